//! The native vector of a task whose step is a formula.

use gym_core::equations::{Equations, all_numbers};
use gym_core::math::Real;
use gym_core::rng::{Stream, WordStream};
use gym_core::{Arguments, Error, Result, Task};

use crate::{ActionColumn, LANES, Many, Native};

impl<E, const K: usize, const A: usize, const P: usize, const O: usize> Native for E
where
    E: Equations<Numbers = [f64; K], Input = [f64; A], Constants = [f64; P]>
        + Task<Observation = [f32; O]>,
{
    type Packed = [f64; K];
    type Stream = WordStream;
    type Constants = [f64; P];

    const INFO: bool = E::INFO;

    fn constants(&self) -> [f64; P] {
        Equations::constants(self)
    }

    fn with_numbers(&self, arguments: &[(String, f64)]) -> Result<Self> {
        let mut config = self.config().clone();
        for (name, value) in arguments {
            if !config.set_number(name, *value) {
                return Err(Error::argument(
                    name,
                    format!(
                        "{} has no argument of this name that is a number",
                        Self::NAME
                    ),
                ));
            }
        }
        Self::new(config)
    }

    fn is_usual(&self) -> bool {
        Equations::is_usual(self)
    }

    fn pack(&self, state: &Self::State) -> [f64; K] {
        all_numbers(self, state)
    }

    #[inline(always)]
    fn unpack(&self, packed: [f64; K], fresh: bool) -> Self::State {
        self.state(packed, fresh)
    }

    #[inline(always)]
    fn step_block<R: Real>(&self, token: R::Token, block: &mut Many<'_, Self>) {
        let constants = block.constants;
        block.advance::<R, K, A, P, O>(
            token,
            self,
            #[inline(always)]
            |first| registers(token, constants, first),
        );
    }

    #[inline(always)]
    fn step_usual_block<R: Real>(&self, token: R::Token, block: &mut Many<'_, Self>) {
        // there are some where `is_usual` says so
        if let Some(usual) = E::USUAL {
            block.advance::<R, K, A, P, O>(
                token,
                self,
                #[inline(always)]
                |_| splat(token, usual),
            );
        }
    }
}

impl<E: Native> Many<'_, E> {
    /// Steps each environment by the equations, as many at once as `R` holds, with the constants of
    /// those from a place on.
    #[inline(always)]
    fn advance<R: Real, const K: usize, const A: usize, const P: usize, const O: usize>(
        &mut self,
        token: R::Token,
        equations: &E,
        constants_of: impl Fn(usize) -> [R; P],
    ) where
        E: Equations<Numbers = [f64; K], Input = [f64; A], Constants = [f64; P]>
            + Native<Packed = [f64; K], Constants = [f64; P]>
            + Task<Observation = [f32; O]>,
    {
        let (mut inputs, mut ages) = ([[0.0; LANES]; A], [0.0; LANES]);
        for lane in 0..LANES {
            let mut input = equations.input(E::Action::from_item(self.actions[lane]));
            if E::IS_NOISY && self.due >> lane & 1 == 0 {
                let mut constants = [0.0; P];
                for (x, column) in constants.iter_mut().zip(self.constants) {
                    *x = column[lane];
                }
                self.streams[lane].lend(|rng| E::disturb(&constants, &mut input, rng));
            }
            for (column, x) in inputs.iter_mut().zip(input) {
                column[lane] = x;
            }
            ages[lane] = f64::from(self.steps[lane]);
        }
        let mut seen = [[0.0; LANES]; O];
        let mut terminated = 0;
        for first in (0..LANES).step_by(R::LANES) {
            let age = R::get(token, &ages[first..]);
            let fresh = age.lt(age.same(1.0));
            let state = registers::<R, K>(token, self.states, first);
            let input = registers::<R, A>(token, &inputs, first);
            let next = equations.advance(constants_of(first), state, fresh, input);
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

/// The same numbers for all environments.
#[inline(always)]
fn splat<R: Real, const N: usize>(token: R::Token, numbers: [f64; N]) -> [R; N] {
    let zero = R::get(token, &[0.0; LANES]);
    let mut registers = [zero; N];
    for (register, x) in registers.iter_mut().zip(numbers) {
        *register = zero.same(x);
    }
    registers
}

/// The numbers of some environments, from `first` on.
#[inline(always)]
fn registers<R: Real, const N: usize>(
    token: R::Token,
    columns: &[[f64; LANES]; N],
    first: usize,
) -> [R; N] {
    let mut registers = [R::get(token, &[0.0; LANES]); N];
    for (x, column) in registers.iter_mut().zip(columns) {
        *x = R::get(token, &column[first..]);
    }
    registers
}
