//! Numbers that follow from a formula, with each engine.

use gym_box2d::physics::{
    BodyDef, BodyId, Filter, FixtureDef, Physics, RevoluteJointDef, Shape, World,
};

use crate::engines::{ENGINES, v};

const DT: f32 = 0.002;

fn step(world: &mut World) {
    world.step(DT, 30, 10);
}

/// Asserts that two numbers differ by at most a hundredth.
#[track_caller]
fn near(a: f32, b: f32, what: &str) {
    assert!(
        (a - b).abs() <= 0.01 * b.abs().max(1.0),
        "{what}: {a}, not {b}"
    );
}

fn disc(radius: f32) -> Shape {
    let center = v(0.0, 0.0);
    Shape::Circle { center, radius }
}

fn rect(half_width: f32, half_height: f32) -> Shape {
    Shape::Rect {
        half_width,
        half_height,
    }
}

/// Makes a body of density 1 without friction.
fn body(world: &mut World, def: BodyDef, shape: Shape, restitution: f32) -> BodyId {
    let body = world.create_body(&def);
    let def = FixtureDef {
        density: 1.0,
        friction: 0.0,
        restitution,
        ..FixtureDef::new(shape)
    };
    world.create_fixture(body, &def);
    body
}

/// Makes a block of 1 m by 3 m that floats, its mass, and its inertia.
fn block(physics: Physics) -> (World, BodyId, f32, f32) {
    let mut world = World::with(physics, v(0.0, 0.0));
    let block = body(
        &mut world,
        BodyDef::dynamic(v(1.0, 2.0), 0.0),
        rect(0.5, 1.5),
        0.0,
    );
    (world, block, 3.0, 3.0 * (1.0 + 9.0) / 12.0)
}

#[test]
fn a_mass_is_density_times_area() {
    let triangle = Shape::Polygon(vec![v(0.0, 0.0), v(4.0, 0.0), v(0.0, 1.0)]);
    let edge = Shape::Edge(v(0.0, 0.0), v(1.0, 0.0));
    for &physics in ENGINES {
        for (shape, area) in [
            (disc(2.0), 4.0 * std::f32::consts::PI),
            (rect(0.5, 2.0), 4.0),
            (triangle.clone(), 2.0),
        ] {
            let mut world = World::with(physics, v(0.0, 0.0));
            let body = world.create_body(&BodyDef::dynamic(v(0.0, 0.0), 0.0));
            for (density, mass) in [(0.5, 0.5), (3.0, 3.5)] {
                let fixture = FixtureDef::new(shape.clone());
                world.create_fixture(body, &FixtureDef { density, ..fixture });
                near(
                    world.mass(body),
                    mass * area,
                    &format!("{physics:?} {shape:?}"),
                );
            }
            world.create_fixture(body, &FixtureDef::new(edge.clone()));
            near(
                world.mass(body),
                3.5 * area,
                &format!("{physics:?}, no mass added"),
            );
        }
    }
}

#[test]
fn forces_torques_and_impulses_act_for_one_step() {
    for &physics in ENGINES {
        let (mut world, block, mass, inertia) = block(physics);
        let turns = |world: &World| world.angular_velocity(block);
        world.apply_torque(block, 500.0);
        for _ in 0..3 {
            step(&mut world);
            near(
                turns(&world),
                500.0 * DT / inertia,
                &format!("{physics:?} torque"),
            );
        }
        world.apply_force_to_center(block, v(0.0, -600.0));
        for _ in 0..3 {
            step(&mut world);
            near(
                world.linear_velocity(block).y,
                -600.0 * DT / mass,
                &format!("{physics:?} force"),
            );
        }
        let (before, at) = (turns(&world), world.position(block) + v(0.2, 0.5));
        world.apply_linear_impulse(block, v(4.0, 3.0), at);
        for _ in 0..3 {
            step(&mut world);
            near(
                world.linear_velocity(block).x,
                4.0 / mass,
                &format!("{physics:?} impulse"),
            );
            let turned = (0.2 * 3.0 - 0.5 * 4.0) / inertia;
            near(turns(&world) - before, turned, &format!("{physics:?} turn"));
        }
    }
}

/// A wheel on a fixed axle: its speed grows by torque over inertia, up to the motor's speed.
#[test]
fn a_motor_is_as_strong_as_its_torque() {
    for &physics in ENGINES {
        for (torque, target) in [(5.0, 3.0), (20.0, -3.0), (0.0, 3.0)] {
            let (mut world, block, _, inertia) = block(physics);
            let post = world.create_body(&BodyDef::fixed(v(1.0, 2.0), 0.7));
            let joint = world.create_revolute_joint(&RevoluteJointDef {
                body_a: post,
                body_b: block,
                local_anchor_a: v(0.0, 0.0),
                local_anchor_b: v(0.0, 0.0),
                limits: None,
                motor: true,
                motor_speed: target,
                max_motor_torque: torque,
                collide_connected: false,
            });
            near(
                world.joint_angle(joint),
                0.0,
                "the angle at the start counts as 0",
            );
            let mut angle = 0.0;
            for i in 1..=1500 {
                step(&mut world);
                let speed = (torque * DT * i as f32 / inertia)
                    .min(target.abs())
                    .copysign(target);
                let what = format!("{physics:?} {torque} {target}, step {i}");
                near(world.joint_speed(joint), speed, &what);
                angle += DT * speed;
                near(world.joint_angle(joint), angle, &what);
            }
            world.set_max_motor_torque(joint, 1e4);
            world.set_motor_speed(joint, 1.5);
            step(&mut world);
            near(
                world.joint_speed(joint),
                1.5,
                &format!("{physics:?} another speed"),
            );
        }
    }
}

/// A disc meets the middle of a side, and a corner at 45°.
#[test]
fn a_disc_bounces_as_its_restitution_says() {
    let floor = Shape::Edge(v(-3.0, 1.0), v(3.0, 1.0));
    let roof = Shape::Polygon(vec![v(-1.0, 0.0), v(1.0, 0.0), v(1.0, 1.0), v(-1.0, 1.0)]);
    let beside = 1.0 + 0.5 * std::f32::consts::FRAC_1_SQRT_2;
    let grounds = [
        (floor, 0.0),
        (rect(1.0, 1.0), 0.0),
        (rect(1.0, 1.0), beside),
        (rect(1.0, 1.0), -beside),
        (roof, 0.3),
    ];
    for &physics in ENGINES {
        for (shape, x) in &grounds {
            for (of_disc, of_ground) in [(0.0, 0.0), (0.5, 0.0), (0.2, 0.8), (1.0, 1.0)] {
                let mut world = World::with(physics, v(0.0, 0.0));
                let ground = BodyDef::fixed(v(0.0, 0.0), 0.0);
                body(&mut world, ground, shape.clone(), of_ground);
                let start = v(*x, 1.7);
                let ball = body(&mut world, BodyDef::dynamic(start, 0.0), disc(0.5), of_disc);
                let impulse = v(0.0, -4.0 * world.mass(ball));
                world.apply_linear_impulse(ball, impulse, start);
                for _ in 0..150 {
                    step(&mut world);
                }
                // the normal of the contact, from the nearest point to the centre of the disc
                let side = if x.abs() > 1.0 { x.signum() } else { 0.0 };
                let normal = v(side, 1.0).normalize();
                let restitution = f32::max(of_disc, of_ground);
                let after = v(0.0, -4.0) + normal * (1.0 + restitution) * 4.0 * normal.y;
                let found = world.linear_velocity(ball);
                let what =
                    format!("{physics:?} {shape:?} {x} {of_disc} {of_ground}: {found} {after}");
                assert!((found - after).norm() < 0.15, "{what}");
            }
        }
    }
}

/// A contact has the geometric mean of the coefficients.
#[test]
fn a_block_slides_as_its_friction_says() {
    for &physics in ENGINES {
        for (of_block, of_ground) in [(0.5_f32, 0.32_f32), (0.3, 0.3), (0.0, 0.9)] {
            let mut world = World::with(physics, v(0.0, -10.0));
            let parts = [
                (BodyDef::fixed(v(0.0, 0.0), 0.0), rect(20.0, 1.0), of_ground),
                (
                    BodyDef::dynamic(v(0.0, 1.31), 0.0),
                    rect(1.0, 0.3),
                    of_block,
                ),
            ];
            let [_, block] = parts.map(|(def, shape, friction)| {
                let body = world.create_body(&def);
                let (density, fixture) = (1.0, FixtureDef::new(shape));
                world.create_fixture(
                    body,
                    &FixtureDef {
                        density,
                        friction,
                        ..fixture
                    },
                );
                body
            });
            for _ in 0..100 {
                step(&mut world);
            }
            let at = world.position(block);
            world.apply_linear_impulse(block, v(3.0 * world.mass(block), 0.0), at);
            for _ in 0..200 {
                step(&mut world);
            }
            let speed = 3.0 - (of_block * of_ground).sqrt() * 10.0 * 200.0 * DT;
            let found = world.linear_velocity(block).x;
            assert!(
                (found - speed).abs() < 0.1,
                "{physics:?} {of_block} {of_ground}: {found}, not {speed}"
            );
        }
    }
}

#[test]
fn a_ray_meets_the_nearest_fixture_of_its_categories() {
    for &physics in ENGINES {
        let mut world = World::with(physics, v(0.0, 0.0));
        let fixtures = [(2.0, 0x1), (4.0, 0x2), (8.0, 0x4)].map(|(x, category)| {
            let body = world.create_body(&BodyDef::dynamic(v(x, 0.0), 0.0));
            let filter = Filter { category, mask: 0 };
            let (density, fixture) = (1.0, FixtureDef::new(rect(0.5, 0.5)));
            world.create_fixture(
                body,
                &FixtureDef {
                    density,
                    filter,
                    ..fixture
                },
            )
        });
        step(&mut world);
        for (categories, hit) in [(0x7, 0), (0x6, 1), (0x3, 0), (0xc, 2), (0x8, 3)] {
            let found = world.ray_cast(v(0.0, 0.25), v(20.0, 0.25), categories);
            let what = format!("{physics:?} {categories}: {found:?}");
            let found = found.map(|hit| (hit.fixture, hit.point, hit.fraction));
            let Some(fixture) = fixtures.get(hit) else {
                assert_eq!(found, None, "{what}");
                continue;
            };
            let (found, point, fraction) = found.unwrap();
            let x = [1.5, 3.5, 7.5][hit];
            assert_eq!(found, Some(*fixture), "{what}");
            assert!(
                (point - v(x, 0.25)).norm() < 1e-3 && (fraction - x / 20.0).abs() < 1e-4,
                "{what}"
            );
        }
    }
}
