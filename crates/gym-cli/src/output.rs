//! Text for the terminal. Unlike `println!`, these functions do not panic if the output cannot be
//! written.
//!
//! A reader such as `head` may close the pipe early. The command then stops printing, but still
//! writes its files and returns its own exit status.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stderr, stdout};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use gym::{Error, Result, printable};

/// The name of the standard output in errors.
const NAME: &str = "standard output";

/// Whether the reader of the standard output has closed the pipe.
static READER_LEFT: AtomicBool = AtomicBool::new(false);

/// Writes to the standard output and flushes it. Nothing is escaped.
pub(crate) fn write(text: Arguments<'_>) -> Result<()> {
    if READER_LEFT.load(Ordering::Relaxed) {
        return Ok(());
    }
    let mut stdout = stdout().lock();
    match stdout.write_fmt(text).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {
            READER_LEFT.store(true, Ordering::Relaxed);
            Ok(())
        }
        written => written.map_err(|error| Error::io(Path::new(NAME), error)),
    }
}

/// Writes lines of text to the standard output. Control characters are escaped.
pub(crate) fn text(text: &str) -> Result<()> {
    write(format_args!("{}", Lines(text)))
}

/// Prints a line like `println!`, but returns an error if the line cannot be written. Control
/// characters are escaped.
pub(crate) fn say(text: Arguments<'_>) -> Result<()> {
    write(format_args!("{}\n", Lines(&text.to_string())))
}

/// Prints a line to the standard error like `eprintln!`, but ignores an error of writing. Control
/// characters are escaped, and long lines are cut.
pub(crate) fn tell(text: Arguments<'_>) {
    const MAX_LENGTH: usize = 2000;
    let cut = |line: &str| match line.char_indices().nth(MAX_LENGTH) {
        Some((end, _)) => format!("{}...", &line[..end]),
        None => line.to_owned(),
    };
    let lines: Vec<_> = text.to_string().split('\n').map(cut).collect();
    let _ = writeln!(stderr().lock(), "{}", Lines(&lines.join("\n")));
}

/// Prints the help, or the error of an invalid command line. Returns the exit status.
pub(crate) fn refuse(error: &clap::Error) -> u8 {
    if error.use_stderr() {
        // (the error may quote control characters of the arguments)
        tell(format_args!("{}", error.render().to_string().trim_end()));
    } else if let Err(error) = error.print()
        && error.kind() != ErrorKind::BrokenPipe
    {
        tell(format_args!("error: {NAME}: {error}"));
        return 1;
    }
    u8::try_from(error.exit_code()).unwrap_or(1)
}

/// Lines of text, each [`printable`].
struct Lines<'a>(&'a str);

impl std::fmt::Display for Lines<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, line) in self.0.split('\n').enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            f.write_str(&printable(line))?;
        }
        Ok(())
    }
}
