//! turbid: what does photon mapping's speed cost in accuracy, when light travels through fog, water or smoke?
//!
//! By meaning, from the bottom up: [`math`], [`spectrum`], [`rng`] and [`stats`] know no light; [`phase`],
//! [`medium`], [`surface`], [`light`] and [`geometry`] are what a [`scene`] is made of; [`transport`] is the random
//! walk that paths and photons share; [`photons`] keeps what it meets, in [`photons::maps`] for pictures;
//! [`estimators`] read it; [`integrators`] make radiance by class of path: the path tracer [`integrators::path`] and the
//! photon mapper [`integrators::mapper`]; [`sensor`] turns both into numbers with standard errors, and into pictures on a
//! [`sensor::Film`]; [`input`] reads files of a bounded size, [`memory`] says what is free; [`output`] writes files that appear whole or not at all.
//!
//! # What is here, and what is not yet
//!
//! - Exact, in double precision, each value with its bound: slabs of any phase function, thickness 1e-12 to 1e9, g from -0.95 to 0.99,
//!   with radiance at any depth and azimuth, by order of scattering, and between refracting faces (fluxes and fluence only);
//!   layers of different media over a ground; half-spaces; spheres, cavities and critical bodies of isotropic scattering; point
//!   sources in unbounded media; kernel theory: moments, blur, edges, sinusoids, beams, the k nearest rule, progressive passes,
//!   treatments of the boundary of slabs, spheres and cuboids, false photons.
//! - Simulated: media in slabs, spheres and cuboids, homogeneous, on grids (`.vol` and `.npy` files), as clouds and thinning out with
//!   height, that absorb, scatter and emit, also within glass and in one another; phase functions of one and two
//!   Henyey-Greenstein terms, Schlick, Rayleigh, tables; diffuse surfaces with textures, mirrors, smooth dielectrics, coloured filters;
//!   meshes, lathes, height fields; point, spot, area and beam lights, the sun (also through a window), isotropic incidence, volume
//!   sources; fluence, radiance along rays, reflectance, transmittance, absorptance; estimates with four treatments of boundaries and
//!   five rejections of false photons.
//! - Pictures: by three photon maps with final gathering and the march of 1998, by paths, and by light tracing, in the same layers;
//!   importance; the maps themselves, drawn and exported; a gallery of nine scenes (`results/gallery`),
//!   each compared with an unbiased reference block by block: the page says which agree, which differ, and where too little can be judged.
//! - Measured: the nine experiments above, on fluences in slabs, spheres, cuboids and shafts, on radiances along marched rays, and
//!   on pixels of boxes of fog.
//! - Not here: exact spheres of anisotropic scattering, exact radiance between refracting faces, layers of different index,
//!   polarisation. Rough glass and glossy surfaces, spectra of more than three channels, motion. Progressive photon maps,
//!   beams, connections between paths from the eye and from the lights: caustics seen in mirrors and through glass, by lights
//!   small or without extent, have no unbiased reference. Regions and lights' volumes are spheres, cuboids and slabs.

pub mod error;
pub mod estimators;
pub mod exchange;
pub mod faults;
pub mod geometry;
pub mod input;
pub mod integrators;
pub mod light;
pub mod math;
pub mod medium;
pub mod memory;
pub mod output;
pub mod phase;
pub mod photons;
pub mod rng;
pub mod scene;
pub mod sensor;
pub mod spectrum;
pub mod stats;
pub mod surface;
pub mod transport;

pub use error::{Error, Result};
pub use spectrum::Spectrum;
