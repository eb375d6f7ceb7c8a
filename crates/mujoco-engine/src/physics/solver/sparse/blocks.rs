//! Rows that are factored and solved together, from MuJoCo 4.0 on: up to three whose elements stand in
//! the same columns. Sums then have another order. (The order was found with the library's exported
//! functions, on random matrices.)

use std::ops::Range;

use super::{NONE, Sparse};
use crate::Revision;
use crate::math::spatial::MINVAL;

/// The most rows of a block.
const MOST: usize = 3;

impl Sparse {
    /// The rows below the diagonal of a column of the factor, and the places of their elements.
    fn dependents(&self, n: usize, column: usize) -> Range<usize> {
        self.below_starts[n - 1 - column]..self.below_starts[n - column]
    }

    /// Lists how many rows are factored together. A row joins the next one, which has one element
    /// more, if the rows that depend on the next one, and no others, depend on it.
    pub(super) fn find_blocks(&mut self, n: usize, revision: Revision) {
        self.together.clear();
        self.marks.clear();
        self.marks.resize(n, NONE);
        for r in 0..n {
            let before = r.checked_sub(1).filter(|&before| {
                let (own, other) = (self.factor.row(r), self.factor.row(before));
                let (below, all) = (self.dependents(n, r), self.dependents(n, before));
                own.len() == other.len() + 1
                    && self.factor.columns[own.end - 2] == before
                    && all.len() == below.len() + 1
                    && (!revision.compares_dependents() || {
                        for &(row, _) in &self.below[all] {
                            self.marks[row] = r;
                        }
                        self.below[below]
                            .iter()
                            .all(|(row, _)| self.marks[*row] == r)
                    })
            });
            let count = before.map_or(1, |before| MOST.min(self.together[before] + 1));
            self.together.push(count);
        }
    }

    /// Computes the factor's elements as from 4.0 on, by blocks of rows. A row takes the multiples of
    /// the rows that depend on the block's last row, then those of the block's later rows, from the
    /// last on. Multiples whose columns are those of the last row's end are summed apart from others.
    pub(super) fn eliminate_blocks(&mut self, n: usize) {
        let mut end = n;
        while end > 0 {
            let last = end - 1;
            let below = self.dependents(n, last);
            // a row without dependents is a block of its own
            let count = if below.is_empty() {
                1
            } else {
                self.together[last]
            };
            for r in (end - count..end).rev() {
                self.eliminate_row(r, last, count, below.clone());
            }
            end -= count;
        }
    }

    fn eliminate_row(&mut self, r: usize, last: usize, count: usize, below: Range<usize>) {
        let (factor, row, sums) = (&mut self.factor, &mut self.row, &mut self.sums);
        let (own, known) = (factor.row(r), self.hessian.row(r));
        sums.clear();
        sums.resize(own.len(), 0.0);
        for (&column, value) in self.hessian.columns[known.clone()]
            .iter()
            .zip(&self.hessian.values[known.clone()])
        {
            row[column] = *value;
        }
        if count > 1 || known.len() == own.len() {
            for (&column, sum) in factor.columns[own.clone()].iter().zip(&mut *sums) {
                *sum = std::mem::take(&mut row[column]);
            }
        }
        let ends = factor.row(last);
        for &(c, place) in &self.below[below] {
            let first = factor.starts[c];
            let Some(at) = (place + r).checked_sub(last).filter(|at| *at >= first) else {
                continue; // 4.0.0 reads the row before
            };
            let multiple = factor.values[at];
            let (columns, values) = (&factor.columns[first..=at], &factor.values[first..=at]);
            let start = ends.len().checked_sub(1 + place - first);
            match start.filter(|start| factor.columns[ends.start + start] == columns[0]) {
                Some(start) => {
                    for (sum, value) in sums[start..].iter_mut().zip(values) {
                        *sum -= multiple * value;
                    }
                }
                None => {
                    for (&column, value) in columns.iter().zip(values) {
                        row[column] -= multiple * value;
                    }
                }
            }
        }
        for (&column, sum) in factor.columns[own.clone()].iter().zip(&mut *sums) {
            *sum += std::mem::take(&mut row[column]);
        }
        for c in (r + 1..=last).rev() {
            let (first, at) = (factor.starts[c], factor.starts[c + 1] - 1 - (c - r));
            let multiple = factor.values[at];
            for (sum, value) in sums.iter_mut().zip(&factor.values[first..=at]) {
                *sum -= multiple * value;
            }
        }
        let pivot = sums[own.len() - 1];
        let (diagonal, inverse) = if pivot < MINVAL {
            (MINVAL.sqrt(), 0.0)
        } else {
            (pivot.sqrt(), 1.0 / pivot.sqrt())
        };
        for (value, sum) in factor.values[own.clone()].iter_mut().zip(&*sums) {
            *value = sum * inverse;
        }
        factor.values[own.end - 1] = diagonal;
    }

    /// How many rows from `first` on are solved together: up to three, each with the elements of the
    /// one before and one more.
    pub(super) fn solved_together(&self, n: usize, first: usize) -> usize {
        let factor = &self.factor;
        let length = factor.row(first).len();
        let follows = |&k: &usize| {
            let row = factor.row(first + k);
            row.len() == length + k && factor.columns[row.start + length - 1] == first
        };
        let others = (1..MOST.min(n - first)).take_while(follows);
        1 + others.count()
    }

    /// Substitutes in a block of rows: first the columns before the block, one product after the
    /// other, then those of the block.
    pub(super) fn solve_together(&self, values: &[f64], x: &mut [f64], first: usize, count: usize) {
        let factor = &self.factor;
        let row = factor.row(first);
        let before = row.start..row.end - 1;
        let mut sums = [0.0; MOST];
        for (k, &column) in factor.columns[before.clone()].iter().enumerate() {
            for (row, sum) in sums[..count].iter_mut().enumerate() {
                *sum += values[factor.starts[first + row] + k] * x[column];
            }
        }
        for (row, sum) in sums[..count].iter().enumerate() {
            let own = &values[factor.row(first + row)][before.len()..];
            x[first + row] -= sum;
            for k in 0..row {
                x[first + row] -= own[k] * x[first + k];
            }
            x[first + row] /= own[row];
        }
    }
}
