//! Tests of the commands as a user runs them.

mod bench;
mod commands;
mod documents;
mod files;
#[cfg(unix)]
mod launcher;
mod lines;
mod pictures;
mod play;
mod plugin;
mod replay;
mod run;
mod transcripts;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value as Json;

/// Returns the program `commands`.
fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_commands"))
}

fn xtask(arguments: &[&str]) -> Output {
    program()
        .args(arguments)
        .output()
        .expect("the command starts")
}

/// Returns the output of a command, which must succeed.
fn prints(arguments: &[&str]) -> String {
    said(&xtask(arguments), arguments)
}

/// Returns the standard output in `output`. Panics if the command failed.
fn said(output: &Output, arguments: &[&str]) -> String {
    let [stdout, stderr] =
        [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    assert!(output.status.success(), "{arguments:?}: {stdout}\n{stderr}");
    stdout
}

/// Returns the error output of a command, which must fail.
fn fails(arguments: &[&str]) -> String {
    let output = xtask(arguments);
    assert!(!output.status.success(), "{arguments:?} succeeds");
    String::from_utf8(output.stderr).expect("text")
}

/// Makes an empty folder for one test.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn first_word(line: &str) -> &str {
    line.split_whitespace().next().unwrap_or_default()
}

fn json(path: &Path) -> Json {
    serde_json::from_slice(&std::fs::read(path).expect("the file")).expect("JSON")
}
