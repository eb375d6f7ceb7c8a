//! One contact of many worlds at once, between a static and a moving body. Each operation is that
//! of [`Constraint::solve_velocity`]; branches become selects.
//!
//! The static body's velocity is 0, but its terms `0 × lever` are kept and subtracted: they decide
//! the sign of a zero.

use fearless_simd::Simd;

use super::{Constraint, Velocity, cross_scalar};
use crate::physics::box2d::lane_bodies::Bodies;
use crate::physics::box2d::wide::{Mask, Pair, Row, Strip, Wide, rows};

rows! {
    /// A contact point; `still` is the static body's term `0 × lever`.
    struct PointRows {
        r_x, r_y, still_x, still_y,
        normal_impulse, tangent_impulse, normal_mass, tangent_mass, bias,
    }
}

rows! {
    /// The data that the points share.
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
    /// Whether any lane has one point, and whether any lane has two.
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
                (&mut rows.still_x, still.x),
                (&mut rows.still_y, still.y),
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

    /// Makes one iteration of this contact, whose moving body is `body`.
    #[inline(always)]
    pub(in crate::physics::box2d) fn sweep<S: Simd, const R: usize>(
        &mut self,
        strip: Strip<S, R>,
        bodies: &mut Bodies,
        body: usize,
    ) {
        let (m, i) = bodies.masses(strip, body);
        let (before_v, before_w) = bodies.load(strip, body);
        let (mut v, mut w) = (before_v, before_w);
        let count = strip.load(&self.rows.count);
        let (one, two) = (strip.same(0.5).lt(count), strip.same(1.5).lt(count));
        let normal = pair(strip, &self.rows.normal_x, &self.rows.normal_y);
        let tangent = normal.cross_one();
        let friction = strip.load(&self.rows.friction);

        // masks keep the numbers of points that a lane does not have
        for k in 0..if self.counts[1] { 2 } else { 1 } {
            let (point, there) = (&mut self.points[k], if k == 0 { one } else { two });
            let vt = point.relative(strip, v, w).dot(tangent);
            let max = friction * strip.load(&point.normal_impulse);
            let old = strip.load(&point.tangent_impulse);
            let new = (old + strip.load(&point.tangent_mass) * -vt).clamp(-max, max);
            let p = tangent.times(new - old);
            point.tangent_impulse.set(strip, there, new);
            v = there.choose(v + p.times(m), v);
            w = there.select(w + i * pair(strip, &point.r_x, &point.r_y).cross(p), w);
        }

        let (mut end_v, mut end_w) = (v, w);
        if self.counts[0] {
            let single = one & !two;
            let point = &mut self.points[0];
            let vn = point.relative(strip, v, w).dot(normal);
            let lambda = -strip.load(&point.normal_mass) * (vn - strip.load(&point.bias));
            let old = strip.load(&point.normal_impulse);
            let new = (old + lambda).max(strip.same(0.0));
            let p = normal.times(new - old);
            point.normal_impulse.set(strip, single, new);
            end_v = single.choose(v + p.times(m), end_v);
            end_w = single.select(w + i * pair(strip, &point.r_x, &point.r_y).cross(p), end_w);
        }
        if self.counts[1] {
            let [p1, p2] = &mut self.points;
            let old = pair(strip, &p1.normal_impulse, &p2.normal_impulse);
            let vn1 = p1.relative(strip, v, w).dot(normal);
            let vn2 = p2.relative(strip, v, w).dot(normal);
            let (k11, k12, k22) = (
                strip.load(&self.rows.k11),
                strip.load(&self.rows.k12),
                strip.load(&self.rows.k22),
            );
            let k_old = Pair {
                x: k11 * old.x + k12 * old.y,
                y: k12 * old.x + k22 * old.y,
            };
            let b = Pair {
                x: vn1 - strip.load(&p1.bias),
                y: vn2 - strip.load(&p2.bias),
            } - k_old;
            let masses = (strip.load(&p1.normal_mass), strip.load(&p2.normal_mass));
            let (x, solved) = self.rows.solve_block(strip, masses, b);
            let there = two & solved;
            let d = x - old;
            let (impulse1, impulse2) = (normal.times(d.x), normal.times(d.y));
            let (r1, r2) = (pair(strip, &p1.r_x, &p1.r_y), pair(strip, &p2.r_x, &p2.r_y));
            p1.normal_impulse.set(strip, there, x.x);
            p2.normal_impulse.set(strip, there, x.y);
            end_v = there.choose(v + (impulse1 + impulse2).times(m), end_v);
            end_w = there.select(w + i * (r1.cross(impulse1) + r2.cross(impulse2)), end_w);
        }
        bodies.store(strip, body, end_v, end_w);
    }
}

#[inline(always)]
fn pair<S: Simd, const R: usize>(strip: Strip<S, R>, x: &Row, y: &Row) -> Pair<S, R> {
    Pair {
        x: strip.load(x),
        y: strip.load(y),
    }
}

impl Row {
    /// Sets the lanes of `mask` to `x`.
    #[inline(always)]
    fn set<S: Simd, const R: usize>(
        &mut self,
        strip: Strip<S, R>,
        mask: Mask<S, R>,
        x: Wide<S, R>,
    ) {
        strip.store(self, mask.select(x, strip.load(self)));
    }
}

impl PointRows {
    /// Returns the velocity of the moving body at the point, relative to the static body.
    #[inline(always)]
    fn relative<S: Simd, const R: usize>(
        &self,
        strip: Strip<S, R>,
        v: Pair<S, R>,
        w: Wide<S, R>,
    ) -> Pair<S, R> {
        v + pair(strip, &self.r_x, &self.r_y).turned_by(w)
            - pair(strip, &self.still_x, &self.still_y)
    }
}

impl ContactRows {
    /// Solves the four cases of [`solve_block`](super::solve_block); the mask tells which lanes
    /// have a solution.
    #[inline(always)]
    fn solve_block<S: Simd, const R: usize>(
        &self,
        strip: Strip<S, R>,
        (mass1, mass2): (Wide<S, R>, Wide<S, R>),
        b: Pair<S, R>,
    ) -> (Pair<S, R>, Mask<S, R>) {
        let zero = strip.same(0.0);
        let k12 = strip.load(&self.k12);
        let (i11, i12, i22) = (
            strip.load(&self.inverse11),
            strip.load(&self.inverse12),
            strip.load(&self.inverse22),
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

    /// Returns the moving body's index in the island, if the first body is static and at rest.
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
