//! MountainCar: drive an underpowered car out of a valley by swinging back and forth.
//!
//! | | |
//! |---|---|
//! | observation | position in [-1.2, 0.6], velocity in ±0.07 per step, both without unit; `Box(2, float32)` |
//! | action | [`Action`]: accelerate left, not at all, or right; `Discrete(3)` |
//! | reward | -1 per step |
//! | start | position uniform in [-0.6, -0.4], at rest; reset options `low`, `high` (numbers, -0.6 and -0.4) are other bounds |
//! | end | terminated at [`Config::goal_position`] or beyond with at least [`Config::goal_velocity`] |
//! | limit | 200 steps |
//!
//! From Moore (1990), "Efficient memory-based learning for robot control"; the order of operations
//! is that of Gymnasium 1.4.0, `envs/classic_control/mountain_car.py`.

use gym_core::canvas::{Canvas, Color, Point, Primitive};
use gym_core::keys::json;
use gym_core::math::{Real, cos, numpy_sin_cos_f32, sin};
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::{
    Error, Generator, Keys, Names, Policy, Registration, Reset, Result, Space, Stateful, Task,
    pygame,
};
use gym_native::{Compared, Equations, Next};
use serde::{Deserialize, Serialize};

use crate::{constants, policy, reset};

/// The environment.
pub type MountainCar = Stateful<MountainCarDynamics>;

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub const struct Config {
        /// The smallest velocity at which the goal counts as reached.
        pub goal_velocity: f64 = 0.0,
        /// The left end of the valley: a wall.
        pub min_position: f64 = -1.2,
        /// The right end of the valley.
        pub max_position: f64 = 0.6,
        /// The largest velocity, per step.
        pub max_speed: f64 = 0.07,
        /// The position of the goal.
        pub goal_position: f64 = 0.5,
        /// The change of velocity by the motor in a step.
        pub force: f64 = 0.001,
        /// The largest change of velocity by the slope in a step.
        pub gravity: f64 = 0.0025,
    }
}

gym_core::discrete! {
    /// The direction of the acceleration.
    pub enum Action {
        /// To the left.
        Left,
        /// No acceleration.
        Coast,
        /// To the right.
        Right,
    }
}

/// The state of the car.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Position along the valley.
    pub position: f64,
    /// Velocity per step.
    pub velocity: f64,
    /// Whether no step was taken since the reset.
    #[serde(default)]
    pub fresh: bool,
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct MountainCarDynamics {
    config: Config,
    /// The arguments of the constructor, from which the spaces follow.
    built: Config,
    constants: Compared<Constants<f64>>,
}

gym_core::constants! {
    /// The constants of the equations, under the names of the arguments.
    pub struct Constants {
        goal_velocity,
        min_position,
        max_position,
        max_speed,
        goal_position,
        force,
        gravity,
    }
}

impl Constants<f64> {
    /// The constants that follow from the arguments.
    const fn of(config: &Config) -> Self {
        Self {
            goal_velocity: config.goal_velocity,
            min_position: config.min_position,
            max_position: config.max_position,
            max_speed: config.max_speed,
            goal_position: config.goal_position,
            force: config.force,
            gravity: config.gravity,
        }
    }
}

impl Equations for MountainCarDynamics {
    type Numbers = [f64; 2];
    type Input = [f64; 1];
    type Constants = Constants<f64>;

    const DEFAULTS: Option<Constants<f64>> = Some(Constants::of(&Config::DEFAULT));

    #[inline(always)]
    fn constants(&self) -> Compared<Constants<f64>> {
        self.constants
    }

    #[inline(always)]
    fn pack(&self, state: &State) -> [f64; 2] {
        [state.position, state.velocity]
    }

    #[inline(always)]
    fn unpack(&self, [position, velocity]: [f64; 2], fresh: bool) -> State {
        State {
            position,
            velocity,
            fresh,
        }
    }

    /// Returns the direction of the acceleration.
    #[inline(always)]
    fn encode(&self, action: Action) -> [f64; 1] {
        [f64::from(action as i8 - 1)]
    }

    /// The equations of motion.
    #[inline(always)]
    fn step<R: Real>(
        &self,
        constants: Constants<R>,
        [position, velocity]: [R; 2],
        [push]: [R; 1],
    ) -> Next<R, Self> {
        let Constants {
            goal_velocity,
            min_position,
            max_position,
            max_speed,
            goal_position,
            force,
            gravity,
        } = constants;
        let velocity = velocity + (push * force + (position * 3.0).cos() * -gravity);
        let velocity = clip(velocity, -max_speed, max_speed);
        let position = clip(position + velocity, min_position, max_position);
        let zero = velocity.same(0.0);
        let velocity = R::select(
            equal(position, min_position) & velocity.lt(zero),
            zero,
            velocity,
        );
        let terminated = goal_position.le(position) & goal_velocity.le(velocity);
        let numbers = [position, velocity];
        Next {
            numbers,
            reward: velocity.same(-1.0),
            terminated,
            observation: numbers,
        }
    }

    #[inline(always)]
    fn observe(&self, state: &State) -> [f32; 2] {
        self.pack(state).map(|x| x as f32)
    }
}

impl Task for MountainCarDynamics {
    type Config = Config;
    type State = State;
    type Observation = [f32; 2];
    type Action = Action;

    const NAME: &'static str = "MountainCar";

    fn new(config: Config) -> Result<Self> {
        let Config {
            goal_velocity,
            min_position,
            max_position,
            max_speed,
            goal_position,
            force,
            gravity,
        } = config;
        check_valley(Self::NAME, goal_velocity, [min_position, max_position])?;
        constants::finite(
            Self::NAME,
            [
                ("goal_position", goal_position),
                ("force", force),
                ("gravity", gravity),
            ],
        )?;
        constants::limits(Self::NAME, [("max_speed", max_speed)])?;
        Ok(Self {
            config,
            built: config,
            constants: Compared::new(Constants::of(&config), Self::DEFAULTS),
        })
    }

    fn check_start(&self) -> Result<()> {
        check_start(
            Self::NAME,
            [self.config.min_position, self.config.max_position],
        )
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
        valley(
            self.built.min_position,
            self.built.max_position,
            self.built.max_speed,
        )
    }

    fn action_space(&self) -> Space {
        Action::space()
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
        draw(
            state.position,
            false,
            [min_position, max_position],
            goal_position,
            canvas,
        );
    }
}

/// Refuses a valley that does not contain every start of an episode, from -0.6 to -0.4.
pub(crate) fn check_start(env: &str, [low, high]: [f64; 2]) -> Result<()> {
    if low > -0.6 || high < -0.4 {
        let reason = format!(
            "min_position is {low:?} and max_position {high:?}: episodes start between -0.6 and -0.4, which must lie between the two"
        );
        return Err(Error::argument(env, reason));
    }
    Ok(())
}

/// Returns the observation space of both mountain cars.
pub(crate) fn valley(min_position: f64, max_position: f64, max_speed: f64) -> Space {
    Space::boxed(
        [min_position as f32, -max_speed as f32],
        [max_position as f32, max_speed as f32],
    )
}

/// Checks the arguments that both mountain cars share.
pub(crate) fn check_valley(env: &str, goal_velocity: f64, [low, high]: [f64; 2]) -> Result<()> {
    constants::finite(env, [("min_position", low), ("max_position", high)])?;
    if goal_velocity.is_nan() {
        return Err(Error::argument(
            env,
            "goal_velocity is NaN: it must be a number",
        ));
    }
    if low >= high {
        let reason =
            format!("min_position is {low:?}: it must be less than max_position, {high:?}");
        return Err(Error::argument(env, reason));
    }
    Ok(())
}

/// Limits `x` as `np.clip` does.
#[inline(always)]
pub(crate) fn clip<R: Real>(x: R, low: R, high: R) -> R {
    let x = R::select(x.lt(low), low, x);
    R::select(x.gt(high), high, x)
}

/// Compares as Python's `==` does.
#[inline(always)]
pub(crate) fn equal<R: Real>(x: R, y: R) -> R::Mask {
    x.le(y) & y.le(x)
}

/// Draws the valley, the car and the flag of both mountain cars. If `is_single`, the position is
/// `float32`, and numpy computes the car's place in `float32`.
pub(crate) fn draw(
    position: f64,
    is_single: bool,
    [min_position, max_position]: [f64; 2],
    goal_position: f64,
    canvas: &mut dyn Canvas,
) {
    const CLEARANCE: f64 = 10.0; // of the car above the ground
    const CAR: [f64; 2] = [40.0, 20.0];
    const WHEEL_RADIUS: f64 = CAR[1] / 2.5;
    const POINTS: usize = 100;
    let scale = 600.0 / (max_position - min_position); // pixels per unit
    let height = |x: f64| sin(3.0 * x) * 0.45 + 0.55;
    let pixel = |x: f64| [(x - min_position) * scale, height(x) * scale];
    // converts a number of the car to its precision
    let number = |x: f64| if is_single { f64::from(x as f32) } else { x };
    let angle = number(3.0 * position);
    let sin = if is_single {
        f64::from(numpy_sin_cos_f32(angle as f32).0)
    } else {
        sin(angle)
    };
    let car_height = number(number(sin * number(0.45)) + number(0.55));
    let car_pixel =
        [number(position - number(min_position)), car_height].map(|x| number(x * number(scale)));

    canvas.clear(Color::WHITE);
    canvas.push(pygame::flipped(400.0));
    // as numpy's linspace
    let step = (max_position - min_position) / (POINTS - 1) as f64;
    let hill: [Point; POINTS] = std::array::from_fn(|i| {
        pixel(if i == POINTS - 1 {
            max_position
        } else {
            i as f64 * step + min_position
        })
    });
    canvas.pygame(
        Primitive::AaLines {
            points: &hill,
            closed: false,
        },
        Color::BLACK,
    );

    // Gymnasium rotates the car by the cosine of `angle`, which is close to the slope's angle
    let turn = cos(angle);
    let place = |point: Point| {
        let ([x, y], [left, bottom]) = (pygame::rotate_rad(point, turn), car_pixel);
        [number(x) + left, number(y + CLEARANCE) + bottom].map(number)
    };
    let car = pygame::corners([-CAR[0] / 2.0, 0.0], [CAR[0] / 2.0, CAR[1]]).map(place);
    pygame::gfx_polygon(canvas, &car, Color::BLACK);
    for wheel in [CAR[0] / 4.0, -CAR[0] / 4.0] {
        pygame::gfx_circle(
            canvas,
            place([wheel, 0.0]),
            WHEEL_RADIUS,
            Color::rgb(128, 128, 128),
        );
    }

    let [x, bottom] = pixel(goal_position).map(f64::trunc);
    let top = bottom + 50.0;
    canvas.pygame(
        Primitive::VLine {
            x,
            y1: bottom,
            y2: top,
        },
        Color::BLACK,
    );
    let flag = [[x, top], [x, top - 10.0], [x + 25.0, top - 5.0]];
    pygame::gfx_polygon(canvas, &flag, Color::rgb(204, 204, 0));
    canvas.pop();
}

gym_core::register!(
    Registration::new::<MountainCar>("MountainCar-v0")
        .description("Drive an underpowered car out of a valley by rocking.")
        .max_episode_steps(200)
        .reward_threshold(-110.0)
        .reset_options(&[("low", "-0.55"), ("high", "-0.45")])
        .exceptions(reset::EXCEPTIONS)
        .vector_entry_point(gym_native::entry_point::<MountainCarDynamics>)
        .light_step()
        .names(|_| Names::new(&["position", "velocity (per step)"], &[]))
        .actions(Action::VARIANTS)
        .keys(|_| Keys::new(json!({"Left": 0, "Right": 2})).idle(json!(1)))
        .policy(Policy::rules(
            "drives right while the velocity lies between two curves over the position, else left",
            |_| reflex(policy::mountain_car),
        ))
        .clip(Clip {
            seeds: 0..1,
            every: 2,
            frames: 80,
            size: (300, 200)
        })
);
