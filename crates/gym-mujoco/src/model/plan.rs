//! Facts that the engine computes from a model once, such as the sparsity of the inertia matrix.

use std::ops::Range;

use super::bounds::Tree;
use super::laws::Laws;
use super::pairs::{Pair, Reach, most_contacts};
use super::paths::Paths;
use super::{
    CompiledModel, Cone, Disable, Integrator, JointType, Options, Stage, TransmissionType,
};
use crate::Result;

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
    /// The boxes around the geoms of each body.
    pub(crate) bounds: Vec<Tree>,
    /// Whether the depth of some takes a polytope.
    pub(crate) deep: bool,
    /// What the sizes of buffers depend on.
    pub(crate) sizes: [usize; 15],
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
    /// Whether the forces of all actuators on degrees of freedom follow from controls alone.
    pub(crate) steady: bool,
    /// Whether they follow from controls and positions, as a sum.
    pub(crate) servos: bool,
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
    /// Whether Euler's method has damping to treat implicitly.
    pub(crate) damped: bool,
    /// Whether it does, as the integrator of the model.
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
    /// Whether a timestep reads the frame of each geom, and those of sites.
    pub(crate) geoms_read: Vec<bool>,
    pub(crate) sites_read: bool,
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
    /// A frame in that of its parent.
    fn new(pos: &[f64; 3], quat: &[f64; 4]) -> Self {
        Self {
            moved: *pos != [0.0; 3],
            turned: *quat != [1.0, 0.0, 0.0, 0.0],
        }
    }

    /// A frame in that of its body, which takes that frame where it hardly differs: MuJoCo's
    /// `sameframe`.
    fn within(pos: &[f64; 3], quat: &[f64; 4]) -> Self {
        let turned = !same_quat(quat, &[1.0, 0.0, 0.0, 0.0]);
        Self {
            moved: *pos != [0.0; 3] && (turned || !same(pos, &[0.0; 3])),
            turned,
        }
    }

    fn all(
        place: fn(&[f64; 3], &[f64; 4]) -> Self,
        pos: &[[f64; 3]],
        quat: &[[f64; 4]],
    ) -> Vec<Self> {
        let both = pos.iter().zip(quat);
        both.map(|(pos, quat)| place(pos, quat)).collect()
    }
}

/// Whether numbers hardly differ.
pub(crate) fn same(a: &[f64], b: &[f64]) -> bool {
    const NEAR: f64 = 1e-6;
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < NEAR)
}

/// Whether orientations hardly differ.
pub(crate) fn same_quat(a: &[f64; 4], b: &[f64; 4]) -> bool {
    same(a, b) || same(a, &b.map(|x| -x))
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
        let damped = !off(Disable::EulerDamp)
            && !off(Disable::Damper)
            && m.dof_damping.iter().any(|&damping| damping > 0.0);
        let geoms = (0..m.ngeom()).map(|g| {
            let (b, pos, quat) = (m.geom_bodyid[g], &m.geom_pos[g], &m.geom_quat[g]);
            let (inertia_pos, inertia_quat) = (&m.body_ipos[b], &m.body_iquat[b]);
            let placed = Placed::within(pos, quat);
            let near = same(pos, inertia_pos) && same_quat(quat, inertia_quat);
            let inertial = (pos, quat) == (inertia_pos, inertia_quat) || (placed.turned && near);
            (!inertial).then_some(placed)
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
            bounds: Vec::new(),
            reaches: Vec::new(),
            deep: false,
            sizes: [0; 15],
            limits: Vec::new(),
            plain: {
                let elliptic = m.opt.cone == Cone::Elliptic;
                !elliptic && !Laws::new(m).pull()
            },
            laws: Laws::new(m),
            paths: Paths::default(),
            motors: super::drives::motors(m),
            steady: super::drives::steady(m),
            servos: super::drives::servos(m),
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
            implicit: damped && m.opt.integrator == Integrator::Euler,
            damped,
            springs: (0..m.njnt())
                .filter(|&j| m.jnt_stiffness[j] != 0.0 && !off(Disable::Spring))
                .collect(),
            boxes: boxes(m),
            bodies: Placed::all(Placed::new, &m.body_pos, &m.body_quat),
            inertias: Placed::all(Placed::within, &m.body_ipos, &m.body_iquat),
            sites: Placed::all(Placed::within, &m.site_pos, &m.site_quat),
            geoms: geoms.collect(),
            geoms_read: Vec::new(),
            sites_read: false,
            anchored: m.jnt_pos.iter().map(|pos| *pos != [0.0; 3]).collect(),
        };
        plan.paths = Paths::new(m, |body| plan.chain(body));
        let constraints = !off(Disable::Constraint);
        if constraints && !off(Disable::Contact) {
            plan.pairs = plan.find_pairs(m)?;
        }
        plan.deep = plan.pairs.iter().any(Pair::is_convex);
        let paths = plan.measures || plan.paths.fixed.contains(&false);
        plan.geoms_read =
            vec![paths || m.geom_fluid.iter().any(|fluid| fluid.0[0] != 0.0); m.ngeom()];
        for g in plan.pairs.iter().flat_map(|pair| pair.geom) {
            plan.geoms_read[g] = true;
        }
        plan.sites_read =
            paths || m.neq() > 0 || m.actuator_trntype.contains(&TransmissionType::Site);
        plan.bounds = (0..m.nbody())
            .map(|body| Tree::new(m, body, self::geoms(m, body)))
            .collect();
        plan.reaches = plan.pairs.iter().map(Reach::new).collect();
        plan.limits = (0..m.njnt())
            .filter(|&j| constraints && !off(Disable::Limit) && m.jnt_limited[j])
            .map(|j| limit(m, j))
            .collect();
        plan.sizes = [
            m.nq(),
            m.nv(),
            m.nu(),
            m.nbody(),
            m.njnt(),
            m.ngeom(),
            m.nsite(),
            plan.m_colind.len(),
            m.na(),
            m.nsensordata(),
            plan.paths.columns.len(),
            m.ntendon(),
            m.ntree(),
            m.opt.integrator as usize,
            usize::from(plan.deep),
        ];
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

pub(super) fn geoms(m: &CompiledModel, body: usize) -> Range<usize> {
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
