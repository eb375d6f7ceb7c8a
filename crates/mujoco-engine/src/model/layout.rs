//! Meshes, laid out for searches: what a step of a search reads lies in a row.

use std::sync::OnceLock;

use super::Meshes;
use super::bounds::Bounds;
use super::triangles::Triangles;
use crate::math::spatial::{Vec3, dot};

/// What follows from a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// The box around the vertices.
    pub(crate) bounds: Bounds,
    pub(crate) hull: Option<Hull>,
    /// For rays, which few models need.
    pub(super) triangles: OnceLock<Triangles>,
}

/// The layouts of all meshes.
pub(crate) fn layouts(m: &Meshes) -> Vec<Layout> {
    let of = |mesh: usize| {
        let first = m.mesh_vertadr[mesh];
        let points = &m.mesh_vert[first..first + m.mesh_vertnum[mesh]];
        let start = usize::try_from(m.mesh_graphadr[mesh]).ok();
        let hull = |start: usize| Hull::new(&m.mesh_graph[start..], points, m.mesh_extrema[mesh]);
        Layout {
            bounds: around(points.iter().copied()),
            triangles: OnceLock::new(),
            hull: start.map(hull),
        }
    };
    (0..m.mesh_vertadr.len()).map(of).collect()
}

/// The box around points.
pub(super) fn around(points: impl Iterator<Item = [f32; 3]>) -> Bounds {
    let (mut low, mut high) = ([f64::MAX; 3], [f64::MIN; 3]);
    for point in points {
        for k in 0..3 {
            let x = f64::from(point[k]);
            (low[k], high[k]) = (low[k].min(x), high[k].max(x));
        }
    }
    let half = |sign: f64| [0, 1, 2].map(|k| (high[k] + sign * low[k]) / 2.0);
    [half(1.0), half(-1.0)]
}

/// A convex hull, with its vertices numbered as in MuJoCo's `mesh_graph`.
#[derive(Clone, Debug)]
pub(crate) struct Hull {
    vertices: Vec<Vertex>,
    /// The neighbours of each vertex, in the order of the graph.
    neighbours: Vec<Neighbour>,
    /// Where searches begin, by direction: `mesh_extrema`.
    pub(crate) seeds: [u32; 27],
}

#[derive(Clone, Copy, Debug)]
struct Vertex {
    at: [f32; 3],
    /// The vertex's number in the mesh.
    id: u32,
    /// Where the vertex's neighbours end.
    end: u32,
}

#[derive(Clone, Copy, Debug)]
struct Neighbour {
    at: [f32; 3],
    /// The vertex's number in the hull.
    number: u32,
}

impl Hull {
    fn new(graph: &[i32], points: &[[f32; 3]], seeds: [u32; 27]) -> Self {
        let (count, rest) = (graph[0] as usize, &graph[2..]);
        let (ids, lists) = (&rest[count..2 * count], &rest[2 * count..]);
        let at = |number: usize| points[ids[number] as usize];
        let mut lists = lists.split(|other| *other == -1);
        let (mut vertices, mut neighbours) = (Vec::with_capacity(count), Vec::new());
        for (number, id) in ids.iter().enumerate() {
            let others = lists.next().unwrap_or_default().iter();
            neighbours.extend(others.map(|other| Neighbour {
                at: at(*other as usize),
                number: *other as u32,
            }));
            vertices.push(Vertex {
                at: at(number),
                id: *id as u32,
                end: neighbours.len() as u32,
            });
        }
        Self {
            vertices,
            neighbours,
            seeds,
        }
    }

    /// The number in the mesh.
    pub(crate) fn id(&self, vertex: usize) -> usize {
        self.vertices[vertex].id as usize
    }

    /// How far a vertex is in a direction.
    pub(crate) fn along(&self, direction: Vec3, vertex: usize) -> f64 {
        along(direction, self.vertices[vertex].at)
    }

    fn neighbours(&self, vertex: usize) -> &[Neighbour] {
        let before = vertex.checked_sub(1);
        let start = before.map_or(0, |before| self.vertices[before].end);
        &self.neighbours[start as usize..self.vertices[vertex].end as usize]
    }

    /// Moves from a vertex to better neighbours until there is none: MuJoCo's
    /// `mjc_hillclimbSupport`. A round compares the neighbours of the vertex at its start.
    pub(crate) fn climb(&self, start: usize, direction: Vec3) -> usize {
        let (mut best, mut most) = (start, self.along(direction, start));
        loop {
            let before = best;
            for other in self.neighbours(before) {
                let height = along(direction, other.at);
                if height > most {
                    (best, most) = (other.number as usize, height);
                }
            }
            if best == before {
                return best;
            }
        }
    }
}

#[inline]
fn along(direction: Vec3, at: [f32; 3]) -> f64 {
    dot(direction, at.map(f64::from))
}
