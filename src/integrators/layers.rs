//! Layers of a picture: radiance by the class of the path that brought it.

use crate::Spectrum;
use crate::transport::Flags;
use std::ops::{Add, AddAssign, Index, IndexMut, Mul, MulAssign};

/// A class of paths, by what light has met before the eye: L light, S specular surface, D other surface, M collision in
/// a medium, E eye.
///
/// From the eye, specular surfaces are looked through (S*); X is the first event behind them. Every path is in exactly
/// one class.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// L S* E: no event but specular ones.
    Emission,
    /// L D S* E: X is a surface, lit straight from the light.
    Direct,
    /// L S+ D S* E: X is a surface, lit by specular surfaces alone.
    Caustic,
    /// L ... D S* E: X is a surface, lit by anything else.
    Indirect,
    /// L M S* E: X is a collision, lit straight from the light.
    Single,
    /// L ... M S* E: X is a collision, lit by anything else.
    Multiple,
}

impl Layer {
    /// Every class, in the order of [`Layers`].
    pub const ALL: [Layer; 6] =
        [Layer::Emission, Layer::Direct, Layer::Caustic, Layer::Indirect, Layer::Single, Layer::Multiple];

    /// The class's name in pictures and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Layer::Emission => "emission",
            Layer::Direct => "direct",
            Layer::Caustic => "caustic",
            Layer::Indirect => "indirect",
            Layer::Single => "single",
            Layer::Multiple => "multiple",
        }
    }

    /// The class of a path from the eye.
    ///
    /// # Arguments
    /// `order` its scatterings by surfaces and media; `first` what X is, `Flags::MEDIUM` or a surface (not asked for at
    /// order 0); `is_by_specular` whether a specular surface lies between the light and the scattering next to it
    pub fn of(order: u32, first: Flags, is_by_specular: bool) -> Self {
        let in_medium = first.has(Flags::MEDIUM);
        match (order, in_medium) {
            (0, _) => Layer::Emission,
            (1, false) if is_by_specular => Layer::Caustic,
            (1, false) => Layer::Direct,
            (_, false) => Layer::Indirect,
            (1, true) if !is_by_specular => Layer::Single,
            (_, true) => Layer::Multiple,
        }
    }
}

/// Radiance by class [W/(L^2 sr)].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Layers {
    /// L S* E.
    pub emission: Spectrum,
    /// L D S* E.
    pub direct: Spectrum,
    /// L S+ D S* E.
    pub caustic: Spectrum,
    /// L ... D S* E, what is neither direct nor caustic.
    pub indirect: Spectrum,
    /// L M S* E.
    pub single: Spectrum,
    /// L ... M S* E, what is not single.
    pub multiple: Spectrum,
}

impl Layers {
    /// Nothing in any class.
    pub const ZERO: Layers = Layers {
        emission: Spectrum::ZERO,
        direct: Spectrum::ZERO,
        caustic: Spectrum::ZERO,
        indirect: Spectrum::ZERO,
        single: Spectrum::ZERO,
        multiple: Spectrum::ZERO,
    };

    /// All classes together.
    pub fn total(&self) -> Spectrum {
        self.iter().fold(Spectrum::ZERO, |sum, (_, value)| sum + value)
    }

    /// Classes and what they hold, in the order of [`Layer::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Layer, Spectrum)> + '_ {
        Layer::ALL.into_iter().map(|layer| (layer, self[layer]))
    }

    /// Whether every channel of every class is finite.
    pub fn is_finite(&self) -> bool {
        self.iter().all(|(_, value)| value.is_finite())
    }

    /// A function applied to each class.
    pub fn map(&self, f: impl Fn(Spectrum) -> Spectrum) -> Layers {
        let mut mapped = Layers::ZERO;
        for layer in Layer::ALL {
            mapped[layer] = f(self[layer]);
        }
        mapped
    }
}

impl Index<Layer> for Layers {
    type Output = Spectrum;
    fn index(&self, layer: Layer) -> &Spectrum {
        match layer {
            Layer::Emission => &self.emission,
            Layer::Direct => &self.direct,
            Layer::Caustic => &self.caustic,
            Layer::Indirect => &self.indirect,
            Layer::Single => &self.single,
            Layer::Multiple => &self.multiple,
        }
    }
}

impl IndexMut<Layer> for Layers {
    fn index_mut(&mut self, layer: Layer) -> &mut Spectrum {
        match layer {
            Layer::Emission => &mut self.emission,
            Layer::Direct => &mut self.direct,
            Layer::Caustic => &mut self.caustic,
            Layer::Indirect => &mut self.indirect,
            Layer::Single => &mut self.single,
            Layer::Multiple => &mut self.multiple,
        }
    }
}

impl AddAssign for Layers {
    fn add_assign(&mut self, other: Layers) {
        for layer in Layer::ALL {
            self[layer] += other[layer];
        }
    }
}

impl Add for Layers {
    type Output = Layers;
    fn add(mut self, other: Layers) -> Layers {
        self += other;
        self
    }
}

impl MulAssign<Spectrum> for Layers {
    fn mul_assign(&mut self, factor: Spectrum) {
        for layer in Layer::ALL {
            self[layer] *= factor;
        }
    }
}

impl Mul<Spectrum> for Layers {
    type Output = Layers;
    fn mul(mut self, factor: Spectrum) -> Layers {
        self *= factor;
        self
    }
}

impl MulAssign<f64> for Layers {
    fn mul_assign(&mut self, factor: f64) {
        *self *= Spectrum::grey(factor);
    }
}

impl Mul<f64> for Layers {
    type Output = Layers;
    fn mul(self, factor: f64) -> Layers {
        self * Spectrum::grey(factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the definitions, written as words over S, D and M from the light to the eye.
    #[test]
    fn every_word_has_its_class() {
        let class = |word: &str| {
            let letters: Vec<char> = word.chars().collect();
            // Specular surfaces before the eye are looked through.
            let seen = word.trim_end_matches('S');
            match seen.chars().last() {
                None => Layer::Emission,
                Some('D') => match &seen[..seen.len() - 1] {
                    "" => Layer::Direct,
                    before if before.chars().all(|c| c == 'S') => Layer::Caustic,
                    _ => Layer::Indirect,
                },
                Some('M') if seen == "M" => Layer::Single,
                _ => {
                    assert!(letters.contains(&'M'));
                    Layer::Multiple
                }
            }
        };
        let mut words = vec![String::new()];
        for length in 0..5 {
            let longer: Vec<String> = words
                .iter()
                .filter(|w| w.len() == length)
                .flat_map(|w| "SDM".chars().map(move |c| format!("{w}{c}")))
                .collect();
            words.extend(longer);
        }
        assert_eq!(words.len(), 1 + 3 + 9 + 27 + 81 + 243);
        for word in words {
            let order = word.chars().filter(|c| *c != 'S').count() as u32;
            let first = match word.chars().rev().find(|c| *c != 'S') {
                Some('M') => Flags::MEDIUM,
                _ => Flags::DIFFUSE,
            };
            let is_by_specular = word.starts_with('S');
            assert_eq!(Layer::of(order, first, is_by_specular), class(&word), "L{word}E");
        }
    }

    #[test]
    fn layers_are_told_apart_and_add_up() {
        let mut layers = Layers::ZERO;
        for (i, layer) in Layer::ALL.into_iter().enumerate() {
            layers[layer] = Spectrum::grey(f64::from(1u32 << i));
        }
        assert_eq!((layers.emission[0], layers.caustic[1], layers.multiple[2]), (1.0, 4.0, 32.0));
        assert_eq!(layers.total(), Spectrum::grey(63.0));
        assert_eq!((layers * 2.0 + layers).total(), Spectrum::grey(189.0));
        let names: Vec<&str> = layers.iter().map(|(layer, _)| layer.name()).collect();
        assert_eq!(names, ["emission", "direct", "caustic", "indirect", "single", "multiple"]);
    }
}
