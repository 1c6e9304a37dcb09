//! `turbid scenes`: the built-in ones.

use super::load::Source;
use super::shared::print;
use turbid::scene::BUILTIN;

/// List the built-in scenes, or print one.
#[derive(clap::Args)]
pub struct Scenes {
    /// Print the parameters of this built-in scene.
    name: Option<String>,
    /// Print the whole scene file that results, instead of the parameters.
    #[arg(long, requires = "name")]
    resolved: bool,
    /// Change a value before the file is printed, as everywhere: `albedo=0.5`.
    #[arg(long = "set", value_name = "KEY=VALUE", requires = "resolved")]
    sets: Vec<String>,
}

impl Scenes {
    /// Prints the list, the parameters or the file.
    pub fn run(self) -> anyhow::Result<()> {
        let Some(name) = self.name else {
            let lines: String = BUILTIN.iter().map(|b| format!("{:8} {}\n", b.name, b.about)).collect();
            return print(&format!("{lines}\n`turbid scenes NAME` prints the parameters of one.\n"));
        };
        match BUILTIN.iter().find(|b| b.name == name) {
            Some(builtin) if !self.resolved => {
                print(&format!("# {}: {}\n{}", builtin.name, builtin.about, builtin.defaults))
            }
            _ => print(&Source::with_sets(&name, self.sets).resolve()?.to_toml()?),
        }
    }
}
