//! `cargo xtask COMMAND`: builds the program `commands` with the settings that the command needs,
//! and runs the command.
//!
//! One build cannot serve all commands, because this workspace takes long to build, and longer with
//! optimisation or with rapier2d. Therefore this program has few dependencies, and builds
//! `commands` in several ways:
//! - Commands that play are built with optimisation, and commands that measure with the most.
//!   Commands that need no speed are built without, unless the optimised program exists.
//! - The first demo is built in two parts: the GIFs of the small families appear while the other
//!   families are compiled.
//! - `play` is built with windows, and `conform` with a counting allocator. Native vectors are built
//!   only for commands that make vectors, and rapier2d for commands that use its ids.
//! - `web` builds the gallery for the browser, and is part of this program.

#[path = "../../crates/gym-cli/src/collision.rs"]
mod collision;
mod files;
mod web;

use std::env;
use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// The commands that need no speed.
const QUICK: [&str; 5] = ["list", "help", "mjcf", "new", "python"];
/// The commands that measure speed, or play for hours.
const FASTEST: [&str; 2] = ["bench", "soak"];
/// The commands that make native vectors.
const WITH_VECTORS: [&str; 2] = ["bench", "conform"];

fn main() -> ExitCode {
    match run(&env::args_os().skip(1).collect::<Vec<_>>()) {
        Ok(code) => code,
        Err(error) => {
            // `eprintln!` panics if standard error is closed
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[OsString]) -> Result<ExitCode, String> {
    match arguments {
        [web, ..] if web == "web" => web::web(&arguments[1..]).map(|()| ExitCode::SUCCESS),
        // `help web`, as for the other commands
        [help, web] if help == "help" && web == "web" => {
            web::web(&["--help".into()]).map(|()| ExitCode::SUCCESS)
        }
        [help] if ["help", "--help", "-h"].contains(&&*help.to_string_lossy()) => {
            let code = commands(arguments)?;
            say(format_args!(
                "\n`cargo xtask web` builds a page that runs the environments in a browser: `cargo xtask web --help`."
            ))?;
            Ok(code)
        }
        _ => commands(arguments),
    }
}

/// Builds the commands, and runs the requested one.
fn commands(arguments: &[OsString]) -> Result<ExitCode, String> {
    let build = Build::of(arguments);
    if build.is_first_demo {
        say(format_args!(
            "The quick families first: the others are built after their GIFs."
        ))?;
        let quick = Build {
            families: "small",
            ..build
        };
        let code = start(&quick, arguments)?;
        if code != ExitCode::SUCCESS {
            return Ok(code);
        }
    }
    start(&build, arguments)
}

fn start(build: &Build, arguments: &[OsString]) -> Result<ExitCode, String> {
    let mut cargo = Command::new(cargo());
    cargo.args(["run", "--package", "xtask", "--bin", "commands"]);
    cargo
        .args(["--profile", build.profile, "--manifest-path"])
        .arg(root().join("Cargo.toml"));
    let features = [
        Some(build.families),
        build.rapier.then_some("rapier"),
        build.native_vectors.then_some("native-vectors"),
        build.feature,
    ];
    let features: Vec<_> = features.into_iter().flatten().collect();
    cargo.args(["--no-default-features", "--features", &features.join(",")]);
    let status = cargo.arg("--").args(arguments).status();
    let status = status.map_err(|error| format!("cargo cannot be run: {error}"))?;
    // a program that a signal ended has no exit code
    Ok(status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .map_or(ExitCode::FAILURE, ExitCode::from))
}

/// Prints a line. Unlike `println!`, the function does not panic if the output cannot be written,
/// and ignores a closed pipe.
fn say(line: std::fmt::Arguments<'_>) -> Result<(), String> {
    match writeln!(std::io::stdout(), "{line}") {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|error| format!("standard output: {error}")),
    }
}

/// The settings of the build for a command.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Build {
    profile: &'static str,
    feature: Option<&'static str>,
    /// The feature that links families of environments.
    families: &'static str,
    /// Whether the command is the demo, and nothing is built yet. The demo then shows first the
    /// families that build quickly.
    is_first_demo: bool,
    /// Whether to build rapier2d, the engine of the ids `rapier/...`, which doubles the time of the
    /// build.
    rapier: bool,
    /// Whether to build native vectors, which commands that play one environment do without.
    native_vectors: bool,
}

impl Build {
    fn of(arguments: &[OsString]) -> Self {
        let command = arguments.iter().filter_map(|argument| argument.to_str());
        let command = command.clone().find(|argument| !argument.starts_with('-'));
        let asks_for_help = arguments
            .iter()
            .any(|argument| argument == "--help" || argument == "-h");
        // `mjcf` simulates and draws if it is asked to
        let has_options = arguments.iter().any(|argument| {
            let options = ["--steps", "--out", "--window"];
            argument
                .to_str()
                .is_some_and(|text| options.iter().any(|option| text.starts_with(option)))
        });
        let is_quick =
            asks_for_help || !has_options && command.is_none_or(|command| QUICK.contains(&command));
        let is_built = || {
            target_dir()
                .join("play")
                .join("commands")
                .with_extension(env::consts::EXE_EXTENSION)
                .exists()
        };
        let feature = match command {
            _ if asks_for_help => None,
            Some("conform") => Some("conform"),
            Some("play") if !arguments.iter().any(|argument| argument == "--terminal") => {
                Some("human")
            }
            Some("mjcf") if arguments.iter().any(|argument| argument == "--window") => {
                Some("human")
            }
            _ => None,
        };
        let profile = match is_quick {
            true if !is_built() => "quick",
            false if command.is_some_and(|command| FASTEST.contains(&command)) => "release",
            _ => "play",
        };
        let is_over_all = command
            .is_some_and(|command| ["conform", "docs", "soak"].contains(&command))
            && !asks_for_help;
        let names_it = arguments.iter().any(|argument| {
            argument
                .to_str()
                .is_some_and(|text| text.contains("rapier"))
        });
        let shows_all = arguments.iter().any(|argument| argument == "--all");
        let rapier = is_over_all || names_it || shows_all;
        let is_first_demo = command == Some("demo") && profile == "play" && !rapier && !is_built();
        Self {
            profile,
            feature,
            families: "families",
            is_first_demo,
            rapier,
            native_vectors: !asks_for_help
                && command.is_some_and(|command| WITH_VECTORS.contains(&command)),
        }
    }
}

/// Returns the folder of this workspace.
fn root() -> &'static Path {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.parent().unwrap_or(own)
}

/// Returns the target folder of this workspace.
fn target_dir() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// Returns the path of the Cargo that runs this program.
fn cargo() -> OsString {
    env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments(line: &str) -> Vec<OsString> {
        line.split_whitespace().map(OsString::from).collect()
    }

    #[test]
    fn the_workspace_is_the_folder_above_this_package() {
        let manifest = std::fs::read_to_string(root().join("Cargo.toml")).unwrap();
        assert!(manifest.contains("[workspace]"), "{}", root().display());
        assert!(root().join("crates/gym-cli").is_dir());
    }

    #[test]
    fn commands_are_built_with_what_they_need() {
        let feature = |line: &str| Build::of(&arguments(line)).feature;
        assert_eq!(feature("conform CartPole-v1"), Some("conform"));
        assert_eq!(feature("play CartPole-v1"), Some("human"));
        assert_eq!(feature("play Taxi-v4 --terminal"), None);
        assert_eq!(feature("mjcf robot.xml --window"), Some("human"));
        assert_eq!(feature("mjcf robot.xml --out x.png"), None);
        assert_eq!(feature("conform --help"), None, "help is quick");
        assert_eq!(
            feature("bench"),
            None,
            "allocations are not counted where time is measured"
        );
    }

    #[test]
    fn rapier_is_built_for_what_asks_for_it() {
        let rapier = |line: &str| Build::of(&arguments(line)).rapier;
        for line in [
            "run rapier/LunarLander-v3",
            "conform",
            "docs --check",
            "demo --all",
        ] {
            assert!(rapier(line), "{line}");
        }
        for line in ["list", "demo", "run LunarLander-v3", "conform --help", ""] {
            assert!(!rapier(line), "{line}");
        }
    }

    #[test]
    fn native_vectors_are_built_for_what_makes_them() {
        let native_vectors = |line: &str| Build::of(&arguments(line)).native_vectors;
        for line in ["bench CartPole-v1", "conform"] {
            assert!(native_vectors(line), "{line}");
        }
        for line in ["demo", "play CartPole-v1", "gif Taxi-v4", "conform --help"] {
            assert!(!native_vectors(line), "{line}");
        }
    }

    #[test]
    fn commands_that_play_are_optimised_and_those_that_measure_the_most() {
        let profile = |line: &str| Build::of(&arguments(line)).profile;
        for line in [
            "demo",
            "conform",
            "run Taxi-v4",
            "mjcf robot.xml --steps 9",
            "mjcf robot.xml --steps=9",
            "mjcf robot.xml --out=x.png",
            "mjcf robot.xml --window",
        ] {
            assert_eq!(profile(line), "play", "{line}");
        }
        assert_eq!(profile("bench CartPole-v1"), "release");
        assert_ne!(profile("bench --help"), "release", "help is quick");
    }

    #[test]
    fn only_a_demo_is_built_in_two_parts() {
        for line in ["demo --all", "demo --help", "run CartPole-v1", "list"] {
            assert!(!Build::of(&arguments(line)).is_first_demo, "{line}");
        }
    }
}
