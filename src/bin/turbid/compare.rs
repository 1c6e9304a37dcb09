//! `turbid render --compare`: the picture against an unbiased reference of the same camera.

use super::progress::Bar;
use super::shared::{note, print, whole};
use anyhow::{Context, bail};
use clap::ValueEnum;
use serde::Serialize;
use std::path::{Path, PathBuf};
use turbid::output::{
    error_scale, one_line, write_aligned, write_atomically, write_csv, write_error_picture,
};
use turbid::scene::{Camera, Scene};
use turbid::sensor::{
    Blocks, Comparison, Film, MAX_SAMPLES, Method, PictureError, Streams, compare, luminance_errors,
};

/// What the picture is compared with.
#[derive(clap::Args)]
pub struct Compared {
    /// Compare the picture with an unbiased one of the same camera, made after it: writes beside the EXR NAME-error.png,
    /// the relative error of the luminance of blocks, and NAME-error.csv, mean, bias and root mean square error in total and by
    /// layer, and prints a short table. With several --maps, blocks are tested one by one.
    #[arg(long, value_enum)]
    compare: Option<ReferenceName>,
    /// Samples a pixel of the reference, at least 2 [default: as many as make its error half the picture's, by a pilot, up to
    /// 1024; 64 where the pilot does not tell].
    #[arg(long, value_parser = whole::<u64>(2..=MAX_SAMPLES), requires = "compare")]
    compare_samples: Option<u64>,
}

#[derive(Clone, Copy, ValueEnum)]
enum ReferenceName {
    /// The unbiased path tracer.
    Paths,
}

/// Samples of the pilot, and of a reference where it says nothing; the most that it asks for.
const PILOT: u64 = 8;
const SAMPLES: u64 = 64;
const MOST: u64 = 1024;

/// A line of NAME-error.csv.
#[derive(Serialize)]
struct Row {
    layer: &'static str,
    mean: f64,
    reference: f64,
    relative_bias: f64,
    relative_bias_error: f64,
    error_holds: &'static str,
    rmse: f64,
    rmse_error: f64,
    relative_rmse: f64,
    relative_rmse_error: f64,
    block_side: u32,
    blocks: Option<usize>,
    blocks_that_differ: Option<usize>,
    blocks_undecided: Option<usize>,
    detectable_relative_bias: Option<f64>,
    reference_samples: u64,
    reference_guide: Option<u64>,
}

impl Compared {
    /// Whether there is something to compare with.
    pub fn is_asked_for(&self) -> bool {
        self.compare.is_some()
    }

    /// The files of a picture's comparison.
    pub fn files(&self, output: &Path) -> Vec<PathBuf> {
        if self.compare.is_none() {
            return Vec::new();
        }
        let stem = output.file_stem().unwrap_or_default();
        let named = |end: &str| {
            let mut name = stem.to_os_string();
            name.push(end);
            output.with_file_name(name)
        };
        vec![named("-error.png"), named("-error.csv")]
    }

    /// Refuses scenes that the reference cannot be made of.
    pub fn check(&self, scene: &Scene) -> anyhow::Result<()> {
        if self.compare.is_some() && !scene.plan().unreachable.is_empty() {
            bail!(
                "--compare paths: the path tracer cannot sample every path of this scene ({}); allowed: without --compare, or a \
                 light with an extent",
                scene.plan().unreachable.join("; ")
            );
        }
        Ok(())
    }

    /// The reference of a picture, from streams of its own.
    pub fn reference(
        &self,
        paths: &Method<'_>,
        camera: &Camera,
        picture: &Film,
        streams: Streams,
    ) -> anyhow::Result<Film> {
        let mut film = Film::new(camera.width(), camera.height());
        let pixels = film.pixels().len() as u64;
        let take = |film: &mut Film, samples: u64| -> anyhow::Result<()> {
            let bar = Bar::stage("reference", samples.saturating_mul(pixels));
            let work = paths.extend(film, camera, samples, streams, &bar);
            bar.finish();
            work.context("--compare paths")?;
            Ok(())
        };
        if let Some(samples) = self.compare_samples {
            take(&mut film, samples)?;
            return Ok(film);
        }
        take(&mut film, PILOT)?;
        let samples = samples_for(picture, &film);
        take(&mut film, samples - PILOT)?;
        Ok(film)
    }

    /// Writes and prints how far a picture is from its reference, whose paths so many histories led.
    pub fn tell(
        &self,
        output: &Path,
        scene: &Scene,
        (picture, reference, guide): (&Film, &Film, Option<u64>),
        error: PictureError<'_>,
    ) -> anyhow::Result<()> {
        let blocks = Blocks::of(picture.width(), picture.height());
        let channels = if scene.plan().is_grey { 1 } else { 3 };
        let compared = compare(blocks, picture, reference, error, channels);
        let errors = luminance_errors(blocks, picture, reference);
        let scale = error_scale(errors.iter().flatten().copied());
        let rows = compared.iter().map(|one| row(one, blocks, (reference, guide))).collect::<Vec<_>>();
        let files = self.files(output);
        let [png, csv] = &files[..] else { return Ok(()) };
        let size = (picture.width(), picture.height());
        write_error_picture(png, size, |x, y| errors[blocks.at(x, y)], scale)?;
        write_atomically(csv, |out| write_csv(out, &rows))?;
        let text = |lines: &[[String; 7]]| -> anyhow::Result<String> {
            let mut out = Vec::new();
            write_aligned(&mut out, lines, 1)?;
            Ok(String::from_utf8(out)?)
        };
        let table = text(&lines(&rows))?;
        print(&format!(
            "compared       with {}paths of {} samples a pixel; blocks of {} x {} pixels\n{table}",
            if guide.is_some() { "guided " } else { "" },
            reference.samples(),
            blocks.side(),
            blocks.side(),
        ))?;
        let name = |path: &Path| one_line(&path.display().to_string());
        print(&format!("written        {}, {}\n", name(png), name(csv)))?;
        if matches!(error, PictureError::Unknown) {
            note(
                "all pixels of one picture share its photons, whose error a single repetition does not tell: no test of blocks, and \
                 the error of the bias is the reference's alone; --maps 8 or more tells it",
            )?;
        }
        Ok(())
    }
}

/// Samples that make the root mean square error of a reference half the picture's, by one of few samples.
fn samples_for(picture: &Film, pilot: &Film) -> u64 {
    let (mut square, mut noise) = (0.0, 0.0);
    for (mine, other) in picture.pixels().iter().zip(pilot.pixels()) {
        let (difference, variance) = (mine.total() - other.total(), other.variance().unwrap_or_default());
        square += (difference * difference).mean() - variance.mean();
        noise += variance.mean();
    }
    // What is below a tenth of the noise may be noise.
    if square < 0.1 * noise {
        return SAMPLES;
    }
    let samples = PILOT as f64 * noise / (0.25 * square);
    (samples.ceil() as u64).clamp(2 * PILOT, MOST)
}

fn row(one: &Comparison, blocks: Blocks, (reference, guide): (&Film, Option<u64>)) -> Row {
    let relative = |x: f64| x / one.reference.abs();
    Row {
        layer: one.layer.map_or("total", |layer| layer.name()),
        mean: one.mean,
        reference: one.reference,
        relative_bias: relative(one.mean - one.reference),
        relative_bias_error: relative(one.std_error),
        error_holds: if one.test.is_some() { "picture and reference" } else { "reference" },
        rmse: one.rmse,
        rmse_error: one.rmse_error,
        relative_rmse: relative(one.rmse),
        relative_rmse_error: relative(one.rmse_error),
        block_side: blocks.side(),
        blocks: one.test.map(|test| test.blocks),
        blocks_that_differ: one.test.map(|test| test.differ),
        blocks_undecided: one.test.map(|test| test.undecided),
        detectable_relative_bias: one.test.map(|test| relative(test.smallest)),
        reference_samples: reference.samples(),
        reference_guide: guide,
    }
}

/// The short table, in per cent of each layer's own mean.
fn lines(rows: &[Row]) -> Vec<[String; 7]> {
    let header = ["layer", "mean", "reference", "bias %", "RMSE %", "blocks differ", "detectable bias %"];
    let percent = |x: f64, error: f64| format!("{:.2} ± {:.2}", 100.0 * x, 100.0 * error);
    let mut lines = vec![header.map(String::from)];
    for row in rows {
        let differ = match (row.blocks_that_differ, row.blocks, row.blocks_undecided) {
            (Some(differ), Some(blocks), Some(0)) => format!("{differ} of {blocks}"),
            (Some(differ), Some(blocks), Some(open)) => format!("{differ} of {blocks}, {open} undecided"),
            _ => "no test".to_string(),
        };
        let detectable = row.detectable_relative_bias;
        lines.push([
            row.layer.to_string(),
            format!("{:.4e}", row.mean),
            format!("{:.4e}", row.reference),
            percent(row.relative_bias, row.relative_bias_error),
            percent(row.relative_rmse, row.relative_rmse_error),
            differ,
            detectable.map_or_else(|| "no test".to_string(), |x| format!("{:.2}", 100.0 * x)),
        ]);
    }
    lines
}
