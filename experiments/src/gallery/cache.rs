//! Cached renders of a picture, each kept in a file as soon as it is made: an interrupted run goes on where it stopped.

use super::keep::{CachedRender, RenderRecord};
use super::light::ByLight;
use super::lines::Stored;
use super::pictures::Lines;
use super::settings::Settings;
use super::studio::Studio;
use crate::harness::{duration, say};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use turbid::transport::Progress;

/// The cached renders of one picture in one size, in a folder.
pub struct Cache<'a> {
    /// What the user chose.
    pub settings: &'a Settings,
    /// Where they are kept.
    pub folder: PathBuf,
    /// Who makes them.
    pub studio: &'a Studio<'a>,
}

impl Cache<'_> {
    /// A render from its file, or made now and kept.
    fn get(
        &self,
        file: &str,
        words: &str,
        work: u64,
        make: impl FnOnce(&Bar) -> anyhow::Result<CachedRender>,
    ) -> anyhow::Result<CachedRender> {
        let path = self.folder.join(format!("{file}.picture"));
        if !self.settings.fresh
            && let Ok(kept) = CachedRender::read(&path, self.studio.grid().pixels())
            && kept.facts.words == words
            && (self.settings.reuse || kept.facts.program == self.studio.program)
        {
            return Ok(kept);
        }
        let mut kept = make(&Bar::new(&format!("{}, {file}", self.studio.picture.name), work))?;
        kept.facts.words = words.to_string();
        kept.write(&path)?;
        Ok(kept)
    }

    /// The picture of a method without photon maps in so many CPU seconds.
    pub fn rival(&self, file: &str, by_light: ByLight, seconds: f64) -> anyhow::Result<CachedRender> {
        let s = self.studio;
        let words = format!("{} in {seconds} s", s.unbiased_words(by_light, 0, 0));
        self.get(file, &words, 0, |bar| Ok(s.unbiased_for(by_light, seconds, 0, bar)?.without_layers()))
    }

    /// The picture with its medium read along whole rays, in as many CPU seconds as `ours` took.
    pub fn lines(&self, of: (&Lines, Stored), ours: &RenderRecord) -> anyhow::Result<CachedRender> {
        let s = self.studio;
        self.get(of.1.kind(), &s.words_of_lines(of, ours.seconds), 0, |bar| {
            Ok(s.lines_for(of, ours.radii, ours.seconds, bar)?.without_layers())
        })
    }

    /// A pass of the reference.
    pub fn reference(
        &self,
        file: &str,
        by_light: ByLight,
        samples: u64,
        replicate: u64,
    ) -> anyhow::Result<CachedRender> {
        let (s, work) = (self.studio, self.studio.work(samples));
        let words = s.unbiased_words(by_light, samples, replicate);
        self.get(file, &words, work, |bar| {
            Ok(s.unbiased(by_light, samples, replicate, bar)?.without_layers())
        })
    }

    /// The photon mapper's picture.
    pub fn photons(&self, file: &str, samples: u64, replicate: u64) -> anyhow::Result<CachedRender> {
        let (s, work) = (self.studio, self.studio.work(samples));
        let words = s.photon_words(samples, replicate, 1);
        self.get(file, &words, work, |bar| Ok(s.photons(samples, replicate, 1, bar)?.without_layers()))
    }

    /// The same by classes of light, with `factor` times the photons.
    pub fn photons_by_class(
        &self,
        file: &str,
        samples: u64,
        replicate: u64,
        factor: u64,
    ) -> anyhow::Result<CachedRender> {
        let (s, work) = (self.studio, self.studio.work(samples));
        let words = s.photon_words(samples, replicate, factor);
        self.get(file, &words, work, |bar| s.photons(samples, replicate, factor, bar))
    }
}

/// Progress with remaining time, on standard error, a line every ten seconds.
pub struct Bar {
    what: String,
    total: u64,
    done: AtomicU64,
    start: Instant,
    told: AtomicU64,
}

impl Bar {
    /// For so many samples in all; 0 if it is not known.
    pub fn new(what: &str, total: u64) -> Self {
        Bar { what: what.to_string(), total, done: 0.into(), start: Instant::now(), told: 0.into() }
    }
}

impl Progress for Bar {
    fn advance(&self, histories: u64) {
        let done = self.done.fetch_add(histories, Ordering::Relaxed) + histories;
        let spent = self.start.elapsed();
        let tens = spent.as_secs() / 10;
        if self.told.fetch_max(tens, Ordering::Relaxed) < tens {
            let left = if self.total == 0 {
                String::new()
            } else {
                let share = (done as f64 / self.total as f64).min(1.0);
                let left = Duration::as_secs_f64(&spent) * (1.0 - share) / share.max(1e-9);
                format!(", {:.0} %, about {} left", 100.0 * share, duration(left))
            };
            say(&format!("  {}{left}", self.what));
        }
    }
}
