//! Which geoms touch, and where.
//!
//! The model lists all pairs that can ever touch, in the order of their contacts. A test of
//! bounding spheres skips most pairs, and never changes the result.

mod bounds;
mod box_box;
mod boxes;
mod capsule_box;
mod convex;
mod epa;
mod features;
mod gjk;
mod hfield;
mod manifold;
mod manifold_3_12;
mod mesh;
mod primitive;
mod sweep;

use super::sleep;
use crate::math::number::{self, Number};
use crate::math::spatial::{
    Mat3, Vec3, add_scaled, column, cross, dot, norm, normalize, sub, unit,
};
use crate::model::{Disable, GeomType, Pair, Reach};
use crate::{Contact, Data, Model};
pub(in crate::physics) use bounds::{Frame, ROUNDING, from_segments};
pub(crate) use epa::Polytope;
pub(super) use primitive::above_plane;

use box_box::box_box;
use boxes::{plane_box, sphere_box, sphere_cylinder};
use capsule_box::capsule_box;
use convex::Solid;
use gjk::Rules;
use hfield::Field;
use mesh::{Mesh, plane_neighbours, plane_polygon};
use primitive::{
    capsule_capsule, plane_capsule, plane_cylinder, plane_sphere, sphere_capsule, sphere_sphere,
};

/// A geom in the world.
#[derive(Clone, Copy)]
struct Shape<'a> {
    pos: Vec3,
    mat: &'a Mat3,
    size: &'a Vec3,
}

impl Shape<'_> {
    fn axis(&self) -> Vec3 {
        column(self.mat, 2)
    }
}

/// A contact point of two geoms.
#[derive(Clone, Copy, Default)]
struct Hit {
    dist: f64,
    pos: Vec3,
    /// From the first geom to the second.
    normal: Vec3,
    /// The preferred direction of the first tangent; zero for none.
    tangent: Vec3,
}

/// Takes the contacts of two geoms.
type Push<'a> = &'a mut dyn FnMut(Hit);

impl Hit {
    /// A contact without a preferred direction of the first tangent.
    fn new(dist: f64, pos: Vec3, normal: Vec3) -> Self {
        Self {
            dist,
            pos,
            normal,
            ..Self::default()
        }
    }
}

/// Finds all contacts: MuJoCo's `mj_collision`.
pub fn collision(m: &Model, d: &mut Data) {
    if m.plan().sleeps {
        let awake = std::mem::take(&mut d.work.tree_awake);
        collide(m, d, |index| {
            sleep::rests(m, &awake, &m.plan().pairs[index])
        });
        d.work.tree_awake = awake;
    } else {
        collide(m, d, |_| false);
    }
}

/// [`collision`], without the pairs that rest.
#[inline(always)]
fn collide(m: &Model, d: &mut Data, rests: impl Fn(usize) -> bool) {
    d.contact.clear();
    let (plan, n) = (m.plan(), m.ngeom());
    let (xpos, xmat) = (&d.geom_xpos[..n], &d.geom_xmat[..n]);
    let mut axes = None;
    for (index, reach) in plan.reaches.iter().enumerate() {
        if out_of_reach(xpos, xmat, reach) || rests(index) {
            continue;
        }
        let frames = plan.pairs[index].geom.map(|g| (xpos[g], &xmat[g]));
        let places = Places {
            frames,
            inertial: |body: usize| (d.xipos[body], d.ximat[body]),
            geom: |g: usize| (xpos[g], xmat[g]),
            axes: &mut axes,
        };
        touch(m, index, places, &mut d.work.polytope, &mut d.contact);
    }
}

/// The frames that contacts of a pair depend on.
pub(in crate::physics) struct Places<'a, I, G> {
    /// Of the two geoms.
    pub(in crate::physics) frames: [(Vec3, &'a Mat3); 2],
    /// The inertial frame of a body.
    pub(in crate::physics) inertial: I,
    /// The frame of a geom.
    pub(in crate::physics) geom: G,
    /// The axes of `sweep`, computed once for all pairs of a state.
    pub(in crate::physics) axes: &'a mut Option<Mat3>,
}

/// Adds the contacts of a pair of geoms whose bounding volumes touch.
#[inline(never)]
pub(in crate::physics) fn touch(
    m: &Model,
    index: usize,
    places: Places<'_, impl Fn(usize) -> Frame, impl Fn(usize) -> Frame>,
    polytope: &mut Polytope,
    contacts: &mut Vec<Contact>,
) {
    let pair = &m.plan().pairs[index];
    let [a, b] = [0, 1].map(|k| Shape {
        pos: places.frames[k].0,
        mat: places.frames[k].1,
        size: &m.geom_size[pair.geom[k]],
    });
    let first = contacts.len();
    let (margin, push) = (pair.margin, &mut |hit: Hit| {
        contacts.push(contact(pair, index, &hit));
    });
    match pair.kind {
        (GeomType::Plane, GeomType::Sphere) => plane_sphere(a, b, margin, push),
        (GeomType::Plane, GeomType::Capsule) => plane_capsule(a, b, margin, push),
        (GeomType::Plane, GeomType::Cylinder) => plane_cylinder(a, b, margin, push),
        (GeomType::Sphere, GeomType::Sphere) => sphere_sphere(a, b, margin, push),
        (GeomType::Sphere, GeomType::Capsule) => sphere_capsule(a, b, margin, push),
        (GeomType::Capsule, GeomType::Capsule) => {
            let squares = from_segments(m, pair, sub(b.pos, a.pos), [a.axis(), b.axis()]);
            if !squares.iter().any(|(square, most)| square > most) {
                capsule_capsule(a, b, margin, m.revision, push);
            }
        }
        (GeomType::Plane, GeomType::Box) => plane_box(a, b, margin, push),
        (GeomType::Sphere, GeomType::Box) => sphere_box((a.pos, a.size[0]), b, margin, push),
        (GeomType::Sphere, GeomType::Cylinder) => sphere_cylinder(a, b, margin, push),
        (GeomType::Capsule, GeomType::Box) => capsule_box(a, b, margin, push),
        (GeomType::Plane, GeomType::Ellipsoid) => {
            convex::plane_ellipsoid(a, b, margin, m.revision, push);
        }
        (GeomType::Plane, GeomType::Plane) => {} // never touch
        _ if bounds::far_apart(m, pair, [a, b]) => {}
        (GeomType::Box, GeomType::Box) => box_box(a, b, margin, push),
        _ => general(m, pair, [a, b], polytope, push),
    }
    if contacts.len() == first {
        return;
    }
    let found = &contacts[first..];
    let deep = pair.margin - m.opt.ccd_tolerance;
    let near = |contact: &Contact| contact.dist > deep - ROUNDING;
    let mut dropped =
        pair.boxed && found.iter().all(near) && bounds::apart(m, pair, [a, b], places.inertial);
    let shallow = |contact: &Contact| sweep::may_separate(contact, deep);
    if !dropped && pair.swept && found.iter().all(shallow) {
        let axes = places
            .axes
            .get_or_insert_with(|| sweep::axes(m, &places.geom));
        let bodies = pair.geom.map(|g| m.geom_bodyid[g]);
        dropped = sweep::apart(m, axes, bodies, &places.geom);
    }
    if dropped {
        contacts.truncate(first);
    }
}

/// The distance of two geoms and their nearest points, if it is less than `most`: MuJoCo's
/// `mj_geomDistance`.
pub(super) fn nearest(
    m: &Model,
    d: &mut Data,
    geoms: [usize; 2],
    most: f64,
) -> Option<(f64, [Vec3; 2])> {
    let shapes = geoms.map(|g| Shape {
        pos: d.geom_xpos[g],
        mat: &d.geom_xmat[g],
        size: &m.geom_size[g],
    });
    let kinds = geoms.map(|g| m.geom_type[g]);
    let flipped = u8::from(kinds[0]) > u8::from(kinds[1]);
    let [first, second] = if flipped { [1, 0] } else { [0, 1] };
    let (a, b) = (shapes[first], shapes[second]);
    let mut least: Option<Hit> = None;
    let mut push = |hit: Hit| {
        if hit.dist < least.map_or(most, |least| least.dist) {
            least = Some(hit);
        }
    };
    let push: Push<'_> = &mut push;
    let polytope = &mut d.work.polytope;
    match (kinds[first], kinds[second]) {
        (GeomType::Plane, GeomType::Plane | GeomType::Hfield) | (GeomType::Hfield, _) => {
            return None;
        }
        (GeomType::Plane, GeomType::Sphere) => plane_sphere(a, b, most, push),
        (GeomType::Plane, GeomType::Capsule) => plane_capsule(a, b, most, push),
        (GeomType::Plane, GeomType::Cylinder) => plane_cylinder(a, b, most, push),
        (GeomType::Plane, GeomType::Box) => plane_box(a, b, most, push),
        (GeomType::Plane, GeomType::Ellipsoid) => {
            convex::plane_ellipsoid(a, b, most, m.revision, push);
        }
        (GeomType::Plane, GeomType::Mesh) => {
            let mesh = Mesh::of(m, geoms[second])?;
            if m.revision.clips_faces() {
                plane_polygon(a, b, &mesh, most, &mut polytope.features, push);
            } else {
                plane_neighbours(a, b, &mesh, m.geom_rbound[geoms[second]], most, push);
            }
        }
        (GeomType::Sphere, GeomType::Sphere) => sphere_sphere(a, b, most, push),
        (GeomType::Sphere, GeomType::Capsule) => sphere_capsule(a, b, most, push),
        (GeomType::Sphere, GeomType::Cylinder) => sphere_cylinder(a, b, most, push),
        (GeomType::Sphere, GeomType::Box) => sphere_box((a.pos, a.size[0]), b, most, push),
        (GeomType::Capsule, GeomType::Capsule) => capsule_capsule(a, b, most, m.revision, push),
        (GeomType::Capsule, GeomType::Box) => capsule_box(a, b, most, push),
        _ => {
            let meshes = [0, 1].map(|k| {
                let is = kinds[k] == GeomType::Mesh;
                Mesh::of(m, geoms[k]).filter(|_| is)
            });
            let [a, b] = [0, 1].map(|k| Solid {
                kind: kinds[k],
                shape: shapes[k],
                mesh: meshes[k].as_ref(),
                prism: None,
            });
            let touch = convex::within(a, b, ([0.0; 2], most), Rules::of(m), polytope)?;
            return Some((touch.dist, touch.points));
        }
    }
    let hit = least?;
    let half = if flipped { -0.5 } else { 0.5 } * hit.dist;
    let end = |by: f64| add_scaled(hit.pos, hit.normal, by);
    Some((hit.dist, [end(-half), end(half)]))
}

/// The contacts of pairs without a routine of their own.
fn general(
    m: &Model,
    pair: &Pair,
    [a, b]: [Shape<'_>; 2],
    polytope: &mut Polytope,
    push: Push<'_>,
) {
    let (margin, [g1, g2]) = (pair.margin, pair.geom);
    let meshes = pair.geom.map(|g| Mesh::of(m, g));
    let [first, second] = [0, 1].map(|k| meshes[k].as_ref());
    if let (GeomType::Plane, Some(mesh)) = (pair.kind.0, second) {
        if m.revision.clips_faces() {
            plane_polygon(a, b, mesh, margin, &mut polytope.features, push);
        } else {
            plane_neighbours(a, b, mesh, m.geom_rbound[g2], margin, push);
        }
        return;
    }
    let solid = |kind, shape, mesh| Solid {
        kind,
        shape,
        mesh,
        prism: None,
    };
    let rules = Rules::of(m);
    let b = solid(pair.kind.1, b, second);
    if let Some(field) = Field::of(m, g1) {
        let reach = (m.geom_rbound[g2], margin);
        hfield::contacts(field, a, b, reach, rules, polytope, push);
        return;
    }
    let a = solid(pair.kind.0, a, first);
    if m.opt.disables(Disable::MultiCcd) {
        if let Some(touch) = convex::one(a, b, [0.5 * margin; 2], rules, polytope) {
            push(touch.hit(margin));
        }
    } else if m.revision.clips_faces() {
        manifold::contacts(a, b, margin, rules, polytope, push);
    } else if margin == 0.0 && a.is_discrete() && b.is_discrete() {
        manifold_3_12::contacts(a, b, rules, polytope, push);
    } else {
        let apart = 1e-3 * m.geom_rbound[g1].min(m.geom_rbound[g2]);
        convex::contacts(a, b, (margin, apart), rules, polytope, push);
    }
}

/// Whether two bounding spheres, or a plane and a bounding sphere, are too far apart to touch.
#[inline]
fn out_of_reach(xpos: &[Vec3], xmat: &[Mat3], reach: &Reach) -> bool {
    let [g1, g2] = reach.geom;
    let between = sub(xpos[g2], xpos[g1]);
    let along = if reach.plane {
        column(&xmat[g1], 2)
    } else {
        between
    };
    dot(between, along) > reach.most
}

#[inline(never)]
fn contact(pair: &Pair, index: usize, hit: &Hit) -> Contact {
    let frame = frame((), hit.normal, hit.tangent);
    contact_at(pair, index, hit.dist, hit.pos, frame)
}

/// Returns a contact without constraint rows.
#[inline]
pub(super) fn contact_at(pair: &Pair, index: usize, dist: f64, pos: Vec3, frame: Mat3) -> Contact {
    Contact {
        dist,
        pos,
        frame,
        includemargin: pair.includemargin,
        friction: pair.friction,
        solref: pair.solref,
        solimp: pair.solimp,
        mu: 0.0,
        dim: pair.dim,
        geom: pair.geom,
        efc_address: -1,
        pair: index,
    }
}

/// A contact frame by rows: the normal, a tangent, and their product: MuJoCo's `mju_makeFrame`. The
/// tangent is `tangent` made orthogonal to the normal, or near y or z if `tangent` is zero.
#[inline(always)]
pub(super) fn frame<N: Number>(place: N::At, normal: [N; 3], tangent: [N; 3]) -> [N; 9] {
    let (x, _) = unit(place, normal);
    let near = N::choose(
        dot(tangent, tangent).is_below(0.25),
        #[inline(always)]
        || {
            N::choose(
                x[1].abs().is_below(0.5),
                #[inline(always)]
                || number::of(place, [0.0, 1.0, 0.0]),
                #[inline(always)]
                || number::of(place, [0.0, 0.0, 1.0]),
            )
        },
        #[inline(always)]
        || tangent,
    );
    let (y, _) = unit(place, add_scaled(near, x, -dot(x, near)));
    let z = cross(x, y);
    [x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]]
}

/// The contact of two spheres. If the centres coincide, `axes` give the normal.
#[inline]
fn spheres(c1: Vec3, r1: f64, c2: Vec3, r2: f64, axes: (Vec3, Vec3), margin: f64) -> Option<Hit> {
    let between = sub(c2, c1);
    let distance = norm(between);
    let dist = distance - r1 - r2;
    if dist > margin {
        return None;
    }
    let normal = if distance < crate::math::spatial::MINVAL {
        normalize(cross(axes.0, axes.1)).0
    } else {
        crate::math::spatial::scale(between, 1.0 / distance)
    };
    Some(Hit {
        dist,
        pos: add_scaled(c1, normal, r1 + 0.5 * dist),
        normal,
        tangent: [0.0; 3],
    })
}
