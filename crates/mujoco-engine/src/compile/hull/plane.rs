// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! Planes of facets, distances to them, and centrums. After `geom_r.c` of Qhull; no operation is
//! fused.

use super::Builder;
use super::arena::{NONE, Plane, Set};

/// The least divisor of `qh_normalize2`: the largest of `1 / MAX` and `MIN_POSITIVE`.
const LEAST: f64 = f64::MIN_POSITIVE;

impl Plane {
    #[inline(always)]
    pub(super) fn distance(&self, point: [f64; 3]) -> f64 {
        let n = self.normal;
        self.offset + point[0] * n[0] + point[1] * n[1] + point[2] * n[2]
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    0.0 + a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn less(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

impl Builder<'_> {
    #[inline(always)]
    pub(super) fn position(&self, vertex: u32) -> [f64; 3] {
        self.points[self.vertices[vertex as usize].point as usize]
    }

    /// The distance of a vertex above the plane of a facet.
    #[inline]
    pub(super) fn vertex_distance(&self, vertex: u32, facet: u32) -> f64 {
        self.planes[facet as usize].distance(self.position(vertex))
    }

    /// The plane through a triangle, outward by the order of its vertices (`qh_setfacetplane`).
    pub(super) fn set_plane(&mut self, f: u32) {
        let facet = &self.facets[f as usize];
        let corners = [0, 1, 2].map(|i| self.position(facet.vertices.get(i)));
        let oriented = facet.top_oriented;
        let [p0, p1, p2] = corners;
        let (d1, d2) = (less(p1, p0), less(p2, p0));
        let mut normal = [
            d2[1] * d1[2] - d2[2] * d1[1],
            d1[0] * d2[2] - d1[2] * d2[0],
            d2[0] * d1[1] - d2[1] * d1[0],
        ];
        self.normalize(&mut normal, oriented);
        let mut offset = -(p0[0] * normal[0] + p0[1] * normal[1] + p0[2] * normal[2]);
        let off = [p2, p1].iter().any(|p| {
            let distance = offset + (p[0] * normal[0] + p[1] * normal[1] + p[2] * normal[2]);
            distance > self.dist_round || distance < -self.dist_round
        });
        let mut near_zero = false;
        if off {
            (normal, near_zero) = self.eliminate([d1, d2], oriented);
            self.normalize(&mut normal, true);
            offset = -(p0[0] * normal[0]);
            offset -= p0[1] * normal[1];
            offset -= p0[2] * normal[2];
        }
        let plane = &mut self.planes[f as usize];
        plane.normal = normal;
        plane.offset = offset;
        if near_zero {
            self.orient_outside(f);
        }
        self.facets[f as usize].has_plane = true;
        self.check_flipped(f);
    }

    /// Marks a facet as flipped unless the interior point is below it; false if it is flipped.
    pub(super) fn check_flipped(&mut self, f: u32) -> bool {
        let plane = &mut self.planes[f as usize];
        if !plane.flipped && plane.distance(self.interior) >= -self.dist_round {
            plane.flipped = true;
        }
        !plane.flipped
    }

    /// Turns a plane that has the interior point above it.
    pub(super) fn orient_outside(&mut self, f: u32) {
        let plane = &mut self.planes[f as usize];
        if plane.distance(self.interior) > 0.0 {
            plane.normal = plane.normal.map(|n| -n);
            plane.offset = -plane.offset;
        }
    }

    /// `qh_normalize2`
    fn normalize(&self, normal: &mut [f64; 3], oriented: bool) {
        let [x, y, z] = *normal;
        let mut norm = (x * x + y * y + z * z).sqrt();
        if norm > self.constants.min_denominator {
            if !oriented {
                norm = -norm;
            }
            *normal = normal.map(|n| n / norm);
        } else if norm == 0.0 {
            *normal = [(1.0 / 3f64).sqrt(); 3];
        } else {
            if !oriented {
                norm = -norm;
            }
            for k in 0..3 {
                match divide(normal[k], norm, LEAST) {
                    Some(quotient) => normal[k] = quotient,
                    None => {
                        let mut largest = 0;
                        for i in 1..3 {
                            if normal[i].abs() > normal[largest].abs() {
                                largest = i;
                            }
                        }
                        let one = if normal[largest] * norm >= 0.0 {
                            1.0
                        } else {
                            -1.0
                        };
                        *normal = [0.0; 3];
                        normal[largest] = one;
                        return;
                    }
                }
            }
        }
    }

    /// The normal of a plane spanned by two rows, by elimination with pivoting (`qh_gausselim`,
    /// `qh_backnormal`), and whether a pivot was nearly zero.
    fn eliminate(&self, mut rows: [[f64; 3]; 2], oriented: bool) -> ([f64; 3], bool) {
        let c = &self.constants;
        let mut sign = oriented;
        let mut near_zero = false;
        if rows[1][0].abs() > rows[0][0].abs() {
            rows.swap(0, 1);
            sign = !sign;
        }
        for k in 0..2 {
            let pivot = rows[k][k];
            if pivot.abs() <= c.near_zero[k] {
                near_zero = true;
            }
            if k == 0 && pivot != 0.0 {
                let n = rows[1][0] / pivot;
                rows[1][1] -= n * rows[0][1];
                rows[1][2] -= n * rows[0][2];
            }
        }
        for (k, row) in rows.iter().enumerate() {
            if row[k] < 0.0 {
                sign = !sign;
            }
        }
        let one = if sign { -1.0 } else { 1.0 };
        let mut normal = [0.0, 0.0, one];
        let mut zero_column = None;
        for i in [1, 0] {
            let mut value = 0.0;
            for j in i + 1..3 {
                value -= rows[i][j] * normal[j];
            }
            let diagonal = rows[i][i];
            if diagonal.abs() > c.min_denominator_2 {
                normal[i] = value / diagonal;
            } else if let Some(quotient) = divide(value, diagonal, c.min_denominator_1_2) {
                normal[i] = quotient;
            } else {
                zero_column = Some(i);
                normal[i] = one;
                for tail in &mut normal[i + 1..] {
                    *tail = 0.0;
                }
            }
        }
        (normal, near_zero || zero_column.is_some())
    }

    /// The mean of vertices.
    pub(super) fn center(&self, vertices: &Set) -> [f64; 3] {
        let mut center = [0.0; 3];
        for (k, coordinate) in center.iter_mut().enumerate() {
            for &v in vertices.as_slice() {
                *coordinate += self.position(v)[k];
            }
            *coordinate /= vertices.len() as f64;
        }
        center
    }

    /// The mean of a facet's vertices, moved to its plane; made when it is missing.
    pub(super) fn centrum(&mut self, f: u32) -> [f64; 3] {
        if let Some(centrum) = self.facets[f as usize].centrum {
            return centrum;
        }
        let center = self.center(&self.facets[f as usize].vertices);
        let plane = &self.planes[f as usize];
        let distance = plane.distance(center);
        let mut centrum = center;
        for (coordinate, normal) in centrum.iter_mut().zip(plane.normal) {
            *coordinate -= distance * normal;
        }
        self.facets[f as usize].centrum = Some(centrum);
        centrum
    }

    /// How far the vertices of `facet` that `neighbor` lacks are from its plane: the largest
    /// distance below (negative) and above.
    pub(super) fn range(&mut self, facet: u32, neighbor: u32) -> (f64, f64) {
        debug_assert!(facet != NONE && neighbor != NONE);
        let mark = self.next_vertex_visit();
        for &v in self.facets[neighbor as usize].vertices.as_slice() {
            self.vertices[v as usize].visit = mark;
        }
        let (mut low, mut high) = (0.0, 0.0);
        for &v in self.facets[facet as usize].vertices.as_slice() {
            if self.vertices[v as usize].visit != mark {
                let distance = self.vertex_distance(v, neighbor);
                if distance < low {
                    low = distance;
                } else if distance > high {
                    high = distance;
                }
            }
        }
        (low, high)
    }
}

/// `qh_divzero`: a quotient, or none if it would overflow.
fn divide(numerator: f64, denominator: f64, least: f64) -> Option<f64> {
    if numerator < least && numerator > -least {
        return (numerator.abs() < denominator.abs()).then(|| numerator / denominator);
    }
    let inverse = denominator / numerator;
    (inverse > least || inverse < -least).then(|| numerator / denominator)
}
