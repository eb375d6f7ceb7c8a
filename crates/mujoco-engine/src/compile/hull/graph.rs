//! The hull as MuJoCo stores it: `mesh_graph`.

use super::Builder;
use super::arena::NONE;
use super::error::HullError;

/// The vertices, edges and triangles of a convex hull, in the order of libmujoco.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Graph {
    /// The number of each vertex among the points.
    pub points: Vec<u32>,
    /// Where each vertex's neighbours begin in `edges`.
    pub edge_starts: Vec<u32>,
    /// The neighbours of each vertex, by their number in `points`; -1 ends each list.
    pub edges: Vec<i32>,
    /// The corners of each triangle, by their number among the points, counterclockwise from
    /// outside.
    pub faces: Vec<[u32; 3]>,
}

impl Graph {
    /// `mesh_graph`: the counts of vertices and triangles, then `edge_starts`, `points`, `edges`
    /// and `faces`.
    #[must_use]
    pub fn to_integers(&self) -> Vec<i32> {
        let mut integers = vec![self.points.len() as i32, self.faces.len() as i32];
        integers.extend(
            self.edge_starts
                .iter()
                .chain(&self.points)
                .map(|&i| i as i32),
        );
        integers.extend(&self.edges);
        integers.extend(self.faces.iter().flatten().map(|&i| i as i32));
        integers
    }
}

impl Builder<'_> {
    pub(super) fn graph(&mut self) -> Result<Graph, HullError> {
        self.find_vertex_neighbors();
        let mut points = Vec::with_capacity(self.num_vertices);
        let mut number = vec![0; self.vertices.len()];
        let mut v = self.first_vertex();
        while v != NONE {
            number[v as usize] = points.len() as i32;
            points.push(self.vertices[v as usize].point);
            v = self.vertices[v as usize].next;
        }

        let (mut edge_starts, mut edges) = (Vec::new(), Vec::new());
        let mut v = self.first_vertex();
        while v != NONE {
            let start = edges.len();
            edge_starts.push(start as u32);
            let mark = self.next_vertex_visit();
            self.vertices[v as usize].visit = mark;
            for &f in self.vertices[v as usize].neighbors.clone().as_slice() {
                for &other in self.facets[f as usize].vertices.as_slice() {
                    let vertex = &mut self.vertices[other as usize];
                    if vertex.visit != mark {
                        vertex.visit = mark;
                        edges.push(number[other as usize]);
                    }
                }
            }
            edges.push(-1);
            v = self.vertices[v as usize].next;
        }

        let mut faces = Vec::with_capacity(self.num_facets);
        let mut f = self.first_facet();
        while f != NONE {
            let facet = &self.facets[f as usize];
            let [a, b, c] = [0, 1, 2].map(|i| self.vertices[facet.vertices.get(i) as usize].point);
            if facet.vertices.len() != 3 {
                return Err(HullError::Inconsistent("a facet is no triangle"));
            }
            faces.push(if facet.top_oriented {
                [b, a, c]
            } else {
                [a, b, c]
            });
            f = self.planes[f as usize].next;
        }
        if edges.len() != points.len() + 3 * faces.len() {
            return Err(HullError::Inconsistent(
                "the edges are not those of the triangles",
            ));
        }
        Ok(Graph {
            points,
            edge_starts,
            edges,
            faces,
        })
    }
}
