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
    /// The neighbours of each vertex, in the order of the graph, by fours.
    neighbours: Vec<Four>,
    /// Where searches begin, by direction: `mesh_extrema`.
    pub(crate) seeds: [u32; 27],
}

#[derive(Clone, Copy, Debug)]
struct Vertex {
    at: [f32; 3],
    /// The vertex's number in the mesh.
    id: u32,
    /// Where the fours of the vertex's neighbours end.
    end: u32,
}

/// Four neighbours of a vertex; those that are missing have NaN as coordinates.
#[derive(Clone, Copy, Debug)]
struct Four {
    x: [f32; 4],
    y: [f32; 4],
    z: [f32; 4],
    /// The vertices' numbers in the hull.
    numbers: [u32; 4],
}

impl Four {
    fn new(numbers: &[i32], at: impl Fn(usize) -> [f32; 3]) -> Self {
        let places = std::array::from_fn(|k| match numbers.get(k) {
            Some(&number) => at(number as usize),
            None => [f32::NAN; 3],
        });
        let of = |axis: usize| places.map(|place: [f32; 3]| place[axis]);
        let number = |k: usize| numbers.get(k).map_or(0, |&number| number as u32);
        Self {
            x: of(0),
            y: of(1),
            z: of(2),
            numbers: std::array::from_fn(number),
        }
    }

    /// How far each is in a direction.
    #[inline]
    fn along(&self, [x, y, z]: Vec3) -> [f64; 4] {
        std::array::from_fn(|k| {
            x * f64::from(self.x[k]) + y * f64::from(self.y[k]) + z * f64::from(self.z[k])
        })
    }
}

impl Hull {
    fn new(graph: &[i32], points: &[[f32; 3]], seeds: [u32; 27]) -> Self {
        let (count, rest) = (graph[0] as usize, &graph[2..]);
        let (ids, lists) = (&rest[count..2 * count], &rest[2 * count..]);
        let at = |number: usize| points[ids[number] as usize];
        let mut lists = lists.split(|other| *other == -1);
        let (mut vertices, mut neighbours) = (Vec::with_capacity(count), Vec::new());
        for (number, id) in ids.iter().enumerate() {
            let others = lists.next().unwrap_or_default();
            neighbours.extend(others.chunks(4).map(|four| Four::new(four, at)));
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

    fn neighbours(&self, vertex: usize) -> &[Four] {
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
            for four in self.neighbours(before) {
                let heights = four.along(direction);
                // no comparison with NaN is true, so the first of a pair stays
                let larger = |a: f64, b: f64| if b > a { b } else { a };
                let [a, b, c, d] = heights;
                let highest = larger(larger(a, b), larger(c, d));
                if highest > most {
                    let first = heights.iter().position(|height| *height == highest);
                    best = four.numbers[first.unwrap_or(0)] as usize;
                    most = highest;
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
