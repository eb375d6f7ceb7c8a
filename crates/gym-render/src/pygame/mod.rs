//! pygame's drawing calls, to the last bit.
//!
//! Written from a description of pygame-ce 2.5.8's output and tested against recordings of it
//! (`tests/pygame`). One file per module of pygame: [`gfxdraw`], [`draw`], [`aalines`].
//!
//! All functions draw on [`Pixels`], a surface of which only some rows may be stored. As in pygame,
//! the edges of the whole surface clip a call. Rows that are not stored are skipped, so that a
//! large surface can be drawn in bands (see [`downscale`](crate::downscale)).

mod aalines;
mod draw;
mod gfxdraw;
mod rgb;
mod smoothscale;
#[cfg(test)]
mod tests;

use std::ops::Range;

use gym_core::canvas::{Color, Point, Primitive};

pub(crate) use gfxdraw::{MOST_ROWS, polygon as gfx_polygon};
pub(crate) use rgb::RgbPixels;
pub(crate) use smoothscale::{Phase, part, phases};

/// A surface of which only some rows may be stored.
pub(crate) trait Pixels {
    /// Returns the width of the surface.
    fn width(&self) -> i32;

    /// Returns the height of the surface.
    fn height(&self) -> i32;

    /// Returns the stored rows.
    fn rows(&self) -> Range<i32>;

    /// Colours the pixels `x1..=x2` of a stored row.
    fn run(&mut self, x1: i32, x2: i32, y: i32, color: Color);

    /// Changes each channel of a pixel from `d` to `f(d, s)`, where `s` is the channel of `color`.
    /// The pixel must be in a stored row.
    fn change(&mut self, x: i32, y: i32, color: Color, f: impl Fn(u8, u8) -> u8);

    /// Blends like `gfxdraw`, with a weight below 256: `d += ((s - d) * weight) >> 8`.
    fn blend(&mut self, x: i32, y: i32, color: Color, weight: i32) {
        self.change(x, y, color, |d, s| {
            (i32::from(d) + (((i32::from(s) - i32::from(d)) * weight) >> 8)) as u8
        });
    }

    /// [Blends](Self::blend) the pixels `x1..=x2` of a stored row; `weight` returns the weight for
    /// an `x`.
    #[inline]
    fn blend_span(&mut self, x1: i32, x2: i32, y: i32, color: Color, weight: impl Fn(i32) -> i32) {
        for x in x1..=x2 {
            self.blend(x, y, color, weight(x));
        }
    }

    /// Whether the pixel at `x`, `y` is on the surface, in a stored row.
    fn keeps(&self, x: i32, y: i32) -> bool {
        (0..self.width()).contains(&x) && self.rows().contains(&y)
    }

    /// Colours the pixels from `x1` to `x2` (in either order) of a row, clipped to the stored rows.
    fn hline(&mut self, x1: i32, x2: i32, y: i32, color: Color) {
        let (x1, x2) = (x1.min(x2).max(0), x1.max(x2).min(self.width() - 1));
        if x1 <= x2 && self.rows().contains(&y) {
            self.run(x1, x2, y, color);
        }
    }

    /// Colours the pixels from `y1` to `y2` (in either order) of a column, clipped to the stored
    /// rows.
    fn vline(&mut self, x: i32, y1: i32, y2: i32, color: Color) {
        let rows = self.rows();
        if (0..self.width()).contains(&x) {
            for y in y1.min(y2).max(rows.start)..=y1.max(y2).min(rows.end - 1) {
                self.run(x, x, y, color);
            }
        }
    }
}

/// The largest distance from the surface's corner. Further away, pygame's 16-bit coordinates
/// overflow, and loops would be slow.
const REACH: f64 = 30_000.0;

/// Whether pygame's coordinates do not overflow.
pub(crate) fn is_in_reach(primitive: &Primitive<'_>) -> bool {
    let near = |x: &f64| x.abs() <= REACH; // false for NaN
    match *primitive {
        Primitive::AaPolygon(points)
        | Primitive::FilledPolygon(points)
        | Primitive::Polygon(points)
        | Primitive::Lines { points, .. }
        | Primitive::AaLines { points, .. } => points.as_flattened().iter().all(near),
        Primitive::AaCircle {
            center: [x, y],
            radius,
        }
        | Primitive::FilledCircle {
            center: [x, y],
            radius,
        }
        | Primitive::Circle {
            center: [x, y],
            radius,
        } => [x, y, radius].iter().all(near),
        Primitive::HLine { x1, x2, y } => [x1, x2, y].iter().all(near),
        Primitive::VLine { x, y1, y2 } => [x, y1, y2].iter().all(near),
    }
}

/// Truncates coordinates, as pygame does.
fn whole([x, y]: Point) -> [i32; 2] {
    [x as i32, y as i32]
}

/// Draws a primitive.
pub(crate) fn paint(pixels: &mut impl Pixels, primitive: &Primitive<'_>, color: Color) {
    match *primitive {
        Primitive::AaPolygon(points) => gfxdraw::aapolygon(pixels, points, color),
        Primitive::FilledPolygon(points) => gfxdraw::filled_polygon(pixels, points, color),
        Primitive::AaCircle { center, radius } => {
            gfxdraw::aacircle(pixels, whole(center), radius as i32, color);
        }
        Primitive::FilledCircle { center, radius } => {
            gfxdraw::filled_circle(pixels, whole(center), radius as i32, color);
        }
        Primitive::HLine { x1, x2, y } => pixels.hline(x1 as i32, x2 as i32, y as i32, color),
        Primitive::VLine { x, y1, y2 } => pixels.vline(x as i32, y1 as i32, y2 as i32, color),
        Primitive::Polygon(points) => draw::polygon(pixels, points, color),
        Primitive::Lines {
            points,
            closed,
            width,
        } => draw::lines(pixels, points, closed, width, color),
        Primitive::Circle { center, radius } => {
            draw::circle(pixels, whole(center), radius as i32, color);
        }
        Primitive::AaLines { points, closed } => aalines::aalines(pixels, points, closed, color),
    }
}

/// A non-horizontal edge of a polygon, from its upper end.
#[derive(Clone, Copy, Default)]
struct Edge {
    x1: i32,
    y1: i32,
    x2: i32,
    y2: i32,
    /// 2^47 / (y2 - y1), rounded up.
    reciprocal: u64,
}

impl Edge {
    /// Makes an edge from its upper to its lower end.
    fn new([x1, y1]: [i32; 2], [x2, y2]: [i32; 2]) -> Self {
        Self {
            x1,
            y1,
            x2,
            y2,
            reciprocal: (1_u64 << 47).div_ceil((y2 - y1) as u64),
        }
    }

    /// Returns `65536 * (y - y1) / (y2 - y1)` for a row `y` of the edge.
    #[inline]
    fn share(&self, y: i32) -> i32 {
        // the quotient is exact for numerators below 2^31: the error of the reciprocal is less than
        // 1 / 2^47, and the divisor is below 2^16; larger numbers overflow, as in pygame
        let along = y - self.y1;
        if along < 1 << 15 {
            (((along as u64) << 16).wrapping_mul(self.reciprocal) >> 47) as i32
        } else {
            65536_i32.wrapping_mul(along) / (self.y2 - self.y1)
        }
    }
}

/// The non-horizontal edges of a polygon (from the last point to the first, from the first to the
/// second, and so on), and the polygon's first and last row.
struct Edges<const MOST: usize> {
    edges: [Edge; MOST],
    count: usize,
    min: i32,
    max: i32,
}

/// The number of edges that suffices for most polygons.
const FEW: usize = 8;
/// A number of edges that no environment's polygon exceeds. Further edges are ignored.
const MANY: usize = 80;

impl<const MOST: usize> Edges<MOST> {
    fn new(points: &[Point]) -> Self {
        let mut edges = Self {
            edges: [Edge::default(); MOST],
            count: 0,
            min: i32::MAX,
            max: i32::MIN,
        };
        let Some(last) = points.last() else {
            return edges;
        };
        let mut p = whole(*last);
        for point in points {
            let q = whole(*point);
            edges.min = edges.min.min(q[1]);
            edges.max = edges.max.max(q[1]);
            let (upper, lower) = if p[1] < q[1] { (p, q) } else { (q, p) };
            if upper[1] < lower[1] && edges.count < MOST {
                edges.edges[edges.count] = Edge::new(upper, lower);
                edges.count += 1;
            }
            p = q;
        }
        edges
    }

    /// Calls `draw` with each pair of intersections that have the polygon's inside between them.
    /// `cut` returns the intersection of an edge and a row, given the number of earlier
    /// intersections in the row. An edge includes its upper end; in the polygon's last row it also
    /// includes its lower end.
    #[inline]
    fn scan(
        &self,
        rows: Range<i32>,
        cut: impl Fn(&Edge, i32, usize) -> i32,
        mut draw: impl FnMut(i32, i32, i32),
    ) {
        let edges = &self.edges[..self.count];
        let mut cuts = [0; MOST];
        let mut y = self.min.max(rows.start);
        let bottom = (self.max + 1).min(rows.end);
        while y < bottom {
            // from `y` up to the next end of an edge, all rows intersect the same edges
            let mut cut_ones = [Edge::default(); MOST];
            let mut count = 0;
            let mut next = bottom;
            for edge in edges {
                let cuts = (edge.y1 <= y && y < edge.y2) || (y == self.max && y == edge.y2);
                if cuts {
                    cut_ones[count] = *edge;
                    count += 1;
                }
                for end in [edge.y1, edge.y2] {
                    if end > y {
                        next = next.min(end);
                    }
                }
            }
            if y < self.max {
                next = next.min(self.max);
            }
            let cut_ones = &cut_ones[..count];
            if let [a, b] = cut_ones {
                for y in y..next {
                    let (a, b) = (cut(a, y, 0), cut(b, y, 1));
                    draw(a.min(b), a.max(b), y);
                }
            } else {
                for y in y..next {
                    for (i, edge) in cut_ones.iter().enumerate() {
                        cuts[i] = cut(edge, y, i);
                    }
                    cuts[..count].sort_unstable();
                    cuts[..count]
                        .chunks_exact(2)
                        .for_each(|pair| draw(pair[0], pair[1], y));
                }
            }
            y = next;
        }
    }
}
