//! The bodies of a scene, sorted for rays: rectangles in one list, every other shape by itself.

use super::{SceneParts, Target};
use crate::geometry::{Rectangles, Shape};

/// What a ray is tried against. Of two bodies at the same distance the first one counts, objects before lights; of
/// rectangles in one place lights before objects, so that a lamp in its ceiling is seen.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bodies {
    pub rectangles: Rectangles,
    /// Which body each rectangle of the list is.
    pub targets: Vec<Target>,
    /// Every body that is not in the list.
    pub others: Vec<Target>,
    /// Where in the list an object is, and a light.
    objects: Vec<Option<usize>>,
    lights: Vec<Option<usize>>,
}

impl Bodies {
    pub fn of(parts: &SceneParts) -> Self {
        let (mut list, mut targets, mut others) = (Vec::new(), Vec::new(), Vec::new());
        let mut sort = |target: Target, shape: Option<&Shape>| match shape {
            Some(Shape::Rectangle(rectangle)) => {
                list.push(*rectangle);
                targets.push(target);
                Some(list.len() - 1)
            }
            Some(_) => {
                others.push(target);
                None
            }
            None => None,
        };
        let lights = parts.lights.iter().enumerate();
        let lights = lights.map(|(i, light)| sort(Target::Light(i), light.body())).collect();
        let objects = parts.objects.iter().enumerate();
        let objects = objects.map(|(i, object)| sort(Target::Object(i), Some(&object.shape))).collect();
        Bodies { rectangles: Rectangles::new(list), targets, others, objects, lights }
    }

    /// Where in the list a body is, if it is a rectangle.
    pub fn in_list(&self, target: Target) -> Option<usize> {
        match target {
            Target::Object(i) => self.objects[i],
            Target::Light(i) => self.lights[i],
        }
    }
}
