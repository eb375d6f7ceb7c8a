//! The boxes around the geoms of a body, in a tree: MuJoCo's bounding volume hierarchy.
//!
//! Geoms of two bodies are compared only if the boxes around their groups overlap. This skips pairs
//! that do not touch. Where geoms touch at distance 0, the rounding of the boxes decides whether
//! they are compared.

use std::ops::Range;

use super::{CompiledModel, GeomType};
use crate::math::spatial::{EPS, Quat, Vec3, inverse, rotate_quat, sub};

/// The centre and the half sizes of a box.
pub(crate) type Bounds = [Vec3; 2];

/// The box around a geom, in its frame: MuJoCo's `geom_aabb`.
pub(crate) fn bounding_box(m: &CompiledModel, g: usize) -> Bounds {
    match m.geom_type[g] {
        GeomType::Mesh => {}
        GeomType::Hfield => {
            let [x, y, height, base] = m.hfield_size(g);
            let middle = [0.0, 0.0, (height - base) / 2.0];
            return [middle, [x, y, (height + base) / 2.0]];
        }
        kind => return shape_box(kind, m.geom_size[g]),
    }
    let [x, y, z, i, j, k] = m.geom_aabb[g];
    [[x, y, z], [i, j, k]]
}

/// The box around a shape, in its frame; without extent for a mesh or a height field, which have no
/// size.
pub(crate) fn shape_box(kind: GeomType, size: Vec3) -> Bounds {
    let [r, half, z] = size;
    let centre = match kind {
        GeomType::Plane => [0.0, 0.0, -5e9],
        _ => [0.0; 3],
    };
    let half = match kind {
        GeomType::Plane => [1e10, 1e10, 5e9],
        GeomType::Sphere => [r, r, r],
        GeomType::Capsule => [r, r, r + half],
        GeomType::Cylinder => [r, r, half],
        GeomType::Ellipsoid | GeomType::Box => [r, half, z],
        GeomType::Mesh | GeomType::Hfield => [0.0; 3],
    };
    [centre, half]
}

/// A box around some geoms of a body, in the body's inertial frame.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) bounds: Bounds,
    /// The geoms, sorted.
    geoms: Vec<usize>,
    /// The nodes of the two halves of `geoms`; for one geom, the node itself.
    halves: [usize; 2],
}

/// The tree of a body; its first node contains all geoms that can collide.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
    /// The largest margin and gap of the body's geoms.
    pub(crate) margin: f64,
}

impl Tree {
    /// Builds the tree of the geoms of a body.
    pub(super) fn new(m: &CompiledModel, body: usize, geoms: Range<usize>) -> Self {
        let margins = geoms.clone().map(|g| m.geom_margin[g] + m.geom_gap[g]);
        let mut tree = Self {
            nodes: Vec::new(),
            margin: margins.fold(0.0, f64::max),
        };
        let collides = |g: &usize| m.geom_contype[*g] != 0 || m.geom_conaffinity[*g] != 0;
        let geoms: Vec<usize> = geoms.filter(collides).collect();
        if !geoms.is_empty() {
            tree.grow(m, body, geoms);
        }
        tree
    }

    fn grow(&mut self, m: &CompiledModel, body: usize, mut geoms: Vec<usize>) -> usize {
        let inward = |v: Vec3| turned(inverse(m.body_iquat[body]), v);
        let (mut low, mut high) = ([f64::MAX; 3], [-f64::MAX; 3]);
        for &g in &geoms {
            let [centre, half] = bounding_box(m, g);
            for corner in 0..8 {
                let at = std::array::from_fn(|k| {
                    if corner & (1 << k) == 0 {
                        centre[k] - half[k]
                    } else {
                        centre[k] + half[k]
                    }
                });
                let at = turned(m.geom_quat[g], at);
                let from = |k: usize| at[k] + (m.geom_pos[g][k] - m.body_ipos[body][k]);
                let at = inward([from(0), from(1), from(2)]);
                for k in 0..3 {
                    (low[k], high[k]) = (low[k].min(at[k]), high[k].max(at[k]));
                }
            }
        }
        for k in 0..3 {
            if (low[k] - high[k]).abs() < EPS {
                (low[k], high[k]) = (low[k] - EPS, high[k] + EPS);
            }
        }
        let index = self.nodes.len();
        let middle = |k: usize| (high[k] + low[k]) / 2.0;
        let half = |k: usize| (high[k] - low[k]) / 2.0;
        self.nodes.push(Node {
            bounds: [[0, 1, 2].map(middle), [0, 1, 2].map(half)],
            geoms: geoms.clone(),
            halves: [index; 2],
        });
        if geoms.len() > 1 {
            let edges = sub(high, low);
            let mut axis = usize::from(edges[1] >= edges[0] + EPS);
            if edges[2] >= edges[axis] + EPS {
                axis = 2;
            }
            let place = |g: usize| inward(sub(m.geom_pos[g], m.body_ipos[body]))[axis];
            let before = |a: usize, b: usize| {
                if (place(a) - place(b)).abs() > EPS {
                    place(a) < place(b)
                } else {
                    a < b
                }
            };
            let rank = |g: &usize| geoms.iter().filter(|other| before(**other, *g)).count();
            let mut order: Vec<(usize, usize)> = geoms.iter().map(|g| (rank(g), *g)).collect();
            order.sort_unstable();
            let mut upper: Vec<usize> = order.into_iter().map(|(_, g)| g).collect();
            geoms = upper.drain(..upper.len() / 2).collect();
            for (half, mut part) in [geoms, upper].into_iter().enumerate() {
                part.sort_unstable();
                self.nodes[index].halves[half] = self.grow(m, body, part);
            }
        }
        index
    }
}

/// The pairs of boxes that must overlap before two geoms are compared, from the roots down:
/// MuJoCo's `mj_collideTree`.
pub(crate) fn meetings(trees: [&Tree; 2], geoms: [usize; 2]) -> impl Iterator<Item = [&Bounds; 2]> {
    let mut at = trees.map(|tree| tree.nodes.first());
    std::iter::from_fn(move || {
        let [Some(a), Some(b)] = at else { return None };
        let single = [a, b].map(|node| node.geoms.len() == 1);
        if single == [true; 2] {
            return None;
        }
        // descends into the larger box, by MuJoCo's measure of the surface
        let surface = |node: &Node| {
            let [x, y, z] = sub(node.bounds[1], node.bounds[0]);
            x * y + y * z + z * x
        };
        let side = match single {
            [false, true] => 0,
            [true, false] => 1,
            _ => usize::from(surface(a) <= surface(b)),
        };
        let halves = at[side]?.halves.map(|half| &trees[side].nodes[half]);
        let holds = |node: &&Node| node.geoms.binary_search(&geoms[side]).is_ok();
        at[side] = halves.into_iter().find(holds);
        Some([&a.bounds, &b.bounds])
    })
}

/// `v` rotated by `quat`: the compiler's `mjuu_rotVecQuat`. The identity keeps the signs of zeros.
fn turned(quat: Quat, v: Vec3) -> Vec3 {
    if v == [0.0; 3] || quat == [1.0, 0.0, 0.0, 0.0] {
        v
    } else {
        rotate_quat(v, quat)
    }
}
