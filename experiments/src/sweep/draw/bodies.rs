//! Bodies: where they stand, their shapes and surfaces, and what is inside them.

use super::super::motion::Motion;
use super::super::shapes;
use super::super::text::{array, table};
use super::{Pen, Setting, rounded, short};
use glam::DVec3;
use image::codecs::png::PngEncoder;
use image::{ColorType, ImageEncoder};
use toml::Value;
use turbid::output::to_srgb;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Diffuse,
    Mirror,
    Glass,
    Filter,
    Black,
}

impl Pen {
    pub(super) fn wall(&mut self) -> Value {
        match self.pick(&[(0, 0.86), (1, 0.08), (2, 0.06)]) {
            0 => {
                self.has_diffuse = true;
                let texture = self.texture(
                    0.1,
                    0.8,
                    self.setting != Setting::MeshRoom && self.setting != Setting::Ball,
                );
                table([("lambertian", table([("reflectance", texture)]))])
            }
            1 => Value::String("black".into()),
            _ => {
                self.specular = true;
                table([("mirror", table([("reflectance", self.spectrum(0.2, 0.9))]))])
            }
        }
    }

    /// A reflectance or transmittance, the same everywhere or not.
    fn texture(&mut self, low: f64, high: f64, may_tile: bool) -> Value {
        let pair = |pen: &mut Pen| Value::Array(vec![pen.spectrum(low, high), pen.spectrum(low, high)]);
        if may_tile && self.chance(0.15) {
            let tiles = [self.within(1.0, 6.0).floor(), self.within(1.0, 6.0).floor()];
            let values = pair(self);
            return table([("checker", table([("values", values), ("tiles", array(&tiles))]))]);
        }
        if may_tile && self.chance(0.1) {
            return self.image(low, high);
        }
        if self.chance(0.08) {
            let (axis, center) = (rounded(self.direction()), rounded(self.direction() * 2.0));
            let width = short(self.within(0.1, 0.5));
            return table([(
                "wood",
                table([
                    ("values", pair(self)),
                    ("center", array(&center)),
                    ("axis", array(&axis)),
                    ("width", Value::Float(width)),
                ]),
            )]);
        }
        self.spectrum(low, high)
    }

    /// A picture of some pixels, once over a rectangle.
    fn image(&mut self, low: f64, high: f64) -> Value {
        let (width, height) = (1 + self.stream.index(4), 1 + self.stream.index(4));
        let pixels: Vec<u8> = (0..3 * width * height).map(|_| to_srgb(self.within(low, high))).collect();
        let name = format!("image{}.png", self.text.files.len());
        let mut bytes = Vec::new();
        let (columns, rows) = (width as u32, height as u32);
        let written = PngEncoder::new(&mut bytes).write_image(&pixels, columns, rows, ColorType::Rgb8);
        if written.is_err() {
            return self.spectrum(low, high);
        }
        self.text.files.insert(name.clone(), bytes);
        self.say("image");
        table([("image", table([("file", Value::String(name))]))])
    }

    /// A body in the lower place of a column, and perhaps one above it.
    pub(super) fn column(&mut self, (x, z): (f64, f64)) {
        let half = short(self.within(0.12, 0.28));
        let kind = self.surface_kind();
        let is_glass = matches!(kind, Kind::Glass | Kind::Filter);
        let mut center = DVec3::new(x, -1.0 + half, z);
        let stands = self.setting.has_floor() && !self.is_tank && self.chance(0.7);
        if stands && is_glass {
            // Glass keeps a gap: two surfaces in one place are not a boundary.
            center.y += 0.02;
        } else if !stands {
            center.y = short(self.within(-0.65, -0.35));
        }
        let has_wall =
            matches!(self.setting, Setting::Corner | Setting::Room | Setting::Walls | Setting::MeshRoom);
        if has_wall && x < 0.0 && !is_glass && self.chance(0.3) {
            center.x = -1.0 + half;
            self.say("leaning");
        }
        let (shape, name) = self.closed_or_open(center, half, is_glass);
        self.body(shape, name, kind, center, half);
        if self.chance(0.2) {
            let (small, kind) = (short(self.within(0.08, 0.2)), self.surface_kind());
            let is_glass = matches!(kind, Kind::Glass | Kind::Filter);
            // On top of what may be a ball: touching at a point, or standing on a face.
            let gap = if is_glass { 0.02 } else { 0.0 };
            let center = DVec3::new(center.x, center.y + half + small + gap, center.z);
            let (shape, name) = self.closed_or_open(center, small, is_glass);
            self.body(shape, name, kind, center, small);
        }
    }

    fn surface_kind(&mut self) -> Kind {
        if !std::mem::replace(&mut self.has_diffuse, true) {
            return Kind::Diffuse;
        }
        self.pick(&[
            (Kind::Diffuse, 0.52),
            (Kind::Mirror, 0.1),
            (Kind::Glass, 0.24),
            (Kind::Filter, 0.08),
            (Kind::Black, 0.06),
        ])
    }

    /// A shape about a point that reaches no farther than `half` along each axis.
    fn closed_or_open(&mut self, center: DVec3, half: f64, is_closed: bool) -> (Value, &'static str) {
        let solid = [(0, 0.3), (1, 0.22), (2, 0.2), (3, 0.16), (4, 0.06)];
        let any = [(0, 0.28), (1, 0.2), (2, 0.16), (3, 0.12), (4, 0.05), (5, 0.12), (6, 0.07)];
        match if is_closed { self.pick(&solid) } else { self.pick(&any) } {
            0 => (shapes::sphere(center, half), "ball"),
            1 => {
                let size = DVec3::new(1.0, 1.0, 1.0) * half;
                (shapes::cuboid((center - size).to_array(), (center + size).to_array()), "block")
            }
            2 => {
                let frame = Motion::rotation(self.stream.index(24));
                let tilt = self.chance(0.5).then(|| self.direction());
                let solid = match self.stream.index(4) {
                    0 => shapes::block(),
                    1 => shapes::octahedron(),
                    2 => shapes::tetrahedron(),
                    _ => shapes::round(2),
                };
                let solid = shapes::turned(&solid, frame, tilt);
                (shapes::mesh(&mut self.text, &solid, center, half), "mesh")
            }
            3 => (self.lathe(center, half, true), "lathe"),
            4 => (self.height_field(center, half, true), "height field"),
            5 => {
                let normal = self.direction();
                (shapes::tilted_rectangle(center, normal, half * 1.3), "plate")
            }
            _ => match self.stream.index(2) {
                0 => (self.lathe(center, half, false), "open lathe"),
                _ => (self.height_field(center, half, false), "open height field"),
            },
        }
    }

    pub(super) fn lathe(&mut self, center: DVec3, half: f64, is_closed: bool) -> Value {
        let axis = match self.stream.index(3) {
            0 => DVec3::Y,
            1 => DVec3::X,
            _ => self.direction(),
        };
        // Within the ball of radius `half`, whatever the axis.
        let (r, h) = (0.7 * half, 0.7 * half);
        let closed: &[&[(f64, f64)]] = &[
            &[(0.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 1.0)],
            &[(0.0, -1.0), (1.0, -1.0), (0.0, 1.0)],
            &[(0.0, -1.0), (0.9, -0.5), (0.4, 0.2), (0.7, 1.0), (0.0, 1.0)],
            &[(0.4, -0.4), (1.0, -0.4), (1.0, 0.4), (0.4, 0.4), (0.4, -0.4)],
        ];
        let open: &[&[(f64, f64)]] =
            &[&[(1.0, -1.0), (1.0, 1.0)], &[(0.3, -1.0), (0.8, 0.0), (0.5, 1.0)], &[(0.0, -1.0), (1.0, 0.5)]];
        let from = if is_closed { closed } else { open };
        let profile = from[self.stream.index(from.len())];
        let rings = profile.iter().map(|(x, y)| array(&[short(x * r), short(y * h)])).collect();
        let smooth = self.pick(&[(1i64, 0.7), (3, 0.3)]);
        table([(
            "lathe",
            table([
                ("base", array(&center.to_array())),
                ("axis", array(&axis.to_array())),
                ("profile", Value::Array(rings)),
                ("smooth", Value::Integer(smooth)),
            ]),
        )])
    }

    fn height_field(&mut self, center: DVec3, half: f64, is_closed: bool) -> Value {
        let cells = 1 + self.stream.index(4);
        let rows = (0..=cells)
            .map(|_| {
                let row: Vec<f64> = (0..=cells).map(|_| short(self.within(-0.3, 0.3) * half)).collect();
                array(&row)
            })
            .collect();
        let heights = if self.chance(0.5) {
            table([("rows", Value::Array(rows))])
        } else {
            let (seed, wavelength) = (self.stream.index(1000) as i64, short(half * self.within(0.5, 2.0)));
            table([(
                "waves",
                table([
                    ("seed", Value::Integer(seed)),
                    ("count", Value::Integer(4)),
                    ("wavelength", Value::Float(wavelength)),
                    ("rms", Value::Float(short(0.1 * half))),
                ]),
            )])
        };
        let cells = Value::Array(vec![Value::Integer(cells as i64); 2]);
        let mut keys = vec![
            ("corner", array(&[center.z - half, center.x - half])),
            ("size", array(&[2.0 * half, 2.0 * half])),
            ("cells", cells),
            ("up", Value::String("y".into())),
            ("level", Value::Float(center.y)),
            ("heights", heights),
        ];
        if is_closed {
            keys.push(("floor", Value::Float(center.y - half)));
        }
        let keys = keys.into_iter().map(|(key, value)| (key.to_string(), value)).collect();
        table([("height-field", Value::Table(keys))])
    }

    fn body(&mut self, shape: Value, name: &str, kind: Kind, center: DVec3, half: f64) {
        let surface = match kind {
            Kind::Diffuse => {
                let texture = self.texture(0.1, 0.9, name == "plate");
                table([("lambertian", table([("reflectance", texture)]))])
            }
            Kind::Mirror => table([("mirror", table([("reflectance", self.spectrum(0.3, 1.0))]))]),
            Kind::Black => Value::String("black".into()),
            Kind::Filter => {
                let texture = self.texture(0.1, 1.0, name == "plate");
                table([("filter", table([("transmittance", texture)]))])
            }
            Kind::Glass => {
                let inside = self.interior("surroundings");
                table([("dielectric", table([("inside", Value::String(inside.clone()))]))])
            }
        };
        let word = match kind {
            Kind::Diffuse => "diffuse",
            Kind::Mirror => "mirror",
            Kind::Black => "black",
            Kind::Filter => "filter",
            Kind::Glass => "glass",
        };
        self.say(format!("{word} {name}"));
        self.specular |= matches!(kind, Kind::Mirror | Kind::Glass);
        let inside = surface
            .get("dielectric")
            .and_then(|d| d.get("inside"))
            .and_then(Value::as_str)
            .map(ToString::to_string);
        self.object(shape, surface);
        let Some(inside) = inside else { return };
        if name != "ball" && name != "block" {
            return;
        }
        // Something inside, away from the boundary.
        let inner = short(half * self.within(0.3, 0.55));
        match self.pick(&[(0, 0.5), (1, 0.25), (2, 0.15), (3, 0.1)]) {
            0 => {}
            1 => {
                let second = self.interior(&inside);
                let names = [("inside", Value::String(second)), ("outside", Value::String(inside))];
                self.object(shapes::sphere(center, inner), table([("dielectric", table(names))]));
                self.say("glass within");
            }
            2 => {
                let texture = self.spectrum(0.1, 0.9);
                let surface = table([("lambertian", table([("reflectance", texture)]))]);
                self.object(shapes::sphere(center, inner), surface);
                self.say("diffuse ball within");
            }
            _ => {
                let radiance = self.tinted(short(1.0 / (inner * inner)));
                let light = table([("shape", shapes::sphere(center, inner)), ("radiance", radiance)]);
                self.text.parts_mut("lights").push(table([("area", light)]));
                self.say("lamp within");
            }
        }
    }

    /// A new interior, clear or filled; its name.
    pub(super) fn interior(&mut self, outside: &str) -> String {
        let name = format!("glass{}", self.text.parts("interiors").len());
        let index =
            if self.chance(0.15) && outside == "surroundings" { 1.0 } else { short(self.within(1.05, 2.0)) };
        let mut keys = toml::Table::new();
        keys.insert("name".into(), Value::String(name.clone()));
        keys.insert("index".into(), Value::Float(index));
        if index == 1.0 {
            self.say("index-matched");
        }
        if self.chance(0.4) {
            let medium = self.medium(0.5, DVec3::splat(-1.0), DVec3::ONE, false);
            keys.extend(medium);
            self.say("filled");
        }
        self.text.parts_mut("interiors").push(Value::Table(keys));
        name
    }
}
