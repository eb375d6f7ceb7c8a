//! Rows of equality constraints.

use super::{push_row, push_rows, push_scalar};
use crate::math::dense::dot_slices;
use crate::math::spatial::{
    InTurn, Order, Pairwise, Quat, Vec3, add, inverse, rotate, rotation, sub,
};
use crate::model::{Equality, EqualityType, ObjectType};
use crate::physics::constraint::{Constraints, Kind, Source, push_block, set_row};
use crate::physics::jacobian::moves_apart;
use crate::physics::sleep;
use crate::{Data, Model};

/// Adds the rows of active equality constraints: MuJoCo's `mj_instantiateEquality`.
#[inline(never)]
pub(super) fn equality(m: &Model, d: &mut Data) {
    let plan = m.plan();
    for constraint in &plan.constraints.equalities {
        if plan.sleeps && sleep::equality_rests(m, &d.work.tree_awake, constraint.id) {
            continue;
        }
        match (constraint.kind, m.revision.adds_in_pairs()) {
            (EqualityType::Connect | EqualityType::Weld, false) => {
                bodies::<InTurn>(m, d, constraint);
            }
            (EqualityType::Connect | EqualityType::Weld, true) => {
                bodies::<Pairwise>(m, d, constraint);
            }
            (EqualityType::Joint | EqualityType::Tendon, _) => polynomial(m, d, constraint),
        }
    }
}

/// The two anchor points, in the world, of a connect or weld constraint: MuJoCo's
/// `mj_equalityAnchors`.
pub(in crate::physics) fn anchors(m: &Model, d: &Data, constraint: &Equality) -> [Vec3; 2] {
    let ids = [m.eq_obj1id[constraint.id], m.eq_obj2id[constraint.id]].map(|id| id as usize);
    if m.eq_objtype[constraint.id] == ObjectType::Site {
        return ids.map(|site| d.site_xpos[site]);
    }
    let data = &m.eq_data[constraint.id];
    let parts = [[data[0], data[1], data[2]], [data[3], data[4], data[5]]];
    // the first anchor of a weld is given in the second body's frame
    let parts = if constraint.kind == EqualityType::Weld {
        [parts[1], parts[0]]
    } else {
        parts
    };
    [0, 1].map(|k| add(rotate(&d.xmat[ids[k]], parts[k]), d.xpos[ids[k]]))
}

/// Returns the orientation of the second body that a weld constraint requires, and the inverse of
/// the second body's orientation.
pub(in crate::physics) fn orientations<O: Order>(
    m: &Model,
    d: &Data,
    constraint: &Equality,
) -> (Quat, Quat) {
    let ids = [m.eq_obj1id[constraint.id], m.eq_obj2id[constraint.id]].map(|id| id as usize);
    if m.eq_objtype[constraint.id] == ObjectType::Body {
        let data = &m.eq_data[constraint.id];
        let pose = [data[6], data[7], data[8], data[9]];
        (O::mul_quat(d.xquat[ids[0]], pose), inverse(d.xquat[ids[1]]))
    } else {
        let [b1, b2] = constraint.bodies;
        let back = inverse(O::mul_quat(d.xquat[b2], m.site_quat[ids[1]]));
        (O::mul_quat(d.xquat[b1], m.site_quat[ids[0]]), back)
    }
}

/// The torque, in the world, of a weld's orientation rows.
pub(in crate::physics) fn weld_torque(
    m: &Model,
    d: &Data,
    constraint: &Equality,
    rows: Vec3,
) -> Vec3 {
    if m.revision.adds_in_pairs() {
        turned_back::<Pairwise>(m, d, constraint, rows)
    } else {
        turned_back::<InTurn>(m, d, constraint, rows)
    }
}

fn turned_back<O: Order>(m: &Model, d: &Data, constraint: &Equality, rows: Vec3) -> Vec3 {
    let (ahead, back) = orientations::<O>(m, d, constraint);
    let half = 0.5 * m.eq_data[constraint.id][10];
    let turned = mul_quat_axis::<O>(inverse(back), rows);
    let [_, x, y, z] = O::mul_quat(turned, inverse(ahead));
    [x, y, z].map(|x| half * x)
}

fn bodies<O: Order>(m: &Model, d: &mut Data, constraint: &Equality) {
    let points = anchors(m, d, constraint);
    let weld = constraint.kind == EqualityType::Weld;
    let [b1, b2] = constraint.bodies;
    let apart = sub(points[0], points[1]);
    let mut pos = [0.0; 6];
    pos[..3].copy_from_slice(&apart);
    let data = &m.eq_data[constraint.id];
    let torque = data[10];
    let identity: Quat = [1.0, 0.0, 0.0, 0.0];
    let (mut ahead, mut back) = (identity, identity);
    if weld {
        (ahead, back) = orientations::<O>(m, d, constraint);
        let error = O::mul_quat(back, ahead);
        for k in 0..3 {
            pos[3 + k] = error[1 + k] * torque;
        }
    }
    let rows = constraint.kind.rows();
    let (chain1, chain2) = (m.plan().chain(b1), m.plan().chain(b2));
    let last = chain1.last().max(chain2.last());
    let Some(&last) = last else { return };
    let efc = &mut d.efc;
    let tree = m.dof_treeid[*chain1.last().or(chain2.last()).unwrap_or(&last)];
    let source = Source::Equality(constraint.id);
    let row = push_block(efc, source, Kind::Equality, rows, last / 4 + 1, tree);
    for dof in 0..=last {
        let (first, second) = (chain1.contains(&dof), chain2.contains(&dof));
        if !first && !second {
            continue;
        }
        let ends = [(first, b1, points[0]), (second, b2, points[1])];
        let shift = moves_apart(m, &d.cdof, &d.subtree_com, dof, ends);
        for (k, shift) in shift.into_iter().enumerate() {
            set_row(efc, row + k, dof, shift);
        }
        if weld {
            let axis = rotation(&d.cdof[dof]);
            let own = |moved: bool| if moved { axis } else { [0.0; 3] };
            let turn = sub(own(first), own(second));
            let turned = O::mul_quat(mul_quat_axis::<O>(back, turn), ahead);
            for k in 0..3 {
                set_row(efc, row + 3 + k, dof, 0.5 * turned[1 + k] * torque);
            }
        }
    }
    if !m.plan().sparse && drop_zeros(&mut d.efc, row) {
        return;
    }
    let efc = &mut d.efc;
    let distance = dot_slices(&pos[..rows], &pos[..rows]).sqrt();
    for k in 0..rows {
        let diag = constraint.diag[usize::from(k > 2)];
        push_rows(efc, &constraint.softness, (pos[k], distance), 0.0, diag, 1);
    }
}

/// If the Jacobian of the last block, which begins at row `row`, is zero: removes the block, and
/// returns true. MuJoCo adds no such constraints to dense Jacobians.
fn drop_zeros(efc: &mut Constraints, row: usize) -> bool {
    let zero = efc.jacobian()[row * efc.stride()..]
        .as_flattened()
        .iter()
        .all(|x| *x == 0.0);
    if zero {
        efc.pop_block();
    }
    zero
}

/// The product of a quaternion and an axis: MuJoCo's `mju_mulQuatAxis`.
pub(in crate::physics) fn mul_quat_axis<O: Order>(q: Quat, a: Vec3) -> Quat {
    [
        -q[1] * a[0] - q[2] * a[1] - q[3] * a[2],
        O::axis_first(q[0] * a[0], q[2] * a[2], -q[3] * a[1]),
        q[0] * a[1] + q[3] * a[0] - q[1] * a[2],
        O::axis_last(q[0] * a[2], q[1] * a[1], -q[2] * a[0]),
    ]
}

/// The error of a joint or tendon equality, and its derivative by the position of the second joint
/// or tendon: the first position is a polynomial of the second, or constant.
pub(in crate::physics) fn polynomial_error(m: &Model, d: &Data, constraint: &Equality) -> [f64; 2] {
    let place = |id: usize| {
        if constraint.kind == EqualityType::Joint {
            let p = m.jnt_qposadr[id];
            (d.qpos[p], m.qpos0[p])
        } else {
            (d.ten_length[id], m.tendon_length0[id])
        }
    };
    let data = &m.eq_data[constraint.id];
    let (now, rest) = place(m.eq_obj1id[constraint.id] as usize);
    let Ok(second) = usize::try_from(m.eq_obj2id[constraint.id]) else {
        return [now - rest - data[0], 0.0];
    };
    let (now2, rest2) = place(second);
    let x = now2 - rest2;
    let pos = now
        - rest
        - data[0]
        - (data[1] * x + data[2] * x * x + data[3] * x * x * x + data[4] * x * x * x * x);
    let slope = data[1] + 2.0 * data[2] * x + 3.0 * data[3] * x * x + 4.0 * data[4] * x * x * x;
    [pos, -slope]
}

/// Adds the row of a joint or tendon equality.
fn polynomial(m: &Model, d: &mut Data, constraint: &Equality) {
    let joint = constraint.kind == EqualityType::Joint;
    let [pos, slope] = polynomial_error(m, d, constraint);
    let ids = [m.eq_obj1id[constraint.id], m.eq_obj2id[constraint.id]];
    let objects = ids.map(|id| usize::try_from(id).ok());
    let source = (Source::Equality(constraint.id), Kind::Equality);
    let Some(row) = push_scalar(m, d, joint, &objects, source) else {
        return;
    };
    for (object, factor) in objects.into_iter().zip([1.0, slope]) {
        let Some(object) = object else { continue };
        if joint {
            add_row(&mut d.efc, row, m.jnt_dofadr[object], factor);
        } else {
            let paths = &m.plan().paths;
            for e in paths.rows[object].clone() {
                add_row(&mut d.efc, row, paths.columns[e], d.ten_j[e] * factor);
            }
        }
    }
    if !m.plan().sparse && drop_zeros(&mut d.efc, row) {
        return;
    }
    let stiff = (&constraint.softness, constraint.diag[0]);
    push_row(&mut d.efc, stiff, pos, 0.0);
}

fn add_row(efc: &mut Constraints, row: usize, dof: usize, value: f64) {
    let stride = efc.stride();
    efc.jacobian_mut()[row * stride..].as_flattened_mut()[dof] += value;
}
