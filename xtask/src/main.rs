//! Commands over every environment that is linked: `cargo xtask help`.

mod bench;
mod conform;
mod demo;
mod docs;
mod gif;
mod heuristic;
mod keys;
mod list;
mod mjcf;
mod new;
mod play;
mod plots;
mod plugin;
mod policy;
mod replay;
mod run;
mod soak;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Commands over every environment that is linked")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Lists the environments.
    List(list::Arguments),
    /// Plays random episodes of every environment; writes GIFs, plots and a table to target/demo.
    Demo(demo::Arguments),
    /// Records one episode as a GIF, animated PNG or MP4.
    Gif(gif::Arguments),
    /// Lets you play, with the keyboard.
    Play(play::Arguments),
    /// Plays one episode per seed and prints returns and lengths.
    Run(run::Arguments),
    /// Repeats recorded traces and compares, or writes, the answers.
    Replay(replay::Arguments),
    /// Compiles a model in MJCF and prints its sizes.
    Mjcf(mjcf::Arguments),
    /// Writes the pages about the environments, and checks the book.
    Docs(docs::Arguments),
    /// Measures steps and frames per second.
    Bench(bench::Arguments),
    /// Checks that environments keep the rules.
    Conform(conform::Arguments),
    /// Starts a crate with an environment of your own.
    New(new::Arguments),
    /// Steps through every environment for a long time, and watches the memory.
    Soak(soak::Arguments),
}

fn main() -> ExitCode {
    log::set_logger(&Stderr).map(|()| log::set_max_level(log::LevelFilter::Warn)).ok();
    let result = match Arguments::parse().command {
        Command::List(arguments) => list::list(&arguments),
        Command::Demo(arguments) => demo::demo(&arguments),
        Command::Gif(arguments) => gif::gif(&arguments),
        Command::Play(arguments) => play::play(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Replay(arguments) => replay::replay(&arguments),
        Command::Mjcf(arguments) => mjcf::mjcf(&arguments),
        Command::Docs(arguments) => docs::docs(&arguments),
        Command::Bench(arguments) => bench::bench(&arguments),
        Command::Conform(arguments) => conform::conform(&arguments),
        Command::New(arguments) => new::new(&arguments),
        Command::Soak(arguments) => soak::soak(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Shows the library's warnings, such as that of an environment out of date.
struct Stderr;

impl log::Log for Stderr {
    fn enabled(&self, _metadata: &log::Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &log::Record<'_>) {
        // those of other crates are about their own inner workings
        if record.target().starts_with("gym") {
            eprintln!("{}: {}", record.level().as_str().to_lowercase(), record.args());
        }
    }

    fn flush(&self) {}
}

/// Arguments of an environment, as JSON on the command line.
fn parse_kwargs(json: &str) -> Result<gym::Kwargs, String> {
    serde_json::from_str(json).map_err(|error| format!("not a JSON object: {error}"))
}

/// An id as part of a file name.
fn file_stem(id: &str) -> String {
    id.replace('/', "_")
}
