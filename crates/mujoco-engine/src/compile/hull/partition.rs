// Derived from Qhull (http://www.qhull.org), Copyright (c) 1993-2020 C.B. Barber and The Geometry
// Center; rewritten in Rust, November 2026, for three dimensions and the options that MuJoCo asks
// for. Its licence is in COPYING.txt beside this file.

//! Which facet has charge of which point (`qh_partitionall`, `qh_partitionpoint`,
//! `qh_partitioncoplanar` of `libqhull_r.c`).

use super::Builder;
use super::arena::{NONE, Set};
use super::error::HullError;
use super::lists::NOWHERE;
use super::plane::dot;

/// `qh_RATIOcoplanaroutside`: a point so far outside, in targets, is not near its facet.
const TOO_FAR: f64 = 30.0;

/// Puts `point` before the last, which stays the furthest.
fn push_second_last(set: &mut Vec<u32>, point: u32) {
    set.push(point);
    let len = set.len();
    if len > 1 {
        set.swap(len - 2, len - 1);
    }
}

impl Builder<'_> {
    /// Gives every point that is not a vertex to one of the first facets.
    pub(super) fn partition_all(&mut self, vertices: &Set) -> Result<(), HullError> {
        let mut corners: Vec<u32> = vertices
            .as_slice()
            .iter()
            .map(|&v| self.vertices[v as usize].point)
            .collect();
        corners.sort_unstable();
        let mut remaining: Vec<u32> = (0..self.points.len() as u32)
            .filter(|i| !corners.contains(i))
            .collect();
        let enough = self.clearly_outside();
        let mut f = self.first_facet();
        while f != NONE {
            let mut best: Option<(u32, f64)> = None;
            let mut outside = Vec::new();
            remaining.retain(|&point| {
                let distance = self.planes[f as usize].distance(self.points[point as usize]);
                if distance < enough {
                    return true;
                }
                match best {
                    None => best = Some((point, distance)),
                    Some((previous, least)) if distance > least => {
                        outside.push(previous);
                        best = Some((point, distance));
                    }
                    Some(_) => outside.push(point),
                }
                false
            });
            if let Some((point, distance)) = best {
                outside.push(point);
                self.facets[f as usize].furthest = distance;
            }
            self.facets[f as usize].outside = outside;
            f = self.planes[f as usize].next;
        }
        self.find_new = true;
        for point in remaining {
            self.partition_point(point, self.first_facet())?;
        }
        self.find_new = false;
        Ok(())
    }

    /// Gives `point` to the facet that it is furthest above.
    pub(super) fn partition_point(&mut self, point: u32, start: u32) -> Result<(), HullError> {
        self.check_work()?;
        let position = self.points[point as usize];
        let mut found = if self.find_new {
            self.find_best_new(position, start, false)?
        } else {
            self.find_best(position, start, false)?
        };
        let (f, distance) = (found.facet, found.distance);
        if self.planes[f as usize].visible {
            return Err(HullError::Inconsistent("a point above a deleted facet"));
        }
        if self.narrow && distance >= -self.constants.near_inside {
            found.outside = true;
        }
        if !found.outside {
            if distance >= -self.constants.max_coplanar || distance >= -self.constants.near_inside {
                self.partition_coplanar(point, f, Some(distance), self.find_new)?;
            }
            return Ok(());
        }
        let min_outside = self.constants.min_outside;
        let facet = &mut self.facets[f as usize];
        let mut newly_outside = false;
        if facet.outside.is_empty() {
            facet.outside.push(point);
            newly_outside = !self.narrow || distance > min_outside;
            facet.furthest = distance;
        } else if facet.furthest < distance {
            facet.outside.push(point);
            newly_outside = self.narrow && facet.furthest < min_outside && distance >= min_outside;
            facet.furthest = distance;
        } else {
            push_second_last(&mut facet.outside, point);
        }
        if newly_outside && self.facet_next != f {
            if self.planes[f as usize].new {
                if self.planes[self.facet_next as usize].new {
                    self.facet_next = self.first_new();
                }
            } else {
                self.remove_facet(f);
                self.append_facet(f);
                if self.newfacet_list != NOWHERE {
                    self.planes[f as usize].new = true;
                }
            }
        }
        Ok(())
    }

    /// Gives `point`, at `distance` from the facet `start` or to be searched from there, to a facet
    /// that it is near.
    pub(super) fn partition_coplanar(
        &mut self,
        point: u32,
        start: u32,
        distance: Option<f64>,
        all_new: bool,
    ) -> Result<(), HullError> {
        self.check_work()?;
        self.was_coplanar = true;
        let position = self.points[point as usize];
        let (f, height) = match distance {
            Some(distance) => (start, distance),
            None => {
                let found = if all_new {
                    self.find_best_new(position, start, true)?
                } else {
                    self.find_best(position, start, true)?
                };
                if found.distance < -self.constants.near_inside {
                    self.repartitioned = NONE;
                    return Ok(());
                }
                (found.facet, found.distance)
            }
        };
        if self.planes[f as usize].visible {
            return Err(HullError::Inconsistent("a point near a deleted facet"));
        }
        if height > self.max_outside {
            let mut again = distance.is_none()
                && start != f
                && dot(
                    self.planes[start as usize].normal,
                    self.planes[f as usize].normal,
                ) < 0.0;
            if !again && height > self.target * TOO_FAR {
                if start == f {
                    if self.repartitioned == f {
                        return Err(HullError::Wide);
                    }
                    self.repartitioned = f;
                }
                again = true;
            }
            if again {
                let find_new = std::mem::replace(&mut self.find_new, false);
                self.partition_point(point, f)?;
                self.find_new = find_new;
                self.repartitioned = NONE;
                return Ok(());
            }
            self.repartitioned = NONE;
            self.max_outside = height;
        }
        let plane = &self.planes[f as usize];
        let facet = &mut self.facets[f as usize];
        match facet.coplanar.last() {
            Some(&last) if plane.distance(self.points[last as usize]) >= height => {
                push_second_last(&mut facet.coplanar, point);
            }
            _ => facet.coplanar.push(point),
        }
        Ok(())
    }

    /// Gives away the points of the facets that are about to be deleted, and the vertices that no
    /// facet has any more.
    pub(super) fn partition_visible(&mut self) -> Result<(), HullError> {
        let mut visible = self.first_visible();
        while visible != NONE {
            let next = self.next_visible(visible);
            let facet = &mut self.facets[visible as usize];
            if !facet.outside.is_empty() || !facet.coplanar.is_empty() {
                let outside = std::mem::take(&mut facet.outside);
                let coplanar = std::mem::take(&mut facet.coplanar);
                let mut start = self.replacement(visible)?;
                if start == NONE {
                    start = self.first_new();
                }
                if start == NONE {
                    return Err(HullError::Inconsistent("no new facets"));
                }
                for point in outside {
                    self.partition_point(point, start)?;
                }
                for point in coplanar {
                    self.partition_coplanar(point, start, None, self.find_new)?;
                }
            }
            visible = next;
        }
        for i in 0..self.deleted_vertices.len() {
            let v = self.deleted_vertices[i] as usize;
            if !self.vertices[v].partitioned {
                if self.first_new() == NONE {
                    return Err(HullError::Inconsistent("no new facets"));
                }
                self.partition_coplanar(self.vertices[v].point, self.first_new(), None, true)?;
                self.vertices[v].partitioned = true;
            }
        }
        Ok(())
    }

    /// The facet that took over from `f`, or none.
    pub(super) fn replacement(&self, f: u32) -> Result<u32, HullError> {
        let mut result = f;
        for _ in 0..=self.facets.len() {
            if result == NONE || !self.planes[result as usize].visible {
                return Ok(result);
            }
            result = self.facets[result as usize].replace;
        }
        Err(HullError::Inconsistent(
            "facets replace each other in a circle",
        ))
    }
}
