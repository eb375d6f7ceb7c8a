// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! Which facets must merge after a point was added: the tests, the queue, and its order
//! (`qh_premerge` and what it calls, `merge_r.c` of Qhull).

use super::Builder;
use super::arena::{NONE, Ridge};
use super::constants::{fmax, fmin};
use super::error::HullError;
use super::merge::Reason;

impl Builder<'_> {
    /// Merges what is not convex about the new facets.
    pub(super) fn premerge(&mut self) -> Result<(), HullError> {
        if self.new_facets_are_convex() {
            return Ok(());
        }
        let merged = self.merge_into_horizon()? | self.merge_flipped()?;
        self.test_new_facets()?;
        self.merge_all(merged)
    }

    /// Whether the new facets and their horizon are triangles that are clearly convex
    /// (`qh_checkzero`).
    fn new_facets_are_convex(&mut self) -> bool {
        let mut f = self.first_new();
        while f != NONE {
            let facet = &self.facets[f as usize];
            let horizon = facet.neighbors.get(0);
            if !self.facets[horizon as usize].simplicial
                || self.planes[f as usize].flipped
                || !facet.has_plane
            {
                self.all_clear = false;
                return false;
            }
            f = self.planes[f as usize].next;
        }
        let near = -2.0 * self.dist_round;
        let mut f = self.first_new();
        while f != NONE {
            let facet = &self.facets[f as usize];
            let base = [facet.vertices.get(1), facet.vertices.get(2)];
            for (i, &v) in base.iter().enumerate() {
                if self.vertex_distance(v, facet.neighbors.get(i + 1)) >= near {
                    self.all_clear = false;
                    return false;
                }
            }
            let horizon = &self.facets[facet.neighbors.get(0) as usize];
            if let Some(&v) = horizon
                .vertices
                .as_slice()
                .iter()
                .find(|v| !base.contains(v))
                && self.vertex_distance(v, f) >= near
            {
                self.all_clear = false;
                return false;
            }
            f = self.planes[f as usize].next;
        }
        true
    }

    /// Merges new facets into the horizon facets that the point is coplanar with.
    fn merge_into_horizon(&mut self) -> Result<bool, HullError> {
        let mut merged = false;
        let mut f = self.first_new();
        while f != NONE {
            let next = self.planes[f as usize].next;
            let facet = &self.facets[f as usize];
            if !facet.has_plane {
                let horizon = facet.neighbors.get(0);
                for v in [facet.vertices.get(1), facet.vertices.get(2)] {
                    self.vertices[v as usize].lost_ridge = true;
                }
                self.merge_facet(f, horizon, Reason::CoplanarHorizon, None)?;
                merged = true;
            }
            f = next;
        }
        if merged {
            let mut f = self.first_new();
            while f != NONE {
                if self.facets[f as usize].coplanar_horizon {
                    self.test_redundant_neighbors(f)?;
                    self.facets[f as usize].coplanar_horizon = false;
                }
                f = self.planes[f as usize].next;
            }
            self.merge_degenerate()?;
        }
        Ok(merged)
    }

    /// Merges flipped new facets into their best neighbours.
    fn merge_flipped(&mut self) -> Result<bool, HullError> {
        let mut flipped = Vec::new();
        let mut f = self.first_new();
        while f != NONE {
            let plane = &self.planes[f as usize];
            if plane.flipped && !plane.visible && !self.facets[f as usize].redundant {
                flipped.push(f);
            }
            f = plane.next;
        }
        let mut merged = false;
        for f in flipped {
            if !self.planes[f as usize].visible {
                let (neighbor, _, range) = self.best_neighbor(f)?;
                self.merge_facet(f, neighbor, Reason::Flipped, Some(range))?;
                merged = true;
            }
        }
        self.merge_degenerate()?;
        Ok(merged)
    }

    /// Tests every new facet with its neighbours.
    fn test_new_facets(&mut self) -> Result<(), HullError> {
        let mark = self.next_visit();
        let mut f = self.first_new();
        while f != NONE {
            self.planes[f as usize].visit = mark;
            for i in 0..self.facets[f as usize].neighbors.len() {
                let neighbor = self.facets[f as usize].neighbors.get(i);
                if self.planes[neighbor as usize].visit == mark || !self.test_pair(f, neighbor)? {
                    continue;
                }
                for &r in self.facets[neighbor as usize].ridges.as_slice() {
                    let ridge = &mut self.ridges[r as usize];
                    if ridge.other(neighbor) == f {
                        ridge.nonconvex = true;
                        break;
                    }
                }
            }
            self.facets[f as usize].tested = true;
            for &r in self.facets[f as usize].ridges.as_slice() {
                self.ridges[r as usize].tested = true;
            }
            f = self.planes[f as usize].next;
        }
        self.sort_merges();
        Ok(())
    }

    /// Tests the new facets that merges changed, across their untested ridges (`qh_getmergeset`).
    pub(super) fn test_merged_facets(&mut self) -> Result<(), HullError> {
        let mark = self.next_visit();
        let mut f = self.first_new();
        while f != NONE {
            if !self.facets[f as usize].tested {
                self.planes[f as usize].visit = mark;
                for i in 0..self.facets[f as usize].neighbors.len() {
                    let neighbor = self.facets[f as usize].neighbors.get(i);
                    self.facets[neighbor as usize].seen = false;
                }
                for i in 0..self.facets[f as usize].ridges.len() {
                    let r = self.facets[f as usize].ridges.get(i);
                    let Ridge {
                        tested, nonconvex, ..
                    } = self.ridges[r as usize];
                    if tested && !nonconvex {
                        continue;
                    }
                    let neighbor = self.ridges[r as usize].other(f);
                    if !self.facets[neighbor as usize].seen {
                        if self.planes[neighbor as usize].visit == mark {
                            continue;
                        }
                        self.facets[neighbor as usize].seen = true;
                        let nonconvex = self.test_pair(f, neighbor)?;
                        self.ridges[r as usize].nonconvex = nonconvex;
                    } else {
                        self.ridges[r as usize].nonconvex = false;
                    }
                    self.ridges[r as usize].tested = true;
                }
                self.facets[f as usize].tested = true;
            }
            f = self.planes[f as usize].next;
        }
        self.sort_merges();
        Ok(())
    }

    /// Queues a merge of two facets unless they are convex (`qh_test_centrum_merge`).
    fn test_pair(&mut self, f: u32, neighbor: u32) -> Result<bool, HullError> {
        self.work += 2;
        let radius = self.constants.centrum_radius;
        let centrum = self.centrum(f);
        let distance = self.planes[neighbor as usize].distance(centrum);
        let centrum = self.centrum(neighbor);
        let distance2 = self.planes[f as usize].distance(centrum);
        let concave = distance > radius || distance2 > radius;
        let coplanar =
            (-radius..=radius).contains(&distance) || (-radius..=radius).contains(&distance2);
        if distance.is_nan() || distance2.is_nan() {
            return Err(HullError::Inconsistent("a distance is not a number"));
        }
        let (first, second, reason, distance) = match (concave, coplanar) {
            (false, false) => return Ok(false),
            (true, true) if distance > distance2 => {
                (f, neighbor, Reason::ConcaveCoplanar, distance)
            }
            (true, true) => (neighbor, f, Reason::ConcaveCoplanar, distance2),
            (true, false) => (f, neighbor, Reason::Concave, fmax(distance, distance2)),
            (false, true) => {
                let least = fmin(distance.abs(), distance2.abs());
                (f, neighbor, Reason::Coplanar, least)
            }
        };
        self.queue(first, second, reason, distance)?;
        Ok(true)
    }

    /// Queues the neighbours whose vertices `f` has all.
    pub(super) fn test_redundant_neighbors(&mut self, f: u32) -> Result<(), HullError> {
        if self.facets[f as usize].neighbors.len() < 3 {
            return self.queue(f, f, Reason::Degenerate, 0.0);
        }
        let mark = self.next_vertex_visit();
        for &v in self.facets[f as usize].vertices.as_slice() {
            self.vertices[v as usize].visit = mark;
        }
        for i in 0..self.facets[f as usize].neighbors.len() {
            let neighbor = self.facets[f as usize].neighbors.get(i);
            if self.planes[neighbor as usize].visible {
                return Err(HullError::Inconsistent("a neighbour is a deleted facet"));
            }
            let facet = &self.facets[neighbor as usize];
            let turned = self.planes[f as usize].flipped && !self.planes[neighbor as usize].flipped;
            if facet.degenerate || facet.redundant || turned {
                continue;
            }
            if facet
                .vertices
                .as_slice()
                .iter()
                .all(|&v| self.vertices[v as usize].visit == mark)
            {
                self.queue(neighbor, f, Reason::Redundant, 0.0)?;
            }
        }
        Ok(())
    }

    /// Queues the neighbours with fewer than three neighbours.
    pub(super) fn test_degenerate_neighbors(&mut self, f: u32) -> Result<(), HullError> {
        for i in 0..self.facets[f as usize].neighbors.len() {
            let neighbor = self.facets[f as usize].neighbors.get(i);
            if self.planes[neighbor as usize].visible {
                return Err(HullError::Inconsistent("a neighbour is a deleted facet"));
            }
            let facet = &self.facets[neighbor as usize];
            if !facet.degenerate && !facet.redundant && facet.neighbors.len() < 3 {
                self.queue(neighbor, neighbor, Reason::Degenerate, 0.0)?;
            }
        }
        Ok(())
    }

    /// Queues a facet that another one has all vertices of, or that has fewer than three
    /// neighbours.
    pub(super) fn test_degenerate_or_redundant(&mut self, f: u32) -> Result<(), HullError> {
        if self.planes[f as usize].flipped {
            return Ok(());
        }
        for i in 0..self.facets[f as usize].neighbors.len() {
            let neighbor = self.facets[f as usize].neighbors.get(i);
            if self.planes[neighbor as usize].flipped {
                continue;
            }
            if self.planes[neighbor as usize].visible {
                return Err(HullError::Inconsistent("a neighbour is a deleted facet"));
            }
            let mark = self.next_vertex_visit();
            for &v in self.facets[neighbor as usize].vertices.as_slice() {
                self.vertices[v as usize].visit = mark;
            }
            if self.facets[f as usize]
                .vertices
                .as_slice()
                .iter()
                .all(|&v| self.vertices[v as usize].visit == mark)
            {
                return self.queue(f, neighbor, Reason::Redundant, 0.0);
            }
        }
        if self.facets[f as usize].neighbors.len() < 3 {
            self.queue(f, f, Reason::Degenerate, 0.0)?;
        }
        Ok(())
    }
}
