//! Lights of every kind, over the bodies or beside them.

use super::super::shapes;
use super::super::text::{array, table};
use super::{Pen, Setting, rounded, short};
use glam::DVec3;
use toml::Value;

impl Pen {
    pub(super) fn lights(&mut self) {
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
                let (at, dir) = self.aimed(at, 0.4);
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
                let (at, dir) = self.aimed(at, 0.5);
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

    /// Downwards from a place over the bodies, or across from one beside them.
    fn aimed(&mut self, at: DVec3, spread: f64) -> (DVec3, [f64; 3]) {
        let [a, b] = [self.within(-spread, spread), self.within(-spread, spread)];
        match self.pick(&[(0, 0.6), (1, 0.15), (-1, 0.15), (2, 0.1)]) {
            0 => (at, rounded(DVec3::new(a, -1.0, b))),
            // From behind, towards the eye or past it.
            2 => (DVec3::new(at.x, 0.55, -0.72), rounded(DVec3::new(a, b - 0.3, 1.0))),
            side => {
                self.say("from the side");
                let side = f64::from(side);
                (DVec3::new(0.72 * side, 0.55, at.z), rounded(DVec3::new(-side, a - 0.3, b)))
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
}
