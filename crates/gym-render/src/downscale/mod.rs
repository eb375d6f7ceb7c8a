//! A large pygame surface that is downscaled to a frame. The whole surface is never stored.
//!
//! Calls are recorded until the drawing is complete. The surface is then drawn in bands of a few
//! rows, which fit into the CPU's cache: each row is reduced horizontally, and the narrow rows are
//! summed vertically.
//!
//! The pixels of a row that are reduced to one pixel form a *window*. Two adjacent windows share
//! the pixel between them. Nearly all windows have a single colour, and only this colour is stored.
//! A window becomes *expanded* (its pixels are stored) when an edge between colours or an
//! antialiased pixel falls into the window. It has a single colour again when a run of pixels
//! covers it. [`mod@band`] draws; [`shrink`] reduces windows to the frame's pixels.

mod band;
mod shrink;
mod windows;

use std::ops::Range;

use gym_core::canvas::{Color, Point, Primitive};
use gym_core::render::Frame;

use crate::pygame;
use band::Band;
use shrink::Shrink;

/// The number of rows of a band: few enough for the cache, and enough to repeat each call rarely.
const BAND: usize = pygame::MOST_ROWS;

/// The largest factor of reduction. With a larger factor, the sums would overflow.
pub(crate) const MAX_FACTOR: usize = 256;

/// A surface and the calls that draw it. The buffers are reused between frames.
#[derive(Debug, Default)]
pub(crate) struct DownscaledSurface {
    width: usize,
    height: usize,
    background: u32,
    calls: Vec<Call>,
    points: Vec<Point>,
    shrink: Shrink,
    /// For each window of a band, row by row: its colour, or [`EXPANDED`](windows::EXPANDED).
    flat: Vec<u32>,
    /// The pixels of each expanded window of a band, with equal space for each window.
    pixels: Vec<u8>,
}

/// A call, and the range of its points in `points`.
#[derive(Clone, Debug)]
struct Call {
    kind: Kind,
    points: Range<usize>,
    color: Color,
    flipped: bool,
    /// The frame's rows that the call may draw on.
    rows: Range<usize>,
    /// The frame's rows that the call colours completely.
    covers: Range<usize>,
}

/// The kind and parameters of a [`Primitive`], without its points.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Line,
    Column,
    AaPolygon,
    FilledPolygon,
    /// `AaPolygon` and `FilledPolygon` with the same points and colour.
    GfxPolygon,
    AaCircle(f64),
    FilledCircle(f64),
    Polygon,
    Lines {
        closed: bool,
        width: u32,
    },
    Circle(f64),
    AaLines {
        closed: bool,
    },
}

impl DownscaledSurface {
    /// Starts a black surface.
    pub(crate) fn begin(&mut self, (width, height): (u32, u32)) {
        (self.width, self.height) = (width as usize, height as usize);
        self.clear(Color::BLACK);
        // more calls than CarRacing makes when its whole field is visible
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

    /// Records a call.
    pub(crate) fn push(&mut self, primitive: &Primitive<'_>, color: Color, flipped: bool) {
        if let Primitive::FilledPolygon(points) = *primitive
            && let Some(last) = self.calls.last()
            && let Kind::AaPolygon = last.kind
            && (last.color, last.flipped) == (color, flipped)
            && self.points[last.points.clone()] == *points
        {
            let covers = self.covered(points, flipped);
            if let Some(last) = self.calls.last_mut() {
                (last.kind, last.covers) = (Kind::GfxPolygon, covers);
            }
            return;
        }
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
            Primitive::Lines {
                points,
                closed,
                width,
            } => {
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
        let high = points
            .iter()
            .fold(f64::NEG_INFINITY, |high, [_, y]| high.max(*y))
            + spread;
        let left = points
            .iter()
            .fold(f64::INFINITY, |left, [x, _]| left.min(*x))
            - spread;
        let right = points
            .iter()
            .fold(f64::NEG_INFINITY, |right, [x, _]| right.max(*x))
            + spread;
        let is_beside = right < -1.0 || left > self.width as f64 + 1.0;
        let rows = if is_beside {
            0..0
        } else {
            self.rows(low as i64, high as i64, flipped)
        };
        let covers = match kind {
            Kind::FilledPolygon | Kind::Polygon => self.covered(points, flipped),
            _ => 0..0,
        };
        if rows.is_empty() {
            self.points.truncate(first);
        } else {
            let points = first..self.points.len();
            self.calls.push(Call {
                kind,
                points,
                color,
                flipped,
                rows,
                covers,
            });
        }
    }

    /// Returns the surface's rows `low..=high`, counted from the top.
    fn rows(&self, low: i64, high: i64, flipped: bool) -> Range<usize> {
        let place = |row: i64| row.clamp(0, self.height as i64) as usize;
        let (low, high) = (place(low), place(high + 1));
        if flipped {
            self.height - high..self.height - low
        } else {
            low..high
        }
    }

    /// Returns the rows (counted from the top) that a polygon covers completely, or an empty range
    /// if this is not cheap to compute.
    fn covered(&self, points: &[Point], flipped: bool) -> Range<usize> {
        let &[a, b, c, d] = points else { return 0..0 };
        let (width, height) = (self.width as f64, self.height as f64);
        let upright = (a[0] == b[0] && b[1] == c[1] && c[0] == d[0] && d[1] == a[1])
            || (a[1] == b[1] && b[0] == c[0] && c[1] == d[1] && d[0] == a[0]);
        if upright {
            let (left, right) = (a[0].min(c[0]), a[0].max(c[0]));
            let (low, high) = (a[1].min(c[1]), a[1].max(c[1]));
            let across = left < 1.0 && right >= width - 1.0;
            return if across {
                self.rows(low as i64, high as i64, flipped)
            } else {
                0..0
            };
        }
        // the polygon covers the surface if all corners of the surface are on the same side of all
        // edges, at some distance
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
        if sides().all(|s| s > AWAY) || sides().all(|s| s < -AWAY) {
            0..self.height
        } else {
            0..0
        }
    }

    /// Draws the surface, and writes the reduced surface to the frame.
    pub(crate) fn finish(&mut self, frame: &mut Frame) {
        self.shrink.start(
            (self.width, self.height),
            (frame.width() as usize, frame.height() as usize),
        );
        match self.shrink.layout.widest {
            0..=4 => self.draw::<4>(frame),
            5..=16 => self.draw::<16>(frame),
            _ => self.draw::<{ windows::MOST }>(frame),
        }
    }

    /// Like [`finish`](Self::finish), for windows of up to `N` pixels.
    fn draw<const N: usize>(&mut self, frame: &mut Frame) {
        let height = self.height;
        let Self {
            calls,
            points,
            shrink,
            flat,
            pixels,
            ..
        } = self;
        let windows = shrink.layout.windows.len();
        pixels.resize(BAND * windows * 3 * N, 0);
        let pixels = pixels.as_chunks_mut::<N>().0.as_chunks_mut::<3>().0;
        flat.resize(BAND * windows, 0);
        let mut top = 0;
        while top < height {
            let (bottom, first) = band(calls, top, height);
            if first == 0 {
                flat.fill(self.background);
            }
            for call in &calls[first.saturating_sub(1)..] {
                if call.rows.start >= bottom || call.rows.end <= top {
                    continue;
                }
                let (rows, flipped) = (
                    top.max(call.rows.start)..bottom.min(call.rows.end),
                    call.flipped,
                );
                let rows = if flipped {
                    height - rows.end..height - rows.start
                } else {
                    rows
                };
                let mut band = Band {
                    rows: rows.start as i32..rows.end as i32,
                    // the row of the band at which the surface's row 0 would lie, and the step to
                    // the next row
                    origin: if flipped {
                        height as isize - 1 - top as isize
                    } else {
                        -(top as isize)
                    },
                    step: if flipped { -1 } else { 1 },
                    color: packed(call.color),
                    flat: &mut *flat,
                    pixels: &mut *pixels,
                    layout: &shrink.layout,
                };
                match call.primitive(points) {
                    Some(primitive) => pygame::paint(&mut band, &primitive, call.color),
                    None => {
                        pygame::gfx_polygon(&mut band, &points[call.points.clone()], call.color);
                    }
                }
            }
            let rows = flat.chunks_exact(windows).zip(pixels.chunks_exact(windows));
            for (flat, pixels) in rows.take(bottom - top) {
                shrink.row(flat, pixels, frame);
            }
            top = bottom;
        }
    }
}

/// Returns the end of the band that begins at row `top`, and the number of calls up to and
/// including the last call that covers the whole band. Earlier calls are invisible.
fn band(calls: &[Call], top: usize, height: usize) -> (usize, usize) {
    let mut bottom = (top + BAND).min(height);
    let mut first = 0;
    for (i, call) in calls
        .iter()
        .enumerate()
        .filter(|(_, call)| !call.covers.is_empty())
    {
        if call.covers.contains(&top) {
            bottom = bottom.min(call.covers.end);
            first = i + 1;
        } else if top < call.covers.start {
            bottom = bottom.min(call.covers.start);
        }
    }
    (bottom, first)
}

impl Call {
    /// Returns the call's primitive; `None` for a [`Kind::GfxPolygon`], which is merged from two
    /// primitives.
    fn primitive<'a>(&self, points: &'a [Point]) -> Option<Primitive<'a>> {
        let points = &points[self.points.clone()];
        let first = points.first().copied().unwrap_or_default();
        let last = points.last().copied().unwrap_or_default();
        Some(match self.kind {
            Kind::Line => Primitive::HLine {
                x1: first[0],
                x2: last[0],
                y: first[1],
            },
            Kind::Column => Primitive::VLine {
                x: first[0],
                y1: first[1],
                y2: last[1],
            },
            Kind::AaPolygon => Primitive::AaPolygon(points),
            Kind::FilledPolygon => Primitive::FilledPolygon(points),
            Kind::GfxPolygon => return None,
            Kind::AaCircle(radius) => Primitive::AaCircle {
                center: first,
                radius,
            },
            Kind::FilledCircle(radius) => Primitive::FilledCircle {
                center: first,
                radius,
            },
            Kind::Polygon => Primitive::Polygon(points),
            Kind::Lines { closed, width } => Primitive::Lines {
                points,
                closed,
                width,
            },
            Kind::Circle(radius) => Primitive::Circle {
                center: first,
                radius,
            },
            Kind::AaLines { closed } => Primitive::AaLines { points, closed },
        })
    }
}

/// Packs a colour: red in the lowest byte, then green, then blue.
fn packed(Color { r, g, b, .. }: Color) -> u32 {
    u32::from_le_bytes([r, g, b, 0])
}
