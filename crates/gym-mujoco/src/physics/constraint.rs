//! Constraint rows: limits of joints and contacts, their Jacobians, impedances and reference accelerations.
//!
//! Rows belong to blocks: a limit is one row, a contact without friction is one, a contact with friction is a pyramid of four,
//! `n + mu t1, n - mu t1, n + mu t2, n - mu t2`, of the Jacobians of the normal and the two tangents. The three are kept, the four
//! follow from them.

use serde::{Deserialize, Serialize};

use super::spatial::{Vec3, add, cross, dot, rotate, sub};
use crate::libm;
use crate::model::{Bounds, Pair, Softness};
use crate::{Data, Model};

/// The constraints of the last forward call: MuJoCo's `efc_*` arrays.
///
/// Rows of limits come first, by joint, lower before upper; then those of contacts, in their order.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Constraints {
    /// What the rows belong to. This and the Jacobians are not stored: the next forward call makes them anew.
    #[serde(skip)]
    pub(crate) blocks: Vec<Block>,
    /// Degrees of freedom of the blocks' Jacobians.
    #[serde(skip)]
    pub(crate) columns: Vec<usize>,
    /// The blocks' Jacobians: of the normal, then of the tangents.
    #[serde(skip)]
    pub(crate) jac: Vec<f64>,
    /// Distance to the constraint; negative where it is violated.
    pub pos: Vec<f64>,
    /// The constraint acts where the distance is below this.
    pub margin: Vec<f64>,
    /// Approximate diagonal of `J M^-1 J'`.
    #[doc(alias = "efc_diagApprox")]
    pub diag_approx: Vec<f64>,
    /// Regularisation: inverse of `d`.
    pub r: Vec<f64>,
    /// Stiffness that the solver sees.
    pub d: Vec<f64>,
    /// Stiffness, damping, impedance, derivative of the impedance: MuJoCo's `efc_KBIP`.
    pub kbip: Vec<[f64; 4]>,
    /// Velocity in the space of the constraints: `J qvel`.
    pub vel: Vec<f64>,
    /// Reference acceleration.
    pub aref: Vec<f64>,
    /// Force.
    pub force: Vec<f64>,
    /// The island of each row.
    pub island: Vec<usize>,
    /// Number of islands.
    pub nisland: usize,
}

/// A limit or a contact.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// Joint or contact.
    pub(crate) source: Source,
    /// First row.
    pub(crate) row: usize,
    /// Normals and tangents of the blocks before.
    pub(crate) direction: usize,
    /// First column.
    pub(crate) column: usize,
    /// Number of columns.
    pub(crate) width: usize,
    /// First element of the Jacobian.
    pub(crate) jac: usize,
    /// Rows of the Jacobian: 1 or 3.
    pub(crate) dim: usize,
    /// Friction.
    pub(crate) mu: f64,
    /// A tree of the block.
    pub(crate) tree: usize,
    pub(crate) island: usize,
}

/// What a block stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    Limit(usize),
    Contact(usize),
}

impl Block {
    /// Number of rows.
    #[inline]
    pub(crate) fn rows(&self) -> usize {
        if self.dim == 1 { 1 } else { 4 }
    }
}

impl Constraints {
    /// Number of rows.
    #[must_use]
    pub fn nefc(&self) -> usize {
        self.pos.len()
    }

    /// Number of normals and tangents.
    fn directions(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.direction + block.dim)
    }

    /// Makes room for the most constraints that there can be.
    pub(crate) fn reserve(&mut self, bounds: &Bounds) {
        self.blocks.reserve(bounds.blocks);
        self.columns.reserve(bounds.columns);
        self.jac.reserve(bounds.jac);
        for column in [
            &mut self.pos,
            &mut self.margin,
            &mut self.diag_approx,
            &mut self.r,
            &mut self.d,
            &mut self.vel,
            &mut self.aref,
            &mut self.force,
        ] {
            column.reserve(bounds.rows);
        }
        self.kbip.reserve(bounds.rows);
        self.island.reserve(bounds.rows);
    }

    pub(crate) fn clear(&mut self) {
        self.blocks.clear();
        self.columns.clear();
        self.jac.clear();
        for column in [
            &mut self.pos,
            &mut self.margin,
            &mut self.diag_approx,
            &mut self.r,
            &mut self.d,
            &mut self.vel,
            &mut self.aref,
            &mut self.force,
        ] {
            column.clear();
        }
        self.kbip.clear();
        self.island.clear();
        self.nisland = 0;
    }

    /// The block's columns, and its Jacobian.
    #[inline]
    pub(crate) fn jacobian(&self, block: &Block) -> (&[usize], &[f64]) {
        (
            &self.columns[block.column..block.column + block.width],
            &self.jac[block.jac..block.jac + block.width * block.dim],
        )
    }

    /// `J x` of one block, without friction's pyramid: along the normal and the tangents.
    #[inline]
    pub(crate) fn along(&self, block: &Block, x: &[f64]) -> [f64; 3] {
        let (columns, jac) = self.jacobian(block);
        if block.dim == 1 {
            return [columns.iter().zip(jac).map(|(&c, j)| j * x[c]).sum(), 0.0, 0.0];
        }
        let (n, rest) = jac.split_at(block.width);
        let (t1, t2) = rest.split_at(block.width);
        let mut sum = [0.0; 3];
        for (((&c, n), t1), t2) in columns.iter().zip(n).zip(t1).zip(t2) {
            let x = x[c];
            sum[0] += n * x;
            sum[1] += t1 * x;
            sum[2] += t2 * x;
        }
        sum
    }

    /// `out += J' force`, for one block.
    #[inline]
    pub(crate) fn add_jac_t(&self, block: &Block, force: &[f64], out: &mut [f64]) {
        let (columns, jac) = self.jacobian(block);
        let f = frame_force(block, force);
        if f == [0.0; 3] {
            return;
        }
        if block.dim == 1 {
            for (&c, j) in columns.iter().zip(jac) {
                out[c] += j * f[0];
            }
            return;
        }
        let (n, rest) = jac.split_at(block.width);
        let (t1, t2) = rest.split_at(block.width);
        for (((&c, n), t1), t2) in columns.iter().zip(n).zip(t1).zip(t2) {
            out[c] += n * f[0] + t1 * f[1] + t2 * f[2];
        }
    }

    /// The whole Jacobian, row by row (nefc * nv numbers): MuJoCo's `efc_J`.
    #[must_use]
    pub fn full_jacobian(&self, nv: usize) -> Vec<f64> {
        let mut full = vec![0.0; self.nefc() * nv];
        for block in &self.blocks {
            let (columns, jac) = self.jacobian(block);
            for (k, &c) in columns.iter().enumerate() {
                let along = [0, 1, 2].map(|i| if i < block.dim { jac[i * block.width + k] } else { 0.0 });
                let mut rows = [0.0; 4];
                put_rows(&Block { row: 0, ..block.clone() }, along, &mut rows);
                for r in 0..block.rows() {
                    full[(block.row + r) * nv + c] = rows[r];
                }
            }
        }
        full
    }
}

/// Rows of a block from what happens along its normal and tangents.
#[inline]
pub(crate) fn put_rows(block: &Block, along: [f64; 3], rows: &mut [f64]) {
    let [n, t1, t2] = along;
    if block.dim == 1 {
        rows[block.row] = n;
    } else {
        let (t1, t2) = (block.mu * t1, block.mu * t2);
        rows[block.row..block.row + 4].copy_from_slice(&[n + t1, n - t1, n + t2, n - t2]);
    }
}

/// The force along normal and tangents from the forces of a block's rows: MuJoCo's `mju_decodePyramid`.
#[inline]
pub(crate) fn frame_force(block: &Block, force: &[f64]) -> Vec3 {
    if block.dim == 1 {
        return [force[block.row], 0.0, 0.0];
    }
    let f = &force[block.row..block.row + 4];
    [(f[0] + f[1]) + (f[2] + f[3]), (f[0] - f[1]) * block.mu, (f[2] - f[3]) * block.mu]
}

/// Makes all rows: MuJoCo's `mj_makeConstraint`, with `mj_referenceConstraint` once velocities are known.
pub fn make_constraint(m: &Model, d: &mut Data) {
    d.efc.clear();
    limits(m, d);
    contacts(m, d);
    islands(m, d);
}

/// Rows of the limits that are near: MuJoCo's `mj_instantiateLimit`.
fn limits(m: &Model, d: &mut Data) {
    for limit in &m.plan().limits {
        let q = d.qpos[limit.qpos];
        for (side, dist) in [(1.0, q - limit.range[0]), (-1.0, limit.range[1] - q)] {
            if dist < limit.margin {
                let (column, jac) = (d.efc.columns.len(), d.efc.jac.len());
                let direction = d.efc.directions();
                d.efc.columns.push(limit.dof);
                d.efc.jac.push(side);
                let source = Source::Limit(limit.joint);
                let row = d.efc.nefc();
                let tree = limit.tree;
                d.efc.blocks.push(Block {
                    source,
                    row,
                    direction,
                    column,
                    width: 1,
                    jac,
                    dim: 1,
                    mu: 0.0,
                    tree,
                    island: 0,
                });
                push_row(&mut d.efc, &limit.softness, dist, limit.margin, limit.diag);
            }
        }
    }
}

/// Rows of the contacts that act: MuJoCo's `mj_instantiateContact`.
fn contacts(m: &Model, d: &mut Data) {
    for index in 0..d.contact.len() {
        let contact = &mut d.contact[index];
        if contact.dist >= contact.includemargin {
            continue;
        }
        let pair = &m.plan().pairs[contact.pair];
        let Some(tree) = pair.trees[0].or(pair.trees[1]) else { continue };
        let efc = &mut d.efc;
        contact.efc_address = efc.nefc() as i32;
        let dim = usize::from(contact.dim);
        let mu = if dim == 1 { 0.0 } else { contact.friction[0] };
        contact.mu = mu;

        let (column, jac, width) = (efc.columns.len(), efc.jac.len(), pair.columns.len());
        efc.columns.extend(pair.columns.iter().map(|column| column.dof));
        efc.jac.resize(jac + dim * width, 0.0);
        contact_jacobian(pair, &d.cdof, &d.subtree_com, contact.pos, &contact.frame, &mut efc.jac[jac..]);

        let (row, direction) = (efc.nefc(), efc.directions());
        efc.blocks.push(Block {
            source: Source::Contact(index),
            row,
            direction,
            column,
            width,
            jac,
            dim,
            mu,
            tree,
            island: 0,
        });
        if dim == 1 {
            push_row(efc, &pair.softness, contact.dist, contact.includemargin, pair.diag);
        } else {
            let diag = pair.diag + mu * mu * pair.diag;
            for _ in 0..4 {
                push_row(efc, &pair.softness, contact.dist, contact.includemargin, diag);
            }
            // a pyramid as soft as the cone within it
            let r = f64::max(1e-15, 2.0 * mu * mu * efc.r[row]);
            efc.r[row..].fill(r);
            efc.d[row..].fill(1.0 / r);
        }
    }
}

/// How the contact point moves, on the second body against the first, along the contact's frame.
#[inline]
fn contact_jacobian(
    pair: &Pair,
    cdof: &[[f64; 6]],
    com: &[Vec3],
    pos: Vec3,
    frame: &[f64; 9],
    jac: &mut [f64],
) {
    let width = pair.columns.len();
    for (k, column) in pair.columns.iter().enumerate() {
        let c = &cdof[column.dof];
        let offset = sub(pos, com[column.root]);
        let moves = add([c[3], c[4], c[5]], cross([c[0], c[1], c[2]], offset));
        if jac.len() == width {
            jac[k] = column.sign * dot([frame[0], frame[1], frame[2]], moves);
        } else {
            let along = rotate(frame, moves);
            for i in 0..3 {
                jac[i * width + k] = column.sign * along[i];
            }
        }
    }
}

/// A row at some distance: MuJoCo's `mj_makeImpedance`.
fn push_row(efc: &mut Constraints, softness: &Softness, pos: f64, margin: f64, diag: f64) {
    let (impedance, slope) = softness.impedance(pos, margin);
    let r = f64::max(1e-15, (1.0 - impedance) * diag / impedance);
    efc.pos.push(pos);
    efc.margin.push(margin);
    efc.diag_approx.push(diag);
    efc.r.push(r);
    efc.d.push(1.0 / r);
    efc.kbip.push([softness.stiffness, softness.damping, impedance, slope]);
    efc.vel.push(0.0);
    efc.aref.push(0.0);
    efc.force.push(0.0);
    efc.island.push(0);
}

impl Softness {
    /// How much of the acceleration wanted a constraint gives, as a function of its position, and the derivative: MuJoCo's
    /// `getimpedance`.
    fn impedance(&self, pos: f64, margin: f64) -> (f64, f64) {
        let &Self { dmin, dmax, width, midpoint, power, .. } = self;
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
        // x^power / midpoint^(power - 1) below the midpoint, and the same turned around above
        let (x, end, turned) =
            if x <= midpoint { (x, midpoint, false) } else { (1.0 - x, 1.0 - midpoint, true) };
        let (y, slope) = if power == 1.0 {
            (x, 1.0)
        } else if power == 2.0 {
            (x * x / end, 2.0 * x / end)
        } else {
            let end = libm::pow(end, power - 1.0);
            (libm::pow(x, power) / end, power * libm::pow(x, power - 1.0) / end)
        };
        let y = if turned { 1.0 - y } else { y };
        (dmin + y * (dmax - dmin), signed.signum() * slope * (dmax - dmin) / width)
    }
}

/// Velocities and reference accelerations of all rows: MuJoCo's `mj_referenceConstraint`.
pub fn reference_constraint(_m: &Model, d: &mut Data) {
    let efc = &mut d.efc;
    for index in 0..efc.blocks.len() {
        let block = &efc.blocks[index];
        let along = efc.along(block, &d.qvel);
        put_rows(block, along, &mut efc.vel);
    }
    for i in 0..efc.pos.len() {
        let [stiffness, damping, impedance, _] = efc.kbip[i];
        efc.aref[i] = -damping * efc.vel[i] - stiffness * impedance * (efc.pos[i] - efc.margin[i]);
    }
}

/// Sets of trees that constraints join: MuJoCo's `mj_island`.
fn islands(m: &Model, d: &mut Data) {
    let trees = m.plan().trees.len();
    let work = &mut d.work;
    work.tree_island.clear();
    work.tree_island.resize(trees, usize::MAX);
    if d.efc.blocks.is_empty() {
        return;
    }
    if trees == 1 {
        work.tree_island[0] = 0;
        d.efc.nisland = 1;
        return;
    }
    // the smallest tree that each tree is joined to
    let least = &mut work.tree_least;
    least.clear();
    least.extend(0..trees);
    fn find(least: &[usize], mut tree: usize) -> usize {
        while least[tree] != tree {
            tree = least[tree];
        }
        tree
    }
    for block in &d.efc.blocks {
        if let Source::Contact(index) = block.source
            && let [Some(t1), Some(t2)] = m.plan().pairs[d.contact[index].pair].trees
        {
            let (a, b) = (find(least, t1), find(least, t2));
            least[a.max(b)] = a.min(b);
        }
    }
    // islands in the order of their smallest trees
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
        efc.island[block.row..block.row + block.rows()].fill(block.island);
    }
}
