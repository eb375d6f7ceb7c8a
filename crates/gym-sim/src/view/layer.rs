//! Triangles in a picture of their own, in which the nearer hide those behind.
//!
//! Each pixel has several samples, so that edges are smooth. Positions of corners are rounded to
//! 256ths of a sample and the sides of triangles are tested in whole numbers: triangles that share an
//! edge leave no gap, and the picture is the same on every platform.

use gym_core::canvas::{Color, Image, Point};

use super::camera::NEAR;

/// Parts of a sample's width: 256, a power of two.
const PARTS_LOG2: u32 = 8;
const PARTS: f64 = (1 << PARTS_LOG2) as f64;
/// The largest coordinate in samples: triangles beyond are not drawn.
const REACH: f64 = (1 << 20) as f64;

/// A point as a camera sees it, in f32: to the right, up, ahead.
pub(super) type Seen = [f32; 3];

/// A corner of triangles, which share it: what a layer computes once of it.
#[derive(Clone, Copy, Default)]
pub(super) struct Corner {
    seen: Seen,
    /// The position in parts of a sample; `None` for a point that is too far aside.
    at: Option<[i32; 2]>,
    /// One divided by the distance ahead.
    nearness: f32,
}

/// A colour: red, green, blue, opacity, from 0 to 1.
pub(super) type Paint = [f32; 4];

/// Samples of a picture.
pub(super) struct Layer {
    /// Samples in a row, and rows.
    size: [usize; 2],
    /// Samples of a pixel in a row, and rows of samples of a pixel.
    per_pixel: usize,
    /// Width and height of a sample for a distance of 1: samples per tangent of an angle.
    focal: [f64; 2],
    /// One divided by the distance ahead of what a sample shows; 0 for nothing.
    nearness: Vec<f32>,
    /// Colours, multiplied by their opacity; empty in a layer of depths.
    colors: Vec<Paint>,
}

impl Layer {
    /// An empty layer of `width` by `height` pixels, for a camera that shows a length of 1 at a
    /// distance of 1 as `focal` pixels.
    pub(super) fn new([width, height]: [usize; 2], per_pixel: usize, focal: [f64; 2]) -> Self {
        let layer = Self::of_depths([width, height], per_pixel, focal);
        Self {
            colors: vec![[0.0; 4]; layer.nearness.len()],
            ..layer
        }
    }

    /// A layer that has depths only.
    pub(super) fn of_depths(
        [width, height]: [usize; 2],
        per_pixel: usize,
        focal: [f64; 2],
    ) -> Self {
        let size = [width * per_pixel, height * per_pixel];
        Self {
            size,
            per_pixel,
            focal: focal.map(|x| x * per_pixel as f64),
            nearness: vec![0.0; size[0] * size[1]],
            colors: Vec::new(),
        }
    }

    /// Hides all that is further than the surface whose nearness at the sample x, y is `at([x, y])`,
    /// where x and y are the tangents of the angles to the right and up.
    pub(super) fn hide_behind(&mut self, at: impl Fn([f64; 2]) -> f64) {
        let [columns, rows] = self.size;
        for y in 0..rows {
            for x in 0..columns {
                let right = (x as f64 + 0.5 - columns as f64 / 2.0) / self.focal[0];
                let up = (rows as f64 / 2.0 - y as f64 - 0.5) / self.focal[1];
                let nearness = &mut self.nearness[y * columns + x];
                *nearness = nearness.max(at([right, up]) as f32);
            }
        }
    }

    /// Whether nothing within `radius` of a point can be seen.
    pub(super) fn misses(&self, [right, up, ahead]: [f64; 3], radius: f64) -> bool {
        let beyond = |along: f64, k: usize| {
            let slope = self.size[k] as f64 / 2.0 / self.focal[k];
            (along.abs() - ahead * slope) / (1.0 + slope * slope).sqrt() > radius
        };
        ahead + radius < NEAR || beyond(right, 0) || beyond(up, 1)
    }

    /// The corner of triangles at a point.
    pub(super) fn corner(&self, seen: Seen) -> Corner {
        let [columns, rows] = self.size.map(|length| length as f64 / 2.0);
        let [right, up, ahead] = seen.map(f64::from);
        let x = columns + right / ahead * self.focal[0];
        let y = rows - up / ahead * self.focal[1];
        let is_within = x.abs() < REACH && y.abs() < REACH;
        Corner {
            seen,
            at: is_within.then(|| [x, y].map(|x| (x * PARTS).round() as i32)),
            nearness: 1.0 / seen[2],
        }
    }

    /// Draws a triangle whose corners go round against the clock as seen by the camera; others are
    /// not drawn. `paint` gives the colour of a point from the shares of the corners.
    #[inline]
    pub(super) fn triangle(
        &mut self,
        corners: [Corner; 3],
        mut paint: impl FnMut([f32; 3]) -> Paint,
    ) {
        const WHOLE: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let near = NEAR as f32;
        if corners.iter().all(|corner| corner.seen[2] >= near) {
            return self.visible(corners, WHOLE, &mut paint);
        }
        let corners = corners.map(|corner| corner.seen);
        // the part ahead of the near plane has up to four corners
        let mut part = [([0.0; 3], [0.0; 3]); 4];
        let mut count = 0;
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let mut add = |t: f32| {
                let mix = |x: [f32; 3], y: [f32; 3]| [0, 1, 2].map(|k| x[k] + (y[k] - x[k]) * t);
                part[count] = (mix(a, b), mix(WHOLE[k], WHOLE[(k + 1) % 3]));
                count += 1;
            };
            if a[2] >= near {
                add(0.0);
            }
            if (a[2] >= near) != (b[2] >= near) {
                add((near - a[2]) / (b[2] - a[2]));
            }
        }
        for k in 2..count {
            let [a, b, c] = [part[0], part[k - 1], part[k]];
            let corners = [a.0, b.0, c.0].map(|seen| self.corner(seen));
            self.visible(corners, [a.1, b.1, c.1], &mut paint);
        }
    }

    /// Draws a triangle ahead of the near plane; `shares` are those of its corners.
    #[inline]
    fn visible(
        &mut self,
        corners: [Corner; 3],
        shares: [[f32; 3]; 3],
        paint: &mut impl FnMut([f32; 3]) -> Paint,
    ) {
        let Some(covered) = Covered::new(corners, self.size) else {
            return;
        };
        let inverse = corners.map(|corner| corner.nearness);
        let scale = 1.0 / covered.area as f32;
        covered.each(self.size[0], |index, areas| {
            let parts = [0, 1, 2].map(|k| areas[k] as f32 * scale * inverse[k]);
            let nearness = parts[0] + parts[1] + parts[2];
            if nearness > self.nearness[index] {
                self.nearness[index] = nearness;
                if let Some(color) = self.colors.get_mut(index) {
                    let parts = parts.map(|part| part / nearness);
                    let share = [0, 1, 2].map(|k| {
                        parts[0] * shares[0][k] + parts[1] * shares[1][k] + parts[2] * shares[2][k]
                    });
                    let [r, g, b, a] = paint(share);
                    let new = [r * a, g * a, b * a, a];
                    *color = [0, 1, 2, 3].map(|k| new[k] + color[k] * (1.0 - a));
                }
            }
        });
    }

    /// The distances ahead, row by row from the top; `far` for samples without a surface.
    pub(super) fn depths(&self, far: f32) -> impl Iterator<Item = f32> {
        let depth = move |x: &f32| if *x > 0.0 { 1.0 / x } else { far };
        self.nearness.iter().map(depth)
    }

    /// How much of each pixel surfaces cover, from 0 to 255.
    pub(super) fn cover(&self) -> impl Iterator<Item = u8> {
        let (columns, n) = (self.size[0], self.per_pixel);
        let mut covered = vec![0_u16; self.nearness.len() / (n * n)];
        for (y, row) in self.nearness.chunks_exact(columns).enumerate() {
            let pixels = &mut covered[y / n * (columns / n)..];
            for (pixel, samples) in pixels.iter_mut().zip(row.chunks_exact(n)) {
                *pixel += samples.iter().filter(|x| **x > 0.0).count() as u16;
            }
        }
        let all = (n * n) as f32;
        covered
            .into_iter()
            .map(move |count| byte(f32::from(count) / all))
    }

    /// The pixels: the means of their samples.
    pub(super) fn pixels(&self) -> Vec<Color> {
        let [columns, rows] = self.size;
        let n = self.per_pixel;
        let mut pixels = Vec::with_capacity(columns / n * (rows / n));
        for y in 0..rows / n {
            for x in 0..columns / n {
                let mut sum = [0.0; 4];
                for row in 0..n {
                    let first = (y * n + row) * columns + x * n;
                    for color in &self.colors[first..first + n] {
                        sum = [0, 1, 2, 3].map(|k| sum[k] + color[k]);
                    }
                }
                let [r, g, b, a] = sum;
                let color = |x: f32| if a > 0.0 { byte(x / a) } else { 0 };
                pixels.push(Color {
                    r: color(r),
                    g: color(g),
                    b: color(b),
                    a: byte(a / (n * n) as f32),
                });
            }
        }
        pixels
    }

    /// The number of pixels of a row.
    pub(super) fn width(&self) -> usize {
        self.size[0] / self.per_pixel
    }
}

/// A share as a byte.
fn byte(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

/// The samples whose middles a triangle covers.
struct Covered {
    /// The doubled area of the triangle, in parts of a sample.
    area: i64,
    /// The first and the last column and row of its bounds.
    columns: [i64; 2],
    rows: [i64; 2],
    /// For each corner, the doubled area of the triangle of a sample and the opposite side: for the
    /// first sample of the bounds, and how much more it is one column and one row further. A sample
    /// outside of a side has a negative area.
    sides: [(i64, [i64; 2]); 3],
}

impl Covered {
    /// `None` for a triangle that is seen from behind, is too far aside, or covers no sample of
    /// `size`.
    #[inline]
    fn new(corners: [Corner; 3], size: [usize; 2]) -> Option<Self> {
        let [Some(a), Some(b), Some(c)] = corners.map(|corner| corner.at) else {
            return None;
        };
        let [a, b, c] = [a, b, c].map(|at| at.map(i64::from));
        // y points down: the sign of the area is turned
        let area = (b[1] - a[1]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[1] - a[1]);
        if area <= 0 {
            return None;
        }
        // the samples whose middles are within the bounds
        let (parts, half) = (PARTS as i64, PARTS as i64 / 2);
        let range = |k: usize| {
            let least = a[k].min(b[k]).min(c[k]);
            let greatest = a[k].max(b[k]).max(c[k]);
            // (rounded up, and down)
            let first = (least - half + parts - 1) >> PARTS_LOG2;
            let last = (greatest - half) >> PARTS_LOG2;
            [first.max(0), last.min(size[k] as i64 - 1)]
        };
        let (columns, rows) = (range(0), range(1));
        if columns[0] > columns[1] || rows[0] > rows[1] {
            return None;
        }
        let middle = [columns[0] * parts + half, rows[0] * parts + half];
        let side = |from: [i64; 2], to: [i64; 2]| {
            let along = [to[0] - from[0], to[1] - from[1]];
            // a sample on a side belongs to the triangle on one side of it
            let own = along[1] > 0 || along[1] == 0 && along[0] < 0;
            let start = along[1] * (middle[0] - from[0]) - along[0] * (middle[1] - from[1]);
            (
                start - i64::from(!own),
                [along[1] * parts, -along[0] * parts],
            )
        };
        let sides = [side(b, c), side(c, a), side(a, b)];
        Some(Self {
            area,
            columns,
            rows,
            sides,
        })
    }

    /// Calls `visit` with the index of each sample, in rows of `width`, and its areas.
    #[inline]
    fn each(&self, width: usize, mut visit: impl FnMut(usize, [i64; 3])) {
        /// In bounds wider than this the columns are computed, and otherwise tried.
        const NARROW: i64 = 12;
        let [left, right] = self.columns;
        let mut starts = self.sides.map(|(start, _)| start);
        for y in self.rows[0]..=self.rows[1] {
            let row = y as usize * width + left as usize;
            let (mut first, mut last) = (0, right - left);
            if last > NARROW {
                for (start, (_, [step, _])) in starts.iter().zip(self.sides) {
                    if step > 0 && *start < 0 {
                        first = first.max((step - 1 - start) / step);
                    } else if *start < 0 {
                        last = -1;
                    } else if step < 0 {
                        last = last.min(start / -step);
                    }
                }
            }
            let mut areas = [0, 1, 2].map(|k| starts[k] + self.sides[k].1[0] * first);
            for column in first..=last {
                if areas[0] >= 0 && areas[1] >= 0 && areas[2] >= 0 {
                    visit(row + column as usize, areas);
                }
                for (area, (_, step)) in areas.iter_mut().zip(&self.sides) {
                    *area += step[0];
                }
            }
            for (start, (_, step)) in starts.iter_mut().zip(&self.sides) {
                *start += step[1];
            }
        }
    }
}

/// An image of a layer's pixels on a picture of a size.
pub(super) fn image(pixels: &[Color], width: usize, size: Point) -> Image<'_> {
    Image {
        min: [0.0; 2],
        size,
        width,
        pixels,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reds of a layer of 8 by 8 samples, for a camera that sees 1 m at a distance of 1 m.
    fn reds(layer: &Layer) -> Vec<u8> {
        layer
            .pixels()
            .iter()
            .map(|color| if color.a > 0 { color.r } else { 9 })
            .collect()
    }

    fn draw(layer: &mut Layer, corners: [Seen; 3], paint: impl FnMut([f32; 3]) -> Paint) {
        layer.triangle(corners.map(|seen| layer.corner(seen)), paint);
    }

    fn layer() -> Layer {
        Layer::new([8, 8], 1, [8.0; 2])
    }

    /// The corners of a rectangle at a depth, as two triangles.
    fn halves(depth: f32) -> [[Seen; 3]; 2] {
        let at = |x: f32, y: f32| [x * depth, y * depth, depth];
        let [a, b, c, d] = [
            at(-0.31, -0.4),
            at(0.33, -0.37),
            at(0.4, 0.3),
            at(-0.3, 0.45),
        ];
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn triangles_that_share_an_edge_paint_each_sample_once() {
        let mut counts = layer();
        let mut painted = 0;
        for triangle in halves(1.0) {
            draw(&mut counts, triangle, |share| {
                painted += 1;
                assert!((share.iter().sum::<f32>() - 1.0).abs() < 1e-4, "{share:?}");
                [1.0, 0.0, 0.0, 1.0]
            });
        }
        let covered = reds(&counts).iter().filter(|red| **red == 255).count();
        assert_eq!(painted, covered, "none twice");
        // the whole, whose area is 0.512 of 64 samples
        assert!((30..=36).contains(&covered), "{covered}");
        // the backs are not drawn
        let mut back = layer();
        for [a, b, c] in halves(1.0) {
            draw(&mut back, [b, a, c], |_| panic!("a back"));
        }
        assert!(back.nearness.iter().all(|x| *x == 0.0));
    }

    #[test]
    fn the_nearer_hides_the_further_in_any_order() {
        let paint = |layer: &mut Layer, depth: f32, red: f32| {
            for triangle in halves(depth) {
                draw(layer, triangle, |_| [red, 0.0, 0.0, 1.0]);
            }
        };
        let [mut first, mut second] = [layer(), layer()];
        paint(&mut first, 2.0, 0.0);
        paint(&mut first, 1.0, 1.0);
        paint(&mut second, 1.0, 1.0);
        paint(&mut second, 2.0, 0.0);
        assert_eq!(reds(&first), reds(&second));
        assert!(reds(&first).contains(&255) && !reds(&first).contains(&0));
        let mut hidden = layer();
        hidden.hide_behind(|[right, _]| if right < 0.0 { 1.0 } else { 0.0 });
        paint(&mut hidden, 2.0, 1.0);
        let left: Vec<u8> = reds(&hidden)
            .chunks(8)
            .flat_map(|row| &row[..4])
            .copied()
            .collect();
        assert!(left.iter().all(|red| *red == 9) && reds(&hidden).contains(&255));
    }

    #[test]
    fn depths_are_those_of_the_plane_and_the_near_part_is_cut_off() {
        let mut depths = Layer::of_depths([8, 8], 1, [8.0; 2]);
        for triangle in halves(2.5) {
            draw(&mut depths, triangle, |_| [0.0; 4]);
        }
        let middle: Vec<f32> = depths.depths(100.0).collect();
        assert!((middle[4 * 8 + 4] - 2.5).abs() < 1e-5 && middle[0] == 100.0);
        // a floor 1 m below, from behind the camera to far ahead
        let floor = [[-50.0, -1.0, -5.0], [50.0, -1.0, -5.0], [0.0, -1.0, 500.0]];
        let mut depths = Layer::of_depths([8, 8], 1, [8.0; 2]);
        draw(&mut depths, floor, |_| [0.0; 4]);
        let found: Vec<f32> = depths.depths(0.0).collect();
        for (y, row) in found.chunks(8).enumerate() {
            let slope = (y as f32 + 0.5 - 4.0) / 8.0;
            let expected = if slope > 0.0 { 1.0 / slope } else { 0.0 };
            assert!(
                (row[4] - expected).abs() <= 1e-3 * expected,
                "row {y}: {}",
                row[4]
            );
        }
    }

    #[test]
    fn numbers_that_are_not_finite_draw_nothing() {
        let mut samples = layer();
        for bad in [f32::NAN, f32::INFINITY, f32::MAX] {
            draw(
                &mut samples,
                [[bad, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, bad, 1.0]],
                |_| [1.0; 4],
            );
            draw(
                &mut samples,
                [[0.0, 0.0, bad], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]],
                |_| [1.0; 4],
            );
        }
        assert!(samples.nearness.iter().all(|x| x.is_finite()));
    }
}
