// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! The last check: how far points are outside of the hull, and vertices inside of it
//! (`qh_check_maxout`, `poly2_r.c` of Qhull). It cannot change the graph, only refuse it.

use super::Builder;
use super::arena::NONE;
use super::constants::{fmax, fmin};
use super::error::HullError;

/// `qh_WIDEmaxoutside`
const WIDE: f64 = 100.0;

impl Builder<'_> {
    /// Gives the points that a narrow hull left outside to the facets that they are near.
    pub(super) fn keep_outside_points(&mut self) -> Result<(), HullError> {
        let mut f = self.first_facet();
        while f != NONE {
            for point in std::mem::take(&mut self.facets[f as usize].outside) {
                let distance = self.planes[f as usize].distance(self.points[point as usize]);
                self.partition_coplanar(point, f, Some(distance), self.find_new)?;
            }
            f = self.planes[f as usize].next;
        }
        Ok(())
    }

    pub(super) fn check(&mut self) -> Result<(), HullError> {
        if self.all_clear && !self.was_coplanar {
            return Ok(());
        }
        let one_merge = self.constants.one_merge;
        let least_base = fmin(self.min_vertex, -(one_merge + self.dist_round));
        if self.has_vertex_neighbors {
            let mut least = 0.0;
            let mut v = self.first_vertex();
            while v != NONE {
                for &f in self.vertices[v as usize].neighbors.as_slice() {
                    let distance = self.vertex_distance(v, f);
                    if distance < least {
                        least = distance;
                    }
                }
                v = self.vertices[v as usize].next;
            }
            self.min_vertex = least;
        }

        let most_base = fmax(self.max_outside, one_merge + self.dist_round);
        let mut most = 0.0;
        for (point, f) in self.points_with_facets() {
            let position = self.points[point];
            let distance = self.planes[f as usize].distance(position);
            let (_, distance) = self.find_best_horizon(position, f, distance, true);
            self.check_work()?;
            if distance >= most {
                most = distance;
            }
        }
        if most > self.dist_round {
            let mut f = self.first_facet();
            while f != NONE {
                if most < self.facets[f as usize].max_outside {
                    most = self.facets[f as usize].max_outside;
                }
                f = self.planes[f as usize].next;
            }
        }
        self.max_outside = most;
        let far = one_merge * (10.0 * WIDE);
        let wide = if most / most_base > WIDE {
            true
        } else if most_base > far {
            most > far
        } else if self.min_vertex / least_base > WIDE {
            true
        } else {
            least_base < -far && self.min_vertex < -far
        };
        if wide { Err(HullError::Wide) } else { Ok(()) }
    }

    /// Each point that a facet has as a vertex or in charge, in order of points, with that facet.
    fn points_with_facets(&mut self) -> Vec<(usize, u32)> {
        let mut of_point = vec![NONE; self.points.len()];
        let mark = self.next_vertex_visit();
        let mut f = self.first_facet();
        while f != NONE {
            let facet = &self.facets[f as usize];
            for &v in facet.vertices.as_slice() {
                let vertex = &mut self.vertices[v as usize];
                if vertex.visit != mark {
                    vertex.visit = mark;
                    of_point[vertex.point as usize] = f;
                }
            }
            for &point in facet.coplanar.iter().chain(&facet.outside) {
                of_point[point as usize] = f;
            }
            f = self.planes[f as usize].next;
        }
        of_point
            .into_iter()
            .enumerate()
            .filter(|&(_, f)| f != NONE)
            .collect()
    }
}
