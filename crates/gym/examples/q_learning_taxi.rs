//! Tabular Q-learning on Taxi, with a typed environment: observations index the table directly.
//! Run it with `cargo run --release --example q_learning_taxi`.

use gym::Generator;
use gym::prelude::*;
use gym::toytext::Taxi;
use gym::toytext::taxi::{Action, Config};
use gym::wrappers::TimeLimit;

const EPISODES: usize = 3_000;
const LEARNING_RATE: f64 = 0.5;
const DISCOUNT: f64 = 0.99;
const ACTIONS: usize = Action::ALL.len();

type Table = Vec<[f64; ACTIONS]>;

fn greedy(values: &[f64; ACTIONS]) -> usize {
    (0..ACTIONS)
        .max_by(|&a, &b| values[a].total_cmp(&values[b]))
        .unwrap_or(0)
}

/// Plays one episode, learns from its steps unless `exploration` is 0, and returns the return.
fn episode(
    env: &mut impl Env<Observation = usize, Action = Action>,
    q: &mut Table,
    rng: &mut Generator,
    exploration: f64,
) -> Result<f64> {
    let mut state = env.reset(())?;
    let mut total = 0.0;
    loop {
        let explore = rng.random() < exploration;
        let action = if explore {
            rng.choice(ACTIONS)
        } else {
            greedy(&q[state])
        };
        let step = env.step(&Action::ALL[action])?;
        total += step.reward;
        if exploration > 0.0 {
            // after a termination, the value of the next state is 0; after a truncation, the value
            // is bootstrapped
            let next = if step.terminated {
                0.0
            } else {
                q[step.observation][greedy(&q[step.observation])]
            };
            q[state][action] += LEARNING_RATE * (step.reward + DISCOUNT * next - q[state][action]);
        }
        state = step.observation;
        if step.done() {
            return Ok(total);
        }
    }
}

fn main() -> Result<()> {
    let mut env = TimeLimit::new(Taxi::new(Config::default())?, 200)?;
    let mut rng = Generator::from(0);
    let mut q: Table = vec![[0.0; ACTIONS]; 500];
    env.reset(0)?;
    for block in 0..10 {
        let mut sum = 0.0;
        for i in 0..EPISODES / 10 {
            let progress = (block * EPISODES / 10 + i) as f64 / EPISODES as f64;
            sum += episode(&mut env, &mut q, &mut rng, 0.3 * (1.0 - progress) + 0.01)?;
        }
        println!(
            "episodes {:>5}: mean return {:>8.2}",
            (block + 1) * EPISODES / 10,
            sum / (EPISODES / 10) as f64
        );
    }
    let mut sum = 0.0;
    for _ in 0..100 {
        sum += episode(&mut env, &mut q, &mut rng, 0.0)?;
    }
    println!(
        "greedy policy: mean return {:.2} over 100 episodes (8 counts as solved, random gives about -770)",
        sum / 100.0
    );
    Ok(())
}
