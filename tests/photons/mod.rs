//! Photons: their tree, their estimates, the maps and what reads them.

mod accepted_surface;
mod advise;
mod along_rays;
mod beam_blur;
mod beams;
mod boundary;
mod estimators;
mod importance;
mod mapper;
mod mapper_march;
mod maps;
mod march;
mod metrics;
mod parted;
mod passes;
mod planes;
mod progressive;
mod ray_ends;
mod sensor_maps;
mod statistics;
mod surface_estimates;
mod synthetic;
mod tree;
