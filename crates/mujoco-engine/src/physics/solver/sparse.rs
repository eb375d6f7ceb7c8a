//! Newton's matrices for models of many degrees of freedom: only elements that can differ from
//! zero, by rows. MuJoCo adds sums over these elements alone, so their last bits differ from those
//! of [`dense`](crate::math::dense) sums.
//!
//! The factor is `L' L`, made from the last row to the first: the degrees of freedom near the root
//! come last, so the factor has few elements more than the matrix.

mod blocks;

use std::ops::Range;

use super::newton::Problem;
use crate::Revision;
use crate::math::dense::{Lanes, dot_sparse};
use crate::math::spatial::MINVAL;
use crate::physics::constraint::Constraints;

/// A matrix by rows: the columns of the elements, ascending, and the elements.
#[derive(Clone, Debug, Default)]
struct Matrix {
    /// Where each row starts, and the end of the last one.
    starts: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Matrix {
    fn row(&self, i: usize) -> Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }

    fn reserve(&mut self, rows: usize, elements: usize) {
        self.starts.reserve(rows + 1);
        self.columns.reserve(elements);
        self.values.reserve(elements);
    }

    fn clear(&mut self) {
        self.starts.clear();
        self.starts.push(0);
        self.columns.clear();
        self.values.clear();
    }

    fn end_row(&mut self) {
        self.starts.push(self.columns.len());
    }

    /// Writes the product with `x`: MuJoCo's `mju_mulMatVecSparse`.
    fn multiply(&self, x: &[f64], out: &mut [f64]) {
        for (out, row) in out.iter_mut().zip(self.starts.windows(2)) {
            let row = row[0]..row[1];
            *out = dot_sparse(&self.values[row.clone()], &self.columns[row], x);
        }
    }
}

/// The matrices of an island.
#[derive(Clone, Debug, Default)]
pub(super) struct Sparse {
    jac: Matrix,
    /// The transposed Jacobian.
    jac_t: Matrix,
    /// The lower triangle of the Hessian.
    hessian: Matrix,
    /// The factor: the lower triangle, the diagonal last in each row.
    factor: Matrix,
    /// The factor with the second derivatives of cones.
    with_cones: Vec<f64>,
    /// For each column of the factor: the rows below its diagonal, and the places of their elements
    /// in the factor, in the order in which MuJoCo's `mju_cholFactorSymbolic` finds them.
    below: Vec<(usize, usize)>,
    below_starts: Vec<usize>,
    /// The columns of the upper triangle's rows.
    upper: Vec<usize>,
    upper_starts: Vec<usize>,
    // buffers with a number for each degree of freedom
    parents: Vec<usize>,
    marks: Vec<usize>,
    cursors: Vec<usize>,
    /// How many rows are factored together if the row is the last of them.
    together: Vec<usize>,
    row: Vec<f64>,
    /// How many rows were subtracted from the factor since it was made.
    subtracted: usize,
    /// The elements of a row of the factor.
    sums: Vec<f64>,
    /// The island's number of each degree of freedom of the model.
    local: Vec<usize>,
}

/// After how many subtracted rows the factor is made anew, from 4.0 on.
const MOST_SUBTRACTED: usize = 32;

/// No degree of freedom.
const NONE: usize = usize::MAX;

impl Sparse {
    /// Allocates the matrices of `n` degrees of freedom and at most `rows` rows.
    pub(super) fn reserve(&mut self, n: usize, rows: usize, cones: bool) {
        self.jac.reserve(rows, rows * n);
        self.jac_t.reserve(n, rows * n);
        let triangle = n * (n + 1) / 2;
        self.hessian.reserve(n, triangle);
        self.factor.reserve(n, triangle);
        if cones {
            self.with_cones.reserve(triangle);
        }
        self.below.reserve(triangle);
        self.upper.reserve(triangle);
        for vector in [
            &mut self.below_starts,
            &mut self.upper_starts,
            &mut self.parents,
            &mut self.marks,
            &mut self.cursors,
            &mut self.together,
            &mut self.local,
        ] {
            vector.reserve(n + 1);
        }
        self.row.reserve(n);
        self.sums.reserve(n);
    }

    /// Copies the Jacobian of an island, given by its blocks, and transposes it.
    pub(super) fn gather(&mut self, problem: &Problem<'_>, efc: &Constraints, blocks: &[usize]) {
        let n = problem.n;
        self.local.clear();
        self.local.resize(problem.m.nv(), NONE);
        for (dofs, place) in problem.places() {
            for (dof, place) in dofs.zip(place) {
                self.local[dof] = place;
            }
        }
        self.jac.clear();
        self.cursors.clear();
        self.cursors.resize(n + 1, 0);
        for &index in blocks {
            let block = &efc.blocks[index];
            let columns = &efc.columns[block.columns.clone()];
            for row in block.row..block.row + block.rows {
                let numbers = efc.row(row);
                for &dof in columns {
                    let column = self.local[dof];
                    self.jac.columns.push(column);
                    self.jac.values.push(numbers[dof]);
                    self.cursors[column + 1] += 1;
                }
                self.jac.end_row();
            }
        }
        for i in 0..n {
            self.cursors[i + 1] += self.cursors[i];
        }
        self.jac_t.starts.clone_from(&self.cursors);
        self.jac_t.columns.resize(self.jac.columns.len(), 0);
        self.jac_t.values.resize(self.jac.columns.len(), 0.0);
        for row in 0..self.jac.starts.len() - 1 {
            for at in self.jac.row(row) {
                let to = &mut self.cursors[self.jac.columns[at]];
                self.jac_t.columns[*to] = row;
                self.jac_t.values[*to] = self.jac.values[at];
                *to += 1;
            }
        }
    }

    /// Computes `J x`.
    pub(super) fn multiply(&self, x: &[Lanes], out: &mut [f64]) {
        self.jac.multiply(x.as_flattened(), out);
    }

    /// Computes the forces of rows on the joints, `J' force`.
    pub(super) fn apply(&self, force: &[f64], out: &mut [Lanes]) {
        self.jac_t.multiply(force, out.as_flattened_mut());
    }

    /// Factors the Hessian of the cost, `M + J' D J` over the rows that push: MuJoCo's
    /// `MakeHessian` and `FactorizeHessian`.
    #[inline(never)]
    pub(super) fn factor(&mut self, problem: &Problem<'_>, pushes: &[bool]) {
        self.subtracted = 0;
        self.add_up(problem, pushes);
        self.find_elements(problem.n);
        if problem.m.revision.factors_in_blocks() {
            self.find_blocks(problem.n, problem.m.revision);
            self.eliminate_blocks(problem.n);
        } else {
            self.eliminate(problem.n);
        }
    }

    /// Computes the lower triangle of the Hessian: MuJoCo's `mju_sqrMatTDSparse`, then
    /// `mju_addToMatSparse`.
    fn add_up(&mut self, problem: &Problem<'_>, pushes: &[bool]) {
        let plan = problem.m.plan();
        self.hessian.clear();
        self.marks.clear();
        self.marks.resize(problem.n, NONE);
        self.row.clear();
        self.row.resize(problem.n, 0.0);
        for (dofs, place) in problem.places() {
            for (dof, i) in dofs.zip(place.clone()) {
                let start = self.hessian.columns.len();
                for at in self.jac_t.row(i) {
                    let k = self.jac_t.columns[at];
                    let factor = if pushes[k] { problem.d[k] } else { 0.0 } * self.jac_t.values[at];
                    for at in self.jac.row(k) {
                        let column = self.jac.columns[at];
                        if column > i {
                            break;
                        }
                        if self.marks[column] != i {
                            self.marks[column] = i;
                            self.hessian.columns.push(column);
                        }
                        if factor != 0.0 {
                            self.row[column] += factor * self.jac.values[at];
                        }
                    }
                }
                // as in MuJoCo, add the inertia matrix last
                let inertia = plan.m_row(dof);
                for (&column, value) in plan.m_local[inertia.clone()]
                    .iter()
                    .zip(&problem.qm[inertia])
                {
                    let column = place.start + column;
                    if self.marks[column] != i {
                        self.marks[column] = i;
                        self.hessian.columns.push(column);
                    }
                    self.row[column] += value;
                }
                let columns = &mut self.hessian.columns[start..];
                columns.sort_unstable();
                for &column in &*columns {
                    self.hessian
                        .values
                        .push(std::mem::take(&mut self.row[column]));
                }
                self.hessian.end_row();
            }
        }
    }

    /// Lists the elements of the factor: MuJoCo's `mju_cholFactorSymbolic`. Each row of the upper
    /// triangle brings its columns, and those on the way from them to the row in the tree of the
    /// elimination.
    fn find_elements(&mut self, n: usize) {
        self.list_upper(n);
        for vector in [&mut self.parents, &mut self.marks] {
            vector.clear();
            vector.resize(n, NONE);
        }
        let starts = &mut self.factor.starts;
        starts.clear();
        starts.resize(n + 1, 1);
        starts[0] = 0;
        self.below.clear();
        self.below_starts.clear();
        self.below_starts.push(0);
        for r in (0..n).rev() {
            self.marks[r] = r;
            for at in self.upper_starts[r]..self.upper_starts[r + 1] {
                let mut i = self.upper[at];
                while self.marks[i] != r {
                    if self.parents[i] == NONE {
                        self.parents[i] = r;
                    }
                    self.marks[i] = r;
                    self.below.push((i, 0));
                    starts[i + 1] += 1;
                    i = self.parents[i];
                }
            }
            self.below_starts.push(self.below.len());
        }
        for i in 0..n {
            starts[i + 1] += starts[i];
        }
        let elements = starts[n];
        self.factor.columns.resize(elements, 0);
        self.factor.values.resize(elements, 0.0);
        // a row's elements were found from the last to the first, after the diagonal
        self.cursors.clear();
        self.cursors
            .extend(self.factor.starts[1..].iter().map(|end| end - 1));
        for (i, &diagonal) in self.cursors.iter().enumerate() {
            self.factor.columns[diagonal] = i;
        }
        for r in (0..n).rev() {
            for (i, place) in
                &mut self.below[self.below_starts[n - 1 - r]..self.below_starts[n - r]]
            {
                self.cursors[*i] -= 1;
                *place = self.cursors[*i];
                self.factor.columns[*place] = r;
            }
        }
    }

    /// Lists the columns of the Hessian's upper triangle without the diagonal, row by row.
    fn list_upper(&mut self, n: usize) {
        let starts = &mut self.upper_starts;
        starts.clear();
        starts.resize(n + 1, 0);
        let hessian = &self.hessian;
        let strict = |i: usize| {
            hessian.columns[hessian.row(i)]
                .iter()
                .filter(move |c| **c < i)
        };
        for i in 0..n {
            strict(i).for_each(|&column| starts[column + 1] += 1);
        }
        for i in 0..n {
            starts[i + 1] += starts[i];
        }
        self.upper.resize(starts[n], 0);
        self.cursors.clear();
        self.cursors.extend_from_slice(&starts[..n]);
        for i in 0..n {
            for &column in strict(i) {
                self.upper[self.cursors[column]] = i;
                self.cursors[column] += 1;
            }
        }
    }

    /// Computes the factor's elements: MuJoCo's `mju_cholFactorNumeric`.
    fn eliminate(&mut self, n: usize) {
        let (factor, row) = (&mut self.factor, &mut self.row);
        for r in (0..n).rev() {
            let known = self.hessian.row(r);
            let elements = self.hessian.columns[known.clone()].iter();
            for (&column, value) in elements.zip(&self.hessian.values[known]) {
                row[column] = *value;
            }
            for &(c, place) in &self.below[self.below_starts[n - 1 - r]..self.below_starts[n - r]] {
                let (first, multiple) = (factor.starts[c], factor.values[place]);
                let columns = factor.columns[first..=place].iter();
                for (&column, value) in columns.zip(&factor.values[first..=place]) {
                    row[column] -= multiple * value;
                }
            }
            let diagonal = f64::max(row[r], MINVAL).sqrt();
            let inverse = 1.0 / diagonal;
            let own = factor.row(r);
            let columns = factor.columns[own.clone()].iter();
            for (&column, value) in columns.zip(&mut factor.values[own.clone()]) {
                *value = std::mem::take(&mut row[column]) * inverse;
            }
            factor.values[own.end - 1] = diagonal;
        }
    }

    /// Solves for the Newton step: MuJoCo's `mju_cholSolveSparse`. `coned` selects the factor with
    /// the second derivatives of cones.
    #[inline(never)]
    pub(super) fn solve(&self, coned: bool, n: usize, x: &mut [Lanes], revision: Revision) {
        let factor = &self.factor;
        let values = if coned {
            &self.with_cones
        } else {
            &factor.values
        };
        let x = &mut x.as_flattened_mut()[..n];
        for i in (0..n).rev() {
            if x[i] != 0.0 {
                let row = factor.row(i);
                let (columns, elements) = (&factor.columns[row.clone()], &values[row]);
                let Some(((diagonal, elements), _)) =
                    elements.split_last().zip(columns.split_last())
                else {
                    continue;
                };
                x[i] /= diagonal;
                let own = x[i];
                for (&column, element) in columns.iter().zip(elements) {
                    x[column] -= element * own;
                }
            }
        }
        let mut i = 0;
        while i < n {
            let count = if revision.factors_in_blocks() {
                self.solved_together(n, i)
            } else {
                1
            };
            let Range { start, end } = factor.row(i);
            let before = start..end - 1;
            if count == 1 {
                if !before.is_empty() {
                    x[i] -= dot_sparse(&values[before.clone()], &factor.columns[before], x);
                }
                x[i] /= values[end - 1];
            } else {
                self.solve_together(values, x, i, count);
            }
            i += count;
        }
    }

    /// Updates the factor for row `row` of the Jacobian times `scale`, which is added or subtracted.
    /// Returns false if the difference is not positive definite, or from 4.0 on if many rows were
    /// subtracted since the factor was made: then it must be made anew.
    pub(super) fn update(
        &mut self,
        row: usize,
        scale: f64,
        adds: bool,
        revision: Revision,
    ) -> bool {
        self.subtracted += usize::from(!adds);
        if revision.limits_subtractions() && self.subtracted >= MOST_SUBTRACTED {
            return false;
        }
        let range = self.jac.row(row);
        self.row.fill(0.0);
        for at in range.clone() {
            self.row[self.jac.columns[at]] = self.jac.values[at] * scale;
        }
        let last = self.jac.columns[range].last();
        let Sparse { factor, row, .. } = self;
        last.is_none_or(|&last| rotate(factor, None, row, last, adds))
    }

    /// Computes the factor with the second derivatives of cones, given one after the other by
    /// `local`: MuJoCo's `HessianCone`.
    pub(super) fn add_cones<'a>(
        &mut self,
        cones: impl Iterator<Item = (usize, usize, [[f64; 6]; 6])> + 'a,
    ) {
        self.with_cones.clone_from(&self.factor.values);
        for (first, dim, local) in cones {
            for c in 0..dim {
                self.row.fill(0.0);
                for (r, local) in local.iter().enumerate().take(dim).skip(c) {
                    for at in self.jac.row(first + r) {
                        self.row[self.jac.columns[at]] += self.jac.values[at] * local[c];
                    }
                }
                let last = self.jac.columns[self.jac.row(first)].last().copied();
                let Sparse {
                    factor,
                    row,
                    with_cones,
                    ..
                } = self;
                if let Some(last) = last {
                    rotate(factor, Some(with_cones), row, last, true);
                }
            }
        }
    }
}

/// Updates `L` to the factor of `L' L + x x'` or `L' L - x x'`, where `last` is the last element of
/// `x` that can differ from zero: MuJoCo's `mju_cholUpdateSparse`. The values are the factor's own
/// or `others`. Returns false if the difference is not positive definite.
fn rotate(
    factor: &mut Matrix,
    others: Option<&mut Vec<f64>>,
    x: &mut [f64],
    last: usize,
    adds: bool,
) -> bool {
    let Matrix {
        starts,
        columns,
        values,
    } = factor;
    let values = others.unwrap_or(values);
    let mut definite = true;
    for i in (0..=last).rev() {
        let own = x[i];
        if own == 0.0 {
            continue;
        }
        let (start, end) = (starts[i], starts[i + 1] - 1);
        let diagonal = values[end];
        let mut square = diagonal * diagonal + if adds { own * own } else { -own * own };
        if square < MINVAL {
            square = MINVAL;
            definite = false;
        }
        let length = square.sqrt();
        values[end] = length;
        let (c, s) = (diagonal / length, -own / length);
        let signed = if adds { -s } else { s };
        for (&column, value) in columns[start..end].iter().zip(&mut values[start..end]) {
            let (before, other) = (*value, x[column]);
            *value = c * before + signed * other;
            x[column] = s * before + c * other;
        }
    }
    definite
}
