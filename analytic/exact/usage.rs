//! What the parser of the command line says, in one line with what is allowed.

use crate::command::Cli;
use crate::output;
use anyhow::{Result, bail};
use clap::CommandFactory;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::error::Error;
use std::num::ParseFloatError;

/// What can be asked.
pub fn allowed() -> String {
    let names = Cli::command().get_subcommands().map(|c| c.get_name().to_string()).collect::<Vec<_>>();
    format!("--cases FILE.csv, {}", names.join(", "))
}

/// Help and version go to stdout; a command line that cannot be understood becomes an error of one line.
pub fn explain(error: &clap::Error) -> Result<()> {
    let text = error.render().to_string();
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => output::print(text.as_bytes()),
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            bail!("nothing asked; allowed: {}; more with --help", allowed())
        }
        _ => bail!("{}", condensed(&text)),
    }
}

/// What is allowed of counts.
const WHOLE: &str = "a whole number, 0 to 4294967295";

/// A message of std's number parsing, with what is allowed in its place.
fn allowed_numbers(part: &str) -> String {
    if let Some((rest, _)) = part.split_once(" is not in 0..=").and_then(|(front, _)| front.rsplit_once(": "))
    {
        return format!("{rest}; allowed: {WHOLE}");
    }
    let number = [": invalid float literal", ": cannot parse float from empty string"];
    let whole = [
        ": invalid digit found in string",
        ": cannot parse integer from empty string",
        ": number too large to fit in target type",
    ];
    for (endings, allowed) in [(number.as_slice(), "a number"), (&whole, WHOLE)] {
        if let Some(rest) = endings.iter().find_map(|ending| part.strip_suffix(ending)) {
            return format!("{rest}; allowed: {allowed}");
        }
    }
    part.to_string()
}

/// The parts of a message of several lines, without usage and hints where to look.
fn condensed(text: &str) -> String {
    let mut line = String::new();
    for part in text.lines().map(str::trim).filter(|part| !part.is_empty()) {
        if part.starts_with("Usage:") || part.starts_with("For more information") {
            break;
        }
        let part = &allowed_numbers(part.strip_prefix("error: ").unwrap_or(part));
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

/// The same of a cell that became an option, under the name of its column.
pub fn of_cell(
    error: &clap::Error,
    column: impl Fn(&str) -> Option<String>,
    counts: impl Fn(&str) -> &'static str,
) -> String {
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        Some(ContextValue::Strings(all)) => all.first().map(String::as_str),
        _ => None,
    };
    let option =
        text(ContextKind::InvalidArg).and_then(|name| name.strip_prefix("--")?.split([' ', '=']).next());
    let Some(column) = option.and_then(column) else { return condensed(&error.render().to_string()) };
    let value = text(ContextKind::InvalidValue).unwrap_or_default();
    match error.source() {
        // What we read ourselves says what is allowed.
        Some(cause) if cause.to_string().contains("; allowed: ") => cause.to_string(),
        Some(cause) if !cause.is::<ParseFloatError>() => {
            format!("{column} is '{value}'; allowed: {}", counts(&column))
        }
        _ => format!("{column} is '{value}'; allowed: a number"),
    }
}
