//! Fits on the linear scale, with errors over maps.

use super::Moments;

/// A straight line fitted to points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Slope.
    pub slope: f64,
    /// Value at x = 0.
    pub intercept: f64,
    /// Standard error of the slope from the scatter about the line; infinite below three points. It knows nothing
    /// of errors that the points share: refit per map for those.
    pub slope_error: f64,
    /// Standard error of the intercept, likewise.
    pub intercept_error: f64,
}

/// Weighted least squares through `(x, y, weight)`, weights inverse to variances up to a common factor.
///
/// # Returns
/// `None` where the points do not fix a line: fewer than two different x of positive weight.
pub fn fit_line(points: &[(f64, f64, f64)]) -> Option<Line> {
    let total: f64 = points.iter().map(|p| p.2).sum();
    let mean_x = points.iter().map(|p| p.2 * p.0).sum::<f64>() / total;
    let mean_y = points.iter().map(|p| p.2 * p.1).sum::<f64>() / total;
    let sxx: f64 = points.iter().map(|p| p.2 * (p.0 - mean_x) * (p.0 - mean_x)).sum();
    let sxy: f64 = points.iter().map(|p| p.2 * (p.0 - mean_x) * (p.1 - mean_y)).sum();
    if sxx.is_nan() || sxx <= 0.0 {
        return None;
    }
    let slope = sxy / sxx;
    let intercept = mean_y - slope * mean_x;
    let residuals: f64 =
        points.iter().map(|&(x, y, w)| w * (y - intercept - slope * x) * (y - intercept - slope * x)).sum();
    let freedom = points.iter().filter(|p| p.2 > 0.0).count().saturating_sub(2);
    let scatter = if freedom == 0 { f64::INFINITY } else { residuals / freedom as f64 };
    let slope_error = (scatter / sxx).sqrt();
    let intercept_error = (scatter * (1.0 / total + mean_x * mean_x / sxx)).sqrt();
    Some(Line { slope, intercept, slope_error, intercept_error })
}

/// The factor a of "measured = a x predicted", one value a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Amplitude {
    /// The factor of each map, in the order of the maps.
    pub per_map: Vec<f64>,
    /// Their moments: the fit is linear, so their mean is the fit to the mean of the maps, and their spread holds
    /// whatever the points of one map share.
    pub moments: Moments,
}

/// Fits "measured = a x predicted" to each map: a = sum w p y / sum w p^2 over its points.
///
/// # Arguments
/// `predicted` the prediction at each point, with its sign; `maps` the measured values of each map at the same
/// points; `weights` one a point, **fixed before** the measurement or taken from all maps together, so that they do
/// not follow one map's noise.
///
/// # Returns
/// `None` where lengths differ or all predictions of positive weight are zero.
pub fn amplitude_per_map(predicted: &[f64], maps: &[Vec<f64>], weights: &[f64]) -> Option<Amplitude> {
    let norm: f64 = predicted.iter().zip(weights).map(|(p, w)| w * p * p).sum();
    let same = weights.len() == predicted.len() && maps.iter().all(|m| m.len() == predicted.len());
    if !same || norm.is_nan() || norm <= 0.0 {
        return None;
    }
    let amplitude = |map: &Vec<f64>| {
        map.iter().zip(predicted).zip(weights).map(|((y, p), w)| w * p * y).sum::<f64>() / norm
    };
    let per_map: Vec<f64> = maps.iter().map(amplitude).collect();
    let moments = per_map.iter().collect();
    Some(Amplitude { per_map, moments })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, Stream};
    use crate::stats::mean::tests::normal;
    use crate::stats::{ALPHA, mean_interval, wilson_interval};

    #[test]
    fn a_line_by_hand() {
        // (0,1) (1,3) (2,4): slope 3/2, intercept 7/6, residual sum 1/6, slope error sqrt(1/6/2).
        let line = fit_line(&[(0.0, 1.0, 1.0), (1.0, 3.0, 1.0), (2.0, 4.0, 1.0)]).unwrap();
        assert!((line.slope - 1.5).abs() < 1e-15 && (line.intercept - 7.0 / 6.0).abs() < 1e-15);
        assert!((line.slope_error - (1.0f64 / 12.0).sqrt()).abs() < 1e-15);
        assert!((line.intercept_error - (5.0f64 / 36.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn a_weight_of_two_is_the_point_twice() {
        let weighted = fit_line(&[(0.0, 1.0, 1.0), (1.0, 3.0, 2.0), (2.0, 4.0, 1.0)]).unwrap();
        let twice = fit_line(&[(0.0, 1.0, 1.0), (1.0, 3.0, 1.0), (1.0, 3.0, 1.0), (2.0, 4.0, 1.0)]).unwrap();
        assert!(
            (weighted.slope - twice.slope).abs() < 1e-15
                && (weighted.intercept - twice.intercept).abs() < 1e-15
        );
    }

    /// Predictions 1 and 2 with weights 3 and 1: a = (3 y1 + 2 y2) / (3 + 4).
    #[test]
    fn an_amplitude_by_hand() {
        let fit =
            amplitude_per_map(&[1.0, 2.0], &[vec![1.0, 2.0], vec![2.0, 4.0], vec![1.0, 0.5]], &[3.0, 1.0]);
        let fit = fit.unwrap();
        let expected = [1.0, 2.0, 4.0 / 7.0];
        assert!(fit.per_map.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{fit:?}");
        assert!((fit.moments.mean() - 25.0 / 21.0).abs() < 1e-15 && fit.moments.n() == 3);
        // A prediction of the opposite sign has an amplitude of the opposite sign.
        let mirrored = amplitude_per_map(&[-1.0, -2.0], &[vec![1.0, 2.0]], &[3.0, 1.0]).unwrap();
        assert!((mirrored.per_map[0] + 1.0).abs() < 1e-15);
    }

    #[test]
    fn points_that_fix_nothing() {
        assert!(fit_line(&[(1.0, 2.0, 1.0), (1.0, 3.0, 1.0)]).is_none());
        assert!(fit_line(&[]).is_none());
        assert_eq!(fit_line(&[(0.0, 0.0, 1.0), (1.0, 1.0, 1.0)]).unwrap().slope_error, f64::INFINITY);
        assert!(amplitude_per_map(&[0.0], &[vec![1.0]], &[1.0]).is_none());
        assert!(amplitude_per_map(&[1.0], &[vec![1.0, 2.0]], &[1.0]).is_none());
    }

    /// Maps whose points share most of their noise: the interval over maps covers, the scatter about the line of one
    /// mean map (the negative control) does not.
    #[test]
    fn amplitude_covers_although_points_share_photons() {
        let predicted = [0.1, 0.2, 0.4, 0.8];
        let (mut inside, mut control) = (0, 0);
        for set in 0..2000 {
            let mut stream = Stream::new(19, Purpose::Synthetic, set, 0);
            let maps: Vec<Vec<f64>> = (0..16)
                .map(|_| {
                    let shared = normal(&mut stream);
                    predicted.iter().map(|p| 1.05 * p + 0.3 * shared + 0.05 * normal(&mut stream)).collect()
                })
                .collect();
            let fit = amplitude_per_map(&predicted, &maps, &[1.0; 4]).unwrap();
            inside += u64::from(mean_interval(&fit.moments, 0.95).contains(1.05));
            let points: Vec<_> =
                (0..4).map(|i| (predicted[i], maps.iter().map(|m| m[i]).sum::<f64>() / 16.0, 1.0)).collect();
            let a = fit.moments.mean();
            let scatter: f64 = points.iter().map(|&(p, y, _)| (y - a * p) * (y - a * p)).sum::<f64>() / 3.0;
            let error = (scatter / predicted.iter().map(|p| p * p).sum::<f64>()).sqrt();
            // t(0.975; 3) = 3.182.
            control += u64::from((a - 1.05).abs() <= 3.182 * error);
        }
        assert!(wilson_interval(inside, 2000, 1.0 - ALPHA).contains(0.95), "{inside} of 2000");
        assert!(wilson_interval(control, 2000, 1.0 - ALPHA).high < 0.95, "{control} of 2000");
    }
}
