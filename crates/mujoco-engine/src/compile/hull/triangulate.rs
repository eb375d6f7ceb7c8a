// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! Polygons become triangles (`qh_triangulate`, `poly2_r.c` of Qhull). The vertices that this moves
//! to the end of their list change the order of the graph.

use super::Builder;
use super::arena::NONE;
use super::error::HullError;
use super::lists::NOWHERE;

impl Builder<'_> {
    /// Replaces every polygon by a fan from its vertex of highest index.
    pub(super) fn triangulate(&mut self) -> Result<(), HullError> {
        let mark = self.next_visit();
        let mut first = NONE;
        let mut first_touched = NOWHERE;
        self.newvertex_list = NONE;
        let mut f = self.first_facet();
        while f != NONE {
            let next = self.planes[f as usize].next;
            if !self.planes[f as usize].visible && !self.facets[f as usize].simplicial {
                if first == NONE {
                    first = f;
                }
                self.triangulate_facet(f, mark, &mut first_touched)?;
            }
            f = next;
        }

        // a fan has two triangles with its first vertex twice: their neighbours become neighbours
        let mut f = first;
        while f != NONE {
            let next = self.planes[f as usize].next;
            let facet = &self.facets[f as usize];
            if !self.planes[f as usize].visible {
                if !facet.ridges.is_empty() {
                    return Err(HullError::Inconsistent("a triangle has ridges"));
                }
                if facet.vertices.get(0) == facet.vertices.get(1) {
                    self.link_over(f)?;
                }
            }
            f = next;
        }

        let mut v = first_touched;
        while v != NONE && v != NOWHERE {
            let planes = &self.planes;
            self.vertices[v as usize]
                .neighbors
                .retain(|f| !planes[f as usize].visible);
            v = self.vertices[v as usize].next;
        }
        self.newvertex_list = first_touched;
        self.reset_lists();
        let mut f = first;
        while f != NONE {
            let next = self.planes[f as usize].next;
            if self.planes[f as usize].visible {
                self.delete_facet(f);
            }
            f = next;
        }
        Ok(())
    }

    fn triangulate_facet(
        &mut self,
        f: u32,
        mark: u32,
        first_touched: &mut u32,
    ) -> Result<(), HullError> {
        for i in 0..self.facets[f as usize].neighbors.len() {
            let neighbor = self.facets[f as usize].neighbors.get(i);
            let facet = &mut self.facets[neighbor as usize];
            facet.seen = false;
            facet.coplanar_horizon = false;
        }
        self.visible_list = NONE;
        self.newfacet_list = NONE;
        self.planes[f as usize].visit = mark;
        let apex = self.facets[f as usize].vertices.get(0);
        self.cone_from_ridges(f, apex, mark)?;
        self.will_delete(f, NONE);
        self.match_new_facets()?;
        if *first_touched == NOWHERE {
            *first_touched = self.newvertex_list;
        }
        self.newvertex_list = NOWHERE;
        self.visible_list = NOWHERE;
        self.append_to_vertices(self.first_new());
        self.reset_lists();
        Ok(())
    }

    fn link_over(&mut self, f: u32) -> Result<(), HullError> {
        let neighbors = &self.facets[f as usize].neighbors;
        let (a, b) = (neighbors.get(0), neighbors.get(1));
        if self.facets[a as usize].neighbors.contains(b)
            || self.facets[b as usize].neighbors.contains(a)
        {
            return Err(HullError::Unsupported(
                "two triangles with the same vertices",
            ));
        }
        let linked = self.facets[a as usize].neighbors.replace(f, b)
            && self.facets[b as usize].neighbors.replace(f, a);
        if !linked {
            return Err(HullError::Inconsistent("a facet lacks its neighbour"));
        }
        self.will_delete(f, NONE);
        Ok(())
    }
}
