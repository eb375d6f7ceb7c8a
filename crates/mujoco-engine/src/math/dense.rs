//! Vectors and products of vectors in the order in which libmujoco sums them.
//!
//! libmujoco's `mju_dot` keeps four sums in an AVX register: of the elements 0, 4, 8, ..., of the
//! elements 1, 5, 9, ... and so on. At the end, it adds the last one to three elements. The order
//! of a sum decides its last bit, so every scalar product over degrees of freedom or rows uses this
//! order, and includes zeros.

/// Four consecutive elements of a vector. Elements after the end of the vector are zero.
pub(crate) type Lanes = [f64; 4];

/// The number of groups of four that hold `n` elements.
#[inline]
pub(crate) const fn groups(n: usize) -> usize {
    n.div_ceil(4)
}

/// The total of the four partial sums, in libmujoco's order.
#[inline(always)]
pub(crate) fn total(sums: &Lanes) -> f64 {
    (sums[0] + sums[2]) + (sums[1] + sums[3])
}

/// The sums of the products at each of the four places.
#[inline(always)]
fn products(a: &[Lanes], b: &[Lanes]) -> Lanes {
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        sums = [
            sums[0] + a[0] * b[0],
            sums[1] + a[1] * b[1],
            sums[2] + a[2] * b[2],
            sums[3] + a[3] * b[3],
        ];
    }
    sums
}

/// The product of two vectors of `n` elements: MuJoCo's `mju_dot`.
///
/// A vector may be shorter, by whole groups, if the missing elements are zeros.
#[inline(always)]
pub(crate) fn dot(a: &[Lanes], b: &[Lanes], n: usize) -> f64 {
    let full = n / 4;
    let groups = a.len().min(b.len());
    let (a, b) = (&a[..groups], &b[..groups]);
    let whole = groups.min(full);
    let sum = total(&products(&a[..whole], &b[..whole]));
    match (a.get(full), b.get(full)) {
        (Some(a), Some(b)) if n > 4 * full => sum + (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]),
        _ => sum,
    }
}

/// The dot product of two slices: MuJoCo's `mju_dot`.
pub(crate) fn dot_slices(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let sum = dot(a, b, 4 * a.len());
    let products = a_rest.iter().zip(b_rest).map(|(a, b)| a * b);
    let rest = products.reduce(|sum, x| sum + x);
    rest.map_or(sum, |rest| sum + rest)
}

/// The product of a matrix of six rows with a vector, each element in the order of `mju_dot`, or
/// of [`dot_sparse`] if the last products are added `one_by_one`. `columns` are the columns of the
/// matrix, each with its element of the vector.
pub(crate) fn sum_of_columns(
    columns: impl ExactSizeIterator<Item = ([f64; 6], f64)>,
    one_by_one: bool,
) -> [f64; 6] {
    let full = columns.len() - columns.len() % 4;
    let (mut sums, mut last) = ([[0.0; 4]; 6], [[0.0; 6]; 3]);
    let mut left = 0;
    for (j, (column, x)) in columns.enumerate() {
        let products = column.map(|element| element * x);
        if j < full {
            for (sums, product) in sums.iter_mut().zip(products) {
                sums[j % 4] += product;
            }
        } else {
            (last[left], left) = (products, left + 1);
        }
    }
    std::array::from_fn(|k| {
        let (whole, last) = (
            total(&sums[k]),
            last[..left].iter().map(|products| products[k]),
        );
        if one_by_one {
            last.fold(whole, |sum, x| sum + x)
        } else {
            last.reduce(|sum, x| sum + x)
                .map_or(whole, |last| whole + last)
        }
    })
}

/// The scalar product of `a` with the elements `columns` of `x`: MuJoCo's `mju_dotSparse`, which
/// adds the products after the last full group of four one by one.
#[inline(always)]
pub(crate) fn dot_sparse(a: &[f64], columns: &[usize], x: &[f64]) -> f64 {
    let ((a, a_rest), (columns, columns_rest)) = (a.as_chunks::<4>(), columns.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (a, columns) in a.iter().zip(columns) {
        for k in 0..4 {
            sums[k] += a[k] * x[columns[k]];
        }
    }
    let mut sum = total(&sums);
    for (a, &column) in a_rest.iter().zip(columns_rest) {
        sum += a * x[column];
    }
    sum
}

/// The scalar product of the elements `columns` of two vectors, in the order of [`dot_sparse`].
#[inline(always)]
pub(crate) fn dot_at(a: &[f64], b: &[f64], columns: &[usize]) -> f64 {
    let (fours, rest) = columns.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for columns in fours {
        for k in 0..4 {
            sums[k] += a[columns[k]] * b[columns[k]];
        }
    }
    let products = rest.iter().map(|&column| a[column] * b[column]);
    products.fold(total(&sums), |sum, product| sum + product)
}

/// The product of the first `n` elements of two vectors, in the order of [`dot_sparse`].
#[inline(always)]
pub(crate) fn dot_one_by_one(a: &[Lanes], b: &[Lanes], n: usize) -> f64 {
    let whole = n / 4;
    let mut sum = total(&products(&a[..whole], &b[..whole]));
    let (a, b) = (&a.as_flattened()[..n], &b.as_flattened()[..n]);
    for k in 4 * whole..n {
        sum += a[k] * b[k];
    }
    sum
}

/// `a + s b`. All four numbers are read before one is written, so that the compiler uses one vector
/// instruction.
#[inline(always)]
pub(crate) fn plus(a: Lanes, b: Lanes, s: f64) -> Lanes {
    [
        a[0] + b[0] * s,
        a[1] + b[1] * s,
        a[2] + b[2] * s,
        a[3] + b[3] * s,
    ]
}

/// `a - s b`.
#[inline(always)]
pub(crate) fn minus(a: Lanes, b: Lanes, s: f64) -> Lanes {
    [
        a[0] - b[0] * s,
        a[1] - b[1] * s,
        a[2] - b[2] * s,
        a[3] - b[3] * s,
    ]
}

/// `s a`.
#[inline(always)]
pub(crate) fn times(a: Lanes, s: f64) -> Lanes {
    [a[0] * s, a[1] * s, a[2] * s, a[3] * s]
}

/// Whether a vector has a number that is not zero.
#[inline(always)]
pub(crate) fn any(a: &[Lanes]) -> bool {
    // a loop without an early exit vectorises
    let numbers = a.as_flattened().iter();
    numbers.fold(0, |bits, x| bits | x.to_bits()) != 0
}

/// `a += s b`.
#[inline(always)]
pub(crate) fn add_scaled(a: &mut [Lanes], b: &[Lanes], s: f64) {
    for (a, b) in a.iter_mut().zip(b) {
        *a = plus(*a, *b, s);
    }
}

/// A linear combination of rows of a matrix, added one row after the other. Each group of four
/// stays in a register until the sum is complete.
///
/// For each of `count` terms, `term` gives the start of the row and the factor.
#[inline(always)]
pub(crate) fn combine(
    out: &mut [Lanes],
    rows: &[Lanes],
    count: usize,
    term: impl Fn(usize) -> (usize, f64),
) {
    for (chunk, out) in out.chunks_mut(4).enumerate() {
        let group = 4 * chunk;
        match out.len() {
            1 => sum_of_rows::<1>(out, group, rows, count, &term),
            2 => sum_of_rows::<2>(out, group, rows, count, &term),
            3 => sum_of_rows::<3>(out, group, rows, count, &term),
            _ => sum_of_rows::<4>(out, group, rows, count, &term),
        }
    }
}

/// [`combine`] for `G` groups of four.
#[inline(always)]
fn sum_of_rows<const G: usize>(
    out: &mut [Lanes],
    group: usize,
    rows: &[Lanes],
    count: usize,
    term: impl Fn(usize) -> (usize, f64),
) {
    let mut sums = [[0.0; 4]; G];
    for index in 0..count {
        let (start, factor) = term(index);
        let row = &rows[start + group..][..G];
        for g in 0..G {
            sums[g] = plus(sums[g], row[g], factor);
        }
    }
    out.copy_from_slice(&sums);
}

/// Sets element `i` of a vector. All four numbers of the group are written at once: a later read of
/// the whole group would stall after a partial write.
#[inline(always)]
pub(crate) fn set(vector: &mut [Lanes], i: usize, x: f64) {
    const ALL: u64 = u64::MAX;
    const LANES: [[u64; 4]; 4] = [
        [ALL, 0, 0, 0],
        [0, ALL, 0, 0],
        [0, 0, ALL, 0],
        [0, 0, 0, ALL],
    ];
    let (four, lane) = (&mut vector[i / 4], &LANES[i % 4]);
    *four = std::array::from_fn(|k| {
        f64::from_bits((x.to_bits() & lane[k]) | (four[k].to_bits() & !lane[k]))
    });
}

/// Copies `from` to a vector, and zeros to the elements after its end. (A buffer may hold anything
/// there: zero times infinity is not a number.)
#[inline]
pub(crate) fn put(to: &mut [Lanes], from: &[f64]) {
    let (front, rest) = to.as_flattened_mut().split_at_mut(from.len());
    front.copy_from_slice(from);
    rest.fill(0.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The results of different orders of summation differ in the last bits, so the test tells the
    /// orders apart.
    #[test]
    fn rows_are_combined_and_elements_set() {
        for groups in 1..=9 {
            let rows: Vec<Lanes> = (0..3 * groups)
                .map(|i| std::array::from_fn(|k| (4 * i + k) as f64 * 0.1))
                .collect();
            let terms = [(0, 0.3), (2 * groups, -0.7)];
            let mut expected = vec![[0.0; 4]; groups];
            for (start, factor) in terms {
                add_scaled(&mut expected, &rows[start..start + groups], factor);
            }
            let mut got = vec![[f64::NAN; 4]; groups];
            combine(&mut got, &rows, terms.len(), |index| terms[index]);
            assert_eq!(got, expected);
            for i in 0..4 * groups {
                set(&mut got, i, -1.5);
                expected[i / 4][i % 4] = -1.5;
                assert_eq!(got, expected);
            }
        }
    }

    #[test]
    fn sums_have_libmujocos_order() {
        let x: Vec<f64> = (1..=11).map(|k| f64::from(k) * 0.1 + 0.01).collect();
        let p = |k: usize| x[k] * x[k];
        let lanes = |k: usize| p(k) + p(k + 4);
        let four = (lanes(0) + lanes(2)) + (lanes(1) + lanes(3));
        let mut padded = vec![[0.0; 4]; groups(11)];
        put(&mut padded, &x);
        let expected = four + (p(8) + p(9) + p(10));
        assert_eq!(dot(&padded, &padded, 11), expected);
        assert_eq!(dot_slices(&x, &x), expected);
        assert_eq!(dot(&padded[..2], &padded, 11), four);
        let columns: Vec<usize> = (0..11).collect();
        assert_eq!(dot_sparse(&x, &columns, &x), four + p(8) + p(9) + p(10));
        assert_ne!(
            expected,
            four + p(8) + p(9) + p(10),
            "the two products differ"
        );
        assert_eq!(dot_slices(&x[..3], &x[..3]), p(0) + p(1) + p(2));
    }
}
