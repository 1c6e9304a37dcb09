//! `turbid check`: what a scene requires.

use super::load::Source;
use super::shared::print;
use std::fmt::Write;

/// Say what a scene requires, and which path classes no sampler reaches.
#[derive(clap::Args)]
pub struct Check {
    #[command(flatten)]
    source: Source,
}

impl Check {
    /// Prints the plan.
    pub fn run(self) -> anyhow::Result<()> {
        let scene = self.source.load(&[])?;
        let mut text = String::new();
        writeln!(
            text,
            "{} regions, {} objects, {} lights, {} sensors",
            scene.regions().len(),
            scene.objects().len(),
            scene.named_lights().len(),
            scene.sensors().len()
        )?;
        for line in scene.plan().lines() {
            writeln!(text, "- {line}")?;
        }
        if scene.plan().unreachable.is_empty() {
            writeln!(text, "every path class can be sampled by paths and by photons")?;
        }
        for class in &scene.plan().unreachable {
            writeln!(text, "out of reach of the path tracer: {class}")?;
        }
        print(&text)
    }
}
