//! The parts of the commands that depend on one family: MuJoCo's models, ROMs and recordings.

mod atari;
mod mjcf;
mod recordings;

use gym::Result;

pub(crate) use recordings::{answer, compare};

#[derive(clap::Subcommand)]
pub(crate) enum Command {
    /// Prints what a model in MJCF has, steps it, draws it.
    Mjcf(mjcf::Arguments),
    /// Compares your ROMs of the Atari 2600 with recordings of ale-py.
    Atari(atari::Arguments),
}

impl Command {
    pub(crate) fn run(self) -> Result<()> {
        match self {
            Self::Mjcf(arguments) => mjcf::mjcf(&arguments),
            Self::Atari(arguments) => atari::atari(arguments),
        }
    }
}
