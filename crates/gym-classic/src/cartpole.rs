//! CartPole: balance a pole on a cart by pushing the cart left or right.
//!
//! | | |
//! |---|---|
//! | observation | cart position (m), cart velocity (m/s), pole angle (rad), pole angular velocity (rad/s); `Box(4, float32)` |
//! | action | [`Action`]: push left or right with 10 N; `Discrete(2)` |
//! | reward | 1 per step, the last one included; see [`Config::sutton_barto_reward`] for the other choice |
//! | start | each number uniform in ±0.05; reset options `low`, `high` (numbers, -0.05 and 0.05) are other bounds |
//! | end | terminated when the cart leaves ±2.4 m or the pole leaves ±12° |
//! | limit | 500 steps (`CartPole-v0`: 200) |
//!
//! Versions: v1 raised the limit from 200 to 500 and the threshold from 195 to 475.
//!
//! The equations are those of Barto, Sutton and Anderson (1983), "Neuronlike adaptive elements that
//! can solve difficult learning control problems", in Florian's corrected form (2007); the order of
//! operations is that of Gymnasium 1.4.0, `envs/classic_control/cartpole.py`.

use gym_core::canvas::{Canvas, Color, Primitive};
use gym_core::math::Real;
use gym_core::render::Metadata;
use gym_core::vector::native::{self, Equations, Next};
use gym_core::{Generator, Registration, Reset, Result, Space, Stateful, Task, Transition, pygame};
use serde::{Deserialize, Serialize};

use crate::reset;

/// The environment.
pub type CartPole = Stateful<CartPoleDynamics>;

/// Arguments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Reward 0 for each step and -1 for the one that drops the pole, as in Sutton and Barto's
    /// book, instead of 1 for each step.
    pub sutton_barto_reward: bool,
}

const GRAVITY: f64 = 9.8; // m/s^2
const MASS_CART: f64 = 1.0; // kg
const MASS_POLE: f64 = 0.1; // kg
const TOTAL_MASS: f64 = MASS_POLE + MASS_CART;
const LENGTH: f64 = 0.5; // m, half the pole's
const POLEMASS_LENGTH: f64 = MASS_POLE * LENGTH;
const FORCE_MAG: f64 = 10.0; // N
const TAU: f64 = 0.02; // s between states
const THETA_THRESHOLD: f64 = 12.0 * 2.0 * std::f64::consts::PI / 360.0; // rad
const X_THRESHOLD: f64 = 2.4; // m

gym_core::discrete! {
    /// Which way to push the cart.
    pub enum Action {
        /// With 10 N to the left.
        Left,
        /// With 10 N to the right.
        Right,
    }
}

/// Cart and pole.
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
    /// Whether the episode has already terminated: steps beyond earn nothing.
    pub fallen: bool,
    /// Whether no step was taken yet. A start may lie anywhere, as reset options say.
    #[serde(default)]
    pub fresh: bool,
}

/// Whether an episode goes on with the cart and the pole there.
fn is_within(x: f64, theta: f64) -> bool {
    x.abs() <= X_THRESHOLD && theta.abs() <= THETA_THRESHOLD
}

/// The pure functions of the task.
#[derive(Clone, Copy, Debug)]
pub struct CartPoleDynamics {
    config: Config,
}

impl Equations for CartPoleDynamics {
    type Numbers = [f64; 4];
    type Input = [f64; 1];
    type Constants = [f64; 0];

    #[inline(always)]
    fn constants(&self) -> [f64; 0] {
        []
    }

    #[inline(always)]
    fn numbers(&self, state: &State) -> [f64; 4] {
        [state.x, state.x_dot, state.theta, state.theta_dot]
    }

    /// What lies beyond the thresholds ended its episode, and is not stepped again in a vector.
    #[inline(always)]
    fn state(&self, [x, x_dot, theta, theta_dot]: [f64; 4], fresh: bool) -> State {
        State { x, x_dot, theta, theta_dot, fallen: !fresh && !is_within(x, theta), fresh }
    }

    /// The force.
    #[inline(always)]
    fn input(&self, action: Action) -> [f64; 1] {
        [if action == Action::Right { FORCE_MAG } else { -FORCE_MAG }]
    }

    /// The equations of motion, for a pole that has not fallen.
    #[inline(always)]
    fn advance<R: Real>(
        &self,
        []: [R; 0],
        [x, x_dot, theta, theta_dot]: [R; 4],
        _fresh: R::Mask,
        [force]: [R; 1],
    ) -> Next<R, Self> {
        let (sintheta, costheta) = theta.sin_cos();

        let temp = (force + theta_dot * theta_dot * POLEMASS_LENGTH * sintheta) / TOTAL_MASS;
        let thetaacc = (sintheta * GRAVITY - costheta * temp)
            / ((-(costheta * costheta * MASS_POLE / TOTAL_MASS) + 4.0 / 3.0) * LENGTH);
        let xacc = temp - thetaacc * POLEMASS_LENGTH * costheta / TOTAL_MASS;

        // explicit Euler: positions move with the old velocities
        let x = x + x_dot * TAU;
        let theta = theta + theta_dot * TAU;
        let next = [x, x_dot + xacc * TAU, theta, theta_dot + thetaacc * TAU];
        let terminated = x.abs().gt(x.same(X_THRESHOLD)) | theta.abs().gt(x.same(THETA_THRESHOLD));
        let (dropped, held) = if self.config.sutton_barto_reward { (-1.0, 0.0) } else { (1.0, 1.0) };
        let reward = R::select(terminated, x.same(dropped), x.same(held));
        Next { state: next, reward, terminated, seen: next }
    }

    #[inline(always)]
    fn see<R: Real>(&self, state: [R; 4]) -> [R; 4] {
        state
    }

    /// A pole that has fallen before earns nothing more.
    #[inline(always)]
    fn finish(&self, before: &State, _action: Action, transition: &mut Transition<State>) {
        if before.fallen && transition.terminated && !self.config.sutton_barto_reward {
            transition.reward = 0.0; // the end of the episode was paid before
        }
        transition.state.fallen = before.fallen | transition.terminated;
    }
}

impl Task for CartPoleDynamics {
    type Config = Config;
    type State = State;
    type Observation = [f32; 4];
    type Action = Action;

    const NAME: &'static str = "CartPole";

    fn new(config: Config) -> Result<Self> {
        Ok(Self { config })
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn observation_space(&self) -> Space {
        // twice the thresholds, so that the last observation of an episode is still inside
        let high = [(X_THRESHOLD * 2.0) as f32, f32::INFINITY, (THETA_THRESHOLD * 2.0) as f32, f32::INFINITY];
        Space::boxed(high.map(|x| -x), high)
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, reset: &Reset, rng: &mut Generator) -> Result<State> {
        let (low, high) = reset::bounds(reset, Self::NAME, -0.05, 0.05)?;
        let [x, x_dot, theta, theta_dot] = [(); 4].map(|()| rng.uniform(low, high));
        Ok(State { x, x_dot, theta, theta_dot, fallen: false, fresh: true })
    }

    /// Between the start and the end of an episode cart and pole lie within the thresholds, as they did one step
    /// before, so that no velocity leads further than from one threshold to the other.
    fn is_valid(&self, state: &State) -> bool {
        const PUSH: f64 = 1.0; // more than one step adds to a velocity
        let State { x, x_dot, theta, theta_dot, fallen, fresh } = *state;
        let is_slow = x_dot.abs() <= 2.0 * X_THRESHOLD / TAU + PUSH
            && theta_dot.abs() <= 2.0 * THETA_THRESHOLD / TAU + PUSH;
        let is_running = is_within(x, theta) && is_slow;
        reset::plausible(&[x, x_dot, theta, theta_dot]) && (is_running || fallen || fresh)
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(50, (600, 400))
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        const SCALE: f64 = 600.0 / (2.0 * X_THRESHOLD); // pixels per m
        const POLE_LENGTH: f64 = SCALE * (2.0 * LENGTH);
        const POLE_WIDTH: f64 = 10.0;
        const CART: [f64; 2] = [50.0, 30.0];
        const CART_Y: f64 = 100.0;
        const AXLE: f64 = CART[1] / 4.0; // above the middle of the cart

        canvas.clear(Color::WHITE);
        canvas.push(pygame::flipped(400.0));
        let cart_x = state.x * SCALE + 300.0;
        let [width, height] = CART.map(|side| side / 2.0);
        let cart = pygame::corners([-width, -height], [width, height]).map(|[x, y]| [x + cart_x, y + CART_Y]);
        pygame::gfx_polygon(canvas, &cart, Color::BLACK);
        let half = POLE_WIDTH / 2.0;
        let pole = pygame::corners([-half, -half], [half, POLE_LENGTH - half]).map(|corner| {
            let [x, y] = pygame::rotate_rad(corner, -state.theta);
            [x + cart_x, y + CART_Y + AXLE]
        });
        pygame::gfx_polygon(canvas, &pole, Color::rgb(202, 152, 101));
        pygame::gfx_circle(canvas, [cart_x, CART_Y + AXLE], half, Color::rgb(129, 132, 203));
        canvas.pygame(Primitive::HLine { x1: 0.0, x2: 600.0, y: CART_Y }, Color::BLACK);
        canvas.pop();
    }
}

gym_core::register!(
    Registration::new::<CartPole>("CartPole-v0")
        .description("Balance a pole on a cart.")
        .max_episode_steps(200)
        .reward_threshold(195.0)
        .reset_options(&[("low", "-0.025"), ("high", "0.025")])
        .vector_entry_point(native::entry_point::<CartPoleDynamics>)
);
gym_core::register!(
    Registration::new::<CartPole>("CartPole-v1")
        .description("Balance a pole on a cart.")
        .max_episode_steps(500)
        .reward_threshold(475.0)
        .reset_options(&[("low", "-0.025"), ("high", "0.025")])
        .vector_entry_point(native::entry_point::<CartPoleDynamics>)
);

#[cfg(test)]
mod tests {
    use gym_core::{Env, EnvExt};

    use super::*;

    /// Pushes right until the pole falls, and once more.
    fn rewards(config: Config) -> Vec<f64> {
        let mut env = CartPole::new(config).unwrap();
        env.reset(0).unwrap();
        let mut rewards = Vec::new();
        while !env.state().unwrap().fallen {
            rewards.push(env.step(&Action::Right).unwrap().reward);
        }
        rewards.push(env.step(&Action::Right).unwrap().reward);
        rewards.drain(..rewards.len() - 3);
        rewards
    }

    #[test]
    fn only_what_an_episode_reaches_is_restored() {
        let mut env = CartPole::new(Config::default()).unwrap();
        env.reset(0).unwrap();
        env.step(&Action::Left).unwrap();
        let stored = serde_json::to_value(env.snapshot().unwrap()).unwrap();
        let mut with = |name: &str, value: f64| {
            let mut stored = stored.clone();
            stored["episode"]["state"][name] = value.into();
            env.restore(&serde_json::from_value(stored).unwrap())
        };
        with("theta", THETA_THRESHOLD).unwrap();
        with("x", -X_THRESHOLD).unwrap();
        for (name, value) in
            [("theta", 0.9), ("theta", -0.21), ("x", 2.41), ("x_dot", 300.0), ("theta_dot", -1000.0)]
        {
            assert!(with(name, value).unwrap_err().to_string().contains("not a state of this CartPole"));
        }
    }

    #[test]
    fn what_starts_and_ends_beyond_the_thresholds_is_stored_and_restored() {
        let mut env = CartPole::new(Config::default()).unwrap();
        env.reset(Reset::seed(0).option("low", 0.8).option("high", 0.9)).unwrap();
        let start = env.snapshot().unwrap();
        assert!(env.step(&Action::Left).unwrap().terminated);
        let end = env.snapshot().unwrap();
        for snapshot in [start, end] {
            env.restore(&snapshot).unwrap();
            assert_eq!(env.snapshot().unwrap(), snapshot);
        }
    }

    #[test]
    fn the_last_step_counts_and_none_beyond() {
        assert_eq!(rewards(Config::default()), [1.0, 1.0, 0.0]);
        assert_eq!(rewards(Config { sutton_barto_reward: true }), [0.0, -1.0, -1.0]);
    }
}
