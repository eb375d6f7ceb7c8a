//! Goals that are poses: a place in m and a quaternion, 7 numbers.

use gym_core::Goals;
use gym_core::math::{numpy_acos, sin_cos};
use gym_sim::Rng;
use gym_sim::numpy::norm_avx2;
use std::f64::consts::{FRAC_PI_2, PI};

use crate::RewardType;
use crate::goals::distance;
use crate::rotation::{euler_to_quat, mat_to_euler, quat_to_euler};

/// Goals that are reached by place and rotation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    /// Whether the place matters.
    pub(super) by_place: bool,
    /// Whether a turn about the vertical does not matter.
    pub(super) ignore_z: bool,
    /// The distance in m and the angle in rad within which a goal is reached.
    pub(super) thresholds: [f64; 2],
    pub(super) reward_type: RewardType,
}

/// The turn about the vertical that a comparison of goals ignores.
#[derive(Clone, Copy, PartialEq)]
enum Ignored {
    None,
    Z,
    /// All Euler angles are taken as equal.
    All,
}

impl Pose {
    /// The distance in m and the angle in rad between two goals.
    fn apart(&self, a: &[f64], b: &[f64], ignored: Ignored) -> [f64; 2] {
        let shift = if self.by_place {
            distance(&a[..3], &b[..3])
        } else {
            0.0
        };
        let quat = |goal: &[f64]| [goal[3], goal[4], goal[5], goal[6]];
        let (mut first, second) = (quat(a), quat(b));
        if self.ignore_z {
            let mut angles = quat_to_euler(first);
            match ignored {
                Ignored::None => {}
                Ignored::Z => angles[2] = quat_to_euler(second)[2],
                Ignored::All => angles = quat_to_euler(second),
            }
            first = euler_to_quat(angles);
        }
        let [w, x, y, z] = second;
        let turn = quat_mul(first, [w, -x, -y, -z])[0];
        [shift, 2.0 * numpy_acos(turn.clamp(-1.0, 1.0))]
    }

    fn reward(&self, [shift, turn]: [f64; 2]) -> f64 {
        match self.reward_type {
            RewardType::Sparse => f64::from(self.is_near([shift, turn])) - 1.0,
            RewardType::Dense => -(10.0 * shift + turn),
        }
    }

    fn is_near(&self, apart: [f64; 2]) -> bool {
        apart.iter().zip(self.thresholds).all(|(x, most)| *x < most)
    }

    /// Whether a goal is reached, as `info` tells.
    pub(super) fn is_success(&self, achieved: &[f64], desired: &[f64]) -> bool {
        self.is_near(self.apart(achieved, desired, Ignored::Z))
    }
}

impl Goals for Pose {
    fn goal_len(&self) -> usize {
        7
    }

    fn compute_reward(&self, achieved: &[f64], desired: &[f64]) -> f64 {
        self.reward(self.apart(achieved, desired, Ignored::Z))
    }

    /// In columns, the package sets all Euler angles of the third goal in place of the third angle of
    /// all goals.
    fn compute_reward_in(&self, row: usize, rows: usize, achieved: &[f64], desired: &[f64]) -> f64 {
        let ignored = match row {
            2 => Ignored::All,
            _ if rows < 3 => Ignored::Z,
            _ => Ignored::None,
        };
        self.reward(self.apart(achieved, desired, ignored))
    }
}

/// A quaternion of length 1, `quat / np.linalg.norm(quat)`.
pub(super) fn unit(quat: [f64; 4]) -> [f64; 4] {
    let length = norm_avx2(&quat);
    quat.map(|x| x / length)
}

/// The quaternion of a turn by an angle in rad about an axis.
fn turn(angle: f64, axis: [f64; 3]) -> [f64; 4] {
    let length = norm_avx2(&axis);
    let [x, y, z] = axis.map(|x| x / length);
    let (sin, cos) = sin_cos(angle / 2.0);
    unit([cos, sin * x, sin * y, sin * z])
}

/// Draws a turn about the vertical.
pub(super) fn draw_upright(rng: &mut Rng) -> [f64; 4] {
    turn(rng.uniform(-PI, PI), [0.0, 0.0, 1.0])
}

/// Draws a turn about any axis.
pub(super) fn draw_any(rng: &mut Rng) -> [f64; 4] {
    let angle = rng.uniform(-PI, PI);
    turn(angle, [(); 3].map(|()| rng.uniform(-1.0, 1.0)))
}

/// The 24 rotations that map the axes to axes: `get_parallel_rotations`, as quaternions.
pub(super) fn parallel() -> Vec<[f64; 4]> {
    let angles = [0.0, FRAC_PI_2, -FRAC_PI_2, PI];
    let mut found: Vec<[f64; 3]> = Vec::new();
    for (x, y, z) in (0..64).map(|k| (k / 16, k / 4 % 4, k % 4)) {
        let euler = [x, y, z].map(|k: usize| angles[k]);
        let mut turns =
            mat_to_euler(&euler_to_mat(euler)).map(|angle| (angle / FRAC_PI_2).round_ties_even());
        for k in [0, 2] {
            if turns[k] == -2.0 {
                turns[k] = 2.0;
            }
        }
        let euler = turns.map(|turn| turn * FRAC_PI_2);
        if found.iter().all(|other| *other != euler) {
            found.push(euler);
        }
    }
    found.into_iter().map(euler_to_quat).collect()
}

/// The rotation matrix of Euler angles in rad, by its rows: `euler2mat`.
fn euler_to_mat(euler: [f64; 3]) -> [f64; 9] {
    let [(si, ci), (sj, cj), (sk, ck)] = [-euler[2], -euler[1], -euler[0]].map(sin_cos);
    let (cc, cs) = (ci * ck, ci * sk);
    let (sc, ss) = (si * ck, si * sk);
    [
        cj * ci,
        cj * si,
        -sj,
        sj * cs - sc,
        sj * ss + cc,
        cj * sk,
        sj * cc + ss,
        sj * sc - cs,
        cj * ck,
    ]
}

/// The product of two quaternions: `quat_mul`.
pub(super) fn quat_mul([w0, x0, y0, z0]: [f64; 4], [w1, x1, y1, z1]: [f64; 4]) -> [f64; 4] {
    [
        w0 * w1 - x0 * x1 - y0 * y1 - z0 * z1,
        w0 * x1 + x0 * w1 + y0 * z1 - z0 * y1,
        w0 * y1 + y0 * w1 + z0 * x1 - x0 * z1,
        w0 * z1 + z0 * w1 + x0 * y1 - y0 * x1,
    ]
}
