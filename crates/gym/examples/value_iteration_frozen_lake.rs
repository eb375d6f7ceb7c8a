//! Value iteration on FrozenLake from its transition table `P`, then 1000 episodes of the policy
//! found. Run it with `cargo run --release --example value_iteration_frozen_lake`.

use gym::prelude::*;
use gym::toytext::FrozenLake;
use gym::toytext::frozen_lake::{Action, Config, FrozenLakeDynamics};
use gym::wrappers::TimeLimit;

const DISCOUNT: f64 = 0.999;

/// The expected return of an action, given the values of the states it leads to.
fn action_value(lake: &FrozenLakeDynamics, values: &[f64], state: usize, action: Action) -> f64 {
    let outcomes = lake.p().outcomes(state, action as usize);
    outcomes
        .iter()
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
}

fn best(lake: &FrozenLakeDynamics, values: &[f64], state: usize) -> (Action, f64) {
    let rated = Action::ALL.map(|action| (action, action_value(lake, values, state, action)));
    rated.into_iter().fold(
        rated[0],
        |best, other| if other.1 > best.1 { other } else { best },
    )
}

fn main() -> Result<()> {
    let env = FrozenLake::new(Config::default())?;
    let lake = env.dynamics();
    let mut values = vec![0.0; lake.p().states()];
    let mut sweeps = 0;
    loop {
        sweeps += 1;
        let next: Vec<f64> = (0..values.len())
            .map(|state| best(lake, &values, state).1)
            .collect();
        let change = next
            .iter()
            .zip(&values)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        values = next;
        if change < 1e-10 {
            break;
        }
    }
    println!("{sweeps} sweeps; value of the start {:.4}", values[0]);

    let mut env = TimeLimit::new(env.clone(), 100)?;
    let mut reached = 0;
    let mut state = env.reset(0)?;
    for _ in 0..1000 {
        loop {
            let (action, _) = best(lake, &values, state);
            let step = env.step(&action)?;
            state = step.observation;
            if step.done() {
                reached += u32::from(step.reward > 0.0);
                break;
            }
        }
        state = env.reset(())?;
    }
    println!(
        "goal reached in {:.1} % of 1000 episodes (70 % counts as solved)",
        f64::from(reached) / 10.0
    );
    Ok(())
}
