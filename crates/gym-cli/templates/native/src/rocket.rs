//! Rocket: touch down softly, with as little fuel as possible.
//!
//! | | |
//! |---|---|
//! | observation | height (m), velocity (m/s); `Box(2, float32)` |
//! | action | [`Action`]: fall, or fire the engine; `Discrete(2)` |
//! | reward | -0.01 for each step with the engine on; at the ground, the velocity |
//! | start | height uniform from 8 to 12 m, at rest |
//! | end | terminated at the ground |
//! | limit | 500 steps |

use gym_core::canvas::{Canvas, Color};
use gym_core::keys::json;
use gym_core::math::Real;
use gym_core::render::Metadata;
use gym_core::{Error, Generator, Keys, Names, Registration, Reset, Result, Space, Stateful, Task};
use gym_native::{Compared, Equations, Next};
use serde::{Deserialize, Serialize};

/// The environment.
pub type Rocket = Stateful<RocketTask>;

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub struct Config {
        /// Acceleration of gravity.
        #[unit = "m/s²"]
        pub gravity: f64 = 9.8,
        /// Acceleration by the engine.
        #[unit = "m/s²"]
        pub thrust: f64 = 15.0,
        /// The duration of a step.
        #[unit = "s"]
        pub dt: f64 = 0.05,
    }
}

gym_core::discrete! {
    /// Whether to fire the engine.
    pub enum Action {
        /// Fall.
        Off,
        /// Fire.
        On,
    }
}

/// The state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Height above the ground, in m.
    pub height: f64,
    /// Velocity upwards, in m/s.
    pub velocity: f64,
}

/// The task.
#[derive(Clone, Copy, Debug)]
pub struct RocketTask {
    config: Config,
    constants: Compared<Constants<f64>>,
}

/// The task.
impl Task for RocketTask {
    type Config = Config;
    type State = State;
    type Observation = [f32; 2];
    type Action = Action;

    const NAME: &'static str = "Rocket";

    fn new(config: Config) -> Result<Self> {
        let Config { gravity, thrust, dt } = config;
        if !(0.0..=100.0).contains(&gravity) || !(0.0..=100.0).contains(&thrust) || !(0.001..=1.0).contains(&dt) {
            let reason = "gravity and thrust must lie between 0 and 100, and dt between 0.001 and 1";
            return Err(Error::argument(Self::NAME, reason));
        }
        let constants = Compared::new(Constants { gravity, thrust, dt }, Self::DEFAULTS);
        Ok(Self { config, constants })
    }

    fn config(&self) -> &Config {
        &self.config
    }

    fn observation_space(&self) -> Space {
        Space::boxed([f32::NEG_INFINITY; 2], [f32::INFINITY; 2])
    }

    fn action_space(&self) -> Space {
        Action::space()
    }

    fn start(&self, _reset: &Reset, rng: &mut Generator) -> Result<State> {
        Ok(State { height: rng.uniform(8.0, 12.0), velocity: 0.0 })
    }

    fn is_valid(&self, state: &State) -> bool {
        state.height.abs() < 1e6 && state.velocity.abs() < 1e6
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(20, (200, 400))
    }

    fn draw(&self, state: &State, canvas: &mut dyn Canvas) {
        canvas.clear(Color::rgb(24, 28, 52));
        canvas.rect([0.0, 380.0], [200.0, 20.0], Color::rgb(120, 126, 140));
        let bottom = 380.0 - 25.0 * state.height.clamp(0.0, 15.0);
        canvas.rect([92.0, bottom - 40.0], [16.0, 40.0], Color::WHITE);
    }
}

gym_core::constants! {
    /// The constants of the formula.
    pub struct Constants {
        gravity,
        thrust,
        dt,
    }
}

/// A step as a formula, for one environment, and for as many environments as a vector register
/// holds.
impl Equations for RocketTask {
    type Numbers = [f64; 2];
    type Input = [f64; 1];
    type Constants = Constants<f64>;

    #[inline(always)]
    fn constants(&self) -> Compared<Constants<f64>> {
        self.constants
    }

    #[inline(always)]
    fn pack(&self, state: &State) -> [f64; 2] {
        [state.height, state.velocity]
    }

    #[inline(always)]
    fn unpack(&self, [height, velocity]: [f64; 2], _fresh: bool) -> State {
        State { height, velocity }
    }

    #[inline(always)]
    fn encode(&self, action: Action) -> [f64; 1] {
        [if action == Action::On { 1.0 } else { 0.0 }]
    }

    #[inline(always)]
    fn step<R: Real>(
        &self,
        Constants { gravity, thrust, dt }: Constants<R>,
        [height, velocity]: [R; 2],
        [engine]: [R; 1],
    ) -> Next<R, Self> {
        let velocity = velocity + (engine * thrust - gravity) * dt;
        let height = height + velocity * dt;
        let zero = height.same(0.0);
        let terminated = height.le(zero);
        // `select` instead of `if`, because the environments of a register may differ
        let reward = R::select(terminated, velocity, zero) - engine * 0.01;
        let numbers = [height, velocity];
        Next { numbers, reward, terminated, observation: numbers }
    }

    fn observe(&self, state: &State) -> [f32; 2] {
        [state.height as f32, state.velocity as f32]
    }
}

gym_core::register!(
    Registration::new::<Rocket>("plugin_name/Rocket-v0")
        .description("Touch down softly, with as little fuel as possible.")
        .max_episode_steps(500)
        .names(|_| Names::new(&["height (m)", "velocity (m/s)"], &[]))
        // the keys of `cargo xtask play`; without this line, the keys are digits
        .keys(|_| Keys::new(json!({"Up": 1})).idle(json!(0)))
        .vector_entry_point(gym_native::entry_point::<RocketTask>)
);

#[cfg(test)]
mod tests {
    use gym_core::prelude::*;
    use gym_core::vector::VectorKind;

    #[test]
    fn native_vectors_equal_single_environments() {
        let make = |kind| {
            let envs = builder("plugin_name/Rocket-v0").vector(50).kind(kind);
            envs.arg_each("gravity", (0..50).map(|i| f64::from(i) / 5.0).collect::<Vec<_>>()).build().unwrap()
        };
        let [mut native, mut sync] = [VectorKind::Native, VectorKind::Sync].map(make);
        let mut actions = native.action_sampler(1).unwrap();
        assert_eq!(native.reset(7).unwrap(), sync.reset(7).unwrap());
        for _ in 0..300 {
            let actions = actions.sample();
            assert_eq!(native.step(&actions).unwrap(), sync.step(&actions).unwrap());
        }
    }
}
