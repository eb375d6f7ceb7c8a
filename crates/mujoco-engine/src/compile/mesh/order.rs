//! The order in which libmujoco goes through the polygons of a mesh: that of a hash map of libc++
//! (LLVM 20), with which its wheels for Linux are built. The order is a fact of the bits of the
//! keys and of how the map grows (`__hash_table` in libc++).

use crate::Revision;

/// The hash of a pair of numbers in libmujoco: the bits of both (a zero has none), mixed by
/// exclusive or, in 4.0 as in Boost's `hash_combine` (found by experiment).
pub(super) fn hash(first: f64, second: f64, revision: Revision) -> u64 {
    let bits = |x: f64| if x == 0.0 { 0 } else { x.to_bits() };
    let (first, second) = (bits(first), bits(second));
    if revision.mixes_hashes() {
        first
            ^ second
                .wrapping_add(0x9e37_79b9)
                .wrapping_add(first << 6)
                .wrapping_add(first >> 2)
    } else {
        first ^ second
    }
}

/// The order of iteration after keys with these hashes were inserted one by one.
pub(super) fn iteration(hashes: &[u64]) -> Vec<usize> {
    let mut table = Table {
        next: vec![END],
        ..Table::default()
    };
    for &hash in hashes {
        table.insert(hash);
    }
    let mut order = Vec::with_capacity(hashes.len());
    let mut node = table.next[0];
    while node != END {
        order.push(node - 1);
        node = table.next[node];
    }
    order
}

const END: usize = usize::MAX;

/// A chain of all nodes, in which those of a bucket are neighbours. Node 0 is the head; bucket `b`
/// starts after node `buckets[b]`.
#[derive(Debug, Default)]
struct Table {
    next: Vec<usize>,
    hashes: Vec<u64>,
    buckets: Vec<usize>,
}

impl Table {
    fn bucket(&self, node: usize) -> usize {
        let (hash, count) = (self.hashes[node - 1], self.buckets.len() as u64);
        if count.is_power_of_two() {
            (hash & (count - 1)) as usize
        } else {
            (hash % count) as usize
        }
    }

    fn insert(&mut self, hash: u64) {
        let count = self.buckets.len();
        let size = self.hashes.len() + 1;
        if size > count {
            let power = count > 2 && count.is_power_of_two();
            self.grow((2 * count + usize::from(!power)).max(size));
        }
        self.hashes.push(hash);
        let node = self.hashes.len();
        let bucket = self.bucket(node);
        if self.buckets[bucket] == END {
            let first = self.next[0];
            self.next.push(first);
            self.next[0] = node;
            self.buckets[bucket] = 0;
            if first != END {
                let bucket = self.bucket(first);
                self.buckets[bucket] = node;
            }
        } else {
            let before = self.buckets[bucket];
            self.next.push(self.next[before]);
            self.next[before] = node;
        }
    }

    fn grow(&mut self, count: usize) {
        let count = match count {
            1 => 2,
            count if count.is_power_of_two() => count,
            count => (count..).find(|&n| is_prime(n)).unwrap_or(count),
        };
        self.buckets = vec![END; count];
        let mut previous = self.next[0];
        if previous == END {
            return;
        }
        let mut last = self.bucket(previous);
        self.buckets[last] = 0;
        while self.next[previous] != END {
            let node = self.next[previous];
            let bucket = self.bucket(node);
            if bucket == last {
                previous = node;
            } else if self.buckets[bucket] == END {
                self.buckets[bucket] = previous;
                previous = node;
                last = bucket;
            } else {
                self.next[previous] = self.next[node];
                let before = self.buckets[bucket];
                self.next[node] = self.next[before];
                self.next[before] = node;
            }
        }
    }
}

fn is_prime(n: usize) -> bool {
    n >= 2
        && (2..)
            .take_while(|d| d * d <= n)
            .all(|d| !n.is_multiple_of(d))
}
