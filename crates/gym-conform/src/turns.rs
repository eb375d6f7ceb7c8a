//! Turns of the threads that check environments.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Lets only some of many threads work at a time. A thread that sleeps lets another one work.
pub(crate) struct Turns {
    /// Below zero if threads go on after they slept, although others have all turns.
    free: Mutex<isize>,
    freed: Condvar,
}

impl Turns {
    /// Lets `threads` threads work at a time.
    pub(crate) fn new(threads: usize) -> Self {
        Self {
            free: Mutex::new(threads.cast_signed()),
            freed: Condvar::new(),
        }
    }

    /// Waits for a turn, then does `work`.
    pub(crate) fn take<R>(&self, work: impl FnOnce() -> R) -> R {
        /// Ends the turn, even if `work` panics.
        struct Turn<'a>(&'a Turns);
        impl Drop for Turn<'_> {
            fn drop(&mut self) {
                self.0.end();
            }
        }
        let free = self.lock();
        let waited = self.freed.wait_while(free, |free| *free <= 0);
        *waited.unwrap_or_else(PoisonError::into_inner) -= 1;
        let _turn = Turn(self);
        work()
    }

    /// Sleeps within a turn, which another thread has meanwhile. Does not wait for a turn
    /// afterwards, so that the check takes no longer than it sleeps.
    pub(crate) fn sleep(&self, time: Duration) {
        self.end();
        thread::sleep(time);
        *self.lock() -= 1;
    }

    fn end(&self) {
        *self.lock() += 1;
        self.freed.notify_one();
    }

    fn lock(&self) -> MutexGuard<'_, isize> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn only_as_many_threads_work_as_have_turns() {
        let (turns, working, most) = (Turns::new(2), AtomicUsize::new(0), AtomicUsize::new(0));
        thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    turns.take(|| {
                        let now = working.fetch_add(1, Ordering::SeqCst) + 1;
                        most.fetch_max(now, Ordering::SeqCst);
                        // long enough for all threads to begin that may
                        thread::sleep(Duration::from_millis(5));
                        working.fetch_sub(1, Ordering::SeqCst);
                        turns.sleep(Duration::from_millis(1));
                    });
                });
            }
        });
        assert!((1..=2).contains(&most.load(Ordering::SeqCst)));
        // a thread that panics ends its turn
        let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            turns.take(|| panic!("a fault"));
        }));
        assert!(panicked.is_err());
        turns.take(|| turns.take(|| ()));
    }

    #[test]
    fn a_thread_that_slept_goes_on_at_once() {
        let turns = Turns::new(1);
        let (slept, has_slept) = std::sync::mpsc::channel();
        thread::scope(|scope| {
            turns.take(|| {
                // has the only turn until the first thread goes on
                scope.spawn(|| turns.take(move || has_slept.recv()));
                turns.sleep(Duration::from_millis(20));
                slept.send(()).unwrap();
            });
        });
    }
}
