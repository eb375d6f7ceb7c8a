//! The book's claims about the task.

use std::collections::BTreeSet;

use gym_core::{Dynamics, Env, EnvExt, Generator, Result, Task, Value};
use sutton_envs::windy_gridworld::{Config, State, WindyGridworldDynamics};

/// Returns the least number of steps to the goal, by trying every action in every reachable state.
fn shortest_way(king: bool) -> Result<u32> {
    let dynamics = WindyGridworldDynamics::new(Config {
        king,
        stochastic: false,
    })?;
    let mut rng = Generator::from(0);
    let (mut reached, mut seen) = (vec![dynamics.start(&0.into(), &mut rng)?], BTreeSet::new());
    for steps in 1.. {
        let mut next: Vec<State> = Vec::new();
        for state in &reached {
            for action in 0..if king { 8 } else { 4 } {
                let transition = dynamics.transition(state, &action, &mut rng)?;
                if transition.terminated {
                    return Ok(steps);
                }
                if seen.insert(dynamics.observe(&transition.state)) {
                    next.push(transition.state);
                }
            }
        }
        reached = next;
    }
    unreachable!("there is a way to the goal")
}

#[test]
fn the_shortest_way_is_that_of_the_book() -> Result<()> {
    assert_eq!(shortest_way(false)?, 15);
    assert_eq!(shortest_way(true)?, 7);
    Ok(())
}

#[test]
fn it_is_found_by_id_with_arguments() -> Result<()> {
    let mut env = gym_core::builder("sutton/WindyGridworld-v0")
        .arg("stochastic", true)
        .build()?;
    assert_eq!(env.action_space().to_string(), "Discrete(4)");
    env.reset(1)?;
    let step = env.step(&Value::Int(2))?;
    assert_eq!((step.reward, step.done()), (-1.0, false));
    let error = gym_core::builder("sutton/WindyGridworld-v0")
        .arg("kings", true)
        .build()
        .unwrap_err();
    assert!(
        error.to_string().contains(
            "unknown argument `kings`: did you mean `king`? (known are `king`, `stochastic`)"
        ),
        "{error}"
    );
    Ok(())
}
