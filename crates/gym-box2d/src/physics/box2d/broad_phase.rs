//! Finds the pairs of fixtures that may touch. A fixture's broad-phase box has a margin, so that
//! small motions change no pair.
//!
//! Box2D searches a tree of the boxes, this module all boxes in turn. Both sort the pairs by the
//! proxies' ids, so the contacts and their order are the same.

use serde::{Deserialize, Serialize};

use super::math::{Vec2, vec2};
use super::settings::{AABB_EXTENSION, AABB_MULTIPLIER};
use super::shape::Aabb;
use super::terrain::Terrain;

/// The broad-phase box of one fixture.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Proxy {
    fat: Aabb,
    fixture: u32,
    /// A pair needs at least one dynamic proxy.
    dynamic: bool,
    used: bool,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct BroadPhase {
    /// All proxies outside the terrain, in the order of their ids.
    proxies: Vec<Proxy>,
    /// The terrain; each of its edges has a proxy id too.
    pub(crate) terrain: Terrain,
    /// Ids to reuse, the last freed first.
    free: Vec<u32>,
    /// Proxies whose pairs the next search looks for.
    moved: Vec<u32>,
}

impl BroadPhase {
    /// Inserts terrain into a world without terrain.
    pub(crate) fn insert_terrain(&mut self, points: &[Vec2], friction: f32) {
        self.terrain = Terrain::new(points.to_vec(), friction, self.proxies.len() as u32);
        self.moved.clear();
        self.moved.extend(
            (0..)
                .zip(&self.proxies)
                .filter(|(_, proxy)| proxy.used)
                .map(|(id, _)| id),
        );
    }

    /// Inserts a proxy and returns its id.
    pub(crate) fn insert(&mut self, aabb: &Aabb, fixture: u32, dynamic: bool) -> u32 {
        let r = vec2(AABB_EXTENSION, AABB_EXTENSION);
        let fat = Aabb {
            lower: aabb.lower - r,
            upper: aabb.upper + r,
        };
        let proxy = Proxy {
            fat,
            fixture,
            dynamic,
            used: true,
        };
        let id = if let Some(id) = self.free.pop() {
            let place = self.place(id);
            self.proxies[place] = proxy;
            id
        } else {
            self.proxies.push(proxy);
            self.id(self.proxies.len() - 1)
        };
        self.moved.push(id);
        id
    }

    /// Returns the index in `proxies` of the proxy `id`, which must be outside the terrain.
    #[inline]
    fn place(&self, id: u32) -> usize {
        let id = id as usize;
        if id < self.terrain.first as usize {
            id
        } else {
            id.wrapping_sub(self.terrain.len())
        }
    }

    /// Returns the id of the proxy at the index `place`.
    #[inline]
    fn id(&self, place: usize) -> u32 {
        let behind = place >= self.terrain.first as usize;
        (if behind {
            place + self.terrain.len()
        } else {
            place
        }) as u32
    }

    pub(crate) fn remove(&mut self, id: u32) {
        let place = self.place(id);
        self.proxies[place].used = false;
        self.moved.retain(|moved| *moved != id);
        self.free.push(id);
    }

    /// Updates the enlarged box of a proxy after its fixture moved by `displacement`. `aabb`
    /// contains the fixture before and after the motion. An enlarged box that contains `aabb` does
    /// not change.
    pub(crate) fn update(&mut self, id: u32, aabb: &Aabb, displacement: Vec2) {
        let place = self.place(id);
        let fat = &mut self.proxies[place].fat;
        if fat.contains(aabb) {
            return;
        }
        let r = vec2(AABB_EXTENSION, AABB_EXTENSION);
        *fat = Aabb {
            lower: aabb.lower - r,
            upper: aabb.upper + r,
        };
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
    pub(crate) fn fat(&self, id: u32) -> Aabb {
        match self.terrain.edge_of(id) {
            Some(edge) => self.terrain.edge_box(edge),
            None => self.proxies[self.place(id)].fat,
        }
    }

    #[inline]
    pub(crate) fn overlap(&self, a: u32, b: u32) -> bool {
        self.fat(a).overlaps(&self.fat(b))
    }

    /// Whether a proxy has moved since the last call of [`find_pairs`](Self::find_pairs).
    pub(crate) fn has_moved(&self) -> bool {
        !self.moved.is_empty()
    }

    /// Fills `pairs` with the pairs of overlapping proxies of which at least one has moved. Each
    /// pair has the smaller id first.
    pub(crate) fn find_pairs(&mut self, pairs: &mut Vec<(u32, u32)>) {
        pairs.clear();
        for &id in &self.moved {
            let query = self.proxies[self.place(id)];
            let mut pair = |other: u32| pairs.push((id.min(other), id.max(other)));
            for (place, proxy) in self.proxies.iter().enumerate() {
                if proxy.fat.overlaps(&query.fat) && (proxy.dynamic || query.dynamic) && proxy.used
                {
                    let other = self.id(place);
                    if other != id {
                        pair(other);
                    }
                }
            }
            if query.dynamic {
                self.terrain
                    .query(&query.fat, |edge| pair(self.terrain.first + edge as u32));
            }
        }
        self.moved.clear();
        pairs.sort_unstable();
        pairs.dedup();
    }

    /// Returns the allocated bytes.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        let lists = size_of::<u32>() * (self.free.capacity() + self.moved.capacity());
        lists + size_of::<Proxy>() * self.proxies.capacity() + self.terrain.bytes()
    }

    /// Reads one number of each box, to prefetch it.
    pub(crate) fn prefetch(&self) -> u32 {
        self.proxies
            .iter()
            .fold(self.terrain.prefetch(), |seen, proxy| seen ^ proxy.fixture)
    }

    /// Returns the fixture of the proxy `id`, which must be outside the terrain.
    pub(crate) fn fixture(&self, id: u32) -> u32 {
        self.proxies[self.place(id)].fixture
    }

    /// Whether the proxy `id` exists and belongs to `fixture`. A proxy of the terrain belongs to
    /// any fixture.
    pub(crate) fn holds(&self, id: u32, fixture: u32) -> bool {
        self.terrain.edge_of(id).is_some()
            || self
                .proxies
                .get(self.place(id))
                .is_some_and(|proxy| proxy.used && proxy.fixture == fixture)
    }

    /// Iterates over the fixtures whose box overlaps `aabb`, except the terrain's.
    pub(crate) fn query(&self, aabb: Aabb) -> impl Iterator<Item = u32> {
        let hit = move |proxy: &&Proxy| proxy.fat.overlaps(&aabb) && proxy.used;
        self.proxies.iter().filter(hit).map(|proxy| proxy.fixture)
    }

    /// Whether deserialized data is consistent. `owns(fixture, id)` tells whether the fixture has
    /// that proxy.
    pub(crate) fn is_valid(&self, owns: impl Fn(u32, u32) -> bool) -> bool {
        let proxy = |id: &u32| {
            let proxy = self.proxies.get(self.place(*id));
            proxy.filter(|_| self.terrain.edge_of(*id).is_none())
        };
        self.terrain.is_valid()
            && self.terrain.first as usize <= self.proxies.len()
            && self.moved.iter().all(|id| proxy(id).is_some())
            && self
                .free
                .iter()
                .all(|id| proxy(id).is_some_and(|proxy| !proxy.used))
            && (self.proxies.iter().enumerate())
                .all(|(place, proxy)| !proxy.used || owns(proxy.fixture, self.id(place)))
    }
}
