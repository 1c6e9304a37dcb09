//! The instrument's own numbers against closed cases: moments, errors, tests; what they promise and what they drop.

use turbid::stats::student_p;

#[test]
fn moments_by_hand() {
    crate::checks::numbers::moments_by_hand();
}

#[test]
fn nothing_non_finite_is_dropped() {
    crate::checks::numbers::nothing_non_finite_is_dropped();
}

#[test]
fn a_long_mean_does_not_drift() {
    crate::checks::numbers::a_long_mean_does_not_drift();
}

#[test]
fn false_alarms_are_as_rare_as_promised() {
    crate::checks::numbers::false_alarms_are_as_rare_as_promised(|z| student_p(z, 7));
}
