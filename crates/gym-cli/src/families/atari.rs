//! `cargo xtask atari check`

use std::fmt;
use std::path::PathBuf;

use gym::atari::RomDir;
use gym::atari::check::Sums;
use gym::atari::games::{GAMES, Game};
use gym::{Error, Result};

use crate::output::say;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Plays your ROMs, and lists the games that equal ale-py 0.12.1's.
    Check {
        /// The folder of ROMs; by default the one that environments find.
        #[arg(long, value_name = "DIR")]
        rom_dir: Option<PathBuf>,
    },
}

pub(crate) fn atari(arguments: Arguments) -> Result<()> {
    let Command::Check { rom_dir } = arguments.command;
    let folder = rom_dir.map(RomDir::new).or_else(RomDir::find).ok_or_else(|| {
        Error::custom(
            "no ROMs were found: `pip install ale-py` brings them; or name their folder with `--rom-dir`",
        )
    })?;
    check(&folder)
}

/// Compares every game whose file is in `folder` with the recordings of ale-py.
fn check(folder: &RomDir) -> Result<()> {
    let (there, missing): (Vec<_>, Vec<_>) =
        GAMES.iter().partition(|game| folder.file(game).exists());
    if there.is_empty() {
        let (path, example) = (folder.path().display(), folder.file(&GAMES[0]));
        let example = example.file_name().unwrap_or_default().display();
        return Err(Error::custom(format!(
            "{path} has no ROM of a known game: a file is named as {example}"
        )));
    }
    let mut failed = 0;
    for &game in &there {
        let verdict = Verdict::of(game, folder);
        failed += usize::from(verdict != Verdict::Equal);
        say(format_args!("{:20} {verdict}", game.name))?;
    }
    let equal = there.len() - failed;
    say(format_args!(
        "{equal} of {} games are as recorded, {} have no ROM here",
        GAMES.len(),
        missing.len()
    ))?;
    if failed > 0 {
        return Err(Error::custom(format!(
            "{failed} of {} ROMs failed",
            there.len()
        )));
    }
    Ok(())
}

/// The result of a game.
#[derive(Debug, PartialEq)]
enum Verdict {
    Equal,
    /// The recorded runs that differ.
    Different(Vec<&'static str>),
    /// The reason why the game was not played.
    Unplayed(String),
}

impl Verdict {
    fn of(game: &'static Game, folder: &RomDir) -> Self {
        match (folder.rom(game), Sums::recorded(game.name)) {
            (Err(error), _) => Self::Unplayed(error.to_string()),
            (_, None) => Self::Unplayed("it was not recorded".to_owned()),
            (Ok(rom), Some(recorded)) => Self::between(recorded, Sums::of(&rom)),
        }
    }

    fn between(recorded: Sums, played: Sums) -> Self {
        match played.differences(&recorded) {
            runs if runs.is_empty() => Self::Equal,
            runs => Self::Different(runs),
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Equal => f.write_str("as recorded"),
            Self::Different(runs) => write!(f, "differs in {}", runs.join(" and in ")),
            Self::Unplayed(reason) => f.write_str(reason),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_named() {
        let recorded = Sums {
            minimal: 1,
            sticky: 2,
            modes: 3,
        };
        assert_eq!(
            Verdict::between(recorded, recorded).to_string(),
            "as recorded"
        );
        let played = Sums {
            minimal: 0,
            modes: 0,
            ..recorded
        };
        let verdict = Verdict::between(recorded, played);
        assert_eq!(
            verdict.to_string(),
            "differs in the minimal actions and in the modes"
        );
    }
}
