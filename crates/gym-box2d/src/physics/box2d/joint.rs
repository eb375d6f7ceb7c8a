//! The revolute joint: two bodies rotate about a common point, with a motor and angle limits
//! (`b2RevoluteJoint.cpp`).

#[cfg_attr(not(feature = "native-vectors"), allow(dead_code, unused_imports))]
pub(super) mod lanes;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::math::{
    Vec2, clamp, cross, cross_scalar, cross3, dot3, length, reciprocal, rotate, rotation, vec2,
};
use super::motion::{Position, Side, Velocity};
use super::settings::{ANGULAR_SLOP, LINEAR_SLOP, MAX_ANGULAR_CORRECTION};

/// The position of the joint angle relative to its limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum LimitState {
    #[default]
    Inactive,
    AtLower,
    AtUpper,
    /// Both limits are nearly equal, so the angle is fixed.
    Equal,
}

/// A joint of the world.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Joint {
    pub(crate) body_a: u32,
    pub(crate) body_b: u32,
    pub(crate) local_anchor_a: Vec2,
    pub(crate) local_anchor_b: Vec2,
    pub(crate) reference_angle: f32,
    /// The lower and the upper limit of the angle.
    #[serde(deserialize_with = "Option::deserialize")]
    pub(crate) limits: Option<(f32, f32)>,
    pub(crate) motor: bool,
    pub(crate) motor_speed: f32,
    pub(crate) max_motor_torque: f32,
    pub(crate) collide_connected: bool,
    /// The last step's impulses: `x` and `y` of the point constraint, `z` of the limit.
    pub(crate) impulse: Vector3<f32>,
    pub(crate) motor_impulse: f32,
    pub(crate) limit_state: LimitState,
    pub(crate) island: bool,
}

impl Joint {
    /// Returns the other body, if the joint is attached to `body`.
    pub(crate) fn other(&self, body: u32) -> Option<u32> {
        if self.body_a == body {
            Some(self.body_b)
        } else if self.body_b == body {
            Some(self.body_a)
        } else {
            None
        }
    }
}

/// The changes of a joint's impulses in one velocity iteration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Increment {
    /// The change of the motor's impulse, before and after clamping.
    motor: f32,
    motor_applied: f32,
    /// The changes of the impulses of the point constraint (`x`, `y`) and of the limit (`z`).
    impulse: Vector3<f32>,
    /// Whether the limit was inactive because its impulse would have pulled, and the limit's
    /// impulse before this iteration.
    limit_pulls: bool,
    limit_before: f32,
}

impl Default for Increment {
    fn default() -> Self {
        Self {
            motor: 0.0,
            motor_applied: 0.0,
            impulse: Vector3::new(0.0, 0.0, 0.0),
            limit_pulls: false,
            limit_before: 0.0,
        }
    }
}

/// A joint while the solver works on its island.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constraint {
    /// Index in `Box2d::joints`.
    pub(crate) joint: u32,
    a: Side,
    b: Side,
    /// Anchors relative to the centres of mass, in the bodies' coordinates.
    anchor_a: Vec2,
    anchor_b: Vec2,
    r_a: Vec2,
    r_b: Vec2,
    /// Columns of the inverse effective mass.
    ex: Vector3<f32>,
    ey: Vector3<f32>,
    ez: Vector3<f32>,
    /// ey × ez.
    ey_ez: Vector3<f32>,
    /// Reciprocal determinants of the 3x3 matrix and of its upper left 2x2 block.
    det3: f32,
    det2: f32,
    motor_mass: f32,
    motor: bool,
    motor_speed: f32,
    max_motor_impulse: f32,
    reference_angle: f32,
    limits: Option<(f32, f32)>,
    pub(crate) impulse: Vector3<f32>,
    pub(crate) motor_impulse: f32,
    pub(crate) limit_state: LimitState,
}

impl Constraint {
    /// Makes the constraint of `joint` at `positions`. Applies the last step's impulses, scaled by
    /// `ratio`, to `velocities`.
    pub(crate) fn new(
        index: u32,
        joint: &Joint,
        (a, b): (Side, Side),
        positions: &[Position],
        velocities: &mut [Velocity],
        (dt, ratio): (f32, f32),
    ) -> Self {
        let (angle_a, angle_b) = (positions[a.index].a, positions[b.index].a);
        let (m_a, i_a, m_b, i_b) = (a.inv_mass, a.inv_inertia, b.inv_mass, b.inv_inertia);
        let anchor_a = joint.local_anchor_a - a.local_center;
        let anchor_b = joint.local_anchor_b - b.local_center;
        let r_a = rotate(rotation(angle_a), anchor_a);
        let r_b = rotate(rotation(angle_b), anchor_b);

        let exx = m_a + m_b + r_a.y * r_a.y * i_a + r_b.y * r_b.y * i_b;
        let eyx = -r_a.y * r_a.x * i_a - r_b.y * r_b.x * i_b;
        let ezx = -r_a.y * i_a - r_b.y * i_b;
        let eyy = m_a + m_b + r_a.x * r_a.x * i_a + r_b.x * r_b.x * i_b;
        let ezy = r_a.x * i_a + r_b.x * i_b;
        let ezz = i_a + i_b;
        let (ex, ey, ez) = (
            Vector3::new(exx, eyx, ezx),
            Vector3::new(eyx, eyy, ezy),
            Vector3::new(ezx, ezy, ezz),
        );
        let ey_ez = cross3(ey, ez);
        let fixed_rotation = ezz == 0.0;

        let mut joint_motor_impulse = joint.motor_impulse;
        if !joint.motor || fixed_rotation {
            joint_motor_impulse = 0.0;
        }
        let mut impulse = joint.impulse;
        let limits = joint.limits.filter(|_| !fixed_rotation);
        let limit_state = match limits {
            None => LimitState::Inactive,
            Some((lower, upper)) => {
                let angle = angle_b - angle_a - joint.reference_angle;
                let state = if (upper - lower).abs() < 2.0 * ANGULAR_SLOP {
                    LimitState::Equal
                } else if angle <= lower {
                    LimitState::AtLower
                } else if angle >= upper {
                    LimitState::AtUpper
                } else {
                    LimitState::Inactive
                };
                if state == LimitState::Inactive
                    || (state != LimitState::Equal && state != joint.limit_state)
                {
                    impulse.z = 0.0;
                }
                state
            }
        };

        impulse *= ratio;
        let motor_impulse = joint_motor_impulse * ratio;
        let constraint = Self {
            joint: index,
            a,
            b,
            anchor_a,
            anchor_b,
            r_a,
            r_b,
            ex,
            ey,
            ez,
            ey_ez,
            det3: reciprocal(dot3(ex, ey_ez)),
            det2: reciprocal(exx * eyy - eyx * eyx),
            motor_mass: if ezz > 0.0 { 1.0 / ezz } else { ezz },
            motor: joint.motor && limit_state != LimitState::Equal && !fixed_rotation,
            motor_speed: joint.motor_speed,
            max_motor_impulse: dt * joint.max_motor_torque,
            reference_angle: joint.reference_angle,
            limits,
            impulse,
            motor_impulse,
            limit_state,
        };
        let (mut vel_a, mut vel_b) = (velocities[a.index], velocities[b.index]);
        let p = vec2(impulse.x, impulse.y);
        vel_a.v -= m_a * p;
        vel_a.w -= i_a * (cross(r_a, p) + motor_impulse + impulse.z);
        vel_b.v += m_b * p;
        vel_b.w += i_b * (cross(r_b, p) + motor_impulse + impulse.z);
        velocities[a.index] = vel_a;
        velocities[b.index] = vel_b;
        constraint
    }

    /// Makes one velocity iteration: the motor, then the point constraint, together with an active
    /// limit.
    #[inline]
    pub(crate) fn solve_velocity(&mut self, velocities: &mut [Velocity]) -> Increment {
        let (mut vel_a, mut vel_b) = (velocities[self.a.index], velocities[self.b.index]);
        let (m_a, i_a) = (self.a.inv_mass, self.a.inv_inertia);
        let (m_b, i_b) = (self.b.inv_mass, self.b.inv_inertia);
        let mut increment = Increment::default();

        if self.motor {
            let cdot = vel_b.w - vel_a.w - self.motor_speed;
            increment.motor = -self.motor_mass * cdot;
            let old = self.motor_impulse;
            self.motor_impulse = self.clamp_motor(old + increment.motor);
            increment.motor_applied = self.motor_impulse - old;
            vel_a.w -= i_a * increment.motor_applied;
            vel_b.w += i_b * increment.motor_applied;
        }

        let cdot =
            vel_b.v + cross_scalar(vel_b.w, self.r_b) - vel_a.v - cross_scalar(vel_a.w, self.r_a);
        if self.limit_state == LimitState::Inactive {
            let p = self.solve22(-cdot);
            increment.impulse = Vector3::new(p.x, p.y, 0.0);
            self.impulse.x += p.x;
            self.impulse.y += p.y;
            vel_a.v -= m_a * p;
            vel_a.w -= i_a * cross(self.r_a, p);
            vel_b.v += m_b * p;
            vel_b.w += i_b * cross(self.r_b, p);
        } else {
            let cdot_angle = vel_b.w - vel_a.w;
            let mut impulse = -self.solve33(Vector3::new(cdot.x, cdot.y, cdot_angle));
            increment.limit_before = self.impulse.z;
            increment.limit_pulls = self.limit_pulls(self.impulse.z + impulse.z);
            if increment.limit_pulls {
                // the limit would pull: solve the point constraint alone
                let reduced = self.solve22(-cdot + self.impulse.z * vec2(self.ez.x, self.ez.y));
                impulse = Vector3::new(reduced.x, reduced.y, -self.impulse.z);
                self.impulse =
                    Vector3::new(self.impulse.x + reduced.x, self.impulse.y + reduced.y, 0.0);
            } else {
                self.impulse += impulse;
            }
            increment.impulse = impulse;
            let p = vec2(impulse.x, impulse.y);
            vel_a.v -= m_a * p;
            vel_a.w -= i_a * (cross(self.r_a, p) + impulse.z);
            vel_b.v += m_b * p;
            vel_b.w += i_b * (cross(self.r_b, p) + impulse.z);
        }
        velocities[self.a.index] = vel_a;
        velocities[self.b.index] = vel_b;
        increment
    }

    #[inline]
    fn clamp_motor(&self, impulse: f32) -> f32 {
        clamp(impulse, -self.max_motor_impulse, self.max_motor_impulse)
    }

    /// Whether the accumulated limit impulse `impulse` would pull instead of push.
    #[inline]
    fn limit_pulls(&self, impulse: f32) -> bool {
        match self.limit_state {
            LimitState::AtLower => impulse < 0.0,
            LimitState::AtUpper => impulse > 0.0,
            LimitState::Equal | LimitState::Inactive => false,
        }
    }

    /// Whether an iteration from the same velocities changes the impulses by `increment` again.
    #[inline]
    pub(crate) fn repeats(&self, increment: &Increment) -> bool {
        let motor = self.clamp_motor(self.motor_impulse + increment.motor) - self.motor_impulse;
        let limit = if increment.limit_pulls {
            self.impulse.z.to_bits() == increment.limit_before.to_bits()
        } else {
            !self.limit_pulls(self.impulse.z + increment.impulse.z)
        };
        limit && (!self.motor || motor.to_bits() == increment.motor_applied.to_bits())
    }

    /// Adds `increment` to the impulses, as an iteration does if [`repeats`](Self::repeats) is
    /// true. Returns whether an impulse changed.
    #[inline]
    pub(crate) fn repeat(&mut self, increment: &Increment) -> bool {
        let (motor_before, before) = (self.motor_impulse, self.impulse);
        if self.motor {
            self.motor_impulse = self.clamp_motor(self.motor_impulse + increment.motor);
        }
        self.impulse.x += increment.impulse.x;
        self.impulse.y += increment.impulse.y;
        if increment.limit_pulls {
            self.impulse.z = 0.0;
        } else if self.limit_state != LimitState::Inactive {
            self.impulse.z += increment.impulse.z;
        }
        let same = |a: f32, b: f32| a.to_bits() == b.to_bits();
        !(same(motor_before, self.motor_impulse)
            && same(before.x, self.impulse.x)
            && same(before.y, self.impulse.y)
            && same(before.z, self.impulse.z))
    }

    #[inline]
    fn solve22(&self, b: Vec2) -> Vec2 {
        let (ex, ey) = (self.ex, self.ey);
        vec2(
            self.det2 * (ey.y * b.x - ey.x * b.y),
            self.det2 * (ex.x * b.y - ex.y * b.x),
        )
    }

    #[inline]
    fn solve33(&self, b: Vector3<f32>) -> Vector3<f32> {
        Vector3::new(
            self.det3 * dot3(b, self.ey_ez),
            self.det3 * dot3(self.ex, cross3(b, self.ez)),
            self.det3 * dot3(self.ex, cross3(self.ey, b)),
        )
    }

    /// Makes one position iteration: corrects the angle at a limit, then the anchors. Returns
    /// whether both errors were within tolerance.
    pub(crate) fn solve_position(&self, positions: &mut [Position]) -> bool {
        let (mut a, mut b) = (positions[self.a.index], positions[self.b.index]);
        let (m_a, i_a) = (self.a.inv_mass, self.a.inv_inertia);
        let (m_b, i_b) = (self.b.inv_mass, self.b.inv_inertia);

        let mut angular_error = 0.0;
        if let Some((lower, upper)) = self.limits
            && self.limit_state != LimitState::Inactive
        {
            const MAX: f32 = MAX_ANGULAR_CORRECTION;
            let angle = b.a - a.a - self.reference_angle;
            let c = match self.limit_state {
                LimitState::AtLower => {
                    angular_error = -(angle - lower);
                    clamp(angle - lower + ANGULAR_SLOP, -MAX, 0.0)
                }
                LimitState::AtUpper => {
                    angular_error = angle - upper;
                    clamp(angle - upper - ANGULAR_SLOP, 0.0, MAX)
                }
                LimitState::Equal | LimitState::Inactive => {
                    let c = clamp(angle - lower, -MAX, MAX);
                    angular_error = c.abs();
                    c
                }
            };
            let impulse = -self.motor_mass * c;
            a.a -= i_a * impulse;
            b.a += i_b * impulse;
        }

        let r_a = rotate(rotation(a.a), self.anchor_a);
        let r_b = rotate(rotation(b.a), self.anchor_b);
        let c = b.c + r_b - a.c - r_a;
        let position_error = length(c);
        let k11 = m_a + m_b + i_a * r_a.y * r_a.y + i_b * r_b.y * r_b.y;
        let k12 = -i_a * r_a.x * r_a.y - i_b * r_b.x * r_b.y;
        let k22 = m_a + m_b + i_a * r_a.x * r_a.x + i_b * r_b.x * r_b.x;
        let det = reciprocal(k11 * k22 - k12 * k12);
        let impulse = -vec2(det * (k22 * c.x - k12 * c.y), det * (k11 * c.y - k12 * c.x));
        a.c -= m_a * impulse;
        a.a -= i_a * cross(r_a, impulse);
        b.c += m_b * impulse;
        b.a += i_b * cross(r_b, impulse);

        positions[self.a.index] = a;
        positions[self.b.index] = b;
        position_error <= LINEAR_SLOP && angular_error <= ANGULAR_SLOP
    }
}
