//! Channels keep apart: lights, fillings, media and their emission, each in its own colour.

use crate::checks::color;

#[test]
fn two_lights_keep_their_colors() {
    color::two_lights_keep_their_colors();
}

#[test]
fn photons_carry_each_lights_power() {
    color::photons_carry_each_lights_power();
}

#[test]
fn a_colored_filling_passes_each_channel() {
    color::a_colored_filling_passes_each_channel();
}

#[test]
fn colored_media_beside_a_varying_one() {
    color::colored_media_beside_a_varying_one();
}

#[test]
fn emission_is_reported_by_channel() {
    color::emission_is_reported_by_channel();
}

#[test]
fn medium_emission_has_the_color_of_its_place() {
    color::medium_emission_has_the_color_of_its_place();
}

#[test]
fn channels_in_another_order_change_nothing_else() {
    color::channels_in_another_order_change_nothing_else();
}

#[test]
fn photons_carry_the_power_of_all_lights() {
    color::photons_carry_the_power_of_all_lights();
}
