//! Factors `L L'` of a positive definite matrix, each sum in libmujoco's order.
//!
//! The lower triangle is stored by columns of `stride` groups of four rows. libmujoco computes the
//! sums of one row at a time, this module the sums of four rows at once. Elements above the
//! diagonal are undefined.

use std::ops::Sub;

use crate::Revision;
use crate::math::dense::{Lanes, minus, plus, times};
use crate::math::spatial::MINVAL;

/// Replaces the lower triangle of a matrix of `n` rows by its factor: MuJoCo's `mju_cholFactor`. A
/// pivot below `MINVAL` is replaced by `MINVAL`.
#[inline(always)]
pub(super) fn factor(matrix: &mut [Lanes], n: usize, stride: usize) {
    with_stride(
        stride,
        #[inline(always)]
        |stride| factor_columns(matrix, n, stride),
    );
}

/// Calls `call` with `stride`. The strides of most models are passed as constants, so that the
/// compiler unrolls loops.
#[inline(always)]
fn with_stride(stride: usize, mut call: impl FnMut(usize)) {
    match stride {
        2 => call(2),
        3 => call(3),
        4 => call(4),
        other => call(other),
    }
}

#[inline(always)]
fn factor_columns(matrix: &mut [Lanes], n: usize, stride: usize) {
    for j in 0..n {
        let (before, column) = matrix.split_at_mut(j * stride);
        let (first, lane) = (j / 4, j % 4);
        let column = &mut column[first..stride];
        for (g, rows) in column.iter_mut().enumerate() {
            // in all rows, the factor of a column's product is the column's element j
            let products = dot_rows(
                before,
                stride,
                first + g,
                #[inline(always)]
                |column, _| column[first][lane],
            );
            *rows = minus(*rows, products, 1.0);
        }
        let pivot = column[0][lane];
        if pivot < MINVAL {
            column.fill([0.0; 4]);
            column[0][lane] = MINVAL.sqrt();
        } else {
            let diagonal = pivot.sqrt();
            let inverse = 1.0 / diagonal;
            for rows in column.iter_mut() {
                *rows = times(*rows, inverse);
            }
            column[0][lane] = diagonal;
        }
    }
}

/// Returns the products of four rows (`group`) with a vector, in the order of
/// [`dot`](crate::math::dense::dot), over `columns`. `element` returns the vector's element for
/// a column and the column's index.
#[inline(always)]
fn dot_rows(
    columns: &[Lanes],
    stride: usize,
    group: usize,
    element: impl Fn(&[Lanes], usize) -> f64,
) -> Lanes {
    let fours = columns.chunks_exact(4 * stride);
    let (columns, mut number) = (fours.remainder(), 0);
    let mut sums = [[0.0; 4]; 4];
    for four in fours {
        for (sum, column) in sums.iter_mut().zip(four.chunks_exact(stride)) {
            *sum = plus(*sum, column[group], element(column, number));
            number += 1;
        }
    }
    let mut rest = [0.0; 4];
    for column in columns.chunks_exact(stride) {
        rest = plus(rest, column[group], element(column, number));
        number += 1;
    }
    let [a, b, c, d] = sums;
    plus(plus(plus(a, c, 1.0), plus(b, d, 1.0), 1.0), rest, 1.0)
}

/// Solves `L L' x = x`: MuJoCo's `mju_cholSolve`. From 4.0 on, the back substitution goes by
/// columns, so the products of the last elements are subtracted first.
#[inline(always)]
pub(super) fn solve(
    factor: &[Lanes],
    n: usize,
    stride: usize,
    x: &mut [Lanes],
    revision: Revision,
) {
    with_stride(
        stride,
        #[inline(always)]
        |stride| substitute(factor, n, stride, x, revision),
    );
}

#[inline(always)]
fn substitute(factor: &[Lanes], n: usize, stride: usize, x: &mut [Lanes], revision: Revision) {
    let x = &mut x[..stride];
    for g in 0..stride {
        // subtract the products of all columns before the current four rows
        let known = x[..g].as_flattened();
        let sums = dot_rows(
            &factor[..4 * g * stride],
            stride,
            g,
            #[inline(always)]
            |_, number| known[number],
        );
        let mut rows = x[g];
        for r in 0..4.min(n - 4 * g) {
            let mut rest = 0.0;
            for k in 0..r {
                rest += factor[(4 * g + k) * stride + g][r] * rows[k];
            }
            rows[r] = (rows[r] - (sums[r] + rest)) / factor[(4 * g + r) * stride + g][r];
        }
        x[g] = rows;
    }
    let x = x.as_flattened_mut();
    for i in (0..n).rev() {
        let column = factor[i * stride..(i + 1) * stride].as_flattened();
        let products = column[i + 1..n].iter().zip(&x[i + 1..n]);
        let products = products.map(
            #[inline(always)]
            |(l, x)| l * x,
        );
        let sum = if revision.substitutes_by_columns() {
            products.rfold(x[i], Sub::sub)
        } else {
            products.fold(x[i], Sub::sub)
        };
        x[i] = sum / column[i];
    }
}

/// Updates `L` to the factor of `L L' + x x'` or `L L' - x x'` for each `x` of `rows`, one after the
/// other: MuJoCo's `mju_cholUpdate`. `adds` has the signs. Returns false if a difference is not
/// positive definite; `L` is then undefined.
///
/// MuJoCo completes one update before the next. Here each column takes all updates before the next
/// column, so that the roots and quotients of one update need not wait for those of another.
#[inline(always)]
pub(super) fn update(
    factor: &mut [Lanes],
    n: usize,
    stride: usize,
    rows: &mut [Lanes],
    adds: &[bool],
) -> bool {
    match *adds {
        // most updates are of one row, for which the compiler leaves out the loop over rows
        [add] => update_columns(factor, n, stride, &mut rows[..stride], &[add]),
        _ => update_columns(factor, n, stride, rows, adds),
    }
}

#[inline(always)]
fn update_columns(
    factor: &mut [Lanes],
    n: usize,
    stride: usize,
    rows: &mut [Lanes],
    adds: &[bool],
) -> bool {
    let mut definite = true;
    for k in 0..n {
        let (first, lane) = (k / 4, k % 4);
        let column = &mut factor[k * stride + first..(k + 1) * stride];
        let mut lkk = column[0][lane];
        for (x, &adds) in rows.chunks_exact_mut(stride).zip(adds) {
            let x = &mut x[first..];
            let xk = x[0][lane];
            if xk == 0.0 {
                continue;
            }
            let mut square = lkk * lkk + if adds { xk * xk } else { -xk * xk };
            if square < MINVAL {
                square = MINVAL;
                definite = false;
            }
            let r = square.sqrt();
            let c = r / lkk;
            let (inverse, s) = (1.0 / c, xk / lkk);
            let signed = if adds { s } else { -s };
            for (l, x) in column.iter_mut().zip(x) {
                *l = times(plus(*l, *x, signed), inverse);
                *x = minus(times(*x, c), *l, s);
            }
            lkk = r;
        }
        column[0][lane] = lkk;
    }
    definite
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::dense::{dot_slices, groups};

    const N: usize = 7;

    /// Returns a positive definite matrix, by rows.
    fn matrix() -> [[f64; N]; N] {
        let entry =
            |i: usize, j: usize| 1.0 / (1.0 + i as f64 + j as f64) + if i == j { 2.0 } else { 0.0 };
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }

    fn by_columns(matrix: &[[f64; N]; N]) -> Vec<Lanes> {
        let mut columns = vec![[0.0; 4]; N * groups(N)];
        for j in 0..N {
            for i in j..N {
                columns[j * groups(N) + i / 4][i % 4] = matrix[i][j];
            }
        }
        columns
    }

    /// Computes factor and solution by rows, element by element, as libmujoco does.
    fn plain(matrix: &mut [[f64; N]; N], x: &mut [f64; N], revision: Revision) {
        for j in 0..N {
            let diagonal = (matrix[j][j] - dot_slices(&matrix[j][..j], &matrix[j][..j])).sqrt();
            matrix[j][j] = diagonal;
            for i in j + 1..N {
                matrix[i][j] = (matrix[i][j] - dot_slices(&matrix[i][..j], &matrix[j][..j]))
                    * (1.0 / diagonal);
            }
        }
        for i in 0..N {
            x[i] = (x[i] - dot_slices(&matrix[i][..i], &x[..i])) / matrix[i][i];
        }
        for i in (0..N).rev() {
            if !revision.substitutes_by_columns() {
                for j in i + 1..N {
                    x[i] -= matrix[j][i] * x[j];
                }
            }
            x[i] /= matrix[i][i];
            if revision.substitutes_by_columns() {
                for j in 0..i {
                    x[j] -= matrix[i][j] * x[i];
                }
            }
        }
    }

    #[test]
    fn rows_four_at_once_have_the_bits_of_one_at_a_time() {
        let mut columns = by_columns(&matrix());
        factor(&mut columns, N, groups(N));
        let start: [f64; N] = std::array::from_fn(|i| 1.0 / (3.0 + i as f64));
        let solved = Revision::ALL.map(|revision| {
            let (mut rows, mut x) = (matrix(), start);
            let mut padded = vec![[0.0; 4]; groups(N)];
            crate::math::dense::put(&mut padded, &x);
            solve(&columns, N, groups(N), &mut padded, revision);
            plain(&mut rows, &mut x, revision);
            let factors = by_columns(&rows);
            for j in 0..N {
                for i in j..N {
                    let at = j * groups(N) + i / 4;
                    assert_eq!(columns[at][i % 4], factors[at][i % 4], "{i} {j}");
                }
            }
            assert_eq!(&padded.as_flattened()[..N], &x);
            x
        });
        assert_ne!(
            solved.first(),
            solved.last(),
            "the orders differ in the last bits"
        );
    }

    #[test]
    fn many_updates_have_the_bits_of_one_at_a_time() {
        let groups = groups(N);
        let mut factors = by_columns(&matrix());
        factor(&mut factors, N, groups);
        let element = |i: usize| match i % 5 {
            0 => 0.0,
            _ => 1.0 / (1.0 + (7 * i % 23) as f64) - 0.1,
        };
        let mut rows = vec![[0.0; 4]; 6 * groups];
        for (u, row) in rows.chunks_exact_mut(groups).enumerate() {
            let row = row.as_flattened_mut()[..N].iter_mut();
            row.enumerate().for_each(|(i, x)| *x = element(N * u + i));
        }
        let adds = [true, true, true, false, true, false];
        let (mut alone, mut copies) = (factors.clone(), rows.clone());
        for (x, adds) in copies.chunks_exact_mut(groups).zip(adds) {
            assert!(update(&mut alone, N, groups, x, &[adds]));
        }
        assert!(update(&mut factors, N, groups, &mut rows, &adds));
        for j in 0..N {
            for i in j..N {
                let [together, alone] =
                    [&factors, &alone].map(|factors| factors[j * groups + i / 4][i % 4]);
                assert_eq!(together.to_bits(), alone.to_bits(), "{i} {j}");
            }
        }
    }

    #[test]
    fn an_update_and_its_reverse_lead_back() {
        let mut factors = by_columns(&matrix());
        factor(&mut factors, N, groups(N));
        let before = factors.clone();
        let row = || vec![[0.0, 0.5, 0.0, -0.25], [0.125, 0.0, 0.3, 0.0]];
        assert!(update(&mut factors, N, groups(N), &mut row(), &[true]));
        let mut sum = matrix();
        let x = row().as_flattened().to_vec();
        (0..N).for_each(|i| (0..N).for_each(|j| sum[i][j] += x[i] * x[j]));
        let mut expected = by_columns(&sum);
        factor(&mut expected, N, groups(N));
        for (factors, expected) in [(factors.clone(), expected), {
            assert!(update(&mut factors, N, groups(N), &mut row(), &[false]));
            (factors.clone(), before)
        }] {
            for j in 0..N {
                for i in j..N {
                    let at = j * groups(N) + i / 4;
                    assert!(
                        (factors[at][i % 4] - expected[at][i % 4]).abs() < 1e-14,
                        "{i} {j}"
                    );
                }
            }
        }
        let mut far = vec![[9.0; 4]; groups(N)];
        assert!(
            !update(&mut factors, N, groups(N), &mut far, &[false]),
            "not positive definite any more"
        );
    }
}
