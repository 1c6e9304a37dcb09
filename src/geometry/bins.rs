//! Bins: equal parts of a rectangle and of a box along the axes, over which a field is averaged.

use super::{Cuboid, Rectangle};
use crate::error::{Error, Result};
use crate::math::{Interval, Ray};
use glam::{DVec2, DVec3};

/// Most bins of one sensor.
pub const MAX_BINS: usize = 1 << 22;

fn check_count(count: &[usize]) -> Result<()> {
    if let Some(bad) = count.iter().find(|n| **n == 0) {
        return Err(Error::out_of_range("bins along an axis", *bad as f64, "1 or more"));
    }
    match count.iter().try_fold(1, |product: usize, n| product.checked_mul(*n)) {
        Some(all) if all <= MAX_BINS => Ok(()),
        _ => {
            let all = count.iter().map(|n| *n as f64).product();
            Err(Error::out_of_range("the number of bins", all, "at most 4194304"))
        }
    }
}

/// A rectangle in equal parts; bins are counted along u first, then along v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceBins {
    rectangle: Rectangle,
    count: [usize; 2],
}

impl FaceBins {
    /// So many parts along the edges u and v.
    ///
    /// # Errors
    /// `Error::OutOfRange` for none along an edge, and more than [`MAX_BINS`] in all
    pub fn new(rectangle: Rectangle, count: [usize; 2]) -> Result<Self> {
        check_count(&count)?;
        Ok(FaceBins { rectangle, count })
    }

    /// The whole.
    pub fn rectangle(&self) -> &Rectangle {
        &self.rectangle
    }

    /// Parts along u and v.
    pub fn count(&self) -> [usize; 2] {
        self.count
    }

    /// Area of a bin \[L^2\].
    pub fn area(&self) -> f64 {
        self.rectangle.area() / (self.count[0] * self.count[1]) as f64
    }

    /// The point of a bin at `u`, in [0, 1) along both edges \[L\].
    pub fn point(&self, bin: usize, u: [f64; 2]) -> DVec3 {
        let [nu, nv] = self.count;
        let a = ((bin % nu) as f64 + u[0]) / nu as f64;
        let b = ((bin / nu) as f64 + u[1]) / nv as f64;
        self.rectangle.corner() + self.rectangle.u() * a + self.rectangle.v() * b
    }

    /// The bin above or below which a point lies, seen along the normal.
    pub fn bin_at(&self, p: DVec3) -> Option<usize> {
        let from = p - self.rectangle.corner();
        let part = |edge: DVec3, n: usize| {
            let x = from.dot(edge) / edge.length_squared() * n as f64;
            (x >= 0.0 && x < n as f64).then_some(x as usize)
        };
        let [nu, nv] = self.count;
        Some(part(self.rectangle.u(), nu)? + nu * part(self.rectangle.v(), nv)?)
    }

    /// Distance along a ray to the rectangle's plane, at least 0: a ray that starts in it meets it there \[L\].
    pub fn distance(&self, ray: &Ray) -> Option<f64> {
        let t = (self.rectangle.corner() - ray.origin).dot(self.rectangle.normal())
            / ray.dir.dot(self.rectangle.normal());
        (0.0..f64::INFINITY).contains(&t).then_some(t)
    }
}

/// A box in equal parts; bins are counted along x first, then y, then z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Voxels {
    cuboid: Cuboid,
    count: [usize; 3],
    step: DVec3,
}

/// One axis of the planes between voxels: those of one box, or of its copies with a period.
struct Axis {
    min: f64,
    max: f64,
    step: f64,
    count: i64,
    period: Option<f64>,
}

impl Axis {
    /// The stretch between planes that a place is in. With a period each copy has one more, to the next copy.
    fn index(&self, x: f64) -> i64 {
        let copy = self.period.map_or(0.0, |period| (x / period).floor());
        let local = x - self.period.map_or(0.0, |period| copy * period);
        let part = (((local - self.min) / self.step) as i64).clamp(0, self.count - 1);
        match self.period {
            None => part,
            Some(_) if local < self.min => copy as i64 * (self.count + 1) - 1,
            Some(_) if local >= self.max => copy as i64 * (self.count + 1) + self.count,
            Some(_) => copy as i64 * (self.count + 1) + part,
        }
    }

    /// Place of the plane at the lower end of a stretch.
    fn plane(&self, index: i64) -> f64 {
        let place =
            |part: i64| if part == self.count { self.max } else { self.min + part as f64 * self.step };
        match self.period {
            None => place(index),
            Some(period) => {
                let (copy, part) = (index.div_euclid(self.count + 1), index.rem_euclid(self.count + 1));
                copy as f64 * period + place(part)
            }
        }
    }

    /// The voxel of a stretch; none between copies and outside.
    fn part(&self, index: i64) -> Option<usize> {
        let part = self.period.map_or(index, |_| index.rem_euclid(self.count + 1));
        (0..self.count).contains(&part).then_some(part as usize)
    }
}

impl Voxels {
    /// So many parts along the axes.
    ///
    /// # Errors
    /// `Error::OutOfRange` for none along an axis, and more than [`MAX_BINS`] in all
    pub fn new(cuboid: Cuboid, count: [usize; 3]) -> Result<Self> {
        check_count(&count)?;
        let step = (cuboid.max() - cuboid.min()) / DVec3::from_array(count.map(|n| n as f64));
        Ok(Voxels { cuboid, count, step })
    }

    /// The whole.
    pub fn cuboid(&self) -> &Cuboid {
        &self.cuboid
    }

    /// Parts along x, y and z.
    pub fn count(&self) -> [usize; 3] {
        self.count
    }

    /// Volume of a voxel \[L^3\].
    pub fn volume(&self) -> f64 {
        self.step.element_product()
    }

    /// The point of a voxel at `u`, in [0, 1) along each axis \[L\].
    pub fn point(&self, bin: usize, u: [f64; 3]) -> DVec3 {
        let [nx, ny, _] = self.count;
        let index = [bin % nx, bin / nx % ny, bin / (nx * ny)].map(|i| i as f64);
        self.cuboid.min() + self.step * (DVec3::from_array(index) + DVec3::from_array(u))
    }

    /// The voxel that a point is in.
    pub fn bin_at(&self, p: DVec3) -> Option<usize> {
        let (min, max) = (self.cuboid.min(), self.cuboid.max());
        if !(p.cmpge(min).all() && p.cmplt(max).all()) {
            return None;
        }
        let part =
            |axis: usize| (((p[axis] - min[axis]) / self.step[axis]) as usize).min(self.count[axis] - 1);
        Some(part(0) + self.count[0] * (part(1) + self.count[1] * part(2)))
    }

    /// Calls `meet` with each voxel on a stretch of a ray and the part of the ray in it, in their order; with the voxels of
    /// all copies of the box where it is repeated with a period along x and y \[L\].
    pub fn along(
        &self,
        ray: &Ray,
        stretch: Interval,
        period: Option<DVec2>,
        mut meet: impl FnMut(usize, Interval),
    ) {
        let axes = [0, 1, 2].map(|a| Axis {
            min: self.cuboid.min()[a],
            max: self.cuboid.max()[a],
            step: self.step[a],
            count: self.count[a] as i64,
            period: period.filter(|_| a < 2).map(|period| period[a]),
        });
        let (mut start, mut end) = (stretch.start, stretch.end);
        for (a, axis) in axes.iter().enumerate().filter(|(_, axis)| axis.period.is_none()) {
            let (o, d) = (ray.origin[a], ray.dir[a]);
            if d == 0.0 {
                if o < axis.min || o >= axis.max {
                    return;
                }
                continue;
            }
            let (near, far) = ((axis.min - o) / d, (axis.max - o) / d);
            (start, end) = (start.max(near.min(far)), end.min(near.max(far)));
        }
        // A level ray without end in a periodic world has no length to speak of; light never runs along one.
        if end.is_nan() || end <= start || end.is_infinite() {
            return;
        }
        let first = ray.at(start);
        let mut index = [0, 1, 2].map(|a| axes[a].index(first[a]));
        let mut t = start;
        loop {
            let next = DVec3::from_array([0, 1, 2].map(|a| match ray.dir[a] {
                0.0 => f64::INFINITY,
                d => (axes[a].plane(index[a] + i64::from(d > 0.0)) - ray.origin[a]) / d,
            }));
            let a = next.min_position();
            // Rounding of a plane never leads back.
            let here = next[a].clamp(t, end);
            if here > t
                && let [Some(i), Some(j), Some(k)] = [0, 1, 2].map(|a| axes[a].part(index[a]))
            {
                meet(i + self.count[0] * (j + self.count[1] * k), Interval { start: t, end: here });
            }
            if next[a] >= end {
                return;
            }
            t = here;
            index[a] += if ray.dir[a] > 0.0 { 1 } else { -1 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;
    use crate::rng::{Purpose, Stream};

    fn voxels() -> Voxels {
        let (min, max) = (DVec3::new(0.5, 0.0, -1.0), DVec3::new(1.5, 2.0, 2.0));
        Voxels::new(Cuboid::new(min, max).unwrap(), [3, 2, 5]).unwrap()
    }

    /// Where a ray is said to be in a voxel its points are in it, and all other points are in none.
    fn check(voxels: &Voxels, ray: &Ray, stretch: Interval, period: Option<DVec2>) {
        let mut parts: Vec<(usize, Interval)> = Vec::new();
        voxels.along(ray, stretch, period, |bin, part| parts.push((bin, part)));
        let folded = |p: DVec3| match period {
            None => p,
            Some(w) => DVec3::new(p.x.rem_euclid(w.x), p.y.rem_euclid(w.y), p.z),
        };
        let mut stream = Stream::new(1, Purpose::Synthetic, 0, 0);
        for _ in 0..200 {
            let t = stretch.start + stream.unit() * (stretch.end - stretch.start);
            let said = parts.iter().find(|(_, part)| part.start <= t && t < part.end).map(|(bin, _)| *bin);
            // Within rounding of a plane either voxel is right.
            let near = |t: f64| parts.iter().any(|(_, p)| (p.start - t).abs().min((p.end - t).abs()) < 1e-9);
            assert!(said == voxels.bin_at(folded(ray.at(t))) || near(t), "{ray:?} at {t}: {said:?}");
        }
    }

    #[test]
    fn a_ray_is_in_the_voxels_that_its_points_are_in() {
        let voxels = voxels();
        let mut stream = Stream::new(2, Purpose::Synthetic, 0, 0);
        for number in 0..600 {
            let origin = DVec3::from_array(stream.triple()) * 6.0 - 2.0;
            let mut dir = warp::square_to_sphere(stream.pair()).normalize();
            if number % 5 == 0 {
                // Along a plane or an axis.
                dir[number % 3] = 0.0;
                dir = if number % 2 == 0 { dir.normalize() } else { DVec3::AXES[number % 3] };
            }
            let ray = Ray::new(origin, dir);
            check(&voxels, &ray, Interval { start: 0.0, end: 8.0 }, None);
            check(&voxels, &ray, Interval { start: 0.5, end: 8.0 }, Some(DVec2::new(2.0, 3.0)));
            // The box fills the cell along y: no gap between its copies.
            check(&voxels, &ray, Interval { start: 0.0, end: 8.0 }, Some(DVec2::new(1.5, 2.0)));
        }
    }

    #[test]
    fn points_are_in_their_bins() {
        let rectangle = Rectangle::new(DVec3::new(1.0, 0.0, 2.0), DVec3::Y * 3.0, DVec3::Z * 0.5).unwrap();
        let (face, voxels) = (FaceBins::new(rectangle, [4, 3]).unwrap(), voxels());
        for u in [0.25, 0.75] {
            assert!((0..12).all(|bin| face.bin_at(face.point(bin, [u, 1.0 - u])) == Some(bin)));
            assert!((0..30).all(|bin| voxels.bin_at(voxels.point(bin, [u, 0.5, 1.0 - u])) == Some(bin)));
        }
        assert_eq!(face.bin_at(DVec3::new(1.0, -0.1, 2.1)), None);
        // Products of three rounded factors.
        assert!((face.area() - 0.125).abs() < 1e-16 && (voxels.volume() - 0.2).abs() < 1e-16);
    }

    #[test]
    fn a_ray_that_starts_in_the_plane_meets_it_there() {
        let rectangle = Rectangle::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap();
        let bins = FaceBins::new(rectangle, [1, 1]).unwrap();
        let at = |z: f64, dir: f64| bins.distance(&Ray::new(DVec3::new(0.5, 0.5, z), DVec3::Z * dir));
        assert_eq!([at(0.0, 1.0), at(-2.0, 1.0), at(2.0, 1.0)], [Some(0.0), Some(2.0), None]);
        assert_eq!(bins.distance(&Ray::new(DVec3::ZERO, DVec3::X)), None);
    }

    #[test]
    fn bins_are_counted() {
        let rectangle = Rectangle::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap();
        assert!(FaceBins::new(rectangle, [0, 1]).is_err());
        assert!(FaceBins::new(rectangle, [1 << 22, 2]).is_err());
        let cuboid = Cuboid::new(DVec3::ZERO, DVec3::ONE).unwrap();
        assert!(Voxels::new(cuboid, [usize::MAX, usize::MAX, 2]).is_err());
    }
}
