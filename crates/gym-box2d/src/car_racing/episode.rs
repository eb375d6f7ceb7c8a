//! The world of an episode: how it is made, and what a step is worth.

use gym_core::exact::is_finite;
use gym_core::{Generator, Outcome};

use super::car::Car;
use super::{
    Action, Colors, Config, DISCRETE_BRAKE, DISCRETE_GAS, DISCRETE_STEER, Drive, Episode, FPS,
    LEAVING_REWARD, PLAYFIELD, STEP_COST, State, TRACK_REWARD, track,
};
use crate::physics::{BodyDef, BodyId, FixtureDef, Shape, Vec2, World};
use crate::shapes::points;
use crate::worlds::{POSITION_ITERATIONS, VELOCITY_ITERATIONS};

impl Episode {
    /// Makes track, tiles and car, in Gymnasium's order of random draws and creation.
    pub(super) fn new(config: &Config, mut rng: Generator, colors: Colors) -> Self {
        let mut world = World::with(config.physics, Vec2::zeros());
        let track = track::generate(&mut rng);
        let tiles = track::tiles(&track);
        let tile_bodies = tiles
            .iter()
            .map(|tile| {
                let body = world.create_body(&BodyDef::fixed(Vec2::zeros(), 0.0));
                let shape = Shape::Polygon(points(&tile.road, |x| x));
                world.create_fixture(
                    body,
                    &FixtureDef {
                        sensor: true,
                        ..FixtureDef::new(shape)
                    },
                );
                body
            })
            .collect();
        let car = Car::new(&mut world, &track[0]);
        Self {
            rng,
            world,
            colors,
            visited: vec![false; tiles.len()],
            touched: vec![false; tiles.len()],
            track,
            tiles,
            tile_bodies,
            tile_visited_count: 0,
            lap_complete_percent: config.lap_complete_percent,
            car,
            reward: 0.0,
            prev_reward: 0.0,
            observed_reward: 0.0,
            t: 0.0,
            new_lap: false,
            lap_finished: None,
        }
    }

    /// Takes one step. `action` is `None` for the step that is part of a reset.
    pub(super) fn advance(&mut self, version: u32, action: Option<&Action>) -> Outcome {
        if let Some(action) = action {
            let (steer, gas, brake) = match *action {
                Action::Pedals(pedals) => {
                    let [steer, gas, brake] = pedals.numbers;
                    (-steer, gas, brake)
                }
                Action::Drive(Drive::Idle) => (0.0, 0.0, 0.0),
                Action::Drive(Drive::Right) => (-DISCRETE_STEER, 0.0, 0.0),
                Action::Drive(Drive::Left) => (DISCRETE_STEER, 0.0, 0.0),
                Action::Drive(Drive::Gas) => (0.0, DISCRETE_GAS, 0.0),
                Action::Drive(Drive::Brake) => (0.0, 0.0, DISCRETE_BRAKE),
            };
            self.car.steer(steer);
            self.car.gas(gas);
            self.car.brake(brake);
        }
        self.car.step(&mut self.world, 1.0 / FPS);
        self.world
            .step((1.0 / FPS) as f32, VELOCITY_ITERATIONS, POSITION_ITERATIONS);
        self.touch_tiles();
        self.t += 1.0 / FPS;
        self.observed_reward = self.reward;

        let mut outcome = Outcome::default();
        self.lap_finished = None;
        if action.is_some() {
            self.reward -= STEP_COST;
            outcome.reward = self.reward - self.prev_reward;
            self.prev_reward = self.reward;
            if self.tile_visited_count == self.track.len() || self.new_lap {
                outcome.terminated = version != 2;
                outcome.truncated = version == 2;
                self.lap_finished = Some(true);
            }
            let position = self.world.position(self.car.hull);
            if f64::from(position.x).abs() > PLAYFIELD || f64::from(position.y).abs() > PLAYFIELD {
                outcome.terminated = true;
                self.lap_finished = Some(false);
                outcome.reward = LEAVING_REWARD;
            }
        }
        outcome
    }

    /// Updates the tiles that each wheel touches, and counts newly visited tiles.
    fn touch_tiles(&mut self) {
        let tiles = self.track.len() as f64;
        for event in self.world.contact_events() {
            let tile_of = |body: &BodyId| {
                self.tile_bodies
                    .binary_search_by_key(&body.index(), BodyId::index)
                    .ok()
            };
            let [a, b] = &event.bodies;
            let (tile, other) = match (tile_of(a), tile_of(b)) {
                (Some(tile), _) => (tile, b),
                (None, Some(tile)) => (tile, a),
                (None, None) => continue,
            };
            self.touched[tile] = true;
            let Some(wheel) = self
                .car
                .wheels
                .iter_mut()
                .find(|wheel| wheel.body == *other)
            else {
                continue;
            };
            if !event.begin {
                wheel.tiles = wheel.tiles.saturating_sub(1);
                continue;
            }
            wheel.tiles += 1;
            if !self.visited[tile] {
                self.visited[tile] = true;
                self.reward += TRACK_REWARD / tiles;
                self.tile_visited_count += 1;
                // the lap counts if more than this share of the tiles was visited
                if tile == 0 && self.tile_visited_count as f64 / tiles > self.lap_complete_percent {
                    self.new_lap = true;
                }
            }
        }
    }

    pub(super) fn state(&self) -> State {
        let (world, hull) = (&self.world, self.car.hull);
        let (position, velocity) = (world.position(hull), world.linear_velocity(hull));
        let (angle, w) = (world.angle(hull), world.angular_velocity(hull));
        let wheels = [0, 1, 2, 3].map(|i| {
            let wheel = &self.car.wheels[i];
            [
                f64::from(world.joint_angle(wheel.joint)),
                wheel.omega,
                wheel.phase,
            ]
        });
        State {
            hull: [position.x, position.y, angle, velocity.x, velocity.y, w].map(f64::from),
            wheels,
            tiles_visited: self.tile_visited_count,
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        let n = self.track.len();
        is_finite(self)
            && self.world.is_valid()
            && n > 0
            && [
                self.tiles.len(),
                self.tile_bodies.len(),
                self.visited.len(),
                self.touched.len(),
            ] == [n; 4]
            && self.tile_visited_count == self.visited.iter().filter(|visited| **visited).count()
            && self.car.is_valid(&self.world, n)
    }
}
