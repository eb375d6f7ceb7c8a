//! The entries of masks and probabilities: checks and choices.

use std::fmt;

use gym_numerics::Generator;

use crate::value::fault::Fault;

/// An entry of a [`Selection`](super::Selection). The methods assume that the checks have passed.
pub(super) trait Weight: Copy + fmt::Debug + PartialEq + 'static {
    /// Whether one of the entries can be chosen. `tolerance` applies to a sum of probabilities.
    fn check_choice(weights: &[Self], tolerance: f64) -> Result<(), Fault>;

    /// Whether each entry is valid for a binary choice.
    fn check_tosses(weights: &[Self]) -> Result<(), Fault>;

    /// An index, as `Discrete` chooses it.
    fn choose(weights: &[Self], rng: &mut Generator) -> usize;

    /// An index, as `MultiDiscrete` chooses it.
    fn choose_rescaled(weights: &[Self], rng: &mut Generator) -> usize {
        Self::choose(weights, rng)
    }

    /// A zero or a one for each entry, as `MultiBinary` chooses them.
    fn toss(weights: &[Self], rng: &mut Generator, out: &mut [i8]);

    /// The probability of each character, as `Text` computes it.
    fn probabilities(weights: &[Self]) -> Vec<f64>;
}

/// numpy's `integers(0, 2, dtype=np.int8)`: a byte of the stream each.
pub(super) fn toss(rng: &mut Generator, values: &mut [i8]) {
    // A word holds four bytes, and the end of a call drops the rest: pieces of a multiple of four
    // bytes equal the whole.
    let mut bytes = [0; 64];
    for piece in values.chunks_mut(bytes.len()) {
        let bytes = &mut bytes[..piece.len()];
        rng.integers_u8(0, 1, bytes);
        for (value, byte) in piece.iter_mut().zip(bytes) {
            *value = *byte as i8;
        }
    }
}

/// The weights of a [`Mask`](super::Mask).
impl Weight for i8 {
    fn check_choice(weights: &[Self], _: f64) -> Result<(), Fault> {
        check_each(
            weights,
            |&entry| entry == 0 || entry == 1,
            "neither 0 nor 1",
        )
    }

    fn check_tosses(weights: &[Self]) -> Result<(), Fault> {
        check_each(weights, |entry| (0..=2).contains(entry), "not 0, 1 or 2")
    }

    fn choose(weights: &[Self], rng: &mut Generator) -> usize {
        let allowed = || {
            weights
                .iter()
                .enumerate()
                .filter(|(_, entry)| **entry == 1)
                .map(|(i, _)| i)
        };
        match allowed().count() {
            0 => 0,
            n => allowed().nth(rng.choice(n)).unwrap_or(0),
        }
    }

    fn toss(weights: &[Self], rng: &mut Generator, out: &mut [i8]) {
        toss(rng, out);
        for (out, entry) in out
            .iter_mut()
            .zip(weights)
            .filter(|(_, entry)| **entry != 2)
        {
            *out = *entry;
        }
    }

    fn probabilities(weights: &[Self]) -> Vec<f64> {
        let total = weights
            .iter()
            .map(|&entry| i64::from(entry))
            .sum::<i64>()
            .max(1);
        weights
            .iter()
            .map(|&entry| f64::from(entry) / total as f64)
            .collect()
    }
}

/// The weights of [`Probabilities`](super::Probabilities).
impl Weight for f64 {
    fn check_choice(weights: &[Self], tolerance: f64) -> Result<(), Fault> {
        Self::check_tosses(weights)?;
        let sum = pairwise_sum(weights);
        if (sum - 1.0).abs() <= tolerance {
            return Ok(());
        }
        Err(Fault::new(format!(
            "the probabilities sum to {sum} and should sum to 1"
        )))
    }

    fn check_tosses(weights: &[Self]) -> Result<(), Fault> {
        check_each(
            weights,
            |entry| (0.0..=1.0).contains(entry),
            "not between 0 and 1",
        )
    }

    fn choose(weights: &[Self], rng: &mut Generator) -> usize {
        rng.choice_p(weights)
    }

    fn choose_rescaled(weights: &[Self], rng: &mut Generator) -> usize {
        let total = pairwise_sum(weights);
        let possible: Vec<usize> = (0..weights.len()).filter(|&i| weights[i] > 0.0).collect();
        let rescaled: Vec<f64> = possible.iter().map(|&i| weights[i] / total).collect();
        possible.get(rng.choice_p(&rescaled)).copied().unwrap_or(0)
    }

    fn toss(weights: &[Self], rng: &mut Generator, out: &mut [i8]) {
        for (out, p) in out.iter_mut().zip(weights) {
            *out = (rng.random() <= *p).into();
        }
    }

    fn probabilities(weights: &[Self]) -> Vec<f64> {
        weights.to_vec()
    }
}

fn check_each<T: fmt::Debug>(
    weights: &[T],
    is_valid: impl Fn(&T) -> bool,
    complaint: &str,
) -> Result<(), Fault> {
    match weights.iter().position(|entry| !is_valid(entry)) {
        None => Ok(()),
        Some(i) => Err(Fault::new(format!("{:?} is {complaint}", weights[i])).at(i)),
    }
}

/// numpy's `sum`, to the last bit: eight running sums in blocks of up to 128 numbers.
fn pairwise_sum(numbers: &[f64]) -> f64 {
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
    fn where_nothing_may_be_chosen_the_first_is() {
        let mut rng = Generator::from(0);
        let untouched = rng.clone();
        assert_eq!(<i8 as Weight>::choose(&[0, 0, 0], &mut rng), 0);
        assert_eq!(rng, untouched);
    }

    #[test]
    fn sums_agree_with_plain_ones() {
        for n in [0, 1, 7, 8, 9, 127, 128, 129, 1000] {
            let numbers: Vec<f64> = (0..n).map(f64::from).collect();
            assert_eq!(pairwise_sum(&numbers), numbers.iter().sum::<f64>(), "{n}");
        }
    }

    /// `np.sum([1 / (i + 3) for i in range(n)])`, which plain sums differ from.
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
