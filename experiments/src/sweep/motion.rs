//! Scenes turned, mirrored, moved and rescaled: the picture stays the same.

use super::text::{SceneText, array, choice, number, point, table};
use glam::{DMat3, DVec2, DVec3};
use serde::Deserialize;
use toml::{Table, Value};
use turbid::geometry::Waves;
use turbid::medium::Grid;

/// p becomes s R p + t, with R a permutation of the axes with signs, so that cuboids stay cuboids.
///
/// Coefficients are divided by s, powers multiplied by s^2, power and emission by volume divided by s: radiance stays as
/// it is, everywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Rotation or reflection.
    pub turn: DMat3,
    /// Factor of all lengths.
    pub scale: f64,
    /// What is added to all points \[L\].
    pub offset: DVec3,
}

/// What cannot be moved so, in words.
type Moved<T> = Result<T, String>;

fn absent(what: &str) -> String {
    format!("a scene file without {what}")
}

impl Motion {
    /// Nothing changes.
    pub const NONE: Motion = Motion { turn: DMat3::IDENTITY, scale: 1.0, offset: DVec3::ZERO };

    /// The rotation of a number: 24 turn a cube into itself.
    pub fn rotation(number: usize) -> DMat3 {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let (a, sign) = (number % 3, if (number / 3).is_multiple_of(2) { 1.0 } else { -1.0 });
        let rest = [(a + 1) % 3, (a + 2) % 3];
        let second = [axes[rest[0]], axes[rest[1]], -axes[rest[0]], -axes[rest[1]]][number / 6 % 4];
        let first = axes[a] * sign;
        DMat3::from_cols(first, second, first.cross(second))
    }

    /// Whether left and right are exchanged.
    pub fn is_mirror(&self) -> bool {
        self.turn.determinant() < 0.0
    }

    fn is_turned(&self) -> bool {
        self.turn != DMat3::IDENTITY
    }

    fn place(&self, p: [f64; 3]) -> [f64; 3] {
        (self.turn * DVec3::from(p) * self.scale + self.offset).to_array()
    }

    fn side(&self, v: [f64; 3]) -> [f64; 3] {
        (self.turn * DVec3::from(v) * self.scale).to_array()
    }

    fn dir(&self, v: [f64; 3]) -> [f64; 3] {
        (self.turn * DVec3::from(v)).to_array()
    }

    /// The same scene elsewhere.
    ///
    /// # Errors
    /// what a part of the scene cannot be: a cloud's noise is not turned, a height field has its up side
    pub fn of(&self, text: &SceneText) -> Moved<SceneText> {
        let mut moved = text.clone();
        if let Some(cell) = moved.table.get_mut("cell") {
            *cell = Value::Float(number(cell).ok_or_else(|| absent("cell"))? * self.scale);
        }
        for kind in ["regions", "interiors", "objects", "lights"] {
            for i in 0..text.parts(kind).len() {
                let mut part = text.parts(kind)[i].clone();
                let entries = part.as_table_mut().ok_or_else(|| absent("tables"))?;
                match kind {
                    "lights" => self.light(entries, &mut moved)?,
                    _ => self.part(entries, &mut moved)?,
                }
                moved.parts_mut(kind)[i] = part;
            }
        }
        if let Some(camera) = moved.table.get_mut("camera").and_then(Value::as_table_mut) {
            self.each(camera, &["position", "look_at"], |p| self.place(p))?;
            camera.entry("up").or_insert_with(|| array(&[0.0, 1.0, 0.0]));
            self.each(camera, &["up"], |p| self.dir(p))?;
        }
        Ok(moved)
    }

    /// Changes points or directions of these keys, where they are.
    fn each(&self, table: &mut Table, keys: &[&str], change: impl Fn([f64; 3]) -> [f64; 3]) -> Moved<()> {
        for key in keys {
            if let Some(value) = table.get_mut(*key) {
                *value = array(&change(point(value).ok_or_else(|| absent(key))?));
            }
        }
        Ok(())
    }

    /// Changes numbers or spectra of these keys by a factor, where they are.
    fn times(table: &mut Table, keys: &[&str], factor: f64) -> Moved<()> {
        for key in keys {
            if let Some(value) = table.get_mut(*key) {
                *value = match &*value {
                    Value::Array(all) => {
                        let all: Option<Vec<f64>> = all.iter().map(|v| Some(number(v)? * factor)).collect();
                        array(&all.ok_or_else(|| absent(key))?)
                    }
                    other => Value::Float(number(other).ok_or_else(|| absent(key))? * factor),
                };
            }
        }
        Ok(())
    }

    /// A region, an interior or an object.
    fn part(&self, part: &mut Table, scene: &mut SceneText) -> Moved<()> {
        Self::times(part, &["sigma_t", "emission", "emission_by_density"], 1.0 / self.scale)?;
        if let Some(density) = part.get_mut("density") {
            *density = self.density(density, scene)?;
        }
        if let Some(grid) = part.get_mut("albedo_grid").and_then(Value::as_table_mut) {
            self.grid(grid, scene)?;
        }
        let is_rectangle = matches!(part.get("shape").and_then(choice), Some(("rectangle", _)));
        if let Some(shape) = part.get_mut("shape") {
            *shape = self.shape(shape, scene)?;
        }
        if let Some((_, surface)) =
            part.get_mut("surface").and_then(Value::as_table_mut).and_then(|t| t.iter_mut().next())
            && let Some(surface) = surface.as_table_mut()
        {
            for key in ["reflectance", "transmittance"] {
                if let Some(texture) = surface.get_mut(key).and_then(Value::as_table_mut) {
                    self.texture(texture, is_rectangle)?;
                }
            }
        }
        Ok(())
    }

    fn texture(&self, texture: &mut Table, is_rectangle: bool) -> Moved<()> {
        if let Some(wood) = texture.get_mut("wood").and_then(Value::as_table_mut) {
            if self.is_turned() {
                return Err("rings of wood wander by an azimuth that does not turn".into());
            }
            self.each(wood, &["center"], |p| self.place(p))?;
            return Self::times(wood, &["width"], self.scale);
        }
        if !self.is_turned() || (is_rectangle && !self.is_mirror()) {
            return Ok(());
        }
        match texture.get_mut("checker").and_then(Value::as_table_mut).and_then(|c| c.get_mut("tiles")) {
            // A mirrored rectangle has its sides exchanged.
            Some(Value::Array(tiles)) if is_rectangle => {
                tiles.swap(0, 1);
                Ok(())
            }
            _ => Err("a texture over a curved body, or an image, has a beginning that does not turn".into()),
        }
    }

    fn density(&self, density: &Value, scene: &mut SceneText) -> Moved<Value> {
        let (name, keys) = choice(density).ok_or_else(|| absent("a density"))?;
        let mut keys = keys.as_table().ok_or_else(|| absent("a density"))?.clone();
        match name {
            "grid" => self.grid(&mut keys, scene)?,
            "cloud" => {
                if self.is_turned() {
                    return Err("a cloud's noise does not turn".into());
                }
                self.each(&mut keys, &["center"], |p| self.place(p))?;
                self.each(&mut keys, &["radii"], |p| self.side(p))?;
            }
            "height-fog" => {
                let up = DVec3::from(keys.get("up").and_then(point).ok_or_else(|| absent("up"))?).normalize();
                let base = keys.get("base").and_then(number).ok_or_else(|| absent("base"))?;
                let base = base * self.scale + self.offset.dot(self.turn * up);
                keys.insert("base".into(), Value::Float(base));
                self.each(&mut keys, &["up"], |p| self.dir(p))?;
                Self::times(&mut keys, &["scale_height"], self.scale)?;
            }
            other => return Err(format!("a density {other} that the sweep does not know")),
        }
        Ok(table([(name, Value::Table(keys))]))
    }

    /// A grid with its own corners; its file is written anew where axes change.
    fn grid(&self, keys: &mut Table, scene: &mut SceneText) -> Moved<()> {
        let corner = |key: &str| keys.get(key).and_then(point).ok_or_else(|| absent("min and max of a grid"));
        let (a, b) = (DVec3::from(self.place(corner("min")?)), DVec3::from(self.place(corner("max")?)));
        keys.insert("min".into(), array(&a.min(b).to_array()));
        keys.insert("max".into(), array(&a.max(b).to_array()));
        if !self.is_turned() {
            return Ok(());
        }
        let name = keys.get("file").and_then(Value::as_str).ok_or_else(|| absent("file"))?.to_string();
        let bytes = scene.files.get(&name).ok_or_else(|| absent(&name))?;
        let grid = Grid::from_bytes(bytes).map_err(|e| e.to_string())?;
        let turned = self.turned(&grid).map_err(|e| e.to_string())?;
        let name = self.new_name(&name);
        scene.files.insert(name.clone(), turned.to_bytes());
        keys.insert("file".into(), Value::String(name));
        Ok(())
    }

    fn turned(&self, grid: &Grid) -> turbid::Result<Grid> {
        let (count, channels) = (grid.count(), grid.channels());
        // The axis of the old grid that each axis of the new one follows, and whether it runs the same way.
        let follows: [(usize, bool); 3] = std::array::from_fn(|to| {
            let row = self.turn.row(to).to_array();
            let from = (0..3).find(|&from| row[from] != 0.0).unwrap_or(to);
            (from, row[from] > 0.0)
        });
        let new = follows.map(|(from, _)| count[from]);
        let mut values = Vec::with_capacity(grid.values().len());
        for z in 0..new[2] {
            for y in 0..new[1] {
                for x in 0..new[0] {
                    let mut old = [0; 3];
                    for (to, index) in [x, y, z].into_iter().enumerate() {
                        let (from, is_forward) = follows[to];
                        old[from] = if is_forward { index } else { count[from] - 1 - index };
                    }
                    let first = ((old[2] * count[1] + old[1]) * count[0] + old[0]) * channels;
                    values.extend_from_slice(&grid.values()[first..first + channels]);
                }
            }
        }
        Grid::new(grid.corners(), new, channels, values)
    }

    /// A name that says how the file was changed, and that no other change has.
    fn new_name(&self, name: &str) -> String {
        let digits: String = (0..3)
            .flat_map(|row| self.turn.row(row).to_array())
            .map(|x| {
                if x > 0.0 {
                    'p'
                } else if x < 0.0 {
                    'm'
                } else {
                    'o'
                }
            })
            .collect();
        format!("{digits}-{name}")
    }

    fn shape(&self, shape: &Value, scene: &mut SceneText) -> Moved<Value> {
        let (name, keys) = choice(shape).ok_or_else(|| absent("a shape"))?;
        let mut keys = keys.as_table().ok_or_else(|| absent("a shape"))?.clone();
        match name {
            "sphere" => {
                self.each(&mut keys, &["center"], |p| self.place(p))?;
                Self::times(&mut keys, &["radius"], self.scale)?;
            }
            "rectangle" => self.rectangle(&mut keys)?,
            "cuboid" => {
                let corner = |key: &str| keys.get(key).and_then(point).ok_or_else(|| absent(key));
                let (a, b) =
                    (DVec3::from(self.place(corner("min")?)), DVec3::from(self.place(corner("max")?)));
                keys.insert("min".into(), array(&a.min(b).to_array()));
                keys.insert("max".into(), array(&a.max(b).to_array()));
            }
            "slab" => {
                if self.turn * DVec3::Z != DVec3::Z {
                    return Err("a slab lies along z".into());
                }
                let top = keys.get("top").and_then(number).ok_or_else(|| absent("top"))?;
                keys.insert("top".into(), Value::Float(top * self.scale + self.offset.z));
                Self::times(&mut keys, &["thickness"], self.scale)?;
            }
            "mesh" => {
                let at = keys.get("at").and_then(point).unwrap_or_default();
                let scale = keys.get("scale").and_then(number).unwrap_or(1.0);
                keys.insert("at".into(), array(&self.place(at)));
                keys.insert("scale".into(), Value::Float(scale * self.scale));
                if self.is_turned() {
                    let name =
                        keys.get("file").and_then(Value::as_str).ok_or_else(|| absent("file"))?.to_string();
                    let bytes = scene.files.get(&name).ok_or_else(|| absent(&name))?;
                    let turned = self.obj(&String::from_utf8_lossy(bytes))?;
                    let name = self.new_name(&name);
                    scene.files.insert(name.clone(), turned.into_bytes());
                    keys.insert("file".into(), Value::String(name));
                }
            }
            "lathe" => {
                keys.entry("base").or_insert_with(|| array(&[0.0; 3]));
                keys.entry("axis").or_insert_with(|| array(&[0.0, 0.0, 1.0]));
                self.each(&mut keys, &["base"], |p| self.place(p))?;
                self.each(&mut keys, &["axis"], |p| self.dir(p))?;
                for ring in keys.get_mut("profile").and_then(Value::as_array_mut).into_iter().flatten() {
                    self.scaled(ring)?;
                }
            }
            "height-field" => self.height_field(&mut keys)?,
            other => return Err(format!("a shape {other} that the sweep does not know")),
        }
        Ok(table([(name, Value::Table(keys))]))
    }

    /// Numbers of an array times the scale.
    fn scaled(&self, value: &mut Value) -> Moved<()> {
        for x in value.as_array_mut().ok_or_else(|| absent("numbers"))? {
            *x = Value::Float(number(x).ok_or_else(|| absent("numbers"))? * self.scale);
        }
        Ok(())
    }

    /// The front stays the front: where left and right are exchanged, so are the sides.
    fn rectangle(&self, keys: &mut Table) -> Moved<()> {
        self.each(keys, &["corner"], |p| self.place(p))?;
        self.each(keys, &["u", "v"], |p| self.side(p))?;
        if self.is_mirror()
            && let (Some(u), Some(v)) = (keys.get("u").cloned(), keys.get("v").cloned())
        {
            keys.insert("u".into(), v);
            keys.insert("v".into(), u);
        }
        Ok(())
    }

    fn height_field(&self, keys: &mut Table) -> Moved<()> {
        if self.is_turned() {
            return Err("a height field has its up side".into());
        }
        let is_y = keys.get("up").and_then(Value::as_str) == Some("y");
        let [x, y, z] = self.offset.to_array();
        let ([first, second], height) = if is_y { ([z, x], y) } else { ([x, y], z) };
        if self.offset != DVec3::ZERO {
            Self::listed_waves(keys)?;
        }
        let corner = keys.get_mut("corner").ok_or_else(|| absent("corner"))?;
        self.scaled(corner)?;
        if let Some(corner) = corner.as_array_mut() {
            for (value, offset) in corner.iter_mut().zip([first, second]) {
                *value = Value::Float(number(value).unwrap_or(0.0) + offset);
            }
        }
        self.scaled(keys.get_mut("size").ok_or_else(|| absent("size"))?)?;
        for key in ["level", "floor"] {
            let given = keys.get(key).and_then(number);
            if let Some(value) = given.or((key == "level").then_some(0.0)) {
                keys.insert(key.into(), Value::Float(value * self.scale + height));
            }
        }
        let heights =
            keys.get_mut("heights").and_then(Value::as_table_mut).ok_or_else(|| absent("heights"))?;
        for row in heights.get_mut("rows").and_then(Value::as_array_mut).into_iter().flatten() {
            self.scaled(row)?;
        }
        if let Some(waves) = heights.get_mut("waves").and_then(Value::as_table_mut) {
            Self::times(waves, &["wavelength", "rms"], self.scale)?;
        }
        Ok(())
    }

    /// Waves are where they are in the world: those of a field that moves are listed.
    fn listed_waves(keys: &mut Table) -> Moved<()> {
        let file: HeightField = Value::Table(keys.clone()).try_into().map_err(|e| format!("{e}"))?;
        let Heights::Waves { seed, count, wavelength, rms } = file.heights else { return Ok(()) };
        let waves = Waves::new(seed, count, wavelength, rms).map_err(|e| e.to_string())?;
        let [columns, rows] = file.cells;
        let part = |i: usize, of: usize| i as f64 / of as f64;
        let (corner, size) = (DVec2::from(file.corner), DVec2::from(file.size));
        let at = |i: usize, j: usize| corner + size * DVec2::new(part(i, columns), part(j, rows));
        let row = |j: usize| {
            let heights: Vec<f64> = (0..=columns).map(|i| waves.height(at(i, j))).collect();
            array(&heights)
        };
        keys.insert("heights".into(), table([("rows", Value::Array((0..=rows).map(row).collect()))]));
        Ok(())
    }

    /// Vertices turned; faces the other way round where left and right are exchanged.
    fn obj(&self, text: &str) -> Moved<String> {
        let mut turned = String::new();
        for line in text.lines() {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("v") => {
                    let all: Vec<f64> =
                        words.map(|w| w.parse().map_err(|_| absent("numbers"))).collect::<Result<_, _>>()?;
                    let p: [f64; 3] = all.try_into().map_err(|_| absent("three numbers a vertex"))?;
                    let [x, y, z] = self.dir(p);
                    turned.push_str(&format!("v {x} {y} {z}\n"));
                }
                Some("f") if self.is_mirror() => {
                    let corners: Vec<&str> = words.rev().collect();
                    turned.push_str(&format!("f {}\n", corners.join(" ")));
                }
                _ => {
                    turned.push_str(line);
                    turned.push('\n');
                }
            }
        }
        Ok(turned)
    }

    fn light(&self, light: &mut Table, scene: &mut SceneText) -> Moved<()> {
        let name = light.keys().next().cloned().ok_or_else(|| absent("a light"))?;
        let keys = light.get_mut(&name).and_then(Value::as_table_mut).ok_or_else(|| absent("a light"))?;
        if let Some(shape) = keys.get_mut("shape") {
            *shape = self.shape(shape, scene)?;
        }
        self.each(keys, &["position"], |p| self.place(p))?;
        self.each(keys, &["dir"], |p| self.dir(p))?;
        match name.as_str() {
            "point" | "spot" => Self::times(keys, &["power"], self.scale * self.scale),
            "volume-source" => Self::times(keys, &["density"], 1.0 / self.scale),
            "area" | "isotropic" => Ok(()),
            "sun" | "beam" => {
                for key in ["portal", "section"] {
                    let Some(inner) = keys.get_mut(key).and_then(Value::as_table_mut) else { continue };
                    if let Some(rectangle) = inner.get_mut("rectangle").and_then(Value::as_table_mut) {
                        self.rectangle(rectangle)?;
                    }
                    if let Some(disc) = inner.get_mut("disc").and_then(Value::as_table_mut) {
                        self.each(disc, &["center"], |p| self.place(p))?;
                        Self::times(disc, &["radius"], self.scale)?;
                    }
                }
                Ok(())
            }
            other => Err(format!("a light {other} that the sweep does not know")),
        }
    }
}

/// Where a height field is, and its heights.
#[derive(Deserialize)]
struct HeightField {
    corner: [f64; 2],
    size: [f64; 2],
    cells: [usize; 2],
    heights: Heights,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Heights {
    Rows(serde::de::IgnoredAny),
    Waves { seed: u64, count: u32, wavelength: f64, rms: f64 },
}

#[cfg(test)]
mod tests {
    use super::super::draw::draw;
    use super::*;
    use turbid::geometry::Shape;

    /// Every triangle, and the ball about every other body, is where the motion puts it.
    #[test]
    fn bodies_move_with_the_scene() {
        let motion = Motion { turn: Motion::rotation(0), scale: 2.5, offset: DVec3::new(0.3, -0.7, 1.9) };
        let mut moved_triangles = 0;
        for seed in 0..200 {
            let text = draw(seed, 0).text;
            let (Ok(scene), Ok(other)) = (text.scene(), motion.of(&text)) else { continue };
            let other = other.scene().unwrap();
            let place = |p: DVec3| DVec3::from(motion.place(p.to_array()));
            let near = |a: DVec3, b: DVec3| assert!(a.distance(b) < 1e-9 * b.length().max(1.0), "{seed}");
            for (a, b) in scene.objects().iter().zip(other.objects()) {
                if let (Shape::Mesh(a), Shape::Mesh(b)) = (&a.shape, &b.shape) {
                    for index in 0..a.len() as u32 {
                        a.triangle(index)
                            .into_iter()
                            .zip(b.triangle(index))
                            .for_each(|(a, b)| near(b, place(a)));
                        moved_triangles += 1;
                    }
                } else if let (Some(a), Some(b)) = (a.shape.bounds(), b.shape.bounds()) {
                    near(b.0, place(a.0));
                }
            }
        }
        assert!(moved_triangles > 1000, "{moved_triangles}");
    }

    /// The 24 rotations are rotations, and different.
    #[test]
    fn rotations_of_a_cube() {
        let all: Vec<DMat3> = (0..24).map(Motion::rotation).collect();
        for (i, a) in all.iter().enumerate() {
            assert_eq!(a.determinant(), 1.0);
            assert!(all[..i].iter().all(|b| a != b), "{i}");
        }
    }

    /// There and back again is the same scene, file by file.
    #[test]
    fn a_motion_and_its_inverse_are_nothing() {
        let grid = Grid::new((DVec3::ZERO, DVec3::ONE), [2, 3, 4], 1, (0..24).map(|i| i as f32).collect());
        let mesh = "v 8 1 2\nv 3 4 5\nv 6 7 9\nf 1 2 3\n".to_string();
        let table: Table = toml::from_str(
            "camera = { position = [1.0, 2.0, 3.0], look_at = [4.0, 5.0, 6.0], up = [0.0, 1.0, 0.0] }\n\
             regions = [{ shape = { cuboid = { min = [0.0, 1.0, 2.0], max = [3.0, 5.0, 7.0] } }, sigma_t = [1.0, 2.0, 4.0],\n\
                density = { grid = { file = \"a.vol\", min = [0.0, 0.0, 0.0], max = [1.0, 2.0, 3.0] } } }]\n\
             objects = [{ shape = { mesh = { file = \"a.obj\", scale = 1.0, at = [1.0, 1.0, 2.0] } }, surface = \"black\" }]\n\
             lights = [{ point = { position = [1.0, 1.0, 1.0], power = 2.0 } }]\n",
        )
        .unwrap();
        let files =
            [("a.vol".to_string(), grid.unwrap().to_bytes()), ("a.obj".to_string(), mesh.into_bytes())];
        let text = SceneText { table, files: files.into_iter().collect() };
        let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        for turn in (0..24).flat_map(|i| [Motion::rotation(i), Motion::rotation(i) * mirror]) {
            let there = Motion { turn, scale: 4.0, offset: DVec3::new(1.0, -2.0, 0.5) };
            let back =
                Motion { turn: turn.inverse(), scale: 0.25, offset: -(turn.inverse() * there.offset * 0.25) };
            let again = back.of(&there.of(&text).unwrap()).unwrap().without_unused();
            let strip = |text: &SceneText| text.toml().replace("pooopooop-", "");
            let plain: Vec<&Vec<u8>> = again.files.values().collect();
            let first: Vec<&Vec<u8>> = text.files.values().collect();
            assert_eq!(plain, first, "{turn:?}");
            let (a, b) = (strip(&again), strip(&text));
            let bare = |t: &str| t.lines().filter(|l| !l.contains("file")).collect::<Vec<_>>().join("\n");
            assert_eq!(bare(&a).replace("-0.0", "0.0"), bare(&b), "{turn:?}");
        }
    }
}
