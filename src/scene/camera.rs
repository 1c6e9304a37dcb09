//! The camera: a pinhole that sees a rectangle of pixels.

use crate::error::{Error, Result};
use crate::math::Ray;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// How the samples of a pixel are spread about it. Every sample belongs to one pixel, so that pixels are independent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Filter {
    /// Uniformly over the pixel's square.
    #[default]
    Box,
    /// With the density of a tent two pixels wide about the pixel's middle.
    Tent,
}

impl Filter {
    /// The offset from the pixel's upper left corner, in pixels, of a sample made of two numbers in [0, 1).
    pub fn offset(self, u: [f64; 2]) -> DVec2 {
        match self {
            Filter::Box => DVec2::from(u),
            Filter::Tent => DVec2::new(0.5 + tent(u[0]), 0.5 + tent(u[1])),
        }
    }

    /// The pixels, along one axis, that may have a sample at this raster coordinate, with its density in each.
    pub fn pixels(self, at: f64) -> [(i64, f64); 2] {
        match self {
            Filter::Box => [(at.floor() as i64, 1.0), (0, 0.0)],
            Filter::Tent => {
                let first = (at - 0.5).floor();
                let part = at - 0.5 - first;
                [(first as i64, 1.0 - part), (first as i64 + 1, part)]
            }
        }
    }
}

/// Density 1 - |x| on (-1, 1), by inversion.
fn tent(u: f64) -> f64 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - u)).sqrt() }
}

/// What a camera is made of, before it is checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Where it is \[L\].
    pub position: DVec3,
    /// A point in the middle of the picture \[L\].
    pub look_at: DVec3,
    /// The direction that is up in the picture, as far as it is across the line of sight.
    pub up: DVec3,
    /// The full horizontal angle \[degrees\].
    pub fov: f64,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// How the samples of a pixel are spread.
    pub filter: Filter,
}

/// A pinhole camera.
///
/// Raster coordinates count pixels from the picture's upper left corner, x to the right and y down; the pixel (i, j)
/// is the square [i, i+1) x [j, j+1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    view: View,
    forward: DVec3,
    /// Half the picture's width at distance 1.
    right: DVec3,
    /// Half the picture's height at distance 1, downwards.
    down: DVec3,
}

/// Most pixels along a side.
pub const MAX_SIDE: u32 = 16_384;

/// Most pixels: a picture takes 545 bytes a pixel, and 715 where it is the mean of several, which is 6 GB.
pub const MAX_PIXELS: u64 = 1 << 23;

impl Camera {
    /// A camera.
    ///
    /// # Errors
    /// `Error::OutOfRange` for a side of 0 or above 16384 pixels, more than 8388608 pixels in all and an angle outside (0, 180); `Error::Scene` for a
    /// line of sight without direction, and an up along it.
    pub fn new(view: View) -> Result<Self> {
        for (name, side) in [("camera.width", view.width), ("camera.height", view.height)] {
            if !(1..=MAX_SIDE).contains(&side) {
                return Err(Error::out_of_range(name, f64::from(side), "1 to 16384 pixels"));
            }
        }
        let pixels = u64::from(view.width) * u64::from(view.height);
        if pixels > MAX_PIXELS {
            let allowed = "at most 8388608 pixels (such as 4096 x 2048), whose film takes 6 GB of memory";
            return Err(Error::out_of_range("camera.width times camera.height", pixels as f64, allowed));
        }
        if !(view.fov > 0.0 && view.fov < 180.0) {
            return Err(Error::out_of_range("camera.fov", view.fov, "above 0 and below 180 degrees"));
        }
        let refuse = |text: &str| Err(Error::Scene(text.to_string()));
        if !view.position.is_finite() {
            return refuse("camera.position is not finite");
        }
        let Some(forward) = (view.look_at - view.position).try_normalize() else {
            return refuse("camera.look_at must be finite and another point than camera.position");
        };
        let across = view.up.try_normalize().map(|up| forward.cross(up)).filter(|a| a.length() > PARALLEL);
        let Some(right) = across.and_then(DVec3::try_normalize) else {
            return refuse("camera.up must be finite, not 0 0 0 and not along the line of sight");
        };
        let half = libm::tan(0.5 * view.fov.to_radians());
        let aspect = f64::from(view.height) / f64::from(view.width);
        Ok(Camera { view, forward, right: right * half, down: forward.cross(right) * (half * aspect) })
    }

    /// The same camera with another number of pixels.
    ///
    /// # Errors
    /// Those of [`Camera::new`].
    pub fn with_size(&self, width: u32, height: u32) -> Result<Self> {
        Camera::new(View { width, height, ..self.view })
    }

    /// The same camera with another picture size: of sides that are not given, one follows the other, and both are as they are.
    ///
    /// # Errors
    /// Those of [`Camera::new`].
    pub fn sized(&self, width: Option<u32>, height: Option<u32>) -> Result<Self> {
        let follow = |given: u32, over: u32, under: u32| {
            ((f64::from(given) * f64::from(over) / f64::from(under)).round() as u32).max(1)
        };
        let (width, height) = match (width, height) {
            (None, None) => (self.width(), self.height()),
            (Some(w), Some(h)) => (w, h),
            (Some(w), None) => (w, follow(w, self.height(), self.width())),
            (None, Some(h)) => (follow(h, self.width(), self.height()), h),
        };
        self.with_size(width, height)
    }

    /// What it was made of.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Where it is \[L\].
    pub fn position(&self) -> DVec3 {
        self.view.position
    }

    /// Unit direction of sight.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The pixels that may have a sample at a place of the raster, by number row by row from the top left, with its density
    /// in each.
    pub fn pixels(&self, at: DVec2) -> impl Iterator<Item = (usize, f64)> + use<> {
        let (width, height) = (i64::from(self.view.width), i64::from(self.view.height));
        let rows = self.view.filter.pixels(at.y);
        let columns = self.view.filter.pixels(at.x).into_iter();
        columns.flat_map(move |(x, wide)| rows.map(move |(y, high)| (x, y, wide * high))).filter_map(
            move |(x, y, density)| {
                let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
                (is_inside && density > 0.0).then_some(((y * width + x) as usize, density))
            },
        )
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.view.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.view.height
    }

    /// The ray through a point of the picture, in raster coordinates.
    pub fn ray(&self, at: DVec2) -> Ray {
        let x = 2.0 * at.x / f64::from(self.view.width) - 1.0;
        let y = 2.0 * at.y / f64::from(self.view.height) - 1.0;
        Ray::new(self.view.position, (self.forward + self.right * x + self.down * y).normalize())
    }

    /// The ray of a sample of a pixel, made of two numbers in [0, 1).
    pub fn sample(&self, x: u32, y: u32, u: [f64; 2]) -> Ray {
        self.ray(DVec2::new(f64::from(x), f64::from(y)) + self.view.filter.offset(u))
    }

    /// Where a point is seen, in raster coordinates, inside the picture or not; none if it is not in front.
    pub fn project(&self, p: DVec3) -> Option<DVec2> {
        let towards = p - self.view.position;
        let depth = towards.dot(self.forward);
        if depth.is_nan() || depth <= 0.0 {
            return None;
        }
        let x = towards.dot(self.right) / (depth * self.right.length_squared());
        let y = towards.dot(self.down) / (depth * self.down.length_squared());
        let at = DVec2::new(
            0.5 * (x + 1.0) * f64::from(self.view.width),
            0.5 * (y + 1.0) * f64::from(self.view.height),
        );
        at.is_finite().then_some(at)
    }

    /// The pixel that a point is seen in, if the picture holds it.
    pub fn pixel(&self, p: DVec3) -> Option<(u32, u32)> {
        let at = self.project(p)?;
        let is_inside = at.min_element() >= 0.0
            && at.x < f64::from(self.view.width)
            && at.y < f64::from(self.view.height);
        is_inside.then_some((at.x as u32, at.y as u32))
    }

    /// Whether a sample of a pixel may be at this place, in raster coordinates: at most half a pixel outside.
    pub fn is_near(&self, at: DVec2) -> bool {
        let last = DVec2::new(f64::from(self.view.width), f64::from(self.view.height)) + 0.5;
        at.cmpge(DVec2::splat(-0.5)).all() && at.cmple(last).all()
    }

    /// Area of a pixel on the plane at distance 1 \[1\].
    pub fn pixel_area(&self) -> f64 {
        let whole = 4.0 * self.right.length() * self.down.length();
        whole / (f64::from(self.view.width) * f64::from(self.view.height))
    }
}

/// Sine of the angle below which up is taken to be along the line of sight: less keeps no eight digits of across.
const PARALLEL: f64 = 1e-8;

#[cfg(test)]
mod tests {
    use super::*;

    const VIEW: View = View {
        position: DVec3::new(1.0, 2.0, 3.0),
        look_at: DVec3::new(1.0, 2.0, -7.0),
        up: DVec3::Y,
        fov: 90.0,
        width: 4,
        height: 2,
        filter: Filter::Box,
    };

    /// Right angle across, looking along -z with y up: the left edge is at 45 degrees, the picture half as high.
    #[test]
    fn corners_and_centres_of_pixels() {
        let camera = Camera::new(VIEW).unwrap();
        let along = |x: f64, y: f64| camera.ray(DVec2::new(x, y)).dir;
        let cases = [
            ((0.0, 0.0), DVec3::new(-1.0, 0.5, -1.0)),
            ((4.0, 0.0), DVec3::new(1.0, 0.5, -1.0)),
            ((0.0, 2.0), DVec3::new(-1.0, -0.5, -1.0)),
            ((4.0, 2.0), DVec3::new(1.0, -0.5, -1.0)),
            ((2.0, 1.0), DVec3::new(0.0, 0.0, -1.0)),
            ((0.5, 0.5), DVec3::new(-0.75, 0.25, -1.0)),
            ((3.5, 1.5), DVec3::new(0.75, -0.25, -1.0)),
        ];
        for ((x, y), towards) in cases {
            assert!(along(x, y).distance(towards.normalize()) < 4.0 * f64::EPSILON, "{x} {y}");
        }
        assert_eq!(camera.ray(DVec2::ONE).origin, VIEW.position);
        assert!(camera.sample(1, 0, [0.5, 0.5]).dir.distance(along(1.5, 0.5)) < f64::EPSILON);
        assert!((camera.pixel_area() - 0.25).abs() < 1e-15);
    }

    #[test]
    fn points_are_seen_where_their_rays_leave() {
        let tilted = View { look_at: DVec3::new(-4.0, 0.5, 9.0), up: DVec3::new(0.3, 1.0, 0.2), ..VIEW };
        let camera = Camera::new(View { fov: 37.0, width: 64, height: 48, ..tilted }).unwrap();
        for (x, y) in [(0.1, 0.2), (63.9, 47.9), (12.5, 40.25), (-3.0, 50.0)] {
            let at = DVec2::new(x, y);
            let seen = camera.project(camera.ray(at).at(5.0)).unwrap();
            assert!(seen.distance(at) < 1e-11, "{at} {seen}");
        }
        let pixel = |x, y| camera.pixel(camera.ray(DVec2::new(x, y)).at(2.0));
        assert_eq!(pixel(12.5, 40.25), Some((12, 40)));
        assert_eq!(pixel(-0.5, 3.0), None);
        assert_eq!(camera.project(VIEW.position - camera.forward()), None);
        assert_eq!(camera.project(VIEW.position), None);
    }

    /// Two numbers on a fine grid: the tent's mean is the middle of the pixel, its variance 1/6 along each axis, and its
    /// samples stay within a pixel of it.
    #[test]
    fn filters_have_their_moments() {
        let n = 1000;
        for (filter, variance) in [(Filter::Box, 1.0 / 12.0), (Filter::Tent, 1.0 / 6.0)] {
            let (mut first, mut second) = (0.0, 0.0);
            for i in 0..n {
                let x = filter.offset([(f64::from(i) + 0.5) / f64::from(n), 0.5]).x - 0.5;
                assert!(x.abs() < 1.0);
                first += x / f64::from(n);
                second += x * x / f64::from(n);
            }
            // The midpoint rule errs by at most 1/(24 n^2) times the slope, finite but at the tent's ends: 1/n there.
            assert!(first.abs() < 1e-12 && (second - variance).abs() < 1.0 / f64::from(n), "{filter:?}");
        }
        assert_eq!(Filter::Tent.offset([0.0, 0.5]), DVec2::new(-0.5, 0.5));
    }

    #[test]
    fn impossible_views_are_refused() {
        let refused = |view: View, word: &str| {
            let text = Camera::new(view).unwrap_err().to_string();
            assert!(text.contains(word), "{text}");
        };
        refused(View { width: 0, ..VIEW }, "camera.width is 0; allowed: 1 to 16384");
        refused(
            View { width: 4097, height: 2048, ..VIEW },
            "camera.height is 8390656; allowed: at most 8388608",
        );
        refused(View { height: 20_000, ..VIEW }, "camera.height is 20000");
        for fov in [0.0, 180.0, -1.0, f64::NAN, f64::INFINITY] {
            refused(View { fov, ..VIEW }, "camera.fov is");
        }
        refused(View { look_at: VIEW.position, ..VIEW }, "camera.look_at");
        refused(View { look_at: DVec3::NAN, ..VIEW }, "camera.look_at");
        refused(View { position: DVec3::INFINITY, ..VIEW }, "camera.position");
        for up in [DVec3::Z, DVec3::ZERO, DVec3::NAN, DVec3::new(0.0, 1e-9, 1.0)] {
            refused(View { up, ..VIEW }, "camera.up");
        }
    }
}
