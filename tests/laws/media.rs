//! Densities: bounds hold, by cell; and media through every way of tracking.

use crate::checks::media;

#[test]
fn samples_lie_in_the_middles_of_cells() {
    media::samples_lie_in_the_middles_of_cells();
}

#[test]
fn each_channel_passes_as_its_depth_says() {
    media::each_channel_passes_as_its_depth_says();
}
