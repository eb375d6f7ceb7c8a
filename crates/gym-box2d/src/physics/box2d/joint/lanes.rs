//! One revolute joint of many worlds at once. [`Constraint::solve_velocity`] makes the same
//! operations in the same order; masks replace its branches.

use fearless_simd::Simd;

use super::{Constraint, LimitState};
use crate::physics::box2d::lane_bodies::Bodies;
use crate::physics::box2d::wide::{Chunk, Mask, Pair, Wide, per_world};

per_world! {
    /// One joint, in all lanes.
    struct WideJoint {
        r_ax, r_ay, r_bx, r_by,
        exx, eyx, ezx, eyy, ezy, ezz,
        cross_x, cross_y, cross_z, // ey × ez
        det3, det2,
        motor_mass, motor_speed, max_motor_impulse,
        at_limit, // 1 at a limit, else 0
        sense, // the sign of a limit impulse that pushes; 0 if both signs are allowed
        impulse_x, impulse_y, impulse_z, motor_impulse,
    }
}

/// The changes of a joint's impulses, and the lanes whose joint is at a limit.
struct Limit<S: Simd, const R: usize> {
    at_limit: Mask<S, R>,
    /// The changes of the impulses of the point constraint (`p`) and of the limit (`z`).
    p: Pair<S, R>,
    z: Wide<S, R>,
}

impl WideJoint {
    /// Loads `c`, a joint with a motor, into `lane`.
    pub(in crate::physics::box2d) fn load(&mut self, lane: usize, c: &Constraint) {
        let (at_limit, sense) = match c.limit_state {
            LimitState::Inactive => (0.0, 0.0),
            LimitState::AtLower => (1.0, 1.0),
            LimitState::AtUpper => (1.0, -1.0),
            LimitState::Equal => (1.0, 0.0),
        };
        for (row, x) in [
            (&mut self.r_ax, c.r_a.x),
            (&mut self.r_ay, c.r_a.y),
            (&mut self.r_bx, c.r_b.x),
            (&mut self.r_by, c.r_b.y),
            (&mut self.exx, c.ex.x),
            (&mut self.eyx, c.ex.y),
            (&mut self.ezx, c.ex.z),
            (&mut self.eyy, c.ey.y),
            (&mut self.ezy, c.ey.z),
            (&mut self.ezz, c.ez.z),
            (&mut self.cross_x, c.ey_ez.x),
            (&mut self.cross_y, c.ey_ez.y),
            (&mut self.cross_z, c.ey_ez.z),
            (&mut self.det3, c.det3),
            (&mut self.det2, c.det2),
            (&mut self.motor_mass, c.motor_mass),
            (&mut self.motor_speed, c.motor_speed),
            (&mut self.max_motor_impulse, c.max_motor_impulse),
            (&mut self.at_limit, at_limit),
            (&mut self.sense, sense),
            (&mut self.impulse_x, c.impulse.x),
            (&mut self.impulse_y, c.impulse.y),
            (&mut self.impulse_z, c.impulse.z),
            (&mut self.motor_impulse, c.motor_impulse),
        ] {
            row.0[lane] = x;
        }
    }

    /// Writes the impulses of `lane` back to `c`.
    pub(in crate::physics::box2d) fn collect(&self, lane: usize, c: &mut Constraint) {
        c.impulse.x = self.impulse_x.0[lane];
        c.impulse.y = self.impulse_y.0[lane];
        c.impulse.z = self.impulse_z.0[lane];
        c.motor_impulse = self.motor_impulse.0[lane];
    }

    /// Makes one velocity iteration of the joint between bodies `a` and `b`.
    #[inline(always)]
    pub(in crate::physics::box2d) fn solve_velocity<S: Simd, const R: usize>(
        &mut self,
        chunk: Chunk<S, R>,
        bodies: &mut Bodies,
        (a, b): (usize, usize),
    ) {
        let ((m_a, i_a), (m_b, i_b)) = (bodies.masses(chunk, a), bodies.masses(chunk, b));
        let ((mut v_a, mut w_a), (mut v_b, mut w_b)) =
            (bodies.load(chunk, a), bodies.load(chunk, b));
        let (r_a, r_b) = (
            chunk.pair(&self.r_ax, &self.r_ay),
            chunk.pair(&self.r_bx, &self.r_by),
        );

        let cdot = w_b - w_a - chunk.load(&self.motor_speed);
        let old = chunk.load(&self.motor_impulse);
        let max = chunk.load(&self.max_motor_impulse);
        let new = (old + -chunk.load(&self.motor_mass) * cdot).clamp(-max, max);
        chunk.store(&mut self.motor_impulse, new);
        let applied = new - old;
        w_a = w_a - i_a * applied;
        w_b = w_b + i_b * applied;

        let cdot = v_b + r_b.turned_by(w_b) - v_a - r_a.turned_by(w_a);
        let at_limit = chunk.same(0.0).lt(chunk.load(&self.at_limit));
        let Limit { at_limit, p, z } = if at_limit.any() {
            self.solve_limit(chunk, at_limit, cdot, w_b - w_a)
        } else {
            // -0 changes no sum, not even the sign of a zero
            Limit {
                at_limit,
                p: self.solve22(chunk, -cdot),
                z: chunk.same(-0.0),
            }
        };
        let impulse = chunk.pair(&self.impulse_x, &self.impulse_y) + p;
        chunk.store(&mut self.impulse_x, impulse.x);
        chunk.store(&mut self.impulse_y, impulse.y);
        let impulse_z = chunk.load(&self.impulse_z);
        chunk.store(
            &mut self.impulse_z,
            at_limit.select(impulse_z + z, impulse_z),
        );
        v_a = v_a - p.times(m_a);
        w_a = w_a - i_a * (r_a.cross(p) + z);
        v_b = v_b + p.times(m_b);
        w_b = w_b + i_b * (r_b.cross(p) + z);
        bodies.store(chunk, a, v_a, w_a);
        bodies.store(chunk, b, v_b, w_b);
    }

    /// Solves the point constraint: in the lanes of `at_limit` together with the limit.
    #[inline(always)]
    fn solve_limit<S: Simd, const R: usize>(
        &self,
        chunk: Chunk<S, R>,
        at_limit: Mask<S, R>,
        cdot: Pair<S, R>,
        cdot_angle: Wide<S, R>,
    ) -> Limit<S, R> {
        let zero = chunk.same(0.0);
        let impulse_z = chunk.load(&self.impulse_z);
        let (full, full_z) = self.solve33(chunk, cdot, cdot_angle);
        let (full, full_z) = (-full, -full_z);
        // a limit only pushes: where the limit would pull, solve the point constraint alone
        let pulls = (chunk.load(&self.sense) * (impulse_z + full_z)).lt(zero);
        let ez = chunk.pair(&self.ezx, &self.ezy);
        let right = pulls.choose(-cdot + ez.times(impulse_z), -cdot);
        let p = (at_limit & !pulls).choose(full, self.solve22(chunk, right));
        let z = at_limit.select(pulls.select(-impulse_z, full_z), chunk.same(-0.0));
        Limit { at_limit, p, z }
    }

    #[inline(always)]
    fn solve22<S: Simd, const R: usize>(&self, chunk: Chunk<S, R>, b: Pair<S, R>) -> Pair<S, R> {
        let (exx, eyx, eyy) = (
            chunk.load(&self.exx),
            chunk.load(&self.eyx),
            chunk.load(&self.eyy),
        );
        let det = chunk.load(&self.det2);
        Pair {
            x: det * (eyy * b.x - eyx * b.y),
            y: det * (exx * b.y - eyx * b.x),
        }
    }

    #[inline(always)]
    fn solve33<S: Simd, const R: usize>(
        &self,
        chunk: Chunk<S, R>,
        b: Pair<S, R>,
        bz: Wide<S, R>,
    ) -> (Pair<S, R>, Wide<S, R>) {
        let (exx, eyx, ezx) = (
            chunk.load(&self.exx),
            chunk.load(&self.eyx),
            chunk.load(&self.ezx),
        );
        let (eyy, ezy, ezz) = (
            chunk.load(&self.eyy),
            chunk.load(&self.ezy),
            chunk.load(&self.ezz),
        );
        let det = chunk.load(&self.det3);
        let (cross_x, cross_y) = (chunk.load(&self.cross_x), chunk.load(&self.cross_y));
        let x = det * (b.x * cross_x + b.y * cross_y + bz * chunk.load(&self.cross_z));
        let b_ez = (
            b.y * ezz - bz * ezy,
            bz * ezx - b.x * ezz,
            b.x * ezy - b.y * ezx,
        );
        let y = det * (exx * b_ez.0 + eyx * b_ez.1 + ezx * b_ez.2);
        let ey_b = (
            eyy * bz - ezy * b.y,
            ezy * b.x - eyx * bz,
            eyx * b.y - eyy * b.x,
        );
        let z = det * (exx * ey_b.0 + eyx * ey_b.1 + ezx * ey_b.2);
        (Pair { x, y }, z)
    }
}

impl Constraint {
    /// Returns the indices of both bodies in the island, if the joint has a motor.
    pub(in crate::physics::box2d) fn driven_ends(&self) -> Option<(usize, usize)> {
        self.motor.then_some((self.a.index, self.b.index))
    }
}
