//! `cargo xtask COMMAND`: builds the commands as the one that is asked for needs them, and runs it.
//!
//! This program has next to no dependencies, so that it says within seconds what it builds:
//! - Commands that play are built with optimisation, and those that measure with all of it; `list`,
//!   `help` and `new` without any, unless those that play are there.
//! - `play` is built with windows, `conform` with the allocator that counts; rapier2d is built for
//!   what asks for it.
//! - `web` builds the gallery for the browser, and `python` writes a plugin's Python package: both
//!   are part of this program.
//! - With `--plugin PATH` a program is built that links the crate in that folder.

mod files;
mod plugin;
mod python;
mod web;

use std::env;
use std::ffi::{OsStr, OsString};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use plugin::Plugin;

/// The commands that need no speed.
const QUICK: [&str; 4] = ["list", "help", "mjcf", "new"];
/// The commands that measure speed, or play for hours.
const FASTEST: [&str; 2] = ["bench", "soak"];

fn main() -> ExitCode {
    match run(env::args_os().skip(1).collect()) {
        Ok(code) => code,
        Err(error) => {
            // `eprintln!` panics if standard error is closed
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: Vec<OsString>) -> Result<ExitCode, String> {
    let (plugin, arguments) = take_plugin(arguments)?;
    // `help web`, as `help` has every other command
    let arguments = match &arguments[..] {
        [help, command] if help == "help" && own(command).is_some() => {
            vec![command.clone(), "--help".into()]
        }
        _ => arguments,
    };
    if let Some(command) = arguments.first().and_then(|command| own(command)) {
        return command(plugin.as_deref(), &arguments).map(|()| ExitCode::SUCCESS);
    }
    let build = Build::of(
        &arguments,
        env::var("XTASK_PROFILE").is_ok_and(|profile| profile == "dev"),
    );
    if build.is_first_demo && plugin.is_none() {
        say(format_args!(
            "The quick families first: the others are built after their GIFs."
        ))?;
        let quick = Build {
            families: "gym/classic,gym/toytext",
            ..build
        };
        let code = start(&quick, None, &arguments)?;
        if code != ExitCode::SUCCESS {
            return Ok(code);
        }
    }
    start(&build, plugin.as_deref(), &arguments)
}

/// A command that is part of this program.
type Own = fn(Option<&Path>, &[OsString]) -> Result<(), String>;

fn own(command: &OsStr) -> Option<Own> {
    match command.to_str() {
        Some("python") => Some(python::python),
        Some("web") => Some(web::web),
        _ => None,
    }
}

/// Builds the commands, and runs the requested one.
fn start(build: &Build, plugin: Option<&Path>, arguments: &[OsString]) -> Result<ExitCode, String> {
    let mut cargo = Command::new(cargo());
    cargo.arg("run").args(["--profile", build.profile]);
    match plugin {
        None => {
            cargo
                .args(["--package", "xtask-commands", "--manifest-path"])
                .arg(root().join("Cargo.toml"));
        }
        Some(folder) => {
            let plugin = Plugin::read(folder)?;
            let program = target_dir().join("plugins").join(&plugin.name);
            plugin.write_program(&program)?;
            cargo.arg("--manifest-path").arg(program.join("Cargo.toml"));
            cargo.arg("--target-dir").arg(target_dir());
        }
    }
    let mut features: Vec<&str> = build.feature.into_iter().collect();
    if plugin.is_none() && !build.rapier {
        cargo.arg("--no-default-features");
        features.push(build.families);
    }
    if !features.is_empty() {
        cargo.args(["--features", &features.join(",")]);
    }
    let status = cargo.arg("--").args(arguments).status();
    let status = status.map_err(|error| format!("cargo cannot be run: {error}"))?;
    // a signal leaves no code
    Ok(status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .map_or(ExitCode::FAILURE, ExitCode::from))
}

/// Prints a line; `println!` panics where the output cannot be written.
fn say(line: std::fmt::Arguments<'_>) -> Result<(), String> {
    writeln!(std::io::stdout(), "{line}").map_err(|error| format!("standard output: {error}"))
}

/// The settings with which a command is built.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Build {
    profile: &'static str,
    feature: Option<&'static str>,
    /// The families that are linked without rapier2d.
    families: &'static str,
    /// Whether this is the demo, and nothing is built yet: then the families that build quickly are
    /// shown first.
    is_first_demo: bool,
    /// With the engine of the namespace `rapier/`, which doubles the time that everything takes to
    /// build.
    rapier: bool,
}

impl Build {
    /// `in_dev` builds as tests are built, which need no speed.
    fn of(arguments: &[OsString], in_dev: bool) -> Self {
        let command = arguments.iter().filter_map(|argument| argument.to_str());
        let command = command.clone().find(|argument| !argument.starts_with('-'));
        let asks_for_help = arguments
            .iter()
            .any(|argument| argument == "--help" || argument == "-h");
        let is_quick = asks_for_help || command.is_none_or(|command| QUICK.contains(&command));
        let is_built = || {
            target_dir()
                .join("play")
                .join("xtask-commands")
                .with_extension(env::consts::EXE_EXTENSION)
                .exists()
        };
        let feature = match command {
            _ if asks_for_help => None,
            Some("conform") => Some("conform"),
            Some("play") if !arguments.iter().any(|argument| argument == "--terminal") => {
                Some("human")
            }
            _ => None,
        };
        let profile = match is_quick {
            _ if in_dev => "dev",
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
        let rapier = in_dev || is_over_all || names_it || shows_all;
        let is_first_demo = command == Some("demo") && profile == "play" && !rapier && !is_built();
        Self {
            profile,
            feature,
            families: "families",
            is_first_demo,
            rapier,
        }
    }
}

/// The folder after `--plugin`, and the other arguments.
fn take_plugin(arguments: Vec<OsString>) -> Result<(Option<PathBuf>, Vec<OsString>), String> {
    let (mut plugin, mut others) = (None, Vec::new());
    let mut arguments = arguments.into_iter();
    while let Some(argument) = arguments.next() {
        if argument == "--plugin" {
            let folder = arguments
                .next()
                .ok_or("`--plugin` needs the folder of a crate: `--plugin ../my_envs`")?;
            plugin = Some(PathBuf::from(folder));
        } else if let Some(folder) = argument
            .to_str()
            .and_then(|text| text.strip_prefix("--plugin="))
        {
            plugin = Some(PathBuf::from(folder));
        } else {
            others.push(argument);
        }
    }
    if plugin.is_some() && others.iter().any(|argument| argument == OsStr::new("new")) {
        return Err("`new` takes no `--plugin`: it is about this workspace".into());
    }
    Ok((plugin, others))
}

/// The folder of this workspace.
fn root() -> &'static Path {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.parent().unwrap_or(own)
}

/// Where this workspace is built, and plugins with it.
fn target_dir() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// The cargo that runs this.
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
    fn commands_are_built_with_what_they_need() {
        let feature = |line: &str| Build::of(&arguments(line), false).feature;
        assert_eq!(feature("conform CartPole-v1"), Some("conform"));
        assert_eq!(feature("play CartPole-v1"), Some("human"));
        assert_eq!(feature("play Taxi-v4 --terminal"), None);
        assert_eq!(feature("conform --help"), None, "help is quick");
        assert_eq!(
            feature("bench"),
            None,
            "allocations are not counted where time is measured"
        );
    }

    #[test]
    fn rapier_is_built_for_what_asks_for_it() {
        let rapier = |line: &str| Build::of(&arguments(line), false).rapier;
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
    fn commands_that_play_are_optimised_and_those_that_measure_the_most() {
        let profile = |line: &str| Build::of(&arguments(line), false).profile;
        for line in ["demo", "conform", "run Taxi-v4"] {
            assert_eq!(profile(line), "play", "{line}");
        }
        assert_eq!(profile("bench CartPole-v1"), "release");
        assert_ne!(profile("bench --help"), "release", "help is quick");
    }

    #[test]
    fn only_a_demo_is_built_in_two_parts() {
        for line in ["demo --all", "demo --help", "run CartPole-v1", "list"] {
            assert!(!Build::of(&arguments(line), false).is_first_demo, "{line}");
        }
        assert!(
            !Build::of(&arguments("demo"), true).is_first_demo,
            "tests are built at once"
        );
    }

    #[test]
    fn the_plugin_stands_anywhere() {
        for line in [
            "--plugin x list --long",
            "list --plugin x --long",
            "list --long --plugin=x",
        ] {
            let expected = (Some(PathBuf::from("x")), arguments("list --long"));
            assert_eq!(take_plugin(arguments(line)).unwrap(), expected, "{line}");
        }
        assert!(
            take_plugin(arguments("list --plugin"))
                .unwrap_err()
                .contains("folder of a crate")
        );
        assert!(
            take_plugin(arguments("new x --plugin y"))
                .unwrap_err()
                .contains("`new` takes no")
        );
    }
}
