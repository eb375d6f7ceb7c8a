//! Boxes around the triangles of a mesh, in a tree: a ray is compared with few triangles.

use std::ops::Range;

use super::Meshes;
use super::bounds::Bounds;
use super::layout::around;

/// The most triangles of a box that has no others within.
const FEW: usize = 4;

/// The depth below which no tree of up to 2^32 triangles reaches.
const DEPTH: usize = 40;

#[derive(Clone, Debug)]
pub(crate) struct Triangles {
    /// The triangles by their numbers in the mesh: those of a box follow each other.
    order: Vec<u32>,
    /// A box is followed by those within its first half.
    boxes: Vec<Node>,
}

#[derive(Clone, Debug)]
struct Node {
    bounds: Bounds,
    triangles: Range<u32>,
    /// The box of the second half; `None` if the box has no others within.
    second: Option<u32>,
}

impl Triangles {
    pub(super) fn new(m: &Meshes, mesh: usize) -> Self {
        let (first, start) = (m.mesh_vertadr[mesh], m.mesh_faceadr[mesh]);
        let corner = |number: u32| m.mesh_vert[first + number as usize];
        let faces = &m.mesh_face[start..start + m.mesh_facenum[mesh]];
        let corners: Vec<_> = faces.iter().map(|face| face.map(corner)).collect();
        let mut triangles = Self {
            order: (0..faces.len() as u32).collect(),
            boxes: Vec::with_capacity(faces.len()),
        };
        triangles.grow(&corners, 0..faces.len());
        triangles
    }

    fn grow(&mut self, corners: &[[[f32; 3]; 3]], range: Range<usize>) {
        let index = self.boxes.len();
        let part = &mut self.order[range.clone()];
        let points = part.iter().flat_map(|number| corners[*number as usize]);
        let bounds = around(points);
        self.boxes.push(Node {
            bounds,
            triangles: range.start as u32..range.end as u32,
            second: None,
        });
        if range.len() <= FEW {
            return;
        }
        let [_, [x, y, z]] = bounds;
        let axis = match () {
            () if x >= y && x >= z => 0,
            () if y >= z => 1,
            () => 2,
        };
        let place = |number: &u32| {
            let corners = corners[*number as usize].map(|corner| f64::from(corner[axis]));
            corners[0] + corners[1] + corners[2]
        };
        let half = part.len() / 2;
        part.select_nth_unstable_by(half, |a, b| place(a).total_cmp(&place(b)));
        let middle = range.start + half;
        self.grow(corners, range.start..middle);
        self.boxes[index].second = Some(self.boxes.len() as u32);
        self.grow(corners, middle..range.end);
    }

    /// Calls `each` with the numbers of all triangles that are in boxes which `meets` accepts.
    pub(crate) fn visit(&self, meets: impl Fn(&Bounds) -> bool, mut each: impl FnMut(usize)) {
        let (mut left, mut number) = ([0; DEPTH], 1);
        while number > 0 {
            number -= 1;
            let index = left[number];
            let Some(node) = self.boxes.get(index) else {
                continue;
            };
            if !meets(&node.bounds) {
                continue;
            }
            if let Some(second) = node.second {
                (left[number], left[number + 1]) = (second as usize, index + 1);
                number += 2;
            } else {
                let Range { start, end } = node.triangles;
                let triangles = &self.order[start as usize..end as usize];
                triangles
                    .iter()
                    .for_each(|triangle| each(*triangle as usize));
            }
        }
    }
}
