//! The vector made of blocks.

use std::fmt;

use fearless_simd::{Level, dispatch};

use super::step::{Block, NO_LIMIT, Step};
use super::{ActionColumn, LANES, Native, ObservationColumn, Packed};
use crate::math::{Kernel, Real, widest};
use crate::render::Metadata;
use crate::rng::Stream;
use crate::vector::slot::{describe, episode_over};
use crate::vector::{Autoreset, Columns, VectorEnv, VectorReset, VectorSpec};
use crate::{Error, Generator, Result, Space, Value};

/// Environments stepped by one loop with vector instructions: the vector behind
/// [`entry_point`](super::entry_point).
///
/// Each keeps its state, its [stream](Native::Stream) and the number of its steps: 66 bytes for a
/// CartPole.
#[derive(Clone)]
pub struct NativeVectorEnv<D: Native> {
    dynamics: D,
    spec: Option<VectorSpec>,
    num_envs: usize,
    limit: u16,
    autoreset: Autoreset,
    observation_space: Space,
    level: Level,
    closed: bool,
    /// None before the first reset.
    blocks: Vec<Block<D>>,
    /// One for each environment, and for each place in the last block that has none.
    streams: Vec<D::Stream>,
    /// The last states of episodes, where infos tell of them.
    finals: Vec<D::Packed>,
    /// Which environments the last reset has left out, if any.
    left_out: Vec<bool>,
}

impl<D: Native> NativeVectorEnv<D> {
    /// `num_envs` environments whose episodes are truncated after `max_episode_steps`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for no environments, or a limit that is 0 or above 65534.
    pub fn new(
        dynamics: D,
        num_envs: usize,
        max_episode_steps: Option<u32>,
        autoreset: Autoreset,
    ) -> Result<Self> {
        let refuse = |reason: String| Err(Error::argument(format!("a native vector of {}", D::NAME), reason));
        if num_envs == 0 {
            return refuse("num_envs is 0: it must be at least 1".into());
        }
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
        let observation_space = dynamics.observation_space();
        Ok(Self {
            dynamics,
            spec: None,
            num_envs,
            limit,
            autoreset,
            observation_space,
            level: Level::new(),
            closed: false,
            blocks: Vec::new(),
            streams: Vec::new(),
            finals: Vec::new(),
            left_out: Vec::new(),
        })
    }

    pub(super) fn with_spec(self, spec: VectorSpec) -> Self {
        Self { spec: Some(spec), ..self }
    }

    /// The same with only the instructions that each CPU of this kind has: slower, and the same bits,
    /// which tests hold it to.
    #[must_use]
    pub fn baseline(self) -> Self {
        Self { level: Level::baseline(), ..self }
    }

    /// The state of an environment; `None` if there is no such one, or it was never reset.
    pub fn state(&self, index: usize) -> Option<D::State> {
        let block = self.blocks.get(index / LANES).filter(|_| index < self.num_envs)?;
        (block.unset >> (index % LANES) & 1 == 0).then(|| block.state(index % LANES))
    }

    fn check_open(&self, call: &'static str) -> Result<()> {
        if self.closed { Err(Error::Closed(call)) } else { Ok(()) }
    }

    /// Whether each environment has an episode to go on with, or one to begin by itself.
    fn check_ready(&self) -> Result<()> {
        if self.blocks.is_empty() {
            return Err(Error::ResetNeeded("step").at_env(0));
        }
        let disabled = self.autoreset == Autoreset::Disabled;
        for (i, block) in self.blocks.iter().enumerate() {
            let over = if disabled { block.due } else { 0 };
            let lane = (block.unset | over).trailing_zeros() as usize;
            if lane < LANES {
                let error =
                    if block.unset >> lane & 1 == 1 { Error::ResetNeeded("step") } else { episode_over() };
                return Err(error.at_env(i * LANES + lane));
            }
        }
        Ok(())
    }

    /// The error of the first action that is not valid, of an environment that takes one.
    #[cold]
    fn refuse(&self, actions: &[<D::Action as ActionColumn>::Item]) -> Result<()> {
        let due = |i: usize| self.blocks[i / LANES].due >> (i % LANES) & 1 == 1;
        match (0..self.num_envs).find(|i| !D::Action::is_valid(actions[*i]) && !due(*i)) {
            Some(i) => Err(Error::InvalidAction {
                action: format!("{:?}", actions[i]),
                space: self.single_action_space().to_string(),
                hint: "; nothing was stepped".into(),
            }
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
        self.dynamics.action_space()
    }

    fn autoreset(&self) -> Autoreset {
        self.autoreset
    }

    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        self.check_open("reset")?;
        reset.check(self.num_envs)?;
        columns.prepare(&self.observation_space, self.num_envs)?;
        let Columns { observations, rewards, terminated, truncated, has_final, .. } = columns;
        let mut rows = D::Observation::rows(observations).ok_or_else(|| mismatch::<D>())?;

        for block in &mut self.blocks {
            block.ended = 0;
        }
        for i in 0..self.num_envs {
            let (at, lane) = (i / LANES, i % LANES);
            if !reset.selects(i) {
                if let Some(state) = self.state(i) {
                    D::Observation::write_rows(&mut rows, i, &[self.dynamics.observe(&state)]);
                }
                continue;
            }
            let start = reset.of(i).unwrap_or_default();
            let unset = self.blocks.get(at).is_none_or(|block| block.unset >> lane & 1 == 1);
            let mut stream = match &start.seed {
                Some(seed) => D::Stream::new(Generator::new(seed)),
                None if unset => D::Stream::new(Generator::from_os()?),
                None => self.streams[i].clone(),
            };
            // options are those of all environments: if one cannot start, the first cannot
            let state =
                stream.lend(|rng| self.dynamics.start(&start, rng)).map_err(|error| error.at_env(i))?;
            if self.blocks.is_empty() {
                let block = Block {
                    states: D::pack(&state).splat(),
                    steps: [0; LANES],
                    due: 0,
                    unset: u32::MAX,
                    ended: 0,
                };
                let mut blocks = vec![block; self.num_envs.div_ceil(LANES)];
                if let (Some(last), rest @ 1..) = (blocks.last_mut(), self.num_envs % LANES) {
                    last.unset >>= LANES - rest;
                }
                self.streams = vec![stream.clone(); blocks.len() * LANES];
                if D::INFO && self.autoreset == Autoreset::SameStep {
                    self.finals = vec![D::pack(&state); self.num_envs];
                }
                self.blocks = blocks;
            }
            self.streams[i] = stream;
            let block = &mut self.blocks[at];
            block.start(lane, &state);
            block.due &= !(1 << lane);
            block.unset &= !(1 << lane);
            D::Observation::write_rows(&mut rows, i, &[self.dynamics.observe(&state)]);
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

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.check_open("step")?;
        self.check_ready()?;
        let items = D::Action::items(actions, self.num_envs).ok_or_else(|| Error::InvalidAction {
            action: actions.to_string(),
            space: self.action_space().map_or_else(|error| error.to_string(), |space| space.to_string()),
            hint: "; a native vector takes an array of just this shape and type".into(),
        })?;
        let level = self.level;
        let valid = dispatch!(level, _simd => all_valid::<D::Action>(items));
        if !valid {
            self.refuse(items)?;
        }
        columns.prepare(&self.observation_space, self.num_envs)?;
        let Columns { observations, rewards, terminated, truncated, final_observations, has_final } = columns;
        has_final.fill(false);
        let step = Step {
            dynamics: &self.dynamics,
            autoreset: self.autoreset,
            limit: self.limit,
            actions: items,
            observations: D::Observation::rows(observations).ok_or_else(|| mismatch::<D>())?,
            rewards,
            terminated,
            truncated,
            final_observations: D::Observation::rows(final_observations).ok_or_else(|| mismatch::<D>())?,
            has_final,
            finals: &mut self.finals,
        };
        self.left_out.clear();
        let (blocks, streams) = (&mut self.blocks, &mut self.streams);
        widest(level, Run { step, blocks, streams })
    }

    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        let left_out = self.left_out.get(index).copied().unwrap_or(false);
        if let Some(state) = self.state(index)
            && !left_out
        {
            self.dynamics.info(&state, visit);
        }
    }

    fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        if let (Some(block), Some(last)) = (self.blocks.get(index / LANES), self.finals.get(index))
            && block.ended >> (index % LANES) & 1 == 1
        {
            self.dynamics.info(&D::unpack(*last, false), visit);
        }
    }

    fn metadata(&self) -> Metadata {
        Metadata { render_modes: &[], ..self.dynamics.metadata() }
    }

    fn spec(&self) -> Option<VectorSpec> {
        self.spec.clone()
    }

    fn describe(&self) -> String {
        describe("NativeVectorEnv", self.spec.clone().map(|spec| spec.env), self.num_envs)
    }

    fn close(&mut self) {
        self.closed = true;
        self.blocks = Vec::new();
        self.streams = Vec::new();
    }
}

/// One step, compiled for each set of vector instructions.
struct Run<'a, D: Native> {
    step: Step<'a, D>,
    blocks: &'a mut [Block<D>],
    streams: &'a mut [D::Stream],
}

impl<D: Native> Kernel for Run<'_, D> {
    type Output = Result<()>;

    #[inline(always)]
    fn run<R: Real>(self, token: R::Token) -> Result<()> {
        self.step.run::<R>(token, self.blocks, self.streams)
    }
}

/// Without early exit, which would keep the compiler from vector instructions.
#[inline(always)]
fn all_valid<A: ActionColumn>(items: &[A::Item]) -> bool {
    items.iter().fold(true, |valid, item| valid & A::is_valid(*item))
}

fn mismatch<D: Native>() -> Error {
    Error::Contract(format!("the observations of {} do not fit their space", D::NAME))
}
