//! The score on the dashboard. Gymnasium draws the score with a font. This module draws its own
//! digits, unless [`ScoreGlyphs`] of that font are loaded.

use std::collections::BTreeMap;
use std::path::Path;

use gym_core::canvas::{Canvas, Color, Point, Primitive};
use gym_core::{Error, Result, file};
use serde::Deserialize;

/// The distance from one character to the next, in pixels of the window.
const ADVANCE: f64 = 23.0;
/// The width of a digit.
const WIDTH: f64 = 15.0;
const HEIGHT: f64 = 26.0;
/// The width of a stroke.
const PEN: f64 = 3.0;

/// The strokes of each digit, as bits: top, upper left, upper right, middle, lower left, lower
/// right, bottom.
const STROKES: [u8; 10] = [
    0b111_0111, 0b001_0010, 0b101_1101, 0b101_1011, 0b011_1010, 0b110_1011, 0b110_1111, 0b101_0010,
    0b111_1111, 0b111_1011,
];
const MINUS: u8 = 0b000_1000;

/// Images of Gymnasium's digits: with them, all pixels of CarRacing's frames equal Gymnasium's.
///
/// They come from a font under another licence, so this crate does not include them. With
/// pygame-ce, this Python program writes them to a file:
///
/// ```python
/// import json, pygame
/// pygame.font.init()
/// font = pygame.font.Font(pygame.font.get_default_font(), 42)
/// glyphs = {}
/// for c in "-0123456789":
///     grey = pygame.surfarray.array3d(font.render(c, True, (255, 255, 255), (0, 0, 0)))[:, 3:35, 0]
///     glyphs[c] = [grey.shape[0], grey.T.tobytes().hex()]
/// json.dump(glyphs, open("glyphs.json", "w"))
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScoreGlyphs {
    /// Width and grey levels of `-` and the digits.
    glyphs: [(usize, Vec<u8>); 11],
}

/// The rows of a glyph.
const ROWS: usize = 32;
/// The first row of the window that glyphs cover.
const TOP: usize = 730;
/// The largest width of a glyph.
const WIDEST: usize = 64;
/// The largest size of a file of glyphs, in bytes: several times the hexadecimal digits.
const MAX_LEN: usize = 1 << 20;

impl ScoreGlyphs {
    /// Reads a file that the program above wrote.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read, [`Error::InvalidArgument`] if it does not contain
    /// the glyphs.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text = file::read_text(path, MAX_LEN).map_err(|error| Error::io(path, error))?;
        Self::parse(&text)
    }

    /// Parses the text of a file that the program above wrote.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if it does not contain the glyphs.
    pub fn parse(text: &str) -> Result<Self> {
        let invalid =
            |reason: String| Error::argument("CarRacing", format!("score glyphs: {reason}"));
        #[derive(Deserialize)]
        #[serde(transparent)]
        struct File(BTreeMap<String, (usize, String)>);
        let File(file) = serde_json::from_str(text).map_err(|error| invalid(error.to_string()))?;
        let glyph = |c: char| {
            let (width, hex) = file
                .get(c.encode_utf8(&mut [0; 4]) as &str)
                .ok_or_else(|| invalid(format!("`{c}` is missing")))?;
            let digits: Option<Vec<u8>> = hex
                .chars()
                .map(|c| c.to_digit(16).map(|d| d as u8))
                .collect();
            match digits {
                Some(digits)
                    if (1..=WIDEST).contains(width) && digits.len() == 2 * ROWS * width =>
                {
                    Ok((
                        *width,
                        digits
                            .chunks_exact(2)
                            .map(|pair| 16 * pair[0] + pair[1])
                            .collect(),
                    ))
                }
                _ => Err(invalid(format!(
                    "`{c}` needs a width up to {WIDEST} and {ROWS} rows of as many bytes, in hexadecimal"
                ))),
            }
        };
        let mut glyphs = [const { (0, Vec::new()) }; 11];
        for (place, c) in glyphs.iter_mut().zip("-0123456789".chars()) {
            *place = glyph(c)?;
        }
        Ok(Self { glyphs })
    }

    /// Draws `text`, centred on the column `middle`.
    fn draw(&self, canvas: &mut dyn Canvas, text: &str, middle: f64) {
        let index = |c: u8| {
            if c.is_ascii_digit() {
                usize::from(c - b'0') + 1
            } else {
                0
            }
        };
        // the left end of each character; the pen moves in 64ths of a pixel
        let (mut pen, mut before, mut width) = (0, None, 0);
        let mut places = [(0, 0); MOST];
        for (place, c) in places.iter_mut().zip(text.bytes()) {
            let glyph = index(c);
            let own = self.glyphs[glyph].0;
            let kerning: f64 = before.map_or(0.0, |before| kern(before, c) * 42.0 * 64.0 / 1000.0);
            pen += kerning.round_ties_even() as i64;
            *place = ((pen >> 6).max(0) as usize, glyph);
            width = place.0 + own;
            pen += 64 * own as i64;
            before = Some(c);
        }
        let places = &places[..text.len().min(MOST)];
        let left = middle as i64 - (width / 2) as i64;
        for y in 0..ROWS {
            let grey = |x: usize| {
                let of = |&(place, glyph): &(usize, usize)| {
                    let (own, pixels) = &self.glyphs[glyph];
                    x.checked_sub(place)
                        .filter(|x| x < own)
                        .map(|x| pixels[y * own + x])
                };
                places.iter().filter_map(of).max().unwrap_or(0)
            };
            let mut x = 0;
            while x < width {
                let (from, level) = (x, grey(x));
                while x < width && grey(x) == level {
                    x += 1;
                }
                if level > 0 {
                    let [x1, x2] = [from, x - 1].map(|x| (left + x as i64) as f64);
                    let line = Primitive::HLine {
                        x1,
                        x2,
                        y: (TOP + y) as f64,
                    };
                    canvas.pygame(line, Color::rgb(level, level, level));
                }
            }
        }
    }
}

/// The largest number of characters of a score.
const MOST: usize = 8;

/// The kerning of FreeSansBold between the digits `before` and `c`, in thousandths of its size.
fn kern(before: u8, c: u8) -> f64 {
    const KERNS: [(&[u8; 2], i8); 49] = [
        (b"00", 58),
        (b"02", 73),
        (b"03", 75),
        (b"05", 79),
        (b"08", 65),
        (b"09", 80),
        (b"11", -85),
        (b"17", -65),
        (b"20", 84),
        (b"23", 70),
        (b"26", 77),
        (b"28", 70),
        (b"29", 91),
        (b"30", 70),
        (b"32", 61),
        (b"33", 87),
        (b"35", 88),
        (b"36", 66),
        (b"38", 77),
        (b"39", 78),
        (b"40", 89),
        (b"42", 59),
        (b"43", 92),
        (b"45", 89),
        (b"46", 86),
        (b"48", 97),
        (b"49", 80),
        (b"53", 73),
        (b"55", 77),
        (b"58", 63),
        (b"59", 77),
        (b"60", 66),
        (b"63", 82),
        (b"65", 87),
        (b"66", 62),
        (b"68", 73),
        (b"69", 81),
        (b"74", -62),
        (b"80", 65),
        (b"82", 69),
        (b"83", 81),
        (b"85", 85),
        (b"86", 61),
        (b"88", 71),
        (b"89", 86),
        (b"92", 70),
        (b"93", 65),
        (b"95", 69),
        (b"99", 70),
    ];
    KERNS
        .iter()
        .find(|(pair, _)| **pair == [before, c])
        .map_or(0.0, |(_, kern)| f64::from(*kern))
}

/// Draws `text` in white, centred.
pub(super) fn draw(
    canvas: &mut dyn Canvas,
    text: &str,
    [x, y]: Point,
    glyphs: Option<&ScoreGlyphs>,
) {
    if let Some(glyphs) = glyphs {
        return glyphs.draw(canvas, text, x);
    }
    let mut left = x - (ADVANCE * text.len() as f64 - (ADVANCE - WIDTH)) / 2.0;
    // in a font, the middle of a digit lies above the middle of the line
    let top = y - HEIGHT / 2.0 - 4.0;
    for character in text.bytes() {
        let strokes = match character {
            b'0'..=b'9' => STROKES[usize::from(character - b'0')],
            _ => MINUS,
        };
        draw_strokes(canvas, strokes, [left, top]);
        left += ADVANCE;
    }
}

fn draw_strokes(canvas: &mut dyn Canvas, strokes: u8, [left, top]: Point) {
    const HALF: f64 = (HEIGHT - PEN) / 2.0;
    let (level, upright) = ([WIDTH, PEN], [PEN, HALF + PEN]);
    let places = [
        ([0.0, 0.0], level),
        ([0.0, 0.0], upright),
        ([WIDTH - PEN, 0.0], upright),
        ([0.0, HALF], level),
        ([0.0, HALF], upright),
        ([WIDTH - PEN, HALF], upright),
        ([0.0, 2.0 * HALF], level),
    ];
    for (i, ([x, y], [width, height])) in places.into_iter().enumerate() {
        if strokes & 1 << (6 - i) != 0 {
            let [x1, y1] = [left + x, top + y];
            let [x2, y2] = [x1 + width - 1.0, y1 + height - 1.0];
            canvas.pygame(
                Primitive::Polygon(&[[x1, y1], [x1, y2], [x2, y2], [x2, y1]]),
                Color::WHITE,
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Glyphs that are filled boxes with the font's widths.
    fn boxes() -> String {
        let glyph = |c: char| {
            let width = if c == '-' { 13 } else { 23 };
            format!("\"{c}\": [{width}, \"{}\"]", "ff".repeat(ROWS * width))
        };
        format!(
            "{{{}}}",
            "-0123456789"
                .chars()
                .map(glyph)
                .collect::<Vec<_>>()
                .join(", ")
        )
    }

    #[test]
    fn grey_levels_are_read_from_both_digits() {
        let text = boxes().replacen("\"-\": [13, \"ffff", "\"-\": [13, \"a17f", 1);
        let (width, levels) = &ScoreGlyphs::parse(&text).unwrap().glyphs[0];
        assert_eq!((*width, &levels[..3]), (13, &[0xa1, 0x7f, 0xff][..]));
    }

    /// The lines and polygons that were drawn, by their left and right ends.
    #[derive(Default)]
    struct Drawn(Vec<[f64; 2]>);

    impl Canvas for Drawn {
        fn clear(&mut self, _: Color) {}
        fn fill(&mut self, _: gym_core::canvas::Shape<'_>, _: Color) {}
        fn stroke(&mut self, _: gym_core::canvas::Shape<'_>, _: f64, _: Color) {}
        fn text(&mut self, _: &str, _: Point, _: f64, _: gym_core::canvas::Align, _: Color) {}
        fn push(&mut self, _: gym_core::canvas::Transform) {}
        fn pop(&mut self) {}
        fn pygame(&mut self, primitive: Primitive<'_>, _: Color) {
            self.0.push(match primitive {
                Primitive::HLine { x1, x2, .. } => [x1, x2],
                Primitive::Polygon([[x1, _], _, [x2, _], _]) => [*x1, *x2],
                _ => panic!("{primitive:?}"),
            });
        }
    }

    /// A minus sign is one stroke, and the digits have as many as on a pocket calculator.
    #[test]
    fn each_character_has_its_strokes() {
        for (i, strokes) in [6, 2, 5, 5, 4, 5, 6, 3, 7, 6].into_iter().enumerate() {
            let mut drawn = Drawn::default();
            draw(&mut drawn, &format!("-{i}"), [60.0, 750.0], None);
            let left = 60.0 - (ADVANCE + WIDTH) / 2.0;
            assert_eq!(drawn.0[0], [left, left + WIDTH - 1.0], "the sign of -{i}");
            let digit = &drawn.0[1..];
            assert_eq!(digit.len(), strokes, "{i}");
            assert!(digit.iter().all(|[x, _]| *x >= left + ADVANCE), "{i}");
        }
    }

    #[test]
    fn text_lies_where_the_font_puts_it() {
        let glyphs = ScoreGlyphs::parse(&boxes()).unwrap();
        // left end and width, recorded from pygame
        for (text, left, width) in [
            ("0000", 11, 99),
            ("0123", 13, 94),
            ("-005", 17, 87),
            ("0900", 12, 97),
            ("0117", 18, 85),
        ] {
            let mut drawn = Drawn::default();
            draw(&mut drawn, text, [60.0, 750.0], Some(&glyphs));
            let ends = drawn
                .0
                .into_iter()
                .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
            assert_eq!(
                ends,
                Some([f64::from(left), f64::from(left + width - 1)]),
                "{text}"
            );
        }
    }

    #[test]
    fn glyphs_that_do_not_fit_are_refused() {
        let good = boxes();
        let bad = [
            ("not JSON", "{".to_owned()),
            ("`7` is missing", good.replacen("\"7\"", "\"x\"", 1)),
            ("`-` needs", good.replacen("13", "14", 1)),
            ("`-` needs", good.replacen("ff", "zz", 1)),
            ("`-` needs", good.replacen("13", "1000000", 1)),
        ];
        for (what, text) in bad {
            let error = ScoreGlyphs::parse(&text).unwrap_err().to_string();
            assert!(
                error.contains("score glyphs") && (what == "not JSON" || error.contains(what)),
                "{error}"
            );
        }
        assert!(
            ScoreGlyphs::read("no such file")
                .unwrap_err()
                .to_string()
                .contains("no such file")
        );
    }
}
