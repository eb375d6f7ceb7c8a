//! Buttons, sliders, lines and texts, one below the other.

use gym::canvas::{Align, Canvas, Color, Point, Shape};
use gym::render::text_width;

use super::{Area, Input, rest};

/// The height of a capital letter, in pixels, of texts and of small texts.
pub(crate) const TEXT: f64 = 9.0;
const SMALL: f64 = 8.0;
/// The space around everything, and between two rows.
const MARGIN: f64 = 12.0;
const GAP: f64 = 6.0;
const BUTTON: f64 = 24.0;
const TRACK: f64 = 8.0;
const PLOT: f64 = 44.0;

const BACK: Color = Color::rgb(246, 247, 249);
const INK: Color = Color::rgb(28, 34, 44);
const FAINT: Color = Color::rgb(98, 108, 122);
const FACE: Color = Color::rgb(224, 229, 236);
const LIT: Color = Color::rgb(38, 98, 190);
const WRONG: Color = Color::rgb(178, 24, 32);
/// The colours of the numbers of a sensor.
const LINES: [Color; 6] = [
    Color::rgb(204, 51, 51),
    Color::rgb(38, 140, 68),
    Color::rgb(38, 98, 190),
    Color::rgb(190, 120, 20),
    Color::rgb(140, 60, 170),
    Color::rgb(90, 100, 112),
];

/// A column of widgets that can be longer than its area: the wheel moves it.
#[derive(Debug, Default)]
pub(crate) struct Panel {
    scroll: f64,
    /// The height of all rows in the last frame.
    length: f64,
    /// The number of the widget that is held.
    held: Option<usize>,
    /// The buttons and sliders of the last frame: name, corner, size.
    #[cfg(test)]
    pub(crate) places: Vec<(String, Point, Point)>,
}

impl Panel {
    /// Draws the rows that `rows` adds, and lets `input` act on them.
    pub(crate) fn rows(
        &mut self,
        area: Area,
        input: &Input,
        canvas: &mut dyn Canvas,
        rows: impl FnOnce(&mut Rows<'_>),
    ) {
        let height = f64::from(area.size.1);
        let is_over = area.contains(input.pointer.at);
        if is_over {
            self.scroll -= 48.0 * input.pointer.wheel;
        }
        self.scroll = self.scroll.clamp(0.0, (self.length - height).max(0.0));
        if !input.pointer.left {
            self.held = None;
        }
        canvas.clear(BACK);
        let mut all = Rows {
            canvas,
            at: area.local(input.pointer.at),
            presses: is_over && input.presses(|pointer| pointer.left),
            clears: is_over && input.presses(|pointer| pointer.right),
            held: &mut self.held,
            #[cfg(test)]
            places: Vec::new(),
            width: f64::from(area.size.0),
            height,
            y: MARGIN - self.scroll,
            number: 0,
        };
        rows(&mut all);
        let end = all.y + self.scroll;
        #[cfg(test)]
        {
            self.places = all.places;
        }
        self.length = end + MARGIN;
        if self.length > height {
            // how much of the panel there is
            let bar = (height / self.length * height).max(12.0);
            let top = self.scroll / (self.length - height) * (height - bar);
            let x = f64::from(area.size.0) - 5.0;
            canvas.round_rect([x, top], [4.0, bar], 2.0, FAINT.alpha(140));
        }
    }
}

/// The rows of a panel while they are drawn.
pub(crate) struct Rows<'a> {
    canvas: &'a mut dyn Canvas,
    at: Point,
    /// Whether the left button went down, and the right one.
    presses: bool,
    clears: bool,
    held: &'a mut Option<usize>,
    #[cfg(test)]
    places: Vec<(String, Point, Point)>,
    width: f64,
    height: f64,
    /// The top of the next row.
    y: f64,
    number: usize,
}

impl Rows<'_> {
    /// Returns the top of a row of some height, and whether it is visible.
    fn row(&mut self, height: f64) -> (f64, bool) {
        let top = self.y;
        self.y += height + GAP;
        (top, top < self.height && top + height > 0.0)
    }

    fn is_over(&self, min: Point, size: Point) -> bool {
        let within = |k: usize| (min[k]..min[k] + size[k]).contains(&self.at[k]);
        within(0) && within(1)
    }

    fn inner(&self) -> f64 {
        (self.width - 2.0 * MARGIN).max(1.0)
    }

    fn write(&mut self, text: &str, at: Point, (size, align, color): (f64, Align, Color)) {
        self.canvas.text(text, at, size, align, color);
    }

    /// Some space above a group of rows, and its name.
    pub(crate) fn heading(&mut self, text: &str) {
        self.y += 6.0;
        let (top, is_seen) = self.row(TEXT + 5.0);
        if is_seen {
            let line = [self.inner(), 1.0];
            self.canvas.rect([MARGIN, top - 5.0], line, FACE);
            self.write(text, [MARGIN, top + TEXT + 3.0], (TEXT, Align::Left, LIT));
        }
    }

    /// A line of text, cut to the width.
    pub(crate) fn text(&mut self, text: &str) {
        self.line(text, TEXT, INK);
    }

    /// A line of small text.
    pub(crate) fn note(&mut self, text: &str) {
        self.line(text, SMALL, FAINT);
    }

    /// An error, in as many lines as it needs.
    pub(crate) fn error(&mut self, text: &str) {
        for line in wrapped(text, self.inner(), TEXT) {
            self.line(&line, TEXT, WRONG);
        }
    }

    fn line(&mut self, text: &str, size: f64, color: Color) {
        let (top, is_seen) = self.row(size + 3.0);
        if is_seen {
            let text = cut(text, self.inner(), size);
            self.write(&text, [MARGIN, top + size], (size, Align::Left, color));
        }
    }

    /// Buttons side by side, in as many rows as they need; those for which `is_lit` are on. Returns the
    /// one that was pressed.
    pub(crate) fn buttons<T: AsRef<str>>(
        &mut self,
        names: &[T],
        is_lit: impl Fn(usize) -> bool,
    ) -> Option<usize> {
        let mut pressed = None;
        let mut x = MARGIN;
        let (mut top, mut is_seen) = self.row(BUTTON);
        for (i, name) in names.iter().enumerate() {
            let name = cut(name.as_ref(), self.inner() - 16.0, TEXT);
            let size = [text_width(&name, TEXT) + 16.0, BUTTON];
            if x > MARGIN && x + size[0] > MARGIN + self.inner() {
                x = MARGIN;
                (top, is_seen) = self.row(BUTTON);
            }
            let min = [x, top];
            x += size[0] + GAP;
            #[cfg(test)]
            self.places.push((name.clone(), min, size));
            if !is_seen {
                continue;
            }
            if self.presses && self.is_over(min, size) {
                pressed = Some(i);
            }
            let (face, ink) = if is_lit(i) {
                (LIT, Color::WHITE)
            } else if self.is_over(min, size) {
                (Color::rgb(204, 214, 228), INK)
            } else {
                (FACE, INK)
            };
            self.canvas.round_rect(min, size, 5.0, face);
            let middle = [min[0] + size[0] / 2.0, top + (BUTTON + TEXT) / 2.0];
            self.write(&name, middle, (TEXT, Align::Center, ink));
        }
        pressed
    }

    /// A slider with its name and its value: dragged with the left button, set to zero with the
    /// right one. Returns the new value, if it changed.
    pub(crate) fn slider(&mut self, name: &str, value: f64, range: [f64; 2]) -> Option<f64> {
        let number = self.number;
        self.number += 1;
        let (top, is_seen) = self.row(TEXT + TRACK + 9.0);
        let (left, width) = (MARGIN, self.inner());
        let is_held = *self.held == Some(number);
        #[cfg(test)]
        self.places
            .push((name.to_owned(), [left, top], [width, TEXT + TRACK + 9.0]));
        if !is_seen && !is_held {
            return None;
        }
        let [low, high] = range;
        let length = high - low;
        let mut now = value;
        let is_over = self.is_over([0.0, top], [self.width, TEXT + TRACK + 9.0]);
        if self.presses && is_over {
            *self.held = Some(number);
        }
        if *self.held == Some(number) {
            let part = ((self.at[0] - left) / width).clamp(0.0, 1.0);
            now = low + part * length;
        } else if self.clears && is_over {
            now = rest(range);
        }
        let part = |x: f64| {
            if length > 0.0 {
                ((x - low) / length).clamp(0.0, 1.0)
            } else {
                0.0
            }
        };
        let shown = short(now);
        let room = width - text_width(&shown, TEXT) - 8.0;
        let base = top + TEXT + 1.0;
        let name = cut(name, room, TEXT);
        self.write(&name, [left, base], (TEXT, Align::Left, INK));
        let end = [left + width, base];
        self.write(&shown, end, (TEXT, Align::Right, FAINT));
        let track = base + 4.0;
        self.canvas
            .round_rect([left, track], [width, TRACK], TRACK / 2.0, FACE);
        let (zero, knob) = (left + part(0.0) * width, left + part(now) * width);
        let from = zero.min(knob);
        let filled = [(zero - knob).abs(), TRACK];
        self.canvas.rect([from, track], filled, LIT.alpha(110));
        self.canvas
            .circle([knob, track + TRACK / 2.0], TRACK / 2.0 + 3.0, LIT);
        (now != value).then_some(now)
    }

    /// Numbers over time as lines, with a name, and the least and the greatest. `values` adds the
    /// numbers of a line, and returns false if there is none.
    pub(crate) fn lines(
        &mut self,
        name: &str,
        shown: &str,
        mut values: impl FnMut(usize, &mut Vec<f64>) -> bool,
    ) {
        let (top, is_seen) = self.row(TEXT + 6.0 + PLOT);
        if !is_seen {
            return;
        }
        let (left, width) = (MARGIN, self.inner());
        let base = top + TEXT;
        let shown = cut(shown, width * 0.62, SMALL);
        let room = width - text_width(&shown, SMALL) - 8.0;
        let name = cut(name, room, TEXT);
        self.write(&name, [left, base], (TEXT, Align::Left, INK));
        let end = [left + width, base];
        self.write(&shown, end, (SMALL, Align::Right, FAINT));
        let (min, size) = ([left, base + 6.0], [width, PLOT]);
        self.canvas.rect(min, size, Color::WHITE);
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut column = Vec::new();
        while columns.len() < LINES.len() && values(columns.len(), &mut column) {
            columns.push(std::mem::take(&mut column));
        }
        let all = || columns.iter().flatten().copied().filter(|x| x.is_finite());
        let (low, high) = (
            all().fold(f64::INFINITY, f64::min),
            all().fold(f64::NEG_INFINITY, f64::max),
        );
        if low > high {
            return;
        }
        let length = if high > low { high - low } else { 1.0 };
        let middle = (high + low) / 2.0;
        let y = |x: f64| min[1] + PLOT / 2.0 - (x - middle) / length * (PLOT - 8.0);
        if low < 0.0 && high > 0.0 {
            let line = [width, 1.0];
            self.canvas.rect([left, y(0.0)], line, FACE);
        }
        let step = width / (gym::sim::viewer::HISTORY - 1) as f64;
        for (values, color) in columns.iter().zip(LINES) {
            let place = |(i, x): (usize, &f64)| {
                let x = if x.is_finite() { *x } else { middle };
                [left + width - (values.len() - 1 - i) as f64 * step, y(x)]
            };
            let points: Vec<Point> = values.iter().enumerate().map(place).collect();
            self.canvas.stroke(Shape::Polyline(&points), 1.5, color);
        }
        if high > low {
            let corner = [left + 3.0, min[1] + SMALL];
            self.write(&short(high), corner, (7.0, Align::Left, FAINT));
            let corner = [left + 3.0, min[1] + PLOT - 3.0];
            self.write(&short(low), corner, (7.0, Align::Left, FAINT));
        }
    }
}

/// A number in few letters.
pub(crate) fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e4).contains(&size) => {
            let digits = if size < 10.0 {
                3
            } else if size < 100.0 {
                2
            } else {
                1
            };
            format!("{x:.digits$}")
        }
        _ => format!("{x:.2e}"),
    }
}

/// A text of at most some width, cut at its end.
fn cut(text: &str, width: f64, size: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let mut short: String = text.to_owned();
    while short.pop().is_some() {
        let cut = format!("{}..", short.trim_end());
        if text_width(&cut, size) <= width {
            return cut;
        }
    }
    short
}

/// A text in lines of at most some width, broken at spaces.
fn wrapped(text: &str, width: f64, size: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    use gym::canvas::Blank;
    use gym::render::{DrawLog, Pointer};
    use gym_testing::kept;

    const AREA: Area = Area {
        min: (100, 0),
        size: (200, 100),
    };

    /// A frame of a panel with two sliders far apart: their new values.
    fn frame(panel: &mut Panel, input: &mut Input, pointer: Pointer) -> [Option<f64>; 2] {
        input.follow(pointer, Vec::new());
        let mut new = [None; 2];
        panel.rows(AREA, input, &mut Blank, |rows| {
            new[0] = rows.slider("first", 1.0, [-2.0, 2.0]);
            for _ in 0..10 {
                rows.text("between");
            }
            new[1] = rows.slider("second", 0.5, [0.0, 1.0]);
        });
        new
    }

    fn at(x: f64, y: f64) -> Pointer {
        Pointer {
            at: [x, y],
            ..Pointer::default()
        }
    }

    fn left(x: f64, y: f64) -> Pointer {
        Pointer {
            left: true,
            ..at(x, y)
        }
    }

    #[test]
    fn a_slider_is_held_until_the_button_is_up() {
        let (mut panel, mut input) = (Panel::default(), Input::default());
        assert_eq!(frame(&mut panel, &mut input, at(200.0, 20.0)), [None; 2]);
        assert_eq!(
            frame(&mut panel, &mut input, left(200.0, 20.0)),
            [Some(0.0), None]
        );
        // beyond its end, and beside it
        assert_eq!(
            frame(&mut panel, &mut input, left(900.0, 90.0)),
            [Some(2.0), None]
        );
        assert_eq!(frame(&mut panel, &mut input, at(150.0, 20.0)), [None; 2]);
        // a button that went down elsewhere does nothing
        assert_eq!(frame(&mut panel, &mut input, left(50.0, 20.0)), [None; 2]);
        assert_eq!(frame(&mut panel, &mut input, left(200.0, 20.0)), [None; 2]);
        let right = Pointer {
            right: true,
            ..at(150.0, 20.0)
        };
        assert_eq!(frame(&mut panel, &mut input, right), [Some(0.0), None]);
    }

    /// A row of each kind is drawn as in `panel.txt`, one below the other. After an intended change, look at a live window,
    /// then store the calls with `GYM_UPDATE_KEPT=1 cargo test --package gym-cli --features families --lib panel`.
    #[test]
    fn each_row_is_drawn_as_kept() {
        let draw = DrawLog::of(|canvas| {
            let area = Area {
                min: (0, 0),
                size: (200, 400),
            };
            Panel::default().rows(area, &Input::default(), canvas, |rows| {
                rows.heading("joints");
                rows.text("a line of text");
                rows.note("a small line");
                rows.error("what is wrong, in as many lines as it needs");
                rows.buttons(&["one", "two", "a button of the next row"], |i| i == 1);
                rows.slider("hinge", 0.5, [-1.0, 1.0]);
                let columns = [[0.0, 2.0, 1.0], [1.0, f64::NAN, -1.0]];
                rows.lines("height", "2 m", |i, column| {
                    column.extend(columns.get(i).into_iter().flatten());
                    i < columns.len()
                });
                rows.lines("constant", "3 m", |i, column| {
                    column.extend([3.0; 3]);
                    i == 0
                });
            });
        });
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        kept(&folder.join("src/live/panel.txt"), &draw.to_string());
    }

    #[test]
    fn the_wheel_moves_a_long_panel() {
        let (mut panel, mut input) = (Panel::default(), Input::default());
        frame(&mut panel, &mut input, at(200.0, 20.0));
        let place = |panel: &Panel| panel.places[1].1[1];
        let before = place(&panel);
        assert!(before > 100.0, "it is below: {before}");
        let wheel = Pointer {
            wheel: -100.0,
            ..at(200.0, 20.0)
        };
        frame(&mut panel, &mut input, wheel);
        let after = place(&panel);
        assert!(after < 75.0 && after > 40.0, "{after}");
        let pressed = frame(
            &mut panel,
            &mut input,
            left(288.0 - 176.0 / 4.0, after + 5.0),
        );
        assert_eq!(pressed, [None, Some(0.75)]);
        // not beside the panel
        frame(
            &mut panel,
            &mut input,
            Pointer {
                wheel: 100.0,
                ..at(50.0, 20.0)
            },
        );
        assert_eq!(place(&panel), after);
    }

    #[test]
    fn numbers_and_texts_are_short() {
        for (x, text) in [
            (0.0, "0"),
            (-0.123_456, "-0.123"),
            (12.345, "12.35"),
            (123.45, "123.5"),
            (1e-5, "1.00e-5"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short(x), text);
        }
        assert_eq!(cut("short", 200.0, TEXT), "short");
        let long = cut("a name that is far too long", 80.0, TEXT);
        assert!(long.starts_with("a name") && long.ends_with(".."), "{long}");
        assert!(text_width(&long, TEXT) <= 80.0);
        let lines = wrapped("the simulation diverged at 0.1 s", 100.0, TEXT);
        assert!(lines.len() > 1 && lines.join(" ") == "the simulation diverged at 0.1 s");
    }
}
