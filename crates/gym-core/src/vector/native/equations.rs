//! Equations that are solved for one environment or for as many as a vector register holds.

use super::{ActionColumn, LANES, Many, Native};
use crate::Dynamics;
use crate::math::{Emulated, Hardware, One, Real, with};

/// The equations of a task of `K` numbers, of which `O` are observed: written once, and the same bits
/// for one environment and for many.
pub trait Equations<const K: usize, const O: usize>: Dynamics {
    /// The action as a number.
    fn input(action: Self::Action) -> f64;

    /// One step from a state that is `fresh`, the first of its episode, or not. To be marked
    /// `#[inline(always)]`, with all that it calls.
    fn advance<R: Real>(&self, state: [R; K], fresh: R::Mask, action: R) -> Next<R, K>;

    /// What is seen of a state that is not fresh. To be marked `#[inline(always)]`.
    fn see<R: Real>(&self, state: [R; K]) -> [R; O];
}

/// What comes of a step.
#[derive(Clone, Copy, Debug)]
pub struct Next<R: Real, const K: usize> {
    /// The numbers of the new state.
    pub state: [R; K],
    /// The reward.
    pub reward: R,
    /// Whether the episode is over.
    pub terminated: R::Mask,
}

/// [`Equations::advance`] of one environment: its new state, the reward, and whether the episode is over.
#[inline]
pub fn advance<E: Equations<K, O>, const K: usize, const O: usize>(
    equations: &E,
    state: [f64; K],
    fresh: bool,
    action: E::Action,
) -> ([f64; K], f64, bool) {
    let action = E::input(action);
    with(
        #[inline(always)]
        || one::<E, Hardware, K, O>(equations, state, fresh, action),
        #[inline(always)]
        || one::<E, Emulated, K, O>(equations, state, fresh, action),
    )
}

#[inline(always)]
fn one<E: Equations<K, O>, F: crate::math::Fma, const K: usize, const O: usize>(
    equations: &E,
    state: [f64; K],
    fresh: bool,
    action: f64,
) -> ([f64; K], f64, bool) {
    let action = One::<F>::new(action);
    let mut numbers = [action; K];
    for (number, x) in numbers.iter_mut().zip(state) {
        *number = One::new(x);
    }
    let next = equations.advance(numbers, fresh, action);
    (next.state.map(One::value), next.reward.value(), next.terminated)
}

/// [`Equations::see`] of one environment.
#[inline]
pub fn see<E: Equations<K, O>, const K: usize, const O: usize>(equations: &E, state: [f64; K]) -> [f32; O] {
    with(
        #[inline(always)]
        || equations.see(state.map(One::<Hardware>::new)).map(|x| x.value() as f32),
        #[inline(always)]
        || equations.see(state.map(One::<Emulated>::new)).map(|x| x.value() as f32),
    )
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
            let terminated = R::bits(next.terminated);
            for (i, flag) in self.terminated[first..][..R::LANES].iter_mut().enumerate() {
                *flag = terminated >> i & 1 == 1;
            }
            for (column, x) in seen.iter_mut().zip(equations.see(next.state)) {
                x.put(&mut column[first..]);
            }
        }
        for (lane, observation) in self.observations.iter_mut().enumerate() {
            for (x, column) in observation.iter_mut().zip(&seen) {
                *x = column[lane] as f32;
            }
        }
    }
}
