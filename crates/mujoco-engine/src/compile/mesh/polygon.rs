//! Polygons of OBJ files are cut into triangles, ear by ear, as tinyobjloader does
//! (`exportGroupsToShape`): 3.12 has its commit 1421a10d, 4.0 a later one, which cuts quadrilaterals
//! along the shorter diagonal and computes an ear's orientation otherwise.

use super::error::MeshError;
use crate::Revision;

/// libmujoco drops polygons with more corners (found by experiment with 3.12.0 and 4.0.0).
const MOST_CORNERS: usize = 100;
/// Tests of corners that may be made for a file: some seconds' worth. A polygon of `n` corners
/// takes up to n^3.
const MOST_TESTS: usize = 1 << 30;

/// A corner of a face in an OBJ file: indices from 0; -1: none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) vertex: i32,
    pub(super) texture: i32,
    pub(super) normal: i32,
}

/// Cuts polygons, and counts the work.
#[derive(Debug, Default)]
pub(super) struct Cutter {
    tests: usize,
}

impl Cutter {
    /// Appends the triangles of `polygon`. One of fewer than three or more than a hundred corners
    /// has none.
    pub(super) fn cut(
        &mut self,
        vertices: &[f32],
        polygon: Vec<Corner>,
        revision: Revision,
        out: &mut Vec<[Corner; 3]>,
    ) -> Result<(), MeshError> {
        let corner = |corner: Corner, axis: usize| -> Option<f32> {
            usize::try_from(corner.vertex)
                .ok()
                .and_then(|v| vertices.get(3 * v + axis))
                .copied()
        };
        let position = |c: Corner| Some([corner(c, 0)?, corner(c, 1)?, corner(c, 2)?]);
        match polygon[..] {
            [] | [_] | [_, _] => return Ok(()),
            [a, b, c] => {
                out.push([a, b, c]);
                return Ok(());
            }
            [a, b, c, d] if revision.cuts_quadrilaterals() => {
                if let [Some(pa), Some(pb), Some(pc), Some(pd)] = [a, b, c, d].map(position) {
                    let shorter = square_distance(pa, pc) < square_distance(pb, pd);
                    out.extend(if shorter {
                        [[a, b, c], [a, c, d]]
                    } else {
                        [[a, b, d], [b, c, d]]
                    });
                }
                return Ok(());
            }
            _ if polygon.len() > MOST_CORNERS => return Ok(()),
            _ => {}
        }
        let axes = plane_axes(&polygon, position);
        let flat = |c: Corner| Some([corner(c, axes[0])?, corner(c, axes[1])?]);
        let mut area = 0.0f32;
        for k in 0..polygon.len() {
            if let (Some(a), Some(b)) = (flat(polygon[k]), flat(polygon[(k + 1) % polygon.len()])) {
                area += (a[0] * b[1] - a[1] * b[0]) * 0.5;
            }
        }

        let mut rest = polygon;
        let mut start = 0;
        let (mut tries, mut before) = (rest.len(), rest.len());
        while rest.len() > 3 && tries > 0 {
            let n = rest.len();
            if start >= n {
                start -= n;
            }
            if before == n {
                tries -= 1;
            } else {
                (before, tries) = (n, n);
            }
            self.tests += 1;
            let ear = [0, 1, 2].map(|k| rest[(start + k) % n]);
            let [p, q, r] = ear.map(|c| flat(c).unwrap_or([0.0; 2]));
            let cross = (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0]);
            if revision.cuts_quadrilaterals() {
                area = (p[0] * q[1] - p[1] * q[0]) * 0.5;
            }
            if cross * area < 0.0 {
                start += 1;
                continue;
            }
            let overlaps = (3..n).any(|k| {
                self.tests += 1;
                flat(rest[(start + k) % n]).is_some_and(|point| is_inside([p, q, r], point))
            });
            if self.tests > MOST_TESTS {
                return Err(MeshError::TooMany {
                    what: "tests of polygons' corners",
                    found: self.tests,
                    most: MOST_TESTS,
                });
            }
            if overlaps {
                start += 1;
                continue;
            }
            out.push(ear);
            rest.remove((start + 1) % n);
        }
        if let [a, b, c] = rest[..] {
            out.push([a, b, c]);
        }
        Ok(())
    }
}

fn square_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|k| b[k] - a[k]);
    x * x + y * y + z * z
}

/// The two axes that show the polygon widest, by its first corner that is not straight.
fn plane_axes(polygon: &[Corner], position: impl Fn(Corner) -> Option<[f32; 3]>) -> [usize; 2] {
    let n = polygon.len();
    for k in 0..n {
        let corners = [0, 1, 2].map(|i| position(polygon[(k + i) % n]));
        let [Some(a), Some(b), Some(c)] = corners else {
            continue;
        };
        let e = [0, 1, 2].map(|i| b[i] - a[i]);
        let f = [0, 1, 2].map(|i| c[i] - b[i]);
        let x = (e[1] * f[2] - e[2] * f[1]).abs();
        let y = (e[2] * f[0] - e[0] * f[2]).abs();
        let z = (e[0] * f[1] - e[1] * f[0]).abs();
        if x > f32::EPSILON || y > f32::EPSILON || z > f32::EPSILON {
            return if x > y && x > z {
                [1, 2]
            } else if z > x && z > y {
                [0, 1]
            } else {
                [0, 2]
            };
        }
    }
    [1, 2]
}

/// W. R. Franklin's test by crossings.
fn is_inside(triangle: [[f32; 2]; 3], [x, y]: [f32; 2]) -> bool {
    let mut inside = false;
    for i in 0..3 {
        let (a, b) = (triangle[i], triangle[(i + 2) % 3]);
        if (a[1] > y) != (b[1] > y) && x < (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) + a[0] {
            inside = !inside;
        }
    }
    inside
}
