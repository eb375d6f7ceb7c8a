//! Commands that are built for what they do: with the checks, or around a plugin.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value as Json;

/// The variable with the level of optimisation of the profile `dev`.
const OPT_LEVEL: &str = "CARGO_PROFILE_DEV_OPT_LEVEL";

/// The program, which builds commands as tests are built.
fn program() -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_xtask"));
    program.env("XTASK_PROFILE", "dev");
    program
}

/// The program with a plugin: all is built for it anew, in less time than tests are.
fn program_of(plugin: &str) -> Command {
    let mut program = program();
    program.args(["--plugin", plugin]).env(OPT_LEVEL, "0");
    program
}

fn xtask(arguments: &[&str]) -> Output {
    program()
        .args(arguments)
        .output()
        .expect("the command starts")
}

/// The output of a command, which must succeed.
fn prints(arguments: &[&str]) -> String {
    said(xtask(arguments), arguments)
}

fn said(output: Output, arguments: &[&str]) -> String {
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).expect("text")
}

/// The error of a command that fails.
fn fails(arguments: &[&str]) -> String {
    let output = xtask(arguments);
    assert!(!output.status.success(), "{arguments:?} succeeds");
    String::from_utf8(output.stderr).expect("text")
}

/// An empty folder of a test's own.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

#[test]
fn conform_passes() {
    let text = prints(&["conform", "CartPole-v1", "Taxi-v4"]);
    assert!(
        text.contains("2 environments") && text.contains("0 broken"),
        "{text}"
    );
    let reports: Json =
        serde_json::from_str(&prints(&["conform", "Taxi-v4", "--format", "json"])).expect("JSON");
    assert_eq!(
        (&reports[0]["id"], &reports[0]["findings"]),
        (&"Taxi-v4".into(), &Json::Array(vec![]))
    );
    let skipped = reports[0]["skipped"].as_array().expect("a list");
    let skipped: Vec<_> = skipped.iter().map(|check| &check["check"]).collect();
    assert_eq!(
        skipped,
        ["options-accepted", "options-matter"],
        "pictures are drawn and allocations counted"
    );
    assert!(
        prints(&["conform", "Taxi-v4", "--format", "junit"])
            .contains("<testsuite name=\"Taxi-v4\"")
    );
    assert!(fails(&["conform", "Taxy-v4"]).contains("did you mean `Taxi-v4`?"));
    assert!(fails(&["conform", "--plugin", "/nonexistent"]).contains("/nonexistent/Cargo.toml"));
    assert!(fails(&["conform", "--format", "xml"]).contains("text, json and junit"));
}

/// A crate that xtask does not link is built with a program around it.
#[test]
fn conform_flags_a_plugin() {
    let broken = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/plugins/broken");
    let broken = broken.to_str().unwrap();
    let output = program_of(broken)
        .args([
            "conform",
            "--format",
            "json",
            "broken/reward-finite-v0",
            "broken/none-v0",
        ])
        .output()
        .expect("the command starts");
    assert_eq!(
        output.status.code(),
        Some(1),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let reports: Json = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(reports[0]["findings"][0]["check"], "reward-finite");
    assert_eq!(reports[1]["findings"], Json::Array(vec![]));
    assert_eq!(
        reports[1]["skipped"],
        Json::Array(vec![]),
        "pictures are drawn and allocations counted"
    );
}

/// From nothing to a crate that conforms and draws.
#[test]
fn new_makes_a_plugin_that_works() {
    let folder = folder("new").join("my_envs");
    let path = folder.to_str().unwrap();
    prints(&["new", "my_envs", "--path", path]);
    let cargo = |arguments: &[&str]| {
        let target = PathBuf::from(env!("CARGO_BIN_EXE_xtask"));
        let target = target
            .ancestors()
            .nth(2)
            .expect("the binary lies in target/debug");
        let mut command = Command::new(env!("CARGO"));
        command
            .args(arguments)
            .current_dir(&folder)
            .env("CARGO_TARGET_DIR", target)
            .env(OPT_LEVEL, "0");
        let output = command.output().unwrap();
        let [stdout, stderr] =
            [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
        assert!(output.status.success(), "{arguments:?}: {stdout}\n{stderr}");
        stdout
    };
    let tests = cargo(&["test", "--offline", "--tests"]);
    assert!(
        tests.contains("every_environment_conforms ... ok") && tests.contains("0 ignored"),
        "{tests}"
    );
    cargo(&["run", "--offline", "--example", "gif"]);
    let gif = std::fs::read(folder.join("episode.gif")).expect("a GIF");
    assert!(gif.starts_with(b"GIF89a") && gif.len() > 500);
}

/// Every command works over the environments of a crate that this workspace does not know.
#[test]
fn commands_serve_a_plugin() {
    let good = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/plugins/good");
    let good = good.to_str().unwrap();
    let id = "sutton/WindyGridworld-v0";
    let of_plugin = |arguments: &[&str]| {
        said(
            program_of(good).args(arguments).output().unwrap(),
            arguments,
        )
    };
    assert!(of_plugin(&["conform"]).contains("0 broken"));
    let list = of_plugin(&["list"]);
    assert!(list.contains(id) && !list.contains("CartPole"), "{list}");
    let out = folder("plugin");
    let gif = out.join("episode.gif");
    of_plugin(&[
        "gif",
        id,
        "--max-frames",
        "5",
        "--out",
        gif.to_str().unwrap(),
    ]);
    assert!(std::fs::read(&gif).expect("a GIF").starts_with(b"GIF89a"));
    assert!(of_plugin(&["run", id, "--seeds", "0..2"]).contains("return"));
    let good_policy = of_plugin(&["run", id, "--policy", "good", "--seeds", "0..1"]);
    assert!(
        good_policy.contains("-15.0"),
        "the least number of steps: {good_policy}"
    );
    assert!(of_plugin(&["soak", "--steps", "20000"]).contains("20000 steps of"));
    let bench = of_plugin(&["bench", "--seconds", "0.01", "--kind", "make"]);
    assert!(bench.contains(id) && !bench.contains("CartPole"), "{bench}");

    // the keys of its registration, played from the terminal
    let mut play = program_of(good)
        .args(["play", id, "--terminal", "--episodes", "1"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the command starts");
    play.stdin
        .take()
        .expect("a pipe")
        .write_all(b"Right\nq\n")
        .expect("it reads");
    let played = play.wait_with_output().expect("it ends");
    let text = String::from_utf8_lossy(&played.stdout);
    assert!(
        text.contains("Up = 0, Down = 1") || text.contains("Right = 2"),
        "{text}"
    );
    // a page of its own, in a copy of the crate
    let copy = out.join("sutton");
    copy_crate(Path::new(good), &copy);
    said(
        program_of(copy.to_str().unwrap())
            .args(["docs", "--measure"])
            .output()
            .unwrap(),
        &["docs"],
    );
    let page =
        std::fs::read_to_string(copy.join("docs/environments/windy-gridworld.md")).expect("a page");
    for part in [
        "# Windy gridworld",
        "| `king` | boolean | `false` |",
        "-15.00",
        "goes around the wind",
    ] {
        assert!(page.contains(part), "{part}: {page}");
    }
}

/// Copies a crate, whose dependencies on folders stay where they are.
fn copy_crate(from: &Path, to: &Path) {
    std::fs::create_dir_all(to.join("src")).expect("a folder");
    for file in ["src/lib.rs", "src/windy_gridworld.rs"] {
        std::fs::copy(from.join(file), to.join(file)).expect("a copy");
    }
    let crates = from
        .join("../../../crates")
        .canonicalize()
        .expect("the crates");
    let manifest = std::fs::read_to_string(from.join("Cargo.toml")).expect("a manifest");
    let manifest = manifest.replace("../../../crates", crates.to_str().expect("a path in UTF-8"));
    std::fs::write(to.join("Cargo.toml"), manifest).expect("a manifest");
}
