//! Tests of the whole engine.

mod buffers;
mod recorded;

use super::island::Island;
use super::lanes::Lanes;
use super::*;
use crate::physics::{BodyId, Filter, FixtureId, Shape};

impl Box2d {
    fn step(&mut self, dt: f32, velocity_iterations: u32, position_iterations: u32) {
        self.step_in(
            &mut Island::new(),
            dt,
            velocity_iterations,
            position_iterations,
        );
    }

    fn step_in(
        &mut self,
        island: &mut Island,
        dt: f32,
        velocity_iterations: u32,
        position_iterations: u32,
    ) {
        self.begin(island, dt, velocity_iterations, position_iterations);
        island.solve_velocities();
        self.finish(island);
    }
}

fn v(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

fn rect(half_width: f32, half_height: f32) -> FixtureDef {
    FixtureDef {
        density: 1.0,
        ..FixtureDef::new(Shape::Rect {
            half_width,
            half_height,
        })
    }
}

/// Makes a ground, and a chain of links with motors and limits that hangs from a heavy block.
fn chain() -> Box2d {
    let mut world = Box2d::new(v(0.0, -10.0));
    let ground = world.create_body(&BodyDef::fixed(v(0.0, 0.0), 0.0));
    for i in -3..3 {
        let (x, y) = (i as f32 * 2.0, (i * i) as f32 * 0.1);
        let edge = Shape::Edge(v(x, y), v(x + 2.0, ((i + 1) * (i + 1)) as f32 * 0.1));
        world.create_fixture(
            ground,
            &FixtureDef {
                friction: 0.9,
                ..FixtureDef::new(edge)
            },
        );
    }
    let filter = Filter {
        category: 2,
        mask: 1,
    };
    let mut last = world.create_body(&BodyDef::dynamic(v(0.0, 3.0), 0.1));
    world.create_fixture(
        last,
        &FixtureDef {
            density: 20.0,
            filter,
            ..rect(0.5, 0.3)
        },
    );
    for i in 1..4 {
        let link = world.create_body(&BodyDef::dynamic(v(i as f32 * 0.8, 3.0), 0.1 * i as f32));
        world.create_fixture(
            link,
            &FixtureDef {
                filter,
                ..rect(0.4, 0.1)
            },
        );
        world.create_revolute_joint(&RevoluteJointDef {
            body_a: BodyId(last),
            body_b: BodyId(link),
            local_anchor_a: v(0.4, 0.0),
            local_anchor_b: v(-0.4, 0.0),
            limits: Some((-0.6, 0.4)),
            motor: i % 2 == 1,
            motor_speed: 1.5,
            max_motor_torque: 3.0,
            collide_connected: false,
        });
        last = link;
    }
    world
}

/// Terrain uses little memory. Bodies, ray casts, snapshots and impacts are the same as with one
/// static body per edge.
#[test]
fn terrain_is_as_many_static_bodies() {
    let points: Vec<Vec2> = (0..60)
        .map(|i| v(i as f32 * 0.47, math::rotation(i as f32 * 0.9).im))
        .collect();
    let [mut terrain, mut bodies] = [true, false].map(|compact| {
        let mut world = Box2d::new(v(0.0, -10.0));
        // one proxy before the edges and several after them
        let wall = world.create_body(&BodyDef::fixed(v(27.0, 1.0), 0.2));
        world.create_fixture(wall, &rect(0.5, 3.0));
        if compact {
            world.create_terrain(&points, 0.7);
        } else {
            for ends in points.windows(2) {
                let edge = FixtureDef {
                    friction: 0.7,
                    ..FixtureDef::new(Shape::Edge(ends[0], ends[1]))
                };
                let body = world.create_body(&BodyDef::fixed(v(0.0, 0.0), 0.0));
                world.create_fixture(body, &edge);
            }
        }
        for i in 0..6 {
            let body = world.create_body(&BodyDef::dynamic(v(2.0 + i as f32, 3.0), 0.3 * i as f32));
            world.create_fixture(body, &rect(0.3, 0.2));
            world.body_mut(body).velocity = v(9.0, -20.0 * i as f32);
        }
        world
    });
    assert!(json(&terrain).to_string().len() < json(&bodies).to_string().len() / 3);
    for step in 0..400 {
        for world in [&mut terrain, &mut bodies] {
            world.step(0.02, 30, 10);
        }
        let state = |world: &Box2d| -> Vec<[u32; 6]> {
            let of = |id: &u32| {
                let body = world.body(*id);
                let xf = body.xf.translation;
                [
                    xf.x,
                    xf.y,
                    body.sweep.a,
                    body.velocity.x,
                    body.velocity.y,
                    body.angular_velocity,
                ]
                .map(f32::to_bits)
            };
            world.dynamic.iter().map(of).collect()
        };
        assert_eq!(state(&terrain), state(&bodies), "step {step}");
        assert_eq!(terrain.events.len(), bodies.events.len());
        let ends = [v(step as f32 * 0.07, -3.0), v(28.0, 0.5), v(14.0, 3.0)];
        let rays = |world: &Box2d| {
            world
                .ray_casts(v(14.0, 3.0), &ends, 1)
                .map(|hit| hit.map(|hit| (hit.point, hit.fraction)))
        };
        assert_eq!(rays(&terrain), rays(&bodies));
        if step % 50 == 0 {
            assert!(terrain.is_valid());
            terrain = serde_json::from_value(json(&terrain)).unwrap();
        }
    }
    assert!(terrain.contacts.len() > 6 && terrain.bodies.iter().count() < 30);

    // a fixture of an edge must have the edge's shape, and a contact
    let damage = |path: &str, value: serde_json::Value| {
        let mut damaged = json(&terrain);
        *damaged.pointer_mut(path).unwrap() = value;
        serde_json::from_value::<Box2d>(damaged).is_ok_and(|world| world.is_valid())
    };
    assert!(damage("/gravity/0", 1.5.into()));
    assert!(!damage("/contacts", serde_json::json!([])));
    assert!(!damage(
        "/broad_phase/terrain/points",
        serde_json::json!([])
    ));
    assert!(!damage("/broad_phase/terrain/first", 99.into()));
}

fn json(world: &Box2d) -> serde_json::Value {
    serde_json::to_value(world).unwrap()
}

#[test]
fn saved_sweeps_keep_the_bits() {
    let (mut quick, mut complete) = (chain(), chain());
    let [mut some_sweeps, mut every_iteration] = [(); 2].map(|()| Island::new());
    every_iteration.no_shortcut = true;
    for step in 0..600 {
        if step % 150 == 149 {
            for world in [&mut quick, &mut complete] {
                world
                    .body_mut(1)
                    .apply_impulse(v(step as f32 * 0.1, 30.0), v(0.3, 2.0));
            }
        }
        quick.step_in(&mut some_sweeps, 0.02, 180, 60);
        complete.step_in(&mut every_iteration, 0.02, 180, 60);
        assert!(json(&quick) == json(&complete), "step {step}");
    }
}

/// Makes two joined boxes that fall on the ground and lie there until they sleep.
fn falling_pair(height: f32) -> Box2d {
    let mut world = Box2d::new(v(0.0, -10.0));
    world.create_terrain(&[v(-9.0, 0.0), v(0.1, 0.0), v(9.0, 0.1)], 0.8);
    let filter = Filter {
        category: 2,
        mask: 1,
    };
    let [a, b] = [-0.4, 0.4].map(|x| {
        let body = world.create_body(&BodyDef::dynamic(v(x, height), 0.1));
        world.create_fixture(
            body,
            &FixtureDef {
                filter,
                ..rect(0.4, 0.2)
            },
        );
        body
    });
    world.create_revolute_joint(&RevoluteJointDef {
        body_a: BodyId(a),
        body_b: BodyId(b),
        local_anchor_a: v(0.4, 0.0),
        local_anchor_b: v(-0.4, 0.0),
        limits: Some((-0.5, 0.3)),
        motor: true,
        motor_speed: 0.0,
        max_motor_torque: 0.5,
        collide_connected: false,
    });
    world
}

/// Some worlds sleep while others fall; one world has other bodies than the others; all wake again.
#[test]
fn worlds_that_sleep_and_wake_keep_their_bits_in_lanes() {
    let worlds = || -> Vec<Box2d> {
        (0..21)
            .map(|i| {
                if i == 5 {
                    chain()
                } else {
                    falling_pair(0.5 + 0.4 * i as f32)
                }
            })
            .collect()
    };
    let awake = |worlds: &[Box2d]| -> usize {
        worlds
            .iter()
            .filter(|world| world.dynamic.iter().any(|id| world.body(*id).awake))
            .count()
    };
    for mut lanes in Lanes::of_each_level() {
        let (mut alone, mut together) = (worlds(), worlds());
        let mut counts = Vec::new();
        for step in 0..400 {
            if step == 300 {
                for worlds in [&mut alone, &mut together] {
                    worlds
                        .iter_mut()
                        .for_each(|world| world.body_mut(world.dynamic[0]).wake());
                }
            }
            alone.iter_mut().for_each(|world| world.step(0.02, 40, 20));
            lanes.clear();
            let places: Vec<_> = together
                .iter_mut()
                .map(|world| lanes.begin(world, 0.02, 40, 20))
                .collect();
            lanes.solve_velocities();
            together
                .iter_mut()
                .zip(places)
                .for_each(|(world, place)| lanes.finish(place, world));
            counts.push(awake(&alone));
            if step % 20 == 19 {
                let bits = |worlds: &[Box2d]| worlds.iter().map(json).collect::<Vec<_>>();
                assert!(
                    bits(&alone) == bits(&together),
                    "step {step}, {:?}",
                    lanes.level()
                );
            }
        }
        // at first all worlds are awake, then some, then few; in the end all wake again
        let some = counts.iter().any(|count| (5..15).contains(count));
        assert!(
            counts[0] == 21 && some && counts[299] < 5 && counts[301] == 21,
            "{counts:?}"
        );
    }
}

#[test]
fn a_stored_world_continues_identically() {
    let mut world = chain();
    for step in 0..300 {
        if step % 37 == 0 {
            let stored = json(&world);
            let mut read: Box2d = serde_json::from_value(stored.clone()).unwrap();
            assert!(read.is_valid());
            assert_eq!(json(&read), stored);
            let mut copy = world.clone();
            for _ in 0..20 {
                read.step(0.02, 50, 20);
                copy.step(0.02, 50, 20);
            }
            assert_eq!(json(&read), json(&copy));
        }
        world.step(0.02, 50, 20);
    }
}

#[test]
fn damaged_worlds_are_refused() {
    let stored = json(&chain());
    let damage = |path: &str, value: serde_json::Value| {
        let mut damaged = stored.clone();
        *damaged.pointer_mut(path).unwrap() = value;
        serde_json::from_value::<Box2d>(damaged).is_ok_and(|world| world.is_valid())
    };
    assert!(damage("/gravity/0", 1.5.into()));
    assert!(!damage("/dynamic/0", 77.into()));
    assert!(!damage("/fixtures/slots/1/next", 6.into()));
    assert!(!damage("/fixtures/slots/1/body", 9.into()));
    assert!(!damage("/joints/slots/0/body_a", 9.into()));
    assert!(!damage("/broad_phase/moved", serde_json::json!([99])));
    assert!(!damage("/bodies/free", serde_json::json!([0])));
}

#[test]
fn bodies_rest_sleep_and_wake() {
    let mut world = Box2d::new(v(0.0, -10.0));
    let ground = world.create_body(&BodyDef::fixed(v(0.0, 0.0), 0.0));
    world.create_fixture(
        ground,
        &FixtureDef::new(Shape::Edge(v(-9.0, 0.0), v(9.0, 0.0))),
    );
    let stack: Vec<u32> = (0..3)
        .map(|i| world.create_body(&BodyDef::dynamic(v(0.0, 0.6 + 1.1 * i as f32), 0.0)))
        .collect();
    for body in &stack {
        world.create_fixture(*body, &rect(0.5, 0.5));
    }
    let mut begun = 0;
    for _ in 0..200 {
        world.step(0.02, 30, 10);
        begun += world.events().iter().filter(|event| event.begin).count();
    }
    assert_eq!(begun, 3);
    for (i, body) in stack.iter().enumerate() {
        let body = world.body(*body);
        assert!(!body.awake);
        assert!(
            (body.xf.translation.y - (0.5 + i as f32)).abs() < 0.05,
            "{:?}",
            body.xf
        );
    }
    // bodies that lay on the destroyed body fall
    world.destroy_body(stack[0]);
    world.step(0.02, 30, 10);
    assert!(world.body(stack[1]).awake);
    for _ in 0..200 {
        world.step(0.02, 30, 10);
    }
    assert!((world.body(stack[1]).xf.translation.y - 0.5).abs() < 0.03);
    assert!(world.is_valid());
}

#[test]
fn fast_bodies_do_not_tunnel() {
    let mut world = Box2d::new(v(0.0, 0.0));
    let wall = world.create_body(&BodyDef::fixed(v(5.0, 0.0), 0.0));
    world.create_fixture(
        wall,
        &FixtureDef::new(Shape::Edge(v(0.0, -5.0), v(0.0, 5.0))),
    );
    for shape in [
        Shape::Circle {
            center: v(0.0, 0.0),
            radius: 0.1,
        },
        Shape::Rect {
            half_width: 0.1,
            half_height: 0.1,
        },
    ] {
        let bullet = world.create_body(&BodyDef::dynamic(v(0.0, 0.0), 0.3));
        world.create_fixture(
            bullet,
            &FixtureDef {
                density: 1.0,
                ..FixtureDef::new(shape)
            },
        );
        let mass = world.body(bullet).mass;
        world
            .body_mut(bullet)
            .apply_impulse(v(90.0 * mass, 0.0), v(0.0, 0.0));
        for _ in 0..10 {
            world.step(0.02, 10, 5);
        }
        assert!(world.body(bullet).xf.translation.x < 5.0);
        world.destroy_body(bullet);
    }
}

#[test]
fn sensors_tell_and_rays_meet() {
    let mut world = Box2d::new(v(0.0, 0.0));
    let gate = world.create_body(&BodyDef::fixed(v(2.0, 0.0), 0.0));
    let sensor = world.create_fixture(
        gate,
        &FixtureDef {
            sensor: true,
            ..rect(0.5, 0.5)
        },
    );
    let body = world.create_body(&BodyDef::dynamic(v(0.0, 0.0), 0.0));
    let circle = Shape::Circle {
        center: v(0.0, 0.0),
        radius: 0.25,
    };
    let disc = world.create_fixture(
        body,
        &FixtureDef {
            density: 1.0,
            ..FixtureDef::new(circle)
        },
    );
    world.body_mut(body).velocity = v(5.0, 0.0);
    let mut events = Vec::new();
    for _ in 0..50 {
        world.step(0.02, 10, 5);
        events.extend(
            world
                .events()
                .iter()
                .map(|event| (event.begin, event.fixtures[0], event.fixtures[1])),
        );
    }
    let pair = (FixtureId(sensor), FixtureId(disc));
    assert_eq!(events, [(true, pair.0, pair.1), (false, pair.0, pair.1)]);
    assert_eq!(world.body(body).velocity, v(5.0, 0.0));

    let ray = |to, categories| world.ray_casts(v(0.0, 0.25), &[to], categories)[0];
    let hit = ray(v(4.0, 0.25), 1).unwrap();
    assert_eq!(
        (hit.fixture, hit.fraction),
        (Some(FixtureId(sensor)), 0.375)
    );
    assert_eq!(ray(v(4.0, 0.25), 2), None);
    assert_eq!(ray(v(1.0, 0.25), 1), None);
}

/// Masses computed by pybox2d 2.3.10.
#[test]
fn masses_are_box2ds() {
    let mut world = Box2d::new(v(0.0, 0.0));
    let lander = [
        [-14.0, 17.0],
        [-17.0, 0.0],
        [-17.0, -10.0],
        [17.0, -10.0],
        [17.0, 0.0],
        [14.0, 17.0],
    ];
    let points = lander
        .map(|[x, y]: [f64; 2]| v((x / 30.0) as f32, (y / 30.0) as f32))
        .to_vec();
    let body = world.create_body(&BodyDef::dynamic(v(0.0, 0.0), 0.0));
    world.create_fixture(
        body,
        &FixtureDef {
            density: 5.0,
            ..FixtureDef::new(Shape::Polygon(points))
        },
    );
    let body = world.body(body);
    assert_eq!(body.mass, 4.816_666_6);
    assert_eq!(body.sweep.local_center.y, 0.101_307_19);
    let about_origin =
        body.inertia + body.mass * math::dot(body.sweep.local_center, body.sweep.local_center);
    assert_eq!(about_origin, 0.833_314_9);
}
