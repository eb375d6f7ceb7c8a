//! One contact of many worlds at once, between a static and a dynamic body.
//! [`Constraint::solve_velocity`] makes the same operations in the same order; masks replace its
//! branches.
//!
//! The static body's velocity is 0. Its terms `0 × lever arm` are nevertheless subtracted, because
//! the subtraction decides the sign of a zero.

use fearless_simd::Simd;

use super::{Constraint, Velocity, cross_scalar};
use crate::physics::box2d::lane_bodies::Bodies;
use crate::physics::box2d::wide::{Chunk, Mask, Pair, PerWorld, Wide, per_world};

per_world! {
    /// A contact point. `static_x`, `static_y`: the static body's term `0 × lever arm`.
    struct PointRows {
        r_x, r_y, static_x, static_y,
        normal_impulse, tangent_impulse, normal_mass, tangent_mass, bias,
    }
}

per_world! {
    /// The data that both points share.
    struct ContactRows {
        count, // number of points; 0 in the lane of a world without this contact
        friction, normal_x, normal_y,
        k11, k12, k22,
        inverse11, inverse12, inverse22,
    }
}

/// One contact of a body, in all lanes.
#[derive(Clone, Debug)]
pub(in crate::physics::box2d) struct WideContact {
    rows: ContactRows,
    points: [PointRows; 2],
    /// Whether some lane has one point, and whether some lane has two.
    counts: [bool; 2],
}

impl WideContact {
    pub(in crate::physics::box2d) const NONE: Self = Self {
        rows: ContactRows::ZERO,
        points: [PointRows::ZERO; 2],
        counts: [false; 2],
    };

    pub(in crate::physics::box2d) fn is_none(&self) -> bool {
        self.counts == [false; 2]
    }

    pub(in crate::physics::box2d) fn pad(&mut self, len: usize) {
        self.rows.pad(len);
        self.points.iter_mut().for_each(|point| point.pad(len));
    }

    pub(in crate::physics::box2d) fn load(&mut self, lane: usize, c: &Constraint) {
        self.counts[c.count - 1] = true;
        let rows = &mut self.rows;
        for (row, x) in [
            (&mut rows.count, c.count as f32),
            (&mut rows.friction, c.friction),
            (&mut rows.normal_x, c.normal.x),
            (&mut rows.normal_y, c.normal.y),
            (&mut rows.k11, c.k.ex.x),
            (&mut rows.k12, c.k.ex.y),
            (&mut rows.k22, c.k.ey.y),
            (&mut rows.inverse11, c.normal_mass.ex.x),
            (&mut rows.inverse12, c.normal_mass.ex.y),
            (&mut rows.inverse22, c.normal_mass.ey.y),
        ] {
            row.0[lane] = x;
        }
        for (rows, point) in self.points.iter_mut().zip(&c.points[..c.count]) {
            let still = cross_scalar(0.0, point.r_a);
            for (row, x) in [
                (&mut rows.r_x, point.r_b.x),
                (&mut rows.r_y, point.r_b.y),
                (&mut rows.static_x, still.x),
                (&mut rows.static_y, still.y),
                (&mut rows.normal_impulse, point.normal_impulse),
                (&mut rows.tangent_impulse, point.tangent_impulse),
                (&mut rows.normal_mass, point.normal_mass),
                (&mut rows.tangent_mass, point.tangent_mass),
                (&mut rows.bias, point.velocity_bias),
            ] {
                row.0[lane] = x;
            }
        }
    }

    /// Writes the impulses of `lane` back to `c`.
    pub(in crate::physics::box2d) fn collect(&self, lane: usize, c: &mut Constraint) {
        let count = c.count;
        for (rows, point) in self.points.iter().zip(&mut c.points[..count]) {
            point.normal_impulse = rows.normal_impulse.0[lane];
            point.tangent_impulse = rows.tangent_impulse.0[lane];
        }
    }

    /// Makes one velocity iteration of this contact, whose dynamic body is `body`.
    #[inline(always)]
    pub(in crate::physics::box2d) fn solve_velocity<S: Simd, const R: usize>(
        &mut self,
        chunk: Chunk<S, R>,
        bodies: &mut Bodies,
        body: usize,
    ) {
        let (m, i) = bodies.masses(chunk, body);
        let (before_v, before_w) = bodies.load(chunk, body);
        let (mut v, mut w) = (before_v, before_w);
        let count = chunk.load(&self.rows.count);
        let (one, two) = (chunk.same(0.5).lt(count), chunk.same(1.5).lt(count));
        let normal = pair(chunk, &self.rows.normal_x, &self.rows.normal_y);
        let tangent = normal.cross_one();
        let friction = chunk.load(&self.rows.friction);

        // `active`: the lanes that have point `k`; the other lanes keep their values
        for k in 0..if self.counts[1] { 2 } else { 1 } {
            let (point, active) = (&mut self.points[k], if k == 0 { one } else { two });
            let vt = point.relative(chunk, v, w).dot(tangent);
            let max = friction * chunk.load(&point.normal_impulse);
            let old = chunk.load(&point.tangent_impulse);
            let new = (old + chunk.load(&point.tangent_mass) * -vt).clamp(-max, max);
            let p = tangent.times(new - old);
            point.tangent_impulse.set(chunk, active, new);
            v = active.choose(v + p.times(m), v);
            w = active.select(w + i * pair(chunk, &point.r_x, &point.r_y).cross(p), w);
        }

        let (mut end_v, mut end_w) = (v, w);
        if self.counts[0] {
            let single = one & !two;
            let point = &mut self.points[0];
            let vn = point.relative(chunk, v, w).dot(normal);
            let lambda = -chunk.load(&point.normal_mass) * (vn - chunk.load(&point.bias));
            let old = chunk.load(&point.normal_impulse);
            let new = (old + lambda).max(chunk.same(0.0));
            let p = normal.times(new - old);
            point.normal_impulse.set(chunk, single, new);
            end_v = single.choose(v + p.times(m), end_v);
            end_w = single.select(w + i * pair(chunk, &point.r_x, &point.r_y).cross(p), end_w);
        }
        if self.counts[1] {
            let [p1, p2] = &mut self.points;
            let old = pair(chunk, &p1.normal_impulse, &p2.normal_impulse);
            let vn1 = p1.relative(chunk, v, w).dot(normal);
            let vn2 = p2.relative(chunk, v, w).dot(normal);
            let (k11, k12, k22) = (
                chunk.load(&self.rows.k11),
                chunk.load(&self.rows.k12),
                chunk.load(&self.rows.k22),
            );
            let k_old = Pair {
                x: k11 * old.x + k12 * old.y,
                y: k12 * old.x + k22 * old.y,
            };
            let b = Pair {
                x: vn1 - chunk.load(&p1.bias),
                y: vn2 - chunk.load(&p2.bias),
            } - k_old;
            let masses = (chunk.load(&p1.normal_mass), chunk.load(&p2.normal_mass));
            let (x, solved) = self.rows.solve_block(chunk, masses, b);
            let active = two & solved;
            let d = x - old;
            let (impulse1, impulse2) = (normal.times(d.x), normal.times(d.y));
            let (r1, r2) = (pair(chunk, &p1.r_x, &p1.r_y), pair(chunk, &p2.r_x, &p2.r_y));
            p1.normal_impulse.set(chunk, active, x.x);
            p2.normal_impulse.set(chunk, active, x.y);
            end_v = active.choose(v + (impulse1 + impulse2).times(m), end_v);
            end_w = active.select(w + i * (r1.cross(impulse1) + r2.cross(impulse2)), end_w);
        }
        bodies.store(chunk, body, end_v, end_w);
    }
}

#[inline(always)]
fn pair<S: Simd, const R: usize>(chunk: Chunk<S, R>, x: &PerWorld, y: &PerWorld) -> Pair<S, R> {
    Pair {
        x: chunk.load(x),
        y: chunk.load(y),
    }
}

impl PerWorld {
    /// Sets the lanes in `mask` to `x`.
    #[inline(always)]
    fn set<S: Simd, const R: usize>(
        &mut self,
        chunk: Chunk<S, R>,
        mask: Mask<S, R>,
        x: Wide<S, R>,
    ) {
        chunk.store(self, mask.select(x, chunk.load(self)));
    }
}

impl PointRows {
    /// Returns the dynamic body's velocity at the point, relative to the static body.
    #[inline(always)]
    fn relative<S: Simd, const R: usize>(
        &self,
        chunk: Chunk<S, R>,
        v: Pair<S, R>,
        w: Wide<S, R>,
    ) -> Pair<S, R> {
        v + pair(chunk, &self.r_x, &self.r_y).turned_by(w)
            - pair(chunk, &self.static_x, &self.static_y)
    }
}

impl ContactRows {
    /// Tries the four cases of [`solve_block`](super::solve_block) in each lane. The mask selects
    /// the lanes that have a solution.
    #[inline(always)]
    fn solve_block<S: Simd, const R: usize>(
        &self,
        chunk: Chunk<S, R>,
        (mass1, mass2): (Wide<S, R>, Wide<S, R>),
        b: Pair<S, R>,
    ) -> (Pair<S, R>, Mask<S, R>) {
        let zero = chunk.same(0.0);
        let k12 = chunk.load(&self.k12);
        let (i11, i12, i22) = (
            chunk.load(&self.inverse11),
            chunk.load(&self.inverse12),
            chunk.load(&self.inverse22),
        );
        let both = -Pair {
            x: i11 * b.x + i12 * b.y,
            y: i12 * b.x + i22 * b.y,
        };
        let first = Pair {
            x: -mass1 * b.x,
            y: zero,
        };
        let second = Pair {
            x: zero,
            y: -mass2 * b.y,
        };
        let is_both = both.x.ge(zero) & both.y.ge(zero);
        let is_first = first.x.ge(zero) & (k12 * first.x + b.y).ge(zero);
        let is_second = second.y.ge(zero) & (k12 * second.y + b.x).ge(zero);
        let is_neither = b.x.ge(zero) & b.y.ge(zero);
        let x = is_second.choose(second, Pair { x: zero, y: zero });
        let x = is_both.choose(both, is_first.choose(first, x));
        (x, is_both | is_first | is_second | is_neither)
    }
}

impl Constraint {
    /// Returns the second body's index in the island.
    pub(in crate::physics::box2d) fn body_b(&self) -> usize {
        self.b.index
    }

    /// Returns the dynamic body's index in the island, if the first body is static and at rest.
    /// Bodies with indices from `dynamic` on are static.
    pub(in crate::physics::box2d) fn moving_body(
        &self,
        dynamic: usize,
        velocities: &[Velocity],
    ) -> Option<usize> {
        let still = velocities[self.a.index];
        let rests = [still.v.x, still.v.y, still.w].map(f32::to_bits) == [0; 3];
        let is_static =
            self.a.index >= dynamic && self.a.inv_mass == 0.0 && self.a.inv_inertia == 0.0;
        (is_static && rests && self.b.index < dynamic && self.count > 0).then_some(self.b.index)
    }
}
