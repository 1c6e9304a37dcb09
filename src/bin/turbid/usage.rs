//! What is wrong with a command line, in one line.

use super::shared::print;
use clap::error::ErrorKind;

/// Help and version go to stdout; a command line that cannot be understood becomes an error of one line.
///
/// # Errors
/// What is wrong and what is allowed; or that stdout cannot be written to.
pub fn explain(error: &clap::Error) -> anyhow::Result<()> {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => print(&error.render().to_string()),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            anyhow::bail!("no command given; allowed: {}; more with --help", commands())
        }
        ErrorKind::InvalidSubcommand => {
            anyhow::bail!("{}; allowed: {}", one_line(&error.render().to_string()), commands())
        }
        _ => anyhow::bail!("{}", one_line(&error.render().to_string())),
    }
}

/// The names of all commands.
fn commands() -> String {
    let all = clap::Command::new("turbid");
    let all = <crate::command::Command as clap::Subcommand>::augment_subcommands(all);
    all.get_subcommands().map(clap::Command::get_name).collect::<Vec<_>>().join(", ")
}

/// The parts of a message of several lines, without usage and hints where to look.
fn one_line(text: &str) -> String {
    let mut line = String::new();
    for part in text.lines().map(str::trim).filter(|part| !part.is_empty()) {
        if part.starts_with("Usage:") || part.starts_with("For more information") {
            break;
        }
        let part = part.strip_prefix("error: ").unwrap_or(part);
        let part = part
            .strip_prefix("[possible values: ")
            .map_or(part.to_string(), |values| format!("allowed: {}", values.trim_end_matches(']')));
        if !line.is_empty() {
            line.push_str(if line.ends_with(':') { " " } else { "; " });
        }
        line.push_str(&part);
    }
    line
}

#[cfg(test)]
mod tests {
    use super::one_line;

    #[test]
    fn several_lines_become_one() {
        let text = "error: invalid value 'x' for '--format <FORMAT>'\n  [possible values: table, csv]\n\nFor more information, try '--help'.\n";
        assert_eq!(one_line(text), "invalid value 'x' for '--format <FORMAT>'; allowed: table, csv");
        let text =
            "error: the following required arguments were not provided:\n  --with <WITH>\n\nUsage: turbid\n";
        assert_eq!(one_line(text), "the following required arguments were not provided: --with <WITH>");
    }
}
