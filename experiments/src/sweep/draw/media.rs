//! Media: regions, the filling of bodies, densities and phase functions.

use super::super::shapes;
use super::super::text::{array, table};
use super::{Pen, rounded, short};
use glam::DVec3;
use toml::Value;

impl Pen {
    /// The keys of a medium in a box of about this size.
    pub(super) fn medium(&mut self, size: f64, min: DVec3, max: DVec3, may_vary: bool) -> toml::Table {
        let mut keys = toml::Table::new();
        let depth = self.log_within(0.1, 4.0);
        let sigma_t = self.tinted(short(depth / size));
        keys.insert("sigma_t".into(), sigma_t);
        let albedo = self.spectrum(0.2, 0.97);
        keys.insert("albedo".into(), albedo);
        self.phase(&mut keys);
        let is_varying = may_vary && self.chance(0.45);
        if is_varying {
            let density = self.density(min, max);
            keys.insert("density".into(), density);
            if self.chance(0.25) {
                let grid = self.grid(1.0, (min, max));
                keys.insert("albedo_grid".into(), grid);
            }
        }
        if self.chance(0.12) {
            let key = if is_varying && self.chance(0.5) { "emission_by_density" } else { "emission" };
            let emission = self.tinted(short(0.3 / size));
            keys.insert(key.into(), emission);
            self.say(key);
        }
        keys
    }

    fn phase(&mut self, keys: &mut toml::Table) {
        let number = |x: f64| Value::Float(short(x));
        match self.pick(&[(0, 0.3), (1, 0.3), (2, 0.12), (3, 0.1), (4, 0.1), (5, 0.08)]) {
            0 => {
                keys.insert("g".into(), Value::Float(0.0));
            }
            1 => {
                let g = self.within(-0.7, 0.9);
                keys.insert("g".into(), number(g));
            }
            2 => {
                keys.insert("phase".into(), table([("rayleigh", table([]))]));
            }
            3 => {
                let k = self.within(-0.8, 0.8);
                keys.insert("phase".into(), table([("schlick", table([("k", number(k))]))]));
            }
            4 => {
                let (g1, g2, share) = (self.within(0.2, 0.85), self.within(-0.6, 0.1), self.stream.unit());
                let both = [("g1", number(g1)), ("g2", number(g2)), ("share", number(share))];
                keys.insert("phase".into(), table([("two-term", table(both))]));
            }
            _ => {
                let values: Vec<f64> = (0..7).map(|_| short(self.within(0.1, 2.0))).collect();
                let lines: Vec<String> =
                    values.iter().enumerate().map(|(i, v)| format!("{} {v}", 30 * i)).collect();
                let name = format!("phase{}.txt", self.text.files.len());
                self.text.files.insert(name.clone(), (lines.join("\n") + "\n").into_bytes());
                keys.insert("phase".into(), table([("table", table([("file", Value::String(name))]))]));
                self.say("table phase");
            }
        }
    }

    /// A density over a box.
    fn density(&mut self, min: DVec3, max: DVec3) -> Value {
        match self.stream.index(3) {
            0 => {
                self.say("grid");
                let grid = self.grid(2.0, (min, max));
                table([("grid", grid)])
            }
            1 => {
                let radii = (max - min) * 0.5 * self.within(0.5, 0.9);
                let seed = self.stream.index(1000) as i64;
                let (frequency, roughness) = (short(self.within(0.5, 3.0)), short(self.within(0.0, 1.5)));
                self.say("cloud");
                table([(
                    "cloud",
                    table([
                        ("center", array(&(0.5 * (min + max)).to_array())),
                        ("radii", array(&radii.to_array())),
                        ("seed", Value::Integer(seed)),
                        ("frequency", Value::Float(frequency)),
                        ("octaves", Value::Integer(2)),
                        ("roughness", Value::Float(roughness)),
                    ]),
                )])
            }
            _ => {
                let up = match self.stream.index(3) {
                    0 => DVec3::Y,
                    1 => DVec3::X,
                    _ => self.direction(),
                };
                let (base, scale) = (short(self.within(-0.8, 0.2)), short(self.log_within(0.2, 2.0)));
                self.say("height fog");
                table([(
                    "height-fog",
                    table([
                        ("base", Value::Float(base)),
                        ("scale_height", Value::Float(scale)),
                        ("up", array(&up.to_array())),
                    ]),
                )])
            }
        }
    }

    /// Some samples up to a value, over a box.
    fn grid(&mut self, most: f64, (min, max): (DVec3, DVec3)) -> Value {
        let count: [usize; 3] = std::array::from_fn(|_| 1 + self.stream.index(5));
        let channels = if most == 1.0 { 1 + 2 * self.stream.index(2) } else { 1 };
        let number = channels * count.iter().product::<usize>();
        let values: Vec<f32> = (0..number).map(|_| self.within(0.0, most) as f32).collect();
        let name = format!("grid{}.vol", self.text.files.len());
        if let Ok(grid) = turbid::medium::Grid::new((DVec3::ZERO, DVec3::ONE), count, channels, values) {
            self.text.files.insert(name.clone(), grid.to_bytes());
        }
        let corners = [("min", min), ("max", max)].map(|(key, corner)| (key, array(&corner.to_array())));
        let [low, high] = corners;
        table([("file", Value::String(name)), low, high])
    }

    /// Regions: over all, a part, or several that overlap.
    pub(super) fn media(&mut self) {
        let count = self.pick(&[(1, 0.75), (2, 0.25)]);
        for _ in 0..count {
            let (shape, size, min, max) =
                match self.pick(&[(0, 0.3), (1, 0.2), (2, 0.2), (3, 0.25), (4, 0.05)]) {
                    // Face by face that of the room.
                    0 => (shapes::cuboid([-1.0; 3], [1.0; 3]), 2.0, DVec3::NEG_ONE, DVec3::ONE),
                    1 => (shapes::cuboid([-1.4; 3], [1.4; 3]), 2.0, DVec3::splat(-1.4), DVec3::splat(1.4)),
                    2 => (shapes::sphere(DVec3::ZERO, 2.2), 2.0, DVec3::splat(-1.2), DVec3::splat(1.2)),
                    3 => {
                        let half = short(self.within(0.25, 0.6));
                        let at = DVec3::new(
                            self.within(-0.3, 0.3),
                            self.within(-0.3, 0.3),
                            self.within(-0.3, 0.3),
                        );
                        let at = DVec3::from(at.to_array().map(short));
                        let (min, max) = (at - half, at + half);
                        let shape = match self.stream.index(2) {
                            0 => shapes::sphere(at, half),
                            _ => shapes::cuboid(min.to_array(), max.to_array()),
                        };
                        (shape, 2.0 * half, min, max)
                    }
                    _ => {
                        let (top, thickness) = (short(self.within(-0.9, 0.0)), short(self.within(0.3, 1.0)));
                        let keys = [("top", Value::Float(top)), ("thickness", Value::Float(thickness))];
                        self.say("slab region");
                        (table([("slab", table(keys))]), 2.0, DVec3::NEG_ONE, DVec3::ONE)
                    }
                };
            let mut keys = self.medium(size, min, max, true);
            keys.insert("shape".into(), shape);
            self.text.parts_mut("regions").push(Value::Table(keys));
            self.say("medium");
        }
    }

    /// An unbounded slab, which paths alone can make pictures of.
    pub(super) fn slab_with_cell(&mut self) {
        self.say("slab with a cell");
        let slab = table([("slab", table([("top", Value::Float(0.0)), ("thickness", Value::Float(1.0))]))]);
        let mut keys = self.medium(1.0, DVec3::ZERO, DVec3::ONE, false);
        keys.insert("shape".into(), slab.clone());
        self.text.parts_mut("regions").push(Value::Table(keys));
        self.text.table.insert("cell".into(), Value::Float(1.0));
        let light = if self.chance(0.5) {
            let dir = rounded(DVec3::new(self.within(-0.5, 0.5), 0.0, 1.0));
            let keys = [
                ("dir", array(&dir)),
                ("irradiance", self.tinted(1.0)),
                ("section", Value::String("unbounded".into())),
            ];
            table([("beam", table(keys))])
        } else {
            let faces = Value::String((if self.chance(0.5) { "top" } else { "both" }).into());
            table([("isotropic", table([("shape", slab), ("faces", faces), ("radiance", self.tinted(0.3))]))])
        };
        self.text.parts_mut("lights").push(light);
        let camera = [
            ("position", array(&[0.1, 0.2, -1.5])),
            ("look_at", array(&[0.0, 0.0, 0.5])),
            ("fov", Value::Float(60.0)),
            ("width", Value::Integer(16)),
            ("height", Value::Integer(12)),
        ];
        self.text.table.insert("camera".into(), table(camera));
    }
}
