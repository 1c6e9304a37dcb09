//! The data files of the scenes that a program has made: the stained-glass window, the tiles of the pool, and the grid of the fog box.

use super::{Grid, develop};
use glam::DVec3;
use turbid::Spectrum;
use turbid::math::{atan2, cos, sin, sin_cos};
use turbid::medium;

/// Size of the window's picture: 1.8 m by 2.2 m, a pixel a centimetre.
const WINDOW: Grid = Grid { width: 180, height: 220 };

/// Lead is opaque; glass passes a fifth to four fifths of its own colour.
const LEAD: Spectrum = Spectrum::grey(0.002);
const RUBY: Spectrum = Spectrum::rgb(0.80, 0.05, 0.04);
const COBALT: Spectrum = Spectrum::rgb(0.05, 0.12, 0.75);
const AMBER: Spectrum = Spectrum::rgb(0.90, 0.55, 0.06);
const EMERALD: Spectrum = Spectrum::rgb(0.06, 0.55, 0.16);
const CLEAR: Spectrum = Spectrum::rgb(0.85, 0.83, 0.72);

/// Transmittance of the window at a point in centimetres from its lower left corner: a rose with twelve petals over
/// three lancets.
fn window_at(x: f64, y: f64) -> Spectrum {
    let (dx, dy) = (x - 90.0, y - 142.0);
    let radius = (dx * dx + dy * dy).sqrt();
    if !(4.0..=176.0).contains(&x) || !(4.0..=216.0).contains(&y) {
        return LEAD;
    }
    if radius < 70.0 {
        rose(radius, atan2(dy, dx))
    } else if y > 72.0 {
        corner(radius, x, y)
    } else {
        lancet(x, y)
    }
}

fn rose(radius: f64, angle: f64) -> Spectrum {
    let turn = angle / (2.0 * std::f64::consts::PI) + 0.5;
    let sector = |n: f64| (turn * n).floor() as i64;
    // Distance from the nearest of n spokes.
    let spoke = |n: f64| {
        let part = turn * n - (turn * n).round();
        radius * sin_cos(2.0 * std::f64::consts::PI * part / n).0.abs()
    };
    let is_near = |r: f64| (radius - r).abs() < 1.6;
    match radius {
        _ if is_near(14.0) || is_near(44.0) || radius > 66.0 => LEAD,
        r if r < 14.0 => AMBER,
        r if r < 44.0 && spoke(6.0) < 1.4 => LEAD,
        r if r < 44.0 => [RUBY, COBALT][(sector(6.0) % 2) as usize],
        _ if spoke(12.0) < 1.4 => LEAD,
        _ => [COBALT, AMBER, RUBY, EMERALD][(sector(12.0) % 4) as usize],
    }
}

/// Clear quarries of 12 cm beside the rose.
fn corner(radius: f64, x: f64, y: f64) -> Spectrum {
    let edge = |t: f64| (t / 12.0 - (t / 12.0).round()).abs() * 12.0;
    if radius < 72.0 || edge(x + y) < 0.9 || edge(x - y) < 0.9 { LEAD } else { CLEAR }
}

fn lancet(x: f64, y: f64) -> Spectrum {
    if !(8.0..=68.0).contains(&y) {
        return LEAD;
    }
    let column = ((x - 4.0) / (172.0 / 3.0)).floor().clamp(0.0, 2.0);
    let across = x - 4.0 - (column + 0.5) * 172.0 / 3.0;
    // A pointed arch: two arcs of the lancet's full width about the feet of the other side.
    let is_inside = |half: f64, foot: f64| {
        let far = across.abs() + half;
        across.abs() < half && (y < foot || far * far + (y - foot) * (y - foot) < 4.0 * half * half)
    };
    let rows = ((y - 8.0) / 15.0).fract();
    match () {
        () if !is_inside(24.0, 26.0) => LEAD,
        () if !is_inside(21.5, 26.0) => [EMERALD, AMBER, EMERALD][column as usize],
        () if !is_inside(19.5, 26.0) || rows < 0.08 => LEAD,
        () if across.abs() + 15.0 * (rows - 0.5).abs() < 7.0 => AMBER,
        () => [RUBY, COBALT, RUBY][column as usize],
    }
}

/// The picture of the window, `window.png` of the scene `dusty-room`.
pub fn window() -> develop::Print {
    let at = |i: usize| {
        let (column, row) = (i % WINDOW.width, i / WINDOW.width);
        window_at(column as f64 + 0.5, WINDOW.height as f64 - row as f64 - 0.5)
    };
    let pixels: Vec<Spectrum> = (0..WINDOW.pixels()).map(at).collect();
    develop::plain(WINDOW, &pixels)
}

/// Side of a tile of the pool, with its joint \[pixels\].
const TILE: usize = 10;

/// Two glazes, between which tiles differ, the mortar of the joints, and the dark tiles of the borders.
const GLAZES: [Spectrum; 2] = [Spectrum::rgb(0.42, 0.64, 0.72), Spectrum::rgb(0.30, 0.54, 0.66)];
const JOINT: Spectrum = Spectrum::rgb(0.70, 0.72, 0.70);
const BORDER: Spectrum = Spectrum::rgb(0.05, 0.16, 0.34);

/// Tiles of uneven blue, dark where there is a border.
fn tiles(columns: usize, rows: usize, is_border: impl Fn(usize, usize) -> bool) -> develop::Print {
    let grid = Grid { width: columns * TILE, height: rows * TILE };
    let at = |i: usize| {
        let (x, y) = (i % grid.width, i / grid.width);
        let (column, row) = (x / TILE, y / TILE);
        if x % TILE == 0 || y % TILE == 0 {
            return JOINT;
        }
        if is_border(column, row) {
            return BORDER;
        }
        // The fraction of a product with an irrational number looks like chance.
        let part = ((column * 37 + row * 101 + column * row * 11) as f64 * 0.618_033_988_749_894_8).fract();
        GLAZES[0] * part + GLAZES[1] * (1.0 - part)
    };
    let pixels: Vec<Spectrum> = (0..grid.pixels()).map(at).collect();
    develop::plain(grid, &pixels)
}

/// The tiles of the scene `pool`: the names of their files in the folder of the scenes, and the pictures.
pub fn pool() -> [(&'static str, develop::Print); 3] {
    let ring = |column: usize, row: usize| column.min(23 - column).min(row).min(19 - row) == 2;
    let top = |_: usize, row: usize| row == 1;
    [
        ("pool/bottom.png", tiles(24, 20, ring)),
        ("pool/end.png", tiles(24, 5, top)),
        ("pool/side.png", tiles(20, 5, top)),
    ]
}

/// The density of the scene `fogbox-het`, `fogbox/het.vol`: 32 samples along each axis of the box, their mean 1.
///
/// # Errors
/// None that a user could cause: the grid's own, if its numbers were wrong.
pub fn fogbox_het() -> anyhow::Result<Vec<u8>> {
    let wave = |p: DVec3| {
        let turn = |x: f64| 2.0 * std::f64::consts::PI * x;
        let (x, y, z) = (0.5 * (p.x + 1.0), 0.5 * (p.y + 1.0), 0.5 * (p.z + 1.0));
        let slow = sin(turn(1.5 * x + 0.2)) * cos(turn(y)) * sin(turn(1.2 * z + 0.1));
        (1.0 + 0.6 * slow + 0.35 * sin(turn(3.0 * x + 2.0 * y + 2.5 * z))).max(0.02)
    };
    let corners = (DVec3::NEG_ONE, DVec3::ONE);
    let grid = medium::Grid::sampled(corners, [32; 3], wave)?;
    let mean = grid.values().iter().map(|&v| f64::from(v)).sum::<f64>() / grid.values().len() as f64;
    Ok(grid.placed(corners, 1.0 / mean)?.to_bytes())
}

#[cfg(test)]
mod tests {
    /// The kept files are what this program makes; `gallery --assets` writes them anew.
    #[test]
    fn the_kept_files_are_those_made_here() {
        let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let kept = image::open(scenes.join("window.png")).unwrap().to_rgb8();
        assert!(kept.as_raw()[..] == *super::window().pixels.as_flattened());
        for (file, print) in super::pool() {
            let kept = image::open(scenes.join(file)).unwrap().to_rgb8();
            assert!(kept.as_raw()[..] == *print.pixels.as_flattened(), "{file}");
        }
        assert!(std::fs::read(scenes.join("fogbox/het.vol")).unwrap() == super::fogbox_het().unwrap());
    }
}
