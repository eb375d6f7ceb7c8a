//! `cargo xtask replay TRACE...`

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::families;
use crate::output::{say, tell};
use gym::render::file;
use gym::trace::Trace;
use gym::{Error, Result, unique};
use serde_json::{Map, Value as Json};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Trace files.
    #[arg(required = true)]
    traces: Vec<PathBuf>,
    /// Writes the environments' answers to files of the same names in this folder, instead of
    /// comparing.
    #[arg(long)]
    out: Option<PathBuf>,
}

pub(crate) fn replay(arguments: &Arguments) -> Result<()> {
    let mut written = BTreeMap::new();
    if let Some(out) = &arguments.out {
        if out.exists() && !out.is_dir() {
            let reason = format!("`{}` is not a folder: choose another name", out.display());
            return Err(Error::argument("--out", reason));
        }
        written = destinations(&arguments.traces, out)?;
    }
    let mut failed = 0;
    for path in &arguments.traces {
        let outcome = match written.get(path) {
            Some(to) => write_answers(path, to).map(|()| None),
            None => compare(path).map(Some),
        };
        match outcome {
            Ok(None) => {}
            Ok(Some(equal)) => say(format_args!("{}: {equal}", path.display()))?,
            Err(error) => {
                match error {
                    Error::Io { .. } => tell(format_args!("{error}")), // the error names the file
                    error => tell(format_args!("{}: {error}", path.display())),
                }
                failed += 1;
            }
        }
    }
    match failed {
        0 => Ok(()),
        _ => Err(Error::custom(format!(
            "{failed} of {} traces failed",
            arguments.traces.len()
        ))),
    }
}

/// Returns the path of the answer to each recording: a file of the same name in `out`.
///
/// # Errors
/// If two recordings have the same file name, or an answer would replace a recording.
fn destinations(traces: &[PathBuf], out: &Path) -> Result<BTreeMap<PathBuf, PathBuf>> {
    let refuse = |reason: String| Err(Error::argument("--out", reason));
    let recordings: BTreeSet<PathBuf> = traces
        .iter()
        .filter_map(|path| path.canonicalize().ok())
        .collect();
    let mut taken = BTreeMap::new();
    for path in traces {
        let name = path.file_name().ok_or_else(|| {
            Error::custom(format!("`{}` is no trace: name a file", path.display()))
        })?;
        let to = out.join(name);
        if to.canonicalize().is_ok_and(|to| recordings.contains(&to)) {
            return refuse(format!(
                "`{}` is a recording to replay: choose another folder",
                to.display()
            ));
        }
        if let Some(other) = taken.insert(to.clone(), path)
            && other != path
        {
            let [to, path, other] = [&to, path, other].map(|path| path.display());
            return refuse(format!(
                "`{other}` and `{path}` would both be written to `{to}`: replay one at a time"
            ));
        }
    }
    Ok(taken
        .into_iter()
        .map(|(to, path)| (path.clone(), to))
        .collect())
}

fn read(path: &Path) -> Result<String> {
    /// The largest size of a recording, in bytes.
    const LIMIT: usize = 256 << 20; // bytes
    let mut text = gym::file::read_text(path, LIMIT).map_err(|error| match error.kind() {
        ErrorKind::InvalidData => Error::custom("not a recording: it is not text in UTF-8"),
        ErrorKind::FileTooLarge => Error::custom(format!(
            "it is larger than a recording can be, which is {} MiB",
            LIMIT >> 20
        )),
        _ => Error::io(path, error),
    })?;
    // some editors begin a file with a byte order mark
    if text.starts_with('\u{feff}') {
        text.remove(0);
    }
    Ok(text)
}

fn parse(text: &str) -> Result<Trace> {
    serde_json::from_str(text).map_err(|error| Error::custom(format!("not a trace: {error}")))
}

/// Compares a recording with its replay. Returns a text that names the equal parts and the parts
/// that are not compared.
fn compare(path: &Path) -> Result<String> {
    let text = read(path)?;
    if let Some(compared) = families::compare(&text) {
        return compared;
    }
    let recorded = parse(&text)?;
    let (parts, facts) = recorded.compared();
    if parts.is_empty() {
        return Err(Error::custom(
            "no event has an answer, so there is nothing to compare",
        ));
    }
    if let Some(difference) = recorded.first_difference(&recorded.replay()?) {
        return Err(Error::custom(difference));
    }
    let (events, names) = (recorded.events.len(), [parts, facts].concat().join(", "));
    Ok(match &recorded.not_compared()[..] {
        [] => format!("{events} events ({names}), equal"),
        notes => format!(
            "{events} events ({names}), equal; not compared: {}",
            notes.join(", ")
        ),
    })
}

/// Writes the recording `path` with new answers to `to`, whose folder is made if there is none. The
/// other entries of the file, such as the policy, stay.
fn write_answers(path: &Path, to: &Path) -> Result<()> {
    let text = read(path)?;
    let not_json = |error: serde_json::Error| Error::custom(format!("not a recording: {error}"));
    let mut rest = unique::from_str(&text)
        .and_then(unique::object)
        .map_err(not_json)?;
    let json = match families::answer(&text, &rest, path)? {
        Some(answer) => Ok(answer),
        None => {
            let answers = parse(&text)?.replay()?;
            rest.remove("events");
            let (_, facts) = answers.compared();
            for name in facts {
                rest.extend(
                    answers
                        .about
                        .get_key_value(name)
                        .map(|(name, fact)| (name.clone(), fact.clone())),
                );
            }
            serde_json::to_vec(&Answers {
                rest,
                events: &answers.events,
            })
        }
    };
    let json = json.map_err(not_json)?;
    if let Some(folder) = to.parent() {
        fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
    }
    file::write(to, &json)
}

/// The events of a trace, and the other entries of its file.
#[derive(serde::Serialize)]
struct Answers<'a> {
    #[serde(flatten)]
    rest: Map<String, Json>,
    events: &'a [gym::trace::Event],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_not_text_is_named_and_a_byte_order_mark_is_not_part_of_it() {
        let path = std::env::temp_dir().join(format!("gym-cli-bom-{}.json", std::process::id()));
        fs::write(&path, "\u{feff}{}").unwrap();
        assert_eq!(read(&path).unwrap(), "{}");
        fs::write(&path, [0xff, 0xfe, b'{', 0]).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("not text in UTF-8"), "{error}");
        // a file cannot be the folder for answers
        let arguments = Arguments {
            traces: vec![path.clone()],
            out: Some(path.clone()),
        };
        let error = replay(&arguments).unwrap_err().to_string();
        assert!(error.contains("is not a folder"), "{error}");
        fs::remove_file(&path).unwrap();
    }

    /// A pipe would wait for a writer.
    #[cfg(unix)]
    #[test]
    fn a_recording_is_a_regular_file() {
        let path = std::env::temp_dir().join(format!("gym-cli-pipe-{}", std::process::id()));
        let made = std::process::Command::new("mkfifo").arg(&path).status();
        assert!(made.unwrap().success());
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("not a regular file"), "{error}");
        fs::remove_file(&path).unwrap();
    }

    /// The same recording may be given twice. Two recordings may not have the same file name.
    #[test]
    fn each_recording_has_a_file_of_its_own() {
        let to = |paths: &[&str]| {
            let paths: Vec<PathBuf> = paths.iter().map(PathBuf::from).collect();
            destinations(&paths, Path::new("/nonexistent/out"))
        };
        let path = |name: &str| Path::new("/nonexistent").join(name);
        let pair = |name: &str| (path(name), path("out").join(name));
        let [one, other] = ["/nonexistent/a.json", "/nonexistent/b.json"];
        let expected = BTreeMap::from([pair("a.json"), pair("b.json")]);
        assert_eq!(to(&[one, other]).unwrap(), expected);
        assert_eq!(to(&[one, other, one]).unwrap(), expected);
        for same in [[one, "x/a.json"], ["a.json", "./x/a.json"]] {
            let error = to(&same).unwrap_err().to_string();
            assert!(error.contains("would both be written to"), "{error}");
        }
        assert!(to(&["/"]).unwrap_err().to_string().contains("name a file"));
        // an answer never replaces a recording, even if the path is written in another way
        let own = Path::new(file!()).file_name().unwrap();
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
        let recording = manifest.join("src").join(own);
        let error = destinations(&[recording], &manifest.join("src/docs/.."));
        let error = error.unwrap_err().to_string();
        assert!(error.contains("is a recording to replay"), "{error}");
    }
}
