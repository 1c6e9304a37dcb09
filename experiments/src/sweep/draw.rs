//! Scenes drawn by chance: bodies on a floor, in a room or in the open, with media, glass, lights and a camera.
//!
//! A scene is made in a world two units wide, y upwards, then turned, rescaled and moved as a whole. Bodies have places of
//! their own, so that glass meets nothing but what was put into it; opaque ones stand on the floor, lean against a wall or on
//! each other with faces that coincide.

use super::motion::Motion;
use super::shapes;
use super::text::{SceneText, array, table};
use glam::DVec3;
use toml::Value;
use turbid::math::{exp, ln, sin_cos};
use turbid::rng::{Purpose, Stream};

/// A drawn scene.
#[derive(Debug, Clone)]
pub struct Drawn {
    /// As text.
    pub text: SceneText,
    /// What is in it, in a few words.
    pub what: String,
}

/// Where bodies may stand: columns of the floor, each with a lower and an upper place.
const COLUMNS: [(f64, f64); 4] = [(-0.42, -0.42), (0.42, -0.42), (-0.42, 0.42), (0.42, 0.42)];

/// The scene of a seed; `attempt` counts those before it that were refused.
pub fn draw(seed: u64, attempt: u64) -> Drawn {
    let mut pen = Pen {
        stream: Stream::new(seed, Purpose::Synthetic, attempt, 0),
        text: SceneText::default(),
        what: Vec::new(),
        setting: Setting::Open,
        is_tank: false,
        specular: false,
        has_diffuse: false,
    };
    pen.scene();
    Drawn { text: pen.text, what: pen.what.join(", ") }
}

/// What is about the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Setting {
    Open,
    Floor,
    Corner,
    /// A cuboid seen from inside.
    Room,
    /// Six rectangles.
    Walls,
    /// A sphere seen from inside.
    Ball,
    /// A mesh seen from inside.
    MeshRoom,
}

impl Setting {
    fn is_closed(self) -> bool {
        matches!(self, Setting::Room | Setting::Walls | Setting::Ball | Setting::MeshRoom)
    }

    fn has_floor(self) -> bool {
        self != Setting::Open && self != Setting::Ball
    }
}

struct Pen {
    stream: Stream,
    text: SceneText,
    what: Vec<String>,
    setting: Setting,
    /// Whether all of it stands in a dielectric body.
    is_tank: bool,
    specular: bool,
    /// Whether something is to be seen.
    has_diffuse: bool,
}

impl Pen {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.stream.unit()
    }

    fn log_within(&mut self, low: f64, high: f64) -> f64 {
        exp(self.within(ln(low), ln(high)))
    }

    fn chance(&mut self, p: f64) -> bool {
        self.stream.unit() < p
    }

    fn pick<T: Copy>(&mut self, from: &[(T, f64)]) -> T {
        let total: f64 = from.iter().map(|(_, weight)| weight).sum();
        let mut left = self.stream.unit() * total;
        for (value, weight) in from {
            if left < *weight {
                return *value;
            }
            left -= weight;
        }
        from[from.len() - 1].0
    }

    /// Uniform on the sphere.
    fn direction(&mut self) -> DVec3 {
        let z = self.within(-1.0, 1.0);
        let (sin, cos) = sin_cos(self.within(0.0, std::f64::consts::TAU));
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }

    /// Rounded to five digits, so that a scene can be read; the same for all channels, or one a channel.
    fn spectrum(&mut self, low: f64, high: f64) -> Value {
        if self.chance(0.4) {
            return Value::Float(short(self.within(low, high)));
        }
        let all: [f64; 3] = std::array::from_fn(|_| short(self.within(low, high)));
        array(&all)
    }

    /// A spectrum about 1, times a factor.
    fn tinted(&mut self, factor: f64) -> Value {
        if self.chance(0.4) {
            return Value::Float(short(factor));
        }
        let all: [f64; 3] = std::array::from_fn(|_| short(factor * self.within(0.3, 1.5)));
        array(&all)
    }

    fn say(&mut self, what: impl Into<String>) {
        self.what.push(what.into());
    }

    fn object(&mut self, shape: Value, surface: Value) {
        self.text.parts_mut("objects").push(table([("shape", shape), ("surface", surface)]));
    }

    fn scene(&mut self) {
        if self.chance(0.02) {
            return self.slab_with_cell();
        }
        self.setting = self.pick(&[
            (Setting::Open, 0.2),
            (Setting::Floor, 0.2),
            (Setting::Corner, 0.14),
            (Setting::Room, 0.18),
            (Setting::Walls, 0.12),
            (Setting::Ball, 0.08),
            (Setting::MeshRoom, 0.08),
        ]);
        self.say(format!("{:?}", self.setting).to_lowercase());
        self.surroundings();
        self.is_tank = self.chance(0.06);
        // Where nothing about the bodies scatters, one of them does.
        let none = if self.has_diffuse { 0.08 } else { 0.0 };
        let bodies = self.pick(&[(0usize, none), (1, 0.37), (2, 0.35), (3, 0.2)]);
        let mut columns = COLUMNS.to_vec();
        for _ in 0..bodies {
            let index = self.stream.index(columns.len());
            let column = columns.swap_remove(index);
            self.column(column);
        }
        if self.chance(0.6) {
            self.media();
        }
        self.lights();
        let camera = self.camera();
        if self.is_tank {
            self.tank();
        }
        self.text.table.insert("camera".into(), camera);
        self.moved();
    }

    /// Walls and floor.
    fn surroundings(&mut self) {
        let surface = self.wall();
        let rectangle = |corner: [f64; 3], u: [f64; 3], v: [f64; 3]| shapes::rectangle(corner, u, v);
        let floor = rectangle([-1.0, -1.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0]);
        let back = rectangle([-1.0, -1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
        let left = rectangle([-1.0, -1.0, -1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]);
        match self.setting {
            Setting::Open => {}
            Setting::Floor => self.object(floor, surface),
            Setting::Corner => {
                for shape in [floor, back, left] {
                    let surface = self.wall();
                    self.object(shape, surface);
                }
            }
            Setting::Room => self.object(shapes::cuboid([-1.0; 3], [1.0; 3]), surface),
            Setting::Walls => {
                let right = rectangle([1.0, -1.0, -1.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0]);
                let front = rectangle([-1.0, -1.0, 1.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]);
                let top = rectangle([-1.0, 1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]);
                for shape in [floor, back, left, right, front, top] {
                    let surface = self.wall();
                    self.object(shape, surface);
                }
            }
            Setting::Ball => self.object(shapes::sphere(DVec3::ZERO, 1.75), surface),
            Setting::MeshRoom => {
                let shape = shapes::mesh(&mut self.text, &shapes::block(), DVec3::ZERO, 1.0);
                self.object(shape, surface);
            }
        }
    }

    fn wall(&mut self) -> Value {
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

    /// A body in the lower place of a column, and perhaps one above it.
    fn column(&mut self, (x, z): (f64, f64)) {
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

    fn lathe(&mut self, center: DVec3, half: f64, is_closed: bool) -> Value {
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
    fn interior(&mut self, outside: &str) -> String {
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

    /// The keys of a medium in a box of about this size.
    fn medium(&mut self, size: f64, min: DVec3, max: DVec3, may_vary: bool) -> toml::Table {
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
                let count: [usize; 3] = std::array::from_fn(|_| 1 + self.stream.index(5));
                let number = count.iter().product();
                let values: Vec<f32> = (0..number).map(|_| self.within(0.0, 2.0) as f32).collect();
                let name = format!("grid{}.vol", self.text.files.len());
                if let Ok(grid) = turbid::medium::Grid::new((DVec3::ZERO, DVec3::ONE), count, 1, values) {
                    self.text.files.insert(name.clone(), grid.to_bytes());
                }
                self.say("grid");
                let corners = [("min", array(&min.to_array())), ("max", array(&max.to_array()))];
                let [low, high] = corners;
                table([("grid", table([("file", Value::String(name)), low, high]))])
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

    /// Regions: over all, a part, or several that overlap.
    fn media(&mut self) {
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

    fn lights(&mut self) {
        let count = self.pick(&[(1, 0.6), (2, 0.3), (3, 0.1)]);
        // Over the bodies: in the middle, or in two corners.
        let mut places =
            vec![DVec3::new(0.0, 0.75, 0.0), DVec3::new(-0.6, 0.75, -0.55), DVec3::new(0.6, 0.75, -0.55)];
        for _ in 0..count {
            let at = places.swap_remove(self.stream.index(places.len()));
            let light = self.light(at);
            self.text.parts_mut("lights").push(light);
        }
    }

    fn light(&mut self, at: DVec3) -> Value {
        // What has no extent is out of reach of paths where glass or mirrors are: less of it there.
        let delta = if self.specular { 0.03 } else { 0.12 };
        let open = if self.setting.is_closed() || self.is_tank { 0.0 } else { 0.12 };
        let power = short(self.log_within(2.0, 12.0));
        match self.pick(&[
            (0, 0.5),
            (1, delta),
            (2, delta),
            (3, delta),
            (4, open),
            (5, 0.7 * open),
            (6, 0.08),
            (7, if self.is_tank { 0.0 } else { 0.06 }),
        ]) {
            0 => self.area(at, power),
            1 => {
                self.say("point light");
                table([(
                    "point",
                    table([("position", array(&at.to_array())), ("power", self.tinted(power))]),
                )])
            }
            2 => {
                let full = short(self.within(10.0, 60.0));
                let edge = short(full + self.within(0.0, 30.0));
                let dir = rounded(DVec3::new(self.within(-0.4, 0.4), -1.0, self.within(-0.4, 0.4)));
                self.say("spot");
                table([(
                    "spot",
                    table([
                        ("position", array(&at.to_array())),
                        ("dir", array(&dir)),
                        ("full_angle", Value::Float(full)),
                        ("edge_angle", Value::Float(edge)),
                        ("power", self.tinted(power)),
                    ]),
                )])
            }
            3 => {
                let dir = rounded(DVec3::new(self.within(-0.5, 0.5), -1.0, self.within(-0.5, 0.5)));
                let half = short(self.within(0.08, 0.25));
                let section = match self.stream.index(2) {
                    0 => table([(
                        "disc",
                        table([("center", array(&at.to_array())), ("radius", Value::Float(half))]),
                    )]),
                    _ => {
                        let (u, v) = DVec3::from(dir).normalize().any_orthonormal_pair();
                        let corner = at - (u + v) * half;
                        let (u, v) = (u * (2.0 * half), v * (2.0 * half));
                        shapes::rectangle(corner.to_array(), u.to_array(), v.to_array())
                    }
                };
                let irradiance = self.tinted(short(power / (4.0 * half * half)));
                self.say("beam");
                table([(
                    "beam",
                    table([("dir", array(&dir)), ("irradiance", irradiance), ("section", section)]),
                )])
            }
            4 => {
                let dir = DVec3::new(self.within(-0.5, 0.5), -1.0, self.within(-0.5, 0.5));
                let dir = if self.setting == Setting::Corner { DVec3::new(-0.4, -1.0, -0.4) } else { dir };
                let is_delta = self.chance(if self.specular { 0.05 } else { 0.25 });
                let radius = if is_delta {
                    0.0
                } else {
                    short(if self.specular { self.within(10.0, 30.0) } else { self.within(2.0, 25.0) })
                };
                let mut keys = toml::Table::new();
                keys.insert("dir".into(), array(&rounded(dir)));
                let irradiance = self.tinted(short(0.5 * power));
                keys.insert("irradiance".into(), irradiance);
                keys.insert("angular_radius".into(), Value::Float(radius));
                if self.chance(0.4) {
                    let (x, z) = (short(self.within(-0.8, 0.0)), short(self.within(-0.8, 0.0)));
                    let portal = shapes::rectangle([x, 0.98, z], [0.9, 0.0, 0.0], [0.0, 0.0, 0.9]);
                    keys.insert("portal".into(), portal);
                    self.say("portal");
                }
                self.say("sun");
                table([("sun", Value::Table(keys))])
            }
            5 => {
                let (shape, radiance) = if self.chance(0.75) {
                    (shapes::sphere(DVec3::ZERO, 5.0), 0.1 * power)
                } else {
                    (shapes::cuboid([-1.2; 3], [1.2; 3]), 0.1 * power)
                };
                self.say("isotropic light");
                let radiance = self.tinted(short(radiance));
                let faces = Value::String("both".into());
                table([("isotropic", table([("shape", shape), ("faces", faces), ("radiance", radiance)]))])
            }
            6 => {
                let half = short(self.within(0.08, 0.2));
                let shape = match self.stream.index(2) {
                    0 => shapes::sphere(at, half),
                    _ => shapes::cuboid((at - half).to_array(), (at + half).to_array()),
                };
                let density = self.tinted(short(power / (6.0 * half * half * half)));
                self.say("volume source");
                table([("volume-source", table([("shape", shape), ("density", density)]))])
            }
            _ => {
                // The whole ceiling, close to a wall where there is one.
                let shape = shapes::rectangle([-0.9, 0.998, -0.9], [1.8, 0.0, 0.0], [0.0, 0.0, 1.8]);
                self.say("ceiling");
                table([("area", table([("shape", shape), ("radiance", self.tinted(short(0.1 * power)))]))])
            }
        }
    }

    fn area(&mut self, at: DVec3, power: f64) -> Value {
        // Large enough that paths find them by mirrors and through glass.
        let half = short(if self.specular { self.within(0.16, 0.24) } else { self.within(0.1, 0.2) });
        let (shape, name) = match self.pick(&[(0, 0.35), (1, 0.35), (2, 0.15), (3, 0.08), (4, 0.07)]) {
            0 => (shapes::sphere(at, half), "ball lamp"),
            1 => {
                let size = 2.0 * half;
                let corner = [at.x - half, at.y, at.z - half];
                // u x v is downwards.
                (shapes::rectangle(corner, [size, 0.0, 0.0], [0.0, 0.0, size]), "panel")
            }
            2 => (shapes::cuboid((at - half).to_array(), (at + half).to_array()), "block lamp"),
            3 => (shapes::mesh(&mut self.text, &shapes::octahedron(), at, half), "mesh lamp"),
            _ => (self.lathe(at, half, true), "lathe lamp"),
        };
        self.say(name);
        let radiance = self.tinted(short(power / (40.0 * half * half)));
        table([("area", table([("shape", shape), ("radiance", radiance)]))])
    }

    fn camera(&mut self) -> Value {
        let target = [self.within(-0.2, 0.2), self.within(-0.6, -0.1), self.within(-0.2, 0.2)].map(short);
        let is_inside = self.setting.is_closed() || self.is_tank || self.chance(0.35);
        let (position, fov) = if is_inside {
            let x = if self.chance(0.5) { self.within(-0.3, 0.3) } else { 0.0 };
            ([x, self.within(-0.4, 0.5), 0.93].map(short), self.within(60.0, 95.0))
        } else {
            let away = DVec3::new(self.within(-1.0, 1.0), self.within(-0.1, 0.8), 1.0).normalize();
            ((away * self.within(2.4, 3.6)).to_array().map(short), self.within(40.0, 65.0))
        };
        // Nothing is seen straight from there, so that paths must reach all light.
        let kinds = ["point", "spot", "beam"];
        let has_delta =
            self.text.parts("lights").iter().any(|l| kinds.iter().any(|kind| l.get(kind).is_some()));
        if !self.is_tank && !has_delta && self.chance(0.04) {
            // An eye of glass.
            let inside = self.interior("surroundings");
            let radius = 0.05;
            let surface = table([("dielectric", table([("inside", Value::String(inside))]))]);
            self.object(shapes::sphere(DVec3::from(position), radius), surface);
            self.say("camera in glass");
        }
        let filter = if self.chance(0.3) { "tent" } else { "box" };
        let mut keys = toml::Table::new();
        keys.insert("position".into(), array(&position));
        keys.insert("look_at".into(), array(&target));
        keys.insert("fov".into(), Value::Float(short(fov)));
        keys.insert("width".into(), Value::Integer(16));
        keys.insert("height".into(), Value::Integer(12));
        if filter == "tent" {
            keys.insert("filter".into(), Value::String(filter.into()));
        }
        Value::Table(keys)
    }

    /// A dielectric body about all there is, camera and lights.
    fn tank(&mut self) {
        let name = self.interior("surroundings");
        let shape = match self.stream.index(2) {
            0 => shapes::sphere(DVec3::ZERO, 2.6),
            _ => shapes::cuboid([-1.6; 3], [1.6; 3]),
        };
        // What was in the surroundings is in the tank now.
        for object in self.text.parts_mut("objects") {
            let surface = object.get_mut("surface").and_then(|s| s.get_mut("dielectric"));
            if let Some(names) = surface.and_then(Value::as_table_mut) {
                names.entry("outside").or_insert_with(|| Value::String(name.clone()));
            }
        }
        let surface = table([("dielectric", table([("inside", Value::String(name))]))]);
        self.object(shape, surface);
        self.specular = true;
        self.say("all in a tank");
    }

    /// Turned, rescaled and moved as a whole.
    fn moved(&mut self) {
        let turn = if self.chance(0.5) { Motion::rotation(self.stream.index(24)) } else { Motion::NONE.turn };
        let scale = if self.chance(0.4) { short(self.log_within(1e-3, 1e3)) } else { 1.0 };
        let offset = if self.chance(0.3) {
            self.direction() * self.log_within(0.1, 10.0) * scale
        } else {
            DVec3::ZERO
        };
        let whole = Motion { turn, scale, offset };
        let straight = Motion { turn: Motion::NONE.turn, ..whole };
        // What cannot be turned stays upright.
        let moved = whole.of(&self.text).or_else(|_| straight.of(&self.text));
        if let Ok(moved) = moved {
            self.text = moved.without_unused();
            if scale != 1.0 {
                self.say(format!("scale {scale}"));
            }
        }
    }

    /// An unbounded slab, which paths alone can make pictures of.
    fn slab_with_cell(&mut self) {
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

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Diffuse,
    Mirror,
    Glass,
    Filter,
    Black,
}

/// Three digits: a scene can be read, and numbers like these are what people write.
pub(super) fn short(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { format!("{x:.2e}").parse().unwrap_or(x) }
}

fn rounded(v: DVec3) -> [f64; 3] {
    v.to_array().map(short)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Most scenes are valid, each is the same whenever it is drawn, and every part is there.
    #[test]
    fn scenes_are_valid_and_various() {
        let mut words = std::collections::BTreeSet::new();
        let mut refused = 0;
        for seed in 0..300 {
            let drawn = draw(seed, 0);
            assert_eq!(drawn.text, draw(seed, 0).text);
            refused += u32::from(drawn.text.scene().is_err());
            let text = drawn.text.toml();
            words.extend(
                text.split(|c: char| !c.is_alphanumeric() && c != '-' && c != '_').map(str::to_string),
            );
        }
        assert!(refused < 30, "{refused} of 300");
        for word in [
            "sphere",
            "rectangle",
            "cuboid",
            "mesh",
            "lathe",
            "height-field",
            "slab",
            "cell",
            "lambertian",
            "mirror",
            "dielectric",
            "filter",
            "black",
            "checker",
            "wood",
            "grid",
            "cloud",
            "height-fog",
            "emission",
            "rayleigh",
            "schlick",
            "two-term",
            "table",
            "g",
            "area",
            "point",
            "spot",
            "sun",
            "portal",
            "beam",
            "disc",
            "isotropic",
            "volume-source",
            "tent",
            "outside",
        ] {
            assert!(words.contains(word), "no {word}");
        }
    }
}
