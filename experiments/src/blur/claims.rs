//! The claims. Widths are of the mean profile, jackknifed over maps. Equivalent widths, and kernels at equal standard
//! deviation, say the same again with more noise: they are in the tables and results, without a verdict.

use super::cases::{KERNELS_AT, KERNELS_K, NEIGHBORS};
use super::results::{CaseResult, Transfer, find, find_at, largest};
use crate::harness::{Claim, Estimate, GEOMETRIC, LEFT_OVER, PREDICTED, Unit, number};
use crate::setups::Size;
use turbid::estimators::Kernel;
use turbid::stats::{Moments, amplitude_per_map};
use turbid_analytic::edge::Edge;
use turbid_analytic::kernel as referee;

/// All claims of the experiment.
pub fn all(results: &[CaseResult], transfers: &[Transfer]) -> anyhow::Result<Vec<Claim>> {
    let mut claims = radius_claims(results);
    claims.extend(kernel_claims(results));
    claims.extend(nearest_claims(results));
    claims.extend(number_claims(results));
    claims.extend(half_claim(results));
    claims.extend(left_over_claims(results));
    claims.extend(mistaken_law_claim(results)?);
    claims.extend(mistaken_width_claim(results));
    claims.extend(wave_claims(transfers));
    Ok(claims)
}

/// Measured over predicted 10-90 width.
fn rise_claim(id: &str, text: &str, result: Option<&CaseResult>) -> Option<Claim> {
    let result = result?;
    let ratio = result.rise.times(1.0 / result.theory.rise_probed);
    let text = format!("10-90 width, {text}: measured over predicted");
    Some(Claim::about(id, &text, Unit::ONE, ratio, 1.0, GEOMETRIC))
}

fn radius_claims(results: &[CaseResult]) -> Vec<Claim> {
    let one = |radius: f64| {
        let result = find(results, Size::Radius(radius), Kernel::Uniform);
        rise_claim(
            &format!("rise-radius-{radius}"),
            &format!("uniform kernel, fixed radius {radius}"),
            result,
        )
    };
    [0.2, 0.4].into_iter().filter_map(one).collect()
}

/// Other kernels, at the same radius and the same k; the Gaussian one's mass is narrow, and its width noisy.
fn kernel_claims(results: &[CaseResult]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for kernel in Kernel::ALL.into_iter().filter(|k| !matches!(k, Kernel::Uniform | Kernel::Gaussian)) {
        let name = kernel.name();
        for (size, how, text) in [
            (Size::Radius(KERNELS_AT), "radius", format!("fixed radius {KERNELS_AT}")),
            (Size::Nearest(KERNELS_K), "nearest", format!("{KERNELS_K} nearest")),
        ] {
            let result = find(results, size, kernel);
            claims.extend(rise_claim(
                &format!("rise-{name}-{how}"),
                &format!("{name} kernel, {text}"),
                result,
            ));
        }
    }
    claims
}

fn nearest_claims(results: &[CaseResult]) -> Vec<Claim> {
    let one = |k: usize| {
        let result = find(results, Size::Nearest(k), Kernel::Uniform);
        rise_claim(&format!("rise-k-{k}"), &format!("uniform kernel, {k} nearest"), result)
    };
    NEIGHBORS.into_iter().filter_map(one).collect()
}

/// At fixed k the edge narrows as the root of third degree of the photons; at a fixed radius it stays.
fn number_claims(results: &[CaseResult]) -> Vec<Claim> {
    let most = largest(results);
    let fewest = results.iter().map(|r| r.case.photons).min().unwrap_or(0);
    let mut claims = Vec::new();
    for (size, name) in [(Size::Nearest(20), "20 nearest"), (Size::Radius(0.4), "fixed radius 0.4")] {
        let find = |photons| find_at(results, photons, size, Kernel::Uniform);
        let (Some(few), Some(many)) = (find(fewest), find(most)) else { continue };
        let predicted = few.theory.rise_probed / many.theory.rise_probed;
        let ratio = few.rise.times(1.0 / (many.rise.value() * predicted));
        // The maps of the two numbers share nothing.
        let ratio = ratio.with_reference_error(ratio.value() * many.rise.std_error() / many.rise.value());
        let text = format!(
            "10-90 width, {name}, with {fewest} over {most} photons, measured over predicted ({})",
            number(predicted)
        );
        let id = format!("number-{}", name.replace(' ', "-"));
        claims.push(Claim::about(&id, &text, Unit::ONE, ratio, 1.0, PREDICTED));
    }
    claims
}

/// On the edge the estimate is half the plateau, whatever sets the radius.
fn half_claim(results: &[CaseResult]) -> Option<Claim> {
    let most = largest(results);
    let chosen: Vec<(&CaseResult, usize)> = results
        .iter()
        .filter(|r| r.case.photons == most && r.case.size.is_nearest() && r.case.kernel == Kernel::Uniform)
        .filter_map(|r| Some((r, r.case.places().iter().position(|p| p.abs() < 1e-9)?)))
        .collect();
    let maps = chosen.first()?.0.single.n() as usize;
    let mean = |m: usize| {
        chosen.iter().map(|(r, i)| r.profile[*i][m] / r.theory.plateau).sum::<f64>() / chosen.len() as f64
    };
    let moments: Moments = (0..maps).map(mean).collect::<Vec<f64>>().iter().collect();
    // A little more than half: the ball on the edge is larger, and the decay along the shaft lifts what it sees.
    let predicted = chosen.iter().map(|(r, i)| r.theory.profile[*i].0 / r.theory.plateau).sum::<f64>()
        / chosen.len() as f64;
    let text =
        format!("k nearest, all k: estimate on the edge over the plateau (predicted {})", number(predicted));
    Some(Claim::within("half-on-the-edge", &text, Unit::ONE, Estimate::mean(&moments), 0.49, 0.51))
}

/// Mean of what the predictions leave of all places of all profiles.
fn left_over_claims(results: &[CaseResult]) -> Vec<Claim> {
    let most = largest(results);
    let mut claims = Vec::new();
    for (is_nearest, name) in [(false, "fixed radius"), (true, "k nearest")] {
        let chosen: Vec<&CaseResult> = results
            .iter()
            .filter(|r| r.case.photons == most && r.case.size.is_nearest() == is_nearest)
            .collect();
        let Some(first) = chosen.first() else { continue };
        let places: usize = chosen.iter().map(|r| r.profile.len()).sum();
        let left = |m: usize| {
            let one = |r: &&CaseResult| {
                r.profile.iter().zip(&r.theory.profile).map(|(maps, t)| maps[m] - t.0).sum::<f64>()
            };
            chosen.iter().map(one).sum::<f64>() / places as f64
        };
        let moments: Moments =
            (0..first.single.n() as usize).map(left).collect::<Vec<f64>>().iter().collect();
        claims.push(Claim::about(
            &format!("left-over-{}", name.replace(' ', "-")),
            &format!("{name}, all places of all profiles: what the prediction leaves, of the fluence inside"),
            Unit::FRACTION,
            Estimate::mean(&moments),
            0.0,
            LEFT_OVER,
        ));
    }
    claims
}

/// A wrong law: the fixed radius's width at the radius of k photons in full light.
fn mistaken_law_claim(results: &[CaseResult]) -> anyhow::Result<Option<Claim>> {
    let Some(result) = find(results, Size::Nearest(50), Kernel::Uniform) else { return Ok(None) };
    let radius = result.case.scale();
    let wrong = radius * Edge::new(referee::Kernel::Uniform, radius)?.rise_width()?.value;
    let text =
        "wrong on purpose, the fixed radius's law for the 50 nearest: measured over so predicted 10-90 width";
    let ratio = result.rise.times(1.0 / wrong);
    Ok(Some(Claim::detected("nearest-by-the-law-of-the-radius", text, Unit::ONE, ratio, 1.0, 0.4)))
}

/// A wrong statistic: the mean width of single maps' profiles.
///
/// Gather and margin were chosen after a trial run (seed 1), in which radius 0.2 differed by 5 per cent but was too noisy for
/// a margin of 3; seeds 3 to 6, looked at after the choice, uphold it too.
fn mistaken_width_claim(results: &[CaseResult]) -> Option<Claim> {
    let fewest = results.iter().map(|r| r.case.photons).min()?;
    let result = find_at(results, fewest, Size::Nearest(20), Kernel::Uniform)?;
    let text = format!(
        "wrong on purpose, the width of each map's own profile, {fewest} photons, 20 nearest: mean over predicted"
    );
    let ratio = Estimate::mean(&result.single).times(1.0 / result.theory.rise_probed);
    let claim = Claim::detected("width-of-single-maps", &text, Unit::ONE, ratio, 1.0, 0.01);
    Some(claim.chosen_after("case and difference", &[1, 3, 4, 5, 6]))
}

/// Contrasts of a sinusoid.
fn wave_claims(transfers: &[Transfer]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for kernel in Kernel::ALL {
        let chosen: Vec<&Transfer> = transfers.iter().filter(|t| t.kernel == kernel).collect();
        let Some(maps) = chosen.first().map(|t| t.maps.len()) else { continue };
        let predicted: Vec<f64> = chosen.iter().map(|t| t.predicted).collect();
        let weights: Vec<f64> =
            chosen.iter().map(|t| 1.0 / t.maps.iter().collect::<Moments>().variance()).collect();
        let per_map: Vec<Vec<f64>> = (0..maps).map(|m| chosen.iter().map(|t| t.maps[m]).collect()).collect();
        let text = format!(
            "contrast left of a sinusoid, {} kernel, all radii: measured over predicted",
            kernel.name()
        );
        claims.extend(amplitude_per_map(&predicted, &per_map, &weights).map(|a| {
            let id = format!("contrast-{}", kernel.name());
            Claim::about(&id, &text, Unit::ONE, Estimate::mean(&a.moments), 1.0, GEOMETRIC)
        }));
    }
    let reversed = transfers.iter().find(|t| t.kernel == Kernel::Uniform && t.radius == 0.9);
    claims.extend(reversed.map(|t| {
        let text = format!(
            "uniform kernel, radius 0.9 wavelengths: light and dark change places, contrast (predicted {})",
            number(t.predicted)
        );
        let contrast: Moments = t.maps.iter().collect();
        Claim::at_most("contrast-reversed", &text, Unit::ONE, Estimate::mean(&contrast), -0.07)
    }));
    claims
}
