//! The world of an episode: how it is made, how the engines and the wind push, and what a step is
//! worth.

use std::f64::consts::PI;

use gym_core::canvas::Point;
use gym_core::exact::is_finite;
use gym_core::math::{cos, sin, tanh};
use gym_core::{Generator, Outcome};

use super::exhaust::{self, Exhaust};
use super::{
    Action, CHUNKS, Config, Engine, Episode, FPS, H, HELIPAD_Y, INITIAL_RANDOM, LANDER_POLY,
    LEG_AWAY, LEG_DOWN, LEG_H, LEG_SPRING_TORQUE, LEG_W, MAIN_ENGINE_POWER, MAIN_ENGINE_Y_LOCATION,
    SCALE, SIDE_ENGINE_AWAY, SIDE_ENGINE_HEIGHT, SIDE_ENGINE_POWER, VIEWPORT_H, VIEWPORT_W,
};
use crate::physics::{BodyDef, Filter, FixtureDef, Place, RevoluteJointDef, Shape, Vec2, World};
use crate::shapes::{points, vec2};
use crate::worlds::{self, Worlds};

impl Episode {
    /// Makes ground, lander and legs, in Gymnasium's order of random draws and creation.
    pub(super) fn new(config: &Config, version: u32, mut rng: Generator) -> Self {
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
    pub(super) fn begin(
        &mut self,
        config: &Config,
        action: &Action,
        worlds: Option<&mut Worlds>,
    ) -> Place {
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
    pub(super) fn finish(&mut self) -> ([f32; 8], Outcome) {
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

    pub(super) fn is_valid(&self) -> bool {
        /// Far above the potential of any position and speed.
        const MAX_SHAPING: f64 = 1e6;
        let [a, b] = self.legs;
        is_finite(self)
            && self.world.is_valid()
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
    pub(super) fn render(&mut self, config: &Config, renders: bool) {
        if !renders {
            self.exhaust = None;
        } else if self.exhaust.is_none() {
            self.exhaust = Some(Exhaust::new(config.gravity, &self.smooth_y));
        }
    }
}
