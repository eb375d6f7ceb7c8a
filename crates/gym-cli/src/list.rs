//! `cargo xtask list`

use gym::{Result, registry};

use crate::output::{self, say};
use crate::workspace;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// One line per environment, with spaces, limit and threshold.
    #[arg(long)]
    long: bool,
}

pub(crate) fn list(arguments: &Arguments) -> Result<()> {
    if !arguments.long {
        return output::text(&registry::pretty(3));
    }
    for registration in workspace::without_needy(registry::all()) {
        use gym::Env;
        let spec = registration.spec()?;
        let env = spec.make()?;
        let limit = spec
            .max_episode_steps
            .map_or("none".into(), |n| n.to_string());
        let threshold = spec
            .reward_threshold
            .map_or("none".into(), |x| x.to_string());
        say(format_args!(
            "{:28} limit {limit:>5}  threshold {threshold:>6}  {} -> {}",
            spec.id,
            env.action_space(),
            env.observation_space()
        ))?;
    }
    Ok(())
}
