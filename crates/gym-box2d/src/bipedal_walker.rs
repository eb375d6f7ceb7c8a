//! BipedalWalker: walk over uneven ground, and in its hardcore form over stumps, stairs and pits.
//!
//! | | |
//! |---|---|
//! | observation | angle of the hull, counterclockwise (rad), its angular velocity (25 rad/s), its velocity x, y (8.33 m/s, 12.5 m/s); for each leg angle and speed of the hip (rad, 4 rad/s), angle plus 1 and speed of the knee (rad, 6 rad/s), whether it touches the ground (0 or 1); ten distances of the ground by lidar, from straight down to nearly ahead (5.33 m; 1 if there is none); `Box(24, float32)` |
//! | action | hip and knee of the first leg, hip and knee of the second: direction and strength of the motor, as a share of 80 N m; `Box(-1, 1, (4,), float32)` |
//! | reward | 130/30 per m forward, less 5 per rad that the hull tilts, less 0.028 per step for each motor at full strength; -100 for a fall |
//! | start | standing, with a random push; reset options: none |
//! | end | terminated when the hull touches the ground, the walker goes back beyond the start, or reaches the end |
//! | limit | 1600 steps (hardcore: 2000) |
//!
//! Differences from Gymnasium: each reset builds a new world, so an episode depends only on its
//! seed. In Gymnasium, this holds only for the first episode of a new environment, which equals the
//! episode here; in a used environment, the same seed can give another episode.
//!
//! The constants and the order of operations are those of Gymnasium 1.4.0,
//! `envs/box2d/bipedal_walker.py`.

mod draw;
mod episode;
mod ground;
mod heuristic;

use std::f32::consts::PI;
use std::sync::LazyLock;

use gym_core::canvas::{Canvas, Point};
use gym_core::math::{cos, sin};
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::vector::lockstep::Lockstep;
use gym_core::{
    Configure, Continuous, Env, Error, Generator, Inspect, Keys, Names, Outcome, Policy,
    Registration, Reset, Result, Snapshot, Space,
};
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};

use crate::physics::{BodyId, Filter, FixtureId, JointId, Physics, Place, World};
use crate::rapier;
use crate::settings;
use crate::worlds::{Ahead, Call, Worlds};
pub use heuristic::Heuristic;

const FPS: f64 = 50.0;
const SCALE: f64 = 30.0; // pixels per m
const VIEWPORT_W: f64 = 600.0;
const VIEWPORT_H: f64 = 400.0;
const MOTORS_TORQUE: f32 = 80.0; // N m
const SPEED_HIP: f32 = 4.0; // rad/s
const SPEED_KNEE: f32 = 6.0;
const LIDAR_RANGE: f64 = 160.0 / SCALE;
const LIDAR_RAYS: usize = 10;
/// The vector of each lidar ray: to the right and down, in m.
static BEAMS: LazyLock<[Point; LIDAR_RAYS]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let angle = 1.5 * i as f64 / 10.0;
        [sin(angle) * LIDAR_RANGE, cos(angle) * LIDAR_RANGE]
    })
});
/// The number of frames after which the drawn lidar ray repeats its motion.
const LIDAR_CYCLE: usize = 100;
const INITIAL_RANDOM: f64 = 5.0; // N, the largest push at the start
const HULL_POLY: [[f64; 2]; 5] = [
    [-30.0, 9.0],
    [6.0, 9.0],
    [34.0, 1.0],
    [34.0, -8.0],
    [-30.0, -8.0],
];
const LEG_DOWN: f64 = -8.0 / SCALE;
const LEG_W: f64 = 8.0 / SCALE;
const LEG_H: f64 = 34.0 / SCALE;
const TERRAIN_STEP: f64 = 14.0 / SCALE;
const TERRAIN_LENGTH: usize = 200; // steps
const TERRAIN_HEIGHT: f64 = VIEWPORT_H / SCALE / 4.0;
const TERRAIN_GRASS: usize = 10; // terrain steps of even ground at either end
const TERRAIN_STARTPAD: usize = 20; // terrain steps of even ground at the start
const FRICTION: f32 = 2.5;
/// The category of the ground, which lidar rays and the walker collide with.
const GROUND: u16 = 0x0001;
/// The walker collides with the ground, not with itself.
const WALKER: Filter = Filter {
    category: 0x0020,
    mask: GROUND,
};

gym_core::arguments! {
    /// Arguments.
    #[derive(Copy)]
    pub struct Config {
        /// Whether the ground has stumps, stairs and pits.
        pub hardcore: bool,
        /// The physics engine: `box2d` or `rapier`.
        pub physics: Physics,
    }
}

/// The environment.
#[derive(Clone, Debug)]
pub struct BipedalWalker {
    config: Config,
    episode: Option<Episode>,
    ahead: Option<Ahead>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Episode {
    rng: Generator,
    world: World,
    hull: BodyId,
    /// Upper and lower leg of the first side, then of the second.
    legs: [BodyId; 4],
    /// Hip and knee of the first side, then of the second.
    joints: [JointId; 4],
    /// The fixtures of the legs and the hull, to draw.
    fixtures: [FixtureId; 5],
    /// Heights of the ground, one per [`TERRAIN_STEP`].
    terrain_y: Vec<f64>,
    /// Fixtures of stumps, stairs and the walls of pits, to draw.
    obstacles: Vec<FixtureId>,
    clouds: [[Point; 5]; TERRAIN_LENGTH / 20],
    /// Whether the hull has touched the ground.
    game_over: bool,
    /// Whether each lower leg touches the ground.
    ground_contact: [bool; 2],
    #[serde(deserialize_with = "Option::deserialize")]
    prev_shaping: Option<f64>,
    lidar: [f32; LIDAR_RAYS],
    /// The number of frames drawn, modulo [`LIDAR_CYCLE`], because the drawn lidar ray moves with
    /// every frame.
    pictures: usize,
    /// The action of the step that has begun.
    #[serde(skip)]
    action: Continuous<4>,
}

impl BipedalWalker {
    /// Makes the environment with the arguments `config`.
    pub fn new(config: Config) -> Self {
        Self {
            config,
            episode: None,
            ahead: None,
        }
    }

    /// The arguments.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Resets the environment and begins its first step, in which no motor drives.
    fn begin_episode(&mut self, reset: &Reset, worlds: Option<&mut Worlds>) -> Result<Place> {
        let rng = reset.generator(self.episode.as_ref().map(|episode| &episode.rng))?;
        let episode = self.episode.insert(Episode::new(self.config, rng));
        Ok(episode.begin(&Continuous::default(), worlds))
    }

    #[cfg(test)]
    pub(crate) fn world_bytes(&self) -> usize {
        self.episode
            .as_ref()
            .map_or(0, |episode| episode.world.bytes())
    }

    /// The heights of the ground, one per 14/30 m from the left, in m; `None` before the first
    /// reset.
    pub fn terrain(&self) -> Option<&[f64]> {
        self.episode.as_ref().map(|episode| &*episode.terrain_y)
    }
}

/// The next reset applies a set argument. `physics` is fixed.
impl Inspect for BipedalWalker {
    fn arguments(&self) -> Json {
        serde_json::to_value(self.config).unwrap_or_default()
    }

    fn set_argument(&mut self, name: &str, value: Json) -> Result<()> {
        self.config = settings::assigned(&self.config, name, value, "BipedalWalker")?;
        Ok(())
    }
}

impl Env for BipedalWalker {
    type Observation = [f32; 24];
    type Action = Continuous<4>;

    fn observation_space(&self) -> Space {
        // five times the rated speeds, because impacts exceed the rated speeds
        let mut high = [1.0; 24];
        high[..14].copy_from_slice(&[
            PI, 5.0, 5.0, 5.0, PI, 5.0, PI, 5.0, 5.0, PI, 5.0, PI, 5.0, 5.0,
        ]);
        let mut low = high.map(|x: f32| -x);
        [low[8], low[13]] = [-0.0; 2];
        Space::boxed(low, high)
    }

    fn action_space(&self) -> Space {
        Space::boxed([-1.0; 4], [1.0; 4])
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut [f32; 24]) -> Result<()> {
        if !Ahead::take(&mut self.ahead, Call::Reset) {
            self.begin_episode(reset, None)?;
        }
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("reset"));
        };
        *observation = episode.finish().0;
        Ok(())
    }

    fn step_into(
        &mut self,
        action: &Continuous<4>,
        observation: &mut [f32; 24],
    ) -> Result<Outcome> {
        let begun = Ahead::take(&mut self.ahead, Call::Step);
        let Some(episode) = &mut self.episode else {
            return Err(Error::ResetNeeded("step"));
        };
        if !begun {
            if !action.is_finite() {
                return Err(self.action_space().refuse_action(action));
            }
            episode.begin(action, None);
        }
        let (observed, outcome) = episode.finish();
        *observation = observed;
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::with_config("BipedalWalker", &self.config, &self.episode)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.episode = snapshot.for_config("BipedalWalker", &self.config, Episode::is_valid)?;
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
        if let (1.., Some(episode)) = (count, &mut self.episode) {
            episode.pictures = (episode.pictures + 1) % LIDAR_CYCLE;
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

impl Lockstep for BipedalWalker {
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

    fn begin_step(&mut self, action: &Continuous<4>, worlds: &mut Worlds) {
        let possible = action.is_finite();
        let episode = self.episode.as_mut().filter(|_| possible);
        let place = episode.map(|episode| episode.begin(action, Some(worlds)));
        self.ahead = Ahead::of(Call::Step, place);
    }

    fn collect(&mut self, worlds: &mut Worlds) {
        if let (Some(ahead), Some(episode)) = (self.ahead, &mut self.episode) {
            worlds.finish(&mut episode.world, ahead.place);
        }
    }
}

impl Configure for BipedalWalker {
    type Config = Config;

    fn configure(config: Config, _version: u32) -> Result<Self> {
        Ok(Self::new(config))
    }
}

/// The observation contains velocities divided by rated speeds. A hand-made snapshot may have
/// higher velocities.
const WORLD: (&str, &str) = (
    "snapshot-legal",
    "which forces and velocities of the bodies an episode reaches cannot be told from a snapshot, only that they are finite",
);
/// The numbers of observations and actions.
fn names() -> Names {
    let mut observation = vec![
        "angle of the hull, counterclockwise (rad)".to_owned(),
        "angular velocity of the hull (25 rad/s)".to_owned(),
        "velocity x of the hull (8.33 m/s)".to_owned(),
        "velocity y of the hull (12.5 m/s)".to_owned(),
    ];
    let mut action = Vec::new();
    for leg in ["first", "second"] {
        observation.extend([
            format!("angle of the {leg} hip (rad)"),
            format!("speed of the {leg} hip (4 rad/s)"),
            format!("angle of the {leg} knee, plus 1 (rad)"),
            format!("speed of the {leg} knee (6 rad/s)"),
            format!("whether the {leg} leg touches the ground"),
        ]);
        action.extend(["hip", "knee"].map(|joint| format!("motor of the {leg} {joint} (80 N m)")));
    }
    observation.extend((0..10).map(|i| format!("distance by lidar {i} (5.33 m)")));
    Names {
        observation,
        action,
    }
}

/// The registration shared by all ids.
const fn walker(id: &'static str) -> Registration {
    Registration::new::<BipedalWalker>(id)
        .description("Walk on two legs over slightly uneven ground.")
        .exceptions(&[WORLD])
        .names(|_| names())
        .max_episode_steps(1600)
        .reward_threshold(300.0)
        // hip and knee of one leg, then of the other
        .keys(|_| {
            let keys = json!({
                "Q": [1, 0, 0, 0], "A": [-1, 0, 0, 0], "W": [0, 1, 0, 0], "S": [0, -1, 0, 0],
                "O": [0, 0, 1, 0], "L": [0, 0, -1, 0], "I": [0, 0, 0, 1], "K": [0, 0, 0, -1],
            });
            Keys::new(keys).idle(json!([0, 0, 0, 0]))
        })
        .policy(Policy::rules(
            "is Gymnasium's own controller, `bipedal_walker::Heuristic`; it falls in most episodes",
            |_| {
                let mut gait = Heuristic::default();
                reflex(move |seen| gait.act(seen))
            },
        ))
}

const fn hardcore(id: &'static str) -> Registration {
    walker(id)
        .description("Walk on two legs over ladders, stumps and pits.")
        .max_episode_steps(2000)
}

const RAPIER_EXCEPTIONS: &[(&str, &str)] = &[
    WORLD,
    (
        "observation-in-space",
        "on impact rapier's joints can turn faster than five times their rated speed",
    ),
    rapier::RAPIER_ALLOCATES,
];

#[cfg(not(test))]
gym_core::register!(
    walker("BipedalWalker-v3")
        .lockstep::<BipedalWalker>()
        .clip(Clip {
            seeds: 0..1,
            every: 4,
            frames: 100,
            size: (300, 200)
        }),
    hardcore("BipedalWalkerHardcore-v3")
        .lockstep::<BipedalWalker>()
        .kwargs(r#"{"hardcore": true}"#),
    rapier::on_rapier(
        walker("rapier/BipedalWalker-v3")
            .kwargs(r#"{"physics": "rapier"}"#)
            .exceptions(RAPIER_EXCEPTIONS)
    ),
    rapier::on_rapier(
        hardcore("rapier/BipedalWalkerHardcore-v3")
            .kwargs(r#"{"hardcore": true, "physics": "rapier"}"#)
            .exceptions(RAPIER_EXCEPTIONS)
    ),
);
