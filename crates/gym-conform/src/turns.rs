//! Turns of the threads that check environments.

use std::sync::{Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Lets only some of many threads work at a time. A thread that sleeps lets another one work.
pub(crate) struct Turns {
    free: Mutex<usize>,
    freed: Condvar,
}

impl Turns {
    /// Lets `threads` threads work at a time.
    pub(crate) fn new(threads: usize) -> Self {
        Self {
            free: Mutex::new(threads),
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
        self.begin();
        let _turn = Turn(self);
        work()
    }

    /// Sleeps within a turn, which another thread has meanwhile.
    pub(crate) fn sleep(&self, time: Duration) {
        self.end();
        thread::sleep(time);
        self.begin();
    }

    fn begin(&self) {
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.freed.wait_while(free, |free| *free == 0);
        *waited.unwrap_or_else(PoisonError::into_inner) -= 1;
    }

    fn end(&self) {
        *self.free.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        self.freed.notify_one();
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
}
