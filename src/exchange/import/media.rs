//! Media and phase functions.

use super::document::Element;
use super::importer::{Importer, channels, refuse_negative};
use super::part::{Part, numbers};
use crate::Spectrum;
use crate::error::Result;
use crate::math::{Albedo, Asymmetry, NonNegative};
use crate::medium::Grid;
use crate::scene::{Channels, DensityFile, GridFile, Interpolation, PhaseFile};
use glam::DVec3;

/// What a scene file says of a medium.
#[derive(Debug, Clone)]
pub(super) struct MediumKeys {
    pub sigma_t: Channels<NonNegative>,
    pub albedo: Channels<Albedo>,
    pub g: Option<Asymmetry>,
    pub phase: Option<PhaseFile>,
    pub density: Option<DensityFile>,
    pub albedo_grid: Option<GridFile>,
    /// The box outside of which there is none of it, where there is such a box.
    pub extent: Option<(DVec3, DVec3)>,
}

/// A volume: the same everywhere, or a grid in a box.
enum Volume {
    Constant(Spectrum),
    Grid { grid: Box<Grid>, corners: (DVec3, DVec3), is_blocks: bool },
}

impl<'a> Importer<'a> {
    /// The keys of a medium.
    pub(super) fn medium_keys(&mut self, element: &'a Element) -> Result<MediumKeys> {
        let part = Part::new(element, self.ids)?;
        let is_varying = match part.kind() {
            "homogeneous" => false,
            "heterogeneous" => true,
            other => {
                return part.refuse(format!(
                    "a medium of type `{other}` is not imported; allowed: homogeneous, heterogeneous"
                ));
            }
        };
        part.pass_over(&["sample_emitters", "has_spectral_extinction"]);
        let scale = part.float("scale")?.unwrap_or(1.0);
        let pair = [self.volume(&part, "sigma_a")?, self.volume(&part, "sigma_s")?];
        let (sigma_t, albedo) = match pair {
            [None, None] => (
                self.volume(&part, "sigma_t")?.unwrap_or(Volume::Constant(Spectrum::ONE)),
                self.volume(&part, "albedo")?.unwrap_or(Volume::Constant(Spectrum::grey(0.75))),
            ),
            [Some(Volume::Constant(a)), Some(Volume::Constant(s))] => {
                (Volume::Constant(a + s), Volume::Constant(s.over(a + s)))
            }
            _ => {
                return part.refuse(
                    "sigma_a and sigma_s; allowed: both, the same everywhere, or sigma_t and albedo",
                );
            }
        };
        let (g, phase) = match part.part("phase")? {
            Some(element) => self.phase(element)?,
            None => (Some(0.0), None),
        };
        part.finish()?;
        let g = g.map(|g| Asymmetry::new("g", g)).transpose().map_err(|e| element.error(e))?;
        let (hue, density, extent) = match sigma_t {
            Volume::Constant(sigma_t) => (sigma_t, None, None),
            Volume::Grid { .. } if !is_varying => {
                return part.refuse("a homogeneous medium of a grid; allowed: type heterogeneous");
            }
            Volume::Grid { grid, corners, is_blocks } => {
                let Some((hue, grid)) = one_channel(&grid, corners)? else {
                    return part.refuse(
                        "sigma_t has channels that vary apart from each other; allowed: one channel, or a colour times one",
                    );
                };
                (hue, Some(DensityFile::Grid(self.grid_file(&grid, corners, is_blocks))), Some(corners))
            }
        };
        let (albedo, albedo_grid, density) = match albedo {
            Volume::Constant(albedo) => (albedo, None, density),
            Volume::Grid { grid, corners, is_blocks } => {
                // A grid of albedos stands beside a density.
                let even = |corners: (DVec3, DVec3)| -> Result<DensityFile> {
                    Ok(DensityFile::Grid(GridFile {
                        values: Some(vec![NonNegative::new("1", 1.0)?]),
                        count: Some([1; 3]),
                        ..grid_in(corners)
                    }))
                };
                let density = match density {
                    Some(density) => density,
                    None => even(corners)?,
                };
                (Spectrum::ONE, Some(self.grid_file(&grid, corners, is_blocks)), Some(density))
            }
        };
        let within = |e: crate::Error| element.error(e);
        refuse_negative(element, "sigma_t", hue * scale)?;
        Ok(MediumKeys {
            sigma_t: channels(hue * scale, |x| NonNegative::new("sigma_t", x)).map_err(within)?,
            albedo: channels(albedo, |x| Albedo::new("albedo", x)).map_err(within)?,
            g,
            phase,
            density,
            albedo_grid,
            extent,
        })
    }

    fn grid_file(&mut self, grid: &Grid, corners: (DVec3, DVec3), is_blocks: bool) -> GridFile {
        let file = self.beside("grid", "vol", grid.to_bytes());
        GridFile {
            file: Some(file),
            interpolation: is_blocks.then_some(Interpolation::Blocks),
            ..grid_in(corners)
        }
    }

    /// A value that may be a volume.
    fn volume(&mut self, part: &Part<'a>, name: &str) -> Result<Option<Volume>> {
        let volumes = part.parts("volume")?;
        let Some((_, element)) = volumes.into_iter().find(|(given, _)| *given == Some(name)) else {
            return Ok(part.color(name)?.map(|color| Volume::Constant(color.of_matter())));
        };
        let volume = Part::new(element, self.ids)?;
        let found = match volume.kind() {
            "constvolume" => match volume.color("value")? {
                Some(value) => Volume::Constant(value.of_matter()),
                None => Volume::Constant(Spectrum::ONE),
            },
            "gridvolume" => {
                let Some(file) = volume.string("filename")? else {
                    return volume.refuse("a gridvolume without filename; allowed: one");
                };
                let is_blocks = match volume.string("filter_type")? {
                    None | Some("trilinear") => false,
                    Some("nearest") => true,
                    Some(other) => {
                        return volume
                            .refuse(format!("filter_type is `{other}`; allowed: trilinear, nearest"));
                    }
                };
                match volume.string("wrap_mode")? {
                    None | Some("clamp") => {}
                    Some(other) => return volume.refuse(format!("wrap_mode is `{other}`; allowed: clamp")),
                }
                volume.pass_over(&["raw", "accel"]);
                let grid = Grid::read(&self.path(element, file)?).map_err(|e| element.error(e))?;
                let Some((scale, at)) = volume.transform("to_world")?.along_axes() else {
                    return volume.refuse("to_world of a grid turns it; allowed: scale and translate");
                };
                let (min, max) = match volume.flag("use_grid_bbox")? {
                    Some(true) => grid.corners(),
                    _ => (DVec3::ZERO, DVec3::ONE),
                };
                Volume::Grid {
                    grid: Box::new(grid),
                    corners: (min * scale + at, max * scale + at),
                    is_blocks,
                }
            }
            other => {
                return volume.refuse(format!(
                    "a volume of type `{other}` is not imported; allowed: constvolume, gridvolume"
                ));
            }
        };
        volume.finish()?;
        Ok(Some(found))
    }

    /// A mean cosine, or another phase function.
    fn phase(&mut self, element: &'a Element) -> Result<(Option<f64>, Option<PhaseFile>)> {
        let part = Part::new(element, self.ids)?;
        let found = match part.kind() {
            "isotropic" => (Some(0.0), None),
            "hg" => (Some(part.float("g")?.unwrap_or(0.8)), None),
            "rayleigh" => (None, Some(PhaseFile::Rayleigh {})),
            "tabphase" => {
                let Some(values) = part.string("values")? else {
                    return part.refuse("a tabphase without values; allowed: two or more");
                };
                let values = numbers(element, values)?;
                if values.len() < 2 || values.iter().any(|value| *value < 0.0) {
                    return part.refuse("values of a tabphase; allowed: two or more, at least 0");
                }
                let mut text = String::from("# Cosine of the scattering angle, value.\n");
                for (i, value) in values.iter().enumerate() {
                    let cosine = -1.0 + 2.0 * i as f64 / (values.len() - 1) as f64;
                    text.push_str(&format!("{cosine:?} {value:e}\n"));
                }
                let file = self.beside("phase", "txt", text.into_bytes());
                (None, Some(PhaseFile::Table { file }))
            }
            "blendphase" => {
                let terms = part.parts("phase")?;
                let Some(weight) = part.float("weight")? else {
                    return part.refuse("a blendphase without a number as weight; allowed: one");
                };
                let mut asymmetries = Vec::new();
                for (_, term) in terms {
                    if term.attribute("type") == Some("blendphase") {
                        return term.refuse("a blendphase in another; allowed: two of hg and isotropic");
                    }
                    match self.phase(term)? {
                        (Some(g), None) => {
                            asymmetries.push(Asymmetry::new("g", g).map_err(|e| term.error(e))?)
                        }
                        _ => return term.refuse("a part of a blendphase; allowed: hg, isotropic"),
                    }
                }
                let [g1, g2] = asymmetries[..] else {
                    return part.refuse(format!("{} parts of a blendphase; allowed: two", asymmetries.len()));
                };
                let share = Albedo::new("1 - weight", 1.0 - weight).map_err(|e| element.error(e))?;
                (None, Some(PhaseFile::TwoTerm { g1, g2, share }))
            }
            other => {
                return part.refuse(format!(
                    "a phase function of type `{other}` is not imported; allowed: isotropic, hg, rayleigh, tabphase, blendphase"
                ));
            }
        };
        part.finish()?;
        Ok(found)
    }
}

/// A grid's place alone.
fn grid_in((min, max): (DVec3, DVec3)) -> GridFile {
    GridFile {
        file: None,
        values: None,
        count: None,
        interpolation: None,
        scale: None,
        min: Some(min.to_array()),
        max: Some(max.to_array()),
    }
}

/// A grid as a colour, 1 in its largest channel, times one channel; none where channels vary apart from each other by more
/// than the rounding of a product in single precision.
fn one_channel(grid: &Grid, corners: (DVec3, DVec3)) -> Result<Option<(Spectrum, Grid)>> {
    let values = grid.values();
    if grid.channels() == 1 {
        return Ok(Some((Spectrum::ONE, grid.placed(corners, 1.0)?)));
    }
    let cell = |cell: &[f32]| DVec3::new(f64::from(cell[0]), f64::from(cell[1]), f64::from(cell[2]));
    let brightest =
        values.chunks_exact(3).map(cell).max_by(|a, b| a.max_element().total_cmp(&b.max_element()));
    let Some(brightest) = brightest.filter(|cell| cell.max_element() > 0.0) else { return Ok(None) };
    let high = brightest.max_element();
    let hue = brightest / high;
    let channel = (0..3).find(|c| brightest[*c] == high).unwrap_or_default();
    let rounding = 4.0 * f64::from(f32::EPSILON);
    let is_one = values
        .chunks_exact(3)
        .map(cell)
        .all(|cell| (cell - hue * cell[channel]).abs().cmple(DVec3::splat(rounding * cell[channel])).all());
    if !is_one {
        return Ok(None);
    }
    let single = values.chunks_exact(3).map(|cell| cell[channel]).collect();
    Ok(Some((Spectrum(hue), Grid::new(corners, grid.count(), 1, single)?)))
}
