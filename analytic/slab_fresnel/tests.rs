use super::*;

#[test]
fn probe() {
    for (tau, w, g, n, inc) in [
        (1.0, 0.9, 0.0, 1.5, Incidence::Beam { mu0: 1.0 }),
        (1.0, 0.9, 0.0, 1.5, Incidence::Diffuse),
        (1.0, 1.0, 0.0, 1.33, Incidence::Beam { mu0: 1.0 }),
        (1.0, 1.0, 0.5, 1.0001, Incidence::Diffuse),
        (1.0, 1.0, 0.75, 2.4, Incidence::Diffuse),
        (1.0, 1.0, 0.75, 0.7, Incidence::Diffuse),
        (0.1, 0.9, 0.75, 0.7, Incidence::Beam { mu0: 0.9 }),
        (100.0, 0.99999, 0.75, 2.4, Incidence::Beam { mu0: 0.9 }),
        (100.0, 0.9, 0.75, 2.4, Incidence::Beam { mu0: 0.9 }),
        (1e-8, 0.99999, 0.75, 2.4, Incidence::Beam { mu0: 0.9 }),
        (1.0, 0.9, 0.5, 1.0 + 1e-9, Incidence::Diffuse),
        (0.2, 0.5, -0.8, 1.5, Incidence::Diffuse),
        (10.0, 0.99, 0.9, 1.5, Incidence::Beam { mu0: 0.3 }),
    ] {
        let phase = Phase::henyey_greenstein(g).unwrap();
        let start = std::time::Instant::now();
        let a = FresnelSlab::solve(tau, w, &phase, n, inc, false).unwrap();
        let mid = std::time::Instant::now();
        let b = FresnelSlab::solve(tau, w, &phase, n, inc, true).unwrap();
        eprintln!("{tau} {w} {g} n {n} {inc:?} {:?} {:?}", mid - start, mid.elapsed());
        let show = |name: &str, a: Value, b: Value| {
            eprintln!(
                "   {name} {:.17} +- {:.1e} other +- {:.1e} off {:.1e} {}",
                a.value,
                a.error / a.value,
                b.error / b.value,
                (a.value - b.value) / b.value,
                if (a.value - b.value).abs() > a.error + b.error { "NOT COVERED" } else { "" }
            )
        };
        show("Rdif", a.reflectance_diffuse(), b.reflectance_diffuse());
        show("Tdif", a.transmittance_diffuse(), b.transmittance_diffuse());
        show("A", a.absorptance(), b.absorptance());
        for t in [0.0, 0.01 * tau, 0.3 * tau, tau] {
            show("phi", a.fluence(t).unwrap(), b.fluence(t).unwrap());
        }
        eprintln!(
            "   sum-1 {:.1e}",
            a.reflectance().value + a.transmittance().value + a.absorptance().value - 1.0
        );
    }
}
