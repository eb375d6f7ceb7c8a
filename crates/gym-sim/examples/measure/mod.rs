//! How much faster worlds step together than one by one, for the examples of families.
//!
//! Steps two vectors by the same random actions, in turn, and prints the most steps per second of
//! each: of many short slices, some are not interrupted. Both vectors must give the same numbers.

use std::time::Instant;

use gym_core::vector::{VectorEnvExt, VectorKind};
use gym_core::{Error, Value, builder};

/// Measures vectors of the size and the ids that the command line names.
///
/// # Errors
/// Those of making and stepping a vector.
pub(crate) fn main() -> Result<(), Error> {
    const TRIES: usize = 60;
    let mut arguments = std::env::args().skip(1);
    let number = arguments.next().and_then(|number| number.parse().ok());
    let number = number.unwrap_or(64_usize);
    let steps = (1_500 / number).max(10);
    for id in arguments {
        let mut best = [0.0_f64; 2];
        let mut vectors = Vec::new();
        for kind in [VectorKind::Native, VectorKind::Sync] {
            let mut envs = builder(&id).vector(number).kind(kind).build()?;
            let columns = envs.reset(0)?;
            vectors.push((envs, columns));
        }
        let mut sampler = vectors[0].0.action_sampler(0)?;
        for _ in 0..TRIES {
            let actions: Vec<Value> = (0..steps).map(|_| sampler.sample()).collect();
            for ((envs, columns), best) in vectors.iter_mut().zip(&mut best) {
                let start = Instant::now();
                for action in &actions {
                    envs.step_into(action, columns)?;
                }
                let rate = (number * steps) as f64 / start.elapsed().as_secs_f64();
                *best = best.max(rate);
            }
            let [together, alone] = [0, 1].map(|k| &vectors[k].1);
            assert_eq!(together.observations, alone.observations, "{id}");
            assert_eq!(together.rewards, alone.rewards, "{id}");
        }
        let [together, alone] = best.map(|rate| rate / 1000.0);
        let ratio = together / alone;
        println!(
            "{id}, {number}: {together:.1} k steps/s together, {alone:.1} k one by one: {ratio:.2}"
        );
    }
    Ok(())
}
