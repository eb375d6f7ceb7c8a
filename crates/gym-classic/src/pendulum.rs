//! Pendulum: swing a pendulum up and hold it there.
//!
//! | | |
//! |---|---|
//! | observation | cosine and sine of the angle, angular velocity in ±8 rad/s; `Box(3, float32)` |
//! | action | torque in [-2, 2] N m, clipped beyond; `Box(1, float32)` |
//! | reward | -(angle² + 0.1 velocity² + 0.001 torque²), between -16.27 and 0, of the state before the step |
//! | start | angle uniform in ±π, velocity uniform in ±1; reset options `x_init`, `y_init` (numbers, π and 1) are other bounds of angle and velocity |
//! | end | never |
//! | limit | 200 steps |
//!
//! The angle is 0 upright and grows counterclockwise. The order of operations is that of Gymnasium
//! 1.4.0, `envs/classic_control/pendulum.py`, with numpy 2: products of a torque that comes
//! as `float32` are `float32`.

use std::f64::consts::PI;

use gym_core::canvas::{Canvas, Color, Point, arc};
use gym_core::keys::json;
use gym_core::math::{Real, sin, sin_cos, square};
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::{
    Continuous, Generator, Keys, Names, Policy, Precision, Registration, Reset, Result, Space,
    Stateful, Task, Transition, pygame,
};
use gym_native::{Compared, Equations, Next};
use serde::{Deserialize, Serialize};

use crate::mountain_car::clip;
use crate::{constants, policy, reset};

/// The environment.
pub type Pendulum = Stateful<PendulumDynamics>;

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub const struct Config {
        /// Acceleration of gravity.
        #[unit = "m/s²"]
        pub g: f64 = 10.0,
        /// Mass of the rod.
        #[unit = "kg"]
        pub m: f64 = 1.0,
        /// Length of the rod.
        #[unit = "m"]
        pub l: f64 = 1.0,
        /// The largest angular velocity.
        #[unit = "rad/s"]
        pub max_speed: f64 = 8.0,
        /// The largest torque.
        #[unit = "N m"]
        pub max_torque: f64 = 2.0,
        /// The duration of a step.
        #[unit = "s"]
        pub dt: f64 = 0.05,
    }
}

/// The state of the pendulum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Angle from upright, in rad, not wrapped.
    pub theta: f64,
    /// Angular velocity, in rad/s.
    pub theta_dot: f64,
    /// The last clipped torque, for drawing.
    #[serde(deserialize_with = "Option::deserialize")]
    pub last_torque: Option<f32>,
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct PendulumDynamics {
    config: Config,
    /// The arguments of the constructor, from which the spaces follow.
    built: Config,
    constants: Compared<Constants<f64>>,
}

/// Reset options: the bounds of the initial state.
#[derive(Default, Deserialize)]
struct Start {
    #[serde(default, deserialize_with = "reset::number")]
    x_init: Option<f64>,
    #[serde(default, deserialize_with = "reset::number")]
    y_init: Option<f64>,
}

gym_core::constants! {
    /// The constants of the equation.
    pub struct Constants {
        /// The angular acceleration by gravity, over the sine of the angle.
        per_sin,
        /// The angular acceleration by a torque of 1.
        per_torque,
        max_speed,
        max_torque,
        dt,
    }
}

impl Constants<f64> {
    /// The constants that follow from the arguments; `l_2` is the square of the length.
    const fn of(config: &Config, l_2: f64) -> Self {
        Self {
            per_sin: 3.0 * config.g / (2.0 * config.l),
            per_torque: 3.0 / (config.m * l_2),
            max_speed: config.max_speed,
            max_torque: config.max_torque,
            dt: config.dt,
        }
    }
}

/// Returns the cost of a torque, and its angular acceleration. If `SINGLE`, numpy computes both in
/// `float32`.
#[inline(always)]
fn effects<R: Real, const SINGLE: bool>(torque: R, per_torque: R, max_torque: R) -> [R; 2] {
    let rounded = |x: R| if SINGLE { x.single() } else { x };
    let max_torque = rounded(max_torque);
    let u = clip(torque, -max_torque, max_torque);
    let effort = if SINGLE {
        (u.square_f32() * f64::from(0.001f32)).single()
    } else {
        u.square() * 0.001
    };
    [effort, rounded(u * rounded(per_torque))]
}

impl Equations for PendulumDynamics {
    type Numbers = [f64; 3];
    type Input = [f64; 2];
    type Constants = Constants<f64>;

    const DEFAULTS: Option<Constants<f64>> = Some(Constants::of(&Config::DEFAULT, 1.0));

    #[inline(always)]
    fn constants(&self) -> Compared<Constants<f64>> {
        self.constants
    }

    /// The third number is the sine of the angle, which the observation and the next step share.
    #[inline(always)]
    fn pack(&self, state: &State) -> [f64; 3] {
        [state.theta, state.theta_dot, sin(state.theta)]
    }

    #[inline(always)]
    fn unpack(&self, [theta, theta_dot, _]: [f64; 3], _fresh: bool) -> State {
        State {
            theta,
            theta_dot,
            last_torque: None,
        }
    }

    /// Returns the torque, and 1 if numpy computes products with the torque in `float64`, which
    /// numpy does not for `float32` arrays.
    #[inline(always)]
    fn encode(
        &self,
        Continuous {
            numbers: [torque],
            precision,
        }: Continuous<1>,
    ) -> [f64; 2] {
        [torque, f64::from(u8::from(precision != Precision::Single))]
    }

    /// The equation of motion, for a torque of any size.
    #[inline(always)]
    fn step<R: Real>(
        &self,
        constants: Constants<R>,
        [theta, theta_dot, sin]: [R; 3],
        [torque, is_double]: [R; 2],
    ) -> Next<R, Self> {
        let Constants {
            per_sin,
            per_torque,
            max_speed,
            max_torque,
            dt,
        } = constants;
        let single = is_double.lt(is_double.same(1.0));
        let [effort, push] = if R::all(single) {
            effects::<R, true>(torque, per_torque, max_torque)
        } else {
            let singles = effects::<R, true>(torque, per_torque, max_torque);
            let doubles = effects::<R, false>(torque, per_torque, max_torque);
            [
                R::select(single, singles[0], doubles[0]),
                R::select(single, singles[1], doubles[1]),
            ]
        };
        let angle = (theta + PI).modulo(2.0 * PI) - PI;
        let costs = angle.square() + theta_dot.square() * 0.1 + effort;

        let pull = sin * per_sin;
        let theta_dot = clip(theta_dot + (pull + push) * dt, -max_speed, max_speed);
        let theta = theta + theta_dot * dt;
        let terminated = theta.lt(theta) & theta.lt(theta);
        let (sin, cos) = theta.sin_cos();
        Next {
            numbers: [theta, theta_dot, sin],
            reward: -costs,
            terminated,
            observation: [cos, sin, theta_dot],
        }
    }

    #[inline(always)]
    fn observe(&self, state: &State) -> [f32; 3] {
        let (sin, cos) = sin_cos(state.theta);
        [cos, sin, state.theta_dot].map(|x| x as f32)
    }

    #[inline(always)]
    fn finish(&self, _before: &State, action: Continuous<1>, transition: &mut Transition<State>) {
        let [torque] = action.numbers.map(|torque| torque as f32);
        transition.state.last_torque = Some(
            torque
                .max(-self.config.max_torque as f32)
                .min(self.config.max_torque as f32),
        );
    }
}

/// The largest speed at the start of an episode, in rad/s.
const START_SPEED: f64 = 1.0;

impl Task for PendulumDynamics {
    type Config = Config;
    type State = State;
    type Observation = [f32; 3];
    type Action = Continuous<1>;

    const NAME: &'static str = "Pendulum";

    fn new(config: Config) -> Result<Self> {
        let Config {
            g,
            m,
            l,
            max_speed,
            max_torque,
            dt,
        } = config;
        constants::finite(Self::NAME, [("g", g), ("dt", dt)])?;
        constants::divisors(Self::NAME, [("m", m), ("l", l)])?;
        constants::limits(
            Self::NAME,
            [("max_speed", max_speed), ("max_torque", max_torque)],
        )?;
        let constants = Constants::of(&config, square(l));
        Ok(Self {
            config,
            built: config,
            constants: Compared::new(constants, Self::DEFAULTS),
        })
    }

    fn check_start(&self) -> Result<()> {
        constants::contains_starts(
            Self::NAME,
            [("max_speed", self.config.max_speed)],
            START_SPEED,
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
        let high = [1.0, 1.0, self.built.max_speed as f32];
        Space::boxed(high.map(|x| -x), high)
    }

    fn action_space(&self) -> Space {
        let high = self.built.max_torque as f32;
        Space::boxed([-high], [high])
    }

    fn start(&self, reset: &Reset, rng: &mut Generator) -> Result<State> {
        let Start { x_init, y_init } = if reset.options.is_empty() {
            Start::default()
        } else {
            reset.options(Self::NAME)?
        };
        let x = reset::check_bound(Self::NAME, "x_init", x_init.unwrap_or(PI))?;
        let y = reset::check_bound(Self::NAME, "y_init", y_init.unwrap_or(START_SPEED))?;
        Ok(State {
            theta: rng.uniform(-x, x),
            theta_dot: rng.uniform(-y, y),
            last_torque: None,
        })
    }

    fn is_valid(&self, state: &State) -> bool {
        state.last_torque.is_none_or(f32::is_finite)
            && (!self.constants.are_defaults() || reset::plausible(&[state.theta, state.theta_dot]))
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(30, (500, 500))
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        const SCALE: f64 = 500.0 / 4.4; // pixels per m
        const ROD_WIDTH: f64 = 0.2 * SCALE;
        const ROD: Color = Color::rgb(204, 77, 77);

        canvas.clear(Color::WHITE);
        canvas.push(pygame::flipped(500.0));
        let place =
            |point: Point| pygame::rotate_rad(point, state.theta + PI / 2.0).map(|x| x + MIDDLE);
        let rod = pygame::corners([0.0, -ROD_WIDTH / 2.0], [SCALE, ROD_WIDTH / 2.0]).map(place);
        pygame::gfx_polygon(canvas, &rod, ROD);
        pygame::gfx_circle(canvas, [MIDDLE; 2], ROD_WIDTH / 2.0, ROD);
        pygame::gfx_circle(canvas, place([SCALE, 0.0]), ROD_WIDTH / 2.0, ROD);
        if let Some(torque) = state.last_torque {
            draw_torque(f64::from(torque), SCALE, canvas);
        }
        pygame::gfx_circle(canvas, [MIDDLE; 2], 0.05 * SCALE, Color::BLACK);
        canvas.pop();
    }
}

/// The coordinate of the axle, horizontally and vertically.
const MIDDLE: f64 = 250.0;

/// Draws an arrow around the axle with the torque's magnitude and direction. Gymnasium loads an
/// image; this arrow has the image's size and place.
fn draw_torque(torque: f64, scale: f64, canvas: &mut dyn Canvas) {
    // the sizes are for a radius of 1. As in Gymnasium, the arrow is not quite circular and not
    // centred on the axle.
    const WIDTH: f64 = 0.065; // of the line
    const WIDE: f64 = 0.973;
    const HIGH: f64 = 1.034;
    const SHIFT: f64 = 0.064;
    const HEAD: [Point; 4] = [[0.77, -0.1], [0.91, -0.02], [1.05, -0.1], [0.91, 0.3]];
    const POINTS: usize = 33;
    let size = 0.94 * scale * torque.abs() / 4.0; // in Gymnasium the whole image is twice as wide
    if size < 1.0 {
        return;
    }
    // the points are of a counterclockwise arrow; a negative torque mirrors the arrow
    let place = |[x, y]: Point| [x * size * torque.signum() + MIDDLE, y * size + MIDDLE];
    let edge =
        |radius| arc([0.0; 2], radius, -1.5 * PI, 0.0).map(|[x, y]| [WIDE * x - SHIFT, HIGH * y]);
    let (inner, outer): ([Point; POINTS], [Point; POINTS]) =
        (edge(1.0 - WIDTH / 2.0), edge(1.0 + WIDTH / 2.0));
    let ring: [Point; 2 * POINTS] = std::array::from_fn(|i| {
        place(
            outer
                .get(i)
                .copied()
                .unwrap_or_else(|| inner[2 * POINTS - 1 - i]),
        )
    });
    pygame::gfx_polygon(canvas, &ring, Color::BLACK);
    pygame::gfx_polygon(canvas, &HEAD.map(place), Color::BLACK);
}

gym_core::register!(
    Registration::new::<Pendulum>("Pendulum-v1")
        .description("Swing a pendulum up and hold it.")
        .max_episode_steps(200)
        .reset_options(&[("x_init", "0.5"), ("y_init", "0.5")])
        .vector_entry_point(gym_native::entry_point::<PendulumDynamics>)
        .light_step()
        .names(|_| Names::new(
            &[
                "cosine of the angle",
                "sine of the angle",
                "angular velocity (rad/s)"
            ],
            &["torque (N m)"]
        ))
        .keys(|_| {
            // a positive torque is counterclockwise
            Keys::new(json!({"Left": [2], "Right": [-2]})).idle(json!([0]))
        })
        .policy(Policy::rules(
            "adds energy until the pole is near the top, then holds it there with a PD controller",
            |_| reflex(policy::pendulum),
        ))
        .clip(Clip {
            seeds: 5..6,
            every: 2,
            frames: 80,
            size: (200, 200)
        })
);
