//! Numbers as they stand on axes: exact decimals, a true minus sign, powers of ten in superscript.

/// The decimal text of n 10^k.
///
/// Integers in, so that 3 times 0.1 reads 0.3.
pub(crate) fn decimal(n: i64, k: i32) -> String {
    let sign = if n < 0 { "−" } else { "" };
    let digits = n.unsigned_abs().to_string();
    if n == 0 {
        return "0".to_owned();
    }
    if k >= 0 {
        return format!("{sign}{digits}{}", "0".repeat(k as usize));
    }
    let places = k.unsigned_abs() as usize;
    let padded = format!("{digits:0>width$}", width = places + 1);
    let (whole, part) = padded.split_at(padded.len() - places);
    format!("{sign}{whole}.{part}")
}

/// The power 10^k with the exponent in superscript.
pub(crate) fn power_of_ten(k: i32) -> String {
    let exponent: String = k
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '0' => '⁰',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            _ => '⁹',
        })
        .collect();
    format!("10{exponent}")
}

/// n 10^k, rounded once: powers of ten are exact up to 22.
pub(crate) fn value(n: i64, k: i32) -> f64 {
    if (-22..0).contains(&k) { n as f64 / 10f64.powi(-k) } else { n as f64 * 10f64.powi(k) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact() {
        for (n, k, text) in [
            (3, -1, "0.3"),
            (-25, -2, "−0.25"),
            (-5, 0, "−5"),
            (2, 3, "2000"),
            (0, -3, "0"),
            (12, -4, "0.0012"),
            (120, -1, "12.0"),
        ] {
            assert_eq!(decimal(n, k), text);
        }
    }

    #[test]
    fn powers_are_superscripts() {
        assert_eq!(power_of_ten(-12), "10⁻¹²");
        assert_eq!(power_of_ten(6), "10⁶");
        assert_eq!(power_of_ten(3457890), "10³⁴⁵⁷⁸⁹⁰");
    }

    #[test]
    fn values_are_the_nearest_doubles() {
        for k in -22..=22 {
            for n in [1_i64, 3, 7, -15] {
                let parsed: f64 = format!("{n}e{k}").parse().unwrap();
                assert_eq!(value(n, k), parsed, "{n}e{k}");
            }
        }
    }
}
