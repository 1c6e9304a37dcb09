//! The page: every picture with its reference, its error, its maps and its numbers. It needs nothing from elsewhere.

use super::keep::{MapEstimates, RenderRecord};
use super::pictures::{ALL, Picture};
use super::plates::SCALE;
use super::settings::Settings;
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
.plates { display: grid; grid-template-columns: repeat(auto-fill, minmax(300px, 1fr)); gap: 16px; margin: 16px 0; }
figure { margin: 0; }
img { display: block; width: 100%; height: auto; image-rendering: auto; background: #000; }
figcaption, table, pre, .soft { font-family: system-ui, 'Segoe UI', Arial, 'DejaVu Sans', sans-serif; }
figcaption { font-size: 13.5px; line-height: 1.35; padding-top: 6px; }
.scale { display: flex; justify-content: space-between; height: 20px; margin-top: 4px; padding: 0 4px; border: 1px solid var(--line); font-size: 12.5px; line-height: 18px; }
.sharp { image-rendering: pixelated; }
.verdict { font-weight: 600; }
code { font-size: 13px; overflow-wrap: anywhere; }
.soft { color: var(--soft); font-size: 14.5px; }
table { border-collapse: collapse; font-size: 14px; font-variant-numeric: tabular-nums; margin: 8px 0 16px; }
th { text-align: left; border-bottom: 1.5px solid var(--ink); padding: 4px 16px 4px 0; }
td { border-bottom: 1px solid var(--line); padding: 4px 16px 4px 0; vertical-align: top; }
pre { background: #f5f6f8; border: 1px solid var(--line); border-radius: 4px; padding: 10px 12px; font-size: 13px; white-space: pre-wrap; }
";

/// The page of all pictures that are there.
pub fn page(shown: &[PageEntry], settings: &Settings) -> Markup {
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
                h1 { "The pictures of photon mapping in fog, and what they are worth" }
                p {
                    "Each picture was made as in 1998: photons are stored in maps, and the maps are read along the rays of a "
                    "camera. Beside it stands what a path tracer makes of the same scene in the same CPU time; a reference of many more "
                    "samples that knows no photons; and the difference. Where a row says " em { "the original" } ", photons, "
                    "samples and times are those of the lectures or the paper; everything else is measured here."
                }
                p.soft {
                    "How the verdict is found: what blur and edges do to each pixel is predicted from two other replicates, with up to 8 times as "
                    "many photons, before anything is compared; pixels where they may cost more than 2 per cent are masked, and what was "
                    "predicted for the others is allowed. Outside the mask the means of blocks of 16 by 16 pixels of 64 replicates with maps "
                    "of their own are compared with those of 64 passes of the reference, channel by channel (Holm, family-wise 0.001). Both "
                    "sides of that are computed on half the width and height, where a block is 8 by 8. Blocks of which one side is "
                    "heavy-tailed have no interval, hence no verdict; they are counted. A picture of which a fifth or more "
                    "has no verdict is undecided. Settings that are ours were chosen on runs with other seeds, or for "
                    "a small mask before anything was compared, but where a picture says otherwise."
                }
                p.soft {
                    "Errors are relative to the mean of the picture, lamps that are seen directly left out, which both count alike; "
                    "intervals are of 95 per cent. A small bias remains by the method: the k nearest photons reach farther where there "
                    "are few, so that dark places take light from bright ones beside them and give none back, and discs that are cut "
                    "off at an edge read what lies on the near side of it. It shrinks with k."
                }
                pre { (settings.command()) }
                @for picture in ALL {
                    @if let Some(shown) = shown.iter().find(|s| s.name == picture.name) { (section(picture, shown)) }
                }
                (speed::section(speed::ROWS))
            }
        }
    }
}

fn section(picture: &Picture, shown: &PageEntry) -> Markup {
    html! {
        h2 id=(picture.name) { (picture.title) }
        p { (picture.see) }
        div.plates {
            @for plate in &shown.plates { (figure(plate, shown.size.0)) }
        }
        (numbers(picture, shown))
        p.soft { "The same picture as EXR, by layers:" }
        pre { (shown.command) }
    }
}

fn figure(plate: &Plate, width: usize) -> Markup {
    let is_sharp = ["error", "mask"].contains(&plate.kind.as_str());
    html! {
        figure {
            img class=[is_sharp.then_some("sharp")] src=(plate.file) alt=(plate.caption) width=(width);
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
        table {
            tbody {
                tr { th { "the original" } td { (picture.original) } }
                tr { th { "here" } td {
                    (stored.join(", ")) " photons stored; maps " (duration(ours.map_seconds)) ", picture "
                    (duration(ours.seconds - ours.map_seconds)) " of CPU time for "
                    (shown.size.0) " × " (shown.size.1) " pixels, " (ours.samples) " samples each"
                } }
                tr { th { "photons in an estimate" } td { (estimates(ours)) } }
                @if let Some((paths, seconds)) = shown.reference {
                    tr { th { "reference" } td { (paths) " samples per pixel, " (duration(seconds)) " of CPU time" } }
                }
                @if let Some(compared) = &shown.compared { (comparison(compared)) }
            }
        }
    }
}

/// Photons asked for and found, map by map.
fn estimates(ours: &RenderRecord) -> String {
    let Some(maps) = &ours.estimates else {
        return "found: not measured when this picture was made".to_string();
    };
    let one = |(name, map): (&str, &MapEstimates)| {
        format!(
            "{name} map: {} asked for, {:.0} found on average, {} of the estimates under-full",
            map.asked,
            map.found,
            percent(map.underfull)
        )
    };
    let read = ["global", "caustic", "volume"].into_iter().zip(maps).filter(|(_, map)| map.count > 0);
    read.map(one).collect::<Vec<_>>().join("; ")
}

fn percent(x: f64) -> String {
    let digits = if x.abs() < 0.01 { 2 } else { 1 };
    format!("{:.digits$} %", 100.0 * x)
}

fn between([low, high]: [f64; 2]) -> String {
    format!("{} to {}", percent(low), percent(high))
}

fn comparison(c: &Compared) -> Markup {
    html! {
        tr { th { "RMS error of a pixel" } td {
            "photon maps " (between(c.rms)) "; paths in the same time " (between(c.equal_rms))
        } }
        tr { th { "bias" } td {
            "of the picture's mean " (between(c.bias)) "; of a block of 16 by 16, root mean square, what remains with any number of maps: "
            (between(c.systematic)) " (" (c.replicates) " sets of maps)"
        } }
        tr { th { "verdict" } td {
            span.verdict { (c.verdict) } ": " (c.blocks.1) " of " (c.blocks.0) " block means differ; masked " (percent(c.masked))
            " of the picture, heavy-tailed " (percent(c.heavy)) "; in a typical block a deviation of "
            (percent(c.smallest)) " beyond what was predicted is detectable"
        } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percents_have_the_digits_that_matter() {
        assert_eq!([0.1234, 0.00456, -0.02].map(percent), ["12.3 %", "0.46 %", "-2.0 %"]);
        assert_eq!(between([0.01, 0.02]), "1.0 % to 2.0 %");
    }

    #[test]
    fn the_scale_ends_where_errors_do() {
        let text = scale().into_string();
        assert!(text.contains("−20 %") && text.contains("+20 %") && text.matches("rgb(").count() == 17);
    }
}
