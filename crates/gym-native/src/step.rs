//! The loop over environments.

use gym_core::math::Real;
use gym_core::rng::Stream;
use gym_core::vector::{Autoreset, Progress};
use gym_core::{Element, Reset, Result, Transition};

use crate::varied::Varied;
use crate::{ActionColumn, LANES, Native, ObservationColumn, Packed};

/// A block of environments. Flags are sets of bits; the lowest bit belongs to the first
/// environment.
#[derive(Clone, Debug)]
pub(crate) struct Block<D: Native> {
    pub(crate) states: <D::Packed as Packed>::Block,
    /// The number of steps of each episode, saturating.
    pub(crate) steps: [u16; LANES],
    /// The environments whose episode has ended and that are not yet reset.
    pub(crate) due: u32,
    /// The environments that were never reset.
    pub(crate) unset: u32,
    /// The environments whose episode ended in the last step, and that this step reset.
    pub(crate) ended: u32,
}

impl<D: Native> Block<D> {
    pub(crate) fn state(&self, dynamics: &D, lane: usize) -> D::State {
        dynamics.unpack(D::Packed::get(&self.states, lane), self.steps[lane] == 0)
    }

    /// Starts an episode.
    #[inline]
    pub(crate) fn start(&mut self, dynamics: &D, lane: usize, state: &D::State) {
        dynamics.pack(state).set(&mut self.states, lane);
        self.steps[lane] = 0;
    }
}

/// A limit that no episode reaches.
pub(crate) const NO_LIMIT: u16 = u16::MAX;

/// One step of all environments: its inputs, and the columns that it fills.
pub(crate) struct Step<'a, D: Native> {
    pub(crate) dynamics: &'a D,
    pub(crate) constants: &'a <D::Constants as Packed>::Block,
    /// The constants of each environment, if they differ.
    pub(crate) varied: Option<&'a mut Varied<D>>,
    pub(crate) autoreset: Autoreset,
    pub(crate) limit: u16,
    pub(crate) actions: <D::Action as ActionColumn>::Items<'a>,
    pub(crate) num_envs: usize,
    pub(crate) observations: <D::Observation as ObservationColumn>::Rows<'a>,
    pub(crate) rewards: &'a mut [f64],
    pub(crate) terminated: &'a mut [bool],
    pub(crate) truncated: &'a mut [bool],
    pub(crate) final_observations: <D::Observation as ObservationColumn>::Rows<'a>,
    pub(crate) has_final: &'a mut [bool],
    pub(crate) progress: &'a mut [Progress],
    /// The last states of the episodes that have ended, if [`Task::INFO`](gym_core::Task::INFO) is
    /// set.
    pub(crate) finals: &'a mut [D::Packed],
}

/// The results of a block before they are copied to the columns. Flags are sets of bits; the lowest
/// bit belongs to the first environment.
struct Results<O> {
    observations: [O; LANES],
    rewards: [f64; LANES],
    terminated: u32,
    truncated: u32,
}

impl<D: Native> Step<'_, D> {
    /// Steps block by block. With `DEFAULTS`, all environments have the default constants. `run` is
    /// inlined into one function for each vector instruction set.
    #[inline(always)]
    pub(crate) fn run<R: Real, const DEFAULTS: bool>(
        mut self,
        token: R::Token,
        blocks: &mut [Block<D>],
        streams: &mut [D::Stream],
    ) -> Result<()> {
        let mut results = Results {
            observations: [D::Observation::empty(); LANES],
            rewards: [0.0; LANES],
            terminated: 0,
            truncated: 0,
        };
        let mut room = [Default::default(); LANES];
        let num_envs = self.num_envs;
        for (i, (block, streams)) in blocks.iter_mut().zip(streams.as_chunks_mut().0).enumerate() {
            let first = i * LANES;
            let len = LANES.min(num_envs - first);
            let actions = D::Action::block(self.actions, first, len, &mut room);
            let mut many = Many {
                constants: self
                    .varied
                    .as_ref()
                    .map_or(self.constants, |varied| varied.block(i)),
                states: &mut block.states,
                steps: &block.steps,
                due: block.due,
                streams: &mut *streams,
                actions,
                observations: &mut results.observations,
                rewards: &mut results.rewards,
                terminated: &mut results.terminated,
            };
            if DEFAULTS {
                self.dynamics.step_default_block::<R>(token, &mut many);
            } else {
                self.dynamics.step_block::<R>(token, &mut many);
            }
            let done = count(block, &mut results, self.limit) & (u32::MAX >> (LANES - len));
            self.reset(block, streams, done, first, &mut results)?;

            let Results {
                observations,
                rewards,
                terminated,
                truncated,
            } = &results;
            if len == LANES {
                // the compiler knows the length of this slice
                D::Observation::write_rows(&mut self.observations, first, observations);
            } else {
                D::Observation::write_rows(&mut self.observations, first, &observations[..len]);
            }
            put(self.rewards, first, rewards);
            put(self.terminated, first, &flags(*terminated));
            put(self.truncated, first, &flags(*truncated));
        }
        Ok(())
    }

    /// Resets environments, according to the autoreset mode: those whose episode ended in the
    /// previous step, or those in `done`, whose episode ended in this step.
    #[inline(always)]
    fn reset(
        &mut self,
        block: &mut Block<D>,
        streams: &mut [D::Stream; LANES],
        done: u32,
        first: usize,
        results: &mut Results<D::Observation>,
    ) -> Result<()> {
        let reset = Reset::default();
        let mut start = |block: &mut Block<D>,
                         results: &mut Results<D::Observation>,
                         lane: usize|
         -> Result<()> {
            let state = streams[lane].lend(|rng| {
                if let Some(varied) = &mut self.varied
                    && let Some(own) = varied.draw(first + lane, self.dynamics, rng)?
                {
                    varied.keep(first + lane, &own);
                }
                self.dynamics.start(&reset, rng)
            });
            let state = state.map_err(|error| error.at_env(first + lane))?;
            block.start(self.dynamics, lane, &state);
            results.observations[lane] = self.dynamics.observe(&state);
            Ok(())
        };
        match self.autoreset {
            Autoreset::NextStep => {
                for lane in lanes(block.due) {
                    start(block, results, lane)?;
                    results.rewards[lane] = 0.0;
                    self.progress[first + lane] = Progress::Started;
                }
                results.terminated &= !block.due;
                results.truncated &= !block.due;
                block.due = done & !block.due;
            }
            Autoreset::SameStep => {
                block.ended = done;
                for lane in lanes(done) {
                    if let Some(last) = self.finals.get_mut(first + lane) {
                        *last = D::Packed::get(&block.states, lane);
                    }
                    let observation = [results.observations[lane]];
                    D::Observation::write_rows(
                        &mut self.final_observations,
                        first + lane,
                        &observation,
                    );
                    self.has_final[first + lane] = true;
                    start(block, results, lane)?;
                }
            }
            Autoreset::Disabled => block.due |= done,
        }
        Ok(())
    }
}

/// The environments of a block in a step, and the destination of its results.
#[derive(Debug)]
pub struct Many<'a, D: Native> {
    pub(crate) constants: &'a <D::Constants as Packed>::Block,
    pub(crate) states: &'a mut <D::Packed as Packed>::Block,
    pub(crate) steps: &'a [u16; LANES],
    /// The environments that are due for a reset; their results are overwritten.
    pub(crate) due: u32,
    pub(crate) streams: &'a mut [D::Stream; LANES],
    pub(crate) actions: &'a [<D::Action as ActionColumn>::Item; LANES],
    pub(crate) observations: &'a mut [D::Observation; LANES],
    pub(crate) rewards: &'a mut [f64; LANES],
    /// The environments whose episode terminated, as a set of bits.
    pub(crate) terminated: &'a mut u32,
}

impl<D: Native> Many<'_, D> {
    /// Steps the environments one by one. Environments due for a reset are skipped: their
    /// generators do not advance.
    #[inline(always)]
    pub fn each(
        &mut self,
        dynamics: &D,
        step: impl Fn(&D::State, D::Action, &mut D::Stream) -> Transition<D::State>,
    ) {
        *self.terminated = 0;
        for lane in 0..LANES {
            if self.due >> lane & 1 == 1 {
                continue;
            }
            let state = dynamics.unpack(D::Packed::get(self.states, lane), self.steps[lane] == 0);
            let action = D::Action::from_item(self.actions[lane]);
            let transition = step(&state, action, &mut self.streams[lane]);
            dynamics.pack(&transition.state).set(self.states, lane);
            self.observations[lane] = dynamics.observe(&transition.state);
            self.rewards[lane] = transition.reward;
            *self.terminated |= u32::from(transition.terminated) << lane;
        }
    }
}

/// Counts the step and truncates episodes. Returns the set of environments whose episode is over.
#[inline(always)]
fn count<D: Native, O>(block: &mut Block<D>, results: &mut Results<O>, limit: u16) -> u32 {
    let mut truncated = 0;
    for (lane, steps) in block.steps.iter_mut().enumerate() {
        *steps = (*steps + 1).min(NO_LIMIT - 1);
        truncated |= u32::from(*steps >= limit) << lane;
    }
    results.truncated = truncated;
    results.terminated | truncated
}

/// A set of bits as an array of flags.
#[inline(always)]
fn flags(bits: u32) -> [bool; LANES] {
    let mut flags = [false; LANES];
    for (lane, flag) in flags.iter_mut().enumerate() {
        *flag = bits >> lane & 1 == 1;
    }
    flags
}

/// Overwrites the rows from `first` on with `values`; the last block may have fewer rows.
#[inline(always)]
fn put<T: Copy>(column: &mut [T], first: usize, values: &[T; LANES]) {
    let rows = &mut column[first..];
    match rows.first_chunk_mut() {
        Some(rows) => *rows = *values,
        None => rows.copy_from_slice(&values[..rows.len()]),
    }
}

/// The indices of the bits that are set.
#[inline(always)]
pub(crate) fn lanes(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}
