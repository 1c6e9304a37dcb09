//! Each experiment, whole, on few photons, through its own command: two at a time.
#![allow(clippy::unwrap_used, reason = "tests")]

mod run;

mod bias;
mod blur;
mod boundary;
mod claims_1998;
mod coverage;
mod debiasing;
mod dimension;
mod extremes;
mod march;
mod pages;
mod progressive;
mod rates;
mod selection;
mod tradeoff;
mod transmittance;
