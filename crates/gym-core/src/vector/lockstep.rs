//! Environments that compute the most expensive part of a step together.
//!
//! A step of such an environment has three parts, and the middle one can be computed for many
//! environments in SIMD lanes. A vector lets a group of sub-environments
//! [begin](Lockstep::begin_step) their next call, [solves](Together::solve) the middle part for all
//! of them, and then resets or steps each as a sync vector does: the environment finishes the step
//! it has begun. So time limits, autoreset, infos, errors and all numbers are equal to a sync
//! vector's.
//!
//! The working memory of a step belongs to the group and is lent to its environments, so that many
//! environments fit the CPU's cache. If a vector has more environments than fit the cache, a
//! group's memory is prefetched before the group steps.

use std::borrow::{Borrow, BorrowMut};
use std::hint::black_box;
use std::marker::PhantomData;

use super::slot::{Request, Slot};
use super::{Autoreset, SyncVectorEnv, VectorEnv, VectorSpec};
use crate::env::{BoxEnv, Env, EnvExt};
use crate::spec::{Reset, ResetOptions};
use crate::value::{Element, Result};

/// The buffers of a group of environments for a step, and the part of the step that is computed for
/// all of them together.
pub trait Together: Default + Send + 'static {
    /// The largest number of environments in a group.
    const LEN: usize;

    /// Computes the shared part for all environments that have begun.
    fn solve(&mut self);

    /// Forgets the environments that have begun.
    fn clear(&mut self);
}

/// An environment that can be stepped together with others of its kind.
///
/// The results must equal the results of ordinary steps, bit for bit.
pub trait Lockstep: Env {
    /// The buffers of a group.
    type Group: Together;

    /// Reads some bytes of all memory that a step needs, and returns a value computed from them.
    /// The CPU then fetches the memory of several environments at once; their steps would wait for
    /// each piece in turn. A vector calls it if it has more environments than fit the cache. It
    /// must not panic, even if a step panicked and left the environment half updated.
    fn prefetch(&self) -> u32 {
        0
    }

    /// Begins a reset; the next call is [`reset_into`](Env::reset_into) with the same argument and
    /// finishes it. That call does everything that cannot begin here, and returns the errors.
    fn begin_reset(&mut self, reset: &Reset, group: &mut Self::Group);

    /// Begins a step; the next call is [`step_into`](Env::step_into) with the same action and
    /// finishes it. That call does everything that cannot begin here, and returns the errors.
    fn begin_step(&mut self, action: &Self::Action, group: &mut Self::Group);

    /// Takes the result of [`Together::solve`], and releases this environment's place in the group.
    /// The environment called [`begin_reset`](Self::begin_reset) or
    /// [`begin_step`](Self::begin_step) after the group was last cleared, but may have had nothing
    /// to solve.
    fn collect(&mut self, group: &mut Self::Group);
}

/// Begins the next calls of a group of sub-environments.
pub(crate) trait SlotGroup<E>: Send {
    /// The number of environments that can step together.
    fn group_len(&self) -> usize;

    /// An empty group of the same kind, for another thread.
    fn new_empty(&self) -> Box<dyn SlotGroup<E>>;

    /// Clears the results of the previous group.
    fn clear(&mut self);

    /// Prefetches the memory of the environment in `slot`.
    fn prefetch(&self, slot: &Slot<E>);

    /// Begins the next reset or step of `slot`. If `begin` panics, the slot's next call returns the
    /// error.
    fn begin(&mut self, slot: &mut Slot<E>, request: &Request);

    /// Computes the shared part for all slots that have begun.
    fn solve(&mut self);

    /// Gives `slot` the result of [`solve`](Self::solve), before `slot` serves its request. If
    /// `solve` panics, the slot's next call returns the error.
    fn collect(&mut self, slot: &mut Slot<E>, request: &Request);
}

/// Environments `E` within wrappers `W` that pass actions on unchanged.
struct WrappedGroup<E: Lockstep, W> {
    group: E::Group,
    wrapped: PhantomData<fn(W)>,
}

impl<E: Lockstep, W> Default for WrappedGroup<E, W> {
    fn default() -> Self {
        Self {
            group: E::Group::default(),
            wrapped: PhantomData,
        }
    }
}

impl<E: Lockstep, W: Env> SlotGroup<W> for WrappedGroup<E, W> {
    fn group_len(&self) -> usize {
        E::Group::LEN
    }

    fn new_empty(&self) -> Box<dyn SlotGroup<W>> {
        Box::new(Self::default())
    }

    fn clear(&mut self) {
        self.group.clear();
    }

    fn prefetch(&self, slot: &Slot<W>) {
        black_box(slot.env.layer::<E>().map(E::prefetch));
    }

    fn begin(&mut self, slot: &mut Slot<W>, request: &Request) {
        let restart = slot.restarts();
        slot.run_part(|Slot { env, action, .. }| {
            let Some(env) = env.layer_mut::<E>() else {
                return;
            };
            match request {
                Request::Reset(reset) => env.begin_reset(reset, &mut self.group),
                Request::Step if restart => env.begin_reset(&Reset::default(), &mut self.group),
                Request::Step => {
                    E::Action::with(action, |action| env.begin_step(action, &mut self.group));
                }
                Request::Nothing => {}
            }
        });
    }

    fn solve(&mut self) {
        self.group.solve();
    }

    fn collect(&mut self, slot: &mut Slot<W>, request: &Request) {
        if let Request::Nothing = request {
            return; // nothing has begun
        }
        slot.run_part(|Slot { env, .. }| {
            if let Some(env) = env.layer_mut::<E>() {
                env.collect(&mut self.group);
            }
        });
    }
}

/// Makes a native vector of the environments that `make` gives for each index: a sync vector whose
/// sub-environments step together. `options` are those of the registration.
///
/// # Errors
/// Those of `make`, and as [`SyncVectorEnv::native`].
pub fn native<E: Lockstep, W: Env>(
    spec: &VectorSpec,
    options: ResetOptions,
    make: impl Fn(usize) -> Result<W>,
) -> Result<Box<dyn VectorEnv>> {
    let vector = SyncVectorEnv::native(spec, options, make)?;
    Ok(Box::new(
        vector.in_lockstep(Box::new(WrappedGroup::<E, W>::default())),
    ))
}

/// Lets environments made by id step together.
pub(crate) fn slot_group<E: Lockstep>() -> Box<dyn SlotGroup<BoxEnv>> {
    Box::new(WrappedGroup::<E, BoxEnv>::default())
}

/// Serves each slot's request, one by one or, with `lockstep`, in groups, and passes each result to
/// `receive`.
pub(super) fn serve_all<E: Env, S: BorrowMut<Slot<E>>, A: Borrow<Request>>(
    slots: &mut [S],
    mut lockstep: Option<&mut (dyn SlotGroup<E> + 'static)>,
    autoreset: Autoreset,
    is_cached: bool,
    request: impl Fn(usize) -> A,
    mut receive: impl FnMut(usize, &mut Slot<E>, Result<()>),
) {
    let len = lockstep
        .as_ref()
        .map_or(1, |lockstep| group_len(slots.len(), lockstep.group_len()));
    for (group, slots) in slots.chunks_mut(len).enumerate() {
        let first = group * len;
        if let Some(lockstep) = &mut lockstep {
            lockstep.clear();
            if !is_cached {
                slots
                    .iter()
                    .for_each(|slot| lockstep.prefetch(slot.borrow()));
            }
            for (slot, place) in slots.iter_mut().zip(first..) {
                lockstep.begin(slot.borrow_mut(), request(place).borrow());
            }
            lockstep.solve();
        }
        for (slot, place) in slots.iter_mut().zip(first..) {
            let (slot, request) = (slot.borrow_mut(), request(place));
            if let Some(lockstep) = &mut lockstep {
                lockstep.collect(slot, request.borrow());
            }
            let result = slot.serve(request.borrow(), autoreset);
            receive(place, slot, result);
        }
    }
}

/// Whether the memory of `n` environments stays in the cache from step to step.
pub(super) fn is_cached(n: usize) -> bool {
    n <= 128
}

/// The size of the groups of `n` slots: at most `most`, and about equal.
pub(super) fn group_len(n: usize, most: usize) -> usize {
    n.div_ceil(n.div_ceil(most).max(1)).max(1)
}
