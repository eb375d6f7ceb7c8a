//! A vector on a pool of threads.
//!
//! Workers receive sub-environments by value, step them and send them back, so nothing is shared and
//! nothing is locked. `home[i]` is `None` while a worker owns environment `i`.

use std::any::Any;
use std::collections::VecDeque;
use std::fmt;
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use super::lockstep::{Ahead, group_len};
use super::size::MAX_THREADS;
use super::slot::{self, Ask, Slot, Spaces, describe, slots};
use super::{Autoreset, Columns, ObservationMode, VectorEnv, VectorReset, VectorSpec};
use crate::render::{Metadata, Rendered};
use crate::{BoxEnv, Env, EnvExt, EnvSpec, Error, Result, Snapshot, Space, Value};

/// Steps its sub-environments on a pool of threads: Gymnasium's `AsyncVectorEnv`, without its processes.
///
/// The results equal [`SyncVectorEnv`](super::SyncVectorEnv)'s for any number of threads. It pays
/// if steps take microseconds, as with physics and images.
///
/// [`send`](Self::send) and [`recv_into`](Self::recv_into) step some sub-environments and receive the
/// first results, so that no step waits for the slowest. The episodes are still the same.
///
/// Dropping the vector waits only for running steps.
pub struct AsyncVectorEnv<E: Env = BoxEnv> {
    /// By index, `None` while away.
    home: Vec<Option<Box<Traveller<E>>>>,
    /// Back with a result that was not received yet.
    ready: VecDeque<Box<Traveller<E>>>,
    pool: Pool<E>,
    spaces: Spaces,
    autoreset: Autoreset,
    spec: Option<VectorSpec>,
    /// Of the first sub-environment, which may be with a worker.
    metadata: Metadata,
    env_spec: Option<EnvSpec>,
}

/// A sub-environment with its request.
struct Traveller<E> {
    index: usize,
    slot: Slot<E>,
    ask: Ask,
    result: Result<()>,
}

/// Some sub-environments that one worker steps.
type Group<E> = Vec<Box<Traveller<E>>>;

/// Groups per thread when all are stepped, so that a thread that finishes early takes another.
const GROUPS_PER_THREAD: usize = 4;

impl<E: Env> AsyncVectorEnv<E> {
    /// A vector of these environments with autoreset on the next step, and a thread per core, at most one
    /// per sub-environment.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if there are none, or if their spaces differ; [`Error::Custom`] if the
    /// operating system cannot start threads.
    pub fn new(envs: impl IntoIterator<Item = E>) -> Result<Self> {
        Self::with_observation_mode(envs, ObservationMode::Same)
    }

    /// A vector of environments whose observation spaces may differ.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new), and one if they differ by more than `mode` allows.
    pub fn with_observation_mode(envs: impl IntoIterator<Item = E>, mode: ObservationMode) -> Result<Self> {
        let (slots, spaces) = slots(envs, mode)?;
        let cores = thread::available_parallelism().map_or(1, NonZero::get);
        let pool = Pool::new(cores.min(slots.len()).min(MAX_THREADS), None)?;
        let first = slots.first().map(|slot| &slot.env);
        let metadata = first.map_or_else(Metadata::default, Env::metadata);
        let env_spec = first.and_then(Env::spec);
        let home = slots.into_iter().enumerate();
        let home = home
            .map(|(index, slot)| Some(Box::new(Traveller { index, slot, ask: Ask::Step, result: Ok(()) })));
        let autoreset = Autoreset::default();
        let (home, ready) = (home.collect(), VecDeque::new());
        Ok(Self { home, ready, pool, spaces, autoreset, spec: None, metadata, env_spec })
    }

    /// With this number of threads; the results do not depend on it.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for 0 or for more than 1024 threads, [`Error::Custom`] while sub-environments are
    /// pending or if the operating system cannot start threads.
    pub fn with_threads(self, threads: usize) -> Result<Self> {
        if !(1..=MAX_THREADS).contains(&threads) {
            let reason = format!("threads is {threads}: it must be from 1 to {MAX_THREADS}");
            return Err(Error::argument("an async vector", reason));
        }
        if self.num_pending() > 0 {
            return Err(Error::custom("sub-environments are still pending: receive them first"));
        }
        Ok(Self { pool: Pool::new(threads.min(self.home.len()), None)?, ..self })
    }

    /// Lets the sub-environments that a worker takes at once step together.
    pub(crate) fn with_ahead(self, ahead: &dyn Ahead<E>) -> Result<Self> {
        let threads = self.num_threads();
        Ok(Self { pool: Pool::new(threads, Some(ahead))?, ..self })
    }

    /// Resets sub-environments at another time.
    #[must_use]
    pub fn with_autoreset(self, autoreset: Autoreset) -> Self {
        Self { autoreset, ..self }
    }

    pub(crate) fn with_spec(self, spec: VectorSpec) -> Self {
        Self { spec: Some(spec), ..self }
    }

    /// The number of threads.
    pub fn num_threads(&self) -> usize {
        self.pool.workers.len()
    }

    /// The number of sub-environments that were [sent](Self::send) and not yet received.
    pub fn num_pending(&self) -> usize {
        self.home.iter().filter(|traveller| traveller.is_none()).count()
    }

    /// Makes the sub-environments `ids` step, and returns at once: EnvPool's `send`. Row `i` of
    /// `actions` is for the sub-environment `ids[i]`.
    ///
    /// # Errors
    /// [`Error::NotInSpace`] unless `actions` has a row for each of `ids`; [`Error::InvalidArgument`] for
    /// an id that is not an index or occurs twice; [`Error::SubEnvironment`] for one that is pending or
    /// must be reset. Then nothing was sent.
    pub fn send(&mut self, actions: &Value, ids: &[usize]) -> Result<()> {
        self.spaces.action.check_actions(actions, ids.len())?;
        let n = self.home.len();
        let mut seen = vec![false; n];
        for (row, &id) in ids.iter().enumerate() {
            let refuse = |reason: &str| Err(Error::argument("ids", format!("{id} {reason}")));
            match self.home.get_mut(id) {
                None => return refuse(&format!("is not the index of a sub-environment: there are {n}")),
                Some(_) if std::mem::replace(&mut seen[id], true) => return refuse("occurs twice"),
                Some(None) => return Err(Error::custom("it is still pending: receive it first").at_env(id)),
                Some(Some(traveller)) => traveller.prepare(&self.spaces, self.autoreset, actions, row)?,
            }
        }
        for &id in ids {
            self.pool.send(self.home[id].take().into_iter().collect(), self.autoreset)?;
        }
        Ok(())
    }

    /// Waits for `m` of the sent sub-environments and receives their results: EnvPool's `recv`. Their
    /// indices go to `ids`, in no particular order, and their results to as many rows of `columns`.
    /// [`info`](VectorEnv::info) is then about them.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for fewer pending than `m`, or for an `m` of 0; then nothing was
    /// received. [`Error::SubEnvironment`] for one whose step failed; only this one was received;
    /// the next call receives the others.
    pub fn recv_into(&mut self, m: usize, ids: &mut Vec<usize>, columns: &mut Columns) -> Result<()> {
        let pending = self.num_pending();
        if m == 0 || m > pending {
            let reason = format!("m is {m}: it must be from 1 to the {pending} that are pending");
            return Err(Error::argument("recv_into", reason));
        }
        while self.ready.len() < m {
            self.ready.extend(self.pool.receive()?);
        }
        if let Some(failed) = self.ready.iter().position(|traveller| traveller.result.is_err())
            && let Some(traveller) = self.ready.remove(failed)
        {
            return self.welcome(traveller);
        }
        columns.prepare(&self.spaces.observation, m)?;
        ids.clear();
        let mut result = Ok(());
        for (row, traveller) in self.ready.drain(..m).enumerate() {
            let index = traveller.index;
            let written = traveller.slot.write(&self.spaces, columns, row);
            result = result.and(written.map_err(|error| error.at_env(index)));
            ids.push(index);
            self.home[index] = Some(traveller);
        }
        result
    }

    /// Calls a function with each sub-environment and its index, on this thread; the results are in the
    /// order of the indices.
    ///
    /// If the function resets, steps or restores a sub-environment, reset it with a mask before the next step, which is
    /// otherwise an error: the vector cannot know whether its episode has ended. (The vector detects this only for
    /// [`BoxEnv`](crate::BoxEnv)s.)
    ///
    /// # Errors
    /// [`Error::Custom`] while some are pending.
    pub fn call<R>(&mut self, mut f: impl FnMut(usize, &mut E) -> R) -> Result<Vec<R>> {
        self.all_home()?;
        let travellers = self.home.iter_mut().flatten();
        let call = |traveller: &mut Box<Traveller<E>>| {
            let Traveller { index, slot, .. } = &mut **traveller;
            slot.lend(|env| f(*index, env))
        };
        Ok(travellers.map(call).collect())
    }

    fn all_home(&self) -> Result<()> {
        match self.num_pending() {
            0 => Ok(()),
            pending => {
                Err(Error::custom(format!("{pending} sub-environments are pending: receive them first")))
            }
        }
    }

    /// The number of sub-environments that a worker takes at once, if all are stepped.
    fn group_len(&self) -> usize {
        let share = self.home.len().div_ceil(self.pool.workers.len());
        // whole groups of those that step together
        let together = self.pool.group_len.map_or(1, |most| group_len(share, most));
        share.div_ceil(together).div_ceil(GROUPS_PER_THREAD) * together
    }

    /// Takes back a sub-environment, and returns its result.
    fn welcome(&mut self, mut traveller: Box<Traveller<E>>) -> Result<()> {
        let index = traveller.index;
        let result = std::mem::replace(&mut traveller.result, Ok(()));
        self.home[index] = Some(traveller);
        result.map_err(|error| error.at_env(index))
    }

    /// Steps or resets the sub-environments that `goes` selects, waits for them, and writes every row.
    /// Returns the first error, by index.
    fn round(&mut self, columns: &mut Columns, goes: impl Fn(usize) -> bool) -> Result<()> {
        let n = self.home.len();
        let group_len = self.group_len();
        let mut away = 0;
        for start in (0..n).step_by(group_len) {
            let mut group = self.pool.spare.pop().unwrap_or_default();
            for index in (start..n.min(start + group_len)).filter(|index| goes(*index)) {
                group.extend(self.home[index].take());
            }
            away += group.len();
            self.pool.send(group, self.autoreset)?;
        }
        while away > 0 {
            let mut group = self.pool.receive()?;
            away -= group.len();
            for traveller in group.drain(..) {
                let index = traveller.index;
                self.home[index] = Some(traveller);
            }
            self.pool.spare.push(group);
        }
        let mut result = Ok(());
        for (index, traveller) in self.home.iter_mut().flatten().enumerate() {
            let answer = std::mem::replace(&mut traveller.result, Ok(()));
            let answer = answer.and(traveller.slot.write(&self.spaces, columns, index));
            result = result.and(answer.map_err(|error| error.at_env(index)));
        }
        result
    }
}

impl<E: Env> Traveller<E> {
    /// Takes its action from a row, if it can step.
    fn prepare(&mut self, spaces: &Spaces, autoreset: Autoreset, actions: &Value, row: usize) -> Result<()> {
        self.ask = Ask::Step;
        let ready = self.slot.check(autoreset).and_then(|()| self.slot.read_action(spaces, actions, row));
        ready.map_err(|error| error.at_env(self.index))
    }

    fn go(&mut self, autoreset: Autoreset) {
        self.result = self.slot.go(&self.ask, autoreset);
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
        columns.prepare(&self.spaces.observation, self.home.len())?;
        for traveller in self.home.iter_mut().flatten() {
            traveller.slot.clear();
            traveller.ask = reset.of(traveller.index).map_or(Ask::Nothing, Ask::Reset);
        }
        self.round(columns, |index| reset.selects(index))
    }

    fn step_into(&mut self, actions: &Value, columns: &mut Columns) -> Result<()> {
        self.all_home()?;
        self.spaces.action.check_actions(actions, self.home.len())?;
        for traveller in self.home.iter_mut().flatten() {
            traveller.prepare(&self.spaces, self.autoreset, actions, traveller.index)?;
        }
        columns.prepare(&self.spaces.observation, self.home.len())?;
        self.round(columns, |_| true)
    }

    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        if let Some(Some(traveller)) = self.home.get(index) {
            traveller.slot.info(visit);
        }
    }

    fn final_info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        if let Some(Some(traveller)) = self.home.get(index) {
            traveller.slot.final_info(visit);
        }
    }

    fn visit_envs(&mut self, visit: &mut dyn FnMut(usize, &mut dyn Any)) -> Result<()> {
        self.call(|index, env| visit(index, env)).map(|_| ())
    }

    fn render(&mut self) -> Result<Vec<Rendered>> {
        self.call(|index, env| env.render().map_err(|error| error.at_env(index)))?.into_iter().collect()
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
        slot::snapshot(self.autoreset, self.home.iter().flatten().map(|traveller| &traveller.slot))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.all_home()?;
        let mut slots: Vec<_> = self.home.iter_mut().flatten().map(|traveller| &mut traveller.slot).collect();
        slot::restore(snapshot, self.autoreset, &self.spaces, &mut slots)
    }

    /// Waits for those that are pending.
    fn close(&mut self) {
        while self.ready.len() < self.num_pending() {
            match self.pool.receive() {
                Ok(group) => self.ready.extend(group),
                Err(_) => break,
            }
        }
        while let Some(traveller) = self.ready.pop_front() {
            let index = traveller.index;
            self.home[index] = Some(traveller);
        }
        self.home.iter_mut().flatten().for_each(|traveller| traveller.slot.close());
    }
}

impl<E: Env> fmt::Debug for AsyncVectorEnv<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe())
    }
}

/// Threads that take groups from one channel and answer on another.
struct Pool<E> {
    /// `None` once no more work comes.
    jobs: Option<Sender<Job<E>>>,
    results: Receiver<Group<E>>,
    stop: Arc<AtomicBool>,
    workers: Vec<JoinHandle<()>>,
    /// Empty groups, kept to reuse their storage.
    spare: Vec<Group<E>>,
    /// The number of sub-environments that can step together, if they can.
    group_len: Option<usize>,
}

struct Job<E> {
    group: Group<E>,
    autoreset: Autoreset,
}

impl<E: Env> Pool<E> {
    fn new(threads: usize, ahead: Option<&dyn Ahead<E>>) -> Result<Self> {
        let (jobs, queue) = channel();
        let (answers, results) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let group_len = ahead.map(Ahead::group_len);
        let (workers, spare) = (Vec::new(), Vec::new());
        let mut pool = Self { jobs: Some(jobs), results, stop, workers, spare, group_len };
        let queue = Arc::new(Mutex::new(queue));
        for i in 0..threads {
            let (queue, answers, stop) = (queue.clone(), answers.clone(), pool.stop.clone());
            let ahead = ahead.map(Ahead::another);
            let worker = thread::Builder::new()
                .name(format!("gym-vector-{i}"))
                .spawn(move || work(&queue, &answers, &stop, ahead))
                .map_err(|error| {
                    Error::custom(format!("the system gives no thread for an async vector: {error}"))
                })?;
            pool.workers.push(worker);
        }
        Ok(pool)
    }

    fn send(&self, group: Group<E>, autoreset: Autoreset) -> Result<()> {
        let sent = self.jobs.as_ref().map(|jobs| jobs.send(Job { group, autoreset }));
        if matches!(sent, Some(Ok(()))) { Ok(()) } else { Err(no_workers()) }
    }

    fn receive(&self) -> Result<Group<E>> {
        self.results.recv().map_err(|_| no_workers())
    }
}

fn no_workers() -> Error {
    Error::custom("the threads of this vector have ended: make a new one")
}

fn work<E: Env>(
    queue: &Mutex<Receiver<Job<E>>>,
    answers: &Sender<Group<E>>,
    stop: &AtomicBool,
    mut ahead: Option<Box<dyn Ahead<E>>>,
) {
    loop {
        let job = queue.lock().unwrap_or_else(PoisonError::into_inner).recv();
        let Ok(Job { mut group, autoreset }) = job else { return };
        let together = match &ahead {
            Some(ahead) => group_len(group.len(), ahead.group_len()),
            None => group.len(),
        };
        for group in group.chunks_mut(together.max(1)) {
            if let Some(ahead) = &mut ahead {
                ahead.clear();
                group.iter_mut().for_each(|traveller| {
                    let Traveller { slot, ask, .. } = &mut **traveller;
                    ahead.begin(slot, ask);
                });
                ahead.solve();
                group.iter_mut().for_each(|traveller| {
                    let Traveller { slot, ask, .. } = &mut **traveller;
                    ahead.collect(slot, ask);
                });
            }
            for traveller in group {
                if stop.load(Ordering::Relaxed) {
                    return;
                }
                traveller.go(autoreset);
            }
        }
        if answers.send(group).is_err() {
            return;
        }
    }
}

impl<E> Drop for Pool<E> {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.jobs = None;
        for worker in self.workers.drain(..) {
            // a worker panics only if an environment panics while it is dropped
            let _ = worker.join();
        }
    }
}
