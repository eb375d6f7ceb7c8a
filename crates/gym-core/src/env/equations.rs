//! Equations for one environment, or for the environments of a SIMD register.
//!
//! The equations are generic over [`Real`](crate::math::Real): one `f64`, or as many as a vector
//! register holds. Single environments and native vectors run the same function, and sines and
//! squares round equally, so their bits are equal. The equations use `Real::select` instead of
//! `if`: with plain `f64` loops, vectorization depended on the compiler's version.

use std::fmt;

use gym_numerics::Generator;
use gym_numerics::math::{Emulated, Fma, Hardware, One, Real, with};

use crate::env::{Dynamics, Outcome, Task, Transition};
use crate::spaces::ActionColumn;
use crate::spec::Arguments;
use crate::value::Result;

/// A task whose step is a formula of a few numbers. The formula is written once for [`Real`]
/// numbers; scalar environments and native vectors compute it with the same bits.
///
/// Implementing it implements [`Dynamics`], and `Native` of the crate gym-native; see the book's
/// page on native vectors. Mark functions with `R: Real`, and all that they call,
/// `#[inline(always)]`: otherwise they are compiled without SIMD.
pub trait Equations:
    Task<Config: Arguments + Clone, State: Copy, Observation: Row, Action: ActionColumn> + Sync
{
    /// The numbers that steps work with, `[f64; K]`.
    type Numbers: Row;

    /// An action as numbers, `[f64; A]`.
    type Input: Row;

    /// The constants of the equations, `[f64; P]`: they follow from the arguments, and may differ
    /// between the environments of a vector.
    type Constants: Row + PartialEq;

    /// The constants of the default arguments, if known at compile time: a native vector with these
    /// runs code with the constants folded in.
    const USUAL: Option<Self::Constants> = None;

    /// Whether [`numbers`](Self::numbers) returns all numbers, so that [`complete`](Self::complete)
    /// does nothing.
    const IS_COMPLETE: bool = true;

    /// Whether [`disturb`](Self::disturb) does anything.
    const IS_NOISY: bool = false;

    /// Whether [`info`](Task::info) has entries.
    const INFO: bool = false;

    /// The constants for these arguments. Each step of a scalar environment calls it, so return
    /// stored numbers.
    fn constants(&self) -> Self::Constants;

    /// Whether these are the [usual](Self::USUAL) constants. Each step of a scalar environment
    /// asks, so return a stored answer.
    fn is_usual(&self) -> bool {
        Self::USUAL == Some(self.constants())
    }

    /// The numbers of a state.
    fn numbers(&self, state: &Self::State) -> Self::Numbers;

    /// The state with these numbers; `fresh` if it is the first of an episode.
    fn state(&self, numbers: Self::Numbers, fresh: bool) -> Self::State;

    /// Whether a state is the first of its episode, for equations that need it.
    fn is_fresh(&self, state: &Self::State) -> bool {
        let _ = state;
        false
    }

    /// Computes the numbers that follow from others, such as a sine that the next step needs again.
    #[inline(always)]
    fn complete<R: Real>(numbers: Of<Self::Numbers, R>) -> Of<Self::Numbers, R> {
        numbers
    }

    /// The action as numbers.
    fn input(&self, action: Self::Action) -> Self::Input;

    /// Adds noise to an input.
    fn disturb(constants: &Self::Constants, input: &mut Self::Input, rng: &mut Generator) {
        let _ = (constants, input, rng);
    }

    /// One step from a state that is `fresh`, the first of its episode, or not.
    fn advance<R: Real>(
        &self,
        constants: Of<Self::Constants, R>,
        state: Of<Self::Numbers, R>,
        fresh: R::Mask,
        input: Of<Self::Input, R>,
    ) -> Next<R, Self>
    where
        Self: Sized;

    /// The observation of a state.
    fn see<R: Real>(&self, state: Of<Self::Numbers, R>) -> Of<Self::Observation, R>;

    /// The observation of a state, if it is not [`see`](Self::see) of its numbers.
    fn see_otherwise(&self, state: &Self::State) -> Option<Self::Observation> {
        let _ = state;
        None
    }

    /// Adds the parts of a state that only scalar environments keep.
    #[inline(always)]
    fn finish(
        &self,
        before: &Self::State,
        action: Self::Action,
        transition: &mut Transition<Self::State>,
    ) {
        let _ = (before, action, transition);
    }
}

/// An array type. [`Of`] is an array of the same length.
pub trait Row: Copy + fmt::Debug + Send + Sync + 'static {
    /// `[T; N]`.
    type Of<T: Copy + fmt::Debug>: Copy + fmt::Debug + IntoIterator<Item = T>;
}

impl<S: Copy + fmt::Debug + Send + Sync + 'static, const N: usize> Row for [S; N] {
    type Of<T: Copy + fmt::Debug> = [T; N];
}

/// `[T; N]` for a type `A` that is an array of `N`.
pub type Of<A, T> = <A as Row>::Of<T>;

/// The result of a step.
#[derive(Clone, Copy, Debug)]
pub struct Next<R: Real, E: Equations> {
    /// The numbers of the new state.
    pub state: Of<E::Numbers, R>,
    /// The reward.
    pub reward: R,
    /// Whether the episode is over.
    pub terminated: R::Mask,
    /// The observation of the new state.
    pub seen: Of<E::Observation, R>,
}

impl<E, const K: usize, const A: usize, const P: usize, const O: usize> Dynamics for E
where
    E: Equations<Numbers = [f64; K], Input = [f64; A], Constants = [f64; P]>
        + Task<Observation = [f32; O]>,
{
    #[inline]
    fn transition(
        &self,
        state: &Self::State,
        action: &Self::Action,
        rng: &mut Generator,
    ) -> Result<Transition<Self::State>> {
        action.check(|| self.action_space())?;
        let constants = Equations::constants(self);
        Ok(with(
            (state, action, rng),
            #[inline(always)]
            |(state, action, rng)| {
                step_one::<E, Hardware, K, A, P, O>(self, constants, state, *action, rng).0
            },
            #[inline(always)]
            |(state, action, rng)| {
                step_one::<E, Emulated, K, A, P, O>(self, constants, state, *action, rng).0
            },
        ))
    }

    #[inline]
    fn observe(&self, state: &Self::State) -> [f32; O] {
        if let Some(observation) = self.see_otherwise(state) {
            return observation;
        }
        with(
            self.numbers(state),
            #[inline(always)]
            |numbers| singles(self.see(ones::<Hardware, K>(numbers))),
            #[inline(always)]
            |numbers| singles(self.see(ones::<Emulated, K>(numbers))),
        )
    }

    #[inline]
    fn step(
        &self,
        state: &mut Self::State,
        action: &Self::Action,
        rng: &mut Generator,
        observation: &mut [f32; O],
    ) -> Result<Outcome> {
        action.check(|| self.action_space())?;
        // return these two in registers: a copy through memory would be slower
        let (reward, terminated) = with(
            (state, action, rng, observation),
            #[inline(always)]
            |(state, action, rng, observation)| {
                step_in_place::<E, Hardware, K, A, P, O>(self, state, *action, rng, observation)
            },
            #[inline(always)]
            |(state, action, rng, observation)| {
                step_in_place::<E, Emulated, K, A, P, O>(self, state, *action, rng, observation)
            },
        );
        Ok(Outcome {
            reward,
            terminated,
            truncated: false,
        })
    }
}

/// The numbers of a state, with those that follow from others.
#[inline]
pub fn all_numbers<E, const K: usize>(equations: &E, state: &E::State) -> [f64; K]
where
    E: Equations<Numbers = [f64; K]>,
{
    let numbers = equations.numbers(state);
    if E::IS_COMPLETE {
        return numbers;
    }
    with(
        numbers,
        #[inline(always)]
        |numbers| values(E::complete(ones::<Hardware, K>(numbers))),
        #[inline(always)]
        |numbers| values(E::complete(ones::<Emulated, K>(numbers))),
    )
}

/// Calls `f` with the constants. It is compiled a second time for the usual ones, with which a step
/// of CartPole takes a sixth less time.
#[inline(always)]
fn with_constants<E: Equations, T>(equations: &E, f: impl FnOnce(E::Constants) -> T) -> T {
    match E::USUAL {
        Some(usual) if equations.is_usual() => f(usual),
        _ => f(equations.constants()),
    }
}

#[inline(always)]
fn step_in_place<E, F: Fma, const K: usize, const A: usize, const P: usize, const O: usize>(
    equations: &E,
    state: &mut E::State,
    action: E::Action,
    rng: &mut Generator,
    observation: &mut [f32; O],
) -> (f64, bool)
where
    E: Equations<Numbers = [f64; K], Input = [f64; A], Constants = [f64; P]>
        + Task<Observation = [f32; O]>,
{
    with_constants(
        equations,
        #[inline(always)]
        |constants| {
            let (transition, seen) =
                step_one::<E, F, K, A, P, O>(equations, constants, state, action, rng);
            *observation = seen;
            *state = transition.state;
            (transition.reward, transition.terminated)
        },
    )
}

/// A step of one environment, and its observation.
#[inline(always)]
fn step_one<E, F: Fma, const K: usize, const A: usize, const P: usize, const O: usize>(
    equations: &E,
    constants: [f64; P],
    state: &E::State,
    action: E::Action,
    rng: &mut Generator,
) -> (Transition<E::State>, [f32; O])
where
    E: Equations<Numbers = [f64; K], Input = [f64; A], Constants = [f64; P]>
        + Task<Observation = [f32; O]>,
{
    let mut input = equations.input(action);
    if E::IS_NOISY {
        E::disturb(&constants, &mut input, rng);
    }
    let numbers = E::complete(ones::<F, K>(equations.numbers(state)));
    let next = equations.advance(
        ones(constants),
        numbers,
        equations.is_fresh(state),
        ones(input),
    );
    let mut transition = Transition {
        state: equations.state(values(next.state), false),
        reward: next.reward.value(),
        terminated: next.terminated,
    };
    equations.finish(state, action, &mut transition);
    (transition, singles(next.seen))
}

// loops, because `array::map` is not always inlined, and is then compiled without the CPU's
// features
#[inline(always)]
fn ones<F: Fma, const N: usize>(numbers: [f64; N]) -> [One<F>; N] {
    let mut ones = [One::new(0.0); N];
    for (one, x) in ones.iter_mut().zip(numbers) {
        *one = One::new(x);
    }
    ones
}

#[inline(always)]
fn values<F: Fma, const N: usize>(ones: [One<F>; N]) -> [f64; N] {
    let mut values = [0.0; N];
    for (x, one) in values.iter_mut().zip(ones) {
        *x = one.value();
    }
    values
}

#[inline(always)]
fn singles<F: Fma, const N: usize>(ones: impl IntoIterator<Item = One<F>>) -> [f32; N] {
    let mut singles = [0.0; N];
    for (x, one) in singles.iter_mut().zip(ones) {
        *x = one.value() as f32;
    }
    singles
}
