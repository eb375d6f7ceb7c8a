//! `cargo xtask demo`: the main job over every linked environment.

use std::collections::BTreeMap;
use std::iter;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
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
    #[arg(long, default_value_t = 30, allow_negative_numbers = true, value_parser = inputs::parse_count)]
    episodes: u64,
    /// The folder for the files.
    #[arg(long, default_value = "target/demo")]
    out: PathBuf,
    /// The largest number of frames in a GIF.
    #[arg(long, default_value_t = 200, allow_negative_numbers = true, value_parser = inputs::parse_count)]
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
    let bar = ProgressBar::new((registrations.len() as u64).saturating_mul(arguments.episodes))
        .with_style(
            ProgressStyle::with_template("{bar:40} {pos}/{len} episodes  {msg}")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
    let stems = stems(registrations.iter().map(Registration::id));
    let workers = thread::available_parallelism().map_or(1, usize::from);
    // each thread takes the next environment when it is free, because some environments take a
    // hundred times as long as others
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
                let stem = arguments.out.join(&stems[i]);
                let row = show(registration.spec()?, &stem, arguments, &bar)?;
                let gif = with_extension(&stem, "gif");
                bar.suspend(|| say(format_args!("{}", gif.display())))?;
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

/// Returns the newest version of each task, without the ids in the namespace `rapier`.
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

/// Returns the names of the environments' files, without the extension. If two ids would have the
/// same name, `+` replaces the `/`, because no id contains a `+`.
fn stems<'a>(ids: impl Iterator<Item = &'a str> + Clone) -> Vec<String> {
    let mut counts = BTreeMap::new();
    for id in ids.clone() {
        *counts.entry(inputs::file_stem(id)).or_insert(0) += 1;
    }
    let stem = |id: &str| match inputs::file_stem(id) {
        stem if counts[&stem] > 1 => id.replace('/', "+"),
        stem => stem,
    };
    ids.map(stem).collect()
}

/// Plays one environment, writes its files, and returns its row of the table.
fn show(spec: EnvSpec, stem: &Path, arguments: &Arguments, bar: &ProgressBar) -> Result<String> {
    let id = spec.id.clone();
    bar.set_message(id.clone());
    let episodes = play(spec, stem, arguments, bar)?;
    let row = format!("{id:28} {}", summary(&episodes));
    let runs = [("random policy".to_owned(), episodes)];
    for extension in ["svg", "png"] {
        plots::write(&with_extension(stem, extension), &id, &runs)?;
    }
    Ok(row)
}

/// Returns `stem` with an extension. (`Path::with_extension` would replace the part after the last
/// dot of an id.)
fn with_extension(stem: &Path, extension: &str) -> PathBuf {
    let mut path = stem.as_os_str().to_owned();
    path.push(format!(".{extension}"));
    path.into()
}

/// Plays the episodes of one environment, and records the first `max_frames` frames.
fn play(
    spec: EnvSpec,
    stem: &Path,
    arguments: &Arguments,
    bar: &ProgressBar,
) -> Result<Vec<Episode>> {
    let max_episode_steps = spec.max_episode_steps.or(Some(STEP_LIMIT));
    let mut env = EnvSpec {
        max_episode_steps,
        render_mode: Some(RenderMode::RgbArray),
        ..spec
    }
    .make()?;
    let mut recorder =
        Recorder::new(with_extension(stem, "gif"), &env)?.max_frames(arguments.max_frames);
    let episodes = (0..arguments.episodes)
        .map(|seed| {
            bar.inc(1);
            Policy::Random.play(&mut env, seed, |env| recorder.capture(env))
        })
        .collect::<Result<_>>()?;
    recorder.finish()?;
    Ok(episodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_environments_have_one_file() {
        let of = |ids: &[&str]| stems(ids.iter().copied());
        assert_eq!(
            of(&[
                "a/b-v0", "a_b-v0", "a/b-v1", "c", "c_/d", "c/_d", "x/y.z-v0"
            ]),
            [
                "a+b-v0", "a_b-v0", "a_b-v1", "c", "c_+d", "c+_d", "x_y.z-v0"
            ]
        );
        let path = with_extension(Path::new("demo/x_y.z-v0"), "gif");
        assert_eq!(path, Path::new("demo/x_y.z-v0.gif"));
    }
}
