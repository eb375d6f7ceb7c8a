//! `cargo xtask gif ID`

use std::path::PathBuf;

use gym::render::{Recorder, RenderMode};
use gym::{EnvSpec, Kwargs, Result};

use crate::inputs;
use crate::output::say;
use crate::policy::Policy;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environment.
    id: String,
    /// The policy.
    #[arg(long, value_enum, default_value = "random")]
    policy: Policy,
    /// Seeds the environment and its action space.
    #[arg(long, default_value_t = 0, allow_negative_numbers = true, value_parser = inputs::parse_seed)]
    seed: u64,
    /// Arguments of the environment, as a JSON object.
    #[arg(long, value_parser = inputs::parse_kwargs, default_value = "{}")]
    kwargs: Kwargs,
    /// Ends the recording after this number of frames.
    #[arg(long, default_value_t = 500, allow_negative_numbers = true, value_parser = inputs::parse_count)]
    max_frames: u64,
    /// The file, whose extension is its format: .gif, .png (animated) or .mp4 (through `ffmpeg`).
    /// By default the id with `.gif`.
    #[arg(long)]
    out: Option<PathBuf>,
}

pub(crate) fn gif(arguments: &Arguments) -> Result<()> {
    let spec = gym::builder(&arguments.id)
        .args(arguments.kwargs.clone())
        .render_mode(RenderMode::RgbArray)
        .spec()?;
    // (an episode without end is recorded too)
    let most = u32::try_from(arguments.max_frames).unwrap_or(u32::MAX);
    let steps = spec.max_episode_steps.unwrap_or(most).min(most);
    let mut env = EnvSpec {
        max_episode_steps: Some(steps),
        ..spec
    }
    .make()?;
    let path = arguments.out.clone();
    let path = path.unwrap_or_else(|| format!("{}.gif", inputs::file_stem(&arguments.id)).into());
    let mut recorder = Recorder::new(&path, &env)?.max_frames(arguments.max_frames);
    arguments
        .policy
        .play(&mut env, arguments.seed, |env| recorder.capture(env))?;
    let frames = recorder.finish()?;
    say(format_args!("{}: {frames} frames", path.display()))?;
    Ok(())
}
