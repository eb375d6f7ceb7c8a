// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! Facets, vertices and ridges live in arenas and name each other by index. Slot 0 of facets and of
//! vertices is the end of their list, so index 0 also stands for "none": reading it is harmless.

/// No facet, vertex or ridge.
pub(super) const NONE: u32 = 0;

/// A set of indices whose order matters: up to four are held inline.
#[derive(Clone, Debug, Default)]
pub(super) struct Set {
    len: u32,
    inline: [u32; INLINE],
    heap: Vec<u32>,
}

const INLINE: usize = 4;

impl Set {
    pub(super) fn of(items: &[u32]) -> Self {
        let mut set = Self::default();
        for &item in items {
            set.push(item);
        }
        set
    }

    #[inline(always)]
    pub(super) fn as_slice(&self) -> &[u32] {
        if self.len as usize <= INLINE {
            &self.inline[..self.len as usize]
        } else {
            &self.heap
        }
    }

    fn as_mut_slice(&mut self) -> &mut [u32] {
        if self.len as usize <= INLINE {
            &mut self.inline[..self.len as usize]
        } else {
            &mut self.heap
        }
    }

    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.len as usize
    }

    pub(super) fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Item `i`, or none.
    #[inline(always)]
    pub(super) fn get(&self, i: usize) -> u32 {
        self.as_slice().get(i).copied().unwrap_or(NONE)
    }

    pub(super) fn set(&mut self, i: usize, item: u32) {
        if let Some(place) = self.as_mut_slice().get_mut(i) {
            *place = item;
        }
    }

    pub(super) fn position(&self, item: u32) -> Option<usize> {
        self.as_slice().iter().position(|&other| other == item)
    }

    pub(super) fn contains(&self, item: u32) -> bool {
        self.position(item).is_some()
    }

    pub(super) fn push(&mut self, item: u32) {
        let len = self.len as usize;
        if len < INLINE {
            self.inline[len] = item;
        } else {
            if len == INLINE {
                self.heap.clear();
                self.heap.extend_from_slice(&self.inline);
            }
            self.heap.push(item);
        }
        self.len += 1;
    }

    fn shrink(&mut self) {
        self.len -= 1;
        if self.len as usize == INLINE {
            self.inline.copy_from_slice(&self.heap[..INLINE]);
            self.heap.clear();
        } else if self.len as usize > INLINE {
            self.heap.pop();
        }
    }

    /// Removes the item at `i`; the last takes its place.
    pub(super) fn delete_at(&mut self, i: usize) {
        let len = self.len();
        if i < len {
            self.as_mut_slice().swap(i, len - 1);
            self.shrink();
        }
    }

    /// Removes `item`; the last takes its place.
    pub(super) fn delete(&mut self, item: u32) {
        if let Some(i) = self.position(item) {
            self.delete_at(i);
        }
    }

    /// Removes the item at `i` and keeps the order.
    pub(super) fn delete_sorted_at(&mut self, i: usize) {
        if i < self.len() {
            self.as_mut_slice()[i..].rotate_left(1);
            self.shrink();
        }
    }

    /// Removes `item` and keeps the order.
    pub(super) fn delete_sorted(&mut self, item: u32) {
        if let Some(i) = self.position(item) {
            self.delete_sorted_at(i);
        }
    }

    /// Inserts `item` before the one at `i`.
    pub(super) fn insert(&mut self, i: usize, item: u32) {
        self.push(item);
        self.as_mut_slice()[i..].rotate_right(1);
    }

    /// Puts `new` in the place of `old`; false if `old` is absent.
    pub(super) fn replace(&mut self, old: u32, new: u32) -> bool {
        match self.position(old) {
            Some(i) => {
                self.set(i, new);
                true
            }
            None => false,
        }
    }

    /// Keeps the items that satisfy `keep`, in order.
    pub(super) fn retain(&mut self, mut keep: impl FnMut(u32) -> bool) {
        let kept: Vec<u32> = self
            .as_slice()
            .iter()
            .copied()
            .filter(|&item| keep(item))
            .collect();
        if kept.len() < self.len() {
            *self = Self::of(&kept);
        }
    }

    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }
}

/// What searches read of a facet, apart from the rest for the cache's sake.
#[derive(Clone, Debug, Default)]
pub(super) struct Plane {
    pub(super) normal: [f64; 3],
    pub(super) offset: f64,
    pub(super) next: u32,
    pub(super) previous: u32,
    /// The search that came here last.
    pub(super) visit: u32,
    /// The interior point is not below the plane.
    pub(super) flipped: bool,
    /// Made or changed by the point that is being added.
    pub(super) new: bool,
    /// Seen by the point that is being added, or merged into another: deleted soon.
    pub(super) visible: bool,
}

/// A facet: a triangle, or a polygon that merges made, with the points that it has in charge.
#[derive(Clone, Debug, Default)]
pub(super) struct Facet {
    /// By descending index. In a triangle, neighbour `i` is opposite vertex `i`.
    pub(super) vertices: Set,
    pub(super) neighbors: Set,
    pub(super) ridges: Set,
    /// Points above, the furthest last.
    pub(super) outside: Vec<u32>,
    /// Points near the plane, the furthest last.
    pub(super) coplanar: Vec<u32>,
    pub(super) furthest: f64,
    pub(super) max_outside: f64,
    pub(super) centrum: Option<[f64; 3]>,
    /// The facet that took over, when this one is visible.
    pub(super) replace: u32,
    pub(super) merges: u16,
    /// Whether the set of ridges exists: an emptied set is not an absent one.
    pub(super) has_ridges: bool,
    pub(super) has_plane: bool,
    /// Whether the triangle's vertices, in order, are seen clockwise from outside.
    pub(super) top_oriented: bool,
    pub(super) simplicial: bool,
    pub(super) seen: bool,
    pub(super) tested: bool,
    pub(super) new_merge: bool,
    pub(super) merge_horizon: bool,
    pub(super) coplanar_horizon: bool,
    pub(super) keep_centrum: bool,
    pub(super) degenerate: bool,
    pub(super) redundant: bool,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Vertex {
    pub(super) point: u32,
    pub(super) next: u32,
    pub(super) previous: u32,
    pub(super) visit: u32,
    /// Facets, from the first merge on.
    pub(super) neighbors: Set,
    pub(super) new: bool,
    pub(super) seen: bool,
    pub(super) deleted: bool,
    pub(super) partitioned: bool,
    /// A ridge at this vertex was deleted: it may be renamed.
    pub(super) lost_ridge: bool,
    pub(super) waiting: Waiting,
}

/// The facet of a cone that waits for its neighbour along the edge from the apex to a vertex, and
/// the index of that neighbour.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Waiting {
    pub(super) cone: u32,
    pub(super) facet: u32,
    pub(super) skip: usize,
}

/// An edge of a facet that is not a triangle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ridge {
    /// By descending index.
    pub(super) vertices: [u32; 2],
    pub(super) top: u32,
    pub(super) bottom: u32,
    pub(super) tested: bool,
    pub(super) nonconvex: bool,
}

impl Ridge {
    /// The facet on the other side of `facet`.
    #[inline]
    pub(super) fn other(&self, facet: u32) -> u32 {
        if self.top == facet {
            self.bottom
        } else {
            self.top
        }
    }

    pub(super) fn has(&self, vertex: u32) -> bool {
        self.vertices[0] == vertex || self.vertices[1] == vertex
    }

    /// The end that is not `vertex`.
    pub(super) fn other_vertex(&self, vertex: u32) -> u32 {
        if self.vertices[0] == vertex {
            self.vertices[1]
        } else {
            self.vertices[0]
        }
    }
}
