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

/// `qh_BESTnonconvex`: with more vertices, only neighbours across nonconvex ridges are candidates.
const MANY_VERTICES: usize = 3 + 15;
/// `qh_BESTcentrum2`, `qh_BESTcentrum`: with more vertices, the centrum stands for all.
const TOO_MANY_VERTICES: usize = 2 * 3 + 20;

/// Facet `facet` and its neighbour should merge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Merge {
    pub(super) facet: u32,
    pub(super) neighbor: u32,
    pub(super) reason: Reason,
    pub(super) distance: f64,
}

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
    fn test_merged_facets(&mut self) -> Result<(), HullError> {
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

    /// By reason, then by distance, descending: merges are taken from the end. The order of equal
    /// ones is kept.
    fn sort_merges(&mut self) {
        self.merges.sort_by(|a, b| {
            b.reason.cmp(&a.reason).then(
                b.distance
                    .partial_cmp(&a.distance)
                    .unwrap_or(std::cmp::Ordering::Equal),
            )
        });
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

    /// `qh_appendmergeset`
    pub(super) fn queue(
        &mut self,
        facet: u32,
        neighbor: u32,
        reason: Reason,
        distance: f64,
    ) -> Result<(), HullError> {
        let state = &self.facets[facet as usize];
        if state.redundant
            || self.facets[neighbor as usize].redundant
            || (state.degenerate && reason == Reason::Degenerate)
        {
            return Ok(());
        }
        if self.planes[neighbor as usize].flipped && !self.planes[facet as usize].flipped {
            return Err(HullError::Inconsistent(
                "a facet would merge into a flipped one",
            ));
        }
        let merge = Merge {
            facet,
            neighbor,
            reason,
            distance,
        };
        match reason {
            Reason::Degenerate => {
                self.facets[facet as usize].degenerate = true;
                if self
                    .degenerate
                    .last()
                    .is_none_or(|last| last.reason == Reason::Degenerate)
                {
                    self.degenerate.push(merge);
                } else {
                    self.degenerate.insert(0, merge);
                }
            }
            Reason::Redundant => {
                self.facets[facet as usize].redundant = true;
                self.degenerate.push(merge);
            }
            _ => self.merges.push(merge),
        }
        Ok(())
    }

    /// Serves the queue until it stays empty (`qh_all_merges`).
    fn merge_all(&mut self, mut merged: bool) -> Result<(), HullError> {
        loop {
            while !self.merges.is_empty() || !self.degenerate.is_empty() {
                self.check_work()?;
                if !self.degenerate.is_empty() {
                    self.merge_degenerate()?;
                    merged = true;
                }
                while let Some(Merge {
                    facet,
                    neighbor,
                    reason,
                    ..
                }) = self.merges.pop()
                {
                    if self.planes[facet as usize].visible || self.planes[neighbor as usize].visible
                    {
                        continue;
                    }
                    let untested =
                        |f: u32| !self.facets[f as usize].tested && self.planes[f as usize].new;
                    if reason == Reason::Coplanar && (untested(facet) || untested(neighbor)) {
                        continue;
                    }
                    self.merge_nonconvex(facet, neighbor, reason)?;
                    self.merge_degenerate()?;
                    merged = true;
                }
                self.test_merged_facets()?;
            }
            if !(self.has_vertex_neighbors && merged) {
                return Ok(());
            }
            merged = false;
            if !self.reduce_vertices()? {
                return Ok(());
            }
            self.test_merged_facets()?;
        }
    }

    /// Merges one of two facets into the nearest of its neighbours.
    fn merge_nonconvex(
        &mut self,
        facet: u32,
        neighbor: u32,
        reason: Reason,
    ) -> Result<(), HullError> {
        let (first, second) = if self.planes[facet as usize].new {
            (facet, neighbor)
        } else {
            (neighbor, facet)
        };
        let (best, distance, range) = self.best_neighbor(first)?;
        let (best2, distance2, range2) = self.best_neighbor(second)?;
        if distance < distance2 {
            self.merge_facet(first, best, reason, Some(range))
        } else {
            self.merge_facet(second, best2, reason, Some(range2))
        }
    }

    /// The neighbour whose plane a facet's vertices are nearest to, how near, and their range.
    fn best_neighbor(&mut self, f: u32) -> Result<(u32, f64, (f64, f64)), HullError> {
        let size = self.facets[f as usize].vertices.len();
        let by_centrum = size > TOO_MANY_VERTICES;
        let mut best = (NONE, f64::MAX, (0.0, 0.0));
        if size > MANY_VERTICES {
            for i in 0..self.facets[f as usize].ridges.len() {
                let ridge = self.ridges[self.facets[f as usize].ridges.get(i) as usize];
                if ridge.nonconvex {
                    self.try_neighbor(f, ridge.other(f), by_centrum, &mut best);
                }
            }
        }
        if best.0 == NONE {
            for i in 0..self.facets[f as usize].neighbors.len() {
                self.try_neighbor(
                    f,
                    self.facets[f as usize].neighbors.get(i),
                    by_centrum,
                    &mut best,
                );
            }
        }
        if best.0 == NONE {
            return Err(HullError::Inconsistent(
                "a facet has no neighbour to merge into",
            ));
        }
        if by_centrum {
            best.2 = self.range(f, best.0);
        }
        Ok(best)
    }

    fn try_neighbor(
        &mut self,
        f: u32,
        neighbor: u32,
        by_centrum: bool,
        best: &mut (u32, f64, (f64, f64)),
    ) {
        let flipped = |f: u32| self.planes[f as usize].flipped;
        if flipped(f) && flipped(neighbor) && best.0 != NONE && !flipped(best.0) {
            return;
        }
        let range = if by_centrum {
            let centrum = self.centrum(f);
            let distance = self.planes[neighbor as usize].distance(centrum) * 3.0;
            if distance < 0.0 {
                (distance, 0.0)
            } else {
                (0.0, distance)
            }
        } else {
            self.range(f, neighbor)
        };
        let distance = if range.1 > -range.0 {
            range.1
        } else {
            -range.0
        };
        if distance < best.1 {
            *best = (neighbor, distance, range);
        }
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

    /// Serves the queue of degenerate and redundant facets; whether any merged
    /// (`qh_merge_degenredundant`).
    pub(super) fn merge_degenerate(&mut self) -> Result<bool, HullError> {
        let mut merged = false;
        while let Some(Merge {
            facet: f,
            neighbor,
            reason,
            ..
        }) = self.degenerate.pop()
        {
            if self.planes[f as usize].visible {
                continue;
            }
            let facet = &mut self.facets[f as usize];
            facet.degenerate = false;
            facet.redundant = false;
            if reason == Reason::Redundant {
                let target = self.replacement(neighbor)?;
                if target == NONE {
                    return Err(HullError::Inconsistent(
                        "a redundant facet has no replacement",
                    ));
                }
                if target != f {
                    self.merge_facet(f, target, reason, None)?;
                    merged = true;
                }
                continue;
            }
            let neighbors = self.facets[f as usize].neighbors.len();
            if neighbors == 0 {
                let vertices = self.facets[f as usize].vertices.clone();
                self.will_delete(f, NONE);
                for &v in vertices.as_slice() {
                    let vertex = &mut self.vertices[v as usize];
                    vertex.neighbors.delete(f);
                    if vertex.neighbors.is_empty() {
                        vertex.deleted = true;
                        self.deleted_vertices.push(v);
                    }
                }
                merged = true;
            } else if neighbors < 3 {
                let (best, _, range) = self.best_neighbor(f)?;
                self.merge_facet(f, best, reason, Some(range))?;
                merged = true;
            }
        }
        Ok(merged)
    }
}
