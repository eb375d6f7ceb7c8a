//! `cargo xtask mjcf FILE`

mod describe;
mod film;
mod run;
#[cfg(feature = "human")]
mod window;

use std::path::PathBuf;
#[cfg(feature = "human")]
use std::sync::Arc;

use crate::inputs;
use crate::output::{say, text};
use gym::sim::engine::{Model, Revision};
#[cfg(feature = "human")]
use gym::sim::viewer::Viewer;
use gym::{Error, Result};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A model in MJCF.
    file: PathBuf,
    /// The version of MuJoCo whose numbers the engine gives.
    #[arg(long, value_name = "VERSION", default_value_t)]
    mujoco: Revision,
    /// Starts at a keyframe, given by its name or number.
    #[arg(long, value_name = "NAME")]
    keyframe: Option<String>,
    /// Takes this number of steps with random controls, and prints the steps per second.
    #[arg(long, value_name = "N", value_parser = inputs::parse_count)]
    steps: Option<u64>,
    /// Seeds the random controls.
    #[arg(long, default_value_t = 0, requires = "steps")]
    seed: u32,
    /// Opens a window, in which the model is stepped live: `?` lists the keys.
    #[arg(long, group = "shown", conflicts_with = "steps")]
    window: bool,
    #[command(flatten)]
    picture: film::Picture,
}

pub(crate) fn mjcf(arguments: &Arguments) -> Result<()> {
    let model = Model::from_path_with(&arguments.file, arguments.mujoco).map_err(refused)?;
    if arguments.window {
        return show(arguments, model);
    }
    let mut data = run::start(&model, arguments.keyframe.as_deref())?;
    let mut film = film::Film::open(
        &arguments.picture,
        (&model, &data),
        arguments.steps.is_some(),
    )?;
    if let Some(steps) = arguments.steps {
        let report = run::run(&model, &mut data, (steps, arguments.seed), |data| {
            film.as_mut()
                .map_or(Ok(()), |film| film.watch(&model, data))
        });
        say(format_args!("{}", report?))?;
    } else if film.is_none() {
        return text(&describe::model(&model));
    }
    match film {
        Some(film) => say(format_args!("{}", film.finish(&model, &data)?)),
        None => Ok(()),
    }
}

/// Shows a model in a window.
#[cfg(feature = "human")]
fn show(arguments: &Arguments, model: Model) -> Result<()> {
    let name = match &model.model {
        name if name.is_empty() => arguments.file.display().to_string(),
        name => name.clone(),
    };
    let mut viewer = Viewer::new(Arc::new(model))?;
    if let Some(keyframe) = &arguments.keyframe {
        viewer.reset_to(keyframe)?;
    }
    arguments.picture.aim(&mut viewer)?;
    let size = arguments.picture.size.unwrap_or((1100, 640));
    window::open(window::Live::new(&name, viewer), size)
}

#[cfg(not(feature = "human"))]
fn show(_: &Arguments, _: Model) -> Result<()> {
    Err(Error::custom(
        "this program was built without windows: run `cargo xtask mjcf FILE --window`",
    ))
}

/// An error of the engine as one of a command.
#[expect(
    clippy::needless_pass_by_value,
    reason = "`map_err` passes errors by value"
)]
fn refused(error: gym::sim::engine::Error) -> Error {
    Error::custom(error.to_string())
}
