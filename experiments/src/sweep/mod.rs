//! Scenes by chance: does every method give every valid scene the same light?
//!
//! `sweep` draws valid scenes (`draw`): all shapes from outside and inside, surfaces, textures, nested and index-matched
//! interiors, media, phase functions, lights and cameras, in the open, in rooms and in a tank, between a thousandth and a
//! thousand units wide, with bodies that touch. Each is rendered in 16 x 12 pixels by every method (`measure`), and what they
//! make is compared by layer, channel and quarter of the picture (`compare`). A scene runs in a process of its own, so that
//! one that panics or never ends stops no other.
//!
//! # What is compared
//!
//! - **Light tracing and paths**, both unbiased, where the eye sees no specular body: light tracing knows only that.
//! - **The scene in other words** (`pairs`): turned, mirrored, moved, rescaled, a body, region or light in two, its lights in
//!   another order, or with the full plan; by paths, and by light tracing where paths cannot sample all of it.
//! - **Energy by channel**: photons carry the power of the lights, and what is absorbed and escapes is what was emitted.
//! - **Photon maps** as the command reads them, with N and with 8 N photons, against paths. Layers that read no map are
//!   unbiased and tested as such. The error of the others must shrink with the radius, below.
//! - **Failures**: an error, a panic, a history without end. A valid scene is refused by no method, with two exceptions: a
//!   camera that is shut in is refused by every method, and photons cannot start in a medium that emits and has no end.
//!
//! # Criteria
//!
//! *Two unbiased means* differ by chance as Student's t says: 64 independent repetitions each, Welch's degrees of freedom. A
//! number whose variance is itself unknown is not tested: variance of variance above 0.1, or single paths or histories with a
//! tail of shape 1/2 or more, whose largest contributions may not have been drawn (a lamp that paths find in a mirror, after
//! a collision, with one in 20,000).
//!
//! *Photon maps.* An estimate from a radius r reads the mean of its field over r. Where the field is smooth the error of that is
//! in proportion to r^2; within r of an edge (a shadow's, a body's, a medium's) it is of the order of the field, and the part of a quarter
//! that lies so is in proportion to r. Summed, D(r) = a r + b r^2 + ..., so that from r1 to a smaller r2 the error falls at least in
//! their ratio q = r2/r1: |D(r2)| <= q |D(r1)|. With the same number of nearest photons of 8 times as many q is 8^(-1/3) = 0.5 in
//! media, where the volume is shared out, and 8^(-1/2) = 0.35 on surfaces. What exceeds that, by more than chance, is no
//! matter of the radius. (The reach of an estimate that finds too few is made larger in the same ratio at N, so that r
//! shrinks there too. Errors of either sign may cancel at r1 in one quarter: the largest of the four counts. A bright spot beside a dark quarter
//! counts as the inverse of the disc, more in the smaller one: a hundredth of the brightest quarter is no error of another.)
//!
//! *Alarms.* A number with p < 10^-4 is measured once more, on another seed with four times the samples of the whole
//! effort. Only these second numbers decide, by Holm over all of them in the run, family-wise 10^-3: the family is what the first ones chose, and its
//! data are independent of the choice. Both are printed, with the smallest scene that still shows an alarm
//! (`shrink`).
//!
//! *Sharpness.* Every number says the smallest deviation that it would have shown with 99 per cent power,
//! (t + 2.4) standard errors at 10^-4, and what the radius explains besides. In a layer and channel that is the number of the
//! sharpest comparison of unbiased pictures; where the layer is made by photon maps, the larger of this and that of the maps.
//! A scene's number is the median over light: half of it is where so much would have been detected. Above 20 per cent
//! the scene counts as undecided; a run in which more than a tenth is so does not pass.
//!
//! # Cost
//!
//! A pilot counts rays and look-ups, and sets the samples of each method; the clock only stops what takes many times longer
//! (undecided), or does not come back at all (an alarm). So results are a function of the seed. Each seed leaves a small
//! file under `results/local/sweep`, whole or not at all: a run that is interrupted goes on.

pub mod compare;
pub mod draw;
pub mod energy;
pub mod examine;
pub mod maps;
pub mod measure;
pub mod motion;
pub mod pairs;
mod run;
mod settings;
pub mod shapes;
pub mod shrink;
pub mod text;

pub use run::main;
