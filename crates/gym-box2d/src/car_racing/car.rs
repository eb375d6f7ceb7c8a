//! The car: a hull on four wheels that roll, slip and brake (`envs/box2d/car_dynamics.py`).

use serde::{Deserialize, Serialize};

use super::track::TrackPoint;
use crate::physics::{
    BodyDef, BodyId, Filter, FixtureDef, FixtureId, JointId, RevoluteJointDef, Shape, Vec2, World,
};
use crate::shapes::{points, sign, vec2};

// The constants and the order of arithmetic are those of `car_dynamics.py`.

const SIZE: f64 = 0.02;
const ENGINE_POWER: f64 = 100000000.0 * SIZE * SIZE;
const WHEEL_MOMENT_OF_INERTIA: f64 = 4000.0 * SIZE * SIZE;
/// Friction is proportional to mass, and mass to size².
const FRICTION_LIMIT: f64 = 1000000.0 * SIZE * SIZE;
/// Force per m/s of slip.
const GRIP: f64 = 205000.0 * SIZE * SIZE;
/// The deceleration of a wheel by its brake, in rad/s per step.
const BRAKE_FORCE: f64 = 15.0;
/// The brake at which a wheel locks.
const LOCKING_BRAKE: f64 = 0.9;
/// The largest increase of a wheel's throttle per step.
const GAS_RISE: f64 = 0.1;
/// The number added to a wheel's angular velocity, in rad/s, before the engine's power is divided
/// by the velocity.
const MIN_OMEGA: f64 = 5.0;
/// The friction limit on grass, as a fraction of the road's.
const GRASS_FRICTION: f64 = 0.6;
/// The force, relative to the friction limit, above which a wheel leaves a skid mark.
const SKID_FORCE: f64 = 2.0;
/// The largest angle of a front wheel, in rad.
const MAX_STEER: f32 = 0.4;
/// The steering speed per rad of remaining turn, in rad/s.
const STEER_GAIN: f64 = 50.0;
/// The largest steering speed, in rad/s.
const STEER_SPEED: f64 = 3.0;
const STEER_TORQUE: f64 = 180.0 * 900.0 * SIZE * SIZE;
/// The angle that the stripe on a wheel covers, in rad.
const STRIPE_ANGLE: f64 = 1.2;
const WHEEL_R: f64 = 27.0;
const WHEEL_W: f64 = 14.0;
const WHEEL_RAD: f64 = 1.0 * WHEEL_R * SIZE;
const WHEELPOS: [[f64; 2]; 4] = [[-55.0, 80.0], [55.0, 80.0], [-55.0, -82.0], [55.0, -82.0]];
const HULL_POLY1: [[f64; 2]; 4] = [[-60.0, 130.0], [60.0, 130.0], [60.0, 110.0], [-60.0, 110.0]];
const HULL_POLY2: [[f64; 2]; 4] = [[-15.0, 120.0], [15.0, 120.0], [20.0, 20.0], [-20.0, 20.0]];
const HULL_POLY3: [[f64; 2]; 8] = [
    [25.0, 20.0],
    [50.0, -10.0],
    [50.0, -40.0],
    [20.0, -90.0],
    [-20.0, -90.0],
    [-50.0, -40.0],
    [-50.0, -10.0],
    [-25.0, 20.0],
];
const HULL_POLY4: [[f64; 2]; 4] = [
    [-50.0, -120.0],
    [50.0, -120.0],
    [50.0, -90.0],
    [-50.0, -90.0],
];
const WHEEL_POLY: [[f64; 2]; 4] = [
    [-WHEEL_W, WHEEL_R],
    [WHEEL_W, WHEEL_R],
    [WHEEL_W, -WHEEL_R],
    [-WHEEL_W, -WHEEL_R],
];

/// A wheel.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Wheel {
    pub(super) body: BodyId,
    pub(super) joint: JointId,
    pub(super) fixture: FixtureId,
    gas: f64,
    brake: f64,
    steer: f64,
    /// The angle that the wheel has rolled, in rad.
    pub(super) phase: f64,
    /// The angular velocity of rolling, in rad/s.
    pub(super) omega: f64,
    /// The number of road tiles that the wheel touches.
    pub(super) tiles: u32,
    skid: Skidding,
}

/// The state of the skid mark that a wheel draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Skidding {
    /// Whether the wheel slipped in the previous step, but has not begun a mark.
    slips: bool,
    /// The number of the mark that the wheel draws.
    #[serde(deserialize_with = "Option::deserialize")]
    mark: Option<u64>,
}

/// The mark of a skidding wheel: a line.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct SkidMark {
    pub(super) on_grass: bool,
    pub(super) points: Vec<[f64; 2]>,
    number: u64,
}

/// The number of marks that are kept (`car_dynamics.py`).
const MARKS: usize = 30;
/// An upper bound for snapshots, far above the number of marks in an episode.
const MAX_MARKS_MADE: u64 = 1 << 48;
/// The points of a mark.
pub(super) const MARK_POINTS: usize = 30;

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Car {
    pub(super) hull: BodyId,
    pub(super) hull_fixtures: [FixtureId; 4],
    /// Front left, front right, rear left, rear right.
    pub(super) wheels: [Wheel; 4],
    /// The skid marks, oldest first; empty until a wheel draws them.
    pub(super) marks: Vec<SkidMark>,
    marks_made: u64,
}

impl Car {
    pub(super) fn new(world: &mut World, start: &TrackPoint) -> Self {
        let angle = start.beta as f32;
        let hull = world.create_body(&BodyDef::dynamic(vec2(start.x, start.y), angle));
        let polys: [&[[f64; 2]]; 4] = [&HULL_POLY1, &HULL_POLY2, &HULL_POLY3, &HULL_POLY4];
        let hull_fixtures = polys.map(|poly| {
            let shape = Shape::Polygon(points(poly, |x| x * SIZE));
            world.create_fixture(
                hull,
                &FixtureDef {
                    density: 1.0,
                    ..FixtureDef::new(shape)
                },
            )
        });
        let wheels = WHEELPOS.map(|[wx, wy]| {
            let position = vec2(start.x + wx * SIZE, start.y + wy * SIZE);
            let body = world.create_body(&BodyDef::dynamic(position, angle));
            let shape = Shape::Polygon(points(&WHEEL_POLY, |x| x * 1.0 * SIZE));
            let filter = Filter {
                category: 0x0020,
                mask: 0x001,
            };
            let fixture = world.create_fixture(
                body,
                &FixtureDef {
                    density: 0.1,
                    filter,
                    ..FixtureDef::new(shape)
                },
            );
            let joint = world.create_revolute_joint(&RevoluteJointDef {
                body_a: hull,
                body_b: body,
                local_anchor_a: vec2(wx * SIZE, wy * SIZE),
                local_anchor_b: Vec2::zeros(),
                limits: Some((-MAX_STEER, MAX_STEER)),
                motor: true,
                motor_speed: 0.0,
                max_motor_torque: STEER_TORQUE as f32,
                collide_connected: false,
            });
            let (gas, brake, steer, phase, omega) = (0.0, 0.0, 0.0, 0.0, 0.0);
            Wheel {
                body,
                joint,
                fixture,
                gas,
                brake,
                steer,
                phase,
                omega,
                tiles: 0,
                skid: Skidding::default(),
            }
        });
        let no_mark = || SkidMark {
            on_grass: false,
            points: Vec::with_capacity(MARK_POINTS),
            number: u64::MAX,
        };
        let marks = std::iter::repeat_with(no_mark).take(MARKS).collect();
        Self {
            hull,
            hull_fixtures,
            wheels,
            marks,
            marks_made: 0,
        }
    }

    /// Sets the throttle of the rear wheels. An increase takes effect slowly, a decrease at once.
    pub(super) fn gas(&mut self, gas: f64) {
        let gas = gas.clamp(0.0, 1.0);
        for wheel in &mut self.wheels[2..] {
            wheel.gas += (gas - wheel.gas).min(GAS_RISE);
        }
    }

    /// Sets the brake of all wheels; a wheel locks at [`LOCKING_BRAKE`] or more.
    pub(super) fn brake(&mut self, brake: f64) {
        for wheel in &mut self.wheels {
            wheel.brake = brake;
        }
    }

    /// Sets the target angle of the front wheels, in rad. The wheels turn towards the target over
    /// several steps.
    pub(super) fn steer(&mut self, steer: f64) {
        for wheel in &mut self.wheels[..2] {
            wheel.steer = steer;
        }
    }

    /// Steers, drives and brakes each wheel, and applies the friction of its surface.
    pub(super) fn step(&mut self, world: &mut World, dt: f64) {
        for i in 0..self.wheels.len() {
            let wheel = &mut self.wheels[i];
            let turn = wheel.steer - f64::from(world.joint_angle(wheel.joint));
            world.set_motor_speed(
                wheel.joint,
                (sign(turn) * (STEER_GAIN * turn.abs()).min(STEER_SPEED)) as f32,
            );

            let on_grass = wheel.tiles == 0;
            let friction_limit = if on_grass {
                FRICTION_LIMIT * GRASS_FRICTION
            } else {
                FRICTION_LIMIT
            };

            let rotation = world.pose(wheel.body).rotation;
            let (sin, cos) = (f64::from(rotation.im), f64::from(rotation.re));
            let (forw, side) = ([-sin, cos], [cos, sin]);
            let v = world.linear_velocity(wheel.body);
            let v = [f64::from(v.x), f64::from(v.y)];
            let vf = forw[0] * v[0] + forw[1] * v[1]; // forward speed
            let vs = side[0] * v[0] + side[1] * v[1]; // side speed

            // power = moment of inertia * omega * domega/dt, kept finite at rest
            wheel.omega += dt * ENGINE_POWER * wheel.gas
                / WHEEL_MOMENT_OF_INERTIA
                / (wheel.omega.abs() + MIN_OMEGA);
            if wheel.brake >= LOCKING_BRAKE {
                wheel.omega = 0.0;
            } else if wheel.brake > 0.0 {
                let val = BRAKE_FORCE * wheel.brake;
                let val = if val.abs() > wheel.omega.abs() {
                    wheel.omega.abs()
                } else {
                    val
                };
                wheel.omega += -sign(wheel.omega) * val;
            }
            wheel.phase += wheel.omega * dt;

            let vr = wheel.omega * WHEEL_RAD; // speed of the tyre's rim
            let mut f_force = (-vf + vr) * GRIP;
            let mut p_force = -vs * GRIP;
            let force = (f_force * f_force + p_force * p_force).sqrt();
            let slips = force.abs() > SKID_FORCE * friction_limit;
            if force.abs() > friction_limit {
                f_force /= force;
                p_force /= force;
                f_force *= friction_limit;
                p_force *= friction_limit;
            }
            wheel.omega -= dt * f_force * WHEEL_RAD / WHEEL_MOMENT_OF_INERTIA;
            let push = vec2(
                p_force * side[0] + f_force * forw[0],
                p_force * side[1] + f_force * forw[1],
            );
            world.apply_force_to_center(wheel.body, push);

            let position = world.position(wheel.body);
            self.skid(
                i,
                slips.then_some([f64::from(position.x), f64::from(position.y)]),
                on_grass,
            );
        }
    }

    /// Extends the mark of `wheel` to the position `slips`. `None` ends the mark.
    fn skid(&mut self, wheel: usize, slips: Option<[f64; 2]>, on_grass: bool) {
        let skid = &mut self.wheels[wheel].skid;
        let Some(position) = slips else {
            *skid = Skidding::default();
            return;
        };
        let mark = skid
            .mark
            .and_then(|number| self.marks.iter_mut().find(|mark| mark.number == number));
        if let Some(mark) = mark
            && mark.on_grass == on_grass
            && mark.points.len() < MARK_POINTS
        {
            mark.points.push(position);
        } else if std::mem::take(&mut skid.slips) {
            let number = self.marks_made;
            skid.mark = Some(number);
            self.marks_made += 1;
            // reuse the oldest mark's allocation
            self.marks.rotate_left(1);
            if let Some(mark) = self.marks.last_mut() {
                (mark.on_grass, mark.number) = (on_grass, number);
                mark.points.clear();
                // (Gymnasium means to begin at the wheel's previous position, but has already
                // overwritten this position)
                mark.points.extend([position, position]);
            }
        } else {
            skid.slips = true;
        }
    }

    /// Returns the white stripe on `wheel`, in the wheel's coordinates, if its phase makes it
    /// visible.
    pub(super) fn stripe(wheel: &Wheel) -> Option<[[f64; 2]; 4]> {
        let ends = [wheel.phase, wheel.phase + STRIPE_ANGLE].map(gym_core::math::sin_cos);
        if ends.iter().all(|(sin, _)| *sin > 0.0) {
            return None;
        }
        let [c1, c2] = ends.map(|(sin, cos)| if sin > 0.0 { sign(cos) } else { cos });
        let corner = |x: f64, c: f64| [x * SIZE, WHEEL_R * c * SIZE];
        Some([
            corner(-WHEEL_W, c1),
            corner(WHEEL_W, c1),
            corner(WHEEL_W, c2),
            corner(-WHEEL_W, c2),
        ])
    }

    pub(super) fn is_valid(&self, world: &World, tiles: usize) -> bool {
        // a larger count would overflow
        self.marks.len() == MARKS
            && self.marks_made <= MAX_MARKS_MADE
            && world.has_body(self.hull)
            && self
                .hull_fixtures
                .iter()
                .all(|fixture| world.has_fixture(*fixture))
            && self.wheels.iter().all(|wheel| {
                wheel.tiles as usize <= tiles
                    && world.has_body(wheel.body)
                    && world.has_joint(wheel.joint)
                    && world.has_fixture(wheel.fixture)
            })
    }
}
