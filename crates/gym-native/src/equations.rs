//! The native vector of a task whose step is a formula.

use gym_core::equations::{Constants, Equations};
use gym_core::math::Real;
use gym_core::rng::{Stream, WordStream};
use gym_core::{Arguments, Error, Result, Task};

use crate::{ActionColumn, LANES, Many, Native, Packed};

impl<E, const K: usize, const A: usize, const P: usize, const O: usize> Native for E
where
    E: Equations<Numbers = [f64; K], Input = [f64; A], Constants: Constants<Array = [f64; P]>>
        + Task<Observation = [f32; O]>,
{
    type Packed = [f64; K];
    type Stream = WordStream;
    type Constants = [f64; P];

    fn constants(&self) -> [f64; P] {
        Equations::constants(self).get().to_array()
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
        let task = Self::new(config)?;
        task.check_start()?;
        Ok(task)
    }

    fn has_defaults(&self) -> bool {
        Equations::constants(self).are_defaults()
    }

    #[inline(always)]
    fn pack(&self, state: &Self::State) -> [f64; K] {
        Equations::pack(self, state)
    }

    #[inline(always)]
    fn unpack(&self, packed: [f64; K], fresh: bool) -> Self::State {
        Equations::unpack(self, packed, fresh)
    }

    #[inline(always)]
    fn step_block<R: Real>(&self, token: R::Token, block: &mut Many<'_, Self>) {
        let constants = block.constants;
        block.step::<R, K, A, P, O>(
            token,
            self,
            #[inline(always)]
            |first| registers(token, constants, first),
        );
    }

    #[inline(always)]
    fn step_default_block<R: Real>(&self, token: R::Token, block: &mut Many<'_, Self>) {
        // without `DEFAULTS`, `has_defaults` is false and this function is never called
        if let Some(defaults) = E::DEFAULTS {
            let defaults = defaults.to_array();
            block.step::<R, K, A, P, O>(
                token,
                self,
                #[inline(always)]
                |_| splat(token, defaults),
            );
        }
    }
}

impl<E: Native> Many<'_, E> {
    /// Steps each environment by the equations, as many at once as `R` holds. `constants_of(i)`
    /// returns the constants of the environments from index `i` on.
    #[inline(always)]
    fn step<R: Real, const K: usize, const A: usize, const P: usize, const O: usize>(
        &mut self,
        token: R::Token,
        equations: &E,
        constants_of: impl Fn(usize) -> [R; P],
    ) where
        E: Equations<Numbers = [f64; K], Input = [f64; A]>
            + Equations<Constants: Constants<Array = [f64; P]>>
            + Native<Packed = [f64; K], Constants = [f64; P]>
            + Task<Observation = [f32; O]>,
    {
        let mut inputs = [[0.0; LANES]; A];
        for lane in 0..LANES {
            let mut input = equations.encode(E::Action::from_item(self.actions[lane]));
            if self.due >> lane & 1 == 0 {
                let constants =
                    <E as Equations>::Constants::from_array(<[f64; P]>::get(self.constants, lane));
                self.streams[lane].lend(|rng| E::noise(&constants, &mut input, rng));
            }
            for (column, x) in inputs.iter_mut().zip(input) {
                column[lane] = x;
            }
        }
        let mut observations = [[0.0; LANES]; O];
        let mut terminated = 0;
        for first in (0..LANES).step_by(R::LANES) {
            let constants = <E as Equations>::Constants::from_array(constants_of(first));
            let numbers = registers::<R, K>(token, self.states, first);
            let input = registers::<R, A>(token, &inputs, first);
            let next = Equations::step(equations, constants, numbers, input);
            for (column, x) in self.states.iter_mut().zip(next.numbers) {
                x.put(&mut column[first..]);
            }
            next.reward.put(&mut self.rewards[first..]);
            terminated |= (R::bits(next.terminated) as u32) << first;
            for (column, x) in observations.iter_mut().zip(next.observation) {
                x.put(&mut column[first..]);
            }
        }
        *self.terminated = terminated;
        for (lane, observation) in self.observations.iter_mut().enumerate() {
            for (x, column) in observation.iter_mut().zip(&observations) {
                *x = column[lane] as f32;
            }
        }
    }
}

/// The same numbers for each environment in a register.
#[inline(always)]
fn splat<R: Real, const N: usize>(token: R::Token, numbers: [f64; N]) -> [R; N] {
    let zero = R::get(token, &[0.0; LANES]);
    let mut registers = [zero; N];
    for (register, x) in registers.iter_mut().zip(numbers) {
        *register = zero.same(x);
    }
    registers
}

/// The numbers of the environments from `first` on, one register for each number.
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
