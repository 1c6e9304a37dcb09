//! The headline sentences of the papers, and what was found of them at equal time.
//!
//! Times are of this machine: they are in words and tables, not in results and claims.

use super::cases::{Medium, Method};
use super::crossing::Pair;
use super::results::Curve;
use crate::harness::{FAMILY_WISE, Table, number};

/// What papers say, in our words: the new method has the smaller error in the same time.
const SENTENCES: [(&str, Method, Method); 4] = [
    (
        "one look-up of the points along a ray beats a march through balls (Jarosz, Zwicker and Jensen 2008)",
        Method::Points,
        Method::Balls,
    ),
    (
        "beams beat points along a ray (Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011)",
        Method::Beams,
        Method::Points,
    ),
    ("planes beat beams (Bitterli and Jarosz 2017)", Method::Planes, Method::Beams),
    (
        "taking the bias out beats living with it (asked of Misso and others 2022)",
        Method::Debiased,
        Method::Beams,
    ),
];

/// All pairs of all sentences and media.
pub fn pairs(curves: &[Curve]) -> Vec<Pair<'_>> {
    let find = |medium, method| curves.iter().find(|c| c.medium == medium && c.method == method);
    let of = |(_, new, old): (&str, Method, Method)| {
        Medium::ALL
            .into_iter()
            .filter_map(move |medium| Some(Pair::new(find(medium, new)?, find(medium, old)?)))
    };
    SENTENCES.into_iter().flat_map(of).collect()
}

/// Upheld where the whole interval says that the new method has the smaller typical error, rejected where it says the larger; all
/// verdicts hold at once with the probability that claims do.
fn verdict(pair: &Pair<'_>, count: usize) -> (String, &'static str) {
    let Some(ratio) = pair.ratio else {
        return match pair.new.rungs.last().zip(pair.old.rungs.first()) {
            Some((new, old)) if new.seconds < old.seconds => {
                ("no time in common: sooner".to_string(), "undecided")
            }
            _ => ("no time in common: later".to_string(), "undecided"),
        };
    };
    let interval = ratio.interval(1.0 - FAMILY_WISE / count as f64);
    let times = |x: f64| number(libm::exp(x));
    let text = format!("{} ({} to {})", times(ratio.value()), times(interval.low), times(interval.high));
    let word = match () {
        () if interval.high < 0.0 => "upheld",
        () if interval.low > 0.0 => "rejected",
        () => "undecided",
    };
    (text, word)
}

/// Where one overtakes the other.
fn crossing(pair: &Pair<'_>) -> String {
    let ahead = |is_new: bool| if is_new { pair.new.method.title() } else { pair.old.method.title() };
    let Some(ratio) = pair.ratio else { return String::new() };
    let is_new = ratio.value() < 0.0;
    let Some((low, high)) = pair.common else {
        return format!("{}, in less time at their most photons", ahead(is_new));
    };
    match pair.crossing {
        Some((at, interval)) => format!(
            "{} from {} s on ({} to {} s; {} % of the samples cross)",
            ahead(is_new),
            number(at),
            number(interval.low),
            number(interval.high),
            number(100.0 * pair.crossed)
        ),
        None => format!("{} from {} to {} s", ahead(is_new), number(low), number(high)),
    }
}

/// The table of all sentences.
pub fn table(pairs: &[Pair<'_>]) -> Table {
    let row = |pair: &Pair<'_>| {
        let sentence = SENTENCES.iter().find(|s| s.1 == pair.new.method && s.2 == pair.old.method);
        let (ratio, word) = verdict(pair, pairs.len());
        vec![
            sentence.map_or(String::new(), |s| s.0.to_string()),
            pair.new.medium.name().to_string(),
            ratio,
            word.to_string(),
            crossing(pair),
        ]
    };
    let columns = ["the papers", "medium", "error over error, equal time", "verdict", "who is ahead"];
    Table {
        caption: "Sentences of the papers against four media: the typical error of the new method over that of the old one in the longest time \
                  that both have errors of (with none in common, of the last of the sooner one and the first of the later one), with the interval in which all of these hold at once; and where one overtakes the other, with the 95 % \
                  interval over samples of the maps. Times are CPU seconds of this machine, of a map and 10,000 rays; no claim rests on them."
            .to_string(),
        columns: columns.map(String::from).to_vec(),
        rows: pairs.iter().map(row).collect(),
    }
}

/// Media as a list; none of none.
fn in_words(media: &[&str]) -> Option<String> {
    let (last, others) = media.split_last()?;
    Some(if others.is_empty() {
        format!("{last} medium")
    } else {
        format!("{} and {last} media", others.join(", "))
    })
}

/// The sentences in words: in which media each is upheld, rejected and undecided.
pub fn summary(pairs: &[Pair<'_>]) -> String {
    let of = |&(sentence, new, old): &(&str, Method, Method)| {
        let own: Vec<(&str, &str)> = pairs
            .iter()
            .filter(|pair| pair.new.method == new && pair.old.method == old)
            .map(|pair| (pair.new.medium.name(), verdict(pair, pairs.len()).1))
            .collect();
        let said = ["upheld", "rejected", "undecided"].into_iter().filter_map(|word| {
            let media: Vec<&str> = own.iter().filter(|o| o.1 == word).map(|o| o.0).collect();
            in_words(&media).map(|media| format!("{word} in the {media}"))
        });
        let said: Vec<String> = said.collect();
        format!("{sentence}: {}", said.join(", "))
    };
    let all: Vec<String> = SENTENCES.iter().map(of).collect();
    format!(
        "At equal time (CPU, a map and 10,000 rays, light scattered twice and more, typical errors), the sentences of the papers: {}.",
        all.join("; ")
    )
}
