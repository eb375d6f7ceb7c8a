//! Vectors of the tasks have the same bits on any number of threads.

use gym_core::registry::{Each, EnvBuilder};
use gym_core::render::RenderMode;
use gym_core::vector::{Autoreset, Columns, VectorEnv, VectorEnvExt, VectorKind, VectorReset};
use gym_core::{BoxEnv, EnvExt, Result, Value, builder, registry};
use gym_mujoco::models;
use gym_sim::SimEnv;
use serde_json::json;

/// Returns the bits of all results of a step.
fn bits(columns: &Columns) -> Vec<u64> {
    let observations = columns
        .observations
        .as_slice::<f64>()
        .expect("rows of float64");
    let flags = columns
        .terminated
        .iter()
        .chain(&columns.truncated)
        .map(|flag| u64::from(*flag));
    observations
        .iter()
        .chain(&columns.rewards)
        .map(|x| x.to_bits())
        .chain(flags)
        .collect()
}

#[test]
fn the_bits_are_the_same_on_any_number_of_threads() {
    const N: usize = 6;
    const STEPS: usize = 60;
    let ids = registry::all()
        .into_iter()
        .map(|entry| entry.id().to_owned());
    let ids: Vec<String> = ids.filter(|id| id.ends_with("-v5")).collect();
    assert_eq!(ids.len(), 11);
    for id in ids {
        let vector = builder(&id).max_episode_steps(25).vector(N);
        let mut sync = vector.clone().kind(VectorKind::Sync).build().unwrap();
        let mut actions = sync.action_sampler(3).unwrap();
        let batches: Vec<_> = (0..STEPS).map(|_| actions.sample()).collect();
        let mut columns = sync.reset(8).unwrap();
        let mut expected = vec![bits(&columns)];
        for batch in &batches {
            sync.step_into(batch, &mut columns).unwrap();
            expected.push(bits(&columns));
        }
        for threads in [1, 2, 4] {
            let mut pool = vector
                .clone()
                .kind(VectorKind::Async)
                .threads(threads)
                .build()
                .unwrap();
            let mut columns = pool.reset(8).unwrap();
            assert!(
                bits(&columns) == expected[0],
                "{id} on {threads} threads, reset"
            );
            for (step, (batch, expected)) in batches.iter().zip(&expected[1..]).enumerate() {
                pool.step_into(batch, &mut columns).unwrap();
                assert!(
                    bits(&columns) == *expected,
                    "{id} on {threads} threads, step {step}"
                );
            }
        }
    }
}

/// Tasks whose worlds step together.
const TOGETHER: [&str; 16] = [
    "HalfCheetah-v5",
    "Hopper-v4",
    "Walker2d-v5",
    "InvertedPendulum-v5",
    "InvertedDoublePendulum-v5",
    "Swimmer-v5",
    "Ant-v5",
    "Ant-v3",
    "Hopper-v5",
    "Humanoid-v5",
    "Humanoid-v3",
    "HumanoidStandup-v5",
    "Reacher-v5",
    "Reacher-v4",
    "Pusher-v5",
    "Pusher-v4",
];

const NATIVE: [VectorKind; 2] = [VectorKind::Native, VectorKind::Sync];

/// Two vectors of different kinds. The methods make the same calls on both, and compare all
/// results.
struct Pair {
    envs: [Box<dyn VectorEnv>; 2],
    columns: [Columns; 2],
    what: String,
}

impl Pair {
    fn new(
        kinds: [VectorKind; 2],
        make: impl Fn(VectorKind) -> Result<Box<dyn VectorEnv>>,
        what: String,
    ) -> Self {
        let envs = kinds.map(|kind| make(kind).unwrap());
        let columns = [0, 1].map(|k| envs[k].columns().unwrap());
        Self {
            envs,
            columns,
            what,
        }
    }

    fn go(&mut self, call: impl Fn(&mut dyn VectorEnv, &mut Columns) -> Result<()>) {
        for (envs, columns) in self.envs.iter_mut().zip(&mut self.columns) {
            call(&mut **envs, columns).unwrap();
        }
        let [native, sync] = &self.columns;
        assert!(bits(native) == bits(sync), "{}", self.what);
        assert_eq!(native.has_final, sync.has_final, "{}", self.what);
        let [native, sync] = [0, 1].map(|k| self.envs[k].infos(&self.columns[k]));
        assert_eq!(format!("{native:?}"), format!("{sync:?}"), "{}", self.what);
    }

    fn step(&mut self, actions: &Value) {
        self.go(|envs, columns| envs.step_into(actions, columns));
    }
}

#[test]
fn worlds_that_step_together_have_the_bits_of_worlds_alone() {
    for id in TOGETHER {
        for (n, mode, mujoco) in [
            (1, Autoreset::NextStep, "4.0"),
            (7, Autoreset::SameStep, "3.12"),
            (8, Autoreset::NextStep, "4.0"),
            (9, Autoreset::NextStep, "3.12"),
            (13, Autoreset::SameStep, "3.12"),
            (67, Autoreset::Disabled, "4.0"),
        ] {
            let make = |kind| {
                builder(id)
                    .arg("mujoco", mujoco)
                    .max_episode_steps(40)
                    .vector(n)
                    .autoreset(mode)
                    .kind(kind)
                    .build()
            };
            let mut pair = Pair::new(NATIVE, make, format!("{id}, {n}, {mode:?}, {mujoco}"));
            let mut actions = pair.envs[1].action_sampler(3).unwrap();
            pair.go(|envs, columns| envs.reset_into(&8.into(), columns));
            let mut kept = None;
            for step in 0..130 {
                let done: Vec<bool> = {
                    let columns = &pair.columns[1];
                    let flags = columns.terminated.iter().zip(&columns.truncated);
                    flags.map(|(a, b)| *a || *b).collect()
                };
                if mode == Autoreset::Disabled && done.contains(&true) {
                    let reset = VectorReset::default().mask(done);
                    pair.go(|envs, columns| envs.reset_into(&reset, columns));
                } else if step % 50 == 20 {
                    // a partial reset
                    let mask: Vec<bool> = (0..n).map(|i| i % 3 == 0).collect();
                    let reset = VectorReset::from(step as u64).mask(mask);
                    pair.go(|envs, columns| envs.reset_into(&reset, columns));
                }
                let batch = actions.sample();
                pair.step(&batch);
                if step == 60 {
                    kept = Some([0, 1].map(|k| pair.envs[k].snapshot().unwrap()));
                }
            }
            // both continue from their snapshots
            for (envs, kept) in pair.envs.iter_mut().zip(kept.unwrap()) {
                envs.restore(&kept).unwrap();
            }
            for _ in 0..5 {
                let batch = actions.sample();
                if mode != Autoreset::Disabled {
                    pair.step(&batch);
                }
            }
        }
    }
}

/// Makes a vector of eight environments. An async vector has one thread.
fn eight(env: EnvBuilder, kind: VectorKind) -> Result<Box<dyn VectorEnv>> {
    let vector = env.vector(8).kind(kind);
    match kind {
        VectorKind::Async => vector.threads(1).build(),
        _ => vector.build(),
    }
}

/// Derived arrays that no task reads are computed on request, and equal the arrays of a world that
/// steps alone.
#[test]
fn all_arrays_are_there_when_asked_for() {
    // a native vector does not give access to its environments; the thread of an async vector steps
    // worlds together, too
    let kinds = [VectorKind::Async, VectorKind::Sync];
    let make = |kind| eight(builder("Walker2d-v5"), kind);
    let mut pair = Pair::new(kinds, make, "Walker2d-v5".into());
    let mut actions = pair.envs[1].action_sampler(5).unwrap();
    pair.go(|envs, columns| envs.reset_into(&1.into(), columns));
    for step in 0..60 {
        let batch = actions.sample();
        pair.step(&batch);
        if step % 20 < 18 {
            continue;
        }
        let [native, sync] = [0, 1].map(|k| {
            let mut seen = Vec::new();
            pair.envs[k]
                .visit_envs(&mut |_, env| {
                    let env = env.downcast_ref::<BoxEnv>().unwrap();
                    let data = env.layer::<SimEnv>().unwrap().data().unwrap().clone();
                    let numbers = data.xpos.as_flattened().iter().chain(&data.qfrc_constraint);
                    let numbers = numbers.chain(&data.qacc).chain(&data.efc.force);
                    let numbers = numbers
                        .chain(data.cfrc_ext.as_flattened())
                        .chain([&data.time]);
                    seen.push(numbers.map(|x| x.to_bits()).collect::<Vec<_>>());
                })
                .unwrap();
            seen
        });
        assert_eq!(native.len(), 8);
        // the last number is the time: some environments have stepped since their reset
        assert!(native.iter().any(|bits| bits.last() > Some(&0)));
        assert!(native == sync, "step {step}");
    }
}

/// Depth frames need derived arrays that no task reads.
#[test]
fn depths_are_those_of_worlds_alone() {
    let kinds = [VectorKind::Async, VectorKind::Sync];
    let make = |kind| {
        let env = builder("Walker2d-v5").render_mode(RenderMode::DepthArray);
        eight(env.arg("width", 24).arg("height", 24), kind)
    };
    let mut pair = Pair::new(kinds, make, "Walker2d-v5".into());
    let mut actions = pair.envs[1].action_sampler(5).unwrap();
    pair.go(|envs, columns| envs.reset_into(&1.into(), columns));
    let mut first = None;
    for step in 0..12 {
        let [shown, expected] = [0, 1].map(|k| pair.envs[k].render().unwrap());
        assert_eq!(shown.len(), 8);
        assert!(shown == expected, "step {step}");
        assert!(step == 0 || first.as_ref() != Some(&shown), "it moves");
        first.get_or_insert(shown);
        let batch = actions.sample();
        pair.step(&batch);
    }
}

/// The infos contain fixed tendons, although no timestep is repeated.
#[test]
fn infos_of_vectors_show_tendons() {
    for id in ["Humanoid-v5", "HumanoidStandup-v5"] {
        let [mut native, mut sync] = [VectorKind::Native, VectorKind::Sync].map(|kind| {
            let vector = builder(id).max_episode_steps(25);
            let mut envs = vector.vector(8).kind(kind).build().unwrap();
            let columns = envs.reset(1).unwrap();
            (envs, columns)
        });
        let mut actions = native.0.action_sampler(5).unwrap();
        let mut lengths = Vec::new();
        for step in 0..60 {
            let batch = actions.sample();
            for (envs, columns) in [&mut native, &mut sync] {
                envs.step_into(&batch, columns).unwrap();
            }
            for index in 0..8 {
                let [shown, expected] = [&native, &sync].map(|(envs, _)| envs.info_map(index));
                assert_eq!(shown, expected, "{id}, step {step}, {index}");
                lengths.extend(shown.get("tendon_length").map(ToString::to_string));
            }
        }
        lengths.dedup();
        assert!(lengths.len() > 200, "{id}: {}", lengths.len());
    }
}

/// A sub-environment with another number of timesteps per step, or another model, steps alone.
#[test]
fn sub_environments_with_other_arguments_step_by_themselves() {
    let (_, text) = models()
        .find(|(name, _)| *name == "half_cheetah.xml")
        .unwrap();
    let rough = text.replace("friction=\"0.4 ", "friction=\"0.9 ");
    assert_ne!(rough, text);
    for (name, usual, other) in [
        ("frame_skip", json!(5), json!(3)),
        ("mujoco", json!("4.0"), json!("3.12")),
        ("xml_file", json!("half_cheetah.xml"), json!(rough)),
    ] {
        let each = (0..9).map(|i| if i == 4 { other.clone() } else { usual.clone() });
        let values: Vec<_> = each.collect();
        let make = |kind| {
            builder("HalfCheetah-v5")
                .vector(9)
                .arg_each(name, Each::Values(values.clone()))
                .kind(kind)
                .build()
        };
        let mut pair = Pair::new(NATIVE, make, format!("HalfCheetah-v5, {name}"));
        let mut actions = pair.envs[1].action_sampler(5).unwrap();
        let seeds = VectorReset::seeds(0..9);
        pair.go(|envs, columns| envs.reset_into(&seeds, columns));
        for _ in 0..50 {
            let batch = actions.sample();
            pair.step(&batch);
        }
    }
}
