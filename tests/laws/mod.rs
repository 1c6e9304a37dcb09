//! The laws: what every phase function, warp, light, shape, flight and roulette obeys, over its whole domain.

mod blocks;
mod color;
mod emitters;
mod flight;
mod fresnel;
mod interiors;
mod lights;
mod media;
mod phase;
mod pictures;
mod projection;
mod roulette;
mod shapes;
mod warps;
