//! MountainCarContinuous: drive an underpowered car out of a valley, with as little force as
//! possible.
//!
//! | | |
//! |---|---|
//! | observation | position in [-1.2, 0.6], velocity in ±0.07 per step, both without unit; `Box(2, float32)` |
//! | action | force in [-1, 1], clipped beyond; `Box(1, float32)` |
//! | reward | -0.1 times the squared action (as given, not clipped), and 100 at the goal |
//! | start | position uniform in [-0.6, -0.4], at rest; reset options `low`, `high` (numbers, -0.6 and -0.4) are other bounds |
//! | end | terminated at [`Config::goal_position`] or beyond with at least [`Config::goal_velocity`] |
//! | limit | 999 steps |
//!
//! From Moore (1990), "Efficient memory-based learning for robot control"; the order of operations
//! is that of Gymnasium 1.4.0, `envs/classic_control/continuous_mountain_car.py`, with numpy 2: the
//! state is `float64` after a reset and `float32` from the first step on, and the force keeps the
//! precision of the action.

use gym_core::canvas::Canvas;
use gym_core::keys::json;
use gym_core::math::Real;
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::{
    Continuous, Error, Generator, Keys, Names, Policy, Registration, Reset, Result, Space,
    Stateful, Task,
};
use gym_native::{Compared, Equations, Next};
use serde::{Deserialize, Serialize};

use crate::mountain_car::{self, clip, equal};
use crate::{constants, policy, reset};

/// The environment.
pub type MountainCarContinuous = Stateful<MountainCarContinuousDynamics>;

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub const struct Config {
        /// The smallest velocity at which the goal counts as reached.
        pub goal_velocity: f64 = 0.0,
        /// The smallest force: a smaller action is raised to it.
        pub min_action: f64 = -1.0,
        /// The largest force: a larger action is lowered to it.
        pub max_action: f64 = 1.0,
        /// The left end of the valley: a wall.
        pub min_position: f64 = -1.2,
        /// The right end of the valley.
        pub max_position: f64 = 0.6,
        /// The largest velocity, per step.
        pub max_speed: f64 = 0.07,
        /// The position of the goal.
        pub goal_position: f64 = 0.45,
        /// The change of velocity by a force of 1 in a step.
        pub power: f64 = 0.0015,
    }
}

/// The state of the car.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Position along the valley.
    pub position: f64,
    /// Velocity per step.
    pub velocity: f64,
    /// Whether the episode has just begun: the numbers are then `float64`, later `float32`.
    pub fresh: bool,
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct MountainCarContinuousDynamics {
    config: Config,
    /// The arguments of the constructor, from which the spaces follow.
    built: Config,
    constants: Compared<Constants<f64>>,
}

gym_core::constants! {
    /// The constants of the equations, under the names of the arguments.
    pub struct Constants {
        goal_velocity,
        min_action,
        max_action,
        min_position,
        max_position,
        max_speed,
        goal_position,
        power,
    }
}

impl Constants<f64> {
    /// The constants that follow from the arguments.
    const fn of(config: &Config) -> Self {
        Self {
            goal_velocity: config.goal_velocity,
            min_action: config.min_action,
            max_action: config.max_action,
            min_position: config.min_position,
            max_position: config.max_position,
            max_speed: config.max_speed,
            goal_position: config.goal_position,
            power: config.power,
        }
    }
}

/// Takes one step. With `SINGLE`, all actions are `float32` and within bounds, and no state is the
/// first of its episode, so every result is rounded to `float32`.
#[inline(always)]
fn advance<R: Real, const SINGLE: bool>(
    constants: Constants<R>,
    [position, velocity]: [R; 2],
    fresh: R::Mask,
    [action, precision]: [R; 2],
) -> Next<R, MountainCarContinuousDynamics> {
    let Constants {
        goal_velocity,
        min_action,
        max_action,
        min_position,
        max_position,
        max_speed,
        goal_position,
        power,
    } = constants;
    let (single, zero) = (precision.lt(precision.same(1.0)), position.same(0.0));
    let double = R::but_not(precision.lt(precision.same(2.0)), single);
    // each operation on `float32` numbers is exact in `float64` up to this rounding
    let rounded = |wide: R::Mask, x: R| {
        if SINGLE {
            x.single()
        } else {
            R::select(wide, x, x.single())
        }
    };
    // as `rounded`, for numbers that are already rounded if `SINGLE` is true
    let narrowed = |wide: R::Mask, x: R| if SINGLE { x } else { rounded(wide, x) };

    let pull = rounded(fresh, position * 3.0).cos() * 0.0025;
    let within = ((action * power.single()).single() - pull.single()).single();
    // a clipped force is one of the bounds, which are Python floats: the sum is then `float64`
    let below = action.lt(R::select(single, min_action.single(), min_action));
    let above = action.gt(R::select(single, max_action.single(), max_action));
    let clipped = below | above;
    let force = R::select(below, min_action, R::select(above, max_action, action));
    let change = if SINGLE {
        within
    } else {
        R::select(R::but_not(single, clipped), within, force * power - pull)
    };

    // a sum with a Python float has the precision of the state; a sum with a `float64` number has
    // double precision
    let wide = fresh | R::but_not(double, clipped);
    let most = rounded(wide, max_speed);
    let moved = rounded(wide, velocity + narrowed(wide, change));
    let wide_position = fresh | R::but_not(wide, moved.lt(-most) | moved.gt(most));
    let velocity = clip(moved, -most, most);
    let min_position = rounded(wide_position, min_position);
    let max_position = rounded(wide_position, max_position);
    let moved = rounded(wide_position, position + narrowed(wide_position, velocity));
    let position = clip(moved, min_position, max_position);
    let velocity = R::select(
        equal(position, min_position) & velocity.lt(zero),
        zero,
        velocity,
    );
    let terminated = rounded(wide_position, goal_position).le(position)
        & rounded(wide, goal_velocity).le(velocity);
    let bonus = R::select(terminated, zero.same(100.0), zero);
    let reward = bonus - action.square() * 0.1;
    let observation = if SINGLE {
        [position, velocity]
    } else {
        [position.single(), velocity.single()]
    };
    let [position, velocity] = observation;
    Next {
        numbers: [position, velocity, zero],
        reward,
        terminated,
        observation,
    }
}

impl Equations for MountainCarContinuousDynamics {
    type Numbers = [f64; 3];
    type Input = [f64; 2];
    type Constants = Constants<f64>;

    const DEFAULTS: Option<Constants<f64>> = Some(Constants::of(&Config::DEFAULT));

    #[inline(always)]
    fn constants(&self) -> Compared<Constants<f64>> {
        self.constants
    }

    /// The third number is 1 if the state is the first of its episode.
    #[inline(always)]
    fn pack(&self, state: &State) -> [f64; 3] {
        let fresh = f64::from(u8::from(state.fresh));
        [state.position, state.velocity, fresh]
    }

    #[inline(always)]
    fn unpack(&self, [position, velocity, _]: [f64; 3], fresh: bool) -> State {
        State {
            position,
            velocity,
            fresh,
        }
    }

    #[inline(always)]
    fn encode(
        &self,
        Continuous {
            numbers: [force],
            precision,
        }: Continuous<1>,
    ) -> [f64; 2] {
        [force, f64::from(precision as u8)]
    }

    /// The equations of motion, for a force of any magnitude.
    #[inline(always)]
    fn step<R: Real>(
        &self,
        constants: Constants<R>,
        [position, velocity, fresh]: [R; 3],
        [action, precision]: [R; 2],
    ) -> Next<R, Self> {
        let Constants {
            min_action,
            max_action,
            ..
        } = constants;
        let fresh = fresh.gt(fresh.same(0.0));
        let single = precision.lt(precision.same(1.0));
        let within = min_action.single().le(action) & action.le(max_action.single());
        if R::all(R::but_not(single & within, fresh)) {
            advance::<R, true>(constants, [position, velocity], fresh, [action, precision])
        } else {
            advance::<R, false>(constants, [position, velocity], fresh, [action, precision])
        }
    }

    #[inline(always)]
    fn observe(&self, state: &State) -> [f32; 2] {
        [state.position, state.velocity].map(|x| x as f32)
    }
}

impl Task for MountainCarContinuousDynamics {
    type Config = Config;
    type State = State;
    type Observation = [f32; 2];
    type Action = Continuous<1>;

    const NAME: &'static str = "MountainCarContinuous";

    fn new(config: Config) -> Result<Self> {
        let Config {
            min_action,
            max_action,
            max_speed,
            goal_position,
            power,
            ..
        } = config;
        mountain_car::check_valley(
            Self::NAME,
            config.goal_velocity,
            [config.min_position, config.max_position],
        )?;
        constants::finite(
            Self::NAME,
            [
                ("min_action", min_action),
                ("max_action", max_action),
                ("goal_position", goal_position),
                ("power", power),
            ],
        )?;
        constants::limits(Self::NAME, [("max_speed", max_speed)])?;
        if min_action > max_action {
            let reason = format!(
                "min_action is {min_action:?}: it must not be above max_action, {max_action:?}"
            );
            return Err(Error::argument(Self::NAME, reason));
        }
        Ok(Self {
            config,
            built: config,
            constants: Compared::new(Constants::of(&config), Self::DEFAULTS),
        })
    }

    fn check_start(&self) -> Result<()> {
        let range = [self.config.min_position, self.config.max_position];
        mountain_car::check_start(Self::NAME, range)
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn assign(&mut self, config: Config) -> Result<()> {
        *self = Self {
            built: self.built,
            ..Self::new(config)?
        };
        Ok(())
    }

    fn observation_space(&self) -> Space {
        mountain_car::valley(
            self.built.min_position,
            self.built.max_position,
            self.built.max_speed,
        )
    }

    fn action_space(&self) -> Space {
        Space::boxed(
            [self.built.min_action as f32],
            [self.built.max_action as f32],
        )
    }

    fn start(&self, reset: &Reset, rng: &mut Generator) -> Result<State> {
        let (low, high) = reset::bounds(reset, Self::NAME, -0.6, -0.4)?;
        Ok(State {
            position: rng.uniform(low, high),
            velocity: 0.0,
            fresh: true,
        })
    }

    fn is_valid(&self, state: &State) -> bool {
        !self.constants.are_defaults() || reset::plausible(&[state.position, state.velocity])
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(30, (600, 400))
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        let Config {
            min_position,
            max_position,
            goal_position,
            ..
        } = self.config;
        mountain_car::draw(
            state.position,
            !state.fresh,
            [min_position, max_position],
            goal_position,
            canvas,
        );
    }
}

gym_core::register!(
    Registration::new::<MountainCarContinuous>("MountainCarContinuous-v0")
        .description("Drive an underpowered car out of a valley, with little effort.")
        .max_episode_steps(999)
        .reward_threshold(90.0)
        .reset_options(&[("low", "-0.55"), ("high", "-0.45")])
        .exceptions(reset::EXCEPTIONS)
        .vector_entry_point(gym_native::entry_point::<MountainCarContinuousDynamics>)
        .light_step()
        .names(|_| Names::new(&["position", "velocity (per step)"], &["force"]))
        .keys(|_| Keys::new(json!({"Left": [-1], "Right": [1]})).idle(json!([0])))
        .policy(Policy::rules(
            "drives in the direction of the velocity, with force 0.4",
            |_| reflex(policy::mountain_car_continuous)
        ))
        .clip(Clip {
            seeds: 0..1,
            every: 3,
            frames: 100,
            size: (300, 200)
        })
);
