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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_of_a_panic_is_told() {
        let told = |f: fn()| {
            let result = contained(" on the way", || {
                f();
                Ok(())
            });
            result.unwrap_err().to_string()
        };
        for (f, words) in [
            (
                (|| panic!("a word")) as fn(),
                "it panicked on the way: a word",
            ),
            (
                || panic!("{} words", "two".to_owned()),
                "it panicked on the way: two words",
            ),
            (
                || std::panic::panic_any(3),
                "it panicked on the way: no message",
            ),
        ] {
            let told = told(f);
            assert!(told.contains(words), "{told}");
        }
        assert_eq!(contained("", || Ok(3)).unwrap(), 3);
        let refused = contained("", || -> Result<()> { Err(Error::custom("no")) });
        assert_eq!(refused.unwrap_err().to_string(), "no");
    }

    #[test]
    fn what_panics_while_it_is_dropped_is_dropped_once() {
        struct Bomb<'a>(&'a std::sync::atomic::AtomicU32);
        impl Drop for Bomb<'_> {
            fn drop(&mut self) {
                self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                panic!("on purpose");
            }
        }
        let dropped = std::sync::atomic::AtomicU32::new(0);
        drop(Held::new(Bomb(&dropped)));
        assert_eq!(dropped.into_inner(), 1);
    }
}
