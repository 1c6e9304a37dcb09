//! Every function of numbers answers with finite numbers or refuses, whatever the bits.

use crate::support::any_input::{cases, number, sound};
use proptest::prelude::*;
use turbid_analytic::ball_mean::exponential_mean;
use turbid_analytic::beer_lambert::{direct_transmittance, uncollided_fluence};
use turbid_analytic::blur::{edge_spread, line_spread, modulation_transfer};
use turbid_analytic::exponential_integral::exponential_integral;
use turbid_analytic::nearest::{nearest_expectation, nearest_moments, nearest_square_distance};
use turbid_analytic::progressive::progressive;
use turbid_analytic::slab_kernel::{edge_loss, face_moment, slab_kernel_mean, slab_moment};
use turbid_analytic::slab_single::{
    single_fluence, single_radiance, single_reflectance, single_transmittance,
};
use turbid_analytic::volumes::{ball_slab_volume, lens_volume};
use turbid_analytic::{Dimension, Incidence, Kernel};

fn any_kernel() -> impl Strategy<Value = Kernel> {
    prop_oneof![
        Just(Kernel::Uniform),
        Just(Kernel::Epanechnikov),
        Just(Kernel::Biweight),
        number().prop_map(|kappa| Kernel::Cone { kappa }),
        Just(Kernel::Gaussian),
        Just(Kernel::TruncatedGaussian),
    ]
}

proptest! {
    #![proptest_config(cases(3000, 20_260_102))]

    #[test]
    fn functions_of_few_numbers(
        kernel in any_kernel(), which in 0_usize..3, j in 0_u32..25, x in number(), y in number(), z in number(),
    ) {
        let d = Dimension::ALL[which];
        sound(exponential_integral(j, x))?;
        sound(kernel.profile(d, x))?;
        sound(kernel.normalization(d))?;
        sound(kernel.moment(d, j))?;
        sound(kernel.roughness(d))?;
        sound(kernel.variance_coefficient(d))?;
        sound(kernel.marginal(x))?;
        sound(exponential_mean(kernel, d, x))?;
        sound(edge_spread(d, x))?;
        sound(line_spread(d, x))?;
        sound(modulation_transfer(d, x))?;
        sound(face_moment(kernel, j, x))?;
        sound(slab_moment(kernel, j, x, y, z))?;
        sound(lens_volume(x, y, z))?;
        sound(ball_slab_volume(x, y, z))?;
        sound(nearest_square_distance(d, j, x, Some(u64::from(j) * 3)))?;
        if let Ok(p) = progressive(d, x, j) {
            sound(Ok(p.radius))?;
            sound(Ok(p.variance))?;
            sound(Ok(p.bias))?;
        }
    }

    #[test]
    fn single_scattering(
        tau in number(), albedo in number(), g in number(), mu0 in number(), t in number(), mu in number(),
        dphi in number(),
    ) {
        sound(single_radiance(tau, albedo, g, mu0, t, mu, dphi))?;
        sound(single_fluence(tau, albedo, mu0, t))?;
        for incidence in [Incidence::Beam { mu0 }, Incidence::Diffuse] {
            sound(uncollided_fluence(incidence, t))?;
            sound(direct_transmittance(incidence, t))?;
        }
    }
}

proptest! {
    #![proptest_config(cases(2000, 20_260_103))]

    #[test]
    fn integrals(
        kernel in any_kernel(), k in 0_u32..60, x in number(), y in number(), z in number(), slope in number(),
    ) {
        let field = |t: f64| slope * t + libm::exp(-t);
        sound(slab_kernel_mean(kernel, x, y, z, field))?;
        if let Ok(split) = edge_loss(kernel, x, y, z, field) {
            sound(Ok(split.edge))?;
            sound(Ok(split.blur))?;
        }
        let (lambda, mean) = (|r: f64| x * r * r * r, |r: f64| 1.0 + y * r);
        sound(nearest_expectation(k, z, lambda, mean))?;
        if let Ok(gather) = nearest_moments(k, z, lambda, mean, |r| 1.0 / lambda(r)) {
            sound(Ok(gather.mean))?;
            sound(Ok(gather.variance))?;
        }
        for incidence in [Incidence::Beam { mu0: y }, Incidence::Diffuse] {
            sound(single_reflectance(x, z, incidence))?;
            sound(single_transmittance(x, z, incidence))?;
        }
    }
}
