//! Facts that the engine computes from a model once: sparsity of the inertia matrix, and pairs of
//! geoms that can touch.

use std::ops::Range;

use super::laws::Laws;
use super::mix::Mixed;
use super::paths::Paths;
use super::{CompiledModel, Cone, Disable, GeomType, Integrator, JointType, Options, Stage};
use crate::{Error, Result};

/// Friction below this counts as this: MuJoCo's `mjMINMU`.
const MIN_FRICTION: f64 = 1e-5;
/// Impedances are kept within these: MuJoCo's `mjMINIMP` and `mjMAXIMP`.
const IMPEDANCE: [f64; 2] = [1e-4, 0.9999];

/// Precomputed structure of a model.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// The elements of each row of the inertia matrix. All rows take as many groups of four
    /// elements as the longest, so that rows are combined whole.
    ///
    /// Row `i` holds the lower triangle: the degrees of freedom on the way from the root to `i`,
    /// ascending, `i` last.
    m_rows: Vec<Range<usize>>,
    /// How many groups a row takes: up to four, or a multiple of four.
    pub(crate) m_groups: usize,
    /// Columns of the elements; zero behind the end of a row.
    pub(crate) m_colind: Vec<usize>,
    /// The same, counted from the first degree of freedom of the tree.
    pub(crate) m_local: Vec<usize>,
    /// How many of a row's columns are 0, 1, 2 and so on.
    m_lead: Vec<usize>,
    /// Whether most rows begin with four such columns, so that it pays to compute four elements at
    /// once.
    pub(crate) m_fours: bool,
    /// The last degree of freedom that moves each body.
    last_dof: Vec<Option<usize>>,
    /// The degrees of freedom of each tree.
    pub(crate) trees: Vec<Range<usize>>,
    /// Pairs of geoms that can touch, in the order of their contacts, and when they are near
    /// enough.
    pub(crate) pairs: Vec<Pair>,
    pub(crate) reaches: Vec<Reach>,
    /// Joints with limits.
    pub(crate) limits: Vec<Limit>,
    /// Constraints of equality, friction and tendons.
    pub(crate) laws: Laws,
    /// Whether all rows push only, so that no row needs to say what it is.
    pub(crate) plain: bool,
    /// The tendons.
    pub(crate) paths: Paths,
    /// Whether all actuators are motors of slides and hinges, without anything else.
    pub(crate) motors: bool,
    /// Whether lengths and velocities of actuators are needed.
    pub(crate) transmits: bool,
    /// The periods of setpoints that are angles about any axis; 0 for others.
    pub(crate) periods: Vec<f64>,
    /// Whether the forces of actuators on a tendon are limited.
    pub(crate) tendon_forces: bool,
    /// Whether weights are lifted.
    pub(crate) gravcomp: bool,
    /// Whether there are sensors or energies.
    pub(crate) measures: bool,
    /// Whether forces between bodies are needed.
    pub(crate) internal: bool,
    /// Whether there are passive forces at all.
    pub(crate) passive: bool,
    /// The damping of each degree of freedom, unless it is switched off.
    pub(crate) damping: Vec<f64>,
    /// Gravity, unless it is switched off.
    pub(crate) gravity: [f64; 3],
    /// Whether Euler's integrator has damping to treat implicitly.
    pub(crate) implicit: bool,
    /// Joints with springs.
    pub(crate) springs: Vec<usize>,
    /// In a medium, the bodies with mass, and the edges of the box of equal inertia.
    pub(crate) boxes: Vec<(usize, Option<[f64; 3]>)>,
    /// How each body is placed in its parent's frame, its principal axes of inertia in its own, and
    /// each site in its body's.
    pub(crate) bodies: Vec<Placed>,
    pub(crate) inertias: Vec<Placed>,
    pub(crate) sites: Vec<Placed>,
    /// How each geom is placed in its body's frame; `None` for one whose frame is that of the
    /// body's inertia.
    pub(crate) geoms: Vec<Option<Placed>>,
    /// Whether each joint's anchor is not its body's origin.
    pub(crate) anchored: Vec<bool>,
}

/// The parts in which a frame differs from the frame that it is given in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) moved: bool,
    pub(crate) turned: bool,
}

impl Placed {
    fn new(pos: &[f64; 3], quat: &[f64; 4]) -> Self {
        Self {
            moved: *pos != [0.0; 3],
            turned: *quat != [1.0, 0.0, 0.0, 0.0],
        }
    }

    fn all(pos: &[[f64; 3]], quat: &[[f64; 4]]) -> Vec<Self> {
        pos.iter()
            .zip(quat)
            .map(|(pos, quat)| Self::new(pos, quat))
            .collect()
    }
}

/// The most constraints that a state can have, for buffers that never grow.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bounds {
    pub(crate) contacts: usize,
    /// Limits and contacts.
    pub(crate) blocks: usize,
    pub(crate) rows: usize,
}

/// A limited joint.
#[derive(Clone, Debug)]
pub(crate) struct Limit {
    pub(crate) joint: usize,
    /// Whether it bounds the angle of a ball.
    pub(crate) ball: bool,
    pub(crate) qpos: usize,
    pub(crate) dof: usize,
    pub(crate) tree: usize,
    pub(crate) range: [f64; 2],
    pub(crate) margin: f64,
    pub(crate) diag: f64,
    pub(crate) softness: Softness,
}

/// Two geoms that can touch, and everything about their contacts that does not depend on the state.
#[derive(Clone, Debug)]
pub(crate) struct Pair {
    /// The geoms; the first has the lower type.
    pub(crate) geom: [usize; 2],
    pub(crate) kind: (GeomType, GeomType),
    /// Contacts are listed below this distance: margins and gaps.
    pub(crate) margin: f64,
    /// Contacts act below this distance.
    pub(crate) includemargin: f64,
    /// Nothing can touch where centres are further apart; from a plane, where the centre is higher.
    pub(crate) reach: f64,
    pub(crate) dim: u8,
    /// The rows of a contact.
    pub(crate) rows: usize,
    pub(crate) friction: [f64; 5],
    pub(crate) solref: [f64; 2],
    pub(crate) solimp: [f64; 5],
    pub(crate) softness: Softness,
    /// Damping of sliding in elliptic cones.
    pub(crate) friction_damping: f64,
    /// The sum of the bodies' inverse weights of translation.
    pub(crate) diag: f64,
    /// The degrees of freedom that move one of the bodies and not the other, ascending, with the
    /// sign of the motion of the second body against the first.
    pub(crate) columns: Vec<Column>,
    /// The groups of four degrees of freedom up to the last of these.
    pub(crate) groups: usize,
    /// The trees of the bodies, if they can move.
    pub(crate) trees: [Option<usize>; 2],
}

impl Pair {
    /// Whether no closed form gives the contacts.
    pub(crate) fn is_convex(&self) -> bool {
        matches!(
            self.kind,
            (
                GeomType::Sphere | GeomType::Capsule | GeomType::Ellipsoid,
                GeomType::Ellipsoid
            ) | (
                GeomType::Capsule | GeomType::Ellipsoid | GeomType::Cylinder,
                GeomType::Cylinder
            ) | (GeomType::Ellipsoid | GeomType::Cylinder, GeomType::Box)
        )
    }
}

/// How near two geoms must be before they can touch. It is apart from the [`Pair`], which few pairs
/// need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    pub(crate) geom: [usize; 2],
    pub(crate) plane: bool,
    /// The height of the second one's centre above a plane, or the square of the distance of the
    /// centres.
    pub(crate) most: f64,
}

impl Reach {
    fn new(pair: &Pair) -> Self {
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
    /// The root of its body's tree.
    pub(crate) root: usize,
    pub(crate) sign: f64,
}

/// Impedance and reference acceleration of a constraint, as functions of its position.
#[derive(Clone, Debug)]
pub(crate) struct Softness {
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) dmin: f64,
    pub(crate) dmax: f64,
    pub(crate) width: f64,
    pub(crate) midpoint: f64,
    pub(crate) power: f64,
}

impl Softness {
    /// MuJoCo's `getsolparam` and the stiffness and damping of `mj_makeImpedance`.
    pub(crate) fn new(solref: [f64; 2], solimp: [f64; 5], opt: &Options) -> Self {
        const LEAST: f64 = 1e-15;
        let [dmin, dmax, width, midpoint, power] = solimp;
        let [dmin, dmax, midpoint] =
            [dmin, dmax, midpoint].map(|x| x.clamp(IMPEDANCE[0], IMPEDANCE[1]));
        let [mut time, ratio] = solref;
        if time > 0.0 && !opt.disables(Disable::RefSafe) {
            time = time.max(2.0 * opt.timestep);
        }
        Self {
            stiffness: if time > 0.0 {
                1.0 / f64::max(LEAST, dmax * dmax * time * time * ratio * ratio)
            } else {
                -time / f64::max(LEAST, dmax * dmax)
            },
            damping: if ratio > 0.0 {
                2.0 / f64::max(LEAST, dmax * time)
            } else {
                -ratio / f64::max(LEAST, dmax)
            },
            dmin,
            dmax,
            width: width.max(0.0),
            midpoint,
            power: power.max(1.0),
        }
    }
}

impl Plan {
    pub(super) fn new(m: &CompiledModel) -> Result<Self> {
        let mut ways: Vec<Vec<usize>> = Vec::new();
        let mut trees: Vec<Range<usize>> = Vec::new();
        for i in 0..m.nv() {
            let mut way =
                usize::try_from(m.dof_parentid[i]).map_or(vec![], |parent| ways[parent].clone());
            way.push(i);
            ways.push(way);
            match trees.get_mut(m.dof_treeid[i]) {
                Some(tree) => tree.end = i + 1,
                None => trees.push(i..i + 1),
            }
        }
        let m_groups = match ways
            .iter()
            .map(|way| way.len().div_ceil(4))
            .max()
            .unwrap_or(1)
        {
            few @ ..=4 => few,
            many => many.next_multiple_of(4),
        };
        let (mut m_rows, mut m_colind) = (Vec::new(), vec![0; 4 * m_groups * m.nv()]);
        for (i, way) in ways.iter().enumerate() {
            let row = 4 * m_groups * i..4 * m_groups * i + way.len();
            m_colind[row.clone()].copy_from_slice(way);
            m_rows.push(row);
        }
        let mut last_dof: Vec<Option<usize>> = Vec::new();
        for b in 0..m.nbody() {
            last_dof.push(match m.body_dofnum[b] {
                0 if b == 0 => None,
                0 => last_dof[m.body_parentid[b]],
                number => usize::try_from(m.body_dofadr[b])
                    .ok()
                    .map(|first| first + number - 1),
            });
        }
        let off = |part: Disable| m.opt.disables(part);
        let implicit = m.opt.integrator == Integrator::Euler
            && !off(Disable::EulerDamp)
            && !off(Disable::Damper)
            && m.dof_damping.iter().any(|&damping| damping > 0.0);
        let geoms = (0..m.ngeom()).map(|g| {
            let (b, pos, quat) = (m.geom_bodyid[g], &m.geom_pos[g], &m.geom_quat[g]);
            let inertial = *pos == m.body_ipos[b] && *quat == m.body_iquat[b];
            (!inertial).then(|| Placed::new(pos, quat))
        });
        let mut m_local = m_colind.clone();
        for (row, &tree) in m_rows.iter().zip(&m.dof_treeid) {
            m_local[row.clone()]
                .iter_mut()
                .for_each(|j| *j -= trees[tree].start);
        }
        let lead = |row: &Range<usize>| {
            let columns = &m_colind[row.clone()];
            (0..columns.len())
                .take_while(|&place| columns[place] == place)
                .count()
        };
        let m_lead: Vec<usize> = m_rows.iter().map(lead).collect();
        let mut plan = Self {
            m_fours: 2 * m_lead.iter().map(|lead| lead / 4).sum::<usize>() > m.nv(),
            m_lead,
            m_rows,
            m_groups,
            m_colind,
            m_local,
            last_dof,
            trees,
            pairs: Vec::new(),
            reaches: Vec::new(),
            limits: Vec::new(),
            plain: {
                let elliptic = m.opt.cone == Cone::Elliptic;
                !elliptic && !Laws::new(m).pull()
            },
            laws: Laws::new(m),
            paths: Paths::default(),
            motors: super::drives::motors(m),
            transmits: super::drives::transmits(m),
            periods: super::drives::periods(m),
            tendon_forces: m.tendon_actfrclimited.contains(&true),
            gravcomp: !off(Disable::Gravity)
                && m.opt.gravity != [0.0; 3]
                && m.body_gravcomp.iter().any(|part| *part != 0.0),
            measures: m.nsensor() > 0 || m.opt.enableflags != 0,
            internal: m
                .sensor_type
                .iter()
                .any(|kind| kind.stage() == Stage::Acceleration),
            passive: !off(Disable::Spring) || !off(Disable::Damper),
            damping: if off(Disable::Damper) {
                vec![0.0; m.nv()]
            } else {
                m.dof_damping.clone()
            },
            gravity: if off(Disable::Gravity) {
                [0.0; 3]
            } else {
                m.opt.gravity
            },
            implicit,
            springs: (0..m.njnt())
                .filter(|&j| m.jnt_stiffness[j] != 0.0 && !off(Disable::Spring))
                .collect(),
            boxes: boxes(m),
            bodies: Placed::all(&m.body_pos, &m.body_quat),
            inertias: Placed::all(&m.body_ipos, &m.body_iquat),
            sites: Placed::all(&m.site_pos, &m.site_quat),
            geoms: geoms.collect(),
            anchored: m.jnt_pos.iter().map(|pos| *pos != [0.0; 3]).collect(),
        };
        plan.paths = Paths::new(m, |body| plan.chain(body));
        let constraints = !off(Disable::Constraint);
        if constraints && !off(Disable::Contact) {
            plan.pairs = plan.find_pairs(m)?;
        }
        plan.reaches = plan.pairs.iter().map(Reach::new).collect();
        plan.limits = (0..m.njnt())
            .filter(|&j| constraints && !off(Disable::Limit) && m.jnt_limited[j])
            .map(|j| limit(m, j))
            .collect();
        Ok(plan)
    }

    /// The most constraints that there can be.
    pub(crate) fn bounds(&self) -> Bounds {
        // both sides of each limit
        let limits = 2 * self.limits.len();
        let (blocks, rows) = self.laws.most();
        let mut bounds = Bounds {
            contacts: 0,
            blocks: limits + blocks,
            rows: limits + rows,
        };
        for pair in &self.pairs {
            let contacts = most_contacts(pair.kind);
            bounds.contacts += contacts;
            bounds.blocks += contacts;
            bounds.rows += contacts * pair.rows;
        }
        // of so many rows hardly any state has all: buffers grow as they are needed
        const MOST_ROWS: usize = 4000;
        if bounds.rows > MOST_ROWS {
            Bounds::default()
        } else {
            bounds
        }
    }

    /// The elements of a row of the inertia matrix; the last is the diagonal.
    #[inline]
    pub(crate) fn m_row(&self, i: usize) -> Range<usize> {
        self.m_rows[i].clone()
    }

    /// The elements of a row but for the diagonal, which is behind them.
    #[inline]
    pub(crate) fn m_ancestors(&self, i: usize) -> Range<usize> {
        self.m_rows[i].start..self.m_diagonal(i)
    }

    /// How many of a row's columns are the model's first degrees of freedom.
    #[inline]
    pub(crate) fn m_lead(&self, i: usize) -> usize {
        self.m_lead[i]
    }

    /// Where the diagonal element of a row is.
    #[inline]
    pub(crate) fn m_diagonal(&self, i: usize) -> usize {
        self.m_rows[i].end - 1
    }

    /// The degrees of freedom that move a body, root first.
    #[inline]
    pub(crate) fn chain(&self, body: usize) -> &[usize] {
        self.last_dof[body].map_or(&[], |dof| &self.m_colind[self.m_row(dof)])
    }

    /// The pairs in the order of MuJoCo's `mj_collision`: by bodies, and within two bodies by the
    /// pairs' geoms.
    fn find_pairs(&self, m: &CompiledModel) -> Result<Vec<Pair>> {
        /// Of all pairs together: a model with more takes gigabytes.
        const MOST_COLUMNS: usize = 4_000_000;
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
                    Ok(())
                };
                // pairs that the model states come first, and replace others of these geoms
                let of_bodies = stated[next..].iter();
                let count = of_bodies
                    .take_while(|&&i| stated_bodies(m, i) == [b1, b2])
                    .count();
                let of_bodies = &stated[next..next + count];
                next += count;
                for &i in of_bodies {
                    let geoms = [m.pair_geom1[i], m.pair_geom2[i]];
                    push(&mut pairs, self.pair(m, geoms, Figures::stated(m, i))?)?;
                }
                if b1 == b2 || !bodies_collide(m, &excluded, b1, b2) {
                    continue;
                }
                let first = pairs.len();
                for g1 in geoms(m, b1) {
                    for g2 in geoms(m, b2) {
                        let meet = m.geom_contype[g1] & m.geom_conaffinity[g2]
                            | m.geom_contype[g2] & m.geom_conaffinity[g1];
                        let known = of_bodies.iter().any(|&i| {
                            let geoms = [m.pair_geom1[i], m.pair_geom2[i]];
                            geoms == [g1, g2] || geoms == [g2, g1]
                        });
                        if meet != 0 && !known {
                            push(
                                &mut pairs,
                                self.pair(m, [g1, g2], Figures::mixed(m, g1, g2))?,
                            )?;
                        }
                    }
                }
                pairs[first..].sort_by_key(|pair: &Pair| pair.geom);
            }
        }
        Ok(pairs)
    }

    /// The pair of two geoms; none for two planes, which never touch.
    ///
    /// # Errors
    /// For shapes whose contacts are not supported.
    fn pair(
        &self,
        m: &CompiledModel,
        [g1, g2]: [usize; 2],
        figures: Figures,
    ) -> Result<Option<Pair>> {
        let [g1, g2] = if m.geom_type[g1] > m.geom_type[g2] {
            [g2, g1]
        } else {
            [g1, g2]
        };
        let kind = (m.geom_type[g1], m.geom_type[g2]);
        if kind == (GeomType::Plane, GeomType::Plane) {
            return Ok(None);
        }
        let (b1, b2) = (m.geom_bodyid[g1], m.geom_bodyid[g2]);
        let Figures {
            dim,
            solref,
            solref_friction,
            solimp,
            includemargin,
            ..
        } = figures;
        let margin = includemargin + figures.gap;
        let tree = |b: usize| usize::try_from(m.body_treeid[b]).ok();
        let columns = self.columns(m, b1, b2);
        let softness = Softness::new(solref, solimp, &m.opt);
        let friction_damping = if solref_friction == [0.0; 2] {
            softness.damping
        } else {
            Softness::new(solref_friction, solimp, &m.opt).damping
        };
        Ok(Some(Pair {
            geom: [g1, g2],
            kind,
            margin,
            includemargin,
            reach: m.geom_rbound[g1] + m.geom_rbound[g2] + margin,
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
        }))
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
        columns.sort_by_key(|column| column.dof);
        columns
    }
}

/// The figures of the contacts of two geoms.
struct Figures {
    dim: u8,
    friction: [f64; 5],
    solref: [f64; 2],
    /// That of sliding in elliptic cones; zeros for the same.
    solref_friction: [f64; 2],
    solimp: [f64; 5],
    includemargin: f64,
    gap: f64,
}

impl Figures {
    /// Those of a pair that the model states.
    fn stated(m: &CompiledModel, i: usize) -> Self {
        Self {
            dim: m.pair_dim[i],
            friction: m.pair_friction[i],
            solref: m.pair_solref[i],
            solref_friction: m.pair_solreffriction[i],
            solimp: m.pair_solimp[i],
            includemargin: m.pair_margin[i],
            gap: m.pair_gap[i],
        }
    }

    /// Those that follow from the geoms.
    fn mixed(m: &CompiledModel, g1: usize, g2: usize) -> Self {
        let Mixed {
            dim,
            friction: [slide, spin, roll],
            solref,
            solimp,
        } = m.mixed(g1, g2);
        Self {
            dim,
            friction: [slide, slide, spin, roll, roll],
            solref,
            solref_friction: [0.0; 2],
            solimp,
            includemargin: m.geom_margin[g1] + m.geom_margin[g2],
            gap: m.geom_gap[g1] + m.geom_gap[g2],
        }
    }
}

/// The bodies of a pair that the model states, the lower first.
fn stated_bodies(m: &CompiledModel, i: usize) -> [usize; 2] {
    let [b1, b2] = [m.pair_geom1[i], m.pair_geom2[i]].map(|g| m.geom_bodyid[g]);
    [b1.min(b2), b1.max(b2)]
}

/// The most contacts of two shapes.
fn most_contacts(kind: (GeomType, GeomType)) -> usize {
    match kind {
        (GeomType::Plane, GeomType::Capsule) | (GeomType::Capsule, GeomType::Capsule) => 2,
        (GeomType::Capsule, GeomType::Box) => 2,
        (GeomType::Plane, GeomType::Cylinder | GeomType::Box) => 4,
        (GeomType::Box, GeomType::Box) => 8,
        (GeomType::Capsule | GeomType::Cylinder, GeomType::Cylinder | GeomType::Box) => 5,
        _ => 1,
    }
}

/// The boxes on which a medium acts, by their edges; none where it acts on the geoms of the body.
fn boxes(m: &CompiledModel) -> Vec<(usize, Option<[f64; 3]>)> {
    const LEAST: f64 = 1e-15;
    let medium = m.opt.density > 0.0 || m.opt.viscosity > 0.0;
    let heavy = (1..m.nbody()).filter(|&b| medium && m.body_mass[b] >= LEAST);
    let of = |b: usize| {
        if geoms(m, b).any(|g| m.geom_fluid[g].0[0] > 0.0) {
            return (b, None);
        }
        let ([i, j, k], mass) = (m.body_inertia[b], m.body_mass[b]);
        let edge = |a: f64, b: f64, c: f64| (f64::max(LEAST, a + b - c) / mass * 6.0).sqrt();
        (b, Some([edge(j, k, i), edge(i, k, j), edge(i, j, k)]))
    };
    heavy.map(of).collect()
}

/// `excluded` is sorted.
fn bodies_collide(m: &CompiledModel, excluded: &[u32], b1: usize, b2: usize) -> bool {
    let (w1, w2) = (m.body_weldid[b1], m.body_weldid[b2]);
    let parent = |w: usize| m.body_weldid[m.body_parentid[w]];
    let related = !m.opt.disables(Disable::FilterParent)
        && w1 != 0
        && w2 != 0
        && (w1 == parent(w2) || w2 == parent(w1));
    w1 != w2
        && !related
        && excluded
            .binary_search(&(((b1 as u32) << 16) + b2 as u32))
            .is_err()
}

fn geoms(m: &CompiledModel, body: usize) -> Range<usize> {
    usize::try_from(m.body_geomadr[body]).map_or(0..0, |first| first..first + m.body_geomnum[body])
}

fn limit(m: &CompiledModel, joint: usize) -> Limit {
    let dof = m.jnt_dofadr[joint];
    Limit {
        joint,
        ball: m.jnt_type[joint] == JointType::Ball,
        qpos: m.jnt_qposadr[joint],
        dof,
        tree: m.dof_treeid[dof],
        range: m.jnt_range[joint],
        margin: m.jnt_margin[joint],
        diag: m.dof_invweight0[dof],
        softness: Softness::new(m.jnt_solref[joint], m.jnt_solimp[joint], &m.opt),
    }
}
