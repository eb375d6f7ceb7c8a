//! The ground, stretch by stretch: grass and, in the hardcore version, stumps, stairs and pits.

use gym_core::Generator;
use gym_core::canvas::Point;

use super::{
    FRICTION, SCALE, TERRAIN_GRASS, TERRAIN_HEIGHT, TERRAIN_LENGTH, TERRAIN_STARTPAD, TERRAIN_STEP,
};
use crate::physics::{BodyDef, FixtureDef, FixtureId, Shape, Vec2, World};
use crate::shapes::{points, sign, vec2};

/// A stretch of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stretch {
    Grass,
    Stump,
    Stairs,
    Pit,
}

/// Builds the ground: heights, and obstacles in the order of their creation.
pub(super) struct Ground<'a> {
    rng: &'a mut Generator,
    world: &'a mut World,
    /// Heights, one per [`TERRAIN_STEP`].
    pub(super) terrain_y: Vec<f64>,
    /// Fixtures of stumps, stairs and the walls of pits.
    pub(super) obstacles: Vec<FixtureId>,
}

impl<'a> Ground<'a> {
    /// Draws a random ground and creates it in `world`.
    pub(super) fn new(rng: &'a mut Generator, world: &'a mut World, hardcore: bool) -> Self {
        let mut ground = Self {
            rng,
            world,
            terrain_y: Vec::with_capacity(TERRAIN_LENGTH),
            obstacles: Vec::new(),
        };
        ground.generate(hardcore);
        ground
    }

    fn obstacle(&mut self, poly: [Point; 4]) {
        let body = self.world.create_body(&BodyDef::fixed(Vec2::zeros(), 0.0));
        let shape = Shape::Polygon(points(&poly, |x| x));
        let fixture = self.world.create_fixture(
            body,
            &FixtureDef {
                friction: FRICTION,
                ..FixtureDef::new(shape)
            },
        );
        self.obstacles.push(fixture);
    }

    fn generate(&mut self, hardcore: bool) {
        let mut state = Stretch::Grass;
        let mut velocity = 0.0;
        let mut y = TERRAIN_HEIGHT;
        let mut counter = TERRAIN_STARTPAD as i64;
        let mut first = false; // whether this step begins a stretch
        let (mut stair_steps, mut stair_width, mut stair_height) = (0, 0, 0);
        let mut original_y = 0.0;
        for i in 0..TERRAIN_LENGTH {
            let x = i as f64 * TERRAIN_STEP;
            match (state, first) {
                (Stretch::Grass, false) => {
                    velocity = 0.8 * velocity + 0.01 * sign(TERRAIN_HEIGHT - y);
                    if i > TERRAIN_STARTPAD {
                        velocity += self.rng.uniform(-1.0, 1.0) / SCALE;
                    }
                    y += velocity;
                }
                (Stretch::Grass, true) => {}
                (Stretch::Pit, true) => {
                    counter = self.rng.integers(3, 5);
                    let bottom = y - 4.0 * TERRAIN_STEP;
                    let poly = [
                        [x, y],
                        [x + TERRAIN_STEP, y],
                        [x + TERRAIN_STEP, bottom],
                        [x, bottom],
                    ];
                    self.obstacle(poly);
                    self.obstacle(poly.map(|[x, y]| [x + TERRAIN_STEP * counter as f64, y]));
                    counter += 2;
                    original_y = y;
                }
                (Stretch::Pit, false) => {
                    y = original_y;
                    if counter > 1 {
                        y -= 4.0 * TERRAIN_STEP;
                    }
                }
                (Stretch::Stump, true) => {
                    counter = self.rng.integers(1, 3);
                    let (right, top) = (
                        x + counter as f64 * TERRAIN_STEP,
                        y + counter as f64 * TERRAIN_STEP,
                    );
                    self.obstacle([[x, y], [right, y], [right, top], [x, top]]);
                }
                (Stretch::Stump, false) => {}
                (Stretch::Stairs, true) => {
                    stair_height = if self.rng.random() > 0.5 { 1 } else { -1 };
                    stair_width = self.rng.integers(4, 5);
                    stair_steps = self.rng.integers(3, 5);
                    original_y = y;
                    for s in 0..stair_steps {
                        let left = x + (s * stair_width) as f64 * TERRAIN_STEP;
                        let right = x + ((1 + s) * stair_width) as f64 * TERRAIN_STEP;
                        let top = y + (s * stair_height) as f64 * TERRAIN_STEP;
                        let bottom = y + (-1 + s * stair_height) as f64 * TERRAIN_STEP;
                        self.obstacle([[left, top], [right, top], [right, bottom], [left, bottom]]);
                    }
                    counter = stair_steps * stair_width;
                }
                (Stretch::Stairs, false) => {
                    let s = stair_steps * stair_width - counter - stair_height;
                    let n = s as f64 / stair_width as f64;
                    y = original_y + (n * stair_height as f64) * TERRAIN_STEP;
                }
            }
            first = false;
            self.terrain_y.push(y);
            counter -= 1;
            if counter == 0 {
                counter = self
                    .rng
                    .integers(TERRAIN_GRASS as i64 / 2, TERRAIN_GRASS as i64);
                state = if state == Stretch::Grass && hardcore {
                    [Stretch::Stump, Stretch::Stairs, Stretch::Pit]
                        [self.rng.integers(1, 4) as usize - 1]
                } else {
                    Stretch::Grass
                };
                first = true;
            }
        }
        let at = |(i, y): (usize, &f64)| vec2(i as f64 * TERRAIN_STEP, *y);
        let points: Vec<Vec2> = self.terrain_y.iter().enumerate().map(at).collect();
        self.world.create_terrain(&points, FRICTION);
    }
}
