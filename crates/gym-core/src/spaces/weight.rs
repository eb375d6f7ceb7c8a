//! The entries of masks and probabilities: checks and choices.

use std::fmt;

use gym_numerics::Generator;
use gym_numerics::math::pairwise_sum;

use crate::value::fault::Fault;

/// An entry of a [`Selection`](super::Selection). The methods assume that the checks have passed.
pub(super) trait Weight: Copy + fmt::Debug + PartialEq + 'static {
    /// Whether one of the entries can be chosen. `tolerance` applies to a sum of probabilities.
    fn check_choice(weights: &[Self], tolerance: f64) -> Result<(), Fault>;

    /// Whether each entry is valid for a binary choice.
    fn check_tosses(weights: &[Self]) -> Result<(), Fault>;

    /// Draws an index as `Discrete` does.
    fn choose(weights: &[Self], rng: &mut Generator) -> usize;

    /// Draws an index as `MultiDiscrete` does.
    fn choose_rescaled(weights: &[Self], rng: &mut Generator) -> usize {
        Self::choose(weights, rng)
    }

    /// Draws 0 or 1 for each entry as `MultiBinary` does.
    fn toss(weights: &[Self], rng: &mut Generator, out: &mut [i8]);

    /// The probability of each character, as `Text` computes it.
    fn probabilities(weights: &[Self]) -> Vec<f64>;
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
        rng.tosses(out);
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
}
