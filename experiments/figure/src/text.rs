//! The embedded font: which characters it has, how wide a text is, where its pixels lie.

use crate::error::Error;
use crate::layer::Align;
use crate::mark::{Paint, Text};
use ab_glyph::{Font, FontRef, PxScale, point};

/// Size of tick labels and legends [pt].
pub(crate) const SMALL: f64 = 6.5;
/// Size of axis labels and headings of panels [pt].
pub(crate) const NORMAL: f64 = 7.5;
/// Size of the heading of a figure [pt].
pub(crate) const LARGE: f64 = 8.5;
/// Distance of baselines, in sizes.
pub(crate) const LEADING: f64 = 1.25;
/// Height of a digit of DejaVu Sans, in sizes.
pub(crate) const DIGIT: f64 = 0.73;

/// DejaVu Sans, regular and bold.
pub(crate) struct Fonts {
    regular: FontRef<'static>,
    bold: FontRef<'static>,
}

impl Fonts {
    pub(crate) fn load() -> Result<Self, Error> {
        let load = |bytes| FontRef::try_from_slice(bytes).map_err(|e| Error::Backend(e.to_string()));
        Ok(Self { regular: load(dejavu::sans::regular())?, bold: load(dejavu::sans::bold())? })
    }

    fn face(&self, bold: bool) -> &FontRef<'static> {
        if bold { &self.bold } else { &self.regular }
    }

    /// Refuses characters without a glyph, which would come out as boxes.
    pub(crate) fn check(&self, text: &str) -> Result<(), Error> {
        match text
            .chars()
            .find(|&c| c.is_control() || self.regular.glyph_id(c).0 == 0 || self.bold.glyph_id(c).0 == 0)
        {
            Some(character) => Err(Error::Glyph { text: text.to_owned(), character }),
            None => Ok(()),
        }
    }

    /// The width [pt].
    pub(crate) fn width(&self, text: &str, size: f64, bold: bool) -> f64 {
        let face = self.face(bold);
        let mut units = 0.0;
        let mut before = None;
        for id in text.chars().map(|c| face.glyph_id(c)) {
            if let Some(before) = before {
                units += face.kern_unscaled(before, id);
            }
            units += face.h_advance_unscaled(id);
            before = Some(id);
        }
        size * f64::from(units / face.units_per_em().unwrap_or(2048.0))
    }

    /// The text in lines no wider than `width`, broken at spaces; a longer word keeps a line of its own.
    pub(crate) fn wrap(&self, text: &str, size: f64, bold: bool, width: f64) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            match lines.last_mut() {
                Some(line) if self.width(&format!("{line} {word}"), size, bold) <= width => {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(word.to_owned()),
            }
        }
        lines
    }

    /// Calls `cover` with the pixels of the text and their coverage, `scale` pixels to the point.
    pub(crate) fn draw(&self, text: &Text, scale: f64, mut cover: impl FnMut(i64, i64, f64)) {
        let face = self.face(text.bold);
        let em = text.size * scale;
        let units = f64::from(face.units_per_em().unwrap_or(2048.0));
        let px = PxScale::from((em * f64::from(face.height_unscaled()) / units) as f32);
        let shift = match text.align {
            Align::Start => 0.0,
            Align::Middle => -0.5,
            Align::End => -1.0,
        } * self.width(&text.text, text.size, text.bold)
            * scale;
        // Along the baseline glyphs keep their fractions of a pixel; across it they snap, which keeps stems even.
        let origin = (text.at.0 * scale, text.at.1 * scale);
        let (start, base) = if text.upright { (-origin.1, origin.0) } else { (origin.0, origin.1) };
        let (mut pen, base) = (start + shift, libm::round(base) as i64);
        let mut before = None;
        for id in text.text.chars().map(|c| face.glyph_id(c)) {
            if let Some(before) = before {
                pen += em * f64::from(face.kern_unscaled(before, id)) / units;
            }
            let whole = libm::floor(pen);
            if let Some(outline) =
                face.outline_glyph(id.with_scale_and_position(px, point((pen - whole) as f32, 0.0)))
            {
                let bounds = outline.px_bounds();
                let (left, top) = (whole as i64 + bounds.min.x as i64, base + bounds.min.y as i64);
                outline.draw(|x, y, c| {
                    let (x, y) = (left + i64::from(x), top + i64::from(y));
                    let (x, y) = if text.upright { (y, -x) } else { (x, y) };
                    cover(x, y, f64::from(c.clamp(0.0, 1.0)));
                });
            }
            pen += em * f64::from(face.h_advance_unscaled(id)) / units;
            before = Some(id);
        }
    }
}

/// A line of ordinary black text.
pub(crate) fn plain(text: impl Into<String>, at: (f64, f64), align: Align, size: f64) -> Text {
    Text { text: text.into(), at, align, size, bold: false, upright: false, paint: Paint::INK }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_those_of_the_font_tables() {
        // DejaVu Sans: 2048 units to the em, digits 1303, space 651.
        let fonts = Fonts::load().unwrap();
        let em = |units: f64| units / 2048.0;
        assert!((fonts.width("0", 1.0, false) - em(1303.0)).abs() < 1e-6);
        assert!((fonts.width("12 5", 10.0, false) - 10.0 * em(3.0 * 1303.0 + 651.0)).abs() < 1e-5);
    }

    #[test]
    fn greek_and_superscripts_are_there_and_missing_glyphs_refused() {
        let fonts = Fonts::load().unwrap();
        fonts.check("σ_t r, 10⁻⁶ [W/(m² sr)] ± − × ≤ → µ Σ ∇²").unwrap();
        assert!(matches!(fonts.check("a霧"), Err(Error::Glyph { character: '霧', .. })));
        assert!(fonts.check("two\nlines").is_err());
    }

    #[test]
    fn lines_break_at_spaces_within_the_width() {
        let fonts = Fonts::load().unwrap();
        let width = fonts.width("measured error", NORMAL, false);
        let lines = fonts.wrap("measured error over predicted", NORMAL, false, width);
        assert_eq!(lines, ["measured error", "over predicted"]);
        assert_eq!(fonts.wrap("unbreakable", NORMAL, false, 1.0), ["unbreakable"]);
    }

    #[test]
    fn ink_lies_where_the_text_is_put() {
        // A capital I of 20 pt at scale 1 stands on the baseline, 0.729 em tall, inside its advance of 604 units.
        let fonts = Fonts::load().unwrap();
        for upright in [false, true] {
            let text = Text { upright, ..plain("I", (100.0, 100.0), Align::Start, 20.0) };
            let (mut along, mut across) = ((i64::MAX, i64::MIN), (i64::MAX, i64::MIN));
            fonts.draw(&text, 1.0, |x, y, c| {
                if c > 0.3 {
                    let (a, b) = if upright { (100 - y, 100 - x) } else { (x - 100, 100 - y) };
                    along = (along.0.min(a), along.1.max(a));
                    across = (across.0.min(b), across.1.max(b));
                }
            });
            assert!(along.0 >= 1 && along.1 <= 6, "{along:?}");
            assert!((0..=1).contains(&across.0) && (14..=15).contains(&across.1), "{across:?}");
        }
    }
}
