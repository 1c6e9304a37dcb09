//! The photons that a tree is built from: in parts, as a pass stores them, so that nothing is copied to bring them together.

use crate::photons::Photon;

/// Photons in parts, numbered through.
#[derive(Debug)]
pub(super) struct Records {
    parts: Vec<Vec<Photon>>,
    /// The number of each part's first photon.
    starts: Vec<usize>,
    count: usize,
}

impl Records {
    pub(super) fn new(mut parts: Vec<Vec<Photon>>) -> Self {
        parts.retain(|part| !part.is_empty());
        let mut count = 0;
        let starts = parts.iter().map(|part| {
            let start = count;
            count += part.len();
            start
        });
        let starts = starts.collect();
        Records { parts, starts, count }
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Photon> {
        self.parts.iter().flatten()
    }

    /// The photon of a number, which is below [`Records::len`].
    #[inline]
    pub(super) fn get(&self, index: u32) -> &Photon {
        let index = index as usize;
        if self.parts.len() == 1 {
            return &self.parts[0][index];
        }
        let part = self.starts.partition_point(|start| *start <= index) - 1;
        &self.parts[part][index - self.starts[part]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photons::Flags;
    use glam::{DVec3, Vec3};

    #[test]
    fn photons_keep_their_numbers_in_parts() {
        let photon = |x: u32| Photon {
            position: DVec3::X * f64::from(x),
            dir: Vec3::Z,
            normal: Vec3::ZERO,
            power: Vec3::ONE,
            order: 0,
            flags: Flags::NONE,
        };
        let all: Vec<Photon> = (0..10).map(photon).collect();
        let parts = vec![vec![], all[..3].to_vec(), vec![], all[3..4].to_vec(), all[4..].to_vec(), vec![]];
        for records in [Records::new(parts), Records::new(vec![all.clone()])] {
            assert_eq!(records.len(), 10);
            assert!(records.iter().eq(&all));
            assert!((0..10).all(|i| *records.get(i) == all[i as usize]));
        }
        assert_eq!(Records::new(Vec::new()).len(), 0);
    }
}
