//! Proximal policy optimization (Schulman et al., 2017) on vector environments:
//!
//! ```text
//! cargo run --release -p gym-ppo -- CartPole-v1
//! ```
//!
//! Trains until the mean return of the last 100 episodes reaches the environment's threshold, shows how
//! it goes, and leaves a plot of all returns. The same seed gives the same agent.

mod agent;
mod rollout;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::time::Instant;

use agent::Agent;
use anyhow::{Context, bail};
use clap::Parser;
use gym::rendering::Plot;
use gym::vector::{Autoreset, VectorEnv};
use gym::{Generator, Space};
use indicatif::{ProgressBar, ProgressStyle};
use rollout::Rollout;

#[derive(Parser)]
#[command(about = "Trains an agent by proximal policy optimization")]
struct Arguments {
    /// An environment with a few discrete actions that observes a row of numbers.
    #[arg(default_value = "CartPole-v1")]
    id: String,
    /// Seeds the environments and the agent.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Gives up after so many steps of all environments together.
    #[arg(long, default_value_t = 2_000_000)]
    steps: u64,
    /// Where the plot of returns goes, as SVG.
    #[arg(long, default_value = "target/ppo.svg")]
    plot: PathBuf,
}

/// What the algorithm leaves open.
struct Settings {
    envs: usize,
    /// Steps of each environment between two rounds of learning.
    steps: usize,
    minibatch: usize,
    epochs: usize,
    learning_rate: f64,
    discount: f32,
    gae_lambda: f32,
    clip: f64,
    entropy_coefficient: f64,
}

impl Settings {
    /// Settings found good for a task; those of CartPole and LunarLander follow RL Baselines3 Zoo.
    fn of(id: &str) -> Self {
        let lander = Self {
            envs: 16,
            steps: 1024,
            minibatch: 256,
            epochs: 4,
            learning_rate: 5e-4,
            discount: 0.999,
            gae_lambda: 0.98,
            clip: 0.2,
            entropy_coefficient: 0.01,
        };
        if id.starts_with("CartPole") {
            return Self {
                envs: 8,
                steps: 32,
                epochs: 20,
                learning_rate: 1e-3,
                discount: 0.98,
                gae_lambda: 0.8,
                entropy_coefficient: 0.0,
                ..lander
            };
        }
        lander
    }
}

/// Episodes whose mean return decides whether the task is solved.
const WINDOW: usize = 100;

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let settings = Settings::of(&arguments.id);
    let spec = gym::builder(&arguments.id).vector(settings.envs).autoreset(Autoreset::SameStep).spec()?;
    let mut envs = spec.make()?;
    let (Space::Box(observation), Space::Discrete(action)) =
        (envs.single_observation_space(), envs.single_action_space())
    else {
        bail!("{} does not observe a row of numbers or has no discrete actions", arguments.id);
    };
    let threshold = spec.env.reward_threshold.unwrap_or(f64::INFINITY);

    let mut rng = Generator::from(arguments.seed);
    let mut agent = Agent::new(observation.shape().iter().product(), action.n() as usize, &mut rng)?;
    let mut rollout = Rollout::new(&mut envs, settings.steps, arguments.seed)?;
    let mut returns = Vec::new();
    let mut running = vec![0.0; settings.envs];
    let mut recent = VecDeque::new();
    let mean = |recent: &VecDeque<f64>| recent.iter().sum::<f64>() / recent.len().max(1) as f64;

    let bar = ProgressBar::new(arguments.steps).with_style(ProgressStyle::with_template(
        "{elapsed} {wide_bar} {human_pos} steps, {per_sec}, {msg}",
    )?);
    let started = Instant::now();
    let mut steps = 0;
    while steps < arguments.steps && !(recent.len() == WINDOW && mean(&recent) >= threshold) {
        rollout.collect(&mut envs, &agent, &mut rng, |columns| {
            for (i, total) in running.iter_mut().enumerate() {
                *total += columns.rewards[i];
                if columns.terminated[i] || columns.truncated[i] {
                    returns.push(*total);
                    recent.push_back(std::mem::take(total));
                    if recent.len() > WINDOW {
                        recent.pop_front();
                    }
                }
            }
        })?;
        let progress = steps as f64 / arguments.steps as f64;
        agent.learn(&rollout.batch(&agent, &settings)?, &settings, progress, &mut rng)?;
        steps += (settings.steps * settings.envs) as u64;
        bar.set_position(steps);
        bar.set_message(format!("{} episodes, mean return {:.1}", returns.len(), mean(&recent)));
    }
    bar.abandon();
    let seconds = started.elapsed().as_secs_f64();
    let env_seconds = rollout.env_time.as_secs_f64();
    println!(
        "{}: mean return {:.1} over the last {} of {} episodes, after {steps} steps and {seconds:.1} s, \
         {env_seconds:.2} s ({:.1} %) of them in the environments",
        arguments.id,
        mean(&recent),
        recent.len(),
        returns.len(),
        100.0 * env_seconds / seconds,
    );
    Plot::new(format!("{}, PPO, seed {}", arguments.id, arguments.seed))
        .x_label("episode")
        .y_label("return")
        .series("return", &returns)
        .moving_average(WINDOW)
        .write_svg(&arguments.plot)
        .with_context(|| format!("the plot {}", arguments.plot.display()))?;
    println!("returns: {}", arguments.plot.display());
    Ok(())
}
