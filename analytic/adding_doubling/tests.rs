use super::*;

#[test]
fn probe() {
    for (tau, w, g, inc, refs) in [
        (
            1.0,
            0.9,
            0.0,
            Incidence::Beam { mu0: 1.0 },
            [0.26741033506936274, 0.22374564841004368, 0.14096457534915277],
        ),
        (0.1, 0.9, 0.5, Incidence::Beam { mu0: 1.0 }, [0.01524878441491533, f64::NAN, 0.01069783118058586]),
        (100.0, 1.0, 0.5, Incidence::Diffuse, [0.0; 3]),
        (1e-8, 1.0, 0.75, Incidence::Beam { mu0: 0.3 }, [0.0; 3]),
        (1.0, 0.9, 0.9, Incidence::Beam { mu0: 0.3 }, [0.0; 3]),
        (100.0, 0.9, 0.3, Incidence::Beam { mu0: 1e-5 }, [0.0; 3]),
    ] {
        let start = std::time::Instant::now();
        let s = AddingDoubling::new(tau, w, g, inc).unwrap();
        let (r, t, a) = (s.reflectance(), s.transmittance_diffuse(), s.absorptance());
        eprintln!("{tau} {w} {g} {:?}", start.elapsed());
        for (v, x) in [r, t, a].iter().zip(refs) {
            eprintln!("   {:.15e} +- {:.1e}  off {:.1e}", v.value, v.error / v.value, (v.value - x) / x);
        }
        eprintln!("   sum {:.2e}", r.value + s.transmittance().value + a.value - 1.0);
        for t in [0.0, 0.01 * tau, 0.5 * tau, tau] {
            let v = s.fluence(t).unwrap();
            let o = crate::AnisotropicSlab::new(tau.max(1e-3), w, g, inc).unwrap().fluence(t).unwrap();
            eprintln!(
                "   phi {:.15e} +- {:.1e} ordinates {:.1e}+-{:.1e}",
                v.value,
                v.error / v.value,
                (v.value - o.value) / v.value,
                o.error / o.value
            );
        }
    }
}

#[test]
fn radiance_probe() {
    let rows = std::fs::read_to_string("/work/shared/reference/slab_hg_radiance.csv").unwrap();
    for line in rows.lines().skip(1).step_by(3) {
        let line = line.split('"').next().unwrap();
        let f: Vec<&str> = line.split(',').collect();
        let n = |i: usize| f[i].parse::<f64>().unwrap();
        let start = std::time::Instant::now();
        let s = AddingDoubling::new(n(2), n(4), n(5), Incidence::Beam { mu0: n(7) }).unwrap();
        let v = s.radiance(n(8), n(10), n(11)).unwrap();
        eprintln!(
            "{} {:.2e} bound {:.1e} off {:.1e} digits {} {:?}",
            f[0],
            v.value,
            v.error / v.value,
            (v.value - n(14)) / v.value,
            f[15],
            start.elapsed()
        );
    }
}
