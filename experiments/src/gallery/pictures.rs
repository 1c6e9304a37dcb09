//! The pictures: scenes, numbers of photons, and what the originals cost.

use super::light::ByLight;
use turbid::integrators::Layer;
use turbid::photons::maps::Amount;

/// What is drawn of a picture beside the whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beside {
    /// The photons of its maps, seen from the camera.
    Maps,
    /// Light that was scattered once, alone.
    Single,
}

/// What each of the maps takes that are read along whole rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lines {
    /// The picture's photons on surfaces over those of each map.
    pub parts: u64,
    /// Points in the medium, and the radius about rays in the first map \[L\].
    pub points: (Amount, f64),
    /// Beams in the medium, and that radius.
    pub beams: (Amount, f64),
    /// Planes and beams in the medium, and the radius of the beams: of a medium that is grey and the same everywhere, without glass.
    pub planes: Option<(Amount, f64)>,
}

/// One picture of the gallery.
#[derive(Debug, Clone, Copy)]
pub struct Picture {
    /// Name of the scene's file and of all files made from it.
    pub name: &'static str,
    /// Heading.
    pub title: &'static str,
    /// What to see in it.
    pub see: &'static str,
    /// Numbers, machine and times of the original.
    pub original: &'static str,
    /// Photons of the global, caustic and volume map.
    pub photons: [Amount; 3],
    /// Photons in an estimate: global, caustic, volume.
    pub nearest: [usize; 3],
    /// Samples a pixel.
    pub samples: u64,
    /// Rays of a final gathering; 0 where the global map is seen directly.
    pub gather: u32,
    /// Rays of a final gathering that are shorter than this are traced on \[L\]: beside dark places the map's estimates would
    /// bring light from bright ones. 0 for never.
    pub near: f64,
    /// Extent of what is seen \[L\]: steps of the march are twentieths of it.
    pub size: f64,
    /// Whether steps shorten where the light changes, as in 1998: not in the cloud, where the probes of the light cost more than
    /// shorter steps bring.
    pub is_adaptive: bool,
    /// The farthest that gathers reach \[L\].
    pub reach: f64,
    /// Radiance 1 on a scale where 1 is white.
    pub exposure: f64,
    /// What stands beside it.
    pub beside: Beside,
    /// The most samples per pixel of one of the 64 passes of the reference: a pilot says how many are needed. More are taken only
    /// where a picture beside the reference has more than all passes together.
    pub reference: u64,
    /// What of the page's reference is found by light tracing.
    pub by_light: ByLight,
    /// How it is made of light read along whole rays, beside the picture; none where no medium scatters, or nothing is asked.
    pub lines: Option<Lines>,
}

/// Of a map that the scene does not need, or that nothing in the picture reads.
const NONE: Amount = Amount::Emitted(1);

/// All of them, in the order of the page.
pub const ALL: &[Picture] = &[
    Picture {
        name: "cs665-box",
        title: "The box of the lectures",
        see: "Light gathers behind the glass sphere in a caustic on the floor, and the mirror sphere throws a second one on \
              the wall. The maps beside it are what the picture was made from. The \
              number of photons and the samples are the original's; ours: their shares of the maps, 50 and 60 in an estimate.",
        original: "171,880 photons, 25 samples per pixel: 444 s on a Pentium 4 of 3 GHz",
        photons: [Amount::Stored(121_880), Amount::Stored(50_000), NONE],
        nearest: [50, 60, 100],
        samples: 25,
        gather: 6,
        near: 0.0,
        size: 2.0,
        is_adaptive: true,
        reach: 0.2,
        exposure: 1.3,
        beside: Beside::Maps,
        reference: 10,
        by_light: ByLight::NOTHING,
        lines: None,
    },
    Picture {
        name: "cognac",
        title: "A glass of cognac",
        see: "The liquid is a lens: the lamp behind the glass becomes a bright cusp on the table, in the colour that the \
              cognac lets through. Numbers of photons and samples are the original's.",
        original: "200,000 photons, 64 samples per pixel: 4 h on a Pentium of 90 MHz",
        photons: [Amount::Stored(100_000), Amount::Stored(100_000), NONE],
        nearest: [100, 60, 100],
        samples: 64,
        gather: 2,
        near: 0.0,
        size: 20.0,
        is_adaptive: true,
        reach: 1.0,
        exposure: 0.85,
        beside: Beside::Maps,
        reference: 10,
        by_light: ByLight::CAUSTICS,
        lines: None,
    },
    Picture {
        name: "cloud",
        title: "A cloud",
        see: "With single scattering alone the cloud is a grey shell, black where the sun does not reach; light scattered many \
              times fills it and makes it white. Numbers of photons and samples are ours.",
        original: "single scattering 61 s; multiple scattering 8 s for the map and 92 s for the picture; no numbers of photons",
        photons: [NONE, NONE, Amount::Stored(1_600_000)],
        nearest: [100, 60, 40],
        samples: 128,
        gather: 0,
        near: 0.0,
        size: 3.0,
        is_adaptive: false,
        reach: 0.1,
        exposure: 0.8,
        beside: Beside::Single,
        reference: 12,
        by_light: ByLight::NOTHING,
        lines: None,
    },
    Picture {
        name: "cornell-fog",
        title: "Cornell box in fog",
        see: "The lamp has a halo, the walls lend their colour to the air beside them, and shadows are lifted. Numbers of \
              photons are the original's, and 100 of them are found in an estimate, as it asks: for that estimates reach up to 30 cm. \
              Before the dark side of the low block that takes light from beyond its shadow. Samples are ours.",
        original: "200,000 photons, of them 65,000 in the volume map, 100 in an estimate: 4 s for the maps and 3 min 32 s \
                   for the picture",
        photons: [Amount::Stored(135_000), NONE, Amount::Stored(65_000)],
        nearest: [100, 60, 100],
        samples: 8,
        gather: 8,
        near: 0.25,
        // Steps of 0.2: thin fog needs no shorter ones.
        size: 4.0,
        is_adaptive: true,
        reach: 0.3,
        exposure: 1.8,
        beside: Beside::Maps,
        reference: 12,
        by_light: ByLight::NOTHING,
        lines: Some(Lines {
            parts: 1,
            points: (Amount::Stored(65_000), 0.1),
            beams: (Amount::Stored(5000), 0.1),
            // Fewer, since rays of the final gathering read them all along their way.
            planes: Some((Amount::Stored(1000), 0.1)),
        }),
    },
    Picture {
        name: "cornell-anisotropic",
        title: "The same in fog that scatters forwards",
        see: "Light keeps its direction: the lamp has a bright halo, and the air before the walls hides less of their colour. \
              Before the dark side of the low block that takes light from beyond its shadow, as above. Numbers of photons are \
              the original's, and so are the 100 that an estimate finds; ours: the mean cosine of 0.6, the samples, and the \
              reach of 30 cm.",
        original: "200,000 photons, of them 65,000 in the volume map, 100 in an estimate: 4 s for the maps and 4 min 3 s \
                   for the picture",
        photons: [Amount::Stored(135_000), NONE, Amount::Stored(65_000)],
        nearest: [100, 60, 100],
        samples: 16,
        gather: 8,
        near: 0.25,
        // Steps of 0.2: thin fog needs no shorter ones.
        size: 4.0,
        is_adaptive: true,
        reach: 0.3,
        exposure: 1.8,
        beside: Beside::Maps,
        reference: 24,
        by_light: ByLight::NOTHING,
        lines: None,
    },
    Picture {
        name: "cornell-smoke",
        title: "The same with smoke on the floor",
        see: "Smoke lies on the floor: it hides the feet of the blocks and takes up the light that falls on it; above, the air \
              is clear. Numbers of photons are the original's, and so are the 50 that an estimate in the smoke finds; ours: the 100 \
              on surfaces, the samples, and the reach of 30 cm.",
        original: "200,000 photons, of them 65,000 in the volume map, 50 in an estimate: 6 s for the maps (4 s elsewhere in \
                   the same source) and 7 min 54 s for the picture",
        photons: [Amount::Stored(135_000), NONE, Amount::Stored(65_000)],
        nearest: [100, 60, 50],
        samples: 8,
        gather: 8,
        near: 0.25,
        // Steps of 0.2: thin fog needs no shorter ones.
        size: 4.0,
        is_adaptive: true,
        reach: 0.3,
        exposure: 1.8,
        beside: Beside::Maps,
        reference: 12,
        by_light: ByLight::NOTHING,
        lines: None,
    },
    Picture {
        name: "dusty-room",
        title: "A dusty room with a stained-glass window",
        see: "The sun paints the window on the floor, and the dust shows each pane's colour on its way through the room. \
              Numbers of photons are the original's, samples are ours.",
        original: "80,000 photons in the dust, 220,000 on surfaces: 27 s for the maps and 5 min 27 s for the picture",
        photons: [Amount::Stored(220_000), NONE, Amount::Stored(80_000)],
        nearest: [100, 60, 40],
        samples: 16,
        gather: 16,
        near: 0.0,
        size: 6.0,
        is_adaptive: true,
        reach: 0.4,
        exposure: 2.2,
        beside: Beside::Maps,
        reference: 48,
        by_light: ByLight::NOTHING,
        lines: Some(Lines {
            parts: 1,
            points: (Amount::Stored(80_000), 0.15),
            beams: (Amount::Stored(5000), 0.1),
            planes: None,
        }),
    },
    Picture {
        name: "sunbeams",
        title: "Sunbeams in a flooded cave",
        see: "Waves on the water in the roof's opening gather the sun into shafts, seen from the side by what the silt scatters, \
              and draw a net of light on the bottom. Numbers of photons and samples are ours.",
        original: "from the same lectures, without numbers",
        photons: [Amount::Stored(200_000), Amount::Stored(60_000), Amount::Stored(3_000_000)],
        nearest: [20, 20, 16],
        samples: 16,
        gather: 0,
        near: 0.0,
        size: 4.0,
        is_adaptive: true,
        reach: 0.08,
        exposure: 1.3,
        beside: Beside::Maps,
        reference: 10,
        by_light: ByLight {
            layers: &[Layer::Direct, Layer::Caustic, Layer::Indirect, Layer::Single, Layer::Multiple],
            permille: 500,
            guide: 0,
        },
        lines: Some(Lines {
            parts: 4,
            points: (Amount::Stored(300_000), 0.03),
            beams: (Amount::Stored(30_000), 0.03),
            planes: None,
        }),
    },
    Picture {
        name: "pool",
        title: "A pool",
        see: "The net of light on the tiles is drawn by the same waves through which it is seen, bent as they bend the dark border; \
              the ball casts its shadow through them. Numbers of photons and samples are ours.",
        original: "the closing picture of the lectures, without numbers",
        photons: [Amount::Stored(200_000), Amount::Stored(400_000), NONE],
        nearest: [80, 16, 60],
        samples: 16,
        gather: 2,
        near: 0.0,
        size: 6.0,
        is_adaptive: true,
        reach: 0.4,
        exposure: 0.95,
        beside: Beside::Maps,
        reference: 20,
        by_light: ByLight::NOTHING,
        lines: None,
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_has_its_scene() {
        let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        for picture in ALL {
            assert!(scenes.join(format!("{}.toml", picture.name)).is_file(), "{}", picture.name);
        }
    }
}
