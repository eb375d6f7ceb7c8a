//! Where everything is: positions and orientations of bodies, joints, geoms and sites.

use super::spatial::{
    InTurn, Mat3, Order, Pairwise, Quat, Vec3, add, add_scaled, axis_angle, mul_quat,
    normalize_quat, quat_to_mat, rotate, rotate_quat, sub,
};
use super::velocity::joints;
use crate::model::{JointType, Placed};
use crate::{Data, Model, Revision};

/// Frames of bodies, joints, geoms and sites from `qpos`: MuJoCo's `mj_kinematics`.
#[inline(always)]
pub fn kinematics(m: &Model, d: &mut Data) {
    match m.revision {
        Revision::V3_12 => place::<InTurn>(m, d),
        Revision::V4_0 => place::<Pairwise>(m, d),
    }
}

#[inline(always)]
fn place<O: Order>(m: &Model, d: &mut Data) {
    // slices of one length: an index is checked once for all of them
    let n = m.nbody();
    let parents = &m.body_parentid[..n];
    let (body_pos, body_quat, body_ipos, body_iquat) = (
        &m.body_pos[..n],
        &m.body_quat[..n],
        &m.body_ipos[..n],
        &m.body_iquat[..n],
    );
    let (placed, inertias) = (&m.plan().bodies[..n], &m.plan().inertias[..n]);
    let (xpos, xquat, xmat) = (&mut d.xpos[..n], &mut d.xquat[..n], &mut d.xmat[..n]);
    let (xipos, ximat) = (&mut d.xipos[..n], &mut d.ximat[..n]);
    let njnt = m.njnt();
    let (types, axes, origins, addresses) = (
        &m.jnt_type[..njnt],
        &m.jnt_axis[..njnt],
        &m.jnt_pos[..njnt],
        &m.jnt_qposadr[..njnt],
    );
    let (xaxis, xanchor) = (&mut d.xaxis[..njnt], &mut d.xanchor[..njnt]);
    let (anchored, nq) = (&m.plan().anchored[..njnt], m.nq());
    let (qpos, qpos0) = (&d.qpos[..nq], &m.qpos0[..nq]);
    for b in 1..n {
        let joints = joints(m, b);
        let (mut pos, mut quat);
        if joints.len() == 1 && types[joints.start] == JointType::Free {
            let j = joints.start;
            let q = &qpos[addresses[j]..addresses[j] + 7];
            pos = [q[0], q[1], q[2]];
            quat = normalize_quat::<O>([q[3], q[4], q[5], q[6]]);
            xanchor[j] = pos;
            xaxis[j] = axes[j];
        } else {
            let parent = parents[b];
            (pos, quat) = (body_pos[b], body_quat[b]);
            if let Ok(mocap) = usize::try_from(m.body_mocapid[b]) {
                (pos, quat) = (d.mocap_pos[mocap], d.mocap_quat[mocap]);
                quat = normalize_quat::<O>(quat);
            }
            if parent > 0 {
                pos = add(rotate(&xmat[parent], pos), xpos[parent]);
                quat = if placed[b].turned {
                    mul_quat::<O>(xquat[parent], quat)
                } else {
                    xquat[parent]
                };
            }
            for j in joints {
                let axis = rotate_quat(axes[j], quat);
                let anchor = if anchored[j] {
                    add(rotate_quat(origins[j], quat), pos)
                } else {
                    pos
                };
                let moved = qpos[addresses[j]] - qpos0[addresses[j]];
                match types[j] {
                    JointType::Slide => pos = add_scaled(pos, axis, moved),
                    other => {
                        let turn = if other == JointType::Ball {
                            let q = &qpos[addresses[j]..addresses[j] + 4];
                            normalize_quat::<O>([q[0], q[1], q[2], q[3]])
                        } else {
                            axis_angle(axes[j], moved)
                        };
                        quat = mul_quat::<O>(quat, turn);
                        if anchored[j] {
                            pos = sub(anchor, rotate_quat(origins[j], quat));
                        }
                    }
                }
                (xaxis[j], xanchor[j]) = (axis, anchor);
            }
        }
        quat = normalize_quat::<O>(quat);
        (xpos[b], xquat[b], xmat[b]) = (pos, quat, quat_to_mat::<O>(quat));
        (xipos[b], ximat[b]) = local_to_global::<O>(
            pos,
            quat,
            &xmat[b],
            inertias[b],
            body_ipos[b],
            body_iquat[b],
        );
    }
    let n = m.ngeom();
    let (bodies, placed) = (&m.geom_bodyid[..n], &m.plan().geoms[..n]);
    let (geom_xpos, geom_xmat) = (&mut d.geom_xpos[..n], &mut d.geom_xmat[..n]);
    for g in 0..n {
        let b = bodies[g];
        (geom_xpos[g], geom_xmat[g]) = match placed[g] {
            None => (xipos[b], ximat[b]),
            Some(placed) => local_to_global::<O>(
                xpos[b],
                xquat[b],
                &xmat[b],
                placed,
                m.geom_pos[g],
                m.geom_quat[g],
            ),
        };
    }
    for (s, &placed) in m.plan().sites.iter().enumerate() {
        let b = m.site_bodyid[s];
        (d.site_xpos[s], d.site_xmat[s]) = local_to_global::<O>(
            xpos[b],
            xquat[b],
            &xmat[b],
            placed,
            m.site_pos[s],
            m.site_quat[s],
        );
    }
}

/// A frame given in a body's frame: MuJoCo's `mj_local2Global`.
#[inline(always)]
fn local_to_global<O: Order>(
    xpos: Vec3,
    xquat: Quat,
    xmat: &Mat3,
    placed: Placed,
    pos: Vec3,
    quat: Quat,
) -> (Vec3, Mat3) {
    (
        if placed.moved {
            add(rotate(xmat, pos), xpos)
        } else {
            xpos
        },
        if placed.turned {
            quat_to_mat::<O>(mul_quat::<O>(xquat, quat))
        } else {
            *xmat
        },
    )
}
