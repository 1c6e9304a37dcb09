//! From data to the unit interval.

use crate::axis::{Axis, Scale};

/// Where a number without a place on a logarithmic axis stands, in axis lengths below the lower limit.
const BELOW: f64 = 1.0;

/// Positions are held within this many axis lengths, so that arithmetic on them stays finite.
const FAR: f64 = 1e9;

/// Numbers closer than this on a linear axis stand in one place: its ticks are thousandths of their distance at least, and
/// powers of ten end at 1e-308.
pub(crate) const NARROWEST: f64 = 1e-300;

/// Margin between the outermost datum and the border, as a fraction of the axis.
const MARGIN: f64 = 0.045;

impl Scale {
    /// The number on the scale where equal differences are equal lengths; minus infinity below a logarithmic axis.
    pub(crate) fn forward(self, v: f64) -> f64 {
        match self {
            Self::Linear => v,
            Self::Log | Self::LogClipped => {
                if v > 0.0 {
                    libm::log10(v)
                } else {
                    f64::NEG_INFINITY
                }
            }
            Self::SymLog { threshold } => {
                let u = v / threshold;
                if u.abs() <= 1.0 { u } else { u.signum() * (1.0 + libm::log10(u.abs())) }
            }
        }
    }

    /// The number at a transformed one.
    pub(crate) fn backward(self, t: f64) -> f64 {
        match self {
            Self::Linear => t,
            Self::Log | Self::LogClipped => libm::exp10(t),
            Self::SymLog { threshold } => {
                threshold * if t.abs() <= 1.0 { t } else { t.signum() * libm::exp10(t.abs() - 1.0) }
            }
        }
    }

    /// Whether only positive numbers have a place on it.
    pub(crate) fn is_log(self) -> bool {
        matches!(self, Self::Log | Self::LogClipped)
    }
}

/// The limits of an axis, in transformed numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) scale: Scale,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Span {
    /// Limits exactly as given.
    pub(crate) fn exact(scale: Scale, (low, high): (f64, f64)) -> Self {
        Self { scale, low: scale.forward(low), high: scale.forward(high) }
    }

    /// Limits around data with a margin; `floor` keeps the lower limit at the lowest datum (bars stand on it).
    pub(crate) fn around(scale: Scale, (low, high): (f64, f64), floor: bool) -> Self {
        let (low, high) = (scale.forward(low), scale.forward(high));
        let width = high - low;
        // One value alone stands in the middle of an axis of its own size, or of one decade.
        let size = low.abs().max(high.abs());
        let pad = if width > (1e-12 * size).max(NARROWEST) {
            MARGIN * width
        } else if scale == Scale::Linear && low.abs() > NARROWEST {
            0.5 * low.abs()
        } else {
            0.5
        };
        Self { scale, low: if floor { low } else { low - pad }, high: high + pad }
    }

    /// Limits from the axis, or from the data where the axis leaves them open.
    pub(crate) fn of(axis: &Axis, data: (f64, f64), floor: bool) -> Self {
        match axis.range {
            Some(range) => Self::exact(axis.scale, range),
            None => Self::around(axis.scale, data, floor),
        }
    }

    /// Position from 0 (low) to 1 (high), outside beyond the limits.
    pub(crate) fn unit(&self, v: f64) -> f64 {
        self.unit_of_transformed(self.scale.forward(v))
    }

    pub(crate) fn unit_of_transformed(&self, t: f64) -> f64 {
        if t == f64::NEG_INFINITY {
            -BELOW
        } else {
            ((t - self.low) / (self.high - self.low)).clamp(-FAR, FAR)
        }
    }

    /// Whether the number lies within the limits, up to rounding.
    pub(crate) fn contains(&self, v: f64) -> bool {
        (-1e-9..=1.0 + 1e-9).contains(&self.unit(v))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_interval_of_each_scale_is_the_closed_form() {
        let linear = Span::exact(Scale::Linear, (-2.0, 6.0));
        assert_eq!([linear.unit(-2.0), linear.unit(0.0), linear.unit(6.0)], [0.0, 0.25, 1.0]);
        let log = Span::exact(Scale::Log, (1e-2, 1e2));
        assert!((log.unit(1.0) - 0.5).abs() < 1e-15 && (log.unit(10.0) - 0.75).abs() < 1e-15);
        // One linear unit, then a decade, on either side: (-10, 10) spans 4 units.
        let sym = Span::exact(Scale::SymLog { threshold: 1.0 }, (-10.0, 10.0));
        for (v, u) in [(-10.0, 0.0), (-1.0, 0.25), (0.5, 0.625), (1.0, 0.75), (10.0, 1.0)] {
            assert!((sym.unit(v) - u).abs() < 1e-15, "{v}");
        }
    }

    #[test]
    fn outside_stays_outside_and_finite() {
        let log = Span::exact(Scale::LogClipped, (1.0, 10.0));
        assert_eq!(log.unit(0.0), -BELOW);
        assert_eq!(log.unit(-3.0), -BELOW);
        assert!(!log.contains(0.999) && log.contains(1.0) && log.contains(10.0));
        assert!((log.unit(1e300) - 300.0).abs() < 1e-12, "a line to there keeps its slope");
        assert_eq!(Span::exact(Scale::Linear, (0.0, 1e-300)).unit(1e300), FAR);
    }

    #[test]
    fn backward_undoes_forward() {
        for scale in [Scale::Linear, Scale::Log, Scale::SymLog { threshold: 0.3 }] {
            for v in [1e-9, 0.2, 0.3, 7.0, 1e12, -4.0, -0.1] {
                if v > 0.0 || !scale.is_log() {
                    // A logarithm of size L loses L ln 10 ulps on the way back.
                    assert!((scale.backward(scale.forward(v)) / v - 1.0).abs() < 1e-13, "{scale:?} {v}");
                }
            }
        }
    }

    #[test]
    fn ranges_from_data_have_a_margin_and_never_no_width() {
        let s = Span::around(Scale::Linear, (0.0, 10.0), false);
        assert!(s.low < 0.0 && s.high > 10.0);
        assert_eq!(Span::around(Scale::Linear, (0.0, 10.0), true).low, 0.0);
        for v in [0.0, 3.0, -1e-9] {
            let s = Span::around(Scale::Linear, (v, v), false);
            assert!(s.low < v && v < s.high, "{v}");
        }
        assert!(Span::around(Scale::Log, (5.0, 5.0), false).high > libm::log10(5.0));
    }
}
