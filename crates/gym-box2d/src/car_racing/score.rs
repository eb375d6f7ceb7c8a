//! The score on the dashboard. Gymnasium writes it with a font; the digits here are our own.

use gym_core::canvas::{Canvas, Color, Point, Primitive};

/// From one character to the next, in pixels of the window.
const ADVANCE: f64 = 23.0;
/// Of a digit.
const WIDTH: f64 = 15.0;
const HEIGHT: f64 = 26.0;
/// Of a stroke.
const PEN: f64 = 3.0;

/// The strokes of a digit that shine: top, left and right above, middle, left and right below, bottom.
const STROKES: [u8; 10] = [
    0b111_0111, 0b001_0010, 0b101_1101, 0b101_1011, 0b011_1010, 0b110_1011, 0b110_1111, 0b101_0010, 0b111_1111,
    0b111_1011,
];
const MINUS: u8 = 0b000_1000;

/// Writes a number in the middle of a place, in white.
pub(super) fn draw(canvas: &mut dyn Canvas, text: &str, [x, y]: Point) {
    let mut left = x - (ADVANCE * text.len() as f64 - (ADVANCE - WIDTH)) / 2.0;
    let top = y - HEIGHT / 2.0;
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
            canvas.pygame(Primitive::Polygon(&[[x1, y1], [x1, y2], [x2, y2], [x2, y1]]), Color::WHITE);
        }
    }
}
