//! The page: every picture beside its rival and its reference, with its error, its maps and its numbers. It needs nothing from
//! elsewhere.

use super::keep::{MapEstimates, RenderRecord};
use super::lines::Stored;
use super::pictures::{ALL, Picture};
use super::plates::SCALE;
use super::print::Printed;
use super::settings::{FROM_PAGE, Settings};
use super::shown::{Compared, PageEntry, Plate};
use super::speed;
use crate::harness::duration;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use turbid_figure::Shading;

const CSS: &str = "
:root { --ink: #1c1f23; --soft: #5b6470; --line: #d5dae0; }
* { box-sizing: border-box; }
body { max-width: 1120px; margin: 0 auto; padding: 40px 24px 80px; color: var(--ink); background: #fff; font: 17px/1.5 Charter, 'Bitstream Charter', Georgia, serif; }
h1 { font-size: 34px; line-height: 1.2; margin: 0 0 10px; font-weight: 600; }
h2 { font-size: 25px; margin: 56px 0 6px; padding-top: 16px; border-top: 2px solid var(--ink); font-weight: 600; }
p { max-width: 46em; margin: 0 0 12px; }
figure { margin: 0; }
img { display: block; width: 100%; height: auto; background: #000; }
figcaption, table, pre, button, .soft, .index { font-family: system-ui, 'Segoe UI', Arial, 'DejaVu Sans', sans-serif; }
figcaption { font-size: 13.5px; line-height: 1.35; padding-top: 6px; }
.index { display: grid; grid-template-columns: repeat(auto-fill, minmax(158px, 1fr)); gap: 16px; margin: 20px 0 32px; padding: 0; list-style: none; font-size: 14px; line-height: 1.35; }
.index a { display: block; color: inherit; text-decoration: none; }
.index a:hover strong, .index a:focus strong { text-decoration: underline; }
.index img { aspect-ratio: 4 / 3; object-fit: cover; margin-bottom: 6px; }
.index strong { display: block; }
.compare { display: grid; grid-template-columns: repeat(auto-fit, minmax(260px, 1fr)); gap: 16px; margin: 16px 0; }
.plates { display: grid; grid-template-columns: repeat(auto-fill, minmax(220px, 1fr)); gap: 16px; margin: 16px 0; }
button { font-size: 15px; padding: 8px 14px; border: 1px solid var(--ink); border-right-width: 0; background: #fff; color: inherit; cursor: pointer; }
button:last-child { border-right-width: 1px; }
button[aria-pressed=true] { background: var(--ink); color: #fff; }
.scale { display: flex; justify-content: space-between; height: 20px; margin-top: 4px; padding: 0 4px; border: 1px solid var(--line); font-size: 12.5px; line-height: 18px; }
.sharp { image-rendering: pixelated; }
.outcome { font-weight: 600; }
code { font-size: 13px; overflow-wrap: anywhere; }
.soft { color: var(--soft); font-size: 14.5px; }
table { border-collapse: collapse; font-size: 14px; font-variant-numeric: tabular-nums; margin: 8px 0 16px; }
th { text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); padding: 4px 16px 4px 0; }
td { border-bottom: 1px solid var(--line); padding: 4px 16px 4px 0; vertical-align: top; }
pre { background: #f5f6f8; border: 1px solid var(--line); border-radius: 4px; padding: 10px 12px; font-size: 13px; white-space: pre-wrap; overflow-wrap: anywhere; }
@media screen {
  .compare.one { display: block; max-width: var(--width); }
  .compare.one figure:not(.on) { display: none; }
}
@media (max-width: 560px) {
  body { padding: 20px 14px 48px; font-size: 16px; }
  h1 { font-size: 26px; }
  .index { grid-template-columns: 1fr 1fr; gap: 12px; }
  .toggle { display: flex; }
  .toggle[hidden] { display: none; }
  button { flex: 1; padding: 8px 4px; font-size: 14px; }
  .rows tr, .rows th, .rows td { display: block; }
  .rows th { border-bottom: 0; padding: 6px 0 0; }
  .rows td { padding: 0 0 6px; }
}
@media print {
  body { max-width: none; padding: 0; font-size: 11pt; }
  .toggle { display: none; }
  h2 { break-after: avoid; }
  figure, tr { break-inside: avoid; }
  .compare { grid-template-columns: repeat(3, 1fr); }
}
";

/// Shows one of a picture's three renders at a time, larger; without it all three are shown.
const SCRIPT: &str = "
for (const box of document.querySelectorAll('.compare')) {
  const bar = box.previousElementSibling, buttons = [...bar.children], figures = [...box.children];
  const show = n => {
    figures.forEach((figure, i) => figure.classList.toggle('on', i === n));
    buttons.forEach((button, i) => button.setAttribute('aria-pressed', i === n));
  };
  buttons.forEach((button, i) => button.addEventListener('click', () => show(i)));
  bar.hidden = figures.length < 2;
  box.classList.add('one');
  show(0);
}
";

/// Longer side of the large picture, at most \[CSS pixels\].
const LARGE: f64 = 720.0;

/// The renders of a picture that are compared by eye: the kind of its plate, and its button.
const RENDERS: [(&str, &str); 6] = [
    ("photons", "Photon map"),
    ("rays", "Along rays, equal time"),
    ("beams", "Beams, equal time"),
    ("planes", "Planes, equal time"),
    ("rival", "Rival, equal time"),
    ("reference", "Reference"),
];

/// The page of all pictures that are there.
pub fn page(shown: &[PageEntry], printed: &[(&str, Printed)], settings: &Settings) -> Markup {
    let entries: Vec<(&Picture, &PageEntry)> = ALL
        .iter()
        .filter_map(|picture| Some((picture, shown.iter().find(|s| s.name == picture.name)?)))
        .collect();
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "turbid: the gallery" }
                style { (PreEscaped(CSS)) }
            }
            body {
                h1 { "The pictures of photon mapping in participating media, and what they are worth" }
                ul.index { @for (picture, shown) in &entries { li { (thumbnail(picture, shown)) } } }
                (method(settings))
                @for (picture, shown) in &entries {
                    (section(picture, shown, printed.iter().find(|(name, _)| *name == picture.name).map(|(_, printed)| printed)))
                }
                (speed::section(&speed::rows()))
                script { (PreEscaped(SCRIPT)) }
            }
        }
    }
}

fn thumbnail(picture: &Picture, shown: &PageEntry) -> Markup {
    html! {
        a href=(format!("#{}", picture.name)) {
            @if let Some(plate) = shown.plates.iter().find(|plate| plate.kind == "photons") {
                img src=(plate.file) alt="" loading="lazy";
            }
            strong { (picture.title) }
            @if let Some(c) = &shown.compared { (winner(c)) }
        }
    }
}

fn method(settings: &Settings) -> Markup {
    html! {
        p {
            "Each picture was made as in 1998: photons are stored in maps, and the maps are read along the rays of a "
            "camera, in steps that shorten where the light changes (in the cloud they are equal). Beside it stand its rival, the best that a method without photon maps makes "
            "of the same scene in the same CPU time; a reference of many more samples without photon maps; and the difference. Where a row "
            "says " em { "the original" } ", photons, samples and times are those of the lectures or the paper; everything else is "
            "measured here."
        }
        p {
            "Paths from the eye and light tracing, photons connected to the camera from where they scatter, race for "
            "the place of the rival wherever the scene permits both, and where there are specular bodies guided paths too, whose directions follow where 200,000 "
            "photons came from; the one with the smaller error is shown. In light tracing too, paths find lamps "
            "and what is seen by mirrors and through glass."
        }
        p {
            "Of some pictures the light in the medium was read along whole rays as well, from points within a radius of the ray and from "
            "photons' flights, stored as beams: in the same CPU time as the picture of 1998 took, as the mean over maps one after the other, "
            "each of its own photons, with radii that shrink. Light that comes straight from a lamp and is scattered once is found by shadow "
            "rays there too. In the grey fog what media scatter twice and more comes from planes as well, which pairs of flights span, "
            "without blur; light from the walls comes by beams there. The cognac only absorbs: there is nothing along its rays to be read."
        }
        p.soft {
            "How the verdict is found: what blur and edges do to each pixel is predicted from two other replicates, with up to 8 times as "
            "many photons, before anything is compared; pixels where they may cost more than 2 per cent are masked, and what was "
            "predicted for the others is allowed. Outside the mask the means of blocks of 16 by 16 pixels of 64 replicates with maps "
            "of their own are compared with those of 64 passes of the reference, channel by channel (Holm, family-wise 0.001). Both "
            "sides of that are computed on half the width and height, where a block is 8 by 8. Blocks without light are left out, and shares are "
            "of the pixels that scatter light. Blocks of which one side is "
            "heavy-tailed have no interval, hence no verdict; they are counted. A picture of which a fifth or more "
            "has no verdict, or in which a deviation of 10 per cent would not be detected in a typical block, is undecided. Settings that are ours were chosen for a small mask, for the number of "
            "photons found, or on runs with other seeds, before anything was compared."
        }
        p.soft {
            "Errors are root mean squares over pixels, relative to the mean of the picture, lamps that are seen directly left out, which "
            "all methods count alike; intervals are of 95 per cent. A small bias remains by the method: the k nearest photons reach farther where there "
            "are few, so that dark places take light from bright ones beside them and give none back, and discs that are cut "
            "off at an edge read what lies on the near side of it. It shrinks with k. An estimate is under-full where it finds fewer photons than "
            "it asks for within its largest radius."
        }
        pre { (settings.command()) }
    }
}

fn section(picture: &Picture, shown: &PageEntry, printed: Option<&Printed>) -> Markup {
    let of = |kind: &str| shown.plates.iter().find(|plate| plate.kind == kind);
    let renders: Vec<(&Plate, &str)> =
        RENDERS.iter().filter_map(|(kind, button)| Some((of(kind)?, *button))).collect();
    let others = shown.plates.iter().filter(|plate| renders.iter().all(|(render, _)| render != plate));
    let (width, height) = shown.size;
    let large = LARGE * (width as f64 / height.max(1) as f64).min(1.0);
    html! {
        h2 id=(picture.name) { (picture.title) }
        p { (picture.see) }
        div.toggle hidden role="group" aria-label="Which picture" {
            @for (_, button) in &renders { button type="button" { (button) } }
        }
        div.compare style=(format!("--width: {large:.0}px")) {
            @for (plate, _) in &renders { (figure(plate, shown.size)) }
        }
        @if let Some(compared) = &shown.compared { p.outcome { (winner(compared)) } }
        (numbers(picture, shown))
        div.plates { @for plate in others { (figure(plate, shown.size)) } }
        @if let Some(printed) = printed { (links(picture, printed)) }
        p.soft { "The same picture as EXR, by layers:" }
        pre { (shown.command) }
    }
}

/// Where the pictures at the size of print are, and how they were made.
fn links(picture: &Picture, printed: &Printed) -> Markup {
    let link = |kind: &str, text: &str| {
        html! { a href=(format!("{FROM_PAGE}/{}-{kind}.png", picture.name)) { (text) } }
    };
    let told =
        |facts: &RenderRecord| format!("{} samples per pixel, {}", facts.samples, duration(facts.seconds));
    html! {
        p.soft {
            (printed.size.0) " pixels wide, in the same CPU time each: " (link("photons", "photon maps")) " (" (told(&printed.ours)) "), "
            @for (kind, _) in &printed.along {
                @if let Some(stored) = Stored::ALL.iter().find(|stored| stored.kind() == kind) {
                    (link(kind, stored.name())) ", "
                }
            }
            (link("rival", &printed.rival)) " (" (told(&printed.equal)) "); " (link("reference", "reference")) " ("
            @if let Some(by) = &printed.by { "by " (by) ", " }
            (printed.reference.0) " samples per pixel, " (duration(printed.reference.1)) ")."
        }
    }
}

fn figure(plate: &Plate, (width, height): (usize, usize)) -> Markup {
    let is_sharp = ["error", "mask"].contains(&plate.kind.as_str());
    html! {
        figure {
            img class=[is_sharp.then_some("sharp")] src=(plate.file) alt=(plate.caption) width=(width) height=(height);
            @if plate.kind == "error" { (scale()) }
            figcaption { (plate.caption) "." }
        }
    }
}

/// The colours of relative errors, with their numbers.
fn scale() -> Markup {
    const STOPS: u32 = 16;
    let stop = |n: u32| {
        let (r, g, b) = Shading::Diverging.rgb(f64::from(n) / f64::from(STOPS));
        format!("rgb({r},{g},{b})")
    };
    let colors: Vec<String> = (0..=STOPS).map(stop).collect();
    let end = format!("{:.0} %", 100.0 * SCALE);
    html! {
        div.scale style=(format!("background: linear-gradient(to right, {})", colors.join(", "))) {
            span style="color: #fff" { "−" (end) } span { "0" } span style="color: #fff" { "+" (end) }
        }
    }
}

fn numbers(picture: &Picture, shown: &PageEntry) -> Markup {
    let ours = &shown.ours;
    let [global, caustic, volume] = ours.stored;
    let stored: Vec<String> = [("global", global), ("caustic", caustic), ("volume", volume)]
        .iter()
        .filter(|(_, n)| *n > 1)
        .map(|(name, n)| format!("{n} {name}"))
        .collect();
    html! {
        table.rows {
            tbody {
                @if let Some(c) = &shown.compared { (errors(c)) }
                tr { th { "photons in an estimate" } td { (estimates(ours)) } }
                @if let Some(c) = &shown.compared { (verdict(c)) }
                tr { th { "the original" } td { (picture.original) } }
                tr { th { "here" } td {
                    (stored.join(", ")) " photons stored; maps " (duration(ours.map_seconds)) ", picture "
                    (duration(ours.seconds - ours.map_seconds)) " of CPU time for "
                    (shown.size.0) " × " (shown.size.1) " pixels, " (ours.samples) " samples each"
                } }
                @if let Some((samples, seconds)) = shown.reference {
                    tr { th { "reference" } td { (samples) " samples per pixel, " (duration(seconds)) " of CPU time" } }
                }
            }
        }
    }
}

/// Photons asked for and found, map by map.
fn estimates(ours: &RenderRecord) -> String {
    let one = |(name, map): (&str, &MapEstimates)| {
        let (asked, found, underfull) = (map.asked, map.found, percent(map.underfull));
        format!(
            "{name} map: {asked} asked for, {found:.1} found on average, {underfull} of the estimates under-full"
        )
    };
    let all =
        ["global", "caustic", "volume"].into_iter().zip(ours.estimates.iter().flatten()).zip(ours.stored);
    let read = all.filter(|((_, map), stored)| map.count > 0 && *stored > 1).map(|(map, _)| map);
    read.map(one).collect::<Vec<_>>().join("; ")
}

/// Two significant digits.
fn two_digits(x: f64) -> String {
    let text = format!("{x:.1e}");
    let exponent = text.split_once('e').and_then(|(_, e)| e.parse::<i32>().ok()).unwrap_or(0);
    let decimals = if x == 0.0 { 0 } else { (1 - exponent).max(0) as usize };
    format!("{:.decimals$}", text.parse().unwrap_or(x))
}

fn percent(x: f64) -> String {
    format!("{}\u{a0}%", two_digits(100.0 * x))
}

fn between([low, high]: [f64; 2]) -> String {
    format!("{} to {}", percent(low), percent(high))
}

fn middle([low, high]: [f64; 2]) -> f64 {
    0.5 * (low + high)
}

/// Errors that differ by less are called level: by so much two runs differ in their times.
const LEVEL: f64 = 1.05;

/// Who has the smaller error at equal time, in a sentence.
fn winner(c: &Compared) -> String {
    let (ours, theirs) = (middle(c.rms), middle(c.equal_rms));
    let errors = format!("{} against {} at equal time", percent(ours), percent(theirs));
    let factor = (theirs / ours).max(ours / theirs);
    if c.rms[0] <= c.equal_rms[1] && c.equal_rms[0] <= c.rms[1] || factor < LEVEL {
        return format!("The photon map and {} are level: an error of {errors}.", c.rival);
    }
    let factor = two_digits(factor);
    if ours < theirs {
        return format!(
            "The photon map wins by a factor of {factor} over {}: an error of {errors}.",
            c.rival
        );
    }
    let (first, rest) = c.rival.split_at(1);
    let is_plural = ["paths", "guided paths"].iter().any(|plural| c.rival.starts_with(plural));
    let wins = if is_plural { "win" } else { "wins" };
    format!(
        "{}{rest} {wins} by a factor of {factor}: the photon map has an error of {errors}.",
        first.to_uppercase()
    )
}

fn errors(c: &Compared) -> Markup {
    html! {
        tr { th { "RMS error of a pixel" } td { "photon map " (between(c.rms)) } }
        tr { th { "at equal time" } td {
            (c.rival) " " (between(c.equal_rms))
            @for (name, rms) in &c.beaten { "; beaten: " (name) " " (between(*rms)) }
        } }
        @if !c.along.is_empty() {
            tr { th { "along whole rays, at equal time" } td {
                @for (n, (name, rms)) in c.along.iter().enumerate() { @if n > 0 { "; " } (name) " " (between(*rms)) }
            } }
        }
        tr { th { "bias" } td {
            "of the picture's mean " (between(c.bias)) "; of a block of 16 by 16, root mean square, what remains with any number of maps: "
            (between(c.systematic)) " (" (c.replicates) " sets of maps)"
        } }
    }
}

fn verdict(c: &Compared) -> Markup {
    html! {
        tr { th { "verdict" } td {
            span.outcome { (c.verdict) } ": " (c.blocks.1) " of " (c.blocks.0) " block means differ; masked " (percent(c.masked))
            " of what scatters light, heavy-tailed " (percent(c.heavy)) "; in a typical block a deviation of "
            (percent(c.smallest)) " beyond what was predicted is detectable"
        } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_two_digits() {
        let texts = [0.1234, 0.00456, -0.02, 0.0996, 25.8, 0.0].map(|x| percent(x).replace('\u{a0}', " "));
        assert_eq!(texts, ["12 %", "0.46 %", "-2.0 %", "10 %", "2600 %", "0 %"]);
        assert_eq!(between([0.01, 0.02]), "1.0\u{a0}% to 2.0\u{a0}%");
    }

    #[test]
    fn the_scale_ends_where_errors_do() {
        let text = scale().into_string();
        assert!(text.contains("−20 %") && text.contains("+20 %") && text.matches("rgb(").count() == 17);
    }

    fn compared(rms: [f64; 2], equal_rms: [f64; 2], rival: &str) -> Compared {
        let text = serde_json::json!({
            "replicates": 64, "rms": rms, "systematic": [0.0, 0.1], "bias": [0.0, 0.1], "equal_rms": equal_rms,
            "rival": rival, "verdict": "agrees with its reference", "blocks": [9, 0], "masked": 0.1, "heavy": 0.0,
            "smallest": 0.05
        });
        serde_json::from_value(text).unwrap()
    }

    /// The winner is named with the factor; intervals that overlap have none.
    #[test]
    fn the_sentence_names_who_wins() {
        let winner = |c: &Compared| winner(c).replace('\u{a0}', " ");
        let wins = winner(&compared([0.09, 0.11], [0.19, 0.21], "light tracing"));
        assert_eq!(
            wins,
            "The photon map wins by a factor of 2.0 over light tracing: an error of 10 % against 20 % at equal time."
        );
        let loses = winner(&compared([0.29, 0.31], [0.19, 0.21], "paths"));
        assert_eq!(
            loses,
            "Paths win by a factor of 1.5: the photon map has an error of 30 % against 20 % at equal time."
        );
        let level = winner(&compared([0.09, 0.11], [0.10, 0.12], "paths"));
        assert!(level.starts_with("The photon map and paths are level"), "{level}");
        assert_eq!(compared([0.1; 2], [0.1; 2], "paths").beaten, []);
    }
}
