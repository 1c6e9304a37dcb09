//! Means over bins against exact values: fluxes through planes, fluence and absorption of layers and radiance at faces of a
//! slab; a void about sources; a furnace.

use super::henyey_greenstein::{medium, referee};
use crate::checks::slab::exact;
use crate::support::quadrature::integrate;
use crate::support::run::{bin_paths, scores};
use crate::support::scenes::{Incidence, written};
use crate::support::verdict;
use std::f64::consts::PI;
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::scene::{Orders, Scene};
use turbid::sensor::{PhotonSettings, by_photons};
use turbid::stats::Moments;
use turbid::transport::NoProgress;
use turbid_analytic::{Ground, Layer, Phase, StratifiedSlab};

const PHOTONS: u64 = 1 << 17;
const PATHS: u64 = 1 << 14;
const TAU: f64 = 2.0;
const LAYERS: usize = 4;

/// A slab of thickness 1, extinction 2, albedo 0.8 and g 0.5 under an oblique beam or diffuse light of irradiance 1, with these
/// sensors in its cell.
fn slab(how: Incidence, sensors: &str) -> Scene {
    let light = match how {
        Incidence::Beam(mu0) => {
            let s = ((1.0 - mu0) * (1.0 + mu0)).sqrt();
            format!("beam = {{ dir = [{s}, 0, {mu0}], irradiance = {}, section = \"unbounded\" }}", 1.0 / mu0)
        }
        _ => format!(
            "isotropic = {{ shape = {{ slab = {{ top = 0, thickness = 1 }} }}, faces = \"top\", radiance = {} }}",
            1.0 / PI
        ),
    };
    written(&format!(
        "cell = 1.5\n[[regions]]\nshape = {{ slab = {{ top = 0, thickness = 1 }} }}\nsigma_t = 2\nalbedo = 0.8\ng = 0.5\n\
         [[lights]]\n{light}\n{sensors}"
    ))
}

fn sensor(measure: &str) -> String {
    format!("[[sensors]]\nname = \"s\"\nmeasure = {{ {measure} }}\n")
}

/// A plane of the slab's cell in two bins.
fn plane(z: f64, more: &str) -> String {
    format!("corner = [0, 0, {z}], u = [1.5, 0, 0], v = [0, 1.5, 0], bins = [2, 1]{more}")
}

const LIT: [Incidence; 2] = [Incidence::Beam(0.5), Incidence::Diffuse];

fn layers(how: Incidence) -> StratifiedSlab {
    let layer = Layer::new(TAU / LAYERS as f64, 0.8, &Phase::henyey_greenstein(0.5).unwrap()).unwrap();
    let incidence = match how {
        Incidence::Beam(mu0) => turbid_analytic::Incidence::Beam { mu0 },
        _ => turbid_analytic::Incidence::Diffuse,
    };
    StratifiedSlab::new(&vec![layer; LAYERS], Ground::black(), Some(incidence)).unwrap()
}

/// Light both ways through the faces and a plane within, scored as it passes and looked for by paths; direct light lights the
/// first face.
#[test]
fn fluxes_through_planes_of_a_slab() {
    let depths = [0.0, 0.4, 1.0];
    let ways = ["along", "against", "net"];
    let sensors: String = depths
        .iter()
        .flat_map(|z| {
            ways.map(|way| sensor(&format!("flux = {{ {} }}", plane(*z, &format!(", crossing = \"{way}\"")))))
        })
        .collect();
    for how in LIT {
        let exact_slab = layers(how);
        let scene = slab(how, &sensors);
        let scored = scores(&scene, PHOTONS, 1);
        for (number, sensor) in scene.sensors().iter().enumerate() {
            let (t, way) = (depths[number / 3] * TAU, ways[number % 3]);
            let flux = |way: &str| {
                exact(match way {
                    "along" => exact_slab.flux_down(t).unwrap(),
                    "against" => exact_slab.flux_up(t).unwrap(),
                    _ => exact_slab.flux(t).unwrap(),
                })
            };
            let what = format!("{way} at {t}, {how:?}");
            for (bin, moments) in scored[number].iter().enumerate() {
                let by_paths = bin_paths(&scene, sensor, bin, PATHS, 2)[0];
                verdict::agrees(&format!("{what}, scored"), &moments[0], flux(way), 0.05, 1);
                verdict::agrees(&format!("{what}, paths"), &by_paths, flux(way), 0.15, 2);
            }
            if way != "net" && t == 0.8 {
                let other = if way == "along" { "against" } else { "along" };
                verdict::rejects(&format!("{what}, other way"), &scored[number][0][0], flux(other).0, 1);
            }
        }
    }
}

/// Fluence and absorption of layers, by each way of scoring and by paths. What a layer absorbs is the difference of net fluxes.
#[test]
fn layers_of_a_slab() {
    let place = "min = [0, 0, 0], max = [1.5, 1.5, 1], cells = [1, 1, 4]";
    let scorings = ["track-length", "collision", "analog"];
    let mut sensors = String::new();
    for scoring in &scorings[..2] {
        sensors += &sensor(&format!("mean-fluence = {{ {place}, scoring = \"{scoring}\" }}"));
    }
    for scoring in scorings {
        sensors += &sensor(&format!("mean-absorption = {{ {place}, scoring = \"{scoring}\" }}"));
    }
    for how in LIT {
        let exact_slab = layers(how);
        let scene = slab(how, &sensors);
        let scored = scores(&scene, PHOTONS, 3);
        for (layer, collided) in scored[1].iter().enumerate() {
            // A layer is 1/4 thick.
            let absorbed = exact_slab.absorptance(layer).unwrap();
            let (top, bottom) = (0.5 * layer as f64, 0.5 * (layer + 1) as f64);
            let [top, bottom] = [top, bottom].map(|t| exact_slab.flux(t).unwrap());
            let error = top.error + bottom.error + absorbed.error + 4.0 * f64::EPSILON;
            assert!((top.value - bottom.value - absorbed.value).abs() <= error);
            let fluence = exact(exact_slab.mean_fluence(layer).unwrap());
            let absorption = (4.0 * absorbed.value, 4.0 * absorbed.error + 1e-15);
            let what = format!("layer {layer}, {how:?}");
            for (number, sensor) in scene.sensors().iter().enumerate() {
                let (reference, name) =
                    if number < 2 { (fluence, "fluence") } else { (absorption, "absorption") };
                let scoring = scorings[if number < 2 { number } else { number - 2 }];
                let moments = scored[number][layer][0];
                let name = format!("{name}, {what}");
                verdict::agrees(&format!("{name}, {scoring}"), &moments, reference, 0.1, 3);
                if scoring == "track-length" {
                    let by_paths = bin_paths(&scene, sensor, layer, PATHS, 4)[0];
                    verdict::agrees(&format!("{name}, paths"), &by_paths, reference, 0.3, 4);
                }
            }
            // Collisions not divided by the extinction.
            verdict::rejects(&format!("{what}, undivided"), &collided[0], 2.0 * fluence.0, 3);
        }
    }
}

/// Voxels that part the cell too, and leave some of it out: all alike, since the slab is.
#[test]
fn columns_of_a_cell_are_alike() {
    let place = "min = [0.1, 0, 0.25], max = [1.3, 1.5, 0.5], cells = [3, 2, 1]";
    let sensors = sensor(&format!("mean-fluence = {{ {place} }}"))
        + &sensor(&format!("mean-absorption = {{ {place} }}"))
        + &sensor("mean-fluence = { region = 0 }");
    let how = Incidence::Beam(0.5);
    let exact_slab = layers(how);
    let scored = scores(&slab(how, &sensors), PHOTONS, 5);
    let absorbed = exact_slab.absorptance(1).unwrap();
    assert_eq!((scored[0].len(), scored[1].len()), (6, 6));
    for (bin, (flown, kept)) in scored[0].iter().zip(&scored[1]).enumerate() {
        let fluence = exact(exact_slab.mean_fluence(1).unwrap());
        verdict::agrees(&format!("column {bin}"), &flown[0], fluence, 0.15, 5);
        let absorption = (4.0 * absorbed.value, 4.0 * absorbed.error);
        verdict::agrees(&format!("column {bin}, absorption"), &kept[0], absorption, 0.15, 5);
    }
    let all = (0..LAYERS).map(|i| exact_slab.mean_fluence(i).unwrap());
    let mean = all.fold((0.0, 0.0), |(v, e), x| (v + 0.25 * x.value, e + 0.25 * x.error));
    verdict::agrees("the region", &scored[2][0][0], mean, 0.05, 5);
}

/// Depth over thickness, cosine (up is positive), azimuth against the beam's.
const VIEWS: [(f64, f64, f64); 3] = [(0.0, 0.4, 2.0), (1.0, -0.8, 0.0), (0.4, -0.6, 1.0)];

/// Scattered radiance through planes, by what scatterings send there and by paths.
#[test]
fn radiance_through_planes_of_a_slab() {
    let exact_medium = medium(0.8, 0.5);
    let mut sensors = String::new();
    for (part, mu, dphi) in VIEWS {
        let s = ((1.0 - mu) * (1.0 + mu)).sqrt();
        let (sin, cos) = turbid::math::sin_cos(dphi);
        let dir = format!(", dir = [{}, {}, {mu}]", -s * cos, -s * sin);
        sensors += &(sensor(&format!("mean-radiance = {{ {} }}", plane(part, &dir))) + "min_order = 1\n");
    }
    for how in LIT {
        let exact_slab = referee(&exact_medium, TAU, how);
        let scene = slab(how, &sensors);
        let scored = scores(&scene, PHOTONS, 6);
        for (number, (part, mu, dphi)) in VIEWS.into_iter().enumerate() {
            let reference = exact(exact_slab.radiance(part * TAU, mu, dphi).unwrap());
            let value = reference.0;
            let what = format!("depth {part}, mu {mu}, {how:?}");
            for (bin, moments) in scored[number].iter().enumerate() {
                let by_paths = bin_paths(&scene, &scene.sensors()[number], bin, PATHS, 7)[0];
                let moments = &moments[0];
                verdict::agrees(&format!("{what}, scored"), moments, reference, 0.1 * value, 6);
                verdict::agrees(&format!("{what}, paths"), &by_paths, reference, 0.2 * value, 7);
                verdict::rejects(&format!("{what}, area not across"), moments, reference.0 * mu.abs(), 6);
            }
        }
    }
}

/// Fluence of a point light in a void: 1/(4 pi r^2), averaged over each voxel.
#[test]
fn a_void_about_a_point_light() {
    let scene = written(&format!(
        "[[lights]]\npoint = {{ position = [0, 0, 0], power = 1 }}\n{}",
        sensor("mean-fluence = { min = [0.5, -0.25, 0.5], max = [1.5, 0.75, 1.5], cells = [2, 1, 2] }")
    ));
    let scored = scores(&scene, PHOTONS, 8);
    for (bin, moments) in scored[0].iter().enumerate() {
        let (x0, z0) = (0.5 + 0.5 * (bin % 2) as f64, 0.5 + 0.5 * (bin / 2) as f64);
        let over_x = |y: f64, z: f64| integrate(x0, x0 + 0.5, 1, |x| 1.0 / (x * x + y * y + z * z));
        let over_xy = |z: f64| integrate(-0.25, 0.75, 1, |y| over_x(y, z));
        let mean = integrate(z0, z0 + 0.5, 1, over_xy) / (4.0 * PI * 0.25);
        verdict::agrees(&format!("voxel {bin}"), &moments[0], (mean, 1e-12), 0.25 * mean, 8);
        let by_paths = bin_paths(&scene, &scene.sensors()[0], bin, PATHS, 9)[0];
        verdict::agrees(&format!("voxel {bin}, paths"), &by_paths, (mean, 1e-12), 0.1 * mean, 9);
    }
    verdict::rejects("another voxel", &scored[0][1][0], scored[0][0][0].mean(), 8);
}

/// A ball that sends out power evenly in a void: seen from a uniform point of it in a uniform direction its edge is 3/4 R away on
/// average, so that the mean fluence is 3/4 R times the power by volume.
#[test]
fn a_void_in_a_source() {
    let ball = "{ sphere = { center = [1, 2, 3], radius = 2 } }";
    let scene = written(&format!(
        "[[regions]]\nshape = {ball}\nsigma_t = 0\nalbedo = 0\ng = 0\n[[lights]]\nvolume-source = {{ shape = {ball}, density = 3 }}\n{}",
        sensor("mean-fluence = { region = 0 }")
    ));
    let scored = scores(&scene, PHOTONS, 10)[0][0][0];
    verdict::agrees("scored", &scored, (4.5, 1e-13), 0.1, 10);
    let by_paths = bin_paths(&scene, &scene.sensors()[0], 0, PATHS, 11)[0];
    verdict::agrees("paths", &by_paths, (4.5, 1e-13), 0.2, 11);
}

/// Light from all sides, a mirror, a diffuse ball and fog that varies, none of which absorbs: radiance 1, and so a fluence of
/// 4 pi, everywhere; in the middle of glass as much more as the square of the index. Maps read it from fog alone.
#[test]
fn a_furnace() {
    let fog = "sigma_t = 1.5\nalbedo = 1\ng = 0.4\ndensity = { height-fog = { base = -1, scale_height = 1, up = [0, 0, 1] } }";
    let light = "[[lights]]\nisotropic = { shape = { sphere = { center = [0, 0, 0], radius = 2 } }, faces = \"both\", radiance = 1 }\n";
    let inside = "[[objects]]\nshape = { sphere = { center = [-0.9, 0, 0], radius = 0.3 } }\nsurface = { mirror = { reflectance = 1 } }\n\
        [[objects]]\nshape = { sphere = { center = [0, -0.9, 0], radius = 0.3 } }\nsurface = { lambertian = { reflectance = 1 } }\n\
        [[objects]]\nshape = { sphere = { center = [0.9, 0, 0], radius = 0.4 } }\nsurface = { dielectric = { inside = \"glass\" } }\n";
    let region =
        format!("[[regions]]\nshape = {{ sphere = {{ center = [0, 0, 0], radius = 1.9 }} }}\n{fog}\n");
    let air = "min = [-0.5, -0.5, 0.2], max = [0.5, 0.5, 0.6], cells = [2, 1, 1]";
    // Within radius over index: farther out rays that are caught by total reflection are dark.
    let glass = "min = [0.75, -0.15, -0.15], max = [1.05, 0.15, 0.15], cells = [1, 1, 2]";
    let radiance = "mean-radiance = { corner = [-0.5, -0.5, 0.7], u = [1, 0, 0], v = [0, 1, 0], bins = [1, 2], dir = [0, 0.6, -0.8] }";
    let measured = [
        format!("mean-fluence = {{ {air} }}"),
        format!("mean-fluence = {{ {glass} }}"),
        radiance.to_string(),
    ];
    let sensors: String = measured.iter().map(|m| sensor(m)).collect();
    let scene = written(&format!(
        "interiors = [{{ name = \"glass\", index = 1.5 }}]\n{region}{inside}{light}{sensors}"
    ));
    let references = [4.0 * PI, 2.25 * 4.0 * PI, 1.0];
    for (number, reference) in references.into_iter().enumerate() {
        for bin in 0..2 {
            let by_paths = bin_paths(&scene, &scene.sensors()[number], bin, PATHS, 12)[0];
            let what = format!("sensor {number}, bin {bin}");
            verdict::agrees(&format!("{what}, paths"), &by_paths, (reference, 1e-12), 0.1 * reference, 12);
        }
    }
    let scored = scores(&scene, PHOTONS, 13);
    for (bin, reference) in
        [(0, references[0]), (1, references[1])].into_iter().flat_map(|(s, r)| [((s, 0), r), ((s, 1), r)])
    {
        let moments = &scored[bin.0][bin.1][0];
        verdict::agrees(&format!("{bin:?}, scored"), moments, (reference, 1e-12), 0.25 * reference, 13);
    }
    verdict::rejects("glass as air", &scored[1][0][0], references[0], 13);

    // Where the density varies maps blur it.
    let even = region.split("density").next().unwrap();
    let scene = written(&format!("{even}{light}{}{}", sensor(&measured[0]), sensor(radiance)));
    let mut moments = [Moments::new(); 4];
    for seed in 0..64 {
        let estimator =
            Estimator::new(Kernel::Uniform, Gather::radius(0.4).unwrap()).treated(Treatment::Clipped);
        let settings = PhotonSettings { photons: 4096, maps: 1, seed, orders: Orders::ALL, estimator };
        let read = by_photons(&scene, &settings, &NoProgress).unwrap();
        moments.iter_mut().zip(&read.measurements).for_each(|(m, read)| m.push(read.mean));
    }
    for (number, moments) in moments.iter().enumerate() {
        let reference = if number < 2 { 4.0 * PI } else { 1.0 };
        verdict::agrees(&format!("maps, {number}"), moments, (reference, 1e-6), 0.15 * reference, 0);
    }
}
