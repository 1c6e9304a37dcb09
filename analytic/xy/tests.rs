use super::*;
use crate::exponential_integral::e_n;
use crate::quadrature::GaussLegendre;
use libm::{exp, expm1, ldexp};

/// Nodes in mu on panels that shrink fourfold towards 0.
fn nodes(order: usize, panels: i32) -> Vec<(f64, f64)> {
    let rule = GaussLegendre::new(order).unwrap();
    (0..=panels)
        .flat_map(|i| {
            let low = if i == panels { 0.0 } else { ldexp(1.0, -2 * i - 2) };
            let length = ldexp(1.0, -2 * i) - low;
            rule.nodes
                .iter()
                .zip(&rule.weights)
                .map(move |(x, w)| (low + length * x, length * w))
                .collect::<Vec<_>>()
        })
        .collect()
}

/// The other method: X and Y of growing slabs, from 1e-14 to tau in steps that grow by a half.
///
/// In each step X J is a polynomial through Gauss points and dY/dtau = -Y/mu + X J is integrated exactly for it, mu
/// however small; J = (w/2) (E_1(tau) + int (Y - e^(-tau/m)) dm/m). Repeated until it stands.
struct Growth {
    nodes: Vec<(f64, f64)>,
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Growth {
    fn to(tau: f64, albedo: f64) -> Self {
        const POINTS: usize = 10;
        let nodes = nodes(8, 10);
        let rule = GaussLegendre::new(POINTS).unwrap();
        let inner = GaussLegendre::new(16).unwrap();
        let barycentric: Vec<f64> = (0..POINTS)
            .map(|j| {
                let others = rule.nodes.iter().enumerate().filter(|&(i, _)| i != j);
                1.0 / others.map(|(_, x)| rule.nodes[j] - x).product::<f64>()
            })
            .collect();
        let lagrange = |at: f64| -> [f64; POINTS] {
            let all: f64 = rule.nodes.iter().map(|x| at - x).product();
            std::array::from_fn(|j| all * barycentric[j] / (at - rule.nodes[j]))
        };
        // Ends of integration: the points, and the end of the step.
        let ends: Vec<f64> = rule.nodes.iter().copied().chain([1.0]).collect();
        let flat: Vec<Vec<f64>> = ends
            .iter()
            .map(|&end| {
                let mut row = vec![0.0; POINTS];
                for (s, w) in inner.nodes.iter().zip(&inner.weights) {
                    row.iter_mut().zip(lagrange(end * s)).for_each(|(r, l)| *r += end * w * l);
                }
                row
            })
            .collect();
        let mut start = 1e-14;
        let (mut x, mut y) =
            (vec![1.0; nodes.len()], nodes.iter().map(|&(mu, _)| exp(-start / mu)).collect::<Vec<f64>>());
        while start < tau {
            let step = (0.5 * start).min(tau - start).min(0.25);
            // int_0^end e^(-(end-s) step/mu) l_j(s) ds for each node, on pieces that follow the exponential.
            let fading: Vec<Vec<Vec<f64>>> = nodes
                .iter()
                .map(|&(mu, _)| {
                    let rate = step / mu;
                    ends.iter()
                        .map(|&end| {
                            let mut row = vec![0.0; POINTS];
                            let mut edges = vec![0.0];
                            let mut edge = 4.0 / rate;
                            while edge < end && edge * rate < 40.0 {
                                edges.push(edge);
                                edge += 6.0 / rate;
                            }
                            edges.push(end.min(edge));
                            for pair in edges.windows(2) {
                                let length = pair[1] - pair[0];
                                for (u, w) in inner.nodes.iter().zip(&inner.weights) {
                                    let back = pair[0] + length * u;
                                    let weight = length * w * exp(-back * rate);
                                    row.iter_mut()
                                        .zip(lagrange(end - back))
                                        .for_each(|(r, l)| *r += weight * l);
                                }
                            }
                            row
                        })
                        .collect()
                })
                .collect();
            let (mut xs, mut ys) = (vec![x.clone(); ends.len()], vec![y.clone(); ends.len()]);
            for _ in 0..40 {
                let js: Vec<f64> = (0..POINTS)
                    .map(|i| {
                        let at = start + step * ends[i];
                        let scattered: f64 =
                            nodes.iter().zip(&ys[i]).map(|(&(mu, w), y)| w / mu * (y - exp(-at / mu))).sum();
                        0.5 * albedo * (e_n(1, at) + scattered)
                    })
                    .collect();
                let mut moved = 0.0_f64;
                let (before_x, before_y) = (xs.clone(), ys.clone());
                for (m, &(mu, _)) in nodes.iter().enumerate() {
                    for (e, &end) in ends.iter().enumerate() {
                        let grown: f64 = (0..POINTS).map(|j| flat[e][j] * before_y[j][m] * js[j]).sum();
                        let lit: f64 = (0..POINTS).map(|j| fading[m][e][j] * before_x[j][m] * js[j]).sum();
                        xs[e][m] = x[m] + step * grown;
                        ys[e][m] = y[m] * exp(-end * step / mu) + step * lit;
                        moved =
                            moved.max((xs[e][m] - before_x[e][m]).abs() + (ys[e][m] - before_y[e][m]).abs());
                    }
                }
                if moved < 1e-15 {
                    break;
                }
            }
            (x, y) = (xs[POINTS].clone(), ys[POINTS].clone());
            start += step;
        }
        Growth { nodes, x, y }
    }
}

#[test]
fn two_methods_agree() {
    for (tau, albedo) in [(0.1, 0.5), (2.0, 1.0)] {
        let (grown, xy) = (Growth::to(tau, albedo), XAndY::new(tau, albedo).unwrap());
        let mut worst = 0.0_f64;
        for i in (0..grown.nodes.len()).step_by(9) {
            let [x, y] = xy.at(grown.nodes[i].0).unwrap();
            worst = worst.max((x.value / grown.x[i] - 1.0).abs()).max((y.value - grown.y[i]).abs());
            assert!(x.error < 1e-12 && y.error < 1e-12, "{x:?} {y:?}");
        }
        assert!(worst < 1e-10, "tau {tau} w {albedo}: {worst:e}");
    }
}

#[test]
fn the_identity_and_the_integral_equations() {
    for (tau, albedo) in [(1e-8, 0.5), (0.3, 0.9), (2.0, 1.0), (20.0, 0.999_999)] {
        let xy = XAndY::new(tau, albedo).unwrap();
        let [a, b] = xy.integrals().unwrap();
        let (out, across) = (1.0 - 0.5 * albedo * a.value, 0.5 * albedo * b.value);
        let allowed = (a.error + b.error) * albedo * (out + across) + 1e-15;
        assert!((out * out - across * across - (1.0 - albedo)).abs() <= allowed, "{tau} {albedo}");
        assert!(allowed < 1e-12, "{allowed:e}");
    }
    let (tau, albedo, mu) = (1.0, 0.9, 0.37);
    let xy = XAndY::new(tau, albedo).unwrap();
    let [x, y] = xy.at(mu).unwrap().map(|v| v.value);
    let (mut upper, mut lower) = (1.0, exp(-tau / mu));
    for (m, w) in nodes(10, 6) {
        let [xm, ym] = xy.at(m).unwrap().map(|v| v.value);
        upper += 0.5 * albedo * mu * w * (x * xm - y * ym) / (mu + m);
        lower += 0.5 * albedo * mu * w * (y * xm - x * ym) / (mu - m);
    }
    // The rule integrates (1 + mu ln mu)/(mu + m) to about 1e-11, the quotient at m = mu with 1e-13 over the distance.
    assert!((upper - x).abs() < 1e-10 && (lower - y).abs() < 1e-10, "{:e} {:e}", upper - x, lower - y);
}

#[test]
fn light_that_leaves_by_x_and_y() {
    for (tau, albedo) in [(0.5, 0.9), (2.0, 1.0), (1e-3, 0.7)] {
        let xy = XAndY::new(tau, albedo).unwrap();
        for mu0 in [0.2, 1.0] {
            let slab = IsotropicSlab::new(tau, albedo, Incidence::Beam { mu0 }).unwrap();
            let same = |a: Value, b: Value| {
                assert!((a.value - b.value).abs() <= a.error + b.error, "{tau} {albedo} {mu0}: {a:?} {b:?}");
                assert!(a.error < 1e-11, "{a:?}");
            };
            let [r, t] = xy.fluxes(mu0).unwrap();
            same(r, slab.reflectance());
            same(t, slab.transmittance());
            for mu in [0.1, 0.6] {
                same(xy.radiance_up(mu0, mu).unwrap(), slab.radiance(0.0, mu).unwrap());
                same(xy.radiance_down(mu0, mu).unwrap(), slab.radiance(tau, -mu).unwrap());
            }
        }
    }
    // Thin: X = 1 + (w/2) tau (E_1-like), Y - e^(-tau/mu) likewise.
    let [x, y] = XAndY::new(1e-10, 0.5).unwrap().at(0.5).unwrap();
    let first = 0.25 * (1e-10 * (1.0 - 0.577_215_664_901_532_9 - libm::log(1e-10)));
    assert!((x.value - 1.0 - first).abs() < 1e-16 + x.error, "{x:?} {first:e}");
    assert!((y.value - 1.0 - expm1(-2e-10) - first).abs() < 1e-16 + y.error, "{y:?}");
}
