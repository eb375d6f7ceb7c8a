//! The stack of transforms that every canvas keeps.

use gym_core::canvas::Transform;

/// The stack of the transforms between `push` and `pop`. Each entry is composed with all entries
/// below it.
#[derive(Clone, Debug)]
pub(crate) struct Transforms {
    current: Transform,
    outer: Vec<Transform>,
}

impl Transforms {
    /// Makes an empty stack.
    pub(crate) const fn new() -> Self {
        Self {
            current: Transform::IDENTITY,
            outer: Vec::new(),
        }
    }

    /// Empties the stack and starts with `base`.
    pub(crate) fn restart(&mut self, base: Transform) {
        self.current = base;
        self.outer.clear();
    }

    /// Returns the transform from the coordinates of the current drawing to the coordinates of the
    /// canvas.
    pub(crate) fn current(&self) -> Transform {
        self.current
    }

    pub(crate) fn push(&mut self, inner: Transform) {
        self.outer.push(self.current);
        self.current = self.current.then(inner);
    }

    /// Replaces the current transform by `transform` until the matching `pop`.
    pub(crate) fn push_anew(&mut self, transform: Transform) {
        self.outer.push(self.current);
        self.current = transform;
    }

    /// Returns the number of transforms that were pushed and not yet popped.
    pub(crate) fn depth(&self) -> usize {
        self.outer.len()
    }

    /// Applies `outer` after all transforms from `depth` on.
    pub(crate) fn rebase(&mut self, depth: usize, outer: Transform) {
        for transform in self.outer.iter_mut().skip(depth).chain([&mut self.current]) {
            *transform = outer.then(*transform);
        }
    }

    /// Undoes the last push; does nothing on an empty stack.
    pub(crate) fn pop(&mut self) {
        if let Some(outer) = self.outer.pop() {
            self.current = outer;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn push_composes_and_pop_restores() {
        let mut transforms = Transforms::new();
        transforms.restart(Transform::scale(2.0, 2.0));
        transforms.push(Transform::translate(10.0, 0.0));
        transforms.push(Transform::scale(3.0, 1.0));
        assert_eq!(transforms.current().apply([1.0, 1.0]), [26.0, 2.0]);
        transforms.pop();
        assert_eq!(transforms.current().apply([1.0, 1.0]), [22.0, 2.0]);
        transforms.pop();
        transforms.pop();
        assert_eq!(transforms.current(), Transform::scale(2.0, 2.0));
    }
}
