//! A plugin of Mitsuba: its named values, its parts, and a refusal of all that nobody asked for.

use super::document::{Element, shown};
use crate::Spectrum;
use crate::error::Result;
use glam::{DMat3, DMat4, DVec3};
use std::cell::RefCell;
use std::collections::HashMap;

/// Elements by their `id`.
pub(super) type Ids<'a> = HashMap<&'a str, &'a Element>;

/// An element of which each child must be asked for.
pub(super) struct Part<'a> {
    pub element: &'a Element,
    ids: &'a Ids<'a>,
    asked: RefCell<Vec<bool>>,
}

/// A value with channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Color {
    /// The same, as it is given.
    Plain(Spectrum),
    /// A spectrum that is the same at every wavelength: of lights it is not white.
    Even(f64),
}

impl Color {
    /// Of what reflects, scatters or extinguishes.
    pub fn of_matter(self) -> Spectrum {
        match self {
            Color::Plain(value) => value,
            Color::Even(x) => Spectrum::grey(x),
        }
    }

    /// Of what emits. The colour of a spectrum of 1 everywhere is what Mitsuba 3.9 makes of one (CIE 1931, sRGB primaries).
    pub fn of_light(self) -> Spectrum {
        match self {
            Color::Plain(value) => value,
            Color::Even(x) => Spectrum::rgb(1.204_794, 0.948_291, 0.908_916) * x,
        }
    }
}

/// Numbers between spaces or commas.
pub(super) fn numbers(element: &Element, text: &str) -> Result<Vec<f64>> {
    text.split([' ', ',', '\t', '\n', '\r'])
        .filter(|word| !word.is_empty())
        .map(|word| match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => element.refuse(format!("{}: `{}` is not a finite number", element.name(), shown(word))),
        })
        .collect()
}

impl<'a> Part<'a> {
    pub fn new(element: &'a Element, ids: &'a Ids<'a>) -> Result<Self> {
        let names = element.children.iter().filter_map(|child| child.attribute("name"));
        let mut seen = Vec::new();
        for name in names {
            if seen.contains(&name) {
                return element.refuse(format!(
                    "{} has `{}` twice; allowed: once",
                    element.name(),
                    shown(name)
                ));
            }
            seen.push(name);
        }
        Ok(Part { element, ids, asked: RefCell::new(vec![false; element.children.len()]) })
    }

    /// The type of the plugin.
    pub fn kind(&self) -> &'a str {
        self.element.attribute("type").unwrap_or_default()
    }

    pub fn refuse<T>(&self, text: impl std::fmt::Display) -> Result<T> {
        self.element.refuse(text)
    }

    /// A named child.
    pub fn named(&self, name: &str) -> Option<&'a Element> {
        let at = self.element.children.iter().position(|child| child.attribute("name") == Some(name))?;
        self.asked.borrow_mut()[at] = true;
        Some(&self.element.children[at])
    }

    fn value(&self, name: &str, tags: &[&str]) -> Result<Option<(&'a Element, &'a str)>> {
        let Some(child) = self.named(name) else { return Ok(None) };
        match child.attribute("value") {
            Some(value) if tags.contains(&child.tag.as_str()) => Ok(Some((child, value))),
            _ => child.refuse(format!("{}; allowed: <{}> with a value", child.name(), tags.join("> or <"))),
        }
    }

    pub fn float(&self, name: &str) -> Result<Option<f64>> {
        let Some((child, value)) = self.value(name, &["float", "integer"])? else { return Ok(None) };
        match numbers(child, value)?[..] {
            [x] => Ok(Some(x)),
            _ => child.refuse(format!("{} has several numbers; allowed: one", child.name())),
        }
    }

    pub fn count(&self, name: &str, otherwise: u32) -> Result<u32> {
        let Some((child, value)) = self.value(name, &["integer"])? else { return Ok(otherwise) };
        value.trim().parse().map_err(|_| {
            child.error(format!("{} is `{}`; allowed: a whole number", child.name(), shown(value)))
        })
    }

    pub fn flag(&self, name: &str) -> Result<Option<bool>> {
        let Some((child, value)) = self.value(name, &["boolean"])? else { return Ok(None) };
        match value.trim() {
            "true" => Ok(Some(true)),
            "false" => Ok(Some(false)),
            other => child.refuse(format!("{} is `{}`; allowed: true, false", child.name(), shown(other))),
        }
    }

    pub fn string(&self, name: &str) -> Result<Option<&'a str>> {
        Ok(self.value(name, &["string"])?.map(|(_, value)| value))
    }

    /// A point or vector.
    pub fn vector(&self, name: &str) -> Result<Option<DVec3>> {
        let Some(child) = self.named(name) else { return Ok(None) };
        if !["point", "vector"].contains(&child.tag.as_str()) {
            return child.refuse(format!("{}; allowed: <point> or <vector>", child.name()));
        }
        Ok(Some(triple(child, 0.0)?))
    }

    pub fn color(&self, name: &str) -> Result<Option<Color>> {
        let Some((child, value)) = self.value(name, &["rgb", "spectrum", "float"])? else { return Ok(None) };
        color(child, value).map(Some)
    }

    /// A transform.
    pub fn transform(&self, name: &str) -> Result<Transform> {
        let Some(child) = self.named(name) else { return Ok(Transform::default()) };
        if child.tag != "transform" {
            return child.refuse(format!("{}; allowed: <transform>", child.name()));
        }
        Transform::new(child)
    }

    /// Children of a kind, with their names, where they stand or where a `ref` leads.
    pub fn parts(&self, tag: &str) -> Result<Vec<(Option<&'a str>, &'a Element)>> {
        let mut found = Vec::new();
        for (i, child) in self.element.children.iter().enumerate() {
            let target = match child.tag.as_str() {
                "ref" => {
                    let id = child.attribute("id").unwrap_or_default();
                    match self.ids.get(id) {
                        Some(target) => target,
                        None => {
                            return child
                                .refuse(format!("<ref id=\"{}\">: no element has this id", shown(id)));
                        }
                    }
                }
                _ => child,
            };
            if target.tag == tag {
                self.asked.borrow_mut()[i] = true;
                found.push((child.attribute("name"), target));
            }
        }
        Ok(found)
    }

    /// The one child of a kind, if there is one.
    pub fn part(&self, tag: &str) -> Result<Option<&'a Element>> {
        let parts = self.parts(tag)?;
        match parts[..] {
            [] => Ok(None),
            [(_, element)] => Ok(Some(element)),
            _ => self.refuse(format!("{} has {} of <{tag}>; allowed: one", self.element.name(), parts.len())),
        }
    }

    /// Children that say nothing here.
    pub fn pass_over(&self, names: &[&str]) {
        names.iter().for_each(|name| {
            self.named(name);
        });
    }

    /// Refuses what nobody has asked for.
    pub fn finish(&self) -> Result<()> {
        let asked = self.asked.borrow();
        match self.element.children.iter().zip(asked.iter()).find(|(_, asked)| !**asked) {
            Some((child, _)) => {
                child.refuse(format!("{} of {} is not imported", child.name(), self.element.name()))
            }
            None => Ok(()),
        }
    }
}

/// A colour of an element.
pub(super) fn color(element: &Element, value: &str) -> Result<Color> {
    if value.contains(['#', ':']) {
        return element.refuse(format!("{} is `{}`; allowed: numbers", element.name(), shown(value)));
    }
    match (element.tag.as_str(), &numbers(element, value)?[..]) {
        ("rgb", [x]) | ("float", [x]) => Ok(Color::Plain(Spectrum::grey(*x))),
        ("rgb", [r, g, b]) => Ok(Color::Plain(Spectrum::rgb(*r, *g, *b))),
        ("spectrum", [x]) => Ok(Color::Even(*x)),
        (_, found) => element.refuse(format!(
            "{} has {} numbers; allowed: one, or three of <rgb>",
            element.name(),
            found.len()
        )),
    }
}

/// Three numbers: attributes x, y and z, or a value.
fn triple(element: &Element, otherwise: f64) -> Result<DVec3> {
    if let Some(value) = element.attribute("value") {
        return match numbers(element, value)?[..] {
            [x, y, z] => Ok(DVec3::new(x, y, z)),
            _ => element.refuse(format!("{} is `{}`; allowed: three numbers", element.name(), shown(value))),
        };
    }
    let mut found = DVec3::splat(otherwise);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if let Some(text) = element.attribute(name) {
            match numbers(element, text)?[..] {
                [x] => found[axis] = x,
                _ => return element.refuse(format!("{} is `{}`; allowed: one number", name, shown(text))),
            }
        }
    }
    Ok(found)
}

/// A transform, and what it looks at if that is all it does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform {
    pub matrix: DMat4,
    /// Origin, target and up of a single `lookat`.
    pub look_at: Option<[DVec3; 3]>,
    /// Scale and translation, where there is nothing else.
    pub scaled: Option<(DVec3, DVec3)>,
}

impl Default for Transform {
    fn default() -> Self {
        Transform { matrix: DMat4::IDENTITY, look_at: None, scaled: Some((DVec3::ONE, DVec3::ZERO)) }
    }
}

impl Transform {
    /// Each operation is applied after those before it.
    fn new(element: &Element) -> Result<Self> {
        let mut all = Transform::default();
        for operation in &element.children {
            let mut scaled = None;
            let matrix = match operation.tag.as_str() {
                "translate" => {
                    let by = triple(operation, 0.0)?;
                    scaled = all.scaled.map(|(scale, at)| (scale, at + by));
                    DMat4::from_translation(by)
                }
                "scale" => {
                    let by = match operation
                        .attribute("value")
                        .map(|value| numbers(operation, value))
                        .transpose()?
                        .as_deref()
                    {
                        Some([x]) => DVec3::splat(*x),
                        _ => triple(operation, 1.0)?,
                    };
                    scaled = all.scaled.map(|(scale, at)| (scale * by, at * by));
                    DMat4::from_scale(by)
                }
                "rotate" => {
                    let axis = triple(operation, 0.0)?.try_normalize();
                    let degrees =
                        operation.attribute("angle").map(|text| numbers(operation, text)).transpose()?;
                    match (axis, degrees.as_deref()) {
                        (Some(axis), Some([degrees])) => DMat4::from_mat3(turn(axis, *degrees)),
                        _ => {
                            return operation.refuse("<rotate> needs an axis other than 0 0 0, and an angle");
                        }
                    }
                }
                "lookat" => {
                    let point = |name: &str| -> Result<Option<DVec3>> {
                        match operation
                            .attribute(name)
                            .map(|text| numbers(operation, text))
                            .transpose()?
                            .as_deref()
                        {
                            None => Ok(None),
                            Some([x, y, z]) => Ok(Some(DVec3::new(*x, *y, *z))),
                            Some(_) => {
                                operation.refuse(format!("{name} of <lookat>; allowed: three numbers"))
                            }
                        }
                    };
                    let (Some(origin), Some(target)) = (point("origin")?, point("target")?) else {
                        return operation.refuse("<lookat> without origin or target; allowed: both");
                    };
                    let up = point("up")?;
                    let forward = (target - origin).try_normalize();
                    let chosen = up.unwrap_or_else(|| forward.unwrap_or(DVec3::Z).any_orthonormal_vector());
                    let left = forward.and_then(|forward| chosen.cross(forward).try_normalize());
                    let (Some(forward), Some(left)) = (forward, left) else {
                        return operation.refuse("<lookat> without a direction, or with up along it");
                    };
                    if element.children.len() == 1 {
                        all.look_at = Some([origin, target, chosen]);
                    }
                    let axes = [left, forward.cross(left), forward].map(|axis| axis.extend(0.0));
                    DMat4::from_cols(axes[0], axes[1], axes[2], origin.extend(1.0))
                }
                "matrix" => {
                    let rows = numbers(operation, operation.attribute("value").unwrap_or_default())?;
                    match rows.len() {
                        16 if rows[12..] == [0.0, 0.0, 0.0, 1.0] => {
                            let mut all = [0.0; 16];
                            all.copy_from_slice(&rows);
                            DMat4::from_cols_array(&all).transpose()
                        }
                        9 => {
                            let mut all = [0.0; 9];
                            all.copy_from_slice(&rows);
                            DMat4::from_mat3(DMat3::from_cols_array(&all).transpose())
                        }
                        _ => {
                            return operation.refuse(
                                "<matrix>; allowed: 9 numbers, or 16 whose last row is 0 0 0 1, row by row",
                            );
                        }
                    }
                }
                _ => {
                    return operation.refuse(format!(
                        "{}; allowed: translate, rotate, scale, lookat, matrix",
                        operation.name()
                    ));
                }
            };
            all.matrix = matrix * all.matrix;
            all.scaled = scaled;
        }
        if !all.matrix.is_finite() {
            return element.refuse("a transform beyond all numbers");
        }
        let linear = all.linear();
        let size = linear.x_axis.length() * linear.y_axis.length() * linear.z_axis.length();
        // Beyond, the axes lie in one plane but for rounding.
        let determinant = linear.determinant();
        if determinant.is_nan() || determinant <= 1e-12 * size {
            return element.refuse(
                "a transform that mirrors, or makes flat; allowed: one that keeps right hands right",
            );
        }
        Ok(all)
    }

    pub fn linear(&self) -> DMat3 {
        DMat3::from_mat4(self.matrix)
    }

    pub fn point(&self, p: DVec3) -> DVec3 {
        // Where there is no turn, no sum that cancels.
        match self.scaled {
            Some((scale, at)) => p * scale + at,
            None => self.matrix.transform_point3(p),
        }
    }

    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.linear() * v
    }

    /// The direction of a normal, by the transpose of the inverse, which stays perpendicular to what it was.
    pub fn normal(&self, n: DVec3) -> DVec3 {
        self.linear().inverse().transpose() * n
    }

    /// By how much it scales, if it scales alike along all axes and keeps them perpendicular.
    pub fn even_scale(&self) -> Option<f64> {
        let linear = self.linear();
        let scale = linear.x_axis.length();
        let product = linear.transpose() * linear;
        let rest = product - DMat3::from_diagonal(DVec3::splat(scale * scale));
        let is_even = rest.to_cols_array().iter().all(|x| x.abs() <= 1e-9 * scale * scale);
        is_even.then_some(scale)
    }

    /// Scale along the axes and translation, where it does nothing else.
    pub fn along_axes(&self) -> Option<(DVec3, DVec3)> {
        if let Some((scale, at)) = self.scaled {
            return scale.cmpgt(DVec3::ZERO).all().then_some((scale, at));
        }
        let linear = self.linear();
        let scale = DVec3::new(linear.x_axis.x, linear.y_axis.y, linear.z_axis.z);
        let rest = linear - DMat3::from_diagonal(scale);
        let is_along = rest.to_cols_array().iter().all(|x| x.abs() <= 1e-12 * scale.max_element());
        (is_along && scale.cmpgt(DVec3::ZERO).all()).then_some((scale, self.matrix.w_axis.truncate()))
    }
}

/// A turn about a unit axis.
fn turn(axis: DVec3, degrees: f64) -> DMat3 {
    // Whole quarters are exact.
    let (sin, cos) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => crate::math::sin_cos(other.to_radians()),
    };
    let column = |e: DVec3| cos * e + sin * axis.cross(e) + (1.0 - cos) * axis.dot(e) * axis;
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}
