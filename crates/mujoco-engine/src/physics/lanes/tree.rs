//! Sums and matrices of several worlds, in the same order of operations as for one world: see
//! [`dense`](crate::math::dense) and [`inertia`](crate::physics::inertia).

use std::ops::Range;

use fearless_simd::Simd;
use gym_numerics::math::{Lanes, Real};

use super::{At, PerWorld, load, same, store};
use crate::Model;

/// Returns the sum of `count` products in the order of [`dot`](crate::math::dense::dot). The sum
/// of the last one to three products starts with the first product instead of zero. The result has
/// the same bits, because the total of the other products starts at zero and is never -0.
#[inline(always)]
pub(super) fn sum<S: Simd>(
    at: At<S>,
    count: usize,
    product: impl Fn(usize) -> Lanes<S>,
) -> Lanes<S> {
    let zero = same(at, 0.0);
    let whole = count / 4 * 4;
    let mut sums = [zero; 4];
    for first in (0..whole).step_by(4) {
        for k in 0..4 {
            sums[k] = sums[k] + product(first + k);
        }
    }
    let total = (sums[0] + sums[2]) + (sums[1] + sums[3]);
    let mut rest = zero;
    for k in whole..count {
        rest = rest + product(k);
    }
    total + rest
}

/// Returns the scalar product of two vectors, in the order of [`sum`].
#[inline(always)]
pub(super) fn dot<S: Simd>(at: At<S>, a: &[PerWorld], b: &[PerWorld]) -> Lanes<S> {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let zero = same(at, 0.0);
    let mut sums = [zero; 4];
    for (a, b) in a.iter().zip(b) {
        for k in 0..4 {
            sums[k] = sums[k] + load(at, &a[k]) * load(at, &b[k]);
        }
    }
    let mut rest = zero;
    for (a, b) in a_rest.iter().zip(b_rest) {
        rest = rest + load(at, a) * load(at, b);
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// Replaces matrices with the sparsity of the inertia matrix by `L' D L`, and computes the inverses
/// of the diagonals. Factoring `K` matrices at once hides the latency of divisions.
#[inline(always)]
pub(super) fn factor<S: Simd, const K: usize>(
    m: &Model,
    at: At<S>,
    mut matrices: [(&mut [PerWorld], &mut [PerWorld]); K],
) {
    let plan = m.plan();
    for k in (0..m.nv()).rev() {
        let range = plan.m_row(k);
        let (last, columns) = (range.len() - 1, &plan.m_colind[range.clone()]);
        for (matrix, inverses) in &mut matrices {
            let (above, row) = matrix.split_at_mut(range.start);
            let row = &mut row[..=last];
            let diagonal: Lanes<S> = load(at, &row[last]);
            let inverse = diagonal.same(1.0) / diagonal;
            store(at, &mut inverses[k], inverse);
            for c in (0..last).rev() {
                let factor = load(at, &row[c]) * inverse;
                for (a, b) in above[plan.m_row(columns[c])].iter_mut().zip(&*row) {
                    store(at, a, load(at, a) - load(at, b) * factor);
                }
            }
            for x in &mut row[..last] {
                store(at, x, load(at, x) * inverse);
            }
        }
    }
}

/// Replaces `x` by `(L' D L)^-1 x`.
#[inline(always)]
pub(super) fn solve<S: Simd>(
    m: &Model,
    at: At<S>,
    factors: &[PerWorld],
    inverses: &[PerWorld],
    x: &mut [PerWorld],
) {
    for tree in &m.plan().trees {
        let x = &mut x[tree.clone()];
        solve_tree(m, at, tree, factors, inverses, x);
    }
}

/// [`solve`] for the degrees of freedom of one tree.
#[inline(always)]
pub(super) fn solve_tree<S: Simd>(
    m: &Model,
    at: At<S>,
    tree: &Range<usize>,
    factors: &[PerWorld],
    inverses: &[PerWorld],
    x: &mut [PerWorld],
) {
    let (plan, n) = (m.plan(), tree.len());
    let (x, inverses) = (&mut x[..n], &inverses[tree.clone()]);
    for i in (1..n).rev() {
        let xi: Lanes<S> = load(at, &x[i]);
        // where `xi` is zero, keep the value: a subtraction of zero could turn -0 into 0
        let zero = xi.abs().le(xi.same(0.0));
        let row = plan.m_ancestors(tree.start + i);
        for (&j, l) in plan.m_local[row.clone()].iter().zip(&factors[row]) {
            let xj = load(at, &x[j]);
            store(
                at,
                &mut x[j],
                Lanes::select(zero, xj, xj - load(at, l) * xi),
            );
        }
    }
    for (x, inverse) in x.iter_mut().zip(inverses) {
        store(at, x, load(at, x) * load(at, inverse));
    }
    for i in 1..n {
        let row = plan.m_ancestors(tree.start + i);
        let (columns, factors) = (&plan.m_local[row.clone()], &factors[row]);
        let (product,) = (
            #[inline(always)]
            |k: usize| load(at, &factors[k]) * load(at, &x[columns[k]]),
        );
        let whole = columns.len() / 4 * 4;
        // the remaining products are added one by one
        let mut total = sum(at, whole, product);
        for k in whole..columns.len() {
            total = total + product(k);
        }
        let rest = load(at, &x[i]) - total;
        store(at, &mut x[i], rest);
    }
}

/// Writes `M x` to `y`, for the degrees of freedom of one tree.
#[inline(always)]
pub(super) fn multiply<S: Simd>(
    m: &Model,
    at: At<S>,
    tree: &Range<usize>,
    qm: &[PerWorld],
    x: &[PerWorld],
    y: &mut [PerWorld],
) {
    let (plan, n) = (m.plan(), tree.len());
    let (x, y) = (&x[..n], &mut y[..n]);
    for i in 0..n {
        let xi: Lanes<S> = load(at, &x[i]);
        let row = plan.m_ancestors(tree.start + i);
        let mut sum = load(at, &qm[row.end]) * xi;
        for (&j, value) in plan.m_local[row.clone()].iter().zip(&qm[row]).rev() {
            let value = load(at, value);
            sum = sum + value * load(at, &x[j]);
            let other = load(at, &y[j]) + value * xi;
            store(at, &mut y[j], other);
        }
        store(at, &mut y[i], sum);
    }
}

/// Replaces the lower triangle of a matrix of `n` rows, stored by columns, by its Cholesky factor:
/// MuJoCo's `mju_cholFactor`.
#[inline(always)]
pub(super) fn cholesky<S: Simd>(at: At<S>, n: usize, matrix: &mut [PerWorld], least: f64) {
    for j in 0..n {
        let (before, column) = matrix.split_at_mut(j * n);
        let column = &mut column[..n];
        // two rows at once, so that element j of each column is loaded once for both
        let mut i = j;
        while i < n {
            let two = i + 1 < n;
            let next = if two { i + 1 } else { i };
            let zero: Lanes<S> = same(at, 0.0);
            let whole = j / 4 * 4;
            let mut sums = [[zero; 2]; 4];
            for first in (0..whole).step_by(4) {
                for k in 0..4 {
                    let other = &before[(first + k) * n..][..n];
                    let own = load(at, &other[j]);
                    sums[k][0] = sums[k][0] + load(at, &other[i]) * own;
                    sums[k][1] = sums[k][1] + load(at, &other[next]) * own;
                }
            }
            let mut rest = [zero; 2];
            for k in whole..j {
                let other = &before[k * n..][..n];
                let own = load(at, &other[j]);
                rest[0] = rest[0] + load(at, &other[i]) * own;
                rest[1] = rest[1] + load(at, &other[next]) * own;
            }
            for (r, place) in [i, next].into_iter().enumerate() {
                if r == 0 || two {
                    let total = (sums[0][r] + sums[2][r]) + (sums[1][r] + sums[3][r]);
                    let x = load(at, &column[place]) - (total + rest[r]);
                    store(at, &mut column[place], x);
                }
            }
            i += 2;
        }
        let pivot: Lanes<S> = load(at, &column[j]);
        let small = pivot.lt(pivot.same(least));
        let zero = pivot.same(0.0);
        let diagonal = pivot.sqrt();
        let inverse = pivot.same(1.0) / diagonal;
        for x in &mut column[j + 1..] {
            store(at, x, Lanes::select(small, zero, load(at, x) * inverse));
        }
        let least = pivot.same(least.sqrt());
        store(at, &mut column[j], Lanes::select(small, least, diagonal));
    }
}

/// Solves `L L' x = x`: MuJoCo's `mju_cholSolve`. `descending` reverses the order of the sums in
/// the back substitution.
#[inline(always)]
pub(super) fn cholesky_solve<S: Simd>(
    at: At<S>,
    n: usize,
    factor: &[PerWorld],
    x: &mut [PerWorld],
    descending: bool,
) {
    let x = &mut x[..n];
    for i in 0..n {
        let products = sum(
            at,
            i,
            #[inline(always)]
            |k| load(at, &factor[k * n + i]) * load(at, &x[k]),
        );
        let diagonal: Lanes<S> = load(at, &factor[i * n + i]);
        let rest = (load(at, &x[i]) - products) / diagonal;
        store(at, &mut x[i], rest);
    }
    for i in (0..n).rev() {
        let column = &factor[i * n..(i + 1) * n];
        let mut rest: Lanes<S> = load(at, &x[i]);
        for step in i + 1..n {
            let k = if descending { n + i - step } else { step };
            rest = rest - load(at, &column[k]) * load(at, &x[k]);
        }
        store(at, &mut x[i], rest / load(at, &column[i]));
    }
}

/// Updates the factor for `+ x x'` (where `adds` is 1) or `- x x'`, in the lanes of `which`:
/// MuJoCo's `mju_cholUpdate`. Returns the lanes where the result is not positive definite.
#[inline(always)]
pub(super) fn cholesky_update<S: Simd>(
    at: At<S>,
    n: usize,
    factor: &mut [PerWorld],
    x: &mut [PerWorld],
    (which, adds): (<Lanes<S> as Real>::Mask, <Lanes<S> as Real>::Mask),
    least: f64,
) -> <Lanes<S> as Real>::Mask {
    let x = &mut x[..n];
    let none = which & Lanes::<S>::but_not(which, which);
    let mut indefinite = none;
    for k in 0..n {
        let xk: Lanes<S> = load(at, &x[k]);
        let zero = xk.abs().le(xk.same(0.0));
        let which = Lanes::<S>::but_not(which, zero);
        if !Lanes::<S>::any(which) {
            continue;
        }
        let column = &mut factor[k * n..(k + 1) * n];
        let lkk: Lanes<S> = load(at, &column[k]);
        let square = lkk * lkk + Lanes::select(adds, xk * xk, -xk * xk);
        let small = which & square.lt(square.same(least));
        indefinite |= small;
        let square = Lanes::select(small, square.same(least), square);
        let r = square.sqrt();
        let c = r / lkk;
        let (inverse, s) = (c.same(1.0) / c, xk / lkk);
        let signed = Lanes::select(adds, s, -s);
        for (l, x) in column[k + 1..].iter_mut().zip(&mut x[k + 1..]) {
            let (before, own): (Lanes<S>, Lanes<S>) = (load(at, l), load(at, x));
            let after = (before + own * signed) * inverse;
            store(at, l, Lanes::select(which, after, before));
            store(at, x, Lanes::select(which, own * c - after * s, own));
        }
        store(at, &mut column[k], Lanes::select(which, r, lkk));
    }
    indefinite
}
