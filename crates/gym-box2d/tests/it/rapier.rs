//! Episodes on rapier2d compared with episodes on Box2D: not equal, but statistically alike.

#![cfg(feature = "rapier")]

use gym_box2d::physics::Physics;
use gym_box2d::{BipedalWalker, LunarLander, bipedal_walker, lunar_lander};
use gym_core::{Env, Outcome, Reset};

/// The return, the length and the last step of an episode.
struct Episode {
    total: f64,
    length: u32,
    last: Outcome,
    observation: Vec<f32>,
}

/// Plays an episode.
fn play<E, const N: usize>(
    mut env: E,
    seed: u64,
    limit: u32,
    mut policy: impl FnMut(&[f32; N]) -> E::Action,
) -> Episode
where
    E: Env<Observation = [f32; N]>,
{
    let mut observation = [0.0; N];
    env.reset_into(&Reset::seed(seed), &mut observation)
        .unwrap();
    let (mut total, mut length) = (0.0, 0);
    loop {
        let last = env
            .step_into(&policy(&observation), &mut observation)
            .unwrap();
        total += last.reward;
        length += 1;
        if last.terminated || length == limit {
            return Episode {
                total,
                length,
                last,
                observation: observation.to_vec(),
            };
        }
    }
}

fn walk(physics: Physics, seed: u64) -> Episode {
    let env = BipedalWalker::new(bipedal_walker::Config {
        hardcore: false,
        physics,
    });
    let mut gait = bipedal_walker::Heuristic::default();
    play(env, seed, 1600, |seen| gait.act(seen).into())
}

fn land(physics: Physics, enable_wind: bool, seed: u64) -> Episode {
    let config = lunar_lander::Config {
        physics,
        enable_wind,
        ..Default::default()
    };
    play(LunarLander::new(config).unwrap(), seed, 1000, |seen| {
        lunar_lander::heuristic(seen, false)
    })
}

/// Returns the largest distance of two empirical distributions (Kolmogorov and Smirnov).
fn distance(a: &[Episode], b: &[Episode], of: impl Fn(&Episode) -> f64) -> f64 {
    let below = |sample: &[Episode], x: f64| {
        sample.iter().filter(|e| of(e) <= x).count() as f64 / sample.len() as f64
    };
    a.iter()
        .chain(b)
        .map(&of)
        .map(|x| (below(a, x) - below(b, x)).abs())
        .fold(0.0, f64::max)
}

/// Asserts that the distances of returns and of lengths are below the 95 % critical value.
fn assert_alike(a: &[Episode], b: &[Episode]) {
    let critical = 1.358 * (2.0 / a.len() as f64).sqrt();
    let returns = distance(a, b, |e| e.total);
    let lengths = distance(a, b, |e| f64::from(e.length));
    assert!(
        returns < critical && lengths < critical,
        "{returns} and {lengths}, critical {critical}"
    );
}

#[test]
fn walks_are_alike() {
    let [exact, rapier] = [Physics::Box2d, Physics::Rapier].map(|physics| {
        (1000..1040)
            .map(|seed| walk(physics, seed))
            .collect::<Vec<_>>()
    });
    assert_alike(&exact, &rapier);
}

#[test]
fn landings_are_alike() {
    for (wind, share) in [(false, 0.9), (true, 0.85)] {
        let [exact, rapier] = [Physics::Box2d, Physics::Rapier].map(|physics| {
            (1000..1100)
                .map(|seed| land(physics, wind, seed))
                .collect::<Vec<_>>()
        });
        assert_alike(&exact, &rapier);
        let end = |e: &Episode| {
            (
                e.last.terminated,
                e.last.reward == 100.0,
                e.observation[0].abs() >= 1.0,
            )
        };
        let same = exact
            .iter()
            .zip(&rapier)
            .filter(|(a, b)| end(a) == end(b))
            .count();
        assert!(
            same as f64 >= share * 100.0,
            "wind {wind}: {same} of 100 end as on Box2D"
        );
    }
}

/// Equal actions move a walker alike on both engines during its first second.
#[test]
fn the_same_actions_walk_the_same_way() {
    for seed in 0..5 {
        let [mut exact, mut rapier] = [Physics::Box2d, Physics::Rapier].map(|physics| {
            BipedalWalker::new(bipedal_walker::Config {
                hardcore: false,
                physics,
            })
        });
        let (mut a, mut b) = ([0.0; 24], [0.0; 24]);
        exact.reset_into(&Reset::seed(seed), &mut a).unwrap();
        rapier.reset_into(&Reset::seed(seed), &mut b).unwrap();
        let mut gait = bipedal_walker::Heuristic::default();
        for step in 0..50 {
            let action = gait.act(&a);
            exact.step_into(&action.into(), &mut a).unwrap();
            rapier.step_into(&action.into(), &mut b).unwrap();
            let apart = a
                .iter()
                .zip(&b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f32::max);
            assert!(apart < 0.05, "seed {seed}, step {step}: {apart}");
        }
    }
}
