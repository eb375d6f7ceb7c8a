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
    Task<Config: Arguments + Clone, State: Copy, Observation: FixedArray, Action: ActionColumn> + Sync
{
    /// The numbers that steps work with, `[f64; K]`.
    type Numbers: FixedArray;

    /// An action as numbers, `[f64; A]`.
    type Input: FixedArray;

    /// The constants of the equations, a struct of [`constants!`](crate::constants). They follow
    /// from the arguments, and may differ between the environments of a vector.
    type Constants: Constants;

    /// The constants of the default arguments, if known at compile time: environments with these
    /// run code with the constants folded in.
    const DEFAULTS: Option<Self::Constants> = None;

    /// The constants for these arguments. Each step of a scalar environment calls it, so return
    /// stored numbers.
    fn constants(&self) -> Compared<Self::Constants>;

    /// The numbers of a state, and numbers that a step computes for the next step, such as a sine.
    fn pack(&self, state: &Self::State) -> Self::Numbers;

    /// The state with these numbers; `fresh` if it is the first of an episode.
    fn unpack(&self, numbers: Self::Numbers, fresh: bool) -> Self::State;

    /// The action as numbers.
    fn encode(&self, action: Self::Action) -> Self::Input;

    /// Adds noise to an input.
    #[inline(always)]
    fn noise(
        constants: &<Self::Constants as Constants>::Of<f64>,
        input: &mut Self::Input,
        rng: &mut Generator,
    ) {
        let _ = (constants, input, rng);
    }

    /// The step.
    fn step<R: Real>(
        &self,
        constants: <Self::Constants as Constants>::Of<R>,
        numbers: Of<Self::Numbers, R>,
        input: Of<Self::Input, R>,
    ) -> Next<R, Self>
    where
        Self: Sized;

    /// The observation of a state.
    fn observe(&self, state: &Self::State) -> Self::Observation;

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

/// Constants of [`Equations`]: the struct that [`constants!`](crate::constants) declares, with
/// numbers `f64`.
pub trait Constants: Copy + fmt::Debug + PartialEq + Send + Sync + 'static {
    /// The struct with numbers `T`.
    type Of<T: Copy + fmt::Debug>: Copy + fmt::Debug;

    /// `[f64; P]`.
    type Array: FixedArray;

    /// The constants in the order of the fields.
    fn to_array(self) -> Self::Array;

    /// The constants from their order in an array.
    fn from_array<T: Copy + fmt::Debug>(array: Of<Self::Array, T>) -> Self::Of<T>;
}

/// Declares the constants of [`Equations`](crate::equations::Equations): a struct that is generic
/// over the type of its numbers.
///
/// ```
/// gym_core::constants! {
///     /// The constants of a falling ball.
///     pub struct Constants {
///         /// Acceleration of gravity.
///         gravity,
///         /// The duration of a step.
///         dt,
///     }
/// }
///
/// let constants = Constants { gravity: 9.8, dt: 0.05 };
/// # let _ = constants;
/// ```
#[macro_export]
macro_rules! constants {
    ($(#[$meta:meta])* $vis:vis struct $name:ident {
        $($(#[$doc:meta])* $of:vis $field:ident),+ $(,)?
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $vis struct $name<T> { $($(#[$doc])* $of $field: T,)+ }

        impl $crate::equations::Constants for $name<f64> {
            type Of<T: Copy + ::std::fmt::Debug> = $name<T>;
            type Array = [f64; [$(stringify!($field)),+].len()];

            #[inline(always)]
            fn to_array(self) -> Self::Array {
                let Self { $($field),+ } = self;
                [$($field),+]
            }

            #[inline(always)]
            fn from_array<T: Copy + ::std::fmt::Debug>(
                [$($field),+]: $crate::equations::Of<Self::Array, T>,
            ) -> $name<T> {
                $name { $($field),+ }
            }
        }
    };
}

/// Constants that were compared with the default ones once, not in each step.
#[derive(Clone, Copy, Debug)]
pub struct Compared<C> {
    constants: C,
    are_defaults: bool,
}

impl<C: Copy + PartialEq> Compared<C> {
    /// Compares constants with [`Equations::DEFAULTS`].
    pub fn new(constants: C, defaults: Option<C>) -> Self {
        Self {
            constants,
            are_defaults: defaults == Some(constants),
        }
    }

    /// The constants.
    #[inline(always)]
    pub fn get(self) -> C {
        self.constants
    }

    /// Whether they are the default ones.
    #[inline(always)]
    pub fn are_defaults(self) -> bool {
        self.are_defaults
    }
}

/// An array type. [`Of`] is an array of the same length.
pub trait FixedArray: Copy + fmt::Debug + Send + Sync + 'static {
    /// `[T; N]`.
    type Of<T: Copy + fmt::Debug>: Copy + fmt::Debug + IntoIterator<Item = T>;
}

impl<S: Copy + fmt::Debug + Send + Sync + 'static, const N: usize> FixedArray for [S; N] {
    type Of<T: Copy + fmt::Debug> = [T; N];
}

/// `[T; N]` for a type `A` that is an array of `N`.
pub type Of<A, T> = <A as FixedArray>::Of<T>;

/// The result of a step.
#[derive(Clone, Copy, Debug)]
pub struct Next<R: Real, E: Equations> {
    /// The numbers of the new state.
    pub numbers: Of<E::Numbers, R>,
    /// The reward.
    pub reward: R,
    /// Whether the episode is over.
    pub terminated: R::Mask,
    /// The observation of the new state.
    pub observation: Of<E::Observation, R>,
}

impl<E, const K: usize, const A: usize, const P: usize, const O: usize> Dynamics for E
where
    E: Equations<Numbers = [f64; K], Input = [f64; A], Constants: Constants<Array = [f64; P]>>
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
        let constants = self.constants().get().to_array();
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
        Equations::observe(self, state)
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

/// Calls `f` with the constants. The compiler makes a second copy of `f` for the default constants;
/// with this copy, a step of CartPole takes a sixth less time.
#[inline(always)]
fn with_constants<E: Equations, T>(equations: &E, f: impl FnOnce(E::Constants) -> T) -> T {
    let constants = equations.constants();
    match E::DEFAULTS {
        Some(defaults) if constants.are_defaults() => f(defaults),
        _ => f(constants.get()),
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
    E: Equations<Numbers = [f64; K], Input = [f64; A], Constants: Constants<Array = [f64; P]>>
        + Task<Observation = [f32; O]>,
{
    with_constants(
        equations,
        #[inline(always)]
        |constants| {
            let constants = constants.to_array();
            let (transition, next) =
                step_one::<E, F, K, A, P, O>(equations, constants, state, action, rng);
            *observation = next;
            *state = transition.state;
            (transition.reward, transition.terminated)
        },
    )
}

/// Steps one environment and writes its observation.
#[inline(always)]
fn step_one<E, F: Fma, const K: usize, const A: usize, const P: usize, const O: usize>(
    equations: &E,
    constants: [f64; P],
    state: &E::State,
    action: E::Action,
    rng: &mut Generator,
) -> (Transition<E::State>, [f32; O])
where
    E: Equations<Numbers = [f64; K], Input = [f64; A], Constants: Constants<Array = [f64; P]>>
        + Task<Observation = [f32; O]>,
{
    let mut input = equations.encode(action);
    E::noise(&E::Constants::from_array(constants), &mut input, rng);
    let next = Equations::step(
        equations,
        E::Constants::from_array(ones::<F, P>(constants)),
        ones(equations.pack(state)),
        ones(input),
    );
    let mut transition = Transition {
        state: equations.unpack(values(next.numbers), false),
        reward: next.reward.value(),
        terminated: next.terminated,
    };
    equations.finish(state, action, &mut transition);
    (transition, singles(next.observation))
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
