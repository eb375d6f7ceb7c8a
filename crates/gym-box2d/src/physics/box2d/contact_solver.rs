//! Sequential impulses at contacts: friction, then a block solver for the normal impulses of two
//! points at once (`b2ContactSolver.cpp`).

#[cfg_attr(not(feature = "native-vectors"), allow(dead_code, unused_imports))]
pub(super) mod lanes;

use super::contact::Contact;
use super::manifold::{Kind, Manifold};
use super::math::{
    Pose, Vec2, clamp, cross, cross_one, cross_scalar, dot, max, min, normalize, pose_about,
    reciprocal, rotate, transform, vec2,
};
use super::motion::{Position, Side, Velocity};
use super::settings::{
    BAUMGARTE, LINEAR_SLOP, MAX_LINEAR_CORRECTION, TOI_BAUMGARTE, VELOCITY_THRESHOLD,
};

#[derive(Clone, Copy, Debug, Default)]
struct Point {
    r_a: Vec2,
    r_b: Vec2,
    normal_impulse: f32,
    tangent_impulse: f32,
    normal_mass: f32,
    tangent_mass: f32,
    velocity_bias: f32,
}

/// A symmetric 2x2 matrix or its inverse, by columns.
#[derive(Clone, Copy, Debug, Default)]
struct Mat22 {
    ex: Vec2,
    ey: Vec2,
}

impl Mat22 {
    #[inline]
    fn mul(&self, v: Vec2) -> Vec2 {
        vec2(
            self.ex.x * v.x + self.ey.x * v.y,
            self.ex.y * v.x + self.ey.y * v.y,
        )
    }

    fn inverse(&self) -> Self {
        let (a, b, c, d) = (self.ex.x, self.ey.x, self.ex.y, self.ey.y);
        let det = reciprocal(a * d - b * c);
        Self {
            ex: vec2(det * d, -det * c),
            ey: vec2(-det * b, det * a),
        }
    }
}

/// A contact while the solver works on its island.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constraint {
    /// Index in `Box2d::contacts`.
    pub(crate) contact: usize,
    a: Side,
    b: Side,
    friction: f32,
    restitution: f32,
    manifold: Manifold,
    normal: Vec2,
    points: [Point; 2],
    /// The number of points that the velocity solver uses.
    count: usize,
    k: Mat22,
    normal_mass: Mat22,
}

impl Constraint {
    /// Makes the constraint of `contact`. The impulses start at `ratio` times the last step's
    /// impulses; without `ratio`, at 0.
    pub(crate) fn new(
        index: usize,
        contact: &Contact,
        a: Side,
        b: Side,
        ratio: Option<f32>,
    ) -> Self {
        let mut points = [Point::default(); 2];
        if let Some(ratio) = ratio {
            for (point, old) in points.iter_mut().zip(contact.manifold.points()) {
                point.normal_impulse = ratio * old.normal_impulse;
                point.tangent_impulse = ratio * old.tangent_impulse;
            }
        }
        Self {
            contact: index,
            a,
            b,
            friction: contact.friction,
            restitution: contact.restitution,
            manifold: contact.manifold,
            normal: Vec2::zeros(),
            points,
            count: contact.manifold.points().len(),
            k: Mat22::default(),
            normal_mass: Mat22::default(),
        }
    }

    /// Computes the normal, the lever arms and the effective masses at `positions`.
    pub(crate) fn initialize(&mut self, positions: &[Position], velocities: &[Velocity]) {
        let (a, b) = (self.a, self.b);
        let (m_a, i_a, m_b, i_b) = (a.inv_mass, a.inv_inertia, b.inv_mass, b.inv_inertia);
        let (at_a, at_b) = (positions[a.index], positions[b.index]);
        let (vel_a, vel_b) = (velocities[a.index], velocities[b.index]);
        let xf_a = pose_about(at_a.c, at_a.a, a.local_center);
        let xf_b = pose_about(at_b.c, at_b.a, b.local_center);
        let (normal, world) = self.manifold.world(&xf_a, a.radius, &xf_b, b.radius);
        self.normal = normal;
        let tangent = cross_one(normal);
        for (point, world) in self.points[..self.count].iter_mut().zip(world) {
            point.r_a = world - at_a.c;
            point.r_b = world - at_b.c;
            let mass = |direction| {
                let (ra, rb) = (cross(point.r_a, direction), cross(point.r_b, direction));
                let k = m_a + m_b + i_a * ra * ra + i_b * rb * rb;
                if k > 0.0 { 1.0 / k } else { 0.0 }
            };
            point.normal_mass = mass(normal);
            point.tangent_mass = mass(tangent);
            let approach = dot(
                normal,
                vel_b.v + cross_scalar(vel_b.w, point.r_b)
                    - vel_a.v
                    - cross_scalar(vel_a.w, point.r_a),
            );
            point.velocity_bias = if approach < -VELOCITY_THRESHOLD {
                -self.restitution * approach
            } else {
                0.0
            };
        }
        if self.count == 2 {
            self.prepare_block();
        }
    }

    /// Computes the matrix of the block solver. If it is ill-conditioned (the points nearly
    /// coincide), the solver uses one point.
    fn prepare_block(&mut self) {
        const MAX_CONDITION_NUMBER: f32 = 1000.0;
        let (a, b, [p1, p2]) = (self.a, self.b, &self.points);
        let (m_a, i_a, m_b, i_b) = (a.inv_mass, a.inv_inertia, b.inv_mass, b.inv_inertia);
        let (rn1_a, rn1_b) = (cross(p1.r_a, self.normal), cross(p1.r_b, self.normal));
        let (rn2_a, rn2_b) = (cross(p2.r_a, self.normal), cross(p2.r_b, self.normal));
        let k11 = m_a + m_b + i_a * rn1_a * rn1_a + i_b * rn1_b * rn1_b;
        let k22 = m_a + m_b + i_a * rn2_a * rn2_a + i_b * rn2_b * rn2_b;
        let k12 = m_a + m_b + i_a * rn1_a * rn2_a + i_b * rn1_b * rn2_b;
        if k11 * k11 < MAX_CONDITION_NUMBER * (k11 * k22 - k12 * k12) {
            self.k = Mat22 {
                ex: vec2(k11, k12),
                ey: vec2(k12, k22),
            };
            self.normal_mass = self.k.inverse();
        } else {
            self.count = 1;
        }
    }

    /// Applies the initial impulses to the velocities.
    pub(crate) fn warm_start(&self, velocities: &mut [Velocity]) {
        let (mut vel_a, mut vel_b) = (velocities[self.a.index], velocities[self.b.index]);
        let tangent = cross_one(self.normal);
        for point in &self.points[..self.count] {
            let p = point.normal_impulse * self.normal + point.tangent_impulse * tangent;
            vel_a.w -= self.a.inv_inertia * cross(point.r_a, p);
            vel_a.v -= self.a.inv_mass * p;
            vel_b.w += self.b.inv_inertia * cross(point.r_b, p);
            vel_b.v += self.b.inv_mass * p;
        }
        velocities[self.a.index] = vel_a;
        velocities[self.b.index] = vel_b;
    }

    /// Makes one velocity iteration. Friction comes first, because Box2D solves non-penetration,
    /// which is more important, last.
    #[inline]
    pub(crate) fn solve_velocity(&mut self, velocities: &mut [Velocity]) {
        let (mut vel_a, mut vel_b) = (velocities[self.a.index], velocities[self.b.index]);
        let (m_a, i_a) = (self.a.inv_mass, self.a.inv_inertia);
        let (m_b, i_b) = (self.b.inv_mass, self.b.inv_inertia);
        let normal = self.normal;
        let tangent = cross_one(normal);
        let relative = |point: &Point, vel_a: &Velocity, vel_b: &Velocity| {
            vel_b.v + cross_scalar(vel_b.w, point.r_b) - vel_a.v - cross_scalar(vel_a.w, point.r_a)
        };

        for point in &mut self.points[..self.count] {
            let vt = dot(relative(point, &vel_a, &vel_b), tangent);
            let max_friction = self.friction * point.normal_impulse;
            let new = clamp(
                point.tangent_impulse + point.tangent_mass * -vt,
                -max_friction,
                max_friction,
            );
            let p = (new - point.tangent_impulse) * tangent;
            point.tangent_impulse = new;
            vel_a.v -= m_a * p;
            vel_a.w -= i_a * cross(point.r_a, p);
            vel_b.v += m_b * p;
            vel_b.w += i_b * cross(point.r_b, p);
        }

        if self.count == 1 {
            let point = &mut self.points[0];
            let vn = dot(relative(point, &vel_a, &vel_b), normal);
            let lambda = -point.normal_mass * (vn - point.velocity_bias);
            let new = max(point.normal_impulse + lambda, 0.0);
            let p = (new - point.normal_impulse) * normal;
            point.normal_impulse = new;
            vel_a.v -= m_a * p;
            vel_a.w -= i_a * cross(point.r_a, p);
            vel_b.v += m_b * p;
            vel_b.w += i_b * cross(point.r_b, p);
        } else {
            let [p1, p2] = &mut self.points;
            let old = vec2(p1.normal_impulse, p2.normal_impulse);
            let vn1 = dot(relative(p1, &vel_a, &vel_b), normal);
            let vn2 = dot(relative(p2, &vel_a, &vel_b), normal);
            let b = vec2(vn1 - p1.velocity_bias, vn2 - p2.velocity_bias) - self.k.mul(old);
            if let Some(x) = solve_block(
                &self.k,
                &self.normal_mass,
                p1.normal_mass,
                p2.normal_mass,
                b,
            ) {
                let d = x - old;
                let (impulse1, impulse2) = (d.x * normal, d.y * normal);
                vel_a.v -= m_a * (impulse1 + impulse2);
                vel_a.w -= i_a * (cross(p1.r_a, impulse1) + cross(p2.r_a, impulse2));
                vel_b.v += m_b * (impulse1 + impulse2);
                vel_b.w += i_b * (cross(p1.r_b, impulse1) + cross(p2.r_b, impulse2));
                p1.normal_impulse = x.x;
                p2.normal_impulse = x.y;
            }
        }
        velocities[self.a.index] = vel_a;
        velocities[self.b.index] = vel_b;
    }

    /// Returns the normal and the tangent impulse of each point.
    #[inline]
    pub(crate) fn impulses(&self) -> [f32; 4] {
        let [p1, p2] = &self.points;
        [
            p1.normal_impulse,
            p1.tangent_impulse,
            p2.normal_impulse,
            p2.tangent_impulse,
        ]
    }

    /// Sets the impulses, in the order of [`impulses`](Self::impulses).
    pub(crate) fn set_impulses(&mut self, impulses: &[f32; 4]) {
        let [p1, p2] = &mut self.points;
        [
            p1.normal_impulse,
            p1.tangent_impulse,
            p2.normal_impulse,
            p2.tangent_impulse,
        ] = *impulses;
    }

    /// Stores the impulses in `manifold`, for the next step.
    pub(crate) fn store_impulses(&self, manifold: &mut Manifold) {
        for (to, from) in manifold
            .points_mut()
            .iter_mut()
            .zip(&self.points[..self.count])
        {
            to.normal_impulse = from.normal_impulse;
            to.tangent_impulse = from.tangent_impulse;
        }
    }

    /// Makes one position iteration: pushes overlapping bodies apart. Returns the smallest
    /// separation.
    pub(crate) fn solve_position(&self, positions: &mut [Position]) -> f32 {
        self.push_apart(positions, BAUMGARTE, [true; 2])
    }

    /// Like [`solve_position`](Self::solve_position), at a time of impact. Only the two bodies
    /// `movable` move.
    pub(crate) fn solve_toi_position(
        &self,
        positions: &mut [Position],
        movable: [usize; 2],
    ) -> f32 {
        let moves = [&self.a, &self.b].map(|side| movable.contains(&side.index));
        self.push_apart(positions, TOI_BAUMGARTE, moves)
    }

    fn push_apart(&self, positions: &mut [Position], baumgarte: f32, moves: [bool; 2]) -> f32 {
        let [(m_a, i_a), (m_b, i_b)] =
            [(&self.a, moves[0]), (&self.b, moves[1])].map(|(side, moves)| {
                if moves {
                    (side.inv_mass, side.inv_inertia)
                } else {
                    (0.0, 0.0)
                }
            });
        let (mut a, mut b) = (positions[self.a.index], positions[self.b.index]);
        let mut min_separation = 0.0;
        for i in 0..self.manifold.points().len() {
            let (normal, point, separation) = self.separation(i, &a, &b);
            let (r_a, r_b) = (point - a.c, point - b.c);
            min_separation = min(min_separation, separation);
            let c = clamp(
                baumgarte * (separation + LINEAR_SLOP),
                -MAX_LINEAR_CORRECTION,
                0.0,
            );
            let (rn_a, rn_b) = (cross(r_a, normal), cross(r_b, normal));
            let k = m_a + m_b + i_a * rn_a * rn_a + i_b * rn_b * rn_b;
            let impulse = if k > 0.0 { -c / k } else { 0.0 };
            let p = impulse * normal;
            a.c -= m_a * p;
            a.a -= i_a * cross(r_a, p);
            b.c += m_b * p;
            b.a += i_b * cross(r_b, p);
        }
        positions[self.a.index] = a;
        positions[self.b.index] = b;
        min_separation
    }

    /// Returns the normal, the location and the separation of point `index` of the manifold at
    /// positions `a` and `b`.
    fn separation(&self, index: usize, a: &Position, b: &Position) -> (Vec2, Vec2, f32) {
        let xf_a = pose_about(a.c, a.a, self.a.local_center);
        let xf_b = pose_about(b.c, b.a, self.b.local_center);
        let Manifold {
            kind,
            local_normal,
            local_point,
            ..
        } = self.manifold;
        let point = self.manifold.points()[index].local_point;
        let face = |xf_face: &Pose, xf_point: &Pose| {
            let normal = rotate(xf_face.rotation, local_normal);
            let plane = transform(xf_face, local_point);
            let clip = transform(xf_point, point);
            (
                normal,
                clip,
                dot(clip - plane, normal) - self.a.radius - self.b.radius,
            )
        };
        match kind {
            Kind::Circles => {
                let point_a = transform(&xf_a, local_point);
                let point_b = transform(&xf_b, point);
                let normal = normalize(point_b - point_a).0;
                let separation = dot(point_b - point_a, normal) - self.a.radius - self.b.radius;
                (normal, 0.5 * (point_a + point_b), separation)
            }
            Kind::FaceA => face(&xf_a, &xf_b),
            Kind::FaceB => {
                let (normal, clip, separation) = face(&xf_b, &xf_a);
                (-normal, clip, separation)
            }
        }
    }
}

/// Solves the linear complementarity problem of two points by enumeration: impulses `x >= 0` and
/// normal velocities `k x + b >= 0`, where at each point one of the two is 0.
#[inline]
fn solve_block(k: &Mat22, inverse: &Mat22, mass1: f32, mass2: f32, b: Vec2) -> Option<Vec2> {
    let x = -inverse.mul(b);
    if x.x >= 0.0 && x.y >= 0.0 {
        return Some(x); // both points push
    }
    let x = vec2(-mass1 * b.x, 0.0);
    if x.x >= 0.0 && k.ex.y * x.x + b.y >= 0.0 {
        return Some(x); // only the first point pushes
    }
    let x = vec2(0.0, -mass2 * b.y);
    if x.y >= 0.0 && k.ey.x * x.y + b.x >= 0.0 {
        return Some(x); // only the second point pushes
    }
    (b.x >= 0.0 && b.y >= 0.0).then(Vec2::zeros) // no point pushes; `None` without a solution
}
