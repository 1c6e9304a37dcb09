//! Numbers for readers: as many digits as their error has, signs and powers as in print.

use turbid::stats::Moments;

/// A number to four significant digits, without trailing zeros: 0.05, 1.234, 2.5 x 10^-7.
pub fn number(x: f64) -> String {
    if !x.is_finite() {
        return if x.is_nan() {
            "not a number".to_string()
        } else if x > 0.0 {
            "∞".to_string()
        } else {
            "−∞".to_string()
        };
    }
    if x == 0.0 {
        return "0".to_string();
    }
    let power = exponent(x, 3);
    if (-3..7).contains(&power) {
        return trimmed(&print(x, (3 - power).max(0)));
    }
    let mantissa = trimmed(&print(x / ten_to(power), 3));
    format!("{mantissa}{}", times_ten_to(power))
}

/// A value with its error, both to the error's second digit: 1.0031 ± 0.0042, 123460 ± 790, (2.50 ± 0.11) x 10^-7.
pub fn with_error(value: f64, error: f64) -> String {
    to_digits_of_error(value, error, 2)
}

/// The same to the error's first digit, for headlines: 1.003 ± 0.004.
pub fn with_rough_error(value: f64, error: f64) -> String {
    to_digits_of_error(value, error, 1)
}

fn to_digits_of_error(value: f64, error: f64, of_error: i32) -> String {
    if !value.is_finite() || !error.is_finite() || error <= 0.0 {
        return match error {
            0.0 => number(value),
            e if e.is_finite() => format!("{} ± {}", number(value), number(to_power(e, exponent(e, 1) - 1))),
            _ => format!("{} ± unknown", number(value)),
        };
    }
    let largest = exponent(value.abs().max(error), 3);
    let power = if (-3..7).contains(&largest) { 0 } else { largest };
    let (value, error) = (value / ten_to(power), error / ten_to(power));
    // Digits that f64 or a reader cannot use are not printed.
    let digits = (of_error - 1 - exponent(error, (of_error - 1) as usize)).clamp(-15, 15);
    let (value, error) = (to_power(value, -digits), to_power(error, -digits));
    let text = format!("{} ± {}", print(value, digits), print(error, digits));
    if power == 0 { text } else { format!("({text}){}", times_ten_to(power)) }
}

/// A fraction in per cent.
pub fn percent(fraction: f64) -> f64 {
    100.0 * fraction
}

/// A mean of fractions in per cent, with its error: -0.31 ± 0.04, without the sign.
pub fn percent_with_error(fractions: &Moments) -> String {
    with_error(percent(fractions.mean()), percent(fractions.std_error()))
}

/// The power of ten of the first digit, after rounding to so many digits behind it.
fn exponent(x: f64, digits: usize) -> i32 {
    let text = format!("{x:.digits$e}");
    text.split('e').nth(1).and_then(|power| power.parse().ok()).unwrap_or(0)
}

fn ten_to(power: i32) -> f64 {
    // Parsed, not multiplied up: the nearest f64 to the power.
    format!("1e{power}").parse().unwrap_or(1.0)
}

/// The number to this power of ten where that is above 1; finer digits are left to printing.
fn to_power(x: f64, power: i32) -> f64 {
    if power <= 0 { x } else { (x / ten_to(power)).round() * ten_to(power) }
}

fn print(x: f64, digits: i32) -> String {
    let text = format!("{x:.*}", digits.max(0) as usize);
    let is_zero = text.chars().all(|c| "-0.".contains(c));
    if is_zero { text.replace('-', "") } else { text.replace('-', "−") }
}

fn trimmed(text: &str) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        text.to_string()
    }
}

fn times_ten_to(power: i32) -> String {
    if power == 0 {
        return String::new();
    }
    let digits = power.to_string();
    let raised = digits.chars().map(|c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        other => char::from_u32('⁰' as u32 + other.to_digit(10).unwrap_or(0)).unwrap_or(other),
    });
    format!(" × 10{}", raised.collect::<String>())
}

/// A number with so many decimals and a proper minus.
pub fn signed(x: f64, decimals: usize) -> String {
    format!("{x:.decimals$}").replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        let cases = [
            (0.05, "0.05"),
            (1.0, "1"),
            (-0.25, "−0.25"),
            (1.23456, "1.235"),
            (0.0, "0"),
            (2.5e-7, "2.5 × 10⁻⁷"),
            (1e6, "1000000"),
            (3e10, "3 × 10¹⁰"),
            (0.001, "0.001"),
            (9.9999e-4, "0.001"),
            (f64::INFINITY, "∞"),
        ];
        for (x, text) in cases {
            assert_eq!(number(x), text);
        }
    }

    #[test]
    fn one_digit_of_the_error_for_headlines() {
        assert_eq!(with_rough_error(1.003_12, 0.004_21), "1.003 ± 0.004");
        assert_eq!(with_rough_error(75.84, 1.44), "76 ± 1");
        assert_eq!(with_rough_error(0.5, 0.097), "0.5 ± 0.1");
    }

    #[test]
    fn errors_rule_the_digits() {
        let cases = [
            (1.003_12, 0.004_21, "1.0031 ± 0.0042"),
            (2.5e-7, 1.1e-8, "(2.50 ± 0.11) × 10⁻⁷"),
            (-12.34, 5.6, "−12.3 ± 5.6"),
            (1e-9, 0.5, "0.00 ± 0.50"),
            (-1e-9, 0.5, "0.00 ± 0.50"),
            (123_456.0, 789.0, "123460 ± 790"),
            (123_456.0, 99_600.0, "120000 ± 100000"),
            (-5.0, 123.4, "−10 ± 120"),
            (1.0, 0.0, "1"),
            (1.0, f64::INFINITY, "1 ± unknown"),
            (3.0e12, 2.0e10, "(3.000 ± 0.020) × 10¹²"),
            (0.5, 0.099_99, "0.50 ± 0.10"),
        ];
        for (value, error, text) in cases {
            assert_eq!(with_error(value, error), text);
        }
    }

    /// Of errors of every size beside values of every size.
    #[test]
    fn errors_have_two_digits_at_most() {
        for i in -400..=400 {
            for j in -40..=40 {
                let (error, value) =
                    (libm::exp10(0.037 * f64::from(i)), 1.234_567 * libm::exp10(0.37 * f64::from(j)));
                let text = with_error(value, error);
                let (_, error) = text.split_once(" ± ").unwrap();
                let error = error.split([')', ' ']).next().unwrap().replace('.', "");
                let digits = error.trim_start_matches('0').trim_end_matches('0');
                assert!(digits.len() <= 2, "{text}");
            }
        }
    }
}
