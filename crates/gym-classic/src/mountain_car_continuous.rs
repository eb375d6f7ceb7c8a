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
use gym_core::math::{Libm, Math, Polynomial};
use gym_core::render::Metadata;
use gym_core::rng::WordStream;
use gym_core::vector::native::{self, Native};
use gym_core::{Dynamics, Generator, Registration, Reset, Result, Space, Stateful, Transition};
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

impl MountainCarContinuousDynamics {
    /// The equations of motion, for a force of any size.
    #[inline(always)]
    fn advance<M: Math>(&self, state: &State, action: f32) -> Transition<State> {
        // Each operation on `float32` numbers is exact in `float64` up to this rounding.
        let single = |x: f64| f64::from(x as f32);
        let state_type = |x: f64| if state.fresh { x } else { single(x) };
        let State { mut position, mut velocity, .. } = *state;

        let pull = 0.0025 * M::cos(state_type(3.0 * position));
        let change = if (-1.0..=1.0).contains(&action) {
            single(single(f64::from(action) * single(POWER)) - single(pull))
        } else {
            // a clipped force is one of the bounds, a Python float: the sum is then `float64`
            f64::from(action.signum()) * POWER - pull
        };
        let max_speed = state_type(MAX_SPEED);
        let (min_position, max_position) = (state_type(MIN_POSITION), state_type(MAX_POSITION));
        velocity = clip(state_type(velocity + state_type(change)), -max_speed, max_speed);
        position = clip(state_type(position + velocity), min_position, max_position);
        if (position == min_position) & (velocity < 0.0) {
            velocity = 0.0;
        }
        let terminated =
            (position >= state_type(GOAL_POSITION)) & (velocity >= state_type(self.config.goal_velocity));
        let bonus = if terminated { 100.0 } else { 0.0 };
        let reward = bonus - f64::from(action) * f64::from(action) * 0.1;
        let state = State { position: single(position), velocity: single(velocity), fresh: false };
        Transition { state, reward, terminated }
    }
}

impl Dynamics for MountainCarContinuousDynamics {
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

    #[inline]
    fn transition(
        &self,
        state: &State,
        action: &[f32; 1],
        _rng: &mut Generator,
    ) -> Result<Transition<State>> {
        let action = reset::finite(*action, || self.action_space())?;
        Ok(self.advance::<Libm>(state, action))
    }

    #[inline]
    fn observe(&self, state: &State) -> [f32; 2] {
        [state.position as f32, state.velocity as f32]
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

/// `np.clip`. Unlike `clamp` it does not ask whether the bounds are in order.
#[inline(always)]
fn clip(x: f64, low: f64, high: f64) -> f64 {
    let x = if x < low { low } else { x };
    if x > high { high } else { x }
}

impl Native for MountainCarContinuousDynamics {
    type Packed = [f64; 2];
    type Stream = WordStream;

    const DRAWS: bool = false;

    fn pack(state: &State) -> [f64; 2] {
        [state.position, state.velocity]
    }

    #[inline(always)]
    fn unpack([position, velocity]: [f64; 2], fresh: bool) -> State {
        State { position, velocity, fresh }
    }

    #[inline(always)]
    fn step(&self, state: &State, [action]: [f32; 1], _rng: &mut WordStream) -> Transition<State> {
        self.advance::<Polynomial>(state, action)
    }
}

gym_core::register!(
    Registration::new::<MountainCarContinuous>("MountainCarContinuous-v0")
        .description("Drive an underpowered car out of a valley, with little effort.")
        .max_episode_steps(999)
        .reward_threshold(90.0)
        .vector_entry_point(native::entry_point::<MountainCarContinuousDynamics>)
);
