//! numpy's sum of many numbers.

/// numpy's `sum`, to the last bit: eight running sums in blocks of up to 128 numbers.
pub fn pairwise_sum(numbers: &[f64]) -> f64 {
    const LANES: usize = 8;
    const BLOCK: usize = 128;
    let n = numbers.len();
    if n < LANES {
        return numbers.iter().sum();
    }
    if n > BLOCK {
        let half = n / 2;
        let (left, right) = numbers.split_at(half - half % LANES);
        return pairwise_sum(left) + pairwise_sum(right);
    }
    let mut sums = [0.0; LANES];
    let blocks = numbers.chunks_exact(LANES);
    let rest = blocks.remainder();
    for block in blocks {
        for (sum, x) in sums.iter_mut().zip(block) {
            *sum += x;
        }
    }
    let [a, b, c, d, e, f, g, h] = sums;
    rest.iter()
        .fold(((a + b) + (c + d)) + ((e + f) + (g + h)), |sum, x| sum + x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_agree_with_plain_ones() {
        for n in [0, 1, 7, 8, 9, 127, 128, 129, 1000] {
            let numbers: Vec<f64> = (0..n).map(f64::from).collect();
            assert_eq!(pairwise_sum(&numbers), numbers.iter().sum::<f64>(), "{n}");
        }
    }

    /// `np.sum([1 / (i + 3) for i in range(n)])`, for which sums in order differ in the last bits.
    #[test]
    fn sums_are_numpys_to_the_last_bit() {
        for (n, bits) in [
            (7, 0x3ff5_4374_3743_7437),
            (8, 0x3ff6_dd0d_d0dd_0dd0),
            (9, 0x3ff8_516a_e822_df44),
            (128, 0x400f_96b7_0e38_f84d),
            (129, 0x400f_a659_4108_1d6f),
            (200, 0x4011_8d44_7c87_9105),
            (1000, 0x4017_f32a_c6b1_6780_u64),
        ] {
            let numbers: Vec<f64> = (0..n).map(|i| 1.0 / f64::from(i + 3)).collect();
            assert_eq!(pairwise_sum(&numbers).to_bits(), bits, "{n}");
        }
    }
}
