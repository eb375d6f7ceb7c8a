//! A body that is pulled by the pointer.
//!
//! The force is that of MuJoCo's viewer: `mjv_initPerturb` and `mjv_applyPerturbForce` in
//! `src/engine/engine_vis_interact.c` of MuJoCo (Apache-2.0). A spring pulls the point p of the body to
//! the target t: with the mass m that the body has at the point, f = -100 m (p - t) - 10 m v, where v
//! is the point's velocity; and a torque damps the body's turning about the string.

use crate::view::Hit;
use mujoco_engine::math::{
    Vec3, add, add_scaled, cross, dot, normalize, normalize_quat, quat_to_mat, rotate, rotate_back,
    scale, sub,
};
use mujoco_engine::model::JointType;
use mujoco_engine::physics::solve_m;
use mujoco_engine::{Data, Model};

/// Stiffness for 1 kg: MuJoCo's `vis.map.stiffness`, and `stiffnessrot` for 1 kg m².
const STIFFNESS: f64 = 100.0;
const STIFFNESS_ROT: f64 = 500.0;
/// MuJoCo's `mjMINVAL`.
const MINVAL: f64 = 1e-15;

#[derive(Clone, Debug)]
pub(super) struct Pull {
    body: usize,
    /// The point in the body's frame, and the point to which it is pulled.
    local: Vec3,
    target: Vec3,
    /// Whether the target was moved: a body is not pulled when it is only selected.
    is_aimed: bool,
    /// The distance of the target along the viewing direction.
    depth: f64,
    /// The mass of the body at the point, in kg.
    pub(super) mass: f64,
    /// The number of a mocap body.
    mocap: Option<usize>,
}

impl Pull {
    /// Takes hold of the point of a body; `None` if the body cannot move.
    pub(super) fn new(model: &Model, data: &Data, hit: &Hit, depth: f64) -> Option<Self> {
        let body = hit.body;
        let mocap = usize::try_from(model.body_mocapid[body]).ok();
        if mocap.is_none() && model.body_treeid[body] < 0 {
            return None;
        }
        Some(Self {
            body,
            local: rotate_back(&data.xmat[body], sub(hit.point, data.xpos[body])),
            target: hit.point,
            is_aimed: false,
            depth,
            mass: mass_at(model, data, body, hit.point),
            mocap,
        })
    }

    /// Moves the target to where a ray is as far as the point was.
    pub(super) fn aim(&mut self, [from, along]: [Vec3; 2]) {
        let target = add_scaled(from, along, self.depth);
        if target.iter().all(|x| x.is_finite()) {
            (self.target, self.is_aimed) = (target, true);
        }
    }

    /// Moves a mocap body so that the point is at the target; and, while time stands still, the tree of
    /// a body that floats, as `mjv_applyPerturbPose` does. Returns whether something moved.
    pub(super) fn place(&self, model: &Model, data: &mut Data, is_paused: bool) -> bool {
        if let Some(id) = self.mocap {
            let mat = quat_to_mat(normalize_quat(data.mocap_quat[id]));
            data.mocap_pos[id] = sub(self.target, rotate(&mat, self.local));
            return true;
        }
        let root = model.body_rootid[self.body];
        let joint = usize::try_from(model.body_jntadr[root]).ok();
        let floats = joint.filter(|joint| model.jnt_type[*joint] == JointType::Free);
        let Some(joint) = floats.filter(|_| is_paused) else {
            return false;
        };
        let offset = sub(self.target, self.point(data));
        let first = model.jnt_qposadr[joint];
        for (x, by) in data.qpos[first..].iter_mut().zip(offset) {
            *x += by;
        }
        true
    }

    /// Applies the force, before a step.
    pub(super) fn apply(&self, model: &Model, data: &mut Data) {
        if self.mocap.is_some() || !self.is_aimed {
            return;
        }
        let point = self.point(data);
        let stretch = sub(point, self.target);
        let arm = sub(point, data.xipos[self.body]);
        let [x, y, z, vx, vy, vz] = data.cvel[self.body];
        let (turning, at_com) = ([x, y, z], [vx, vy, vz]);
        // `cvel` is the velocity at the centre of mass of the tree
        let from = sub(point, data.subtree_com[model.body_rootid[self.body]]);
        let velocity = add(at_com, cross(turning, from));
        let spring = scale(stretch, -STIFFNESS * self.mass);
        let force = add_scaled(spring, velocity, -STIFFNESS.sqrt() * self.mass);
        let inverse = model.body_invweight0[self.body][1];
        let inertia = if inverse == 0.0 {
            1.0
        } else {
            1.0 / inverse.max(MINVAL)
        };
        let (along, _) = normalize(stretch);
        let damping = -STIFFNESS_ROT.sqrt() * inertia * dot(along, turning);
        let [tx, ty, tz] = add_scaled(cross(arm, force), along, damping);
        let [fx, fy, fz] = force;
        data.xfrc_applied[self.body] = [fx, fy, fz, tx, ty, tz];
    }

    /// Removes the force.
    pub(super) fn end(&self, data: &mut Data) {
        if self.mocap.is_none() {
            data.xfrc_applied[self.body] = [0.0; 6];
        }
    }

    /// The ends of the string, once there is one.
    pub(super) fn ends(&self, data: &Data) -> Option<[Vec3; 2]> {
        self.is_aimed.then(|| [self.point(data), self.target])
    }

    fn point(&self, data: &Data) -> Vec3 {
        let turned = rotate(&data.xmat[self.body], self.local);
        add(data.xpos[self.body], turned)
    }
}

/// The mass of a body at a point, as the mean over three directions: 3 over the trace of J M^-1 J',
/// where J is the point's Jacobian.
fn mass_at(model: &Model, data: &Data, body: usize, point: Vec3) -> f64 {
    let nv = model.nv();
    let [moves, _] = data.jac(model, body, point);
    let mut inverse = 0.0;
    for row in moves.chunks_exact(nv.max(1)) {
        let mut solved = row.to_vec();
        solve_m(model, data, &mut solved);
        inverse += row.iter().zip(&solved).map(|(a, b)| a * b).sum::<f64>();
    }
    if inverse == 0.0 {
        1.0
    } else {
        3.0 / inverse.max(MINVAL)
    }
}
