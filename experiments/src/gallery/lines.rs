//! The same picture with the volume map read along whole rays, from points, from beams, and from planes beside beams: maps one after the
//! other, each of its own photons, with radii that shrink, until as much time has passed as the picture of 1998 took.

use super::keep::{CachedRender, FORMAT, RenderRecord};
use super::pictures::{Lines, Picture};
use super::recipe;
use super::studio::{Studio, stored};
use cpu_time::ProcessTime;
use turbid::estimators::Gather;
use turbid::integrators::mapper::{self, Mapper};
use turbid::math::Positive;
use turbid::photons::maps::{self, Amount, MapSettings};
use turbid::sensor::{Film, Method};
use turbid::transport::{NoProgress, Progress};

/// What is stored of light in a medium.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stored {
    /// Collisions.
    Points,
    /// Flights.
    Beams,
    /// Pairs of flights, and flights that begin on bodies.
    Planes,
}

impl Stored {
    /// All of them.
    pub const ALL: [Stored; 3] = [Stored::Points, Stored::Beams, Stored::Planes];

    /// What is asked for of a picture, in this order.
    pub fn of(picture: &Picture) -> impl Iterator<Item = (&Lines, Stored)> {
        picture.lines.iter().flat_map(|lines| {
            let is_asked = |stored: &Stored| stored.asked(lines).is_some();
            Self::ALL.into_iter().filter(is_asked).map(move |stored| (lines, stored))
        })
    }

    /// Their name on the page.
    pub fn name(self) -> &'static str {
        match self {
            Stored::Points => "points along rays",
            Stored::Beams => "photon beams",
            Stored::Planes => "photon planes beside beams",
        }
    }

    /// Name of the plate and of its file.
    pub fn kind(self) -> &'static str {
        match self {
            Stored::Points => "rays",
            Stored::Beams => "beams",
            Stored::Planes => "planes",
        }
    }

    /// Number of the first of its maps: no random numbers are those of another picture.
    fn first(self) -> u64 {
        match self {
            Stored::Points => 3000,
            Stored::Beams => 3_000_000,
            Stored::Planes => 6_000_000,
        }
    }

    /// How much of it each map takes, and the radius in the first one \[L\]; none where it is not asked for.
    fn asked(self, lines: &Lines) -> Option<(Amount, f64)> {
        match self {
            Stored::Points => Some(lines.points),
            Stored::Beams => Some(lines.beams),
            Stored::Planes => lines.planes,
        }
    }
}

/// What is stored in the map of this number, and how it is read.
fn settings(
    picture: &Picture,
    (lines, stored): (&Lines, Stored),
    radii: [f64; 3],
    seed: u64,
    map: u64,
) -> turbid::Result<(MapSettings, mapper::Settings)> {
    let usual = recipe::maps(picture, 1, seed, stored.first() + map);
    let part = |amount: Amount| match amount {
        Amount::Emitted(n) => Amount::Emitted(n.div_ceil(lines.parts)),
        Amount::Stored(n) => Amount::Stored(n.div_ceil(lines.parts)),
    };
    let nothing =
        || turbid::Error::Scene(format!("{} of {}; allowed: what is asked for", stored.name(), picture.name));
    let (volume, radius) = stored.asked(lines).ok_or_else(nothing)?;
    let (global, caustic) = (part(usual.global), part(usual.caustic));
    let mut read = recipe::readout(picture, 1)?;
    let gathers = [&mut read.global.1, &mut read.caustic.1, &mut read.volume.gather];
    for (gather, radius) in gathers.into_iter().zip(radii) {
        if radius > 0.0 {
            *gather = Gather::radius(radius)?;
        }
    }
    let radius = Positive::new("the radius about rays", radius)?;
    read.volume = match stored {
        Stored::Points => read.volume.along_rays(radius),
        Stored::Beams => read.volume.along_beams(radius),
        Stored::Planes => read.volume.along_beams(radius).in_planes(),
    };
    read.volume = read.volume.progressive();
    let maps = MapSettings { global, caustic, volume, media: read.media(), ..usual };
    Ok((maps, read.in_map(map)))
}

impl Studio<'_> {
    /// What a render from lines will be called.
    pub fn words_of_lines(&self, (lines, stored): (&Lines, Stored), seconds: f64) -> String {
        self.words(&format!("{} of {lines:?} in {seconds} s", stored.name()), 1, 0)
    }

    /// A picture from as many maps as that many CPU seconds allow, a sample a pixel from each; at least two.
    ///
    /// # Arguments   `radii` of the first map's estimates on surfaces, of caustics and in the volume, 0 where there are none \[L\]
    pub fn lines_for(
        &self,
        of: (&Lines, Stored),
        radii: [f64; 3],
        seconds: f64,
        progress: &dyn Progress,
    ) -> anyhow::Result<CachedRender> {
        let start = ProcessTime::now();
        let (width, height) = (self.camera.width(), self.camera.height());
        let mut film = Film::new(width, height);
        let mut facts = RenderRecord {
            format: FORMAT,
            words: self.words_of_lines(of, seconds),
            program: self.program.clone(),
            seconds: 0.0,
            map_seconds: 0.0,
            samples: 0,
            emitted: [0; 2],
            stored: [0; 3],
            radii: [0.0; 3],
            estimates: None,
        };
        loop {
            let (maps, read) = settings(self.picture, of, radii, self.seed, facts.samples)?;
            let began = start.elapsed().as_secs_f64();
            let filled = maps::fill(&self.scene, &maps, &NoProgress)?;
            facts.map_seconds += start.elapsed().as_secs_f64() - began;
            let mapper = Mapper::new(&self.scene, &filled, &read);
            mapper.check_radii()?;
            let mut one = Film::new(width, height);
            let method = Method::Photons(mapper);
            method.extend(&mut one, &self.camera, 1, self.streams(maps.replicate), progress)?;
            film.push_film(&one);
            facts.samples += 1;
            facts.stored = stored(&filled);
            facts.emitted = [filled.report.main.emitted, filled.report.caustic.emitted];
            facts.seconds = start.elapsed().as_secs_f64();
            // As much again as the mean map took.
            if facts.samples >= 2 && facts.seconds * (1.0 + 1.0 / facts.samples as f64) > seconds {
                break;
            }
        }
        Ok(CachedRender::new(facts, film.pixels().iter().map(|p| p.layers()).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery::pictures::ALL;

    /// Where light is read along rays there is a medium that scatters it, every map has its own photons, and radii shrink.
    #[test]
    fn maps_follow_each_other() {
        let of_pictures: Vec<_> = ALL.iter().flat_map(|p| Stored::of(p).map(move |of| (p, of))).collect();
        let pictures = |stored| of_pictures.iter().filter(|(_, of)| of.1 == stored).count();
        assert!(pictures(Stored::Points) > 1 && pictures(Stored::Planes) > 0);
        for (picture, lines) in of_pictures {
            let stored = lines.1;
            let of = |map| settings(picture, lines, [0.1, 0.0, 0.2], 1, map).unwrap();
            let ((maps, first), (others, later)) = (of(0), of(5));
            assert_eq!(
                (maps.media.beams().is_some(), maps.media.has_planes(), maps.replicate + 5),
                (stored != Stored::Points, stored == Stored::Planes, others.replicate)
            );
            let radius = |s: &mapper::Settings| s.volume.ray_radius.or(s.volume.beam_radius).unwrap().get();
            assert!(radius(&later) < radius(&first) && first.volume.reads_rays(), "{}", picture.name);
            assert!(later.global.1.cap() < first.global.1.cap());
            assert_eq!(later.caustic, first.caustic, "nothing is found about no radius");
        }
    }
}
