//! Panics of sub-environments, as errors: one faulty environment must not take the program with it.

use std::any::Any;
use std::ops::{Deref, DerefMut};
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::value::{Error, Result};

/// Calls `f`, and turns its panic into an error, whose advice is `then`.
pub(super) fn contained<R>(then: &str, f: impl FnOnce() -> Result<R>) -> Result<R> {
    catch_unwind(AssertUnwindSafe(f)).unwrap_or_else(|panic| {
        Err(Error::Contract(format!(
            "it panicked{then}: {}",
            message(&*panic)
        )))
    })
}

/// The message of a panic.
fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no message")
}

/// A sub-environment whose panic while it is dropped is a warning.
#[derive(Debug)]
pub(super) struct Held<E>(Option<E>);

impl<E> Held<E> {
    pub(super) fn new(env: E) -> Self {
        Self(Some(env))
    }
}

impl<E> Deref for Held<E> {
    type Target = E;

    #[inline]
    fn deref(&self) -> &E {
        self.0.as_ref().expect("only `drop` takes it")
    }
}

impl<E> DerefMut for Held<E> {
    #[inline]
    fn deref_mut(&mut self) -> &mut E {
        self.0.as_mut().expect("only `drop` takes it")
    }
}

impl<E> Drop for Held<E> {
    fn drop(&mut self) {
        let dropped = contained(" while it was dropped", || {
            self.0 = None;
            Ok(())
        });
        if let Err(error) = dropped {
            log::warn!("a sub-environment: {error}");
        }
    }
}
