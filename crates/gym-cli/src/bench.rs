//! `cargo xtask bench`: the speed of the environments, through `make` and as vectors.

use std::fmt;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use clap::{ValueEnum, builder::PossibleValue};
use gym::render::{Recorder, RenderMode};
use gym::vector::{VectorEnvExt, VectorKind};
use gym::{Element, Env, EnvExt, Error, Registration, Result, registry};

use serde::{Deserialize, Serialize};

use crate::inputs;
use crate::output::say;
use crate::policy::Policy;
use crate::workspace::Workspace;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environments; by default those that this workspace registers.
    ids: Vec<String>,
    /// Sizes of the vectors.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 64, 1024, 16384], allow_negative_numbers = true, value_parser = parse_num_envs)]
    num_envs: Vec<usize>,
    /// The kinds to measure; all by default.
    #[arg(long, value_enum, value_delimiter = ',')]
    kind: Vec<Kind>,
    /// Seconds for each number. The fastest tenth of that time counts, since other programs slow
    /// the rest.
    #[arg(long, default_value_t = 0.5, allow_negative_numbers = true, value_parser = parse_seconds)]
    seconds: f64,
    /// Also counts instructions, with `valgrind`, which takes much longer.
    #[arg(long)]
    instructions: bool,
    /// Also records 500 frames of random episodes of CartPole-v1 to a GIF.
    #[arg(long)]
    gif: bool,
    /// Writes the numbers to a file, as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Only takes this many steps of one environment, kind and size; used to count instructions.
    #[arg(long, hide = true)]
    only_steps: Option<u64>,
}

fn parse_num_envs(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|number| *number > 0);
    number.ok_or_else(|| "the number of sub-environments is a whole number from 1".to_owned())
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    const MAX: f64 = 86_400.0; // a day
    let seconds = text
        .parse()
        .ok()
        .filter(|seconds| (0.0..=MAX).contains(seconds));
    seconds.ok_or_else(|| format!("seconds are a number from 0 to {MAX}"))
}

/// A way to run an environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    /// From `make`.
    Make,
    /// A vector, stepped by one thread.
    Sync,
    /// A vector, stepped by as many threads as there are cores.
    Async,
    /// The native vector of the environment.
    Native,
    /// From `make`, with a frame after each step.
    Frames,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.to_possible_value();
        f.pad(value.as_ref().map_or("", PossibleValue::get_name))
    }
}

#[derive(Serialize)]
struct Row {
    id: String,
    kind: Kind,
    num_envs: usize,
    /// Steps per second, summed over the sub-environments; for `frames`, frames per second.
    per_second: f64,
    instructions_per_step: Option<f64>,
}

#[derive(Serialize)]
struct Report {
    cores: usize,
    rows: Vec<Row>,
    gif: Option<Gif>,
    start: Option<Start>,
}

/// The recording of a GIF with 500 frames of CartPole-v1.
#[derive(Serialize)]
struct Gif {
    seconds: f64,
    bytes: u64,
}

/// The time of a process that makes CartPole-v1, resets it and takes a step.
#[derive(Serialize)]
struct Start {
    milliseconds: f64,
}

/// A function that takes at least the given number of steps, and returns the number of steps taken.
type Work = Box<dyn FnMut(u64) -> Result<u64>>;

pub(crate) fn bench(arguments: &Arguments, workspace: &Workspace) -> Result<()> {
    if let Some(steps) = arguments.only_steps {
        let ([id], [kind], [n]) = (
            &arguments.ids[..],
            &arguments.kind[..],
            &arguments.num_envs[..],
        ) else {
            let reason = "name an id, a kind and a number, one of each";
            return Err(Error::custom(reason));
        };
        if let Some(mut work) = work(id, *kind, *n)? {
            work(steps)?;
        }
        return Ok(());
    }
    if let Some(path) = &arguments.json {
        inputs::check_writable(path)?;
    }
    let registrations = workspace.select(&arguments.ids)?;
    // without restrictions, also measure the start of a process and a GIF, both with CartPole-v1
    let all = arguments.ids.is_empty()
        && arguments.kind.is_empty()
        && registrations
            .iter()
            .any(|registration| registration.id() == "CartPole-v1");
    let kinds = if arguments.kind.is_empty() {
        Kind::value_variants()
    } else {
        &arguments.kind
    };

    say(format_args!(
        "{:36} {:>7} {:>7} {:>14} {:>12}",
        "environment", "kind", "n", "per second", "instructions"
    ))?;
    let mut rows = Vec::new();
    for id in registrations.iter().map(Registration::id) {
        for &kind in kinds {
            let vector = matches!(kind, Kind::Sync | Kind::Async | Kind::Native);
            for &num_envs in if vector {
                &arguments.num_envs[..]
            } else {
                &[1]
            } {
                let Some(work) = work(id, kind, num_envs)? else {
                    continue;
                };
                let per_second = measure(work, arguments.seconds)?;
                let instructions_per_step = if arguments.instructions {
                    Some(instructions(id, kind, num_envs)?)
                } else {
                    None
                };
                let counted =
                    instructions_per_step.map_or_else(String::new, |count| format!("{count:.1}"));
                say(format_args!(
                    "{id:36} {kind:>7} {num_envs:>7} {per_second:>14.0} {counted:>12}"
                ))?;
                rows.push(Row {
                    id: id.to_owned(),
                    kind,
                    num_envs,
                    per_second,
                    instructions_per_step,
                });
            }
        }
    }
    let gif = if all || arguments.gif {
        Some(gif()?)
    } else {
        None
    };
    if let Some(Gif { seconds, bytes }) = &gif {
        say(format_args!(
            "a GIF of 500 frames of CartPole-v1: {seconds:.2} s, {bytes} bytes"
        ))?;
    }
    let start = if all { Some(start()?) } else { None };
    if let Some(Start { milliseconds }) = &start {
        say(format_args!(
            "from the start of a process to the first step of CartPole-v1: {milliseconds:.1} ms"
        ))?;
    }
    if let Some(path) = &arguments.json {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let report = serde_json::to_vec_pretty(&Report {
            cores,
            rows,
            gif,
            start,
        });
        let report = report.map_err(|error| Error::custom(error.to_string()))?;
        gym::render::file::write(path, &report)?;
    }
    Ok(())
}

/// Returns the work of a kind; `None` if the environment does not support the kind.
fn work(id: &str, kind: Kind, num_envs: usize) -> Result<Option<Work>> {
    Ok(Some(match kind {
        Kind::Make => scalar(gym::make(id)?)?,
        Kind::Sync => vector(id, num_envs, VectorKind::Sync)?,
        Kind::Async => vector(id, num_envs, VectorKind::Async)?,
        Kind::Native if !has_native(id) => return Ok(None),
        Kind::Native => vector(id, num_envs, VectorKind::Native)?,
        Kind::Frames => frames(id)?,
    }))
}

fn has_native(id: &str) -> bool {
    registry::all()
        .iter()
        .any(|registration| registration.id() == id && registration.vector_entry_point.is_some())
}

/// The number of actions that are sampled before the measurement, and then taken in turn.
const ACTIONS: usize = 1024;

fn scalar<E: Env>(mut env: E) -> Result<Work> {
    let mut sampler = env.action_sampler(0)?;
    let actions: Vec<E::Action> = (0..ACTIONS).map(|_| sampler.sample()).collect();
    let mut observation = env.reset(0)?;
    Ok(Box::new(move |steps| {
        for step in 0..steps {
            let outcome = env.step_into(&actions[step as usize % ACTIONS], &mut observation)?;
            if outcome.done() {
                env.reset_into(&().into(), &mut observation)?;
            }
        }
        black_box(&observation);
        Ok(steps)
    }))
}

fn vector(id: &str, num_envs: usize, kind: VectorKind) -> Result<Work> {
    let mut envs = gym::builder(id).vector(num_envs).kind(kind).build()?;
    let mut sampler = envs.action_space()?.sampler(0);
    let actions: Vec<_> = (0..16).map(|_| sampler.sample()).collect();
    let mut columns = envs.columns()?;
    envs.reset_into(&0.into(), &mut columns)?;
    Ok(Box::new(move |steps| {
        let rounds = steps.div_ceil(num_envs as u64);
        for round in 0..rounds {
            envs.step_into(&actions[round as usize % actions.len()], &mut columns)?;
        }
        black_box(&columns);
        Ok(rounds * num_envs as u64)
    }))
}

fn frames(id: &str) -> Result<Work> {
    let mut env = gym::builder(id).render_mode(RenderMode::RgbArray).build()?;
    let mut actions = env.action_sampler(0)?;
    let mut observation = gym::Value::empty();
    env.reset_into(&0.into(), &mut observation)?;
    let mut rendered = env.render()?;
    Ok(Box::new(move |frames| {
        for _ in 0..frames {
            if env.step_into(&actions.sample(), &mut observation)?.done() {
                env.reset_into(&().into(), &mut observation)?;
            }
            env.render_into(&mut rendered)?;
            black_box(&rendered);
        }
        Ok(frames)
    }))
}

/// Returns the steps per second in the fastest tenth of the time.
fn measure(mut work: Work, seconds: f64) -> Result<f64> {
    let slice = Duration::from_secs_f64((seconds / 10.0).max(1e-3));
    let mut timed = |steps| {
        let started = Instant::now();
        work(steps).map(|done| (done, started.elapsed()))
    };
    let mut steps = 1;
    let (mut done, mut elapsed) = timed(steps)?;
    while elapsed < slice / 2 {
        steps = 2 * done.max(1);
        (done, elapsed) = timed(steps)?;
    }
    let mut best = done as f64 / elapsed.as_secs_f64();
    for _ in 0..9 {
        let (done, elapsed) = timed(steps)?;
        best = best.max(done as f64 / elapsed.as_secs_f64());
    }
    Ok(best)
}

/// Returns the instructions per step: the difference between a long and a short run under
/// `valgrind`, divided by the steps.
fn instructions(id: &str, kind: Kind, num_envs: usize) -> Result<f64> {
    let count = |steps: u64| -> Result<u64> {
        let program = std::env::current_exe().map_err(|error| Error::custom(error.to_string()))?;
        let output = Command::new("valgrind")
            .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
            .arg(program)
            .args([
                "bench",
                id,
                "--kind",
                &kind.to_string(),
                "--num-envs",
                &num_envs.to_string(),
            ])
            .args(["--only-steps", &steps.to_string()])
            .output()
            .map_err(|error| Error::custom(format!("valgrind: {error}: is it installed?")))?;
        let text = String::from_utf8_lossy(&output.stderr);
        let collected = text
            .lines()
            .find_map(|line| line.split("Collected : ").nth(1));
        collected
            .and_then(|count| count.trim().parse().ok())
            .ok_or_else(|| Error::custom(format!("valgrind gives no count: {text}")))
    };
    // (enough steps for several episodes)
    let short = (10 * num_envs as u64).max(2000);
    let long = 6 * short;
    Ok((count(long)? as f64 - count(short)? as f64) / (long - short) as f64)
}

fn gif() -> Result<Gif> {
    let path = std::env::temp_dir().join(format!("gym-bench-{}.gif", std::process::id()));
    let started = Instant::now();
    let mut env = gym::builder("CartPole-v1")
        .render_mode(RenderMode::RgbArray)
        .build()?;
    let mut recorder = Recorder::new(&path, &env)?.max_frames(500);
    for seed in 0..50 {
        Policy::Random.play(&mut env, seed, |env| recorder.capture(env))?;
    }
    recorder.finish()?;
    let seconds = started.elapsed().as_secs_f64();
    let bytes = std::fs::metadata(&path)
        .map_err(|error| Error::custom(error.to_string()))?
        .len();
    std::fs::remove_file(&path).ok();
    Ok(Gif { seconds, bytes })
}

fn start() -> Result<Start> {
    let program = std::env::current_exe().map_err(|error| Error::custom(error.to_string()))?;
    let run = |program: &Path| -> Result<Duration> {
        let started = Instant::now();
        Command::new(program)
            .args([
                "bench",
                "CartPole-v1",
                "--kind",
                "make",
                "--num-envs",
                "1",
                "--only-steps",
                "1",
            ])
            .status()
            .map_err(|error| Error::custom(error.to_string()))?;
        Ok(started.elapsed())
    };
    let fastest = (0..20)
        .map(|_| run(&program))
        .collect::<Result<Vec<_>>>()?
        .into_iter()
        .min();
    Ok(Start {
        milliseconds: fastest.unwrap_or_default().as_secs_f64() * 1e3,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gym::{Outcome, Reset, Space};

    /// An environment whose episodes have three steps. A step after the end is an error.
    #[derive(Clone, Debug, Default)]
    struct Three {
        steps: u32,
        resets: std::sync::Arc<std::sync::atomic::AtomicU32>,
    }

    impl Env for Three {
        type Observation = i64;
        type Action = i64;

        fn observation_space(&self) -> Space {
            Space::discrete(4)
        }

        fn action_space(&self) -> Space {
            Space::discrete(2)
        }

        fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
            self.resets
                .fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            (self.steps, *observation) = (0, 0);
            Ok(())
        }

        fn step_into(&mut self, _: &i64, observation: &mut i64) -> Result<Outcome> {
            if self.steps == 3 {
                return Err(Error::custom("the episode is over"));
            }
            self.steps += 1;
            *observation = self.steps.into();
            let terminated = self.steps == 3;
            Ok(Outcome {
                terminated,
                ..Outcome::default()
            })
        }
    }

    #[test]
    fn a_measured_environment_is_reset_after_each_end() {
        let env = Three::default();
        let resets = env.resets.clone();
        let mut work = scalar(env).unwrap();
        // more steps than there are actions
        assert_eq!(work(3000).unwrap(), 3000);
        let resets = resets.load(std::sync::atomic::Ordering::Relaxed);
        assert_eq!(resets, 1 + 1000);
    }

    #[test]
    fn each_kind_takes_the_steps_that_it_says() {
        for (kind, num_envs, taken) in [
            (Kind::Make, 1, 100),
            (Kind::Frames, 1, 100),
            (Kind::Sync, 7, 105),
            (Kind::Async, 7, 105),
            (Kind::Native, 7, 105),
        ] {
            let mut work = work("CartPole-v1", kind, num_envs).unwrap().unwrap();
            assert_eq!(work(100).unwrap(), taken, "{kind}");
        }
        assert!(work("CarRacing-v3", Kind::Native, 2).unwrap().is_none());
    }

    #[test]
    fn steps_are_counted_per_second() {
        // a step takes at least two milliseconds, and each call takes a tenth more steps than asked
        let work = |steps: u64| {
            std::thread::sleep(Duration::from_millis(2 * steps));
            Ok(steps + steps / 10)
        };
        let speed = measure(Box::new(work), 0.4).unwrap();
        assert!((20.0..=550.0).contains(&speed), "{speed}");
    }
}
