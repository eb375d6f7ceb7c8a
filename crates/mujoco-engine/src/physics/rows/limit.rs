//! Rows of limits of joints and tendons.

use super::{push_row, push_scalar, tendon_row};
use crate::math::spatial::{InTurn, Order, Pairwise, normalize, quat_to_velocity, scale};
use crate::model::Limit;
use crate::physics::constraint::{Kind, Source, push_block, set_row};
use crate::{Data, Model};

/// Adds the rows of active joint limits: MuJoCo's `mj_instantiateLimit`.
#[inline(always)]
pub(super) fn joint_limits(m: &Model, d: &mut Data) {
    for limit in &m.plan().limits {
        if limit.ball {
            ball_limit(m, d, limit);
            continue;
        }
        let q = d.qpos[limit.qpos];
        let dists = [q - limit.range[0], limit.range[1] - q];
        // most limits are far
        if !dists.iter().any(|dist| *dist < limit.margin) {
            continue;
        }
        if m.plan().sleeps && !d.work.tree_awake[limit.tree] {
            continue;
        }
        for (side, dist) in [1.0, -1.0].into_iter().zip(dists) {
            if dist < limit.margin {
                let efc = &mut d.efc;
                let source = Source::Limit(limit.joint);
                let groups = limit.dof / 4 + 1;
                let row = push_block(efc, source, Kind::OneSided, 1, groups, limit.tree);
                set_row(efc, row, limit.dof, side);
                push_row(efc, (&limit.softness, limit.diag), dist, limit.margin);
            }
        }
    }
}

/// Adds the row of a ball joint's limit, which bounds the angle from its initial orientation.
#[inline(never)]
fn ball_limit(m: &Model, d: &mut Data, limit: &Limit) {
    let p = limit.qpos;
    let quat = [0, 1, 2, 3].map(|k| d.qpos[p + k]);
    let quat = if m.revision.adds_in_pairs() {
        Pairwise::normalize_quat((), quat)
    } else {
        InTurn::normalize_quat((), quat)
    };
    let (axis, angle) = normalize(quat_to_velocity(quat));
    let dist = limit.range[0].max(limit.range[1]) - angle;
    if dist >= limit.margin {
        return;
    }
    if m.plan().sleeps && !d.work.tree_awake[limit.tree] {
        return;
    }
    let efc = &mut d.efc;
    let source = Source::Limit(limit.joint);
    let groups = (limit.dof + 2) / 4 + 1;
    let row = push_block(efc, source, Kind::OneSided, 1, groups, limit.tree);
    for (k, x) in scale(axis, -1.0).into_iter().enumerate() {
        set_row(efc, row, limit.dof + k, x);
    }
    push_row(efc, (&limit.softness, limit.diag), dist, limit.margin);
}

/// Adds the rows of active tendon limits.
#[inline(never)]
pub(super) fn tendon_limits(m: &Model, d: &mut Data) {
    for constraint in &m.plan().constraints.tendon_limits {
        let (t, margin) = (constraint.id, m.tendon_margin[constraint.id]);
        for (side, dist) in reached_limits(m, t, d.ten_length[t]) {
            let source = (Source::TendonLimit(t), Kind::OneSided);
            if let Some(row) = push_scalar(m, d, false, &[Some(t)], source) {
                tendon_row(m, d, row, t, -side);
                let stiff = (&constraint.softness, constraint.diag);
                push_row(&mut d.efc, stiff, dist, margin);
            }
        }
    }
}

/// The limits that a tendon of this length has reached: -1 for the lower limit or 1 for the upper
/// one, and the distance from it.
pub(in crate::physics) fn reached_limits(
    m: &Model,
    tendon: usize,
    length: f64,
) -> impl Iterator<Item = (f64, f64)> {
    let margin = m.tendon_margin[tendon];
    let limits = [-1.0, 1.0].into_iter().zip(m.tendon_range[tendon]);
    limits.filter_map(move |(side, bound)| {
        let dist = side * (bound - length);
        // a distance that is not a number counts as reached
        if dist >= margin {
            None
        } else {
            Some((side, dist))
        }
    })
}
