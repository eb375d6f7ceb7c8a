//! The bodies of many worlds, one world in each lane.

use fearless_simd::Simd;

use super::body::Body;
use super::motion::Velocity;
use super::wide::{Chunk, Pair, Wide, per_world};

per_world! {
    /// A body, in all lanes.
    struct BodyRows { inv_mass, inv_inertia, v_x, v_y, w }
}

/// The dynamic bodies of an island, in all lanes.
#[derive(Clone, Debug, Default)]
pub(super) struct Bodies(Vec<BodyRows>);

impl Bodies {
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    pub(super) fn resize(&mut self, len: usize) {
        self.0.resize(len, BodyRows::ZERO);
    }

    /// Loads the bodies of a world into `lane`.
    pub(super) fn enter<'a>(
        &mut self,
        lane: usize,
        bodies: impl Iterator<Item = &'a Body>,
        velocities: &[Velocity],
    ) {
        for ((rows, body), velocity) in self.0.iter_mut().zip(bodies).zip(velocities) {
            rows.inv_mass.0[lane] = body.inv_mass;
            rows.inv_inertia.0[lane] = body.inv_inertia;
            rows.v_x.0[lane] = velocity.v.x;
            rows.v_y.0[lane] = velocity.v.y;
            rows.w.0[lane] = velocity.w;
        }
    }

    /// Writes the velocities of `lane` back to `velocities`.
    pub(super) fn collect(&self, lane: usize, velocities: &mut [Velocity]) {
        for (Velocity { v, w }, rows) in velocities.iter_mut().zip(&self.0) {
            (v.x, v.y, *w) = (rows.v_x.0[lane], rows.v_y.0[lane], rows.w.0[lane]);
        }
    }

    /// Copies lane 0 to the lanes from `len` on.
    pub(super) fn pad(&mut self, len: usize) {
        self.0.iter_mut().for_each(|rows| rows.pad(len));
    }

    /// Returns the inverse mass and the inverse moment of inertia of `body`.
    #[inline(always)]
    pub(super) fn masses<S: Simd, const R: usize>(
        &self,
        chunk: Chunk<S, R>,
        body: usize,
    ) -> (Wide<S, R>, Wide<S, R>) {
        let rows = &self.0[body];
        (chunk.load(&rows.inv_mass), chunk.load(&rows.inv_inertia))
    }

    /// Returns the velocity and the angular velocity of `body`.
    #[inline(always)]
    pub(super) fn load<S: Simd, const R: usize>(
        &self,
        chunk: Chunk<S, R>,
        body: usize,
    ) -> (Pair<S, R>, Wide<S, R>) {
        let rows = &self.0[body];
        (chunk.pair(&rows.v_x, &rows.v_y), chunk.load(&rows.w))
    }

    #[inline(always)]
    pub(super) fn store<S: Simd, const R: usize>(
        &mut self,
        chunk: Chunk<S, R>,
        body: usize,
        v: Pair<S, R>,
        w: Wide<S, R>,
    ) {
        let rows = &mut self.0[body];
        chunk.store(&mut rows.v_x, v.x);
        chunk.store(&mut rows.v_y, v.y);
        chunk.store(&mut rows.w, w);
    }
}
