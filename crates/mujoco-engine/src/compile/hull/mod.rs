// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! The convex hull of a mesh, with the graph of libmujoco: its vertices, edges and triangles in the
//! same order.
//!
//! MuJoCo calls Qhull with the options `Qt` (triangulate), and with `maxhullvert` `Q9 TA`.
//! Collisions depend on the order of what it returns, and that on everything that Qhull does:
//! quickhull (Barber, Dobkin, Huhdanpaa, "The Quickhull algorithm for convex hulls", ACM Trans.
//! Math. Softw. 22, 1996) with facets merged where rounding makes them not convex. This is Qhull at
//! commit d1c2fc0c for three dimensions; cases that no set of points was seen to reach are
//! [`HullError::Unsupported`].
//!
//! A facet that a point is above has charge of it. The furthest point of a facet is added: the
//! facets that it sees (`cone.rs`) are replaced by a cone of new ones to their horizon, those that
//! are not convex merge (`convexity.rs`, `queue.rs`, `merge.rs`, `rename.rs`), and the points of
//! the old facets move to new ones (`partition.rs`, `locate.rs`). When no facet has a point above
//! it, polygons become triangles (`triangulate.rs`).

mod arena;
mod check;
mod cone;
mod constants;
mod convexity;
mod error;
mod graph;
mod lists;
mod locate;
mod merge;
mod partition;
mod plane;
mod queue;
mod rename;
#[cfg(test)]
pub(crate) mod samples;
mod simplex;
#[cfg(test)]
mod tests;
mod triangulate;

use arena::{Facet, NONE, Plane, Ridge, Set, Vertex};
use constants::Constants;
pub use error::HullError;
pub use graph::Graph;
use lists::NOWHERE;
use queue::Merge;

/// The most points of a set.
pub const MOST_POINTS: usize = 1 << 23;

/// Coordinates beyond it would overflow in products. Those of files, which are `f32`, are below.
const LARGEST: f64 = 1e70;

/// Distances that may be computed, and elements of merged facets that may be visited: about 20 s. A
/// million points on a sphere take a fortieth; only points on few large circles take many.
const MOST_WORK: u64 = 2_000_000_000;

/// The convex hull of `points`, with at most `max_vertices` of them if that is given.
///
/// # Errors
///
/// [`HullError`] if the points have no volume, or rounding spoils their hull: libmujoco refuses
/// these too. The limits are [`MOST_POINTS`] points, 4 million facets at once (2 GB) and two
/// thousand million distances.
pub fn convex_hull(points: &[[f64; 3]], max_vertices: Option<u32>) -> Result<Graph, HullError> {
    if points.len() < 4 {
        return Err(HullError::TooFew(points.len()));
    }
    if points.len() > MOST_POINTS {
        return Err(HullError::TooMany {
            found: points.len(),
            most: MOST_POINTS,
        });
    }
    if let Some(i) = points
        .iter()
        .position(|point| point.iter().any(|x| x.is_nan() || x.abs() > LARGEST))
    {
        return Err(HullError::NotFinite(i));
    }
    if let Some(most) = max_vertices.filter(|&most| most < 4) {
        return Err(HullError::MaxVertices(most));
    }
    let mut builder = Builder::new(points);
    builder.build(max_vertices)?;
    builder.triangulate()?;
    builder.graph()
}

/// A hull while points are added to it.
#[derive(Debug)]
struct Builder<'a> {
    points: &'a [[f64; 3]],
    facets: Vec<Facet>,
    planes: Vec<Plane>,
    vertices: Vec<Vertex>,
    ridges: Vec<Ridge>,
    free_facets: Vec<u32>,
    free_ridges: Vec<u32>,

    // the lists' marks and lengths
    facet_next: u32,
    newfacet_list: u32,
    visible_list: u32,
    newvertex_list: u32,
    num_facets: usize,
    num_vertices: usize,
    num_visible: usize,

    constants: Constants,
    dist_round: f64,
    max_outside: f64,
    min_vertex: f64,
    target: f64,
    interior: [f64; 3],
    /// Two faces of the first tetrahedron nearly face each other.
    narrow: bool,

    total_merges: u32,
    has_vertex_neighbors: bool,
    deleted_vertices: Vec<u32>,
    merges: Vec<Merge>,
    degenerate: Vec<Merge>,

    /// Points are looked for among all new facets, not uphill from one.
    find_new: bool,
    /// The new facets were found to lie in one octant.
    not_sharp: bool,
    /// The facet that a point came back to.
    repartitioned: u32,
    /// No new facet was ever nearly coplanar.
    all_clear: bool,
    /// A point was nearly coplanar.
    was_coplanar: bool,
    stack: Vec<u32>,

    visit: u32,
    vertex_visit: u32,
    cones: u32,
    work: u64,
}

impl<'a> Builder<'a> {
    fn new(points: &'a [[f64; 3]]) -> Self {
        Self {
            points,
            facets: vec![Facet::default()],
            // the list's end is new for ever, which `partition_point` reads
            planes: vec![Plane {
                new: true,
                ..Plane::default()
            }],
            vertices: vec![Vertex {
                new: true,
                ..Vertex::default()
            }],
            ridges: vec![Ridge::default()],
            free_facets: Vec::new(),
            free_ridges: Vec::new(),
            facet_next: NONE,
            newfacet_list: NOWHERE,
            visible_list: NOWHERE,
            newvertex_list: NOWHERE,
            num_facets: 0,
            num_vertices: 0,
            num_visible: 0,
            constants: Constants::default(),
            dist_round: 0.0,
            max_outside: 0.0,
            min_vertex: 0.0,
            target: 0.0,
            interior: [0.0; 3],
            narrow: false,
            total_merges: 0,
            has_vertex_neighbors: false,
            deleted_vertices: Vec::new(),
            merges: Vec::new(),
            degenerate: Vec::new(),
            find_new: false,
            not_sharp: false,
            repartitioned: NONE,
            all_clear: true,
            was_coplanar: false,
            stack: Vec::new(),
            visit: 0,
            vertex_visit: 0,
            cones: 0,
            work: 0,
        }
    }

    fn build(&mut self, max_vertices: Option<u32>) -> Result<(), HullError> {
        let extremes = self.measure();
        let vertices: Set = self.initial_hull(extremes)?;
        self.partition_all(&vertices)?;
        self.reset_lists();
        self.facet_next = self.first_facet();
        self.bring_furthest_forward();
        self.facet_next = self.first_facet();
        while let Some((point, facet)) = self.next_furthest(max_vertices.is_some())? {
            if max_vertices.is_some_and(|most| self.num_vertices >= most as usize) {
                return Ok(());
            }
            self.add_point(point, facet)?;
        }
        if self.narrow {
            self.keep_outside_points()?;
        }
        if max_vertices.is_some() {
            Ok(())
        } else {
            self.check()
        }
    }

    /// Moves the facet with the furthest point to `facet_next`.
    fn bring_furthest_forward(&mut self) {
        let (mut best, mut most) = (NONE, -f64::MAX);
        let mut f = self.first_facet();
        while f != NONE {
            let facet = &self.facets[f as usize];
            if !facet.outside.is_empty() && facet.furthest > most {
                (best, most) = (f, facet.furthest);
            }
            f = self.planes[f as usize].next;
        }
        if best != NONE {
            self.remove_facet(best);
            let at = self.facet_next;
            self.prepend_facet(best, at);
            self.facet_next = best;
        }
    }

    /// The point to add next, and the facet that it is above.
    fn next_furthest(&mut self, furthest_of_all: bool) -> Result<Option<(u32, u32)>, HullError> {
        while self.facet_next != NONE {
            let mut f = self.facet_next;
            let facet = &self.facets[f as usize];
            let next = self.planes[f as usize].next;
            if facet.outside.is_empty()
                || (self.narrow && facet.furthest < self.constants.min_outside)
            {
                self.facet_next = next;
                continue;
            }
            if furthest_of_all {
                self.bring_furthest_forward();
                f = self.facet_next;
            }
            let point = self.facets[f as usize].outside.pop();
            return Ok(point.map(|point| (point, f)));
        }
        Ok(None)
    }

    fn add_point(&mut self, point: u32, facet: u32) -> Result<(), HullError> {
        self.check_work()?;
        self.determine_target();
        self.reset_visits();
        self.find_horizon(point, facet)?;
        self.build_cone(point)?;
        self.find_new = false;
        self.premerge()?;
        self.find_new = self.many_merges() || self.any_new_polygon();
        self.partition_visible()?;
        self.find_new = false;
        self.not_sharp = false;
        self.delete_visible()?;
        self.reset_lists();
        if self.merges.is_empty() && self.degenerate.is_empty() {
            Ok(())
        } else {
            Err(HullError::Inconsistent("merges are left over"))
        }
    }

    fn any_new_polygon(&self) -> bool {
        let mut f = self.first_new();
        while f != NONE {
            if !self.facets[f as usize].simplicial {
                return true;
            }
            f = self.planes[f as usize].next;
        }
        false
    }

    fn check_work(&self) -> Result<(), HullError> {
        if self.work > MOST_WORK {
            Err(HullError::Limit("two thousand million distances"))
        } else {
            Ok(())
        }
    }

    fn next_visit(&mut self) -> u32 {
        // `rename.rs` marks facets with the number before
        self.visit += 2;
        self.visit
    }

    fn next_vertex_visit(&mut self) -> u32 {
        self.vertex_visit += 1;
        self.vertex_visit
    }

    /// Starts the numbers of visits anew before they overflow.
    fn reset_visits(&mut self) {
        if self.visit > u32::MAX / 2 {
            self.visit = 0;
            for plane in &mut self.planes {
                plane.visit = 0;
            }
        }
        if self.vertex_visit > u32::MAX / 2 {
            self.vertex_visit = 0;
            for vertex in &mut self.vertices {
                vertex.visit = 0;
            }
        }
    }
}
