//! `cargo run --package gym-fuzz -- [TARGET...] [--seconds N]`

use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use gym_fuzz::{Mutator, TARGETS, Target};

#[derive(Parser)]
#[command(
    about = "Feeds mutated inputs to the fuzz targets; a target that panics leaves its input in fuzz/artifacts"
)]
struct Arguments {
    /// The targets; default: all.
    targets: Vec<String>,
    /// The seconds that each target runs.
    #[arg(long, default_value_t = 10)]
    seconds: u64,
    /// The seed of the mutations.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Tries these files instead of mutations.
    #[arg(long)]
    input: Vec<PathBuf>,
    /// Replaces each part of each seed input that is JSON in turn, instead of parts by lot.
    #[arg(long)]
    everywhere: bool,
    /// Writes the seed inputs to fuzz/corpus, for `cargo fuzz`, and exits.
    #[arg(long)]
    write_corpus: bool,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let unknown = arguments
        .targets
        .iter()
        .find(|name| TARGETS.iter().all(|target| target.name != **name));
    if let Some(name) = unknown {
        let known: Vec<_> = TARGETS.iter().map(|target| target.name).collect();
        eprintln!(
            "error: unknown target `{name}`: the targets are {}",
            known.join(", ")
        );
        return ExitCode::FAILURE;
    }
    let chosen = |target: &&Target| {
        arguments.targets.is_empty() || arguments.targets.iter().any(|name| name == target.name)
    };
    match TARGETS
        .iter()
        .filter(chosen)
        .try_fold(0, |crashes, target| Ok(crashes + run(target, &arguments)?))
    {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err::<usize, std::io::Error>(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Runs a target; returns the number of distinct crashes.
fn run(target: &Target, arguments: &Arguments) -> std::io::Result<usize> {
    const SLOW: Duration = Duration::from_secs(5);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut inputs = (target.seeds)();
    if arguments.write_corpus {
        let corpus = folder.join("corpus").join(target.name);
        fs::create_dir_all(&corpus)?;
        return inputs
            .iter()
            .enumerate()
            .try_for_each(|(i, seed)| fs::write(corpus.join(i.to_string()), seed))
            .map(|()| 0);
    }
    if !arguments.input.is_empty() {
        inputs = arguments
            .input
            .iter()
            .map(|path| gym::file::read(path, usize::MAX))
            .collect::<Result<_, _>>()?;
    }
    let (mut mutator, mut crashes) = (Mutator::new(arguments.seed), BTreeSet::new());
    let (start, mut tried) = (Instant::now(), 0u64);
    let seeds = inputs.len();
    let chosen = if arguments.everywhere {
        &inputs[..]
    } else {
        &[]
    };
    let mut everywhere = chosen.iter().flat_map(|seed| Mutator::everywhere(seed));
    loop {
        let is_over = start.elapsed().as_secs() >= arguments.seconds;
        let input = match inputs.get(tried as usize) {
            Some(seed) => seed.clone(),
            None if !arguments.input.is_empty() || is_over => break,
            None if arguments.everywhere => match everywhere.next() {
                Some(input) => input,
                None => break,
            },
            None => {
                let (i, j) = (mutator.below(seeds), mutator.below(seeds));
                mutator.mutate(&inputs[i], &inputs[j])
            }
        };
        let begun = Instant::now();
        let panicked = catch_unwind(AssertUnwindSafe(|| (target.run)(&input))).is_err();
        let slow = begun.elapsed() > SLOW;
        tried += 1;
        if (panicked || slow) && crashes.insert(input.clone()) {
            let artifacts = folder.join("artifacts").join(target.name);
            fs::create_dir_all(&artifacts)?;
            let kind = if panicked { "crash" } else { "slow" };
            let path = artifacts.join(format!("{kind}-{}-{tried}", arguments.seed));
            fs::write(&path, &input)?;
            eprintln!("{}: {kind}", path.display());
        }
    }
    println!(
        "{}: {tried} inputs in {:.0?}, {} of them bad",
        target.name,
        start.elapsed(),
        crashes.len()
    );
    Ok(crashes.len())
}
