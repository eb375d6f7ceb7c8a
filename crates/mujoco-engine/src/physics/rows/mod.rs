//! The rows of constraints, by their cause.
//!
//! | file | rows of |
//! |---|---|
//! | `equality` | connects, welds, joints and tendons that are tied |
//! | `friction` | dry friction of joints and tendons |
//! | `limit` | limits of joints and tendons |
//! | `contact` | contacts |
//!
//! `columns` lists the degrees of freedom of each row.
//!
//! A limit has one row, and so has a contact without friction. A contact with friction has four
//! rows, one for each edge of its pyramid: `n + mu t1`, `n - mu t1`, `n + mu t2` and `n - mu t2`,
//! where `n`, `t1` and `t2` are the Jacobians of the normal and the two tangents. The functions
//! that worlds in lanes share are generic over [`Number`](crate::math::number::Number).

mod columns;
mod contact;
mod equality;
mod friction;
mod limit;

use super::constraint::{Constraints, Kind, Source, islands, push_block, set_row};
use crate::math::libm;
use crate::model::Softness;
use crate::{Data, Model};
pub(in crate::physics) use contact::{contact_jacobian, pyramid};
pub(in crate::physics) use equality::{
    anchors, mul_quat_axis, orientations, polynomial_error, weld_torque,
};
pub(in crate::physics) use limit::reached_limits;

/// Builds all rows: MuJoCo's `mj_makeConstraint`, with `mj_referenceConstraint` once velocities are
/// known.
#[inline(always)]
pub fn make_constraint(m: &Model, d: &mut Data) {
    d.efc.clear();
    if m.plan().constraints.can_pull() {
        equality::equality(m, d);
        friction::friction(m, d);
    }
    limit::joint_limits(m, d);
    if m.ntendon() > 0 {
        limit::tendon_limits(m, d);
    }
    contact::contacts(m, d);
    let efc = &mut d.efc;
    let rows = efc.nefc();
    for column in [&mut efc.vel, &mut efc.aref, &mut efc.b, &mut efc.force] {
        column.resize(rows, 0.0);
    }
    efc.island.resize(rows, 0);
    efc.sparse = m.plan().sparse;
    if efc.sparse {
        columns::list(m, d);
    }
    islands(m, d);
}

/// Adds a block of one row for joints or tendons. `None` if no degree of freedom moves the joints
/// or tendons.
fn push_scalar(
    m: &Model,
    d: &mut Data,
    joint: bool,
    objects: &[Option<usize>],
    (source, kind): (Source, Kind),
) -> Option<usize> {
    let paths = &m.plan().paths;
    let (mut last, mut tree) = (None, None);
    for object in objects.iter().flatten() {
        let mut moves = |dof: usize| {
            (last, tree) = (last.max(Some(dof)), tree.or(Some(m.dof_treeid[dof])));
        };
        if joint {
            moves(m.jnt_dofadr[*object]);
        } else {
            let sparse = m.plan().sparse;
            let moved = paths.rows[*object].clone();
            let moved = moved.filter(|&e| sparse || d.ten_j[e] != 0.0);
            moved.for_each(|e| moves(paths.columns[e]));
        }
    }
    let groups = last? / 4 + 1;
    Some(push_block(&mut d.efc, source, kind, 1, groups, tree?))
}

fn tendon_row(m: &Model, d: &mut Data, row: usize, tendon: usize, factor: f64) {
    let paths = &m.plan().paths;
    for e in paths.rows[tendon].clone() {
        set_row(&mut d.efc, row, paths.columns[e], d.ten_j[e] * factor);
    }
}

/// Sets the one row of a constraint at the position `pos`: see [`push_rows`].
#[inline(always)]
fn push_row(efc: &mut Constraints, (softness, diag): (&Softness, f64), pos: f64, margin: f64) {
    push_rows(efc, softness, (pos, pos), margin, diag, 1);
}

/// Sets position, margin and impedance of the rows of one constraint, all equal: MuJoCo's
/// `mj_makeImpedance`. The columns that later stages compute are left for the end.
#[inline(always)]
fn push_rows(
    efc: &mut Constraints,
    softness: &Softness,
    (pos, distance): (f64, f64),
    margin: f64,
    diag: f64,
    rows: usize,
) {
    let (impedance, slope) = softness.impedance(distance, margin);
    let r = regularization(impedance, diag);
    let rows = efc.pos.len() + rows;
    for (column, value) in [
        (&mut efc.pos, pos),
        (&mut efc.margin, margin),
        (&mut efc.r, r),
        (&mut efc.d, 1.0 / r),
    ] {
        column.resize(rows, value);
    }
    let kbip = [softness.stiffness, softness.damping, impedance, slope];
    efc.kbip.resize(rows, kbip);
}

/// The regularisation of a row with impedance `impedance` and diagonal `diag`.
#[inline(always)]
pub(in crate::physics) fn regularization(impedance: f64, diag: f64) -> f64 {
    f64::max(1e-15, (1.0 - impedance) * diag / impedance)
}

impl Softness {
    /// The impedance at a constraint's position, and its derivative: MuJoCo's `getimpedance`.
    pub(in crate::physics) fn impedance(&self, pos: f64, margin: f64) -> (f64, f64) {
        let (dmin, dmax, width) = (self.dmin, self.dmax, self.width);
        let (midpoint, power) = (self.midpoint, self.power);
        if dmin == dmax || width <= 1e-15 {
            return (0.5 * (dmin + dmax), 0.0);
        }
        let signed = (pos - margin) / width;
        let x = signed.abs();
        if x >= 1.0 {
            return (dmax, 0.0);
        }
        if x == 0.0 {
            return (dmin, 0.0);
        }
        // below the midpoint x^power / midpoint^(power - 1); above it, the same curve mirrored
        let (x, end, turned) = if power == 1.0 || x <= midpoint {
            (x, midpoint, false)
        } else {
            (1.0 - x, 1.0 - midpoint, true)
        };
        let (y, slope) = if power == 1.0 {
            (x, 1.0)
        } else {
            let factor = 1.0 / self::power(end, power - 1.0);
            let slope = power * factor * self::power(x, power - 1.0);
            (factor * self::power(x, power), slope)
        };
        let y = if turned { 1.0 - y } else { y };
        let slope = signed.signum() * slope * (dmax - dmin) / width;
        (dmin + y * (dmax - dmin), slope)
    }
}

/// `x` to the power `exponent`. The common exponents are computed by multiplication, which rounds
/// once.
fn power(x: f64, exponent: f64) -> f64 {
    if exponent == 1.0 {
        x
    } else if exponent == 2.0 {
        x * x
    } else {
        libm::pow(x, exponent)
    }
}
