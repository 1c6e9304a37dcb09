//! E_1 as often as an operator needs it: a polynomial up to 1, Chebyshev series by octave beyond.

use crate::exponential_integral::EULER_GAMMA;
use libm::{cos, exp, log};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Terms of the series of Ein on \[0, 1\]: the next is 1/(19 19!) = 4e-19.
const POWERS: usize = 18;

/// Chebyshev terms on an octave \[x, 2x\]: e^x x E_1(x) is analytic up to x = 0, so they fall by 3 + sqrt 8 = 5.8 each,
/// and 24 leave 4e-19.
const CHEBYSHEV: usize = 24;

/// Octaves \[1, 2\] to \[512, 1024\]: E_1 underflows at 739.
const OCTAVES: usize = 10;

struct Tables {
    ein: [f64; POWERS],
    octaves: [[f64; CHEBYSHEV]; OCTAVES],
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let mut ein = [0.0; POWERS];
    let mut factorial = 1.0;
    for (i, c) in ein.iter_mut().enumerate() {
        let k = i as f64 + 1.0;
        factorial *= k;
        *c = if i.is_multiple_of(2) { 1.0 } else { -1.0 } / (k * factorial);
    }
    let mut octaves = [[0.0; CHEBYSHEV]; OCTAVES];
    for (octave, series) in octaves.iter_mut().enumerate() {
        let start = f64::from(1_u32 << octave);
        // cos(pi m/(2 n)) with m reduced as an integer.
        let cosine = |m: usize| cos(PI * (m % (4 * CHEBYSHEV)) as f64 / (2.0 * CHEBYSHEV as f64));
        let values: [f64; CHEBYSHEV] = std::array::from_fn(|i| {
            let x = start * (1.5 + 0.5 * cosine(2 * i + 1));
            x * scaled_e1(x)
        });
        for (j, c) in series.iter_mut().enumerate() {
            let sum: f64 = values.iter().enumerate().map(|(i, v)| v * cosine(j * (2 * i + 1))).sum();
            *c = sum * if j == 0 { 1.0 } else { 2.0 } / CHEBYSHEV as f64;
        }
    }
    Tables { ein, octaves }
});

/// e^x E_1(x) for x >= 1, by its continued fraction from a tail so far out that it does not matter.
fn scaled_e1(x: f64) -> f64 {
    let mut i = 400.0;
    let mut f = x + 2.0 * i + 1.0;
    while i >= 1.0 {
        f = x + 2.0 * i - 1.0 - i * i / f;
        i -= 1.0;
    }
    1.0 / f
}

/// Ein(x) = E_1(x) + gamma + ln x for 0 <= x <= 1.
pub(crate) fn ein(x: f64) -> f64 {
    let mut sum = 0.0;
    for &c in TABLES.ein.iter().rev() {
        sum = sum * x + c;
    }
    sum * x
}

/// E_1(x), x > 0, to a few roundings.
pub(crate) fn e1(x: f64) -> f64 {
    if x < 1.0 {
        return ein(x) - log(x) - EULER_GAMMA;
    }
    if x > 745.0 {
        return 0.0;
    }
    let octave = ((x.to_bits() >> 52) as usize).saturating_sub(1023).min(OCTAVES - 1);
    let start = f64::from(1_u32 << octave);
    // The octave on [-1, 1].
    let y = 2.0 * (x - start) / start - 1.0;
    let (mut b1, mut b2) = (0.0, 0.0);
    for &c in TABLES.octaves[octave][1..].iter().rev() {
        let b0 = 2.0 * y * b1 - b2 + c;
        b2 = b1;
        b1 = b0;
    }
    exp(-x) * (y * b1 - b2 + TABLES.octaves[octave][0]) / x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exponential_integral as slow;

    #[test]
    fn the_continued_fraction_and_the_series_are_met() {
        let mut x = 1e-300;
        while x < 740.0 {
            let (a, b) = (e1(x), slow::e1(x));
            // Both carry up to 16 roundings; subnormal results have fewer digits.
            assert!((a - b).abs() <= 17.0 * f64::EPSILON * b + 5e-322, "{x}: {a} {b}");
            if x <= 1.0 {
                assert!((ein(x) - slow::ein(x)).abs() <= 4.0 * f64::EPSILON * ein(x), "{x}");
            }
            x *= if x < 1e-3 { 1.7 } else { 1.0007 };
        }
        for x in [1.0, 2.0, 64.0, 512.0, 599.9, 600.1] {
            assert!((e1(x) - slow::e1(x)).abs() <= 16.0 * f64::EPSILON * slow::e1(x), "{x}");
        }
        assert_eq!(e1(800.0), 0.0);
    }
}
