//! The commands of `cargo xtask`, over every environment that a program links.
//!
//! A workspace with environments of its own has a package `xtask` with this program, and the alias
//! `xtask = "run --release --package xtask --"` in `.cargo/config.toml`:
//!
//! ```no_run
//! # mod my_envs {}
//! use my_envs as _; // links them
//!
//! fn main() -> std::process::ExitCode {
//!     gym_cli::main(env!("CARGO_MANIFEST_DIR"))
//! }
//! ```
//!
//! `cargo xtask new` makes such a workspace, and `cargo xtask help` lists the commands. Without an
//! id, a command serves all environments that the workspace registers. An id can name any linked
//! environment.
//!
//! `conform` counts allocations with a special allocator, which needs 17 ns for a small allocation
//! (the system's allocator: 10 ns). The other commands, above all `bench`, must not become slower,
//! so `conform` is a separate build with the feature `conform`. It uses the profile `dev`, which
//! also checks for arithmetic overflow.

// (`print!` panics if the output cannot be written)
#![warn(clippy::print_stdout, clippy::print_stderr)]

mod bench;
mod collision;
mod conform;
mod demo;
mod dependency;
mod docs;
#[cfg_attr(not(feature = "families"), path = "no_families.rs")]
mod families;
mod film;
mod gif;
mod inputs;
mod keys;
mod list;
#[cfg(all(feature = "human", feature = "families"))]
mod live;
mod new;
mod output;
mod play;
mod plots;
mod policy;
mod python;
mod replay;
mod run;
#[cfg(feature = "conform")]
mod sample;
mod soak;
mod workspace;

use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use gym::Result;

pub use crate::docs::{Book, Document};
use crate::output::tell;
use crate::workspace::Workspace;

#[derive(Parser)]
#[command(
    name = "cargo xtask",
    bin_name = "cargo xtask",
    about = "Commands over every environment that is linked"
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Lists the environments.
    List(list::Arguments),
    /// Plays ten episodes of each task, and shows them on one page: target/demo/index.html.
    Demo(demo::Arguments),
    /// Records one episode as a GIF, animated PNG or MP4.
    Gif(gif::Arguments),
    /// Lets you play, with the keyboard.
    Play(play::Arguments),
    /// Plays one episode per seed and prints returns and lengths.
    Run(run::Arguments),
    /// Repeats recorded traces and compares, or writes, the answers.
    Replay(replay::Arguments),
    #[command(flatten)]
    Families(families::Command),
    /// Writes the pages about the environments of this workspace.
    Docs(docs::Arguments),
    /// Measures steps and frames per second.
    Bench(bench::Arguments),
    /// Checks environments against the rules of gym-conform.
    Conform(conform::Arguments),
    /// Makes a Python package: rustgym, with the environments of this workspace beside its own.
    Python,
    /// Creates a crate with an environment of your own.
    New(new::Arguments),
    /// Steps every environment for a long time, and checks that memory does not grow.
    Soak(soak::Arguments),
}

/// Runs the command that the program's arguments name, for the workspace of the package in the
/// folder `package`: `env!("CARGO_MANIFEST_DIR")`.
pub fn main(package: &str) -> ExitCode {
    start(package, None)
}

/// As [`main`], in a workspace whose pages on environments are part of a book.
pub fn main_with_book(package: &str, book: &Book) -> ExitCode {
    start(package, Some(book))
}

/// The exit code that shells report for a program that Ctrl+C has ended.
const INTERRUPTED: i32 = 130;

/// Ends the program after a signal, which would leave temporary files of unfinished results.
fn end(code: i32) -> ! {
    let _no_new_folder = new::wait();
    gym::render::file::remove_unfinished_and_exit(code)
}

fn start(package: &str, book: Option<&Book>) -> ExitCode {
    log::set_logger(&Stderr)
        .map(|()| log::set_max_level(log::LevelFilter::Warn))
        .ok();
    ctrlc::set_handler(|| end(INTERRUPTED)).ok();
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGHUP, SIGTERM};
        use std::io::IsTerminal;
        // `nohup`, which lets a program outlive its terminal, takes the terminal away
        let hang_up = std::io::stderr().is_terminal().then_some(SIGHUP);
        let signals = [SIGTERM].into_iter().chain(hang_up);
        if let Ok(mut signals) = signal_hook::iterator::Signals::new(signals) {
            std::thread::spawn(move || signals.forever().next().map(|signal| end(128 + signal)));
        }
    }
    // with a handler, a file larger than `ulimit -f` is an error of `write`; without one, the system
    // ends the program
    #[cfg(unix)]
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default()).ok();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return ExitCode::from(output::refuse(&error)),
    };
    let workspace = Workspace::of(Path::new(package));
    if let Err(error) = gym::math::requested_level() {
        tell(format_args!("error: {error}"));
        return ExitCode::FAILURE;
    }
    match command(arguments.command, &workspace, book) {
        Ok(code) => code,
        Err(error) => {
            tell(format_args!("error: {error}"));
            ExitCode::FAILURE
        }
    }
}

fn command(command: Command, workspace: &Workspace, book: Option<&Book>) -> Result<ExitCode> {
    match command {
        Command::List(arguments) => list::list(&arguments),
        Command::Demo(arguments) => demo::demo(&arguments, workspace),
        Command::Gif(arguments) => gif::gif(&arguments),
        Command::Play(arguments) => play::play(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Replay(arguments) => replay::replay(&arguments),
        Command::Families(command) => command.run(),
        Command::Docs(arguments) => docs::docs(&arguments, workspace, book),
        Command::Bench(arguments) => bench::bench(&arguments, workspace),
        Command::Conform(arguments) => return conform::conform(&arguments, workspace),
        Command::Python => python::python(workspace),
        Command::New(arguments) => new::new(&arguments, workspace),
        Command::Soak(arguments) => soak::soak(&arguments, workspace),
    }
    .map(|()| ExitCode::SUCCESS)
}

/// Prints the library's warnings, such as a warning about an outdated environment.
struct Stderr;

impl log::Log for Stderr {
    fn enabled(&self, _metadata: &log::Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &log::Record<'_>) {
        // (warnings of other crates do not concern the user)
        if record.target().starts_with("gym") {
            tell(format_args!(
                "{}: {}",
                record.level().as_str().to_lowercase(),
                record.args()
            ));
        }
    }

    fn flush(&self) {}
}
