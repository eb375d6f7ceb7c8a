// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! Vertices that merges left with two facets: dropped, or renamed as a neighbour of theirs
//! (`qh_reducevertices` and what it calls, `merge_r.c` of Qhull).

use super::Builder;
use super::arena::{NONE, Ridge};
use super::error::HullError;
use super::lists::NOWHERE;

impl Builder<'_> {
    /// Reduces the vertices of the facets that merges changed; whether facets merged.
    pub(super) fn reduce_vertices(&mut self) -> Result<bool, HullError> {
        let mut merged = self.merge_degenerate()?;
        while self.reduce_once()? {
            merged = true;
        }
        Ok(merged)
    }

    /// True if facets merged, so that the reduction must start anew.
    fn reduce_once(&mut self) -> Result<bool, HullError> {
        self.check_work()?;
        let mut f = self.first_new();
        while f != NONE {
            self.work += 1;
            if self.facets[f as usize].new_merge && self.remove_extra_vertices(f) {
                self.test_degenerate_or_redundant(f)?;
                if self.merge_degenerate()? {
                    return Ok(true);
                }
            }
            f = self.planes[f as usize].next;
        }
        let mut f = self.first_new();
        while f != NONE {
            if self.facets[f as usize].new_merge {
                self.facets[f as usize].new_merge = false;
                let mut i = 0;
                while i < self.facets[f as usize].vertices.len() {
                    let v = self.facets[f as usize].vertices.get(i);
                    if !(self.vertices[v as usize].lost_ridge && self.rename_shared(v, f)?) {
                        i += 1;
                    } else if self.merge_degenerate()? {
                        return Ok(true);
                    }
                }
            }
            f = self.planes[f as usize].next;
        }
        let mut v = self.newvertex_list;
        while v != NONE && v != NOWHERE {
            let vertex = &mut self.vertices[v as usize];
            if !vertex.deleted {
                vertex.lost_ridge = false;
            }
            v = vertex.next;
        }
        Ok(false)
    }

    /// Drops the vertices of a polygon that none of its ridges has.
    fn remove_extra_vertices(&mut self, f: u32) -> bool {
        if self.facets[f as usize].simplicial {
            return false;
        }
        for &v in self.facets[f as usize].vertices.as_slice() {
            self.vertices[v as usize].seen = false;
        }
        for &r in self.facets[f as usize].ridges.as_slice() {
            for v in self.ridges[r as usize].vertices {
                self.vertices[v as usize].seen = true;
            }
        }
        let vertices = self.facets[f as usize].vertices.clone();
        let mut found = false;
        for &v in vertices.as_slice() {
            let vertex = &mut self.vertices[v as usize];
            if vertex.seen {
                continue;
            }
            found = true;
            self.facets[f as usize].vertices.delete_sorted(v);
            vertex.neighbors.delete(f);
            if vertex.neighbors.is_empty() {
                vertex.deleted = true;
                self.deleted_vertices.push(v);
            }
        }
        found
    }

    /// Renames a vertex that only `f` and one other facet have (`qh_rename_sharedvertex`).
    fn rename_shared(&mut self, v: u32, f: u32) -> Result<bool, HullError> {
        let neighbors = &self.vertices[v as usize].neighbors;
        if neighbors.len() != 2 {
            return Ok(false);
        }
        let other = if neighbors.get(0) == f {
            neighbors.get(1)
        } else {
            neighbors.get(0)
        };
        let ridges: Vec<u32> = self.facets[f as usize]
            .ridges
            .as_slice()
            .iter()
            .copied()
            .filter(|&r| {
                let ridge = &self.ridges[r as usize];
                ridge.has(v) && ridge.other(f) == other
            })
            .collect();
        let vertices = &self.facets[f as usize].vertices;
        let others = &self.facets[other as usize].vertices;
        let mut candidates = vertices.clone();
        candidates.retain(|u| others.contains(u));
        candidates.delete(v);
        // by the number of the ridges that have them, ascending
        let mut counted: Vec<(usize, u32)> = Vec::new();
        let mut i = 0;
        while i < candidates.len() {
            let candidate = candidates.get(i);
            let count = ridges
                .iter()
                .filter(|&&r| self.ridges[r as usize].has(candidate))
                .count();
            if count == 0 {
                candidates.delete_at(i);
            } else {
                counted.push((count, candidate));
                i += 1;
            }
        }
        counted.sort_by_key(|&(count, _)| count);
        for (_, candidate) in counted {
            if !self.would_duplicate(candidate, v, &ridges) {
                self.rename(v, candidate, &ridges, f)?;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Whether `ridges`, with `old` renamed as `new`, would have one that `new` has already.
    fn would_duplicate(&mut self, new: u32, old: u32, ridges: &[u32]) -> bool {
        // the ridges between facets at `new`, but not those of its last facet alone
        let facets = self.vertices[new as usize].neighbors.clone();
        let mark = self.next_visit();
        for &f in facets.as_slice() {
            self.planes[f as usize].visit = mark;
        }
        let Some((_, facets)) = facets.as_slice().split_last() else {
            return false;
        };
        for &f in facets {
            for &r in self.facets[f as usize].ridges.as_slice() {
                let ridge = &self.ridges[r as usize];
                if self.planes[ridge.other(f) as usize].visit != mark || !ridge.has(new) {
                    continue;
                }
                let end = ridge.other_vertex(new);
                if ridges.iter().any(|&other| {
                    other != r && self.ridges[other as usize].other_vertex(old) == end
                }) {
                    return true;
                }
            }
            self.planes[f as usize].visit = mark - 1;
        }
        false
    }

    /// Renames `old`, which `f` and one other facet have, as `new` (`qh_renamevertex`).
    fn rename(&mut self, old: u32, new: u32, ridges: &[u32], f: u32) -> Result<(), HullError> {
        for &r in ridges {
            if self.rename_ridge_end(r, old, new)? {
                self.refuse_duplicate(r, new)?;
            }
        }
        let neighbors = self.vertices[old as usize].neighbors.clone();
        for &neighbor in neighbors.as_slice() {
            self.facets[neighbor as usize].vertices.delete_sorted(old);
            self.test_degenerate_or_redundant(neighbor)?;
        }
        self.vertices[old as usize].deleted = true;
        self.deleted_vertices.push(old);
        self.test_degenerate_or_redundant(f)
    }

    /// Renames an end of a ridge; false if both ends are one, so that the ridge is deleted.
    fn rename_ridge_end(&mut self, r: u32, old: u32, new: u32) -> Result<bool, HullError> {
        let ridge = &mut self.ridges[r as usize];
        if !ridge.has(old) {
            return Err(HullError::Inconsistent("a ridge lacks its vertex"));
        }
        let kept = ridge.other_vertex(old);
        if kept == new {
            ridge.vertices = [new; 2];
            self.delete_ridge(r);
            return Ok(false);
        }
        let old_place = usize::from(ridge.vertices[1] == old);
        let new_place = usize::from(kept > new);
        ridge.vertices = if new_place == 0 {
            [new, kept]
        } else {
            [kept, new]
        };
        if old_place != new_place {
            std::mem::swap(&mut ridge.top, &mut ridge.bottom);
        }
        Ok(true)
    }

    /// Qhull then looks for a second ridge with the same ends, to merge vertices later. No set was
    /// seen to have one.
    fn refuse_duplicate(&self, r: u32, new: u32) -> Result<(), HullError> {
        let Ridge {
            vertices,
            top,
            bottom,
            ..
        } = self.ridges[r as usize];
        let will_degenerate = |f: u32| {
            let facet = &self.facets[f as usize];
            let size = facet.vertices.len();
            size < 3 || (size == 3 && !facet.simplicial && facet.vertices.contains(new))
        };
        if will_degenerate(top) || will_degenerate(bottom) {
            return Ok(());
        }
        for f in [top, bottom] {
            let facet = &self.facets[f as usize];
            let again =
                |&&other: &&u32| other != r && self.ridges[other as usize].vertices == vertices;
            if !facet.simplicial
                && facet.merges > 0
                && facet.ridges.as_slice().iter().find(again).is_some()
            {
                return Err(HullError::Unsupported("a merge of two vertices"));
            }
        }
        Ok(())
    }
}
