//! Groups that step together have the bits of worlds that step one by one.

use fearless_simd::Level;
use gym_control as _;
use gym_core::vector::lockstep::{Lockstep, Together};
use gym_core::vector::{Autoreset, Columns, VectorKind};
use gym_core::{Array, Env, EnvExt, Value, VectorEnvExt, builder, registry};
use gym_render as _;
use gym_sim::Groups;
use gym_sim::SimEnv;
use mujoco_engine::Data;

fn ids() -> impl Iterator<Item = String> {
    let own = registry::all().into_iter();
    let own = own.filter(|entry| entry.source.package == "gym-control");
    let ids: Vec<String> = own.map(|entry| entry.id().to_owned()).collect();
    assert_eq!(ids.len(), 51);
    // of the domains with many shapes, which step one by one, one task is enough
    let many = ["dog-", "humanoid_CMU-", "quadruped-"];
    let left_out = move |id: &String| {
        id != "dm_control/quadruped-walk-v0" && many.iter().any(|name| id.contains(name))
    };
    ids.into_iter().filter(move |id| !left_out(id))
}

/// Returns SIMD levels of this CPU with registers of several widths.
fn levels() -> Vec<Level> {
    let level = Level::new();
    let mut levels = vec![level];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if level.as_avx512().is_some() {
        levels.extend(level.as_avx2().map(Level::Avx2));
    }
    levels
}

/// Returns the bits of an observation and a reward.
fn bits(seen: &Value, reward: f64) -> Vec<u64> {
    let numbers = seen.as_slice::<f64>().expect("a row of float64");
    let numbers = numbers.iter().chain([&reward]);
    numbers.map(|x| x.to_bits()).collect()
}

/// Returns the state and all derived arrays, for comparison.
fn arrays(d: &Data) -> impl PartialEq + std::fmt::Debug + '_ {
    let numbers = [
        &d.qpos,
        &d.qvel,
        &d.qacc,
        &d.qacc_warmstart,
        &d.sensordata,
        &d.qfrc_smooth,
        &d.qfrc_constraint,
        &d.qfrc_actuator,
        &d.efc.force,
    ];
    let vectors = [
        &d.xpos,
        &d.geom_xpos,
        &d.site_xpos,
        &d.subtree_com,
        &d.subtree_linvel,
    ];
    (
        d.time,
        numbers,
        vectors,
        &d.cvel,
        &d.cfrc_int,
        &d.contact,
        d.energy,
    )
}

/// Groups of each task step together and alone, with resets in between. Groups that do not fill a
/// register step alone.
#[test]
fn every_task_has_the_bits_of_worlds_alone() {
    for id in ids() {
        for (mujoco, n) in [("4.0", 13), ("3.12", 8)] {
            let spec = builder(&id).arg("flat", true).arg("mujoco", mujoco);
            let made = spec.build().unwrap();
            let made = made.layer::<SimEnv>().expect("a task");
            for level in levels() {
                play(made, n, level, &format!("{id} {mujoco} {level:?}"));
            }
        }
    }
}

/// Eight worlds of a task step together if they have one model, or models that differ in stiffness as
/// those of `lqr` do: each world of `point_mass-hard` draws another gear.
#[test]
fn worlds_of_most_tasks_step_together() {
    let alone = ["point_mass-hard", "quadruped"];
    for id in ids() {
        let made = builder(&id).arg("flat", true).build().unwrap();
        let made = made.layer::<SimEnv>().expect("a task");
        let (mut envs, mut seen) = (vec![made.clone(); 8], Value::default());
        let mut worlds = Groups::default();
        let action = made.action_sampler(4).unwrap().sample().clone();
        for (seed, env) in (0_u64..).zip(&mut envs) {
            env.reset_into(&seed.into(), &mut seen).unwrap();
            env.begin_step(&action, &mut worlds);
        }
        worlds.solve();
        let behind = envs.iter_mut().map(|env| {
            env.collect(&mut worlds);
            env.step_into(&action, &mut seen).unwrap();
            usize::from(env.has_stale_arrays())
        });
        let is_alone = alone.iter().any(|name| id.contains(name));
        let expected = if is_alone || !Groups::can_step() {
            0
        } else {
            8
        };
        assert_eq!(behind.sum::<usize>(), expected, "{id}");
    }
}

fn play(made: &SimEnv, n: usize, level: Level, what: &str) {
    let mut worlds = Groups::new(level);
    let mut envs = vec![made.clone(); n];
    let mut alone = envs.clone();
    let (mut seen, mut expected) = (Value::default(), Value::default());
    let mut sampler = made.action_sampler(4).unwrap();
    for step in 0..110 {
        for (i, (env, alone)) in envs.iter_mut().zip(&mut alone).enumerate() {
            // episodes of different lengths
            if step % (40 + i) == 0 {
                let reset = if step == 0 {
                    (i as u64).into()
                } else {
                    ().into()
                };
                env.reset_into(&reset, &mut seen).unwrap();
                alone.reset_into(&reset, &mut expected).unwrap();
                assert_eq!(bits(&seen, 0.0), bits(&expected, 0.0), "{what}, world {i}");
            }
        }
        let actions: Vec<Array> = (0..n).map(|_| sampler.sample().clone()).collect();
        worlds.clear();
        for (env, action) in envs.iter_mut().zip(&actions) {
            env.begin_step(action, &mut worlds);
        }
        worlds.solve();
        for (i, (env, alone)) in envs.iter_mut().zip(&mut alone).enumerate() {
            env.collect(&mut worlds);
            let outcome = env.step_into(&actions[i], &mut seen).unwrap();
            let other = alone.step_into(&actions[i], &mut expected).unwrap();
            let what = format!("{what}, world {i}, step {step}");
            assert_eq!(
                bits(&seen, outcome.reward),
                bits(&expected, other.reward),
                "{what}"
            );
            assert_eq!(outcome, other, "{what}");
            if (step + i) % 37 == 0 {
                let [own, other] = [&*env, &*alone].map(|env| env.data().unwrap());
                assert_eq!(arrays(own), arrays(other), "{what}");
            }
            if (step, i) == (60, 1) {
                let snapshot = env.snapshot().unwrap();
                assert_eq!(snapshot, alone.snapshot().unwrap(), "{what}");
                env.restore(&snapshot).unwrap();
            }
        }
    }
}

/// Returns the bits of all results of a vector's step.
fn column_bits(columns: &Columns) -> Vec<u64> {
    let flags = columns.terminated.iter().chain(&columns.truncated);
    let flags = flags.map(|flag| u64::from(*flag));
    let numbers = columns.observations.as_slice::<f64>().expect("rows");
    let numbers = numbers.iter().chain(&columns.rewards);
    numbers.map(|x| x.to_bits()).chain(flags).collect()
}

/// Native, async and sync vectors give the same bits, with time limits and autoresets.
#[test]
fn vectors_have_the_bits_of_sync_ones() {
    let kinds = [VectorKind::Sync, VectorKind::Native, VectorKind::Async];
    for id in ids() {
        for (n, mode) in [
            (1, Autoreset::SameStep),
            (7, Autoreset::NextStep),
            (13, Autoreset::NextStep),
            (8, Autoreset::SameStep),
            (67, Autoreset::SameStep),
        ] {
            let steps = 130.min(1500 / n);
            let make = |kind| {
                let spec = builder(&id).arg("flat", true).max_episode_steps(60);
                spec.vector(n).autoreset(mode).kind(kind).build().unwrap()
            };
            let mut vectors = kinds.map(make);
            let mut columns = vectors.each_mut().map(|envs| envs.reset(8).unwrap());
            let mut actions = vectors[0].action_sampler(3).unwrap();
            for step in 0..steps {
                let batch = actions.sample();
                for (envs, columns) in vectors.iter_mut().zip(&mut columns) {
                    envs.step_into(&batch, columns).unwrap();
                }
                let [sync, native, pool] = columns.each_ref().map(column_bits);
                assert!(native == sync, "{id}, {n}, {mode:?}, native, step {step}");
                assert!(pool == sync, "{id}, {n}, {mode:?}, async, step {step}");
            }
        }
    }
}
