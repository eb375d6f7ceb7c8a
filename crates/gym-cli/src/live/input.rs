//! What a person does in a window.

use gym::canvas::Point;
use gym::render::{Pointer, Window};

/// The pointer and the keys since the last frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Input {
    pub(crate) pointer: Pointer,
    /// The pointer before.
    pub(crate) before: Pointer,
    /// The names of the keys that went down.
    pub(crate) keys: Vec<String>,
    /// The names of the keys that are down.
    pub(crate) held: Vec<String>,
}

impl Input {
    /// The input of the next frame of a window.
    pub(crate) fn next(&mut self, window: &mut Window) {
        let held = window.keys();
        self.follow(window.pointer(), held);
    }

    /// The input of the next frame.
    pub(crate) fn follow(&mut self, pointer: Pointer, held: Vec<String>) {
        self.before = std::mem::replace(&mut self.pointer, pointer);
        let new = held.iter().filter(|key| !self.held.contains(key));
        self.keys = new.cloned().collect();
        self.held = held;
    }

    /// Whether a button went down: the left, the middle or the right one.
    pub(crate) fn presses(&self, button: impl Fn(&Pointer) -> bool) -> bool {
        button(&self.pointer) && !button(&self.before)
    }

    /// Whether a key is down.
    pub(crate) fn holds(&self, name: &str) -> bool {
        self.held.iter().any(|key| key.ends_with(name))
    }

    /// How far the pointer moved.
    pub(crate) fn moved(&self) -> Point {
        let [x, y] = self.pointer.at;
        [x - self.before.at[0], y - self.before.at[1]]
    }
}
