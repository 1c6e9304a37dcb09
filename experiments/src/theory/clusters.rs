//! Photons of one history lie near each other: how many, and what that does to an estimate.

use super::Table;
use super::returns::{LARGEST, SMALLEST, returns};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock, Mutex};
use turbid_analytic::quadrature::GaussLegendre;

/// Other photons of the same history around each photon of a ball of radius `r` \[mfp\], on average, far from faces.
///
/// With L the distance from a uniform point of the ball to its surface along any direction, the next collision is
/// inside with probability w <1 - e^-L> = w (3/4 r - ...), and so was the last one: 3/2 w r to first order, whatever
/// the asymmetry. The table of `returns` has all orders; below it the second is taken to be as at its beginning.
pub fn clustering(albedo: f64, g: f64, r: f64) -> f64 {
    if albedo == 0.0 {
        return 0.0;
    }
    let Some(table) = table(albedo, g) else { return f64::NAN };
    if r < SMALLEST {
        let second = (table.at(SMALLEST) / SMALLEST - 1.5 * albedo) / SMALLEST;
        return (1.5 * albedo + second * r) * r;
    }
    table.at(r.min(LARGEST))
}

/// The tables by albedo and asymmetry: made when first asked for.
static TABLES: LazyLock<Mutex<BTreeMap<[u64; 2], Arc<Table>>>> = LazyLock::new(Mutex::default);

fn table(albedo: f64, g: f64) -> Option<Arc<Table>> {
    let key = [albedo.to_bits(), g.to_bits()];
    let mut tables = TABLES.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(table) = tables.get(&key) {
        return Some(table.clone());
    }
    let table = Arc::new(returns(albedo, g).ok()?);
    tables.insert(key, table.clone());
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

    /// Small balls join the tabulated ones, at any albedo.
    #[test]
    fn the_table_begins_where_the_first_orders_end() {
        for albedo in [0.3, 0.9, 1.0] {
            let (below, above) =
                (clustering(albedo, 0.75, SMALLEST - 1e-9), clustering(albedo, 0.75, SMALLEST));
            assert!((above - below).abs() < 1e-7, "albedo {albedo}: {below}, then {above}");
        }
    }

    /// Followers counted one by one: flights from the points of a ball. `g` is planted by scattering with it.
    fn counted(albedo: f64, g: f64, radius: f64) -> turbid::stats::Moments {
        use turbid::rng::{Purpose, Stream};
        let phase = turbid::phase::Phase::with_asymmetry(turbid::math::Asymmetry::new("g", g).unwrap());
        let mut found = turbid::stats::Moments::new();
        for history in 0..200_000 {
            let mut stream = Stream::new(7, Purpose::Synthetic, 0, history);
            let mut p =
                turbid::math::warp::square_to_sphere(stream.pair()) * libm::cbrt(stream.unit()) * radius;
            let mut dir = turbid::math::warp::square_to_sphere(stream.pair());
            let mut followers = 0.0;
            while stream.unit() < albedo {
                dir = phase.scatter(dir, stream.pair());
                p += dir * -libm::log1p(-stream.unit());
                followers += f64::from(u8::from(p.length() <= radius));
            }
            found.push(2.0 * followers);
        }
        found
    }

    #[test]
    fn followers_counted_one_by_one() {
        for (g, radius) in [(0.0, 0.4), (0.75, 0.8), (-0.5, 0.2)] {
            let found = counted(0.9, g, radius);
            let test = turbid::stats::t_test(&found, clustering(0.9, g, radius), 1e-4);
            assert!(test.p > turbid::stats::ALPHA, "g {g}: {test:?}");
        }
        // The isotropic sum without those that leave and come back, 0.575, would be detected; so would the first order
        // alone behind the forward peak.
        assert!(turbid::stats::t_test(&counted(0.9, 0.0, 0.4), 0.575, 0.0).p < turbid::stats::ALPHA);
        assert!(turbid::stats::t_test(&counted(0.9, 0.75, 0.8), 1.08, 0.0).p < turbid::stats::ALPHA);
    }
}
