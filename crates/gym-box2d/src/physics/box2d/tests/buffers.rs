//! Working memory that serves one world after another.

use gym_core::exact::is_finite;

use super::*;

/// A world on the ground, which its next step fills with NaN.
fn poisoned() -> Box2d {
    let mut world = falling_pair(0.3);
    (0..30).for_each(|_| world.step(0.02, 40, 20));
    assert!(world.contacts.iter().any(|contact| contact.touching));
    for id in world.dynamic.clone() {
        let body = world.body_mut(id);
        body.apply_force(v(f32::NAN, f32::INFINITY));
        body.apply_torque(f32::NAN);
    }
    world
}

/// The numbers of one world never reach another, alone and in lanes.
#[test]
fn no_number_passes_from_one_world_to_the_next() {
    const WORLDS: usize = 19;
    let poisoned = poisoned();
    let worlds = || -> Vec<Box2d> {
        let height = |i: usize| 0.5 + 0.1 * i as f32;
        let mut worlds: Vec<_> = (1..WORLDS).map(|i| falling_pair(height(i))).collect();
        worlds.push(chain());
        worlds
    };
    let mut island = Island::new();
    for mut lanes in Lanes::of_each_level() {
        let (mut fresh, mut alone, mut together) = (worlds(), worlds(), worlds());
        for step in 0..120 {
            for world in &mut fresh {
                world.step(0.02, 40, 20);
            }
            for world in &mut alone {
                let mut bad = poisoned.clone();
                bad.step_in(&mut island, 0.02, 40, 20);
                assert!(!is_finite(&bad));
                world.step_in(&mut island, 0.02, 40, 20);
            }
            let mut bad = vec![poisoned.clone(); WORLDS];
            for worlds in [&mut bad, &mut together] {
                lanes.clear();
                let places: Vec<_> = worlds
                    .iter_mut()
                    .map(|world| lanes.begin(world, 0.02, 40, 20))
                    .collect();
                lanes.solve_velocities();
                for (world, place) in worlds.iter_mut().zip(places) {
                    lanes.finish(place, world);
                }
            }
            if step % 20 == 19 {
                let bits = |worlds: &[Box2d]| worlds.iter().map(json).collect::<Vec<_>>();
                assert!(bits(&fresh) == bits(&alone), "step {step}");
                assert!(
                    bits(&fresh) == bits(&together),
                    "step {step}, {:?}",
                    lanes.level()
                );
            }
        }
    }
}
