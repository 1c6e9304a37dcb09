//! Which options mean something with which method: what the chosen one would ignore is refused.

use anyhow::bail;
use clap::ArgMatches;
use clap::parser::ValueSource;

/// Options by their ids, and what they are for, as it is written on the command line: one of these must be asked for. An empty list
/// is for everything.
pub type Table = &'static [(&'static str, &'static [&'static str])];

const ALL: &[&str] = &[];
const PATHS: &[&str] = &["--with paths"];
const PHOTONS: &[&str] = &["--with photons"];
const UNBIASED: &[&str] = &["--with paths", "--with bidirectional"];
const SHOT: &[&str] = &["--with photons", "--with light"];
const WHOLE: &[&str] = &["--with photons", "--with paths", "--with bidirectional"];
const READ: &[&str] = &["--with photons", "--photons-from"];

/// Those of `measure`.
pub const MEASURE: Table = &[
    ("scene", ALL),
    ("sets", ALL),
    ("confined", ALL),
    ("with", ALL),
    ("weight_windows", PATHS),
    ("guide", PATHS),
    ("samples", UNBIASED),
    ("photons", SHOT),
    ("maps", PHOTONS),
    ("passes", PHOTONS),
    ("photons_from", READ),
    ("emitted", &["--photons-from"]),
    ("memory", ALL),
    ("k", READ),
    ("radius", READ),
    ("max_radius", READ),
    ("kernel", READ),
    ("ray_radius", READ),
    ("ray_k", READ),
    ("beam_radius", READ),
    ("beam_fluence", READ),
    ("beam_blur", READ),
    ("beam_length", READ),
    ("ray_ends", READ),
    ("planes", READ),
    ("progressive", READ),
    ("boundary", READ),
    ("reject", READ),
    ("orders", ALL),
    ("seed", ALL),
    ("threads", ALL),
    ("format", ALL),
    ("out", ALL),
    ("npy", ALL),
    ("vol", ALL),
];

const PROBES: &[&str] = &["--for probes"];
const OF_PICTURE: &[&str] = &["--for picture"];

/// Those of `advise`.
pub const ADVISE: Table = &[
    ("scene", ALL),
    ("sets", ALL),
    ("confined", ALL),
    ("for", ALL),
    ("target", ALL),
    ("pilot", PROBES),
    ("samples", PROBES),
    ("width", OF_PICTURE),
    ("height", OF_PICTURE),
    ("gather_rays", OF_PICTURE),
    ("seed", ALL),
    ("threads", ALL),
    ("memory", PROBES),
    ("format", ALL),
];

/// Those of `render`.
pub const RENDER: Table = &[
    ("scene", ALL),
    ("sets", ALL),
    ("confined", ALL),
    ("output", ALL),
    ("with", ALL),
    // Refused by `render` itself where it is full.
    ("plan", ALL),
    ("samples", ALL),
    ("seconds", ALL),
    ("maps", ALL),
    ("passes", PHOTONS),
    ("progressive", PHOTONS),
    ("state", PHOTONS),
    // Light tracing leaves out what paths hold.
    ("compare", WHOLE),
    ("compare_samples", WHOLE),
    ("guide", &["--with paths", "--compare"]),
    ("width", ALL),
    ("height", ALL),
    ("exposure", ALL),
    ("tone", ALL),
    ("seed", ALL),
    ("threads", ALL),
    ("memory", ALL),
    ("global", PHOTONS),
    ("caustic", PHOTONS),
    ("volume", PHOTONS),
    ("importance", PHOTONS),
    ("k", PHOTONS),
    ("caustic_k", PHOTONS),
    ("volume_k", PHOTONS),
    ("radius", PHOTONS),
    ("max_radius", PHOTONS),
    ("kernel", PHOTONS),
    ("caustic_kernel", PHOTONS),
    ("ray_radius", PHOTONS),
    ("ray_k", PHOTONS),
    ("beam_radius", PHOTONS),
    ("beam_blur", PHOTONS),
    ("beam_length", PHOTONS),
    ("ray_ends", PHOTONS),
    ("planes", PHOTONS),
    ("gather_rays", PHOTONS),
    ("near", PHOTONS),
    ("step", PHOTONS),
    ("step_rule", PHOTONS),
    ("adapt", PHOTONS),
    ("no_jitter", PHOTONS),
    ("spacing", PHOTONS),
    ("boundary", PHOTONS),
    ("edges", PHOTONS),
    ("reject", PHOTONS),
];

const PICTURE: &[&str] = &["--output"];
const SEEN: &[&str] = &["--output", "--importance"];
/// The photons of the global and the volume map are those of one pass, and the caustic map is made beside them.
const MAPS: &[&str] = &["--which all", "--which global", "--which caustic", "--which volume"];

/// Those of `map`.
pub const MAP: Table = &[
    ("scene", ALL),
    ("sets", ALL),
    ("confined", ALL),
    ("output", ALL),
    ("ply", ALL),
    ("npy", ALL),
    ("which", ALL),
    ("photons", &["--which medium"]),
    ("width", SEEN),
    ("height", SEEN),
    ("exposure", PICTURE),
    ("tone", PICTURE),
    ("global", MAPS),
    ("caustic", MAPS),
    ("volume", MAPS),
    ("importance", MAPS),
    ("memory", ALL),
    ("seed", ALL),
    ("threads", ALL),
];

/// Refuses an option that was given and is for nothing of what is asked for; the first of that is the method.
///
/// # Errors
/// One line that names the option, the method, and what it is for
pub fn check(given: &ArgMatches, table: Table, asked: &[&str]) -> anyhow::Result<()> {
    let is_given = |id: &str| given.value_source(id) == Some(ValueSource::CommandLine);
    let is_idle = |needs: &[&str]| !needs.is_empty() && !needs.iter().any(|need| asked.contains(need));
    let Some((id, needs)) = table.iter().find(|(id, needs)| is_idle(needs) && is_given(id)) else {
        return Ok(());
    };
    let option = name(id);
    let needs: Vec<&str> = needs.iter().copied().filter(|need| *need != option).collect();
    let method = asked.first().copied().unwrap_or_default();
    bail!("{option} says nothing to {method}; allowed: with {}", needs.join(" or "))
}

/// An option as it is written.
fn name(id: &str) -> String {
    format!("--{}", id.replace('_', "-"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Arguments;
    use clap::{Arg, Command, CommandFactory};
    use std::collections::BTreeSet;

    /// The commands with their tables, what can be asked for of each, joined by plus signs, and words that ask for it.
    type Asked = (&'static str, &'static [&'static str]);
    const COMMANDS: [(&str, Table, &[Asked]); 4] = [
        (
            "advise",
            ADVISE,
            &[
                ("--for probes", &["--target", "5%", "--for", "probes"]),
                ("--for picture", &["--target", "5%", "--for", "picture"]),
            ],
        ),
        (
            "measure",
            MEASURE,
            &[
                ("--with paths", &["--with", "paths"]),
                ("--with bidirectional", &["--with", "bidirectional"]),
                ("--with photons", &["--with", "photons"]),
                ("--with light", &["--with", "light"]),
                ("--photons-from", &["--with", "photons", "--photons-from", "a.npy"]),
            ],
        ),
        (
            "render",
            RENDER,
            &[
                ("--with paths", &["-o", "a.exr", "--with", "paths"]),
                ("--with bidirectional", &["-o", "a.exr", "--with", "bidirectional"]),
                ("--with photons", &["-o", "a.exr"]),
                ("--with light", &["-o", "a.exr", "--with", "light"]),
                ("--with photons + --compare", &["-o", "a.exr", "--compare", "paths"]),
            ],
        ),
        (
            "map",
            MAP,
            &[
                ("--which all", &["--ply", "a.ply"]),
                ("--which global", &["--ply", "a.ply", "--which", "global"]),
                ("--which caustic", &["--ply", "a.ply", "--which", "caustic"]),
                ("--which volume", &["--ply", "a.ply", "--which", "volume"]),
                ("--which medium", &["--npy", "a.npy", "--which", "medium"]),
            ],
        ),
    ];

    fn subcommand(name: &str) -> Command {
        Arguments::command().find_subcommand(name).unwrap().clone()
    }

    fn own_arguments(command: &Command) -> impl Iterator<Item = &Arg> {
        command.get_arguments().filter(|a| !a.is_global_set() && a.get_id() != "help")
    }

    /// Every option is in its table, and every row of a table is an option of that name: a new one cannot be forgotten.
    #[test]
    fn every_option_has_a_row() {
        for (name_of_command, table, _) in COMMANDS {
            let command = subcommand(name_of_command);
            let options: BTreeSet<&str> = own_arguments(&command).map(|a| a.get_id().as_str()).collect();
            let rows: BTreeSet<&str> = table.iter().map(|(id, _)| *id).collect();
            assert_eq!(options, rows, "{name_of_command}");
            assert_eq!(rows.len(), table.len(), "{name_of_command} has a row twice");
            for (id, needs) in table.iter().filter(|(_, needs)| !needs.is_empty()) {
                let long = own_arguments(&command).find(|a| a.get_id() == id).and_then(Arg::get_long);
                assert_eq!(format!("--{}", long.unwrap()), name(id));
                assert!(!needs.contains(&""));
            }
        }
    }

    /// Words that give an option some value that it takes.
    fn words(command: &Command, base: &[&str], option: &Arg) -> Vec<String> {
        let long = format!("--{}", option.get_long().unwrap());
        let all: Vec<String> =
            ["turbid", command.get_name(), "slab"].iter().chain(base).map(ToString::to_string).collect();
        if !option.get_action().takes_values() {
            return [all, vec![long]].concat();
        }
        let possible: Vec<String> =
            option.get_possible_values().iter().map(|value| value.get_name().to_string()).collect();
        let values = possible.into_iter().chain(["2", "0.5", "a.npy", "2G", "0..3"].map(String::from));
        let of = |value: String| [&all[..], &[format!("{long}={value}")]].concat();
        let is_taken = |words: &Vec<String>| {
            let parsed = Arguments::command().try_get_matches_from(words);
            let is_of_value = |kind| {
                matches!(kind, clap::error::ErrorKind::ValueValidation | clap::error::ErrorKind::InvalidValue)
            };
            !parsed.is_err_and(|error| is_of_value(error.kind()))
        };
        values.map(of).find(is_taken).unwrap()
    }

    /// Each option with each method: refused by name where the table says so, by default values never.
    #[test]
    fn what_a_method_ignores_is_refused() {
        let mut refused = 0;
        for (name_of_command, table, asked) in COMMANDS {
            let command = subcommand(name_of_command);
            for (asked, base) in asked {
                let asked: Vec<&str> = asked.split(" + ").collect();
                let method = asked[0];
                let bare: Vec<&str> =
                    ["turbid", name_of_command, "slab"].iter().chain(*base).copied().collect();
                let matches = Arguments::command().try_get_matches_from(&bare).unwrap();
                let (_, given) = matches.subcommand().unwrap();
                assert!(check(given, table, &asked).is_ok(), "{bare:?}");
                for option in own_arguments(&command).filter(|a| a.get_long().is_some()) {
                    let id = option.get_id().as_str();
                    let (_, needs) = table.iter().find(|(row, _)| *row == id).unwrap();
                    let words = words(&command, base, option);
                    // What conflicts with the words of the method itself, such as two values of one option.
                    let Ok(matches) = Arguments::command().try_get_matches_from(&words) else { continue };
                    let (_, given) = matches.subcommand().unwrap();
                    let told = check(given, table, &asked).map_err(|error| error.to_string());
                    if needs.is_empty() || asked.iter().any(|asked| needs.contains(asked)) {
                        assert_eq!(told, Ok(()), "{words:?}");
                    } else {
                        let told = told.unwrap_err();
                        assert!(
                            told.starts_with(&format!(
                                "{} says nothing to {method}; allowed: with --",
                                name(id)
                            )),
                            "{told}"
                        );
                        refused += 1;
                    }
                }
            }
        }
        assert!(refused > 60, "{refused}");
    }
}
