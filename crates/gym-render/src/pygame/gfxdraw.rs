//! `pygame.gfxdraw`: edges antialiased over two pixels, and fills without antialiasing.

use std::ops::Range;

use gym_core::canvas::{Color, Point};

use super::{Edge, Edges, FEW, MANY, Pixels, whole};

/// Draws the antialiased outline of a polygon.
pub(super) fn aapolygon(pixels: &mut impl Pixels, points: &[Point], color: Color) {
    for (i, &p) in points.iter().enumerate() {
        let q = points.get(i + 1).unwrap_or(&points[0]);
        aaline(pixels, whole(p), whole(*q), color);
    }
}

const LEFT: u8 = 1;
const RIGHT: u8 = 2;
const BOTTOM: u8 = 4;
const TOP: u8 = 8;

/// Clips the line from `p` to `q` to the surface. The result may have the ends swapped.
fn clip(mut p: [i16; 2], mut q: [i16; 2], [right, bottom]: [i16; 2]) -> Option<[[i16; 2]; 2]> {
    let outside = |[x, y]: [i16; 2]| {
        (u8::from(x < 0) * LEFT)
            | (u8::from(x > right) * RIGHT)
            | (u8::from(y > bottom) * BOTTOM)
            | (u8::from(y < 0) * TOP)
    };
    // each iteration moves an end to an edge; rounding can move the end back, but only a few times
    for _ in 0..64 {
        if outside(p) | outside(q) == 0 {
            return Some([p, q]);
        }
        if outside(p) & outside(q) != 0 {
            return None;
        }
        if outside(p) == 0 {
            (p, q) = (q, p);
        }
        let d = [0, 1].map(|i| f32::from(q[i]) - f32::from(p[i]));
        let m = if d[0] == 0.0 { 1.0 } else { d[1] / d[0] };
        let code = outside(p);
        if code & (LEFT | RIGHT) != 0 {
            let edge = if code & LEFT != 0 { 0 } else { right };
            p[1] = p[1].wrapping_add(((f32::from(edge) - f32::from(p[0])) * m) as i16);
            p[0] = edge;
        } else {
            let edge = if code & BOTTOM != 0 { bottom } else { 0 };
            if q[0] != p[0] {
                p[0] = p[0].wrapping_add(((f32::from(edge) - f32::from(p[1])) / m) as i16);
            }
            p[1] = edge;
        }
    }
    None
}

/// Draws an antialiased line: each step along the line divides the colour between two adjacent
/// pixels across the line. The next line of an outline draws the last pixel.
fn aaline(pixels: &mut impl Pixels, p: [i32; 2], q: [i32; 2], color: Color) {
    let corner = [(pixels.width() - 1) as i16, (pixels.height() - 1) as i16];
    let Some([p, q]) = clip(p.map(|x| x as i16), q.map(|x| x as i16), corner) else {
        return;
    };
    let [p, q] = [p, q].map(|point| point.map(i32::from));
    let (top, end) = if q[1] < p[1] { (q, p) } else { (p, q) };
    let [tx, ty] = top;
    let (dx, dy) = ((end[0] - tx).unsigned_abs(), (end[1] - ty).unsigned_abs());
    if dx == 0 {
        return pixels.vline(tx, ty, end[1], color);
    }
    if dy == 0 {
        return pixels.hline(tx, end[0], ty, color);
    }
    pixels.hline(p[0], p[0], p[1], color);
    let sx = (end[0] - tx).signum();
    let (major, minor) = (dx.max(dy), dx.min(dy));
    // pygame's 32-bit error term; at 45 degrees the term overflows to 0, and the line moves at
    // every step
    let step = u64::from(((minor << 16) / major) << 16);
    let step = if step == 0 { 1 << 32 } else { step };
    // the first step at which the line has moved `minor` pixels along the minor axis
    let first_at =
        |minor: i32| u64::try_from(minor).map_or(0, |minor| (minor << 32).div_ceil(step));
    let rows = pixels.rows();
    let (from, to) = (rows.start - ty, rows.end - ty);
    let steps =
        |from: u64, to: u64| (from.max(1) as u32).min(major)..(to.min(u64::from(major)) as u32);
    let weights = |at: u64| {
        let w = (at >> 24 & 0xff) as i32;
        [(255 * (255 - w)) >> 8, (255 * w) >> 8]
    };
    if dy > dx {
        let steps = steps(from.max(0) as u64, to.max(0) as u64);
        let mut at = u64::from(steps.start) * step;
        for k in steps {
            let [near, far] = weights(at);
            let (x, y) = (tx + sx * (at >> 32) as i32, ty + k as i32);
            at += step;
            pixels.blend(x, y, color, near);
            // the line is on the surface, but the second pixel across the line may not be
            if x + sx >= 0 && x + sx < pixels.width() {
                pixels.blend(x + sx, y, color, far);
            }
        }
        return;
    }
    let Range { start: mut k, end } = steps(first_at(from - 1), first_at(to));
    let mut at = u64::from(k) * step;
    while k < end {
        // draw together all steps whose two pixels are in the same rows
        let (minor, first) = (at >> 32, k);
        while k < end && at >> 32 == minor {
            k += 1;
            at += step;
        }
        let [x, last] = [first, k - 1].map(|k| tx + sx * k as i32);
        let y = ty + minor as i32;
        for (below, y) in [(0, y), (1, y + 1)] {
            if rows.contains(&y) {
                let weight = |x: i32| weights((sx * (x - tx)) as u64 * step)[below];
                pixels.blend_span(x.min(last), x.max(last), y, color, weight);
            }
        }
    }
}

/// Fills a polygon, including a part of its outline.
pub(super) fn filled_polygon(pixels: &mut impl Pixels, points: &[Point], color: Color) {
    if points.len() <= FEW {
        fill::<FEW>(pixels, points, color);
    } else {
        fill::<MANY>(pixels, points, color);
    }
}

fn fill<const MOST: usize>(pixels: &mut impl Pixels, points: &[Point], color: Color) {
    scan::<MOST>(pixels.rows(), points, |x1, x2, y| {
        pixels.hline(x1, x2, y, color);
    });
}

/// Calls `draw` with the runs inside of a polygon in `rows`; the ends of a run may be in either
/// order.
#[inline]
fn scan<const MOST: usize>(
    rows: Range<i32>,
    points: &[Point],
    mut draw: impl FnMut(i32, i32, i32),
) {
    let edges = Edges::<MOST>::new(points);
    let cut = |edge: &Edge, y: i32, _: usize| {
        edge.share(y)
            .wrapping_mul(edge.x2 - edge.x1)
            .wrapping_add(edge.x1.wrapping_mul(65536))
    };
    let round = |v: i32| (v >> 16) + (v >> 15 & 1);
    edges.scan(rows, cut, |a, b, y| {
        draw(round(a.wrapping_add(1)), round(b.wrapping_sub(1)), y);
    });
}

/// The largest number of rows of a surface on which [`polygon`] draws.
pub(crate) const MOST_ROWS: usize = 64;

/// Draws [`aapolygon`] and then [`filled_polygon`] with the same points, but skips the part of the
/// outline that the fill covers.
pub(crate) fn polygon(pixels: &mut impl Pixels, points: &[Point], color: Color) {
    let rows = pixels.rows();
    let mut inside = Inside {
        top: rows.start,
        runs: [[0; 2]; MOST_ROWS],
    };
    let mut is_simple = points.len() <= FEW && rows.len() <= MOST_ROWS;
    if is_simple {
        let right = pixels.width() - 1;
        scan::<FEW>(rows.clone(), points, |x1, x2, y| {
            let run = &mut inside.runs[(y - rows.start) as usize];
            is_simple &= *run == [0; 2];
            *run = [x1.min(x2).max(0), x1.max(x2).min(right) + 1];
        });
    }
    if !is_simple {
        aapolygon(pixels, points, color);
        return filled_polygon(pixels, points, color);
    }
    for (y, [x1, x2]) in rows.zip(inside.runs) {
        if x1 < x2 {
            pixels.run(x1, x2 - 1, y, color);
        }
    }
    aapolygon(
        &mut Outside {
            pixels,
            inside: &inside,
        },
        points,
        color,
    );
}

/// For each row, the run of pixels that a polygon's fill covers: the first pixel, and the pixel
/// after the last.
struct Inside {
    top: i32,
    runs: [[i32; 2]; MOST_ROWS],
}

/// A surface that ignores blending on the pixels that a polygon's fill will cover.
struct Outside<'a, P> {
    pixels: &'a mut P,
    inside: &'a Inside,
}

impl<P: Pixels> Outside<'_, P> {
    #[inline]
    fn covered(&self, y: i32) -> Range<i32> {
        let [start, end] = self.inside.runs[(y - self.inside.top) as usize];
        start..end
    }
}

impl<P: Pixels> Pixels for Outside<'_, P> {
    fn width(&self) -> i32 {
        self.pixels.width()
    }

    fn height(&self) -> i32 {
        self.pixels.height()
    }

    fn rows(&self) -> Range<i32> {
        self.pixels.rows()
    }

    fn run(&mut self, x1: i32, x2: i32, y: i32, color: Color) {
        self.pixels.run(x1, x2, y, color);
    }

    fn change(&mut self, x: i32, y: i32, color: Color, f: impl Fn(u8, u8) -> u8) {
        if !self.covered(y).contains(&x) {
            self.pixels.change(x, y, color, f);
        }
    }

    #[inline]
    fn blend(&mut self, x: i32, y: i32, color: Color, weight: i32) {
        if !self.covered(y).contains(&x) {
            self.pixels.blend(x, y, color, weight);
        }
    }

    #[inline]
    fn blend_span(&mut self, x1: i32, x2: i32, y: i32, color: Color, weight: impl Fn(i32) -> i32) {
        let covered = self.covered(y);
        if covered.is_empty() {
            return self.pixels.blend_span(x1, x2, y, color, weight);
        }
        for (x1, x2) in [(x1, x2.min(covered.start - 1)), (x1.max(covered.end), x2)] {
            if x1 <= x2 {
                self.pixels.blend_span(x1, x2, y, color, &weight);
            }
        }
    }
}

/// Draws a filled circle with its outline.
pub(super) fn filled_circle(pixels: &mut impl Pixels, [x, y]: [i32; 2], radius: i32, color: Color) {
    if radius == 0 {
        return pixels.hline(x, x, y, color);
    }
    let (mut u, mut v, mut f) = (0, radius, 1 - radius);
    let mut before = None;
    while u <= v {
        if before != Some(v) {
            pixels.hline(x - u, x + u, y + v, color);
            pixels.hline(x - u, x + u, y - v, color);
            before = Some(v);
        }
        if u != v {
            pixels.hline(x - v, x + v, y + u, color);
            pixels.hline(x - v, x + v, y - u, color);
        }
        if f < 0 {
            f += 2 * u + 3;
        } else {
            f += 2 * (u - v) + 5;
            v -= 1;
        }
        u += 1;
    }
}

/// Draws the antialiased outline of a circle.
pub(super) fn aacircle(pixels: &mut impl Pixels, [x, y]: [i32; 2], radius: i32, color: Color) {
    if radius == 0 {
        return pixels.hline(x, x, y, color);
    }
    // the terms of the midpoint algorithm for an ellipse with equal axes
    let area = i64::from(radius) * i64::from(radius);
    let quarter = (area as f64 / ((2 * area) as f64).sqrt()).round_ties_even() as i32;
    let (mut t, mut s, mut d) = (0, -2 * area * i64::from(radius), 0);
    let (mut px, mut py) = (x, y - radius);
    let mirrored = |px: i32, py: i32| {
        [
            [px, py],
            [2 * x - px, py],
            [px, 2 * y - py],
            [2 * x - px, 2 * y - py],
        ]
    };
    for [px, py] in mirrored(px, py) {
        pixels.hline(px, px, py, color);
    }
    let mut four = |px: i32, py: i32, w: i32| {
        for [px, py] in mirrored(px, py) {
            if pixels.keeps(px, py) {
                pixels.blend(px, py, color, (255 * w) >> 8);
            }
        }
    };
    let weight = |d: i64, k: i64| {
        if k == 0 {
            255
        } else {
            ((d as f32).abs() / (k as f32).abs() * 255.0).min(255.0) as i32
        }
    };
    for _ in 0..quarter {
        px -= 1;
        d += t - area;
        let mut down = false;
        let q = if d >= 0 {
            py - 1
        } else if d - s - area > 0 {
            if 2 * d - s - area >= 0 {
                py + 1
            } else {
                down = true;
                py += 1;
                py - 1
            }
        } else {
            down = true;
            py += 1;
            py + 1
        };
        if down {
            d -= s + area;
            s += 2 * area;
        }
        t -= 2 * area;
        let w = weight(d, s);
        four(px, py, 255 - w);
        four(px, q, w);
    }
    for _ in 0..quarter {
        py += 1;
        d -= s + area;
        let mut left = false;
        let q = if d <= 0 {
            px + 1
        } else if d + t - area < 0 {
            if 2 * d + t - area <= 0 {
                px - 1
            } else {
                left = true;
                px -= 1;
                px + 1
            }
        } else {
            left = true;
            px -= 1;
            px - 1
        };
        if left {
            d += t - area;
            t -= 2 * area;
        }
        s += 2 * area;
        let w = weight(d, t);
        four(px, py, 255 - w);
        four(q, py, w);
    }
}
