//! Media: homogeneous ones, and those that vary on an even lattice.

use super::phase::{Said, said};
use super::places::Places;
use super::writer::{Writer, refuse};
use crate::Spectrum;
use crate::error::Result;
use crate::exchange::xml::{Xml, triple};
use crate::medium::{Blocks, Density, Grid, Heterogeneous, Medium};
use crate::surface::Surface;
use glam::DVec3;

/// Most values of a lattice that is written: half a gigabyte.
const MOST_VALUES: usize = 1 << 27;

/// Whether its free flights are the same in every channel.
pub(super) fn is_grey(medium: &Medium) -> bool {
    medium.matter().sigma_t().is_grey()
}

/// Values in the middles of equal cells of a box.
struct Lattice {
    min: DVec3,
    max: DVec3,
    count: [usize; 3],
    channels: usize,
    values: Vec<f64>,
    /// Each value in its whole cell; linear between the middles otherwise.
    is_blocks: bool,
}

impl Lattice {
    fn of_grid(grid: &Grid) -> Self {
        let (min, max) = grid.corners();
        let values = grid.values().iter().map(|v| f64::from(*v)).collect();
        Lattice { min, max, count: grid.count(), channels: grid.channels(), values, is_blocks: false }
    }

    fn of_blocks(blocks: &Blocks) -> Result<Self> {
        if blocks.is_columns() {
            return refuse("columns, which have heights of their own; allowed: grids and even blocks");
        }
        let (min, max) = blocks.corners();
        let count = blocks.count();
        for axis in 0..3 {
            let even = |i: usize| min[axis] + (max[axis] - min[axis]) * i as f64 / count[axis] as f64;
            let least = 1e-9 * (max[axis] - min[axis]);
            if blocks.planes(axis).iter().enumerate().any(|(i, plane)| (plane - even(i)).abs() > least) {
                return refuse(
                    "blocks of different widths, which Mitsuba's grids have not; allowed: even ones",
                );
            }
        }
        let channels = blocks.channels();
        let mut values = Vec::with_capacity(channels * count.iter().product::<usize>());
        let middle = |axis: usize, i: usize| 0.5 * (blocks.planes(axis)[i] + blocks.planes(axis)[i + 1]);
        for z in 0..count[2] {
            for y in 0..count[1] {
                for x in 0..count[0] {
                    let value = blocks.color_at(DVec3::new(middle(0, x), middle(1, y), middle(2, z)));
                    values.extend((0..channels).map(|channel| value[channel]));
                }
            }
        }
        Ok(Lattice { min, max, count, channels, values, is_blocks: true })
    }

    /// The same with as many more cells on each side as hold a box: beyond its own it has the values of its outermost ones,
    /// and Mitsuba's media end there.
    fn over(self, (low, high): (DVec3, DVec3)) -> Result<Self> {
        let (mut min, mut max) = (self.min, self.max);
        let (mut before, mut count) = ([0; 3], self.count);
        for axis in 0..3 {
            let n = self.count[axis];
            if n == 1 {
                (min[axis], max[axis]) = (low[axis].min(min[axis]), high[axis].max(max[axis]));
                continue;
            }
            let step = (max[axis] - min[axis]) / n as f64;
            let cells = |length: f64| (length / step - 1e-9).ceil().max(0.0);
            let (below, above) = (cells(min[axis] - low[axis]), cells(high[axis] - max[axis]));
            if below + above > 1e6 {
                return refuse(
                    "a grid that is far smaller than what it fills; allowed: within a million of its cells",
                );
            }
            (min[axis], max[axis]) = (min[axis] - step * below, max[axis] + step * above);
            (before[axis], count[axis]) = (below as usize, n + (below + above) as usize);
        }
        let all = count.iter().try_fold(self.channels, |product, n| product.checked_mul(*n));
        let Some(all) = all.filter(|all| *all <= MOST_VALUES) else {
            return refuse(
                "a grid that is far smaller than what it fills; allowed: up to 2^27 values with those around",
            );
        };
        crate::memory::check(|| format!("a grid of {all} values"), 20.0 * all as f64)?;
        let mut values = Vec::with_capacity(all);
        let from = |axis: usize, i: usize| i.saturating_sub(before[axis]).min(self.count[axis] - 1);
        for z in 0..count[2] {
            for y in 0..count[1] {
                for x in 0..count[0] {
                    let [x, y, z] = [from(0, x), from(1, y), from(2, z)];
                    let first = self.channels * ((z * self.count[1] + y) * self.count[0] + x);
                    values.extend(&self.values[first..first + self.channels]);
                }
            }
        }
        Ok(Lattice { min, max, count, values, ..self })
    }

    /// The same times a colour.
    fn times(self, factor: Spectrum) -> Self {
        let channels = if factor.is_grey() { self.channels } else { 3 };
        let mut values = Vec::with_capacity(self.values.len() / self.channels * channels);
        for cell in self.values.chunks_exact(self.channels) {
            values.extend((0..channels).map(|c| cell[c.min(self.channels - 1)] * factor[c]));
        }
        Lattice { channels, values, ..self }
    }

    fn bytes(&self) -> Result<Vec<u8>> {
        let single = self.values.iter().map(|value| *value as f32).collect();
        Ok(Grid::new((self.min, self.max), self.count, self.channels, single)?.to_bytes())
    }
}

/// A part of a medium as Mitsuba says it.
enum Part {
    Constant(Spectrum),
    Varying { file: String, min: DVec3, max: DVec3, is_blocks: bool },
}

impl Part {
    fn write(&self, xml: &mut Xml, name: &str) {
        match self {
            Part::Constant(value) => xml.rgb(name, *value),
            Part::Varying { file, min, max, is_blocks } => {
                xml.within("volume", &[("name", name), ("type", "gridvolume")], |xml| {
                    xml.value("string", "filename", file);
                    xml.value("string", "filter_type", if *is_blocks { "nearest" } else { "trilinear" });
                    xml.value("boolean", "raw", "true");
                    xml.within("transform", &[("name", "to_world")], |xml| {
                        xml.element("scale", &[("value", &triple(*max - *min))]);
                        xml.element("translate", &[("value", &triple(*min))]);
                    });
                });
            }
        }
    }
}

impl Writer<'_> {
    /// A medium, by its number.
    pub(super) fn medium(&mut self, number: usize, places: &Places) -> Result<()> {
        let name = self.medium_name(number);
        let medium = self.scene.medium(number);
        let matter = medium.matter();
        let within = |e: crate::Error| e.within(&name);
        let is_emitting = match medium {
            Medium::Homogeneous(matter) => !matter.emission().is_black(),
            Medium::Heterogeneous(varying) => varying.is_emitting(),
        };
        if is_emitting {
            return refuse(format!(
                "{name}: emission, which Mitsuba's media have not; allowed: media that do not emit"
            ));
        }
        let (phase, off) = said(matter.phase()).map_err(within)?;
        if off > 1e-9 {
            self.notes.push(format!(
                "{name}: the phase function is written as a table, {off:.1e} of the light goes elsewhere"
            ));
        }
        // Colours of Mitsuba are at most 1. A power of two changes no digit of them.
        let (part, exponent) = libm::frexp(matter.sigma_t().max());
        let high = libm::ldexp(1.0, if part == 0.5 { exponent - 1 } else { exponent });
        let hue = matter.sigma_t() / high;
        match medium {
            Medium::Homogeneous(matter) => {
                let parts = [("sigma_t", Part::Constant(hue)), ("albedo", Part::Constant(matter.albedo()))];
                self.write_medium("homogeneous", &name, high, &parts, &phase);
            }
            Medium::Heterogeneous(varying) => {
                let filled = self.filled_box(number, places).map_err(within)?;
                let parts = self.varying(&name, varying, hue, filled).map_err(within)?;
                self.write_medium("heterogeneous", &name, high, &parts, &phase);
            }
        }
        Ok(())
    }

    fn write_medium(&mut self, kind: &str, name: &str, scale: f64, parts: &[(&str, Part)], phase: &Said) {
        self.xml.within("medium", &[("type", kind), ("id", name)], |xml| {
            xml.float("scale", scale);
            parts.iter().for_each(|(name, part)| part.write(xml, name));
            phase.write(xml);
        });
    }

    /// The box of all that a medium fills.
    fn filled_box(&self, number: usize, places: &Places) -> Result<(DVec3, DVec3)> {
        if let Some(shape) = places.shape(number) {
            return shape.corners().map_or_else(|| refuse("has no end"), Ok);
        }
        let mut boxes = self.scene.objects().iter().filter_map(|object| {
            let Surface::Dielectric(boundary) = &object.surface else { return None };
            let fills = |interior: usize| self.scene.filling(interior) == Some(number);
            (fills(boundary.inside()) || fills(boundary.outside())).then(|| object.shape.corners()).flatten()
        });
        let Some(first) = boxes.next() else { return refuse("has no end") };
        Ok(boxes.fold(first, |(low, high), (min, max)| (low.min(min), high.max(max))))
    }

    fn varying(
        &mut self,
        name: &str,
        medium: &Heterogeneous,
        hue: Spectrum,
        filled: (DVec3, DVec3),
    ) -> Result<[(&'static str, Part); 2]> {
        let density = match medium.density() {
            Density::Grid(grid) => Lattice::of_grid(grid),
            Density::Blocks(blocks) => Lattice::of_blocks(blocks)?,
            Density::Cloud(_) => {
                return refuse("density of a cloud, which Mitsuba has not; allowed: grids and even blocks");
            }
            Density::HeightFog(_) => {
                return refuse(
                    "density of height fog, which Mitsuba has not; allowed: grids and even blocks",
                );
            }
            Density::Repeated(_) => {
                return refuse("density that repeats itself; allowed: grids and even blocks");
            }
        };
        let albedo = match (medium.albedo_grid(), medium.albedo_blocks()) {
            (Some(grid), _) => Some(Lattice::of_grid(grid)),
            (None, Some(blocks)) => Some(Lattice::of_blocks(blocks)?),
            (None, None) if medium.has_varying_albedo() => return refuse("albedo that repeats itself"),
            (None, None) => None,
        };
        let density = self.lattice(&format!("{name}-sigma_t"), density.over(filled)?.times(hue))?;
        let albedo = match albedo {
            Some(albedo) => {
                self.lattice(&format!("{name}-albedo"), albedo.over(filled)?.times(medium.matter().albedo()))?
            }
            None => Part::Constant(medium.matter().albedo()),
        };
        Ok([("sigma_t", density), ("albedo", albedo)])
    }

    fn lattice(&mut self, name: &str, lattice: Lattice) -> Result<Part> {
        let Lattice { min, max, is_blocks, .. } = lattice;
        let file = self.beside(name, "vol", lattice.bytes()?);
        Ok(Part::Varying { file, min, max, is_blocks })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid that is written over a larger box has the values of the smaller one everywhere: beyond its faces too.
    #[test]
    fn a_wider_grid_is_the_same() {
        let values = [1.0, 2.0, 4.0, 0.5, 0.0, 3.0, 2.5, 7.0, 1.5, 6.0, 2.0, 1.0];
        let grid =
            Grid::new((DVec3::ZERO, DVec3::new(3.0, 2.0, 2.0)), [3, 2, 2], 1, values.to_vec()).unwrap();
        let (low, high) = (DVec3::new(-1.5, 0.0, -4.0), DVec3::new(3.0, 5.0, 2.2));
        let wide = Lattice::of_grid(&grid).over((low, high)).unwrap();
        assert!(wide.min.cmple(low).all() && wide.max.cmpge(high).all());
        let wide = Grid::from_bytes(&wide.bytes().unwrap()).unwrap();
        for i in 0..1000 {
            let part = [0.618_034, 0.754_878, 0.569_840].map(|x: f64| (x * f64::from(i)).fract());
            let p = low + (high - low) * DVec3::from(part);
            assert!((wide.at(p) - grid.at(p)).abs() < 1e-5, "{p}");
        }
    }
}
