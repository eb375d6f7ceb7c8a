//! Tests of the commands in a plugin: a crate outside of this workspace with its own environments.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde_json::Value as Json;

use super::{folder, prints, said};

/// A plugin of a third party.
const GOOD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/plugins/good");

/// Lets only one test run at a time, because the programs of all plugins have the same name in one
/// target folder.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the command `cargo ARGUMENTS` in `folder`, with the settings that compile fastest,
/// because the plugin builds all crates again: `--release` for the alias `xtask`, and `dev` for
/// what the command `conform` builds. Both have the checks of debug builds.
fn cargo(folder: &Path, arguments: &[&str]) -> Command {
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args(arguments)
        .current_dir(folder)
        .env("CARGO_NET_OFFLINE", "true")
        .env(
            "CARGO_TARGET_DIR",
            Path::new(env!("CARGO_TARGET_TMPDIR")).join("plugins"),
        );
    for (setting, value) in [
        ("RELEASE_OPT_LEVEL", "0"),
        ("RELEASE_CODEGEN_UNITS", "16"),
        ("RELEASE_DEBUG_ASSERTIONS", "true"),
        ("RELEASE_OVERFLOW_CHECKS", "true"),
        ("DEV_OPT_LEVEL", "0"),
        ("DEV_CODEGEN_UNITS", "16"),
    ] {
        cargo.env(format!("CARGO_PROFILE_{setting}"), value);
    }
    cargo
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    cargo(folder, arguments).output().expect("cargo starts")
}

/// Returns the output of `cargo xtask` in `folder`, which must succeed.
fn xtask(folder: &Path, arguments: &[&str]) -> String {
    said(&run(folder, &[&["xtask"], arguments].concat()), arguments)
}

/// `new` makes a crate that conforms and draws. The checks find a fault that the test adds.
#[test]
#[ignore = "builds every crate again: run with `--ignored plugin::`"]
fn new_makes_a_plugin_that_works() {
    let _alone = alone();
    let folder = folder("new").join("my_envs");
    prints(&["new", "my_envs", "--path", folder.to_str().unwrap()]);
    let tests = said(&run(&folder, &["test", "--release", "--tests"]), &["test"]);
    assert!(
        tests.contains("every_environment_conforms ... ok") && tests.contains("0 ignored"),
        "{tests}"
    );
    said(
        &run(&folder, &["run", "--release", "--example", "gif"]),
        &["run"],
    );
    let gif = fs::read(folder.join("episode.gif")).expect("a GIF");
    assert!(gif.starts_with(b"GIF89a") && gif.len() > 500);
    assert!(xtask(&folder, &["list"]).contains("my_envs/Corridor-v0"));

    let text = xtask(&folder, &["conform"]);
    assert!(
        text.contains("1 environments") && text.contains("0 broken"),
        "{text}"
    );
    let source = folder.join("src/corridor.rs");
    let text = fs::read_to_string(&source).expect("the environment");
    fs::write(&source, text.replace("reward: -1.0", "reward: f64::NAN")).unwrap();
    let output = run(&folder, &["xtask", "conform", "--format", "json"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    let reports: Json = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(reports[0]["findings"][0]["check"], "reward-finite");
}

#[test]
#[ignore = "builds every crate again: run with `--ignored plugin::`"]
fn new_makes_a_native_vector_that_works() {
    let _alone = alone();
    let folder = folder("new-native").join("rockets");
    let path = folder.to_str().unwrap();
    prints(&["new", "rockets", "--native", "--path", path]);
    let tests = said(&run(&folder, &["test", "--release", "--lib"]), &["test"]);
    assert!(
        tests.contains("native_vectors_equal_single_environments ... ok"),
        "{tests}"
    );
    let text = xtask(&folder, &["list", "--long"]);
    assert!(
        text.contains("rockets/Rocket-v0") && text.contains("limit   500"),
        "{text}"
    );
}

/// Every command works for the environments of a plugin.
#[test]
#[ignore = "builds every crate again: run with `--ignored plugin::`"]
fn commands_serve_a_plugin() {
    let _alone = alone();
    let good = Path::new(GOOD);
    let id = "sutton/WindyGridworld-v0";
    let list = xtask(good, &["list"]);
    assert!(list.contains(id) && !list.contains("CartPole"), "{list}");
    let out = folder("plugin");
    let gif = out.join("episode.gif");
    let path = gif.to_str().unwrap();
    xtask(good, &["gif", id, "--max-frames", "5", "--out", path]);
    assert!(fs::read(&gif).expect("a GIF").starts_with(b"GIF89a"));
    assert!(xtask(good, &["run", id, "--seeds", "0..2"]).contains("return"));
    let policy = xtask(good, &["run", id, "--policy", "good", "--seeds", "0..1"]);
    assert!(policy.contains("-15.0"), "the least steps: {policy}");
    assert!(xtask(good, &["soak", "--steps", "20000"]).contains("20000 steps of"));
    let bench = xtask(good, &["bench", "--seconds", "0.01", "--kind", "make"]);
    assert!(bench.contains(id) && !bench.contains("CartPole"), "{bench}");

    // play with the keys of the registration
    let mut play = cargo(
        good,
        &["xtask", "play", id, "--terminal", "--episodes", "1"],
    )
    .stdin(Stdio::piped())
    .stdout(Stdio::piped())
    .spawn()
    .expect("the command starts");
    let mut keys = play.stdin.take().expect("a pipe");
    keys.write_all(b"Right\nq\n").expect("it reads");
    let played = play.wait_with_output().expect("it ends");
    let text = String::from_utf8_lossy(&played.stdout);
    assert!(
        text.contains("Up = 0, Down = 1") || text.contains("Right = 2"),
        "{text}"
    );
}

/// `conform` has a separate build, with drawing and the allocator that counts.
#[test]
#[ignore = "builds every crate again: run with `--ignored plugin::`"]
fn conform_serves_a_plugin() {
    let _alone = alone();
    let good = Path::new(GOOD);
    let id = "sutton/WindyGridworld-v0";
    assert!(xtask(good, &["conform"]).contains("0 broken"));
    let text = xtask(good, &["conform", id, "--format", "json"]);
    let reports: Json = serde_json::from_str(&text).expect("JSON");
    assert_eq!(
        (&reports[0]["id"], &reports[0]["findings"]),
        (&id.into(), &Json::Array(vec![]))
    );
    let skipped = reports[0]["skipped"].as_array().expect("a list");
    let skipped: Vec<_> = skipped.iter().map(|check| &check["check"]).collect();
    assert_eq!(
        skipped,
        [
            "options-accepted",
            "options-in-space",
            "other-seed-other-episode",
            "reset-carries-on",
            "generator-lent",
            "options-matter",
        ],
        "without chance and options; pictures are drawn and allocations counted"
    );
    let junit = xtask(good, &["conform", id, "--format", "junit"]);
    assert!(
        junit.contains(&format!("<testsuite name=\"{id}\"")),
        "{junit}"
    );
    for (arguments, message) in [
        (["conform", "sutton/WindyGridwurld-v0"], "did you mean"),
        (["conform", "--format=xml"], "text, json and junit"),
    ] {
        let output = run(good, &[&["xtask"], &arguments[..]].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains(message), "{said}");
    }
}

/// `docs` and `python` write pages and a Python package for a plugin.
#[test]
#[ignore = "builds every crate again: run with `--ignored plugin::`"]
fn a_plugin_has_pages_and_a_python_package() {
    let _alone = alone();
    let copy = folder("plugin-copy").join("sutton");
    copy_crate(Path::new(GOOD), &copy);
    xtask(&copy, &["docs", "--measure"]);
    let page = copy.join("docs/environments/windy-gridworld.md");
    let page = fs::read_to_string(page).expect("a page");
    for part in [
        "# Windy gridworld",
        "| `king` | boolean | `false` |",
        "-15.00",
        "goes around the wind",
        "`cargo xtask run sutton/WindyGridworld-v0 --policy good`",
    ] {
        assert!(page.contains(part), "{part}: {page}");
    }
    xtask(&copy, &["docs", "--check"]);

    // without the libraries of gym-python the command fails here
    let output = run(&copy, &["xtask", "python"]);
    let text = |name: &str| fs::read_to_string(copy.join("python").join(name)).expect(name);
    let manifest = text("Cargo.toml");
    for part in [
        "name = \"sutton-envs-python\"",
        "+sutton-envs\"",
        "gym-python = { path = \"",
        "sutton-envs = { path = \"../\" }",
    ] {
        assert!(manifest.contains(part), "{part}: {manifest}");
    }
    assert!(text("src/lib.rs").contains("use sutton_envs as _;"));
    if output.status.success() {
        assert!(text("python/rustgym/__init__.py").contains("gymnasium"));
    }
}

/// Copies a crate. Its dependencies by path still lead to this workspace.
fn copy_crate(from: &Path, to: &Path) {
    let crates = from.join("../../../crates");
    let crates: PathBuf = crates.canonicalize().expect("the crates");
    for file in [
        ".cargo/config.toml",
        "Cargo.lock",
        "Cargo.toml",
        "gallery/Cargo.toml",
        "gallery/src/lib.rs",
        "src/lib.rs",
        "src/windy_gridworld.rs",
        "xtask/Cargo.toml",
        "xtask/src/main.rs",
    ] {
        let path = to.join(file);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        let text = fs::read_to_string(from.join(file)).expect(file);
        let crates = crates.to_str().expect("a path in UTF-8");
        let text = text
            .replace("../../../../crates", crates)
            .replace("../../../crates", crates);
        fs::write(path, text).expect(file);
    }
}
