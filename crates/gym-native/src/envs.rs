//! The vector made of blocks.

use std::collections::BTreeMap;
use std::fmt;

use fearless_simd::{Level, dispatch};
use serde_json::Value as Json;

use gym_core::math::{self, Kernel, Real, widest};
use gym_core::registry::{Each, ResetOptions};
use gym_core::render::Metadata;
use gym_core::rng::Stream;
use gym_core::spaces::array_of;
use gym_core::vector::{Autoreset, Columns, Progress, VectorEnv, VectorReset, VectorSpec, parts};
use gym_core::{DType, Element, Error, Generator, Inspect, Result, Snapshot, Space, Value};

use crate::step::{Block, NO_LIMIT, Step};
use crate::varied::Varied;
use crate::{ActionColumn, LANES, Native, ObservationColumn, Packed};

/// Environments stepped by one SIMD loop: the vector of [`entry_point`](super::entry_point).
///
/// Each environment takes the memory of its state, its [stream](Native::Stream) and its step count:
/// 66 bytes for a CartPole.
#[derive(Clone)]
pub struct NativeVectorEnv<D: Native> {
    pub(crate) dynamics: D,
    constants: <D::Constants as Packed>::Block,
    /// The constants of each environment, if they differ.
    pub(crate) varied: Option<Varied<D>>,
    spec: Option<VectorSpec>,
    reset_options: ResetOptions,
    pub(crate) num_envs: usize,
    pub(crate) limit: u16,
    pub(crate) autoreset: Autoreset,
    observation_space: Space,
    action_space: Space,
    level: Level,
    closed: bool,
    /// Empty before the first reset.
    pub(crate) blocks: Vec<Block<D>>,
    /// The random numbers of each environment, and of each unused lane in the last block.
    pub(crate) streams: Vec<D::Stream>,
    /// The last states of finished episodes, if [`Task::INFO`](gym_core::Task::INFO) is set.
    pub(crate) finals: Vec<D::Packed>,
    /// For each environment, whether the mask of the last reset excluded the environment; empty if
    /// the reset had no mask.
    pub(crate) left_out: Vec<bool>,
    /// A buffer for actions that are cast from another type.
    cast: Value,
}

impl<D: Native> NativeVectorEnv<D> {
    /// Makes `num_envs` environments whose episodes are truncated after `max_episode_steps`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for no environments or more than fit in memory, or a limit that
    /// is 0 or above 65534.
    pub fn new(
        dynamics: D,
        num_envs: usize,
        max_episode_steps: Option<u32>,
        autoreset: Autoreset,
    ) -> Result<Self> {
        let refuse = |reason: String| {
            Err(Error::argument(
                format!("a native vector of {}", D::NAME),
                reason,
            ))
        };
        let limit = match max_episode_steps.map(u16::try_from) {
            None => NO_LIMIT,
            Some(Ok(limit)) if (1..NO_LIMIT).contains(&limit) => limit,
            _ => {
                return refuse(format!(
                    "max_episode_steps must be from 1 to {}; make a sync or async vector for more",
                    NO_LIMIT - 1
                ));
            }
        };
        let (observation_space, action_space) =
            (dynamics.observation_space(), dynamics.action_space());
        let bytes = size_of::<Block<D>>() / LANES + size_of::<D::Stream>();
        parts::check_size(num_envs, &observation_space, &action_space, bytes)?;
        Ok(Self {
            constants: dynamics.constants().splat(),
            varied: None,
            dynamics,
            spec: None,
            reset_options: ResetOptions::default(),
            num_envs,
            limit,
            autoreset,
            observation_space,
            action_space,
            level: math::level(),
            closed: false,
            blocks: Vec::new(),
            streams: Vec::new(),
            finals: Vec::new(),
            left_out: Vec::new(),
            cast: Value::Null,
        })
    }

    /// Gives the environments different values of numeric arguments. Each environment has a fixed
    /// value, or draws one from a range at each reset, from its generator before it draws the
    /// initial state.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an unknown name, an invalid value, a list of another length,
    /// and values that change a space.
    pub fn with_each(self, each: &BTreeMap<String, Each>) -> Result<Self> {
        each.iter()
            .try_for_each(|(name, each)| each.check(name, self.num_envs))?;
        Ok(Self {
            varied: Varied::new(&self.dynamics, each, self.num_envs)?,
            ..self
        })
    }

    /// The arguments that differ between environments, with the values of environment `index`, by
    /// name.
    pub fn arguments(&self, index: usize) -> Vec<(String, f64)> {
        match &self.varied {
            Some(varied) if index < self.num_envs => varied.of(index),
            _ => Vec::new(),
        }
    }

    /// Sets the spec and the reset options of its registered id.
    pub(crate) fn registered(self, spec: VectorSpec, reset_options: ResetOptions) -> Self {
        Self {
            spec: Some(spec),
            reset_options,
            ..self
        }
    }

    /// The same vector with only the baseline instructions of this kind of CPU: slower, with the
    /// same bits, as tests check.
    #[must_use]
    pub fn baseline(self) -> Self {
        Self {
            level: Level::baseline(),
            ..self
        }
    }

    /// The state of an environment; `None` if the index is too large, or it was never reset.
    pub fn state(&self, index: usize) -> Option<D::State> {
        let block = self
            .blocks
            .get(index / LANES)
            .filter(|_| index < self.num_envs)?;
        (block.unset >> (index % LANES) & 1 == 0)
            .then(|| block.state(&self.dynamics, index % LANES))
    }

    pub(crate) fn check_open(&self, call: &'static str) -> Result<()> {
        if self.closed {
            Err(Error::Closed(call))
        } else {
            Ok(())
        }
    }

    /// Makes blocks and streams for all environments, marked as never reset.
    pub(crate) fn make_room(&mut self, state: D::Packed, stream: &D::Stream) -> Result<()> {
        let full = |_| {
            let reason = format!("num_envs = {} does not fit in memory", self.num_envs);
            Error::argument(format!("a native vector of {}", D::NAME), reason)
        };
        let n = self.num_envs.div_ceil(LANES);
        let (mut blocks, mut streams, mut finals) = (Vec::new(), Vec::new(), Vec::new());
        blocks.try_reserve_exact(n).map_err(full)?;
        streams.try_reserve_exact(n * LANES).map_err(full)?;
        let block = Block {
            states: state.splat(),
            steps: [0; LANES],
            due: 0,
            unset: u32::MAX,
            ended: 0,
        };
        blocks.resize(n, block);
        if let (Some(last), rest @ 1..) = (blocks.last_mut(), self.num_envs % LANES) {
            last.unset >>= LANES - rest;
        }
        streams.resize(n * LANES, stream.clone());
        if D::INFO && self.autoreset == Autoreset::SameStep {
            finals.try_reserve_exact(self.num_envs).map_err(full)?;
            finals.resize(self.num_envs, state);
        }
        (self.blocks, self.streams, self.finals) = (blocks, streams, finals);
        Ok(())
    }

    /// The batch of actions cast to the type of the action space, or to `float64` for real numbers.
    #[cold]
    fn cast_actions(&mut self, actions: &Value) -> Result<Value> {
        self.action_space.check_actions(actions, self.num_envs)?;
        if let Value::Tuple(items) = actions
            && let Some(i) = items
                .iter()
                .position(|item| D::Action::from_value(item).is_none())
        {
            return Err(self.action_space.refuse_action(&items[i]).at_env(i));
        }
        let (Some(array), Some(dtype)) = (actions.as_array(), self.action_space.dtype()) else {
            return Err(self.action_space.refuse_action(actions));
        };
        let dtype = if dtype.is_float() { DType::F64 } else { dtype };
        let mut cast = std::mem::take(&mut self.cast);
        array_of(&mut cast, dtype, array.shape()).assign_cast(array)?;
        Ok(cast)
    }

    /// Keeps the memory of a cast for the next cast.
    fn keep(&mut self, cast: Value) {
        if cast != Value::Null {
            self.cast = cast;
        }
    }

    /// Checks that each environment can continue its episode or begin one.
    fn check_ready(&self) -> Result<()> {
        if self.blocks.is_empty() {
            return Err(Error::ResetNeeded("step").at_env(0));
        }
        let disabled = self.autoreset == Autoreset::Disabled;
        for (i, block) in self.blocks.iter().enumerate() {
            let over = if disabled { block.due } else { 0 };
            let lane = (block.unset | over).trailing_zeros() as usize;
            if lane < LANES {
                let error = if block.unset >> lane & 1 == 1 {
                    Error::ResetNeeded("step")
                } else {
                    parts::episode_over()
                };
                return Err(error.at_env(i * LANES + lane));
            }
        }
        Ok(())
    }

    /// Returns the error of the first invalid action. Actions of environments that are due for a
    /// reset are ignored.
    #[cold]
    fn refuse(&self, actions: <D::Action as ActionColumn>::Items<'_>) -> Result<()> {
        let due = |i: usize| self.blocks[i / LANES].due >> (i % LANES) & 1 == 1;
        let action = |i: usize| D::Action::item(actions, i);
        match (0..self.num_envs).find(|i| !D::Action::is_valid(action(*i)) && !due(*i)) {
            Some(i) => Err(self
                .single_action_space()
                .refuse_action(&action(i))
                .at_env(i)),
            None => Ok(()),
        }
    }
}

impl<D: Native> fmt::Debug for NativeVectorEnv<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("NativeVectorEnv")
            .field("dynamics", &self.dynamics)
            .field("num_envs", &self.num_envs)
            .field("autoreset", &self.autoreset)
            .finish_non_exhaustive()
    }
}

impl<D: Native> VectorEnv for NativeVectorEnv<D> {
    fn num_envs(&self) -> usize {
        self.num_envs
    }

    fn single_observation_space(&self) -> Space {
        self.observation_space.clone()
    }

    fn single_action_space(&self) -> Space {
        self.action_space.clone()
    }

    fn autoreset(&self) -> Autoreset {
        self.autoreset
    }

    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        self.check_open("reset")?;
        reset.check(self.num_envs)?;
        if let Some(spec) = self.spec.as_ref().filter(|_| !reset.options.is_empty()) {
            self.reset_options.check(&spec.env.id, &reset.options)?;
        }
        columns.prepare(&self.observation_space, self.num_envs)?;
        let Columns {
            observations,
            rewards,
            terminated,
            truncated,
            has_final,
            progress,
            ..
        } = columns;
        let mut rows =
            D::Observation::rows(observations).ok_or_else(|| mismatch::<D>("observations"))?;

        for block in &mut self.blocks {
            block.ended = 0;
        }
        for (i, progress) in progress.iter_mut().enumerate() {
            let (at, lane) = (i / LANES, i % LANES);
            if !reset.selects(i) {
                if let Some(state) = self.state(i) {
                    D::Observation::write_rows(&mut rows, i, &[self.dynamics.observe(&state)]);
                }
                *progress = Progress::Unchanged;
                continue;
            }
            let start = reset.of(i).unwrap_or_default();
            let unset = self
                .blocks
                .get(at)
                .is_none_or(|block| block.unset >> lane & 1 == 1);
            let mut stream = match &start.seed {
                Some(seed) => D::Stream::new(Generator::new(seed)),
                None if unset => D::Stream::new(Generator::from_os()?),
                None => self.streams[i].clone(),
            };
            // all environments have the same options, so an error occurs at the first environment
            // or at none
            let state = stream.lend(|rng| {
                let own = match &mut self.varied {
                    Some(varied) => varied.draw(i, &self.dynamics, rng)?,
                    None => None,
                };
                let state = self.dynamics.start(&start, rng)?;
                if let (Some(varied), Some(own)) = (&mut self.varied, own) {
                    varied.keep(i, &own);
                }
                Ok(state)
            });
            let state = state.map_err(|error: Error| error.at_env(i))?;
            if self.blocks.is_empty() {
                self.make_room(self.dynamics.pack(&state), &stream)?;
            }
            self.streams[i] = stream;
            let block = &mut self.blocks[at];
            block.start(&self.dynamics, lane, &state);
            block.due &= !(1 << lane);
            block.unset &= !(1 << lane);
            D::Observation::write_rows(&mut rows, i, &[self.dynamics.observe(&state)]);
            *progress = Progress::Started;
        }
        self.left_out.clear();
        if let Some(mask) = &reset.mask {
            self.left_out.extend(mask.iter().map(|selected| !selected));
        }
        rewards.fill(0.0);
        for flags in [terminated, truncated, has_final] {
            flags.fill(false);
        }
        Ok(())
    }

    fn inspect(&mut self, index: usize, visit: &mut dyn FnMut(&mut dyn Inspect)) -> Result<()> {
        if index >= self.num_envs {
            return Err(parts::no_such_env(index, self.num_envs));
        }
        visit(&mut OneEnv { envs: self, index });
        Ok(())
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.check_open("step")?;
        // actions of the right type are not cast
        let mut cast = Value::Null;
        let items = match D::Action::items(actions, self.num_envs) {
            Some(items) => items,
            None => {
                cast = self.cast_actions(actions)?;
                D::Action::items(&cast, self.num_envs).ok_or_else(|| mismatch::<D>("actions"))?
            }
        };
        self.check_ready()?;
        let level = self.level;
        let valid = dispatch!(level, _simd => D::Action::all_valid(items, self.num_envs));
        if !valid {
            self.refuse(items)?;
        }
        columns.prepare(&self.observation_space, self.num_envs)?;
        let Columns {
            observations,
            rewards,
            terminated,
            truncated,
            final_observations,
            has_final,
            progress,
            ..
        } = columns;
        has_final.fill(false);
        progress.fill(Progress::Stepped);
        let has_defaults = self.varied.is_none() && self.dynamics.has_defaults();
        let step = Step {
            dynamics: &self.dynamics,
            constants: &self.constants,
            varied: self.varied.as_mut(),
            autoreset: self.autoreset,
            limit: self.limit,
            actions: items,
            num_envs: self.num_envs,
            observations: D::Observation::rows(observations)
                .ok_or_else(|| mismatch::<D>("observations"))?,
            rewards,
            terminated,
            truncated,
            final_observations: D::Observation::rows(final_observations)
                .ok_or_else(|| mismatch::<D>("observations"))?,
            has_final,
            progress,
            finals: &mut self.finals,
        };
        self.left_out.clear();
        let (blocks, streams) = (&mut self.blocks, &mut self.streams);
        // two functions, because one function would, without optimisation, need the stack of both
        let result = if has_defaults {
            widest(
                level,
                Run::<D, true> {
                    step,
                    blocks,
                    streams,
                },
            )
        } else {
            widest(
                level,
                Run::<D, false> {
                    step,
                    blocks,
                    streams,
                },
            )
        };
        self.keep(cast);
        result
    }

    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        let left_out = self.left_out.get(index).copied().unwrap_or(false);
        if D::INFO
            && !left_out
            && let Some(state) = self.state(index)
        {
            self.dynamics.info(&state, visit);
        }
    }

    fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        if let (Some(block), Some(last)) = (self.blocks.get(index / LANES), self.finals.get(index))
            && block.ended >> (index % LANES) & 1 == 1
        {
            self.dynamics
                .info(&self.dynamics.unpack(*last, false), visit);
        }
    }

    fn metadata(&self) -> Metadata {
        Metadata {
            render_modes: &[],
            ..self.dynamics.metadata()
        }
    }

    fn spec(&self) -> Option<VectorSpec> {
        self.spec.clone()
    }

    fn describe(&self) -> String {
        parts::describe(
            "NativeVectorEnv",
            self.spec.clone().map(|spec| spec.env),
            self.num_envs,
        )
    }

    fn snapshot(&self) -> Result<Snapshot> {
        self.store()
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.read(snapshot)
    }

    fn close(&mut self) {
        self.closed = true;
        self.blocks = Vec::new();
        self.streams = Vec::new();
    }
}

/// A step as a kernel, compiled for each vector instruction set.
struct Run<'a, D: Native, const DEFAULTS: bool> {
    step: Step<'a, D>,
    blocks: &'a mut [Block<D>],
    streams: &'a mut [D::Stream],
}

impl<D: Native, const DEFAULTS: bool> Kernel for Run<'_, D, DEFAULTS> {
    type Output = Result<()>;

    #[inline(always)]
    fn run<R: Real>(self, token: R::Token) -> Result<()> {
        self.step
            .run::<R, DEFAULTS>(token, self.blocks, self.streams)
    }
}

fn mismatch<D: Native>(which: &str) -> Error {
    Error::Contract(format!("the {which} of {} do not fit their space", D::NAME))
}

/// One environment of a native vector. Its arguments cannot be set, because all environments share
/// constants.
struct OneEnv<'a, D: Native> {
    envs: &'a mut NativeVectorEnv<D>,
    index: usize,
}

impl<D: Native> Inspect for OneEnv<'_, D> {
    fn state(&self) -> Option<Json> {
        serde_json::to_value(self.envs.state(self.index)?).ok()
    }

    fn set_state(&mut self, state: Json) -> Result<()> {
        let Self { envs, index } = self;
        if envs.state(*index).is_none() {
            return Err(Error::ResetNeeded("set_state"));
        }
        let state = parts::read_state(&envs.dynamics, &state)?;
        let states = &mut envs.blocks[*index / LANES].states;
        envs.dynamics.pack(&state).set(states, *index % LANES);
        Ok(())
    }

    fn arguments(&self) -> Json {
        let mut arguments = serde_json::to_value(self.envs.dynamics.config()).unwrap_or_default();
        for (name, value) in self.envs.arguments(self.index) {
            arguments[name] = value.into();
        }
        arguments
    }

    fn table(&self) -> Option<Json> {
        self.envs.dynamics.table()
    }
}
