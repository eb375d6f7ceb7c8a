//! Runs every target on its seed inputs and on some mutations of them.

use gym_fuzz::{Mutator, TARGETS};

#[test]
fn targets_survive() {
    const MUTATIONS: usize = 600;
    for target in TARGETS {
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
}
