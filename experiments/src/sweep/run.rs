//! The run over seeds: a process a scene, so that nothing that a scene does can stop the others; kept in files; summed up.

use super::draw::draw;
use super::examine::{Alarm, Examined, examine};
use super::settings::Settings;
use super::shrink::shrunk;
use super::text::SceneText;
use crate::harness::{caught, check_folder, check_later, duration, on_threads, program, program_digest, say};
use anyhow::{Context, bail};
use clap::Parser;
use cpu_time::ProcessTime;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use turbid::input::read_text;
use turbid::output::{print, write_atomically};
use turbid::stats::holm;

/// Family-wise level of a run.
pub const LEVEL: f64 = 1e-3;
/// The largest part of all scenes that may stay undecided.
pub const MOST_UNDECIDED: f64 = 0.1;
/// p-value of a confirmation from which a smaller scene is looked for at once, before the run's end decides.
const SHRINK: f64 = 1e-4;
/// Draws of a seed, at most, until one is valid.
const DRAWS: u64 = 20;
/// Scenes that are tried on the way to the smallest.
const TRIES: usize = 60;
/// Time in which a smaller scene is looked for.
const LONGEST_SHRINKING: Duration = Duration::from_secs(180);

/// What is kept of a seed.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Record {
    /// What it depends on beside the seed: effort and program.
    pub header: String,
    /// The seed.
    pub seed: u64,
    /// What is in the scene.
    pub what: String,
    /// Scenes that were refused before this one, and why.
    pub refused_scenes: Vec<String>,
    /// What was found.
    pub found: Examined,
    /// CPU seconds.
    pub seconds: f64,
    /// The smallest scene that shows an alarm, where one was looked for.
    pub smallest: Option<String>,
}

/// Records of scenes are no larger.
const MOST_OF_A_RECORD: u64 = 1 << 26;
/// Exit code of a scene's process that was ended by a signal: [`turbid::output::end_on_signal`].
const INTERRUPTED: i32 = 130;

impl Record {
    /// That of a scene which ended a method, or the whole process.
    fn broken(seed: u64, check: &str, text: &str) -> Self {
        let found = Examined { alarms: vec![Alarm::failure(check, text)], ..Examined::default() };
        Record { seed, found, ..Record::default() }
    }
}

/// Runs the sweep as a program.
pub fn main() -> ExitCode {
    let kept = |settings: &Settings| match settings.seed.is_some() || settings.scene.is_some() {
        true => "nothing is kept".to_string(),
        false => {
            let out = settings.out.display();
            format!("finished scenes are kept in {out}, and the same command goes on from there")
        }
    };
    program("sweep", Settings::try_parse, kept, run)
}

fn run(settings: &Settings) -> anyhow::Result<u8> {
    if let Some(path) = &settings.child {
        let record = match caught(|| examined(settings)) {
            Ok(examined) => examined?,
            Err(panic) => Record::broken(settings.seed.unwrap_or(0), "scene", &panic),
        };
        let text = serde_json::to_vec(&record)?;
        write_atomically(path, |out| out.write_all(&text))?;
        return Ok(0);
    }
    if settings.print {
        let (drawn, _) = drawn(settings.seed.unwrap_or(0))?;
        print(|out| write!(out, "{}", drawn.toml()))?;
        return Ok(0);
    }
    settings.effort()?;
    if settings.seed.is_some() || settings.scene.is_some() {
        return one(settings);
    }
    many(settings)
}

/// The first valid scene of a seed, and why those before it were refused.
fn drawn(seed: u64) -> anyhow::Result<(SceneText, (String, Vec<String>))> {
    let mut refused = Vec::new();
    for attempt in 0..DRAWS {
        let drawn = draw(seed, attempt);
        match drawn.text.scene() {
            Ok(_) => return Ok((drawn.text, (drawn.what, refused))),
            Err(error) => refused.push(format!("{error:#}")),
        }
    }
    bail!("seed {seed}: {DRAWS} scenes were refused, the last one: {}", refused.pop().unwrap_or_default())
}

/// Examines one scene in this process. What does not end is ended, and said to be wrong.
fn examined(settings: &Settings) -> anyhow::Result<Record> {
    let seed = settings.seed.unwrap_or(0);
    let effort = settings.effort()?;
    let (text, (what, refused_scenes)) = match &settings.scene {
        Some(path) => (SceneText::read(path)?, (path.display().to_string(), Vec::new())),
        None => drawn(seed)?,
    };
    let record = Record { seed, what, refused_scenes, ..Record::default() };
    let stage = Arc::new(Mutex::new((String::new(), 0.0)));
    // Far longer than a method's own clock allows: it is within one history, and no clock is asked there.
    let most = 10.0 * effort.seconds.unwrap_or(f64::INFINITY);
    let (watched, template, path) = (Arc::clone(&stage), record.clone(), settings.child.clone());
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_millis(500));
            let Ok(state) = watched.lock() else { return };
            let (name, since) = &*state;
            if ProcessTime::now().as_duration().as_secs_f64() - since < most {
                continue;
            }
            let text = format!("does not end: more than {most:.0} s of CPU time");
            let found = Record::broken(0, name, &text).found;
            let seconds = ProcessTime::now().as_duration().as_secs_f64();
            let record = Record { found, seconds, ..template };
            let text = serde_json::to_vec(&record).unwrap_or_default();
            let written = path.as_ref().map(|path| write_atomically(path, |out| out.write_all(&text)));
            std::process::exit(if matches!(written, Some(Ok(()))) { 0 } else { 2 });
        }
    });
    let tell = |name: &str| {
        if let Ok(mut state) = stage.lock() {
            *state = (name.to_string(), ProcessTime::now().as_duration().as_secs_f64());
        }
    };
    let found = match caught(|| examine(&text, seed, &effort, &tell)) {
        Ok(found) => found?,
        Err(panic) => {
            let name = stage.lock().map(|state| state.0.clone()).unwrap_or_default();
            Record::broken(seed, &name, &panic).found
        }
    };
    let seconds = ProcessTime::now().as_duration().as_secs_f64();
    Ok(Record { found, seconds, ..record })
}

/// Examines a scene in a process of its own.
fn in_child(settings: &Settings, seed: u64, scene: Option<&Path>) -> anyhow::Result<Record> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("record.json");
    let mut command = Command::new(std::env::current_exe()?);
    command.env("RAYON_NUM_THREADS", "1").args(["--effort", &settings.effort.to_string()]);
    command.args(["--control", &settings.control.to_string()]);
    command.args(["--seed", &seed.to_string()]).arg("--child").arg(&path);
    if let Some(scene) = scene {
        command.arg("--scene").arg(scene);
    }
    let output = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).output();
    let output = output.context("cannot start a process")?;
    if output.status.success() {
        let text = read_text(&path, MOST_OF_A_RECORD).context("a scene left no record")?;
        return Ok(serde_json::from_str(&text)?);
    }
    let said = String::from_utf8_lossy(&output.stderr).trim().lines().take(3).collect::<Vec<_>>().join("; ");
    if output.status.code() == Some(2) {
        bail!("seed {seed}: {}", said.trim_start_matches("error: "));
    }
    if output.status.code() == Some(INTERRUPTED) {
        // Most often the signal was for all processes, and this one is about to end by its own last word.
        std::thread::sleep(Duration::from_secs(1));
        bail!("seed {seed}: stopped by a signal");
    }
    let what = drawn(seed).map_or_else(|_| String::new(), |(_, (what, _))| what);
    Ok(Record { what, ..Record::broken(seed, "process", &format!("ended by {}: {said}", output.status)) })
}

/// Alarms that are not waiting for the whole run's verdict.
fn clear_alarms(record: &Record) -> impl Iterator<Item = &Alarm> {
    record.found.alarms.iter().filter(|alarm| alarm.p() < SHRINK)
}

/// Looks for the smallest scene that shows an alarm of the same kind; writes it, and says where.
fn shrink(settings: &Settings, record: &Record, text: &SceneText) -> anyhow::Result<Option<String>> {
    let places: Vec<(String, String)> = clear_alarms(record).map(Alarm::place).collect();
    if settings.no_shrink || places.is_empty() {
        return Ok(None);
    }
    let folder = tempfile::tempdir()?;
    let (mut tries, start) = (0, Instant::now());
    let smallest = shrunk(text, |less| {
        tries += 1;
        let own = folder.path().join(tries.to_string());
        let tried = (|| {
            less.write(&own, "less.toml")?;
            in_child(settings, record.seed, Some(&own.join("less.toml")))
        })();
        tries <= TRIES
            && start.elapsed() < LONGEST_SHRINKING
            && tried.is_ok_and(|less| clear_alarms(&less).any(|alarm| places.contains(&alarm.place())))
    });
    let name = match &settings.scene {
        Some(path) => path.file_stem().and_then(|s| s.to_str()).unwrap_or("scene").to_string(),
        None => format!("seed-{}", record.seed),
    };
    let folder = settings.out.join("failures").join(name);
    smallest.write(&folder, "scene.toml")?;
    Ok(Some(folder.join("scene.toml").display().to_string()))
}

/// One scene, with all that was found.
fn one(settings: &Settings) -> anyhow::Result<u8> {
    let seed = settings.seed.unwrap_or(0);
    let text = match &settings.scene {
        Some(path) => SceneText::read(path)?,
        None => drawn(seed)?.0,
    };
    if !settings.no_shrink {
        check_later(&settings.out.join("failures"))?;
    }
    let mut record = in_child(settings, seed, settings.scene.as_deref())?;
    record.smallest = shrink(settings, &record, &text)?;
    let verdict = verdict(&record, LEVEL);
    print(|out| {
        write!(out, "{}\n# seed {seed}: {}\n", text.toml(), record.what)?;
        for reason in &record.refused_scenes {
            writeln!(out, "a scene was refused: {reason}")?;
        }
        for line in record.found.refused.iter().chain(&record.found.late) {
            writeln!(out, "refused or late: {line}")?;
        }
        for check in &record.found.checks {
            let none = if check.tests == 0 { "nothing" } else { "heavy tails" };
            let smallest = check.smallest.map_or(none.into(), |s| format!("{:.1} %", 100.0 * s));
            writeln!(
                out,
                "{:44} {:3} numbers, smallest detectable deviation {smallest}",
                check.check, check.tests
            )?;
            if let Some(worst) = &check.worst {
                writeln!(out, "{:44} farthest {}", "", worst.line())?;
            }
        }
        for alarm in &record.found.alarms {
            alarm.lines().into_iter().try_for_each(|line| writeln!(out, "ALARM {line}"))?;
        }
        let smallest = record.found.smallest.map_or("nothing".into(), |s| format!("{:.1} %", 100.0 * s));
        let (word, seconds) = (verdict.word(), record.seconds);
        writeln!(
            out,
            "{word}; smallest detectable deviation in half of the light: {smallest}; {seconds:.1} s of CPU time"
        )
    })?;
    if let Some(path) = &record.smallest {
        let smallest = read_text(Path::new(path), MOST_OF_A_RECORD).unwrap_or_default();
        print(|out| {
            write!(out, "the smallest scene that shows it, {path}:\n{smallest}\n")?;
            writeln!(
                out,
                "again: cargo run --release --bin sweep -- --seed {seed} --scene {path}{}",
                settings.own()
            )
        })?;
    }
    Ok(verdict.code())
}

/// What a scene says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Agree,
    Undecided,
    Alarm,
}

impl Verdict {
    fn word(self) -> &'static str {
        match self {
            Verdict::Agree => "agree",
            Verdict::Undecided => "undecided",
            Verdict::Alarm => "ALARM",
        }
    }

    fn code(self) -> u8 {
        match self {
            Verdict::Agree => 0,
            Verdict::Undecided => 3,
            Verdict::Alarm => 1,
        }
    }
}

/// The verdict of a scene; an alarm has a confirmation below `level`.
fn verdict(record: &Record, level: f64) -> Verdict {
    match () {
        () if record.found.alarms.iter().any(|alarm| alarm.p() <= level) => Verdict::Alarm,
        () if record.found.undecided().is_some() => Verdict::Undecided,
        () => Verdict::Agree,
    }
}

/// All seeds.
fn many(settings: &Settings) -> anyhow::Result<u8> {
    check_folder(&settings.out, &["record.json"])?;
    let wrong =
        if settings.control == 1.0 { String::new() } else { format!(", control {}", settings.control) };
    let header = format!("effort {}{wrong}, program {}", settings.effort, program_digest()?);
    let kept = |seed: u64| -> Option<Record> {
        let text = read_text(&settings.out.join(format!("{seed}.json")), MOST_OF_A_RECORD).ok()?;
        let record: Record = serde_json::from_str(&text).ok()?;
        (settings.reuse || record.header == header).then_some(record)
    };
    let (start, state) = (Instant::now(), Mutex::new((0usize, 0usize, Instant::now())));
    let seeds: Vec<u64> = settings.seeds.clone().collect();
    let examine = |seed: &u64| -> anyhow::Result<Record> {
        if let Some(record) = kept(*seed) {
            return Ok(record);
        }
        let mut record = in_child(settings, *seed, None)?;
        record.header.clone_from(&header);
        if clear_alarms(&record).next().is_some() {
            record.smallest = shrink(settings, &record, &drawn(*seed)?.0)?;
            for line in clear_alarms(&record).take(2).flat_map(Alarm::lines) {
                say(&format!("seed {seed} ({}): {line}", record.what));
            }
        }
        let text = serde_json::to_vec(&record)?;
        write_atomically(settings.out.join(format!("{seed}.json")), |out| out.write_all(&text))?;
        if let Ok(mut state) = state.lock() {
            state.0 += 1;
            state.1 += usize::from(clear_alarms(&record).next().is_some());
            if state.2.elapsed() > Duration::from_secs(10) {
                state.2 = Instant::now();
                let left = seeds.len() - state.0;
                let each = start.elapsed().as_secs_f64() / state.0 as f64;
                let left = duration(each * left as f64);
                say(&format!(
                    "  {} of {} scenes, {} alarms, at most {left} left",
                    state.0,
                    seeds.len(),
                    state.1
                ));
            }
        }
        Ok(record)
    };
    let records: Vec<Record> =
        on_threads(settings.threads, || seeds.par_iter().with_max_len(1).map(examine).collect())?;
    summary(settings, &records)
}

/// The table, and what the run says.
fn summary(settings: &Settings, records: &[Record]) -> anyhow::Result<u8> {
    // Holm over all confirmations of the run: each tests one number, chosen on other data.
    let alarms: Vec<(u64, &Alarm)> =
        records.iter().flat_map(|r| r.found.alarms.iter().map(|a| (r.seed, a))).collect();
    let adjusted = holm(&alarms.iter().map(|(_, alarm)| alarm.p()).collect::<Vec<_>>());
    let is_alarm = |seed: u64| alarms.iter().zip(&adjusted).any(|((s, _), p)| *s == seed && *p <= LEVEL);
    let verdict = |record: &Record| match is_alarm(record.seed) {
        true => Verdict::Alarm,
        false if record.found.undecided().is_some() => Verdict::Undecided,
        false => Verdict::Agree,
    };
    let count = |wanted: Verdict| records.iter().filter(|r| verdict(r) == wanted).count();
    let (wrong, undecided) = (count(Verdict::Alarm), count(Verdict::Undecided));
    let mut refusals: BTreeMap<&str, usize> = BTreeMap::new();
    for reason in records.iter().flat_map(|r| &r.refused_scenes) {
        *refusals.entry(reason).or_default() += 1;
    }
    let mut cannot: BTreeMap<&str, usize> = BTreeMap::new();
    for reason in records.iter().flat_map(|r| &r.found.refused) {
        *cannot.entry(reason).or_default() += 1;
    }
    let mut sharp: BTreeMap<&str, (usize, usize, Vec<f64>)> = BTreeMap::new();
    for check in records.iter().flat_map(|r| &r.found.checks) {
        let entry = sharp.entry(&check.check).or_default();
        entry.0 += 1;
        entry.1 += check.tests;
        entry.2.push(check.smallest.unwrap_or(f64::INFINITY));
    }
    print(|out| {
        writeln!(
            out,
            "{:44} {:>6} {:>8} {:>10} {:>10}",
            "compared", "scenes", "numbers", "median", "nine in ten"
        )?;
        for (name, (scenes, numbers, mut smallest)) in sharp {
            smallest.sort_by(f64::total_cmp);
            let at = |share: f64| 100.0 * smallest[((smallest.len() - 1) as f64 * share) as usize];
            writeln!(out, "{name:44} {scenes:6} {numbers:8} {:8.1} % {:8.1} %", at(0.5), at(0.9))?;
        }
        let mut smallest: Vec<f64> =
            records.iter().map(|r| r.found.smallest.unwrap_or(f64::INFINITY)).collect();
        smallest.sort_by(f64::total_cmp);
        let at = |share: f64| {
            smallest.get((smallest.len() as f64 * share) as usize).map_or(f64::NAN, |s| 100.0 * s)
        };
        writeln!(out, "{:44} {:6} {:>8} {:8.1} % {:8.1} %", "scene", records.len(), "", at(0.5), at(0.9))?;
        for (reason, count) in &refusals {
            writeln!(out, "scenes refused: {count} x {reason}")?;
        }
        for (reason, count) in &cannot {
            writeln!(out, "methods refused: {count} x {reason}")?;
        }
        for record in records.iter().filter(|r| verdict(r) == Verdict::Undecided) {
            let why = record.found.undecided().unwrap_or_default();
            writeln!(out, "undecided: seed {}: {why} ({})", record.seed, record.what)?;
        }
        for record in records.iter().filter(|r| verdict(r) == Verdict::Alarm) {
            writeln!(out, "ALARM: seed {} ({})", record.seed, record.what)?;
            let own = alarms.iter().zip(&adjusted).filter(|((s, _), p)| *s == record.seed && **p <= LEVEL);
            for ((_, alarm), _) in own.take(2) {
                alarm.lines().into_iter().try_for_each(|line| writeln!(out, "    {line}"))?;
            }
            if let Some(path) = &record.smallest {
                writeln!(out, "    the smallest scene that shows it: {path}")?;
            }
            let (seed, own) = (record.seed, settings.own());
            writeln!(out, "    again: cargo run --release --bin sweep -- --seed {seed}{own}")?;
        }
        let seconds: f64 = records.iter().map(|r| r.seconds).sum();
        writeln!(
            out,
            "{} scenes: {} agree, {undecided} undecided (at most {:.0} may be), {wrong} alarms; {} of CPU time",
            records.len(),
            records.len() - wrong - undecided,
            (MOST_UNDECIDED * records.len() as f64).floor(),
            duration(seconds)
        )
    })?;
    Ok(match () {
        () if wrong > 0 => 1,
        () if undecided as f64 > MOST_UNDECIDED * records.len() as f64 => 3,
        () => 0,
    })
}
