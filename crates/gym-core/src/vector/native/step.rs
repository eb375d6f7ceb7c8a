//! The loop over environments.

use super::{ActionColumn, LANES, Native, ObservationColumn, Packed};
use crate::rng::Stream;
use crate::vector::Autoreset;
use crate::{Element, Reset, Result};

/// The environments that lie together. Their flags are sets of bits, the lowest for the first.
#[derive(Clone, Debug)]
pub(super) struct Block<D: Native> {
    pub(super) states: <D::Packed as Packed>::Block,
    /// The steps of each episode so far, as far as they can be counted.
    pub(super) steps: [u16; LANES],
    /// Whose episode is over, and which have not been reset since.
    pub(super) due: u32,
    /// Which were never reset.
    pub(super) unset: u32,
    /// Whose episode has ended in the last step and was reset in it.
    pub(super) ended: u32,
}

impl<D: Native> Block<D> {
    pub(super) fn state(&self, lane: usize) -> D::State {
        D::unpack(D::Packed::get(&self.states, lane), self.steps[lane] == 0)
    }

    /// Starts an episode.
    #[inline]
    pub(super) fn start(&mut self, lane: usize, state: &D::State) {
        D::pack(state).set(&mut self.states, lane);
        self.steps[lane] = 0;
    }
}

/// A limit that no episode reaches.
pub(super) const NO_LIMIT: u16 = u16::MAX;

/// One step of all environments: what it reads, and the columns that it fills.
pub(super) struct Step<'a, D: Native> {
    pub(super) dynamics: &'a D,
    pub(super) autoreset: Autoreset,
    pub(super) limit: u16,
    pub(super) actions: &'a [<D::Action as ActionColumn>::Item],
    pub(super) observations: <D::Observation as ObservationColumn>::Rows<'a>,
    pub(super) rewards: &'a mut [f64],
    pub(super) terminated: &'a mut [bool],
    pub(super) truncated: &'a mut [bool],
    pub(super) final_observations: <D::Observation as ObservationColumn>::Rows<'a>,
    pub(super) has_final: &'a mut [bool],
    /// The last states of the episodes that have ended, where [`Native::INFO`] asks for them.
    pub(super) finals: &'a mut [D::Packed],
}

/// The results of a block, before they go to the columns.
struct Results<O> {
    observations: [O; LANES],
    rewards: [f64; LANES],
    terminated: [bool; LANES],
    truncated: [bool; LANES],
}

impl<D: Native> Step<'_, D> {
    /// Steps block by block. Inlined into a function for each set of vector instructions.
    #[inline(always)]
    pub(super) fn run(mut self, blocks: &mut [Block<D>], streams: &mut [D::Stream]) -> Result<()> {
        let mut results = Results {
            observations: [D::Observation::empty(); LANES],
            rewards: [0.0; LANES],
            terminated: [false; LANES],
            truncated: [false; LANES],
        };
        let mut last = [Default::default(); LANES];
        let num_envs = self.actions.len();
        for (i, (block, streams)) in blocks.iter_mut().zip(streams.as_chunks_mut().0).enumerate() {
            let first = i * LANES;
            let len = LANES.min(num_envs - first);
            let actions = self.actions[first..].first_chunk().unwrap_or_else(|| {
                last[..len].copy_from_slice(&self.actions[first..]);
                &last
            });
            step(self.dynamics, block, streams, actions, &mut results);
            let done = count(block, &mut results, self.limit) & (u32::MAX >> (LANES - len));
            self.reset(block, streams, done, first, &mut results)?;

            let Results { observations, rewards, terminated, truncated } = &results;
            if len == LANES {
                // the length is known to the compiler
                D::Observation::write_rows(&mut self.observations, first, observations);
            } else {
                D::Observation::write_rows(&mut self.observations, first, &observations[..len]);
            }
            put(self.rewards, first, rewards);
            put(self.terminated, first, terminated);
            put(self.truncated, first, truncated);
        }
        Ok(())
    }

    /// Starts the episodes that are to start in this step, of those due from the last step and those
    /// `done` in this one.
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
        let mut start =
            |block: &mut Block<D>, results: &mut Results<D::Observation>, lane: usize| -> Result<()> {
                let state = streams[lane].lend(|rng| self.dynamics.start(&reset, rng));
                let state = state.map_err(|error| error.at_env(first + lane))?;
                block.start(lane, &state);
                results.observations[lane] = self.dynamics.observe(&state);
                Ok(())
            };
        match self.autoreset {
            Autoreset::NextStep => {
                for lane in lanes(block.due) {
                    start(block, results, lane)?;
                    results.rewards[lane] = 0.0;
                    results.terminated[lane] = false;
                    results.truncated[lane] = false;
                }
                block.due = done & !block.due;
            }
            Autoreset::SameStep => {
                block.ended = done;
                for lane in lanes(done) {
                    if let Some(last) = self.finals.get_mut(first + lane) {
                        *last = D::Packed::get(&block.states, lane);
                    }
                    let observation = [results.observations[lane]];
                    D::Observation::write_rows(&mut self.final_observations, first + lane, &observation);
                    self.has_final[first + lane] = true;
                    start(block, results, lane)?;
                }
            }
            Autoreset::Disabled => block.due |= done,
        }
        Ok(())
    }
}

/// Steps each environment of a block. Those that are due only if their generators are not touched: what
/// comes of it is overwritten.
#[inline(always)]
fn step<D: Native>(
    dynamics: &D,
    block: &mut Block<D>,
    streams: &mut [D::Stream; LANES],
    actions: &[<D::Action as ActionColumn>::Item; LANES],
    results: &mut Results<D::Observation>,
) {
    let due = block.due;
    for lane in 0..LANES {
        if D::DRAWS && due >> lane & 1 == 1 {
            continue;
        }
        let state = D::unpack(D::Packed::get(&block.states, lane), block.steps[lane] == 0);
        let action = D::Action::from_item(actions[lane]);
        let transition = dynamics.step(&state, action, &mut streams[lane]);
        D::pack(&transition.state).set(&mut block.states, lane);
        results.observations[lane] = dynamics.observe_state(&transition.state);
        results.rewards[lane] = transition.reward;
        results.terminated[lane] = transition.terminated;
    }
}

/// Counts the step and truncates; gives which episodes are over.
#[inline(always)]
fn count<D: Native, O>(block: &mut Block<D>, results: &mut Results<O>, limit: u16) -> u32 {
    let mut done = 0;
    for lane in 0..LANES {
        let steps = (block.steps[lane] + 1).min(NO_LIMIT - 1);
        block.steps[lane] = steps;
        results.truncated[lane] = steps >= limit;
        done |= u32::from(results.terminated[lane] | results.truncated[lane]) << lane;
    }
    done
}

/// Overwrites the rows from `first` on, as far as there are any.
#[inline(always)]
fn put<T: Copy>(column: &mut [T], first: usize, values: &[T; LANES]) {
    let rows = &mut column[first..];
    match rows.first_chunk_mut() {
        Some(rows) => *rows = *values,
        None => rows.copy_from_slice(&values[..rows.len()]),
    }
}

/// The places of the bits that are set.
#[inline(always)]
pub(super) fn lanes(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}
