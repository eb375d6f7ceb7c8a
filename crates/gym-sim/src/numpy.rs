//! Sums, norms and functions with numpy's rounding, in the order in which numpy adds.

mod arcsinh;
mod tanh;

pub use arcsinh::arcsinh;
pub use tanh::tanh;

use std::ops::{Add, Range};

/// Sum of the squares of an action, in single precision: numpy's `np.square(action).sum()`.
pub fn sum_of_squares_f32(action: &[f32]) -> f32 {
    pairwise(&|i| action[i] * action[i], 0..action.len())
}

/// Sum of the squares of `n` numbers.
pub fn sum_of_squares(n: usize, number: impl Fn(usize) -> f64) -> f64 {
    sum_of(n, |i| number(i) * number(i))
}

/// Sum of numbers: numpy's `sum`.
pub fn sum(numbers: &[f64]) -> f64 {
    sum_of(numbers.len(), |i| numbers[i])
}

/// Sum of `n` numbers: numpy's `sum`.
pub fn sum_of(n: usize, number: impl Fn(usize) -> f64) -> f64 {
    pairwise(&number, 0..n)
}

/// numpy's pairwise summation: eight partial sums, and recursive halving above 128 numbers.
fn pairwise<T: Copy + Default + Add<Output = T>>(
    term: &impl Fn(usize) -> T,
    range: Range<usize>,
) -> T {
    const LANES: usize = 8;
    const BLOCK: usize = 128;
    let (start, n) = (range.start, range.len());
    if n < LANES {
        return range.map(term).fold(T::default(), T::add);
    }
    if n > BLOCK {
        let half = n / 2 / LANES * LANES;
        return pairwise(term, start..start + half) + pairwise(term, start + half..range.end);
    }
    let mut lanes: [T; LANES] = std::array::from_fn(|lane| term(start + lane));
    let whole = n / LANES * LANES;
    for i in (LANES..whole).step_by(LANES) {
        for (lane, sum) in lanes.iter_mut().enumerate() {
            *sum = *sum + term(start + i + lane);
        }
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    let sum = ((a + b) + (c + d)) + ((e + f) + (g + h));
    (start + whole..range.end).map(term).fold(sum, T::add)
}

/// The length of a vector, `np.linalg.norm`, as the recordings of a version have it.
pub fn norm(version: u32, v: &[f64]) -> f64 {
    dot(version, v).sqrt()
}

/// The dot product of a vector with itself, `np.dot`, whose rounding depends on the CPU. Versions 4
/// and 5 were recorded on a CPU that fuses products and sums (AVX-512), versions 2 and 3 on a CPU
/// with vectors of two doubles (no AVX).
pub fn dot(version: u32, v: &[f64]) -> f64 {
    if version >= 4 {
        inner(v, v)
    } else {
        let squares = |first: usize| v.iter().skip(first).step_by(2).map(|x| x * x).sum::<f64>();
        squares(0) + squares(1)
    }
}

/// The dot product of two vectors, `np.dot`, on a CPU with AVX-512: OpenBLAS's kernel for blocks of
/// 32 and 16 numbers, with registers of 8 and 4; the rest is added number by number.
#[expect(
    clippy::disallowed_methods,
    reason = "numpy fuses here, and a fused product is the same on every platform"
)]
pub fn inner(a: &[f64], b: &[f64]) -> f64 {
    /// Adds the products of blocks of numbers to partial sums.
    fn add<const N: usize>(sums: &mut [f64; N], a: &[f64], b: &[f64]) {
        for (a, b) in a.chunks_exact(N).zip(b.chunks_exact(N)) {
            for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
                *sum = a.mul_add(*b, *sum);
            }
        }
    }
    let n = a.len().min(b.len());
    let (wide, blocks) = (n / 32 * 32, n / 16 * 16);
    let mut sum = 0.0;
    if blocks > 0 {
        let mut sums = [0.0; 32];
        add(&mut sums, &a[..wide], &b[..wide]);
        // the halves of each register of 8
        let mut sums: [f64; 16] =
            std::array::from_fn(|i| sums[i / 4 * 8 + i % 4] + sums[i / 4 * 8 + 4 + i % 4]);
        add(&mut sums, &a[wide..blocks], &b[wide..blocks]);
        let four = |i: usize| sums[i] + sums[4 + i] + sums[8 + i] + sums[12 + i];
        sum = (four(0) + four(2)) + (four(1) + four(3));
    }
    let rest = a[blocks..n].iter().zip(&b[blocks..n]);
    rest.fold(sum, |sum, (a, b)| a.mul_add(*b, sum))
}

/// The length of a vector, `np.linalg.norm`, on a CPU for which OpenBLAS has a kernel with AVX2, but
/// none with AVX-512, such as AMD's.
pub fn norm_avx2(v: &[f64]) -> f64 {
    inner_avx2(v, v).sqrt()
}

/// The dot product of two vectors, `np.dot`, on such a CPU: four registers of four sums for blocks of
/// 16 numbers; the rest is multiplied and added number by number.
#[expect(
    clippy::disallowed_methods,
    reason = "numpy fuses here, and a fused product is the same on every platform"
)]
pub fn inner_avx2(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let blocks = n / 16 * 16;
    let mut sums = [0.0; 16];
    for (a, b) in a[..blocks]
        .chunks_exact(16)
        .zip(b[..blocks].chunks_exact(16))
    {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum = a.mul_add(*b, *sum);
        }
    }
    let halves = |i: usize| sums[i] + sums[2 + i];
    let four = |i: usize| (halves(i) + halves(4 + i)) + (halves(8 + i) + halves(12 + i));
    let rest = a[blocks..n].iter().zip(&b[blocks..n]);
    rest.fold(four(0) + four(1), |sum, (a, b)| sum + a * b)
}

/// The product of three rows of numbers and a vector, `a @ b`, on such a CPU. `columns` has those
/// columns of the rows that are not zero, with their numbers, in order; `length` counts all.
#[expect(
    clippy::disallowed_methods,
    reason = "numpy fuses here, and a fused product is the same on every platform"
)]
pub fn three_rows_avx2(
    length: usize,
    columns: impl Iterator<Item = (usize, [f64; 3])>,
    b: &[f64],
) -> [f64; 3] {
    // (the last one to three products)
    let whole = length / 4 * 4;
    let (mut sums, mut rest) = ([[0.0; 4]; 3], [[0.0; 3]; 3]);
    for (i, column) in columns {
        for (k, a) in column.into_iter().enumerate() {
            match i.checked_sub(whole) {
                Some(last) => rest[k][last] = a,
                // the first two rows have a register of two sums, the third has two
                None => sums[k][i % if k < 2 { 2 } else { 4 }] += a * b[i],
            }
        }
    }
    let b = &b[whole..length];
    std::array::from_fn(|k| {
        let ([first, second, third, fourth], a) = (sums[k], rest[k]);
        let sum = (first + third) + (second + fourth);
        match b {
            [x] => a[0].mul_add(*x, sum),
            [x, y] => sum + a[0].mul_add(*x, a[1] * y),
            [x, y, z] => sum + a[2].mul_add(*z, a[0].mul_add(*x, a[1] * y)),
            _ => sum,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_round_as_on_the_cpus_of_the_recordings() {
        // numpy 1.26 and 2.4, with OPENBLAS_CORETYPE=SkylakeX and Prescott
        let v = [0.696, -1.184, -0.662];
        assert_eq!(norm(4, &v), 1.524_636_350_084_832_3);
        assert_eq!(norm(3, &v), 1.524_636_350_084_832_6);
    }

    #[test]
    fn hyperbolic_functions_round_as_on_a_cpu_with_avx_512() {
        // numpy 2.5: np.arcsinh(x), np.tanh(x)
        for (x, arcsinh_of_x, tanh_of_x) in [
            (68.72531706158372, 4.923317754443029, 1.0),
            (
                1.092524028747032e-05,
                1.0925240287252978e-05,
                1.0925240287035638e-05,
            ),
            (
                0.005542009948192656,
                0.005541981579151961,
                0.005541953210024139,
            ),
            (0.2395218161453852, 0.23728874402982877, 0.23504403408933938),
            (835.1023968353297, 7.420701887308946, 1.0),
            (
                0.05349628813685472,
                0.05347080452449469,
                0.053445313653857116,
            ),
            (
                5.618887428741787e-05,
                5.618887425785138e-05,
                5.6188874228284895e-05,
            ),
            (39.72027094645136, 4.3751672619976025, 1.0),
            (
                0.006615854814607094,
                0.00661580655340959,
                0.006615758292000864,
            ),
            (0.24157778844675418, 0.23928769543936798, 0.2369854818373958),
            (
                1.2585427777241988e-05,
                1.2585427776909748e-05,
                1.2585427776577508e-05,
            ),
            (0.3548704042785844, 0.34781502551122356, 0.3406877708910515),
            (8.852568279494, 2.8770297199638657, 0.9999999590940127),
            (
                0.06796993399838624,
                0.06791770665281119,
                0.06786545536403947,
            ),
            (1.0, 0.881373587019543, 0.7615941559557649),
            (1e+200, 461.2101657793691, 1.0),
        ] {
            assert_eq!(arcsinh(x), arcsinh_of_x, "{x}");
            assert_eq!(arcsinh(-x), -arcsinh_of_x, "{x}");
            assert_eq!(tanh(x), tanh_of_x, "{x}");
            assert_eq!(tanh(-x), -tanh_of_x, "{x}");
        }
        for x in [f64::INFINITY, 0.0, -0.0] {
            assert_eq!(arcsinh(x).to_bits(), x.to_bits());
        }
        assert_eq!(tanh(f64::INFINITY), 1.0);
        assert!(arcsinh(f64::NAN).is_nan() && tanh(f64::NAN).is_nan());
    }

    /// Every row of the tables: numpy 2.5's sums over a hundred thousand numbers from 2^-12 to 2^12.
    #[test]
    fn hyperbolic_functions_are_numpys_over_their_whole_range() {
        let sum = |f: fn(f64) -> f64| {
            let mut sum = gym_testing::Sum::default();
            for i in 0..100_000 {
                let x = f64::from_bits(0x3f30_0000_0000_0000 + i * 1_080_863_910_568);
                sum.word(f(x).to_bits());
            }
            sum.finish()
        };
        assert_eq!(sum(arcsinh), 0xbcd6_0a23_0ab2_cdac);
        assert_eq!(sum(tanh), 0x46db_a19c_1470_a07d);
    }

    #[test]
    fn long_dot_products_add_in_blocks() {
        // numpy 2.5, on a CPU with AVX-512: np.dot(1 / n, np.sqrt(n)) for n = np.arange(1, length + 1)
        for (length, product, norm_of_inverses) in [
            (20, 7.595255025289833, 1.2633935427700362),
            (33, 10.11558982983433, 1.2708601561436532),
            (50, 12.752373944855655, 1.2748069397448107),
            (70, 15.332536308685953, 1.277008186148397),
        ] {
            let n = (1..=length).map(f64::from);
            let (inverses, roots): (Vec<f64>, Vec<f64>) = n.map(|n| (1.0 / n, n.sqrt())).unzip();
            assert_eq!(inner(&inverses, &roots), product, "{length}");
            assert_eq!(norm(4, &inverses), norm_of_inverses, "{length}");
        }
    }

    #[test]
    fn products_round_as_on_a_cpu_without_avx_512() {
        // numpy 2.5 with OPENBLAS_CORETYPE=Zen: as above, and
        // (1 / np.arange(1, 3 * n + 1).reshape(3, n)) @ np.sqrt(np.arange(1, n + 1))
        for (length, product, norm_of_inverses) in [
            (20, 7.595255025289832, 1.2633935427700362),
            (33, 10.115589829834331, 1.2708601561436532),
            (50, 12.752373944855657, 1.2748069397448107),
            (70, 15.332536308685953, 1.2770081861483973),
        ] {
            let n = (1..=length).map(f64::from);
            let (inverses, roots): (Vec<f64>, Vec<f64>) = n.map(|n| (1.0 / n, n.sqrt())).unzip();
            assert_eq!(inner_avx2(&inverses, &roots), product, "{length}");
            assert_eq!(norm_avx2(&inverses), norm_of_inverses, "{length}");
        }
        for (length, product) in [
            (
                13,
                [5.888534476577857, 1.601016575579331, 0.9727827568254745],
            ),
            (
                14,
                [6.155795718490282, 1.6580323474392042, 1.0069300553370764],
            ),
            (
                15,
                [6.413994608237443, 1.713104978985726, 1.0399361890583143],
            ),
            (
                16,
                [6.663994608237443, 1.7664233323609948, 1.0719096718626064],
            ),
            (
                21,
                [7.813472915525825, 2.011572122933001, 1.2191052330864043],
            ),
        ] {
            let roots: Vec<f64> = (1..=length).map(|n| f64::from(n as u32).sqrt()).collect();
            let inverse = |n: usize| 1.0 / (n + 1) as f64;
            let column = |i: usize| (i, [0, 1, 2].map(|k| inverse(k * length + i)));
            let columns = (0..length).map(column);
            assert_eq!(
                three_rows_avx2(length, columns, &roots),
                product,
                "{length}"
            );
        }
    }

    #[test]
    fn sums_in_numpys_order() {
        // numpy 2.4: np.sum(1 / np.arange(1, n + 1)), and with dtype float32
        let numbers: Vec<f64> = (1..=300).map(|i| 1.0 / f64::from(i)).collect();
        assert_eq!(sum(&numbers[..7]), 2.5928571428571425);
        assert_eq!(sum(&numbers[..84]), 5.013973034584928);
        assert_eq!(sum(&numbers), 6.282663880299504);
    }
}
