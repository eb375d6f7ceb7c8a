//! The arrays of constraint rows, and the islands that constraints form. [`rows`](super::rows) fills
//! them.
//!
//! Rows belong to blocks, one for each constraint. They are dense, because libmujoco sums over zeros
//! too; see [`dense`](crate::math::dense).

use std::ops::Range;

use super::{adhesion, bias, surface};
use crate::math::dense::{self, Lanes};
use crate::model::{Bounds, Disable};
use crate::{Data, Model};

/// The constraints of the last forward call: MuJoCo's `efc_*` arrays.
///
/// Rows of limits come first, by joint, lower before upper; then those of contacts, in their order.
#[derive(Clone, Debug, Default)]
pub struct Constraints {
    /// The constraint that each group of rows belongs to.
    pub(crate) blocks: Vec<Block>,
    /// The Jacobian: `stride` groups of four numbers for each row.
    jac: Vec<Lanes>,
    stride: usize,
    /// The degrees of freedom of each block's rows, ascending, if the model is sparse.
    pub(super) columns: Vec<usize>,
    /// Whether products with the Jacobian are sums over `columns` alone.
    pub(super) sparse: bool,
    /// Distance to the constraint; negative where it is violated.
    pub pos: Vec<f64>,
    /// The constraint acts where `pos` is below this margin.
    pub margin: Vec<f64>,
    /// Regularisation: inverse of `d`.
    pub r: Vec<f64>,
    /// Inverse of the regularisation, the stiffness of the row: MuJoCo's `efc_D`.
    pub d: Vec<f64>,
    /// Stiffness, damping, impedance, derivative of the impedance: MuJoCo's `efc_KBIP`.
    pub kbip: Vec<[f64; 4]>,
    /// Velocity in the space of the constraints: `J qvel`.
    pub vel: Vec<f64>,
    /// Reference acceleration.
    pub aref: Vec<f64>,
    /// The difference between the acceleration without constraints and the reference: `J
    /// qacc_smooth - aref`.
    pub b: Vec<f64>,
    /// Constraint force.
    pub force: Vec<f64>,
    /// Friction loss; ends with the last row of dry friction.
    pub loss: Vec<f64>,
    /// The island of each row.
    pub island: Vec<usize>,
    /// Number of islands.
    pub nisland: usize,
}

/// The rows of one constraint.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// The joint, tendon, contact or equality that causes the constraint.
    pub(crate) source: Source,
    /// In which directions the rows act.
    pub(crate) kind: Kind,
    /// First row.
    pub(crate) row: usize,
    /// Number of rows.
    pub(crate) rows: usize,
    /// The Jacobians are zero from this group on.
    pub(crate) groups: usize,
    /// The rows' part of [`Constraints::columns`].
    pub(crate) columns: Range<usize>,
    /// A tree that the constraint acts on.
    pub(crate) tree: usize,
    pub(crate) island: usize,
}

/// In which directions the rows of a block act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// In both directions.
    Equality,
    /// In both directions, up to the friction loss.
    Friction,
    /// In one direction: forces are not negative.
    OneSided,
    /// Inequality: the force is within an elliptic friction cone.
    Cone,
}

/// The cause of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// An equality constraint.
    Equality(usize),
    /// Dry friction of a degree of freedom.
    DofFriction(usize),
    /// Dry friction of a tendon.
    TendonFriction(usize),
    /// The limit of a joint.
    Limit(usize),
    /// The limit of a tendon.
    TendonLimit(usize),
    Contact(usize),
}

macro_rules! columns {
    ($efc:ident) => {
        [
            &mut $efc.pos,
            &mut $efc.margin,
            &mut $efc.r,
            &mut $efc.d,
            &mut $efc.vel,
            &mut $efc.aref,
            &mut $efc.b,
            &mut $efc.force,
        ]
    };
}

impl Constraints {
    /// Number of rows.
    #[must_use]
    pub fn nefc(&self) -> usize {
        self.pos.len()
    }

    /// Allocates the largest number of rows that the model can have.
    pub(crate) fn reserve(&mut self, bounds: &Bounds, nv: usize, sparse: bool) {
        self.stride = dense::groups(nv);
        if sparse {
            self.columns.reserve(bounds.blocks * nv);
        }
        self.blocks.reserve(bounds.blocks);
        self.jac.reserve(bounds.rows * self.stride);
        for column in columns!(self) {
            column.reserve(bounds.rows);
        }
        self.kbip.reserve(bounds.rows);
        self.island.reserve(bounds.rows);
        self.loss.reserve(bounds.rows);
    }

    pub(crate) fn clear(&mut self) {
        self.blocks.clear();
        self.jac.clear();
        for column in columns!(self) {
            column.clear();
        }
        self.kbip.clear();
        self.loss.clear();
        self.island.clear();
        self.columns.clear();
        self.nisland = 0;
    }

    /// Computes `J x`, for the number `n` of degrees of freedom.
    #[inline(always)]
    pub(crate) fn multiply(&self, x: &[Lanes], n: usize, out: &mut [f64]) {
        if self.sparse {
            self.multiply_sparse(x.as_flattened(), out);
        } else {
            mul_jacobian(&self.blocks, &self.jac, self.stride, x, n, out);
        }
    }

    #[inline(never)]
    fn multiply_sparse(&self, x: &[f64], out: &mut [f64]) {
        for block in &self.blocks {
            let columns = &self.columns[block.columns.clone()];
            for row in block.row..block.row + block.rows {
                out[row] = dense::dot_at(self.row(row), x, columns);
            }
        }
    }

    /// The Jacobian, row by row.
    #[inline]
    pub(crate) fn jacobian(&self) -> &[Lanes] {
        &self.jac
    }

    /// A row of the Jacobian, padded with zeros.
    pub(super) fn row(&self, row: usize) -> &[f64] {
        self.jac[row * self.stride..][..self.stride].as_flattened()
    }

    /// Removes the last block, to which no rows were pushed yet.
    pub(super) fn pop_block(&mut self) {
        if let Some(block) = self.blocks.pop() {
            self.jac.truncate(block.row * self.stride);
        }
    }

    /// The Jacobian, row by row, mutable.
    #[inline]
    pub(super) fn jacobian_mut(&mut self) -> &mut [Lanes] {
        &mut self.jac
    }

    /// The number of groups of four per row.
    #[inline]
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// The approximate diagonal of `J M^-1 J'`, to which the regularisation corresponds: MuJoCo's
    /// `efc_diagA`.
    #[doc(alias = "efc_diagApprox")]
    #[must_use]
    pub fn diag_approx(&self) -> Vec<f64> {
        let rows = self.r.iter().zip(&self.kbip);
        rows.map(|(r, [_, _, impedance, _])| r * impedance / (1.0 - impedance))
            .collect()
    }

    /// The whole Jacobian, row by row (nefc * nv numbers): MuJoCo's `efc_J`.
    #[must_use]
    pub fn full_jacobian(&self, nv: usize) -> Vec<f64> {
        let rows = self.jac.chunks(self.stride.max(1));
        let elements = rows.flat_map(|row| &row.as_flattened()[..nv]);
        elements.copied().collect()
    }
}

/// Computes `J x` for some blocks, row by row.
#[inline(never)]
pub(crate) fn mul_jacobian(
    blocks: &[Block],
    jac: &[Lanes],
    stride: usize,
    x: &[Lanes],
    n: usize,
    out: &mut [f64],
) {
    for block in blocks {
        let rows = jac[block.row * stride..(block.row + block.rows) * stride].chunks_exact(stride);
        for (out, row) in out[block.row..block.row + block.rows].iter_mut().zip(rows) {
            *out = dense::dot(&row[..block.groups], x, n);
        }
    }
}

/// Adds a block whose rows are zero, and returns its first row.
#[inline(always)]
pub(super) fn push_block(
    efc: &mut Constraints,
    source: Source,
    kind: Kind,
    rows: usize,
    groups: usize,
    tree: usize,
) -> usize {
    let row = efc.nefc();
    efc.blocks.push(Block {
        source,
        kind,
        row,
        rows,
        groups,
        columns: 0..0,
        tree,
        island: 0,
    });
    efc.jac.resize((row + rows) * efc.stride, [0.0; 4]);
    row
}

/// Sets element `dof` of the Jacobian of row `row`.
#[inline(always)]
pub(super) fn set_row(efc: &mut Constraints, row: usize, dof: usize, value: f64) {
    efc.jac[row * efc.stride..].as_flattened_mut()[dof] = value;
}

/// Computes velocities and reference accelerations of all rows: MuJoCo's `mj_referenceConstraint`.
#[inline(always)]
pub fn reference_constraint(m: &Model, d: &mut Data) {
    let (efc, x) = (&mut d.efc, &mut d.work.dofs);
    if efc.blocks.is_empty() {
        return;
    }
    dense::put(x, &d.qvel);
    let mut velocities = std::mem::take(&mut efc.vel);
    efc.multiply(x, m.nv(), &mut velocities);
    efc.vel = velocities;
    if m.plan().surfaces {
        surface::add_velocities(m, d);
    }
    let efc = &mut d.efc;
    for i in 0..efc.pos.len() {
        let [stiffness, damping, impedance, _] = efc.kbip[i];
        efc.aref[i] = -damping * efc.vel[i] - stiffness * impedance * (efc.pos[i] - efc.margin[i]);
    }
    if m.plan().adhesive {
        adhesion::shift_references(m, d);
    }
    if !m.plan().constraints.equalities.is_empty() {
        bias::subtract(m, d);
    }
}

/// Groups the trees that constraints connect into islands: MuJoCo's `mj_island`.
pub(super) fn islands(m: &Model, d: &mut Data) {
    let trees = m.plan().trees.len();
    let work = &mut d.work;
    work.tree_island.clear();
    work.tree_island.resize(trees, usize::MAX);
    if d.efc.blocks.is_empty() {
        return;
    }
    if trees == 1 || m.opt.disables(Disable::Island) {
        work.tree_island.fill(0);
        d.efc.nisland = 1;
        return;
    }
    // for each tree, the smallest index of a connected tree
    let least = &mut work.tree_least;
    least.clear();
    least.extend(0..trees);
    fn find(least: &[usize], mut tree: usize) -> usize {
        while least[tree] != tree {
            tree = least[tree];
        }
        tree
    }
    let mut join = |t1: usize, t2: usize| {
        let (a, b) = (find(least, t1), find(least, t2));
        least[a.max(b)] = a.min(b);
    };
    for block in &d.efc.blocks {
        let of_bodies = match block.source {
            Source::Equality(id) => m.plan().constraints.of_bodies(id),
            _ => None,
        };
        match (block.source, of_bodies) {
            (Source::Limit(_) | Source::DofFriction(_), _) => {}
            (Source::Contact(index), _) => {
                if let [Some(t1), Some(t2)] = m.plan().pairs[d.contact[index].pair].trees {
                    join(t1, t2);
                }
            }
            // both trees, even if one body does not move the point
            (_, Some(equality)) => {
                let trees = equality
                    .bodies
                    .map(|body| usize::try_from(m.body_treeid[body]));
                if let [Ok(t1), Ok(t2)] = trees {
                    join(t1, t2);
                }
            }
            _ if d.efc.sparse => {
                for &dof in &d.efc.columns[block.columns.clone()] {
                    join(block.tree, m.dof_treeid[dof]);
                }
            }
            _ => {
                let rows = block.row * d.efc.stride..(block.row + block.rows) * d.efc.stride;
                for row in d.efc.jac[rows].chunks(d.efc.stride) {
                    let numbers = row.as_flattened()[..m.nv()].iter().enumerate();
                    for (dof, _) in numbers.filter(|(_, x)| **x != 0.0) {
                        join(block.tree, m.dof_treeid[dof]);
                    }
                }
            }
        }
    }
    // islands are numbered in the order of their smallest trees
    work.tree_touched.clear();
    work.tree_touched.resize(trees, false);
    for block in &d.efc.blocks {
        work.tree_touched[find(least, block.tree)] = true;
    }
    let mut number = 0;
    for tree in 0..trees {
        let root = find(least, tree);
        if work.tree_touched[root] {
            if root == tree {
                work.tree_island[tree] = number;
                number += 1;
            } else {
                work.tree_island[tree] = work.tree_island[root];
            }
        }
    }
    let efc = &mut d.efc;
    efc.nisland = number;
    for block in &mut efc.blocks {
        block.island = work.tree_island[block.tree];
        efc.island[block.row..block.row + block.rows].fill(block.island);
    }
}
