//! Positions and orientations of bodies, joints, geoms and sites.

use crate::math::number::{self, Number, get, put};
use crate::math::spatial::{
    InTurn, Order, Pairwise, add, add_scaled, axis_angle, rotate, rotate_quat, sub,
};
use crate::model::{Base, JointType, Mount, Pose};
use crate::{Data, Model};

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
    place: N::At,
    frames: Frames<'_, N::Cell>,
    whole: bool,
) {
    if m.revision.adds_in_pairs() {
        in_order::<N, Pairwise>(m, place, frames, whole);
    } else {
        in_order::<N, InTurn>(m, place, frames, whole);
    }
}

#[inline(always)]
fn in_order<N: Number, O: Order>(m: &Model, at: N::At, frames: Frames<'_, N::Cell>, whole: bool) {
    // slices of equal length let the compiler check an index once for all of them
    let (f, plan, n) = (frames, m.plan(), m.nbody());
    let bodies = &plan.bodies[..n];
    let (xpos, xquat, xmat) = (&mut f.xpos[..n], &mut f.xquat[..n], &mut f.xmat[..n]);
    let (xipos, ximat) = (&mut f.xipos[..n], &mut f.ximat[..n]);
    let joints = &plan.joints[..];
    let (xaxis, xanchor) = (&mut f.xaxis[..joints.len()], &mut f.xanchor[..joints.len()]);
    let qpos = f.qpos;
    let (quat_at,) = (
        #[inline(always)]
        |first: usize| {
            let q = std::array::from_fn(
                #[inline(always)]
                |k| N::get(at, &qpos[first + k]),
            );
            O::normalize_quat(at, q)
        },
    );
    for b in 1..n {
        let body = &bodies[b];
        let (mut pos, mut quat): ([N; 3], [N; 4]);
        if let Base::Free = body.base {
            let j = body.joints.start;
            let first = joints[j].qpos;
            pos = std::array::from_fn(
                #[inline(always)]
                |k| N::get(at, &qpos[first + k]),
            );
            quat = quat_at(first + 3);
            put(at, pos, &mut xanchor[j]);
            put(at, number::of::<N, 3>(at, joints[j].axis), &mut xaxis[j]);
        } else {
            match body.base {
                Base::Mocap(mocap) => {
                    pos = get(at, &f.mocap_pos[mocap]);
                    quat = O::normalize_quat(at, get(at, &f.mocap_quat[mocap]));
                }
                Base::Parent => {
                    let parent = body.parent;
                    let parent_quat = get::<N, 4>(at, &xquat[parent]);
                    let moved = rotate(&get::<N, 9>(at, &xmat[parent]), body.pos);
                    pos = add(moved, get::<N, 3>(at, &xpos[parent]));
                    quat = if body.turned {
                        O::mul_quat(parent_quat, body.quat)
                    } else {
                        parent_quat
                    };
                }
                Base::World | Base::Free => {
                    pos = number::of(at, body.pos);
                    quat = number::of(at, body.quat);
                }
            }
            for j in body.joints.clone() {
                let joint = &joints[j];
                let axis = rotate_quat(joint.axis, quat);
                let anchor = if joint.anchored {
                    add(rotate_quat(joint.origin, quat), pos)
                } else {
                    pos
                };
                let moved = N::get(at, &qpos[joint.qpos]) - joint.rest;
                match joint.kind {
                    JointType::Slide => pos = add_scaled(pos, axis, moved),
                    other => {
                        let turn = if other == JointType::Ball {
                            quat_at(joint.qpos)
                        } else {
                            axis_angle(at, joint.axis, moved)
                        };
                        quat = O::mul_quat(quat, turn);
                        if joint.anchored {
                            pos = sub(anchor, rotate_quat(joint.origin, quat));
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
        let frame = (&xpos[b], &xquat[b], &xmat[b]);
        local_to_global::<N, O>(at, frame, &body.inertia, (&mut xipos[b], &mut ximat[b]));
    }
    let n = m.ngeom();
    let (bodies, mounts) = (&m.geom_bodyid[..n], &plan.geoms[..n]);
    let read = &plan.geoms_read[..n];
    let (geom_xpos, geom_xmat) = (&mut f.geom_xpos[..n], &mut f.geom_xmat[..n]);
    let (seat,) = (
        #[inline(always)]
        |b: usize, mount: &Mount, to: (&mut [N::Cell; 3], &mut [N::Cell; 9])| {
            let own = (&xpos[b], &xquat[b], &xmat[b]);
            match mount {
                Mount::Inertial => (*to.0, *to.1) = (xipos[b], ximat[b]),
                Mount::Own(pose) => local_to_global::<N, O>(at, own, pose, to),
                Mount::Aligned(pose) => {
                    local_to_global::<N, O>(at, own, pose, (&mut *to.0, &mut *to.1));
                    *to.1 = ximat[b];
                }
            }
        },
    );
    for g in 0..n {
        if whole || read[g] {
            let to = (&mut geom_xpos[g], &mut geom_xmat[g]);
            seat(bodies[g], &mounts[g], to);
        }
    }
    if !(whole || plan.sites_read) {
        return;
    }
    for (s, mount) in plan.sites.iter().enumerate() {
        let to = (&mut f.site_xpos[s], &mut f.site_xmat[s]);
        seat(m.site_bodyid[s], mount, to);
    }
}

/// The frame of a body: `xpos`, `xquat` and `xmat`.
type Body<'a, C> = (&'a [C; 3], &'a [C; 4], &'a [C; 9]);

/// Transforms a frame from a body's frame to the world: MuJoCo's `mj_local2Global`.
#[inline(always)]
fn local_to_global<N: Number, O: Order>(
    at: N::At,
    (xpos, xquat, xmat): Body<'_, N::Cell>,
    pose: &Pose,
    (to_pos, to_mat): (&mut [N::Cell; 3], &mut [N::Cell; 9]),
) {
    if pose.moved {
        let moved = rotate(&get::<N, 9>(at, xmat), pose.pos);
        put(at, add(moved, get::<N, 3>(at, xpos)), to_pos);
    } else {
        *to_pos = *xpos;
    }
    if pose.turned {
        let turned = O::mul_quat(get::<N, 4>(at, xquat), pose.quat);
        put(at, O::quat_to_mat(turned), to_mat);
    } else {
        *to_mat = *xmat;
    }
}
