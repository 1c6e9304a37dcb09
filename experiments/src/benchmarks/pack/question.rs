//! A question: words, an exact value with its bound, and the sensor of a scene that measures it.

use serde::Serialize;
use turbid_analytic::Value;

/// A question of the pack, as its tables have it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Question {
    /// Its name, which later versions keep.
    pub id: String,
    /// What is asked, in words.
    pub question: String,
    /// What kind of number the answer is.
    pub quantity: &'static str,
    /// The exact value, rounded to a tenth of its bound.
    pub value: f64,
    /// Absolute bound on its error, that of rounding included.
    pub bound: f64,
    /// Its unit.
    pub unit: &'static str,
    /// How the value and its bound are known.
    pub how_known: &'static str,
    /// The scene file, whose sensor of the same name measures it.
    pub scene: String,
}

/// What is asked of a problem.
pub struct Asked {
    /// The end of the question's name.
    pub name: String,
    /// The end of the question.
    pub words: String,
    /// The kind of number.
    pub quantity: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The exact value.
    pub value: Value,
    /// The sensor's keys but its name.
    pub sensor: String,
}

/// A medium and its light, of which several things are asked.
pub struct Problem {
    /// The beginning of its questions' names, and the name of its scene.
    pub name: String,
    /// The beginning of its questions.
    pub words: String,
    /// The scene without sensors.
    pub scene: String,
    /// What is asked.
    pub asked: Vec<Asked>,
}

impl Problem {
    /// Its scene file, from the folder of the pack.
    pub fn file(&self) -> String {
        format!("scenes/{}.toml", self.name)
    }

    /// The scene with a sensor a question.
    pub fn toml(&self) -> String {
        let sensors = self.asked.iter().map(|asked| {
            format!("\n[[sensors]]\nname = \"{}-{}\"\n{}\n", self.name, asked.name, asked.sensor)
        });
        format!("# {}\n{}{}", self.words, self.scene, sensors.collect::<String>())
    }

    /// Its questions.
    pub fn questions(&self) -> impl Iterator<Item = Question> {
        self.asked.iter().map(|asked| {
            let (value, bound) = rounded(asked.value);
            Question {
                id: format!("{}-{}", self.name, asked.name),
                question: format!("{}: {}", self.words, asked.words),
                quantity: asked.quantity,
                value,
                bound,
                unit: asked.unit,
                how_known: asked.value.method,
                scene: self.file(),
            }
        })
    }
}

/// The same value in another unit.
pub fn scaled(value: Value, factor: f64) -> Value {
    let product = value.value * factor;
    Value {
        value: product,
        error: value.error * libm::fabs(factor) + f64::EPSILON * libm::fabs(product),
        method: value.method,
    }
}

/// A value without the digits that its bound says nothing of, and a bound of two digits: the same on machines whose last bits
/// differ. The value moves by a twentieth of the bound at most, which 1.12 makes up for, with the rounding of the bound.
fn rounded(value: Value) -> (f64, f64) {
    let magnitude = |x: f64| libm::floor(libm::log10(libm::fabs(x)));
    let digits = (magnitude(value.value) - magnitude(value.error) + 1.0).clamp(0.0, 17.0) as usize;
    let read = |text: String, otherwise: f64| text.parse().unwrap_or(otherwise);
    (
        read(format!("{:.digits$e}", value.value), value.value),
        read(format!("{:.1e}", 1.12 * value.error), value.error),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_stays_within_the_bound() {
        for (value, error) in [
            (0.123_456_789_012, 3e-7),
            (0.123_456_789_012, 9.99e-7),
            (4.2e-41, 1e-53),
            (-12.345_678, 1.01e-3),
            (0.999_999_96, 1e-7),
            (0.5, 0.7),
        ] {
            let (shown, bound) = rounded(Value { value, error, method: "" });
            assert!((shown - value).abs() + error <= bound, "{value} {error}: {shown} {bound}");
            assert!(bound <= 1.18 * error, "{error}: {bound}");
        }
        assert_eq!(rounded(Value { value: 0.123_456_789_012, error: 3e-7, method: "" }).0, 0.123_456_79);
    }
}
