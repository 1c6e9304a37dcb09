//! The problems of version 1: what is given, what is asked, and what the referee says.
//!
//! Media have the extinction 1, so that lengths are mean free paths, except where a sphere or an infinite medium says otherwise.

use super::question::{Asked, Problem, scaled};
use rayon::prelude::*;
use std::f64::consts::PI;
use turbid_analytic::{
    FresnelSlab, Ground, Incidence, InfiniteMedium, Layer, Phase, Slab, SlabMedium, Sphere, SphereSource,
    StratifiedSlab, Value,
};

const FRACTION: &str = "incident power";
const IRRADIANCE: &str = "irradiance";
const RADIANCE: &str = "irradiance/sr";

/// All problems, in the order of the tables.
///
/// # Errors
/// Those of the referee
pub fn problems() -> anyhow::Result<Vec<Problem>> {
    let solvers: Vec<fn() -> anyhow::Result<Vec<Problem>>> =
        vec![slabs, peaked_slabs, layered, thermal, refracting, spheres, infinite, furnaces];
    let found: Vec<_> = solvers.into_par_iter().map(|solve| solve()).collect();
    Ok(found.into_iter().collect::<anyhow::Result<Vec<_>>>()?.into_iter().flatten().collect())
}

/// How a medium scatters.
#[derive(Clone, Copy)]
enum Scattering {
    Isotropic,
    HenyeyGreenstein(f64),
    Rayleigh,
}

use Scattering::{HenyeyGreenstein, Isotropic, Rayleigh};

impl Scattering {
    fn name(self) -> String {
        match self {
            Isotropic => "iso".into(),
            HenyeyGreenstein(g) => format!("hg{g}"),
            Rayleigh => "rayleigh".into(),
        }
    }

    fn words(self) -> String {
        match self {
            Isotropic => "isotropic scattering".into(),
            HenyeyGreenstein(g) => format!("Henyey-Greenstein scattering of g = {g}"),
            Rayleigh => "Rayleigh scattering (scalar)".into(),
        }
    }

    fn phase(self) -> anyhow::Result<Phase> {
        Ok(match self {
            Isotropic => Phase::isotropic(),
            HenyeyGreenstein(g) => Phase::henyey_greenstein(g)?,
            Rayleigh => Phase::rayleigh(),
        })
    }

    fn toml(self) -> String {
        match self {
            Isotropic => "g = 0.0".into(),
            HenyeyGreenstein(g) => format!("g = {g:?}"),
            Rayleigh => "phase = { rayleigh = {} }".into(),
        }
    }
}

/// The light on a slab, in a scene.
fn light(incidence: Incidence, shape: &str) -> String {
    match incidence {
        Incidence::Beam { mu0 } => {
            let sine = libm::sqrt(1.0 - mu0 * mu0);
            let irradiance = 1.0 / mu0;
            format!(
                "\n[[lights]]\nbeam = {{ dir = [{sine:?}, 0.0, {mu0:?}], irradiance = {irradiance:?}, section = \"unbounded\" }}\n"
            )
        }
        Incidence::Diffuse => format!(
            "\n[[lights]]\nisotropic = {{ shape = {shape}, radiance = {:?}, faces = \"top\" }}\n",
            1.0 / PI
        ),
    }
}

fn light_name(incidence: Incidence) -> String {
    match incidence {
        Incidence::Beam { mu0 } => format!("mu{mu0}"),
        Incidence::Diffuse => "diffuse".into(),
    }
}

fn light_words(incidence: Incidence) -> String {
    match incidence {
        Incidence::Beam { mu0 } => {
            format!("a beam of cosine {mu0} to the normal and irradiance 1 on the face")
        }
        Incidence::Diffuse => "diffuse light of radiance 1/pi and irradiance 1 on the face".into(),
    }
}

fn slab_shape(top: f64, thickness: f64) -> String {
    format!("{{ slab = {{ top = {top:?}, thickness = {thickness:?} }} }}")
}

fn region(shape: &str, scattering: Scattering, albedo: f64) -> String {
    format!("\n[[regions]]\nshape = {shape}\nsigma_t = 1.0\nalbedo = {albedo:?}\n{}\n", scattering.toml())
}

/// A side of the cell wide enough that its size is of no matter to the lookups in it.
fn cell(tau: f64) -> f64 {
    tau.max(1.0)
}

/// What leaves through a face of a shape.
fn outflow(shape: &str, face: &str) -> String {
    format!("measure = {{ outflow = {{ shape = {shape}, face = \"{face}\" }} }}")
}

fn absorbed(region: usize) -> String {
    format!("measure = {{ absorbed = {{ region = {region} }} }}")
}

fn fluence_at(t: f64) -> String {
    format!("measure = {{ fluence = {{ at = [0.5, 0.5, {t:?}] }} }}")
}

/// Looks against light that travels at a cosine, positive upwards, and at an azimuth \[degrees\] from the beam's.
fn radiance_at(t: f64, mu: f64, azimuth: f64) -> String {
    let sine = libm::sqrt(1.0 - mu * mu);
    let (sin, cos) = if azimuth == 180.0 { (0.0, -1.0) } else { libm::sincos(azimuth.to_radians()) };
    // No negative zeros in a file that people read.
    let (x, y) = (0.0 - sine * cos, 0.0 - sine * sin);
    format!("measure = {{ radiance = {{ origin = [0.5, 0.5, {t:?}], dir = [{x:?}, {y:?}, {mu:?}] }} }}")
}

/// The same without light that was not scattered.
fn scattered(sensor: String) -> String {
    sensor + "\nmin_order = 1"
}

fn ask(
    name: &str,
    words: &str,
    quantity: &'static str,
    unit: &'static str,
    value: Value,
    sensor: String,
) -> Asked {
    Asked { name: name.into(), words: words.into(), quantity, unit, value, sensor }
}

/// What is asked of a slab.
#[derive(Clone, Copy)]
enum Of {
    Reflectance,
    Transmittance,
    Diffuse,
    Absorptance,
    Fluence(f64),
    /// Leaves the lit face at a cosine and an azimuth \[degrees\].
    Up(f64, f64),
    /// Leaves the far face.
    Down(f64, f64),
}

use Of::{Absorptance, Diffuse, Down, Fluence, Reflectance, Transmittance, Up};

const R: Ends = ("reflectance", "what fraction of the incident power leaves through the lit face?");
const T: Ends = (
    "transmittance",
    "what fraction of the incident power leaves through the far face, direct light included?",
);
const D: Ends = (
    "transmittance-diffuse",
    "what fraction of the incident power leaves through the far face after one or more scatterings?",
);
const A: Ends = ("absorptance", "what fraction of the incident power is absorbed?");

/// End of a name, end of a question.
type Ends = (&'static str, &'static str);

fn slab(
    scattering: Scattering,
    tau: f64,
    albedo: f64,
    incidence: Incidence,
    asked: &[Of],
) -> anyhow::Result<Problem> {
    let medium = SlabMedium::new(albedo, &scattering.phase()?)?;
    let slab = Slab::solve(tau, &medium, incidence)?;
    let shape = slab_shape(0.0, tau);
    let turned = |azimuth: f64| match incidence {
        Incidence::Beam { mu0 } if mu0 < 1.0 => {
            (format!("-az{azimuth}"), format!(" and the azimuth {azimuth} degrees from the beam's"))
        }
        _ => (String::new(), String::new()),
    };
    let asked = asked.iter().map(|of| {
        Ok(match *of {
            Reflectance => ask(R.0, R.1, "reflectance", FRACTION, slab.reflectance(), outflow(&shape, "top")),
            Transmittance => {
                ask(T.0, T.1, "transmittance", FRACTION, slab.transmittance(), outflow(&shape, "bottom"))
            }
            Diffuse => {
                let sensor = scattered(outflow(&shape, "bottom"));
                ask(D.0, D.1, "transmittance_diffuse", FRACTION, slab.transmittance_diffuse(), sensor)
            }
            Absorptance => ask(A.0, A.1, "absorptance", FRACTION, slab.absorptance(), absorbed(0)),
            Fluence(t) => ask(
                &format!("fluence-{t}"),
                &format!("what is the fluence at the depth of {t} mean free paths, direct light included?"),
                "fluence",
                IRRADIANCE,
                slab.fluence(t)?,
                fluence_at(t),
            ),
            Up(mu, azimuth) => ask(
                &format!("radiance-up-{mu}{}", turned(azimuth).0),
                &format!("what radiance leaves the lit face at the cosine {mu} to its normal{}?", turned(azimuth).1),
                "radiance",
                RADIANCE,
                slab.radiance(0.0, mu, azimuth.to_radians())?,
                scattered(radiance_at(0.0, mu, azimuth)),
            ),
            Down(mu, azimuth) => ask(
                &format!("radiance-down-{mu}{}", turned(azimuth).0),
                &format!(
                    "what radiance of scattered light leaves the far face at the cosine {mu} to its normal{}?",
                    turned(azimuth).1
                ),
                "radiance",
                RADIANCE,
                slab.radiance(tau, -mu, azimuth.to_radians())?,
                scattered(radiance_at(tau, -mu, azimuth)),
            ),
        })
    });
    Ok(Problem {
        name: format!("slab-{}-t{tau}-w{albedo}-{}", scattering.name(), light_name(incidence)),
        words: format!(
            "Homogeneous slab of optical thickness {tau}, albedo {albedo}, {}, under {}",
            scattering.words(),
            light_words(incidence)
        ),
        asked: asked.collect::<anyhow::Result<_>>()?,
        scene: format!(
            "cell = {:?}\n{}{}",
            cell(tau),
            region(&shape, scattering, albedo),
            light(incidence, &shape)
        ),
    })
}

fn beam(mu0: f64) -> Incidence {
    Incidence::Beam { mu0 }
}

fn slabs() -> anyhow::Result<Vec<Problem>> {
    let diffuse = Incidence::Diffuse;
    Ok(vec![
        slab(
            Isotropic,
            1.0,
            0.9,
            beam(1.0),
            &[Reflectance, Diffuse, Absorptance, Fluence(0.5), Up(0.5, 0.0), Down(0.5, 0.0)],
        )?,
        slab(Isotropic, 0.01, 0.9, beam(0.1), &[Reflectance, Diffuse, Absorptance])?,
        slab(Isotropic, 10.0, 0.99, diffuse, &[Reflectance, Transmittance, Up(1.0, 0.0)])?,
        slab(Isotropic, 50.0, 1.0, beam(1.0), &[Transmittance, Fluence(25.0)])?,
        slab(HenyeyGreenstein(-0.3), 1.0, 0.9, beam(1.0), &[Reflectance, Diffuse, Up(0.5, 0.0)])?,
        slab(HenyeyGreenstein(-0.3), 50.0, 0.9, beam(0.1), &[Reflectance, Transmittance])?,
        slab(Rayleigh, 0.01, 1.0, beam(1.0), &[Reflectance])?,
        slab(Rayleigh, 1.0, 1.0, beam(0.5), &[Reflectance, Up(0.5, 0.0), Up(0.5, 180.0)])?,
        slab(Rayleigh, 10.0, 0.9, diffuse, &[Reflectance, Transmittance])?,
    ])
}

fn peaked_slabs() -> anyhow::Result<Vec<Problem>> {
    let g = HenyeyGreenstein;
    Ok(vec![
        slab(
            g(0.5),
            1.0,
            0.9,
            beam(0.5),
            &[Reflectance, Diffuse, Fluence(0.5), Up(0.5, 0.0), Up(0.5, 180.0)],
        )?,
        slab(g(0.5), 10.0, 0.5, beam(1.0), &[Reflectance, Transmittance])?,
        slab(
            g(0.75),
            1.0,
            0.9,
            beam(1.0),
            &[Reflectance, Diffuse, Fluence(0.5), Up(0.5, 0.0), Down(0.5, 0.0)],
        )?,
        slab(g(0.75), 10.0, 1.0, beam(0.5), &[Transmittance])?,
        slab(g(0.75), 50.0, 0.99, beam(1.0), &[Reflectance, Fluence(5.0)])?,
        slab(g(0.75), 50.0, 1.0, Incidence::Diffuse, &[Transmittance])?,
        slab(g(0.9), 0.01, 1.0, beam(1.0), &[Reflectance])?,
        slab(g(0.9), 1.0, 0.9, beam(0.5), &[Reflectance, Diffuse])?,
        slab(g(0.9), 10.0, 0.99, beam(1.0), &[Reflectance, Absorptance, Fluence(5.0), Up(1.0, 0.0)])?,
        slab(g(0.9), 10.0, 0.5, Incidence::Diffuse, &[Reflectance, Transmittance])?,
    ])
}

/// Clear space between layers, and over the ground: of no matter between planes without end. A scene has layers as interiors of
/// index 1, since two surfaces are not in one place.
const GAP: f64 = 0.5;

/// Layers over a Lambertian ground.
fn over_ground(
    name: &str,
    layers: &[(f64, f64, Scattering)],
    reflectance: f64,
    mu0: f64,
    depth: Option<f64>,
) -> anyhow::Result<Problem> {
    let mut made = Vec::new();
    let mut scene = String::new();
    let mut words = Vec::new();
    let mut top = 0.0;
    for (i, &(tau, albedo, scattering)) in layers.iter().enumerate() {
        made.push(Layer::new(tau, albedo, &scattering.phase()?)?);
        let shape = slab_shape(top, tau);
        scene += &format!(
            "\n[[interiors]]\nname = \"layer {0}\"\nindex = 1.0\nsigma_t = 1.0\nalbedo = {albedo:?}\n{1}\n\n[[objects]]\nshape = {shape}\n\
             surface = {{ dielectric = {{ inside = \"layer {0}\" }} }}\n",
            i + 1,
            scattering.toml()
        );
        words.push(format!("optical thickness {tau}, albedo {albedo}, {}", scattering.words()));
        top += tau + GAP;
    }
    let slab = StratifiedSlab::new(&made, Ground::lambertian(reflectance)?, Some(beam(mu0)))?;
    // From the middle of the gap above the layers to that of the gap over the ground.
    let whole = slab_shape(-0.5 * GAP, top);
    scene += &format!(
        "\n[[objects]]\nshape = {}\nsurface = {{ lambertian = {{ reflectance = {reflectance:?} }} }}\n",
        slab_shape(top, 1.0)
    );
    let mut asked = vec![
        ask(R.0, R.1, "reflectance", FRACTION, slab.reflectance(), outflow(&whole, "top")),
        ask(
            "ground-diffuse",
            "what power, over the incident, arrives at the ground after one or more scatterings or reflections?",
            "transmittance_diffuse",
            FRACTION,
            slab.transmittance_diffuse(),
            scattered(outflow(&whole, "bottom")),
        ),
    ];
    // Photons tally what layers absorb, paths measure fluences and radiances: a scene is answered by one of them.
    if let Some(depth) = depth {
        let gaps = slab.depths().iter().filter(|&&interface| interface > 0.0 && interface < depth).count();
        asked.push(ask(
            &format!("fluence-{depth}"),
            &format!("what is the fluence at the depth of {depth} mean free paths, direct light included?"),
            "fluence",
            IRRADIANCE,
            slab.fluence(depth)?,
            fluence_at(depth + GAP * gaps as f64),
        ));
        let radiance = slab.radiance(0.0, &[0.5])?[0];
        asked.push(ask(
            "radiance-up-0.5",
            "what radiance leaves the lit face at the cosine 0.5 to its normal?",
            "radiance",
            RADIANCE,
            radiance,
            scattered(radiance_at(-0.5 * GAP, 0.5, 0.0)),
        ));
    } else {
        for layer in 0..layers.len() {
            asked.push(ask(
                &format!("absorptance-{}", layer + 1),
                &format!("what fraction of the incident power does layer {} absorb?", layer + 1),
                "absorptance",
                FRACTION,
                slab.absorptance(layer)?,
                absorbed(layer),
            ));
        }
    }
    Ok(Problem {
        name: format!("layers-{name}"),
        words: format!(
            "Layers from the lit face down ({}) over a Lambertian ground of reflectance {reflectance}, under {}",
            words.join("; "),
            light_words(beam(mu0))
        ),
        scene: format!("cell = {:?}\n{scene}{}", cell(top), light(beam(mu0), &whole)),
        asked,
    })
}

fn layered() -> anyhow::Result<Vec<Problem>> {
    Ok(vec![
        over_ground("haze", &[(1.0, 0.9, HenyeyGreenstein(0.75)), (0.5, 0.5, Isotropic)], 0.3, 0.5, None)?,
        over_ground(
            "cloud",
            &[
                (0.1, 0.999, Rayleigh),
                (10.0, 0.99, HenyeyGreenstein(0.75)),
                (0.2, 0.9, HenyeyGreenstein(0.5)),
            ],
            0.8,
            1.0,
            Some(5.1),
        )?,
    ])
}

/// A layer that emits, in the dark.
fn thermal() -> anyhow::Result<Vec<Problem>> {
    let (tau, albedo, scattering) = (2.0, 0.5, HenyeyGreenstein(0.5));
    // Planck radiance 1: 4 pi (1-w) starts per volume.
    let emission = 4.0 * PI * (1.0 - albedo);
    let layer = Layer::new(tau, albedo, &scattering.phase()?)?.emitting(emission)?;
    let slab = StratifiedSlab::new(&[layer], Ground::black(), None)?;
    let radiances = slab.radiance(0.0, &[1.0, 0.1])?;
    let shape = slab_shape(0.0, tau);
    let radiance = |mu: f64, value: Value| {
        ask(
            &format!("radiance-up-{mu}"),
            &format!(
                "what radiance leaves a face at the cosine {mu} to its normal, over that of a black body?"
            ),
            "radiance",
            "black-body radiance",
            value,
            radiance_at(0.0, mu, 0.0),
        )
    };
    Ok(vec![Problem {
        name: "thermal-hg0.5-t2-w0.5".into(),
        words: format!(
            "Slab of optical thickness {tau}, albedo {albedo}, {} and one temperature, whose black body has the radiance 1, in the dark",
            scattering.words()
        ),
        scene: format!(
            "cell = 1.0\n{}emission = {:?}\n",
            region(&shape, scattering, albedo),
            emission / (4.0 * PI)
        ),
        asked: vec![
            ask(
                "escape-top",
                "what fraction of the power that the medium emits leaves through one face?",
                "escape",
                "emitted power",
                scaled(slab.reflectance(), 1.0 / (emission * tau)),
                outflow(&shape, "top"),
            ),
            ask(
                "fluence-1",
                "what is the fluence in the middle, over the radiance of a black body?",
                "fluence",
                "black-body radiance",
                slab.fluence(1.0)?,
                fluence_at(1.0),
            ),
            radiance(1.0, radiances[0]),
            radiance(0.1, radiances[1]),
        ],
    }])
}

fn refracting_slab(
    tau: f64,
    albedo: f64,
    g: f64,
    index: f64,
    incidence: Incidence,
) -> anyhow::Result<Problem> {
    let slab = FresnelSlab::new(tau, albedo, g, index, incidence)?;
    let scattering = if g == 0.0 { Isotropic } else { HenyeyGreenstein(g) };
    // Light starts from around the faces, and is counted there.
    let around = slab_shape(-0.5 * tau, 2.0 * tau);
    let asked = vec![
        ask(
            R.0,
            "what fraction of the incident power leaves on the lit side, mirrored light included?",
            "reflectance",
            FRACTION,
            slab.reflectance(),
            outflow(&around, "top"),
        ),
        ask(
            "reflectance-diffuse",
            "what fraction of the incident power leaves on the lit side after one or more scatterings?",
            "reflectance_diffuse",
            FRACTION,
            slab.reflectance_diffuse(),
            scattered(outflow(&around, "top")),
        ),
        ask(
            T.0,
            "what fraction of the incident power leaves on the far side, direct light included?",
            "transmittance",
            FRACTION,
            slab.transmittance(),
            outflow(&around, "bottom"),
        ),
        ask(A.0, A.1, "absorptance", FRACTION, slab.absorptance(), absorbed(0)),
    ];
    Ok(Problem {
        name: format!("glass-{}-n{index}-t{tau}-w{albedo}-{}", scattering.name(), light_name(incidence)),
        words: format!(
            "Slab of refractive index {index} with smooth faces, optical thickness {tau}, albedo {albedo}, {}, under {}",
            scattering.words(),
            light_words(incidence)
        ),
        scene: format!(
            "cell = {:?}\n\n[[interiors]]\nname = \"glass\"\nindex = {index:?}\nsigma_t = 1.0\nalbedo = {albedo:?}\n{}\n\n[[objects]]\n\
             shape = {}\nsurface = {{ dielectric = {{ inside = \"glass\" }} }}\n{}",
            cell(tau),
            scattering.toml(),
            slab_shape(0.0, tau),
            light(incidence, &around)
        ),
        asked,
    })
}

fn refracting() -> anyhow::Result<Vec<Problem>> {
    Ok(vec![
        refracting_slab(1.0, 0.9, 0.0, 1.5, Incidence::Diffuse)?,
        refracting_slab(10.0, 0.99, 0.9, 1.33, beam(1.0))?,
    ])
}

const ESCAPE: Ends = ("escape", "what fraction of the power leaves the sphere?");

fn ball(
    radius: f64,
    albedo: f64,
    source: SphereSource,
    fluences: &[f64],
    mu: f64,
) -> anyhow::Result<Problem> {
    let sphere = Sphere::new(radius, albedo, source)?;
    let body = format!("{{ sphere = {{ center = [0.0, 0.0, 0.0], radius = {radius:?} }} }}");
    let (name, words, units, lamp) = match source {
        SphereSource::Uniform => (
            "uniform",
            "whose volume emits the power 1 evenly and in all directions".to_string(),
            ["emitted power", "power/mfp^2", "power/(mfp^2 sr)"],
            format!(
                "volume-source = {{ shape = {body}, density = {:?} }}",
                0.75 / (PI * radius * radius * radius)
            ),
        ),
        SphereSource::Centre => (
            "centre",
            "with an isotropic point source of power 1 at its centre".to_string(),
            ["emitted power", "power/mfp^2", "power/(mfp^2 sr)"],
            "point = { position = [0.0, 0.0, 0.0], power = 1.0 }".to_string(),
        ),
        SphereSource::Incident => (
            "incident",
            "lit from outside by the radiance 1/pi from all directions, irradiance 1".to_string(),
            [FRACTION, IRRADIANCE, RADIANCE],
            format!("isotropic = {{ shape = {body}, radiance = {:?}, faces = \"both\" }}", 1.0 / PI),
        ),
    };
    let mut asked = vec![ask(ESCAPE.0, ESCAPE.1, "escape", units[0], sphere.escape(), outflow(&body, "top"))];
    for &r in fluences {
        asked.push(ask(
            &format!("fluence-{r}"),
            &format!("what is the fluence {r} mean free paths from the centre?"),
            "fluence",
            units[1],
            sphere.fluence(r)?,
            format!("measure = {{ fluence = {{ at = [0.0, {r:?}, 0.0] }} }}"),
        ));
    }
    let sine = libm::sqrt(1.0 - mu * mu);
    let origin = [sine, 0.0, radius + mu];
    let words_of = match source {
        SphereSource::Centre => "what radiance of scattered light",
        SphereSource::Uniform => "what radiance",
        SphereSource::Incident => "what radiance, of light that crossed without a collision too,",
    };
    asked.push(ask(
        &format!("radiance-{mu}"),
        &format!("{words_of} leaves the surface at the cosine {mu} to its normal?"),
        "radiance",
        units[2],
        sphere.exit_radiance(mu)?,
        format!(
            "measure = {{ radiance = {{ origin = [{:?}, 0.0, {:?}], dir = [{:?}, 0.0, {:?}] }} }}",
            origin[0], origin[2], -sine, -mu
        ),
    ));
    Ok(Problem {
        name: format!("sphere-{name}-a{radius}-w{albedo}"),
        words: format!(
            "Sphere of a radius of {radius} mean free paths, albedo {albedo}, isotropic scattering, {words}"
        ),
        scene: format!("{}\n[[lights]]\n{lamp}\n", region(&body, Isotropic, albedo).trim_start()),
        asked,
    })
}

fn spheres() -> anyhow::Result<Vec<Problem>> {
    Ok(vec![
        ball(1.0, 0.9, SphereSource::Uniform, &[0.0], 0.5)?,
        ball(5.0, 0.99, SphereSource::Uniform, &[], 0.5)?,
        ball(1.0, 0.9, SphereSource::Centre, &[0.5], 0.5)?,
        ball(5.0, 0.5, SphereSource::Centre, &[], 0.5)?,
        ball(1.0, 0.9, SphereSource::Incident, &[0.0], 0.5)?,
        ball(5.0, 0.99, SphereSource::Incident, &[], 1.0)?,
    ])
}

/// Radius of the ball that stands for an infinite medium: light decays with at least 0.288 in a mean free path where the
/// albedo is 0.9 and g 0.75, so that what the rest would send back is below e^(-0.288 * 110) = 2e-14 of the power.
const FAR: f64 = 60.0;

fn infinite() -> anyhow::Result<Vec<Problem>> {
    let mut found = Vec::new();
    for (albedo, scattering, g) in
        [(0.9, Isotropic, 0.0), (0.5, Isotropic, 0.0), (0.9, HenyeyGreenstein(0.75), 0.75)]
    {
        let medium = InfiniteMedium::henyey_greenstein(albedo, g)?;
        let body = format!("{{ sphere = {{ center = [0.0, 0.0, 0.0], radius = {FAR:?} }} }}");
        let mut asked = Vec::new();
        for r in [1.0, 5.0] {
            asked.push(ask(
                &format!("fluence-{r}"),
                &format!("what is the fluence {r} mean free paths from the source?"),
                "fluence",
                "power/mfp^2",
                medium.fluence(r)?,
                format!("measure = {{ fluence = {{ at = [0.0, {r:?}, 0.0] }} }}"),
            ));
        }
        found.push(Problem {
            name: format!("infinite-{}-w{albedo}", scattering.name()),
            words: format!(
                "Infinite medium of albedo {albedo}, {}, with an isotropic point source of power 1",
                scattering.words()
            ),
            scene: format!(
                "{}\n[[lights]]\npoint = {{ position = [0.0, 0.0, 0.0], power = 1.0 }}\n",
                region(&body, scattering, albedo).trim_start()
            ),
            asked,
        });
    }
    Ok(found)
}

/// What is closed and has one temperature: the light of the black body everywhere.
fn furnaces() -> anyhow::Result<Vec<Problem>> {
    let (tau, albedo, scattering) = (2.0, 0.5, HenyeyGreenstein(0.75));
    // In the unit of the irradiance from outside: Planck radiance 1/pi.
    let emission = 4.0 * (1.0 - albedo);
    let layer = Layer::new(tau, albedo, &scattering.phase()?)?.emitting(emission)?;
    let slab = StratifiedSlab::new(&[layer], Ground::lambertian(1.0)?, Some(Incidence::Diffuse))?;
    let shape = slab_shape(0.0, tau);
    let radiance = slab.radiance(0.0, &[0.3])?[0];
    let furnace = Problem {
        name: "furnace-hg0.75-t2-w0.5".into(),
        words: format!(
            "Closed furnace: a slab of optical thickness {tau}, albedo {albedo}, {}, that emits as a black body of radiance 1/pi, over a white \
             Lambertian ground, under {}",
            scattering.words(),
            light_words(Incidence::Diffuse)
        ),
        scene: format!(
            "cell = 1.0\n{}emission = {:?}\n\n[[objects]]\nshape = {}\nsurface = {{ lambertian = {{ reflectance = 1.0 }} }}\n{}",
            region(&shape, scattering, albedo),
            emission / (4.0 * PI),
            slab_shape(tau, 1.0),
            light(Incidence::Diffuse, &shape)
        ),
        asked: vec![
            ask(
                "fluence-1",
                "what is the fluence in the middle?",
                "fluence",
                IRRADIANCE,
                slab.fluence(1.0)?,
                fluence_at(1.0),
            ),
            ask(
                "radiance-up-0.3",
                "what radiance leaves the lit face at the cosine 0.3 to its normal?",
                "radiance",
                RADIANCE,
                radiance,
                radiance_at(0.0, 0.3, 0.0),
            ),
        ],
    };
    let white = ball(2.0, 1.0, SphereSource::Incident, &[1.5], 0.5)?;
    Ok(vec![
        furnace,
        Problem {
            name: white.name.replace("sphere-incident", "furnace-sphere"),
            words: format!("Furnace: {}", white.words.replace("Sphere", "sphere")),
            ..white
        },
    ])
}
