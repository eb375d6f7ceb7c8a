//! Which fixtures may touch: a box around each, with a margin, so that most motion changes nothing.
//!
//! Box2D keeps the boxes in a tree. The pairs that come out are sorted by the proxies' ids before
//! they are used, so a plain search through all boxes gives the same contacts in the same order.

use serde::{Deserialize, Serialize};

use super::math::{Vec2, vec2};
use super::settings::{AABB_EXTENSION, AABB_MULTIPLIER};
use super::shape::Aabb;

/// The box of one fixture.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Proxy {
    fat: Aabb,
    fixture: u32,
    /// Two proxies that are not make no pair.
    dynamic: bool,
    used: bool,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct BroadPhase {
    proxies: Vec<Proxy>,
    /// Ids to use again, the last one freed first.
    free: Vec<u32>,
    /// Proxies whose pairs are to be searched.
    moved: Vec<u32>,
}

impl BroadPhase {
    /// A new proxy, and its id.
    pub(crate) fn insert(&mut self, aabb: &Aabb, fixture: u32, dynamic: bool) -> u32 {
        let r = vec2(AABB_EXTENSION, AABB_EXTENSION);
        let fat = Aabb { lower: aabb.lower - r, upper: aabb.upper + r };
        let proxy = Proxy { fat, fixture, dynamic, used: true };
        let id = if let Some(id) = self.free.pop() {
            self.proxies[id as usize] = proxy;
            id
        } else {
            self.proxies.push(proxy);
            self.proxies.len() as u32 - 1
        };
        self.moved.push(id);
        id
    }

    pub(crate) fn remove(&mut self, id: u32) {
        self.proxies[id as usize].used = false;
        self.moved.retain(|moved| *moved != id);
        self.free.push(id);
    }

    /// Follows a fixture that moved by `displacement` within `aabb`; a box that still holds it
    /// stays as it is.
    pub(crate) fn update(&mut self, id: u32, aabb: &Aabb, displacement: Vec2) {
        let fat = &mut self.proxies[id as usize].fat;
        if fat.contains(aabb) {
            return;
        }
        let r = vec2(AABB_EXTENSION, AABB_EXTENSION);
        *fat = Aabb { lower: aabb.lower - r, upper: aabb.upper + r };
        let ahead = AABB_MULTIPLIER * displacement;
        for axis in 0..2 {
            if ahead[axis] < 0.0 {
                fat.lower[axis] += ahead[axis];
            } else {
                fat.upper[axis] += ahead[axis];
            }
        }
        self.moved.push(id);
    }

    #[inline]
    pub(crate) fn overlap(&self, a: u32, b: u32) -> bool {
        self.proxies[a as usize].fat.overlaps(&self.proxies[b as usize].fat)
    }

    /// Whether any proxy has moved since the last call of [`find_pairs`](Self::find_pairs).
    pub(crate) fn has_moved(&self) -> bool {
        !self.moved.is_empty()
    }

    /// Leaves in `pairs` the ids, smaller first, of the proxies that overlap one that has moved.
    pub(crate) fn find_pairs(&mut self, pairs: &mut Vec<(u32, u32)>) {
        pairs.clear();
        for &id in &self.moved {
            let query = self.proxies[id as usize];
            for (other, proxy) in self.proxies.iter().enumerate() {
                if proxy.fat.overlaps(&query.fat)
                    && (proxy.dynamic || query.dynamic)
                    && proxy.used
                    && other as u32 != id
                {
                    pairs.push((id.min(other as u32), id.max(other as u32)));
                }
            }
        }
        self.moved.clear();
        pairs.sort_unstable();
        pairs.dedup();
    }

    /// The fixture of a proxy.
    pub(crate) fn fixture(&self, id: u32) -> u32 {
        self.proxies[id as usize].fixture
    }

    /// Whether there is such a proxy and it is that of a fixture.
    pub(crate) fn holds(&self, id: u32, fixture: u32) -> bool {
        self.proxies.get(id as usize).is_some_and(|proxy| proxy.used && proxy.fixture == fixture)
    }

    /// The fixtures whose box meets `aabb`.
    pub(crate) fn query(&self, aabb: Aabb) -> impl Iterator<Item = u32> {
        let hit = move |proxy: &&Proxy| proxy.fat.overlaps(&aabb) && proxy.used;
        self.proxies.iter().filter(hit).map(|proxy| proxy.fixture)
    }

    /// Whether what was read from outside can be worked with, for fixtures that `owns` tells to
    /// have the proxy.
    pub(crate) fn is_valid(&self, owns: impl Fn(u32, u32) -> bool) -> bool {
        let known = |id: &u32| (*id as usize) < self.proxies.len();
        self.free.iter().chain(&self.moved).all(known)
            && self.free.iter().all(|id| !self.proxies[*id as usize].used)
            && (self.proxies.iter().zip(0..)).all(|(proxy, id)| !proxy.used || owns(proxy.fixture, id))
    }
}
