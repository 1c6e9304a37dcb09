//! Shell integrals about one point as a table over the radius: asked once, every ball about the point follows.

use super::rule::{Rule, tau_of};
use super::shell::{CheckedField, F0, F1, Shells, Sums, U1, U2};

/// One piece of the table.
struct Piece {
    start: f64,
    end: f64,
    /// At the nodes of the rule.
    values: Vec<Sums>,
}

/// The table of one centre.
pub(super) struct Profile<'a> {
    rule: &'a Rule,
    pieces: Vec<Piece>,
}

impl<'a> Profile<'a> {
    /// Asks the field on all shells up to `end`.
    pub(super) fn new(rule: &'a Rule, shells: &Shells, end: f64, asked: &CheckedField) -> Self {
        let pieces = shells
            .radii(end)
            .windows(2)
            .map(|pair| {
                let values = rule.on(pair[0], pair[1]).map(|(s, _)| shells.sums(s, rule, asked)).collect();
                Piece { start: pair[0], end: pair[1], values }
            })
            .collect();
        Profile { rule, pieces }
    }

    /// Where the table's pieces end.
    pub(super) fn ends(&self) -> impl Iterator<Item = f64> {
        self.pieces.iter().map(|piece| piece.end)
    }

    /// The shell of radius s.
    pub(super) fn shell(&self, s: f64) -> Sums {
        let index = self.pieces.partition_point(|piece| piece.end < s).min(self.pieces.len() - 1);
        let piece = &self.pieces[index];
        let tau = tau_of((s - piece.start) / (piece.end - piece.start));
        self.rule.interpolate(&piece.values, tau)
    }

    /// The ball of radius r, shells weighted by `weight(s/r)`, cosines by s/r: int weight z^j f, int weight z^j.
    pub(super) fn ball(&self, r: f64, weight: impl Fn(f64) -> f64) -> Sums {
        let mut sums = [0.0; 5];
        let mut add = |s: f64, w: f64, shell: &Sums| {
            let u = s / r;
            let w = w * weight(u);
            for (j, (sum, value)) in sums.iter_mut().zip(shell).enumerate() {
                let z = match j {
                    F1 | U1 => u,
                    U2 => u * u,
                    _ => 1.0,
                };
                *sum += w * z * value;
            }
        };
        for piece in &self.pieces {
            if piece.end <= r {
                for ((s, w), shell) in self.rule.on(piece.start, piece.end).zip(&piece.values) {
                    add(s, w, shell);
                }
            } else if piece.start < r {
                for (tau, s, w) in self.rule.on_part(piece.start, piece.end, r) {
                    add(s, w, &self.rule.interpolate(&piece.values, tau));
                }
            }
        }
        sums
    }

    /// int f over the ball of radius r.
    pub(super) fn held(&self, r: f64) -> f64 {
        self.ball(r, |_| 1.0)[F0]
    }
}
