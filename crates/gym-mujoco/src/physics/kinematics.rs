//! Positions and orientations of bodies, joints, geoms and sites.

use super::number::{self, Number, get, put};
use super::spatial::{
    InTurn, Order, Pairwise, add, add_scaled, axis_angle, rotate, rotate_quat, sub,
};
use super::velocity::joints;
use crate::model::{JointType, Placed};
use crate::{Data, Model, Revision};

/// The arrays that this stage reads and writes, of one world or of several.
pub(crate) struct Frames<'a, C> {
    pub(crate) qpos: &'a [C],
    pub(crate) mocap_pos: &'a [[C; 3]],
    pub(crate) mocap_quat: &'a [[C; 4]],
    pub(crate) xpos: &'a mut [[C; 3]],
    pub(crate) xquat: &'a mut [[C; 4]],
    pub(crate) xmat: &'a mut [[C; 9]],
    pub(crate) xipos: &'a mut [[C; 3]],
    pub(crate) ximat: &'a mut [[C; 9]],
    pub(crate) xanchor: &'a mut [[C; 3]],
    pub(crate) xaxis: &'a mut [[C; 3]],
    pub(crate) geom_xpos: &'a mut [[C; 3]],
    pub(crate) geom_xmat: &'a mut [[C; 9]],
    pub(crate) site_xpos: &'a mut [[C; 3]],
    pub(crate) site_xmat: &'a mut [[C; 9]],
}

/// Computes the frames of bodies, joints, geoms and sites from `qpos`: MuJoCo's `mj_kinematics`.
pub fn kinematics(m: &Model, d: &mut Data) {
    d.work.skips = false;
    find_frames(m, d);
}

/// [`kinematics`], without geoms and sites that no later stage reads if `skips` is set.
#[inline(always)]
pub(super) fn find_frames(m: &Model, d: &mut Data) {
    let whole = !d.work.skips;
    let frames = Frames {
        qpos: &d.qpos,
        mocap_pos: &d.mocap_pos,
        mocap_quat: &d.mocap_quat,
        xpos: &mut d.xpos,
        xquat: &mut d.xquat,
        xmat: &mut d.xmat,
        xipos: &mut d.xipos,
        ximat: &mut d.ximat,
        xanchor: &mut d.xanchor,
        xaxis: &mut d.xaxis,
        geom_xpos: &mut d.geom_xpos,
        geom_xmat: &mut d.geom_xmat,
        site_xpos: &mut d.site_xpos,
        site_xmat: &mut d.site_xmat,
    };
    kinematics_of::<f64>(m, (), frames, whole);
}

/// [`kinematics`] for one world or several.
#[inline(always)]
pub(crate) fn kinematics_of<N: Number>(
    m: &Model,
    place: N::Place,
    frames: Frames<'_, N::Cell>,
    whole: bool,
) {
    match m.revision {
        Revision::V3_12 => in_order::<N, InTurn>(m, place, frames, whole),
        Revision::V4_0 => in_order::<N, Pairwise>(m, place, frames, whole),
    }
}

#[inline(always)]
fn in_order<N: Number, O: Order>(
    m: &Model,
    at: N::Place,
    frames: Frames<'_, N::Cell>,
    whole: bool,
) {
    // slices of equal length let the compiler check an index once for all of them
    let n = m.nbody();
    let parents = &m.body_parentid[..n];
    let (body_pos, body_quat, body_ipos, body_iquat) = (
        &m.body_pos[..n],
        &m.body_quat[..n],
        &m.body_ipos[..n],
        &m.body_iquat[..n],
    );
    let (placed, inertias) = (&m.plan().bodies[..n], &m.plan().inertias[..n]);
    let f = frames;
    let (xpos, xquat, xmat) = (&mut f.xpos[..n], &mut f.xquat[..n], &mut f.xmat[..n]);
    let (xipos, ximat) = (&mut f.xipos[..n], &mut f.ximat[..n]);
    let njnt = m.njnt();
    let (types, axes, origins, addresses) = (
        &m.jnt_type[..njnt],
        &m.jnt_axis[..njnt],
        &m.jnt_pos[..njnt],
        &m.jnt_qposadr[..njnt],
    );
    let (xaxis, xanchor) = (&mut f.xaxis[..njnt], &mut f.xanchor[..njnt]);
    let (anchored, nq) = (&m.plan().anchored[..njnt], m.nq());
    let (qpos, qpos0) = (&f.qpos[..nq], &m.qpos0[..nq]);
    for b in 1..n {
        let joints = joints(m, b);
        let (mut pos, mut quat): ([N; 3], [N; 4]);
        if joints.len() == 1 && types[joints.start] == JointType::Free {
            let j = joints.start;
            let q: [N; 7] = std::array::from_fn(
                #[inline(always)]
                |k| N::get(at, &qpos[addresses[j] + k]),
            );
            pos = [q[0], q[1], q[2]];
            quat = O::normalize_quat(at, [q[3], q[4], q[5], q[6]]);
            put(at, pos, &mut xanchor[j]);
            put(at, number::of::<N, 3>(at, axes[j]), &mut xaxis[j]);
        } else {
            let parent = parents[b];
            if let Ok(mocap) = usize::try_from(m.body_mocapid[b]) {
                pos = get(at, &f.mocap_pos[mocap]);
                quat = O::normalize_quat(at, get(at, &f.mocap_quat[mocap]));
            } else if parent > 0 {
                let parent_quat = get::<N, 4>(at, &xquat[parent]);
                pos = add(
                    rotate(&get::<N, 9>(at, &xmat[parent]), body_pos[b]),
                    get::<N, 3>(at, &xpos[parent]),
                );
                quat = if placed[b].turned {
                    O::mul_quat(parent_quat, body_quat[b])
                } else {
                    parent_quat
                };
            } else {
                pos = number::of(at, body_pos[b]);
                quat = number::of(at, body_quat[b]);
            }
            for j in joints {
                let axis = rotate_quat(axes[j], quat);
                let anchor = if anchored[j] {
                    add(rotate_quat(origins[j], quat), pos)
                } else {
                    pos
                };
                let moved = N::get(at, &qpos[addresses[j]]) - qpos0[addresses[j]];
                match types[j] {
                    JointType::Slide => pos = add_scaled(pos, axis, moved),
                    other => {
                        let turn = if other == JointType::Ball {
                            let q = std::array::from_fn(
                                #[inline(always)]
                                |k| N::get(at, &qpos[addresses[j] + k]),
                            );
                            O::normalize_quat(at, q)
                        } else {
                            axis_angle(at, axes[j], moved)
                        };
                        quat = O::mul_quat(quat, turn);
                        if anchored[j] {
                            pos = sub(anchor, rotate_quat(origins[j], quat));
                        }
                    }
                }
                put(at, axis, &mut xaxis[j]);
                put(at, anchor, &mut xanchor[j]);
            }
        }
        quat = O::normalize_quat(at, quat);
        let mat = O::quat_to_mat(quat);
        put(at, pos, &mut xpos[b]);
        put(at, quat, &mut xquat[b]);
        put(at, mat, &mut xmat[b]);
        local_to_global::<N, O>(
            at,
            (&xpos[b], &xquat[b], &xmat[b]),
            inertias[b],
            (body_ipos[b], body_iquat[b]),
            (&mut xipos[b], &mut ximat[b]),
        );
    }
    let n = m.ngeom();
    let (bodies, placed) = (&m.geom_bodyid[..n], &m.plan().geoms[..n]);
    let read = &m.plan().geoms_read[..n];
    let (geom_xpos, geom_xmat) = (&mut f.geom_xpos[..n], &mut f.geom_xmat[..n]);
    for g in 0..n {
        if !(whole || read[g]) {
            continue;
        }
        let b = bodies[g];
        match placed[g] {
            None => (geom_xpos[g], geom_xmat[g]) = (xipos[b], ximat[b]),
            Some(placed) => local_to_global::<N, O>(
                at,
                (&xpos[b], &xquat[b], &xmat[b]),
                placed,
                (m.geom_pos[g], m.geom_quat[g]),
                (&mut geom_xpos[g], &mut geom_xmat[g]),
            ),
        }
    }
    if !(whole || m.plan().sites_read) {
        return;
    }
    for (s, &placed) in m.plan().sites.iter().enumerate() {
        let b = m.site_bodyid[s];
        local_to_global::<N, O>(
            at,
            (&xpos[b], &xquat[b], &xmat[b]),
            placed,
            (m.site_pos[s], m.site_quat[s]),
            (&mut f.site_xpos[s], &mut f.site_xmat[s]),
        );
    }
}

/// The frame of a body: `xpos`, `xquat` and `xmat`.
type Body<'a, C> = (&'a [C; 3], &'a [C; 4], &'a [C; 9]);

/// Transforms a frame from a body's frame to the world: MuJoCo's `mj_local2Global`.
#[inline(always)]
fn local_to_global<N: Number, O: Order>(
    at: N::Place,
    (xpos, xquat, xmat): Body<'_, N::Cell>,
    placed: Placed,
    (pos, quat): ([f64; 3], [f64; 4]),
    (to_pos, to_mat): (&mut [N::Cell; 3], &mut [N::Cell; 9]),
) {
    if placed.moved {
        let moved = rotate(&get::<N, 9>(at, xmat), pos);
        put(at, add(moved, get::<N, 3>(at, xpos)), to_pos);
    } else {
        *to_pos = *xpos;
    }
    if placed.turned {
        let turned = O::mul_quat(get::<N, 4>(at, xquat), quat);
        put(at, O::quat_to_mat(turned), to_mat);
    } else {
        *to_mat = *xmat;
    }
}
