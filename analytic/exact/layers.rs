//! `exact layers`: a stratified slab over a ground.

use crate::answer::Answer;
use crate::phase::{Named, from_file};
use crate::plot::{Curve, crowded, figure, panel};
use crate::question::{Question, Solved};
use crate::read::{incidence, incidence_field, incidence_title};
use crate::typed::{Typed, is_rounded};
use crate::unit::Unit;
use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use std::path::PathBuf;
use std::rc::Rc;
use turbid_analytic::{Ground, Incidence, Layer, Phase, StratifiedSlab};
use turbid_figure::{Axis, Figure};

/// Homogeneous layers over a ground: fluxes, absorption by layer, fluence, radiance; sources in the layers.
///
/// The azimuthal mean I of the radiance obeys, with t the depth below the lit face, mu > 0 upwards, and w, chi_l and q the
/// albedo, moments and source of the layer,
///
///   mu dI/dt = I - (w/2) int sum_l (2l+1) chi_l P_l(mu) P_l(mu') I(t, mu') dmu' - beam - q/(4 pi)
///
/// and is continuous where the index of refraction is. Elsewhere is a smooth face: Fresnel's laws for unpolarised light,
/// powers of its reflections add. Above the layers the index is 1. The ground is Lambertian (0: black) or a mirror. Powers are
/// per incident power, q is power that starts per area and mean free path over the irradiance; in the dark (--mu0 none) all
/// is in the unit of the sources. T is what arrives at the ground, R + sum A + A_ground = 1 + sum q tau.
///
/// Adding of layers that are doubled each, or discrete ordinates matched at all interfaces, on two sets of nodes. Layers
/// 1e-12 to 100 thick, 400 together; tau=0,albedo=0,index=1.5 is a clear plate of glass.
/// Source: van de Hulst 1963; Hansen and Travis 1974; Stamnes, Tsay, Wiscombe and Jayaweera 1988; Prahl, van Gemert and
/// Welch 1993.
#[derive(Debug, Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// A layer, from the lit face down, as name=value separated by commas: tau (1e-12 to 100), albedo (0 to 1); g
    /// (Henyey-Greenstein, 0 if not given), phase=rayleigh or moments=FILE; emission (0 or more, in a layer of 1e-6 or more);
    /// index (of refraction, over that above the layers, 0.25 to 4, 1 if not given). Once for each layer, or with | between them
    #[arg(verbatim_doc_comment, long, required = true, value_parser = layer, value_delimiter = '|', value_name = "tau=T,albedo=W,g=G")]
    layer: Vec<Given>,
    /// Reflectance of the ground, 0 to 1, or the word mirror, or mirror=R of reflectance R.
    #[arg(long, default_value = "0", value_parser = ground, allow_negative_numbers = true)]
    ground: Surface,
    /// Index of refraction of what lies between the last layer and the ground, 0.25 to 4; that of the layer: no gap.
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    ground_index: f64,
    /// Power per area that the ground sends out by itself, over the irradiance.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    exitance: f64,
    /// Cosine of incidence of a beam, 1e-5 to 1, or the word diffuse (Lambertian light), or none.
    #[arg(long, default_value = "1", value_parser = light, allow_negative_numbers = true)]
    mu0: Light,
    /// Depths in mean free paths, 0 to that of the ground, at which to give fluence and fluxes (direct light included)
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "T", allow_negative_numbers = true)]
    depth: Vec<f64>,
    /// Signed cosines (positive: towards the lit face), 1e-5 or more in magnitude, at which to give the mean over azimuth of
    /// the radiance, without direct light, at every depth, or without depths where the light leaves
    #[arg(verbatim_doc_comment, long, num_args = 1.., value_delimiter = ',', value_name = "MU", allow_negative_numbers = true)]
    mu: Vec<f64>,
    /// How to solve it.
    #[arg(long, value_enum, default_value = "adding")]
    method: Method,
}

/// How layers are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Method {
    /// Adding of layers.
    Adding,
    /// Discrete ordinates matched at all interfaces, the second method (a dozen layers; no radiance).
    Ordinates,
}

/// A layer as typed.
#[derive(Debug, Clone, PartialEq)]
struct Given {
    tau: f64,
    albedo: f64,
    emission: f64,
    index: f64,
    scattering: Scattering,
}

#[derive(Debug, Clone, PartialEq)]
enum Scattering {
    HenyeyGreenstein(f64),
    Rayleigh,
    Moments(PathBuf),
}

/// The light on the lit face.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Light(Option<Incidence>);

/// The ground, without its own light.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Surface {
    Lambertian(f64),
    Mirror(f64),
}

const LAYER: &str = "tau=T,albedo=W and any of g=G, phase=rayleigh, moments=FILE, emission=Q, index=N";

fn layer(text: &str) -> Result<Given, String> {
    let wrong = |what: &str| format!("layer is '{text}': {what}; allowed: {LAYER}");
    let (mut tau, mut albedo, mut emission, mut index, mut scattering) = (None, None, None, None, None);
    for pair in text.split(',') {
        let (name, value) = pair.split_once('=').ok_or_else(|| wrong(&format!("'{pair}'")))?;
        let number = || value.trim().parse::<f64>().map_err(|_| wrong(&format!("{name} is '{value}'")));
        let again = match name.trim() {
            "tau" => tau.replace(number()?).is_some(),
            "albedo" => albedo.replace(number()?).is_some(),
            "emission" => emission.replace(number()?).is_some(),
            "index" => index.replace(number()?).is_some(),
            "g" => scattering.replace(Scattering::HenyeyGreenstein(number()?)).is_some(),
            "phase" if value == "rayleigh" => scattering.replace(Scattering::Rayleigh).is_some(),
            "moments" => scattering.replace(Scattering::Moments(value.into())).is_some(),
            _ => return Err(wrong(&format!("'{pair}'"))),
        };
        if again {
            return Err(wrong("said twice"));
        }
    }
    Ok(Given {
        tau: tau.ok_or_else(|| wrong("no tau"))?,
        albedo: albedo.ok_or_else(|| wrong("no albedo"))?,
        emission: emission.unwrap_or(0.0),
        index: index.unwrap_or(1.0),
        scattering: scattering.unwrap_or(Scattering::HenyeyGreenstein(0.0)),
    })
}

fn light(text: &str) -> Result<Light, String> {
    let named = |text| format!("mu0 is '{text}'; allowed: a number from 1e-5 to 1, diffuse, or none");
    if text == "none" {
        return Ok(Light(None));
    }
    incidence(text).map(|light| Light(Some(light))).map_err(|_| named(text))
}

fn ground(text: &str) -> Result<Surface, String> {
    let number = |text: &str| text.parse::<f64>().ok();
    let found = match text.strip_prefix("mirror") {
        Some("") => Some(Surface::Mirror(1.0)),
        Some(rest) => rest.strip_prefix('=').and_then(number).map(Surface::Mirror),
        None => number(text).map(Surface::Lambertian),
    };
    found.ok_or_else(|| format!("ground is '{text}'; allowed: a number from 0 to 1, mirror, or mirror=R"))
}

impl Given {
    fn named(&self) -> Result<Named> {
        match &self.scattering {
            Scattering::HenyeyGreenstein(g) => Named::henyey_greenstein(*g),
            Scattering::Rayleigh => {
                Ok(Named { phase: Phase::rayleigh(), name: "Rayleigh".into(), single_g: None })
            }
            Scattering::Moments(path) => from_file(path),
        }
    }

    fn layer(&self) -> Result<Layer> {
        let layer = Layer::new(self.tau, self.albedo, &self.named()?.phase)?;
        Ok(layer.emitting(self.emission)?.refracting(self.index)?)
    }

    fn words(&self) -> Result<String> {
        let emission =
            if self.emission > 0.0 { format!(" emission {}", self.emission) } else { String::new() };
        let index = if self.index != 1.0 { format!(" index {}", self.index) } else { String::new() };
        if self.tau == 0.0 {
            return Ok(format!("clear plate{index}"));
        }
        Ok(format!("tau {} albedo {} {}{emission}{index}", self.tau, self.albedo, self.named()?.name))
    }
}

impl Args {
    fn slab(&self, solved: &Solved) -> Result<Rc<StratifiedSlab>> {
        solved.once(
            (&self.layer, self.ground, self.ground_index, self.exitance, self.mu0, self.method),
            || {
                let numbered =
                    |(i, given): (usize, &Given)| given.layer().with_context(|| format!("layer {}", i + 1));
                let layers = self.layer.iter().enumerate().map(numbered).collect::<Result<Vec<_>>>()?;
                let ground = match self.ground {
                    Surface::Lambertian(reflectance) => Ground::lambertian(reflectance)?,
                    Surface::Mirror(reflectance) if self.exitance == 0.0 => Ground::specular(reflectance)?,
                    Surface::Mirror(_) => {
                        bail!("--exitance is {}; allowed with --ground mirror: 0", self.exitance)
                    }
                };
                let below = |ground: Ground| ground.within(self.ground_index).context("--ground-index");
                let ground = below(ground.emitting(self.exitance)?)?;
                Ok(match self.method {
                    Method::Adding => StratifiedSlab::new(&layers, ground, self.mu0.0)?,
                    Method::Ordinates => StratifiedSlab::by_ordinates(&layers, ground, self.mu0.0)?,
                })
            },
        )
    }

    fn tau(&self) -> f64 {
        self.layer.iter().map(|layer| layer.tau).sum()
    }

    /// Radiances by depth, all cosines of one at once.
    fn add_radiances(&self, slab: &StratifiedSlab, answer: &mut Answer) -> Result<()> {
        ensure!(
            self.mu.is_empty() || self.method == Method::Adding,
            "--method is ordinates; allowed with --mu: adding"
        );
        let faces = [0.0, slab.tau()];
        let depths = if self.depth.is_empty() { faces.as_slice() } else { &self.depth };
        for &t in depths {
            let leaves = |mu: f64| !self.depth.is_empty() || (mu > 0.0) == (t == 0.0);
            let cosines: Vec<f64> = self.mu.iter().copied().filter(|&mu| leaves(mu)).collect();
            if cosines.is_empty() {
                continue;
            }
            for (value, mu) in slab.radiance(t, &cosines)?.into_iter().zip(cosines) {
                answer.add("radiance", Unit::IrradiancePerSr, &[("t", t.into()), ("mu", mu.into())], value);
            }
        }
        Ok(())
    }
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let slab = self.slab(solved)?;
        let words = self.layer.iter().map(Given::words).collect::<Result<Vec<_>>>()?;
        answer.of("layers").with("layers", words.join(" | "));
        match self.ground {
            Surface::Lambertian(reflectance) => answer.with("ground", reflectance),
            Surface::Mirror(1.0) => answer.with("ground", "mirror"),
            Surface::Mirror(reflectance) => answer.with("ground", format!("mirror {reflectance}")),
        };
        if self.ground_index != 1.0 {
            answer.with("ground_index", self.ground_index);
        }
        if self.exitance > 0.0 {
            answer.with("exitance", self.exitance);
        }
        match self.mu0.0 {
            Some(light) => answer.with("mu0", incidence_field(light)),
            None => answer.with("mu0", "none"),
        };
        let power = Unit::IncidentPower;
        answer.add("reflectance", power, &[], slab.reflectance());
        if self.ground_index != 1.0 || self.layer.iter().any(|layer| layer.index != 1.0) {
            answer.add("specular", power, &[], slab.specular()?);
            answer.add("reflectance_direct", power, &[], slab.reflectance_direct());
            answer.add("reflectance_diffuse", power, &[], slab.reflectance_diffuse());
        }
        answer.add("transmittance", power, &[], slab.transmittance()?);
        answer.add("transmittance_direct", power, &[], slab.transmittance_direct()?);
        answer.add("transmittance_diffuse", power, &[], slab.transmittance_diffuse());
        answer.add("absorptance_ground", power, &[], slab.absorptance_ground()?);
        for (i, number) in (0..self.layer.len()).zip(1_u64..) {
            answer.add("absorptance", power, &[("layer", number.into())], slab.absorptance(i)?);
            answer.add("mean_fluence", Unit::Irradiance, &[("layer", number.into())], slab.mean_fluence(i)?);
        }
        for &t in &self.depth {
            let at = [("t", t.into())];
            answer.add("fluence", Unit::Irradiance, &at, slab.fluence(t)?);
            answer.add("flux_down", Unit::Irradiance, &at, slab.flux_down(t)?);
            answer.add("flux_up", Unit::Irradiance, &at, slab.flux_up(t)?);
            answer.add("flux", Unit::Irradiance, &at, slab.flux(t)?);
        }
        self.add_radiances(&slab, answer)
    }

    /// Fluence against depth.
    fn figure(&self, solved: &Solved) -> Result<Figure> {
        let slab = self.slab(solved)?;
        let mut depths = vec![0.0];
        for pair in slab.depths().windows(2) {
            depths.extend(
                crowded(pair[1] - pair[0], 41).into_iter().skip(1).map(|x| (pair[0] + x).min(pair[1])),
            );
        }
        let curve = Curve::sample("", &depths, |t| Ok(slab.fluence(t)?.value))?;
        let light = self.mu0.0.map_or("no light from outside".into(), incidence_title);
        let ground = match self.ground {
            Surface::Lambertian(reflectance) => format!("ground {reflectance}"),
            Surface::Mirror(1.0) => "a mirror below".into(),
            Surface::Mirror(reflectance) => format!("a mirror of {reflectance} below"),
        };
        let count = match self.layer.len() {
            1 => "One layer".into(),
            n => format!("{n} layers"),
        };
        let axis = Axis::linear("Depth t", "mean free paths");
        let panel = panel(axis, "Fluence over irradiance", "", vec![curve]);
        Ok(figure(format!("{count}, τ = {}, {ground}, {light}", self.tau()), panel))
    }

    /// As much as all layers together: what rounding an albedo does goes as 1/(1-w).
    fn typed(&self) -> Option<Typed> {
        let rounded = self.layer.iter().map(|layer| layer.albedo).filter(|&w| w < 1.0 && is_rounded(w));
        let sum: f64 = rounded.map(|w| 1.0 / (1.0 - w)).sum();
        let g = |layer: &Given| match layer.scattering {
            Scattering::HenyeyGreenstein(g) if is_rounded(g) => Some(g.abs()),
            _ => None,
        };
        Some(Typed {
            albedo: (sum > 0.0).then(|| 1.0 - 1.0 / sum),
            g: self.layer.iter().filter_map(g).reduce(f64::max),
            size: Some(self.tau()),
            places: self.depth.clone(),
            ..Typed::default()
        })
    }
}
