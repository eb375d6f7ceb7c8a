//! LunarLander: bring a craft down gently between two flags.
//!
//! | | |
//! |---|---|
//! | observation | position x, y of the craft from the middle of the pad (10 m, 6.67 m), velocity x, y (5 m/s, 7.5 m/s), angle from upright, counterclockwise (rad), angular velocity (2.5 rad/s), whether the left and the right leg touch the ground (0 or 1); `Box(8, float32)` |
//! | action | [`Action`]: one engine at a time, `Discrete(4)`, or with `continuous` two throttles, `Box(-1, 1, (2,), float32)`: the main engine is off up to 0 and goes from half to full power at 1; the left engine fires below -0.5, the right one above 0.5 |
//! | reward | the step's increase of a potential, which is higher near the pad, at low speed, upright and with legs on the ground; less 0.3 for the main engine and 0.03 for a side engine; -100 for a crash, +100 for coming to rest |
//! | start | top centre, with a random push; reset options: none |
//! | end | terminated when the hull touches the ground, or the craft leaves the picture at a side or comes to rest |
//! | limit | 1000 steps |
//!
//! Versions: v3 draws a new wind at each reset and widens the bounds of the observation; v2, which
//! Gymnasium has removed, draws its wind from a copy of the environment's generator; Gym drew it
//! from numpy's global one.
//!
//! The constants and the order of operations are those of Gymnasium 1.4.0,
//! `envs/box2d/lunar_lander.py`.

mod draw;
mod episode;
mod exhaust;
mod heuristic;

use std::f64::consts::PI;

use gym_core::canvas::Canvas;
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::vector::lockstep::Lockstep;
use gym_core::{
    Configure, Continuous, Element, Env, Error, Generator, Inspect, Keys, Names, Outcome, Policy,
    Registration, Reset, Result, Snapshot, Space, Value,
};
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};

use crate::physics::{BodyId, FixtureId, Physics, Place, World};
use crate::rapier;
use crate::settings;
use crate::worlds::{Ahead, Call, Worlds};
use exhaust::Exhaust;
pub use heuristic::heuristic;

const FPS: f64 = 50.0;
const SCALE: f64 = 30.0; // pixels per m
const VIEWPORT_W: f64 = 600.0;
const VIEWPORT_H: f64 = 400.0;
const W: f64 = VIEWPORT_W / SCALE; // m
const H: f64 = VIEWPORT_H / SCALE;
const MAIN_ENGINE_POWER: f64 = 13.0;
const SIDE_ENGINE_POWER: f64 = 0.6;
const INITIAL_RANDOM: f64 = 1000.0; // N, the largest push at the start
const LANDER_POLY: [[f64; 2]; 6] = [
    [-14.0, 17.0],
    [-17.0, 0.0],
    [-17.0, -10.0],
    [17.0, -10.0],
    [17.0, 0.0],
    [14.0, 17.0],
];
const LEG_AWAY: f64 = 20.0;
const LEG_DOWN: f64 = 18.0;
const LEG_W: f64 = 2.0;
const LEG_H: f64 = 8.0;
const LEG_SPRING_TORQUE: f32 = 40.0;
const SIDE_ENGINE_HEIGHT: f64 = 14.0;
const SIDE_ENGINE_AWAY: f64 = 12.0;
const MAIN_ENGINE_Y_LOCATION: f64 = 4.0;
const CHUNKS: usize = 11; // points of the ground
/// Height of the landing pad, in m.
pub const HELIPAD_Y: f64 = H / 4.0;

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub struct Config {
        /// Whether an action is two throttles instead of one engine.
        pub continuous: bool,
        /// Acceleration of gravity, between -12 and 0, both excluded.
        #[unit = "m/s²"]
        pub gravity: f64 = -10.0,
        /// Whether wind blows until a leg touches the ground.
        pub enable_wind: bool,
        /// The largest force of the wind; recommended are 0 to 20.
        #[unit = "N"]
        pub wind_power: f64 = 15.0,
        /// The largest torque of the wind; recommended are 0 to 2.
        #[unit = "N m"]
        pub turbulence_power: f64 = 1.5,
        /// The physics engine: `box2d` or `rapier`.
        pub physics: Physics,
    }
}

impl Config {
    /// Whether `action` is of the kind that `continuous` selects.
    fn takes(&self, action: &Action) -> bool {
        match action {
            Action::Fire(_) => !self.continuous,
            Action::Throttle(throttles) => self.continuous && throttles.is_finite(),
        }
    }
}

gym_core::discrete! {
    /// The engine that fires.
    pub enum Engine {
        /// No engine.
        Off,
        /// The left engine, which pushes to the right.
        Left,
        /// The main engine, which pushes up.
        Main,
        /// The right engine, which pushes to the left.
        Right,
    }
}

/// An action: the use of the engines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// One engine at full power, or none.
    Fire(Engine),
    /// With [`Config::continuous`]: main throttle, off up to 0, then from half to full power at 1;
    /// side throttle, left engine below -0.5, right engine above 0.5.
    Throttle(Continuous<2>),
}

impl From<Engine> for Action {
    fn from(engine: Engine) -> Self {
        Self::Fire(engine)
    }
}

impl From<[f32; 2]> for Action {
    fn from(throttles: [f32; 2]) -> Self {
        Self::Throttle(throttles.into())
    }
}

impl Element for Action {
    fn empty() -> Self {
        Self::Fire(Engine::Off)
    }

    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Int(_) => Engine::from_value(value).map(Self::Fire),
            _ => Element::from_value(value).map(Self::Throttle),
        }
    }

    fn write(&self, out: &mut Value) {
        match self {
            Self::Fire(engine) => engine.write(out),
            Self::Throttle(throttles) => throttles.write(out),
        }
    }
}

/// The environment.
#[derive(Clone, Debug)]
pub struct LunarLander {
    config: Config,
    version: u32,
    episode: Option<Episode>,
    /// Whether frames are rendered.
    renders: bool,
    ahead: Option<Ahead>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Episode {
    rng: Generator,
    world: World,
    lander: BodyId,
    legs: [BodyId; 2],
    /// The fixtures of lander and legs, to draw.
    fixtures: [FixtureId; 3],
    /// Heights of the ground, one per 2 m.
    smooth_y: [f64; CHUNKS],
    /// The positions of wind and turbulence in the pattern of gusts. `None` if the episode started
    /// without wind, until wind blows.
    #[serde(deserialize_with = "Option::deserialize")]
    wind_idx: Option<i64>,
    #[serde(deserialize_with = "Option::deserialize")]
    torque_idx: Option<i64>,
    /// Whether the hull has touched the ground.
    game_over: bool,
    ground_contact: [bool; 2],
    #[serde(deserialize_with = "Option::deserialize")]
    prev_shaping: Option<f64>,
    /// The particles of the engines' exhaust, which exist only while frames are rendered.
    #[serde(deserialize_with = "Option::deserialize")]
    exhaust: Option<Exhaust>,
    /// Main and side throttle of the current step.
    #[serde(skip)]
    throttles: [f64; 2],
}

/// Far above 20, Gymnasium's recommended maximum, and far below the overflow of `float32`.
const MAX_POWER: f64 = 1e6;

impl LunarLander {
    /// Makes the environment with the arguments `config`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a gravity out of range, or a power that is not finite.
    pub fn new(config: Config) -> Result<Self> {
        Self::with_version(config, 3)
    }

    /// Like [`new`](Self::new), with the rules of version 2 or 3.
    ///
    /// # Errors
    /// The errors of `new`; [`Error::InvalidArgument`] for a version below 2.
    pub fn with_version(config: Config, version: u32) -> Result<Self> {
        let version = settings::version("LunarLander", version)?;
        Self::check(&config)?;
        Ok(Self {
            config,
            version,
            episode: None,
            renders: false,
            ahead: None,
        })
    }

    fn check(config: &Config) -> Result<()> {
        if !(-12.0 < config.gravity && config.gravity < 0.0) {
            let reason = format!(
                "gravity is {}: it must lie between -12 and 0",
                config.gravity
            );
            return Err(Error::argument("LunarLander", reason));
        }
        for (name, value) in [
            ("wind_power", config.wind_power),
            ("turbulence_power", config.turbulence_power),
        ] {
            if !(-MAX_POWER..=MAX_POWER).contains(&value) {
                let reason =
                    format!("{name} is {value}: it must lie between -{MAX_POWER} and {MAX_POWER}");
                return Err(Error::argument("LunarLander", reason));
            }
        }
        Ok(())
    }

    /// The arguments.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Resets the environment and begins its first step, in which no engine fires.
    fn begin_episode(&mut self, reset: &Reset, worlds: Option<&mut Worlds>) -> Result<Place> {
        let rng = reset.generator(self.episode.as_ref().map(|episode| &episode.rng))?;
        let episode = self
            .episode
            .insert(Episode::new(&self.config, self.version, rng));
        episode.render(&self.config, self.renders);
        let idle = if self.config.continuous {
            Action::Throttle(Continuous::default())
        } else {
            Action::Fire(Engine::Off)
        };
        Ok(episode.begin(&self.config, &idle, worlds))
    }

    #[cfg(test)]
    pub(crate) fn world_bytes(&self) -> usize {
        self.episode
            .as_ref()
            .map_or(0, |episode| episode.world.bytes())
    }

    /// The heights of the ground, one per 2 m from the left, in m; `None` before the first reset.
    pub fn terrain(&self) -> Option<&[f64; CHUNKS]> {
        self.episode.as_ref().map(|episode| &episode.smooth_y)
    }
}

/// Returns the x coordinate of ground point `i`.
fn chunk_x(i: usize) -> f64 {
    W / (CHUNKS - 1) as f64 * i as f64
}

/// Wind changes at once, gravity at the next reset. `continuous` and `physics` are fixed.
impl Inspect for LunarLander {
    fn arguments(&self) -> Json {
        serde_json::to_value(self.config).unwrap_or_default()
    }

    fn set_argument(&mut self, name: &str, value: Json) -> Result<()> {
        let config = settings::assigned(&self.config, name, value, "LunarLander")?;
        Self::check(&config)?;
        self.config = config;
        Ok(())
    }
}

impl Env for LunarLander {
    type Observation = [f32; 8];
    type Action = Action;

    fn observation_space(&self) -> Space {
        let [position, velocity, angle] = if self.version == 2 {
            [1.5, 5.0, PI]
        } else {
            [2.5, 10.0, 2.0 * PI]
        };
        let high = [
            position, position, velocity, velocity, angle, velocity, 1.0, 1.0,
        ]
        .map(|x| x as f32);
        let mut low = high.map(|x| -x);
        low[6..].fill(-0.0);
        Space::boxed(low, high)
    }

    fn action_space(&self) -> Space {
        if self.config.continuous {
            Space::boxed([-1.0; 2], [1.0; 2])
        } else {
            Engine::space()
        }
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut [f32; 8]) -> Result<()> {
        if !Ahead::take(&mut self.ahead, Call::Reset) {
            self.begin_episode(reset, None)?;
        }
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("reset"));
        };
        *observation = episode.finish().0;
        Ok(())
    }

    fn step_into(&mut self, action: &Action, observation: &mut [f32; 8]) -> Result<Outcome> {
        let begun = Ahead::take(&mut self.ahead, Call::Step);
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("step"));
        };
        if !begun {
            if !self.config.takes(action) {
                return Err(self.action_space().refuse_action(action));
            }
            episode.begin(&self.config, action, None);
        }
        let (observed, outcome) = episode.finish();
        *observation = observed;
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::with_config("LunarLander", &(self.version, self.config), &self.episode)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.episode = snapshot.for_config(
            "LunarLander",
            &(self.version, self.config),
            Episode::is_valid,
        )?;
        if let Some(episode) = &mut self.episode {
            episode.render(&self.config, self.renders);
        }
        Ok(())
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.episode.as_mut().map(|episode| &mut episode.rng)
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(FPS as u32, (VIEWPORT_W as u32, VIEWPORT_H as u32))
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        if let Some(episode) = &self.episode {
            episode.draw(canvas);
        }
    }

    fn frames_drawn(&mut self, count: u64) {
        if count == 0 {
            self.renders = true;
            if let Some(episode) = &mut self.episode {
                episode.render(&self.config, true);
            }
        } else if let Some(exhaust) = self
            .episode
            .as_mut()
            .and_then(|episode| episode.exhaust.as_mut())
        {
            exhaust.fade();
        }
    }

    fn inspect(&self) -> Option<&dyn Inspect> {
        Some(self)
    }

    fn inspect_mut(&mut self) -> Option<&mut dyn Inspect> {
        Some(self)
    }

    fn close(&mut self) {
        self.episode = None;
    }
}

impl Lockstep for LunarLander {
    type Group = Worlds;

    fn prefetch(&self) -> u32 {
        self.episode
            .as_ref()
            .map_or(0, |episode| episode.world.prefetch())
    }

    fn begin_reset(&mut self, reset: &Reset, worlds: &mut Worlds) {
        let place = self.begin_episode(reset, Some(worlds)).ok();
        self.ahead = Ahead::of(Call::Reset, place);
    }

    fn begin_step(&mut self, action: &Action, worlds: &mut Worlds) {
        let episode = self.episode.as_mut().filter(|_| self.config.takes(action));
        let place = episode.map(|episode| episode.begin(&self.config, action, Some(worlds)));
        self.ahead = Ahead::of(Call::Step, place);
    }

    fn collect(&mut self, worlds: &mut Worlds) {
        if let (Some(ahead), Some(episode)) = (self.ahead, &mut self.episode) {
            worlds.finish(&mut episode.world, ahead.place);
        }
    }
}

impl Configure for LunarLander {
    type Config = Config;

    fn configure(config: Config, version: u32) -> Result<Self> {
        Self::with_version(config, version)
    }
}

const V2_EXCEPTIONS: &[(&str, &str)] = &[(
    "observation-in-space",
    "the bounds of version 2 are too narrow, which is why there is a version 3",
)];
const SPINS: (&str, &str) = (
    "observation-in-space",
    "a craft that spins beyond a full turn leaves the bounds, in Gymnasium too",
);

/// The numbers of an observation.
const NUMBERS: &[&str] = &[
    "x from the middle of the pad (10 m)",
    "y from the middle of the pad (6.67 m)",
    "velocity x (5 m/s)",
    "velocity y (7.5 m/s)",
    "angle from upright, counterclockwise (rad)",
    "angular velocity (2.5 rad/s)",
    "whether the left leg touches the ground",
    "whether the right leg touches the ground",
];

/// The registration shared by all ids.
const fn lander(id: &'static str) -> Registration {
    Registration::new::<LunarLander>(id)
        .description("Land a craft softly between two flags.")
        .exceptions(&[SPINS])
        .max_episode_steps(1000)
        .reward_threshold(200.0)
        .actions(Engine::VARIANTS)
        .names(|env| {
            let action: &[_] = match env.action_space() {
                Space::Discrete(_) => &[],
                _ => &["main engine", "left engine (-1) or right engine (1)"],
            };
            Names::new(NUMBERS, action)
        })
        .keys(|env| match env.action_space() {
            Space::Discrete(_) => Keys::new(json!({"Left": 1, "Up": 2, "Right": 3})).idle(json!(0)),
            _ => Keys::new(json!({"Up": [1, 0], "Left": [0, -1], "Right": [0, 1]}))
                .idle(json!([0, 0])),
        })
        .policy(Policy::rules(
            "is Gymnasium's own controller, `lunar_lander::heuristic`",
            |env| {
                let continuous = !matches!(env.action_space(), Space::Discrete(_));
                reflex(move |seen| heuristic(seen, continuous))
            },
        ))
}

const fn throttled(id: &'static str) -> Registration {
    lander(id).description("Land a craft softly between two flags, with engines that throttle.")
}

#[cfg(not(test))]
gym_core::register!(
    lander("LunarLander-v2")
        .lockstep::<LunarLander>()
        .exceptions(V2_EXCEPTIONS),
    throttled("LunarLanderContinuous-v2")
        .lockstep::<LunarLander>()
        .kwargs(r#"{"continuous": true}"#)
        .exceptions(V2_EXCEPTIONS),
    lander("LunarLander-v3")
        .lockstep::<LunarLander>()
        .clip(Clip {
            seeds: 0..1,
            every: 4,
            frames: 100,
            size: (300, 200)
        }),
    throttled("LunarLanderContinuous-v3")
        .lockstep::<LunarLander>()
        .kwargs(r#"{"continuous": true}"#),
    rapier::on_rapier(
        lander("rapier/LunarLander-v3")
            .exceptions(&[rapier::RAPIER_ALLOCATES, SPINS])
            .kwargs(r#"{"physics": "rapier"}"#)
    ),
    rapier::on_rapier(
        throttled("rapier/LunarLanderContinuous-v3")
            .exceptions(&[rapier::RAPIER_ALLOCATES, SPINS])
            .kwargs(r#"{"continuous": true, "physics": "rapier"}"#)
    ),
);
