//! An environment of your own, registered at link time and used by id like any other.
//! Run it with `cargo run --release --example custom_env`.

use gym::prelude::*;
use gym::{Dynamics, Generator, NoArguments, Registration, Stateful, Task, Transition};

gym::discrete! {
    /// A step along the corridor.
    enum Move { Left, Right }
}

/// Find the way out of a corridor of ten cells, on a floor so smooth that one step in five fails.
#[derive(Clone, Debug)]
struct Corridor;

impl Task for Corridor {
    type Config = NoArguments;
    type State = i64;
    type Observation = i64;
    type Action = Move;
    const NAME: &'static str = "Corridor";

    fn new(_: NoArguments) -> Result<Self> {
        Ok(Self)
    }
    fn config(&self) -> &NoArguments {
        &NoArguments {}
    }
    fn observation_space(&self) -> Space {
        Space::discrete(10)
    }
    fn action_space(&self) -> Space {
        Move::space()
    }
    fn start(&self, _reset: &Reset, rng: &mut Generator) -> Result<i64> {
        Ok(rng.integers(0, 5))
    }
    fn is_valid(&self, cell: &i64) -> bool {
        (0..10).contains(cell)
    }
}

impl Dynamics for Corridor {
    fn transition(
        &self,
        cell: &i64,
        action: &Move,
        rng: &mut Generator,
    ) -> Result<Transition<i64>> {
        let step = if *action == Move::Right { 1 } else { -1 };
        let cell = if rng.random() < 0.2 {
            *cell
        } else {
            (cell + step).clamp(0, 9)
        };
        Ok(Transition {
            state: cell,
            reward: -1.0,
            terminated: cell == 9,
        })
    }
    fn observe(&self, cell: &i64) -> i64 {
        *cell
    }
}

gym::register!(
    Registration::new::<Stateful<Corridor>>("my_envs/Corridor-v0").max_episode_steps(50)
);

fn main() -> Result<()> {
    let findings = gym_conform::check(|| gym::make("my_envs/Corridor-v0"));
    println!("{} rules are broken", findings.len());

    let mut env = gym::make("my_envs/Corridor-v0")?;
    println!("start in cell {}", env.reset(7)?);
    loop {
        let step = env.step(&gym::Value::Int(1))?;
        println!("walk right: cell {}", step.observation);
        if step.done() {
            return Ok(());
        }
    }
}
