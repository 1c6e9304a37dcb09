//! The tree over the frusta of a lathe.

use super::line::Line;
use glam::DVec2;

/// Frusta that follow each other, and the ring-shaped box around them.
#[derive(Debug, Clone, Copy)]
struct Node {
    first: u32,
    last: u32,
    /// The node that follows when nothing below this one is of interest: nodes stand in the order of a walk.
    next: u32,
    low: DVec2,
    high: DVec2,
}

/// Halves of halves of the profile, in the order of a walk.
#[derive(Debug, Clone)]
pub struct Tree {
    nodes: Vec<Node>,
}

/// Frusta in a leaf.
const LEAF: usize = 4;

/// Boxes are widened by this part of the numbers that their test is computed from, far above its rounding.
const PAD: f64 = 1e-9;

impl Tree {
    pub fn new(rings: &[DVec2]) -> Self {
        let mut tree = Tree { nodes: Vec::new() };
        tree.grow(rings, 0, rings.len() - 1);
        tree
    }

    fn grow(&mut self, rings: &[DVec2], first: usize, last: usize) {
        let around = &rings[first..=last];
        let low = around.iter().copied().reduce(DVec2::min).unwrap_or_default();
        let high = around.iter().copied().reduce(DVec2::max).unwrap_or_default();
        let place = self.nodes.len();
        self.nodes.push(Node { first: first as u32, last: last as u32, next: 0, low, high });
        if last - first > LEAF {
            let middle = (first + last) / 2;
            self.grow(rings, first, middle);
            self.grow(rings, middle, last);
        }
        self.nodes[place].next = self.nodes.len() as u32;
    }

    /// Offers `test` every frustum that the line may cross before the distance that `test` returned last.
    pub fn search(&self, line: &Line, mut test: impl FnMut(usize, f64) -> f64) {
        let (mut place, mut end) = (0, f64::INFINITY);
        while let Some(node) = self.nodes.get(place) {
            let count = (node.last - node.first) as usize;
            if self.nodes.len() > 1 && !node.may_cross(line, end) {
                place = node.next as usize;
                continue;
            }
            if count <= LEAF {
                for k in node.first..node.last {
                    end = test(k as usize, end);
                }
            }
            place += 1;
        }
    }

    /// Offers `test` every frustum that may be nearer to a point (radius, height) than `reach` \[L\]; `test` returns what
    /// that distance is from now on.
    pub fn near(&self, point: DVec2, reach: f64, mut test: impl FnMut(usize, f64) -> f64) {
        let (mut place, mut reach) = (0, reach);
        while let Some(node) = self.nodes.get(place) {
            if point.distance(point.clamp(node.low, node.high)) > reach {
                place = node.next as usize;
                continue;
            }
            if (node.last - node.first) as usize <= LEAF {
                for k in node.first..node.last {
                    reach = test(k as usize, reach);
                }
            }
            place += 1;
        }
    }
}

impl Node {
    fn may_cross(&self, line: &Line, end: f64) -> bool {
        let (a, b) = (line.at_height(self.low.y), line.at_height(self.high.y));
        let (near, far) = (a.min(b), a.max(b));
        if near > end {
            return false;
        }
        let closest = -line.across(0.0).dot(line.dir.truncate()) / line.a;
        let closest = if closest.is_nan() { near } else { closest.clamp(near, far) };
        let pad = PAD * (self.high.x * self.high.x + line.axial(0.0));
        line.axial(closest) <= self.high.x * self.high.x + pad
            && line.axial(near).max(line.axial(far)) >= self.low.x * self.low.x - pad
    }
}
