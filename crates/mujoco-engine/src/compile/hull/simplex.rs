// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! The first tetrahedron, of extreme points (`qh_maxsimplex`, `qh_createsimplex`, `qh_initialhull`
//! of Qhull).

use super::Builder;
use super::arena::{NONE, Set};
use super::constants::fmin;
use super::error::HullError;
use super::plane::dot;

/// `qh_RATIOmaxsimplex`: below it, other points than the extreme ones are searched too.
const THIN: f64 = 1e-3;
/// `qh_MAXnarrow`: two faces of the tetrahedron nearly face each other.
const NARROW: f64 = -0.99999999;

/// `qh_detsimplex`: the determinant of the differences between `corners` and a point.
fn determinant(point: [f64; 3], corners: &[[f64; 3]]) -> f64 {
    let row = |i: usize| [0, 1, 2].map(|k| corners[i][k] - point[k]);
    let det2 = |a: f64, b: f64, c: f64, d: f64| a * d - b * c;
    let (a, b) = (row(0), row(1));
    if corners.len() == 2 {
        return det2(a[0], a[1], b[0], b[1]);
    }
    let c = row(2);
    a[0] * det2(b[1], b[2], c[1], c[2]) - b[0] * det2(a[1], a[2], c[1], c[2])
        + c[0] * det2(a[1], a[2], b[1], b[2])
}

impl Builder<'_> {
    /// Four points for the first tetrahedron.
    fn choose_simplex(&self, extremes: [u32; 6]) -> Result<Vec<u32>, HullError> {
        if self.constants.max_width <= 0.0 {
            return Err(HullError::Flat);
        }
        let (mut first, mut last) = (extremes[0], extremes[0]);
        let (mut low, mut high) = (f64::MAX, -f64::MAX);
        for i in extremes {
            let x = self.points[i as usize][0];
            if high < x {
                (high, last) = (x, i);
            }
            if low > x {
                (low, first) = (x, i);
            }
        }
        if first == last {
            return Err(HullError::Flat);
        }
        let mut simplex = vec![first, last];
        let mut best = high - low;
        for dimension in 2..4 {
            let corners: Vec<[f64; 3]> = simplex[..dimension]
                .iter()
                .map(|&i| self.points[i as usize])
                .collect();
            let near_zero = 10.0 * self.constants.near_zero[dimension - 1];
            let target = best * self.constants.max_width;
            let mut chosen = None;
            best = -1.0;
            let mut is_near_zero = false;
            for i in extremes {
                if simplex.contains(&i) || chosen == Some(i) {
                    continue;
                }
                let det = determinant(self.points[i as usize], &corners).abs();
                if det > best {
                    (best, chosen, is_near_zero) = (det, Some(i), det < near_zero);
                }
            }
            let thin = best > 0.0 && best / target < THIN;
            if chosen.is_none() || is_near_zero || thin {
                for i in 0..self.points.len() as u32 {
                    if extremes.contains(&i) || simplex.contains(&i) {
                        continue;
                    }
                    let det = determinant(self.points[i as usize], &corners).abs();
                    if det > best {
                        (best, chosen, is_near_zero) = (det, Some(i), det < near_zero);
                        if !is_near_zero && best > 10.0 * THIN * target {
                            break;
                        }
                    }
                }
            }
            simplex.push(chosen.ok_or(HullError::Flat)?);
        }
        Ok(simplex)
    }

    /// Makes the first four facets.
    pub(super) fn initial_hull(&mut self, extremes: [u32; 6]) -> Result<Set, HullError> {
        let simplex = self.choose_simplex(extremes)?;
        let mut vertices = Set::default();
        for point in simplex {
            let v = self.make_vertex(point);
            vertices.insert(0, v);
        }
        self.newfacet_list = NONE;
        self.newvertex_list = NONE;
        let mut facets = [NONE; 4];
        for (i, place) in facets.iter_mut().enumerate() {
            let f = self.make_facet()?;
            let facet = &mut self.facets[f as usize];
            facet.vertices = vertices.clone();
            facet.vertices.delete_sorted_at(i);
            facet.top_oriented = i % 2 == 0;
            self.append_facet(f);
            self.append_vertex(vertices.get(i));
            *place = f;
        }
        for f in facets {
            for other in facets {
                if other != f {
                    self.facets[f as usize].neighbors.push(other);
                }
            }
        }
        self.reset_lists();
        self.facet_next = self.first_facet();

        self.interior = self.center(&vertices);
        self.set_plane(facets[0]);
        self.planes[facets[0] as usize].flipped = false;
        if self.planes[facets[0] as usize].distance(self.interior) > self.dist_round {
            for f in facets {
                self.facets[f as usize].top_oriented ^= true;
            }
            self.set_plane(facets[0]);
        }
        for &f in &facets[1..] {
            self.set_plane(f);
        }
        for f in facets {
            self.planes[f as usize].flipped = false;
            if self.planes[f as usize].distance(self.interior) > self.dist_round {
                for f in facets {
                    self.planes[f as usize].flipped = false;
                    self.facets[f as usize].top_oriented ^= true;
                    self.orient_outside(f);
                }
                break;
            }
        }
        let mut least_cosine = f64::MAX;
        for f in facets {
            if !self.check_flipped(f) {
                return Err(HullError::Flat);
            }
            for &other in self.facets[f as usize].neighbors.as_slice() {
                least_cosine = fmin(
                    least_cosine,
                    dot(
                        self.planes[f as usize].normal,
                        self.planes[other as usize].normal,
                    ),
                );
            }
        }
        self.narrow = least_cosine < NARROW;
        for f in facets {
            let facet = &self.facets[f as usize];
            for (&v, &other) in facet
                .vertices
                .as_slice()
                .iter()
                .zip(facet.neighbors.as_slice())
            {
                if self.vertex_distance(v, other) >= -self.dist_round {
                    return Err(HullError::Flat);
                }
            }
        }
        Ok(vertices)
    }
}
