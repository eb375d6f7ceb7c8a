//! The buffers of the primal solvers, Newton and CG.

use super::line_search::Row;
use super::row_costs::{ConeHessian, Course, State};
use super::sparse::Sparse;
use crate::Model;
use crate::math::dense::{self, Lanes};
use crate::physics::constraint::Block;
use crate::physics::inertia::Way;
#[cfg(test)]
use crate::physics::work::Poison;

/// The buffers of the primal solvers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    // vectors over degrees of freedom: `ma_start` over the whole model, the others over an island
    pub(super) ma_start: Vec<f64>,
    pub(super) acc: Vec<Lanes>,
    pub(super) smooth: Vec<Lanes>,
    pub(super) constraint: Vec<Lanes>,
    pub(super) ma: Vec<Lanes>,
    pub(super) grad: Vec<Lanes>,
    pub(super) mgrad: Vec<Lanes>,
    pub(super) search: Vec<Lanes>,
    pub(super) mv: Vec<Lanes>,
    pub(super) way: Way,
    /// The Hessian's lower triangle by columns, then its factor.
    pub(super) hessian: Vec<Lanes>,
    /// The Jacobians of the rows that push (`pushing`), and these Jacobians times the rows'
    /// stiffness (`pushed`).
    pub(super) pushing: Vec<Lanes>,
    pub(super) pushed: Vec<Lanes>,
    /// The terms of the force on the joints: for each row, the index at which its Jacobian starts,
    /// and the row's force.
    pub(super) terms: Vec<(usize, f64)>,
    /// The rows by which a factor is updated, and whether each is added.
    pub(super) updates: Vec<Lanes>,
    pub(super) adds: Vec<bool>,
    // vectors over rows
    pub(super) jar: Vec<f64>,
    pub(super) jv: Vec<f64>,
    pub(super) force: Vec<f64>,
    /// Whether each row pushes. A limit or a contact pushes while its residual `jar` is negative.
    pub(super) pushes: Vec<bool>,
    pub(super) rows: Vec<Row>,
    /// For models with equality constraints, dry friction or elliptic cones: the rows' states and
    /// costs along the search direction, the second derivatives of cones, and the factor that
    /// includes the second derivatives.
    pub(super) states: Vec<State>,
    pub(super) course: Course,
    pub(super) cones: Vec<ConeHessian>,
    pub(super) with_cones: Vec<Lanes>,
    // buffers of conjugate gradients
    pub(super) grad_before: Vec<Lanes>,
    pub(super) mgrad_before: Vec<Lanes>,
    /// The matrices, if the model is sparse.
    pub(super) sparse: Sparse,
    /// The rows of an island, if the model has several islands.
    pub(super) gathered: Gathered,
}

/// Copies of an island's rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Gathered {
    pub(super) blocks: Vec<Block>,
    pub(super) jac: Vec<Lanes>,
    pub(super) aref: Vec<f64>,
    pub(super) d: Vec<f64>,
    pub(super) r: Vec<f64>,
    pub(super) loss: Vec<f64>,
}

impl Buffers {
    /// Allocates the buffers for `m` and at most `rows` rows, `blocks` blocks and `cones` elliptic
    /// cones.
    pub(crate) fn new(m: &Model, rows: usize, blocks: usize, cones: usize) -> Self {
        let nv = m.nv();
        let mut buffers = Self {
            way: Way::new(m),
            ..Self::default()
        };
        buffers.ma_start.resize(nv, 0.0);
        let groups = dense::groups(nv);
        for vector in buffers.of_dofs() {
            vector.resize(groups, [0.0; 4]);
        }
        if m.plan().sparse {
            buffers.sparse.reserve(nv, rows, cones > 0);
        } else {
            buffers.hessian.reserve(nv * groups);
            buffers.pushing.reserve(rows * groups);
            buffers.pushed.reserve(rows * groups);
            buffers.updates.reserve(rows * groups);
            buffers.adds.reserve(rows);
        }
        buffers.terms.reserve(rows);
        for vector in [
            &mut buffers.jar,
            &mut buffers.jv,
            &mut buffers.force,
            &mut buffers.gathered.aref,
            &mut buffers.gathered.d,
            &mut buffers.gathered.r,
            &mut buffers.gathered.loss,
        ] {
            vector.reserve(rows);
        }
        buffers.pushes.reserve(rows);
        buffers.states.reserve(rows);
        buffers.course.reserve(rows, cones);
        buffers.rows.reserve(rows);
        if cones > 0 {
            buffers.cones.reserve(cones);
            if !m.plan().sparse {
                buffers.with_cones.reserve(nv * groups);
            }
        }
        buffers.gathered.jac.reserve(rows * groups);
        buffers.gathered.blocks.reserve(blocks);
        buffers
    }

    /// The vectors with a number for each degree of freedom.
    #[inline(always)]
    fn of_dofs(&mut self) -> [&mut Vec<Lanes>; 10] {
        [
            &mut self.acc,
            &mut self.smooth,
            &mut self.constraint,
            &mut self.ma,
            &mut self.grad,
            &mut self.mgrad,
            &mut self.search,
            &mut self.mv,
            &mut self.grad_before,
            &mut self.mgrad_before,
        ]
    }

    /// Resizes the vectors for an island of `n` degrees of freedom. The elements that fill the last
    /// group of four are zero: a solution that diverged leaves other numbers there.
    pub(super) fn fit(&mut self, n: usize) {
        let fills = !n.is_multiple_of(4);
        for vector in self.of_dofs() {
            if vector.len() != dense::groups(n) {
                vector.resize(dense::groups(n), [0.0; 4]);
            }
            if let Some(last) = vector.last_mut().filter(|_| fills) {
                *last = [0.0; 4];
            }
        }
    }

    #[cfg(test)]
    pub(crate) fn poison(&mut self) {
        for vector in self.of_dofs() {
            vector.poison();
        }
        for vector in [&mut self.hessian, &mut self.pushing, &mut self.pushed] {
            vector.poison();
        }
        self.with_cones.poison();
        self.gathered.jac.poison();
        let gathered = &mut self.gathered;
        for vector in [
            &mut self.ma_start,
            &mut self.jar,
            &mut self.jv,
            &mut self.force,
            &mut gathered.aref,
            &mut gathered.d,
            &mut gathered.r,
            &mut gathered.loss,
        ] {
            vector.poison();
        }
        self.way.poison();
        self.pushes.fill(true);
        self.states.fill(State::Quadratic);
    }
}
