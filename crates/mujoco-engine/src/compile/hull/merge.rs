// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! Merging a facet into a neighbour (`qh_mergefacet` and what it calls, `merge_r.c` of Qhull).

use super::Builder;
use super::arena::{NONE, Ridge, Set};
use super::constants::{fmax, fmin};
use super::error::HullError;

/// `qh_MAXnewcentrum`: a facet with more than 3 and so many vertices keeps its centrum.
const KEEP_CENTRUM: usize = 3 + 5;
/// `qh_MAXnummerge`
const MOST_MERGES: u16 = 511;
/// `qh_WIDEmaxoutside`: a merge that makes a facet so many times thicker fails.
const WIDE: f64 = 100.0;

/// Why two facets merge, in the order in which the reasons are served.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Reason {
    Coplanar,
    Concave,
    ConcaveCoplanar,
    Flipped,
    Degenerate,
    Redundant,
    /// A new facet on a horizon that the point is coplanar with: its apex is the vertex that it
    /// brings.
    CoplanarHorizon,
}

impl Builder<'_> {
    /// Merges facet `f` into `g`. `range`: how far the vertices of `f` are below and above `g`, if
    /// known.
    pub(super) fn merge_facet(
        &mut self,
        f: u32,
        g: u32,
        reason: Reason,
        range: Option<(f64, f64)>,
    ) -> Result<(), HullError> {
        self.total_merges += 1;
        for side in [f, g] {
            let facet = &self.facets[side as usize];
            self.work += (facet.vertices.len() + facet.ridges.len() + facet.neighbors.len()) as u64;
        }
        self.check_work()?;
        if let Some((low, high)) = range {
            let mut most = WIDE * self.constants.one_merge;
            most = fmax(most, self.facets[f as usize].max_outside);
            most = fmax(most, self.facets[g as usize].max_outside);
            if high > most || -low > most {
                return Err(HullError::Wide);
            }
        }
        if f == g || self.planes[f as usize].visible || self.planes[g as usize].visible {
            return Err(HullError::Inconsistent("a facet merges into itself"));
        }
        if self.num_facets - self.num_visible <= 4 {
            return Err(HullError::TooFewFacets);
        }
        if !self.has_vertex_neighbors {
            self.find_vertex_neighbors();
        }
        self.make_ridges(f);
        self.make_ridges(g);
        if let Some((low, high)) = range {
            self.max_outside = fmax(self.max_outside, high);
            self.min_vertex = fmin(self.min_vertex, low);
            let wide = high > self.constants.wide_facet || low < -self.constants.wide_facet;
            let facet = &mut self.facets[g as usize];
            facet.max_outside = fmax(facet.max_outside, high);
            facet.keep_centrum |= wide;
        }
        let merges =
            (self.facets[f as usize].merges + self.facets[g as usize].merges + 1).min(MOST_MERGES);
        let facet = &mut self.facets[g as usize];
        facet.merges = merges;
        facet.new_merge = true;
        self.update_tested(f, g);
        if self.facets[f as usize].vertices.len() == 3 {
            self.merge_triangle(f, g, reason == Reason::CoplanarHorizon)?;
        } else {
            self.merge_polygon(f, g)?;
        }
        self.remove_facet(g);
        self.append_facet(g);
        self.planes[g as usize].new = true;
        self.facets[g as usize].tested = false;
        if reason != Reason::CoplanarHorizon {
            self.test_redundant_neighbors(g)?;
            self.test_degenerate_neighbors(f)?;
            self.test_degenerate_or_redundant(g)?;
        }
        self.will_delete(f, g);
        Ok(())
    }

    /// Lists the facets of every vertex: needed from the first merge on.
    pub(super) fn find_vertex_neighbors(&mut self) {
        if !self.has_vertex_neighbors {
            self.append_to_vertices(self.first_facet());
            self.has_vertex_neighbors = true;
        }
    }

    /// Gives a triangle ridges to the neighbours without one, so that it may become a polygon.
    pub(super) fn make_ridges(&mut self, f: u32) {
        if !self.facets[f as usize].simplicial {
            return;
        }
        self.facets[f as usize].simplicial = false;
        let neighbors = self.facets[f as usize].neighbors.clone();
        for &neighbor in neighbors.as_slice() {
            self.facets[neighbor as usize].seen = false;
        }
        for i in 0..self.facets[f as usize].ridges.len() {
            let ridge = self.ridges[self.facets[f as usize].ridges.get(i) as usize];
            self.facets[ridge.other(f) as usize].seen = true;
        }
        for (i, &neighbor) in neighbors.as_slice().iter().enumerate() {
            if self.facets[neighbor as usize].seen {
                continue;
            }
            let facet = &self.facets[f as usize];
            let mut vertices = facet.vertices.clone();
            vertices.delete_sorted_at(i);
            let (top, bottom) = if facet.top_oriented ^ (i % 2 == 1) {
                (f, neighbor)
            } else {
                (neighbor, f)
            };
            let r = self.make_ridge(Ridge {
                vertices: [vertices.get(0), vertices.get(1)],
                top,
                bottom,
                tested: facet.tested,
                nonconvex: false,
            });
            for side in [f, neighbor] {
                let facet = &mut self.facets[side as usize];
                facet.ridges.push(r);
                facet.has_ridges = true;
            }
        }
    }

    /// Deletes a ridge between facets that become one, and marks its ends (`qh_delridge_merge`).
    pub(super) fn delete_ridge(&mut self, r: u32) {
        if self.ridges[r as usize].nonconvex {
            self.pass_on_nonconvex(r);
        }
        let Ridge {
            vertices,
            top,
            bottom,
            ..
        } = self.ridges[r as usize];
        for v in vertices {
            self.vertices[v as usize].lost_ridge = true;
        }
        self.facets[top as usize].ridges.delete(r);
        self.facets[bottom as usize].ridges.delete(r);
        self.free_ridge(r);
    }

    /// Moves the mark of a ridge to another between the same facets, if there is one.
    pub(super) fn pass_on_nonconvex(&mut self, r: u32) {
        self.ridges[r as usize].nonconvex = false;
        let Ridge { top, bottom, .. } = self.ridges[r as usize];
        for &other in self.facets[top as usize].ridges.as_slice() {
            let ridge = &mut self.ridges[other as usize];
            if other != r && (ridge.top == bottom || ridge.bottom == bottom) {
                ridge.nonconvex = true;
                break;
            }
        }
    }

    fn update_tested(&mut self, f: u32, g: u32) {
        self.facets[g as usize].tested = false;
        for &r in self.facets[f as usize].ridges.as_slice() {
            self.ridges[r as usize].tested = false;
        }
        let facet = &mut self.facets[g as usize];
        if facet.centrum.is_none() {
            return;
        }
        let size = facet.vertices.len();
        if !facet.keep_centrum {
            facet.keep_centrum = size > KEEP_CENTRUM;
        } else if size == 3 {
            facet.keep_centrum = false;
        }
        if !facet.keep_centrum {
            facet.centrum = None;
            for &r in facet.ridges.as_slice() {
                self.ridges[r as usize].tested = false;
            }
        }
    }

    /// `qh_mergesimplex`
    fn merge_triangle(&mut self, f: u32, g: u32, apex: bool) -> Result<(), HullError> {
        let vertices = self.facets[f as usize].vertices.clone();
        let others = self.facets[g as usize].vertices.clone();
        let g_is_new = self.planes[g as usize].new;
        let (opposite, is_new);
        if apex {
            opposite = vertices.get(0);
            if !g_is_new {
                self.touch_all(&others);
            }
            is_new = others.get(0) != opposite;
            if is_new {
                self.facets[g as usize].vertices.insert(0, opposite);
            }
        } else {
            let mut shared = [NONE; 2];
            for &r in self.facets[f as usize].ridges.as_slice() {
                let ridge = &self.ridges[r as usize];
                if ridge.other(f) == g {
                    shared = ridge.vertices;
                    for v in shared {
                        self.vertices[v as usize].lost_ridge = true;
                    }
                    break;
                }
            }
            opposite = vertices
                .as_slice()
                .iter()
                .copied()
                .find(|v| !shared.contains(v))
                .unwrap_or(NONE);
            if opposite == NONE {
                return Err(HullError::Inconsistent("a triangle without a third vertex"));
            }
            is_new = self.add_vertex(g, opposite);
            if g_is_new {
                self.touch(opposite);
            } else {
                let vertices = self.facets[g as usize].vertices.clone();
                self.touch_all(&vertices);
            }
        }
        for &v in vertices.as_slice() {
            let vertex = &mut self.vertices[v as usize];
            if v == opposite && is_new {
                if !vertex.neighbors.replace(f, g) {
                    return Err(HullError::Inconsistent("a vertex lacks its facet"));
                }
            } else {
                vertex.neighbors.delete(f);
                if vertex.neighbors.len() < 2 {
                    self.lose_vertex(v, g);
                }
            }
        }
        let mark = self.next_visit();
        for &neighbor in self.facets[g as usize].neighbors.as_slice() {
            self.planes[neighbor as usize].visit = mark;
        }
        let mut i = 0;
        while i < self.facets[f as usize].ridges.len() {
            let r = self.facets[f as usize].ridges.get(i);
            let other = self.ridges[r as usize].other(f);
            if other == g {
                self.delete_ridge(r);
                self.facets[g as usize].neighbors.delete(f);
                continue;
            }
            let facet = &mut self.facets[g as usize];
            facet.ridges.push(r);
            facet.has_ridges = true;
            if self.planes[other as usize].visit == mark {
                self.make_ridges(other);
                self.forget_merged_neighbor(other, f, g)?;
            } else {
                self.facets[g as usize].neighbors.push(other);
                self.planes[other as usize].visit = mark;
                if !self.facets[other as usize].neighbors.replace(f, g) {
                    return Err(HullError::Inconsistent("a facet lacks its neighbour"));
                }
            }
            let ridge = &mut self.ridges[r as usize];
            *(if ridge.top == f {
                &mut ridge.top
            } else {
                &mut ridge.bottom
            }) = g;
            i += 1;
        }
        Ok(())
    }

    /// Deletes `f`, which merges into `g`, from the neighbours of a facet that has both. If `f` is
    /// first, `g` takes its place.
    fn forget_merged_neighbor(&mut self, facet: u32, f: u32, g: u32) -> Result<(), HullError> {
        let neighbors = &mut self.facets[facet as usize].neighbors;
        if neighbors.get(0) == f {
            neighbors.delete(g);
            if !neighbors.replace(f, g) {
                return Err(HullError::Inconsistent("a facet lacks its neighbour"));
            }
        } else {
            neighbors.delete(f);
        }
        Ok(())
    }

    /// Merges a facet of more than three vertices.
    fn merge_polygon(&mut self, f: u32, g: u32) -> Result<(), HullError> {
        let shared = self.next_vertex_visit();
        for &v in self.facets[g as usize].vertices.as_slice() {
            self.vertices[v as usize].visit = shared;
        }
        // neighbours
        let mark = self.next_visit();
        for &neighbor in self.facets[g as usize].neighbors.as_slice() {
            self.planes[neighbor as usize].visit = mark;
        }
        for i in 0..self.facets[f as usize].neighbors.len() {
            let neighbor = self.facets[f as usize].neighbors.get(i);
            if self.planes[neighbor as usize].visit == mark {
                self.make_ridges(neighbor);
                self.forget_merged_neighbor(neighbor, f, g)?;
            } else if neighbor != g {
                self.facets[g as usize].neighbors.push(neighbor);
                if !self.facets[neighbor as usize].neighbors.replace(f, g) {
                    return Err(HullError::Inconsistent("a facet lacks its neighbour"));
                }
            }
        }
        self.facets[f as usize].neighbors.delete(g);
        self.facets[g as usize].neighbors.delete(f);

        // vertices: both lists descend
        let (first, second) = (
            self.facets[f as usize].vertices.clone(),
            self.facets[g as usize].vertices.clone(),
        );
        let mut merged: Vec<u32> = first
            .as_slice()
            .iter()
            .chain(second.as_slice())
            .copied()
            .collect();
        merged.sort_unstable_by(|a, b| b.cmp(a));
        merged.dedup();
        if merged.len() + 2 > first.len() + second.len() {
            return Err(HullError::Inconsistent(
                "merged facets have one vertex in common",
            ));
        }
        self.facets[g as usize].vertices = Set::of(&merged);

        // ridges
        let mut i = 0;
        while i < self.facets[g as usize].ridges.len() {
            let r = self.facets[g as usize].ridges.get(i);
            let ridge = &self.ridges[r as usize];
            if ridge.top == f || ridge.bottom == f {
                self.delete_ridge(r);
            } else {
                i += 1;
            }
        }
        for i in 0..self.facets[f as usize].ridges.len() {
            let r = self.facets[f as usize].ridges.get(i);
            let ridge = &mut self.ridges[r as usize];
            *(if ridge.top == f {
                &mut ridge.top
            } else {
                &mut ridge.bottom
            }) = g;
            self.facets[g as usize].ridges.push(r);
        }

        // the vertices' neighbours
        for &v in first.as_slice() {
            let vertex = &mut self.vertices[v as usize];
            if vertex.visit == shared {
                vertex.neighbors.delete(f);
                if vertex.neighbors.len() < 2 {
                    self.lose_vertex(v, g);
                }
            } else if !vertex.neighbors.replace(f, g) {
                return Err(HullError::Inconsistent("a vertex lacks its facet"));
            }
        }
        if !self.planes[g as usize].new {
            let vertices = self.facets[g as usize].vertices.clone();
            self.touch_all(&vertices);
        }
        Ok(())
    }

    /// Adds a vertex to a facet in the order of indices; false if it was there.
    fn add_vertex(&mut self, f: u32, v: u32) -> bool {
        let vertices = &mut self.facets[f as usize].vertices;
        let place = vertices
            .as_slice()
            .iter()
            .position(|&other| other <= v)
            .unwrap_or(vertices.len());
        if vertices.get(place) == v {
            return false;
        }
        vertices.insert(place, v);
        true
    }

    /// A vertex between two facets that became one: it leaves `g` and the hull.
    fn lose_vertex(&mut self, v: u32, g: u32) {
        self.facets[g as usize].vertices.delete_sorted(v);
        self.vertices[v as usize].deleted = true;
        self.deleted_vertices.push(v);
    }
}
