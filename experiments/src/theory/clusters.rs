//! Photons of one history lie near each other: how many, and what that does to an estimate.

use super::{Table, isotropic_clustering};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock, Mutex};
use turbid_analytic::quadrature::GaussLegendre;

/// Other photons of the same history around each photon of a ball of radius `r` \[mfp\], on average, far from faces.
///
/// With L the distance from a uniform point of the ball to its surface along any direction, the next collision is
/// inside with probability w <1 - e^-L> = w (3/4 r - ...), and so was the last one: 3/2 w r to first order, whatever
/// the asymmetry. In isotropic fog all orders are known ([`isotropic_clustering`]); behind other phase functions the
/// first stands alone.
pub fn clustering(albedo: f64, g: f64, r: f64) -> f64 {
    if g != 0.0 || albedo == 0.0 {
        return 1.5 * albedo * r;
    }
    // Below, the first two orders leave less than r^3 ln(1/r) = 5e-6 out; beyond, nothing gathers.
    if r < 0.01 {
        return 1.5 * albedo * r + albedo * (0.2 * PI * PI * albedo - 0.8) * r * r;
    }
    isotropic(albedo).map_or(f64::NAN, |table| table.at(r))
}

/// Radius up to which clusters are tabulated \[mfp\].
const REACH: f64 = 8.0;

/// The tables by albedo: made when first asked for.
static TABLES: LazyLock<Mutex<BTreeMap<u64, Arc<Table>>>> = LazyLock::new(Mutex::default);

fn isotropic(albedo: f64) -> Option<Arc<Table>> {
    // Without absorption the sum over orders has no end to integrate to; a millionth of it changes 2e-3 r.
    let albedo = albedo.min(1.0 - 1e-6);
    let mut tables = TABLES.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(table) = tables.get(&albedo.to_bits()) {
        return Some(table.clone());
    }
    let table = Arc::new(isotropic_clustering(albedo, REACH).ok()?);
    tables.insert(albedo.to_bits(), table.clone());
    Some(table)
}

/// What clusters add to a k-nearest estimate, relative to it, far from faces.
///
/// Pairs raise the variance of the number N in a ball that holds lambda on average to lambda (1 + eta), which changes
/// the mean of any f(N) by lambda eta/2 times that of its second difference: P(N >= k) by lambda eta/2 (p_(k-2) -
/// p_(k-1)), p the Poisson probabilities. The estimate (k-1)/lambda_k then reads (k-1)/2 int eta/lambda (p_(k-2) -
/// p_(k-1)) dlambda too much. For eta = c r, with r_1 the radius of the ball in which one photon is expected, that is
/// c r_1 Gamma(k-5/3) / (3 Gamma(k-1)).
pub fn nearest_clustering(albedo: f64, g: f64, photons_per_volume: f64, k: usize) -> f64 {
    nearest_bias(photons_per_volume, k, |r| clustering(albedo, g, r))
}

fn nearest_bias(photons_per_volume: f64, k: usize, eta: impl Fn(f64) -> f64) -> f64 {
    static RULE: LazyLock<Option<GaussLegendre>> = LazyLock::new(|| GaussLegendre::new(16).ok());
    let Some(rule) = RULE.as_ref() else { return f64::NAN };
    let r1 = libm::cbrt(3.0 / (4.0 * PI * photons_per_volume));
    let k = k as f64;
    let poisson = |n: f64, lambda: f64| libm::exp(n * libm::log(lambda) - lambda - libm::lgamma(n + 1.0));
    // In x = lambda^(1/3) the integrand is smooth down to 0; beyond k + 12 sqrt(k) + 40 the Poisson tail is below 1e-17.
    let end = libm::cbrt(k + 12.0 * k.sqrt() + 40.0);
    let panels = 40;
    let step = end / f64::from(panels);
    let sum: f64 = (0..panels)
        .map(|i| {
            rule.integrate(f64::from(i) * step, f64::from(i + 1) * step, |x| {
                let lambda = x * x * x;
                let change = poisson(k - 2.0, lambda) - poisson(k - 1.0, lambda);
                // dlambda / lambda = 3 dx / x.
                eta(r1 * x) * change * 3.0 / x
            })
        })
        .sum();
    0.5 * (k - 1.0) * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Powers of the radius in closed form: for eta = lambda^a, (1-a)/2 Gamma(k-2+a) / Gamma(k-1).
    #[test]
    fn powers_of_the_radius() {
        // One photon in the ball of radius 1.
        let density = 3.0 / (4.0 * PI);
        for k in [3, 4, 10, 50, 1000] {
            for power in [1, 2] {
                let a = f64::from(power) / 3.0;
                let n = k as f64;
                let exact = 0.5 * (1.0 - a) * libm::exp(libm::lgamma(n - 2.0 + a) - libm::lgamma(n - 1.0));
                let found = nearest_bias(density, k, |r| if power == 1 { r } else { r * r });
                // lgamma near 1000 has roundings of 1e-12; the rest is far below.
                assert!((found / exact - 1.0).abs() < 1e-8, "k {k}, power {power}: {found}, not {exact}");
            }
        }
    }

    /// Small balls join the tabulated ones.
    #[test]
    fn the_table_begins_where_the_first_orders_end() {
        for albedo in [0.3, 0.9, 1.0] {
            let (below, above) = (clustering(albedo, 0.0, 0.01 - 1e-9), clustering(albedo, 0.0, 0.01));
            assert!((above - below).abs() < 1e-5, "albedo {albedo}: {below}, then {above}");
        }
    }

    /// The all-orders sum against one made history by history: isotropic flights from the points of a ball.
    #[test]
    fn followers_counted_one_by_one() {
        use turbid::rng::{Purpose, Stream};
        let (albedo, radius) = (0.9, 0.4);
        let mut found = turbid::stats::Moments::new();
        for history in 0..200_000 {
            let mut stream = Stream::new(7, Purpose::Synthetic, 0, history);
            let mut p =
                turbid::math::warp::square_to_sphere(stream.pair()) * libm::cbrt(stream.unit()) * radius;
            let mut followers = 0.0;
            while stream.unit() < albedo {
                let dir = turbid::math::warp::square_to_sphere(stream.pair());
                p += dir * -libm::log1p(-stream.unit());
                followers += f64::from(u8::from(p.length() <= radius));
            }
            found.push(2.0 * followers);
        }
        let exact = clustering(albedo, 0.0, radius);
        let test = turbid::stats::t_test(&found, exact, 1e-5);
        assert!(test.p > turbid::stats::ALPHA, "{test:?}");
        // The sum without those that leave and come back, 0.575 here, would be seen.
        assert!(turbid::stats::t_test(&found, 0.575, 0.0).p < turbid::stats::ALPHA);
    }
}
