//! Widths of a measured profile.

/// Rising values nearest to the given ones in the sense of least squares, by pooling neighbours that fall.
fn rising(values: &[f64]) -> Vec<f64> {
    let mut pools: Vec<(f64, usize)> = Vec::with_capacity(values.len());
    for &value in values {
        pools.push((value, 1));
        while let [.., (a, m), (b, n)] = pools[..]
            && a > b
        {
            pools.truncate(pools.len() - 2);
            pools.push(((a * m as f64 + b * n as f64) / (m + n) as f64, m + n));
        }
    }
    pools.iter().flat_map(|&(value, n)| std::iter::repeat_n(value, n)).collect()
}

/// Where the monotone cubic through rising points on an even grid crosses a level (Fritsch and Butland 1984: slopes are
/// harmonic means of the neighbouring ones). A profile that does not reach the level crosses it at its end.
fn crossing(x: &[f64], y: &[f64], level: f64) -> f64 {
    let last = x.len() - 1;
    let above = y.partition_point(|&v| v < level);
    if above == 0 || above > last {
        return x[above.min(last)];
    }
    let i = above - 1;
    let rise = |i: usize| y[i + 1] - y[i];
    let slope = |i: usize| {
        if i == 0 || i == last {
            return if i == 0 { rise(0) } else { rise(last - 1) };
        }
        let (a, b) = (rise(i - 1), rise(i));
        if a > 0.0 && b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 }
    };
    let (from, to) = (slope(i), slope(i + 1));
    let value = |t: f64| {
        let s = 1.0 - t;
        y[i] * s * s * (1.0 + 2.0 * t) + y[i + 1] * t * t * (3.0 - 2.0 * t) + from * t * s * s
            - to * t * t * s
    };
    let (mut low, mut high) = (0.0, 1.0);
    // A rising cubic, down to a part in 10^12 of the step.
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if value(middle) < level { low = middle } else { high = middle }
    }
    x[i] + 0.5 * (low + high) * (x[i + 1] - x[i])
}

/// Distance from 10 to 90 per cent of the plateau, between crossings of the monotone interpolant, in the unit of `x`.
pub fn rise_width(x: &[f64], y: &[f64], plateau: f64) -> f64 {
    let y = rising(y);
    crossing(x, &y, 0.9 * plateau) - crossing(x, &y, 0.1 * plateau)
}

/// Plateau over the slope at the edge, in the unit of `x`: the slope of the cubic through the two probes next to the edge
/// on either side.
///
/// None where the edge has no two neighbours on an even grid, or where the profile does not rise.
pub fn equivalent_width(x: &[f64], y: &[f64], plateau: f64) -> Option<f64> {
    let edge = x.iter().position(|&x| x.abs() < 1e-12)?;
    if edge < 2 || edge + 2 >= x.len() {
        return None;
    }
    let rise = (8.0 * (y[edge + 1] - y[edge - 1]) - (y[edge + 2] - y[edge - 2])) / 12.0;
    (rise > 0.0).then(|| plateau * (x[edge + 1] - x[edge]) / rise)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Vec<f64> {
        (-12..=12).map(|i| 0.1 * f64::from(i)).collect()
    }

    /// The edge of the uniform kernel.
    fn edge(x: f64) -> f64 {
        let x = x.clamp(-1.0, 1.0);
        0.25 * (1.0 + x) * (1.0 + x) * (2.0 - x)
    }

    #[test]
    fn falling_neighbours_are_pooled() {
        assert_eq!(rising(&[1.0, 3.0, 2.0, 4.0]), [1.0, 2.5, 2.5, 4.0]);
        assert_eq!(rising(&[3.0, 2.0, 1.0]), [2.0, 2.0, 2.0]);
        assert_eq!(rising(&[1.0, 2.0, 2.0]), [1.0, 2.0, 2.0]);
    }

    #[test]
    fn the_widths_of_a_known_edge() {
        let x = grid();
        let y: Vec<f64> = x.iter().map(|&x| 3.0 * edge(x)).collect();
        // With the step h = 0.1 slopes f' at the points have errors of f''^2 h^2/(4f') + f''' h^2/6 = 0.007; a cubic feels at
        // most 4/27 h of that, which over f' = 0.47 is 2.2e-4 at each crossing.
        assert!((rise_width(&x, &y, 3.0) - 1.216_799_577_4).abs() < 4.4e-4);
        // A cubic's slope is met exactly.
        assert!((equivalent_width(&x, &y, 3.0).unwrap() - 4.0 / 3.0).abs() < 1e-12);
        // A straight rise from -1 to 1.
        let line: Vec<f64> = x.iter().map(|x| 0.5 * (1.0 + x).clamp(0.0, 2.0)).collect();
        assert!((rise_width(&x, &line, 1.0) - 1.6).abs() < 1e-9);
        assert!((equivalent_width(&x, &line, 1.0).unwrap() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn profiles_that_do_not_reach_a_level_end_at_their_ends() {
        let x = grid();
        let flat = vec![0.5; x.len()];
        assert!((rise_width(&x, &flat, 1.0) - 2.4).abs() < 1e-12);
        assert!(equivalent_width(&x, &flat, 1.0).is_none());
        assert!(equivalent_width(&x[..3], &flat[..3], 1.0).is_none());
    }
}
