//! Height fields: against planes and the field itself; closed bodies; waves.

use super::solids::{crossings, direction, point, stream};
use glam::{DVec2, DVec3};
use turbid::geometry::{Ground, Mesh, Up, Waves, height_field, listed};
use turbid::math::Ray;

const GROUND: Ground = Ground { corner: DVec2::new(-1.0, -2.0), size: DVec2::new(3.0, 4.0), cells: [24, 32] };

fn field(up: Up, floor: Option<f64>, height: impl Fn(DVec2) -> f64) -> Mesh {
    height_field(&GROUND, up, floor, height).unwrap()
}

/// A tilted plane is met where the plane is, from above with the normal upwards, whichever way is up.
#[test]
fn a_plane_is_a_plane() {
    for up in [Up::Z, Up::Y] {
        // Ground coordinates and height of a point, and back.
        let to = |p: DVec3| if up == Up::Z { p } else { DVec3::new(p.z, p.x, p.y) };
        let from = |p: DVec3| if up == Up::Z { p } else { DVec3::new(p.y, p.z, p.x) };
        let solid = field(up, None, |p| 0.5 + 0.25 * p.x - 0.125 * p.y);
        let normal = DVec3::new(-0.25, 0.125, 1.0).normalize();
        let mut s = stream(21);
        let mut hits = 0;
        for _ in 0..3000 {
            let (o, d) = (point(&mut s) * 4.0, direction(&mut s));
            let found = solid.hit(&Ray::new(from(o), from(d)), None);
            let t = (0.5 * normal.z - o.dot(normal)) / d.dot(normal);
            let q = (o + d * t).truncate() - GROUND.corner;
            let is_on = t > 0.0 && q.min_element() >= 0.0 && q.cmple(GROUND.size).all();
            assert_eq!(found.is_some(), is_on, "{o} {d}");
            if let Some(found) = found {
                assert!((found.t - t).abs() * d.dot(normal).abs() < 1e-13);
                assert!(to(found.normal).distance(normal) < 1e-12);
                assert!((found.uv - q / GROUND.size).length() < 1e-9, "{}", found.uv);
                hits += 1;
            }
        }
        assert!(hits > 150, "{hits}");
        assert!((solid.area() - 12.0 / normal.z).abs() < 1e-12 && !solid.is_closed());
    }
}

/// Straight down, a corner of the grid is met at its height, wherever the field is smooth or not.
#[test]
fn corners_have_their_heights() {
    let waves = Waves::new(3, 12, 1.5, 0.2).unwrap();
    let solid = field(Up::Z, None, |p| waves.height(p));
    for i in 0..=24 {
        for j in 0..=32 {
            let p = GROUND.corner + GROUND.size * DVec2::new(f64::from(i) / 24.0, f64::from(j) / 32.0);
            let found = solid.hit(&Ray::new(p.extend(5.0), DVec3::NEG_Z), None).unwrap();
            assert!((5.0 - found.t - waves.height(p)).abs() < 1e-14, "{p}");
            assert!(found.normal.z > 0.0);
        }
    }
}

/// A body of water is closed, has the volume under its surface, and lines cross it in and out by turns.
#[test]
fn a_body_of_water_is_closed() {
    let waves = Waves::new(4, 12, 1.5, 0.2).unwrap();
    for up in [Up::Z, Up::Y] {
        let solid = field(up, Some(-1.5), |p| waves.height(p));
        assert!(solid.is_closed());
        let mut s = stream(22);
        let mut most = 0;
        for _ in 0..3000 {
            let origin = direction(&mut s) * 6.0;
            let target = point(&mut s) * 2.0;
            let ray = Ray::new(origin, (target - origin).normalize());
            most = most.max(crossings(&ray, false, |ray, from| solid.hit(ray, from)));
        }
        assert!(most >= 4, "{most}");
        for _ in 0..3000 {
            let (p, normal, primitive) = solid.sample_surface(s.pair());
            let dir = direction(&mut s);
            crossings(&Ray::new(p, dir), normal.dot(dir) < 0.0, |ray, from| {
                solid.hit(ray, from.or(Some(primitive)))
            });
        }
    }
    let flat = field(Up::Y, Some(-1.0), |_| 1.0);
    assert!((flat.volume() - 24.0).abs() < 1e-12 && (flat.area() - 2.0 * (12.0 + 6.0 + 8.0)).abs() < 1e-12);
}

/// The mean square of the heights over a large ground is that which was asked for; the same seed gives the same waves.
#[test]
fn waves_have_their_height() {
    let waves = Waves::new(5, 20, 1.0, 0.3).unwrap();
    let mut s = stream(23);
    let n = 20_000;
    let square =
        (0..n).map(|_| waves.height(point(&mut s).truncate() * 1e3).powi(2)).sum::<f64>() / f64::from(n);
    // A sum of 20 sines is nearly Gaussian: its square has a standard deviation of at most sqrt(2) of its mean.
    assert!((square / 0.09 - 1.0).abs() < 5.0 * (2.0 / f64::from(n)).sqrt(), "{square}");
    assert_eq!(waves, Waves::new(5, 20, 1.0, 0.3).unwrap());
    assert_ne!(waves, Waves::new(6, 20, 1.0, 0.3).unwrap());
}

/// Listed heights are met at their places and halfway between.
#[test]
fn listed_heights() {
    let rows = vec![vec![0.0, 1.0, 0.0], vec![0.5, 0.0, -0.5]];
    let height = listed(&GROUND, &rows).unwrap();
    for (x, y, h) in [
        (-1.0, -2.0, 0.0),
        (0.5, -2.0, 1.0),
        (2.0, 2.0, -0.5),
        (0.5, 2.0, 0.0),
        (-0.25, -2.0, 0.5),
        (-1.0, 0.0, 0.25),
    ] {
        assert!((height(DVec2::new(x, y)) - h).abs() < 1e-15, "{x} {y}");
    }
    let say = |rows: &[Vec<f64>]| listed(&GROUND, rows).err().unwrap().to_string();
    assert_eq!(say(&[vec![0.0, 1.0]]), "heights need at least 2 rows of at least 2 numbers");
    assert_eq!(
        say(&[vec![0.0, 1.0], vec![0.0]]),
        "row 2 of the heights has 1 numbers, the first has 2; allowed: all alike"
    );
    assert_eq!(say(&[vec![0.0, 1.0], vec![0.0, f64::INFINITY]]), "height is inf; allowed: finite");
}

#[test]
fn bad_fields_are_refused() {
    let say = |ground: &Ground, floor: Option<f64>, h: f64| {
        height_field(ground, Up::Z, floor, |_| h).unwrap_err().to_string()
    };
    assert_eq!(say(&GROUND, Some(0.0), 0.0), "floor is 0; allowed: finite and below every height");
    assert_eq!(say(&GROUND, None, f64::NAN), "height is NaN; allowed: finite");
    let none = Ground { cells: [0, 3], ..GROUND };
    assert_eq!(say(&none, None, 0.0), "a height field of 0 x 3 cells; allowed: 1 to 2^20 in all");
    let flat = Ground { size: DVec2::new(0.0, 1.0), ..GROUND };
    assert_eq!(say(&flat, None, 0.0), "a height field needs a finite corner and a size above 0 on both axes");
    assert!(
        Waves::new(1, 0, 1.0, 0.1).is_err()
            && Waves::new(1, 1, 0.0, 0.1).is_err()
            && Waves::new(1, 1, 1.0, -0.1).is_err()
    );
}
