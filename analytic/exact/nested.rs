//! `exact nested`: uncollided light in cuboids of several extinctions.

use crate::answer::Answer;
use crate::plot::{Curve, even, figure, panel};
use crate::question::{Question, Solved};
use crate::read::place;
use crate::unit::Unit;
use anyhow::{Result, bail, ensure};
use turbid_analytic::NestedCuboids;
use turbid_figure::{Axis, Figure};

/// Light of a cuboid that emits, uncollided, through cuboids of other extinctions: a shield with ducts.
///
///   phi(r) = int q e^(-tau(r,r'))/(4 pi |r-r'|^2) dr',   q = 1 per volume in the source
///
/// Of cuboids that overlap the later one counts; outside all of them nothing is absorbed. With --mirror, planes x, y or z = 0 reflect, and
/// cuboids, source and places lie at 0 or above there. Lengths are in any unit, extinctions per that length, the fluence is over the power per
/// volume: a length. What scatters has no part in it: albedo 0, or the uncollided light of any medium.
/// Source: Kobayashi, Sugimura and Nagaya 2000 (OECD/NEA), case i.
#[derive(Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// A cuboid of the medium by its extents and its extinction. Once for each cuboid.
    #[arg(long, value_parser = cuboid, value_name = "x=A:B,y=A:B,z=A:B,extinction=S")]
    cuboid: Vec<(Extent, f64)>,
    /// The cuboid that emits.
    #[arg(long, value_parser = source, value_name = "x=A:B,y=A:B,z=A:B")]
    source: Extent,
    /// Axes whose plane 0 is a mirror, as the letters of some of x, y and z: xyz.
    #[arg(long, value_parser = mirrors, value_name = "AXES")]
    mirror: Option<Mirrors>,
    /// A place x,y,z. Once for each place.
    #[arg(long, required = true, value_parser = place, value_name = "X,Y,Z", allow_negative_numbers = true)]
    at: Vec<Vec<f64>>,
}

type Extent = [[f64; 2]; 3];
type Mirrors = [bool; 3];

const AXES: [&str; 3] = ["x", "y", "z"];

/// Reads extents, and an extinction if there may be one.
fn parts(text: &str, allowed: &str) -> Result<(Extent, Option<f64>), String> {
    let wrong = |what: &str| format!("cuboid is '{text}': {what}; allowed: {allowed}");
    let (mut extents, mut extinction) = ([None; 3], None);
    for pair in text.split(',') {
        let (name, value) = pair.split_once('=').ok_or_else(|| wrong(&format!("'{pair}'")))?;
        let name = name.trim();
        let number = |text: &str| text.trim().parse().map_err(|_| wrong(&format!("{name} is '{value}'")));
        let again = match AXES.iter().position(|axis| *axis == name) {
            Some(axis) => {
                let (low, high) =
                    value.split_once(':').ok_or_else(|| wrong(&format!("{name} is '{value}'")))?;
                extents[axis].replace([number(low)?, number(high)?]).is_some()
            }
            None if name == "extinction" => extinction.replace(number(value)?).is_some(),
            None => return Err(wrong(&format!("'{pair}'"))),
        };
        if again {
            return Err(wrong("said twice"));
        }
    }
    match extents {
        [Some(x), Some(y), Some(z)] => Ok(([x, y, z], extinction)),
        _ => Err(wrong("an extent is missing")),
    }
}

fn cuboid(text: &str) -> Result<(Extent, f64), String> {
    const ALLOWED: &str = "x=A:B,y=A:B,z=A:B,extinction=S";
    match parts(text, ALLOWED)? {
        (extent, Some(extinction)) => Ok((extent, extinction)),
        _ => Err(format!("cuboid is '{text}': no extinction; allowed: {ALLOWED}")),
    }
}

fn source(text: &str) -> Result<Extent, String> {
    const ALLOWED: &str = "x=A:B,y=A:B,z=A:B";
    match parts(text, ALLOWED)? {
        (extent, None) => Ok(extent),
        _ => Err(format!("source is '{text}': its extinction is that of the cuboids; allowed: {ALLOWED}")),
    }
}

fn mirrors(text: &str) -> Result<Mirrors, String> {
    let mirrors = AXES.map(|axis| text.contains(axis));
    let count = mirrors.iter().filter(|mirror| **mirror).count();
    if count == text.len() && count > 0 {
        Ok(mirrors)
    } else {
        Err(format!("mirror is '{text}'; allowed: some of the letters x, y and z, each once"))
    }
}

impl Args {
    fn problem(&self) -> Result<NestedCuboids> {
        Ok(NestedCuboids::new(&self.cuboid, self.source, self.mirror.unwrap_or([false; 3]))?)
    }
}

/// Extents in words.
fn words([x, y, z]: &Extent) -> String {
    format!("x {}:{} y {}:{} z {}:{}", x[0], x[1], y[0], y[1], z[0], z[1])
}

fn three(at: &[f64]) -> Result<[f64; 3]> {
    ensure!(at.len() == 3, "--at has {} coordinates; allowed: 3", at.len());
    Ok([at[0], at[1], at[2]])
}

impl Question for Args {
    fn answer(&self, answer: &mut Answer, _: &Solved) -> Result<()> {
        let problem = self.problem()?;
        let of = |(extent, extinction): &(Extent, f64)| format!("{} extinction {extinction}", words(extent));
        let cuboids: Vec<String> = self.cuboid.iter().map(of).collect();
        answer.of("nested").with("cuboids", cuboids.join(" | ")).with("source", words(&self.source));
        if let Some(mirror) = self.mirror {
            let named = AXES.into_iter().zip(mirror).filter(|(_, mirror)| *mirror).map(|(axis, _)| axis);
            answer.with("mirror", named.collect::<String>());
        }
        for at in &self.at {
            let place = three(at)?;
            let at = [("x", at[0].into()), ("y", at[1].into()), ("z", at[2].into())];
            answer.add("fluence", Unit::SourcePerVolumeLength, &at, problem.fluence(place)?);
        }
        Ok(())
    }

    /// The fluence from the first place to the last.
    fn figure(&self, _: &Solved) -> Result<Figure> {
        let problem = self.problem()?;
        let (Some(first), Some(last)) = (self.at.first(), self.at.last()) else { bail!("no place") };
        let (from, to) = (three(first)?, three(last)?);
        ensure!(
            from != to,
            "--at is one place; allowed with --plot: two, the fluence is drawn from the first to the last"
        );
        let length = from.iter().zip(to).map(|(a, b)| (b - a) * (b - a)).sum::<f64>().sqrt();
        let curve = Curve::sample("", &even(0.0, length, 41), |s| {
            let place = [0, 1, 2].map(|axis| from[axis] + s / length * (to[axis] - from[axis]));
            Ok(problem.fluence(place)?.value)
        })?;
        let title = format!("Uncollided light of a cuboid in {} cuboids", self.cuboid.len());
        let axis = Axis::linear("Distance from the first place to the last", "lengths");
        Ok(figure(title, panel(axis, "Fluence over power per volume", "length", vec![curve])))
    }
}
