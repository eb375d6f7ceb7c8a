//! The constants that the smooth stages read of each body and joint, side by side in memory.

use std::ops::Range;

use super::{CompiledModel, JointType};
use crate::math::spatial::MINVAL;

/// The constants of a body.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) parent: usize,
    pub(crate) base: Base,
    pub(crate) joints: Range<usize>,
    pub(crate) dofs: Range<usize>,
    /// The pose in the frame of the parent.
    pub(crate) pos: [f64; 3],
    pub(crate) quat: [f64; 4],
    pub(crate) turned: bool,
    /// The pose of the principal axes in the frame of the body.
    pub(crate) inertia: Pose,
    /// The first body of the tree.
    pub(crate) root: usize,
    pub(crate) mass: f64,
    /// The principal moments of inertia.
    pub(crate) moments: [f64; 3],
    /// The inverse of the mass of the body and its descendants; `None` without mass.
    pub(crate) inverse_mass: Option<f64>,
}

/// The source of a body's frame, before joints move the body.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Base {
    /// A free joint gives the frame.
    Free,
    /// The mocap pose of this number gives the frame.
    Mocap(usize),
    World,
    Parent,
}

/// The constants of a joint.
#[derive(Clone, Debug)]
pub(crate) struct Joint {
    pub(crate) kind: JointType,
    pub(crate) body: usize,
    /// The root of the body's tree.
    pub(crate) root: usize,
    /// The first position and the first degree of freedom.
    pub(crate) qpos: usize,
    pub(crate) dof: usize,
    /// The position in which the joint does not move its body.
    pub(crate) rest: f64,
    pub(crate) axis: [f64; 3],
    pub(crate) origin: [f64; 3],
    /// Whether the origin differs from the origin of the body.
    pub(crate) anchored: bool,
}

/// A pose in the frame of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub(crate) pos: [f64; 3],
    pub(crate) quat: [f64; 4],
    /// Which parts are not zero.
    pub(crate) moved: bool,
    pub(crate) turned: bool,
}

impl Pose {
    /// The body's frame replaces a frame that is nearly equal: MuJoCo's `sameframe`.
    pub(super) fn within(pos: [f64; 3], quat: [f64; 4]) -> Self {
        let turned = !same_quat(&quat, &UNTURNED);
        Self {
            pos,
            quat,
            moved: pos != [0.0; 3] && (turned || !same(&pos, &[0.0; 3])),
            turned,
        }
    }
}

/// The frame of a geom or a site: MuJoCo's `mjtSameFrame`.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Mount {
    /// The inertial frame of the body.
    Inertial,
    /// A position of its own, and the orientation of the inertial frame.
    Aligned(Pose),
    /// A pose in the frame of the body.
    Own(Pose),
}

impl Mount {
    /// The inertial frame replaces what is nearly equal in it. The frame of the body comes first,
    /// because its orientation is exact.
    fn new(m: &CompiledModel, body: usize, pos: [f64; 3], quat: [f64; 4]) -> Self {
        let (inertia_pos, inertia_quat) = (m.body_ipos[body], m.body_iquat[body]);
        let pose = Pose::within(pos, quat);
        let aligned = pose.turned && same_quat(&quat, &inertia_quat);
        if (pos, quat) == (inertia_pos, inertia_quat) || (aligned && same(&pos, &inertia_pos)) {
            Self::Inertial
        } else if aligned {
            Self::Aligned(Pose {
                turned: false,
                ..pose
            })
        } else {
            Self::Own(pose)
        }
    }

    pub(super) fn of_geoms(m: &CompiledModel) -> Vec<Self> {
        let mount = |g: usize| Self::new(m, m.geom_bodyid[g], m.geom_pos[g], m.geom_quat[g]);
        (0..m.ngeom()).map(mount).collect()
    }

    pub(super) fn of_sites(m: &CompiledModel) -> Vec<Self> {
        let mount = |s: usize| Self::new(m, m.site_bodyid[s], m.site_pos[s], m.site_quat[s]);
        (0..m.nsite()).map(mount).collect()
    }
}

const UNTURNED: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// Whether two vectors are nearly equal.
pub(crate) fn same(a: &[f64], b: &[f64]) -> bool {
    const NEAR: f64 = 1e-6;
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < NEAR)
}

/// Whether two orientations are nearly equal.
pub(crate) fn same_quat(a: &[f64; 4], b: &[f64; 4]) -> bool {
    same(a, b) || same(a, &b.map(|x| -x))
}

pub(super) fn bodies(m: &CompiledModel) -> Vec<Body> {
    let range = |first: i32, number: usize| {
        usize::try_from(first).map_or(0..0, |first| first..first + number)
    };
    let body = |b: usize| {
        let parent = m.body_parentid[b];
        let joints = range(m.body_jntadr[b], m.body_jntnum[b]);
        let base = match usize::try_from(m.body_mocapid[b]) {
            _ if joints.len() == 1 && m.jnt_type[joints.start] == JointType::Free => Base::Free,
            Ok(mocap) => Base::Mocap(mocap),
            Err(_) if parent == 0 => Base::World,
            Err(_) => Base::Parent,
        };
        Body {
            parent,
            base,
            joints,
            dofs: range(m.body_dofadr[b], m.body_dofnum[b]),
            pos: m.body_pos[b],
            quat: m.body_quat[b],
            turned: m.body_quat[b] != UNTURNED,
            inertia: Pose::within(m.body_ipos[b], m.body_iquat[b]),
            root: m.body_rootid[b],
            mass: m.body_mass[b],
            moments: m.body_inertia[b],
            inverse_mass: (m.body_subtreemass[b] >= MINVAL).then(|| 1.0 / m.body_subtreemass[b]),
        }
    };
    (0..m.nbody()).map(body).collect()
}

pub(super) fn joints(m: &CompiledModel) -> Vec<Joint> {
    let joint = |j: usize| Joint {
        kind: m.jnt_type[j],
        body: m.jnt_bodyid[j],
        root: m.body_rootid[m.jnt_bodyid[j]],
        qpos: m.jnt_qposadr[j],
        dof: m.jnt_dofadr[j],
        rest: m.qpos0[m.jnt_qposadr[j]],
        axis: m.jnt_axis[j],
        origin: m.jnt_pos[j],
        anchored: m.jnt_pos[j] != [0.0; 3],
    };
    (0..m.njnt()).map(joint).collect()
}
