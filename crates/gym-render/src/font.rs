//! A stroke font of our own, for ASCII from space to tilde.
//!
//! Each glyph consists of strokes of one width, whose points lie on a grid. Coordinates are base-36
//! digits, x then y, with y upwards: the baseline is at 8, lower-case letters reach m (22),
//! capitals and digits s (28), descenders 2. A space starts the next stroke. A single point is a
//! dot; `~` with two points is a quarter of an ellipse from the previous point to the second one,
//! bulging towards the first.

use gym_core::canvas::{Align, Point, Segment};

use crate::outline::quarter;

/// Width of the pen, relative to the height of a capital letter.
pub(crate) const WEIGHT: f64 = 0.125;

/// The baseline on the grid.
const BASELINE: f64 = 8.0;
/// Height of a capital letter on the grid.
const CAPITAL: f64 = 20.0;
/// Horizontal distance from the rightmost point of a glyph to the leftmost point of the next glyph.
const GAP: f64 = 6.0;
/// Length of the stroke that draws a dot: just enough to have a direction.
const DOT: f64 = 0.1;

/// The glyph of unsupported characters: an empty box.
const MISSING: Glyph = Glyph(12, "080scsc808");

/// A glyph: the horizontal distance between its outermost points, and its strokes.
#[derive(Clone, Copy)]
struct Glyph(u8, &'static str);

/// The glyphs of the characters from space to tilde.
const GLYPHS: [Glyph; 95] = [
    Glyph(2, ""),                                                    // space
    Glyph(0, "0s0f 08"),                                             // !
    Glyph(5, "0s0m 5s5m"),                                           // "
    Glyph(14, "5s28 cs98 1lel 0fdf"),                                // #
    Glyph(12, "bo~as6s~0s0n~0i6i~cicd~c868~180c 6v65"),              // $
    Glyph(18, "4s~8s8o~8k4k~0k0o~0s4s eg~igic~i8e8~a8ac~ageg fs38"), // %
    Glyph(15, "f84l~3n3o~3s7s~bsbo~bl6i~0f0d~0868~c8fh"),            // &
    Glyph(0, "0s0m"),                                                // '
    Glyph(4, "4u~0q0h~0844"),                                        // (
    Glyph(4, "0u~4q4h~4804"),                                        // )
    Glyph(8, "4s4i 0q8k 8q0k"),                                      // *
    Glyph(12, "6o6c 0ici"),                                          // +
    Glyph(2, "2914"),                                                // ,
    Glyph(8, "0i8i"),                                                // -
    Glyph(0, "08"),                                                  // .
    Glyph(8, "8u06"),                                                // /
    Glyph(12, "6s~cscmce~c868~080e0m~0s6s"),                         // 0
    Glyph(12, "2n7s78 28c8"),                                        // 1
    Glyph(12, "0m~0s6s~cscm~cj9g08c8"),                              // 2
    Glyph(12, "0n~0s6s~bsbn~bi5i~cicd~c868~080d"),                   // 3
    Glyph(12, "9s0ece 9s98"),                                        // 4
    Glyph(12, "bs1s1i~3l6l~clce~c868~080c"),                         // 5
    Glyph(12, "bs~0s0e~0868~c8ce~ck6k~0k0e"),                        // 6
    Glyph(12, "0scs48"),                                             // 7
    Glyph(12, "6s~bsbn~bi6i~1i1n~1s6s 6i~cicd~c868~080d~0i6i"),      // 8
    Glyph(12, "18~c8cm~cs6s~0s0m~0g6g~cgcm"),                        // 9
    Glyph(0, "0k 08"),                                               // :
    Glyph(2, "2k 2914"),                                             // ;
    Glyph(10, "aq0iaa"),                                             // <
    Glyph(12, "0lcl 0fcf"),                                          // =
    Glyph(10, "0qai0a"),                                             // >
    Glyph(10, "0n~0s5s~asan~ak7i~5g5e 58"),                          // ?
    Glyph(
        20,
        "eh~emam~6m6h~6cac~eceh emef~echc~kckh~ksas~0s0h~06a6~d6f7",
    ), // @
    Glyph(14, "087se8 2ece"),                                        // A
    Glyph(12, "080s6s~bsbn~bi6i 0i7i~cicd~c87808"),                  // B
    Glyph(13, "do~bs7s~0s0i~0878~b8dc"),                             // C
    Glyph(13, "080s5s~dsdi~d85808"),                                 // D
    Glyph(10, "as0s08a8 0i8i"),                                      // E
    Glyph(10, "as0s08 0i8i"),                                        // F
    Glyph(14, "do~bs7s~0s0i~0878~e8eh8h"),                           // G
    Glyph(13, "080s d8ds 0idi"),                                     // H
    Glyph(0, "080s"),                                                // I
    Glyph(8, "8s8e~8848~080d"),                                      // J
    Glyph(12, "080s cs0f 4jc8"),                                     // K
    Glyph(10, "0s08a8"),                                             // L
    Glyph(16, "080s8cgsg8"),                                         // M
    Glyph(13, "080sd8ds"),                                           // N
    Glyph(16, "8s~gsgi~g888~080i~0s8s"),                             // O
    Glyph(12, "080s6s~cscm~cg6g0g"),                                 // P
    Glyph(16, "8s~gsgi~g888~080i~0s8s adg7"),                        // Q
    Glyph(12, "080s6s~cscm~cg6g0g 6gc8"),                            // R
    Glyph(12, "bo~as6s~0s0n~0i6i~cicd~c868~180c"),                   // S
    Glyph(12, "0scs 6s68"),                                          // T
    Glyph(14, "0s0f~0878~e8efes"),                                   // U
    Glyph(14, "0s78es"),                                             // V
    Glyph(20, "0s58asf8ks"),                                         // W
    Glyph(12, "0sc8 cs08"),                                          // X
    Glyph(12, "0s6ics 6i68"),                                        // Y
    Glyph(12, "0scs08c8"),                                           // Z
    Glyph(4, "4u0u0444"),                                            // [
    Glyph(8, "0u86"),                                                // \
    Glyph(4, "0u4u4404"),                                            // ]
    Glyph(10, "0l5sal"),                                             // ^
    Glyph(12, "05c5"),                                               // _
    Glyph(4, "0s4o"),                                                // `
    Glyph(10, "1k~2m5m~amaha8 ag5g~0g0c~0848~88ac"),                 // a
    Glyph(10, "0s08 0f~0m5m~amaf~a858~080f"),                        // b
    Glyph(10, "ak~8m5m~0m0f~0858~88aa"),                             // c
    Glyph(10, "asa8 af~am5m~0m0f~0858~a8af"),                        // d
    Glyph(10, "0faf~am5m~0m0f~0858~88ab"),                           // e
    Glyph(7, "7s~3s3n38 0m7m"),                                      // f
    Glyph(10, "ama7~a252~2214 af~am5m~0m0f~0858~a8af"),              // g
    Glyph(10, "0s08 0g~0m5m~amaga8"),                                // h
    Glyph(0, "0m08 0r"),                                             // i
    Glyph(4, "4m46~4202 4r"),                                        // j
    Glyph(9, "0s08 9m0d 3g98"),                                      // k
    Glyph(3, "0s0b~0838"),                                           // l
    Glyph(16, "0m08 0g~0m4m~8m8g88 8g~8mcm~gmggg8"),                 // m
    Glyph(10, "0m08 0g~0m5m~amaga8"),                                // n
    Glyph(12, "6m~cmcf~c868~080f~0m6m"),                             // o
    Glyph(10, "0m02 0f~0m5m~amaf~a858~080f"),                        // p
    Glyph(10, "ama2 af~am5m~0m0f~0858~a8af"),                        // q
    Glyph(6, "0m08 0g~0m6m"),                                        // r
    Glyph(10, "9k~8m5m~0m0j~0f5f~afab~a858~180a"),                   // s
    Glyph(7, "3r3c~3878 0m7m"),                                      // t
    Glyph(10, "0m0e~0858~a8ae ama8"),                                // u
    Glyph(10, "0m58am"),                                             // v
    Glyph(16, "0m488mc8gm"),                                         // w
    Glyph(10, "0ma8 am08"),                                          // x
    Glyph(10, "0m58 am32"),                                          // y
    Glyph(10, "0mam08a8"),                                           // z
    Glyph(6, "6u~3u3q3m~3i0i~3i3e3a~3464"),                          // {
    Glyph(0, "0u04"),                                                // |
    Glyph(6, "0u~3u3q3m~3i6i~3i3e3a~3404"),                          // }
    Glyph(12, "0g~0k3k~5k6i~7g9g~cgck"),                             // ~
];

fn glyph(character: char) -> Glyph {
    let index = (character as usize).checked_sub(' ' as usize);
    index
        .and_then(|index| GLYPHS.get(index))
        .copied()
        .unwrap_or(MISSING)
}

/// Returns the width of a line of text whose capital letters are `size` high, in the unit of
/// `size`.
pub fn text_width(text: &str, size: f64) -> f64 {
    let count = text.chars().count();
    if count == 0 {
        return 0.0;
    }
    let glyphs: f64 = text
        .chars()
        .map(|character| f64::from(glyph(character).0))
        .sum();
    (glyphs + GAP * (count - 1) as f64) / CAPITAL * size + WEIGHT * size
}

/// Passes the strokes of a line of text to `emit`; the caller draws them `size * WEIGHT` wide with
/// round ends. `position` lies on the baseline; `size` is the height of a capital letter.
pub(crate) fn outline(
    text: &str,
    position: Point,
    size: f64,
    align: Align,
    emit: &mut impl FnMut(Segment),
) {
    let unit = size / CAPITAL;
    let shift = match align {
        Align::Left => 0.0,
        Align::Center => 0.5,
        Align::Right => 1.0,
    };
    let mut left = position[0] + WEIGHT * size / 2.0 - shift * text_width(text, size);
    for character in text.chars() {
        let Glyph(width, strokes) = glyph(character);
        for stroke in strokes.split(' ') {
            draw(
                stroke,
                |[x, y]| [left + x * unit, position[1] - (y - BASELINE) * unit],
                emit,
            );
        }
        left += (f64::from(width) + GAP) * unit;
    }
}

/// Passes one stroke of a glyph to `emit`; `place` maps the grid to the canvas.
fn draw(stroke: &str, place: impl Fn(Point) -> Point, emit: &mut impl FnMut(Segment)) {
    let mut symbols = stroke.chars();
    let Some(start) = point(&mut symbols) else {
        return;
    };
    emit(Segment::Move(place(start)));
    if symbols.as_str().is_empty() {
        emit(Segment::Line(place([start[0] + DOT, start[1]])));
    }
    let mut at = start;
    while !symbols.as_str().is_empty() {
        let corner = if symbols.as_str().starts_with('~') {
            symbols.next();
            point(&mut symbols)
        } else {
            None
        };
        let Some(to) = point(&mut symbols) else {
            return;
        };
        emit(match corner {
            Some(corner) => quarter(place(at), place(corner), place(to)),
            None => Segment::Line(place(to)),
        });
        at = to;
    }
}

fn point(symbols: &mut std::str::Chars<'_>) -> Option<Point> {
    let mut digit = || symbols.next()?.to_digit(36).map(f64::from);
    Some([digit()?, digit()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(text: &str, align: Align) -> Vec<Point> {
        let mut points = Vec::new();
        outline(
            text,
            [100.0, 50.0],
            20.0,
            align,
            &mut |segment| match segment {
                Segment::Move(to) | Segment::Line(to) | Segment::Cubic(_, _, to) => points.push(to),
                other => panic!("{other:?}"),
            },
        );
        points
    }

    #[test]
    fn every_glyph_is_well_formed() {
        for (glyph, code) in GLYPHS.iter().zip(b' '..) {
            let mut right = 0.0_f64;
            for stroke in glyph.1.split(' ').filter(|stroke| !stroke.is_empty()) {
                let digits = stroke.chars().filter(|&symbol| symbol != '~').count();
                let arcs = stroke.chars().filter(|&symbol| symbol == '~').count();
                assert!(digits % 2 == 0, "{:?} {stroke}", code as char);
                let mut pieces = 0;
                draw(stroke, std::convert::identity, &mut |segment| {
                    pieces += 1;
                    if let Segment::Move([x, _])
                    | Segment::Line([x, _])
                    | Segment::Cubic(.., [x, _]) = segment
                    {
                        right = right.max(x - DOT);
                    }
                });
                assert_eq!(
                    pieces,
                    (digits / 2 - arcs).max(2),
                    "{:?} {stroke}",
                    code as char
                );
            }
            assert!(right <= f64::from(glyph.0), "{:?}", code as char);
        }
    }

    #[test]
    fn a_capital_is_as_high_as_the_size() {
        assert_eq!(ends("I", Align::Left), [[101.25, 50.0], [101.25, 30.0]]);
    }

    #[test]
    fn widths_add_up_and_text_is_aligned() {
        assert_eq!(text_width("", 20.0), 0.0);
        assert_eq!(text_width("I", 20.0), 2.5);
        assert_eq!(text_width("II", 20.0), 8.5);
        assert_eq!(text_width("II", 40.0), 17.0);
        assert_eq!(ends("I", Align::Center)[0], [100.0, 50.0]);
        assert_eq!(ends("II", Align::Right)[3], [98.75, 30.0]);
    }

    #[test]
    fn unknown_characters_are_boxes() {
        assert_eq!(ends("é", Align::Left).len(), 5);
        assert_eq!(ends("\n", Align::Left).len(), 5);
    }
}
