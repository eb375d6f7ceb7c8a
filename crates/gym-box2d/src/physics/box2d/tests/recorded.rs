//! Scenes that move as Box2D moved them.

use super::*;

/// Twelve bodies of every shape, some joined, fall on each other until they sleep. Recorded by
/// `tests/reference/pile.py`.
#[test]
fn a_pile_falls_as_box2ds() {
    let mut world = Box2d::new(v(0.0, -10.0));
    let ground = world.create_body(&BodyDef::fixed(v(0.0, 0.0), 0.0));
    for edge in [
        Shape::Edge(v(-4.0, 2.0), v(0.0, 0.0)),
        Shape::Edge(v(0.0, 0.0), v(4.0, 2.0)),
    ] {
        world.create_fixture(
            ground,
            &FixtureDef {
                friction: 0.4,
                ..FixtureDef::new(edge)
            },
        );
    }
    let f = |x: f64| x as f32;
    let bodies: [u32; 12] = std::array::from_fn(|i| {
        let x = i as f64;
        let position = v(
            f((i % 4) as f64 * 0.9 - 1.3 + 0.07 * x),
            f(1.5 + (i / 4) as f64 * 1.1),
        );
        let body = world.create_body(&BodyDef::dynamic(position, f(0.2 * x)));
        let shape = match i % 3 {
            0 => Shape::Rect {
                half_width: f(0.3 + 0.02 * x),
                half_height: 0.25,
            },
            1 => Shape::Circle {
                center: v(0.0, 0.0),
                radius: 0.3,
            },
            _ => Shape::Polygon(vec![v(-0.35, -0.25), v(0.35, -0.3), v(0.05, 0.4)]),
        };
        let def = FixtureDef::new(shape);
        let (density, friction, restitution) = (f(1.0 + 0.5 * x), f(0.1 * x), f(0.05 * x));
        world.create_fixture(
            body,
            &FixtureDef {
                density,
                friction,
                restitution,
                ..def
            },
        );
        world.body_mut(body).velocity = v(f(0.5 * x - 2.0), f(-0.3 * x));
        body
    });
    for (a, b) in [(4, 5), (8, 9)] {
        world.create_revolute_joint(&RevoluteJointDef {
            body_a: BodyId(bodies[a]),
            body_b: BodyId(bodies[b]),
            local_anchor_a: v(0.45, 0.0),
            local_anchor_b: v(-0.45, 0.0),
            limits: Some((-0.5, 0.7)),
            motor: true,
            motor_speed: 2.0,
            max_motor_torque: 1.5,
            collide_connected: a == 8,
        });
    }
    let recorded: Vec<(u32, Vec<[u32; 6]>)> =
        serde_json::from_str(include_str!("../../../../tests/reference/pile.json")).unwrap();
    let mut done = 0;
    for (step, expected) in recorded {
        move_as_recorded(&mut world, &bodies, &mut done, step, expected);
    }
    assert_eq!(done, 300);
}

/// Steps the world from step `done` to `step`, then compares the bodies with `expected`: position,
/// angle, velocity and angular velocity.
fn move_as_recorded(
    world: &mut Box2d,
    bodies: &[u32],
    done: &mut u32,
    step: u32,
    expected: Vec<[u32; 6]>,
) {
    while *done < step {
        world.step(0.02, 8, 3);
        *done += 1;
    }
    for (i, expected) in expected.into_iter().enumerate() {
        let body = world.body(bodies[i]);
        let (position, velocity) = (body.xf.translation, body.velocity);
        let found = [
            position.x,
            position.y,
            body.sweep.a,
            velocity.x,
            velocity.y,
            body.angular_velocity,
        ];
        assert_eq!(found, expected.map(f32::from_bits), "step {step}, body {i}");
    }
}

/// Bodies bounce between walls more often than [`MAX_SUB_STEPS`](super::settings::MAX_SUB_STEPS)
/// allows, pass through walls, or are wedged in and never sleep. Recorded by
/// `tests/reference/tight.py`.
#[test]
fn bodies_in_tight_places_move_as_box2ds() {
    let mut world = Box2d::new(v(0.0, -10.0));
    let ground = world.create_body(&BodyDef::fixed(v(0.0, 0.0), 0.0));
    let f = |x: f64| x as f32;
    let bodies: [u32; 10] = std::array::from_fn(|i| {
        let of = i as f64;
        let (x, width) = (8.0 * of, 0.95 + 0.03 * (of - 3.0));
        for [ax, ay, bx, by] in [
            [x - 0.5 * width, 0.0, x - 0.5 * width, 6.0],
            [x + 0.5 * width, 0.0, x + 0.5 * width, 6.0],
            [x - 3.0, 0.0, x + 3.0, 0.0],
            [x - 3.0, 6.0, x + 3.0, 6.0],
        ] {
            let edge = FixtureDef::new(Shape::Edge(v(f(ax), f(ay)), v(f(bx), f(by))));
            world.create_fixture(
                ground,
                &FixtureDef {
                    friction: f(0.05 * of),
                    ..edge
                },
            );
        }
        let position = v(f(x), if i % 3 == 0 { 0.45 } else { 2.0 });
        let body = world.create_body(&BodyDef::dynamic(position, 0.0));
        let shape = match i % 2 {
            0 => Shape::Circle {
                center: v(0.0, 0.0),
                radius: 0.45,
            },
            _ => Shape::Rect {
                half_width: 0.45,
                half_height: 0.4,
            },
        };
        let restitution = if i < 8 { 1.0 } else { 0.0 };
        let def = FixtureDef {
            density: 1.0,
            friction: 0.1,
            restitution,
            ..FixtureDef::new(shape)
        };
        world.create_fixture(body, &def);
        if i < 8 {
            world.body_mut(body).velocity = v(f(37.0 * of), f(5.0 - 20.0 * of));
            world.body_mut(body).angular_velocity = if i < 4 { 0.0 } else { f(60.0 * of) };
        }
        body
    });
    type Recorded = Vec<(u32, Vec<[u32; 6]>, Vec<bool>)>;
    let recorded: Recorded =
        serde_json::from_str(include_str!("../../../../tests/reference/tight.json")).unwrap();
    let mut done = 0;
    for (step, expected, awake) in recorded {
        move_as_recorded(&mut world, &bodies, &mut done, step, expected);
        let found: Vec<bool> = bodies.iter().map(|body| world.body(*body).awake).collect();
        assert_eq!(found, awake, "step {step}");
    }
    assert_eq!(done, 200);
}
