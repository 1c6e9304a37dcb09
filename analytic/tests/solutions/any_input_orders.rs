//! Slabs order by order, and the theory of kernels and beams: an answer or a refusal that names the parameter, whatever the bits.

use crate::support::any_input::{cases, number, sound};
use proptest::prelude::*;
use turbid_analytic::beams::{Pairing, Ray, blurred_field, crossing_moment, crossing_tail};
use turbid_analytic::kernel::optimum;
use turbid_analytic::nearest::{nearest_curved, optimum_neighbors};
use turbid_analytic::progressive::{
    progressive_asymptote, progressive_error, progressive_radius, progressive_variance,
};
use turbid_analytic::slab_single::{henyey_greenstein_mean, single_radiance_of};
use turbid_analytic::{Dimension, Incidence, Kernel, Phase, ScatteringOrders};

proptest! {
    #![proptest_config(cases(100_000, 20_260_104))]

    #[test]
    fn any_bits(
        tau in number(), albedo in number(), g in number(), mu0 in number(), t in number(), n in any::<u32>(),
    ) {
        sound(henyey_greenstein_mean(g, albedo, t))?;
        // Deep orders are asked of the mixture below: here the first ones, that are closed in depth.
        let n = if n % 3 == 0 { n.max(101) } else { n % 2 };
        for incidence in [Incidence::Beam { mu0 }, Incidence::Diffuse] {
            let n = if incidence == Incidence::Diffuse { 0 } else { n };
            if let Ok(orders) = ScatteringOrders::new(tau, albedo, &Phase::isotropic(), incidence) {
                sound(orders.fluence(n, t))?;
                sound(orders.reflectance(n))?;
                sound(orders.transmittance(n))?;
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(100_000, 20_260_104))]

    #[test]
    fn kernels_and_beams(
        which in 0_usize..3, k in any::<u32>(), x in number(), y in number(), z in number(), kappa in number(),
    ) {
        let d = Dimension::ALL[which];
        let kernel = [Kernel::Uniform, Kernel::Cone { kappa }, Kernel::Gaussian][which];
        let ray = Ray { length: y, extinction: kappa };
        for pairing in [
            Pairing::PointPoints, Pairing::RayPoints, Pairing::RayBeams { sine: z }, Pairing::RayIsotropicBeams,
        ] {
            sound(pairing.bias_coefficient(kernel))?;
            sound(pairing.inverse_sine())?;
            sound(pairing.relative_variance(kernel, x, z, ray))?;
            for part in pairing.optimum(kernel, x, z, ray).map(|(r, e)| [r, e]).into_iter().flatten() {
                sound(Ok(part))?;
            }
        }
        sound(crossing_tail(x))?;
        sound(crossing_moment(k % 7, x))?;
        sound(kernel.square_moment(d))?;
        sound(optimum(d, x, y).map(|(r, _)| r))?;
        sound(optimum(d, x, y).map(|(_, e)| e))?;
        sound(nearest_curved(kernel, d, k, x, y).map(|n| n.bias))?;
        sound(nearest_curved(kernel, d, k % 50, x, y).map(|n| n.mean_squared_error))?;
        sound(optimum_neighbors(kernel, d, x, y).map(|(_, e)| e))?;
        sound(progressive_radius(d, x, y))?;
        sound(progressive_variance(x, y))?;
        sound(progressive_asymptote(d, x).map(|a| a.bias))?;
        sound(progressive_error(d, x, y, z, k % 30))?;
        let phase = |_| Pairing::RayIsotropicBeams.inverse_sine().unwrap();
        sound(single_radiance_of(x, kappa, phase, y, z, kappa, y))?;
    }
}

proptest! {
    #![proptest_config(cases(1000, 20_260_104))]

    #[test]
    fn fields_of_kernels(which in 0_usize..3, x in number(), y in number(), kappa in number()) {
        let d = Dimension::ALL[which];
        for pairing in [Pairing::RayPoints, Pairing::RayIsotropicBeams] {
            sound(pairing.exponential_mean(Kernel::Cone { kappa }, x))?;
        }
        if let Ok(v) = blurred_field(Kernel::Uniform, d, x, |p| y + p[0]) {
            sound(Ok(v))?;
        }
    }
}

proptest! {
    #![proptest_config(cases(16, 20_260_104))]

    #[test]
    fn near_the_ranges(
        tau in (-12.0..4.0_f64).prop_map(|e| libm::pow(10.0, e)),
        albedo in prop_oneof![0.0..=1.0_f64, Just(1.0)],
        g in -0.6..0.8_f64,
        mu0 in (-5.0..0.0_f64).prop_map(|e| libm::pow(10.0, e)),
        diffuse in any::<bool>(),
        share in 0.0..=1.0_f64,
    ) {
        let incidence = if diffuse { Incidence::Diffuse } else { Incidence::Beam { mu0 } };
        let phase = Phase::henyey_greenstein(g).unwrap();
        let orders = ScatteringOrders::new(tau, albedo, &phase, incidence).unwrap();
        let mut before = f64::INFINITY;
        for n in 0..4 {
            let phi = orders.fluence(n, share * tau).unwrap();
            prop_assert!(phi.value >= -phi.error && phi.error <= 1e-6 * phi.value + 1e-20, "{n} {phi:?}");
            let (r, t) = (orders.reflectance(n).unwrap(), orders.transmittance(n).unwrap());
            prop_assert!(r.error <= 1e-8 * r.value + 1e-20 && t.error <= 1e-8 * t.value + 1e-20, "{r:?} {t:?}");
            // No more leaves after n scatterings than was left after n - 1.
            let leaves = r.value + t.value + orders.absorptance(n).unwrap().value;
            prop_assert!(leaves <= before.min(1.0) * (1.0 + 1e-9), "{n} {leaves} {before}");
            before = 1.0;
        }
    }
}
