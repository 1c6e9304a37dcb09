//! The page: every picture with its twin, its error, its maps and its numbers. It needs nothing from elsewhere.

use super::pictures::{ALL, Picture};
use super::settings::Settings;
use super::shown::{Compared, Shown};
use crate::harness::duration;
use maud::{DOCTYPE, Markup, PreEscaped, html};

const CSS: &str = "
:root { --ink: #1c1f23; --soft: #5b6470; --line: #d5dae0; }
* { box-sizing: border-box; }
body { max-width: 1120px; margin: 0 auto; padding: 40px 24px 80px; color: var(--ink); background: #fff; font: 17px/1.5 Charter, 'Bitstream Charter', Georgia, serif; }
h1 { font-size: 34px; line-height: 1.2; margin: 0 0 10px; font-weight: 600; }
h2 { font-size: 25px; margin: 56px 0 6px; padding-top: 16px; border-top: 2px solid var(--ink); font-weight: 600; }
p { max-width: 46em; margin: 0 0 12px; }
.plates { display: flex; flex-wrap: wrap; gap: 16px; margin: 16px 0; }
figure { margin: 0; flex: 1 1 300px; max-width: 400px; }
figure.main { flex-basis: 400px; }
img { display: block; width: 100%; height: auto; image-rendering: auto; background: #000; }
figcaption, table, pre, .soft { font-family: system-ui, 'Segoe UI', Arial, 'DejaVu Sans', sans-serif; }
figcaption { font-size: 13.5px; line-height: 1.35; padding-top: 6px; }
.soft { color: var(--soft); font-size: 14.5px; }
table { border-collapse: collapse; font-size: 14px; font-variant-numeric: tabular-nums; margin: 8px 0 16px; }
th { text-align: left; border-bottom: 1.5px solid var(--ink); padding: 4px 16px 4px 0; }
td { border-bottom: 1px solid var(--line); padding: 4px 16px 4px 0; vertical-align: top; }
pre { background: #f5f6f8; border: 1px solid var(--line); border-radius: 4px; padding: 10px 12px; font-size: 13px; white-space: pre-wrap; }
";

/// The page of all pictures that are there.
pub fn page(shown: &[Shown], settings: &Settings) -> Markup {
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
                    "camera. Beside it stands what a path tracer makes of the same scene in the same CPU time, a converged twin "
                    "that knows no photons, and the difference. Errors are relative to the mean of the picture, lamps that are seen "
                    "directly left out, which both count alike; intervals are of 95 per cent."
                }
                p.soft {
                    "Blur and edges are predicted from a making with more photons before anything is compared; pixels where they may exceed 2 per "
                    "cent are masked, and what was predicted for the others is allowed. Outside the mask the means of blocks of 16 by 16 pixels are compared, "
                    "channel by channel, with errors from independent maps (Holm, family-wise 0.001)."
                }
                pre { (settings.command()) }
                @for picture in ALL {
                    @if let Some(shown) = shown.iter().find(|s| s.name == picture.name) { (section(picture, shown)) }
                }
            }
        }
    }
}

fn section(picture: &Picture, shown: &Shown) -> Markup {
    html! {
        h2 id=(picture.name) { (picture.title) }
        p { (picture.see) }
        div.plates {
            @for plate in &shown.plates {
                figure {
                    img src=(plate.file) alt=(plate.caption) width=(shown.size.0);
                    figcaption { (plate.caption) "." }
                }
            }
        }
        (numbers(picture, shown))
        pre { (shown.command) }
    }
}

fn numbers(picture: &Picture, shown: &Shown) -> Markup {
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
                    (stored.join(", ")) " photons; maps " (duration(ours.map_seconds)) ", picture "
                    (duration(ours.seconds - ours.map_seconds)) " of CPU time for "
                    (shown.size.0) " × " (shown.size.1) " pixels, " (ours.samples) " samples each"
                } }
                @if let Some((paths, seconds)) = shown.twin {
                    tr { th { "twin" } td { (paths) " paths a pixel, " (duration(seconds)) } }
                }
                @if let Some(compared) = &shown.compared { (comparison(compared)) }
            }
        }
    }
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
        tr { th { "RMS error" } td {
            "photon maps " (between(c.rms)) "; paths in the same time " (between(c.equal_rms))
        } }
        tr { th { "of one map" } td {
            "what remains with any number of maps: RMS " (between(c.systematic)) "; bias of the mean " (between(c.bias))
            " (" (c.makings) " sets of maps)"
        } }
        tr { th { "verdict" } td {
            (c.verdict) ": " (c.blocks.1) " of " (c.blocks.0) " blocks and channels differ; masked " (percent(c.masked))
            ", heavy-tailed " (percent(c.heavy)) " of the picture; deviations of " (percent(c.smallest)) " in a block are seen"
        } }
    }
}
