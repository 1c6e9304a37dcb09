//! The stretches of medium that a ray passes, nearest first.

use super::Region;
use super::regions::{FEW, RegionTree};
use super::segment::Segment;
use crate::math::{Interval, Ray};

/// n convex shapes have 2n ends on a ray, and 2n-1 stretches between them.
const MOST_OF_FEW: usize = 2 * FEW - 1;

/// Disjoint stretches in the order in which the ray passes them.
#[derive(Debug, Clone)]
pub struct Segments(Items);

/// One stretch, by far the most frequent case, costs no array; those of a few regions live on the stack.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant, reason = "lives on the stack for one flight; a box would cost more")]
enum Items {
    None,
    One(Segment),
    Few { items: [Segment; MOST_OF_FEW], len: usize },
    Many(Vec<Segment>),
}

const NOTHING: Segment = Segment { interval: Interval { start: 0.0, end: 0.0 }, medium: 0 };

impl Segments {
    /// The stretches of `regions` on `ray` up to distance `end`; where shapes overlap, the later one counts.
    ///
    /// # Arguments `tree` over the regions, where there are more than a few
    pub(super) fn new(regions: &[Region], tree: Option<&RegionTree>, ray: &Ray, end: f64) -> Self {
        let whole = Interval { start: 0.0, end };
        if let Some(tree) = tree {
            return Segments(Items::Many(tree.segments(regions, ray, whole)));
        }
        if let [region] = regions {
            let interval = region.shape.interval(ray).and_then(|i| i.intersection(whole));
            return Segments(
                interval.map_or(Items::None, |interval| Items::One(Segment { interval, medium: 0 })),
            );
        }
        let mut found = [NOTHING; FEW];
        let mut ends = [0.0f64; 2 * FEW];
        let mut count = 0;
        for (index, region) in regions.iter().enumerate() {
            if let Some(interval) = region.shape.interval(ray).and_then(|i| i.intersection(whole)) {
                found[count] = Segment { interval, medium: index };
                (ends[2 * count], ends[2 * count + 1]) = (interval.start, interval.end);
                count += 1;
            }
        }
        let (mut items, mut len) = ([NOTHING; MOST_OF_FEW], 0);
        let ends = &mut ends[..2 * count];
        ends.sort_unstable_by(f64::total_cmp);
        for pair in ends.windows(2) {
            let part = Interval { start: pair[0], end: pair[1] };
            if part.length() > 0.0 {
                let covers = |s: &&Segment| s.interval.start <= part.start && part.end <= s.interval.end;
                if let Some(last) = found[..count].iter().rev().find(covers) {
                    items[len] = Segment { interval: part, medium: last.medium };
                    len += 1;
                }
            }
        }
        Segments(Items::Few { items, len })
    }

    /// At most one stretch.
    pub(super) fn filled(segment: Option<Segment>) -> Self {
        Segments(segment.map_or(Items::None, Items::One))
    }

    /// The stretches, nearest first.
    pub fn iter(&self) -> std::slice::Iter<'_, Segment> {
        match &self.0 {
            Items::None => [].iter(),
            Items::One(segment) => std::slice::from_ref(segment).iter(),
            Items::Few { items, len } => items[..*len].iter(),
            Items::Many(items) => items.iter(),
        }
    }
}
