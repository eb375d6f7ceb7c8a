//! `cargo xtask replay TRACE...`

use std::path::{Path, PathBuf};

use gym::rendering::file;
use gym::trace::Trace;
use gym::{BoxEnv, Error, Result};
use serde_json::{Map, Value as Json};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Trace files.
    #[arg(required = true)]
    traces: Vec<PathBuf>,
    /// Writes what the environments answer to files of the same names in this folder, instead of
    /// comparing.
    #[arg(long)]
    out: Option<PathBuf>,
}

pub(crate) fn replay(arguments: &Arguments) -> Result<()> {
    if let Some(out) = &arguments.out {
        std::fs::create_dir_all(out).map_err(|error| Error::io(out, error))?;
    }
    let mut failed = 0;
    for path in &arguments.traces {
        let outcome = match &arguments.out {
            Some(out) => write_answers(path, out),
            None => compare(path),
        };
        if let Err(error) = outcome {
            eprintln!("{}: {error}", path.display());
            failed += 1;
        }
    }
    match failed {
        0 => Ok(()),
        _ => Err(Error::custom(format!("{failed} of {} traces failed", arguments.traces.len()))),
    }
}

/// What a trace pins down beside the observation: of CarRacing the bodies, of the MuJoCo tasks positions and velocities.
#[cfg(feature = "families")]
fn state(env: &BoxEnv) -> Option<Json> {
    use gym::EnvExt;

    if let Some(data) = gym::mujoco::simulated(env).and_then(|env| env.data()) {
        return Some(serde_json::json!({"qpos": data.qpos, "qvel": data.qvel}));
    }
    env.unwrapped::<gym::box2d::CarRacing>().and_then(|car| serde_json::to_value(car.state()).ok())
}

#[cfg(not(feature = "families"))]
fn state(_: &BoxEnv) -> Option<Json> {
    None
}

fn read(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).map_err(|error| Error::io(path, error))
}

fn parse(text: &str) -> Result<Trace> {
    serde_json::from_str(text).map_err(|error| Error::custom(format!("not a trace: {error}")))
}

fn compare(path: &Path) -> Result<()> {
    let text = read(path)?;
    #[cfg(feature = "families")]
    if let Some(recorded) = frames::parse(&text) {
        return frames::compare(path, &recorded);
    }
    let recorded = parse(&text)?;
    match recorded.first_difference(&recorded.replay(state)?) {
        Some(difference) => Err(Error::custom(difference)),
        None => {
            println!("{}: {} events, equal", path.display(), recorded.events.len());
            Ok(())
        }
    }
}

/// Keeps the other parts of the file, such as its policy, and replaces the answers.
fn write_answers(path: &Path, out: &Path) -> Result<()> {
    let text = read(path)?;
    let not_json = |error: serde_json::Error| Error::custom(format!("not a recording: {error}"));
    let mut rest: Map<String, Json> = serde_json::from_str(&text).map_err(not_json)?;
    let name = path.file_name().ok_or_else(|| Error::custom("the path has no file name"))?;
    #[cfg(feature = "families")]
    if let Some(recorded) = frames::parse(&text) {
        let answers = frames::replay(&recorded)?;
        let json = serde_json::to_vec(&answers).map_err(|error| Error::custom(error.to_string()))?;
        return file::write(out.join(name), &json);
    }
    let json = match of_engine(&rest, path)? {
        Some(answer) => serde_json::to_vec(&answer),
        None => {
            let answers = parse(&text)?.replay(state)?;
            rest.remove("events");
            serde_json::to_vec(&File { rest, events: &answers.events })
        }
    };
    file::write(out.join(name), &json.map_err(not_json)?)
}

/// The answer to a recording of the MuJoCo engine alone: steps, forward calls, figures of a model.
#[cfg(feature = "families")]
fn of_engine(file: &Map<String, Json>, path: &Path) -> Result<Option<Map<String, Json>>> {
    use gym::mujoco::recording;

    if !recording::is_of_engine(file) {
        return Ok(None);
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    recording::answer(file, folder).map(Some).map_err(|error| Error::custom(error.to_string()))
}

#[cfg(not(feature = "families"))]
fn of_engine(_: &Map<String, Json>, _: &Path) -> Result<Option<Map<String, Json>>> {
    Ok(None)
}

/// A trace and the other parts of its file.
#[derive(serde::Serialize)]
struct File<'a> {
    #[serde(flatten)]
    rest: Map<String, Json>,
    events: &'a [gym::trace::Event],
}

/// Recordings of games of the Atari 2600, frame by frame.
#[cfg(feature = "families")]
mod frames {
    use std::path::Path;

    use gym::atari::games::by_md5;
    use gym::atari::recording::Recording;
    use gym::atari::rom;
    use gym::{Error, Result};

    /// A recording, if the text is one.
    pub(super) fn parse(text: &str) -> Option<Recording> {
        serde_json::from_str(text).ok().filter(|recording: &Recording| recording.kind == "raw")
    }

    pub(super) fn replay(recorded: &Recording) -> Result<Recording> {
        let game = by_md5(&recorded.md5)
            .ok_or_else(|| Error::custom(format!("the game `{}` is not supported", recorded.rom)))?;
        recorded.replay(&rom::load(game, None)?)
    }

    pub(super) fn compare(path: &Path, recorded: &Recording) -> Result<()> {
        match recorded.first_difference(&replay(recorded)?) {
            Some(difference) => Err(Error::custom(difference)),
            None => {
                println!("{}: {} frames, equal", path.display(), recorded.ops.len());
                Ok(())
            }
        }
    }
}
