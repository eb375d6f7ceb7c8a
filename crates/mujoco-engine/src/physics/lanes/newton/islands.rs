//! The islands of several worlds. Worlds with the same island, a set of trees, solve it together.
//!
//! An island has vectors of its own degrees of freedom, because an element's position in a vector
//! affects the order of a sum.

use std::ops::Range;

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::{Mask, Newton};
use crate::Model;
use crate::model::Disable;
use crate::physics::lanes::rows::{Rows, worlds};
use crate::physics::lanes::{Arrays, At, PerWorld, WORLDS, copy, load, same, store, tree};
use crate::physics::solver::cones::Shape;

/// The trees of an island: the degrees of freedom of each in the model, and where they start in the
/// island's vectors.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    pub(super) n: usize,
    pub(super) trees: Vec<(Range<usize>, usize)>,
}

impl Part {
    /// The island of the trees whose bits are set in `trees`.
    fn set(&mut self, m: &Model, trees: u64) {
        self.n = 0;
        self.trees.clear();
        for tree in worlds(trees, 0) {
            let dofs = m.plan().trees[tree].clone();
            self.n += dofs.len();
            self.trees.push((dofs.clone(), self.n - dofs.len()));
        }
    }

    /// Iterates over the degrees of freedom: in the model, and in the island's vectors.
    #[inline(always)]
    pub(super) fn dofs(&self) -> impl Iterator<Item = (usize, usize)> {
        let trees = self.trees.iter();
        trees.flat_map(
            #[inline(always)]
            |(dofs, place)| dofs.clone().zip(*place..),
        )
    }

    /// Copies numbers of the model's degrees of freedom to the island's vector.
    #[inline(always)]
    fn take<S: Simd>(&self, at: At<S>, from: &[PerWorld], to: &mut [PerWorld]) {
        for (dofs, place) in &self.trees {
            copy(at, &from[dofs.clone()], &mut to[*place..]);
        }
    }

    /// Writes `M x` to `y`.
    #[inline(always)]
    pub(super) fn multiply<S: Simd>(
        &self,
        m: &Model,
        at: At<S>,
        qm: &[PerWorld],
        x: &[PerWorld],
        y: &mut [PerWorld],
    ) {
        for (dofs, place) in &self.trees {
            tree::multiply(m, at, dofs, qm, &x[*place..], &mut y[*place..]);
        }
    }

    /// Replaces `x` by `M^-1 x`.
    #[inline(always)]
    pub(super) fn solve<S: Simd>(&self, m: &Model, at: At<S>, a: &Arrays, x: &mut [PerWorld]) {
        for (dofs, place) in &self.trees {
            let x = &mut x[*place..];
            tree::solve_tree(m, at, dofs, &a.qld, &a.qld_diag_inv, x);
        }
    }
}

/// The islands, and copies of the rows of one.
#[derive(Clone, Debug, Default)]
pub(super) struct Islands {
    /// The island of all trees.
    pub(super) whole: Part,
    part: Part,
    /// The islands: the bits of their trees, and the bits of their worlds.
    list: Vec<(u64, u64)>,
    /// The islands of one world.
    own: Vec<u64>,
    rows: Rows,
    /// The index of each row among all rows, in each world; `usize::MAX` for none.
    index: Vec<[usize; WORLDS]>,
    /// The accelerations at which all islands start.
    start: Vec<PerWorld>,
    /// The forces of the rows of all islands.
    force: Vec<PerWorld>,
}

impl Islands {
    pub(super) fn new(m: &Model) -> Self {
        let mut islands = Self::default();
        let (trees, rows) = (m.ntree(), m.plan().bounds().rows_of_worlds());
        if trees <= 64 && m.nv() > 0 {
            islands.whole.set(m, u64::MAX >> (64 - trees));
        }
        if trees > 1 {
            islands.part.trees.reserve(trees);
            islands.list.reserve(trees);
            islands.own.reserve(trees);
            islands.index.reserve(rows);
            islands.start.resize(m.nv(), PerWorld::ZERO);
            islands.force.resize(rows, PerWorld::ZERO);
            islands.rows.reserve(m.nv(), rows);
            islands.rows.cones.reserve(m.plan().bounds().contacts);
        }
        islands
    }

    #[cfg(test)]
    pub(super) fn poison(&mut self) {
        use crate::physics::work::Poison;
        self.rows.poison();
        self.start.poison();
        self.force.poison();
    }

    /// The forces of the rows, if the model has several trees.
    pub(super) fn forces(&self) -> Option<&[PerWorld]> {
        (self.whole.trees.len() > 1).then_some(&self.force)
    }

    /// Finds the islands of the worlds in the register that have rows.
    fn find(&mut self, m: &Model, rows: &Rows, has: &PerWorld, first: usize) {
        self.list.clear();
        let all = u64::MAX >> (64 - m.ntree());
        for (world, has) in has.0.iter().enumerate().skip(first) {
            if *has == 0.0 {
                continue;
            }
            self.own.clear();
            for trees in &rows.trees[..rows.used] {
                let mut trees = trees[world];
                if trees == 0 {
                    continue;
                }
                if m.opt.disables(Disable::Island) {
                    trees = all;
                }
                self.own.retain(|own| {
                    let apart = own & trees == 0;
                    trees |= if apart { 0 } else { *own };
                    apart
                });
                self.own.push(trees);
            }
            for trees in &self.own {
                let bit = 1 << (world - first);
                match self.list.iter_mut().find(|(known, _)| known == trees) {
                    Some((_, worlds)) => *worlds |= bit,
                    None => self.list.push((*trees, bit)),
                }
            }
        }
    }

    /// Copies the rows of the island of the trees `trees` in the worlds of `members`. In each world,
    /// the island's rows of one kind follow one another.
    fn gather(&mut self, rows: &Rows, nv: usize, (trees, members): (u64, u64), first: usize) {
        let (n, own) = (self.part.n, &mut self.rows);
        self.index.clear();
        own.used = 0;
        own.cones.clear();
        own.dim = rows.dim;
        let (cones, mut start) = (rows.one_sided().end, 0);
        let ends = [rows.pulls[0], rows.pulls[1], cones, rows.used];
        for (kind, end) in ends.into_iter().enumerate() {
            let begin = own.used;
            let mut next = [begin; WORLDS];
            for row in start..end {
                for world in worlds(members, first) {
                    if rows.trees[row][world] & trees == 0 {
                        continue;
                    }
                    let to = next[world];
                    next[world] += 1;
                    let is_cone = kind == 3 && (row - cones).is_multiple_of(rows.dim);
                    if to == own.used {
                        own.open_all(n);
                        self.index.push([usize::MAX; WORLDS]);
                        if is_cone {
                            own.cones.push(Shape::default());
                        }
                    }
                    self.index[to][world] = row;
                    let jac = &mut own.jac[to * n..(to + 1) * n];
                    for (dof, place) in self.part.dofs() {
                        jac[place].0[world] = rows.jac[row * nv + dof].0[world];
                    }
                    for (to, from) in [
                        (&mut own.d[to], &rows.d[row]),
                        (&mut own.r[to], &rows.r[row]),
                        (&mut own.loss[to], &rows.loss[row]),
                        (&mut own.aref[to], &rows.aref[row]),
                    ] {
                        to.0[world] = from.0[world];
                    }
                    if is_cone {
                        let shape = &rows.cones[(row - cones) / rows.dim];
                        own.cones[(to - begin) / rows.dim]
                            .each(shape, |to, from| to.0[world] = from.0[world]);
                    }
                }
            }
            if let Some(end) = own.pulls.get_mut(kind) {
                *end = own.used;
            }
            start = end;
        }
        own.count.fill(own.used);
    }
}

impl Newton {
    /// Solves all islands of the worlds that have rows, from the accelerations `acc`.
    pub(super) fn solve_islands<S: Simd>(
        &mut self,
        m: &Model,
        at: At<S>,
        a: &mut Arrays,
        rows: &Rows,
        has: &PerWorld,
    ) {
        let (simd, nv) = (at.0, m.nv());
        let mut islands = std::mem::take(&mut self.islands);
        islands.find(m, rows, has, at.1);
        if islands.force.len() < rows.used {
            islands.force.resize(rows.d.len(), PerWorld::ZERO);
            islands.rows.reserve(nv, rows.d.len());
        }
        simd.vectorize(
            #[inline(always)]
            || {
                copy(at, &self.acc, &mut islands.start);
                copy(at, &a.qacc_smooth, &mut a.qacc);
                for zero in a.qfrc_constraint.iter_mut().chain(&mut islands.force) {
                    store(at, zero, same(at, 0.0));
                }
            },
        );
        for k in 0..islands.list.len() {
            let (trees, members) = islands.list[k];
            islands.part.set(m, trees);
            islands.gather(rows, nv, (trees, members), at.1);
            simd.vectorize(
                #[inline(always)]
                || {
                    self.begin(m, at, a, &islands);
                },
            );
            let mut has = PerWorld::ZERO;
            for world in worlds(members, at.1) {
                has.0[world] = 1.0;
            }
            self.iterate(m, at, a, &islands.rows, &islands.part, &has);
            simd.vectorize(
                #[inline(always)]
                || self.end(at, a, &mut islands, &has),
            );
        }
        self.islands = islands;
    }

    /// Starts at the accelerations of all islands.
    #[inline(always)]
    fn begin<S: Simd>(&mut self, m: &Model, at: At<S>, a: &Arrays, islands: &Islands) {
        let (part, rows) = (&islands.part, &islands.rows);
        part.take(at, &islands.start, &mut self.acc);
        part.take(at, &a.qfrc_smooth, &mut self.smooth);
        part.multiply(m, at, &a.qm, &self.acc, &mut self.ma);
        let acc = &self.acc[..part.n];
        rows.multiply(part.n, at, acc, Some(&rows.aref), &mut self.jar);
    }

    /// Stores the results of an island.
    #[inline(always)]
    fn end<S: Simd>(&self, at: At<S>, a: &mut Arrays, islands: &mut Islands, has: &PerWorld) {
        let has: Mask<S> = load::<S>(at, has).gt(same(at, 0.5));
        let (put,) = (
            #[inline(always)]
            |from: &PerWorld, to: &mut PerWorld| {
                let chosen = Lanes::<S>::select(has, load(at, from), load(at, to));
                store(at, to, chosen);
            },
        );
        for (dof, place) in islands.part.dofs() {
            put(&self.acc[place], &mut a.qacc[dof]);
            put(&self.constraint[place], &mut a.qfrc_constraint[dof]);
        }
        for (index, force) in islands.index.iter().zip(&self.force) {
            for (world, &row) in index.iter().enumerate() {
                if let Some(to) = islands.force.get_mut(row) {
                    to.0[world] = force.0[world];
                }
            }
        }
    }
}
