//! A vector on a pool of threads.
//!
//! Workers receive groups of sub-environments by value, step them and send them back with their
//! results, so nothing is shared and nothing is locked. `home[i]` is `None` while a worker owns
//! environment `i`.
//!
//! A group holds the actions and results of its sub-environments side by side in memory. If each
//! sub-environment held its own result, the calling thread would wait for one cache miss per
//! sub-environment, because the result is in the cache of the worker's core.

mod cores;
mod workers;

use std::any::Any;
use std::collections::VecDeque;
use std::fmt;
use std::num::NonZero;
use std::ops::Range;
use std::sync::Arc;
use std::thread;

use super::lockstep::{SlotGroup, group_len};
use super::size::{self, MAX_THREADS};
use super::slot::{self, Request, Slot, Spaces, describe, slots};
use super::{Autoreset, Columns, ObservationMode, VectorEnv, VectorReset, VectorSpec};
use crate::drawing::render::{Metadata, Rendered};
use crate::env::{BoxEnv, Env, EnvExt, Inspect};
use crate::spaces::Space;
use crate::spec::EnvSpec;
use crate::value::{Error, Result, Snapshot, Value};
use workers::{Group, Pool};

/// Steps its sub-environments on a pool of threads: Gymnasium's `AsyncVectorEnv`, without its
/// processes.
///
/// The results equal [`SyncVectorEnv`](super::SyncVectorEnv)'s for any number of threads. It pays
/// if steps take microseconds, as with physics and images.
///
/// [`send`](Self::send) and [`recv_into`](Self::recv_into) step some sub-environments and receive
/// the first results, so that no step waits for the slowest. The episodes are still the same.
///
/// Dropping the vector waits only for running steps.
pub struct AsyncVectorEnv<E: Env = BoxEnv> {
    /// Each sub-environment by its index; `None` while a worker owns it.
    home: Vec<Option<Box<Slot<E>>>>,
    /// Groups of one sub-environment, with results that the caller has not received.
    ready: VecDeque<Group<E>>,
    /// Groups that are packed and not yet sent.
    outgoing: Vec<Group<E>>,
    /// Whether every sub-environment can take a step: each took a step in the last call, and `call`
    /// has lent no sub-environment since.
    all_go_on: bool,
    /// Steps the sub-environments of a group together; `None` if the environments do not implement
    /// [`Lockstep`](super::lockstep::Lockstep).
    lockstep: Option<Box<dyn SlotGroup<E>>>,
    pool: Pool<E>,
    /// The core of the first thread, if threads are bound to cores.
    affinity: Option<usize>,
    spaces: Arc<Spaces>,
    autoreset: Autoreset,
    spec: Option<VectorSpec>,
    /// The metadata of the first sub-environment, which a worker may own.
    metadata: Metadata,
    env_spec: Option<EnvSpec>,
}

/// Groups per thread when all are stepped, so that a thread that finishes early takes another.
const GROUPS_PER_THREAD: usize = 4;

impl<E: Env> AsyncVectorEnv<E> {
    /// A vector of these environments with autoreset on the next step, and a thread per core, at
    /// most one per sub-environment.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if there are none, or if their spaces differ; [`Error::Custom`]
    /// if the operating system cannot start threads.
    pub fn new(envs: impl IntoIterator<Item = E>) -> Result<Self> {
        Self::with_observation_mode(envs, ObservationMode::Same)
    }

    /// A vector of environments whose observation spaces may differ.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new), and one if they differ by more than `mode` allows.
    pub fn with_observation_mode(
        envs: impl IntoIterator<Item = E>,
        mode: ObservationMode,
    ) -> Result<Self> {
        let (slots, spaces) = slots(envs, mode)?;
        let spaces = Arc::new(spaces);
        let cores = thread::available_parallelism().map_or(1, NonZero::get);
        let pool = Pool::new(
            cores.min(slots.len()).min(MAX_THREADS),
            slots.len(),
            &spaces,
            None,
            None,
        )?;
        let first = slots.first().map(|slot| &*slot.env);
        let metadata = first.map_or_else(Metadata::default, Env::metadata);
        let env_spec = first.and_then(Env::spec);
        Ok(Self {
            home: slots.into_iter().map(|slot| Some(Box::new(slot))).collect(),
            ready: VecDeque::new(),
            outgoing: Vec::new(),
            all_go_on: false,
            lockstep: None,
            pool,
            affinity: None,
            spaces,
            autoreset: Autoreset::default(),
            spec: None,
            metadata,
            env_spec,
        })
    }

    /// With this number of threads; the results do not depend on it.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for 0 or for more than 1024 threads, [`Error::Custom`] while
    /// sub-environments are pending or if the operating system cannot start threads.
    pub fn with_threads(self, threads: usize) -> Result<Self> {
        if !(1..=MAX_THREADS).contains(&threads) {
            let reason = format!("threads is {threads}: it must be from 1 to {MAX_THREADS}");
            return Err(Error::argument("an async vector", reason));
        }
        let threads = threads.min(self.home.len());
        self.with_pool(threads)
    }

    /// Binds the threads to cores, as EnvPool's `thread_affinity_offset` does: the first thread to
    /// core `first` of those that the program may use, the second one to the next, and so on, around
    /// the end. The results do not depend on it.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if there is no core `first`; [`Error::Custom`] while
    /// sub-environments are pending, or if the operating system cannot bind threads.
    pub fn with_affinity(self, first: usize) -> Result<Self> {
        let affinity = Some(first);
        let threads = self.num_threads();
        Self { affinity, ..self }.with_pool(threads)
    }

    /// Lets the sub-environments of a group step together.
    pub(crate) fn in_lockstep(self, lockstep: Box<dyn SlotGroup<E>>) -> Result<Self> {
        let (lockstep, threads) = (Some(lockstep), self.num_threads());
        Self { lockstep, ..self }.with_pool(threads)
    }

    /// Replaces the threads.
    fn with_pool(self, threads: usize) -> Result<Self> {
        if self.num_pending() > 0 {
            return Err(Error::custom(
                "sub-environments are still pending: receive them first",
            ));
        }
        let lockstep = self.lockstep.as_deref();
        let n = self.home.len();
        Ok(Self {
            pool: Pool::new(threads, n, &self.spaces, lockstep, self.affinity)?,
            ..self
        })
    }

    /// Resets sub-environments at another time.
    #[must_use]
    pub fn with_autoreset(self, autoreset: Autoreset) -> Self {
        Self {
            autoreset,
            all_go_on: false,
            ..self
        }
    }

    pub(crate) fn with_spec(self, spec: VectorSpec) -> Self {
        Self {
            spec: Some(spec),
            ..self
        }
    }

    /// The number of threads.
    pub fn num_threads(&self) -> usize {
        self.pool.workers.len()
    }

    /// The number of sub-environments that were [sent](Self::send) and not yet received.
    pub fn num_pending(&self) -> usize {
        self.home.iter().filter(|slot| slot.is_none()).count()
    }

    /// Makes the sub-environments `ids` step, and returns at once: EnvPool's `send`. Row `i` of
    /// `actions` is for the sub-environment `ids[i]`.
    ///
    /// # Errors
    /// [`Error::NotInSpace`] unless `actions` has a row for each of `ids`;
    /// [`Error::InvalidArgument`] for an id that is not an index or occurs twice;
    /// [`Error::SubEnvironment`] for one that is pending or must be reset. Then nothing was sent.
    pub fn send(&mut self, actions: &Value, ids: &[usize]) -> Result<()> {
        self.spaces.action.check_actions(actions, ids.len())?;
        let n = self.home.len();
        self.all_go_on = false;
        for (row, &id) in ids.iter().enumerate() {
            let refuse = |reason: &str| Err(Error::argument("ids", format!("{id} {reason}")));
            let packed = match self.home.get(id) {
                None => refuse(&format!(
                    "is not the index of a sub-environment: there are {n}"
                )),
                Some(None) if ids[..row].contains(&id) => refuse("occurs twice"),
                Some(None) => {
                    Err(Error::custom("it is still pending: receive it first").at_env(id))
                }
                Some(Some(_)) => {
                    self.pack(id..id + 1, 1, |_| Some(Request::Step), Some((actions, row)))
                }
            };
            packed.or_else(|error| self.unpack(error))?;
        }
        self.send_packed()
    }

    /// Waits for `m` of the sent sub-environments and receives their results: EnvPool's `recv`.
    /// Their indices go to `ids`, in no particular order, and their results to as many rows of
    /// `columns`. [`info`](VectorEnv::info) is then about them.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for fewer pending than `m`, or for an `m` of 0; then nothing was
    /// received. [`Error::SubEnvironment`] for one whose step failed; only this one was received;
    /// the next call receives the others.
    pub fn recv_into(
        &mut self,
        m: usize,
        ids: &mut Vec<usize>,
        columns: &mut Columns,
    ) -> Result<()> {
        let pending = self.num_pending();
        if m == 0 || m > pending {
            let reason = format!("m is {m}: it must be from 1 to the {pending} that are pending");
            return Err(Error::argument("recv_into", reason));
        }
        while self.ready.len() < m {
            let group = self.pool.receive()?;
            self.ready.push_back(group);
        }
        if let Some(failed) = self.ready.iter().position(|group| !group.failed.is_empty())
            && let Some(group) = self.ready.remove(failed)
        {
            return self
                .take_back(group)
                .map_or(Ok(()), |(index, error)| Err(error.at_env(index)));
        }
        columns.prepare(&self.spaces.observation, m)?;
        ids.clear();
        let mut result = Ok(());
        for row in 0..m {
            let Some(group) = self.ready.pop_front() else {
                break;
            };
            ids.extend(&group.indices);
            result =
                result.and(columns.copy_rows(&self.spaces.observation, row, &group.columns, 0..1));
            self.take_back(group);
        }
        result
    }

    /// Calls a function with each sub-environment and its index, on this thread; the results are in
    /// the order of the indices.
    ///
    /// If the function resets, steps or restores a sub-environment, reset it with a mask before the
    /// next step, which is otherwise an error: the vector cannot know whether its episode has
    /// ended. (The vector detects this only for [`BoxEnv`](crate::BoxEnv)s.)
    ///
    /// # Errors
    /// [`Error::Custom`] while some are pending.
    pub fn call<R>(&mut self, mut f: impl FnMut(usize, &mut E) -> R) -> Result<Vec<R>> {
        self.all_home()?;
        self.all_go_on = false;
        let slots = self.home.iter_mut().flatten().enumerate();
        Ok(slots
            .map(|(index, slot)| slot.lend(|env| f(index, env)))
            .collect())
    }

    fn all_home(&self) -> Result<()> {
        match self.num_pending() {
            0 => Ok(()),
            pending => Err(Error::custom(format!(
                "{pending} sub-environments are pending: receive them first"
            ))),
        }
    }

    /// The size of a group if all sub-environments are stepped.
    fn group_len(&self) -> usize {
        let share = self.home.len().div_ceil(self.pool.workers.len());
        // a multiple of the number that step together
        let together = self
            .lockstep
            .as_ref()
            .map_or(1, |lockstep| group_len(share, lockstep.group_len()));
        share.div_ceil(together).div_ceil(GROUPS_PER_THREAD) * together
    }

    /// Moves the sub-environments `indices` that have a request into a group with space for `room`
    /// sub-environments. `actions` is a batch, and the row from which steps take their actions.
    /// After an error, call [`unpack`](Self::unpack).
    fn pack(
        &mut self,
        indices: Range<usize>,
        room: usize,
        request: impl Fn(usize) -> Option<Request>,
        actions: Option<(&Value, usize)>,
    ) -> Result<()> {
        let mut group = self.pool.spare.pop().unwrap_or_default();
        let mut result = Ok(());
        if group.columns.len() < room {
            result = group.columns.prepare(&self.spaces.observation, room);
            group.actions.resize(room, Value::Null);
        }
        for index in indices {
            let Some(request) = request(index) else {
                continue;
            };
            let Some(slot) = self.home[index].take() else {
                continue;
            };
            if let Some((actions, row)) = actions {
                let place = group.slots.len();
                let ready = if self.all_go_on {
                    Ok(())
                } else {
                    slot.check(self.autoreset)
                };
                let action = &mut group.actions[place];
                let ready = ready
                    .and_then(|()| self.spaces.action.read_action(actions, row + place, action));
                result = result.and(ready.map_err(|error| error.at_env(index)));
            }
            group.indices.push(index);
            group.slots.push(slot);
            group.requests.push(request);
        }
        self.outgoing.push(group);
        result
    }

    /// Takes the sub-environments of all packed groups back, and returns `error`.
    fn unpack(&mut self, error: Error) -> Result<()> {
        while let Some(group) = self.outgoing.pop() {
            self.take_back(group);
        }
        Err(error)
    }

    fn send_packed(&mut self) -> Result<()> {
        let Self {
            outgoing,
            pool,
            autoreset,
            ..
        } = self;
        outgoing
            .drain(..)
            .try_for_each(|group| pool.send(group, *autoreset))
    }

    /// Takes back the sub-environments of a group, and returns the first error.
    fn take_back(&mut self, mut group: Group<E>) -> Option<(usize, Error)> {
        let Group {
            indices,
            slots,
            requests,
            failed,
            ..
        } = &mut group;
        let error = failed
            .drain(..)
            .next()
            .map(|(place, error)| (indices[place], error));
        for (index, slot) in indices.drain(..).zip(slots.drain(..)) {
            self.home[index] = Some(slot);
        }
        requests.clear();
        self.pool.spare.push(group);
        error
    }

    /// Sends the requests, waits for all results, and writes every row. Returns the error of the
    /// lowest index.
    fn round(
        &mut self,
        columns: &mut Columns,
        request: impl Fn(usize) -> Option<Request>,
        actions: Option<&Value>,
    ) -> Result<()> {
        let (n, group_len) = (self.home.len(), self.group_len());
        for start in (0..n).step_by(group_len) {
            let indices = start..n.min(start + group_len);
            let packed = self.pack(
                indices,
                group_len,
                &request,
                actions.map(|actions| (actions, start)),
            );
            packed.or_else(|error| self.unpack(error))?;
        }
        let mut result = columns.prepare(&self.spaces.observation, n);
        if let Err(error) = result {
            return self.unpack(error);
        }
        let mut left_out = 0;
        for (index, slot) in self.home.iter_mut().enumerate() {
            if let Some(slot) = slot {
                slot.clear();
                result = result.and(slot.write(&self.spaces, columns, index));
                left_out += 1;
            }
        }
        let groups = self.outgoing.len();
        self.send_packed()?;
        let mut failed: Option<(usize, Error)> = None;
        for _ in 0..groups {
            let group = self.pool.receive()?;
            let mut row = 0;
            for run in group.indices.chunk_by(|a, b| a + 1 == *b) {
                let rows = row..row + run.len();
                row = rows.end;
                let copied =
                    columns.copy_rows(&self.spaces.observation, run[0], &group.columns, rows);
                result = result.and(copied);
            }
            if let Some(error) = self.take_back(group)
                && failed.as_ref().is_none_or(|first| error.0 < first.0)
            {
                failed = Some(error);
            }
        }
        self.all_go_on = left_out == 0 && failed.is_none() && self.autoreset != Autoreset::Disabled;
        result.and(failed.map_or(Ok(()), |(index, error)| Err(error.at_env(index))))
    }
}

impl<E: Env> VectorEnv for AsyncVectorEnv<E> {
    fn num_envs(&self) -> usize {
        self.home.len()
    }

    fn single_observation_space(&self) -> Space {
        self.spaces.observation.clone()
    }

    fn single_action_space(&self) -> Space {
        self.spaces.action.clone()
    }

    fn observation_space(&self) -> Result<Space> {
        self.spaces.observations(self.home.len())
    }

    fn autoreset(&self) -> Autoreset {
        self.autoreset
    }

    fn reset_into(&mut self, reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        reset.check(self.home.len())?;
        self.all_home()?;
        self.round(columns, |index| reset.of(index).map(Request::Reset), None)
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.all_home()?;
        self.spaces.action.check_actions(actions, self.home.len())?;
        self.round(columns, |_| Some(Request::Step), Some(actions))
    }

    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        if let Some(Some(slot)) = self.home.get(index) {
            slot.info(visit);
        }
    }

    fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        if let Some(Some(slot)) = self.home.get(index) {
            slot.final_info(visit);
        }
    }

    fn visit_envs(&mut self, visit: &mut dyn FnMut(usize, &mut dyn Any)) -> Result<()> {
        self.call(|index, env| visit(index, env)).map(|_| ())
    }

    fn inspect(&mut self, index: usize, visit: &mut dyn FnMut(&mut dyn Inspect)) -> Result<()> {
        self.all_home()?;
        let num_envs = self.num_envs();
        let slot = self.home.get_mut(index).and_then(Option::as_mut);
        slot.ok_or_else(|| size::no_such_env(index, num_envs))?
            .inspect(visit)
    }

    fn render(&mut self) -> Result<Vec<Rendered>> {
        self.call(|index, env| env.render().map_err(|error| error.at_env(index)))?
            .into_iter()
            .collect()
    }

    fn metadata(&self) -> Metadata {
        self.metadata.clone()
    }

    fn spec(&self) -> Option<VectorSpec> {
        self.spec.clone()
    }

    fn describe(&self) -> String {
        describe("AsyncVectorEnv", self.env_spec.clone(), self.home.len())
    }

    fn snapshot(&self) -> Result<Snapshot> {
        self.all_home()?;
        slot::snapshot(
            self.autoreset,
            self.home.iter().flatten().map(AsRef::as_ref),
        )
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.all_home()?;
        self.all_go_on = false;
        let mut slots: Vec<_> = self.home.iter_mut().flatten().map(AsMut::as_mut).collect();
        slot::restore(snapshot, self.autoreset, &self.spaces, &mut slots)
    }

    /// Waits for the pending sub-environments.
    fn close(&mut self) {
        self.all_go_on = false;
        while self.ready.len() < self.num_pending() {
            match self.pool.receive() {
                Ok(group) => self.ready.push_back(group),
                Err(_) => break,
            }
        }
        while let Some(group) = self.ready.pop_front() {
            self.take_back(group);
        }
        self.home.iter_mut().flatten().for_each(|slot| slot.close());
    }
}

impl<E: Env> fmt::Debug for AsyncVectorEnv<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe())
    }
}
