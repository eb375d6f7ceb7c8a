//! Runs every target on its seed inputs and on some mutations of them.

use std::thread;

use gym_fuzz::{Mutator, TARGETS, Target};

#[test]
fn targets_survive() {
    thread::scope(|scope| {
        for target in TARGETS {
            // a panic's message names the thread
            let thread = thread::Builder::new().name(target.name.to_owned());
            thread
                .spawn_scoped(scope, || survives(target))
                .expect("a thread");
        }
    });
}

fn survives(target: &Target) {
    const MUTATIONS: usize = 600;
    let seeds = (target.seeds)();
    assert!(
        seeds.len() > 10,
        "{} has too few inputs to start from",
        target.name
    );
    seeds.iter().for_each(|seed| (target.run)(seed));
    let mut mutator = Mutator::new(0);
    for _ in 0..MUTATIONS {
        let (i, j) = (mutator.below(seeds.len()), mutator.below(seeds.len()));
        (target.run)(&mutator.mutate(&seeds[i], &seeds[j]));
    }
}
