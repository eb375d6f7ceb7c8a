//! `cargo xtask demo`: the main job over every linked environment.

use std::iter;
use std::panic::resume_unwind;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::thread;

use gym::registry::EnvId;
use gym::render::{Recorder, RenderMode};
use gym::{EnvSpec, Error, Registration, Result};
use indicatif::{ProgressBar, ProgressStyle};

use crate::inputs;
use crate::output::say;
use crate::plots;
use crate::policy::{Episode, Policy};
use crate::run::summary;
use crate::workspace::Workspace;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Episodes of each environment.
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..))]
    episodes: u64,
    /// The folder for the files.
    #[arg(long, default_value = "target/demo")]
    out: PathBuf,
    /// The largest number of frames in a GIF.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..))]
    max_frames: u64,
    /// All versions of each task instead of the newest, and those on rapier2d.
    #[arg(long)]
    all: bool,
}

/// The largest number of steps in an episode of an environment without a time limit.
const STEP_LIMIT: u32 = 10_000;

pub(crate) fn demo(arguments: &Arguments, workspace: &Workspace) -> Result<()> {
    std::fs::create_dir_all(&arguments.out).map_err(|error| Error::io(&arguments.out, error))?;
    let mut registrations = workspace.select(&[])?;
    if !arguments.all {
        registrations = newest(registrations);
    }
    let bar = ProgressBar::new(registrations.len() as u64 * arguments.episodes).with_style(
        ProgressStyle::with_template("{bar:40} {pos}/{len} episodes  {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    );
    let workers = thread::available_parallelism().map_or(1, usize::from);
    // a free thread takes the next one: some take a hundred times as long as others
    let waiting = Mutex::new(registrations.iter().enumerate());
    let work = || {
        let next = || {
            waiting
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .next()
        };
        iter::from_fn(next)
            .map(|(i, registration)| {
                let row = show(registration.spec()?, arguments, &bar)?;
                bar.suspend(|| {
                    say(format_args!(
                        "{}",
                        gif_path(registration.id(), arguments).display()
                    ))
                })?;
                Ok((i, row))
            })
            .collect::<Result<Vec<_>>>()
    };
    let rows = thread::scope(|scope| {
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        handles
            .into_iter()
            .map(|handle| handle.join().unwrap_or_else(|panic| resume_unwind(panic)))
            .collect::<Result<Vec<_>>>()
    })?;
    let mut rows: Vec<_> = rows.into_iter().flatten().collect();
    rows.sort_unstable();
    bar.finish_and_clear();
    say(format_args!(
        "Random policy, {} episodes each: mean [min, max]",
        arguments.episodes
    ))?;
    for (_, row) in rows {
        say(format_args!("{row}"))?;
    }
    say(format_args!(
        "\nOne GIF for each, and its returns and lengths as SVG and PNG: {}",
        arguments.out.display()
    ))?;
    Ok(())
}

/// The newest version of each task, on its own engine.
fn newest(registrations: Vec<Registration>) -> Vec<Registration> {
    let ids: Vec<EnvId> = registrations
        .iter()
        .filter_map(|registration| registration.id().parse().ok())
        .collect();
    let is_newest = |registration: &Registration| {
        registration.id().parse::<EnvId>().is_ok_and(|id| {
            id.namespace.as_deref() != Some("rapier")
                && !ids.iter().any(|other| other.same_name(&id) && *other > id)
        })
    };
    registrations.into_iter().filter(is_newest).collect()
}

/// The path of an environment's recording.
fn gif_path(id: &str, arguments: &Arguments) -> PathBuf {
    arguments.out.join(format!("{}.gif", inputs::file_stem(id)))
}

/// Plays one environment, writes its files, and returns its row of the table.
fn show(spec: EnvSpec, arguments: &Arguments, bar: &ProgressBar) -> Result<String> {
    let id = spec.id.clone();
    bar.set_message(id.clone());
    let episodes = play(spec, arguments, bar)?;
    let row = format!("{id:28} {}", summary(&episodes));
    let runs = [("random policy".to_owned(), episodes)];
    for extension in ["svg", "png"] {
        let path = arguments
            .out
            .join(format!("{}.{extension}", inputs::file_stem(&id)));
        plots::write(&path, &id, &runs)?;
    }
    Ok(row)
}

/// Plays the episodes of one environment and records the first ones.
fn play(spec: EnvSpec, arguments: &Arguments, bar: &ProgressBar) -> Result<Vec<Episode>> {
    let path = gif_path(&spec.id, arguments);
    let max_episode_steps = spec.max_episode_steps.or(Some(STEP_LIMIT));
    let mut env = EnvSpec {
        max_episode_steps,
        render_mode: Some(RenderMode::RgbArray),
        ..spec
    }
    .make()?;
    let mut recorder = Recorder::new(&path, &env)?.max_frames(arguments.max_frames);
    let episodes = (0..arguments.episodes)
        .map(|seed| {
            bar.inc(1);
            Policy::Random.play(&mut env, seed, |env| recorder.capture(env))
        })
        .collect::<Result<_>>()?;
    recorder.finish()?;
    Ok(episodes)
}
