//! The summary and the notes.

use super::cases::{FIELDS, Field, MODERATE, SPHERE, THICK, THIN, Treatment};
use super::choose::{Currency, best_over_best, break_even, cheapest, guided_rays, most_efficient};
use super::data::{Data, mean};
use super::tables::{best_error, off};
use crate::harness::{Estimate, percent, with_error};
use crate::prediction::Entry;
use turbid::stats::Moments;

fn even(data: &Data, field: &Field, currency: Currency) -> Option<Estimate> {
    let chosen = most_efficient(&data.of(field, Treatment::Clipped, None))?;
    break_even(chosen.case, data.paths(field)?, currency).queries
}

/// The break-even in both currencies, and the error at which.
fn both(data: &Data, field: &Field) -> Option<String> {
    let chosen = most_efficient(&data.of(field, Treatment::Clipped, None))?;
    let text = |currency| {
        even(data, field, currency).map_or("never".to_string(), |q| {
            format!("from {} queries on", with_error(q.value(), q.std_error()))
        })
    };
    Some(format!(
        "{} in operations and {} in seconds of this machine, at an error of {:.0} %",
        text(Currency::Operations),
        text(Currency::Seconds),
        percent(chosen.rms.value())
    ))
}

/// The summary.
pub fn summary(data: &Data) -> Vec<String> {
    let mut paragraphs = Vec::new();
    let (thin, thick, sphere) = (&THIN, &THICK, &SPHERE);
    if let (Some(plain), Some(clipped), Some(in_thin), Some(in_thick), Some(in_sphere)) = (
        best_error(data, thin, Treatment::Plain),
        best_error(data, thin, Treatment::Clipped),
        both(data, thin),
        both(data, thick),
        both(data, sphere),
    ) {
        paragraphs.push(format!(
            "Against a path tracer of the same error a photon map pays for itself, in thick isotropic fog, {in_thick}; \
             in thin, {in_thin}; in an emitting sphere, {in_sphere}, where an operation is a ray or a photon gathered, each as one. Near a face the plain \
             estimate is stuck: in the thin slab the best of the gathers tried errs by ({}) %, where dividing by the \
             part of the ball inside the fog leaves ({}) %.",
            plain.in_percent(),
            clipped.in_percent()
        ));
    }
    let clipping: Vec<String> = [thin, &MODERATE, thick]
        .into_iter()
        .map(|field| {
            let of = |treatment| data.of(field, treatment, Some(data.largest(field)));
            let ratio = best_over_best(&of(Treatment::Clipped), &of(Treatment::Plain));
            format!("{:.2} ({})", ratio.value(), field.title)
        })
        .collect();
    let reaches = |field: &Field, target: f64| {
        Treatment::ALL
            .iter()
            .any(|&t| cheapest(&data.of(field, t, None), target, |m| m.cost(4096.0)).is_some())
    };
    let reached = |target| FIELDS.into_iter().filter(|field| reaches(field, target)).count();
    paragraphs.push(format!(
        "What limits a gather changes from scene to scene. At the largest maps the best clipped gather has {} times \
         the error of the best plain one: clipping is the first thing to do where faces are near, and changes little \
         in thick fog. Some setting reaches 10 per cent in {} of {} fields, 3 per cent in {} and 1 per cent in {}; theory \
         says what reaches it elsewhere. Of {} measured errors {} are more than 4 standard errors from theory's; a table lists them.",
        clipping.join(", "),
        reached(0.1),
        FIELDS.len(),
        reached(0.03),
        reached(0.01),
        data.measured.len(),
        off(data).len()
    ));
    paragraphs.push(ADVICE.to_string());
    paragraphs
}

/// How to choose, for one's own scene.
const ADVICE: &str = "How to choose k and r. Let n be the photons stored per volume at the place, l the length over \
    which the light bends (l² is the fluence over its Laplacian), s the scattering coefficient. A gather of radius r \
    errs by the blur r²/(10 l²), by the noise sqrt((1 + 1.5 s r)/(4.19 n r³)), the second part of the bracket being the \
    photons of one history that lie together, and, if it is plain and a face is nearer than r, by up to half. First \
    clip, or keep r below the distance to the face. Then balance: the error is least near r⁷ = 18 l⁴/n, where the \
    noise is 1.15 times the blur, and k = 4.19 n r³ is the number that such a ball holds. A tenth of the error takes 10^3.5, \
    about 3000 times the photons at the best radius, and r shrinks to a third. If noise is all, as in thick fog \
    far from faces and lamps, take a larger k, not more photons: 50 or 100 neighbours cannot err by less than 14 or 10 \
    per cent, however many photons there are. If the question is asked at fewer points than the break-even, trace paths.";

/// The notes.
pub fn notes(budget: &[Entry], data: &Data) -> Vec<String> {
    let (entries, rms, largest) = left_over(budget);
    let mut notes = vec![
        format!(
            "{entries} layers of settings enter the error budget of the study: all fixed radii, and k nearest where what \
             is not known of the clusters' part is below a fifth of the expected standard error. Their mean errors less \
             the predicted ones have a root mean square of {rms:.2} standard errors and are at most {largest:.1}. All \
             gathers of one map share its photons, so that there are only {} independent sets, and a set with a few \
             photons more than expected is off in all its layers alike.",
            data.sizes.len()
        ),
        "Each operation counts as one: a ray followed, a record put into the tree, a photon gathered. On real machines \
         a photon gathered is much cheaper than a ray, and the search for the k nearest costs more than the photons \
         it sums; the table in seconds weighs them as one machine does."
            .to_string(),
        "Noise is predicted from Poisson's law times 1 + eta, eta the other photons of a history in a photon's ball; k \
         photons set the radius like k/(1 + eta) independent ones, which is seen at k = 10 and 20. Eta \
         counts all orders of an unbounded medium, with the photons that leave the ball and come back; \
         where a face cuts the ball it is scaled with the mean chord."
            .to_string(),
        "The map holds all light, the uncollided beam included, as its probes ask for all. A renderer that adds the \
         uncollided part in closed form, as the path tracer here does and Jensen and Christensen (1998) advise, would have less noise and \
         blur from the same photons, most of all in thin fog."
            .to_string(),
        "The thick slabs have an albedo of 0.99, the others 0.9: at 0.9 hardly a photon in a hundred would reach the \
         far side of eight mean free paths, and the relative error there would drown all else."
            .to_string(),
        "Relative errors of the layers nearest the faces weigh as much as all others. The probes' outermost layers lie \
         1/32 of the thickness inside: a different layout would have another floor. In the sphere the layers hold equal \
         volumes too, so that half of the probes are nearer to the surface than a fifth of the radius."
            .to_string(),
    ];
    let ratios =
        data.guided.iter().zip(&data.paths).map(|(guided, paths)| guided_rays(&guided.paths, paths).value());
    let (least, most) =
        ratios.fold((f64::INFINITY, 0.0f64), |(low, high), ratio| (low.min(ratio), high.max(ratio)));
    notes.push(format!(
        "Maps are compared with paths that nothing leads. Guided by photons, they take {least:.2} to {most:.2} times the rays to the same \
         error, learning aside, and longer for each: in fog like this light comes from too many sides for directions to gain much, \
         but where it is thin flights are led to collide that would have left. A table has both, and the break-evens are claimed \
         against both. Where guiding pays most, behind glass and under water, the gallery has it as a rival."
    ));
    let never: Vec<&str> = FIELDS
        .into_iter()
        .filter(|field| even(data, field, Currency::Operations).is_none())
        .map(|field| field.title)
        .collect();
    if !never.is_empty() {
        notes.push(format!(
            "There is no break-even in operations in {}: there a sample of the path tracer takes three or four rays and has a \
             relative variance near 0.3, since half of the light is uncollided and known in closed form.",
            never.join(" and ")
        ));
    }
    notes
}

/// Numbers of the budget, for the notes: entries, root mean square of what is left in standard errors, the largest.
fn left_over(entries: &[Entry]) -> (usize, f64, f64) {
    let z = |entry: &Entry| {
        let moments: Moments = entry.maps.iter().collect();
        (moments.mean() - entry.predicted()) / libm::hypot(moments.std_error(), entry.error)
    };
    let scores: Vec<f64> = entries.iter().map(z).collect();
    let squares: Vec<f64> = scores.iter().map(|z| z * z).collect();
    (scores.len(), mean(&squares).sqrt(), scores.iter().map(|z| z.abs()).fold(0.0, f64::max))
}
