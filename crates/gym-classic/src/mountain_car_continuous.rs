//! MountainCarContinuous: drive an underpowered car out of a valley, with as little force as can be.
//!
//! | | |
//! |---|---|
//! | observation | position in [-1.2, 0.6], velocity in ±0.07 per step, both without unit; `Box(2, float32)` |
//! | action | force in [-1, 1], clipped beyond; `Box(1, float32)` |
//! | reward | -0.1 times the squared action (as given, not clipped), and 100 at the goal |
//! | start | position uniform in [-0.6, -0.4], at rest; reset options `low`, `high` (numbers, -0.6 and -0.4) are other bounds |
//! | end | terminated at position 0.45 or beyond with at least [`Config::goal_velocity`] |
//! | limit | 999 steps |
//!
//! From Moore (1990), "Efficient memory-based learning for robot control"; the order of operations
//! is that of Gymnasium 1.4.0, `envs/classic_control/continuous_mountain_car.py`, with numpy 2:
//! the state is `float64` after a reset and `float32` from the first step on.

use gym_core::canvas::Canvas;
use gym_core::math::Real;
use gym_core::render::Metadata;
use gym_core::vector::native::{self, Equations, Next};
use gym_core::{Generator, Registration, Reset, Result, Space, Stateful, Task};
use serde::{Deserialize, Serialize};

use crate::mountain_car::{self, MAX_POSITION, MAX_SPEED, MIN_POSITION};
use crate::reset;

/// The environment.
pub type MountainCarContinuous = Stateful<MountainCarContinuousDynamics>;

pub use crate::mountain_car::Config;

const GOAL_POSITION: f64 = 0.45;
const POWER: f64 = 0.0015;

/// The car.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Position along the valley.
    pub position: f64,
    /// Velocity per step.
    pub velocity: f64,
    /// Whether the episode has just begun, and the numbers are not yet those of `float32`.
    pub fresh: bool,
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct MountainCarContinuousDynamics {
    config: Config,
}

impl Equations for MountainCarContinuousDynamics {
    type Numbers = [f64; 2];
    type Input = [f64; 1];
    type Constants = [f64; 0];

    #[inline(always)]
    fn constants(&self) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn numbers(&self, state: &State) -> [f64; 2] {
        [state.position, state.velocity]
    }

    #[inline(always)]
    fn state(&self, [position, velocity]: [f64; 2], fresh: bool) -> State {
        State { position, velocity, fresh }
    }

    /// The force.
    #[inline(always)]
    fn input(&self, [force]: [f32; 1]) -> [f64; 1] {
        [f64::from(force)]
    }

    /// The equations of motion, for a force of any size.
    #[inline(always)]
    fn advance<R: Real>(
        &self,
        []: [R; 0],
        [position, velocity]: [R; 2],
        fresh: R::Mask,
        [force]: [R; 1],
    ) -> Next<R, Self> {
        // Each operation on `float32` numbers is exact in `float64` up to this rounding.
        let state_type = |x: R| R::select(fresh, x, x.single());
        let same = |x: f64| position.same(x);

        let pull = state_type(position * 3.0).cos() * 0.0025;
        let within = (force * same(POWER).single()).single() - pull.single();
        // a clipped force is one of the bounds, a Python float: the sum is then `float64`
        let beyond = same(POWER).copysign(force) - pull;
        let change = R::select(force.abs().le(same(1.0)), within.single(), beyond);
        let max_speed = state_type(same(MAX_SPEED));
        let min_position = state_type(same(MIN_POSITION));
        let max_position = state_type(same(MAX_POSITION));
        let velocity = clip(state_type(velocity + state_type(change)), -max_speed, max_speed);
        let position = clip(state_type(position + velocity), min_position, max_position);
        let at_wall = position.le(min_position);
        let velocity = R::select(at_wall & velocity.lt(same(0.0)), same(0.0), velocity);
        let terminated = state_type(same(GOAL_POSITION)).le(position)
            & state_type(same(self.config.goal_velocity)).le(velocity);
        let bonus = R::select(terminated, same(100.0), same(0.0));
        let reward = bonus - force * force * 0.1;
        let state = [position.single(), velocity.single()];
        Next { state, reward, terminated, seen: state }
    }

    #[inline(always)]
    fn see<R: Real>(&self, state: [R; 2]) -> [R; 2] {
        state
    }

    #[inline(always)]
    fn is_fresh(&self, state: &State) -> bool {
        state.fresh
    }
}

impl Task for MountainCarContinuousDynamics {
    type Config = Config;
    type State = State;
    type Observation = [f32; 2];
    type Action = [f32; 1];

    const NAME: &'static str = "MountainCarContinuous";

    fn new(config: Config) -> Result<Self> {
        mountain_car::check_goal_velocity(Self::NAME, config.goal_velocity)?;
        Ok(Self { config })
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn observation_space(&self) -> Space {
        Space::boxed([MIN_POSITION as f32, -MAX_SPEED as f32], [MAX_POSITION as f32, MAX_SPEED as f32])
    }

    fn action_space(&self) -> Space {
        Space::boxed([-1.0], [1.0])
    }

    fn start(&self, reset: &Reset, rng: &mut Generator) -> Result<State> {
        let (low, high) = reset::bounds(reset, Self::NAME, -0.6, -0.4)?;
        Ok(State { position: rng.uniform(low, high), velocity: 0.0, fresh: true })
    }

    fn is_valid(&self, state: &State) -> bool {
        reset::plausible(&[state.position, state.velocity])
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(30, (600, 400))
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        mountain_car::draw(state.position, !state.fresh, GOAL_POSITION, canvas);
    }
}

/// `np.clip`.
#[inline(always)]
fn clip<R: Real>(x: R, low: R, high: R) -> R {
    let x = R::select(x.lt(low), low, x);
    R::select(x.gt(high), high, x)
}

gym_core::register!(
    Registration::new::<MountainCarContinuous>("MountainCarContinuous-v0")
        .description("Drive an underpowered car out of a valley, with little effort.")
        .max_episode_steps(999)
        .reward_threshold(90.0)
        .reset_options(&[("low", "-0.55"), ("high", "-0.45")])
        .vector_entry_point(native::entry_point::<MountainCarContinuousDynamics>)
);

#[cfg(test)]
mod tests {
    use gym_core::EnvExt;

    use super::*;

    /// The force is clipped, and what was asked for is paid.
    #[test]
    fn the_cost_is_that_of_the_action_as_given() {
        let step = |force: f32| {
            let mut env = MountainCarContinuous::new(Config::default()).unwrap();
            env.reset(0).unwrap();
            env.step(&[force]).unwrap()
        };
        assert!((step(3.0).reward + 0.9).abs() < 1e-9, "{}", step(3.0).reward);
        assert!((step(1.0).reward + 0.1).abs() < 1e-9);
        assert!((step(3.0).observation[0] - step(1.0).observation[0]).abs() < 1e-6);
    }
}
