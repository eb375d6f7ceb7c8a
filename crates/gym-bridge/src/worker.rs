//! The Python process of an environment, and the requests to it.

use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use gym_core::{Error, Result, Value};

use crate::Config;
use crate::wire::{Reader, write};

/// The program that the worker runs.
const SCRIPT: &str = include_str!("worker.py");
/// The largest frame of a request or reply, as in `worker.py`.
const LONGEST: u32 = 1 << 30; // bytes
/// The bytes per read: many, because an array is read in parts of this size.
const BUFFER: usize = 1 << 18; // bytes

/// The requests to a worker, with their numbers in `worker.py`.
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
    /// Returns the name for error messages.
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

/// A reply that is being read.
pub(crate) type Reply<'a> = Reader<'a, BufReader<UnixStream>>;

/// Reads a reply of one value.
pub(crate) fn value(reply: &mut Reply<'_>) -> Option<Value> {
    reply.value()
}

/// A Python process that serves one environment. The Python process ends when the `Worker` is
/// dropped, or when this process ends.
#[derive(Debug)]
pub(crate) struct Worker {
    child: Child,
    pipe: BufReader<UnixStream>,
    /// The name of the environment in error messages.
    name: String,
    /// The bytes of the last request.
    request: Vec<u8>,
    timeout: Duration,
    /// The exit status of a process that has ended.
    ended: Option<String>,
}

impl Worker {
    /// Starts a process without an environment.
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
        command
            .args(["-c", SCRIPT])
            .stdin(Stdio::from(requests))
            .stdout(Stdio::from(replies));
        let child = command.spawn().map_err(|error| cannot(&error))?;
        let (name, request) = (name.to_owned(), Vec::new());
        let pipe = BufReader::with_capacity(BUFFER, pipe);
        Ok(Self {
            child,
            pipe,
            name,
            request,
            timeout: config.timeout(),
            ended: None,
        })
    }

    /// Returns the name of the environment for error messages.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Sends a request, and reads the reply as it arrives.
    ///
    /// # Errors
    /// Python's exception, the worker's exit status, or a timeout.
    pub(crate) fn ask<T>(
        &mut self,
        request: Request,
        values: &[&Value],
        read: impl FnOnce(&mut Reply<'_>) -> Option<T>,
    ) -> Result<T> {
        if let Some(how) = &self.ended {
            return Err(Error::custom(how.clone()));
        }
        self.write(request, values)?;
        let sent = self.pipe.get_mut().write_all(&self.request);
        // free the memory of large arrays
        self.request.shrink_to(BUFFER);
        let length = sent.and_then(|()| self.length());
        let length = length.map_err(|error| self.end(request, &error))?;
        let mut reply = Reader::new(&mut self.pipe, length.into());
        let told = match reply.byte() {
            Some(0) => read(&mut reply).map(Ok),
            Some(1) => reply.value().map(Err),
            _ => None,
        };
        let is_done = reply.is_done();
        match (told, reply.into_failure()) {
            (Some(Ok(value)), _) if is_done => Ok(value),
            (Some(Err(told)), _) if is_done => Err(exception(&self.name, request, &told)),
            (_, Some(error)) => Err(self.end(request, &error)),
            _ => Err(self.end(
                request,
                &io::Error::new(ErrorKind::InvalidData, "its reply is invalid"),
            )),
        }
    }

    /// Writes the frame of a request.
    fn write(&mut self, request: Request, values: &[&Value]) -> Result<()> {
        self.request.clear();
        self.request.extend([0; 4]);
        self.request.push(request as u8);
        values
            .iter()
            .for_each(|value| write(value, &mut self.request));
        let length = self.request.len() - 4;
        match u32::try_from(length) {
            Ok(fitting) if fitting <= LONGEST => {
                self.request[..4].copy_from_slice(&fitting.to_le_bytes());
                Ok(())
            }
            _ => Err(Error::custom(format!(
                "`{}` cannot be asked to `{}` with {length} bytes: at most {LONGEST} bytes go to a worker at once",
                self.name,
                request.name()
            ))),
        }
    }

    /// Reads the length of a reply.
    fn length(&mut self) -> io::Result<u32> {
        let mut length = [0; 4];
        self.pipe.read_exact(&mut length)?;
        let length = u32::from_le_bytes(length);
        if length > LONGEST {
            return Err(io::Error::new(
                ErrorKind::InvalidData,
                "its reply has no valid length",
            ));
        }
        Ok(length)
    }

    /// Ends the worker after a failure of the pipe; returns the cause.
    fn end(&mut self, request: Request, error: &io::Error) -> Error {
        let (name, asked) = (self.name.clone(), request.name());
        let how = match error.kind() {
            ErrorKind::WouldBlock | ErrorKind::TimedOut => {
                let seconds = self.timeout.as_secs_f64();
                let hint = match request {
                    Request::Close => "",
                    _ => ": make the environment anew, with a longer `timeout` if it needs one",
                };
                format!(
                    "the worker of `{name}` did not answer `{asked}` within {seconds} s and was ended{hint}"
                )
            }
            _ => {
                let is_alive = error.kind() == ErrorKind::InvalidData;
                let status = if is_alive {
                    None
                } else {
                    self.wait(Duration::from_secs(1))
                };
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

    /// Waits until the process ends, for at most `at_most`.
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
        // both fail only if the process has already ended
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        if self.ended.is_some() {
            return;
        }
        // give the worker time to finish videos, but do not wait for a worker that hangs
        let goodbye = Duration::from_secs(2);
        self.timeout = goodbye.min(self.timeout);
        let asked = match self.pipe.get_ref().set_read_timeout(Some(self.timeout)) {
            Ok(()) => self.ask(Request::Close, &[], |_| Some(())),
            Err(error) => Err(Error::custom(error.to_string())),
        };
        if let Err(error) = &asked {
            // `drop` cannot return the error
            eprintln!("{error}");
        }
        if self.ended.is_none() && (asked.is_err() || self.wait(goodbye).is_none()) {
            self.kill();
        }
    }
}

/// Converts an exception that Python raised.
fn exception(name: &str, request: Request, told: &Value) -> Error {
    let text = |key: &str| told.get(key)?.as_text();
    let message = text("message").filter(|message| !message.is_empty());
    let message = message
        .map(|message| format!(": {message}"))
        .unwrap_or_default();
    let place = text("place")
        .map(|place| format!(" ({place})"))
        .unwrap_or_default();
    let call = request.name();
    Error::custom(match (text("type"), request) {
        (Some(kind), _) => format!("`{name}` raised {kind} in `{call}`{message}{place}"),
        (None, Request::Make | Request::Load) => format!("`{name}` cannot be run{message}"),
        (None, _) => format!("`{name}` failed in `{call}`{message}"),
    })
}
