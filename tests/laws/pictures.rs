//! Pictures: what their files and their exposure say of each channel.

use crate::checks::outputs;

#[test]
fn each_channel_has_its_own_variance() {
    outputs::each_channel_has_its_own_variance();
}

#[test]
fn channels_weigh_as_the_eye_has_it() {
    outputs::channels_weigh_as_the_eye_has_it();
}
