//! Pairs of geoms that can touch, and their contact parameters.

use std::cmp::Ordering;

use super::plan::Plan;
use super::{CompiledModel, Cone, Disable, GeomType, Softness};
use crate::error::ensure;
use crate::{Error, Result};

/// Smaller friction is raised to this value: MuJoCo's `mjMINMU`.
const MIN_FRICTION: f64 = 1e-5;

/// Two geoms that can touch, and the properties of their contacts that do not depend on the state.
#[derive(Clone, Debug)]
pub(crate) struct Pair {
    /// The geoms; the first has the lower type.
    pub(crate) geom: [usize; 2],
    pub(crate) kind: (GeomType, GeomType),
    /// Contacts are listed below this distance: the margin plus the gap.
    pub(crate) margin: f64,
    /// Contacts act below this distance.
    pub(crate) includemargin: f64,
    /// The distance of the centres above which the geoms cannot touch. If one geom is a plane: the
    /// height of the other geom's centre above the plane.
    pub(crate) reach: f64,
    /// Whether boxes around the geoms must overlap too. MuJoCo skips this test (its middle phase)
    /// for bodies with one geom each, and for pairs that the model lists.
    pub(crate) boxed: bool,
    /// Whether boxes around the bodies must overlap too.
    pub(crate) swept: bool,
    /// The attraction of the geoms.
    pub(crate) adhesion: f64,
    /// Whether the model lists the pair.
    pub(crate) listed: bool,
    pub(crate) dim: u8,
    /// The number of rows of a contact.
    pub(crate) rows: usize,
    pub(crate) friction: [f64; 5],
    pub(crate) solref: [f64; 2],
    pub(crate) solimp: [f64; 5],
    pub(crate) softness: Softness,
    /// Damping of sliding, for elliptic cones.
    pub(crate) friction_damping: f64,
    /// The sum of the bodies' inverse weights for translation.
    pub(crate) diag: f64,
    /// The degrees of freedom that move one of the bodies and not the other, ascending, with the
    /// sign of the relative motion of the second body.
    pub(crate) columns: Vec<Column>,
    /// The number of groups of four degrees of freedom up to the last column.
    pub(crate) groups: usize,
    /// The trees of the two bodies; `None` for a static body.
    pub(crate) trees: [Option<usize>; 2],
}

impl Pair {
    /// Whether the contacts need the general routine for convex shapes.
    pub(crate) fn is_convex(&self) -> bool {
        use GeomType::{Box, Capsule, Cylinder, Ellipsoid, Mesh, Sphere};
        match self.kind.1 {
            Ellipsoid => matches!(self.kind.0, Sphere | Capsule | Ellipsoid),
            Cylinder => matches!(self.kind.0, Capsule | Ellipsoid | Cylinder),
            Box => matches!(self.kind.0, Ellipsoid | Cylinder),
            Mesh => true,
            _ if self.kind.0 == GeomType::Hfield => true,
            _ => false,
        }
    }
}

/// The distance test of a pair. Few pairs pass the test, so `Reach` is separate from [`Pair`]: the
/// test reads less memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    pub(crate) geom: [usize; 2],
    pub(crate) plane: bool,
    /// The largest value for which the geoms can touch: of the height of the second centre above
    /// the plane, or of the squared distance of the centres.
    pub(crate) most: f64,
}

impl Reach {
    pub(super) fn new(pair: &Pair) -> Self {
        let plane = pair.kind.0 == GeomType::Plane;
        Self {
            geom: pair.geom,
            plane,
            most: if plane {
                pair.reach
            } else {
                pair.reach * pair.reach
            },
        }
    }
}

/// A degree of freedom that moves one of two bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column {
    pub(crate) dof: usize,
    /// The root of the tree of the body that the degree of freedom moves.
    pub(crate) root: usize,
    pub(crate) sign: f64,
}
impl Plan {
    /// All pairs in the order of MuJoCo's `mj_collision`: by bodies, then by the geoms of the pair.
    pub(super) fn find_pairs(&self, m: &CompiledModel) -> Result<Vec<Pair>> {
        /// The limits over all pairs. A model above these limits would take gigabytes.
        const MOST_COLUMNS: usize = 4_000_000;
        const MOST_PAIRS: usize = 1_000_000;
        let mut excluded = m.exclude_signature.clone();
        excluded.sort_unstable();
        let mut stated: Vec<_> = (0..m.pair_dim.len()).collect();
        stated.sort_by_key(|&i| stated_bodies(m, i));
        let (mut pairs, mut columns) = (Vec::new(), 0);
        let mut next = 0;
        for b1 in 0..m.nbody() {
            for b2 in b1..m.nbody() {
                let mut push = |pairs: &mut Vec<Pair>, pair: Option<Pair>| {
                    columns += pair.as_ref().map_or(0, |pair| pair.columns.len());
                    if columns > MOST_COLUMNS {
                        return Err(Error::Model(format!(
                            "too many pairs of geoms can touch, moved by too many degrees of freedom: of all \
                             pairs together more than {MOST_COLUMNS} are not supported"
                        )));
                    }
                    pairs.extend(pair);
                    ensure!(
                        pairs.len() <= MOST_PAIRS,
                        "more than {MOST_PAIRS} pairs of geoms can touch, which are not supported: exclude some"
                    );
                    Ok(())
                };
                // pairs that the model lists come first, and replace automatic pairs of the same
                // geoms
                let of_bodies = stated[next..].iter();
                let of_bodies = of_bodies.take_while(|&&i| stated_bodies(m, i) == [b1, b2]);
                let count = of_bodies.count();
                let of_bodies = &stated[next..next + count];
                next += count;
                for &i in of_bodies {
                    let geoms = [m.pair_geom1[i], m.pair_geom2[i]];
                    push(&mut pairs, self.pair(m, geoms, &Figures::stated(m, i)))?;
                }
                if b1 == b2 || !bodies_collide(m, &excluded, b1, b2) {
                    continue;
                }
                let first = pairs.len();
                for g1 in m.geoms_of(b1) {
                    for g2 in m.geoms_of(b2) {
                        let meet = m.geom_contype[g1] & m.geom_conaffinity[g2]
                            | m.geom_contype[g2] & m.geom_conaffinity[g1];
                        let known = of_bodies.iter().any(|&i| {
                            let geoms = [m.pair_geom1[i], m.pair_geom2[i]];
                            geoms == [g1, g2] || geoms == [g2, g1]
                        });
                        if meet != 0 && !known {
                            let figures = Figures::mixed(m, [g1, g2]);
                            push(&mut pairs, self.pair(m, [g1, g2], &figures))?;
                        }
                    }
                }
                pairs[first..].sort_unstable_by_key(|pair: &Pair| pair.geom);
            }
        }
        Ok(pairs)
    }

    /// Builds the pair of two geoms; `None` for planes and height fields, which never touch each
    /// other.
    fn pair(&self, m: &CompiledModel, [g1, g2]: [usize; 2], figures: &Figures) -> Option<Pair> {
        let [g1, g2] = by_type(m, [g1, g2]);
        let kind = (m.geom_type[g1], m.geom_type[g2]);
        if kind.1 <= GeomType::Hfield {
            return None;
        }
        let (b1, b2) = (m.geom_bodyid[g1], m.geom_bodyid[g2]);
        let (solref, solimp, dim) = (figures.solref, figures.solimp, figures.dim);
        let (solref_friction, includemargin) = (figures.solref_friction, figures.includemargin);
        let margin = includemargin + figures.gap;
        let columns = self.columns(m, b1, b2);
        // 4.0 has no constraint where no degree of freedom moves one body relative to the other
        let fixed = columns.is_empty() && m.revision.drops_rigid_pairs();
        let tree = |b: usize| usize::try_from(m.body_treeid[b]).ok().filter(|_| !fixed);
        let softness = Softness::new(solref, solimp, &m.opt);
        let friction_damping = if solref_friction == [0.0; 2] {
            softness.damping
        } else {
            Softness::new(solref_friction, solimp, &m.opt).damping
        };
        Some(Pair {
            geom: [g1, g2],
            kind,
            margin,
            includemargin,
            reach: m.geom_rbound[g1] + m.geom_rbound[g2] + margin,
            boxed: figures.boxed,
            swept: figures.swept,
            adhesion: figures.adhesion,
            listed: figures.listed,
            dim,
            rows: match (dim, m.opt.cone) {
                (1, _) => 1,
                (dim, Cone::Pyramidal) => 2 * (usize::from(dim) - 1),
                (dim, Cone::Elliptic) => dim.into(),
            },
            friction: figures.friction.map(|f| f.max(MIN_FRICTION)),
            solref,
            solimp,
            friction_damping,
            softness,
            diag: m.body_invweight0[b1][0] + m.body_invweight0[b2][0],
            groups: columns.last().map_or(0, |column| column.dof / 4 + 1),
            columns,
            trees: [tree(b1), tree(b2)],
        })
    }

    fn columns(&self, m: &CompiledModel, b1: usize, b2: usize) -> Vec<Column> {
        let (c1, c2) = (self.chain(b1), self.chain(b2));
        let of = |chain: &[usize], other: &[usize], b: usize, sign: f64| {
            let alone = chain.iter().filter(|dof| !other.contains(dof));
            alone
                .map(|&dof| Column {
                    dof,
                    root: m.body_rootid[b],
                    sign,
                })
                .collect::<Vec<_>>()
        };
        let mut columns = of(c1, c2, b1, -1.0);
        columns.extend(of(c2, c1, b2, 1.0));
        columns.sort_unstable_by_key(|column| column.dof);
        columns
    }
}

/// Two geoms in the order of their types, in which MuJoCo looks for their contacts.
fn by_type(m: &CompiledModel, [g1, g2]: [usize; 2]) -> [usize; 2] {
    if m.geom_type[g1] > m.geom_type[g2] {
        [g2, g1]
    } else {
        [g1, g2]
    }
}

/// The contact parameters of a pair.
struct Figures {
    dim: u8,
    friction: [f64; 5],
    solref: [f64; 2],
    /// `solref` of sliding, for elliptic cones; zeros mean the same as `solref`.
    solref_friction: [f64; 2],
    solimp: [f64; 5],
    includemargin: f64,
    gap: f64,
    boxed: bool,
    swept: bool,
    listed: bool,
    adhesion: f64,
}

impl Figures {
    /// The parameters that the model lists for pair `i`.
    fn stated(m: &CompiledModel, i: usize) -> Self {
        Self {
            dim: m.pair_dim[i],
            friction: m.pair_friction[i],
            solref: m.pair_solref[i],
            solref_friction: m.pair_solreffriction[i],
            solimp: m.pair_solimp[i],
            includemargin: m.pair_margin[i],
            gap: m.pair_gap[i],
            boxed: false,
            swept: false,
            listed: true,
            adhesion: m.pair_adhesion[i],
        }
    }

    /// The parameters mixed from the two geoms.
    fn mixed(m: &CompiledModel, geoms: [usize; 2]) -> Self {
        // the order decides how the averages are rounded
        let [g1, g2] = by_type(m, geoms);
        let mixed = m.mixed(g1, g2);
        let [slide, spin, roll] = mixed.friction;
        Self {
            dim: mixed.dim,
            friction: [slide, slide, spin, roll, roll],
            solref: mixed.solref,
            solref_friction: [0.0; 2],
            solimp: mixed.solimp,
            includemargin: m.geom_margin[g1] + m.geom_margin[g2],
            gap: m.geom_gap[g1] + m.geom_gap[g2],
            boxed: !m.opt.disables(Disable::MidPhase)
                && [g1, g2].map(|g| m.body_geomnum[m.geom_bodyid[g]]) != [1; 2],
            listed: false,
            adhesion: match m.geom_priority[g1].cmp(&m.geom_priority[g2]) {
                Ordering::Greater => m.geom_adhesion[g1],
                Ordering::Less => m.geom_adhesion[g2],
                Ordering::Equal => m.geom_adhesion[g1] + m.geom_adhesion[g2],
            },
            swept: !m.revision.sweeps_otherwise()
                && [g1, g2].iter().all(|g| is_swept(m, m.geom_bodyid[*g])),
        }
    }
}

/// Whether MuJoCo compares boxes around a body before its geoms: not around the world, or a body
/// that cannot move and has a plane.
fn is_swept(m: &CompiledModel, body: usize) -> bool {
    let moves = m.body_dofnum[m.body_weldid[body]] > 0;
    body != 0 && (moves || m.geoms_of(body).all(|g| m.geom_type[g] != GeomType::Plane))
}

/// The bodies of pair `i` that the model lists, the smaller id first.
fn stated_bodies(m: &CompiledModel, i: usize) -> [usize; 2] {
    let [b1, b2] = [m.pair_geom1[i], m.pair_geom2[i]].map(|g| m.geom_bodyid[g]);
    [b1.min(b2), b1.max(b2)]
}

/// MuJoCo's number of a pair of bodies.
pub(crate) fn signature([b1, b2]: [usize; 2]) -> u32 {
    let (first, second) = (b1.min(b2), b1.max(b2));
    ((first as u32) << 16) + second as u32
}

/// The largest number of contacts of two shapes.
pub(super) fn most_contacts(kind: (GeomType, GeomType)) -> usize {
    match kind {
        (GeomType::Hfield, _) => 50,
        (GeomType::Plane, GeomType::Capsule) | (GeomType::Capsule, GeomType::Capsule) => 2,
        (GeomType::Capsule, GeomType::Box) => 2,
        (GeomType::Plane, GeomType::Cylinder | GeomType::Box | GeomType::Mesh) => 4,
        (GeomType::Box, GeomType::Box) => 8,
        (GeomType::Capsule | GeomType::Cylinder, GeomType::Cylinder | GeomType::Box) => 5,
        (
            GeomType::Capsule | GeomType::Cylinder | GeomType::Box | GeomType::Mesh,
            GeomType::Mesh,
        ) => 5,
        _ => 1,
    }
}

/// The sizes of the meshes' polygons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polygons {
    /// The most corners of a polygon.
    pub(crate) corners: usize,
    /// The most polygons at a vertex.
    pub(crate) degree: usize,
    /// The most iterations of a search.
    pub(crate) iterations: usize,
}

impl Polygons {
    pub(super) fn new(m: &CompiledModel) -> Self {
        let most = |counts: &[usize]| counts.iter().copied().max().unwrap_or(0);
        Self {
            corners: most(&m.meshes.mesh_polyvertnum),
            degree: most(&m.meshes.mesh_polymapnum),
            iterations: m.opt.ccd_iterations,
        }
    }
}

/// Whether geoms of two bodies collide. `excluded` is sorted.
fn bodies_collide(m: &CompiledModel, excluded: &[u32], b1: usize, b2: usize) -> bool {
    let (w1, w2) = (m.body_weldid[b1], m.body_weldid[b2]);
    let parent = |w: usize| m.body_weldid[m.body_parentid[w]];
    let related = !m.opt.disables(Disable::FilterParent)
        && w1 != 0
        && w2 != 0
        && (w1 == parent(w2) || w2 == parent(w1));
    w1 != w2 && !related && excluded.binary_search(&signature([b1, b2])).is_err()
}
