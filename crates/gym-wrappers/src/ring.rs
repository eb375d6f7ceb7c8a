use gym_core::{Element, Error, Result, Space};
use serde_json::Value as Json;

use crate::within::element;

/// The last `n` observations, as a ring buffer.
#[derive(Clone, Debug)]
pub(crate) struct Ring<O> {
    items: Vec<O>,
    /// The index of the oldest observation.
    oldest: usize,
}

impl<O: Element> Ring<O> {
    /// Makes a ring of `n` copies of `item`; `None` if the copies do not fit in memory.
    pub(crate) fn new(n: usize, item: &O) -> Option<Self> {
        let mut items = Vec::new();
        items.try_reserve_exact(n).ok()?;
        items.resize(n, item.clone());
        Some(Self { items, oldest: 0 })
    }

    pub(crate) fn fill(&mut self, item: &O) {
        self.items.iter_mut().for_each(|slot| slot.clone_from(item));
    }

    /// Replaces the oldest observation by `item`, and returns the oldest in `item`.
    pub(crate) fn exchange(&mut self, item: &mut O) {
        if let Some(oldest) = self.items.get_mut(self.oldest) {
            std::mem::swap(oldest, item);
            self.oldest = if self.oldest + 1 == self.items.len() {
                0
            } else {
                self.oldest + 1
            };
        }
    }

    /// The observations, the oldest first.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &O> {
        let (newer, older) = self.items.split_at(self.oldest);
        older.iter().chain(newer)
    }

    /// The stored form of the observations, which are elements of `space`.
    pub(crate) fn to_json(&self, space: &Space) -> Result<Vec<Json>> {
        self.iter()
            .map(|item| space.to_json(&item.to_value()))
            .collect()
    }

    /// Reads a ring of the same length from the result of [`to_json`](Self::to_json).
    pub(crate) fn read(&self, space: &Space, stored: &[Json]) -> Result<Self> {
        if stored.len() != self.items.len() {
            let reason = format!(
                "it has {} observations, not {}",
                stored.len(),
                self.items.len()
            );
            return Err(Error::Snapshot(reason));
        }
        let items = stored
            .iter()
            .map(|json| element(space, json))
            .collect::<Result<_>>()?;
        Ok(Self { items, oldest: 0 })
    }
}
