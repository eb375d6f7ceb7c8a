//! Properties that the engine computes from a model once, such as the sparsity of the inertia
//! matrix.

use std::ops::Range;

use super::actuators::Motor;
use super::bounds::Tree;
use super::constraints::ModelConstraints;
use super::frames::{self, Body, Joint, Mount};
use super::memory;
use super::pairs::{Pair, Polygons, Reach, most_contacts};
use super::paths::Paths;
use super::{
    About, CompiledModel, Cone, Disable, GeomType, Integrator, JointType, SensorType, Softness,
    Stage, TransmissionType, actuators, linear,
};
use crate::Result;
use crate::error::ensure;
use crate::math::spatial::MINVAL;

/// Precomputed structure of a model.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// The elements of each row of the inertia matrix. All rows have the same number of groups of
    /// four elements, so that loops over rows have a fixed length.
    ///
    /// Row `i` holds the lower triangle: the degrees of freedom on the way from the root to `i`,
    /// ascending, `i` last.
    m_rows: Vec<Range<usize>>,
    /// The number of groups per row: up to four, or a multiple of four.
    pub(crate) m_groups: usize,
    /// Columns of the elements; zero after the end of a row.
    pub(crate) m_colind: Vec<usize>,
    /// The columns, counted from the first degree of freedom of the tree.
    pub(crate) m_local: Vec<usize>,
    /// The number of ancestors of each degree of freedom.
    pub(crate) depths: Vec<usize>,
    /// The last degree of freedom that moves each body.
    last_dof: Vec<Option<usize>>,
    /// The degrees of freedom of each tree.
    pub(crate) trees: Vec<Range<usize>>,
    /// Pairs of geoms that can touch, in the order of their contacts, and their distance tests.
    pub(crate) pairs: Vec<Pair>,
    pub(crate) reaches: Vec<Reach>,
    /// The boxes around the geoms of each body.
    pub(crate) bounds: Vec<Tree>,
    /// The sizes of polygons, if some pair needs the general routine for convex shapes.
    pub(crate) deep: Option<Polygons>,
    /// The model's sizes on which buffer sizes depend.
    pub(crate) sizes: [usize; 17],
    /// Joints with limits.
    pub(crate) limits: Vec<Limit>,
    /// Equality constraints, dry friction and tendon limits.
    pub(crate) constraints: ModelConstraints,
    /// Whether sums over degrees of freedom leave out those that a row does not depend on: MuJoCo's
    /// `mj_isSparse`.
    pub(crate) sparse: bool,
    /// Whether all constraint rows are inequalities: limits, and contacts without elliptic cones.
    /// Solvers then need not read the type of a row.
    pub(crate) inequalities_only: bool,
    /// Tendons.
    pub(crate) paths: Paths,
    /// The actuators, if all are motors (constant gain, no bias) on slides and hinges.
    pub(crate) motors: Option<Vec<Motor>>,
    /// Whether all actuator forces on degrees of freedom depend on controls alone.
    pub(crate) steady: bool,
    /// Whether all actuator forces are sums of a control term and a position term.
    pub(crate) servos: bool,
    /// Whether the engine must compute lengths and velocities of actuators.
    pub(crate) transmits: bool,
    /// The period of each actuator's setpoint if the setpoint is an angle; 0 for others.
    pub(crate) periods: Vec<f64>,
    /// Whether a tendon limits the total force of its actuators.
    pub(crate) tendon_forces: bool,
    /// Whether a tendon has inertia.
    pub(crate) tendon_armature: bool,
    /// Whether a geom's surface moves.
    pub(crate) surfaces: bool,
    /// Whether a body has gravity compensation.
    pub(crate) gravcomp: bool,
    /// Whether sensors or energies must be computed.
    pub(crate) measures: bool,
    /// Whether a sensor of the acceleration stage needs `cacc` and `cfrc_int`.
    pub(crate) internal: bool,
    /// Whether any passive force acts.
    pub(crate) passive: bool,
    /// The damping of each degree of freedom; zero if dampers are disabled.
    pub(crate) damping: Vec<f64>,
    /// Gravity; zero if disabled.
    pub(crate) gravity: [f64; 3],
    /// Whether Euler's method treats damping implicitly.
    pub(crate) damped: bool,
    /// Whether geoms attract others that they touch.
    pub(crate) adhesive: bool,
    /// Whether trees may fall asleep.
    pub(crate) sleeps: bool,
    /// Whether springs or dampers have factors of higher powers.
    pub(crate) polynomials: bool,
    /// Whether the model's integrator is Euler with implicit damping.
    pub(crate) implicit: bool,
    /// Joints with springs.
    pub(crate) springs: Vec<usize>,
    /// With a fluid: the bodies with mass, and for each the edges of the box of equal inertia.
    pub(crate) boxes: Vec<(usize, Option<[f64; 3]>)>,
    /// The bodies with a free joint and no child joints. `implicitfast` solves the six equations of
    /// each separately.
    pub(crate) free_bodies: Vec<usize>,
    pub(crate) bodies: Vec<Body>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) sites: Vec<Mount>,
    pub(crate) geoms: Vec<Mount>,
    /// Whether a timestep reads the frame of each geom, and the frames of sites.
    pub(crate) geoms_read: Vec<bool>,
    pub(crate) sites_read: bool,
}

/// The largest number of constraints, for buffers that never grow.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bounds {
    pub(crate) contacts: usize,
    /// Limits and contacts.
    pub(crate) blocks: usize,
    pub(crate) rows: usize,
    /// Whether some states may have more. Few do, and buffers then grow.
    pub(crate) exceeded: bool,
}

impl Bounds {
    /// The number of rows for which several worlds have room before they grow: of many, few are used.
    pub(crate) fn rows_of_worlds(&self) -> usize {
        const FEW: usize = 200;
        if self.exceeded { FEW } else { self.rows }
    }
}

/// The limit of a joint.
#[derive(Clone, Debug)]
pub(crate) struct Limit {
    pub(crate) joint: usize,
    /// Whether the joint is a ball joint; the limit then bounds its angle.
    pub(crate) ball: bool,
    pub(crate) qpos: usize,
    pub(crate) dof: usize,
    pub(crate) tree: usize,
    pub(crate) range: [f64; 2],
    pub(crate) margin: f64,
    pub(crate) diag: f64,
    pub(crate) softness: Softness,
}

impl Plan {
    pub(super) fn new(m: &CompiledModel) -> Result<Self> {
        memory::check_inertia(m)?;
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
        let most = ways.iter().map(|way| way.len().div_ceil(4)).max();
        let m_groups = match most.unwrap_or(1) {
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
            && (m.dof_damping.iter().any(|&damping| damping > 0.0) || !linear(&m.dof_dampingpoly));
        let mut m_local = m_colind.clone();
        for (row, &tree) in m_rows.iter().zip(&m.dof_treeid) {
            let local = m_local[row.clone()].iter_mut();
            local.for_each(|j| *j -= trees[tree].start);
        }
        let mut plan = Self {
            depths: ways.iter().map(|way| way.len() - 1).collect(),
            m_rows,
            m_groups,
            m_colind,
            m_local,
            last_dof,
            trees,
            pairs: Vec::new(),
            bounds: Vec::new(),
            reaches: Vec::new(),
            deep: None,
            sizes: [0; 17],
            limits: Vec::new(),
            sparse: m.opt.jacobian == 1 || m.opt.jacobian == 2 && m.nv() >= 60,
            inequalities_only: {
                let elliptic = m.opt.cone == Cone::Elliptic;
                !elliptic && !ModelConstraints::new(m).can_pull()
            },
            constraints: ModelConstraints::new(m),
            paths: Paths::default(),
            motors: actuators::motors(m),
            steady: actuators::steady(m),
            servos: actuators::servos(m),
            transmits: actuators::transmits(m),
            periods: actuators::periods(m),
            tendon_forces: m.tendon_actfrclimited.contains(&true),
            tendon_armature: m.tendon_armature.iter().any(|x| *x != 0.0),
            surfaces: m.geom_surfacevel.iter().any(|of| *of != [0.0; 6]),
            gravcomp: !off(Disable::Gravity)
                && m.opt.gravity != [0.0; 3]
                && m.body_gravcomp.iter().any(|part| *part != 0.0),
            measures: m.nsensor() > 0 || m.opt.enables(super::Options::ENERGY),
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
            sleeps: m.opt.sleeps(),
            adhesive: false,
            polynomials: ![
                &m.jnt_stiffnesspoly,
                &m.dof_dampingpoly,
                &m.tendon_stiffnesspoly,
                &m.tendon_dampingpoly,
            ]
            .into_iter()
            .all(|higher| linear(higher)),
            implicit: damped && m.opt.integrator == Integrator::Euler,
            damped,
            springs: (0..m.njnt())
                .filter(|&j| {
                    let bends = m.jnt_stiffnesspoly[j] != [0.0; 2];
                    (m.jnt_stiffness[j] != 0.0 || bends) && !off(Disable::Spring)
                })
                .collect(),
            boxes: boxes(m),
            free_bodies: (0..m.nbody()).filter(|&body| is_free(m, body)).collect(),
            bodies: frames::bodies(m),
            joints: frames::joints(m),
            sites: Mount::of_sites(m),
            geoms: Mount::of_geoms(m),
            geoms_read: Vec::new(),
            sites_read: false,
        };
        plan.paths = Paths::new(m, |body| plan.chain(body));
        let constraints = !off(Disable::Constraint);
        if constraints && !off(Disable::Contact) {
            plan.pairs = plan.find_pairs(m)?;
            plan.adhesive = plan.pairs.iter().any(|pair| pair.adhesion != 0.0);
        }
        ensure!(
            !off(Disable::NativeCcd) || !plan.pairs.iter().any(Pair::is_convex),
            "the flag nativeccd is disabled, and contacts by libccd, of ellipsoids, cylinders or meshes \
             with other shapes, are not supported: enable it"
        );
        // before the first step, not in it
        m.meshes.layouts();
        if m.sensor_type.contains(&SensorType::Rangefinder) {
            let meshes = (0..m.ngeom()).filter(|g| m.geom_type[*g] == GeomType::Mesh);
            for mesh in meshes.filter_map(|g| usize::try_from(m.geom_dataid[g]).ok()) {
                m.meshes.triangles(mesh);
            }
        }
        plan.deep = {
            let measured = |kind: &SensorType| kind.about() == About::Pair;
            let deep = plan.pairs.iter().any(Pair::is_convex) || m.sensor_type.iter().any(measured);
            deep.then(|| Polygons::new(m))
        };
        let paths = plan.paths.fixed.contains(&false);
        plan.geoms_read =
            vec![paths || m.geom_fluid.iter().any(|fluid| fluid.0[0] != 0.0); m.ngeom()];
        for g in plan.pairs.iter().flat_map(|pair| pair.geom) {
            plan.geoms_read[g] = true;
        }
        if plan.pairs.iter().any(|pair| pair.swept) {
            plan.geoms_read.fill(true);
        }
        plan.sites_read = paths
            || m.neq() > 0
            || m.actuator_trntype.contains(&TransmissionType::Site)
            || m.actuator_trntype.contains(&TransmissionType::SliderCrank);
        let tree = |body: usize| Tree::new(m, body, m.geoms_of(body));
        plan.bounds = (0..m.nbody()).map(tree).collect();
        plan.reaches = plan.pairs.iter().map(Reach::new).collect();
        let limits = constraints && !off(Disable::Limit);
        let limited = (0..m.njnt()).filter(|&j| limits && m.jnt_limited[j]);
        plan.limits = limited.map(|j| limit(m, j)).collect();
        memory::check_rows(m, &plan.bounds(), plan.sparse)?;
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
            plan.deep
                .map_or(0, |polygons| 1 + polygons.corners + polygons.degree),
            plan.deep.map_or(0, |polygons| polygons.iterations),
            usize::from(plan.sleeps),
        ];
        Ok(plan)
    }

    /// The largest number of constraints in any state, or a limit that few states reach.
    pub(crate) fn bounds(&self) -> Bounds {
        // both sides of each limit
        let limits = 2 * self.limits.len();
        let (blocks, rows) = self.constraints.most();
        let mut bounds = Bounds {
            contacts: 0,
            blocks: limits + blocks,
            rows: limits + rows,
            exceeded: false,
        };
        for pair in &self.pairs {
            let contacts = most_contacts(pair.kind);
            bounds.contacts += contacts;
            bounds.blocks += contacts;
            bounds.rows += contacts * pair.rows;
        }
        const MOST_ROWS: usize = 4000;
        Bounds {
            contacts: bounds.contacts.min(MOST_ROWS),
            blocks: bounds.blocks.min(MOST_ROWS),
            rows: bounds.rows.min(MOST_ROWS),
            exceeded: bounds.rows > MOST_ROWS,
        }
    }

    /// The elements of a row of the inertia matrix; the last is the diagonal.
    #[inline]
    pub(crate) fn m_row(&self, i: usize) -> Range<usize> {
        self.m_rows[i].clone()
    }

    /// The elements of a row before the diagonal.
    #[inline]
    pub(crate) fn m_ancestors(&self, i: usize) -> Range<usize> {
        self.m_rows[i].start..self.m_diagonal(i)
    }

    /// The index of a row's diagonal element.
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

/// Whether a free joint moves a body, and no other body with mass: MuJoCo's `mj_isFreeBody`.
fn is_free(m: &CompiledModel, body: usize) -> bool {
    let mut joints = m.jnt_bodyid.iter().zip(&m.jnt_type);
    let free = joints.find(|(of, _)| **of == body).map(|(_, kind)| *kind);
    let dof = usize::try_from(m.body_dofadr[body]).ok();
    let tree = dof.map(|dof| m.dof_treeid[dof]);
    let dofs = m.dof_treeid.iter().filter(|of| Some(**of) == tree).count();
    free == Some(JointType::Free) && dofs == 6 && m.body_subtreemass[body] == m.body_mass[body]
}

/// The boxes on which the fluid acts, by their edges; `None` if the ellipsoid model applies to the
/// body's geoms.
fn boxes(m: &CompiledModel) -> Vec<(usize, Option<[f64; 3]>)> {
    let medium = m.opt.density > 0.0 || m.opt.viscosity > 0.0;
    let heavy = (1..m.nbody()).filter(|&b| medium && m.body_mass[b] >= MINVAL);
    let of = |b: usize| {
        if m.geoms_of(b).any(|g| m.geom_fluid[g].0[0] > 0.0) {
            return (b, None);
        }
        let ([i, j, k], mass) = (m.body_inertia[b], m.body_mass[b]);
        let edge = |a: f64, b: f64, c: f64| (f64::max(MINVAL, a + b - c) / mass * 6.0).sqrt();
        (b, Some([edge(j, k, i), edge(i, k, j), edge(i, j, k)]))
    };
    heavy.map(of).collect()
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
