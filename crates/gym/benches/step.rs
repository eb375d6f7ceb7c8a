//! Steps of typed environments, made ones and vectors: `cargo bench --package gym`.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gym::classic::cartpole::{CartPole, Config};
use gym::vector::VectorKind;
use gym::wrappers::TimeLimit;
use gym::{Element, Env, EnvExt, VectorEnv, VectorEnvExt, registry};

/// Plays `steps` random steps, with the resets that come between.
fn play<E: Env>(env: &mut E, actions: &[E::Action], observation: &mut E::Observation) {
    for action in actions {
        let outcome = env.step_into(action, observation).expect("a valid action");
        if outcome.done() {
            env.reset_into(&().into(), observation).expect("no options");
        }
    }
    black_box(observation);
}

fn bench<E: Env>(criterion: &mut Criterion, name: &str, mut env: E) {
    const STEPS: usize = 10_000;
    let mut sampler = env.action_sampler(0).unwrap();
    let actions: Vec<E::Action> = (0..STEPS).map(|_| sampler.sample()).collect();
    let mut observation = E::Observation::empty();
    env.reset_into(&0.into(), &mut observation).expect("no options");
    let mut group = criterion.benchmark_group("step");
    group.throughput(Throughput::Elements(STEPS as u64));
    group.bench_function(name, |bencher| bencher.iter(|| play(&mut env, &actions, &mut observation)));
    group.finish();
}

fn steps(criterion: &mut Criterion) {
    let cartpole = CartPole::new(Config::default()).expect("default arguments");
    bench(criterion, "typed CartPole", cartpole.clone());
    bench(criterion, "typed CartPole with a time limit", TimeLimit::new(cartpole, 500).expect("a limit"));
    for registration in registry::self_contained() {
        let id = registration.id();
        bench(criterion, &format!("make {id}"), gym::make(id).expect("a registered id"));
    }
}

/// Steps of a whole vector, counted for each of its environments.
fn vectors(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("vector");
    for registration in registry::self_contained() {
        for kind in VectorKind::ALL {
            if kind == VectorKind::Native && registration.vector_entry_point.is_none() {
                continue;
            }
            for num_envs in [64, 1024] {
                let id = registration.id();
                let mut envs = gym::make_vec(id, num_envs, kind).expect("a registered id");
                let actions = envs.action_space().expect("a batched space").sampler(0).sample();
                let mut columns = envs.columns().expect("a batched space");
                envs.reset_into(&0.into(), &mut columns).expect("no options");
                group.throughput(Throughput::Elements(num_envs as u64));
                group.bench_function(format!("{kind} {id} {num_envs}"), |bencher| {
                    bencher.iter(|| envs.step_into(&actions, &mut columns).expect("valid actions"));
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, steps, vectors);
criterion_main!(benches);
