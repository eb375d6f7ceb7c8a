//! Constraint rows: limits of joints and contacts, their Jacobians, impedances and reference
//! accelerations.
//!
//! Rows belong to blocks. A limit has one row, and so has a contact without friction. A contact
//! with friction has four rows, one for each edge of its pyramid: `n + mu t1`, `n - mu t1`,
//! `n + mu t2` and `n - mu t2`, where `n`, `t1` and `t2` are the Jacobians of the normal and the
//! two tangents. Rows are dense, because libmujoco sums over zeros too; see
//! [`dense`](super::dense).

use super::bias;
use super::rows;
use crate::math::dense::{self, Lanes};
use crate::math::libm;
use crate::math::number::Number;
use crate::math::spatial::{add, cross, dot, rotate, sub};
use crate::model::{Bounds, Cone, Disable, Pair, Softness};
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
    /// Distance to the constraint; negative where it is violated.
    pub pos: Vec<f64>,
    /// The constraint acts where `pos` is below this margin.
    pub margin: Vec<f64>,
    /// Approximate diagonal of `J M^-1 J'`.
    #[doc(alias = "efc_diagApprox")]
    pub diag_approx: Vec<f64>,
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
    /// Inequality: forces are not negative.
    Limit,
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
            &mut $efc.diag_approx,
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
    pub(crate) fn reserve(&mut self, bounds: &Bounds, nv: usize) {
        self.stride = dense::groups(nv);
        self.blocks.reserve(bounds.blocks);
        self.jac.reserve(bounds.rows * self.stride);
        for column in columns!(self) {
            column.reserve(bounds.rows);
        }
        self.kbip.reserve(bounds.rows);
        self.island.reserve(bounds.rows);
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
        self.nisland = 0;
    }

    /// Replaces all rows by `rows` inequality rows of one tree. `jac` has the Jacobian of each row,
    /// `nv` numbers; `numbers` returns `d`, `r` and `aref` of a row.
    pub(super) fn set_rows(
        &mut self,
        rows: usize,
        nv: usize,
        mut jac: impl Iterator<Item = f64>,
        numbers: impl Fn(usize) -> [f64; 3],
    ) {
        self.clear();
        push_block(self, Source::Limit(0), Kind::Limit, rows, self.stride, 0);
        self.nisland = 1;
        self.island.resize(rows, 0);
        for column in columns!(self) {
            column.resize(rows, 0.0);
        }
        for row in 0..rows {
            [self.d[row], self.r[row], self.aref[row]] = numbers(row);
        }
        for row in self.jac.chunks_exact_mut(self.stride) {
            let elements = &mut row.as_flattened_mut()[..nv];
            let elements = elements.iter_mut().zip(&mut jac);
            elements.for_each(|(to, x)| *to = x);
        }
    }

    /// The Jacobian, row by row.
    #[inline]
    pub(crate) fn jacobian(&self) -> &[Lanes] {
        &self.jac
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

/// Builds all rows: MuJoCo's `mj_makeConstraint`, with `mj_referenceConstraint` once velocities are
/// known.
#[inline(always)]
pub fn make_constraint(m: &Model, d: &mut Data) {
    d.efc.clear();
    if m.plan().constraints.can_pull() {
        rows::equality(m, d);
        rows::friction(m, d);
    }
    limits(m, d);
    if m.ntendon() > 0 {
        rows::tendon_limits(m, d);
    }
    contacts(m, d);
    let efc = &mut d.efc;
    let rows = efc.nefc();
    for column in [&mut efc.vel, &mut efc.aref, &mut efc.b, &mut efc.force] {
        column.resize(rows, 0.0);
    }
    efc.island.resize(rows, 0);
    islands(m, d);
}

/// Adds the rows of active joint limits: MuJoCo's `mj_instantiateLimit`.
#[inline(always)]
fn limits(m: &Model, d: &mut Data) {
    for limit in &m.plan().limits {
        if limit.ball {
            rows::ball_limit(m, d, limit);
            continue;
        }
        let q = d.qpos[limit.qpos];
        let dists = [q - limit.range[0], limit.range[1] - q];
        // most limits are far
        if !dists.iter().any(|dist| *dist < limit.margin) {
            continue;
        }
        for (side, dist) in [1.0, -1.0].into_iter().zip(dists) {
            if dist < limit.margin {
                let efc = &mut d.efc;
                let source = Source::Limit(limit.joint);
                let groups = limit.dof / 4 + 1;
                let row = push_block(efc, source, Kind::Limit, 1, groups, limit.tree);
                set_row(efc, row, limit.dof, side);
                push_row(efc, (&limit.softness, limit.diag), dist, limit.margin);
            }
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

/// Adds the rows of active contacts: MuJoCo's `mj_instantiateContact`.
#[inline(always)]
fn contacts(m: &Model, d: &mut Data) {
    for index in 0..d.contact.len() {
        let contact = &mut d.contact[index];
        if contact.dist >= contact.includemargin {
            continue;
        }
        let pair = &m.plan().pairs[contact.pair];
        let Some(tree) = pair.trees[0].or(pair.trees[1]) else {
            continue;
        };
        let efc = &mut d.efc;
        contact.efc_address = efc.nefc() as i32;
        let uneven = contact.friction[0] != contact.friction[1];
        if contact.dim > 3 || uneven || m.opt.cone == Cone::Elliptic || m.opt.impratio != 1.0 {
            let place = (index, pair, tree);
            rows::contact(m, &d.cdof, &d.subtree_com, efc, contact, place);
            continue;
        }
        let rows = if contact.dim == 1 { 1 } else { 4 };
        let mu = if rows == 1 { 0.0 } else { contact.friction[0] };
        contact.mu = mu;
        let source = Source::Contact(index);
        let row = push_block(efc, source, Kind::Limit, rows, pair.groups, tree);
        let (width, jac) = (4 * efc.stride, &mut efc.jac[row * efc.stride..]);
        let jac = jac.as_flattened_mut();
        let frames = (
            #[inline(always)]
            |dof: usize| d.cdof[dof],
            #[inline(always)]
            |body: usize| d.subtree_com[body],
        );
        contact_jacobian(
            pair,
            frames,
            (contact.pos, &contact.frame, mu),
            #[inline(always)]
            |dof, values| {
                if rows == 1 {
                    jac[dof] = values[0];
                } else {
                    for (row, value) in values.into_iter().enumerate() {
                        jac[row * width + dof] = value;
                    }
                }
            },
        );
        let (dist, margin) = (contact.dist, contact.includemargin);
        if rows == 1 {
            push_row(efc, (&pair.softness, pair.diag), dist, margin);
            continue;
        }
        let (diag, edge) = pyramid(pair.diag, mu);
        let softness = &pair.softness;
        push_rows(efc, softness, (dist, dist), margin, diag, 4);
        let r = edge(efc.r[row]);
        efc.r[row..].fill(r);
        efc.d[row..].fill(1.0 / r);
    }
}

/// The Jacobian of a contact: the velocity of the second body relative to the first, along the four
/// edges of the pyramid. A pair of one dimension has the normal four times. `axis` and `com` give
/// motion axes and centres of mass; `set` receives each degree of freedom with its four values.
#[inline(always)]
pub(super) fn contact_jacobian<N: Number>(
    pair: &Pair,
    (axis, com): (impl Fn(usize) -> [N; 6], impl Fn(usize) -> [N; 3]),
    (pos, frame, mu): ([N; 3], &[N; 9], f64),
    mut set: impl FnMut(usize, [N; 4]),
) {
    for column in &pair.columns {
        let c = axis(column.dof);
        let offset = sub(pos, com(column.root));
        let moves = add([c[3], c[4], c[5]], cross([c[0], c[1], c[2]], offset));
        // libmujoco's sums start with 0, so no sum is -0
        if pair.dim == 1 {
            let along = dot([frame[0], frame[1], frame[2]], moves);
            set(column.dof, [along * column.sign + 0.0; 4]);
        } else {
            let [n, t1, t2] = rotate(frame, moves).map(
                #[inline(always)]
                |along| along * column.sign + 0.0,
            );
            let (t1, t2) = (t1 * mu, t2 * mu);
            set(column.dof, [n + t1, n - t1, n + t2, n - t2]);
        }
    }
}

/// Sets the one row of a constraint at the position `pos`: see [`push_rows`].
#[inline(always)]
pub(super) fn push_row(
    efc: &mut Constraints,
    (softness, diag): (&Softness, f64),
    pos: f64,
    margin: f64,
) {
    push_rows(efc, softness, (pos, pos), margin, diag, 1);
}

/// Sets position, margin and impedance of the rows of one constraint, all equal: MuJoCo's
/// `mj_makeImpedance`. The columns that later stages compute are left for the end.
#[inline(always)]
pub(super) fn push_rows(
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
        (&mut efc.diag_approx, diag),
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
pub(super) fn regularization(impedance: f64, diag: f64) -> f64 {
    f64::max(1e-15, (1.0 - impedance) * diag / impedance)
}

/// Returns the diagonal of the rows of a friction pyramid with the coefficient `mu`, and the
/// function from the regularisation of the normal row to the regularisation of the pyramid's rows.
/// With these, the pyramid is as soft as an elliptic cone.
#[inline(always)]
pub(super) fn pyramid(diag: f64, mu: f64) -> (f64, impl Fn(f64) -> f64) {
    (diag + mu * mu * diag, move |r: f64| 2.0 * mu * mu * r)
}

impl Softness {
    /// The impedance at a constraint's position, and its derivative: MuJoCo's `getimpedance`.
    pub(super) fn impedance(&self, pos: f64, margin: f64) -> (f64, f64) {
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

/// Computes velocities and reference accelerations of all rows: MuJoCo's `mj_referenceConstraint`.
#[inline(always)]
pub fn reference_constraint(m: &Model, d: &mut Data) {
    let (efc, x) = (&mut d.efc, &mut d.work.dofs);
    if efc.blocks.is_empty() {
        return;
    }
    dense::put(x, &d.qvel);
    mul_jacobian(&efc.blocks, &efc.jac, efc.stride, x, m.nv(), &mut efc.vel);
    for i in 0..efc.pos.len() {
        let [stiffness, damping, impedance, _] = efc.kbip[i];
        efc.aref[i] = -damping * efc.vel[i] - stiffness * impedance * (efc.pos[i] - efc.margin[i]);
    }
    if !m.plan().constraints.equalities.is_empty() {
        bias::subtract(m, d);
    }
}

/// Groups the trees that constraints connect into islands: MuJoCo's `mj_island`.
fn islands(m: &Model, d: &mut Data) {
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
    for block in &d.efc.blocks {
        match block.source {
            Source::Contact(index) => {
                if let [Some(t1), Some(t2)] = m.plan().pairs[d.contact[index].pair].trees {
                    let (a, b) = (find(least, t1), find(least, t2));
                    least[a.max(b)] = a.min(b);
                }
            }
            Source::Limit(_) | Source::DofFriction(_) => {}
            _ => {
                let rows = block.row * d.efc.stride..(block.row + block.rows) * d.efc.stride;
                for row in d.efc.jac[rows].chunks(d.efc.stride) {
                    let numbers = row.as_flattened()[..m.nv()].iter().enumerate();
                    for (dof, _) in numbers.filter(|(_, x)| **x != 0.0) {
                        let (a, b) = (find(least, block.tree), find(least, m.dof_treeid[dof]));
                        least[a.max(b)] = a.min(b);
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
