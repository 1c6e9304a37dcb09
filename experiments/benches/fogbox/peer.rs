//! A Python that renders with Mitsuba, asked line by line.

use crate::{Round, WIDTH};
use anyhow::{Context, Result, bail};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The peer's process.
pub struct Peer {
    process: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Peer {
    /// Starts a variant of Mitsuba on the scenes of a folder; fails where it cannot render the one of this name.
    pub fn start(variant: &str, folder: &Path, scene: &str) -> Result<Self> {
        let python = std::env::var("TURBID_PYTHON").unwrap_or_else(|_| "python3".into());
        let known = Command::new(&python)
            .args(["-c", "import mitsuba, numpy"])
            .stderr(Stdio::null())
            .status()
            .with_context(|| format!("{python} does not run"))?;
        if !known.success() {
            bail!("{python} has no modules mitsuba and numpy");
        }
        let mut process = Command::new(&python)
            .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/fogbox/peer.py"))
            .arg(variant)
            .arg(folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .with_context(|| format!("{python} does not run"))?;
        let questions = process.stdin.take().context("no way to ask")?;
        let answers = BufReader::new(process.stdout.take().context("no way to listen")?);
        let mut peer = Peer { process, questions, answers };
        peer.render(scene, 1, 0).context("it does not render")?;
        Ok(peer)
    }

    /// One picture.
    pub fn render(&mut self, scene: &str, samples: u64, seed: u64) -> Result<Round> {
        writeln!(self.questions, "{scene} {samples} {seed}")?;
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        let seconds = line.trim().parse().with_context(|| format!("the peer said {line:?}"))?;
        let mut bytes = vec![0; WIDTH * WIDTH * 3 * 4];
        self.answers.read_exact(&mut bytes)?;
        let pixels = bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])));
        Ok(Round { pixels: pixels.collect(), seconds })
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // Nothing is left to do for a process that has gone already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
