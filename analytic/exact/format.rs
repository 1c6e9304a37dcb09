//! An answer as a table for eyes, as CSV or as JSON.

use crate::answer::{Answer, Row, shortest};
use crate::text::one_line;
use anyhow::Result;
use clap::ValueEnum;
use std::io::Write;
use turbid_analytic::Value;

/// The form of the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Aligned columns, digits as far as they are certain.
    Table,
    /// Comma-separated, one row a value, every bit of it.
    Csv,
    /// One object, every bit of its numbers.
    Json,
}

/// Writes an answer.
pub fn write(answer: &Answer, format: Format, out: &mut Vec<u8>) -> Result<()> {
    match format {
        Format::Table => table(answer, out),
        Format::Csv => csv(answer, out),
        Format::Json => {
            serde_json::to_writer_pretty(&mut *out, answer)?;
            out.push(b'\n');
            Ok(())
        }
    }
}

fn table(answer: &Answer, out: &mut Vec<u8>) -> Result<()> {
    let parameters: Vec<String> =
        answer.parameters.iter().map(|(name, f)| one_line(&format!("{name} = {f}"))).collect();
    writeln!(
        out,
        "{}{}{}",
        answer.problem,
        if parameters.is_empty() { "" } else { ": " },
        parameters.join(", ")
    )?;
    let coordinates = answer.coordinates();
    let mut head = vec!["quantity"];
    head.extend(&coordinates);
    head.extend(["value", "error", "unit", "how known"]);
    let line = |row: &Row| {
        let mut cells = vec![row.quantity.to_string()];
        cells.extend(coordinates.iter().map(|name| row.place(name)));
        let (value, error) = printed(row.value);
        cells.extend([value, error, row.unit.to_string(), row.value.method.to_string()]);
        cells
    };
    aligned(&head, &answer.rows.iter().map(line).collect::<Vec<_>>(), out)
}

/// Writes cells in columns under a head; see [`one_line`].
pub fn aligned(head: &[&str], lines: &[Vec<String>], out: &mut Vec<u8>) -> Result<()> {
    let lines: Vec<Vec<String>> =
        lines.iter().map(|line| line.iter().map(|cell| one_line(cell)).collect()).collect();
    let length = |cell: &str| cell.chars().count();
    let width = |c: usize| lines.iter().map(|line| length(&line[c])).fold(length(head[c]), usize::max);
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let mut write = |cells: &mut dyn Iterator<Item = &str>| {
        let padded = cells.zip(&widths).map(|(cell, &width)| format!("{cell:width$}"));
        writeln!(out, "{}", padded.collect::<Vec<_>>().join("  ").trim_end())
    };
    write(&mut head.iter().copied())?;
    for line in &lines {
        write(&mut line.iter().map(String::as_str))?;
    }
    Ok(())
}

/// A value to the decade of its bound, and to four digits at least: approximations are far off and told apart.
fn digits(value: Value) -> String {
    let (v, error) = (value.value, value.error);
    if v == 0.0 || error == 0.0 && v.fract() == 0.0 {
        return shortest(v);
    }
    let decade = |x: f64| libm::floor(libm::log10(x)) as i32;
    let error_decade = if error > 0.0 { decade(error) } else { -400 };
    let size = decade(v.abs());
    let after = (size - error_decade).clamp(3, 16);
    if (-4..=6).contains(&size) && after >= size {
        format!("{v:.*}", (after - size) as usize)
    } else {
        format!("{v:.*e}", after as usize)
    }
}

/// A value in the digits that it is known to, and a bound of the error of the value as printed, its own rounding included.
pub fn printed(value: Value) -> (String, String) {
    let text = digits(value);
    let rounding = text.parse().map_or(0.0, |printed: f64| (printed - value.value).abs());
    let error = if rounding > 0.0 { (value.error + rounding).next_up() } else { value.error };
    (text, bound(error))
}

/// A bound by its first digit, rounded up.
fn bound(error: f64) -> String {
    if error == 0.0 {
        return "0".into();
    }
    let nearest = format!("{error:.0e}");
    if nearest.parse().is_ok_and(|printed: f64| printed >= error) {
        return nearest;
    }
    match nearest.split_once('e').map(|(digit, exponent)| (digit, exponent.parse::<i32>())) {
        Some(("9", Ok(exponent))) => format!("1e{}", exponent + 1),
        Some((digit, Ok(exponent))) => format!("{}e{exponent}", digit.parse::<u8>().unwrap_or(9) + 1),
        _ => nearest,
    }
}

fn csv(answer: &Answer, out: &mut Vec<u8>) -> Result<()> {
    let coordinates = answer.coordinates();
    let mut head = vec!["problem"];
    // A parameter that a row states for itself stands in the row's column.
    let own = || answer.parameters.iter().filter(|(name, _)| !coordinates.contains(name));
    head.extend(own().map(|(name, _)| *name));
    head.push("quantity");
    head.extend(&coordinates);
    head.extend(["value", "error", "unit", "method"]);
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(&head)?;
    for row in &answer.rows {
        let mut cells = vec![answer.problem.to_string()];
        cells.extend(own().map(|(_, field)| field.to_string()));
        cells.push(row.quantity.to_string());
        for name in &coordinates {
            cells.push(row.place(name));
        }
        cells.extend([shortest(row.value.value), shortest(row.value.error)]);
        cells.extend([row.unit.to_string(), row.value.method.to_string()]);
        writer.write_record(&cells)?;
    }
    writer.flush()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_certain_digits_are_shown() {
        let show = |value, error| digits(Value { value, error, method: "" });
        assert_eq!(show(0.267_410_335_069_362_74, 2e-14), "0.26741033506936");
        assert_eq!(show(-0.267_410_335_069_362_74, 2e-5), "-0.26741");
        assert_eq!(show(4.0, 0.0), "4");
        assert_eq!(show(4.0, 1e-16), "4.0000000000000000");
        assert_eq!(show(1.5e-9, 1e-15), "1.500000e-9");
        assert_eq!(show(123.456, 0.05), "123.46");
        // Four digits at least.
        assert_eq!(show(123.456, 50.0), "123.5");
        assert_eq!(show(1234567.0, 1e5), "1.235e6");
        assert_eq!(show(0.0, 1.0), "0");
        assert_eq!(show(3.0, 1e3), "3.000");
    }
    /// A bound as printed is never below the bound, nor twice as large; with the rounding of the printed value in it.
    #[test]
    fn bounds_are_rounded_up() {
        for (error, shown) in [
            (1.0e-3, "1e-3"),
            (1.01e-3, "2e-3"),
            (9.2e-8, "1e-7"),
            (2.4e-16, "3e-16"),
            (0.0, "0"),
            (1e-300, "1e-300"),
        ] {
            assert_eq!(bound(error), shown);
        }
        let mut error = 1e-20;
        while error < 1e20 {
            let shown: f64 = bound(error).parse().unwrap();
            assert!(shown >= error && shown <= 2.0 * error, "{error} {shown}");
            error *= 1.0371;
        }
        // 0.123456 is shown as 0.1235, which is 4.4e-5 beside it.
        let value = Value { value: 0.123_456, error: 1.0e-4, method: "" };
        assert_eq!(printed(value), ("0.1235".into(), "2e-4".into()));
    }
}
