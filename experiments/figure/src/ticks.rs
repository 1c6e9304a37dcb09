//! Where ticks stand and what they say.

use crate::axis::Scale;
use crate::number::{decimal, power_of_ten, value};
use crate::scale::Span;

/// Rounding room when a tick falls on a limit, as a fraction of the axis.
const ON_LIMIT: f64 = 1e-9;

/// A tick with its label, at a transformed number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub(crate) at: f64,
    pub(crate) label: String,
}

/// The ticks of one axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Ticks {
    pub(crate) major: Vec<Tick>,
    /// Transformed numbers of the ticks without labels.
    pub(crate) minor: Vec<f64>,
    /// Labels are to be multiplied by this power of ten, which the axis label says.
    pub(crate) exponent: i32,
}

/// Ticks of an axis with at most `most` labels (fewer only where two are the least).
pub(crate) fn ticks(span: &Span, most: usize) -> Ticks {
    let most = most.max(2);
    match span.scale {
        Scale::Linear => linear(span.low, span.high, most),
        Scale::Log | Scale::LogClipped => log(span, most),
        Scale::SymLog { threshold } => symlog(span, threshold, most),
    }
}

/// The multiples of m 10^k within the limits.
fn multiples(low: f64, high: f64, m: i64, k: i32) -> std::ops::RangeInclusive<i64> {
    let step = value(m, k);
    let room = ON_LIMIT * (high - low) / step;
    ((low / step - room).ceil() as i64)..=((high / step + room).floor() as i64)
}

/// The finest step of 1, 2 or 5 times a power of ten that gives at most `most` ticks, and at least two.
fn nice_step(low: f64, high: f64, most: usize) -> (i64, i32) {
    let count = |(m, k)| {
        let range = multiples(low, high, m, k);
        range.end().saturating_sub(*range.start()).saturating_add(1).max(0) as usize
    };
    let mut k = libm::floor(libm::log10((high - low) / most as f64)) as i32;
    let mut finer = (1, k);
    loop {
        for m in [1, 2, 5] {
            let step = (m, k);
            match count(step) {
                n if n > most => finer = step,
                n if n >= 2 => return step,
                _ => return finer,
            }
        }
        k += 1;
    }
}

fn linear(low: f64, high: f64, most: usize) -> Ticks {
    let (m, k) = nice_step(low, high, most);
    let largest = low.abs().max(high.abs());
    let magnitude = libm::floor(libm::log10(largest)) as i32;
    let exponent = if (-3..=4).contains(&magnitude) { 0 } else { 3 * magnitude.div_euclid(3) };
    let major = multiples(low, high, m, k)
        .map(|i| Tick { at: value(i * m, k), label: decimal(i * m, k - exponent) })
        .collect();
    let parts = if m == 2 { 4 } else { 5 };
    // Each part of the step is itself a multiple of a power of ten: 1/5, 2/4, 5/5.
    let (part, part_k) = if m == 5 { (1, k) } else { (10 * m / parts, k - 1) };
    let minor = multiples(low, high, part, part_k)
        .filter(|i| i.rem_euclid(parts) != 0)
        .map(|i| value(i * part, part_k))
        .collect();
    Ticks { major, minor, exponent }
}

/// A label of m 10^k beside others whose exponents all lie in `plain`, or not.
fn log_label(m: i64, k: i32, plain: bool) -> String {
    match (plain, m) {
        (true, _) => decimal(m, k),
        (false, 1) => power_of_ten(k),
        (false, -1) => format!("−{}", power_of_ten(k)),
        (false, _) => format!("{}×{}", decimal(m, 0), power_of_ten(k)),
    }
}

/// Whether decimals are friendlier than powers: 0.01 to 1000.
fn is_plain(low: i32, high: i32) -> bool {
    low >= -3 && high <= 3
}

fn log(span: &Span, most: usize) -> Ticks {
    let (low, high) = (span.low, span.high);
    let room = ON_LIMIT * (high - low);
    let inside = |t: f64| t >= low - room && t <= high + room;
    let (first, last) = (libm::floor(low + room) as i32, libm::ceil(high - room) as i32);
    let place = |m: i64, k: i32| f64::from(k) + libm::log10(m as f64);
    let decades: Vec<i32> = (first..=last).filter(|&k| inside(f64::from(k))).collect();
    let choose = |steps: &[i64]| -> Vec<(i64, i32)> {
        (first..=last)
            .flat_map(|k| steps.iter().map(move |&m| (m, k)))
            .filter(|&(m, k)| inside(place(m, k)))
            .collect()
    };
    // The richest of these that fits; beyond three decades, whole ones, or every n-th.
    let chosen = if high - low < 0.5 {
        return narrow_log(low, high, most);
    } else if high - low < 3.0 {
        let steps: [&[i64]; 5] = [&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[1, 2, 3, 5], &[1, 2, 5], &[1, 3], &[1]];
        let richest = if high - low < 1.0 { 0 } else { 2 };
        steps[richest..].iter().map(|s| choose(s)).find(|c| c.len() <= most && c.len() >= 2)
    } else {
        None
    };
    let chosen = chosen.unwrap_or_else(|| {
        let stride = (1..).find(|s| decades.iter().filter(|k| *k % s == 0).count() <= most).unwrap_or(1);
        decades.iter().filter(|k| *k % stride == 0).map(|&k| (1, k)).collect()
    });
    if chosen.len() < 2 {
        return narrow_log(low, high, most);
    }
    let exponents = || chosen.iter().map(|&(_, k)| k);
    let plain = is_plain(exponents().min().unwrap_or(0), exponents().max().unwrap_or(0));
    let major: Vec<Tick> =
        chosen.iter().map(|&(m, k)| Tick { at: place(m, k), label: log_label(m, k, plain) }).collect();
    let every_decade: Vec<i32> = chosen.iter().filter(|c| c.0 == 1).map(|c| c.1).collect();
    let skips_decades = every_decade.windows(2).any(|w| w[1] - w[0] > 1);
    let candidates: Vec<(i64, i32)> = if skips_decades {
        decades.iter().map(|&k| (1, k)).collect()
    } else {
        choose(&[1, 2, 3, 4, 5, 6, 7, 8, 9])
    };
    let minor = candidates.into_iter().filter(|c| !chosen.contains(c)).map(|(m, k)| place(m, k)).collect();
    Ticks { major, minor, exponent: 0 }
}

/// Less than half a decade: the ticks of a linear axis, at their logarithmic places.
fn narrow_log(low: f64, high: f64, most: usize) -> Ticks {
    let mut t = linear(libm::exp10(low), libm::exp10(high), most);
    for tick in &mut t.major {
        tick.at = libm::log10(tick.at);
    }
    for at in &mut t.minor {
        *at = libm::log10(*at);
    }
    t
}

fn symlog(span: &Span, threshold: f64, most: usize) -> Ticks {
    let room = ON_LIMIT * (span.high - span.low);
    let inside = |t: f64| t >= span.low - room && t <= span.high + room;
    let largest = span.low.abs().max(span.high.abs());
    if largest <= 1.0 {
        // Nothing beyond the linear part.
        let mut t = linear(span.low * threshold, span.high * threshold, most);
        t.major.iter_mut().for_each(|tick| tick.at /= threshold);
        t.minor.iter_mut().for_each(|at| *at /= threshold);
        return t;
    }
    let first = libm::ceil(libm::log10(threshold) - ON_LIMIT) as i32;
    let last = libm::floor(libm::log10(threshold) + largest - 1.0 + room) as i32;
    let place = |m: i64, k: i32| span.scale.forward(value(m, k));
    let signed = |stride: i32| -> Vec<(i64, i32)> {
        (first..=last)
            .filter(|k| (k - first) % stride == 0)
            .flat_map(|k| [(-1, k), (1, k)])
            .filter(|&(m, k)| inside(place(m, k)))
            .collect()
    };
    let stride = (1..).find(|&s| signed(s).len() < most || s > last - first).unwrap_or(1);
    let chosen = signed(stride);
    let plain = is_plain(first, last);
    let mut major: Vec<Tick> =
        chosen.iter().map(|&(m, k)| Tick { at: place(m, k), label: log_label(m, k, plain) }).collect();
    if inside(0.0) {
        major.push(Tick { at: 0.0, label: "0".to_owned() });
    }
    major.sort_by(|a, b| a.at.total_cmp(&b.at));
    let fine: &[i64] = if stride == 1 { &[2, 3, 4, 5, 6, 7, 8, 9] } else { &[1] };
    let minor = (first - 1..=last)
        .flat_map(|k| fine.iter().flat_map(move |&m| [(-m, k), (m, k)]))
        .filter(|&(m, k)| value(m, k).abs() >= threshold && inside(place(m, k)) && !chosen.contains(&(m, k)))
        .map(|(m, k)| place(m, k))
        .collect();
    Ticks { major, minor, exponent: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, range: (f64, f64), most: usize) -> Vec<String> {
        ticks(&Span::exact(scale, range), most).major.into_iter().map(|t| t.label).collect()
    }

    #[test]
    fn linear_ticks_stand_at_nice_values_limits_included() {
        assert_eq!(labels(Scale::Linear, (0.0, 1.0), 6), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(Scale::Linear, (-47.0, 6.0), 7), ["−40", "−30", "−20", "−10", "0"]);
        assert_eq!(labels(Scale::Linear, (0.3, 0.7), 5), ["0.3", "0.4", "0.5", "0.6", "0.7"]);
        assert_eq!(labels(Scale::Linear, (-1e-3, 1e-3), 5), ["−0.0010", "−0.0005", "0", "0.0005", "0.0010"]);
    }

    #[test]
    fn small_and_large_numbers_share_a_power_of_ten() {
        let t = ticks(&Span::exact(Scale::Linear, (0.0, 2e6)), 5);
        assert_eq!(t.exponent, 6);
        assert_eq!(
            t.major.iter().map(|t| t.label.as_str()).collect::<Vec<_>>(),
            ["0", "0.5", "1.0", "1.5", "2.0"]
        );
        assert_eq!(t.major[1].at, 5e5);
        assert_eq!(ticks(&Span::exact(Scale::Linear, (0.0, 3e-5)), 5).exponent, -6);
    }

    #[test]
    fn every_range_has_two_to_most_ticks_inside() {
        for e in -30..30 {
            for (a, b) in [(0.0, 1.0), (-0.37, 0.911), (0.9999, 1.0001), (-5.5, -1.0), (1.0, 1.05)] {
                let s = libm::exp10(f64::from(e) * 0.37);
                for most in 3..9 {
                    let span = Span::exact(Scale::Linear, (a * s, b * s));
                    let t = ticks(&span, most);
                    assert!(t.major.len() >= 2, "{a} {b} {s} {most}");
                    // Where no step gives between two and most, the finer step wins by a few.
                    assert!(t.major.len() <= most.max(5), "{} {most}", t.major.len());
                    assert!(
                        t.major.iter().all(|t| (-1e-6..=1.000_001).contains(&span.unit_of_transformed(t.at)))
                    );
                }
            }
        }
    }

    #[test]
    fn minor_ticks_divide_the_step_and_avoid_the_labels() {
        let t = ticks(&Span::exact(Scale::Linear, (0.0, 1.0)), 6);
        assert_eq!(t.minor.len(), 5 * 3);
        assert_eq!(t.minor[0], 0.05);
        assert!(t.minor.iter().all(|m| t.major.iter().all(|t| (t.at - m).abs() > 0.04)));
        let t = ticks(&Span::exact(Scale::Linear, (0.0, 10.0)), 3);
        assert_eq!(t.minor, [1.0, 2.0, 3.0, 4.0, 6.0, 7.0, 8.0, 9.0]);
    }

    #[test]
    fn log_ticks_are_decades_in_plain_or_superscript() {
        assert_eq!(labels(Scale::Log, (1e3, 1e7), 8), ["10³", "10⁴", "10⁵", "10⁶", "10⁷"]);
        assert_eq!(labels(Scale::Log, (0.005, 200.0), 8), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(labels(Scale::Log, (0.5, 30.0), 8), ["0.5", "1", "2", "5", "10", "20"]);
        assert_eq!(labels(Scale::Log, (1e-12, 1.0), 5), ["10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "10⁰"]);
        assert_eq!(labels(Scale::Log, (0.9, 4.0), 8), ["0.9", "1", "2", "3", "4"]);
        assert_eq!(labels(Scale::Log, (2.1, 3.9), 5), ["2.5", "3.0", "3.5"]);
        let minor = ticks(&Span::exact(Scale::Log, (1e3, 1e6)), 8).minor;
        assert_eq!(minor.len(), 3 * 8);
        assert!((minor[0] - libm::log10(2e3)).abs() < 1e-14);
    }

    #[test]
    fn symmetric_log_ticks_mirror_about_zero() {
        let scale = Scale::SymLog { threshold: 0.1 };
        assert_eq!(labels(scale, (-100.0, 10.0), 9), ["−100", "−10", "−1", "−0.1", "0", "0.1", "1", "10"]);
        assert_eq!(labels(Scale::SymLog { threshold: 5.0 }, (-4.0, 4.0), 5), ["−4", "−2", "0", "2", "4"]);
        assert!(labels(Scale::SymLog { threshold: 1e-6 }, (-1.0, 1.0), 7).len() <= 7);
    }
}
