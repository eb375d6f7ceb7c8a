//! The Python process of an environment, and its requests.

use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use gym_core::{Error, Result, Value};

use crate::Config;
use crate::wire::{Reader, write};

/// What the worker runs.
const SCRIPT: &str = include_str!("worker.py");
/// A reply longer than this is not one.
const LONGEST: usize = 1 << 30; // bytes

/// The requests to a worker, with the numbers in `worker.py`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Request {
    Make,
    Reset,
    Step,
    Render,
    Dump,
    Load,
    Close,
}

impl Request {
    /// As error messages call it.
    fn name(self) -> &'static str {
        match self {
            Self::Make => "make",
            Self::Reset => "reset",
            Self::Step => "step",
            Self::Render => "render",
            Self::Dump => "pickle",
            Self::Load => "unpickle",
            Self::Close => "close",
        }
    }
}

/// A Python process that serves one environment. It ends when this is dropped, or when this process ends.
#[derive(Debug)]
pub(crate) struct Worker {
    child: Child,
    pipe: UnixStream,
    /// The environment, for messages.
    name: String,
    /// The bytes of the last request, then of the last reply.
    frame: Vec<u8>,
    timeout: Duration,
    /// How it ended, once it has.
    ended: Option<String>,
}

impl Worker {
    /// Starts a process, in which no environment is made yet.
    pub(crate) fn start(config: &Config, name: &str) -> Result<Self> {
        let python = config.python();
        let cannot = |error: &io::Error| {
            Error::custom(format!(
                "the Python interpreter `{}` cannot be run: {error}; install Python 3.8 or later, or name another one \
                 with `.arg(\"python\", \"/path/to/python3\")`",
                python.display()
            ))
        };
        let pipes = || -> io::Result<(UnixStream, OwnedFd, OwnedFd)> {
            let (ours, theirs) = UnixStream::pair()?;
            ours.set_read_timeout(Some(config.timeout()))?;
            ours.set_write_timeout(Some(config.timeout()))?;
            Ok((ours, theirs.try_clone()?.into(), theirs.into()))
        };
        let (pipe, requests, replies) = pipes().map_err(|error| cannot(&error))?;
        let mut command = Command::new(&python);
        command.args(["-c", SCRIPT]).stdin(Stdio::from(requests)).stdout(Stdio::from(replies));
        let child = command.spawn().map_err(|error| cannot(&error))?;
        let (name, frame) = (name.to_owned(), Vec::new());
        Ok(Self { child, pipe, name, frame, timeout: config.timeout(), ended: None })
    }

    /// Asks, and waits for the reply.
    ///
    /// # Errors
    /// Python's exception, the worker's exit status, or a timeout.
    pub(crate) fn ask(&mut self, request: Request, values: &[&Value]) -> Result<Reader<'_>> {
        if let Some(how) = &self.ended {
            return Err(Error::custom(how.clone()));
        }
        self.frame.clear();
        self.frame.extend([0; 4]);
        self.frame.push(request as u8);
        values.iter().for_each(|value| write(value, &mut self.frame));
        let length = u32::try_from(self.frame.len() - 4).unwrap_or(u32::MAX);
        self.frame[..4].copy_from_slice(&length.to_le_bytes());
        if let Err(error) = self.pipe.write_all(&self.frame).and_then(|()| self.receive()) {
            return Err(self.end(request, &error));
        }
        let mut reader = Reader::new(&self.frame);
        match reader.byte() {
            Some(0) => Ok(reader),
            Some(1) => Err(exception(&self.name, request, reader.value().as_ref())),
            _ => Err(malformed(&self.name, request)),
        }
    }

    /// Reads a whole reply into the frame.
    fn receive(&mut self) -> io::Result<()> {
        let mut length = [0; 4];
        self.pipe.read_exact(&mut length)?;
        let length = u32::from_le_bytes(length) as usize;
        if length > LONGEST {
            return Err(io::Error::new(ErrorKind::InvalidData, "the reply has no valid length"));
        }
        self.frame.resize(length, 0);
        self.pipe.read_exact(&mut self.frame)
    }

    /// Ends the worker after a failure of the pipe, and returns the cause.
    fn end(&mut self, request: Request, error: &io::Error) -> Error {
        let (name, asked) = (self.name.clone(), request.name());
        let how = match error.kind() {
            ErrorKind::WouldBlock | ErrorKind::TimedOut => {
                let seconds = self.timeout.as_secs_f64();
                format!(
                    "the worker of `{name}` did not answer `{asked}` within {seconds} s and was ended: make the environment \
                     anew, with a longer `timeout` if it needs one"
                )
            }
            _ => {
                let status = self.wait(Duration::from_secs(1));
                let status = status.map_or_else(|| error.to_string(), |status| status.to_string());
                format!(
                    "the worker of `{name}` ended during `{asked}` ({status}): standard error has its messages; make the \
                     environment anew"
                )
            }
        };
        self.kill();
        self.ended = Some(how.clone());
        Error::custom(how)
    }

    /// Waits for the process to end by itself.
    fn wait(&mut self, at_most: Duration) -> Option<std::process::ExitStatus> {
        let start = Instant::now();
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return Some(status),
                Ok(None) if start.elapsed() < at_most => thread::sleep(Duration::from_millis(2)),
                _ => return None,
            }
        }
    }

    fn kill(&mut self) {
        // Both fail only if the process has already ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        if self.ended.is_some() {
            return;
        }
        // Give the worker time to finish videos, but do not wait for one that hangs.
        let goodbye = Duration::from_secs(2);
        let asked = match self.pipe.set_read_timeout(Some(goodbye)) {
            Ok(()) => self.ask(Request::Close, &[]).map(|_| ()),
            Err(error) => Err(Error::custom(error.to_string())),
        };
        if let Err(error) = &asked {
            // a drop returns nothing
            eprintln!("{error}");
        }
        if self.ended.is_none() && (asked.is_err() || self.wait(goodbye).is_none()) {
            self.kill();
        }
    }
}

/// Bytes that the script does not write.
pub(crate) fn malformed(name: &str, request: Request) -> Error {
    Error::custom(format!("the worker of `{name}` sent an invalid reply to `{}`", request.name()))
}

/// What Python raised.
fn exception(name: &str, request: Request, told: Option<&Value>) -> Error {
    let text = |key: &str| told.and_then(|told| told.get(key)?.as_text());
    let message = text("message").unwrap_or("no message");
    Error::custom(match (text("type"), text("place")) {
        (Some(kind), Some(place)) => {
            format!("`{name}` raised {kind} in `{}`: {message} ({place})", request.name())
        }
        _ => format!("`{name}` cannot be run: {message}"),
    })
}
