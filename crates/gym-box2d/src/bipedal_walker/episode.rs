//! The world of an episode: how it is made, how the motors drive it, and what a step is worth.

use gym_core::canvas::Point;
use gym_core::exact::is_finite;
use gym_core::math::{cos, sin};
use gym_core::{Continuous, Generator, Outcome, Precision};

use super::ground::Ground;
use super::{
    BEAMS, Config, Episode, FPS, GROUND, HULL_POLY, INITIAL_RANDOM, LEG_DOWN, LEG_H, LEG_W,
    LIDAR_CYCLE, LIDAR_RAYS, MOTORS_TORQUE, SCALE, SPEED_HIP, SPEED_KNEE, TERRAIN_GRASS,
    TERRAIN_HEIGHT, TERRAIN_LENGTH, TERRAIN_STARTPAD, TERRAIN_STEP, VIEWPORT_H, VIEWPORT_W, WALKER,
};
use crate::physics::{BodyDef, FixtureDef, Place, RevoluteJointDef, Shape, Vec2, World};
use crate::shapes::{points, vec2};
use crate::worlds::{self, Worlds};

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
    pub(super) fn new(config: Config, mut rng: Generator) -> Self {
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
    pub(super) fn begin(&mut self, action: &Continuous<4>, worlds: Option<&mut Worlds>) -> Place {
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
    pub(super) fn finish(&mut self) -> ([f32; 24], Outcome) {
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
    pub(super) fn ray_end(&self, i: usize) -> Point {
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

    pub(super) fn is_valid(&self) -> bool {
        /// Far above the largest potential of an episode.
        const MAX_SHAPING: f64 = 1e6;
        let world = &self.world;
        is_finite(self)
            && world.is_valid()
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
}
