//! Checked rows: computed once, against an exact value within a derived bound.

use super::cases::{Checked, Class};
use super::nearest_checks;
use super::sampled::near_one;
use super::scenes::{Flux, Fog, at_depth, furnace_ball, sensor, slab};
use crate::harness::Settings;
use glam::DVec3;
use turbid::estimators::boundary::Boundary;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::math::{Asymmetry, Ray};
use turbid::phase::{HenyeyGreenstein, PhaseFunction};
use turbid::photons::{Histories, PhotonMap, shoot};
use turbid::rng::{Purpose, Stream};
use turbid::scene::{Orders, Quantity, SURROUNDINGS, decay};
use turbid::transport::NoProgress;
use turbid_analytic::Incidence;
use turbid_analytic::beer_lambert::direct_transmittance;
use turbid_analytic::quadrature::GaussLegendre;

/// All rows.
pub fn all(settings: &Settings) -> anyhow::Result<Vec<Checked>> {
    let mut rows = Vec::new();
    uncollided(&mut rows)?;
    forced(settings, &mut rows)?;
    forward(settings, &mut rows)?;
    moments(&mut rows)?;
    scales(settings, &mut rows)?;
    nearest_checks::number_of_neighbors(settings, &mut rows)?;
    nearest_checks::coincident(&mut rows)?;
    refusals(settings, &mut rows);
    Ok(rows)
}

/// Beer and Lambert's law down to where exp underflows: the exponent is exact, so that a few roundings are left, and
/// below the smallest normal number the spacing of the others.
fn uncollided(rows: &mut Vec<Checked>) -> anyhow::Result<()> {
    let normal = Incidence::Beam { mu0: 1.0 };
    for tau in [1e-12, 1.0, 20.0, 300.0, 700.0, 740.0, 1e4, 1e6] {
        let scene = slab(Fog { tau, albedo: 0.5, g: 0.0 }, normal, 1.0)?;
        let through = Ray::new(at_depth(0.0, 1.0), DVec3::Z);
        let value = decay(scene.optical_depth(&through, f64::INFINITY, SURROUNDINGS))[0];
        let exact = direct_transmittance(normal, tau).map_or(0.0, |v| v.value);
        let bound = 8.0 * f64::EPSILON * exact + 4.0 * f64::from_bits(1);
        rows.push(Checked::new(Class::Thickness, format!("tau={tau:e} transmittance"), value, exact, bound));
    }
    Ok(())
}

/// Without absorption, what a thin slab scatters is what collides: 1 - exp(-tau), in every history the same number, so
/// that its mean has the roundings of the mean alone.
fn forced(settings: &Settings, rows: &mut Vec<Checked>) -> anyhow::Result<()> {
    let count = settings.photons(16_384, 262_144);
    for tau in [1e-12, 1e-6] {
        let scene = slab(Fog { tau, albedo: 1.0, g: 0.0 }, Incidence::Beam { mu0: 1.0 }, 1.0)?;
        let scattered = Orders::SCATTERED;
        let sensors = [Flux::Reflected, Flux::Transmitted].map(|f| sensor(&scene, f, scattered));
        let histories = Histories { count, seed: settings.seed, replicate: 0, max_order: None };
        let pass = shoot(&scene, histories, &sensors, |_| false, &NoProgress)?;
        let value: f64 = pass.tallies.iter().map(|t| t[0].mean()).sum();
        let exact = -libm::expm1(-tau);
        // Two means of numbers of one size: a rounding an update, which average out, 2^-53 sqrt(n), and ten to spare.
        let bound = exact * f64::EPSILON * (10.0 + (count as f64).sqrt());
        rows.push(Checked::new(
            Class::Thickness,
            format!("tau={tau:e} w=1 all that is scattered"),
            value,
            exact,
            bound,
        ));
    }
    Ok(())
}

/// The sharpest forward peak: all but 2 (1-g) tau, a few 1e-9, comes out behind the slab.
fn forward(settings: &Settings, rows: &mut Vec<Checked>) -> anyhow::Result<()> {
    let g = 1.0 - 1e-9;
    let scene = slab(Fog { tau: 2.0, albedo: 1.0, g }, Incidence::Beam { mu0: 0.5 }, 1.0)?;
    let sensors = [sensor(&scene, Flux::Transmitted, Orders::ALL)];
    // Not one of them is expected to turn back: 1e4 histories of some four collisions, 1e-9 each.
    let histories = Histories { count: 10_000, seed: settings.seed, replicate: 0, max_order: None };
    let pass = shoot(&scene, histories, &sensors, |_| false, &NoProgress)?;
    let name = format!("tau=2 w=1 g={} mu0=0.5 transmitted", near_one(g));
    rows.push(Checked::new(Class::Asymmetry, name, pass.tallies[0][0].mean(), 1.0, 0.0));
    Ok(())
}

/// Panels from 1 down, halving: they end far below the width of any peak.
fn halving(rule: &GaussLegendre, deepest: i32, f: impl Fn(f64) -> f64) -> f64 {
    let edge = |i: i32| libm::ldexp(1.0, -i);
    (0..deepest).map(|i| rule.integrate(edge(i + 1), edge(i), &f)).sum::<f64>()
        + rule.integrate(0.0, edge(deepest), &f)
}

/// Henyey-Greenstein by quadrature over the sampler's number and over the density's angle. With x = 1 - |mu| taken from
/// the peak: the mean of x is 1-|g|, of x^2 (2/3)(1-|g|)(2-|g|); the density integrates to 1.
fn moments(rows: &mut Vec<Checked>) -> anyhow::Result<()> {
    let rule = GaussLegendre::new(24)?;
    for g in [1e-12, -1e-12, 0.5, -0.5, 0.9999, -0.9999, 1.0 - 1e-9, -1.0 + 1e-9] {
        let phase = HenyeyGreenstein::new(Asymmetry::new("g", g)?);
        let rest = 1.0 - g.abs();
        let from_peak = |(one_minus, one_plus): (f64, f64)| if g > 0.0 { one_minus } else { one_plus };
        // Towards 0 and towards 1 alike.
        let over_u = |f: &dyn Fn(f64) -> f64| halving(&rule, 60, |v| 0.5 * (f(0.5 * v) + f(1.0 - 0.5 * v)));
        let first = over_u(&|u| from_peak(phase.sample(u)));
        let second = over_u(&|u| from_peak(phase.sample(u)) * from_peak(phase.sample(u)));
        let pair = |x: f64| if g > 0.0 { (x, 2.0 - x) } else { (2.0 - x, x) };
        let eval = |x: f64| {
            let (one_minus, one_plus) = pair(x);
            2.0 * std::f64::consts::PI * phase.eval(one_minus, one_plus)
        };
        let whole = 2.0 * halving(&rule, 70, |v| eval(2.0 * v));
        // Near 1 the sampler's number has steps of 2^-53; a peak there, of negative g, is felt through them by at
        // most the function's variation, 2 and 4, times half a step.
        let step = if g < 0.0 { 0.25 * f64::EPSILON } else { 0.0 };
        let rounding = 1e-13;
        let name = |what: &str| format!("g={} {what}", near_one(g));
        let class = Class::Asymmetry;
        let bound = rounding * rest + 2.0 * step;
        rows.push(Checked::new(class, name("sampled mean of 1-|mu|"), first, rest, bound));
        let exact = 2.0 / 3.0 * rest * (1.0 + rest);
        let bound = rounding * exact + 4.0 * step;
        rows.push(Checked::new(class, name("sampled mean of (1-|mu|)^2"), second, exact, bound));
        rows.push(Checked::new(class, name("density, integral"), whole, 1.0, rounding));
    }
    Ok(())
}

/// The same scene in another unit of length.
fn scales(settings: &Settings, rows: &mut Vec<Checked>) -> anyhow::Result<()> {
    let reference = in_unit(settings, 1.0)?;
    for exponent in [-40, -20, -1, 1, 20, 40] {
        let scaled = in_unit(settings, libm::ldexp(1.0, exponent))?;
        let differ = scaled.iter().zip(&reference).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
        let name = format!("unit 2^{exponent}: of {} numbers, changed", reference.len());
        rows.push(Checked::new(Class::Scale, name, differ as f64, 0.0, 0.0));
    }
    Ok(())
}

/// Numbers that do not depend on the unit of length: fluxes, fluence by maps and paths, radii in mean free paths.
fn in_unit(settings: &Settings, unit: f64) -> anyhow::Result<Vec<f64>> {
    let mut numbers = Vec::new();
    for (fog, mu0) in
        [(Fog { tau: 2.0, albedo: 0.9, g: 0.75 }, 0.5), (Fog { tau: 0.01, albedo: 0.9, g: -0.5 }, 1.0)]
    {
        let scene = slab(fog, Incidence::Beam { mu0 }, unit)?;
        let sensors =
            [Flux::Reflected, Flux::Transmitted, Flux::Absorbed].map(|f| sensor(&scene, f, Orders::ALL));
        let histories = Histories { count: 8192, seed: settings.seed, replicate: 0, max_order: None };
        let pass = shoot(&scene, histories, &sensors, |_| true, &NoProgress)?;
        numbers.extend(pass.tallies.iter().flat_map(|t| [t[0].mean(), t[0].std_error()]));
        numbers.extend(pass.photons().flat_map(|p| (p.position / unit).to_array()));
        let map = pass.into_map(0.0)?;
        let sigma_t = scene.regions()[0].medium.matter().sigma_t();
        for depth in [0.0, 0.25, 0.5, 0.9].map(|part| part * fog.tau) {
            let point = at_depth(depth, unit);
            for gather in
                [Gather::radius(0.3 * unit)?, Gather::nearest(10, unit)?, Gather::nearest(200, unit)?]
            {
                for kernel in Kernel::ALL {
                    let estimator = Estimator::new(kernel, gather);
                    let estimate = estimator.fluence(&map, point, sigma_t, &Boundary::UNKNOWN);
                    numbers.extend([estimate.value[0], estimate.radius / unit]);
                }
            }
            for history in 0..256 {
                let mut stream = Stream::new(settings.seed, Purpose::Paths, 0, history);
                let quantity = Quantity::Fluence(point);
                numbers.push(turbid::sensor::sample(&scene, &quantity, Orders::ALL, &mut stream)[0]);
            }
        }
    }
    Ok(numbers)
}

/// What cannot be answered is refused by an error that names it: 1 if so.
fn refusals(settings: &Settings, rows: &mut Vec<Checked>) {
    let fog = |tau: f64, albedo: f64, g: f64| {
        slab(Fog { tau, albedo, g }, Incidence::Beam { mu0: 1.0 }, 1.0).map(|_| ())
    };
    let ball = |distance: f64| furnace_ball(DVec3::X * distance, 0.0).map(|_| ());
    let asked: Vec<(&str, turbid::Result<()>, &str)> = vec![
        ("a map of no emitted photon", PhotonMap::new(Vec::new(), 0).map(|_| ()), "emitted"),
        ("k = 0", Gather::nearest(0, 1.0).map(|_| ()), "k is 0"),
        ("k = 1", Gather::nearest(1, 1.0).map(|_| ()), "k is 1"),
        ("gather radius 0", Gather::radius(0.0).map(|_| ()), "radius"),
        ("gather radius infinite", Gather::radius(f64::INFINITY).map(|_| ()), "radius"),
        ("gather radius not a number", Gather::radius(f64::NAN).map(|_| ()), "radius"),
        ("albedo 1 + 2^-52", fog(1.0, 1.0 + f64::EPSILON, 0.0), "albedo"),
        ("albedo -1e-300", fog(1.0, -1e-300, 0.0), "albedo"),
        ("asymmetry 1", fog(1.0, 0.5, 1.0), "g"),
        ("asymmetry -1", fog(1.0, 0.5, -1.0), "g"),
        ("thickness 0", fog(0.0, 0.5, 0.0), "thickness"),
        ("thickness not a number", fog(f64::NAN, 0.5, 0.0), "thickness"),
        ("thickness of 2e9 mean free paths", fog(2e9, 0.5, 0.0), "mean free path"),
        ("2e9 mean free paths from the origin", ball(2e9), "mean free path"),
        ("a beam along the faces without edge", beam_without_edge(), "along the faces"),
    ];
    for (name, answer, word) in asked {
        let is_refused = answer.is_err_and(|error| error.to_string().contains(word));
        rows.push(Checked::new(Class::Refusal, name, f64::from(u8::from(is_refused)), 1.0, 0.0));
    }
    // No history at all is an answer: nothing, of unknown error.
    let empty =
        slab(Fog { tau: 1.0, albedo: 0.5, g: 0.0 }, Incidence::Beam { mu0: 1.0 }, 1.0).and_then(|scene| {
            let sensors = [sensor(&scene, Flux::Reflected, Orders::ALL)];
            let histories = Histories { count: 0, seed: settings.seed, replicate: 0, max_order: None };
            shoot(&scene, histories, &sensors, |_| true, &NoProgress)
        });
    let is_empty = empty.is_ok_and(|pass| {
        pass.emitted() == 0 && pass.photons().next().is_none() && pass.tallies[0][0].std_error().is_infinite()
    });
    let name = "no histories: nothing, of infinite error";
    rows.push(Checked::new(Class::Number, name, f64::from(u8::from(is_empty)), 1.0, 0.0));
}

fn beam_without_edge() -> turbid::Result<()> {
    use turbid::Spectrum;
    use turbid::light::{Beam, Light, Section};
    use turbid::scene::{Scene, SceneParts};
    let lit = slab(Fog { tau: 1.0, albedo: 0.5, g: 0.0 }, Incidence::Beam { mu0: 1.0 }, 1.0)?;
    let lights = vec![Light::Beam(Beam::new(DVec3::X, Spectrum::ONE, Section::Unbounded)?)];
    Scene::new(SceneParts {
        regions: lit.regions().to_vec(),
        lights,
        cell: Some(glam::DVec2::splat(4.0)),
        ..SceneParts::default()
    })
    .map(|_| ())
}
