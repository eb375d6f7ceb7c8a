//! Proximal policy optimization (Schulman et al., 2017) on vector environments:
//!
//! ```text
//! cargo run --release -p gym-ppo -- CartPole-v1
//! cargo run --release -p gym-ppo -- Pendulum-v1 --steps 300000 --checkpoint runs/pendulum
//! RAYON_NUM_THREADS=1 cargo run --release -p gym-ppo -- ALE/Pong-v5 --checkpoint runs/pong
//! cargo run --release -p gym-ppo -- evaluate runs/pendulum --video videos
//! cargo run --release -p gym-ppo -- export runs/pendulum pendulum.json
//! ```
//!
//! Trains until the mean return of the last 100 episodes reaches the environment's threshold, shows
//! how it goes, and leaves a plot of all returns. The same seed gives the same agent, also where
//! the training was killed and resumed from its checkpoint.

mod adam;
mod agent;
mod batch;
mod convolution;
mod evaluate;
mod network;
mod numbers;
mod policy;
mod rollout;
mod settings;
mod store;
mod train;

use std::path::PathBuf;

use clap::Parser;

use crate::policy::Policy;

#[derive(Parser)]
#[command(
    about = "Trains an agent by proximal policy optimization",
    args_conflicts_with_subcommands = true
)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    training: Training,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Plays a saved policy in one environment, and records videos where it is told to.
    Evaluate(Evaluation),
    /// Writes the policy of a checkpoint to a file of its own, which `evaluate` takes too.
    Export {
        /// The folder of the checkpoint.
        checkpoint: PathBuf,
        /// The file, as JSON.
        policy: PathBuf,
    },
}

#[derive(clap::Args)]
struct Training {
    /// An environment that observes a row of numbers or pictures, with a few discrete actions or a
    /// row of numbers.
    #[arg(default_value = "CartPole-v1")]
    id: String,
    /// Seeds the environments and the agent.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Stops after this many steps of all environments together.
    #[arg(long, default_value_t = 2_000_000)]
    steps: u64,
    /// Where the plot of returns goes, as SVG.
    #[arg(long, default_value = "target/ppo.svg")]
    plot: PathBuf,
    /// A folder for the checkpoint: the training resumes from the one that is there.
    #[arg(long)]
    checkpoint: Option<PathBuf>,
    /// Rounds of learning between two checkpoints.
    #[arg(long, default_value_t = 10)]
    save_every: u64,
    /// A setting in place of the task's own, such as `learning_rate=1e-3`; may be repeated.
    #[arg(long, value_name = "NAME=NUMBER")]
    set: Vec<String>,
}

#[derive(clap::Args)]
struct Evaluation {
    /// The folder of a checkpoint, or the file of a policy.
    policy: PathBuf,
    /// How many episodes are played.
    #[arg(long, default_value_t = 10)]
    episodes: u64,
    /// Seeds the first episode; the next ones have this plus 1, plus 2, ...
    #[arg(long, default_value_t = 1_000_000)]
    seed: u64,
    /// A folder for videos, one of each episode.
    #[arg(long)]
    video: Option<PathBuf>,
    /// The width and height of the videos, such as `320x200`; the environment's own if it is
    /// absent.
    #[arg(long, requires = "video")]
    size: Option<String>,
    /// The length of each video; whole episodes if it is absent.
    #[arg(long, requires = "video")]
    frames: Option<u64>,
}

fn main() -> anyhow::Result<()> {
    let Arguments { command, training } = Arguments::parse();
    match command {
        Some(Command::Evaluate(evaluation)) => evaluate::evaluate(&evaluation),
        Some(Command::Export { checkpoint, policy }) => Policy::find(&checkpoint)?.write(&policy),
        None => train::train(&training),
    }
}
