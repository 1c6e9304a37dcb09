//! What a tree holds of photons beside their places, by number while their order is sought, then by place.

use super::block::{BLOCK, ROW, Row};
use super::units::Units;
use crate::photons::{Flags, Photons};
use glam::Vec3;
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use wide::f32x8;

/// A photon on its way into the tree: its position in the tree's units, and its number.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) position: [f32; 3],
    pub(super) index: u32,
}

impl Entry {
    /// An entry of no photon, to fill memory with.
    pub(super) const NONE: Entry = Entry { position: [0.0; 3], index: 0 };
}

/// Columns of photons, numbered through.
#[derive(Debug, Default)]
pub(super) struct Columns {
    pub(super) dirs: Vec<Vec3>,
    /// None where no photon has one.
    pub(super) normals: Vec<Vec3>,
    pub(super) powers: Vec<Vec3>,
    pub(super) histories: Vec<(u16, Flags)>,
}

impl Columns {
    /// The columns of all parts, and the entry of each photon; each part is gone before the next is taken.
    pub(super) fn of(parts: Vec<Photons>, units: &Units) -> (Vec<Entry>, Self) {
        let count = parts.iter().map(Photons::len).sum();
        let is_on_surfaces = parts.iter().any(|part| part.normals.iter().any(|normal| *normal != Vec3::ZERO));
        let (mut entries, mut all) = (Vec::with_capacity(count), Columns::default());
        for Photons { positions, dirs, mut normals, powers, histories } in parts {
            let numbers = entries.len() as u32..;
            let entry =
                |(position, index)| Entry { position: units.relative(position).as_vec3().to_array(), index };
            let in_part = positions.len();
            entries.extend(positions.into_iter().zip(numbers).map(entry));
            if is_on_surfaces {
                normals.resize(in_part, Vec3::ZERO);
                append(&mut all.normals, normals);
            }
            append(&mut all.dirs, dirs);
            append(&mut all.powers, powers);
            append(&mut all.histories, histories);
        }
        (entries, all)
    }

    /// The normal of a photon, 0 in a medium.
    pub(super) fn normal(&self, index: usize) -> Vec3 {
        self.normals.get(index).copied().unwrap_or(Vec3::ZERO)
    }
}

/// The first part becomes the column, without a copy.
fn append<T>(column: &mut Vec<T>, mut part: Vec<T>) {
    if column.is_empty() {
        *column = part;
    } else {
        column.append(&mut part);
    }
}

/// A column in an order, eight vectors a row and two rows a block; padding carries nothing.
pub(super) fn rows(column: Vec<Vec3>, order: &[u32], is_parallel: bool) -> Vec<Row> {
    if column.is_empty() {
        return Vec::new();
    }
    let row = |number: usize| {
        let mut lanes = [[0.0; ROW]; 3];
        for (lane, index) in order.iter().skip(number * ROW).take(ROW).enumerate() {
            let vector = column[*index as usize];
            (0..3).for_each(|axis| lanes[axis][lane] = vector[axis]);
        }
        lanes.map(f32x8::new)
    };
    let numbers = 0..2 * order.len().div_ceil(BLOCK);
    if is_parallel { numbers.into_par_iter().map(row).collect() } else { numbers.map(row).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photons::Photon;
    use glam::DVec3;

    #[test]
    fn photons_keep_their_numbers_in_parts() {
        let photon = |x: u16| Photon {
            position: DVec3::X * f64::from(x),
            dir: Vec3::Z * f32::from(x),
            normal: if x.is_multiple_of(4) { Vec3::X * f32::from(x) } else { Vec3::ZERO },
            power: Vec3::ONE * f32::from(x),
            order: x,
            flags: Flags::NONE,
        };
        let photons: Vec<Photon> = (0..10).map(photon).collect();
        let units = Units::new(DVec3::ZERO, DVec3::X * 9.0);
        for cuts in [vec![0, 10], vec![0, 0, 3, 4, 4, 10, 10]] {
            let parts =
                cuts.windows(2).map(|cut| photons[cut[0]..cut[1]].iter().copied().collect()).collect();
            let (entries, columns) = Columns::of(parts, &units);
            assert_eq!(entries.len(), 10);
            for (number, photon) in photons.iter().enumerate() {
                assert_eq!(entries[number].index as usize, number);
                assert_eq!(entries[number].position, units.relative(photon.position).as_vec3().to_array());
                assert_eq!(columns.normal(number), photon.normal);
                assert_eq!((columns.dirs[number], columns.powers[number]), (photon.dir, photon.power));
                assert_eq!(columns.histories[number], (photon.order, photon.flags));
            }
        }
        let (entries, columns) = Columns::of(vec![photons[1..3].iter().copied().collect()], &units);
        assert!(entries.len() == 2 && columns.normals.is_empty());
        assert!(Columns::of(Vec::new(), &units).0.is_empty());
    }
}
