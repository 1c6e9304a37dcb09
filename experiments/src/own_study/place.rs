//! What is measured: one number each.

use crate::harness::Unit;

/// One measured number: a sensor, a bin of it, a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Its name, unique in the scene.
    pub name: String,
    /// What it is one of: the layer of a picture; nothing of a sensor. Errors are told of the first group.
    pub group: &'static str,
    /// Number of the sensor.
    pub sensor: usize,
    /// Number of the bin.
    pub bin: usize,
    /// Channel.
    pub channel: usize,
    /// Unit of the number.
    pub unit: Unit,
    /// A point that it belongs to: the probe, the origin of the ray, the middle of the bin \[L\]; the block of a picture.
    pub at: [f64; 3],
}
