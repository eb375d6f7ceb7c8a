//! A distribution of the start over the states of a table.

use std::sync::Arc;

use gym_core::Generator;

/// Gymnasium's `initial_state_distrib`: the probability of each initial state.
#[derive(Clone, Debug)]
pub(crate) struct Distribution {
    probabilities: Arc<[f64]>,
    /// The partial sums of the probabilities, rounded like `np.cumsum`.
    cumulative: Arc<[f64]>,
    /// The initial state if only one state is possible, whatever the drawn number.
    only: Option<usize>,
}

impl Distribution {
    /// Returns a uniform distribution over the states for which `possible` is true.
    pub(crate) fn uniform(states: usize, possible: impl Fn(usize) -> bool) -> Self {
        let count = (0..states).filter(|state| possible(*state)).count();
        Self::new(
            (0..states)
                .map(|state| {
                    if possible(state) {
                        1.0 / count as f64
                    } else {
                        0.0
                    }
                })
                .collect(),
        )
    }

    /// Returns the distribution with the probability of each state.
    pub(crate) fn new(probabilities: Arc<[f64]>) -> Self {
        let mut sum = 0.0;
        let cumulative = probabilities
            .iter()
            .map(|probability| {
                sum += probability;
                sum
            })
            .collect();
        let mut possible = (0..probabilities.len()).filter(|&state| probabilities[state] > 0.0);
        let only = match (possible.next(), possible.next()) {
            // with a probability of exactly 1, every drawn number selects this state
            (Some(state), None) if probabilities[state] == 1.0 => Some(state),
            _ => None,
        };
        Self {
            probabilities,
            cumulative,
            only,
        }
    }

    pub(crate) fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }

    /// Draws a state by the rule of [`Table::sample`]. The sums never decrease, so a binary search
    /// finds the same index as Gymnasium's scan.
    #[inline]
    pub(crate) fn sample(&self, rng: &mut Generator) -> usize {
        let r = rng.random();
        if let Some(state) = self.only {
            return state;
        }
        let state = self.cumulative.partition_point(|sum| *sum <= r);
        if state < self.cumulative.len() {
            state
        } else {
            0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_binary_search_finds_what_the_scan_finds() {
        let distribution = Distribution::uniform(500, |state| state % 5 > 1);
        let (mut fast, mut slow) = (Generator::from(1), Generator::from(1));
        for _ in 0..1000 {
            assert_eq!(
                distribution.sample(&mut fast),
                slow.categorical(distribution.probabilities())
            );
        }
    }

    #[test]
    fn a_start_above_all_sums_is_the_first_state() {
        for (probabilities, expected) in [
            (vec![0.0, 0.0, 1.0], [2, 2]),
            (vec![0.0, 0.5, 0.0], [0, 1]),
            (vec![0.1, 0.2, 0.3], [0, 2]),
            (vec![0.0, 0.0, 0.0], [0, 0]),
        ] {
            let distribution = Distribution::new(probabilities.clone().into());
            let rng = &mut Generator::from(42);
            let drawn = [(); 2].map(|()| distribution.sample(rng));
            assert_eq!(drawn, expected, "{probabilities:?}");
            assert_ne!(*rng, Generator::from(42), "each start draws");
        }
    }
}
