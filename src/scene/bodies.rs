//! The bodies of a scene, sorted for rays: rectangles in one list, every other shape by itself.

use super::{Parts, Target};
use crate::geometry::{Rectangles, Shape};

/// What a ray is tried against. Bodies are numbered objects first, then lights; of two at the same distance the
/// first one counts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bodies {
    pub rectangles: Rectangles,
    /// Which body each rectangle of the list is.
    pub targets: Vec<Target>,
    pub others: Vec<Target>,
}

impl Bodies {
    pub fn of(parts: &Parts) -> Self {
        let objects = parts.objects.iter().enumerate().map(|(i, o)| (Target::Object(i), Some(o.shape)));
        let lights = parts.lights.iter().enumerate().map(|(i, l)| (Target::Light(i), l.body()));
        let (mut list, mut targets, mut others) = (Vec::new(), Vec::new(), Vec::new());
        for (target, shape) in objects.chain(lights) {
            match shape {
                Some(Shape::Rectangle(rectangle)) => {
                    list.push(rectangle);
                    targets.push(target);
                }
                Some(_) => others.push(target),
                None => {}
            }
        }
        Bodies { rectangles: Rectangles::new(&list), targets, others }
    }
}
