//! How long an exact answer takes, and PythonicDISORT beside it, in one run on one thread.
//!
//! `cargo bench -p turbid-benches --bench referee -- slab` runs the rows whose name contains the word.
//!
//! The peer solves the same slab in the same session, in turn with the referee, if there is a Python that knows it:
//! `python3 -m venv VENV && VENV/bin/pip install PythonicDISORT`, then `TURBID_PYTHON=VENV/bin/python` before the
//! command. Both sides count the seconds of their own processor clock, one thread each.

use anyhow::{Context, Result, bail};
use cpu_time::ThreadTime;
use paired::{Ratio, compare, compare_seconds};
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use turbid_analytic::{
    AnisotropicMedium, AnisotropicSlab, Incidence, IsotropicSlab, Phase, ScatteringOrders, Sphere,
    SphereSource, Value,
};

const ROUNDS: usize = 15;
const TAU: f64 = 1.0;
const ALBEDO: f64 = 0.9;
const G: f64 = 0.75;
const BEAM: Incidence = Incidence::Beam { mu0: 0.6 };
const DEPTHS: u32 = 10;

fn main() -> Result<()> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let is_wanted = |what: &str| wanted.is_empty() || wanted.iter().any(|word| what.contains(word));
    let mut out = std::io::stdout().lock();
    let phase = Phase::henyey_greenstein(G)?;
    let medium = AnisotropicMedium::new(ALBEDO, &phase)?;
    let slab = medium.slab(TAU, BEAM)?;

    writeln!(
        out,
        "albedo {ALBEDO}, g = {G}, thickness {TAU}, beam of cosine 0.6; one thread, {ROUNDS} rounds"
    )?;
    let mut row = |name: &str, work: &mut dyn FnMut() -> Result<f64>| -> Result<()> {
        if is_wanted(name) {
            let milliseconds = median(work)? * 1e3;
            writeln!(out, "{name:56} {milliseconds:9.3} ms")?;
        }
        Ok(())
    };
    row("a medium", &mut || Ok(AnisotropicMedium::new(ALBEDO, &phase)?.albedo()))?;
    row("a slab of a known medium, with R, T and A", &mut || {
        Ok(medium.slab(TAU, BEAM)?.reflectance().value)
    })?;
    row("ten fluences in a known slab", &mut || Ok(fluences(&slab)?.iter().map(|v| v.value).sum()))?;
    row("a radiance with azimuth, modes known", &mut || Ok(slab.radiance(0.5, 0.3, 1.0)?.value))?;
    row("a radiance with azimuth, the first of a medium", &mut || {
        let slab = AnisotropicMedium::new(ALBEDO, &phase)?.slab(TAU, BEAM)?;
        Ok(slab.radiance(0.5, 0.3, 1.0)?.value)
    })?;
    row("medium, slab, R, T, A and ten fluences", &mut || {
        let slab = AnisotropicMedium::new(ALBEDO, &phase)?.slab(TAU, BEAM)?;
        Ok(fluences(&slab)?[0].value + slab.transmittance().value)
    })?;
    row("a table of 200 slabs (20 thicknesses, 10 incidences)", &mut || {
        let mut sum = 0.0;
        for i in 0..20 {
            for j in 0..10 {
                let tau = libm::pow(10.0, -3.0 + 0.25 * f64::from(i));
                let light = Incidence::Beam { mu0: 0.1 * f64::from(j + 1) };
                sum += medium.slab(tau, light)?.reflectance().value;
            }
        }
        Ok(sum)
    })?;
    row("the first ten orders of scattering, R, T and fluence", &mut || {
        let orders = ScatteringOrders::new(TAU, ALBEDO, &phase, BEAM)?;
        let mut sum = 0.0;
        for n in 0..=10 {
            sum +=
                orders.reflectance(n)?.value + orders.transmittance(n)?.value + orders.fluence(n, 0.5)?.value;
        }
        Ok(sum)
    })?;
    row("an isotropic slab by the integral equation", &mut || {
        Ok(IsotropicSlab::new(TAU, ALBEDO, BEAM)?.reflectance().value)
    })?;
    row("a sphere with a uniform source, escape and ten fluences", &mut || {
        let sphere = Sphere::new(TAU, ALBEDO, SphereSource::Uniform)?;
        let mut sum = sphere.escape().value;
        for i in 0..DEPTHS {
            sum += sphere.fluence(TAU * (f64::from(i) + 0.5) / f64::from(DEPTHS))?.value;
        }
        Ok(sum)
    })?;

    if is_wanted("known medium again") {
        let ratio = compare(
            ROUNDS,
            || _ = black_box(AnisotropicMedium::new(ALBEDO, &phase).and_then(|m| m.slab(TAU, BEAM))),
            || _ = black_box(medium.slab(TAU, BEAM)),
        );
        let [low, high] = ratio.interval;
        writeln!(
            out,
            "a known medium makes a slab {:.1} ({low:.1} to {high:.1}) times faster than a new one",
            ratio.ratio
        )?;
    }
    if is_wanted("PythonicDISORT") {
        beside_the_peer(&mut out, &phase, &slab)?;
    }
    Ok(())
}

/// Median seconds of a piece of work on this thread's clock; short work is repeated until it takes a millisecond.
fn median(work: &mut dyn FnMut() -> Result<f64>) -> Result<f64> {
    let mut repeats = 1_u32;
    let mut once = |repeats: u32| -> Result<f64> {
        let start = ThreadTime::now();
        for _ in 0..repeats {
            black_box(work()?);
        }
        Ok(start.elapsed().as_secs_f64() / f64::from(repeats))
    };
    while once(repeats)? * f64::from(repeats) < 1e-3 {
        repeats *= 2;
    }
    let mut seconds = (0..ROUNDS).map(|_| once(repeats)).collect::<Result<Vec<f64>>>()?;
    seconds.sort_unstable_by(f64::total_cmp);
    Ok(seconds[ROUNDS / 2])
}

fn fluences(slab: &AnisotropicSlab) -> turbid_analytic::Result<Vec<Value>> {
    (0..DEPTHS).map(|i| slab.fluence((f64::from(i) + 0.5) / f64::from(DEPTHS) * TAU)).collect()
}

/// What answers with R, T and ten fluences.
type Solver<'a> = dyn Fn() -> Result<Vec<f64>> + 'a;

/// R, T and ten fluences, from scratch.
fn solve(medium: turbid_analytic::Result<AnisotropicMedium>) -> Result<Vec<f64>> {
    let slab = medium?.slab(TAU, BEAM)?;
    let mut all = vec![slab.reflectance().value, slab.transmittance().value];
    all.extend(fluences(&slab)?.iter().map(|v| v.value));
    Ok(all)
}

fn beside_the_peer(out: &mut impl Write, phase: &Phase, slab: &AnisotropicSlab) -> Result<()> {
    let mut peer = match Peer::start() {
        Ok(peer) => peer,
        Err(why) => {
            writeln!(out, "\nPythonicDISORT is not beside it: {why:#}.")?;
            writeln!(out, "  python3 -m venv VENV && VENV/bin/pip install PythonicDISORT")?;
            writeln!(out, "  TURBID_PYTHON=VENV/bin/python cargo bench -p turbid-benches --bench referee")?;
            return Ok(());
        }
    };
    let exact: Vec<Value> =
        [slab.reflectance(), slab.transmittance()].into_iter().chain(fluences(slab)?).collect();
    let truth: Vec<f64> = exact.iter().map(|v| v.value).collect();
    let bound = exact.iter().fold(0.0, |a: f64, v| a.max(v.error / v.value));
    writeln!(out, "\nR, T and ten fluences from scratch, beside PythonicDISORT of 32 streams")?;
    writeln!(out, "{:34} {:>9}  {:>9} {:>9} {:>9}   speed", "", "ms", "error of R", "T", "fluence")?;
    let theirs = peer.solve(32, 1)?.1;
    let with_streams = |n: usize| solve(AnisotropicMedium::with_streams(ALBEDO, phase, n));
    // The fewest streams that are no less accurate in any of the three.
    let limits = off_by(&theirs, &truth);
    let is_enough = |answer: &[f64]| off_by(answer, &truth).iter().zip(&limits).all(|(a, b)| a <= b);
    let mut enough = 32;
    while enough < 128 && !is_enough(&with_streams(enough)?) {
        enough += 2;
    }
    let mut first = true;
    let ours: [(String, &Solver); 3] = [
        ("referee, 32 streams and 24".into(), &|| with_streams(32)),
        (format!("referee, {enough} streams, as accurate"), &|| with_streams(enough)),
        ("referee, as it answers".into(), &|| solve(AnisotropicMedium::new(ALBEDO, phase))),
    ];
    for (name, work) in ours {
        let answer = work()?;
        let mut failed = None;
        let ratio = compare_seconds(
            ROUNDS,
            || {
                peer.solve(32, 5).map_or_else(
                    |why| {
                        failed = Some(why);
                        f64::NAN
                    },
                    |(seconds, _)| seconds,
                )
            },
            || mean_of_five(work),
        );
        if let Some(why) = failed {
            return Err(why);
        }
        if first {
            line(out, "PythonicDISORT, 32 streams", ratio.seconds[0], &theirs, &truth, None)?;
        }
        line(out, &name, ratio.seconds[1], &answer, &truth, Some(ratio))?;
        first = false;
    }
    writeln!(
        out,
        "errors: relative to the referee's own answer, whose bounds are at most {bound:.1e} of it"
    )?;
    Ok(())
}

/// Mean seconds of five repetitions, as the peer's.
fn mean_of_five(work: &Solver) -> f64 {
    let start = ThreadTime::now();
    for _ in 0..5 {
        _ = black_box(work());
    }
    start.elapsed().as_secs_f64() / 5.0
}

/// How far R, T and the worst of the fluences are off, relative.
fn off_by(answer: &[f64], truth: &[f64]) -> [f64; 3] {
    let mut off = answer.iter().zip(truth).map(|(a, b)| (a / b - 1.0).abs());
    let (r, t) = (off.next().unwrap_or(f64::NAN), off.next().unwrap_or(f64::NAN));
    [r, t, off.fold(0.0, f64::max)]
}

fn line(
    out: &mut impl Write,
    name: &str,
    seconds: f64,
    answer: &[f64],
    truth: &[f64],
    ratio: Option<Ratio>,
) -> Result<()> {
    let [r, t, fluence] = off_by(answer, truth);
    write!(out, "{name:34} {:9.3}  {r:9.1e} {t:9.1e} {fluence:9.1e}", seconds * 1e3)?;
    match ratio {
        Some(Ratio { ratio, interval: [low, high], .. }) => {
            writeln!(out, "   {ratio:.2} ({low:.2} to {high:.2}) times the peer's")?;
        }
        None => writeln!(out, "   1")?,
    }
    Ok(())
}

/// A Python that solves slabs, asked line by line.
struct Peer {
    process: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Peer {
    fn start() -> Result<Self> {
        let python = std::env::var("TURBID_PYTHON").unwrap_or_else(|_| "python3".into());
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/referee_peer.py");
        let known = Command::new(&python)
            .args(["-c", "import PythonicDISORT"])
            .stderr(Stdio::null())
            .status()
            .with_context(|| format!("{python} does not run"))?;
        if !known.success() {
            bail!("{python} has no module PythonicDISORT");
        }
        let mut process = Command::new(&python)
            .arg(script)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("{python} does not run"))?;
        let questions = process.stdin.take().context("no way to ask")?;
        let answers = BufReader::new(process.stdout.take().context("no way to listen")?);
        Ok(Peer { process, questions, answers })
    }

    /// Processor seconds of one solution, and R, T and the fluences.
    fn solve(&mut self, streams: u32, repeats: u32) -> Result<(f64, Vec<f64>)> {
        writeln!(self.questions, "{streams} {repeats}")?;
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        let numbers = line
            .split_whitespace()
            .map(str::parse)
            .collect::<std::result::Result<Vec<f64>, _>>()
            .with_context(|| format!("the peer said {line:?}"))?;
        match numbers.split_first() {
            Some((&seconds, answer)) if answer.len() == 2 + DEPTHS as usize => Ok((seconds, answer.to_vec())),
            _ => bail!("the peer said {line:?}"),
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // Nothing is left to do for a process that has gone already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
