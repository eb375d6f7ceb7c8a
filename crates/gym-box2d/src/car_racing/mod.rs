//! CarRacing: drive a car around a random track, seen from above.
//!
//! | | |
//! |---|---|
//! | observation | an image of the car and its surroundings; `Box(0, 255, (96, 96, 3), uint8)` |
//! | action | [`Action`]: steering, gas and brake, `Box([-1, 0, 0], 1, (3,), float32)`, or without `continuous` one of five, `Discrete(5)` |
//! | reward | 1000 / number of tiles for each tile that a wheel touches first, less 0.1 per step; -100 for leaving the field |
//! | start | at rest on the track; reset option `randomize` (boolean, true; with `domain_randomize`): whether to draw new colours |
//! | end | terminated when the lap is complete or the car leaves the field; info `lap_finished` is true for a lap |
//! | limit | 1000 steps |
//!
//! Versions: v3 terminates the episode when the lap is complete, with an entry of info; v2, which
//! Gymnasium no longer has, truncates it and has no info.
//!
//! Differences from Gymnasium: the score has our own digits; all other pixels are equal. The render
//! mode `state_pixels` is missing: the observation is that image.
//!
//! The constants and the order of operations are those of Gymnasium 1.4.0,
//! `envs/box2d/car_racing.py` and `car_dynamics.py`.

mod car;
mod episode;
mod heuristic;
mod picture;
mod score;
mod track;

use std::sync::Arc;

use gym_core::canvas::Canvas;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::{
    Array, Configure, Continuous, Element, Env, Error, Generator, Inspect, Keys, Names, Outcome,
    Policy, Registration, Reset, Result, Snapshot, Space, Value,
};
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};

use crate::physics::{BodyId, Physics, World};
use crate::rapier;
use crate::settings;
use car::Car;
use picture::{Camera, Scene};
pub use score::ScoreGlyphs;
use track::Tile;
pub use track::TrackPoint;

const FPS: f64 = 50.0;
/// The reward of all tiles together.
const TRACK_REWARD: f64 = 1000.0;
/// The cost of a step.
const STEP_COST: f64 = 0.1;
/// The reward of the step that leaves the playfield.
const LEAVING_REWARD: f64 = -100.0;
/// The controls of the discrete actions.
const DISCRETE_STEER: f64 = 0.6;
const DISCRETE_GAS: f64 = 0.2;
const DISCRETE_BRAKE: f64 = 0.8;
/// The largest component of a random colour, and the amount by which grass differs from its
/// background in one component.
const MAX_RANDOM_COLOR: f64 = 210.0;
const GRASS_DIFFERENCE: f64 = 20.0;
/// The scale of the track: Gymnasium's `SCALE`.
const SCALE: f64 = 6.0;
/// Half the side of the playfield, in m. A car outside of it ends the episode.
const PLAYFIELD: f64 = 2000.0 / SCALE;
const VIDEO_W: u32 = 600;
const VIDEO_H: u32 = 400;

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub struct Config {
        /// Accepted as Gymnasium does; nothing is printed.
        pub verbose: bool,
        /// The share of tiles that must have been visited when the first is entered again.
        pub lap_complete_percent: f64 = 0.95,
        /// Whether road and grass have random colours.
        pub domain_randomize: bool,
        /// Steering, gas and brake by degrees instead of five actions.
        pub continuous: bool = true,
        /// The physics engine: `box2d` or `rapier`.
        pub physics: Physics,
    }
}

gym_core::discrete! {
    /// The controls of the driver.
    pub enum Drive {
        /// Nothing.
        Idle,
        /// Steers right.
        Right,
        /// Steers left.
        Left,
        /// Gives some gas.
        Gas,
        /// Brakes.
        Brake,
    }
}

/// The controls of the driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Steering from -1 (left) to 1 (right), gas and brake from 0 to 1.
    Pedals(Continuous<3>),
    /// Without [`Config::continuous`]: one of five.
    Drive(Drive),
}

impl From<[f32; 3]> for Action {
    fn from(pedals: [f32; 3]) -> Self {
        Self::Pedals(pedals.into())
    }
}

impl From<Drive> for Action {
    fn from(drive: Drive) -> Self {
        Self::Drive(drive)
    }
}

impl Element for Action {
    fn empty() -> Self {
        Self::Pedals(Continuous::default())
    }

    fn from_value(value: &Value) -> Option<Self> {
        match value {
            Value::Int(_) => Drive::from_value(value).map(Self::Drive),
            _ => Element::from_value(value).map(Self::Pedals),
        }
    }

    fn write(&self, out: &mut Value) {
        match self {
            Self::Pedals(pedals) => pedals.write(out),
            Self::Drive(drive) => drive.write(out),
        }
    }
}

/// The environment.
#[derive(Clone, Debug)]
pub struct CarRacing {
    config: Config,
    version: u32,
    episode: Option<Episode>,
    camera: Camera,
    /// Images of the score's digits; `None` for our own digits.
    glyphs: Option<Arc<ScoreGlyphs>>,
}

/// The position and motion of the car. With the track they determine the episode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Position x, y in m, angle in rad, velocity x, y in m/s, angular velocity in rad/s.
    pub hull: [f64; 6],
    /// Per wheel (front left, front right, rear left, rear right): the steering angle in rad, the
    /// angular velocity of rolling in rad/s, and the angle rolled in rad.
    pub wheels: [[f64; 3]; 4],
    /// Number of tiles that a wheel has touched.
    pub tiles_visited: usize,
}

/// Colours of the field, 0 to 255.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Colors {
    road: [f64; 3],
    background: [f64; 3],
    grass: [f64; 3],
}

impl Colors {
    const DEFAULT: Self = Self {
        road: [102.0, 102.0, 102.0],
        background: [102.0, 204.0, 102.0],
        grass: [102.0, 230.0, 102.0],
    };

    fn random(rng: &mut Generator) -> Self {
        let mut color = || [(); 3].map(|()| rng.uniform(0.0, MAX_RANDOM_COLOR));
        let (road, background) = (color(), color());
        let mut grass = background;
        grass[rng.integers(0, 3) as usize] += GRASS_DIFFERENCE;
        Self {
            road,
            background,
            grass,
        }
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Episode {
    rng: Generator,
    world: World,
    colors: Colors,
    track: Vec<TrackPoint>,
    tiles: Vec<Tile>,
    /// Bodies of the tiles: `tile_bodies[i]` is the body of `tiles[i]`.
    tile_bodies: Vec<BodyId>,
    /// Whether a wheel has visited each tile.
    visited: Vec<bool>,
    /// Whether the car has touched each tile. A touched tile is drawn without shade.
    touched: Vec<bool>,
    tile_visited_count: usize,
    /// The share of visited tiles above which the lap counts, read at the reset.
    lap_complete_percent: f64,
    car: Car,
    reward: f64,
    prev_reward: f64,
    /// The score that the observation shows, which excludes the current step's cost.
    observed_reward: f64,
    t: f64,
    new_lap: bool,
    /// After the last step of an episode: true if the lap is finished, false if the car left the
    /// field.
    #[serde(deserialize_with = "Option::deserialize")]
    lap_finished: Option<bool>,
}

/// The options of a [`Reset`].
#[derive(Deserialize)]
#[serde(default)]
struct Options {
    randomize: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { randomize: true }
    }
}

impl CarRacing {
    /// Makes the environment with the arguments `config`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a `lap_complete_percent` that is not a number.
    pub fn new(config: Config) -> Result<Self> {
        Self::with_version(config, 3)
    }

    /// Like [`new`](Self::new), with the rules of version 2 or 3.
    ///
    /// # Errors
    /// The errors of `new`; [`Error::InvalidArgument`] for a version below 2.
    pub fn with_version(config: Config, version: u32) -> Result<Self> {
        let version = settings::version("CarRacing", version)?;
        Self::check(&config)?;
        Ok(Self {
            config,
            version,
            episode: None,
            camera: Camera::default(),
            glyphs: None,
        })
    }

    fn check(config: &Config) -> Result<()> {
        if config.lap_complete_percent.is_nan() {
            return Err(Error::argument(
                "CarRacing",
                "lap_complete_percent is not a number",
            ));
        }
        Ok(())
    }

    /// The arguments.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The state of the car; `None` before the first reset.
    pub fn state(&self) -> Option<State> {
        self.episode.as_ref().map(Episode::state)
    }

    /// The centre line of the track; `None` before the first reset.
    pub fn track(&self) -> Option<&[TrackPoint]> {
        self.episode.as_ref().map(|episode| &*episode.track)
    }

    /// Draws the score with `glyphs` from the next frame on, as Gymnasium does, instead of our own
    /// digits. Snapshots and specs do not contain `glyphs`.
    pub fn set_score_glyphs(&mut self, glyphs: ScoreGlyphs) {
        self.glyphs = Some(Arc::new(glyphs));
    }

    /// Resets the environment without drawing an observation.
    ///
    /// # Errors
    /// The errors of [`Env::reset_into`].
    pub fn reset_state(&mut self, reset: &Reset) -> Result<()> {
        let mut rng = reset.generator(self.episode.as_ref().map(|episode| &episode.rng))?;
        let Options { randomize } = reset.options("CarRacing")?;
        let colors = match &self.episode {
            _ if self.config.domain_randomize && randomize => Colors::random(&mut rng),
            // the colours of the last episode: `Inspect` may have set them
            Some(episode) => episode.colors,
            None if !self.config.domain_randomize => Colors::DEFAULT,
            // in Gymnasium the constructor draws these colours from an unseeded generator; here a
            // copy of the episode's generator draws them
            None => Colors::random(&mut rng.clone()),
        };
        let mut episode = Episode::new(&self.config, rng, colors);
        episode.advance(self.version, None);
        self.episode = Some(episode);
        Ok(())
    }

    /// Steps the environment without drawing an observation.
    ///
    /// # Errors
    /// The errors of [`Env::step_into`].
    pub fn step_state(&mut self, action: &Action) -> Result<Outcome> {
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("step"));
        };
        let possible = match action {
            Action::Pedals(pedals) => self.config.continuous && pedals.is_finite(),
            Action::Drive(_) => !self.config.continuous,
        };
        if !possible {
            return Err(self.action_space().refuse_action(action));
        }
        Ok(episode.advance(self.version, Some(action)))
    }
}

/// The next reset applies a set argument. `continuous` and `physics` are fixed.
impl Inspect for CarRacing {
    fn state(&self) -> Option<Json> {
        serde_json::to_value(self.state()?).ok()
    }

    fn arguments(&self) -> Json {
        serde_json::to_value(self.config).unwrap_or_default()
    }

    fn set_argument(&mut self, name: &str, value: Json) -> Result<()> {
        let config = settings::assigned(&self.config, name, value, "CarRacing")?;
        Self::check(&config)?;
        self.config = config;
        Ok(())
    }
}

impl Env for CarRacing {
    type Observation = Array;
    type Action = Action;

    fn observation_space(&self) -> Space {
        picture::space()
    }

    fn action_space(&self) -> Space {
        if self.config.continuous {
            Space::boxed([-1.0, 0.0, 0.0], [1.0; 3])
        } else {
            Drive::space()
        }
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Array) -> Result<()> {
        self.reset_state(reset)?;
        if let Some(episode) = &self.episode {
            self.camera
                .take(episode, self.glyphs.as_deref(), observation);
        }
        Ok(())
    }

    fn step_into(&mut self, action: &Action, observation: &mut Array) -> Result<Outcome> {
        let outcome = self.step_state(action)?;
        if let Some(episode) = &self.episode {
            self.camera
                .take(episode, self.glyphs.as_deref(), observation);
        }
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::with_config("CarRacing", &(self.version, self.config), &self.episode)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.episode =
            snapshot.for_config("CarRacing", &(self.version, self.config), Episode::is_valid)?;
        Ok(())
    }

    fn info(&self, visit: &mut dyn FnMut(&str, Value)) {
        let finished = self
            .episode
            .as_ref()
            .and_then(|episode| episode.lap_finished);
        if let Some(finished) = finished.filter(|_| self.version != 2) {
            visit("lap_finished", Value::Bool(finished));
        }
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.episode.as_mut().map(|episode| &mut episode.rng)
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(FPS as u32, (VIDEO_W, VIDEO_H))
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        if let Some(episode) = &self.episode {
            episode.draw(
                canvas,
                (VIDEO_W, VIDEO_H),
                Scene::Frame,
                self.glyphs.as_deref(),
            );
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

impl Configure for CarRacing {
    type Config = Config;

    fn configure(config: Config, version: u32) -> Result<Self> {
        Self::with_version(config, version)
    }
}

/// `verbose` exists only because Gymnasium has it.
const VERBOSE: (&str, &str) = (
    "arguments-matter.verbose",
    "it is accepted as Gymnasium does, and nothing is printed",
);

/// The registration shared by all ids.
const fn racing(id: &'static str) -> Registration {
    Registration::new::<CarRacing>(id)
        .description("Drive around a track, from pictures.")
        .reset_options(&[("randomize", "false")])
        .exceptions(&[VERBOSE])
        .max_episode_steps(1000)
        .reward_threshold(900.0)
        .actions(Drive::VARIANTS)
        .names(|env| match env.action_space() {
            Space::Discrete(_) => Names::default(),
            _ => Names::new(&[], &["steering, to the right", "gas", "brake"]),
        })
        .keys(|env| match env.action_space() {
            Space::Discrete(_) => {
                Keys::new(json!({"Right": 1, "Left": 2, "Up": 3, "Down": 4})).idle(json!(0))
            }
            _ => {
                let keys =
                    json!({"Left": [-1, 0, 0], "Right": [1, 0, 0], "Up": [0, 1, 0], "Down": [0, 0, 0.8]});
                Keys::new(keys).idle(json!([0, 0, 0]))
            }
        })
        .policy(Policy::rules(
            "steers towards a point of the track ahead at a moderate speed; it reads the track from the environment, not \
             from the picture, and finishes no lap within the limit",
            heuristic::follow_the_track,
        ))
}

#[cfg(not(test))]
gym_core::register!(
    racing("CarRacing-v2"),
    racing("CarRacing-v3").clip(Clip {
        seeds: 1..2,
        every: 6,
        frames: 60,
        size: (300, 200)
    }),
    rapier::on_rapier(
        racing("rapier/CarRacing-v3")
            .exceptions(&[VERBOSE, rapier::RAPIER_ALLOCATES])
            .kwargs(r#"{"physics": "rapier"}"#)
    ),
);

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers are those of numpy's generator, in the order of Gymnasium's `_reinit_colors`.
    #[test]
    fn random_colors_are_gymnasiums() {
        let brighter = [1, 0, 2, 1, 1, 1];
        for (seed, brighter) in (0..).zip(brighter) {
            let mut rng = Generator::new(&gym_core::Seed::from(seed));
            let colors = Colors::random(&mut rng);
            let differences = [0, 1, 2].map(|k| colors.grass[k] - colors.background[k]);
            let mut expected = [0.0; 3];
            expected[brighter] = GRASS_DIFFERENCE;
            for (found, expected) in differences.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-9, "{seed}: {differences:?}");
            }
        }
        let colors = Colors::random(&mut Generator::new(&gym_core::Seed::from(2)));
        assert_eq!(
            [colors.road, colors.background],
            [
                [54.93854819235644, 62.683140116965895, 170.98740552479887],
                [19.30234784837035, 126.02111045278734, 152.99771063047686]
            ]
        );
    }
}
