use std::sync::{Mutex, PoisonError};

use gym_core::render::{Frame, Metadata, RenderMode, Rendered};
use gym_core::{
    Configure, Env, Error, Outcome, Registration, Reset, Result, Snapshot, Space, Value,
};
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::Config;
use crate::spaces;
use crate::worker::{Reply, Request, Worker, value};

/// An environment that runs in a Python process.
#[derive(Debug)]
pub struct PythonEnv {
    config: Config,
    render_mode: Option<RenderMode>,
    name: String,
    spaces: (Space, Space),
    metadata: Metadata,
    /// The entries of the last `info`.
    info: Value,
    has_reset: bool,
    worker: State,
}

/// The connection to the worker.
#[derive(Debug)]
enum State {
    /// A mutex, because clones and snapshots borrow the environment immutably and also send
    /// requests.
    Alive(Mutex<Worker>),
    /// The clone could not be made, for this reason.
    Broken(String),
    Closed,
}

/// The contents of a snapshot.
#[derive(Serialize, Deserialize)]
struct Stored {
    config: Config,
    /// The environment as `pickle` stores it.
    pickle: Value,
    /// The last `info`.
    info: Value,
    has_reset: bool,
}

impl PythonEnv {
    fn start(config: Config, render_mode: Option<RenderMode>) -> Result<Self> {
        let name = config.check()?.to_owned();
        let mut worker = Worker::start(&config, &name)?;
        let Config {
            env_id,
            make_kwargs,
            backend,
            module,
            ..
        } = &config;
        let request = json!({
            "env_id": env_id,
            "make_kwargs": make_kwargs,
            "backend": backend,
            "module": module,
            "render_mode": render_mode.map(RenderMode::name),
        });
        let request = Value::Text(request.to_string());
        let about = worker.ask(Request::Make, &[&request], value)?;
        Self::described(config, render_mode, worker, &about)
    }

    /// Makes the environment from the worker's description.
    fn described(
        config: Config,
        render_mode: Option<RenderMode>,
        worker: Worker,
        about: &Value,
    ) -> Result<Self> {
        let get = |key: &str| {
            about.get(key).ok_or_else(|| {
                Error::custom(format!("the worker described no {key} of its environment"))
            })
        };
        let spaces = spaces::pair(get("spaces")?).map_err(|error| {
            Error::custom(format!("`{}` cannot be run: {error}", worker.name()))
        })?;
        let modes = get("render_modes")?.as_tuple().unwrap_or_default();
        let modes = modes
            .iter()
            .filter_map(|mode| mode.as_text()?.parse().ok())
            .filter(|mode: &RenderMode| !mode.is_list());
        let render_fps = get("render_fps")?
            .as_int()
            .and_then(|fps| u32::try_from(fps).ok())
            .unwrap_or(30);
        let metadata = Metadata {
            render_modes: among(modes),
            render_fps,
            ..Metadata::default()
        };
        let name = get("name")?.as_text().unwrap_or_default().to_owned();
        let worker = State::Alive(Mutex::new(worker));
        let (info, has_reset) = (Value::Dict(Vec::new()), false);
        Ok(Self {
            config,
            render_mode,
            name,
            spaces,
            metadata,
            info,
            has_reset,
            worker,
        })
    }

    fn worker(&mut self, call: &'static str) -> Result<&mut Worker> {
        match &mut self.worker {
            State::Alive(worker) => Ok(worker.get_mut().unwrap_or_else(PoisonError::into_inner)),
            State::Broken(why) => Err(Error::custom(why.clone())),
            State::Closed => Err(Error::Closed(call)),
        }
    }

    /// Returns the environment as `pickle` stores it.
    fn dump(&self) -> Result<Value> {
        let worker = match &self.worker {
            State::Alive(worker) => worker,
            State::Broken(why) => return Err(Error::custom(why.clone())),
            State::Closed => return Err(Error::Closed("snapshot")),
        };
        let mut worker = worker.lock().unwrap_or_else(PoisonError::into_inner);
        worker.ask(Request::Dump, &[], value)
    }

    /// Starts another worker with the environment `pickle`.
    fn load(config: Config, render_mode: Option<RenderMode>, pickle: &Value) -> Result<Self> {
        let name = config.check()?.to_owned();
        let mut worker = Worker::start(&config, &name)?;
        let module = config.module.clone().map_or(Value::Null, Value::Text);
        let about = worker.ask(Request::Load, &[&module, pickle], value)?;
        Self::described(config, render_mode, worker, &about)
    }

    /// Refuses an action that Python cannot receive: an action whose form differs from the action
    /// space's, or with numbers that are not finite.
    fn check_action(&self, action: &Value) -> Result<()> {
        let space = &self.spaces.1;
        let fits = match (space, action) {
            // Python clips or refuses numbers beyond the bounds
            (Space::Box(space), Value::Array(array)) => {
                // floats are sent in the precision in which they arrive
                let fits = array.dtype() == space.dtype() || space.dtype().is_float();
                fits && array.shape() == space.shape() && array.is_finite()
            }
            (Space::Box(space), Value::Tuple(items)) if space.dtype().is_float() => {
                space.shape() == [items.len()]
                    && items
                        .iter()
                        .all(|item| item.as_float().is_some_and(f64::is_finite))
            }
            (space, action) => space.contains(action),
        };
        if fits {
            Ok(())
        } else {
            Err(space.refuse_action(action))
        }
    }
}

/// Returns the render modes in `modes`, in the form of metadata.
fn among(modes: impl Iterator<Item = RenderMode>) -> &'static [RenderMode] {
    use RenderMode::{Ansi, Human, RgbArray};
    let (mut human, mut ansi, mut rgb_array) = (false, false, false);
    modes.for_each(|mode| match mode {
        Human => human = true,
        Ansi => ansi = true,
        RgbArray => rgb_array = true,
        _ => (),
    });
    match (human, ansi, rgb_array) {
        (false, false, false) => &[],
        (false, false, true) => &[RgbArray],
        (false, true, false) => &[Ansi],
        (false, true, true) => &[Ansi, RgbArray],
        (true, false, false) => &[Human],
        (true, false, true) => &[Human, RgbArray],
        (true, true, false) => &[Human, Ansi],
        (true, true, true) => &[Human, Ansi, RgbArray],
    }
}

impl Configure for PythonEnv {
    type Config = Config;

    fn configure(config: Config, _version: u32) -> Result<Self> {
        Self::start(config, None)
    }

    fn configure_to_render(config: Config, mode: RenderMode) -> Result<Option<Self>> {
        Self::start(config, Some(mode)).map(Some)
    }
}

/// Starts another worker that loads the environment; if the worker fails, the clone's calls return
/// the error.
impl Clone for PythonEnv {
    fn clone(&self) -> Self {
        let (config, mode) = (self.config.clone(), self.render_mode);
        let copy = self
            .dump()
            .and_then(|pickle| Self::load(config.clone(), mode, &pickle));
        let worker = match (&self.worker, copy) {
            (State::Closed, _) => State::Closed,
            (State::Broken(why), _) => State::Broken(why.clone()),
            (_, Ok(copy)) => copy.worker,
            (_, Err(error)) => State::Broken(format!(
                "this clone of `{}` could not be made: {error}",
                self.name
            )),
        };
        Self {
            config,
            render_mode: mode,
            name: self.name.clone(),
            spaces: self.spaces.clone(),
            metadata: self.metadata.clone(),
            info: self.info.clone(),
            has_reset: self.has_reset,
            worker,
        }
    }
}

impl Env for PythonEnv {
    type Observation = Value;
    type Action = Value;

    fn observation_space(&self) -> Space {
        self.spaces.0.clone()
    }

    fn action_space(&self) -> Space {
        self.spaces.1.clone()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let seed = reset
            .seed
            .as_ref()
            .map_or(Value::Null, |seed| Value::Text(seed.to_string()));
        let options = Value::Text(serde_json::Value::Object(reset.options.clone()).to_string());
        let read = |reply: &mut Reply<'_>| {
            let changed = reply.value()?;
            let mut read = Value::Null;
            reply.value_into(&mut read)?;
            Some((changed, read, reply.value()?))
        };
        let (changed, read, info) =
            self.worker("reset")?
                .ask(Request::Reset, &[&seed, &options], read)?;
        if changed != Value::Null {
            let spaces = spaces::pair(&changed).map_err(|error| {
                Error::custom(format!("`{}` failed in `reset`: {error}", self.name))
            })?;
            if !(spaces.0.has_form_of(&self.spaces.0) && spaces.1.has_form_of(&self.spaces.1)) {
                let (before, after) = (&self.spaces, &spaces);
                return Err(Error::Contract(format!(
                    "the spaces of `{}` changed at the reset: they are {} and {}, and were {} and {}",
                    self.name, after.0, after.1, before.0, before.1
                )));
            }
            self.spaces = spaces;
        }
        (*observation, self.info, self.has_reset) = (read, info, true);
        Ok(())
    }

    fn step_into(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        if let State::Alive(_) = self.worker {
            if !self.has_reset {
                return Err(Error::ResetNeeded("step"));
            }
            self.check_action(action)?;
        }
        let mut info = std::mem::take(&mut self.info);
        let read = |reply: &mut Reply<'_>| {
            let (reward, terminated, truncated) = (reply.float()?, reply.byte()?, reply.byte()?);
            reply.value_into(observation)?;
            reply.value_into(&mut info)?;
            Some(Outcome {
                reward,
                terminated: terminated != 0,
                truncated: truncated != 0,
            })
        };
        let outcome = self
            .worker("step")
            .and_then(|worker| worker.ask(Request::Step, &[action], read));
        self.info = info;
        outcome
    }

    fn snapshot(&self) -> Result<Snapshot> {
        if !self.config.allow_pickle {
            return Err(refused(&self.name));
        }
        let pickle = self.dump()?;
        let (config, info) = (self.config.clone(), self.info.clone());
        Snapshot::of(&Stored {
            config,
            pickle,
            info,
            has_reset: self.has_reset,
        })
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        if !self.config.allow_pickle {
            return Err(refused(&self.name));
        }
        if let State::Closed = self.worker {
            return Err(Error::Closed("restore"));
        }
        let Stored {
            config,
            pickle,
            info,
            has_reset,
        } = snapshot.get()?;
        if config != self.config {
            return Err(Error::Snapshot(format!(
                "it was taken from a `{}` with other arguments",
                self.name
            )));
        }
        let restored = Self::load(config, self.render_mode, &pickle)
            .map_err(|error| Error::Snapshot(error.to_string()))?;
        *self = Self {
            info,
            has_reset,
            ..restored
        };
        Ok(())
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        if let Value::Dict(entries) = &self.info {
            entries
                .iter()
                .for_each(|(key, value)| visit(key, value.clone()));
        }
    }

    fn metadata(&self) -> Metadata {
        self.metadata.clone()
    }

    fn render_mode(&self) -> Option<RenderMode> {
        self.render_mode
    }

    fn render_into(&mut self, rendered: &mut Rendered) -> Result<()> {
        let Some(mode) = self.render_mode else {
            return Err(Error::UnsupportedMode {
                target: self.describe(),
                mode: "anything".into(),
                reason:
                    "it was made without a render mode: add `.render_mode(RenderMode::RgbArray)`"
                        .into(),
            });
        };
        let picture = self.worker("render")?.ask(Request::Render, &[], value)?;
        let wrong = |what: &str, must: &str| {
            let (name, mode) = (&self.name, mode.name());
            Error::Contract(format!(
                "`{name}` rendered {what} in the mode {mode}: {must}"
            ))
        };
        *rendered = match (picture, mode.single()) {
            (Value::Text(text), RenderMode::Ansi) => Rendered::Text(text),
            (other, RenderMode::Ansi) => {
                let what = if other == Value::Null {
                    "nothing"
                } else {
                    "an array"
                };
                return Err(wrong(what, "it must be a text"));
            }
            (Value::Array(array), _) => Rendered::Frame(frame(&array).ok_or_else(|| {
                let (dtype, shape) = (array.dtype(), array.shape());
                wrong(
                    &format!("an array of {dtype} with shape {shape:?}"),
                    "a frame is uint8 of shape (height, width, 3), both at least 1",
                )
            })?),
            // Python has shown the frame in a window
            (_, RenderMode::Human) => Rendered::Shown,
            (other, _) => {
                let what = if other == Value::Null {
                    "nothing"
                } else {
                    "a text"
                };
                return Err(wrong(what, "it must be an array of pixels"));
            }
        };
        Ok(())
    }

    fn describe(&self) -> String {
        self.name.clone()
    }

    fn close(&mut self) {
        self.worker = State::Closed;
    }
}

fn refused(name: &str) -> Error {
    Error::Snapshot(format!(
        "`{name}` is stored with Python's pickle, and restoring runs code that the snapshot names: add \
         `.arg(\"allow_pickle\", true)` if you trust the snapshots"
    ))
}

/// Converts an image of bytes with the shape (height, width, 3).
fn frame(array: &gym_core::Array) -> Option<Frame> {
    let ([height, width, 3], Some(pixels)) = (array.shape(), array.as_slice::<u8>()) else {
        return None;
    };
    if pixels.is_empty() {
        return None;
    }
    let mut frame = Frame::new(u32::try_from(*width).ok()?, u32::try_from(*height).ok()?).ok()?;
    frame.pixels_mut().copy_from_slice(pixels);
    Some(frame)
}

gym_core::register!(
    Registration::new::<PythonEnv>("GymV26Environment-v0").description(
        "Runs an environment of OpenAI gym or Gymnasium, named by `env_id`, in a Python process."
    )
);

#[cfg(test)]
mod tests {
    use super::*;

    /// Every set of modes, in any order and with modes that the bridge does not have.
    #[test]
    fn metadata_has_the_modes_of_the_environment() {
        use RenderMode::{Ansi, Human, RgbArray, RgbArrayList};
        for set in 0..8 {
            let all = [Human, Ansi, RgbArray].into_iter().enumerate();
            let modes: Vec<_> = all
                .filter(|(bit, _)| set >> bit & 1 == 1)
                .map(|(_, mode)| mode)
                .collect();
            assert_eq!(among(modes.iter().copied()), modes);
            let twice = modes.iter().rev().chain(&modes).copied();
            assert_eq!(among(twice.chain([RgbArrayList])), modes);
        }
    }
}
