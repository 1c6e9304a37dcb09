//! What readers without colours, or with two of three kinds of cones, see of the palette.

use crate::palette::{Color, Dash, Marker, Shading};

type Rgb = (u8, u8, u8);
type Matrix = [[f64; 3]; 3];
/// Lightness L* from 0 to 100 and the two chromatic axes of CIE 1976, white of D65.
type Lab = [f64; 3];

/// Vision with all cones, then without the long, the middle and the short wavelengths' cones.
///
/// # Source
/// Machado, Oliveira and Fernandes 2009, "A physiologically-based model for simulation of color vision deficiency",
/// severity 1.0, on linear sRGB.
const EYES: [(&str, Matrix); 4] = [
    ("normal", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    (
        "protanopia",
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    ),
    (
        "deuteranopia",
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    ),
    (
        "tritanopia",
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
    ),
];

fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// The colour as these eyes see it.
fn seen((r, g, b): Rgb, eyes: &Matrix) -> Lab {
    // IEC 61966-2-1 (sRGB), and its primaries in CIE XYZ over the white.
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
    };
    const XYZ: Matrix = [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ];
    let light = apply(eyes, [linear(r), linear(g), linear(b)]).map(|c| c.clamp(0.0, 1.0));
    let xyz = apply(&XYZ, light);
    let [x, y, z] = [xyz[0] / 0.95047, xyz[1], xyz[2] / 1.08883]
        .map(|t| if t > 216.0 / 24389.0 { libm::cbrt(t) } else { (24389.0 / 27.0 * t + 16.0) / 116.0 });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Lightness in grey.
fn lightness(rgb: Rgb) -> f64 {
    seen(rgb, &EYES[0].1)[0]
}

/// The colour difference CIEDE2000: about 1 can just be seen side by side, 10 at a glance.
///
/// # Source
/// Luo, Cui and Rigg 2001; written as in Sharma, Wu and Dalal 2005.
fn difference(a: Lab, b: Lab) -> f64 {
    let degrees = std::f64::consts::PI / 180.0;
    let seventh = |c: f64| c.powi(7);
    let chroma = |c: Lab| libm::hypot(c[1], c[2]);
    let mean = 0.5 * (chroma(a) + chroma(b));
    let g = 0.5 * (1.0 - (seventh(mean) / (seventh(mean) + seventh(25.0))).sqrt());
    let [(l1, c1, h1), (l2, c2, h2)] = [a, b].map(|c| {
        let red = (1.0 + g) * c[1];
        (c[0], libm::hypot(red, c[2]), (libm::atan2(c[2], red) / degrees).rem_euclid(360.0))
    });
    let is_grey = c1 * c2 == 0.0;
    let mut dh = if is_grey { 0.0 } else { h2 - h1 };
    if dh > 180.0 {
        dh -= 360.0;
    } else if dh < -180.0 {
        dh += 360.0;
    }
    let hue = match (h1 - h2).abs() {
        _ if is_grey => h1 + h2,
        apart if apart <= 180.0 => 0.5 * (h1 + h2),
        _ if h1 + h2 < 360.0 => 0.5 * (h1 + h2 + 360.0),
        _ => 0.5 * (h1 + h2 - 360.0),
    };
    let (l, c) = (0.5 * (l1 + l2), 0.5 * (c1 + c2));
    let cos = |angle: f64| libm::cos(angle * degrees);
    let t = 1.0 - 0.17 * cos(hue - 30.0) + 0.24 * cos(2.0 * hue) + 0.32 * cos(3.0 * hue + 6.0)
        - 0.20 * cos(4.0 * hue - 63.0);
    let from_blue = (hue - 275.0) / 25.0;
    let turn = 60.0 * libm::exp(-from_blue * from_blue);
    let rotation = -2.0 * (seventh(c) / (seventh(c) + seventh(25.0))).sqrt() * libm::sin(turn * degrees);
    let square = (l - 50.0) * (l - 50.0);
    let dl = (l2 - l1) / (1.0 + 0.015 * square / (20.0 + square).sqrt());
    let dc = (c2 - c1) / (1.0 + 0.045 * c);
    let dh = 2.0 * (c1 * c2).sqrt() * libm::sin(0.5 * dh * degrees) / (1.0 + 0.015 * c * t);
    (dl * dl + dc * dc + dh * dh + rotation * dc * dh).sqrt()
}

fn classes() -> Vec<Rgb> {
    (0..7).map(|class| Color::Class(class).rgb()).collect()
}

/// Steps of `n` through the colours of a map, lowest first.
fn steps(shading: Shading, n: u32) -> Vec<Rgb> {
    (0..=n).map(|i| shading.rgb(f64::from(i) / f64::from(n))).collect()
}

/// Pairs of the published test data, to their four digits.
#[test]
fn the_difference_is_that_of_the_published_data() {
    for (a, b, expected) in [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0009], 7.1792),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ([22.7233, 20.0904, -46.6940], [23.0331, 14.9730, -42.5619], 2.0373),
        ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
    ] {
        let found = difference(a, b);
        assert!((found - expected).abs() < 1e-4, "{found} for {expected}");
        assert!((difference(b, a) - found).abs() < 1e-12);
    }
}

#[test]
fn white_and_greys_stay_white_and_grey_for_all_eyes() {
    for (name, eyes) in EYES {
        let white = seen((255, 255, 255), &eyes);
        // Rows of the matrices add up to 1 within their last digit, a millionth.
        assert!((white[0] - 100.0).abs() < 1e-3 && difference(white, [100.0, 0.0, 0.0]) < 0.02, "{name}");
        let grey = seen((119, 119, 119), &eyes);
        assert!((grey[0] - lightness((119, 119, 119))).abs() < 1e-3, "{name}");
    }
}

/// Least steps: 7 of 100 in lightness, so that any two classes differ in grey; a difference of 12 for dichromats and
/// of 20 for others; a difference of 20 from the paper for all.
#[test]
fn the_seven_classes_stay_apart_in_grey_and_for_every_kind_of_eye() {
    let mut light: Vec<f64> = classes().into_iter().map(lightness).collect();
    light.sort_by(f64::total_cmp);
    assert!(light.windows(2).all(|w| w[1] - w[0] >= 7.0), "{light:?}");
    for (name, eyes) in EYES {
        let least = if name == "normal" { 20.0 } else { 12.0 };
        let seen: Vec<Lab> = classes().into_iter().map(|c| seen(c, &eyes)).collect();
        for a in 0..7 {
            for b in 0..a {
                let apart = difference(seen[a], seen[b]);
                assert!(apart >= least, "{name}: classes {a} and {b} differ by {apart:.1}");
            }
            assert!(difference(seen[a], [100.0, 0.0, 0.0]) >= 20.0, "{name}: class {a} fades");
        }
    }
}

/// The shape of points tells all seven classes; the pattern of lines tells four, and classes that share one differ in
/// lightness by two steps.
#[test]
fn markers_and_dashes_carry_the_class_too() {
    for a in 0..7 {
        for b in 0..a {
            assert_ne!(Marker::of_class(a), Marker::of_class(b));
            let apart = lightness(classes()[a]) - lightness(classes()[b]);
            assert!(
                Dash::of_class(a) != Dash::of_class(b) || apart.abs() >= 14.0,
                "classes {a} and {b}: {apart}"
            );
        }
    }
}

/// A tenth of the scale is a difference of at least 3.5, in grey one of 7 of 100 in lightness, rising all the way.
#[test]
fn the_sequential_scale_rises_for_every_kind_of_eye() {
    let colors = steps(Shading::Sequential, 10);
    for (name, eyes) in EYES {
        for w in colors.windows(2) {
            let (a, b) = (seen(w[0], &eyes), seen(w[1], &eyes));
            let least = if name == "normal" { 7.0 } else { 5.0 };
            assert!(b[0] - a[0] >= least && difference(a, b) >= 3.5, "{name}: {a:?} {b:?}");
        }
    }
}

/// Of one strength, 0.2 to 1 of the limit, red and blue differ by at least 15 for every kind of eye; in grey only the
/// lines tell them apart, which stand 20 of 100 in lightness off every colour they cross.
#[test]
fn the_diverging_scale_keeps_its_sign() {
    let colors = steps(Shading::Diverging, 20);
    for (name, eyes) in EYES {
        for i in 0..=8 {
            let (blue, red) = (seen(colors[i], &eyes), seen(colors[20 - i], &eyes));
            assert!(difference(blue, red) >= 15.0, "{name} at step {i}");
        }
        // Half a tenth of the limit towards either end is seen.
        for w in colors.windows(2) {
            assert!(difference(seen(w[0], &eyes), seen(w[1], &eyes)) >= 3.0, "{name}: {w:?}");
        }
    }
    for i in 0..=200 {
        let u = f64::from(i) / 200.0;
        let line = Shading::Diverging.hatch(u);
        assert_eq!(line.is_some(), u < 0.45);
        if let Some(line) = line {
            let off = lightness(line) - lightness(Shading::Diverging.rgb(u));
            assert!(off.abs() >= 20.0, "{u}: {off}");
        }
        assert_eq!(Shading::Sequential.hatch(u), None);
    }
}
