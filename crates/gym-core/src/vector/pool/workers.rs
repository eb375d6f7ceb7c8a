//! The threads of a vector, and the groups of sub-environments that they step.

use std::mem;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use super::super::lockstep::{SlotGroup, is_cached, serve_all};
use super::super::slot::{Request, Slot, Spaces};
use super::super::{Autoreset, Columns};
use super::cores;
use crate::env::Env;
use crate::value::{Error, Result, Value};

/// Some sub-environments that one worker steps: their requests, and their results.
pub(super) struct Group<E> {
    pub(super) indices: Vec<usize>,
    pub(super) slots: Vec<Box<Slot<E>>>,
    pub(super) requests: Vec<Request>,
    /// The actions, at least one for each slot. Later calls reuse the storage. A reset ignores the
    /// actions.
    pub(super) actions: Vec<Value>,
    /// The results, at least one row for each slot.
    pub(super) columns: Columns,
    /// The errors, each with its place in the group.
    pub(super) failed: Vec<(usize, Error)>,
}

impl<E> Default for Group<E> {
    fn default() -> Self {
        Self {
            indices: Vec::new(),
            slots: Vec::new(),
            requests: Vec::new(),
            actions: Vec::new(),
            columns: Columns::default(),
            failed: Vec::new(),
        }
    }
}

/// Threads that receive groups from one channel and send them back on another.
pub(super) struct Pool<E> {
    /// `None` once the pool is being dropped.
    jobs: Option<Sender<Job<E>>>,
    results: Receiver<Group<E>>,
    stop: Arc<AtomicBool>,
    pub(super) workers: Vec<JoinHandle<()>>,
    /// Empty groups, kept to reuse their storage.
    pub(super) spare: Vec<Group<E>>,
}

struct Job<E> {
    group: Group<E>,
    autoreset: Autoreset,
}

impl<E: Env> Pool<E> {
    /// Threads for `n` sub-environments. With `affinity`, each is bound to a core, the first one to
    /// core `affinity` of those that the program may use.
    pub(super) fn new(
        threads: usize,
        n: usize,
        spaces: &Arc<Spaces>,
        lockstep: Option<&dyn SlotGroup<E>>,
        affinity: Option<usize>,
    ) -> Result<Self> {
        let cores = affinity.map(cores::from).transpose()?;
        let (jobs, queue) = channel();
        let (answers, results) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let mut pool = Self {
            jobs: Some(jobs),
            results,
            stop,
            workers: Vec::new(),
            spare: Vec::new(),
        };
        let queue = Arc::new(Mutex::new(queue));
        let (report, bound) = channel();
        for i in 0..threads {
            let mut worker = Worker {
                queue: queue.clone(),
                answers: answers.clone(),
                stop: pool.stop.clone(),
                spaces: spaces.clone(),
                lockstep: lockstep.map(SlotGroup::new_empty),
                is_cached: is_cached(n.div_ceil(threads)),
            };
            let bind = cores
                .as_ref()
                .map(|cores| (cores[i % cores.len()], report.clone()));
            let worker = thread::Builder::new()
                .name(format!("gym-vector-{i}"))
                .spawn(move || {
                    if let Some((core, report)) = bind {
                        let _ = report.send(core.bind());
                    }
                    worker.run();
                })
                .map_err(|error| {
                    Error::custom(format!(
                        "the system gives no thread for an async vector: {error}"
                    ))
                })?;
            pool.workers.push(worker);
        }
        drop(report);
        // one report from each thread that binds itself
        bound.iter().collect::<Result<()>>()?;
        Ok(pool)
    }

    pub(super) fn send(&self, group: Group<E>, autoreset: Autoreset) -> Result<()> {
        let is_sent = self
            .jobs
            .as_ref()
            .is_some_and(|jobs| jobs.send(Job { group, autoreset }).is_ok());
        if is_sent { Ok(()) } else { Err(no_workers()) }
    }

    pub(super) fn receive(&self) -> Result<Group<E>> {
        self.results.recv().map_err(|_| no_workers())
    }
}

fn no_workers() -> Error {
    Error::custom("the threads of this vector have ended: make a new one")
}

/// The state of a thread.
struct Worker<E: Env> {
    queue: Arc<Mutex<Receiver<Job<E>>>>,
    answers: Sender<Group<E>>,
    stop: Arc<AtomicBool>,
    spaces: Arc<Spaces>,
    lockstep: Option<Box<dyn SlotGroup<E>>>,
    is_cached: bool,
}

impl<E: Env> Worker<E> {
    /// Serves groups until the channel closes.
    fn run(&mut self) {
        loop {
            let job = self
                .queue
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .recv();
            let Ok(Job {
                mut group,
                autoreset,
            }) = job
            else {
                return;
            };
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
            self.work(&mut group, autoreset);
            if self.answers.send(group).is_err() {
                return;
            }
        }
    }

    fn work(&mut self, group: &mut Group<E>, autoreset: Autoreset) {
        let Self {
            spaces,
            lockstep,
            is_cached,
            ..
        } = self;
        let Group {
            slots,
            requests,
            actions,
            columns,
            failed,
            ..
        } = group;
        for ((slot, request), action) in slots.iter_mut().zip(&*requests).zip(actions) {
            if let Request::Step = request {
                mem::swap(&mut slot.action, action);
            }
        }
        let request = |place: usize| &requests[place];
        serve_all(
            slots,
            lockstep.as_deref_mut(),
            autoreset,
            *is_cached,
            request,
            |place, slot, result| {
                if let Err(error) = result.and(slot.write(spaces, columns, place)) {
                    failed.push((place, error));
                }
            },
        );
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
