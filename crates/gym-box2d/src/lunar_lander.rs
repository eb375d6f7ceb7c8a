//! LunarLander: bring a craft down gently between two flags.
//!
//! | | |
//! |---|---|
//! | observation | position, velocity, angle and angular velocity of the craft, contacts of its legs; `Box(8, float32)`, see below |
//! | action | [`Action`]: one engine at a time, `Discrete(4)`, or with `continuous` two throttles, `Box(-1, 1, (2,), float32)`: the main engine is off up to 0 and goes from half to full power at 1; the left engine fires below -0.5, the right one above 0.5 |
//! | reward | the step's increase of a potential, which is higher near the pad, at low speed, upright and with legs on the ground; less 0.3 for the main engine and 0.03 for a side engine; -100 for a crash, +100 for coming to rest |
//! | start | top centre, with a random push; reset options: none |
//! | end | terminated when the hull touches the ground, or the craft leaves the picture at a side or comes to rest |
//! | limit | 1000 steps |
//!
//! | number | observation | unit |
//! |---|---|---|
//! | 0, 1 | position x, y, from the middle of the pad | 10 m, 6.67 m |
//! | 2, 3 | velocity x, y | 5 m/s, 7.5 m/s |
//! | 4 | angle from upright, counterclockwise | rad |
//! | 5 | angular velocity | 2.5 rad/s |
//! | 6, 7 | whether the left and the right leg touch the ground | 0 or 1 |
//!
//! Versions: v3 draws a new wind at each reset and widens the bounds of the observation; v2, which
//! Gymnasium has removed, draws its wind from a copy of the environment's generator; Gym drew it
//! from numpy's global one.
//!
//! The constants and the order of operations are those of Gymnasium 1.4.0,
//! `envs/box2d/lunar_lander.py`.

mod exhaust;

use std::f64::consts::PI;

use gym_core::canvas::{Canvas, Color, Point, Primitive};
use gym_core::math::{cos, sin, tanh};
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::vector::lockstep::Lockstep;
use gym_core::{
    Configure, Continuous, Element, Env, Error, Generator, Inspect, Keys, Outcome, Policy,
    Registration, Reset, Result, Snapshot, Space, Value, pygame,
};
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};

use crate::physics::{
    BodyDef, BodyId, Filter, FixtureDef, FixtureId, Physics, Place, RevoluteJointDef, Shape, Vec2,
    World,
};
use crate::rapier;
use crate::settings;
use crate::shapes::{self, points, vec2};
use crate::worlds::{self, Ahead, Call, Worlds};
use exhaust::Exhaust;

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
    wind_idx: Option<i64>,
    torque_idx: Option<i64>,
    /// Whether the hull has touched the ground.
    game_over: bool,
    ground_contact: [bool; 2],
    prev_shaping: Option<f64>,
    /// The particles of the engines' exhaust, which exist only while frames are rendered.
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

impl Episode {
    /// Makes ground, lander and legs, in Gymnasium's order of random draws and creation.
    fn new(config: &Config, version: u32, mut rng: Generator) -> Self {
        let mut world = World::with(config.physics, vec2(0.0, config.gravity));

        let mut height = [0.0; CHUNKS + 1];
        height.fill_with(|| rng.uniform(0.0, H / 2.0));
        height[CHUNKS / 2 - 2..=CHUNKS / 2 + 2].fill(HELIPAD_Y);
        // (as in Gymnasium, the index -1 before the first height means the last of the twelve
        // heights)
        let smooth_y: [f64; CHUNKS] = std::array::from_fn(|i| {
            0.33 * (height[(i + CHUNKS) % (CHUNKS + 1)] + height[i] + height[i + 1])
        });

        exhaust::create_moon(&mut world, &smooth_y);
        let (initial_x, initial_y) = (VIEWPORT_W / SCALE / 2.0, VIEWPORT_H / SCALE);
        let lander = world.create_body(&BodyDef::dynamic(vec2(initial_x, initial_y), 0.0));
        let hull = world.create_fixture(
            lander,
            &FixtureDef {
                density: 5.0,
                friction: 0.1,
                filter: Filter {
                    category: 0x0010,
                    mask: 0x001,
                }, // collides with the ground only
                ..FixtureDef::new(Shape::Polygon(points(&LANDER_POLY, |x| x / SCALE)))
            },
        );
        let push_x = rng.uniform(-INITIAL_RANDOM, INITIAL_RANDOM);
        let push_y = rng.uniform(-INITIAL_RANDOM, INITIAL_RANDOM);
        world.apply_force_to_center(lander, vec2(push_x, push_y));

        let (mut wind_idx, mut torque_idx) = (None, None);
        if config.enable_wind {
            let mut aside = rng.clone();
            let source = if version == 2 { &mut aside } else { &mut rng };
            wind_idx = Some(source.integers(-9999, 9999));
            torque_idx = Some(source.integers(-9999, 9999));
        }

        let mut fixtures = [hull; 3];
        let mut leg = |side: f64, slot: usize| {
            let position = vec2(initial_x - side * LEG_AWAY / SCALE, initial_y);
            let leg = world.create_body(&BodyDef::dynamic(position, (side * 0.05) as f32));
            let shape = Shape::Rect {
                half_width: (LEG_W / SCALE) as f32,
                half_height: (LEG_H / SCALE) as f32,
            };
            let filter = Filter {
                category: 0x0020,
                mask: 0x001,
            };
            fixtures[slot] = world.create_fixture(
                leg,
                &FixtureDef {
                    density: 1.0,
                    filter,
                    ..FixtureDef::new(shape)
                },
            );
            // the legs move between these angles
            let (lower, upper) = if side < 0.0 {
                (0.9 - 0.5, 0.9)
            } else {
                (-0.9, -0.9 + 0.5)
            };
            world.create_revolute_joint(&RevoluteJointDef {
                body_a: lander,
                body_b: leg,
                local_anchor_a: Vec2::zeros(),
                local_anchor_b: vec2(side * LEG_AWAY / SCALE, LEG_DOWN / SCALE),
                limits: Some((lower as f32, upper as f32)),
                motor: true,
                motor_speed: (0.3 * side) as f32, // low enough not to jump back into the sky
                max_motor_torque: LEG_SPRING_TORQUE,
                collide_connected: false,
            });
            leg
        };
        let legs = [leg(-1.0, 1), leg(1.0, 2)];

        Self {
            rng,
            world,
            lander,
            legs,
            fixtures,
            smooth_y,
            wind_idx,
            torque_idx,
            game_over: false,
            ground_contact: [false; 2],
            prev_shaping: None,
            exhaust: None,
            throttles: [0.0; 2],
        }
    }

    /// Applies the wind: tanh(sin(2 k x) + sin(π k x)) with k = 0.01, which never repeats.
    fn blow(&mut self, config: &Config) {
        let gust = |index: &mut Option<i64>| {
            let next = index.get_or_insert(0);
            let x = *next as f64;
            *next += 1;
            tanh(sin(0.02 * x) + sin(PI * 0.01 * x))
        };
        let wind_mag = gust(&mut self.wind_idx) * config.wind_power;
        self.world
            .apply_force_to_center(self.lander, vec2(wind_mag, 0.0));
        let torque_mag = gust(&mut self.torque_idx) * config.turbulence_power;
        self.world.apply_torque(self.lander, torque_mag as f32);
    }

    /// Fires an engine: applies an impulse to the lander at `at` (relative to its centre), and the
    /// opposite impulse to an exhaust particle.
    fn fire(&mut self, [ox, oy]: Point, at: Point, engine_power: f64, power: f64, density: f64) {
        let position = self.world.position(self.lander);
        let at = [
            f64::from(position.x) + ox + at[0],
            f64::from(position.y) + oy + at[1],
        ];
        let impulse = vec2(-ox * engine_power * power, -oy * engine_power * power);
        self.world
            .apply_linear_impulse(self.lander, impulse, vec2(at[0], at[1]));
        if let Some(exhaust) = &mut self.exhaust {
            let impulse = vec2(ox * engine_power * power, oy * engine_power * power);
            exhaust.emit(vec2(at[0], at[1]), impulse, density, power);
        }
    }

    /// Applies wind and engines, then steps the world as [`worlds::step`].
    fn begin(&mut self, config: &Config, action: &Action, worlds: Option<&mut Worlds>) -> Place {
        if config.enable_wind && !self.ground_contact.contains(&true) {
            self.blow(config);
        }

        // the throttles, and the direction of the side engine
        let (m_power, s_power, direction) = match *action {
            Action::Fire(Engine::Off) => (0.0, 0.0, 0.0),
            Action::Fire(Engine::Main) => (1.0, 0.0, 0.0),
            Action::Fire(Engine::Left) => (0.0, 1.0, -1.0),
            Action::Fire(Engine::Right) => (0.0, 1.0, 1.0),
            Action::Throttle(throttles) => {
                let [main, side] = throttles.numbers.map(|throttle| throttle.clamp(-1.0, 1.0));
                let m_power = if main > 0.0 { (main + 1.0) * 0.5 } else { 0.0 };
                (
                    m_power,
                    if side.abs() > 0.5 { side.abs() } else { 0.0 },
                    side.signum(),
                )
            }
        };

        let angle = f64::from(self.world.angle(self.lander));
        let tip = [sin(angle), cos(angle)];
        let side = [-tip[1], tip[0]];
        let dispersion = [(); 2].map(|()| self.rng.uniform(-1.0, 1.0) / SCALE);

        if m_power > 0.0 {
            // `MAIN_ENGINE_Y_LOCATION` puts the impulse a bit below the lander; the random
            // dispersion counts twice along the lander's axis
            let away = MAIN_ENGINE_Y_LOCATION / SCALE + 2.0 * dispersion[0];
            let ox = tip[0] * away + side[0] * dispersion[1];
            let oy = -tip[1] * away - side[1] * dispersion[1];
            self.fire([ox, oy], [0.0, 0.0], MAIN_ENGINE_POWER, m_power, 3.5);
        }
        if s_power > 0.0 {
            let away = 3.0 * dispersion[1] + direction * SIDE_ENGINE_AWAY / SCALE;
            let ox = tip[0] * dispersion[0] + side[0] * away;
            let oy = -tip[1] * dispersion[0] - side[1] * away;
            // (17, although `SIDE_ENGINE_HEIGHT` is 14, as in Gymnasium)
            let at = [
                -(tip[0] * 17.0 / SCALE),
                tip[1] * SIDE_ENGINE_HEIGHT / SCALE,
            ];
            self.fire([ox, oy], at, SIDE_ENGINE_POWER, s_power, 0.7);
        }

        self.throttles = [m_power, s_power];
        worlds::step(&mut self.world, FPS, worlds)
    }

    /// Computes observation, reward and end of the episode from the stepped world.
    fn finish(&mut self) -> ([f32; 8], Outcome) {
        let [m_power, s_power] = self.throttles;
        if let Some(exhaust) = &mut self.exhaust {
            exhaust.step();
        }
        for event in self.world.contact_events() {
            self.game_over |= event.begin && event.bodies.contains(&self.lander);
            for (leg, contact) in self.legs.iter().zip(&mut self.ground_contact) {
                if event.bodies.contains(leg) {
                    *contact = event.begin;
                }
            }
        }

        let state = self.observe();
        let shaping = -100.0 * (state[0] * state[0] + state[1] * state[1]).sqrt()
            - 100.0 * (state[2] * state[2] + state[3] * state[3]).sqrt()
            - 100.0 * state[4].abs()
            + 10.0 * state[6]
            + 10.0 * state[7];
        let mut reward = self.prev_shaping.map_or(0.0, |before| shaping - before);
        self.prev_shaping = Some(shaping);
        reward -= m_power * 0.30; // spent fuel costs reward
        reward -= s_power * 0.03;

        let mut terminated = false;
        if self.game_over || state[0].abs() >= 1.0 {
            terminated = true;
            reward = -100.0;
        }
        if !self.world.is_awake(self.lander) {
            terminated = true;
            reward = 100.0;
        }
        (
            state.map(|x| x as f32),
            Outcome {
                reward,
                terminated,
                truncated: false,
            },
        )
    }

    fn observe(&self) -> [f64; 8] {
        let pos = self.world.position(self.lander);
        let vel = self.world.linear_velocity(self.lander);
        [
            (f64::from(pos.x) - VIEWPORT_W / SCALE / 2.0) / (VIEWPORT_W / SCALE / 2.0),
            (f64::from(pos.y) - (HELIPAD_Y + LEG_DOWN / SCALE)) / (VIEWPORT_H / SCALE / 2.0),
            f64::from(vel.x) * (VIEWPORT_W / SCALE / 2.0) / FPS,
            f64::from(vel.y) * (VIEWPORT_H / SCALE / 2.0) / FPS,
            f64::from(self.world.angle(self.lander)),
            20.0 * f64::from(self.world.angular_velocity(self.lander)) / FPS,
            f64::from(self.ground_contact[0]),
            f64::from(self.ground_contact[1]),
        ]
    }

    fn is_valid(&self) -> bool {
        /// Far above the potential of any position and speed.
        const MAX_SHAPING: f64 = 1e6;
        let [a, b] = self.legs;
        self.world.is_valid()
            && self
                .prev_shaping
                .is_none_or(|shaping| shaping.abs() <= MAX_SHAPING)
            && [self.lander, a, b]
                .iter()
                .all(|body| self.world.has_body(*body))
            && self
                .fixtures
                .iter()
                .all(|fixture| self.world.has_fixture(*fixture))
            && self.exhaust.as_ref().is_none_or(Exhaust::is_valid)
    }

    /// Starts (`renders`) or stops the simulation of the exhaust.
    fn render(&mut self, config: &Config, renders: bool) {
        if !renders {
            self.exhaust = None;
        } else if self.exhaust.is_none() {
            self.exhaust = Some(Exhaust::new(config.gravity, &self.smooth_y));
        }
    }

    /// Draws both flags; Gymnasium draws them again after each body.
    fn draw_flags(canvas: &mut dyn Canvas) {
        for x in [chunk_x(CHUNKS / 2 - 1), chunk_x(CHUNKS / 2 + 1)] {
            let [x, y] = [x * SCALE, HELIPAD_Y * SCALE];
            let top = y + 50.0;
            let pole = Primitive::Lines {
                points: &[[x, y], [x, top]],
                closed: false,
                width: 1,
            };
            canvas.pygame(pole, Color::WHITE);
            let flag = [[x, top], [x, top - 10.0], [x + 25.0, top - 5.0]];
            shapes::draw_polygon(canvas, &flag, Color::rgb(204, 204, 0));
        }
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
        if self
            .ahead
            .take()
            .is_none_or(|ahead| ahead.call != Call::Reset)
        {
            self.begin_episode(reset, None)?;
        }
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("reset"));
        };
        *observation = episode.finish().0;
        Ok(())
    }

    fn step_into(&mut self, action: &Action, observation: &mut [f32; 8]) -> Result<Outcome> {
        let begun = self
            .ahead
            .take()
            .is_some_and(|ahead| ahead.call == Call::Step);
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
        let Some(episode) = &self.episode else { return };
        canvas.clear(Color::WHITE);
        canvas.push(pygame::flipped(VIEWPORT_H));
        for i in 0..CHUNKS - 1 {
            let (x1, x2) = (chunk_x(i), chunk_x(i + 1));
            let sky = [
                [x1, episode.smooth_y[i]],
                [x2, episode.smooth_y[i + 1]],
                [x2, H],
                [x1, H],
            ];
            shapes::draw_polygon(
                canvas,
                &sky.map(|corner| corner.map(|x| x * SCALE)),
                Color::BLACK,
            );
        }
        for (position, ttl) in episode.exhaust.iter().flat_map(Exhaust::visible) {
            let shade = |x: f64| (x.max(0.2) * 255.0) as u8;
            let color = Color::rgb(shade(0.15 + ttl), shade(0.5 * ttl), shade(0.5 * ttl));
            let center = [position.x, position.y].map(|x| f64::from(x * SCALE as f32));
            let radius = f64::from(exhaust::RADIUS) * SCALE;
            canvas.pygame(Primitive::Circle { center, radius }, color);
            Episode::draw_flags(canvas);
        }
        for fixture in episode.fixtures {
            let (corners, count) = shapes::pixel_corners(&episode.world, fixture, SCALE);
            let corners = &corners[..count];
            shapes::draw_polygon(canvas, corners, Color::rgb(128, 102, 230));
            canvas.pygame(
                Primitive::AaLines {
                    points: corners,
                    closed: true,
                },
                Color::rgb(77, 77, 128),
            );
            Episode::draw_flags(canvas);
        }
        canvas.pop();
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
        let place = self.begin_episode(reset, Some(worlds));
        self.ahead = place.ok().map(|place| Ahead {
            call: Call::Reset,
            place,
        });
    }

    fn begin_step(&mut self, action: &Action, worlds: &mut Worlds) {
        let episode = self.episode.as_mut().filter(|_| self.config.takes(action));
        let place = episode.map(|episode| episode.begin(&self.config, action, Some(worlds)));
        self.ahead = place.map(|place| Ahead {
            call: Call::Step,
            place,
        });
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

/// Gymnasium's hand-written pilot: returns its action for the observation `s`, continuous or
/// discrete.
pub fn heuristic(s: &[f32; 8], continuous: bool) -> Action {
    // tilt towards the centre, by at most 0.4 rad
    let angle_targ = (s[0] * 0.5 + s[2] * 1.0).clamp(-0.4, 0.4);
    let hover_targ = 0.55 * s[0].abs(); // the target height grows with the distance
    let mut angle_todo = (angle_targ - s[4]) * 0.5 - s[5] * 1.0;
    let mut hover_todo = (hover_targ - s[1]) * 0.5 - s[3] * 0.5;
    if s[6] != 0.0 || s[7] != 0.0 {
        // on the ground, only damp the fall
        angle_todo = 0.0;
        hover_todo = -s[3] * 0.5;
    }
    if continuous {
        return [hover_todo * 20.0 - 1.0, -angle_todo * 20.0]
            .map(|x| x.clamp(-1.0, 1.0))
            .into();
    }
    Action::Fire(if hover_todo > angle_todo.abs() && hover_todo > 0.05 {
        Engine::Main
    } else if angle_todo < -0.05 {
        Engine::Right
    } else if angle_todo > 0.05 {
        Engine::Left
    } else {
        Engine::Off
    })
}

const V2_EXCEPTIONS: &[(&str, &str)] = &[(
    "observation-in-space",
    "the bounds of version 2 are too narrow, which is why there is a version 3",
)];
const SPINS: (&str, &str) = (
    "observation-in-space",
    "a craft that spins beyond a full turn leaves the bounds, in Gymnasium too",
);

/// The registration shared by all ids.
const fn lander(id: &'static str) -> Registration {
    Registration::new::<LunarLander>(id)
        .description("Land a craft softly between two flags.")
        .exceptions(&[SPINS])
        .max_episode_steps(1000)
        .reward_threshold(200.0)
        .actions(Engine::VARIANTS)
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
