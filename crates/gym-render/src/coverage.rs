//! Filling of outlines, anti-aliased, in buffers that are kept.
//!
//! Each pixel is looked at in 4x4 places, and its coverage is how many of them lie inside by the
//! nonzero winding rule. Points are rounded to a fine grid first; from there on all is in integers
//! and exact divisions, so that a drawing gives the same bytes on every processor.
//!
//! This is how `tiny-skia` does it, which it is tested against. It is written anew because a fill
//! there allocates, and because rows can go straight into the frame here.

use gym_core::canvas::{Color, Point};
use gym_core::render::Frame;

use crate::flatten::Pen;
use crate::pixels::{self, SUBPIXELS};

/// Grid lines between two rows of sample places.
const GRID: i32 = 256;
/// Grid lines in a pixel.
const PIXEL: f64 = (GRID * SUBPIXELS as i32) as f64;
/// Binary places of an edge's position beyond the grid.
const FRACTION: u32 = 24;
/// Outlines that reach further than this from the frame's corner, in pixels, are left out: beyond
/// it, positions would not fit their integers.
pub(crate) const REACH: f64 = 32_768.0;
/// Sample places in a pixel.
const SAMPLES: i32 = (SUBPIXELS * SUBPIXELS) as i32;

/// An outline being gathered, in pixels, and then filled.
#[derive(Debug, Default)]
pub(crate) struct Coverage {
    edges: Vec<Edge>,
    /// The edges that cross the current row of sample places, from left to right.
    active: Vec<Edge>,
    /// By how many sample places the coverage of each pixel of the current row differs from that of
    /// its left neighbour, and which pixels may differ, one bit for each.
    steps: Vec<i32>,
    touched: Vec<u64>,
    /// The frame's size.
    width: usize,
    height: usize,
    /// Where the contour started and where it is, on the grid.
    start: [i32; 2],
    at: [i32; 2],
    /// Whether a point was out of reach.
    is_out_of_reach: bool,
}

/// A piece of an outline, from its upper end to its lower one.
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// Where it crosses the current row of sample places, in `2^-FRACTION` parts of the grid, and how
    /// much further right it crosses the next one.
    x: i64,
    slope: i64,
    /// The rows it crosses.
    first: i32,
    end: i32,
    /// 1 downwards, -1 upwards.
    winding: i32,
}

impl Coverage {
    /// Makes room for a frame of that size.
    pub(crate) fn resize(&mut self, width: u32, height: u32) {
        (self.width, self.height) = (width as usize, height as usize);
        // one pixel more for what ends at the right edge of the frame, and the step behind it
        self.steps.resize(self.width + 2, 0);
        self.touched.resize((self.width + 2).div_ceil(u64::BITS as usize), 0);
    }

    /// Lays colour over what the outline covers, and starts a new one.
    pub(crate) fn fill(&mut self, frame: &mut Frame, color: Color) {
        self.close();
        if !self.is_out_of_reach {
            self.scan(frame, color);
        }
        self.edges.clear();
        self.is_out_of_reach = false;
    }

    fn scan(&mut self, frame: &mut Frame, color: Color) {
        self.edges.sort_unstable_by_key(|edge| edge.first);
        let rows_per_pixel = SUBPIXELS as i32;
        let mut next = 0;
        let mut row = self.edges.first().map_or(0, |edge| edge.first);
        while next < self.edges.len() || !self.active.is_empty() {
            while let Some(edge) = self.edges.get(next)
                && edge.first == row
            {
                self.active.push(*edge);
                next += 1;
            }
            // rows with the same edges; within a row of pixels, upright edges give all the same
            let end = self.edges.get(next).map_or(i32::MAX, |edge| edge.first);
            let end = self.active.iter().fold(end, |end, edge| end.min(edge.end));
            let upright = self.active.iter().all(|edge| edge.slope == 0);
            while row < end {
                let below = rows_per_pixel - row % rows_per_pixel;
                let count = if upright { below.min(end - row) } else { 1 };
                self.cross(count);
                row += count;
                if count == below {
                    self.lay(frame, row / rows_per_pixel - 1, color);
                }
            }
            self.active.retain(|edge| edge.end > row);
        }
        if row % rows_per_pixel != 0 {
            self.lay(frame, row / rows_per_pixel, color);
        }
    }

    /// Notes the stretches of `count` equal rows of sample places that lie inside, and goes to the
    /// next one.
    fn cross(&mut self, count: i32) {
        let Self { active, steps, touched, width, .. } = self;
        active.sort_unstable_by_key(|edge| edge.x);
        let right = (*width * SUBPIXELS) as i64;
        let (mut winding, mut start) = (0, 0);
        for edge in active {
            // the nearest boundary between two sample places
            let half = i64::from(GRID) << (FRACTION - 1);
            let x = ((edge.x + half) >> (FRACTION + GRID.trailing_zeros())).clamp(0, right) as usize;
            edge.x += edge.slope;
            if winding == 0 {
                start = x;
            }
            winding += edge.winding;
            if winding == 0 && start < x {
                step(steps, touched, start, count);
                step(steps, touched, x, -count);
            }
        }
    }

    /// Lays colour over a row of pixels, and forgets it.
    fn lay(&mut self, frame: &mut Frame, y: i32, color: Color) {
        let row = pixels::row(frame, y as usize);
        let (mut start, mut covered) = (0, 0);
        for (word, touched) in self.touched.iter_mut().enumerate() {
            let mut bits = std::mem::take(touched);
            while bits != 0 {
                let pixel = word * u64::BITS as usize + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                if covered > 0 {
                    let coverage = ((covered * 255 + SAMPLES / 2) / SAMPLES) as u8;
                    pixels::blend_run(row, start..pixel, color, coverage);
                }
                covered += std::mem::take(&mut self.steps[pixel]);
                start = pixel;
            }
        }
    }

    /// The grid point nearest to a point, from below.
    fn snap(&mut self, point: Point) -> [i32; 2] {
        if point.iter().all(|at| at.abs() <= REACH) {
            point.map(|at| (at * PIXEL) as i32)
        } else {
            self.is_out_of_reach = true;
            [0; 2]
        }
    }

    fn add_edge(&mut self, from: [i32; 2], to: [i32; 2]) {
        let (winding, [x0, y0], [x1, y1]) = if from[1] <= to[1] { (1, from, to) } else { (-1, to, from) };
        let row = |y: i32| (y + GRID / 2).div_euclid(GRID);
        let rows = (self.height * SUBPIXELS) as i32;
        let (first, end) = (row(y0).max(0), row(y1).min(rows));
        if first >= end {
            return;
        }
        // per grid line; a product with fewer grid lines than the edge crosses stays within its ends
        let slope = (f64::from(x1 - x0) / f64::from(y1 - y0) * f64::from(1 << FRACTION)) as i64;
        let below = i64::from(first * GRID + GRID / 2 - y0);
        let x = (i64::from(x0) << FRACTION) + slope * below;
        self.edges.push(Edge { x, slope: slope * i64::from(GRID), first, end, winding });
    }
}

/// Changes the coverage by `count` sample places a pixel, from a boundary between them on.
fn step(steps: &mut [i32], touched: &mut [u64], at: usize, count: i32) {
    let (pixel, part) = (at / SUBPIXELS, (at % SUBPIXELS) as i32);
    steps[pixel] += count * (SUBPIXELS as i32 - part);
    steps[pixel + 1] += count * part;
    for pixel in [pixel, pixel + 1] {
        touched[pixel / u64::BITS as usize] |= 1 << (pixel % u64::BITS as usize);
    }
}

impl Pen for Coverage {
    fn move_to(&mut self, to: Point) {
        self.close();
        self.start = self.snap(to);
        self.at = self.start;
    }

    fn line_to(&mut self, to: Point) {
        let to = self.snap(to);
        self.add_edge(self.at, to);
        self.at = to;
    }

    fn close(&mut self) {
        self.add_edge(self.at, self.start);
        self.at = self.start;
    }
}

#[cfg(test)]
mod tests {
    use gym_core::canvas::{Canvas, Segment, Shape};
    use tiny_skia::{FillRule, LineJoin, Mask, PathBuilder, Stroke, Transform};

    use super::*;

    const SIZE: u32 = 64;

    /// Numbers that look random.
    struct Numbers(u64);

    impl Numbers {
        /// Between the frame's left edge and its right one, and a little beyond.
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f64 / f64::from(1 << 24) * 90.0 - 13.0
        }

        fn point(&mut self) -> Point {
            [self.next(), self.next()]
        }
    }

    fn coverage(draw: impl FnOnce(&mut dyn Canvas)) -> Vec<u8> {
        crate::frame((SIZE, SIZE), draw).pixels().iter().step_by(3).copied().collect()
    }

    fn skia_path(segments: &[Segment]) -> tiny_skia::Path {
        let mut path = PathBuilder::new();
        let xy = |[x, y]: Point| (x as f32, y as f32);
        for segment in segments {
            match *segment {
                Segment::Move(to) => path.move_to(xy(to).0, xy(to).1),
                Segment::Line(to) => path.line_to(xy(to).0, xy(to).1),
                Segment::Quad(a, to) => path.quad_to(xy(a).0, xy(a).1, xy(to).0, xy(to).1),
                Segment::Cubic(a, b, to) => {
                    path.cubic_to(xy(a).0, xy(a).1, xy(b).0, xy(b).1, xy(to).0, xy(to).1);
                }
                Segment::Close => path.close(),
            }
        }
        path.finish().unwrap()
    }

    fn skia_coverage(path: &tiny_skia::Path) -> Vec<u8> {
        let mut mask = Mask::new(SIZE, SIZE).unwrap();
        mask.fill_path(path, FillRule::Winding, true, Transform::identity());
        mask.take()
    }

    /// The largest difference in sample places of a pixel, and the mean of all.
    fn difference(ours: &[u8], theirs: &[u8]) -> (f64, f64) {
        let samples = ours.iter().zip(theirs).map(|(a, b)| f64::from(a.abs_diff(*b)) * 16.0 / 255.0);
        let (max, sum) = samples.fold((0.0, 0.0), |(max, sum), d| (f64::max(max, d), sum + d));
        (max, sum / f64::from(SIZE * SIZE))
    }

    #[test]
    fn outlines_cover_what_they_cover_in_tiny_skia() {
        let mut numbers = Numbers(1);
        for round in 0..300 {
            let mut segments = vec![Segment::Move(numbers.point())];
            for i in 0..3 + round % 9 {
                segments.push(match (round + i) % 4 {
                    1 if round % 2 == 1 => Segment::Quad(numbers.point(), numbers.point()),
                    3 if round % 2 == 1 => Segment::Cubic(numbers.point(), numbers.point(), numbers.point()),
                    2 if i == 5 => Segment::Move(numbers.point()),
                    _ => Segment::Line(numbers.point()),
                });
            }
            let ours = coverage(|canvas| canvas.fill(Shape::Path(&segments), Color::WHITE));
            let (max, mean) = difference(&ours, &skia_coverage(&skia_path(&segments)));
            assert!(max <= 5.0 && mean < 0.08, "{round}: {max} {mean} {segments:?}");
        }
    }

    #[test]
    fn lines_cover_what_they_cover_in_tiny_skia() {
        let mut numbers = Numbers(2);
        for round in 0..300 {
            let mut segments = vec![Segment::Move(numbers.point())];
            segments.extend((0..2 + round % 5).map(|_| Segment::Line(numbers.point())));
            if round % 3 == 0 {
                segments.push(Segment::Close);
            }
            let width = [1.0, 2.5, 7.0, 20.0][round % 4];
            let ours = coverage(|canvas| canvas.stroke(Shape::Path(&segments), width, Color::WHITE));
            let stroke = Stroke { width: width as f32, line_join: LineJoin::Round, ..Stroke::default() };
            let theirs = skia_coverage(&skia_path(&segments).stroke(&stroke, 1.0).unwrap());
            let (max, mean) = difference(&ours, &theirs);
            assert!(max <= 5.0 && mean < 0.08, "{round}: {max} {mean} {segments:?}");
        }
    }
}
