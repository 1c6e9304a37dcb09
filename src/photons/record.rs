//! What is stored of a photon: exact data, no estimate.

use crate::transport::Flags;
use glam::{DVec3, Vec3};

/// A photon as it arrives at a collision or a surface, before the albedo decides what becomes of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Photon {
    /// Where it arrived \[L\].
    pub position: DVec3,
    /// Unit direction of travel.
    pub dir: Vec3,
    /// Unit geometric normal of the surface where it arrived, on the side of its arrival; 0 in a medium.
    pub normal: Vec3,
    /// Power it arrives with \[W\], as though its history were the only one emitted: estimates divide by the
    /// number emitted. On a smooth mesh, times what it counts about the shading normal
    /// ([`Normals::arriving`](crate::geometry::Normals::arriving)).
    pub power: Vec3,
    /// Number of scatterings so far, by media and non-specular surfaces.
    pub order: u16,
    /// What the path met.
    pub flags: Flags,
}

/// Photons in columns, so that those of media hold no normals, and each column can be given back to the system when it is no longer
/// needed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Photons {
    pub(super) positions: Vec<DVec3>,
    pub(super) dirs: Vec<Vec3>,
    /// None while no photon has one.
    pub(super) normals: Vec<Vec3>,
    pub(super) powers: Vec<Vec3>,
    pub(super) histories: Vec<(u16, Flags)>,
}

/// Parts of fewer photons than these become one as soon as they are as many together: such columns are so large that the system's
/// allocator gives each back at once, where small ones leave holes behind.
const PART: usize = 1 << 19;

impl Photons {
    /// Photons of media, with room for so many.
    pub fn with_capacity(count: usize) -> Self {
        Photons {
            positions: Vec::with_capacity(count),
            dirs: Vec::with_capacity(count),
            normals: Vec::new(),
            powers: Vec::with_capacity(count),
            histories: Vec::with_capacity(count),
        }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The photon of a number below [`Photons::len`].
    #[inline]
    pub fn get(&self, index: usize) -> Photon {
        let (order, flags) = self.histories[index];
        Photon {
            position: self.positions[index],
            dir: self.dirs[index],
            normal: self.normals.get(index).copied().unwrap_or(Vec3::ZERO),
            power: self.powers[index],
            order,
            flags,
        }
    }

    /// Every photon.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Photon> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }

    /// How many are not finite in every column.
    pub(super) fn non_finite(&self) -> u64 {
        let finite = |column: &[Vec3]| column.iter().fold(true, |all, vector| all & vector.is_finite());
        let are_finite = self.positions.iter().fold(true, |all, position| all & position.is_finite())
            && [&self.dirs, &self.normals, &self.powers].into_iter().all(|column| finite(column));
        if are_finite {
            return 0;
        }
        let is_finite = |p: &Photon| {
            p.position.is_finite() && p.dir.is_finite() && p.normal.is_finite() && p.power.is_finite()
        };
        self.iter().filter(|photon| !is_finite(photon)).count() as u64
    }

    /// Adds a photon.
    #[inline]
    pub fn push(&mut self, photon: Photon) {
        if photon.normal != Vec3::ZERO || !self.normals.is_empty() {
            self.normals.resize(self.len(), Vec3::ZERO);
            self.normals.push(photon.normal);
        }
        self.positions.push(photon.position);
        self.dirs.push(photon.dir);
        self.powers.push(photon.power);
        self.histories.push((photon.order, photon.flags));
    }

    /// Keeps the photons that `keeps` accepts, and no room for more.
    pub fn retain(&mut self, keeps: impl Fn(&Photon) -> bool) {
        fn filter<T>(column: &mut Vec<T>, kept: &[bool]) {
            let mut kept = kept.iter();
            column.retain(|_| kept.next() == Some(&true));
        }
        let kept: Vec<bool> = self.iter().map(|photon| keeps(&photon)).collect();
        filter(&mut self.positions, &kept);
        filter(&mut self.dirs, &kept);
        filter(&mut self.normals, &kept);
        filter(&mut self.powers, &kept);
        filter(&mut self.histories, &kept);
        self.shrink_to_fit();
    }

    /// The same photons in as little memory.
    pub(super) fn shrink_to_fit(&mut self) {
        self.positions.shrink_to_fit();
        self.dirs.shrink_to_fit();
        self.normals.shrink_to_fit();
        self.powers.shrink_to_fit();
        self.histories.shrink_to_fit();
    }

    /// Adds others behind its own, column by column; those of media make room for normals.
    fn append(&mut self, mut others: Photons) {
        if !(self.normals.is_empty() && others.normals.is_empty()) {
            self.normals.resize(self.len(), Vec3::ZERO);
            others.normals.resize(others.len(), Vec3::ZERO);
        }
        self.positions.append(&mut others.positions);
        self.dirs.append(&mut others.dirs);
        self.normals.append(&mut others.normals);
        self.powers.append(&mut others.powers);
        self.histories.append(&mut others.histories);
    }

    /// Adds parts behind parts; each photon is copied once at most.
    pub(super) fn join(parts: &mut Vec<Photons>, others: Vec<Photons>) {
        parts.extend(others.into_iter().filter(|part| !part.is_empty()));
        let is_small = |part: &Photons| part.len() < PART;
        let first = parts.iter().position(is_small).unwrap_or(parts.len());
        let small = parts[first..].iter().take_while(|part| is_small(part));
        let (number, count) = small.fold((0, 0), |(number, count), part| (number + 1, count + part.len()));
        if count >= PART {
            let mut one = Photons::with_capacity(count);
            if parts[first..first + number].iter().any(|part| !part.normals.is_empty()) {
                one.normals.reserve_exact(count);
            }
            parts.drain(first..first + number).for_each(|part| one.append(part));
            parts.insert(first, one);
        }
    }
}

impl FromIterator<Photon> for Photons {
    fn from_iter<I: IntoIterator<Item = Photon>>(photons: I) -> Self {
        let photons = photons.into_iter();
        let mut columns = Photons::with_capacity(photons.size_hint().0);
        photons.for_each(|photon| columns.push(photon));
        columns
    }
}

impl From<Vec<Photon>> for Photons {
    fn from(photons: Vec<Photon>) -> Self {
        photons.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn photon(number: usize, is_on_surface: bool) -> Photon {
        let x = number as f32;
        Photon {
            position: DVec3::splat(number as f64),
            dir: Vec3::X * x,
            normal: if is_on_surface { Vec3::Z } else { Vec3::ZERO },
            power: Vec3::Y * x,
            order: number as u16,
            flags: if is_on_surface { Flags::DIFFUSE } else { Flags::MEDIUM },
        }
    }

    #[test]
    fn photons_come_back_as_they_went_in() {
        for is_on_surface in [|_| false, |_| true, |n| n > 3, |n: usize| n.is_multiple_of(3)] {
            let photons: Vec<Photon> = (0..10).map(|n| photon(n, is_on_surface(n))).collect();
            let mut columns = Photons::from(photons.clone());
            assert!(columns.iter().eq(photons.iter().copied()) && columns.len() == 10);
            assert_eq!(columns.normals.is_empty(), !photons.iter().any(|p| p.normal != Vec3::ZERO));
            let is_kept = |p: &Photon| p.order % 4 != 1;
            columns.retain(is_kept);
            assert!(columns.iter().eq(photons.into_iter().filter(is_kept)));
        }
    }

    /// Whoever has normals; and however small parts come, those that are joined are large.
    #[test]
    fn parts_keep_their_order() {
        let sizes = [10, PART - 20, 5, 30, PART, 7, 8, PART / 2, PART / 2];
        let (mut parts, mut all) = (Vec::new(), Vec::new());
        for (which, size) in sizes.into_iter().enumerate() {
            let part: Vec<Photon> = (0..size).map(|n| photon(all.len() + n, which % 3 == 1)).collect();
            all.extend_from_slice(&part);
            Photons::join(&mut parts, vec![part.into(), Photons::default()]);
        }
        assert!(parts.iter().flat_map(Photons::iter).eq(all));
        assert_eq!(parts.iter().filter(|part| part.len() < PART).count(), 0);
    }
}
