//! One environment and its episode, in which the page can go back to earlier steps.

use std::collections::VecDeque;

use gym::keys::Idle;
use gym::policy::Controller;
use gym::render::{RenderMode, Rendered, Video, VideoFormat};
use gym::trace::{Event, Trace};
use gym::{
    BoxEnv, Env, EnvExt, Error, Keys, Kwargs, Reset, Result, Sampler, Seed, Snapshot, Space, Value,
    names, registry,
};
use serde_json::{Value as Json, json};

use crate::describe;

/// The number of steps between stored states.
const MARK_EVERY: usize = 16;
/// The number of stored states. Steps before the first stored state are reached from the start of
/// the episode.
const MARKS: usize = 40;

/// The source of a step's action.
#[derive(Clone, Debug)]
pub(crate) enum By {
    /// A random action.
    Random,
    /// The action of the known policy.
    Good,
    /// The caller.
    Action(Value),
}

/// An environment and its current episode.
pub(crate) struct Player {
    env: BoxEnv,
    id: String,
    kwargs: Kwargs,
    seed: Option<Seed>,
    sampler: Option<Sampler<Value>>,
    /// The state of the known policy in this episode; `None` before its first action.
    controller: Option<Controller>,
    /// The actions of the episode, and the sum of rewards after each. The page has gone back from
    /// the actions after `position`.
    actions: Vec<Value>,
    returns: Vec<f64>,
    position: usize,
    marks: VecDeque<(usize, Snapshot)>,
    observation: Value,
    reward: f64,
    terminated: bool,
    truncated: bool,
    picture: Rendered,
}

impl Player {
    /// Makes the environment. If `fit` is given, the pictures fit into a square of the size `fit`.
    pub(crate) fn new(id: &str, kwargs: &Kwargs, fit: Option<u32>) -> Result<Self> {
        let builder = gym::builder(id)
            .args(kwargs.clone())
            .render_mode(RenderMode::RgbArray);
        let mut env = builder.clone().build()?;
        let (width, height) = env.metadata().render_size;
        let longest = width.max(height);
        if let Some(fit) = fit.filter(|fit| *fit < longest) {
            let [width, height] = [width, height].map(|side| (side * fit / longest).max(1));
            env = builder.render_size(width, height).build()?;
        }
        Ok(Self {
            env,
            id: id.to_owned(),
            kwargs: kwargs.clone(),
            seed: None,
            sampler: None,
            controller: None,
            actions: Vec::new(),
            returns: Vec::new(),
            position: 0,
            marks: VecDeque::new(),
            observation: Value::Null,
            reward: 0.0,
            terminated: false,
            truncated: false,
            picture: Rendered::Shown,
        })
    }

    /// Describes the spaces, the size and rate of the pictures, and the keys.
    pub(crate) fn describe(&self) -> Json {
        let metadata = self.env.metadata();
        json!({
            "observation_space": describe::space(&self.env.observation_space()),
            "action_space": describe::space(&self.env.action_space()),
            "fps": metadata.render_fps,
            "size": [metadata.render_size.0, metadata.render_size.1],
            "limit": self.env.spec().and_then(|spec| spec.time_limit()),
            "threshold": self.env.spec().and_then(|spec| spec.reward_threshold),
            "turns": turns(&self.env),
            "keys": self.keys().unwrap_or_default(),
            "names": self.names(),
        })
    }

    /// Describes the names of the numbers in observations and actions, by the part of the space.
    fn names(&self) -> Json {
        let names = registry::find(&self.id)
            .ok()
            .and_then(|entry| entry.page.names);
        let names = names.map(|names| names(&self.env)).unwrap_or_default();
        let of = |space: &Space, names: &[String]| -> Json {
            let parts = names::parts(space, names).unwrap_or_default().into_iter();
            Json::Object(parts.map(|part| (part.path, json!(part.names))).collect())
        };
        json!({
            "observation": of(&self.env.observation_space(), &names.observation),
            "action": of(&self.env.action_space(), &names.action),
        })
    }

    /// Describes the keys with their actions, and what happens while no key is down: `"wait"`,
    /// `"repeat"` or `{"action": ...}`.
    fn keys(&self) -> Option<Json> {
        let Keys { actions, idle } = (registry::find(&self.id).ok()?.page.keys?)(&self.env);
        let idle = match idle {
            Idle::Wait => json!("wait"),
            Idle::Repeat => json!("repeat"),
            Idle::Action(action) => json!({"action": action}),
        };
        Some(json!({"actions": actions, "idle": idle}))
    }

    /// Starts an episode.
    pub(crate) fn reset(&mut self, seed: Seed) -> Result<()> {
        self.env
            .reset_into(&Reset::from(seed.clone()), &mut self.observation)?;
        self.sampler = Some(self.env.action_space().sampler(seed.clone()));
        self.controller = None;
        self.seed = Some(seed);
        self.actions.clear();
        self.returns.clear();
        self.marks.clear();
        (self.position, self.reward, self.terminated, self.truncated) = (0, 0.0, false, false);
        Ok(())
    }

    /// Takes a step.
    pub(crate) fn step(&mut self, by: By) -> Result<()> {
        let action = match by {
            By::Action(action) => action,
            By::Random => match &mut self.sampler {
                Some(sampler) => sampler.sample(),
                None => return Err(Error::ResetNeeded("step")),
            },
            By::Good => self.good()?,
        };
        self.apply(&action)?;
        self.actions.truncate(self.position);
        self.returns.truncate(self.position);
        while self.marks.back().is_some_and(|(at, _)| *at > self.position) {
            self.marks.pop_back();
        }
        let before = self.returns.last().copied().unwrap_or(0.0);
        self.actions.push(action);
        self.returns.push(before + self.reward);
        self.position += 1;
        if self.position.is_multiple_of(MARK_EVERY)
            && let Ok(snapshot) = self.env.snapshot()
        {
            if self.marks.len() == MARKS {
                self.marks.pop_front();
            }
            self.marks.push_back((self.position, snapshot));
        }
        Ok(())
    }

    /// Returns the action of the known policy.
    fn good(&mut self) -> Result<Value> {
        let missing = || {
            Error::custom(format!(
                "no good policy is known for {} with these arguments",
                self.env
            ))
        };
        let mut controller = match self.controller.take() {
            Some(controller) => controller,
            None => {
                let policy = registry::find(&self.id)?.page.policy.ok_or_else(missing)?;
                policy.controller(&self.env)?.ok_or_else(missing)?
            }
        };
        let action = controller(&self.env, &self.observation);
        self.controller = Some(controller);
        action.ok_or_else(|| {
            Error::Contract(format!(
                "{} is not an observation of {}",
                self.observation, self.env
            ))
        })
    }

    /// Steps the environment, without recording the action.
    fn apply(&mut self, action: &Value) -> Result<()> {
        let outcome = self.env.step_into(action, &mut self.observation)?;
        (self.reward, self.terminated, self.truncated) =
            (outcome.reward, outcome.terminated, outcome.truncated);
        Ok(())
    }

    /// Goes back or forward to the state after `step` steps of the episode.
    pub(crate) fn seek(&mut self, position: usize) -> Result<()> {
        let position = position.min(self.actions.len());
        // at least one step is repeated, for its observation, reward and info
        let mark = self.marks.iter().rev().find(|(at, _)| *at < position);
        let from = match mark {
            Some((at, snapshot)) => {
                self.env.restore(snapshot)?;
                *at
            }
            None => {
                let seed = self.seed.clone().ok_or(Error::ResetNeeded("step"))?;
                self.env
                    .reset_into(&Reset::from(seed), &mut self.observation)?;
                (self.reward, self.terminated, self.truncated) = (0.0, false, false);
                0
            }
        };
        for i in from..position {
            let action = self.actions[i].clone();
            self.apply(&action)?;
        }
        self.position = position;
        Ok(())
    }

    /// Returns whether the episode is over.
    pub(crate) fn done(&self) -> bool {
        self.terminated || self.truncated
    }

    /// Returns the sum of rewards so far.
    pub(crate) fn episode_return(&self) -> f64 {
        self.position
            .checked_sub(1)
            .map_or(0.0, |last| self.returns[last])
    }

    /// Returns the observation.
    pub(crate) fn observation(&self) -> &Value {
        &self.observation
    }

    /// Reads an action from JSON.
    pub(crate) fn action(&self, json: &Json) -> Result<Value> {
        self.env.action_space().from_json(json)
    }

    /// Describes the state: the data that the page shows beside the picture.
    pub(crate) fn state(&self) -> Json {
        let info = self.env.info_map();
        let info: serde_json::Map<_, _> = info
            .iter()
            .map(|(name, value)| (name.clone(), describe::value(value)))
            .collect();
        json!({
            "observation": describe::value(&self.observation),
            "action": self.position.checked_sub(1).map(|last| describe::value(&self.actions[last])),
            "reward": self.reward,
            "return": self.episode_return(),
            "steps": self.position,
            "known": self.actions.len(),
            "terminated": self.terminated,
            "truncated": self.truncated,
            "info": info,
        })
    }

    /// Turns the camera by degrees and multiplies its distance, if there is a camera.
    #[cfg(feature = "families")]
    pub(crate) fn turn(&mut self, [azimuth, elevation, zoom]: [f64; 3]) {
        if let Some(env) = self.env.layer_mut::<gym::sim::SimEnv>() {
            env.turn_camera(azimuth, elevation, zoom);
        }
    }

    #[cfg(not(feature = "families"))]
    pub(crate) fn turn(&mut self, _: [f64; 3]) {}

    /// Draws the state. Returns width and height.
    pub(crate) fn frame(&mut self, rgba: &mut Vec<u8>) -> Result<Json> {
        self.env.render_into(&mut self.picture)?;
        let Rendered::Frame(frame) = &self.picture else {
            return Err(Error::custom(format!("{} cannot be drawn", self.env)));
        };
        describe::to_rgba(frame.pixels(), 3, rgba);
        Ok(json!({"width": frame.width(), "height": frame.height()}))
    }

    /// Converts the observation to RGBA, if it is a picture.
    pub(crate) fn sight(&self, rgba: &mut Vec<u8>) -> Json {
        let picture = self
            .observation
            .as_array()
            .and_then(|array| Some((array.shape(), array.as_slice::<u8>()?)));
        match picture {
            Some((&[height, width, 3], pixels)) => {
                describe::to_rgba(pixels, 3, rgba);
                json!({"width": width, "height": height})
            }
            Some((&[height, width], pixels)) => {
                describe::to_rgba(pixels, 1, rgba);
                json!({"width": width, "height": height})
            }
            _ => Json::Null,
        }
    }

    /// Returns the actions of the episode so far.
    pub(crate) fn actions(&self) -> Result<Json> {
        let space = self.env.action_space();
        self.actions[..self.position]
            .iter()
            .map(|action| space.to_json(action))
            .collect()
    }

    /// Returns the episode as a trace for `cargo xtask replay`.
    pub(crate) fn trace(&self) -> Result<Trace> {
        let seed = self.seed.clone().ok_or(Error::ResetNeeded("step"))?;
        let space = self.env.action_space();
        // large observations are recorded as checksums
        let observation = match &self.observation {
            Value::Array(array) if array.len() > 512 => Some(json!({"crc32": ""})),
            _ => Some(Json::Null),
        };
        let mut events = vec![Event {
            reset: Some((&Reset::from(seed)).into()),
            observation: observation.clone(),
            ..Event::default()
        }];
        for action in &self.actions[..self.position] {
            let step = Some(space.to_json(action)?);
            events.push(Event {
                step,
                observation: observation.clone(),
                ..Event::default()
            });
        }
        let asked = Trace {
            id: self.id.clone(),
            kwargs: self.kwargs.clone(),
            events,
            ..Trace::default()
        };
        asked.replay()
    }

    /// Returns the first `frames` pictures of the episode as a GIF.
    pub(crate) fn gif(&self, frames: usize) -> Result<Vec<u8>> {
        let mut player = Self::new(&self.id, &self.kwargs, None)?;
        player.reset(self.seed.clone().ok_or(Error::ResetNeeded("step"))?)?;
        let fps = player.env.metadata().render_fps;
        let picture = |player: &mut Self| {
            player.env.render_into(&mut player.picture)?;
            match &player.picture {
                Rendered::Frame(frame) => Ok(frame.clone()),
                _ => Err(Error::custom("it cannot be drawn")),
            }
        };
        let mut video = Video::in_memory(VideoFormat::Gif, fps)?;
        video.write(&picture(&mut player)?)?;
        for action in self.actions[..self.position]
            .iter()
            .take(frames.saturating_sub(1))
        {
            player.apply(action)?;
            video.write(&picture(&mut player)?)?;
        }
        video.into_bytes()
    }
}

/// Returns whether the environment has a camera that can be turned.
#[cfg(feature = "families")]
fn turns(env: &BoxEnv) -> bool {
    env.layer::<gym::sim::SimEnv>()
        .is_some_and(|env| env.simulation().has_free_camera())
}

#[cfg(not(feature = "families"))]
fn turns(_: &BoxEnv) -> bool {
    false
}
