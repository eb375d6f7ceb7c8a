//! The polygons of a hull: its triangles, joined where their normals nearly agree (`MakePolygons`
//! in MuJoCo's `user_mesh.cc`). Contacts of faces are made from them.

use std::collections::{BTreeMap, HashMap};

use super::order;
use crate::Revision;
use crate::math::libm;
use crate::math::spatial::{MINVAL, Vec3, cross, dot};

/// The step of the angles that normals are sorted by, in rad.
const STEP: f64 = 0.01;
/// A normal nearer to the z axis has no azimuth.
const POLE: f64 = 1.0 - 1e-7;

/// The polygons of a hull, and which of them each vertex has.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Polygons {
    /// The vertices of each.
    pub(super) corners: Vec<Vec<i32>>,
    /// The polygons of each vertex, ascending.
    pub(super) of_vertex: Vec<Vec<i32>>,
}

impl Polygons {
    pub(super) fn new(points: &[Vec3], faces: &[[i32; 3]], revision: Revision) -> Self {
        // triangles with the same rounded azimuth and polar angle
        let mut groups: Vec<Group> = Vec::new();
        let mut hashes = Vec::new();
        let mut known: BTreeMap<[i64; 2], usize> = BTreeMap::new();
        for face in faces {
            let Some([azimuth, polar]) = key(face.map(|v| points[v as usize])) else {
                continue;
            };
            let group = *known
                .entry([azimuth as i64, polar as i64])
                .or_insert_with(|| {
                    groups.push(Group::default());
                    hashes.push(order::hash(azimuth, polar, revision));
                    groups.len() - 1
                });
            groups[group].insert(*face);
        }
        let mut polygons = Self {
            corners: Vec::new(),
            of_vertex: vec![Vec::new(); points.len()],
        };
        for i in order::iteration(&hashes) {
            polygons.corners.extend(
                groups[i]
                    .outlines(revision)
                    .into_iter()
                    .filter(|outline| outline.len() >= 3),
            );
        }
        for (i, corners) in polygons.corners.iter().enumerate() {
            for &v in corners {
                polygons.of_vertex[v as usize].push(i as i32);
            }
        }
        polygons
    }
}

/// The azimuth and the polar angle of a triangle's normal, in steps; none if it has no area.
fn key([a, b, c]: [Vec3; 3]) -> Option<[f64; 2]> {
    let normal = cross(
        [0, 1, 2].map(|k| b[k] - a[k]),
        [0, 1, 2].map(|k| c[k] - a[k]),
    );
    let length = dot(normal, normal).sqrt();
    if length < MINVAL {
        return None;
    }
    let [x, y, z] = normal.map(|n| n / length + 0.0);
    if z.abs() > POLE {
        return Some([
            0.0,
            if z < 0.0 {
                (std::f64::consts::PI / STEP).round()
            } else {
                0.0
            },
        ]);
    }
    Some([
        (libm::atan2(y, x) / STEP).round(),
        (libm::acos(z) / STEP).round(),
    ])
}

/// Triangles of one direction. They need not be connected: each island has a number, by age.
#[derive(Debug, Default)]
struct Group {
    /// The directed edges of the outlines, by age, and their islands; none where another triangle
    /// closed the edge.
    edges: Vec<Option<([i32; 2], usize)>>,
    place: HashMap<[i32; 2], usize>,
    open: usize,
    /// The island that each one became part of.
    parents: Vec<usize>,
}

impl Group {
    fn insert(&mut self, [a, b, c]: [i32; 3]) {
        let edges = [[a, b], [b, c], [c, a]];
        let mut island = None;
        let closes = edges.map(|[from, to]| {
            let Some(place) = self.place.remove(&[to, from]) else {
                return false;
            };
            if let Some((_, other)) = self.edges[place].take() {
                self.open -= 1;
                let other = self.root(other);
                island = Some(match island {
                    None => other,
                    Some(island) => {
                        let (older, younger) = if other < island {
                            (other, island)
                        } else {
                            (island, other)
                        };
                        self.parents[younger] = older;
                        older
                    }
                });
            }
            true
        });
        let island = island.unwrap_or_else(|| {
            self.parents.push(self.parents.len());
            self.parents.len() - 1
        });
        for (edge, closes) in edges.into_iter().zip(closes) {
            if !closes {
                self.place.insert(edge, self.edges.len());
                self.edges.push(Some((edge, island)));
                self.open += 1;
            }
        }
    }

    fn root(&mut self, mut island: usize) -> usize {
        while self.parents[island] != island {
            self.parents[island] = self.parents[self.parents[island]];
            island = self.parents[island];
        }
        island
    }

    /// The outline of each island, from the oldest edge of the oldest island on.
    fn outlines(&mut self, revision: Revision) -> Vec<Vec<i32>> {
        let edges: Vec<([i32; 2], usize)> = self.edges.iter().flatten().copied().collect();
        if let ([(a, _), (b, _), (c, _)], false) = (&edges[..], revision.joins_single_faces()) {
            return vec![vec![a[0], b[0], c[0]]];
        }
        let mut islands: BTreeMap<usize, Vec<(usize, [i32; 2])>> = BTreeMap::new();
        for (age, (edge, island)) in edges.into_iter().enumerate() {
            islands
                .entry(self.root(island))
                .or_default()
                .push((age, edge));
        }
        let mut outlines = Vec::new();
        for edges in islands.into_values() {
            let (_, [first, second]) = edges[0];
            // the oldest edge from each vertex; the very first edge of all does not count
            let mut onward: HashMap<i32, i32> = HashMap::new();
            for &(age, [from, to]) in &edges {
                if age > 0 {
                    onward.entry(from).or_insert(to);
                }
            }
            let mut outline = vec![first, second];
            for _ in 0..self.open {
                match onward.get(&outline[outline.len() - 1]) {
                    Some(&next) if next == first => {
                        outlines.push(outline);
                        break;
                    }
                    Some(&next) => outline.push(next),
                    // no outline, but libmujoco goes on looking
                    None => break,
                }
            }
        }
        outlines
    }
}
