//! The half-space and the infinite medium against their reference tables, row by row.

use crate::support::table::{Row, check, number, rows};
use turbid_analytic::half_space::hopf_constant;
use turbid_analytic::{HalfSpace, Incidence, InfiniteMedium, Value};

fn whole_table(file: &str, count: usize, answer: impl Fn(&Row) -> Value) {
    for row in rows(file, count) {
        let got = answer(&row);
        check(&row, got);
        assert!(got.error < 1e-13 * number(&row, "value").abs(), "{row:?}: {got:?}");
    }
}

#[test]
fn half_space() {
    whole_table("halfspace_H.csv", 30, |row| {
        let quantity = row["quantity"].as_str();
        if quantity == "hopf_q_inf" {
            return hopf_constant();
        }
        let space = HalfSpace::new(number(row, "w")).unwrap();
        let beam = || Incidence::Beam { mu0: number(row, "mu0") };
        match quantity {
            "H" => space.h(number(row, "mu")).unwrap(),
            "R_plane" => space.reflectance(beam()).unwrap(),
            "R_spherical" => space.reflectance(Incidence::Diffuse).unwrap(),
            "radiance_up_mu0_1_unit_irradiance" => space.radiance(beam(), number(row, "mu")).unwrap(),
            other => panic!("{other}"),
        }
    });
}

#[test]
fn infinite() {
    whole_table("infinite.csv", 31, |row| {
        let medium = InfiniteMedium::henyey_greenstein(number(row, "w"), number(row, "g")).unwrap();
        match row["quantity"].as_str() {
            "diffusion_exponent_k" => medium.decays()[0],
            "fluence_point" => medium.fluence(number(row, "r")).unwrap(),
            "fluence_point_asymptotic_mode" => medium.asymptotic_fluence(number(row, "r")).unwrap(),
            "fluence_point_P1_diffusion" => medium.diffusion_fluence(number(row, "r")).unwrap(),
            "mean_square_r_fluence_weighted" => medium.mean_square_radius().unwrap(),
            other => panic!("{other}"),
        }
    });
}
