//! pygame's drawing calls, to the last bit.
//!
//! Written from a description of what pygame-ce 2.5.8 draws and tested against pictures recorded from it
//! (`tests/pygame`). One file per module of pygame: [`gfxdraw`], [`draw`], [`aalines`].
//!
//! All draw on [`Pixels`]: rows of a surface, which need not all be kept. A call that reaches beyond them
//! is cut as pygame cuts it at the edges of the *surface*; of what is left, rows that are not kept are
//! passed over. So one surface can be drawn in bands (see [`sheet`](crate::sheet)).

mod aalines;
mod draw;
mod gfxdraw;
mod rgb;
mod smoothscale;
#[cfg(test)]
mod tests;

use std::ops::Range;

use gym_core::canvas::{Color, Point, Primitive};

pub(crate) use rgb::RgbPixels;
pub(crate) use smoothscale::{Phase, part, phases};

/// Where primitives draw: a surface of which some rows are kept.
pub(crate) trait Pixels {
    /// Width of the surface.
    fn width(&self) -> i32;

    /// Height of the surface.
    fn height(&self) -> i32;

    /// The rows that are kept, within the surface.
    fn rows(&self) -> Range<i32>;

    /// Colours the pixels `x1..=x2` of a row. All lie on the surface, in a row that is kept.
    fn run(&mut self, x1: i32, x2: i32, y: i32, color: Color);

    /// Colours a pixel. It lies on the surface, in a row that is kept.
    fn dot(&mut self, x: i32, y: i32, color: Color) {
        self.run(x, x, y, color);
    }

    /// Changes a channel of a pixel from `d` to `f(d, s)`, `s` being the channel of the colour. The pixel
    /// lies on the surface, in a row that is kept.
    fn change(&mut self, x: i32, y: i32, color: Color, f: impl Fn(u8, u8) -> u8);

    /// `gfxdraw`'s blending, with a weight below 256: `d += ((s - d) * weight) >> 8`.
    fn blend(&mut self, x: i32, y: i32, color: Color, weight: i32) {
        self.change(x, y, color, |d, s| {
            (i32::from(d) + (((i32::from(s) - i32::from(d)) * weight) >> 8)) as u8
        });
    }

    /// Whether a pixel lies on the surface, in a row that is kept.
    fn keeps(&self, x: i32, y: i32) -> bool {
        (0..self.width()).contains(&x) && self.rows().contains(&y)
    }

    /// `run`, cut to what is kept; the ends may come in either order.
    fn hline(&mut self, x1: i32, x2: i32, y: i32, color: Color) {
        let (x1, x2) = (x1.min(x2).max(0), x1.max(x2).min(self.width() - 1));
        if x1 <= x2 && self.rows().contains(&y) {
            self.run(x1, x2, y, color);
        }
    }

    /// A column of pixels, cut to what is kept; the ends may come in either order.
    fn vline(&mut self, x: i32, y1: i32, y2: i32, color: Color) {
        let rows = self.rows();
        if (0..self.width()).contains(&x) {
            for y in y1.min(y2).max(rows.start)..=y1.max(y2).min(rows.end - 1) {
                self.dot(x, y, color);
            }
        }
    }
}

/// Farther than that from the surface's corner, pygame's 16-bit coordinates run over, and slow loops
/// would not end: nobody draws there.
const REACH: f64 = 30_000.0;

/// Whether all coordinates are such that pygame draws what was meant.
pub(crate) fn is_in_reach(primitive: &Primitive<'_>) -> bool {
    let near = |x: &f64| x.abs() <= REACH; // not if it is no number
    match *primitive {
        Primitive::AaPolygon(points)
        | Primitive::FilledPolygon(points)
        | Primitive::Polygon(points)
        | Primitive::Lines { points, .. }
        | Primitive::AaLines { points, .. } => points.as_flattened().iter().all(near),
        Primitive::AaCircle { center: [x, y], radius }
        | Primitive::FilledCircle { center: [x, y], radius }
        | Primitive::Circle { center: [x, y], radius } => [x, y, radius].iter().all(near),
        Primitive::HLine { x1, x2, y } => [x1, x2, y].iter().all(near),
        Primitive::VLine { x, y1, y2 } => [x, y1, y2].iter().all(near),
    }
}

/// Cuts fractions off, as pygame does.
fn whole([x, y]: Point) -> [i32; 2] {
    [x as i32, y as i32]
}

/// Draws one call.
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
        Primitive::Lines { points, closed, width } => draw::lines(pixels, points, closed, width, color),
        Primitive::Circle { center, radius } => draw::circle(pixels, whole(center), radius as i32, color),
        Primitive::AaLines { points, closed } => aalines::aalines(pixels, points, closed, color),
    }
}

/// An edge of a polygon that is not level, from its upper end.
#[derive(Clone, Copy, Default)]
struct Edge {
    x1: i32,
    y1: i32,
    x2: i32,
    y2: i32,
}

/// The edges of a polygon that are not level: from the last point to the first, from the first to the
/// second, and so on. And its first and last row.
struct Edges {
    edges: [Edge; Self::MOST],
    count: usize,
    min: i32,
    max: i32,
}

impl Edges {
    /// More than any polygon of an environment has; what is beyond them is left out.
    const MOST: usize = 80;

    fn new(points: &[Point]) -> Self {
        let mut edges = Self { edges: [Edge::default(); Self::MOST], count: 0, min: i32::MAX, max: i32::MIN };
        let Some(last) = points.last() else { return edges };
        let mut p = whole(*last);
        for point in points {
            let q = whole(*point);
            edges.min = edges.min.min(q[1]);
            edges.max = edges.max.max(q[1]);
            let ([x1, y1], [x2, y2]) = if p[1] < q[1] { (p, q) } else { (q, p) };
            if y1 < y2 && edges.count < Self::MOST {
                edges.edges[edges.count] = Edge { x1, y1, x2, y2 };
                edges.count += 1;
            }
            p = q;
        }
        edges
    }

    /// Shows `draw` the pairs of places between which each of these rows lies inside. `cut` tells where a row
    /// cuts an edge, if it does, and how many cuts of the row came before.
    fn scan(
        &self,
        rows: Range<i32>,
        cut: impl Fn(&Edge, i32, usize) -> Option<i32>,
        mut draw: impl FnMut(i32, i32, i32),
    ) {
        let mut cuts = [0; Self::MOST];
        for y in self.min.max(rows.start)..(self.max + 1).min(rows.end) {
            let mut count = 0;
            for edge in &self.edges[..self.count] {
                if let Some(place) = cut(edge, y, count) {
                    cuts[count] = place;
                    count += 1;
                }
            }
            if count == 2 {
                draw(cuts[0].min(cuts[1]), cuts[0].max(cuts[1]), y);
            } else {
                cuts[..count].sort_unstable();
                cuts[..count].chunks_exact(2).for_each(|pair| draw(pair[0], pair[1], y));
            }
        }
    }
}
