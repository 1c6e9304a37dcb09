//! What a picture took.

use cpu_time::ProcessTime;
use std::time::{Duration, Instant};
use turbid::integrators::mapper::{Report, Settings};
use turbid::photons::beams::BeamMap;
use turbid::photons::maps::{MapReport, Maps};
use turbid::photons::planes::PlaneMap;
use turbid::sensor::{BlockMean, Film};

/// What a picture took.
pub struct Made {
    /// The picture.
    pub film: Film,
    /// Repetitions.
    pub repetitions: u64,
    /// Samples a pixel of each repetition, or one number for all.
    pub samples: Vec<u64>,
    /// Samples a pixel of all of them.
    pub total_samples: u64,
    /// How the first map is read, if there are maps.
    pub first_read: Option<Settings>,
    /// Rays and look-ups.
    pub work: Report,
    /// What filling each repetition's maps took, and how full the global, caustic and volume map are; of a progressive picture the
    /// first and the last of this run.
    pub maps: Vec<MapsMade>,
    /// Times.
    pub stages: Stages,
    /// Block means of each repetition, if it is to be compared.
    pub block_means: Vec<Vec<BlockMean>>,
    /// Whether it was made by light tracing.
    pub is_by_light: bool,
}

/// The maps of one repetition.
#[derive(Default)]
pub struct MapsMade {
    /// Which one it is.
    pub number: u64,
    /// What filling them took.
    pub report: MapReport,
    /// How full the global, caustic and volume map are; none where the scene needs none.
    pub filled: [Option<Filled>; 3],
    /// How they are read, if they are.
    pub settings: Option<Settings>,
}

impl MapsMade {
    /// Counts a part of the photons.
    pub fn add(&mut self, maps: &Maps) {
        self.report.add_part(&maps.report);
        let emitted = [&maps.global, &maps.caustic, &maps.volume].map(|map| Some(map.as_ref()?.emitted()));
        let of_beams = maps.beams.as_ref().map(BeamMap::emitted);
        let of_planes = maps.planes.as_ref().map(PlaneMap::emitted);
        let emitted = [emitted[0], emitted[1], emitted[2].or(of_beams).or(of_planes)];
        for ((mine, stored), emitted) in self.filled.iter_mut().zip(maps.stored()).zip(emitted) {
            let before = mine.map_or(0, |filled| filled.stored);
            *mine = emitted.map(|emitted| Filled { stored: before + stored, emitted });
        }
    }
}

/// How full a map is.
#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct Filled {
    /// Photons in it.
    pub stored: usize,
    /// Photons that its pass sent out for it.
    pub emitted: u64,
}

/// What a stage took.
pub struct Stage {
    pub name: &'static str,
    /// By the clock.
    pub clock: Duration,
    /// Of all threads' processors.
    pub processor: Duration,
    /// Most memory that the process had had by its end \[bytes\], where the system tells.
    pub memory: Option<u64>,
}

/// Time and memory by stage.
#[derive(Default)]
pub struct Stages(pub Vec<Stage>);

impl Stages {
    /// Does something, and adds its time to a stage.
    pub fn time<T>(&mut self, stage: &'static str, work: impl FnOnce() -> T) -> T {
        let (clock, processor) = (Instant::now(), ProcessTime::now());
        let result = work();
        let (clock, processor) = (clock.elapsed(), processor.elapsed());
        let memory = peak_memory();
        match self.0.iter_mut().find(|known| known.name == stage) {
            Some(known) => {
                known.clock += clock;
                known.processor += processor;
                known.memory = memory;
            }
            None => self.0.push(Stage { name: stage, clock, processor, memory }),
        }
        result
    }
}

/// Most memory that the process has had \[bytes\], where the system tells.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
}
