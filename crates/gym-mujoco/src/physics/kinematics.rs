//! Where everything is: positions and orientations of bodies, joints, geoms and sites.

use super::spatial::{
    Mat3, Quat, Vec3, add, add_scaled, axis_angle, mul_quat, normalize_quat, quat_to_mat, rotate,
    rotate_quat, sub,
};
use crate::model::JointType;
use crate::{Data, Model};

const ORIGIN: Vec3 = [0.0; 3];
const NO_ROTATION: Quat = [1.0, 0.0, 0.0, 0.0];

/// Frames of bodies, joints, geoms and sites from `qpos`: MuJoCo's `mj_kinematics`.
pub fn kinematics(m: &Model, d: &mut Data) {
    for b in 1..m.nbody() {
        let joints = match usize::try_from(m.body_jntadr[b]) {
            Ok(first) => first..first + m.body_jntnum[b],
            Err(_) => 0..0,
        };
        let (mut pos, mut quat);
        if joints.len() == 1 && m.jnt_type[joints.start] == JointType::Free {
            let j = joints.start;
            let q = &d.qpos[m.jnt_qposadr[j]..m.jnt_qposadr[j] + 7];
            pos = [q[0], q[1], q[2]];
            quat = normalize_quat([q[3], q[4], q[5], q[6]]);
            d.xanchor[j] = pos;
            d.xaxis[j] = m.jnt_axis[j];
        } else {
            let parent = m.body_parentid[b];
            (pos, quat) = (m.body_pos[b], m.body_quat[b]);
            if parent > 0 {
                pos = add(rotate(&d.xmat[parent], pos), d.xpos[parent]);
                quat = if quat == NO_ROTATION { d.xquat[parent] } else { mul_quat(d.xquat[parent], quat) };
            }
            for j in joints {
                let axis = rotate_quat(m.jnt_axis[j], quat);
                let anchored = m.jnt_pos[j] != ORIGIN;
                let anchor = if anchored { add(rotate_quat(m.jnt_pos[j], quat), pos) } else { pos };
                let moved = d.qpos[m.jnt_qposadr[j]] - m.qpos0[m.jnt_qposadr[j]];
                match m.jnt_type[j] {
                    JointType::Slide => pos = add_scaled(pos, axis, moved),
                    _ => {
                        quat = mul_quat(quat, axis_angle(m.jnt_axis[j], moved));
                        if anchored {
                            pos = sub(anchor, rotate_quat(m.jnt_pos[j], quat));
                        }
                    }
                }
                (d.xaxis[j], d.xanchor[j]) = (axis, anchor);
            }
        }
        quat = normalize_quat(quat);
        (d.xpos[b], d.xquat[b], d.xmat[b]) = (pos, quat, quat_to_mat(quat));
        (d.xipos[b], d.ximat[b]) = local_to_global(pos, quat, &d.xmat[b], m.body_ipos[b], m.body_iquat[b]);
    }
    for g in 0..m.ngeom() {
        let b = m.geom_bodyid[g];
        (d.geom_xpos[g], d.geom_xmat[g]) =
            if m.geom_pos[g] == m.body_ipos[b] && m.geom_quat[g] == m.body_iquat[b] {
                (d.xipos[b], d.ximat[b])
            } else {
                local_to_global(d.xpos[b], d.xquat[b], &d.xmat[b], m.geom_pos[g], m.geom_quat[g])
            };
    }
    for s in 0..m.nsite() {
        let b = m.site_bodyid[s];
        (d.site_xpos[s], d.site_xmat[s]) =
            local_to_global(d.xpos[b], d.xquat[b], &d.xmat[b], m.site_pos[s], m.site_quat[s]);
    }
}

/// A frame given in a body's frame: MuJoCo's `mj_local2Global`.
fn local_to_global(xpos: Vec3, xquat: Quat, xmat: &Mat3, pos: Vec3, quat: Quat) -> (Vec3, Mat3) {
    let global = if pos == ORIGIN { xpos } else { add(rotate(xmat, pos), xpos) };
    (global, if quat == NO_ROTATION { *xmat } else { quat_to_mat(mul_quat(xquat, quat)) })
}
