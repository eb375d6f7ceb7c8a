//! `cargo xtask mjcf MODEL`

mod describe;
mod film;
mod run;
#[cfg(feature = "human")]
mod window;

use std::path::PathBuf;
use std::sync::Arc;

use crate::inputs;
use crate::output::{say, text};
use gym::sim::SimEnv;
use gym::sim::engine::{Model, Revision};
#[cfg(feature = "human")]
use gym::sim::viewer::Viewer;
use gym::{EnvExt as _, Error, Result};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A file in MJCF, or the id of an environment, whose model is taken.
    model: PathBuf,
    /// The version of MuJoCo whose numbers the engine gives, instead of 4.0 or the environment's.
    #[arg(long, value_name = "VERSION")]
    mujoco: Option<Revision>,
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
    let model = load(arguments)?;
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

/// The model of a file; where there is none, that of an environment.
fn load(arguments: &Arguments) -> Result<Arc<Model>> {
    let Arguments { model, mujoco, .. } = arguments;
    let id = model.to_str().filter(|_| !model.exists());
    if let Some(id) = id.filter(|id| gym::registry::find(id).is_ok()) {
        let mut builder = gym::builder(id);
        if let Some(mujoco) = mujoco {
            builder = builder.arg("mujoco", mujoco.to_string());
        }
        let env = builder.build()?;
        let env = env
            .layer::<SimEnv>()
            .ok_or_else(|| Error::custom(format!("{id} has no MuJoCo model")))?;
        return Ok(env.simulation().model.clone());
    }
    let model = Model::from_path_with(model, mujoco.unwrap_or_default());
    model.map(Arc::new).map_err(refused)
}

/// Shows a model in a window.
#[cfg(feature = "human")]
fn show(arguments: &Arguments, model: Arc<Model>) -> Result<()> {
    let name = match &model.model {
        name if name.is_empty() => arguments.model.display().to_string(),
        name => name.clone(),
    };
    let mut viewer = Viewer::new(model)?;
    if let Some(keyframe) = &arguments.keyframe {
        viewer.reset_to(keyframe)?;
    }
    arguments.picture.aim(&mut viewer)?;
    let size = arguments.picture.size.unwrap_or((1100, 640));
    window::open(window::Live::new(&name, viewer), size)
}

#[cfg(not(feature = "human"))]
fn show(_: &Arguments, _: Arc<Model>) -> Result<()> {
    Err(Error::custom(
        "this program was built without windows: run `cargo xtask mjcf MODEL --window`",
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_is_a_file_or_that_of_an_environment() {
        let load = |words: &str| load(&inputs::parsed(words));
        let [new, old] = ["4.0", "3.12"].map(|mujoco| {
            let model = load(&format!("Humanoid-v5 --mujoco {mujoco}")).unwrap();
            (model.nu(), model.revision)
        });
        assert_eq!((new.0, old.0), (17, 17));
        assert_ne!(new.1, old.1);
        for (name, part) in [
            ("CartPole-v1", "no MuJoCo model"),
            ("Humanoid-v99.xml", "Humanoid-v99.xml"),
        ] {
            let error = load(name).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
        let error = load("CartPole-v1 --mujoco 3.12").unwrap_err();
        assert!(error.to_string().contains("mujoco"), "{error}");
    }
}
