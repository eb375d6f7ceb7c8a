// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! The lists of facets and of vertices, with the marks in them. Removing an element moves every
//! mark on it to its successor; the order of the lists is the order of the graph.

use super::Builder;
use super::arena::{Facet, NONE, Plane, Ridge, Set, Vertex};
use super::error::HullError;

/// A mark that is nowhere, which the lists' end (index 0) is not.
pub(super) const NOWHERE: u32 = u32::MAX;

/// Facets that exist at once: about 1.5 GB.
const MOST_FACETS: usize = 1 << 22;

impl Builder<'_> {
    /// A facet in no list.
    pub(super) fn make_facet(&mut self) -> Result<u32, HullError> {
        let facet = Facet {
            max_outside: self.dist_round,
            simplicial: true,
            ..Facet::default()
        };
        let plane = Plane {
            new: true,
            ..Plane::default()
        };
        if let Some(slot) = self.free_facets.pop() {
            self.facets[slot as usize] = facet;
            self.planes[slot as usize] = plane;
            return Ok(slot);
        }
        if self.facets.len() >= MOST_FACETS {
            return Err(HullError::Limit("4 million facets"));
        }
        self.facets.push(facet);
        self.planes.push(plane);
        Ok(self.facets.len() as u32 - 1)
    }

    pub(super) fn make_vertex(&mut self, point: u32) -> u32 {
        self.vertices.push(Vertex {
            point,
            ..Vertex::default()
        });
        self.vertices.len() as u32 - 1
    }

    pub(super) fn make_ridge(&mut self, ridge: Ridge) -> u32 {
        if let Some(slot) = self.free_ridges.pop() {
            self.ridges[slot as usize] = ridge;
            return slot;
        }
        self.ridges.push(ridge);
        self.ridges.len() as u32 - 1
    }

    pub(super) fn free_ridge(&mut self, ridge: u32) {
        self.free_ridges.push(ridge);
    }

    pub(super) fn first_facet(&self) -> u32 {
        self.planes[0].next
    }

    pub(super) fn first_vertex(&self) -> u32 {
        self.vertices[0].next
    }

    pub(super) fn append_facet(&mut self, f: u32) {
        if self.newfacet_list == NONE {
            self.newfacet_list = f;
            if self.visible_list == NONE {
                self.visible_list = f;
            }
        }
        if self.facet_next == NONE {
            self.facet_next = f;
        }
        self.link_facet_before(f, NONE);
    }

    /// Puts `f` before `at`, which may be the end. The caller moves its mark from `at` to `f`.
    pub(super) fn prepend_facet(&mut self, f: u32, at: u32) {
        if self.facet_next == at {
            self.facet_next = f;
        }
        self.link_facet_before(f, at);
    }

    fn link_facet_before(&mut self, f: u32, at: u32) {
        let before = self.planes[at as usize].previous;
        self.planes[f as usize].previous = before;
        self.planes[f as usize].next = at;
        self.planes[before as usize].next = f;
        self.planes[at as usize].previous = f;
        self.num_facets += 1;
    }

    pub(super) fn remove_facet(&mut self, f: u32) {
        let Plane { next, previous, .. } = self.planes[f as usize];
        for mark in [
            &mut self.newfacet_list,
            &mut self.facet_next,
            &mut self.visible_list,
        ] {
            if *mark == f {
                *mark = next;
            }
        }
        self.planes[previous as usize].next = next;
        self.planes[next as usize].previous = previous;
        self.num_facets -= 1;
    }

    /// Removes `f` from the list and frees its slot.
    pub(super) fn delete_facet(&mut self, f: u32) {
        self.remove_facet(f);
        self.facets[f as usize] = Facet::default();
        self.planes[f as usize] = Plane::default();
        self.free_facets.push(f);
    }

    /// Moves a merged facet to the visible ones; `replace` takes over.
    pub(super) fn will_delete(&mut self, f: u32, replace: u32) {
        self.remove_facet(f);
        let at = if self.visible_list == NOWHERE {
            NONE
        } else {
            self.visible_list
        };
        self.prepend_facet(f, at);
        self.visible_list = f;
        self.num_visible += 1;
        self.planes[f as usize].visible = true;
        let facet = &mut self.facets[f as usize];
        facet.replace = replace;
        facet.ridges.clear();
        facet.neighbors.clear();
    }

    pub(super) fn append_vertex(&mut self, v: u32) {
        if self.newvertex_list == NONE {
            self.newvertex_list = v;
        }
        let before = self.vertices[0].previous;
        let vertex = &mut self.vertices[v as usize];
        vertex.new = true;
        vertex.previous = before;
        vertex.next = NONE;
        self.vertices[before as usize].next = v;
        self.vertices[0].previous = v;
        self.num_vertices += 1;
    }

    pub(super) fn remove_vertex(&mut self, v: u32) {
        let Vertex { next, previous, .. } = self.vertices[v as usize];
        if self.newvertex_list == v {
            self.newvertex_list = next;
        }
        self.vertices[previous as usize].next = next;
        self.vertices[next as usize].previous = previous;
        self.num_vertices -= 1;
    }

    /// Moves a vertex that is not new to the end of the list, as a new one.
    pub(super) fn touch(&mut self, v: u32) {
        if !self.vertices[v as usize].new {
            self.remove_vertex(v);
            self.append_vertex(v);
        }
    }

    pub(super) fn touch_all(&mut self, vertices: &Set) {
        for &v in vertices.as_slice() {
            self.touch(v);
        }
    }

    /// Forgets which facets and vertices are new.
    pub(super) fn reset_lists(&mut self) {
        let mut v = self.newvertex_list;
        while v != NONE && v != NOWHERE {
            self.vertices[v as usize].new = false;
            v = self.vertices[v as usize].next;
        }
        self.newvertex_list = NOWHERE;
        let mut f = self.newfacet_list;
        while f != NONE && f != NOWHERE {
            self.planes[f as usize].new = false;
            f = self.planes[f as usize].next;
        }
        self.newfacet_list = NOWHERE;
        self.visible_list = NOWHERE;
    }

    /// The first of the facets from the mark `newfacet_list` on, or none.
    pub(super) fn first_new(&self) -> u32 {
        if self.newfacet_list == NOWHERE {
            NONE
        } else {
            self.newfacet_list
        }
    }

    /// The first visible facet, or none.
    pub(super) fn first_visible(&self) -> u32 {
        self.visible_from(self.visible_list)
    }

    /// The visible facet after `f`, or none.
    pub(super) fn next_visible(&self, f: u32) -> u32 {
        self.visible_from(self.planes[f as usize].next)
    }

    fn visible_from(&self, f: u32) -> u32 {
        if f != NOWHERE && self.planes[f as usize].visible {
            f
        } else {
            NONE
        }
    }

    /// Deletes the facets and the vertices that the last point made superfluous.
    pub(super) fn delete_visible(&mut self) -> Result<(), HullError> {
        let mut count = 0;
        let mut f = self.first_visible();
        while f != NONE {
            let next = self.next_visible(f);
            self.delete_facet(f);
            count += 1;
            f = next;
        }
        if count != self.num_visible {
            return Err(HullError::Inconsistent("visible facets are out of order"));
        }
        self.num_visible = 0;
        for v in std::mem::take(&mut self.deleted_vertices) {
            self.remove_vertex(v);
            self.vertices[v as usize].neighbors.clear();
        }
        Ok(())
    }
}
