//! A scene as a scene of Mitsuba 3, which renders to the same values in its variants `scalar_rgb` and `llvm_ad_rgb`.

mod lights;
mod media;
mod phase;
mod places;
mod shapes;
mod writer;

use super::Beside;
use super::xml::{Xml, number, triple};
use crate::error::Result;
use crate::scene::{Camera, Filter, Object, Scene};
use crate::surface::{Surface, Texture};
use places::{Places, is_there};
use writer::{Writer, refuse};

/// A scene of Mitsuba.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// The XML file.
    pub text: String,
    /// Files that it names.
    pub files: Vec<Beside>,
    /// What is not quite the same.
    pub notes: Vec<String>,
}

/// A scene that is smaller is less than 500 times as large as the step by which Mitsuba's rays leave surfaces \[L\].
const SMALLEST: f64 = 0.05;

/// Rays of Mitsuba leave a surface by 1500 roundings of single precision, of 1 and the largest coordinate together; shapes
/// that are to be told apart are twice as far from each other.
const APART: f64 = 2.0 * 1500.0 / (1u64 << 24) as f64;

/// Writes a scene as one of Mitsuba 3; names of files beside it begin with `stem`.
///
/// # Errors
/// `Error::Scene` that names what Mitsuba cannot say
pub fn to_mitsuba(scene: &Scene, stem: &str) -> Result<Exported> {
    let Some(camera) = scene.camera() else {
        return refuse("the scene has no camera; allowed: one with [camera]");
    };
    if scene.periodic_cell().is_some() {
        return refuse(
            "cell: Mitsuba has no worlds that repeat themselves; allowed: bounded media and shapes",
        );
    }
    let (center, radius) = scene
        .bounds_of_bounded()
        .map_or((camera.position(), 0.0), |sphere| (sphere.center(), sphere.radius()));
    let size = radius + center.distance(camera.position());
    let far = center.abs().max_element() + radius;
    let nearest = APART * (1.0 + far);
    let places = Places::of(scene, nearest)?;
    if size < SMALLEST {
        return refuse(format!(
            "the scene is {} in size, and rays of Mitsuba leave surfaces by 9e-5; allowed: {SMALLEST} or more, as in another unit of length",
            number(size)
        ));
    }
    let mut writer = Writer {
        scene,
        stem,
        xml: Xml::default(),
        files: Vec::new(),
        notes: places.notes().to_vec(),
        nearest,
    };
    writer.notes.extend(places::near_glass(scene, nearest));
    if !scene.sensors().is_empty() {
        writer.notes.push(format!(
            "{} sensors are left out: only the camera's picture is written",
            scene.sensors().len()
        ));
    }
    writer.scene_element(camera, &places, size)?;
    let Writer { xml, files, notes, .. } = writer;
    Ok(Exported { text: xml.into_text(), files, notes })
}

impl Writer<'_> {
    fn scene_element(&mut self, camera: &Camera, places: &Places, size: f64) -> Result<()> {
        // Elements within elements, but with errors: their text is made apart.
        let mut outer = std::mem::take(&mut self.xml);
        let mut failure = Ok(());
        outer.within("scene", &[("version", "3.0.0")], |xml| {
            std::mem::swap(&mut self.xml, xml);
            failure = self.parts(camera, places, size);
            std::mem::swap(&mut self.xml, xml);
        });
        self.xml = outer;
        failure
    }

    fn parts(&mut self, camera: &Camera, places: &Places, size: f64) -> Result<()> {
        let scene = self.scene;
        self.xml
            .remark("Written by turbid: lengths in units of the scene, rgb linear, radiance in W/(L^2 sr).");
        self.xml.element("default", &[("name", "spp"), ("value", "64")]);
        let is_grey = |number: &usize| media::is_grey(scene.medium(*number));
        let used = places.used(scene);
        // Free flights of `volpath` are drawn by one channel, weights of the others have no bound.
        let kind = if used.iter().all(is_grey) { "volpath" } else { "volpathmis" };
        self.xml.within("integrator", &[("type", kind)], |xml| xml.value("integer", "max_depth", "-1"));
        for &number in &used {
            self.medium(number, places)?;
        }
        self.camera(camera, places, size);
        for (index, region) in places.regions() {
            self.region(index, region, places)?;
        }
        for (index, object) in scene.objects().iter().enumerate() {
            self.object(index, object, places).map_err(|e| e.within(&format!("objects[{index}]")))?;
        }
        self.lights()
    }

    fn camera(&mut self, camera: &Camera, places: &Places, size: f64) {
        let view = *camera.view();
        let within = places.medium_at(self.scene, camera.position()).map(|number| self.medium_name(number));
        self.xml.within("sensor", &[("type", "perspective")], |xml| {
            xml.value("string", "fov_axis", "x");
            xml.float("fov", view.fov);
            // What is nearer than the one or farther than the other is cut off.
            xml.float("near_clip", 1e-5 * size);
            xml.float("far_clip", 100.0 * size);
            xml.within("transform", &[("name", "to_world")], |xml| {
                let [origin, target, up] = [view.position, view.look_at, view.up].map(triple);
                xml.element("lookat", &[("origin", &origin), ("target", &target), ("up", &up)]);
            });
            if let Some(medium) = within {
                xml.element("ref", &[("id", &medium)]);
            }
            xml.within("sampler", &[("type", "independent")], |xml| {
                xml.value("integer", "sample_count", "$spp")
            });
            xml.within("film", &[("type", "hdrfilm")], |xml| {
                xml.value("integer", "width", &view.width.to_string());
                xml.value("integer", "height", &view.height.to_string());
                xml.value("string", "pixel_format", "rgb");
                xml.value("string", "component_format", "float32");
                match view.filter {
                    Filter::Box => xml.element("rfilter", &[("type", "box")]),
                    Filter::Tent => {
                        // Samples beside the picture count in its outermost pixels.
                        xml.value("boolean", "sample_border", "true");
                        xml.element("rfilter", &[("type", "tent")]);
                    }
                }
            });
        });
    }

    /// A body, with its surface.
    fn object(&mut self, index: usize, object: &Object, places: &Places) -> Result<()> {
        let (scene, name) = (self.scene, format!("object-{index}"));
        match &object.surface {
            Surface::Dielectric(boundary) => {
                let [inside, outside] = [boundary.inside(), boundary.outside()];
                let about = places.region_about(&object.shape, inside == 0 || outside == 0)?;
                let medium = |interior: usize| match interior {
                    0 => about,
                    filled => scene.filling(filled).filter(|number| is_there(scene.medium(*number))),
                };
                let sides = [medium(inside), medium(outside)];
                let index = [inside, outside].map(|interior| scene.interiors()[interior].index);
                self.shape(&name, &object.shape, sides, |xml| {
                    if boundary.is_matched() {
                        xml.element("bsdf", &[("type", "null")]);
                    } else {
                        xml.within("bsdf", &[("type", "dielectric")], |xml| {
                            xml.float("int_ior", index[0]);
                            xml.float("ext_ior", index[1]);
                        });
                    }
                })
            }
            surface => {
                let bsdf = opaque(surface)?;
                self.shape(&name, &object.shape, [None, None], bsdf)
            }
        }
    }
}

/// The constant value of a texture.
fn constant(texture: &Texture, name: &str) -> Result<crate::Spectrum> {
    match texture {
        Texture::Constant(value) => Ok(*value),
        Texture::Image(_) | Texture::Checker(_) | Texture::Wood(_) => {
            refuse(format!("{name} varies, which is not exported; allowed: a number or three"))
        }
    }
}

/// The scattering function of a surface that is no boundary.
fn opaque(surface: &Surface) -> Result<impl FnOnce(&mut Xml) + use<>> {
    enum Kind {
        Diffuse(crate::Spectrum),
        Mirror(crate::Spectrum),
        Filter(f64),
    }
    let kind = match surface {
        Surface::Lambertian(s) => Kind::Diffuse(constant(s.texture(), "reflectance")?),
        Surface::Mirror(s) => Kind::Mirror(s.reflectance()),
        Surface::Filter(s) => {
            let passed = constant(s.texture(), "transmittance")?;
            if !passed.is_grey() {
                return refuse(
                    "transmittance of a filter has a colour, which Mitsuba's mask has not; allowed: one number",
                );
            }
            Kind::Filter(passed[0])
        }
        Surface::Black(_) | Surface::Dielectric(_) => Kind::Diffuse(crate::Spectrum::ZERO),
    };
    Ok(move |xml: &mut Xml| match kind {
        Kind::Diffuse(reflectance) => xml.within("bsdf", &[("type", "twosided")], |xml| {
            xml.within("bsdf", &[("type", "diffuse")], |xml| xml.rgb("reflectance", reflectance));
        }),
        Kind::Mirror(reflectance) => xml.within("bsdf", &[("type", "twosided")], |xml| {
            xml.within("bsdf", &[("type", "conductor")], |xml| {
                xml.value("string", "material", "none");
                xml.rgb("specular_reflectance", reflectance);
            });
        }),
        Kind::Filter(passed) => xml.within("bsdf", &[("type", "mask")], |xml| {
            xml.float("opacity", 1.0 - passed);
            xml.within("bsdf", &[("type", "diffuse")], |xml| xml.rgb("reflectance", crate::Spectrum::ZERO));
        }),
    })
}
