//! A slab: values keep their index while others are inserted and removed.

use std::ops::{Index, IndexMut};

use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Arena<T> {
    slots: Vec<Option<T>>,
    free: Vec<u32>,
}

impl<T> Default for Arena<T> {
    fn default() -> Self {
        Self {
            slots: Vec::new(),
            free: Vec::new(),
        }
    }
}

impl<T> Arena<T> {
    pub(crate) fn insert(&mut self, value: T) -> u32 {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.slots.push(None);
            self.slots.len() as u32 - 1
        });
        self.slots[slot as usize] = Some(value);
        slot
    }

    /// Reserves space for `more` further values.
    pub(crate) fn reserve(&mut self, more: usize) {
        self.slots.reserve_exact(more);
        self.free.reserve_exact(more);
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        if self.slots[slot as usize].take().is_some() {
            self.free.push(slot);
        }
    }

    pub(crate) fn get(&self, slot: u32) -> Option<&T> {
        self.slots.get(slot as usize)?.as_ref()
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, &T)> {
        (0..)
            .zip(&self.slots)
            .filter_map(|(slot, value)| Some((slot, value.as_ref()?)))
    }

    /// Returns the allocated bytes.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Option<T>>() * self.slots.capacity() + size_of::<u32>() * self.free.capacity()
    }

    /// Whether deserialized data is consistent: the free list holds exactly the empty slots.
    pub(crate) fn is_valid(&self) -> bool {
        let mut empty: Vec<bool> = self.slots.iter().map(Option::is_none).collect();
        self.free
            .iter()
            .all(|slot| empty.get_mut(*slot as usize).is_some_and(std::mem::take))
            && !empty.contains(&true)
    }
}

impl<T> Index<u32> for Arena<T> {
    type Output = T;

    #[inline]
    fn index(&self, slot: u32) -> &T {
        self.slots[slot as usize]
            .as_ref()
            .expect("the body, fixture or joint was destroyed")
    }
}

impl<T> IndexMut<u32> for Arena<T> {
    #[inline]
    fn index_mut(&mut self, slot: u32) -> &mut T {
        self.slots[slot as usize]
            .as_mut()
            .expect("the body, fixture or joint was destroyed")
    }
}
