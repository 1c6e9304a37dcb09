//! Lights.

use super::places::hull;
use super::writer::{Writer, refuse};
use crate::error::Result;
use crate::exchange::xml::triple;
use crate::geometry::{Rectangle, Shape};
use crate::light::{Isotropic, Light};
use crate::math::FOUR_PI;
use crate::scene::Scene;

impl Writer<'_> {
    pub(super) fn lights(&mut self) -> Result<()> {
        let scene = self.scene;
        let mut around = 0;
        for (index, light) in scene.named_lights().iter().enumerate() {
            around += usize::from(matches!(light, Light::Isotropic(_)));
            self.light(index, light).map_err(|e| e.within(&format!("lights[{index}]")))?;
            if around > 1 {
                return refuse(format!("lights[{index}]: a second isotropic light; allowed: one"));
            }
        }
        Ok(())
    }

    fn light(&mut self, index: usize, light: &Light) -> Result<()> {
        match light {
            Light::Area(area) => {
                let radiance = area.radiance();
                let shape = self.before_its_wall(index, area.shape())?;
                self.shape(&format!("light-{index}"), &shape, [None, None], |xml| {
                    xml.within("bsdf", &[("type", "diffuse")], |xml| {
                        xml.rgb("reflectance", crate::Spectrum::ZERO)
                    });
                    xml.within("emitter", &[("type", "area")], |xml| xml.rgb("radiance", radiance));
                })
            }
            Light::Point(point) => {
                self.xml.within("emitter", &[("type", "point")], |xml| {
                    xml.element("point", &[("name", "position"), ("value", &triple(point.position()))]);
                    xml.rgb("intensity", light.power(None) / FOUR_PI);
                });
                Ok(())
            }
            Light::Spot(spot) => {
                let [full, edge] = spot.angles();
                if full != edge {
                    return refuse(format!(
                        "full_angle is {full} and edge_angle {edge}, between which Mitsuba's spot falls off in another way; allowed: one angle for both"
                    ));
                }
                let (position, dir) = (spot.position(), spot.dir());
                let intensity = spot.intensity(dir);
                self.xml.within("emitter", &[("type", "spot")], |xml| {
                    xml.within("transform", &[("name", "to_world")], |xml| {
                        let up = dir.any_orthonormal_vector();
                        let [origin, target, up] = [position, position + dir, up].map(triple);
                        xml.element("lookat", &[("origin", &origin), ("target", &target), ("up", &up)]);
                    });
                    xml.rgb("intensity", intensity);
                    xml.float("cutoff_angle", edge);
                    xml.float("beam_width", edge);
                });
                Ok(())
            }
            Light::Sun(sun) => {
                if sun.has_portal() {
                    return refuse("portal: Mitsuba has none; allowed: a sun without");
                }
                if !sun.is_delta() {
                    return refuse(
                        "angular_radius: Mitsuba has no disc of even radiance far away; allowed: 0",
                    );
                }
                self.xml.within("emitter", &[("type", "directional")], |xml| {
                    xml.element("vector", &[("name", "direction"), ("value", &triple(sun.dir()))]);
                    xml.rgb("irradiance", sun.irradiance());
                });
                Ok(())
            }
            Light::Isotropic(isotropic) => {
                surrounds(self.scene, isotropic)?;
                self.xml.within("emitter", &[("type", "constant")], |xml| {
                    xml.rgb("radiance", isotropic.radiance())
                });
                Ok(())
            }
            Light::Beam(_) => refuse(
                "beam: Mitsuba's collimated beams are out of reach of its path tracers; allowed: area, point, spot, sun and isotropic lights",
            ),
            Light::VolumeSource(_) => refuse(
                "volume-source: Mitsuba has none; allowed: area, point, spot, sun and isotropic lights",
            ),
            Light::MediumEmission(_) => refuse("a medium that emits, which Mitsuba has not"),
        }
    }

    /// A lamp that lies in the plane of another rectangle, which Mitsuba would take now the one and now the other of: in front
    /// of it.
    fn before_its_wall(&mut self, index: usize, shape: &Shape) -> Result<Shape> {
        let Shape::Rectangle(lamp) = shape else { return Ok(shape.clone()) };
        let is_in_one_plane = |wall: &Shape| match wall {
            Shape::Rectangle(wall) => wall.overlaps(lamp),
            Shape::Cuboid(block) => block.faces().iter().any(|face| face.overlaps(lamp)),
            _ => false,
        };
        if !self.scene.objects().iter().any(|object| is_in_one_plane(&object.shape)) {
            return Ok(shape.clone());
        }
        let step = 2.0 * self.nearest;
        self.notes.push(format!("lights[{index}] lies in a wall: it is written {step:.1e} before it"));
        let [a, b, _, d] = lamp.corners();
        Ok(Shape::Rectangle(Rectangle::new(a + step * lamp.normal(), b - a, d - a)?))
    }
}

/// Refuses isotropic light that does not come from all around whatever there is.
fn surrounds(scene: &Scene, isotropic: &Isotropic) -> Result<()> {
    let shape = isotropic.shape();
    let holds = |body: &Shape| match body {
        _ if body == shape => true,
        // What fills it is inside too.
        Shape::Sphere(ball) => shape.room(ball.center()) >= ball.radius(),
        Shape::Slab(_) => false,
        _ => hull(body).iter().all(|p| shape.room(*p) >= 0.0),
    };
    let bodies = scene.objects().iter().map(|object| &object.shape);
    let lamps = scene.named_lights().iter().filter_map(Light::body);
    let regions = scene.regions().iter().map(|region| &region.shape);
    let eye = scene.camera().is_none_or(|camera| shape.room(camera.position()) > 0.0);
    if !(eye && bodies.chain(lamps).chain(regions).all(holds)) {
        return refuse(
            "isotropic light is Mitsuba's light from all around, which reaches all there is; allowed: a shape about the camera, all media and all surfaces",
        );
    }
    Ok(())
}
