//! `exact emitting-cube`: the cube of Burns and Christon.

use crate::answer::Answer;
use crate::plot::{Curve, even, figure, panel};
use crate::question::{Question, Solved};
use crate::read::place;
use crate::unit::Unit;
use anyhow::{Result, ensure};
use turbid_analytic::EmittingCube;
use turbid_figure::{Axis, Figure};

/// A unit cube that absorbs and emits at one temperature between cold black walls: fluence, divergence of the flux, flux into the walls.
///
/// With the absorption coefficient kappa = peak (1-2|x-1/2|)(1-2|y-1/2|)(1-2|z-1/2|) + base per side, sigma T^4 = 1 and tau the optical
/// depth from a place to the wall,
///
///   phi = 4 - (1/pi) int e^(-tau) dOmega,   div q = kappa (4 - phi),   q_wall = 1 - (1/pi) int e^(-tau) cos(theta) dOmega
///
/// fluence and flux in units of sigma T^4, the divergence in that per side. `flux` is given where the place lies on a wall (of an edge, on the
/// wall across the first axis).
/// Source: Burns and Christon 1997.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// Absorption in the middle above that at the walls, per side, 0 to 10.
    #[arg(long, default_value_t = 0.9, allow_negative_numbers = true)]
    peak: f64,
    /// Absorption at the walls, per side, 0 to 10.
    #[arg(long, default_value_t = 0.1, allow_negative_numbers = true)]
    base: f64,
    /// A place x,y,z in the cube, coordinates 0 to 1. Once for each place.
    #[arg(long, required = true, value_parser = place, value_name = "X,Y,Z", allow_negative_numbers = true)]
    at: Vec<Vec<f64>>,
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, _: &Solved) -> Result<()> {
        let cube = EmittingCube::new(self.peak, self.base)?;
        answer.of("emitting-cube").with("peak", self.peak).with("base", self.base);
        for at in &self.at {
            ensure!(at.len() == 3, "--at has {} coordinates; allowed: 3", at.len());
            let place = [at[0], at[1], at[2]];
            let at = [("x", at[0].into()), ("y", at[1].into()), ("z", at[2].into())];
            answer.add("fluence", Unit::BlackExitance, &at, cube.fluence(place)?);
            answer.add("divergence", Unit::BlackExitancePerSide, &at, cube.divergence(place)?);
            if place.iter().any(|&x| x == 0.0 || x == 1.0) {
                answer.add("flux", Unit::BlackExitance, &at, cube.wall_flux(place)?);
            }
        }
        Ok(())
    }

    /// The divergence along the middle.
    fn figure(&self, _: &Solved) -> Result<Figure> {
        let cube = EmittingCube::new(self.peak, self.base)?;
        let curve = Curve::sample("", &even(0.0, 1.0, 61), |x| Ok(cube.divergence([x, 0.5, 0.5])?.value))?;
        let title = format!("Emitting cube, peak {}, base {}", self.peak, self.base);
        let axis = Axis::linear("x, at y = z = 1/2", "sides");
        Ok(figure(title, panel(axis, "Divergence of the flux", "σT⁴/side", vec![curve])))
    }
}
