//! Trying one input: what is asked of it, and whether it was answered.

use super::input::Input;
use super::kind::Kind;
use super::seeds;
use crate::harness::{read_cell, try_redraw};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};
use turbid::estimators::boundary::Treatment;
use turbid::estimators::{Estimator, Gather, Kernel};
use turbid::integrators::mapper;
use turbid::output::one_line;
use turbid::photons::check_end;
use turbid::photons::importance::{Importance, ImportanceSettings};
use turbid::photons::maps::{Amount, Indirect, MapSettings, MediumSamples, fill_by_importance};
use turbid::scene::{Camera, Orders, Scene, SceneFile};
use turbid::sensor::{
    Film, Method, PathSettings, PhotonSettings, Streams, by_light, by_paths, by_photons, check_camera,
};
use turbid::transport::NoProgress;

/// What became of an input.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// It did what it says.
    Accepted,
    /// It was refused, in one line.
    Refused(String),
    /// Neither: what happened.
    Failed(String),
}

impl Verdict {
    /// Whether it failed.
    pub fn is_failure(&self) -> bool {
        matches!(self, Verdict::Failed(_))
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Accepted => write!(f, "accepted"),
            Verdict::Refused(why) => write!(f, "refused: {}", one_line(why)),
            Verdict::Failed(what) => write!(f, "failed: {}", one_line(what)),
        }
    }
}

/// What the last panic said.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Keeps what a panic says, and prints nothing.
pub fn keep_panics() {
    std::panic::set_hook(Box::new(|info| {
        let text = info.payload_as_str().unwrap_or("no text");
        let place = info.location().map(|l| format!("{}:{}", l.file(), l.line())).unwrap_or_default();
        if let Ok(mut last) = PANIC.lock() {
            *last = format!("{place}: {text}");
        }
    }));
}

/// How much a scene is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Thoroughness {
    /// One of the uses of photons, which take longest: by its length one scene is asked for this and another for that.
    ByTurns,
    /// All.
    All,
}

/// A folder with the files that scenes name, where inputs are tried.
pub struct Workbench {
    folder: tempfile::TempDir,
    program: Option<PathBuf>,
    thoroughness: Thoroughness,
}

/// What a refusal of an input must not be.
fn checked(message: String, file: Option<&str>) -> Verdict {
    if message.contains('\n') {
        Verdict::Failed(format!("a message of several lines: {message}"))
    } else if message.chars().any(char::is_control) {
        Verdict::Failed(format!("a message with signs that a terminal obeys: {message}"))
    } else if file
        .is_some_and(|file| !["regions[0]", "objects[0]", file].iter().any(|name| message.contains(name)))
    {
        Verdict::Failed(format!("a message without its file: {message}"))
    } else if message.is_empty() {
        Verdict::Failed("an empty message".to_string())
    } else {
        Verdict::Refused(message)
    }
}

/// The same of what the library or the laboratory says, as it is before a program makes one line of it: line feeds and
/// control characters are not its own, but at most those of the input, which it may quote.
fn said(message: &str, quotable: &str, file: Option<&str>) -> Verdict {
    match message.chars().find(|c| c.is_control() && !quotable.contains(*c)) {
        Some(c) => Verdict::Failed(format!("a message with {c:?} of its own: {message}")),
        None => checked(one_line(message), file),
    }
}

/// What a message may quote of a file: its text, of which readers take a line at a time.
fn quotable(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).replace('\n', "")
}

/// What the escapes of JSON in a text stand for: keys are quoted as they are read.
fn escapes(text: &str) -> String {
    text.split('\\')
        .skip(1)
        .filter_map(|after| match after.chars().next()? {
            'b' => Some('\u{8}'),
            'f' => Some('\u{c}'),
            'n' => Some('\n'),
            'r' => Some('\r'),
            't' => Some('\t'),
            'u' => char::from_u32(u32::from_str_radix(after.get(1..5)?, 16).ok()?),
            _ => None,
        })
        .collect()
}

/// The same of a scene: the keys and strings that are written in it.
fn strings(text: &str) -> String {
    fn add(value: &toml::Value, all: &mut String) {
        match value {
            toml::Value::String(text) => all.push_str(text),
            toml::Value::Table(table) => table.iter().for_each(|(key, inner)| {
                all.push_str(key);
                add(inner, all);
            }),
            toml::Value::Array(list) => list.iter().for_each(|inner| add(inner, all)),
            _ => {}
        }
    }
    let mut all = String::new();
    if let Ok(table) = toml::from_str(text) {
        add(&toml::Value::Table(table), &mut all);
    }
    all
}

/// The program `turbid` beside this one, or beside the folder that this one is in.
pub fn program() -> Option<PathBuf> {
    let own = std::env::current_exe().ok()?;
    let name = format!("turbid{}", std::env::consts::EXE_SUFFIX);
    own.ancestors().skip(1).take(2).map(|folder| folder.join(&name)).find(|path| path.is_file())
}

/// What a scene is made of: one of them is in every message about it.
const PARTS: [&str; 8] = ["object", "region", "light", "interior", "camera", "sensor", "cell", "a sun needs"];

const SEED: u64 = 7;

impl Workbench {
    /// A new folder with the files that seeds name.
    ///
    /// # Errors
    /// If files cannot be written.
    pub fn new(thoroughness: Thoroughness) -> std::io::Result<Self> {
        let folder = tempfile::tempdir()?;
        for (name, bytes) in seeds::files() {
            std::fs::write(folder.path().join(name), bytes)?;
        }
        copy(&seeds::gallery(), folder.path())?;
        std::fs::write(folder.path().join("drawn.toml"), DRAWN)?;
        Ok(Workbench { folder, program: program(), thoroughness })
    }

    /// Tries one input.
    pub fn judge(&self, input: &Input) -> Verdict {
        match catch_unwind(AssertUnwindSafe(|| self.try_one(input))) {
            Ok(verdict) => verdict,
            Err(_) => {
                let what = PANIC.lock().map(|last| last.clone()).unwrap_or_default();
                Verdict::Failed(format!("panic at {what}"))
            }
        }
    }

    fn try_one(&self, Input { kind, bytes }: &Input) -> Verdict {
        let name = format!("input.{}", kind.ending());
        let path = self.folder.path().join(&name);
        if *kind != Kind::Arguments
            && let Err(error) = std::fs::write(&path, bytes)
        {
            return Verdict::Failed(format!("cannot write {}: {error}", path.display()));
        }
        let medium = "density = { grid = { file = \"input.vol\" } }\ng = 0.3";
        let table = "phase = { table = { file = \"input.txt\" } }";
        let fog = |keys: &str| {
            format!(
                "[[regions]]\nshape = {{ cuboid = {{ min = [-1, -1, -1], max = [1, 1, 1] }} }}\nsigma_t = 2\nalbedo = 0.8\n{keys}\n{LIT}"
            )
        };
        let object = |shape: &str, surface: &str| {
            format!(
                "[[objects]]\nshape = {{ {shape} }}\nsurface = {{ lambertian = {{ reflectance = {surface} }} }}\n{LIT}"
            )
        };
        match kind {
            Kind::Scenes => self.scene(bytes),
            Kind::Vol => self.scene_of(&fog(medium), &quotable(bytes), Some(&name)),
            Kind::Tables => self.scene_of(&fog(table), &quotable(bytes), Some(&name)),
            Kind::Png => {
                let square = "rectangle = { corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0] }";
                let scene = object(square, "{ image = { file = \"input.png\" } }");
                self.scene_of(&scene, &quotable(bytes), Some(&name))
            }
            Kind::Obj => {
                let scene = object("mesh = { file = \"input.obj\" }", "0.5");
                self.scene_of(&scene, &quotable(bytes), Some(&name))
            }
            Kind::Cells => match read_cell(&path) {
                Ok(_) => Verdict::Accepted,
                Err(error) => {
                    let text = quotable(bytes);
                    said(&format!("{error:#}"), &(escapes(&text) + &text), Some(&name))
                }
            },
            Kind::Figures => match try_redraw(&path) {
                Ok(_) => Verdict::Accepted,
                Err(error) => said(&format!("{error:#}"), &quotable(bytes), Some(&name)),
            },
            Kind::Arguments => self.command(bytes, None),
        }
    }

    /// A scene file, as it is read by the library; one in ten by the program too, which says where it is wrong.
    fn scene(&self, bytes: &[u8]) -> Verdict {
        if bytes.len() % 10 == 7
            && let refused @ Verdict::Failed(_) = self.command(b"check\ninput.toml", Some("input.toml"))
        {
            return refused;
        }
        let Ok(text) = std::str::from_utf8(bytes) else { return Verdict::Refused("not UTF-8".to_string()) };
        self.scene_of(text, &strings(text), None)
    }

    /// A scene, and all that can be asked of it; what its file is refused for names `file`, and may quote something.
    fn scene_of(&self, text: &str, quotable: &str, file: Option<&str>) -> Verdict {
        let parsed = match SceneFile::from_toml(text) {
            Ok(parsed) => parsed,
            // The program makes one line of these.
            Err(error) => return checked(one_line(error.message()), None),
        };
        let scene = match parsed.scene(self.folder.path()) {
            Ok(scene) => scene,
            Err(error) => {
                let message = error.to_string();
                // The program names the file; where in it is for the library to say.
                return if file.is_some() || PARTS.iter().any(|part| message.contains(part)) {
                    said(&message, quotable, file)
                } else {
                    Verdict::Failed(format!("a message without a part of the scene: {message}"))
                };
            }
        };
        if let Err(error) = check_end(&scene) {
            return said(&error.to_string(), quotable, None);
        }
        let camera = scene.camera().and_then(|camera| camera.with_size(4, 4).ok());
        let camera = camera.filter(|camera| check_camera(&scene, camera).is_ok());
        let mut notes = Vec::new();
        let mut note = |of: &str, outcome: turbid::Result<()>| {
            if let Err(error) = outcome {
                notes.push((of.to_string(), error));
            }
        };
        let asks = |use_of_photons: usize| {
            self.thoroughness == Thoroughness::All || text.len() % 3 == use_of_photons
        };
        if let Some(camera) = &camera {
            note("paths", paths(&scene, camera));
            note("light", light(&scene, camera));
            if asks(0) {
                note("photons", photons(&scene, camera, Indirect::Seen, false));
            }
            if asks(1) {
                note("photons by importance", photons(&scene, camera, Indirect::Gathered, true));
            }
        }
        if !scene.sensors().is_empty() {
            let settings = PathSettings { samples: 10, seed: SEED, replicate: 0, orders: Orders::ALL };
            note("measured by paths", by_paths(&scene, &settings, &NoProgress).map(|_| ()));
            if asks(2) || camera.is_none() {
                note("measured by photons", measured(&scene));
            }
        }
        for (of, error) in notes {
            if let turbid::Error::NonFinite { .. } = error {
                return Verdict::Failed(format!("{of}: {error}"));
            }
            if let failed @ Verdict::Failed(_) = said(&error.to_string(), quotable, None) {
                return failed;
            }
        }
        Verdict::Accepted
    }

    /// A command line of the program; what it is refused for names `file`.
    fn command(&self, bytes: &[u8], file: Option<&str>) -> Verdict {
        let Some(program) = &self.program else {
            return Verdict::Refused("the program turbid is not there".to_string());
        };
        let text = String::from_utf8_lossy(bytes).replace('\0', "");
        let child = Command::new(program)
            .args(text.split('\n'))
            .current_dir(self.folder.path())
            .env("RAYON_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn();
        let mut child = match child {
            Ok(child) => child,
            Err(error) => return Verdict::Refused(error.to_string()),
        };
        let start = Instant::now();
        let status = loop {
            match child.try_wait() {
                Ok(Some(status)) => break status,
                Ok(None) if start.elapsed() < PATIENCE => std::thread::sleep(Duration::from_millis(2)),
                _ => {
                    let _ended = child.kill().and_then(|()| child.wait());
                    return Verdict::Failed(format!("the program had not ended after {PATIENCE:?}"));
                }
            }
        };
        let mut said = String::new();
        if let Some(mut pipe) = child.stderr.take() {
            let _unheard = std::io::Read::read_to_string(&mut pipe, &mut said);
        }
        match status.code() {
            Some(0) => match said.lines().find(|line| !line.starts_with("turbid: note: ")) {
                Some(line) => Verdict::Failed(format!("no error, but: {line}")),
                None => Verdict::Accepted,
            },
            Some(2) => {
                let line = said.strip_suffix('\n').unwrap_or(&said);
                match line.strip_prefix("turbid: error: ") {
                    Some(message) => checked(message.to_string(), file),
                    None => Verdict::Failed(format!("an error that is none of turbid's: {line}")),
                }
            }
            code => Verdict::Failed(format!("exit code {code:?}: {said}")),
        }
    }
}

/// How long a command line may take by the clock, on a machine that has other work to do.
const PATIENCE: Duration = Duration::from_secs(60);

/// Light and an eye for the scenes that files are tried in.
const LIT: &str = "[[lights]]\npoint = { position = [0.2, 3, 2], power = 10 }\n[camera]\nposition = [0, 0.5, 4]\n\
                   look_at = [0, 0, 0]\nfov = 50\nwidth = 8\nheight = 8\n\
                   [[sensors]]\nname = \"s\"\nmeasure = { fluence = { at = [0.1, 0.2, 0.3] } }\n";

/// A scene that command lines name.
const DRAWN: &str = "[[objects]]\nshape = { sphere = { center = [0, 0, 0], radius = 1 } }\n\
                     surface = { lambertian = { reflectance = 0.5 } }\n[[regions]]\n\
                     shape = { cuboid = { min = [-2, -2, -2], max = [2, 2, 2] } }\nsigma_t = 0.5\nalbedo = 0.8\ng = 0\n\
                     [[lights]]\npoint = { position = [0.2, 3, 2], power = 10 }\n[camera]\nposition = [0, 0.5, 4]\n\
                     look_at = [0, 0, 0]\nfov = 50\nwidth = 8\nheight = 8\n\
                     [[sensors]]\nname = \"s\"\nmeasure = { fluence = { at = [0, 0, 1.5] } }\n";

/// Copies the files of a folder and its folders.
fn copy(from: &Path, to: &Path) -> std::io::Result<()> {
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            std::fs::create_dir_all(&target)?;
            copy(&entry.path(), &target)?;
        } else {
            std::fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}

const STREAMS: Streams = Streams { seed: SEED, replicate: 0 };

/// Whether every number of a film is finite.
fn finite(film: &Film, place: &'static str) -> turbid::Result<()> {
    let is_bad = |p: &&turbid::sensor::Pixel| {
        !p.total().is_finite() || p.variance().is_some_and(|variance| !variance.is_finite())
    };
    match film.pixels().iter().filter(is_bad).count() as u64 {
        0 => Ok(()),
        count => Err(turbid::Error::NonFinite { count, place }),
    }
}

fn paths(scene: &Scene, camera: &Camera) -> turbid::Result<()> {
    let film = Method::Paths(scene).render(camera, 2, STREAMS, &NoProgress)?;
    finite(&film, "the film of paths")
}

fn light(scene: &Scene, camera: &Camera) -> turbid::Result<()> {
    finite(&by_light(scene, camera, 16, 3, STREAMS, &NoProgress)?, "the film of light tracing")
}

fn photons(scene: &Scene, camera: &Camera, indirect: Indirect, is_by_importance: bool) -> turbid::Result<()> {
    let amount = Amount::Emitted(100);
    let maps = MapSettings {
        global: amount,
        caustic: amount,
        volume: amount,
        media: MediumSamples::Points,
        indirect,
        seed: SEED,
        replicate: 0,
    };
    let learned =
        ImportanceSettings { particles: 64, pilot: 32, rounds: 2, boxes: 4, seed: SEED, replicate: 0 };
    // Only a part of the scenes can be rendered so; importance says why not.
    let importance = if is_by_importance {
        Some(Importance::of(scene, camera, indirect, &learned, &NoProgress)?)
    } else {
        None
    };
    let maps = fill_by_importance(scene, &maps, importance.as_ref(), &NoProgress)?;
    let settings = mapper::Settings { gather_rays: 2, ..mapper::Settings::for_scene(scene, 20)? };
    let photons = Method::Photons(mapper::Mapper::new(scene, &maps, &settings));
    let film = photons.render(camera, 1, STREAMS, &NoProgress)?;
    finite(&film, "the film of photons")
}

fn measured(scene: &Scene) -> turbid::Result<()> {
    let densest = scene.regions().iter().map(|r| r.medium.highest_sigma_t().max()).fold(0.0, f64::max);
    let cap = match scene.periodic_cell() {
        Some(periodic_cell) => 0.5 * periodic_cell.side.min_element(),
        None if densest > 0.0 => 1.0 / densest,
        None => 1.0,
    };
    let settings = PhotonSettings {
        photons: 100,
        maps: 2,
        seed: SEED,
        orders: Orders::ALL,
        estimator: Estimator::new(Kernel::Uniform, Gather::nearest(10, cap)?).treated(Treatment::Clipped),
    };
    by_photons(scene, &settings, &NoProgress).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a message must not be is found in what the library says and in what the program prints.
    #[test]
    fn messages_are_looked_at_as_they_are() {
        let failed = |verdict: Verdict| verdict.is_failure();
        assert!(failed(said("two\nlines", "", None)) && failed(said("red \u{1b}[31m", "x", None)));
        let key = r#"{"non\finite\u000b":0}"#;
        assert!(failed(said("a key 'non\u{c}inite'", &quotable(key.as_bytes()), None)));
        assert!(!failed(said("a key 'non\u{c}inite\u{b}'", &escapes(key), None)));
        assert!(failed(said("a key\twith a tab", &escapes(key), None)));
        assert!(failed(said("", "", None)) && failed(said("no file", "", Some("input.vol"))));
        assert_eq!(
            said("interior \u{1b}x", "a\u{1b}x", None),
            Verdict::Refused("interior \\u{1b}x".to_string())
        );
        assert!(
            failed(checked("two\nlines".to_string(), None)) && failed(checked("\u{7}".to_string(), None))
        );
        assert!(!failed(checked("input.toml: no light".to_string(), Some("input.toml"))));
        assert!(failed(checked("no light".to_string(), Some("input.toml"))));
        // Line feeds of a file stand between its lines; those of a scene may be in a name.
        assert!(failed(said("two\nlines", &quotable(b"v 1\nf 2\n"), None)));
        assert_eq!(strings("a = [1, { name = \"x\\ny\" }]\n\"k\\u001b\" = 2\n"), "anamex\nyk\u{1b}");
    }
}
