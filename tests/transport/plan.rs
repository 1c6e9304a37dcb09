//! What a scene does not require costs nothing, and changes nothing where it is done nevertheless.

use crate::checks::ledger::{Room, by_paths, filling, layers_of_maps, look, mirror, settings};
use crate::support::scenes::lambertian;
use crate::support::verdict;
use turbid::Spectrum;
use turbid::integrators::Layer;
use turbid::integrators::mapper::{Mapper, Report};
use turbid::integrators::path;
use turbid::photons::maps::{Indirect, MapReport, fill};
use turbid::rng::{Purpose, Stream, Work};
use turbid::scene::Scene;
use turbid::transport::NoProgress;

fn room(sigma_t: f64, has_mirror: bool) -> Room {
    Room {
        floor: if has_mirror { mirror() } else { lambertian(Spectrum::grey(0.5)) },
        sigma_t: Spectrum::grey(sigma_t),
        albedo: Spectrum::grey(0.8),
        g: 0.3,
        is_colored: true,
        has_glass: false,
        has_water: false,
    }
}

/// The work of a few photons, rays and paths.
fn work(scene: &Scene) -> (MapReport, Report, Work) {
    let maps = fill(scene, &filling(1000, Indirect::Gathered, 1, 0), &NoProgress).unwrap();
    let settings = settings(4);
    let mapper = Mapper::new(scene, &maps, &settings);
    let (mut report, mut work) = (Report::default(), Work::default());
    for history in 0..100 {
        let mut stream = Stream::new(1, Purpose::Paths, 0, history);
        let ray = look(history, &mut stream);
        report += mapper.radiance(ray, None, 0, &mut stream).1;
        path::layers(scene, ray, None, 0, &mut stream);
        work += stream.work;
    }
    work += maps.report.main.work;
    work += maps.report.caustic.work;
    (maps.report, report, work)
}

#[test]
fn what_is_not_required_costs_nothing() {
    for (sigma_t, has_mirror) in [(0.0, false), (0.5, false), (0.0, true), (0.5, true)] {
        let scene = room(sigma_t, has_mirror).scene();
        let (maps, report, tracking) = work(&scene);
        // Homogeneous and grey, or nothing at all.
        assert_eq!(tracking, Work::default());
        let has_fog = sigma_t > 0.0;
        assert_eq!((report.volume.count > 0, report.steps > 0), (has_fog, has_fog));
        assert_eq!((maps.projection_cells > 0, maps.caustic.emitted > 0), (has_mirror, has_mirror));
        // A final gathering looks one bounce away; caustics are looked up where the eye looks.
        assert_eq!(report.caustic.count > 0, has_mirror);

        let (maps, report, tracking) = work(&scene.with_full_plan().unwrap());
        let Work { majorants, transmittances, channel_flights, .. } = tracking;
        assert!(majorants > 0 && transmittances > 0 && channel_flights > 0, "{tracking:?}");
        assert!(maps.projection_cells > 0 && maps.caustic.emitted > 0);
        assert!(report.volume.count > 0 && report.steps > 0 && report.caustic.count > 0);
    }
}

/// Both plans make the same picture, by paths and by photons: each layer within the errors of the two.
#[test]
fn what_is_done_nevertheless_changes_nothing() {
    for (sigma_t, has_mirror, seed) in [(0.0, false, 1), (0.5, true, 2)] {
        let scene = room(sigma_t, has_mirror).scene();
        let full = scene.with_full_plan().unwrap();
        // Seeds differ, so that the two are independent.
        let paths = [(&scene, seed), (&full, seed + 10)].map(|(scene, seed)| by_paths(scene, 400 * 64, seed));
        let photons = [(&scene, seed), (&full, seed + 10)]
            .map(|(scene, seed)| layers_of_maps(scene, &settings(1), 4000, Indirect::Seen, seed));
        for (who, [auto, full]) in [("paths", paths), ("photons", photons)] {
            let names = Layer::ALL.map(Layer::name).into_iter().chain(["total"]);
            for (i, name) in names.enumerate() {
                if auto[i].mean() == 0.0 {
                    assert_eq!(full[i].mean(), 0.0, "{who}, {name}");
                    continue;
                }
                let reference = (auto[i].mean(), auto[i].std_error());
                // Paths find caustics by chance alone.
                let promise = if name == "caustic" { 2.0 } else { 0.2 };
                let what = format!("{who}, {name}");
                verdict::agrees(&what, &full[i], reference, promise * reference.0, seed);
            }
        }
    }
}
