//! Recordings other than traces: Atari 2600 games frame by frame, and MuJoCo's engine.

use std::path::Path;

use gym::atari::games::by_md5;
use gym::atari::recording::Recording;
use gym::atari::rom;
use gym::mujoco::recording;
use gym::{Error, Result};
use serde_json::{Map, Value as Json};

/// Compares a recording of a game with its replay. Returns `None` if `text` is another recording.
pub(crate) fn compare(text: &str) -> Option<Result<String>> {
    game(text).map(|recorded| {
        if recorded.ops.is_empty() {
            return Err(Error::custom(
                "it has no frames, so there is nothing to compare",
            ));
        }
        match recorded.first_difference(&replay(&recorded)?) {
            Some(difference) => Err(Error::custom(difference)),
            None => Ok(format!("{} frames, equal", recorded.ops.len())),
        }
    })
}

/// Returns the answer, in JSON, to the recording `text`, whose top-level entries are `parts`. The
/// files that the recording names are in the folder of `path`. Returns `None` for a trace.
pub(crate) fn answer(
    text: &str,
    parts: &Map<String, Json>,
    path: &Path,
) -> Result<Option<Vec<u8>>> {
    let json = |answer: serde_json::Result<Vec<u8>>| {
        answer
            .map(Some)
            .map_err(|error| Error::custom(error.to_string()))
    };
    if let Some(recorded) = game(text) {
        return json(serde_json::to_vec(&replay(&recorded)?));
    }
    if !recording::is_of_engine(parts) {
        return Ok(None);
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let answer =
        recording::answer(parts, folder).map_err(|error| Error::custom(error.to_string()))?;
    json(serde_json::to_vec(&answer))
}

/// Parses the recording of a game; `None` if `text` is another recording.
fn game(text: &str) -> Option<Recording> {
    serde_json::from_str(text)
        .ok()
        .filter(|recording: &Recording| recording.kind == "raw")
}

fn replay(recorded: &Recording) -> Result<Recording> {
    let game = by_md5(&recorded.md5)
        .ok_or_else(|| Error::custom(format!("the game `{}` is not supported", recorded.rom)))?;
    recorded.replay(&rom::load(game, None)?)
}
