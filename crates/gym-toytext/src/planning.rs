//! The optimal policy of a transition table.

use gym_core::policy::{Controller, reflex};
use gym_core::{BoxEnv, Dynamics, EnvExt, Stateful};

use crate::tabular::Table;

/// The description of the policy.
pub(crate) const DESCRIPTION: &str =
    "is the best one, found by value iteration over the transition table";

/// A controller that plays the best action of the environment's table.
pub(crate) fn controller<D: Dynamics>(env: &BoxEnv, table: fn(&D) -> &Table) -> Option<Controller> {
    let best = value_iteration(table(env.layer::<Stateful<D>>()?.dynamics()));
    reflex(move |state: &usize| best.get(*state).copied().unwrap_or(0))
}

/// Returns the best action in each state of a table (Sutton and Barto, section 4.4).
fn value_iteration(table: &Table) -> Vec<i64> {
    const DISCOUNT: f64 = 0.999;
    const TOLERANCE: f64 = 1e-9;
    let rate = |values: &[f64], state, action| -> f64 {
        let outcomes = table.outcomes(state, action).iter();
        outcomes
            .map(|o| {
                o.probability
                    * (o.reward
                        + if o.terminated {
                            0.0
                        } else {
                            DISCOUNT * values[o.next]
                        })
            })
            .sum()
    };
    let best = |values: &[f64], state| {
        let rated = (0..table.actions()).map(|action| (action, rate(values, state, action)));
        rated
            .reduce(|best, other| if other.1 > best.1 { other } else { best })
            .unwrap_or((0, 0.0))
    };
    let mut values = vec![0.0; table.states()];
    loop {
        let mut change = 0.0_f64;
        for state in 0..values.len() {
            let (_, value) = best(&values, state);
            change = change.max((value - values[state]).abs());
            values[state] = value;
        }
        if change < TOLERANCE {
            return (0..values.len())
                .map(|state| best(&values, state).0 as i64)
                .collect();
        }
    }
}
