//! A large surface of pygame's that is shrunk to a frame, without ever being whole.
//!
//! Calls are recorded until the surface is complete. It is then drawn in bands of a few rows, which stay
//! in the cache: each row is shrunk horizontally, and the narrow rows are summed vertically.
//!
//! The pixels of a row that become one pixel of the narrow row are a *window*; two neighbours share the pixel
//! between them. Nearly everywhere a window has one colour, and is kept as that colour alone. It is written
//! out in pixels when a border between colours, or a smoothed pixel, falls into it, and is one colour again
//! when a run covers it.

use std::ops::Range;

use gym_core::canvas::{Color, Point, Primitive};
use gym_core::render::Frame;

use crate::pixels::{self, RGB};
use crate::pygame::{self, Phase, Pixels, part, phases};

/// Rows of a band: few enough to stay in the cache, enough for what each call costs in each band.
const BAND: usize = 64;

/// A surface to draw on and its calls so far. It reuses its buffers between frames.
#[derive(Debug, Default)]
pub(crate) struct Sheet {
    width: usize,
    height: usize,
    background: u32,
    calls: Vec<Call>,
    points: Vec<Point>,
    shrink: Shrink,
    /// The colours of the windows of a band, row by row.
    flat: Vec<u32>,
    /// The pixels of a band, in windows that are written out.
    pixels: Vec<u32>,
    /// A bit for each window that is written out, row by row.
    marks: Vec<u64>,
}

/// A call, and where its points are.
#[derive(Clone, Debug)]
struct Call {
    kind: Kind,
    points: Range<usize>,
    color: Color,
    flipped: bool,
    /// The rows of the frame that it can reach.
    rows: Range<usize>,
    /// The rows of the frame that it covers completely.
    covers: Range<usize>,
}

/// The parts of a [`Primitive`] that are not points.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Line,
    Column,
    AaPolygon,
    FilledPolygon,
    AaCircle(f64),
    FilledCircle(f64),
    Polygon,
    Lines { closed: bool, width: u32 },
    Circle(f64),
    AaLines { closed: bool },
}

impl Sheet {
    /// Starts a black surface.
    pub(crate) fn begin(&mut self, (width, height): (u32, u32)) {
        (self.width, self.height) = (width as usize, height as usize);
        self.clear(Color::BLACK);
        // more than CarRacing's calls when all of its field is in sight
        self.calls.reserve(4096);
        self.points.reserve(4 * 4096);
    }

    pub(crate) fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    pub(crate) fn clear(&mut self, color: Color) {
        self.background = packed(color);
        self.calls.clear();
        self.points.clear();
    }

    /// Keeps a call.
    pub(crate) fn push(&mut self, primitive: &Primitive<'_>, color: Color, flipped: bool) {
        let first = self.points.len();
        let (kind, spread) = match *primitive {
            Primitive::HLine { x1, x2, y } => {
                self.points.extend([[x1, y], [x2, y]]);
                (Kind::Line, 0.0)
            }
            Primitive::VLine { x, y1, y2 } => {
                self.points.extend([[x, y1], [x, y2]]);
                (Kind::Column, 0.0)
            }
            Primitive::AaPolygon(points) => {
                self.points.extend(points);
                (Kind::AaPolygon, 1.0)
            }
            Primitive::FilledPolygon(points) => {
                self.points.extend(points);
                (Kind::FilledPolygon, 0.0)
            }
            Primitive::Polygon(points) => {
                self.points.extend(points);
                (Kind::Polygon, 0.0)
            }
            Primitive::Lines { points, closed, width } => {
                self.points.extend(points);
                (Kind::Lines { closed, width }, f64::from(width))
            }
            Primitive::AaLines { points, closed } => {
                self.points.extend(points);
                (Kind::AaLines { closed }, 2.0)
            }
            Primitive::AaCircle { center, radius } => {
                self.points.push(center);
                (Kind::AaCircle(radius), radius + 2.0)
            }
            Primitive::FilledCircle { center, radius } => {
                self.points.push(center);
                (Kind::FilledCircle(radius), radius + 1.0)
            }
            Primitive::Circle { center, radius } => {
                self.points.push(center);
                (Kind::Circle(radius), radius + 1.0)
            }
        };
        let points = &self.points[first..];
        let low = points.iter().fold(f64::INFINITY, |low, [_, y]| low.min(*y)) - spread;
        let high = points.iter().fold(f64::NEG_INFINITY, |high, [_, y]| high.max(*y)) + spread;
        let rows = self.rows(low as i64, high as i64, flipped);
        let covers = match kind {
            Kind::FilledPolygon | Kind::Polygon => self.covered(points, flipped),
            _ => 0..0,
        };
        if rows.is_empty() {
            self.points.truncate(first);
        } else {
            let points = first..self.points.len();
            self.calls.push(Call { kind, points, color, flipped, rows, covers });
        }
    }

    /// Rows of the frame, from rows of the surface.
    fn rows(&self, low: i64, high: i64, flipped: bool) -> Range<usize> {
        let place = |row: i64| row.clamp(0, self.height as i64) as usize;
        let (low, high) = (place(low), place(high + 1));
        if flipped { self.height - high..self.height - low } else { low..high }
    }

    /// The rows that a polygon covers completely, if easily computed.
    fn covered(&self, points: &[Point], flipped: bool) -> Range<usize> {
        let &[a, b, c, d] = points else { return 0..0 };
        let (width, height) = (self.width as f64, self.height as f64);
        let upright = (a[0] == b[0] && b[1] == c[1] && c[0] == d[0] && d[1] == a[1])
            || (a[1] == b[1] && b[0] == c[0] && c[1] == d[1] && d[0] == a[0]);
        if upright {
            let (left, right) = (a[0].min(c[0]), a[0].max(c[0]));
            let (low, high) = (a[1].min(c[1]), a[1].max(c[1]));
            let across = left < 1.0 && right >= width - 1.0;
            return if across { self.rows(low as i64, high as i64, flipped) } else { 0..0 };
        }
        // the corners of the surface lie on one side of all edges, well away from them
        const AWAY: f64 = 4.0;
        let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
        let side = |from: Point, to: Point, p: Point| {
            let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
            (dx * (p[1] - from[1]) - dy * (p[0] - from[0])) / (dx * dx + dy * dy).sqrt()
        };
        let sides = || {
            [(a, b), (b, c), (c, d), (d, a)]
                .into_iter()
                .flat_map(move |(from, to)| corners.map(|corner| side(from, to, corner)))
        };
        if sides().all(|s| s > AWAY) || sides().all(|s| s < -AWAY) { 0..self.height } else { 0..0 }
    }

    /// Draws the surface and writes it, shrunk, to the frame.
    pub(crate) fn finish(&mut self, frame: &mut Frame) {
        let (width, height) = (self.width, self.height);
        self.shrink.start((width, height), (frame.width() as usize, frame.height() as usize));
        self.pixels.resize(BAND * width, 0);
        self.marks.resize(BAND * self.shrink.words, 0);
        let windows = self.shrink.windows.len();
        self.flat.resize(BAND * windows, 0);
        let mut top = 0;
        while top < height {
            let (bottom, first) = self.band(top);
            self.marks.fill(0);
            if first == 0 {
                self.flat.fill(self.background);
            }
            for call in &self.calls[first.saturating_sub(1)..] {
                if call.rows.start >= bottom || call.rows.end <= top {
                    continue;
                }
                let (rows, flipped) = (top.max(call.rows.start)..bottom.min(call.rows.end), call.flipped);
                let rows = if flipped { height - rows.end..height - rows.start } else { rows };
                let mut band = Band {
                    width: width as i32,
                    height: height as i32,
                    rows: rows.start as i32..rows.end as i32,
                    // the place of row 0 of the surface, and the way to the next
                    origin: if flipped { height as isize - 1 - top as isize } else { -(top as isize) },
                    step: if flipped { -1 } else { 1 },
                    color: packed(call.color),
                    flat: &mut self.flat,
                    pixels: &mut self.pixels,
                    marks: &mut self.marks,
                    words: self.shrink.words,
                    windows: &self.shrink.windows,
                    border: &self.shrink.border,
                };
                pygame::paint(&mut band, &call.primitive(&self.points), call.color);
            }
            let marks = self.marks.chunks_exact(self.shrink.words);
            let rows = self.flat.chunks_exact(windows).zip(self.pixels.chunks_exact(width)).zip(marks);
            for ((flat, pixels), marks) in rows.take(bottom - top) {
                self.shrink.row(flat, pixels, marks, frame);
            }
            top = bottom;
        }
    }

    /// Where the band ends that begins at a row, and the number of calls up to the last one that covers it
    /// all: what came before is out of sight.
    fn band(&self, top: usize) -> (usize, usize) {
        let mut bottom = (top + BAND).min(self.height);
        let mut first = 0;
        for (i, call) in self.calls.iter().enumerate().filter(|(_, call)| !call.covers.is_empty()) {
            if call.covers.contains(&top) {
                bottom = bottom.min(call.covers.end);
                first = i + 1;
            } else if top < call.covers.start {
                bottom = bottom.min(call.covers.start);
            }
        }
        (bottom, first)
    }
}

impl Call {
    fn primitive<'a>(&self, points: &'a [Point]) -> Primitive<'a> {
        let points = &points[self.points.clone()];
        let first = points.first().copied().unwrap_or_default();
        let last = points.last().copied().unwrap_or_default();
        match self.kind {
            Kind::Line => Primitive::HLine { x1: first[0], x2: last[0], y: first[1] },
            Kind::Column => Primitive::VLine { x: first[0], y1: first[1], y2: last[1] },
            Kind::AaPolygon => Primitive::AaPolygon(points),
            Kind::FilledPolygon => Primitive::FilledPolygon(points),
            Kind::AaCircle(radius) => Primitive::AaCircle { center: first, radius },
            Kind::FilledCircle(radius) => Primitive::FilledCircle { center: first, radius },
            Kind::Polygon => Primitive::Polygon(points),
            Kind::Lines { closed, width } => Primitive::Lines { points, closed, width },
            Kind::Circle(radius) => Primitive::Circle { center: first, radius },
            Kind::AaLines { closed } => Primitive::AaLines { points, closed },
        }
    }
}

/// Red in the lowest byte, then green, then blue.
fn packed(Color { r, g, b, .. }: Color) -> u32 {
    u32::from_le_bytes([r, g, b, 0])
}

/// Some rows of the surface.
struct Band<'a> {
    width: i32,
    height: i32,
    rows: Range<i32>,
    origin: isize,
    step: isize,
    color: u32,
    flat: &'a mut [u32],
    pixels: &'a mut [u32],
    marks: &'a mut [u64],
    words: usize,
    windows: &'a [Window],
    border: &'a [u16],
}

impl Band<'_> {
    /// Which row of the band it is.
    fn place(&self, y: i32) -> usize {
        (self.origin + self.step * y as isize) as usize
    }

    /// Writes out the window that the border left of a pixel lies in.
    #[inline]
    fn write_out(&mut self, row: usize, x: usize) {
        let index = usize::from(self.border[x]);
        if self.marks[row * self.words + index / 64] & 1 << (index % 64) == 0 {
            self.write_out_window(row, index);
        }
    }

    #[inline(never)]
    fn write_out_window(&mut self, row: usize, index: usize) {
        self.marks[row * self.words + index / 64] |= 1 << (index % 64);
        // a border at an end of the row lies in no window
        if let Some(window) = self.windows.get(index) {
            let color = self.flat[row * self.windows.len() + index];
            let first = row * self.width as usize + usize::from(window.first);
            self.pixels[first..=first + usize::from(window.last - window.first)].fill(color);
        }
    }

    /// The pixel to change, in windows that are written out.
    fn pixel(&mut self, x: i32, y: i32) -> &mut u32 {
        self.get_ready(x, x, y);
        &mut self.pixels[self.place(y) * self.width as usize + x as usize]
    }

    /// Makes windows one colour.
    fn flatten(&mut self, row: usize, windows: Range<usize>) {
        let (first, last) = (windows.start, windows.end - 1);
        self.flat[row * self.windows.len()..][windows].fill(self.color);
        let marks = &mut self.marks[row * self.words..][first / 64..=last / 64];
        let count = marks.len();
        let (below, above) = (!(u64::MAX << (first % 64)), !(u64::MAX >> (63 - last % 64)));
        for (i, word) in marks.iter_mut().enumerate() {
            *word &= if i == 0 { below } else { 0 } | if i + 1 == count { above } else { 0 };
        }
    }
}

impl Pixels for Band<'_> {
    fn width(&self) -> i32 {
        self.width
    }

    fn height(&self) -> i32 {
        self.height
    }

    fn rows(&self) -> Range<i32> {
        self.rows.clone()
    }

    fn run(&mut self, x1: i32, x2: i32, y: i32, _: Color) {
        let (row, x1, x2) = (self.place(y), x1 as usize, x2 as usize + 1);
        let (left, right) = (usize::from(self.border[x1]), usize::from(self.border[x2]));
        let start = row * self.width as usize;
        if x1 > 0 && left == right {
            self.write_out(row, x1);
            return self.pixels[start + x1..start + x2].fill(self.color);
        }
        let (mut first, mut last) = (0, self.windows.len());
        if x1 > 0 {
            self.write_out(row, x1);
            let end = usize::from(self.windows[left].last);
            self.pixels[start + x1..=start + end].fill(self.color);
            first = left + 1;
        }
        if x2 < self.width as usize {
            self.write_out(row, x2);
            let begin = usize::from(self.windows[right].first).max(x1);
            self.pixels[start + begin..start + x2].fill(self.color);
            last = right;
        }
        if first < last {
            self.flatten(row, first..last);
        }
    }

    fn change(&mut self, x: i32, y: i32, color: Color, f: impl Fn(u8, u8) -> u8) {
        let pixel = self.pixel(x, y);
        let [r, g, b, _] = pixel.to_le_bytes();
        *pixel = u32::from_le_bytes([f(r, color.r), f(g, color.g), f(b, color.b), 0]);
    }

    #[inline]
    fn blend(&mut self, x: i32, y: i32, color: Color, weight: i32) {
        self.get_ready(x, x, y);
        self.blend_ready(x, y, color, weight);
    }

    #[inline]
    fn get_ready(&mut self, x1: i32, x2: i32, y: i32) {
        let row = self.place(y);
        let marks = row * self.words;
        // (the border at the start of a row lies in no window)
        let first = usize::from(self.border[x1.max(1) as usize]);
        let last = usize::from(self.border[x2 as usize + 1]);
        for index in first..=last {
            if self.marks[marks + index / 64] & 1 << (index % 64) == 0 {
                self.write_out_window(row, index);
            }
        }
    }

    #[inline]
    fn blend_ready(&mut self, x: i32, y: i32, _: Color, weight: i32) {
        let color = self.color;
        let at = self.place(y) * self.width as usize + x as usize;
        let pixel = &mut self.pixels[at];
        // all channels at once: (d * (256 - weight) + s * weight) >> 8 stays below 2^16 in each
        let apart = |pixel: u32| u64::from(pixel & 0x00ff_00ff) | u64::from(pixel & 0xff00) << 24;
        let sum = apart(*pixel) * (256 - weight) as u64 + apart(color) * weight as u64;
        let sum = sum >> 8 & 0x00ff_00ff_00ff;
        *pixel = sum as u32 | (sum >> 24) as u32 & 0xff00;
    }
}

/// The first and the last pixel that a pixel of the narrow row is made of.
#[derive(Clone, Copy, Debug)]
struct Window {
    first: u16,
    last: u16,
}

/// Shrinks rows, and sums them up.
///
/// Most windows have the colour that they had in the row above, and most pixels of the frame that of the
/// pixel above. Where a row of the frame is made of whole rows, a window is *loose* as long as it has one colour
/// and had no other for the row of the frame above: it has no sum, and its pixel is that above.
#[derive(Debug, Default)]
struct Shrink {
    from: (usize, usize),
    to: (usize, usize),
    columns: Vec<Phase>,
    rows: Vec<Phase>,
    /// One for each pixel of the narrow row.
    windows: Vec<Window>,
    /// For the border left of each pixel, the window that it lies in.
    border: Vec<u16>,
    /// Words of a narrow row's marks.
    words: usize,
    /// The colour that each window last had, as a whole, and the pixel of the narrow row that it becomes: all
    /// reds, greens, blues. From row to row few change.
    colors: Vec<u32>,
    plain: Vec<u16>,
    /// The row from which on that pixel is still to be added to the sums.
    since: Vec<u16>,
    /// A narrow row: all its reds, greens, blues.
    narrow: Vec<u16>,
    /// What the rows so far add up to.
    sums: Vec<u16>,
    /// A bit for each window that is not loose.
    tight: Vec<u64>,
    /// A bit for each window that has had more than one colour in the row of the frame so far.
    mixed: Vec<u64>,
    /// Whether each row of the frame is made of whole rows.
    is_whole: bool,
    /// The next row of the surface, and of the frame.
    at: (usize, usize),
}

impl Shrink {
    /// Gets ready for a surface and a frame of these sizes.
    fn start(&mut self, from: (usize, usize), to: (usize, usize)) {
        self.at = (0, 0);
        self.sums.clear();
        self.sums.resize(3 * to.0, 0);
        self.since.clear();
        self.since.resize(to.0, 0);
        self.words = to.0 / 64 + 1;
        self.tight.clear();
        self.tight.resize(self.words, u64::MAX);
        self.mixed.clear();
        self.mixed.resize(self.words, 0);
        if (self.from, self.to) == (from, to) {
            return;
        }
        (self.from, self.to) = (from, to);
        (self.columns, self.rows) = (phases(from.0, to.0), phases(from.1, to.1));
        self.is_whole = from.1.is_multiple_of(to.1);
        self.narrow.resize(3 * to.0, 0);
        self.windows.clear();
        // a border at an end of the row lies in no window
        self.border = vec![to.0 as u16; from.0 + 1];
        for (i, phase) in self.columns.iter().enumerate() {
            self.windows.push(Window { first: phase.first as u16, last: phase.last as u16 });
            self.border[phase.first + 1..=phase.last].fill(i as u16);
        }
        // black, which becomes black
        self.colors = vec![0; to.0];
        self.plain = vec![0; 3 * to.0];
    }

    /// Adds a row of the surface; completes a row of the frame if it is its last.
    fn row(&mut self, flat: &[u32], pixels: &[u32], marks: &[u64], frame: &mut Frame) {
        let (y, k) = self.at;
        self.at.0 += 1;
        let Some(&phase) = self.rows.get(k) else { return };
        self.change_colors(flat, &phase);
        for (word, marks) in marks.iter().enumerate() {
            self.mixed[word] |= marks;
            let mut loose = marks & !self.tight[word];
            while loose != 0 {
                self.tighten(64 * word + loose.trailing_zeros() as usize, &phase);
                loose &= loose - 1;
            }
        }
        if y < phase.last {
            let width = self.to.0;
            each(marks, |window| {
                let Some(columns) = self.columns.get(window) else { return };
                for (channel, mean) in mean(columns, pixels).into_iter().enumerate() {
                    let at = channel * width + window;
                    // its plain pixel will be added in its place
                    self.sums[at] = self.sums[at].wrapping_add(mean).wrapping_sub(self.plain[at]);
                }
            });
            return;
        }
        self.at.1 += 1;
        if self.is_whole && k > 0 {
            self.complete_tight(pixels, marks, &phase, frame);
        } else {
            let next_share = self.rows.get(k + 1).map_or(0, |next| next.first_share);
            self.complete_all(pixels, marks, &phase, next_share, frame);
        }
        if self.is_whole {
            std::mem::swap(&mut self.tight, &mut self.mixed);
            self.mixed.fill(0);
        }
    }

    /// Gives a loose window its sum, which is still to be made.
    #[inline]
    fn tighten(&mut self, window: usize, phase: &Phase) {
        let (word, bit) = (window / 64, 1 << (window % 64));
        if self.tight[word] & bit == 0 && window < self.to.0 {
            self.tight[word] |= bit;
            self.since[window] = phase.begin as u16;
            for channel in 0..3 {
                self.sums[channel * self.to.0 + window] = 0;
            }
        }
    }

    /// Takes over the colours of windows in a row, and adds to the sums what those were that change.
    fn change_colors(&mut self, flat: &[u32], phase: &Phase) {
        const CHUNK: usize = 8;
        let (width, y) = (self.to.0, self.at.0 as u16 - 1);
        for (i, flat) in flat.chunks(CHUNK).enumerate() {
            // (a comparison of slices calls a function of the C library)
            let colors = &self.colors[CHUNK * i..][..flat.len()];
            if colors.iter().zip(flat).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0 {
                continue;
            }
            for (window, &flat) in (CHUNK * i..).zip(flat) {
                if self.colors[window] == flat {
                    continue;
                }
                self.tighten(window, phase);
                self.mixed[window / 64] |= 1 << (window % 64);
                self.colors[window] = flat;
                let rows = y - std::mem::replace(&mut self.since[window], y);
                let columns = &self.columns[window];
                for (channel, value) in flat.to_le_bytes().into_iter().take(3).enumerate() {
                    let at = channel * width + window;
                    self.sums[at] = self.sums[at].wrapping_add(self.plain[at].wrapping_mul(rows));
                    let value = u16::from(value);
                    let whole = value.wrapping_mul((columns.last - columns.begin) as u16);
                    self.plain[at] = columns.mean(value, whole, value).into();
                }
            }
        }
    }

    /// Completes a row of the frame in which no window is loose. The last row of the surface has a share in the
    /// next one.
    fn complete_all(
        &mut self,
        pixels: &[u32],
        marks: &[u64],
        phase: &Phase,
        next_share: u16,
        frame: &mut Frame,
    ) {
        let (width, y) = (self.to.0, phase.last as u16);
        for (sums, plain) in self.sums.chunks_exact_mut(width).zip(self.plain.chunks_exact(width)) {
            for ((sum, plain), since) in sums.iter_mut().zip(plain).zip(&self.since) {
                *sum = sum.wrapping_add(plain.wrapping_mul(y - since));
            }
        }
        self.since.fill(y + 1);
        self.narrow.copy_from_slice(&self.plain);
        each(marks, |window| {
            let Some(columns) = self.columns.get(window) else { return };
            for (channel, mean) in mean(columns, pixels).into_iter().enumerate() {
                self.narrow[channel * width + window] = mean;
            }
        });
        for (sum, v) in self.sums.iter_mut().zip(&mut self.narrow) {
            let total = u32::from(sum.wrapping_add(part(*v, phase.last_share)));
            *sum = part(*v, next_share);
            *v = ((total * u32::from(phase.reciprocal)) >> 16) as u16;
        }
        let (reds, rest) = self.narrow.split_at(width);
        let (greens, blues) = rest.split_at(width);
        let row = pixels::row(frame, self.at.1 - 1).chunks_exact_mut(RGB);
        for (((pixel, r), g), b) in row.zip(reds).zip(greens).zip(blues) {
            pixel.copy_from_slice(&[*r as u8, *g as u8, *b as u8]);
        }
    }

    /// Completes a row of the frame, of which the loose windows are as above.
    fn complete_tight(&mut self, pixels: &[u32], marks: &[u64], phase: &Phase, frame: &mut Frame) {
        let (width, y) = (self.to.0, phase.last as u16);
        let start = (self.at.1 - 1) * width * RGB;
        let (above, row) = frame.pixels_mut()[start - width * RGB..].split_at_mut(width * RGB);
        row[..width * RGB].copy_from_slice(above);
        each(&self.tight, |window| {
            let Some(columns) = self.columns.get(window) else { return };
            let is_marked = marks[window / 64] & 1 << (window % 64) != 0;
            let places = [0, 1, 2].map(|channel| channel * width + window);
            let values = if is_marked { mean(columns, pixels) } else { places.map(|at| self.plain[at]) };
            let rows = y - std::mem::replace(&mut self.since[window], y + 1);
            for ((pixel, at), v) in row[window * RGB..].iter_mut().zip(places).zip(values) {
                let sum = self.sums[at].wrapping_add(self.plain[at].wrapping_mul(rows));
                *pixel = phase.of(sum, v);
                self.sums[at] = 0;
            }
        });
    }
}

/// Calls `f` with the number of each bit that is set.
#[inline]
fn each(words: &[u64], mut f: impl FnMut(usize)) {
    for (i, mut bits) in words.iter().copied().enumerate() {
        while bits != 0 {
            f(64 * i + bits.trailing_zeros() as usize);
            bits &= bits - 1;
        }
    }
}

/// The red, green and blue that a window of a row becomes.
#[inline]
fn mean(phase: &Phase, row: &[u32]) -> [u16; 3] {
    // two pixels at a time, each channel with room for a sum
    let (mut red_blue, mut green) = (0_u64, 0_u64);
    let mut pairs = row[phase.begin..phase.last].chunks_exact(2);
    let mut add = |pixels: u64| {
        red_blue += pixels & 0x00ff_00ff_00ff_00ff;
        green += pixels >> 8 & 0x00ff_00ff_00ff_00ff;
    };
    pairs.by_ref().map(|pair| u64::from(pair[0]) | u64::from(pair[1]) << 32).for_each(&mut add);
    if let [pixel] = *pairs.remainder() {
        add(pixel.into());
    }
    let (red_blue, green) = ((red_blue + (red_blue >> 32)) as u32, (green + (green >> 32)) as u32);
    // red and blue side by side, as `Phase::mean` computes one of them
    let apart = |red_blue: u32| (u64::from(red_blue) | u64::from(red_blue) << 16) & 0x0000_ffff_0000_ffff;
    let part = |pixel: u32, share: u16| {
        (apart(pixel & 0x00ff_00ff) * u64::from(share)) >> 14 & 0x0000_ffff_0000_ffff
    };
    let (first, last) = (row[phase.first], row[phase.last]);
    let sum = part(first, phase.first_share) + apart(red_blue) + part(last, phase.last_share);
    let red_blue = (sum & 0x0000_ffff_0000_ffff) * u64::from(phase.reciprocal);
    let green = phase.mean(u16::from((first >> 8) as u8), green as u16, u16::from((last >> 8) as u8));
    [u16::from((red_blue >> 16) as u8), green.into(), u16::from((red_blue >> 48) as u8)]
}
