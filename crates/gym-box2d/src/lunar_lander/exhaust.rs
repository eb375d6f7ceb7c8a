//! The particles of the engines' exhaust: bodies that only frames show.
//!
//! In Gymnasium they are bodies of the lander's world while a render mode is set. They collide only
//! with the ground and never affect the lander, so here they have a world of their own, with the
//! same ground.

use serde::{Deserialize, Serialize};

use super::{CHUNKS, FPS, SCALE, W, chunk_x};
use crate::physics::{BodyDef, BodyId, Filter, FixtureDef, Shape, Vec2, World};
use crate::shapes::vec2;
use crate::worlds::{POSITION_ITERATIONS, VELOCITY_ITERATIONS};

/// The radius of a particle, in m.
pub(super) const RADIUS: f32 = (2.0 / SCALE) as f32;
/// The decrease of the time to live per frame.
const FADING: f64 = 0.15;

/// Adds the ground to `world`.
pub(super) fn create_moon(world: &mut World, smooth_y: &[f64; CHUNKS]) {
    let moon = world.create_body(&BodyDef::fixed(Vec2::zeros(), 0.0));
    world.create_fixture(
        moon,
        &FixtureDef::new(Shape::Edge(Vec2::zeros(), vec2(W, 0.0))),
    );
    for i in 0..CHUNKS - 1 {
        let edge = Shape::Edge(
            vec2(chunk_x(i), smooth_y[i]),
            vec2(chunk_x(i + 1), smooth_y[i + 1]),
        );
        world.create_fixture(
            moon,
            &FixtureDef {
                friction: 0.1,
                ..FixtureDef::new(edge)
            },
        );
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Exhaust {
    world: World,
    /// Oldest first.
    particles: Vec<Particle>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Particle {
    body: BodyId,
    /// Time to live. The oldest particle is removed once `ttl` is below 0.
    ttl: f64,
}

impl Exhaust {
    pub(super) fn new(gravity: f64, smooth_y: &[f64; CHUNKS]) -> Self {
        let mut world = World::new(vec2(0.0, gravity));
        create_moon(&mut world, smooth_y);
        Self {
            world,
            particles: Vec::with_capacity(32),
        }
    }

    /// Adds a particle that an engine emits.
    pub(super) fn emit(&mut self, position: Vec2, impulse: Vec2, density: f64, power: f64) {
        let body = self.world.create_body(&BodyDef::dynamic(position, 0.0));
        let shape = Shape::Circle {
            center: Vec2::zeros(),
            radius: RADIUS,
        };
        self.world.create_fixture(
            body,
            &FixtureDef {
                density: density as f32,
                friction: 0.1,
                restitution: 0.3,
                filter: Filter {
                    category: 0x0100,
                    mask: 0x001,
                }, // collides with the ground only
                ..FixtureDef::new(shape)
            },
        );
        self.world.apply_linear_impulse(body, impulse, position);
        self.particles.push(Particle { body, ttl: power });
    }

    pub(super) fn step(&mut self) {
        self.world
            .step((1.0 / FPS) as f32, VELOCITY_ITERATIONS, POSITION_ITERATIONS);
    }

    /// Iterates over the position and time to live of each particle in the next frame.
    pub(super) fn visible(&self) -> impl Iterator<Item = (Vec2, f64)> + '_ {
        let faded = self
            .particles
            .iter()
            .map(|particle| (self.world.position(particle.body), particle.ttl - FADING));
        faded.skip_while(|(_, ttl)| *ttl < 0.0)
    }

    /// Updates the particles after a frame.
    pub(super) fn fade(&mut self) {
        self.particles
            .iter_mut()
            .for_each(|particle| particle.ttl -= FADING);
        let gone = self
            .particles
            .iter()
            .take_while(|particle| particle.ttl < 0.0)
            .count();
        for particle in self.particles.drain(..gone) {
            self.world.destroy_body(particle.body);
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        self.world.is_valid()
            && self
                .particles
                .iter()
                .all(|particle| self.world.has_body(particle.body))
    }
}
