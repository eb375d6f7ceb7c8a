//! Steps of typed and erased environments: `cargo bench --package gym`.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use gym::classic::cartpole::{CartPole, Config};
use gym::wrappers::TimeLimit;
use gym::{Element, Env, registry};

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
    for registration in registry::all() {
        let id = registration.id();
        bench(criterion, &format!("make {id}"), gym::make(id).expect("a registered id"));
    }
}

criterion_group!(benches, steps);
criterion_main!(benches);
