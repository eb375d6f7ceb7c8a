// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! Adding a point: which facets it sees, the cone of new facets from it to their horizon, and how
//! these fit together (`libqhull_r.c`, `poly_r.c` of Qhull).

use super::Builder;
use super::arena::{NONE, Ridge, Set, Waiting};
use super::constants::{fmax, fmin};
use super::error::HullError;
use super::lists::NOWHERE;

impl Builder<'_> {
    /// Moves the facets that `point` sees to the end of the list (`qh_findhorizon`).
    pub(super) fn find_horizon(&mut self, point: u32, facet: u32) -> Result<(), HullError> {
        let position = self.points[point as usize];
        self.remove_facet(facet);
        self.append_facet(facet);
        self.num_visible = 1;
        self.visible_list = facet;
        self.planes[facet as usize].visible = true;
        self.facets[facet as usize].replace = NONE;
        let mark = self.next_visit();
        let mut horizon = 0;
        let mut visible = facet;
        while visible != NONE {
            self.planes[visible as usize].visit = mark;
            self.work += self.facets[visible as usize].neighbors.len() as u64;
            for i in 0..self.facets[visible as usize].neighbors.len() {
                let neighbor = self.facets[visible as usize].neighbors.get(i);
                if self.planes[neighbor as usize].visit == mark {
                    continue;
                }
                self.planes[neighbor as usize].visit = mark;
                let distance = self.planes[neighbor as usize].distance(position);
                if distance > self.constants.min_visible {
                    self.remove_facet(neighbor);
                    self.append_facet(neighbor);
                    self.planes[neighbor as usize].visible = true;
                    self.facets[neighbor as usize].replace = NONE;
                    self.num_visible += 1;
                    continue;
                }
                horizon += 1;
                let near = distance >= -self.constants.max_coplanar;
                let facet = &mut self.facets[neighbor as usize];
                facet.coplanar_horizon = near;
                if near && distance > 0.0 {
                    self.max_outside = fmax(self.max_outside, distance);
                    facet.max_outside = fmax(facet.max_outside, distance);
                } else if near {
                    self.min_vertex = fmin(self.min_vertex, distance);
                }
            }
            visible = self.next_visible(visible);
        }
        if horizon == 0 {
            Err(HullError::Inconsistent("a point sees every facet"))
        } else {
            Ok(())
        }
    }

    /// Makes the cone of new facets with the apex `point` (`qh_buildcone`).
    pub(super) fn build_cone(&mut self, point: u32) -> Result<(), HullError> {
        self.make_new_facets(point)?;
        self.match_new_facets()?;
        let mut f = self.first_new();
        while f != NONE {
            if !self.facets[f as usize].merge_horizon {
                self.set_plane(f);
            }
            f = self.planes[f as usize].next;
        }
        self.update_vertex_neighbors();
        Ok(())
    }

    fn make_new_facets(&mut self, point: u32) -> Result<(), HullError> {
        self.newfacet_list = NONE;
        self.newvertex_list = NONE;
        let apex = self.make_vertex(point);
        self.append_vertex(apex);
        let mark = self.next_visit();
        // both survive from one visible facet to the next, as in Qhull: a facet without a new one
        // names an earlier one
        let (mut from_ridges, mut last) = (NONE, NONE);
        let mut visible = self.first_visible();
        while visible != NONE {
            for i in 0..self.facets[visible as usize].neighbors.len() {
                let neighbor = self.facets[visible as usize].neighbors.get(i);
                self.facets[neighbor as usize].seen = false;
            }
            if self.facets[visible as usize].has_ridges {
                self.planes[visible as usize].visit = mark;
                from_ridges = self.cone_from_ridges(visible, apex, mark)?;
            }
            if self.facets[visible as usize].simplicial {
                last = self.cone_from_triangle(visible, apex)?;
            }
            if from_ridges != NONE {
                last = from_ridges;
            }
            let facet = &mut self.facets[visible as usize];
            if last != NONE {
                facet.replace = last;
            }
            facet.ridges.clear();
            facet.neighbors.clear();
            visible = self.next_visible(visible);
        }
        Ok(())
    }

    fn make_new_facet(
        &mut self,
        vertices: Set,
        top_oriented: bool,
        horizon: u32,
    ) -> Result<u32, HullError> {
        self.touch_all(&vertices);
        let f = self.make_facet()?;
        let facet = &mut self.facets[f as usize];
        facet.vertices = vertices;
        facet.top_oriented = top_oriented;
        // the other two are found by `match_new_facets`
        facet.neighbors = Set::of(&[horizon, NONE, NONE]);
        self.append_facet(f);
        Ok(f)
    }

    /// New facets over the ridges of `visible` to the horizon; the last one, if any
    /// (`qh_makenew_nonsimplicial`).
    pub(super) fn cone_from_ridges(
        &mut self,
        visible: u32,
        apex: u32,
        mark: u32,
    ) -> Result<u32, HullError> {
        let mut last = NONE;
        for i in 0..self.facets[visible as usize].ridges.len() {
            let r = self.facets[visible as usize].ridges.get(i);
            let ridge = self.ridges[r as usize];
            let neighbor = ridge.other(visible);
            if self.planes[neighbor as usize].visible {
                if self.planes[neighbor as usize].visit == mark {
                    self.free_ridge(r);
                }
                self.facets[neighbor as usize].seen = true;
                continue;
            }
            let top_oriented = ridge.top == visible;
            let vertices = Set::of(&[apex, ridge.vertices[0], ridge.vertices[1]]);
            let f = self.make_new_facet(vertices, top_oriented, neighbor)?;
            last = f;
            let horizon = &mut self.facets[neighbor as usize];
            if horizon.coplanar_horizon {
                if horizon.seen {
                    return Err(HullError::Unsupported(
                        "a merge of several facets into one at once",
                    ));
                }
                self.facets[f as usize].merge_horizon = true;
            }
            let horizon = &mut self.facets[neighbor as usize];
            if horizon.seen {
                if horizon.simplicial {
                    return Err(HullError::Inconsistent(
                        "a triangle has two edges in common with a facet",
                    ));
                }
                horizon.neighbors.push(f);
            } else if !horizon.neighbors.replace(visible, f) {
                return Err(HullError::Inconsistent("a facet lacks its neighbour"));
            }
            horizon.seen = true;
            if horizon.simplicial {
                horizon.ridges.delete(r);
                self.free_ridge(r);
            } else {
                let facet = &mut self.facets[f as usize];
                facet.ridges.push(r);
                facet.has_ridges = true;
                let Ridge { top, bottom, .. } = &mut self.ridges[r as usize];
                *(if top_oriented { top } else { bottom }) = f;
            }
        }
        Ok(last)
    }

    /// New facets over the edges of a visible triangle to the horizon; the last one, if any
    /// (`qh_makenew_simplicial`).
    fn cone_from_triangle(&mut self, visible: u32, apex: u32) -> Result<u32, HullError> {
        let mut last = NONE;
        for i in 0..self.facets[visible as usize].neighbors.len() {
            let neighbor = self.facets[visible as usize].neighbors.get(i);
            let horizon = &self.facets[neighbor as usize];
            if horizon.seen || self.planes[neighbor as usize].visible {
                continue;
            }
            let skip = horizon
                .neighbors
                .position(visible)
                .ok_or(HullError::Inconsistent("a facet lacks its neighbour"))?;
            let mut vertices = Set::of(&[apex]);
            for (k, &v) in horizon.vertices.as_slice().iter().enumerate() {
                if k != skip {
                    vertices.push(v);
                }
            }
            if vertices.len() != 3 {
                return Err(HullError::Inconsistent("a polygon lacks an edge"));
            }
            let top_oriented = (skip % 2 == 1) == horizon.top_oriented;
            let merge_horizon = horizon.coplanar_horizon;
            let f = self.make_new_facet(vertices, top_oriented, neighbor)?;
            last = f;
            self.facets[f as usize].merge_horizon = merge_horizon;
            self.facets[neighbor as usize].neighbors.set(skip, f);
        }
        Ok(last)
    }

    /// Makes new facets neighbours along the edges from the apex. Qhull hashes the edges; here each
    /// waits at its other vertex.
    pub(super) fn match_new_facets(&mut self) -> Result<(), HullError> {
        self.cones += 1;
        let mut unmatched = 0i64;
        let mut f = self.first_new();
        while f != NONE {
            for skip in [1, 2] {
                let facet = &self.facets[f as usize];
                let v = facet.vertices.get(3 - skip) as usize;
                let Waiting {
                    cone,
                    facet: other,
                    skip: other_skip,
                } = self.vertices[v].waiting;
                if cone != self.cones {
                    self.vertices[v].waiting = Waiting {
                        cone: self.cones,
                        facet: f,
                        skip,
                    };
                    unmatched += 1;
                    continue;
                }
                let same = skip % 2 == other_skip % 2;
                let turned = facet.top_oriented != self.facets[other as usize].top_oriented;
                if same != turned || self.facets[other as usize].neighbors.get(other_skip) != NONE {
                    return Err(HullError::Unsupported("an edge with three new facets"));
                }
                self.facets[other as usize].neighbors.set(other_skip, f);
                self.facets[f as usize].neighbors.set(skip, other);
                unmatched -= 1;
            }
            f = self.planes[f as usize].next;
        }
        if unmatched == 0 {
            Ok(())
        } else {
            Err(HullError::Inconsistent("an edge with one new facet"))
        }
    }

    /// Replaces visible facets by new ones among the neighbours of vertices, and finds the vertices
    /// that are left without any (`qh_update_vertexneighbors_cone`).
    fn update_vertex_neighbors(&mut self) {
        if self.has_vertex_neighbors {
            let mut v = self.newvertex_list;
            while v != NONE && v != NOWHERE {
                let mut i = 0;
                while i < self.vertices[v as usize].neighbors.len() {
                    let neighbor = self.vertices[v as usize].neighbors.get(i);
                    if self.planes[neighbor as usize].visible {
                        self.vertices[v as usize].neighbors.delete_at(i);
                    } else {
                        i += 1;
                    }
                }
                v = self.vertices[v as usize].next;
            }
            self.append_to_vertices(self.first_new());
        }
        let mut visible = self.first_visible();
        while visible != NONE {
            for &v in self.facets[visible as usize].vertices.as_slice() {
                let vertex = &mut self.vertices[v as usize];
                if vertex.new || vertex.deleted {
                    continue;
                }
                let planes = &self.planes;
                let survives = self.has_vertex_neighbors
                    && vertex
                        .neighbors
                        .as_slice()
                        .iter()
                        .any(|&neighbor| !planes[neighbor as usize].visible);
                if survives {
                    vertex.neighbors.delete(visible);
                } else {
                    vertex.deleted = true;
                    self.deleted_vertices.push(v);
                }
            }
            visible = self.next_visible(visible);
        }
    }

    /// Appends the facets from `f` on to the neighbours of their vertices.
    pub(super) fn append_to_vertices(&mut self, mut f: u32) {
        while f != NONE {
            if !self.planes[f as usize].visible {
                for &v in self.facets[f as usize].vertices.as_slice() {
                    self.vertices[v as usize].neighbors.push(f);
                }
            }
            f = self.planes[f as usize].next;
        }
    }
}
