//! The photons themselves, as records for a structured array.

use crate::choices::chosen;
use crate::scene::Given;
use crate::work::{self, Watch};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyDict};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use turbid::integrators::Layer;
use turbid::memory;
use turbid::photons::{Emitter, Flags, Histories, Photon, Photons, Run, Storage};
use turbid::scene::Scene;
use turbid::transport::{NoProgress, Progress};

/// Bytes of a record: position 3 x 8, direction, normal and power 3 x 4 each, order 2, flags 1, class 1.
const RECORD: usize = 64;

/// Histories of the pilot that counts photons, at most.
const PILOT: u64 = 1024;

/// Where photons are kept.
#[derive(Clone, Copy, PartialEq)]
enum At {
    Media,
    Surfaces,
    Both,
}

/// What is kept: places and orders.
struct Keep {
    at: At,
    orders: (u32, Option<u32>),
    kept: AtomicU64,
}

impl Keep {
    fn takes(&self, is_here: bool, photon: &Photon) -> bool {
        let (min, max) = self.orders;
        let order = u32::from(photon.order);
        let takes = is_here && order >= min && max.is_none_or(|max| order <= max);
        self.kept.fetch_add(u64::from(takes), Ordering::Relaxed);
        takes
    }
}

impl Storage for Keep {
    fn in_medium(&self, _history: u64, photon: &Photon) -> bool {
        self.takes(self.at != At::Surfaces, photon)
    }

    fn on_surface(&self, _history: u64, photon: &Photon) -> bool {
        self.takes(self.at != At::Media, photon)
    }
}

/// The class of the light that a photon makes where it is scattered: the number of a layer of pictures.
fn class(photon: &Photon, is_in_medium: bool) -> u8 {
    let first = if is_in_medium { Flags::MEDIUM } else { Flags::DIFFUSE };
    let order = u32::from(photon.order).saturating_add(1);
    Layer::of(order, first, photon.flags.has(Flags::SPECULAR)) as u8
}

fn write(photon: &Photon, is_in_medium: bool, record: &mut [u8]) {
    let (position, rest) = record.split_at_mut(24);
    let (vectors, end) = rest.split_at_mut(36);
    for (place, number) in position.chunks_exact_mut(8).zip(photon.position.to_array()) {
        place.copy_from_slice(&number.to_ne_bytes());
    }
    let numbers = [photon.dir, photon.normal, photon.power].into_iter().flat_map(|vector| vector.to_array());
    for (place, number) in vectors.chunks_exact_mut(4).zip(numbers) {
        place.copy_from_slice(&number.to_ne_bytes());
    }
    end[..2].copy_from_slice(&photon.order.to_ne_bytes());
    end[2] = photon.flags.bits();
    end[3] = class(photon, is_in_medium);
}

/// Photons of all histories, part by part: those in media and those on surfaces.
type Kept = [Vec<Photons>; 2];

fn shoot(
    scene: &Scene,
    (emitted, seed): (u64, u64),
    (at, orders): (At, (u32, Option<u32>)),
    watch: &Watch,
) -> anyhow::Result<Kept> {
    let keep = || Keep { at, orders, kept: AtomicU64::new(0) };
    let emitter = Emitter::by_power(scene);
    let histories = |count: u64| Histories { count, seed, replicate: 0, max_order: orders.1 };
    let (pilot, first) = (keep(), emitted.min(PILOT));
    Run { is_pilot: true, ..Run::new(scene, &emitter, histories(first)) }.pass(&pilot, &NoProgress)?;
    let expected = pilot.kept.into_inner() as f64 * emitted as f64 / first as f64;
    // As they are kept, and as Python gets them.
    let bytes = expected * (size_of::<Photon>() + RECORD) as f64;
    memory::check(|| format!("{expected:.2e} photons of {emitted} histories"), bytes)?;
    watch.stage("photons", emitted);
    let pass = Run::new(scene, &emitter, histories(emitted)).pass(&keep(), watch)?;
    Ok([pass.media, pass.surfaces])
}

/// Sends photons out and gives back those that are kept, as records, those in media first.
#[pyfunction]
#[pyo3(signature = (scene, parameters, folder, emitted, at, orders, seed, threads, progress))]
#[allow(clippy::too_many_arguments, reason = "called from one place, by name")]
pub fn photons<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    parameters: Option<&Bound<'py, PyDict>>,
    folder: Option<PathBuf>,
    emitted: u64,
    at: &str,
    orders: (u32, Option<u32>),
    seed: u64,
    threads: Option<u16>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyByteArray>> {
    let at = chosen("at", at, &[("media", At::Media), ("surfaces", At::Surfaces), ("both", At::Both)])?;
    let given = Given::read(scene, parameters, folder)?;
    let scene = given.scene()?;
    let kept = work::run(py, threads, progress.as_ref(), move |watch| {
        shoot(&scene, (emitted, seed), (at, orders), watch).map_err(|error| given.named(error))
    })?;
    let count: usize = kept.iter().flatten().map(Photons::len).sum();
    PyByteArray::new_with(py, RECORD * count, |bytes| {
        let mut records = bytes.chunks_exact_mut(RECORD);
        for (parts, is_in_medium) in kept.into_iter().zip([true, false]) {
            // Part by part, so that what is copied is given back.
            for part in parts {
                for (photon, record) in part.iter().zip(records.by_ref().take(part.len())) {
                    write(&photon, is_in_medium, record);
                }
            }
        }
        Ok(())
    })
}
