//! One sub-environment of a vector, and its steps with automatic resets.

use std::any::Any;

use serde::{Deserialize, Serialize};

use super::panic::{Held, contained};
use super::{Autoreset, Columns, ObservationMode, Progress, VectorSpec, size};
use crate::env::{BoxEnv, Env, Inspect, Outcome};
use crate::spaces::Space;
use crate::spec::{EnvSpec, Reset};
use crate::value::{Element, Error, Result, Snapshot, Value};

/// A sub-environment with its last result. Sync and async vectors are made of these.
pub(crate) struct Slot<E> {
    pub(super) env: Held<E>,
    /// The action of the next step.
    pub(super) action: Value,
    observation: Value,
    /// The buffer of the next observation; if `has_final`, the last observation of the episode.
    spare: Value,
    outcome: Outcome,
    /// What the last request did, if the request succeeded.
    progress: Progress,
    has_final: bool,
    final_info: Vec<(String, Value)>,
    stage: Stage,
    /// The panic of a part of the next call, run in advance by [`run_part`](Self::run_part).
    panicked_part: Option<Error>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Stage {
    Made,
    Running,
    Done,
    Panicked,
    /// A caller reset, stepped or restored the environment directly.
    Moved,
    Closed,
}

/// A request to a [`Slot`].
pub(crate) enum Request {
    Reset(Reset),
    Step,
    Nothing,
}

/// The stored form of a [`Slot`].
#[derive(Serialize, Deserialize)]
pub(super) struct StoredSlot {
    env: Snapshot,
    stage: Stage,
    /// What the last request did; this decides whether [`info`](Slot::info) has entries.
    progress: Progress,
    observation: Value,
}

/// The error of a step that needs a reset first.
pub fn episode_over() -> Error {
    Error::custom("the episode has ended and autoreset is disabled: call `reset_into` with a mask")
}

impl<E: Env> Slot<E> {
    fn new(env: E, spaces: &Spaces) -> Result<Self> {
        let observation = spaces.observation.zero()?;
        Ok(Self {
            env: Held::new(env),
            action: Value::Null,
            spare: observation.clone(),
            observation,
            outcome: Outcome::default(),
            progress: Progress::Unchanged,
            has_final: false,
            final_info: Vec::new(),
            stage: Stage::Made,
            panicked_part: None,
        })
    }

    /// Whether the next call can be a step.
    pub(super) fn check(&self, autoreset: Autoreset) -> Result<()> {
        match self.stage {
            Stage::Running => Ok(()),
            Stage::Done if autoreset == Autoreset::NextStep => Ok(()),
            Stage::Done => Err(episode_over()),
            Stage::Made => Err(Error::ResetNeeded("step")),
            Stage::Panicked => Err(Error::custom(
                "it panicked in an earlier call: call `reset_into` with a mask",
            )),
            Stage::Moved => Err(Error::custom(
                "it was changed through `call`: \
                 call `reset_into` with a mask before the next step",
            )),
            Stage::Closed => Err(Error::Closed("step")),
        }
    }

    /// Lends the environment to a caller, which may step it.
    pub(super) fn lend<R>(&mut self, f: impl FnOnce(&mut E) -> R) -> R {
        let moves = |env: &E| {
            (env as &dyn Any)
                .downcast_ref::<BoxEnv>()
                .map(BoxEnv::moves)
        };
        let before = moves(&self.env);
        let result = f(&mut self.env);
        if before != moves(&self.env) && self.stage != Stage::Closed {
            self.stage = Stage::Moved;
        }
        result
    }

    /// Calls `visit` with the environment's [`Inspect`](crate::Inspect).
    pub(super) fn inspect(&mut self, visit: &mut dyn FnMut(&mut dyn Inspect)) -> Result<()> {
        let Some(inspect) = self.env.inspect_mut() else {
            return Err(Error::custom(format!(
                "{} cannot be inspected: it does not implement `Env::inspect_mut`",
                self.env.describe()
            )));
        };
        visit(inspect);
        Ok(())
    }

    /// Takes the action of the next step from a row.
    pub(super) fn read_action(
        &mut self,
        spaces: &Spaces,
        actions: &Value,
        row: usize,
    ) -> Result<()> {
        spaces.action.read_action(actions, row, &mut self.action)
    }

    /// Whether the next step starts an episode.
    pub(super) fn restarts(&self) -> bool {
        self.stage == Stage::Done
    }

    /// Runs a part of the next call in advance. If the part panics, the next call returns the
    /// error, and `run_part` skips the other parts.
    pub(super) fn run_part(&mut self, part: impl FnOnce(&mut Self)) {
        if self.panicked_part.is_none() {
            let result = self.guard(|slot| {
                part(slot);
                Ok(())
            });
            self.panicked_part = result.err();
        }
    }

    /// Resets or steps as requested.
    pub(super) fn serve(&mut self, request: &Request, autoreset: Autoreset) -> Result<()> {
        if let Some(error) = self.panicked_part.take() {
            self.clear();
            return Err(error);
        }
        match request {
            Request::Reset(reset) => self.reset(reset),
            Request::Step => self.step(autoreset),
            Request::Nothing => {
                self.clear();
                Ok(())
            }
        }
    }

    fn reset(&mut self, reset: &Reset) -> Result<()> {
        if self.stage == Stage::Closed {
            return Err(Error::Closed("reset"));
        }
        self.call(|slot| {
            slot.begin(reset)?;
            slot.progress = Progress::Started;
            Ok(())
        })
    }

    fn step(&mut self, autoreset: Autoreset) -> Result<()> {
        self.call(|slot| {
            if slot.stage == Stage::Done {
                slot.begin(&Reset::default())?;
                slot.progress = Progress::Started;
            } else {
                slot.outcome = slot.advance()?;
                slot.progress = Progress::Stepped;
                if slot.stage == Stage::Done && autoreset == Autoreset::SameStep {
                    let Self {
                        env, final_info, ..
                    } = slot;
                    final_info.clear();
                    env.info(&mut |key, value| final_info.push((key.to_owned(), value)));
                    slot.begin(&Reset::default())?;
                    slot.has_final = true;
                }
            }
            Ok(())
        })
    }

    /// Starts an episode.
    fn begin(&mut self, reset: &Reset) -> Result<()> {
        let Self { env, spare, .. } = self;
        E::Observation::fill(spare, |observation| env.reset_into(reset, observation))?;
        std::mem::swap(&mut self.observation, &mut self.spare);
        self.stage = Stage::Running;
        Ok(())
    }

    /// Steps the environment with `self.action`.
    fn advance(&mut self) -> Result<Outcome> {
        let Self {
            env, action, spare, ..
        } = self;
        let outcome = E::Action::with(action, |action| {
            E::Observation::fill(spare, |observation| env.step_into(action, observation))
        });
        let outcome =
            outcome.unwrap_or_else(|| Err(self.env.action_space().refuse_action(&self.action)))?;
        std::mem::swap(&mut self.observation, &mut self.spare);
        self.stage = if outcome.done() {
            Stage::Done
        } else {
            Stage::Running
        };
        Ok(outcome)
    }

    /// Resets or steps the environment. After an error there is no reward, flag or info. After a
    /// panic the environment must be reset.
    fn call(&mut self, request: impl FnOnce(&mut Self) -> Result<()>) -> Result<()> {
        self.clear();
        let result = self.guard(request);
        if result.is_err() {
            self.clear();
        }
        result
    }

    /// Turns a panic of the environment into an error.
    fn guard(&mut self, call: impl FnOnce(&mut Self) -> Result<()>) -> Result<()> {
        let mut is_over = false;
        let result = contained("; reset it before the next step", || {
            let result = call(self);
            is_over = true;
            result
        });
        if !is_over {
            self.stage = Stage::Panicked;
        }
        result
    }

    /// Clears the last result, except the observation.
    pub(super) fn clear(&mut self) {
        (self.outcome, self.progress, self.has_final) =
            (Outcome::default(), Progress::Unchanged, false);
    }

    /// Writes the last result to a row of the columns.
    pub(super) fn write(&self, spaces: &Spaces, columns: &mut Columns, row: usize) -> Result<()> {
        columns.rewards[row] = self.outcome.reward;
        columns.terminated[row] = self.outcome.terminated;
        columns.truncated[row] = self.outcome.truncated;
        columns.has_final[row] = self.has_final;
        columns.progress[row] = self.progress;
        spaces
            .observation
            .write_row(&mut columns.observations, row, &self.observation)?;
        if self.has_final {
            spaces
                .observation
                .write_row(&mut columns.final_observations, row, &self.spare)?;
        }
        Ok(())
    }

    pub(super) fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        if self.progress != Progress::Unchanged {
            self.env.info(visit);
        }
    }

    pub(super) fn final_info(&self, visit: &mut dyn FnMut(&str, Value)) {
        if self.has_final {
            self.final_info
                .iter()
                .for_each(|(key, value)| visit(key, value.clone()));
        }
    }

    pub(super) fn store(&self) -> Result<StoredSlot> {
        let Self {
            env,
            stage,
            progress,
            observation,
            ..
        } = self;
        Ok(StoredSlot {
            env: contained(" in `snapshot`", || env.snapshot())?,
            stage: *stage,
            progress: *progress,
            observation: observation.clone(),
        })
    }

    /// Calls [`restore`](Self::restore) on a clone, and returns the error.
    pub(super) fn check_restore(&self, spaces: &Spaces, stored: &StoredSlot) -> Result<()> {
        if self.stage == Stage::Closed {
            return Err(Error::Closed("restore"));
        }
        if stored.stage == Stage::Closed {
            return Err(Error::Snapshot("it was taken after `close`".into()));
        }
        let mut batch = spaces.observation.empty_batch(1)?;
        spaces
            .observation
            .write_row(&mut batch, 0, &stored.observation)
            .map_err(|_| {
                Error::Snapshot(format!(
                    "its observation {} does not fit the observation space",
                    stored.observation
                ))
            })?;
        contained(" in `restore`", || E::clone(&self.env).restore(&stored.env))
    }

    /// Continues from the stored state, after [`check_restore`](Self::check_restore).
    pub(super) fn restore(&mut self, stored: StoredSlot) -> Result<()> {
        self.guard(|slot| slot.env.restore(&stored.env))?;
        self.clear();
        (self.stage, self.progress) = (stored.stage, stored.progress);
        self.observation = stored.observation;
        Ok(())
    }

    pub(super) fn close(&mut self) {
        let closed = self.guard(|slot| {
            slot.env.close();
            Ok(())
        });
        if let Err(error) = closed {
            log::warn!("a sub-environment, when it was closed: {error}");
        }
        self.stage = Stage::Closed;
    }
}

/// The spaces of the sub-environments.
#[derive(Clone, Debug)]
pub(super) struct Spaces {
    /// The first environment's space; the others have the same form.
    pub(super) observation: Space,
    /// The batched observation space, if the observation spaces differ.
    differing: Option<Space>,
    pub(super) action: Space,
}

impl Spaces {
    /// The batched observation space of `n` sub-environments. The bounds need as much memory as the
    /// observations, so the space is made on request.
    pub(super) fn observations(&self, n: usize) -> Result<Space> {
        self.differing
            .clone()
            .map_or_else(|| self.observation.batch(n), Ok)
    }
}

/// The stored form of the sub-environments of a vector, sync or async.
#[derive(Serialize, Deserialize)]
struct StoredSlots {
    autoreset: Autoreset,
    slots: Vec<StoredSlot>,
}

/// The snapshot of some sub-environments.
pub(super) fn snapshot<'a, E: Env>(
    autoreset: Autoreset,
    slots: impl Iterator<Item = &'a Slot<E>>,
) -> Result<Snapshot> {
    let stored = slots
        .enumerate()
        .map(|(index, slot)| slot.store().map_err(|error| error.at_env(index)));
    Snapshot::of(&StoredSlots {
        autoreset,
        slots: stored.collect::<Result<_>>()?,
    })
}

/// Restores all sub-environments. If a sub-environment refuses its snapshot, restores none.
pub(super) fn restore<E: Env>(
    snapshot: &Snapshot,
    autoreset: Autoreset,
    spaces: &Spaces,
    slots: &mut [&mut Slot<E>],
) -> Result<()> {
    let stored: StoredSlots = snapshot.get()?;
    if stored.autoreset != autoreset {
        let reason = format!(
            "it was taken with autoreset {:?}, and this vector has {autoreset:?}",
            stored.autoreset
        );
        return Err(Error::Snapshot(reason));
    }
    if stored.slots.len() != slots.len() {
        let reason = format!(
            "it has {} sub-environments, and this vector {}",
            stored.slots.len(),
            slots.len()
        );
        return Err(Error::Snapshot(reason));
    }
    for (index, (slot, stored)) in slots.iter().zip(&stored.slots).enumerate() {
        slot.check_restore(spaces, stored)
            .map_err(|error| error.at_env(index))?;
    }
    for (index, (slot, stored)) in slots.iter_mut().zip(stored.slots).enumerate() {
        slot.restore(stored).map_err(|error| error.at_env(index))?;
    }
    Ok(())
}

/// The least memory of a sub-environment.
fn slot_bytes<E>(observation: &Space) -> usize {
    size_of::<Slot<E>>() + 2 * 8 * observation.len_of_row()
}

/// Makes the environments of a spec, if the environments fit in memory. `extra` is the memory of an
/// environment, in bytes, in addition to the size of its type.
pub(crate) fn make_envs<E: Env>(
    spec: &VectorSpec,
    extra: usize,
    make: impl Fn(usize) -> Result<E>,
) -> Result<Vec<E>> {
    spec.check_each()?;
    let make = |index| {
        contained(" while it was made", || make(index)).map_err(|error| match error {
            error @ Error::Contract(_) => error.at_env(index),
            error => error,
        })
    };
    let first = make(0)?;
    let observation = first.observation_space();
    let bytes = slot_bytes::<E>(&observation) + extra;
    size::check(spec.num_envs, &observation, &first.action_space(), bytes)?;
    let others = (1..spec.num_envs).map(make);
    std::iter::once(Ok(first)).chain(others).collect()
}

/// The sub-environments of a vector.
///
/// Returns an error if there are no sub-environments, or if their spaces differ by more than the
/// mode allows.
pub(super) fn slots<E: Env>(
    envs: impl IntoIterator<Item = E>,
    mode: ObservationMode,
) -> Result<(Vec<Slot<E>>, Spaces)> {
    let refuse = |reason: String| Err(Error::argument("a vector", reason));
    let envs: Vec<E> = envs.into_iter().collect();
    let Some(first) = envs.first() else {
        return refuse("it needs at least one sub-environment".into());
    };
    let (observation, action) = (first.observation_space(), first.action_space());
    size::check(
        envs.len(),
        &observation,
        &action,
        slot_bytes::<E>(&observation),
    )?;
    for (index, env) in envs.iter().enumerate() {
        let (seen, taken) = (env.observation_space(), env.action_space());
        let (fits, rule) = match mode {
            ObservationMode::Same => (
                seen == observation,
                "be equal, or differ in bounds with ObservationMode::Different",
            ),
            ObservationMode::Different => (
                seen.has_form_of(&observation),
                "differ only in their bounds",
            ),
        };
        for (kind, fits, space, first, rule) in [
            ("observation", fits, &seen, &observation, rule),
            ("action", taken == action, &taken, &action, "be equal"),
        ] {
            if !fits {
                return refuse(format!(
                    "the {kind} space of sub-environment {index} is {space}, and the first one's is {first}: they must {rule}"
                ));
            }
        }
    }
    let differing = match mode {
        ObservationMode::Same => None,
        ObservationMode::Different => Some(Space::batch_differing(
            &envs.iter().map(Env::observation_space).collect::<Vec<_>>(),
        )?),
    };
    let spaces = Spaces {
        observation,
        differing,
        action,
    };
    let slots = envs
        .into_iter()
        .map(|env| Slot::new(env, &spaces))
        .collect::<Result<_>>()?;
    Ok((slots, spaces))
}

/// `SyncVectorEnv(CartPole-v1, num_envs=3)`.
pub fn describe(kind: &str, env: Option<EnvSpec>, n: usize) -> String {
    let id = env.map_or_else(String::new, |spec| format!("{}, ", spec.id));
    format!("{kind}({id}num_envs={n})")
}
