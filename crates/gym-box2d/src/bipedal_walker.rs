//! BipedalWalker: walk over uneven ground, and in its hardcore form over stumps, stairs and pits.
//!
//! | | |
//! |---|---|
//! | observation | motion of the hull, joints and contacts of the legs, ten distances by lidar; `Box(24, float32)`, see below |
//! | action | hip and knee of the first leg, hip and knee of the second: direction and strength of the motor, as a share of 80 N m; `Box(-1, 1, (4,), float32)` |
//! | reward | 130/30 per m forward, less 5 per rad that the hull tilts, less 0.028 per step for each motor at full strength; -100 for a fall |
//! | start | standing, with a random push; reset options: none |
//! | end | terminated when the hull touches the ground, the walker goes back beyond the start, or reaches the end |
//! | limit | 1600 steps (hardcore: 2000) |
//!
//! | number | observation | unit |
//! |---|---|---|
//! | 0 | angle of the hull, counterclockwise | rad |
//! | 1 | its angular velocity | 25 rad/s |
//! | 2, 3 | its velocity x, y | 8.33 m/s, 12.5 m/s |
//! | 4, 5 | angle and speed of the first hip | rad, 4 rad/s |
//! | 6, 7 | angle of the first knee, plus 1, and its speed | rad, 6 rad/s |
//! | 8 | whether the first leg touches the ground | 0 or 1 |
//! | 9 to 13 | the same of the second leg | |
//! | 14 to 23 | distance of the ground by lidar, from straight down to nearly ahead | 5.33 m; 1 if there is none |
//!
//! Differences from Gymnasium: each reset builds a new world, so an episode depends only on its
//! seed. In Gymnasium, this holds only for the first episode of a new environment, which equals the
//! episode here; in a used environment, the same seed can give another episode.
//!
//! The constants and the order of operations are those of Gymnasium 1.4.0,
//! `envs/box2d/bipedal_walker.py`.

mod ground;
mod heuristic;

use std::f32::consts::PI;
use std::sync::LazyLock;

use gym_core::canvas::{Canvas, Color, Point, Primitive, Transform};
use gym_core::math::{cos, sin};
use gym_core::policy::reflex;
use gym_core::registry::Clip;
use gym_core::render::Metadata;
use gym_core::vector::lockstep::Lockstep;
use gym_core::{
    Configure, Continuous, Env, Error, Generator, Inspect, Keys, Outcome, Policy, Precision,
    Registration, Reset, Result, Snapshot, Space, pygame,
};
use serde::{Deserialize, Serialize};
use serde_json::{Value as Json, json};

use crate::physics::{
    BodyDef, BodyId, Filter, FixtureDef, FixtureId, JointId, Physics, Place, RevoluteJointDef,
    Shape, Vec2, World,
};
use crate::rapier;
use crate::settings;
use crate::shapes::{self, points, vec2};
use crate::worlds::{self, Ahead, Call, Worlds};

use ground::Ground;
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

fn cloud(rng: &mut Generator) -> [Point; 5] {
    let x = rng.uniform(0.0, TERRAIN_LENGTH as f64) * TERRAIN_STEP;
    let y = VIEWPORT_H / SCALE * 3.0 / 4.0;
    std::array::from_fn(|a| {
        #[expect(clippy::approx_constant, reason = "Gymnasium's")]
        let angle = 3.14 * 2.0 * a as f64 / 5.0;
        let px = x + 15.0 * TERRAIN_STEP * sin(angle) + rng.uniform(0.0, 5.0 * TERRAIN_STEP);
        let py = y + 5.0 * TERRAIN_STEP * cos(angle) + rng.uniform(0.0, 5.0 * TERRAIN_STEP);
        [px, py]
    })
}

impl Episode {
    /// Makes ground, clouds, hull and legs, in Gymnasium's order of random draws and creation.
    fn new(config: Config, mut rng: Generator) -> Self {
        let mut world = World::with(config.physics, vec2(0.0, -10.0));
        let Ground {
            terrain_y,
            obstacles,
            ..
        } = Ground::new(&mut rng, &mut world, config.hardcore);
        let clouds = [(); TERRAIN_LENGTH / 20].map(|()| cloud(&mut rng));

        let init_x = TERRAIN_STEP * TERRAIN_STARTPAD as f64 / 2.0;
        let init_y = TERRAIN_HEIGHT + 2.0 * LEG_H;
        let hull = world.create_body(&BodyDef::dynamic(vec2(init_x, init_y), 0.0));
        let hull_shape = Shape::Polygon(points(&HULL_POLY, |x| x / SCALE));
        let hull_fixture = world.create_fixture(
            hull,
            &FixtureDef {
                density: 5.0,
                friction: 0.1,
                filter: WALKER,
                ..FixtureDef::new(hull_shape)
            },
        );
        let push = rng.uniform(-INITIAL_RANDOM, INITIAL_RANDOM);
        world.apply_force_to_center(hull, vec2(push, 0.0));

        let (mut legs, mut joints, mut fixtures) = (Vec::new(), Vec::new(), Vec::new());
        for side in [-1.0, 1.0] {
            let (mut above, mut anchor) = (hull, vec2(0.0, LEG_DOWN));

            for (halves, width, limits, motor_speed) in [
                (1.0, LEG_W, (-0.8, 1.1), side),
                (3.0, 0.8 * LEG_W, (-1.6, -0.1), 1.0),
            ] {
                let position = vec2(init_x, init_y - LEG_H * halves / 2.0 - LEG_DOWN);
                let leg = world.create_body(&BodyDef::dynamic(position, (side * 0.05) as f32));
                let shape = Shape::Rect {
                    half_width: (width / 2.0) as f32,
                    half_height: (LEG_H / 2.0) as f32,
                };
                let def = FixtureDef {
                    density: 1.0,
                    filter: WALKER,
                    ..FixtureDef::new(shape)
                };
                fixtures.push(world.create_fixture(leg, &def));
                joints.push(world.create_revolute_joint(&RevoluteJointDef {
                    body_a: above,
                    body_b: leg,
                    local_anchor_a: anchor,
                    local_anchor_b: vec2(0.0, LEG_H / 2.0),
                    limits: Some(limits),
                    motor: true,
                    motor_speed: motor_speed as f32,
                    max_motor_torque: MOTORS_TORQUE,
                    collide_connected: false,
                }));
                legs.push(leg);
                (above, anchor) = (leg, vec2(0.0, -LEG_H / 2.0));
            }
        }
        Self {
            rng,
            world,
            hull,
            legs: [legs[0], legs[1], legs[2], legs[3]],
            joints: [joints[0], joints[1], joints[2], joints[3]],
            fixtures: [
                fixtures[0],
                fixtures[1],
                fixtures[2],
                fixtures[3],
                hull_fixture,
            ],
            terrain_y,
            obstacles,
            clouds,
            game_over: false,
            ground_contact: [false; 2],
            prev_shaping: None,
            lidar: [1.0; LIDAR_RAYS],
            pictures: 0,
            action: Continuous::default(),
        }
    }

    /// Sets the motors to `action`, then steps the world as [`worlds::step`].
    fn begin(&mut self, action: &Continuous<4>, worlds: Option<&mut Worlds>) -> Place {
        for (i, (joint, a)) in self.joints.into_iter().zip(action.numbers).enumerate() {
            let speed = if i % 2 == 0 { SPEED_HIP } else { SPEED_KNEE };
            let direction = if a == 0.0 { 0.0 } else { a.signum() as f32 };
            self.world.set_motor_speed(joint, speed * direction);
            // for an action of `float32`, numpy rounds the product to `float32`; for other actions,
            // Box2D does
            let torque = f64::from(MOTORS_TORQUE) * a.abs().clamp(0.0, 1.0);
            self.world.set_max_motor_torque(joint, torque as f32);
        }
        self.action = *action;
        worlds::step(&mut self.world, FPS, worlds)
    }

    /// Computes observation, reward and end of the episode from the stepped world.
    fn finish(&mut self) -> ([f32; 24], Outcome) {
        for event in self.world.contact_events() {
            self.game_over |= event.begin && event.bodies.contains(&self.hull);
            for (leg, contact) in [1, 3].into_iter().zip(&mut self.ground_contact) {
                if event.bodies.contains(&self.legs[leg]) {
                    *contact = event.begin;
                }
            }
        }
        let pos = self.world.position(self.hull);
        let x = f64::from(pos.x);
        let ends: [Vec2; LIDAR_RAYS] = std::array::from_fn(|i| {
            let end = self.ray_end(i);
            vec2(end[0], end[1])
        });
        let hits = self.world.ray_casts(pos, &ends, GROUND);
        self.lidar = hits.map(|hit| hit.map_or(1.0, |hit| hit.fraction));

        let state = self.observe();
        let mut shaping = 130.0 * x / SCALE; // moving forward
        shaping -= 5.0 * f64::from(self.world.angle(self.hull)).abs(); // keeping the head straight
        // for an action of `float32`, numpy's promotion makes the reward a `float32` from the first
        // motor's cost on
        let single = self.action.precision == Precision::Single;
        let rounded = |x: f64| if single { f64::from(x as f32) } else { x };
        let mut reward = rounded(self.prev_shaping.map_or(0.0, |before| shaping - before));
        self.prev_shaping = Some(shaping);
        let cost = rounded(0.00035 * f64::from(MOTORS_TORQUE));
        for a in self.action.numbers {
            reward = rounded(reward - rounded(cost * a.abs().clamp(0.0, 1.0)));
        }

        let mut terminated = false;
        if self.game_over || x < 0.0 {
            reward = -100.0;
            terminated = true;
        }
        if x > (TERRAIN_LENGTH - TERRAIN_GRASS) as f64 * TERRAIN_STEP {
            terminated = true;
        }
        (
            state,
            Outcome {
                reward,
                terminated,
                truncated: false,
            },
        )
    }

    /// Returns the end of lidar ray `i` for a ray that hits nothing.
    fn ray_end(&self, i: usize) -> Point {
        let pos = self.world.position(self.hull);
        let [right, down] = BEAMS[i];
        [f64::from(pos.x) + right, f64::from(pos.y) - down]
    }

    fn observe(&self) -> [f32; 24] {
        let world = &self.world;
        let vel = world.linear_velocity(self.hull);
        let mut state = [0.0; 24];
        state[0] = f64::from(world.angle(self.hull));
        state[1] = 2.0 * f64::from(world.angular_velocity(self.hull)) / FPS;
        state[2] = 0.3 * f64::from(vel.x) * (VIEWPORT_W / SCALE) / FPS;
        state[3] = 0.3 * f64::from(vel.y) * (VIEWPORT_H / SCALE) / FPS;
        for side in 0..2 {
            let [hip, knee] = [self.joints[2 * side], self.joints[2 * side + 1]];
            let leg = &mut state[4 + 5 * side..];
            leg[0] = f64::from(world.joint_angle(hip));
            leg[1] = f64::from(world.joint_speed(hip)) / f64::from(SPEED_HIP);
            leg[2] = f64::from(world.joint_angle(knee)) + 1.0;
            leg[3] = f64::from(world.joint_speed(knee)) / f64::from(SPEED_KNEE);
            leg[4] = f64::from(self.ground_contact[side]);
        }
        let mut observation = state.map(|x| x as f32);
        observation[14..].copy_from_slice(&self.lidar);
        observation
    }

    fn is_valid(&self) -> bool {
        /// Far above the largest potential of an episode.
        const MAX_SHAPING: f64 = 1e6;
        let world = &self.world;
        world.is_valid()
            && world.has_body(self.hull)
            && self.legs.iter().all(|leg| world.has_body(*leg))
            && self.joints.iter().all(|joint| world.has_joint(*joint))
            && self
                .fixtures
                .iter()
                .chain(&self.obstacles)
                .all(|fixture| world.has_fixture(*fixture))
            && self.terrain_y.len() == TERRAIN_LENGTH
            && self.pictures < LIDAR_CYCLE
            && self
                .prev_shaping
                .is_none_or(|shaping| shaping.abs() <= MAX_SHAPING)
    }

    /// The scroll position of the frame, in m.
    fn scroll(&self) -> f64 {
        f64::from(self.world.position(self.hull).x) - VIEWPORT_W / SCALE / 5.0
    }

    fn draw_ground(&self, canvas: &mut dyn Canvas) {
        let scroll = self.scroll();
        let point = |i: usize| [i as f64 * TERRAIN_STEP, self.terrain_y[i]];
        for i in 0..TERRAIN_LENGTH - 1 {
            let ([x1, y1], [x2, y2]) = (point(i), point(i + 1));
            if x2 >= scroll && x1 <= scroll + VIEWPORT_W / SCALE {
                let ground =
                    [[x1, y1], [x2, y2], [x2, 0.0], [x1, 0.0]].map(|p| p.map(|x| x * SCALE));
                shapes::draw_polygon(canvas, &ground, Color::rgb(102, 153, 76));
            }
        }
    }

    /// Draws one lidar ray per frame: first to last, then last to first, then none until the end of
    /// the cycle.
    fn draw_lidar(&self, canvas: &mut dyn Canvas) {
        let i = (self.pictures + 1) % LIDAR_CYCLE;
        if i >= 2 * LIDAR_RAYS {
            return;
        }
        let i = if i < LIDAR_RAYS {
            i
        } else {
            2 * LIDAR_RAYS - 1 - i
        };
        let (p1, end, fraction) = (
            self.world.position(self.hull),
            self.ray_end(i),
            self.lidar[i],
        );
        let p2 = if fraction < 1.0 {
            // the point at which the engine's ray meets the ground
            let end = vec2(end[0], end[1]);
            [
                (1.0 - fraction) * p1.x + fraction * end.x,
                (1.0 - fraction) * p1.y + fraction * end.y,
            ]
            .map(f64::from)
        } else {
            end
        };
        let points = [[p1.x, p1.y].map(f64::from), p2].map(|p| p.map(|x| x * SCALE));
        canvas.pygame(
            Primitive::Lines {
                points: &points,
                closed: false,
                width: 1,
            },
            Color::rgb(255, 0, 0),
        );
    }

    /// Draws the edges of the ground and the obstacles on it, last first.
    fn draw_terrain(&self, canvas: &mut dyn Canvas) {
        for i in (0..TERRAIN_LENGTH - 1).rev() {
            // rounded to `f32`, as in the world
            let point = |i: usize| {
                let at = vec2(i as f64 * TERRAIN_STEP, self.terrain_y[i]);
                [at.x, at.y].map(|x| f64::from(x * SCALE as f32))
            };
            let green = if i % 2 == 0 { 255 } else { 204 };
            let points = [point(i), point(i + 1)];
            canvas.pygame(
                Primitive::AaLines {
                    points: &points,
                    closed: false,
                },
                Color::rgb(76, green, 76),
            );
        }
        for fixture in self.obstacles.iter().rev() {
            self.draw_body(canvas, *fixture, [(255, 255, 255), (153, 153, 153)]);
        }
    }

    fn draw_body(&self, canvas: &mut dyn Canvas, fixture: FixtureId, colors: [(u8, u8, u8); 2]) {
        let (mut corners, count) = shapes::pixel_corners(&self.world, fixture, SCALE);
        let [fill, outline] = colors.map(|(r, g, b)| Color::rgb(r, g, b));
        shapes::draw_polygon(canvas, &corners[..count], fill);
        canvas.pygame(
            Primitive::Lines {
                points: &corners[..count],
                closed: true,
                width: 1,
            },
            outline,
        );
        // repeat the first corner: pygame then draws its pixel in full colour
        corners[count] = corners[0];
        canvas.pygame(Primitive::AaPolygon(&corners[..=count]), outline);
    }

    fn draw_walker(&self, canvas: &mut dyn Canvas) {
        let colors = [
            (178, 101, 152),
            (178, 101, 152),
            (128, 51, 102),
            (128, 51, 102),
            (127, 51, 229),
        ];
        let outlines = [
            (127, 76, 101),
            (127, 76, 101),
            (77, 26, 51),
            (77, 26, 51),
            (76, 76, 127),
        ];
        for ((fixture, fill), outline) in self.fixtures.iter().zip(colors).zip(outlines) {
            self.draw_body(canvas, *fixture, [fill, outline]);
        }
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

    fn step_into(
        &mut self,
        action: &Continuous<4>,
        observation: &mut [f32; 24],
    ) -> Result<Outcome> {
        let begun = self
            .ahead
            .take()
            .is_some_and(|ahead| ahead.call == Call::Step);
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
        let Some(episode) = &self.episode else { return };
        let scroll = episode.scroll();
        canvas.clear(Color::BLACK);
        // Gymnasium draws a wider image, from the start of the ground, and crops the image to its
        // right end
        let left = (VIEWPORT_W + scroll.max(0.0) * SCALE).trunc() - VIEWPORT_W;
        canvas.push(Transform::translate(-left, 0.0));
        canvas.push(pygame::flipped(VIEWPORT_H));
        // truncate to whole pixels as pygame does, so that the sky begins at the edge at any size
        let sky_left = (scroll * SCALE).trunc();
        let sky = pygame::corners([sky_left, 0.0], [sky_left + VIEWPORT_W, VIEWPORT_H]);
        let [a, b, c, d] = sky;
        canvas.pygame(Primitive::Polygon(&[a, d, c, b]), Color::rgb(215, 215, 255));
        for cloud in &episode.clouds {
            let (left, right) = cloud
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), [x, _]| {
                    (low.min(*x), high.max(*x))
                });
            // clouds scroll at half speed
            if right >= scroll / 2.0 && left <= scroll / 2.0 + VIEWPORT_W / SCALE {
                let cloud = cloud.map(|[x, y]| [x * SCALE + scroll * SCALE / 2.0, y * SCALE]);
                shapes::draw_polygon(canvas, &cloud, Color::WHITE);
            }
        }
        episode.draw_ground(canvas);
        episode.draw_lidar(canvas);
        episode.draw_terrain(canvas);
        episode.draw_walker(canvas);
        let (x, bottom) = (TERRAIN_STEP * 3.0 * SCALE, TERRAIN_HEIGHT * SCALE);
        let top = bottom + 50.0;
        let pole = Primitive::AaLines {
            points: &[[x, bottom], [x, top]],
            closed: false,
        };
        canvas.pygame(pole, Color::BLACK);
        let flag = [[x, top], [x, top - 10.0], [x + 25.0, top - 5.0]];
        canvas.pygame(Primitive::Polygon(&flag), Color::rgb(230, 51, 0));
        canvas.pygame(
            Primitive::Lines {
                points: &flag,
                closed: true,
                width: 1,
            },
            Color::BLACK,
        );
        canvas.pop();
        canvas.pop();
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
        let place = self.begin_episode(reset, Some(worlds));
        self.ahead = place.ok().map(|place| Ahead {
            call: Call::Reset,
            place,
        });
    }

    fn begin_step(&mut self, action: &Continuous<4>, worlds: &mut Worlds) {
        let possible = action.is_finite();
        let episode = self.episode.as_mut().filter(|_| possible);
        let place = episode.map(|episode| episode.begin(action, Some(worlds)));
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
/// The registration shared by all ids.
const fn walker(id: &'static str) -> Registration {
    Registration::new::<BipedalWalker>(id)
        .description("Walk on two legs over slightly uneven ground.")
        .exceptions(&[WORLD])
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
