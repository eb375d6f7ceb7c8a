//! Worlds by lot: shapes of every kind, with every property, joints, kicks and bodies that are destroyed. They move as when
//! Box2D's own recordings were equal.

use gym_box2d::physics::{
    BodyDef, BodyId, Filter, FixtureDef, JointId, RevoluteJointDef, Shape, Vec2, World,
};

/// The digest of each world's poses, velocities, contacts and rays.
const DIGESTS: [u64; 16] = [
    0x44db_c150_c902_b967,
    0x52aa_3d4d_9ac7_f601,
    0xec6e_a983_8df6_0eeb,
    0x85bb_e072_d96b_71b1,
    0xe95b_3505_e216_1c09,
    0x97f0_27b5_7d3e_8173,
    0x4f2c_030f_5e8a_1ff3,
    0x4a32_0253_cb44_0ed2,
    0x0869_37dd_ad2e_e8e6,
    0xc469_0fe1_b319_66fc,
    0xf5d9_c061_c4c0_ec9b,
    0x4e8b_f844_f5ab_ed48,
    0xf502_5b58_85d3_0965,
    0x3ddf_423e_5b7e_1ecc,
    0x4bfa_acc2_93fd_06ff,
    0xf25e_6d94_47b0_fab8,
];

/// Draws numbers.
struct Lot(u64);

impl Lot {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) % n
    }

    /// A number of 64 steps from `low` to `high`.
    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.below(65) as f32 / 64.0
    }

    fn at(&mut self, low: f32, high: f32) -> Vec2 {
        Vec2::new(self.between(low, high), self.between(low, high))
    }

    fn shape(&mut self) -> Shape {
        match self.below(5) {
            0 => Shape::Circle {
                center: self.at(-0.1, 0.1),
                radius: self.between(0.1, 0.5),
            },
            1 | 2 => Shape::Rect {
                half_width: self.between(0.1, 0.6),
                half_height: self.between(0.1, 0.6),
            },
            3 => Shape::Polygon(
                [(-0.4, -0.3), (0.5, -0.2), (0.1, 0.6)]
                    .map(|(x, y)| Vec2::new(x, y))
                    .into(),
            ),
            _ => {
                let corners = [
                    (-0.3, -0.4),
                    (0.3, -0.4),
                    (0.6, 0.0),
                    (0.2, 0.5),
                    (-0.5, 0.3),
                ];
                Shape::Polygon(corners.map(|(x, y)| Vec2::new(x, y)).into())
            }
        }
    }

    fn fixture(&mut self) -> FixtureDef {
        let filters = [(1, 0xffff), (1, 0xffff), (2, 1), (4, 0xfffb)];
        let (category, mask) = filters[self.below(4) as usize];
        FixtureDef {
            density: self.between(0.5, 3.0),
            friction: self.between(0.0, 1.0),
            restitution: [0.0, 0.0, 0.3, 0.9][self.below(4) as usize],
            filter: Filter { category, mask },
            sensor: self.below(9) == 0,
            ..FixtureDef::new(self.shape())
        }
    }

    fn joint(&mut self, [body_a, body_b]: [BodyId; 2]) -> RevoluteJointDef {
        RevoluteJointDef {
            body_a,
            body_b,
            local_anchor_a: self.at(-0.5, 0.5),
            local_anchor_b: self.at(-0.5, 0.5),
            limits: [None, Some((-0.4, 0.7)), Some((0.1, 0.1)), Some((-3.0, 3.0))]
                [self.below(4) as usize],
            motor: self.below(2) == 0,
            motor_speed: self.between(-4.0, 4.0),
            max_motor_torque: self.between(0.0, 30.0),
            collide_connected: self.below(3) == 0,
        }
    }
}

fn add(digest: &mut u64, number: f32) {
    *digest = (*digest ^ u64::from(number.to_bits())).wrapping_mul(0x100_0000_01b3);
}

fn digest(seed: u64) -> u64 {
    let (mut lot, mut digest) = (Lot(seed), 0xcbf2_9ce4_8422_2325);
    let mut world = World::new(Vec2::new(lot.between(-1.0, 1.0), -10.0));
    let heights = [0.5, 0.0, 0.3, -0.5, -0.5, 0.0, 0.8, 0.1, 2.0];
    let points = (-4..)
        .map(|x| 3.0 * x as f32)
        .zip(heights)
        .map(|(x, y)| Vec2::new(x, y));
    world.create_terrain(&points.collect::<Vec<_>>(), 0.6);
    let wall = world.create_body(&BodyDef::fixed(Vec2::new(6.0, 2.0), 0.2));
    world.create_fixture(wall, &lot.fixture());
    world.create_fixture(
        wall,
        &FixtureDef::new(Shape::Edge(Vec2::new(0.0, -2.0), Vec2::new(0.3, 3.0))),
    );
    let mut bodies = Vec::new();
    let mut joints: Vec<(JointId, [BodyId; 2])> = Vec::new();
    for i in 0..5 + lot.below(6) {
        let at = Vec2::new(lot.between(-6.0, 5.0), 1.0 + 0.8 * i as f32);
        let body = world.create_body(&BodyDef::dynamic(at, lot.between(-3.0, 3.0)));
        for _ in 0..1 + lot.below(2) {
            world.create_fixture(body, &lot.fixture());
        }
        if let (Some(&before), 0) = (bodies.last(), lot.below(2)) {
            let pair = [before, body];
            joints.push((world.create_revolute_joint(&lot.joint(pair)), pair));
        }
        bodies.push(body);
    }
    for step in 0..240 {
        let body = bodies[lot.below(bodies.len() as u64) as usize];
        match lot.below(12) {
            0 => world.apply_force_to_center(body, lot.at(-90.0, 90.0)),
            1 => world.apply_torque(body, lot.between(-20.0, 20.0)),
            2 => {
                // fast enough to be stopped by sweeps
                let impulse = lot.at(-25.0, 25.0);
                world.apply_linear_impulse(body, impulse, world.position(body) + lot.at(-0.2, 0.2));
            }
            3 if !joints.is_empty() => {
                let (joint, _) = joints[lot.below(joints.len() as u64) as usize];
                world.set_motor_speed(joint, lot.between(-5.0, 5.0));
                world.set_max_motor_torque(joint, lot.between(0.0, 40.0));
            }
            4 if step > 150 && bodies.len() > 3 => {
                world.destroy_body(body);
                bodies.retain(|other| *other != body);
                joints.retain(|(_, pair)| !pair.contains(&body));
            }
            _ => {}
        }
        let iterations = [(180, 60), (6, 2), (30, 10)][(seed % 3) as usize];
        world.step(
            [0.02, 1.0 / 60.0][(seed % 2) as usize],
            iterations.0,
            iterations.1,
        );
        for event in world.contact_events() {
            add(&mut digest, if event.begin { 1.0 } else { 2.0 });
        }
        for &body in &bodies {
            let (at, velocity) = (world.position(body), world.linear_velocity(body));
            let numbers = [at.x, at.y, world.angle(body), velocity.x, velocity.y];
            numbers.iter().for_each(|number| add(&mut digest, *number));
            add(&mut digest, world.angular_velocity(body));
            add(&mut digest, f32::from(u8::from(world.is_awake(body))));
        }
        for (joint, _) in &joints {
            add(&mut digest, world.joint_angle(*joint));
            add(&mut digest, world.joint_speed(*joint));
        }
        let from = lot.at(-6.0, 6.0);
        if let Some(hit) =
            world.ray_cast(from, lot.at(-6.0, 6.0), [1, 2, 0xffff][(seed % 3) as usize])
        {
            for number in [hit.point.x, hit.point.y, hit.fraction] {
                add(&mut digest, number);
            }
        }
    }
    digest
}

#[test]
fn worlds_by_lot_move_as_before() {
    let found: Vec<_> = (0..16).map(digest).collect();
    assert_eq!(found, DIGESTS, "{found:#018x?}");
}
