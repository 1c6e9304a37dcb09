//! The same bits on any number of threads.

use crate::support::run::{pass, paths};
use crate::support::scenes::{Incidence, at_depth, reflectance, slab};
use turbid::scene::Orders;

/// Tallies of photons and moments of paths, every bit of them.
pub fn moments_do_not_depend_on_the_threads() {
    let scene = slab(2.0, 0.9, 0.5, Incidence::Beam(0.5));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let photons = pass(&scene, &[(reflectance(2.0), Orders::ALL)], 20_000, 7, |_| false);
            (photons.tallies, photons.report.ledger, paths(&scene, at_depth(1.0), Orders::ALL, 20_000, 7))
        })
    };
    let one = run(1);
    for threads in [1, 2, 4] {
        assert!(run(threads) == one, "{threads} threads give other bits");
    }
}
