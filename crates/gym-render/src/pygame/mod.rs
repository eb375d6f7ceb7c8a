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
                self.run(x, x, y, color);
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

/// The edges of a polygon: from the last point to the first, from the first to the second, and so on.
fn edges(points: &[Point]) -> impl Iterator<Item = [[i32; 2]; 2]> + '_ {
    let last = points.last().map(|point| whole(*point));
    points.iter().scan(last, |before, point| {
        let point = whole(*point);
        before.replace(point).map(|before| [before, point])
    })
}

/// The places where a row cuts a polygon's edges.
struct Cuts {
    places: [i32; Self::MOST],
    count: usize,
}

impl Cuts {
    /// More than any polygon of an environment has; what is beyond them is left out.
    const MOST: usize = 64;

    fn new() -> Self {
        Self { places: [0; Self::MOST], count: 0 }
    }

    fn push(&mut self, place: i32) {
        if let Some(slot) = self.places.get_mut(self.count) {
            *slot = place;
            self.count += 1;
        }
    }

    /// Pairs of cuts from left to right.
    fn pairs(&mut self) -> impl Iterator<Item = [i32; 2]> + '_ {
        let places = &mut self.places[..self.count];
        if places.len() == 2 {
            if places[0] > places[1] {
                places.swap(0, 1);
            }
        } else {
            places.sort_unstable();
        }
        places.chunks_exact(2).map(|pair| [pair[0], pair[1]])
    }
}
