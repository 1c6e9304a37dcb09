//! The problems and their arguments, as the command line declares them.

use crate::command::Command;
use clap::{ArgAction, Subcommand};

/// A problem that can be asked about: a command.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Its name, `_` between words.
    pub name: String,
    /// Its help: equation, units, ranges, sources.
    pub about: String,
    /// What it takes.
    pub arguments: Vec<Argument>,
}

/// An argument of a problem: an option of a command.
#[derive(Debug, Clone)]
pub struct Argument {
    /// Its name, `_` between words.
    pub name: String,
    /// Its help: meaning, unit, range.
    pub help: String,
    /// How many values it takes.
    pub takes: Takes,
    /// Whether there is no answer without it.
    pub is_required: bool,
    /// What stands for it where it is not given; empty for nothing.
    pub default: Vec<String>,
    /// All words that it may be, if they are few.
    pub allowed: Vec<String>,
}

/// How many values an argument takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Takes {
    /// None: it is given or not.
    Nothing,
    /// One.
    One,
    /// Numbers that belong together, as the sides of a body.
    Vector,
    /// A list of places or counts, each of which has values of its own.
    List,
    /// Whole descriptions, one by one: places, layers, cuboids.
    Descriptions,
}

/// What figures alone ask for.
const OF_FIGURES: [&str; 1] = ["draw"];

/// Every problem, in the order of the command line.
pub fn problems() -> Vec<Problem> {
    let parser = Command::augment_subcommands(clap::Command::new("exact"));
    parser.get_subcommands().map(problem).collect()
}

fn problem(command: &clap::Command) -> Problem {
    let about = command.get_long_about().or(command.get_about()).map(|text| text.to_string());
    let is_asked = |arg: &&clap::Arg| !arg.is_hide_set() && !OF_FIGURES.contains(&arg.get_id().as_str());
    Problem {
        name: command.get_name().replace('-', "_"),
        about: about.unwrap_or_default(),
        arguments: command.get_arguments().filter(is_asked).map(argument).collect(),
    }
}

fn argument(arg: &clap::Arg) -> Argument {
    let help = arg.get_long_help().or(arg.get_help()).map(|text| text.to_string());
    let takes = arg.get_num_args().map_or(1, |range| range.max_values());
    let takes = match arg.get_action() {
        ArgAction::SetTrue => Takes::Nothing,
        _ if takes == usize::MAX && !arg.is_required_set() => Takes::List,
        _ if takes > 1 => Takes::Vector,
        ArgAction::Append => Takes::Descriptions,
        _ => Takes::One,
    };
    let words = |word: &clap::builder::OsStr| word.to_string_lossy().into_owned();
    let is_switch = takes == Takes::Nothing;
    let allowed = arg.get_possible_values().iter().map(|value| value.get_name().to_string()).collect();
    Argument {
        name: arg.get_id().as_str().replace('-', "_"),
        help: help.unwrap_or_default(),
        takes,
        is_required: arg.is_required_set(),
        default: if is_switch { Vec::new() } else { arg.get_default_values().iter().map(words).collect() },
        allowed: if is_switch { Vec::new() } else { allowed },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asker::Asker;

    /// One question of each problem, by its required arguments and defaults; a new problem is named here.
    #[test]
    fn every_problem_is_asked_by_name() {
        let given = |problem: &str, argument: &str| match (problem, argument) {
            ("critical", "secondaries") => "1.5",
            ("nearest", "k") => "10",
            ("kernel", "kernel") => "uniform",
            ("path", "shape") => "sphere",
            ("path", "size") => "1",
            ("cuboid", "sides") => "1,1,1",
            ("nested", "source") => "x=0:1,y=0:1,z=0:1",
            ("emitting_cube" | "nested", "at") => "0.5,0.5,1",
            ("layers", "layer") => "tau=1,albedo=0.5",
            (_, "tau" | "radius") => "1",
            (_, "albedo" | "wall_albedo") => "0.5",
            other => panic!("{other:?} is required: say here what to ask with"),
        };
        let problems = problems();
        for problem in &problems {
            assert!(problem.about.contains("Source: "), "{}", problem.name);
            let required = problem.arguments.iter().filter(|argument| argument.is_required);
            let arguments: Vec<_> =
                required.map(|a| (a.name.clone(), Some(given(&problem.name, &a.name).to_string()))).collect();
            let answer = Asker::default().ask(&problem.name, &arguments).unwrap();
            assert_eq!(answer.problem.replace('-', "_"), problem.name);
            assert!(!answer.rows.is_empty(), "{}", problem.name);
        }
        assert!(problems.len() >= 19);
    }

    #[test]
    fn arguments_say_what_they_take() {
        let all = problems();
        let of = |problem: &str, name: &str| {
            let problem = all.iter().find(|p| p.name == problem).unwrap();
            problem.arguments.iter().find(|argument| argument.name == name).unwrap().clone()
        };
        let takes = |problem: &str, name: &str| of(problem, name).takes;
        assert_eq!(takes("slab", "tau"), Takes::One);
        assert_eq!(takes("slab", "depth"), Takes::List);
        assert_eq!(takes("slab", "rayleigh"), Takes::Nothing);
        assert_eq!(takes("thick", "tau"), Takes::List);
        assert_eq!([takes("cuboid", "sides"), takes("path", "size")], [Takes::Vector; 2]);
        assert_eq!([takes("layers", "layer"), takes("nested", "at")], [Takes::Descriptions; 2]);
        assert_eq!(of("slab", "mu0").default, ["1"]);
        assert_eq!(of("progressive", "passes").default, ["10", "100", "1000"]);
        assert_eq!(of("sphere", "source").allowed, ["uniform", "centre", "incident"]);
        assert!(of("slab", "albedo").is_required && !of("slab", "g").is_required);
        assert!(all.iter().flat_map(|p| &p.arguments).all(|a| !a.help.is_empty() && a.name != "draw"));
    }

    #[test]
    fn mistakes_go_by_the_name_of_the_argument() {
        let ask = |problem: &str, arguments: &[(&str, &str)]| {
            let arguments = arguments.iter().map(|(name, value)| (name.to_string(), Some(value.to_string())));
            Asker::default().ask(problem, &arguments.collect::<Vec<_>>()).unwrap_err().to_string()
        };
        let slab = |name, value| ask("slab", &[("tau", "1"), ("albedo", "0.5"), (name, value)]);
        assert_eq!(slab("mu0", "up"), "mu0 is 'up'; allowed: a number above 0 to 1, or diffuse");
        assert_eq!(slab("depth", "x"), "depth is 'x'; allowed: a number");
        assert_eq!(slab("order", "0.5"), "order is '0.5'; allowed: a whole number");
        assert_eq!(slab("tau", "2"), "the argument '--tau <TAU>' cannot be used multiple times");
        assert_eq!(ask("slab", &[("tau", "1"), ("albedo", "1.5")]), "albedo is 1.5; allowed: 0 to 1");
        assert!(ask("cylinder", &[]).contains("cylinder"));
        assert!(slab("colour", "red").contains("--colour"));
    }
}
