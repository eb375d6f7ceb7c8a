//! Equations that are solved for one environment or for as many as a vector register holds.

use super::{ActionColumn, LANES, Many, Native};
use crate::math::{Emulated, Fma, Hardware, One, Real, with};
use crate::{Dynamics, Outcome, Transition};

/// The equations of a task of `K` numbers, of which `O` are observed: written once, and the same bits
/// for one environment and for many.
pub trait Equations<const K: usize, const O: usize>: Dynamics {
    /// The action as a number.
    fn input(action: Self::Action) -> f64;

    /// One step from a state that is `fresh`, the first of its episode, or not. To be marked
    /// `#[inline(always)]`, with all that it calls.
    fn advance<R: Real>(&self, state: [R; K], fresh: R::Mask, action: R) -> Next<R, K, O>;

    /// What is seen of a state that is not fresh. To be marked `#[inline(always)]`.
    fn see<R: Real>(&self, state: [R; K]) -> [R; O];

    /// [`Dynamics::transition`] for an action that can be executed, and what is seen then, by [`advance`]. To
    /// be marked `#[inline(always)]`.
    fn move_on<F: Fma>(
        &self,
        state: &Self::State,
        action: Self::Action,
    ) -> (Transition<Self::State>, Self::Observation);

    /// [`Dynamics::observe`], by [`see`]. To be marked `#[inline(always)]`.
    fn look_at<F: Fma>(&self, state: &Self::State) -> Self::Observation;
}

/// What comes of a step.
#[derive(Clone, Copy, Debug)]
pub struct Next<R: Real, const K: usize, const O: usize> {
    /// The numbers of the new state.
    pub state: [R; K],
    /// The reward.
    pub reward: R,
    /// Whether the episode is over.
    pub terminated: R::Mask,
    /// What is seen of the new state.
    pub seen: [R; O],
}

/// [`Equations::advance`] of one environment: its new state, the reward, whether the episode is over, and what
/// is seen.
#[inline(always)]
pub fn advance<E: Equations<K, O>, F: Fma, const K: usize, const O: usize>(
    equations: &E,
    state: [f64; K],
    fresh: bool,
    action: E::Action,
) -> ([f64; K], f64, bool, [f32; O]) {
    let action = One::<F>::new(E::input(action));
    let mut numbers = [action; K];
    for (number, x) in numbers.iter_mut().zip(state) {
        *number = One::new(x);
    }
    let next = equations.advance(numbers, fresh, action);
    let mut state = state;
    for (x, number) in state.iter_mut().zip(next.state) {
        *x = number.value();
    }
    (state, next.reward.value(), next.terminated, singles(next.seen))
}

/// [`Equations::see`] of one environment.
#[inline(always)]
pub fn see<E: Equations<K, O>, F: Fma, const K: usize, const O: usize>(
    equations: &E,
    state: [f64; K],
) -> [f32; O] {
    let mut numbers = [One::<F>::new(0.0); K];
    for (number, x) in numbers.iter_mut().zip(state) {
        *number = One::new(x);
    }
    singles(equations.see(numbers))
}

// (a loop, because `array::map` is not always inlined)
#[inline(always)]
fn singles<F: Fma, const O: usize>(numbers: [One<F>; O]) -> [f32; O] {
    let mut singles = [0.0; O];
    for (x, number) in singles.iter_mut().zip(numbers) {
        *x = number.value() as f32;
    }
    singles
}

/// [`Dynamics::transition`] of a task of equations.
#[inline]
pub fn transition<E: Equations<K, O>, const K: usize, const O: usize>(
    equations: &E,
    state: &E::State,
    action: E::Action,
) -> Transition<E::State> {
    with(
        action,
        #[inline(always)]
        |action| equations.move_on::<Hardware>(state, action).0,
        #[inline(always)]
        |action| equations.move_on::<Emulated>(state, action).0,
    )
}

/// [`Dynamics::observe`] of a task of equations.
#[inline]
pub fn observe<E: Equations<K, O>, const K: usize, const O: usize>(
    equations: &E,
    state: &E::State,
) -> E::Observation {
    with(
        (),
        #[inline(always)]
        |()| equations.look_at::<Hardware>(state),
        #[inline(always)]
        |()| equations.look_at::<Emulated>(state),
    )
}

/// [`Dynamics::step`] of a task of equations, which truncates nothing.
#[inline]
pub fn step<E: Equations<K, O>, const K: usize, const O: usize>(
    equations: &E,
    state: &mut E::State,
    action: E::Action,
    observation: &mut E::Observation,
) -> Outcome {
    // these two come back in registers; what is put together of them in memory would be waited for
    let (reward, terminated) = with(
        (equations, state, action, observation),
        #[inline(always)]
        |(equations, state, action, observation)| {
            step_with::<E, Hardware, K, O>(equations, state, action, observation)
        },
        #[inline(always)]
        |(equations, state, action, observation)| {
            step_with::<E, Emulated, K, O>(equations, state, action, observation)
        },
    );
    Outcome { reward, terminated, truncated: false }
}

#[inline(always)]
fn step_with<E: Equations<K, O>, F: Fma, const K: usize, const O: usize>(
    equations: &E,
    state: &mut E::State,
    action: E::Action,
    observation: &mut E::Observation,
) -> (f64, bool) {
    let (Transition { state: next, reward, terminated }, seen) = equations.move_on::<F>(state, action);
    *observation = seen;
    *state = next;
    (reward, terminated)
}

impl<D: Native> Many<'_, D> {
    /// Steps each environment by the equations, as many at once as `R` holds.
    #[inline(always)]
    pub fn advance<R: Real, const K: usize, const O: usize>(&mut self, token: R::Token, equations: &D)
    where
        D: Equations<K, O> + Native<Packed = [f64; K]> + Dynamics<Observation = [f32; O]>,
    {
        // loops, because `array::map` is not always inlined, and then it is compiled without the CPU's features
        let (mut actions, mut ages) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            actions[lane] = D::input(D::Action::from_item(self.actions[lane]));
            ages[lane] = f64::from(self.steps[lane]);
        }
        let mut seen = [[0.0; LANES]; O];
        let mut terminated = 0;
        for first in (0..LANES).step_by(R::LANES) {
            let get = |numbers: &[f64; LANES]| R::get(token, &numbers[first..]);
            let age = get(&ages);
            let mut state = [age; K];
            for (x, column) in state.iter_mut().zip(self.states.iter()) {
                *x = get(column);
            }
            let next = equations.advance(state, age.lt(age.same(1.0)), get(&actions));
            for (column, x) in self.states.iter_mut().zip(next.state) {
                x.put(&mut column[first..]);
            }
            next.reward.put(&mut self.rewards[first..]);
            terminated |= (R::bits(next.terminated) as u32) << first;
            for (column, x) in seen.iter_mut().zip(next.seen) {
                x.put(&mut column[first..]);
            }
        }
        *self.terminated = terminated;
        for (lane, observation) in self.observations.iter_mut().enumerate() {
            for (x, column) in observation.iter_mut().zip(&seen) {
                *x = column[lane] as f32;
            }
        }
    }
}
