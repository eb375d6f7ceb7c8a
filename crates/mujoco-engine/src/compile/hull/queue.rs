// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! The queue of facets that must merge, and who merges into whom (`qh_all_merges` and what it
//! calls, `merge_r.c` of Qhull).

use super::Builder;
use super::arena::NONE;
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
    /// By reason, then by distance, descending: merges are taken from the end. The order of equal
    /// ones is kept.
    pub(super) fn sort_merges(&mut self) {
        self.merges.sort_by(|a, b| {
            b.reason.cmp(&a.reason).then(
                b.distance
                    .partial_cmp(&a.distance)
                    .unwrap_or(std::cmp::Ordering::Equal),
            )
        });
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
    pub(super) fn merge_all(&mut self, mut merged: bool) -> Result<(), HullError> {
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
    pub(super) fn best_neighbor(&mut self, f: u32) -> Result<(u32, f64, (f64, f64)), HullError> {
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
