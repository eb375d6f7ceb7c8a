//! Text for the terminal. `println!` panics where the output cannot be written; here that is an
//! error.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stderr, stdout};
use std::path::Path;

use gym::{Error, Result};

/// The name of the standard output in errors.
const NAME: &str = "standard output";

/// Prints a line, as `println!`, and gives an error where it cannot be written.
macro_rules! say {
    ($($text:tt)*) => { $crate::output::write(format_args!("{}\n", format_args!($($text)*))) };
}

/// Prints a line to the standard error, as `eprintln!`. An error of writing is ignored.
macro_rules! tell {
    ($($text:tt)*) => { $crate::output::write_error(format_args!("{}\n", format_args!($($text)*))) };
}

pub(crate) use {say, tell};

/// Writes to the standard output, at once.
pub(crate) fn write(text: Arguments<'_>) -> Result<()> {
    let mut stdout = stdout().lock();
    stdout
        .write_fmt(text)
        .and_then(|()| stdout.flush())
        .map_err(|error| Error::io(Path::new(NAME), error))
}

pub(crate) fn write_error(text: Arguments<'_>) {
    let _ = stderr().lock().write_fmt(text);
}

/// Whether a command ended because its reader, such as `head`, closed the pipe.
pub(crate) fn reader_left(error: &Error) -> bool {
    matches!(error, Error::Io { path, source } if path == NAME && source.kind() == ErrorKind::BrokenPipe)
}
