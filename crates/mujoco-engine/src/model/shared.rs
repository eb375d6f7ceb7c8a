//! Large parts of a model that its copies share.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A part of a model that its copies share. Changing it makes a copy of it.
#[derive(Clone, Debug, Default)]
pub struct Shared<T> {
    part: Arc<T>,
    /// Whether the part was checked, and did not change since. A check may take long, and tasks change
    /// other figures of a model in each episode.
    checked: bool,
}

impl<T> Shared<T> {
    pub(crate) fn is_checked(&self) -> bool {
        self.checked
    }

    pub(crate) fn mark_checked(&mut self) {
        self.checked = true;
    }
}

impl<T> Deref for Shared<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.part
    }
}

impl<T: Clone> DerefMut for Shared<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.checked = false;
        Arc::make_mut(&mut self.part)
    }
}

impl<T: PartialEq> PartialEq for Shared<T> {
    fn eq(&self, other: &Self) -> bool {
        self.part == other.part
    }
}

impl<T: Serialize> Serialize for Shared<T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.part.as_ref().serialize(to)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Shared<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        T::deserialize(from).map(|part| Self {
            part: Arc::new(part),
            checked: false,
        })
    }
}
