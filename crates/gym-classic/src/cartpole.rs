//! CartPole: balance a pole on a cart by pushing the cart left or right.
//!
//! | | |
//! |---|---|
//! | observation | cart position (m), cart velocity (m/s), pole angle (rad), pole angular velocity (rad/s); `Box(4, float32)` |
//! | action | [`Action`]: push left or right; `Discrete(2)` |
//! | reward | 1 per step, the last one included; see [`Config::sutton_barto_reward`] for the other choice |
//! | start | each number uniform in ±0.05; reset options `low`, `high` (numbers, -0.05 and 0.05) are other bounds |
//! | end | terminated when the cart leaves ±[`Config::x_threshold`] or the pole ±[`Config::theta_threshold_radians`] |
//! | limit | 500 steps (`CartPole-v0`: 200) |
//!
//! Versions: v1 raised the limit from 200 to 500 and the threshold from 195 to 475.
//!
//! The equations are those of Barto, Sutton and Anderson (1983), "Neuronlike adaptive elements that
//! can solve difficult learning control problems", in Florian's corrected form (2007); the order of
//! operations is that of Gymnasium 1.4.0, `envs/classic_control/cartpole.py`.

use std::f64::consts::PI;

use gym_core::canvas::{Canvas, Color, Primitive};
use gym_core::keys::json;
use gym_core::math::Real;
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::{
    ArgumentType, Generator, Keys, Names, Policy, Registration, Reset, Result, Space, Stateful,
    Task, Transition, pygame,
};
use gym_native::{Compared, Equations, Next};
use serde::{Deserialize, Serialize};

use crate::{constants, policy, reset};

/// The environment.
pub type CartPole = Stateful<CartPoleDynamics>;

gym_core::arguments! {
    /// Arguments.
    ///
    /// Gymnasium computes `total_mass` and `polemass_length` only in its constructor: setting an
    /// attribute later, such as `masspole`, does not change them. Here they follow from the other
    /// arguments unless given.
    #[derive(Copy)]
    pub const struct Config {
        /// Whether the reward is 0 for each step and -1 for the step that drops the pole, as in
        /// Sutton and Barto's book, instead of 1 for each step.
        pub sutton_barto_reward: bool = false,
        /// Acceleration of gravity.
        #[unit = "m/s²"]
        pub gravity: f64 = 9.8,
        /// Mass of the cart.
        #[unit = "kg"]
        pub masscart: f64 = 1.0,
        /// Mass of the pole.
        #[unit = "kg"]
        pub masspole: f64 = 0.1,
        /// Mass of cart and pole: `masspole + masscart` unless given.
        #[unit = "kg"]
        pub total_mass: Option<f64> = None,
        /// Half the length of the pole.
        #[unit = "m"]
        pub length: f64 = 0.5,
        /// Mass times length of the pole: `masspole * length` unless given.
        #[unit = "kg m"]
        pub polemass_length: Option<f64> = None,
        /// The force of a push.
        #[unit = "N"]
        pub force_mag: f64 = 10.0,
        /// The duration of a step.
        #[unit = "s"]
        pub tau: f64 = 0.02,
        /// The integrator of a step.
        pub kinematics_integrator: Integrator = Integrator::Euler,
        /// The angle of the pole beyond which the episode ends.
        #[unit = "rad"]
        pub theta_threshold_radians: f64 = 12.0 * 2.0 * PI / 360.0,
        /// The position of the cart beyond which the episode ends.
        #[unit = "m"]
        pub x_threshold: f64 = 2.4,
    }
}

/// How a step integrates positions and velocities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Integrator {
    /// Positions change by the old velocities.
    #[default]
    #[serde(rename = "euler")]
    Euler,
    /// Positions change by the new velocities. In Gymnasium, any name except `euler` selects this.
    #[serde(rename = "semi-implicit euler")]
    SemiImplicitEuler,
}

impl ArgumentType for Integrator {
    fn kind() -> String {
        "string".into()
    }
}

gym_core::discrete! {
    /// The direction of the push.
    pub enum Action {
        /// To the left.
        Left,
        /// To the right.
        Right,
    }
}

/// The state of cart and pole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Position of the cart, in m.
    pub x: f64,
    /// Velocity of the cart, in m/s.
    pub x_dot: f64,
    /// Angle of the pole from upright, in rad, positive to the right.
    pub theta: f64,
    /// Angular velocity of the pole, in rad/s.
    pub theta_dot: f64,
    /// Whether the episode has already terminated: further steps have reward 0.
    pub fallen: bool,
    /// How many steps beyond the end also ended beyond a threshold.
    #[serde(default)]
    pub steps_beyond_terminated: u32,
    /// Whether no step was taken since the reset. Reset options allow any start.
    #[serde(default)]
    pub fresh: bool,
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct CartPoleDynamics {
    config: Config,
    /// The arguments of the constructor, from which the spaces follow.
    built: Config,
    constants: Compared<Constants<f64>>,
}

impl CartPoleDynamics {
    /// Whether the episode continues with the cart at `x` and the pole at `theta`.
    fn is_within(&self, x: f64, theta: f64) -> bool {
        x.abs() <= self.config.x_threshold && theta.abs() <= self.config.theta_threshold_radians
    }
}

gym_core::constants! {
    /// The constants of the equations, under the names of the arguments.
    pub struct Constants {
        gravity,
        masspole,
        total_mass,
        length,
        polemass_length,
        force_mag,
        tau,
        theta_threshold_radians,
        x_threshold,
    }
}

impl Constants<f64> {
    /// The constants that follow from the arguments.
    const fn of(config: &Config) -> Self {
        Self {
            gravity: config.gravity,
            masspole: config.masspole,
            total_mass: match config.total_mass {
                Some(total_mass) => total_mass,
                None => config.masspole + config.masscart,
            },
            length: config.length,
            polemass_length: match config.polemass_length {
                Some(polemass_length) => polemass_length,
                None => config.masspole * config.length,
            },
            force_mag: config.force_mag,
            tau: config.tau,
            theta_threshold_radians: config.theta_threshold_radians,
            x_threshold: config.x_threshold,
        }
    }
}

impl Equations for CartPoleDynamics {
    type Numbers = [f64; 4];
    type Input = [f64; 1];
    type Constants = Constants<f64>;

    const DEFAULTS: Option<Constants<f64>> = Some(Constants::of(&Config::DEFAULT));

    #[inline(always)]
    fn constants(&self) -> Compared<Constants<f64>> {
        self.constants
    }

    #[inline(always)]
    fn pack(&self, state: &State) -> [f64; 4] {
        [state.x, state.x_dot, state.theta, state.theta_dot]
    }

    /// Restores a state. A state beyond the thresholds is terminal; a vector does not step a
    /// terminal state.
    #[inline(always)]
    fn unpack(&self, [x, x_dot, theta, theta_dot]: [f64; 4], fresh: bool) -> State {
        State {
            x,
            x_dot,
            theta,
            theta_dot,
            fallen: !fresh && !self.is_within(x, theta),
            steps_beyond_terminated: 0,
            fresh,
        }
    }

    /// Returns the direction of the push, without a branch: with random actions, the CPU would
    /// mispredict half of them.
    #[inline(always)]
    fn encode(&self, action: Action) -> [f64; 1] {
        [f64::from(2 * action as i8 - 1)]
    }

    /// The equations of motion of a pole that has not fallen.
    #[inline(always)]
    fn step<R: Real>(
        &self,
        constants: Constants<R>,
        [x, x_dot, theta, theta_dot]: [R; 4],
        [push]: [R; 1],
    ) -> Next<R, Self> {
        let Constants {
            gravity,
            masspole,
            total_mass,
            length,
            polemass_length,
            force_mag,
            tau,
            theta_threshold_radians,
            x_threshold,
        } = constants;
        let force = push * force_mag;
        let (sintheta, costheta) = theta.sin_cos();

        let temp = (force + theta_dot * theta_dot * polemass_length * sintheta) / total_mass;
        let thetaacc = (sintheta * gravity - costheta * temp)
            / ((-(costheta * costheta * masspole / total_mass) + 4.0 / 3.0) * length);
        let xacc = temp - thetaacc * polemass_length * costheta / total_mass;

        let (new_x_dot, new_theta_dot) = (x_dot + xacc * tau, theta_dot + thetaacc * tau);
        let (x, theta) = match self.config.kinematics_integrator {
            Integrator::Euler => (x + x_dot * tau, theta + theta_dot * tau),
            Integrator::SemiImplicitEuler => (x + new_x_dot * tau, theta + new_theta_dot * tau),
        };
        let next = [x, new_x_dot, theta, new_theta_dot];
        let terminated = x.abs().gt(x_threshold) | theta.abs().gt(theta_threshold_radians);
        let (dropped, held) = if self.config.sutton_barto_reward {
            (-1.0, 0.0)
        } else {
            (1.0, 1.0)
        };
        let reward = R::select(terminated, x.same(dropped), x.same(held));
        Next {
            numbers: next,
            reward,
            terminated,
            observation: next,
        }
    }

    #[inline(always)]
    fn observe(&self, state: &State) -> [f32; 4] {
        self.pack(state).map(|x| x as f32)
    }

    /// Sets the reward to 0 once the pole has fallen.
    #[inline(always)]
    fn finish(&self, before: &State, _action: Action, transition: &mut Transition<State>) {
        let is_beyond = before.fallen && transition.terminated;
        if is_beyond && !self.config.sutton_barto_reward {
            transition.reward = 0.0; // the end of the episode was rewarded before
        }
        transition.state.fallen = before.fallen | transition.terminated;
        transition.state.steps_beyond_terminated =
            (before.steps_beyond_terminated).saturating_add(u32::from(is_beyond));
    }
}

/// The largest number of an initial state.
const START: f64 = 0.05;

impl Task for CartPoleDynamics {
    type Config = Config;
    type State = State;
    type Observation = [f32; 4];
    type Action = Action;

    const NAME: &'static str = "CartPole";

    fn new(config: Config) -> Result<Self> {
        let constants = Constants::of(&config);
        let Constants {
            gravity,
            masspole,
            total_mass,
            length,
            polemass_length,
            force_mag,
            tau,
            theta_threshold_radians,
            x_threshold,
        } = constants;
        constants::finite(
            Self::NAME,
            [
                ("gravity", gravity),
                ("masscart", config.masscart),
                ("masspole", masspole),
                ("polemass_length", polemass_length),
                ("force_mag", force_mag),
                ("tau", tau),
            ],
        )?;
        constants::divisors(Self::NAME, [("total_mass", total_mass), ("length", length)])?;
        constants::limits(
            Self::NAME,
            [
                ("theta_threshold_radians", theta_threshold_radians),
                ("x_threshold", x_threshold),
            ],
        )?;
        Ok(Self {
            config,
            built: config,
            constants: Compared::new(constants, Self::DEFAULTS),
        })
    }

    fn check_start(&self) -> Result<()> {
        let limits = [
            (
                "theta_threshold_radians",
                self.config.theta_threshold_radians,
            ),
            ("x_threshold", self.config.x_threshold),
        ];
        // the observation space has twice the thresholds
        constants::contains_starts(Self::NAME, limits, START / 2.0)
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn assign(&mut self, config: Config) -> Result<()> {
        let Constants {
            total_mass,
            polemass_length,
            ..
        } = self.constants.get();
        let config = Config {
            total_mass: config.total_mass.or(Some(total_mass)),
            polemass_length: config.polemass_length.or(Some(polemass_length)),
            ..config
        };
        *self = Self {
            built: self.built,
            ..Self::new(config)?
        };
        Ok(())
    }

    fn observation_space(&self) -> Space {
        // twice the thresholds, so that an episode's last observation is inside
        let [x, theta] =
            [self.built.x_threshold, self.built.theta_threshold_radians].map(|x| (x * 2.0) as f32);
        let high = [x, f32::INFINITY, theta, f32::INFINITY];
        Space::boxed(high.map(|x| -x), high)
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, reset: &Reset, rng: &mut Generator) -> Result<State> {
        let (low, high) = reset::bounds(reset, Self::NAME, -START, START)?;
        let [x, x_dot, theta, theta_dot] = [(); 4].map(|()| rng.uniform(low, high));
        Ok(State {
            x,
            x_dot,
            theta,
            theta_dot,
            fallen: false,
            steps_beyond_terminated: 0,
            fresh: true,
        })
    }

    /// With the default constants: during an episode, cart and pole are within the thresholds
    /// before and after a step, so no velocity exceeds the thresholds' distance per step.
    fn is_valid(&self, state: &State) -> bool {
        const PUSH: f64 = 1.0; // more than one step adds to a velocity
        let State {
            x,
            x_dot,
            theta,
            theta_dot,
            fallen,
            fresh,
            ..
        } = *state;
        let Config {
            tau,
            x_threshold,
            theta_threshold_radians,
            ..
        } = self.config;
        let is_slow = x_dot.abs() <= 2.0 * x_threshold / tau + PUSH
            && theta_dot.abs() <= 2.0 * theta_threshold_radians / tau + PUSH;
        let is_running = self.is_within(x, theta) && is_slow;
        !self.constants.are_defaults()
            || reset::plausible(&[x, x_dot, theta, theta_dot]) && (is_running || fallen || fresh)
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(50, (600, 400))
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        const POLE_WIDTH: f64 = 10.0;
        const CART: [f64; 2] = [50.0, 30.0];
        const CART_Y: f64 = 100.0;
        const AXLE: f64 = CART[1] / 4.0; // above the middle of the cart

        let scale = 600.0 / (self.config.x_threshold * 2.0); // pixels per m
        let pole_length = scale * (2.0 * self.config.length);
        canvas.clear(Color::WHITE);
        canvas.push(pygame::flipped(400.0));
        let cart_x = state.x * scale + 300.0;
        let [width, height] = CART.map(|side| side / 2.0);
        let cart = pygame::corners([-width, -height], [width, height])
            .map(|[x, y]| [x + cart_x, y + CART_Y]);
        pygame::gfx_polygon(canvas, &cart, Color::BLACK);
        let half = POLE_WIDTH / 2.0;
        let pole = pygame::corners([-half, -half], [half, pole_length - half]).map(|corner| {
            let [x, y] = pygame::rotate_rad(corner, -state.theta);
            [x + cart_x, y + CART_Y + AXLE]
        });
        pygame::gfx_polygon(canvas, &pole, Color::rgb(202, 152, 101));
        pygame::gfx_circle(
            canvas,
            [cart_x, CART_Y + AXLE],
            half,
            Color::rgb(129, 132, 203),
        );
        canvas.pygame(
            Primitive::HLine {
                x1: 0.0,
                x2: 600.0,
                y: CART_Y,
            },
            Color::BLACK,
        );
        canvas.pop();
    }
}

/// The registration shared by both versions.
const fn cartpole(id: &'static str) -> Registration {
    Registration::new::<CartPole>(id)
        .description("Balance a pole on a cart.")
        .reset_options(&[("low", "-0.025"), ("high", "0.025")])
        .exceptions(reset::EXCEPTIONS)
        .vector_entry_point(gym_native::entry_point::<CartPoleDynamics>)
        .light_step()
        .names(|_| {
            Names::new(
                &[
                    "cart position (m)",
                    "cart velocity (m/s)",
                    "pole angle (rad)",
                    "pole angular velocity (rad/s)",
                ],
                &[],
            )
        })
        .actions(Action::VARIANTS)
        .keys(|_| Keys::new(json!({"Left": 0, "Right": 1})).repeat())
        .policy(Policy::rules(
            "pushes to the side given by the sign of a weighted sum of the four numbers",
            |_| reflex(policy::cartpole),
        ))
}

gym_core::register!(
    cartpole("CartPole-v0")
        .max_episode_steps(200)
        .reward_threshold(195.0),
    cartpole("CartPole-v1")
        .max_episode_steps(500)
        .reward_threshold(475.0)
        .clip(Clip {
            seeds: 3..4,
            every: 3,
            frames: 60,
            size: (300, 200)
        }),
);
