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
//! Trains until the mean return of the last 100 episodes reaches the environment's threshold,
//! reports progress, and plots all returns. The same seed gives the same agent, even if the
//! training was killed and resumed from its checkpoint.

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
    /// Plays a saved policy in one environment and, with `--video`, records videos.
    Evaluate(Evaluation),
    /// Writes the policy of a checkpoint to a file that `evaluate` reads too.
    Export {
        /// The folder of the checkpoint.
        checkpoint: PathBuf,
        /// The JSON file to write.
        policy: PathBuf,
    },
}

#[derive(clap::Args)]
struct Training {
    /// An environment with observations of numbers or images, and discrete actions or actions of
    /// numbers.
    #[arg(default_value = "CartPole-v1")]
    id: String,
    /// Seeds the environments and the agent.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Stops after this number of steps, summed over all environments.
    #[arg(long, default_value_t = 2_000_000)]
    steps: u64,
    /// The SVG file for the plot of returns.
    #[arg(long, default_value = "target/ppo.svg")]
    plot: PathBuf,
    /// The folder of the checkpoint. If it holds a checkpoint, the training resumes from it.
    #[arg(long)]
    checkpoint: Option<PathBuf>,
    /// Updates between two checkpoints.
    #[arg(long, default_value_t = 10)]
    save_every: u64,
    /// Overrides one setting of the task, such as `learning_rate=1e-3`; may be repeated.
    #[arg(long, value_name = "NAME=NUMBER")]
    set: Vec<String>,
}

#[derive(clap::Args)]
struct Evaluation {
    /// The folder of a checkpoint, or the file of a policy.
    policy: PathBuf,
    /// The number of episodes to play.
    #[arg(long, default_value_t = 10)]
    episodes: u64,
    /// The seed of the first episode; the next episodes use seed + 1, seed + 2, ...
    #[arg(long, default_value_t = 1_000_000)]
    seed: u64,
    /// The folder for videos, one per episode.
    #[arg(long)]
    video: Option<PathBuf>,
    /// The width and height of the videos, such as `320x200`. Default: the environment's own size.
    #[arg(long, requires = "video")]
    size: Option<String>,
    /// The frames of each video. Default: the whole episode.
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
