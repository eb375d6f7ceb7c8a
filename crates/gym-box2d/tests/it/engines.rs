//! The documented behaviour of a world, with each engine.

use gym_box2d::physics::{
    BodyDef, BodyId, Filter, FixtureDef, JointId, Physics, RevoluteJointDef, Shape, Vec2, World,
};

pub(crate) const ENGINES: &[Physics] = &[
    Physics::Box2d,
    #[cfg(feature = "rapier")]
    Physics::Rapier,
];

pub(crate) fn v(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

fn block(half_width: f32, half_height: f32) -> FixtureDef {
    FixtureDef {
        density: 1.0,
        friction: 0.5,
        ..FixtureDef::new(Shape::Rect {
            half_width,
            half_height,
        })
    }
}

/// Makes an empty world with a ground at height 0.
fn over_ground(physics: Physics) -> World {
    let mut world = World::with(physics, v(0.0, -10.0));
    let ground = world.create_body(&BodyDef::fixed(v(0.0, 0.0), 0.0));
    world.create_fixture(
        ground,
        &FixtureDef::new(Shape::Edge(v(-20.0, 0.0), v(20.0, 0.0))),
    );
    world
}

/// Makes two blocks and a joint between them, whose motor turns against the upper limit.
fn knee(physics: Physics) -> (World, [BodyId; 2], JointId) {
    let mut world = over_ground(physics);
    let filter = Filter {
        category: 2,
        mask: 1,
    };
    let [thigh, shin] = [2.0, 1.0].map(|y| {
        let body = world.create_body(&BodyDef::dynamic(v(0.0, y), 0.0));
        world.create_fixture(
            body,
            &FixtureDef {
                filter,
                ..block(0.1, 0.5)
            },
        );
        body
    });
    let joint = world.create_revolute_joint(&RevoluteJointDef {
        body_a: thigh,
        body_b: shin,
        local_anchor_a: v(0.0, -0.5),
        local_anchor_b: v(0.0, 0.5),
        limits: Some((-0.6, 0.4)),
        motor: true,
        motor_speed: 2.0,
        max_motor_torque: 40.0,
        collide_connected: false,
    });
    (world, [thigh, shin], joint)
}

fn step(world: &mut World) {
    world.step(0.02, 180, 60);
}

#[test]
fn a_stack_comes_to_rest_and_sleeps() {
    for &physics in ENGINES {
        let mut world = over_ground(physics);
        let stack = [0.6, 1.7].map(|y| {
            let body = world.create_body(&BodyDef::dynamic(v(0.0, y), 0.0));
            world.create_fixture(body, &block(0.5, 0.5));
            body
        });
        let (mut begun, mut ended) = (0, 0);
        for _ in 0..300 {
            step(&mut world);
            begun += world
                .contact_events()
                .iter()
                .filter(|event| event.begin)
                .count();
            ended += world
                .contact_events()
                .iter()
                .filter(|event| !event.begin)
                .count();
        }
        assert_eq!(
            begun - ended,
            2,
            "{physics:?}: the ground and the lower block, the blocks"
        );
        for (body, height) in stack.into_iter().zip([0.5, 1.5]) {
            assert!(!world.is_awake(body), "{physics:?}");
            assert!(
                (world.position(body).y - height).abs() < 0.05,
                "{physics:?}: {}",
                world.position(body)
            );
        }
        world.apply_linear_impulse(stack[1], v(3.0, 0.0), v(0.0, 1.5));
        step(&mut world);
        assert!(
            stack.iter().all(|body| world.is_awake(*body)),
            "{physics:?}: a kick wakes what it touches"
        );
    }
}

#[test]
fn a_free_fall_is_semi_implicit_euler() {
    for &physics in ENGINES {
        let mut world = World::with(physics, v(0.0, -10.0));
        let body = world.create_body(&BodyDef::dynamic(v(0.0, 0.0), 0.0));
        world.create_fixture(body, &block(0.5, 0.5));
        for _ in 0..50 {
            step(&mut world);
        }
        // the sum of h g (1 + 2 + ... + 50) h
        assert!(
            (world.position(body).y + 10.0 * 0.02 * 0.02 * 1275.0).abs() < 1e-4,
            "{physics:?}"
        );
        assert!(
            (world.linear_velocity(body).y + 10.0).abs() < 1e-4,
            "{physics:?}"
        );
    }
}

#[test]
fn a_motor_turns_a_knee_to_its_limit() {
    for &physics in ENGINES {
        let (mut world, [thigh, shin], joint) = knee(physics);
        let mut fastest: f32 = 0.0;
        for _ in 0..60 {
            step(&mut world);
            fastest = fastest.max(world.joint_speed(joint));
        }
        assert!(
            (world.joint_angle(joint) - 0.4).abs() < 0.06,
            "{physics:?}: {}",
            world.joint_angle(joint)
        );
        assert!((1.0..2.5).contains(&fastest), "{physics:?}: {fastest}");
        // the ends of both blocks stay together
        let end = |body: BodyId, y: f32| world.pose(body) * nalgebra::Point2::new(0.0, y);
        assert!(
            (end(thigh, -0.5) - end(shin, 0.5)).norm() < 0.02,
            "{physics:?}"
        );

        world.set_motor_speed(joint, -2.0);
        for _ in 0..60 {
            step(&mut world);
        }
        assert!(
            (world.joint_angle(joint) + 0.6).abs() < 0.06,
            "{physics:?}: {}",
            world.joint_angle(joint)
        );
    }
}

#[test]
fn a_stored_world_continues_to_the_last_bit() {
    for &physics in ENGINES {
        let (mut world, bodies, joint) = knee(physics);
        for i in 0..120 {
            world.set_motor_speed(joint, if i % 40 < 20 { 3.0 } else { -3.0 });
            if i % 30 == 0 {
                let text = serde_json::to_string(&world).unwrap();
                let mut read: World = serde_json::from_str(&text).unwrap();
                assert!(read.is_valid());
                let mut copy = world.clone();
                for _ in 0..30 {
                    step(&mut read);
                    step(&mut copy);
                }
                for body in bodies {
                    assert_eq!(read.pose(body), copy.pose(body), "{physics:?}");
                    assert_eq!(
                        read.linear_velocity(body),
                        copy.linear_velocity(body),
                        "{physics:?}"
                    );
                }
            }
            step(&mut world);
        }
    }
}

#[test]
fn threads_change_nothing() {
    for &physics in ENGINES {
        let run = move || {
            let (mut world, bodies, _) = knee(physics);
            for _ in 0..200 {
                step(&mut world);
            }
            bodies.map(|body| world.pose(body))
        };
        let here = run();
        let there: Vec<_> = (0..3).map(|_| std::thread::spawn(run)).collect();
        for thread in there {
            assert_eq!(thread.join().unwrap(), here, "{physics:?}");
        }
    }
}

#[test]
fn fast_bodies_stop_at_a_wall() {
    for &physics in ENGINES {
        let mut world = World::with(physics, v(0.0, 0.0));
        let wall = world.create_body(&BodyDef::fixed(v(5.0, 0.0), 0.0));
        world.create_fixture(
            wall,
            &FixtureDef::new(Shape::Edge(v(0.0, -5.0), v(0.0, 5.0))),
        );
        let bullet = world.create_body(&BodyDef::dynamic(v(0.0, 0.0), 0.3));
        world.create_fixture(bullet, &block(0.1, 0.1));
        world.apply_linear_impulse(bullet, v(90.0 * world.mass(bullet), 0.0), v(0.0, 0.0));
        for _ in 0..10 {
            step(&mut world);
        }
        assert!(
            world.position(bullet).x < 5.0,
            "{physics:?}: {}",
            world.position(bullet)
        );
    }
}

#[test]
fn what_is_destroyed_is_gone() {
    for &physics in ENGINES {
        let (mut world, [thigh, shin], joint) = knee(physics);
        step(&mut world);
        world.destroy_body(thigh);
        assert!(
            !world.has_body(thigh) && !world.has_joint(joint) && world.has_body(shin),
            "{physics:?}"
        );
        for _ in 0..200 {
            step(&mut world);
        }
        assert!(world.is_valid());
        assert!(world.position(shin).y < 0.6, "{physics:?}: it falls");
    }
}

/// A contact ends with one of its bodies, and by a joint that lets what it joins overlap.
#[test]
fn a_contact_that_cannot_be_has_ended() {
    for &physics in ENGINES {
        let stacked = || {
            let mut world = over_ground(physics);
            let stack = [0.5, 1.5].map(|y| {
                let body = world.create_body(&BodyDef::dynamic(v(0.0, y), 0.0));
                world.create_fixture(body, &block(0.5, 0.5));
                body
            });
            for _ in 0..20 {
                step(&mut world);
            }
            (world, stack)
        };
        let ended = |world: &World| -> Vec<[BodyId; 2]> {
            let events = world.contact_events().iter();
            events
                .filter(|event| !event.begin)
                .map(|event| event.bodies)
                .collect()
        };
        let (mut world, [lower, upper]) = stacked();
        world.destroy_body(lower);
        let told = ended(&world);
        assert_eq!(told.len(), 2, "{physics:?}: {told:?}");
        assert!(
            told.iter().all(|bodies| bodies.contains(&lower)),
            "{physics:?}"
        );
        assert!(
            told.iter().any(|bodies| bodies.contains(&upper)),
            "{physics:?}"
        );
        for collide_connected in [false, true] {
            let (mut world, [lower, upper]) = stacked();
            world.create_revolute_joint(&RevoluteJointDef {
                body_a: lower,
                body_b: upper,
                local_anchor_a: v(0.0, 0.5),
                local_anchor_b: v(0.0, -0.5),
                limits: None,
                motor: false,
                motor_speed: 0.0,
                max_motor_torque: 0.0,
                collide_connected,
            });
            step(&mut world);
            let told = ended(&world);
            let between = told
                .iter()
                .any(|bodies| bodies.contains(&lower) && bodies.contains(&upper));
            assert_eq!(between, !collide_connected, "{physics:?}: {told:?}");
        }
    }
}

/// A motor reaches zero torque, reverses or reaches full torque within one step. rapier limits the
/// change of a motor's impulse to the same range in both directions: a motor that started from its
/// last impulse could not reach zero in one step.
#[test]
fn a_motor_lets_go_at_once() {
    let run = |physics| {
        let (mut world, bodies, joint) = knee(physics);
        world.destroy_body(bodies[1]);
        let _ = joint;
        let wheel = world.create_body(&BodyDef::dynamic(v(0.0, 2.5), 0.0));
        world.create_fixture(
            wheel,
            &FixtureDef {
                filter: Filter {
                    category: 2,
                    mask: 1,
                },
                ..block(0.3, 0.3)
            },
        );
        let axle = world.create_revolute_joint(&RevoluteJointDef {
            body_a: bodies[0],
            body_b: wheel,
            local_anchor_a: v(0.0, 0.5),
            local_anchor_b: v(0.0, 0.0),
            limits: None,
            motor: true,
            motor_speed: 0.0,
            max_motor_torque: 0.0,
            collide_connected: false,
        });
        let mut speeds = Vec::new();
        for i in 0..20 {
            // at full torque for two steps, then near the target speed
            let (speed, torque) = [(8.0, 0.5), (8.0, 0.5), (3.0, 1.5), (-2.0, 3.0)][i % 4];
            world.set_motor_speed(axle, speed);
            world.set_max_motor_torque(axle, torque);
            step(&mut world);
            speeds.push(world.joint_speed(axle));
        }
        speeds
    };
    let exact = run(Physics::Box2d);
    assert!(
        exact.iter().any(|speed| (speed + 2.0).abs() < 1e-3),
        "the motor reaches its speed: {exact:?}"
    );
    for &physics in ENGINES {
        for (i, (a, b)) in run(physics).iter().zip(&exact).enumerate() {
            assert!((a - b).abs() < 1e-3, "{physics:?}: {a} for {b} in step {i}");
        }
    }
}

/// A contact lies halfway between the skins; a post that tips over pivots about this point.
#[test]
fn a_post_tips_over_its_corner() {
    let run = |physics| {
        let mut world = over_ground(physics);
        let tilt: f32 = -0.2;
        let post = world.create_body(&BodyDef::dynamic(
            v(0.0, 0.1 * tilt.abs().sin() + tilt.cos() + 0.018),
            tilt,
        ));
        world.create_fixture(
            post,
            &FixtureDef {
                friction: 25.0,
                ..block(0.1, 1.0)
            },
        );
        for _ in 0..30 {
            step(&mut world);
        }
        (world.angle(post), world.position(post))
    };
    let (angle, position) = run(Physics::Box2d);
    assert!((-1.5..-0.3).contains(&angle), "it tips: {angle}");
    for &physics in ENGINES {
        let (a, p) = run(physics);
        assert!(
            (a - angle).abs() < 2e-3 && (p - position).norm() < 2e-3,
            "{physics:?}: {a} for {angle}, {p} for {position}"
        );
    }
}

#[test]
fn a_block_keeps_its_place_on_a_slope() {
    for &physics in ENGINES {
        let mut world = World::with(physics, v(0.0, -10.0));
        let hill = world.create_body(&BodyDef::fixed(v(0.0, 0.0), 0.4));
        let slope = FixtureDef {
            friction: 2.5,
            ..FixtureDef::new(Shape::Edge(v(-20.0, 0.0), v(20.0, 0.0)))
        };
        world.create_fixture(hill, &slope);
        let up = v(-(0.4f32).sin(), (0.4f32).cos());
        let body = world.create_body(&BodyDef::dynamic(0.515 * up, 0.4));
        world.create_fixture(
            body,
            &FixtureDef {
                friction: 2.5,
                ..block(0.5, 0.5)
            },
        );
        for _ in 0..10 {
            step(&mut world);
        }
        let start = world.position(body);
        for i in 0..100 {
            // keep the body awake, so that only the joint stops it
            world.apply_torque(body, if i % 2 == 0 { 0.3 } else { -0.3 });
            step(&mut world);
        }
        let moved = (world.position(body) - start).norm();
        assert!(moved < 2e-3, "{physics:?}: it slid by {moved} m");
    }
}

#[test]
fn steps_without_sweeps_are_steps() {
    for &physics in ENGINES {
        let (mut world, [thigh, _], _) = knee(physics);
        for _ in 0..50 {
            world.step(0.02, 0, 0);
        }
        assert!(world.position(thigh).y.is_finite(), "{physics:?}");
    }
}

#[cfg(not(feature = "rapier"))]
#[test]
fn the_engine_that_was_left_out_is_named() {
    let registration =
        gym_core::registry::find("rapier/LunarLander-v3").expect("registered all the same");
    assert!(!registration.needs.expect("a need").is_met());
    for made in [
        gym_core::make("rapier/LunarLander-v3"),
        gym_core::builder("CarRacing-v3")
            .arg("physics", "rapier")
            .build(),
    ] {
        let error = made.map(drop).unwrap_err().to_string();
        assert!(error.contains("build with the feature `rapier`"), "{error}");
    }
}
