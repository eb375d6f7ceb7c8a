//! Large parts of a model that its copies share.

use std::ops::{Deref, DerefMut};
use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Meshes;
use super::layout::{Layout, layouts};
use super::triangles::Triangles;

/// A part of a model that its copies share. Changing it makes a copy of it.
#[derive(Clone, Debug, Default)]
pub struct Shared<T> {
    part: Arc<Part<T>>,
    /// Whether the part was checked, and did not change since. A check may take long, and tasks change
    /// other figures of a model in each episode.
    checked: bool,
}

/// A part, and what follows from it.
#[derive(Clone, Debug, Default)]
struct Part<T> {
    figures: T,
    layouts: OnceLock<Vec<Layout>>,
}

impl<T> From<T> for Part<T> {
    fn from(figures: T) -> Self {
        Self {
            figures,
            layouts: OnceLock::new(),
        }
    }
}

impl Shared<Meshes> {
    /// The meshes, laid out for searches. The first call computes them.
    pub(crate) fn layouts(&self) -> &[Layout] {
        let layouts = || layouts(&self.part.figures);
        self.part.layouts.get_or_init(layouts)
    }

    /// The triangles of a mesh, in a tree. The first call for a mesh computes it.
    pub(crate) fn triangles(&self, mesh: usize) -> &Triangles {
        let triangles = || Triangles::new(&self.part.figures, mesh);
        self.layouts()[mesh].triangles.get_or_init(triangles)
    }
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
        &self.part.figures
    }
}

impl<T: Clone> DerefMut for Shared<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.checked = false;
        let part = Arc::make_mut(&mut self.part);
        part.layouts = OnceLock::new();
        &mut part.figures
    }
}

impl<T: PartialEq> PartialEq for Shared<T> {
    fn eq(&self, other: &Self) -> bool {
        self.part.figures == other.part.figures
    }
}

impl<T: Serialize> Serialize for Shared<T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.part.figures.serialize(to)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Shared<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        T::deserialize(from).map(|part| Self {
            part: Arc::new(part.into()),
            checked: false,
        })
    }
}
