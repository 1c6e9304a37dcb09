//! Scenes drawn by chance: bodies on a floor, in a room or in the open, with media, glass, lights and a camera.
//!
//! A scene is made in a world two units wide, y upwards, then turned, rescaled and moved as a whole. Bodies have places of
//! their own, so that glass meets nothing but what was put into it; opaque ones stand on the floor, lean against a wall or on
//! each other with faces that coincide.

mod bodies;
mod lights;
mod media;

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
                // A wall as thick as half a scene, without end.
                let solid = [("top", Value::Float(-1.5)), ("thickness", Value::Float(0.5))];
                let is_slab = self.chance(0.15);
                if is_slab {
                    self.say("slab wall");
                }
                let back = if is_slab { table([("slab", table(solid))]) } else { back };
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
            words.extend(drawn.what.split(", ").map(str::to_string));
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
            "image",
            "albedo_grid",
            "slab wall",
            "from the side",
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
