//! The part of a constraint's acceleration that velocities alone cause (`Jdot v`), for connect and
//! weld constraints: MuJoCo's `mj_Jdotv`.

use super::constraint::Source;
use super::rows::{anchors, mul_quat_axis, orientations};
use crate::math::dense::sum_of_columns;
use crate::math::spatial::{
    InTurn, Order, Pairwise, Quat, Vec3, add, cross, cross_motion, inverse, rotation, sub,
    transform_motion, translation,
};
use crate::model::{Equality, EqualityType, JointType, ObjectType};
use crate::{Data, Model};

/// Subtracts `Jdot v` from the reference accelerations.
#[inline(never)]
pub(super) fn subtract(m: &Model, d: &mut Data) {
    for index in 0..d.efc.blocks.len() {
        let block = &d.efc.blocks[index];
        let Source::Equality(id) = block.source else {
            continue;
        };
        let row = block.row;
        let Some(constraint) = m.plan().constraints.of_bodies(id) else {
            continue;
        };
        let weld = constraint.kind == EqualityType::Weld;
        let points = anchors(m, d, constraint);
        let [first, second] = [0, 1].map(|k| of_point(m, d, constraint.bodies[k], points[k]));
        for k in 0..3 {
            d.efc.aref[row + k] -= first.0[k] - second.0[k];
        }
        if weld {
            let turning = sub(first.1, second.1);
            let bias = if m.revision.adds_in_pairs() {
                turned::<Pairwise>(m, d, constraint, turning)
            } else {
                turned::<InTurn>(m, d, constraint, turning)
            };
            for (aref, bias) in d.efc.aref[row + 3..row + 6].iter_mut().zip(bias) {
                *aref -= bias;
            }
        }
    }
}

/// The linear and angular acceleration of a point of a body if `qacc` is zero: MuJoCo's `mj_jacDot`
/// times the velocities.
fn of_point(m: &Model, d: &Data, body: usize, point: Vec3) -> (Vec3, Vec3) {
    let com = d.subtree_com[m.body_rootid[body]];
    let offset = sub(point, com);
    let velocity = translation(&transform_motion(&d.cvel[body], point, com));
    let column = |dof: usize| {
        let joint = m.dof_jntid[dof];
        let quat = match m.jnt_type[joint] {
            JointType::Ball => true,
            JointType::Free => dof >= m.jnt_dofadr[joint] + 3,
            JointType::Slide | JointType::Hinge => false,
        };
        let axis = &d.cdof[dof];
        let change = if quat {
            cross_motion(&d.cvel[m.dof_bodyid[dof]], axis)
        } else {
            d.cdof_dot[dof]
        };
        let moves = add(translation(&change), cross(rotation(&change), offset));
        let [x, y, z] = add(moves, cross(rotation(axis), velocity));
        let [turn_x, turn_y, turn_z] = rotation(&change);
        [x, y, z, turn_x, turn_y, turn_z]
    };
    if m.plan().sparse {
        let chain = m.plan().chain(body);
        let columns = chain.iter().map(|&dof| (column(dof), d.qvel[dof]));
        let [x, y, z, turn_x, turn_y, turn_z] = sum_of_columns(columns, true);
        return ([x, y, z], [turn_x, turn_y, turn_z]);
    }
    let mut chain = m.plan().chain(body).iter().peekable();
    let columns = (0..m.nv()).map(|dof| {
        let moves = chain.next_if_eq(&&dof).is_some();
        (if moves { column(dof) } else { [0.0; 6] }, d.qvel[dof])
    });
    let [x, y, z, turn_x, turn_y, turn_z] = sum_of_columns(columns, false);
    ([x, y, z], [turn_x, turn_y, turn_z])
}

/// The rate of change of quaternion `q` at the angular velocity `w` in the world's frame: MuJoCo's
/// `mju_derivQuat`.
fn quat_rate(q: Quat, w: Vec3) -> Quat {
    [
        0.5 * (-w[0] * q[1] - w[1] * q[2] - w[2] * q[3]),
        0.5 * (w[0] * q[0] + w[1] * q[3] - w[2] * q[2]),
        0.5 * (-w[0] * q[3] + w[1] * q[0] + w[2] * q[1]),
        0.5 * (w[0] * q[2] - w[1] * q[1] + w[2] * q[0]),
    ]
}

/// `Jdot v` of the orientation rows of a weld.
fn turned<O: Order>(m: &Model, d: &Data, constraint: &Equality, turning: Vec3) -> Vec3 {
    let (ahead, back) = orientations::<O>(m, d, constraint);
    let [w1, w2] = constraint.bodies.map(|body| rotation(&d.cvel[body]));
    let relative = sub(w1, w2);
    let [b1, b2] = constraint.bodies;
    let (ahead_rate, back_rate) = if m.eq_objtype[constraint.id] == ObjectType::Body {
        let data = &m.eq_data[constraint.id];
        let pose = [data[6], data[7], data[8], data[9]];
        let back_rate = inverse(quat_rate(d.xquat[b2], w2));
        (O::mul_quat(quat_rate(d.xquat[b1], w1), pose), back_rate)
    } else {
        (quat_rate(ahead, w1), inverse(quat_rate(inverse(back), w2)))
    };
    let around = |before: Quat, axis: Vec3, after: Quat| {
        O::mul_quat(mul_quat_axis::<O>(before, axis), after)
    };
    let first = around(back_rate, relative, ahead);
    let second = around(back, turning, ahead);
    let third = around(back, relative, ahead_rate);
    let torque = m.eq_data[constraint.id][10];
    std::array::from_fn(|k| 0.5 * (first[1 + k] + second[1 + k] + third[1 + k]) * torque)
}
