//! Emitters and the camera.

use super::document::Element;
use super::importer::{Importer, light_channels};
use super::part::Part;
use crate::Spectrum;
use crate::error::Result;
use crate::math::{FOUR_PI, cos};
use crate::scene::{CameraFile, Filter, LightFile};
use glam::DVec3;
use std::f64::consts::PI;

impl<'a> Importer<'a> {
    /// A light without a body.
    pub(super) fn emitter(&mut self, element: &'a Element) -> Result<()> {
        let part = Part::new(element, self.ids)?;
        let power = |name: &str, factor: f64| -> Result<_> {
            let value = part.color(name)?.map_or(Spectrum::ONE, |color| color.of_light());
            light_channels(element, name, value * factor)
        };
        let transform = part.transform("to_world")?;
        let (origin, forward) = (transform.point(DVec3::ZERO), transform.vector(DVec3::Z));
        let light = match part.kind() {
            "point" => {
                let position = part.vector("position")?.unwrap_or(origin);
                LightFile::Point { position: position.to_array(), power: power("intensity", FOUR_PI)? }
            }
            "spot" => {
                let cutoff = part.float("cutoff_angle")?.unwrap_or(20.0);
                let width = part.float("beam_width")?.unwrap_or(0.75 * cutoff);
                if width != cutoff {
                    return part.refuse(format!(
                        "beam_width is {width} and cutoff_angle {cutoff}, between which turbid's spot falls off in another way; allowed: one angle for both"
                    ));
                }
                let cone = 2.0 * PI * (1.0 - cos(cutoff.to_radians()));
                LightFile::Spot {
                    position: origin.to_array(),
                    dir: forward.to_array(),
                    full_angle: cutoff,
                    edge_angle: cutoff,
                    power: power("intensity", cone)?,
                }
            }
            "directional" => LightFile::Sun {
                dir: part.vector("direction")?.unwrap_or(forward).to_array(),
                irradiance: power("irradiance", 1.0)?,
                angular_radius: 0.0,
                portal: None,
            },
            "constant" => {
                let radiance = power("radiance", 1.0)?;
                part.finish()?;
                return self.light_from_around(element, radiance);
            }
            other => {
                return part.refuse(format!(
                    "an emitter of type `{other}` is not imported; allowed: point, spot, directional, constant, and area in a shape"
                ));
            }
        };
        part.finish()?;
        self.lights.push(light);
        Ok(())
    }

    /// The camera.
    pub(super) fn sensor(&mut self, element: &'a Element) -> Result<()> {
        if self.camera.is_some() {
            return element.refuse("a second sensor; allowed: one");
        }
        let part = Part::new(element, self.ids)?;
        if part.kind() != "perspective" {
            return part
                .refuse(format!("a sensor of type `{}` is not imported; allowed: perspective", part.kind()));
        }
        part.pass_over(&["near_clip", "far_clip", "shutter_open", "shutter_close", "focus_distance"]);
        part.parts("sampler")?;
        let (width, height, filter) = self.film(part.part("film")?)?;
        let Some(fov) = part.float("fov")? else {
            return part.refuse("a perspective sensor without fov; allowed: one");
        };
        if !(fov > 0.0 && fov < 180.0) {
            return part.refuse(format!("fov is {fov}; allowed: above 0 and below 180"));
        }
        let aspect = f64::from(width) / f64::from(height);
        let axis = part.string("fov_axis")?.unwrap_or("x");
        // Width over the side that the angle spans.
        let ratio = match axis {
            "x" => 1.0,
            "y" => aspect,
            "smaller" => aspect.max(1.0),
            "larger" => aspect.min(1.0),
            "diagonal" => aspect / libm::hypot(aspect, 1.0),
            other => {
                return part
                    .refuse(format!("fov_axis is `{other}`; allowed: x, y, diagonal, smaller, larger"));
            }
        };
        let fov = match ratio {
            1.0 => fov,
            ratio => 2.0 * crate::math::atan2(ratio * libm::tan(0.5 * fov.to_radians()), 1.0).to_degrees(),
        };
        let transform = part.transform("to_world")?;
        if transform.even_scale().is_none() {
            return part.refuse("to_world of the sensor is skewed; allowed: rotate, translate, lookat");
        }
        let origin = transform.point(DVec3::ZERO);
        let [position, look_at, up] = transform
            .look_at
            .unwrap_or_else(|| [origin, origin + transform.vector(DVec3::Z), transform.vector(DVec3::Y)]);
        self.camera_medium = part.part("medium")?;
        part.finish()?;
        self.camera_place = Some(element);
        self.camera = Some(CameraFile {
            position: position.to_array(),
            look_at: look_at.to_array(),
            up: up.to_array(),
            fov,
            width,
            height,
            filter,
        });
        Ok(())
    }

    fn film(&mut self, element: Option<&'a Element>) -> Result<(u32, u32, Filter)> {
        let Some(element) = element else { return Ok((768, 576, Filter::Box)) };
        let part = Part::new(element, self.ids)?;
        if part.kind() != "hdrfilm" {
            return part
                .refuse(format!("a film of type `{}` is not imported; allowed: hdrfilm", part.kind()));
        }
        part.pass_over(&["file_format", "pixel_format", "component_format", "sample_border", "compensate"]);
        let size = (part.count("width", 768)?, part.count("height", 576)?);
        let filter = match part.part("rfilter")? {
            Some(filter) if filter.attribute("type") == Some("box") => Filter::Box,
            Some(filter) if filter.attribute("type") == Some("tent") && filter.children.is_empty() => {
                Filter::Tent
            }
            other => {
                let given = other.and_then(|filter| filter.attribute("type")).unwrap_or("gaussian");
                let text = format!("{}: the filter `{given}` is read as box", element.place());
                self.notes.push(text);
                Filter::Box
            }
        };
        part.finish()?;
        Ok((size.0, size.1, filter))
    }
}
