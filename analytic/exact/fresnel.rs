//! `exact slab --index`: the slab between refracting faces.

use crate::answer::Answer;
use crate::method::Method;
use crate::phase::Named;
use crate::plot::{Curve, crowded, figure, panel};
use crate::question::Solved;
use crate::read::{incidence_field, incidence_title};
use crate::unit::Unit;
use anyhow::{Result, bail};
use std::rc::Rc;
use turbid_analytic::slab_fresnel::hemispherical_reflectance;
use turbid_analytic::{FresnelSlab, Incidence};
use turbid_figure::{Axis, Figure};

/// A slab between refracting faces.
pub struct Refracting<'a> {
    /// Optical thickness.
    pub tau: f64,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Refractive index inside over outside.
    pub index: f64,
    /// How the light falls.
    pub incidence: Incidence,
    /// How it is solved.
    pub method: Method,
    /// Depths.
    pub depth: &'a [f64],
}

impl Refracting<'_> {
    fn solve(&self, named: &Named, solved: &Solved) -> Result<Rc<FresnelSlab>> {
        let Refracting { tau, albedo, index, incidence, method, .. } = *self;
        solved.once((tau, albedo, &named.name, index, incidence, method), || {
            Ok(match method {
                Method::Auto | Method::Ordinates => {
                    FresnelSlab::with_phase(tau, albedo, &named.phase, index, incidence)?
                }
                Method::Doubling => FresnelSlab::by_doubling(tau, albedo, &named.phase, index, incidence)?,
                Method::Peierls => {
                    bail!("--method is peierls; allowed with --index: auto, ordinates, doubling")
                }
            })
        })
    }

    /// Gives fluxes, and fluence at the depths.
    pub fn answer(&self, named: &Named, answer: &mut Answer, solved: &Solved) -> Result<()> {
        let slab = self.solve(named, solved)?;
        answer
            .of("slab")
            .with("tau", self.tau)
            .with("albedo", self.albedo)
            .with("phase", named.name.as_str())
            .with("index", self.index)
            .with("mu0", incidence_field(self.incidence));
        let power = Unit::IncidentPower;
        answer.add("specular", power, &[], slab.specular());
        let face = |from_outside| Ok(hemispherical_reflectance(self.index, from_outside)?);
        answer.ask("face_reflectance_outside", Unit::One, &[], || face(true))?;
        answer.ask("face_reflectance_inside", Unit::One, &[], || face(false))?;
        answer.add("reflectance", power, &[], slab.reflectance());
        answer.add("reflectance_diffuse", power, &[], slab.reflectance_diffuse());
        answer.add("transmittance", power, &[], slab.transmittance());
        answer.add("transmittance_direct", power, &[], slab.transmittance_direct());
        answer.add("transmittance_diffuse", power, &[], slab.transmittance_diffuse());
        answer.add("absorptance", power, &[], slab.absorptance());
        for &t in self.depth {
            answer.ask("fluence", Unit::Irradiance, &[("t", t.into())], || Ok(slab.fluence(t)?))?;
        }
        Ok(())
    }

    /// The fluence against depth.
    pub fn figure(&self, named: &Named, solved: &Solved) -> Result<Figure> {
        let slab = self.solve(named, solved)?;
        let curve = Curve::sample("", &crowded(self.tau, 121), |t| Ok(slab.fluence(t)?.value))?;
        let (named, light) = (&named.name, incidence_title(self.incidence));
        let title =
            format!("Slab τ = {}, albedo {}, {named}, index {}, {light}", self.tau, self.albedo, self.index);
        let axis = Axis::linear("Depth t", "mean free paths");
        Ok(figure(title, panel(axis, "Fluence over irradiance", "", vec![curve])))
    }
}
