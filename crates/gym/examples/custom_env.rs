//! An environment of your own, registered at link time and used by id like any other.
//! Run it with `cargo run --release --example custom_env`.

use gym::{Configure, Env, Generator, NoArguments, Outcome, Registration, Reset, Result, Snapshot, Space};
use serde::{Deserialize, Serialize};

/// Guess a number from 0 to 9; the observation says whether the last guess was too low (0), right
/// (1) or too high (2).
#[derive(Clone, Serialize, Deserialize)]
struct Guess {
    rng: Generator,
    secret: i64,
}

impl Env for Guess {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(3)
    }

    fn action_space(&self) -> Space {
        Space::discrete(10)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut i64) -> Result<()> {
        if let Some(seed) = &reset.seed {
            self.rng = Generator::new(seed);
        }
        (self.secret, *observation) = (self.rng.integers(0, 10), 1);
        Ok(())
    }

    fn step_into(&mut self, guess: &i64, observation: &mut i64) -> Result<Outcome> {
        *observation = (*guess - self.secret).signum() + 1;
        let terminated = *guess == self.secret;
        Ok(Outcome { reward: if terminated { 1.0 } else { -0.1 }, terminated, truncated: false })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(self)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        snapshot.get().map(|env| *self = env)
    }
}

impl Configure for Guess {
    type Config = NoArguments;

    fn configure(_: NoArguments) -> Result<Self> {
        Ok(Self { rng: Generator::from_os()?, secret: 0 })
    }
}

gym::register!(Registration::new::<Guess>("my_envs/Guess-v0").max_episode_steps(20));

fn main() -> Result<()> {
    let mut env = gym::make("my_envs/Guess-v0")?;
    let mut actions = env.action_sampler(7)?;
    env.reset(7)?;
    loop {
        let action = actions.sample();
        let step = env.step(&action)?;
        println!("guess {action}: observation {}, reward {}", step.observation, step.reward);
        if step.done() {
            return Ok(());
        }
    }
}
