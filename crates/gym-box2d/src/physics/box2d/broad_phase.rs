//! Which fixtures may touch: a box around each, with a margin, so that most motion changes nothing.
//!
//! Box2D keeps the boxes in a tree. The pairs that come out are sorted by the proxies' ids before
//! they are used, so a plain search through all boxes gives the same contacts in the same order.

use serde::{Deserialize, Serialize};

use super::math::{Vec2, vec2};
use super::settings::{AABB_EXTENSION, AABB_MULTIPLIER};
use super::shape::Aabb;
use super::terrain::Terrain;

/// The box of one fixture.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Proxy {
    fat: Aabb,
    fixture: u32,
    /// Two proxies that do not move make no pair.
    dynamic: bool,
    used: bool,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct BroadPhase {
    /// All but those of the terrain, in the order of their ids.
    proxies: Vec<Proxy>,
    /// Its edges have ids like any proxy.
    pub(crate) terrain: Terrain,
    /// Ids to use again, the last one freed first.
    free: Vec<u32>,
    /// Proxies whose pairs are to be searched.
    moved: Vec<u32>,
}

impl BroadPhase {
    /// Puts terrain into a world that has none.
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

    /// A new proxy, and its id.
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

    /// The place of a proxy outside the terrain.
    #[inline]
    fn place(&self, id: u32) -> usize {
        let id = id as usize;
        if id < self.terrain.first as usize {
            id
        } else {
            id.wrapping_sub(self.terrain.len())
        }
    }

    /// The id of the proxy at a place.
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

    /// Follows a fixture that moved by `displacement` within `aabb`; a box that still holds it
    /// stays as it is.
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

    /// Whether any proxy has moved since the last call of [`find_pairs`](Self::find_pairs).
    pub(crate) fn has_moved(&self) -> bool {
        !self.moved.is_empty()
    }

    /// Leaves in `pairs` the ids, smaller first, of the proxies that overlap one that has moved.
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

    /// Its memory, on the heap.
    #[cfg(test)]
    pub(crate) fn bytes(&self) -> usize {
        let lists = size_of::<u32>() * (self.free.capacity() + self.moved.capacity());
        lists + size_of::<Proxy>() * self.proxies.capacity() + self.terrain.bytes()
    }

    /// Reads a number of each box, so that it is fetched.
    pub(crate) fn touch(&self) -> u32 {
        self.proxies
            .iter()
            .fold(self.terrain.touch(), |seen, proxy| seen ^ proxy.fixture)
    }

    /// The fixture of a proxy that is not of the terrain.
    pub(crate) fn fixture(&self, id: u32) -> u32 {
        self.proxies[self.place(id)].fixture
    }

    /// Whether a proxy exists and belongs to a fixture; any fixture may stand for an edge of the
    /// terrain.
    pub(crate) fn holds(&self, id: u32, fixture: u32) -> bool {
        self.terrain.edge_of(id).is_some()
            || self
                .proxies
                .get(self.place(id))
                .is_some_and(|proxy| proxy.used && proxy.fixture == fixture)
    }

    /// The fixtures whose box meets `aabb`, but for the terrain.
    pub(crate) fn query(&self, aabb: Aabb) -> impl Iterator<Item = u32> {
        let hit = move |proxy: &&Proxy| proxy.fat.overlaps(&aabb) && proxy.used;
        self.proxies.iter().filter(hit).map(|proxy| proxy.fixture)
    }

    /// Whether data read from outside is consistent; `owns` tells whether a fixture has a proxy.
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
