//! Commands over every environment that is linked: `cargo xtask help`.
//!
//! The program `xtask` builds this crate with the features of a command, and runs it; for a plugin
//! it makes a program that links the plugin and calls [`main_of`].

// they panic where the output cannot be written
#![warn(clippy::print_stdout, clippy::print_stderr)]

#[cfg(feature = "families")]
mod atari;
mod bench;
mod conform;
mod demo;
mod docs;
mod gif;
mod keys;
mod list;
#[cfg(feature = "families")]
mod mjcf;
mod new;
mod output;
mod play;
mod plots;
mod policy;
mod replay;
mod run;
mod selection;
mod soak;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use gym::{Error, Result};

use crate::output::tell;
use crate::selection::Selection;

#[derive(Parser)]
#[command(
    name = "cargo xtask",
    bin_name = "cargo xtask",
    about = "Commands over every environment that is linked",
    after_help = "`cargo xtask web` builds a page that runs every environment in a browser, `cargo xtask python` a Python package with the \
                  environments of a plugin. `--help` after either says more."
)]
struct Arguments {
    /// The folder of a crate whose environments replace those of this workspace, for every command
    /// except `new`.
    #[arg(long, global = true, value_name = "PATH")]
    plugin: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Lists the environments.
    List(list::Arguments),
    /// Plays random episodes of the newest version of each task; writes GIFs, plots and a table to
    /// target/demo.
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
    #[cfg(feature = "families")]
    Mjcf(mjcf::Arguments),
    /// Compares your ROMs of the Atari 2600 with recordings of ale-py.
    #[cfg(feature = "families")]
    Atari(atari::Arguments),
    /// Writes the pages about the environments, and checks the book.
    Docs(docs::Arguments),
    /// Measures steps and frames per second.
    Bench(bench::Arguments),
    /// Checks environments against the rules of gym-conform.
    Conform(conform::Arguments),
    /// Creates a crate with an environment of your own.
    New(new::Arguments),
    /// Steps every environment for a long time, and checks that memory does not grow.
    Soak(soak::Arguments),
}

/// Runs the command that the program's arguments name, over every environment that is linked.
pub fn main() -> ExitCode {
    start(Selection::All)
}

/// As [`main`], over the environments that the crate in a folder registers.
pub fn main_of(crate_name: &'static str, folder: &'static str) -> ExitCode {
    start(Selection::Crate(crate_name, folder))
}

fn start(selection: Selection) -> ExitCode {
    log::set_logger(&Stderr)
        .map(|()| log::set_max_level(log::LevelFilter::Warn))
        .ok();
    match command(Arguments::parse(), selection) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if output::reader_left(&error) => ExitCode::SUCCESS,
        Err(error) => {
            tell!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn command(arguments: Arguments, selection: Selection) -> Result<()> {
    if arguments.plugin.is_some() {
        return Err(Error::custom(
            "`--plugin` builds a program around the plugin: run it as `cargo xtask`",
        ));
    }
    match arguments.command {
        Command::List(arguments) => list::list(&arguments, selection),
        Command::Demo(arguments) => demo::demo(&arguments, selection),
        Command::Gif(arguments) => gif::gif(&arguments),
        Command::Play(arguments) => play::play(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Replay(arguments) => replay::replay(&arguments),
        #[cfg(feature = "families")]
        Command::Mjcf(arguments) => mjcf::mjcf(&arguments),
        #[cfg(feature = "families")]
        Command::Atari(arguments) => atari::atari(arguments),
        Command::Docs(arguments) => docs::docs(&arguments, selection),
        Command::Bench(arguments) => bench::bench(&arguments, selection),
        Command::Conform(arguments) => conform::conform(&arguments, selection),
        Command::New(arguments) => new::new(&arguments),
        Command::Soak(arguments) => soak::soak(&arguments, selection),
    }
}

/// Shows the library's warnings, for example about an outdated environment.
struct Stderr;

impl log::Log for Stderr {
    fn enabled(&self, _metadata: &log::Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &log::Record<'_>) {
        // warnings of other crates are not about environments
        if record.target().starts_with("gym") {
            tell!(
                "{}: {}",
                record.level().as_str().to_lowercase(),
                record.args()
            );
        }
    }

    fn flush(&self) {}
}

/// A seed on the command line.
fn parse_seed(text: &str) -> Result<u64, String> {
    text.parse()
        .map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

/// Fails early if a file cannot be written.
fn check_writable(path: &Path) -> Result<()> {
    gym::render::file::AtomicFile::create(path).map(drop)
}

/// Whether two paths name one file, which need not exist yet.
fn is_one_file(a: &Path, b: &Path) -> bool {
    let resolved = |path: &Path| -> std::io::Result<PathBuf> {
        let folder = path
            .parent()
            .filter(|folder| *folder != Path::new(""))
            .unwrap_or(Path::new("."));
        path.canonicalize().or_else(|_| {
            Ok(folder
                .canonicalize()?
                .join(path.file_name().unwrap_or_default()))
        })
    };
    a == b || resolved(a).is_ok_and(|a| resolved(b).is_ok_and(|b| a == b))
}

/// Arguments of an environment, as JSON on the command line.
fn parse_kwargs(json: &str) -> Result<gym::Kwargs, String> {
    serde_json::from_str(json).map_err(|error| format!("not a JSON object: {error}"))
}

/// An id as part of a file name.
fn file_stem(id: &str) -> String {
    id.replace('/', "_")
}

/// The folder of the workspace that this was built in.
fn root() -> &'static Path {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.ancestors().nth(2).unwrap_or(own)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    /// The README, CONTRIBUTING and every page of the book.
    fn documents(folder: &Path, files: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                documents(&path, files);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                files.push(path);
            }
        }
    }

    /// Fails with the fault in the rest of a line behind `cargo xtask`.
    fn check(line: &str, program: &clap::Command, web: &str) -> std::result::Result<(), String> {
        let mut words = line
            .split_whitespace()
            .map(|word| word.trim_end_matches([',', '.', ';', ':', ')']));
        let mut command = None;
        while let Some(word) = words.next() {
            let flag = word
                .strip_prefix("--")
                .map(|flag| flag.split('=').next().unwrap_or(flag));
            match (flag, command) {
                (Some("plugin" | "help"), _) => drop(words.next()),
                (Some(flag), Some("web")) if web.contains(&format!("--{flag} ")) => {}
                (Some(flag), Some(name)) => {
                    let of = program
                        .find_subcommand(name)
                        .ok_or(format!("`{name}` has no option"))?;
                    let inner = of.get_subcommands().flat_map(clap::Command::get_arguments);
                    let mut flags = of
                        .get_arguments()
                        .chain(inner)
                        .filter_map(clap::Arg::get_long);
                    flags
                        .find(|other| *other == flag)
                        .ok_or(format!("`{name}` has no option `--{flag}`"))?;
                }
                (Some(flag), None) => return Err(format!("`--{flag}` is an option of no command")),
                (None, None) if word == "COMMAND" => return Ok(()),
                (None, None) => {
                    let is_command = ["python", "web", "help"].contains(&word)
                        || program.find_subcommand(word).is_some();
                    is_command
                        .then_some(())
                        .ok_or(format!("there is no command `{word}`"))?;
                    command = Some(word);
                }
                // an argument of the command
                (None, Some(_)) => {}
            }
        }
        Ok(())
    }

    #[test]
    fn one_file_may_have_several_paths() {
        let is_one = |a: &str, b: &str| is_one_file(Path::new(a), Path::new(b));
        assert!(
            is_one("src/../x.svg", "src/../src/../x.svg")
                && is_one("/nonexistent/a", "/nonexistent/a")
        );
        assert!(!is_one("x.svg", "src/x.svg") && !is_one("/nonexistent/a", "/nonexistent/b"));
    }

    #[test]
    fn commands_and_options_in_the_documents_exist() {
        let root = root();
        let mut files = vec![
            root.join("README.md"),
            root.join("CONTRIBUTING.md"),
            root.join("ARCHITECTURE.md"),
        ];
        documents(&root.join("docs"), &mut files);
        let web = std::fs::read_to_string(root.join("xtask/src/web.rs")).unwrap();
        let (program, mut seen) = (super::Arguments::command(), 0);
        for file in files {
            let text = std::fs::read_to_string(&file).unwrap();
            for (number, line) in text.lines().enumerate() {
                for rest in line.split("cargo xtask ").skip(1) {
                    let rest = rest
                        .split(['`', '#', '|', '&', '<'])
                        .next()
                        .unwrap_or_default()
                        .trim_end_matches("-->");
                    seen += 1;
                    if let Err(reason) = check(rest, &program, &web) {
                        panic!(
                            "{}:{}: `cargo xtask {rest}`: {reason}",
                            file.display(),
                            number + 1
                        );
                    }
                }
            }
        }
        assert!(seen > 40, "{seen} commands");
    }
}
