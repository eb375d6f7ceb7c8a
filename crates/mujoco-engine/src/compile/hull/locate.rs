// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! Which facet a point is above (`qh_findbest`, `qh_findbestnew`, `qh_findbesthorizon` in
//! `geom_r.c` of Qhull).

use super::Builder;
use super::arena::NONE;
use super::constants::fmin;
use super::error::HullError;
use super::lists::NOWHERE;

/// Below every distance (`-REALmax/2`).
const FAR_BELOW: f64 = -f64::MAX / 2.0;

/// The facet that a point is furthest above, as far as a search found out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) facet: u32,
    pub(super) distance: f64,
    pub(super) outside: bool,
}

impl Builder<'_> {
    /// Searches uphill from `start`. With `exhaustive`, all facets near the best one, and never
    /// only the new ones.
    pub(super) fn find_best(
        &mut self,
        position: [f64; 3],
        start: u32,
        exhaustive: bool,
    ) -> Result<Found, HullError> {
        let only_new = !exhaustive;
        let min_outside = self.constants.min_outside;
        let mark = self.next_visit();
        let mut best = NONE;
        let mut best_distance = FAR_BELOW;
        if !self.planes[start as usize].flipped {
            let distance = self.planes[start as usize].distance(position);
            if !exhaustive && distance >= min_outside {
                return Ok(Found {
                    facet: start,
                    distance,
                    outside: true,
                });
            }
            (best, best_distance) = (start, distance);
        }
        self.planes[start as usize].visit = mark;
        let mut facet = start;
        while facet != NONE {
            let mut next = NONE;
            self.work += self.facets[facet as usize].neighbors.len() as u64;
            for &neighbor in self.facets[facet as usize].neighbors.as_slice() {
                let plane = &mut self.planes[neighbor as usize];
                if (only_new && !plane.new) || plane.visit == mark {
                    continue;
                }
                plane.visit = mark;
                if plane.flipped {
                    continue;
                }
                let distance = plane.distance(position);
                if distance > best_distance {
                    if !exhaustive && distance >= min_outside {
                        return Ok(Found {
                            facet: neighbor,
                            distance,
                            outside: true,
                        });
                    }
                    (best, best_distance) = (neighbor, distance);
                    next = neighbor;
                    break;
                }
            }
            facet = next;
        }
        let mut found = Found {
            facet: best,
            distance: best_distance,
            outside: true,
        };
        let mut wide = false;
        if only_new {
            if best == NONE {
                found = self.find_best_new(position, self.newfacet_list, exhaustive)?;
                wide = true;
            } else if !self.not_sharp && best_distance < -self.dist_round {
                if self.new_facets_are_sharp() {
                    found = self.find_best_new(position, best, exhaustive)?;
                    wide = true;
                    self.find_new = true;
                } else {
                    self.not_sharp = true;
                }
            }
        }
        if found.facet == NONE {
            return Err(HullError::Unsupported("a search among flipped facets"));
        }
        if !wide {
            (found.facet, found.distance) =
                self.find_best_horizon(position, found.facet, found.distance, false);
        }
        if found.distance < min_outside {
            found.outside = false;
        }
        Ok(found)
    }

    /// The best of the facets from `start` to the list's end and of the new ones before it. Unless
    /// `exhaustive`, the first that the point is clearly outside of.
    pub(super) fn find_best_new(
        &mut self,
        position: [f64; 3],
        start: u32,
        exhaustive: bool,
    ) -> Result<Found, HullError> {
        if start == NONE || start == NOWHERE {
            return Err(HullError::Inconsistent("no new facets"));
        }
        let enough = if exhaustive {
            f64::INFINITY
        } else {
            self.clearly_outside()
        };
        let mark = self.next_visit();
        let (mut best, mut best_distance) = (NONE, FAR_BELOW);
        for (first, end) in [(start, NONE), (self.first_new(), start)] {
            let mut facet = first;
            while facet != NONE && facet != end {
                let plane = &mut self.planes[facet as usize];
                plane.visit = mark;
                if !plane.flipped {
                    self.work += 1;
                    let distance = plane.distance(position);
                    if distance > best_distance {
                        best = facet;
                        if distance >= enough {
                            return Ok(Found {
                                facet,
                                distance,
                                outside: true,
                            });
                        }
                        best_distance = distance;
                    }
                }
                facet = plane.next;
            }
        }
        let from = if best == NONE { start } else { best };
        let (facet, distance) = self.find_best_horizon(position, from, best_distance, false);
        Ok(Found {
            facet,
            distance,
            outside: distance >= self.constants.min_outside,
        })
    }

    /// A better facet among those near the best one. `check` is the last check of all points, which
    /// also notes how far they are outside.
    pub(super) fn find_best_horizon(
        &mut self,
        position: [f64; 3],
        start: u32,
        distance: f64,
        check: bool,
    ) -> (u32, f64) {
        let (mut best, mut best_distance) = (start, distance);
        let mark = self.next_visit();
        if check {
            let facet = &mut self.facets[start as usize];
            if best_distance > facet.max_outside {
                facet.max_outside = best_distance;
            }
        }
        let search = self.search_distance();
        let mut least = best_distance - search;
        if check {
            least = fmin(least, -search);
        }
        self.planes[start as usize].visit = mark;
        let mut stack = std::mem::take(&mut self.stack);
        stack.clear();
        let mut facet = start;
        loop {
            let mut pending = NONE;
            let neighbors = self.facets[facet as usize].neighbors.len();
            self.work += neighbors as u64;
            let wide = check && self.facets[facet as usize].merges > 10 && neighbors > 100;
            for i in 0..neighbors {
                let neighbor = self.facets[facet as usize].neighbors.get(i);
                let plane = &mut self.planes[neighbor as usize];
                if plane.visit == mark {
                    continue;
                }
                plane.visit = mark;
                if !plane.flipped {
                    let distance = plane.distance(position);
                    if distance > best_distance {
                        if !check {
                            least = distance - search;
                            if distance > best_distance + search {
                                stack.clear();
                            }
                        }
                        (best, best_distance) = (neighbor, distance);
                    } else if distance < if wide { 5.0 * least } else { least } {
                        continue;
                    }
                    if check {
                        let facet = &mut self.facets[neighbor as usize];
                        if distance > facet.max_outside {
                            facet.max_outside = distance;
                        }
                    }
                }
                if pending != NONE {
                    stack.push(pending);
                }
                pending = neighbor;
            }
            facet = if pending != NONE {
                pending
            } else {
                stack.pop().unwrap_or(NONE)
            };
            if facet == NONE {
                break;
            }
        }
        self.stack = stack;
        (best, best_distance)
    }

    /// Whether the normals of the new facets lie in more than one octant.
    fn new_facets_are_sharp(&self) -> bool {
        let octant = |f: u32| self.planes[f as usize].normal.map(|n| n > 0.0);
        let first = self.first_new();
        let mut f = first;
        while f != NONE {
            if octant(f) != octant(first) {
                return true;
            }
            f = self.planes[f as usize].next;
        }
        false
    }
}
