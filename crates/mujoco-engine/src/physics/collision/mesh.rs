//! The convex hull of a mesh: its furthest point in a direction, its polygons, and its contacts
//! with a plane.

use std::cell::Cell;

use super::features::Features;
use super::manifold::{area, keep, largest};
use super::{Hit, Push, Shape};
use crate::math::spatial::{Vec3, add, add_scaled, dot, norm, rotate, rotate_back, scale, sub};
use crate::model::{CompiledModel, GeomType, Hull, Meshes};

/// Meshes with fewer vertices are searched exhaustively: MuJoCo's `mjMESH_HILLCLIMB_MIN`.
const FEW: usize = 10;

/// The component above which a direction counts as along an axis, where a search begins.
const ALONG: f64 = 0.4;

/// The most contacts with a plane before 4.0.
const PLANE_MOST: usize = 3;

/// The least distance of such contacts from the first, in bounding radii.
const PLANE_APART: f64 = 0.3;

/// The arrays of a mesh, and the vertex at which the next search begins.
#[derive(Debug)]
pub(super) struct Mesh<'a> {
    all: &'a Meshes,
    mesh: usize,
    vertices: &'a [[f32; 3]],
    hull: Option<&'a Hull>,
    /// The last vertex found for this pair of geoms, by its number in the search: in the hull if
    /// `climbs`, else in the mesh. Where several vertices are equally far, the result depends on it.
    last: Cell<Option<usize>>,
}

impl<'a> Mesh<'a> {
    /// The mesh of a geom; `None` for other shapes.
    pub(super) fn of(m: &'a CompiledModel, geom: usize) -> Option<Self> {
        if m.geom_type[geom] != GeomType::Mesh {
            return None;
        }
        let mesh = usize::try_from(m.geom_dataid[geom]).ok()?;
        let all = &*m.meshes;
        let (first, count) = (all.mesh_vertadr[mesh], all.mesh_vertnum[mesh]);
        Some(Self {
            all,
            mesh,
            vertices: &all.mesh_vert[first..first + count],
            hull: m.meshes.layouts()[mesh].hull.as_ref(),
            last: Cell::new(None),
        })
    }

    pub(super) fn vertex(&self, number: usize) -> Vec3 {
        self.vertices[number].map(f64::from)
    }

    pub(super) fn has_polygons(&self) -> bool {
        self.all.mesh_polynum[self.mesh] > 0
    }

    fn polygon(&self, number: u32) -> usize {
        self.all.mesh_polyadr[self.mesh] + number as usize
    }

    pub(super) fn normal(&self, polygon: u32) -> Vec3 {
        self.all.mesh_polynormal[self.polygon(polygon)]
    }

    /// The vertices of a polygon.
    pub(super) fn outline(&self, polygon: u32) -> &'a [u32] {
        let polygon = self.polygon(polygon);
        let start = self.all.mesh_polyvertadr[polygon];
        &self.all.mesh_polyvert[start..start + self.all.mesh_polyvertnum[polygon]]
    }

    /// The polygons at a vertex.
    pub(super) fn polygons_at(&self, vertex: u32) -> &'a [u32] {
        let vertex = self.all.mesh_vertadr[self.mesh] + vertex as usize;
        let start = self.all.mesh_polymapadr[vertex];
        &self.all.mesh_polymap[start..start + self.all.mesh_polymapnum[vertex]]
    }

    /// The hull that searches climb: not that of a mesh with few vertices.
    fn climbs(&self) -> Option<&'a Hull> {
        self.hull.filter(|_| self.vertices.len() >= FEW)
    }

    fn along(&self, local: Vec3, vertex: usize) -> f64 {
        dot(local, self.vertex(vertex))
    }

    /// The number of the vertex that is furthest in a direction of the geom's frame: MuJoCo's
    /// `mjc_meshSupport` and `mjc_hillclimbSupport`.
    pub(super) fn support(&self, local: Vec3) -> usize {
        match self.climbs() {
            Some(hull) => self.climb(hull, local),
            None => self.search(local),
        }
    }

    fn search(&self, local: Vec3) -> usize {
        let mut best = self.last.get().unwrap_or(0);
        let mut most = match self.last.get() {
            Some(last) => self.along(local, last),
            None => -f64::from(f32::MAX),
        };
        for vertex in 0..self.vertices.len() {
            let along = self.along(local, vertex);
            if along > most {
                (best, most) = (vertex, along);
            }
        }
        self.last.set(Some(best));
        best
    }

    fn climb(&self, hull: &Hull, local: Vec3) -> usize {
        let cell = local.map(|x| 1 + usize::from(x > ALONG) - usize::from(x < -ALONG));
        let seed = hull.seeds[9 * cell[0] + 3 * cell[1] + cell[2]] as usize;
        let along = |vertex: usize| hull.along(local, vertex);
        let start = match self.last.get() {
            Some(last) if along(seed) <= along(last) => last,
            _ => seed,
        };
        let best = hull.climb(start, local);
        self.last.set(Some(best));
        hull.id(best)
    }

    /// The mesh's part of `mesh_graph` from its first list on: where the neighbours of each vertex
    /// begin, and the number of vertices.
    fn graph(&self) -> Option<(&'a [i32], usize)> {
        let start = usize::try_from(self.all.mesh_graphadr[self.mesh]).ok()?;
        let count = self.all.mesh_graph[start] as usize;
        Some((&self.all.mesh_graph[start + 2..], count))
    }
}

/// The contact of a plane at a point.
fn plane_point(plane: Shape<'_>, point: Vec3) -> Hit {
    let normal = plane.axis();
    let dist = dot(normal, sub(point, plane.pos));
    Hit::new(dist, add_scaled(point, normal, -0.5 * dist), normal)
}

/// The contacts of a plane and a mesh before 4.0, at most three: the lowest vertex, and its
/// neighbours that are below the margin and not near it. MuJoCo's `mjc_PlaneConvex`.
pub(super) fn plane_neighbours(
    plane: Shape<'_>,
    shape: Shape<'_>,
    mesh: &Mesh<'_>,
    radius: f64,
    margin: f64,
    push: Push<'_>,
) {
    let normal = plane.axis();
    let local = rotate_back(shape.mat, scale(normal, -1.0));
    let at = |vertex: usize| add(rotate(shape.mat, mesh.vertex(vertex)), shape.pos);
    // the search of libccd, which begins at the first vertex
    let climbs = mesh.climbs();
    let number = match climbs {
        Some(hull) => hull.climb(0, local),
        None => mesh.search(local),
    };
    let lowest = climbs.map_or(number, |hull| hull.id(number));
    let first = plane_point(plane, at(lowest));
    if first.dist > margin {
        return;
    }
    push(first);
    let (mut count, least) = (1, dot(normal, sub(shape.pos, plane.pos)) - margin);
    let mut other = |vertex: usize| {
        let below = count < PLANE_MOST && mesh.along(local, vertex) > least;
        if below && norm(sub(at(vertex), first.pos)) >= PLANE_APART * radius {
            push(plane_point(plane, at(vertex)));
            count += 1;
        }
    };
    match mesh.graph() {
        None => {
            let others = (0..mesh.vertices.len()).filter(|vertex| *vertex != number);
            others.for_each(other);
        }
        // in a small mesh, the number is one of the mesh, but MuJoCo looks it up in the graph
        Some((starts, count)) => {
            let (ids, lists) = (&starts[count..2 * count], &starts[2 * count..]);
            let start = starts.get(number).copied().unwrap_or_default();
            let start = usize::try_from(start).unwrap_or(usize::MAX);
            let list = lists.get(start..).unwrap_or_default().iter();
            for vertex in list.map_while(|vertex| usize::try_from(*vertex).ok()) {
                if let Some(&id) = ids.get(vertex) {
                    other(id as usize);
                }
            }
        }
    }
}

/// The contacts of a plane and a mesh from 4.0 on, at most four: corners of the polygon at the
/// lowest vertex that looks most toward the plane, if they are not above the geom's centre.
pub(super) fn plane_polygon(
    plane: Shape<'_>,
    shape: Shape<'_>,
    mesh: &Mesh<'_>,
    margin: f64,
    features: &mut Features,
    push: Push<'_>,
) {
    let local = rotate_back(shape.mat, scale(plane.axis(), -1.0));
    let at = |vertex: Vec3| add(rotate(shape.mat, vertex), shape.pos);
    let lowest = mesh.support(local) as u32;
    if plane_point(plane, at(mesh.vertex(lowest as usize))).dist > margin {
        return;
    }
    let mut best = None;
    for &polygon in mesh.polygons_at(lowest) {
        let along = dot(mesh.normal(polygon), local);
        if best.is_none_or(|(most, _)| along > most) {
            best = Some((along, polygon));
        }
    }
    let corners = best.map_or(&[][..], |(_, polygon)| mesh.outline(polygon));
    let polygon = &mut features.polygons[0];
    polygon.clear();
    if corners.is_empty() {
        polygon.push(mesh.vertex(lowest as usize));
    }
    let first = corners.iter().position(|corner| *corner == lowest);
    let (before, after) = corners.split_at(first.unwrap_or(0));
    let vertex = |number: &u32| mesh.vertex(*number as usize);
    polygon.extend(after.iter().chain(before).map(vertex));
    if polygon.len() > 4 {
        // in the geom's frame, so that the choice does not depend on the pose
        keep(polygon, largest(polygon, 1, area));
    }
    for &corner in polygon.iter() {
        let point = at(corner);
        let hit = plane_point(plane, point);
        // a corner above the geom's centre is none
        if hit.dist <= margin && dot(plane.axis(), sub(point, shape.pos)) <= 0.0 {
            push(hit);
        }
    }
}
