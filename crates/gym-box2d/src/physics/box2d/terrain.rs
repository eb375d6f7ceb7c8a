//! Terrain: a line of edges at the origin, each a static body of its own.
//!
//! Most edges are far from moving bodies, so the world stores only the points, and one box per
//! [`BLOCK`] edges. An edge has a body and a fixture only while a moving body is near, because a
//! static body has no state between steps.

use serde::{Deserialize, Serialize};

use super::math::{Vec2, max2, min2, vec2};
use super::settings::{AABB_EXTENSION, POLYGON_RADIUS};
use super::shape::{Aabb, Geometry};
use crate::physics::Shape;

/// The number of edges that share a box.
const BLOCK: usize = 16;

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(from = "Stored", into = "Stored")]
pub(crate) struct Terrain {
    points: Vec<Vec2>,
    pub(crate) friction: f32,
    /// The proxy of the first edge; the proxies of the other edges follow.
    pub(crate) first: u32,
    /// The boxes, each around [`BLOCK`] edges.
    blocks: Vec<Aabb>,
}

/// The serialized form. `blocks` is computed from the points.
#[derive(Serialize, Deserialize)]
struct Stored {
    points: Vec<Vec2>,
    friction: f32,
    first: u32,
}

impl From<Stored> for Terrain {
    fn from(
        Stored {
            points,
            friction,
            first,
        }: Stored,
    ) -> Self {
        Self::new(points, friction, first)
    }
}

impl From<Terrain> for Stored {
    fn from(
        Terrain {
            points,
            friction,
            first,
            ..
        }: Terrain,
    ) -> Self {
        Self {
            points,
            friction,
            first,
        }
    }
}

impl Terrain {
    pub(crate) fn new(points: Vec<Vec2>, friction: f32, first: u32) -> Self {
        let mut terrain = Self {
            points,
            friction,
            first,
            blocks: Vec::new(),
        };
        let union = |a: Aabb, b: Aabb| a.union(&b);
        let edges: Vec<Aabb> = (0..terrain.len()).map(|i| terrain.edge_box(i)).collect();
        terrain.blocks = edges
            .chunks(BLOCK)
            .filter_map(|boxes| boxes.iter().copied().reduce(union))
            .collect();
        terrain
    }

    /// Returns the number of edges.
    pub(crate) fn len(&self) -> usize {
        self.points.len().saturating_sub(1)
    }

    /// Returns the edge of `proxy`, if `proxy` belongs to the terrain.
    pub(crate) fn edge_of(&self, proxy: u32) -> Option<usize> {
        let edge = proxy.checked_sub(self.first)? as usize;
        (edge < self.len()).then_some(edge)
    }

    /// Returns the shape of edge `edge`.
    pub(crate) fn shape(&self, edge: usize) -> Geometry {
        Geometry::from(&Shape::Edge(self.points[edge], self.points[edge + 1]))
    }

    /// Returns an edge's broad-phase box, with margin.
    #[inline]
    pub(crate) fn edge_box(&self, edge: usize) -> Aabb {
        let (a, b) = (self.points[edge], self.points[edge + 1]);
        let (r, margin) = (
            vec2(POLYGON_RADIUS, POLYGON_RADIUS),
            vec2(AABB_EXTENSION, AABB_EXTENSION),
        );
        Aabb {
            lower: min2(a, b) - r - margin,
            upper: max2(a, b) + r + margin,
        }
    }

    /// Calls `visit` with each edge whose box overlaps `aabb`.
    #[inline]
    pub(crate) fn query(&self, aabb: &Aabb, mut visit: impl FnMut(usize)) {
        for (block, bounds) in self.blocks.iter().enumerate() {
            if bounds.overlaps(aabb) {
                let first = block * BLOCK;
                for edge in first..self.len().min(first + BLOCK) {
                    if self.edge_box(edge).overlaps(aabb) {
                        visit(edge);
                    }
                }
            }
        }
    }

    /// Returns the allocated bytes.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Vec2>() * self.points.capacity() + size_of::<Aabb>() * self.blocks.capacity()
    }

    /// Reads one number of each block's box, to prefetch it.
    pub(crate) fn prefetch(&self) -> u32 {
        self.blocks
            .iter()
            .fold(0, |seen, block| seen ^ block.lower.x.to_bits())
    }

    /// Returns both ends of an edge.
    #[inline]
    pub(crate) fn ends(&self, edge: usize) -> [Vec2; 2] {
        [self.points[edge], self.points[edge + 1]]
    }

    pub(crate) fn is_valid(&self) -> bool {
        let finite = |point: &Vec2| point.x.is_finite() && point.y.is_finite();
        self.points.iter().all(finite) && self.friction.is_finite()
    }
}
