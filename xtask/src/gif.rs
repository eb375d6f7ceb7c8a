//! `cargo xtask gif ID`

use std::path::PathBuf;

use gym::render::{RenderMode, Rendered};
use gym::rendering::GifWriter;
use gym::{BoxEnv, Env, Error, Kwargs, Result};

use crate::policy::Policy;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environment.
    id: String,
    /// Who acts.
    #[arg(long, value_enum, default_value = "random")]
    policy: Policy,
    /// Seeds the environment and its action space.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Arguments of the environment, as a JSON object.
    #[arg(long, value_parser = crate::parse_kwargs, default_value = "{}")]
    kwargs: Kwargs,
    /// Ends the recording after that many frames.
    #[arg(long, default_value_t = 500)]
    max_frames: u64,
    /// The file; by default the id with `.gif`.
    #[arg(long)]
    out: Option<PathBuf>,
}

pub(crate) fn gif(arguments: &Arguments) -> Result<()> {
    let mut env = gym::builder(&arguments.id)
        .args(arguments.kwargs.clone())
        .render_mode(RenderMode::RgbArray)
        .build()?;
    let path = arguments.out.clone();
    let path = path.unwrap_or_else(|| format!("{}.gif", crate::file_stem(&arguments.id)).into());
    let mut recording = Recording::create(&path, &env, arguments.max_frames)?;
    arguments.policy.play(&mut env, arguments.seed, |env| recording.watch(env))?;
    let frames = recording.finish()?;
    println!("{}: {frames} frames", path.display());
    Ok(())
}

/// The first frames of what an environment shows, as a GIF.
pub(crate) struct Recording {
    gif: GifWriter,
    frames: u64,
    max_frames: u64,
}

impl Recording {
    pub(crate) fn create(path: &std::path::Path, env: &BoxEnv, max_frames: u64) -> Result<Self> {
        let gif = GifWriter::create(path, env.metadata().render_fps)?;
        Ok(Self { gif, frames: 0, max_frames })
    }

    pub(crate) fn watch(&mut self, env: &mut BoxEnv) -> Result<()> {
        if self.frames == self.max_frames {
            return Ok(());
        }
        self.frames += 1;
        match env.render()? {
            Rendered::Frame(frame) => self.gif.write(&frame),
            other => Err(Error::Contract(format!("`rgb_array` rendered {other:?}"))),
        }
    }

    /// Completes the file; gives the number of frames.
    pub(crate) fn finish(self) -> Result<u64> {
        self.gif.finish()?;
        Ok(self.frames)
    }
}
