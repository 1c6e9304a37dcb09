//! The methods against each other.

use super::ordinates::Ordinates;
use super::point::PointSource;
use super::*;

/// Both methods at six radii for every source, over the whole of albedos and thicknesses.
#[test]
fn integral_equation_and_ordinates_agree() {
    for a in [1e-3, 0.1, 1.0, 10.0, 50.0] {
        let sphere = Sphere::new(a, 0.5, SphereSource::Uniform).unwrap();
        for albedo in [1e-6, 0.5, 0.9, 0.999_999, 1.0] {
            let slab = Ordinates::new(a, albedo, 12);
            let point = PointSource::new(albedo);
            let lit = slab.incident().unwrap();
            for source in [SphereSource::Uniform, SphereSource::Incident, SphereSource::Centre] {
                let sphere = sphere.with(albedo, source).unwrap();
                let field = match source {
                    SphereSource::Uniform => slab.uniform(),
                    SphereSource::Incident => slab.incident(),
                    SphereSource::Centre => slab.lit(|m| -point.incoming(albedo, a, m)),
                }
                .unwrap();
                for part in [0.0, 0.1, 0.4, 0.8, 0.99, 1.0 - 1e-7, 1.0] {
                    let r = part * a;
                    let Ok(want) = sphere.fluence(r) else { continue };
                    let got = match source {
                        // The particular solution cancels in thin spheres that absorb; there phi_incident does not.
                        SphereSource::Uniform if albedo < 0.6 => {
                            (1.0 - 0.25 * slab.fluence(&lit, r)) / (1.0 - albedo) / sphere.volume()
                        }
                        SphereSource::Uniform => slab.fluence(&field, r) / sphere.volume(),
                        SphereSource::Incident => slab.fluence(&field, r),
                        SphereSource::Centre => slab.fluence(&field, r) + point.total(r) / r,
                    };
                    let off = got / want.value - 1.0;
                    assert!(off.abs() < 1e-10, "{a} {albedo} {source:?} {part}: {off:e} {want:?}");
                    // Twelve directions a panel may be off too, by what 1e-12 allows.
                    assert!(
                        off.abs() < want.error / want.value + 1e-11,
                        "{a} {albedo} {source:?} {part}: {off:e}"
                    );
                }
                let escape = match source {
                    SphereSource::Uniform => 0.25 * slab.mean(&lit),
                    SphereSource::Incident => 1.0 - a / 3.0 * (1.0 - albedo) * slab.mean(&lit),
                    SphereSource::Centre => 0.25 * slab.fluence(&lit, 0.0),
                };
                let off = escape / sphere.escape().value - 1.0;
                assert!(off.abs() < 1e-10, "{a} {albedo} {source:?} escape: {off:e}");
            }
        }
    }
}

/// The two solutions of the library where one takes over from the other: every answer within both bounds.
#[test]
fn large_spheres_join_on() {
    let a = 60.0;
    let small = Sphere::new(a, 0.5, SphereSource::Uniform).unwrap();
    for albedo in [1e-6, 0.3, 0.8, 0.99, 1.0] {
        for source in [SphereSource::Uniform, SphereSource::Incident, SphereSource::Centre] {
            let small = small.with(albedo, source).unwrap();
            let large = Sphere::large(a, albedo, source).unwrap();
            let same = |p: Value, q: Value, what: &str| {
                let near = (p.value - q.value).abs() <= p.error + q.error;
                assert!(near, "{albedo} {source:?} {what}: {p:?} {q:?}");
                assert!(q.error <= 1e-10 * q.value.max(1e-3), "{albedo} {source:?} {what}: {q:?}");
            };
            for r in [0.0, 1e-9, 3.0, 30.0, 57.0, 59.5, 59.99, 60.0 - 1e-5, 60.0 - 1e-9, 60.0] {
                if let (Ok(p), Ok(q)) = (small.fluence(r), large.fluence(r)) {
                    same(p, q, &format!("fluence at {r}"));
                }
            }
            same(small.escape(), large.escape(), "escape");
            same(small.absorptance(), large.absorptance(), "absorptance");
            for mu in [0.0, 1e-9, 1e-3, 0.1, 0.5, 0.999, 1.0] {
                if let (Ok(p), Ok(q)) = (small.exit_radiance(mu), large.exit_radiance(mu)) {
                    same(p, q, &format!("radiance at {mu}"));
                }
            }
        }
    }
}
