//! Fields of a model that are computed from other fields, such as masses of subtrees and inverse
//! weights: MuJoCo's `mj_setConst`.

use crate::math::dense::dot_slices;
use crate::math::spatial::{
    EPS, InTurn, MINVAL, Order, Pairwise, add, cross, norm, rotate, rotate_back, sub,
};
use crate::mjcf::orientation::IDENTITY;
use crate::model::{
    CompiledModel, EqualityType, GeomType, JointType, ObjectType, WrapType, same, same_quat,
};
use crate::physics::{com_pos, crb, factor_m, kinematics, solve_m, tendon, transmission};
use crate::{Data, Model, Result};

impl Model {
    /// Changes fields of the model, and recomputes the fields that depend on them: MuJoCo's
    /// `mj_setConst`. On error, the model is unchanged.
    ///
    /// It recomputes the masses of subtrees, inverse weights and inertias, lengths of tendons and
    /// actuators, anchors of equality constraints, and `stat`. Unlike MuJoCo's function, it also
    /// recomputes the bounding radii of geoms, except of meshes, and `body_simple`. To change fields and recompute
    /// nothing, like a plain write to MuJoCo's `mjModel`, call
    /// [`into_compiled`](Self::into_compiled), change the result, and pass it to
    /// [`new`](Self::new).
    ///
    /// ```
    /// use mujoco_engine::Model;
    ///
    /// let text = r#"<mujoco><worldbody><body name="ball"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>"#;
    /// let mut m = Model::from_xml(text)?;
    /// let ball = m.body_id("ball").expect("the ball");
    /// m.change(|figures| {
    ///     figures.opt.gravity[2] = -1.62;
    ///     figures.body_mass[ball] *= 2.0;
    /// })?;
    /// assert_eq!(m.body_subtreemass[0], m.body_mass[ball]);
    /// # Ok::<(), mujoco_engine::Error>(())
    /// ```
    ///
    /// # Errors
    /// The errors of `new`.
    pub fn change(&mut self, change: impl FnOnce(&mut CompiledModel)) -> Result<()> {
        let mut figures = Box::new(CompiledModel::clone(self));
        change(&mut figures);
        // check lengths and ids before the first computation with them
        let mut figures = Box::new(boxed(*figures)?.into_compiled());
        bound_geoms(&mut figures);
        mark_simple(&mut figures);
        *self = Self::new(*with_constants(figures)?)?;
        Ok(())
    }
}

/// Computes the fields that depend on other fields.
pub(crate) fn with_constants(mut m: Box<CompiledModel>) -> Result<Box<CompiledModel>> {
    add_subtree_masses(&mut m);
    let mut d = add_inertia(&mut m)?;
    let model = boxed(*m)?;
    d.resize_for(&model);
    factor_inertia(&model, &mut d);
    Ok(Box::new(with_figures(&model, &mut d)))
}

// A model and its data take several kilobytes each. Unoptimised builds copy them at each move, so
// they are boxed, in functions of their own, to fit on a small stack.

fn boxed(m: CompiledModel) -> Result<Box<Model>> {
    Model::new(m).map(Box::new)
}

/// The radius of the bounding sphere of a shape; 0 for a plane or a height field. The size of a mesh
/// is that of a box around it.
pub(crate) fn bounding_radius(shape: GeomType, size: [f64; 3]) -> f64 {
    match shape {
        GeomType::Plane | GeomType::Hfield => 0.0,
        GeomType::Sphere => size[0],
        GeomType::Capsule => size[0] + size[1],
        GeomType::Cylinder => (size[0] * size[0] + size[1] * size[1]).sqrt(),
        GeomType::Ellipsoid => size[0].max(size[1]).max(size[2]),
        GeomType::Box | GeomType::Mesh => {
            (size[0] * size[0] + size[1] * size[1] + size[2] * size[2]).sqrt()
        }
    }
}

/// The radius of the bounding sphere of a height field.
pub(crate) fn hfield_radius([x, y, height, base]: [f64; 4]) -> f64 {
    (x * x + y * y + f64::max(height * height, base * base)).sqrt()
}

fn bound_geoms(m: &mut CompiledModel) {
    for g in 0..m.ngeom() {
        m.geom_rbound[g] = match m.geom_type[g] {
            // a mesh keeps its own, which does not follow from `geom_size`
            GeomType::Mesh => m.geom_rbound[g],
            GeomType::Hfield => hfield_radius(m.hfield_size(g)),
            kind => bounding_radius(kind, m.geom_size[g]),
        };
    }
}

fn add_subtree_masses(m: &mut CompiledModel) {
    m.body_subtreemass.clone_from(&m.body_mass);
    for b in (1..m.nbody()).rev() {
        m.body_subtreemass[m.body_parentid[b]] += m.body_subtreemass[b];
    }
}

/// Sets `body_simple`, which marks bodies whose part of the inertia matrix is diagonal. Such bodies
/// have no children, a parent that is fixed in the world, an inertial frame equal to the body's (up
/// to 1e-6, as in MuJoCo), and joints along coordinate axes: slides, then at most one hinge.
pub(crate) fn mark_simple(m: &mut CompiledModel) {
    m.body_simple.clear();
    for b in 0..m.nbody() {
        let origin = |pos: &[f64; 3]| same(pos, &[0.0; 3]);
        let own_frame = origin(&m.body_ipos[b]) && same_quat(&m.body_iquat[b], &IDENTITY);
        let parent = m.body_parentid[b];
        let rooted = parent == 0 || (m.body_parentid[parent] == 0 && m.body_jntnum[parent] == 0);
        m.body_simple.push(u8::from(own_frame && rooted));
        m.body_simple[parent] &= u8::from(parent == 0);
        let (mut turns, mut slides) = (false, 0);
        let first = usize::try_from(m.body_jntadr[b]).unwrap_or(0);
        for j in first..first + m.body_jntnum[b] {
            let aligned = m.jnt_axis[j].iter().filter(|x| x.abs() > EPS).count() == 1;
            if turns || !origin(&m.jnt_pos[j]) || (m.jnt_type[j].is_scalar() && !aligned) {
                m.body_simple[b] = 0;
            }
            turns |= matches!(m.jnt_type[j], JointType::Hinge | JointType::Ball);
            slides += usize::from(m.jnt_type[j] == JointType::Slide);
        }
        if m.body_simple[b] == 1 && slides > 0 && slides == m.body_jntnum[b] {
            m.body_simple[b] = 2;
        }
    }
    // tendons with inertia couple the bodies of their sites
    for t in (0..m.ntendon()).filter(|&t| m.tendon_armature[t] != 0.0) {
        for w in m.tendon_adr[t]..m.tendon_adr[t] + m.tendon_num[t] {
            if m.wrap_type[w] == WrapType::Site {
                m.body_simple[m.site_bodyid[m.wrap_objid[w] as usize]] = 0;
            }
        }
    }
    m.dof_simplenum = vec![0; m.nv()];
    let mut count = 0;
    for i in (0..m.nv()).rev() {
        count = if m.body_simple[m.dof_bodyid[i]] > 0 {
            count + 1
        } else {
            0
        };
        m.dof_simplenum[i] = count;
    }
}

/// Computes `dof_M0` and `meaninertia`, and returns the data of the initial configuration.
fn add_inertia(m: &mut CompiledModel) -> Result<Box<Data>> {
    // for simple bodies the engine reads `dof_M0`, which is not computed yet: mark none as simple
    m.dof_invweight0 = vec![0.0; m.nv()];
    m.dof_m0 = vec![0.0; m.nv()];
    m.body_invweight0 = vec![[0.0; 2]; m.nbody()];
    let general = without_simple_dofs(m)?;
    let mut d = Box::new(Data::new(&general));
    kinematics(&general, &mut d);
    com_pos(&general, &mut d);
    crb(&general, &mut d);
    let diagonal = |d: &Data| -> Vec<f64> {
        let last = |i| general.plan().m_row(i).end - 1;
        (0..m.nv()).map(|i| d.qm[last(i)]).collect()
    };
    let without_tendons = diagonal(&d);
    if general.plan().tendon_armature {
        // the inertia along tendons counts in all other constants
        tendon(&general, &mut d);
        crb(&general, &mut d);
    }
    m.stat.meaninertia = if m.nv() == 0 {
        1.0
    } else {
        diagonal(&d).iter().sum::<f64>() / m.nv() as f64
    };
    m.dof_m0 = without_tendons;
    Ok(d)
}

fn without_simple_dofs(m: &CompiledModel) -> Result<Box<Model>> {
    let mut m = m.clone();
    m.dof_simplenum.fill(0);
    boxed(m)
}

/// Factors the inertia matrix again, now with the diagonals of simple bodies.
fn factor_inertia(m: &Model, d: &mut Data) {
    crb(m, d);
    factor_m(m, d);
}

/// Computes the fields that depend on the factored inertia matrix.
fn with_figures(model: &Model, d: &mut Data) -> CompiledModel {
    let mut m = CompiledModel::clone(model);
    add_dof_weights(&mut m, model, d);
    add_body_weights(&mut m, model, d);
    add_equalities(&mut m, d);
    add_tendons(&mut m, model, d);
    add_actuators(&mut m, model, d);
    add_statistics(&mut m, d);
    if !m.tree_sleep_policy.is_empty() {
        super::sleep::add_lengths(&mut m, d);
    }
    add_springs(&mut m, model, d);
    m
}

/// `dof_invweight0`: the diagonal of the inverse inertia matrix. For a free joint it is averaged
/// over the three translations, and over the three rotations.
fn add_dof_weights(m: &mut CompiledModel, model: &Model, d: &Data) {
    let mut unit = vec![0.0; m.nv()];
    for i in 0..m.nv() {
        unit.fill(0.0);
        unit[i] = 1.0;
        solve_m(model, d, &mut unit);
        m.dof_invweight0[i] = unit[i];
    }
    for j in 0..m.njnt() {
        let first = m.jnt_dofadr[j];
        let threes: &[usize] = match m.jnt_type[j] {
            JointType::Free => &[0, 3],
            JointType::Ball => &[0],
            _ => &[],
        };
        for three in threes.iter().map(|three| first + three) {
            let mean = m.dof_invweight0[three..three + 3].iter().sum::<f64>() / 3.0;
            m.dof_invweight0[three..three + 3].fill(mean);
        }
        if threes.is_empty() && m.body_simple[m.jnt_bodyid[j]] == 2 {
            m.dof_invweight0[first] = 1.0 / m.body_mass[m.jnt_bodyid[j]];
        }
    }
}

/// `body_invweight0`: the mean of the diagonal of `J M^-1 J'`, where `J` is the Jacobian of the
/// centre of mass, for translation and for rotation.
fn add_body_weights(m: &mut CompiledModel, model: &Model, d: &Data) {
    let (mut row, mut solved) = (vec![0.0; m.nv()], vec![0.0; m.nv()]);
    for b in 1..m.nbody() {
        if model.plan().chain(b).is_empty() {
            continue;
        }
        if m.body_simple[b] == 2 {
            m.body_invweight0[b] = [1.0 / m.body_mass[b], 0.0];
            continue;
        }
        let com = d.subtree_com[m.body_rootid[b]];
        let offset: [f64; 3] = std::array::from_fn(|k| d.xipos[b][k] - com[k]);
        for kind in 0..2 {
            let mut trace = 0.0;
            for axis in 0..3 {
                row.fill(0.0);
                for &i in model.plan().chain(b) {
                    let [wx, wy, wz, vx, vy, vz] = d.cdof[i];
                    let turn = [wx, wy, wz];
                    let across = cross(turn, offset);
                    row[i] = if kind == 1 {
                        turn[axis]
                    } else {
                        [vx, vy, vz][axis] + across[axis]
                    };
                }
                solved.copy_from_slice(&row);
                solve_m(model, d, &mut solved);
                trace += dot_slices(&row, &solved);
            }
            m.body_invweight0[b][kind] = trace / 3.0;
        }
    }
}

/// The second anchor of connect constraints, and the relative pose of welds that give none.
fn add_equalities(m: &mut CompiledModel, d: &Data) {
    for i in 0..m.neq() {
        if m.eq_objtype[i] != ObjectType::Body {
            if m.eq_type[i] == EqualityType::Connect {
                m.eq_data[i] = [0.0; 11];
            }
            continue;
        }
        let ids = [m.eq_obj1id[i], m.eq_obj2id[i]].map(|id| usize::try_from(id).unwrap_or(0));
        let data = &mut m.eq_data[i];
        let weld = match m.eq_type[i] {
            EqualityType::Connect => false,
            EqualityType::Weld => true,
            EqualityType::Joint | EqualityType::Tendon => continue,
        };
        if weld && data[6..10].iter().any(|x| *x != 0.0) {
            let given = [data[6], data[7], data[8], data[9]];
            let quat = if m.revision.adds_in_pairs() {
                Pairwise::normalize_quat((), given)
            } else {
                InTurn::normalize_quat((), given)
            };
            data[6..10].copy_from_slice(&quat);
            continue;
        }
        let [from, to] = if weld { [ids[1], ids[0]] } else { ids };
        let anchor = rotate(&d.xmat[from], [data[0], data[1], data[2]]);
        let anchor = sub(add(anchor, d.xpos[from]), d.xpos[to]);
        data[3..6].copy_from_slice(&rotate_back(&d.xmat[to], anchor));
        if weld {
            let [w, x, y, z] = d.xquat[ids[0]];
            let (back, quat) = ([w, -x, -y, -z], d.xquat[ids[1]]);
            let pose = if m.revision.adds_in_pairs() {
                Pairwise::mul_quat(back, quat)
            } else {
                InTurn::mul_quat(back, quat)
            };
            data[6..10].copy_from_slice(&pose);
        }
    }
}

/// Lengths and inverse inertias of the tendons, and lengths and moments of the actuators.
fn add_tendons(m: &mut CompiledModel, model: &Model, d: &mut Data) {
    tendon(model, d);
    transmission(model, d);
    m.tendon_length0.clone_from(&d.ten_length);
    m.actuator_length0.clone_from(&d.actuator_length);
    let paths = &model.plan().paths;
    for (t, row) in paths.rows.iter().enumerate() {
        let columns = &paths.columns[row.clone()];
        let (along, solved) = response(model, d, columns, &d.ten_j[row.clone()]);
        m.tendon_invweight0[t] = dot_slices(&along, &solved);
    }
}

/// Returns a force on the degrees of freedom as a dense vector, and the acceleration by the force.
/// `values` has the elements of the force in `columns`; all others are zero.
fn response(model: &Model, d: &Data, columns: &[usize], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut dense = vec![0.0; model.nv()];
    for (&dof, value) in columns.iter().zip(values) {
        dense[dof] = *value;
    }
    let mut solved = dense.clone();
    solve_m(model, d, &mut solved);
    (dense, solved)
}

/// Computes `actuator_acc0`, and the damping of servos that is given as a ratio.
fn add_actuators(m: &mut CompiledModel, model: &Model, d: &Data) {
    for i in 0..m.nu() {
        let (columns, moments) = d.work.moments.row(i);
        let (dense, solved) = response(model, d, columns, moments);
        m.actuator_acc0[i] = dot_slices(&solved, &solved).sqrt();
        let kp = m.actuator_gainprm[i].0[0];
        let bias = &mut m.actuator_biasprm[i].0;
        if kp != -bias[1] || bias[2] <= 0.0 {
            continue;
        }
        let mass = if m.revision.damps_moved_inertia() {
            // the inertia that the actuator moves
            1.0 / dot_slices(&dense, &solved).max(MINVAL)
        } else {
            let mut mass = 0.0;
            for (&dof, moment) in columns.iter().zip(moments) {
                let square = moment.abs() * moment.abs();
                if square > MINVAL {
                    mass += m.dof_m0[dof] / square;
                }
            }
            mass
        };
        bias[2] = -(bias[2] * 2.0 * (kp * mass).sqrt());
    }
}

/// Sets the rest lengths of tendon springs without a given length to the lengths at the joints'
/// `springref`: MuJoCo's `setSpring`.
fn add_springs(m: &mut CompiledModel, model: &Model, d: &mut Data) {
    d.qpos.copy_from_slice(&model.qpos_spring);
    kinematics(model, d);
    com_pos(model, d);
    tendon(model, d);
    for (spring, length) in m.tendon_lengthspring.iter_mut().zip(&d.ten_length) {
        if *spring == [-1.0; 2] {
            *spring = [*length; 2];
        }
    }
}

/// The size of each body: the greatest distance from its centre of mass to its joints and geoms.
pub(crate) fn body_sizes(m: &CompiledModel, d: &Data) -> Vec<f64> {
    const LEAST: f64 = 1e-5;
    let distance = |a: [f64; 3], b: [f64; 3]| norm(sub(a, b));
    let mut size = vec![LEAST; m.nbody()];
    for j in 0..m.njnt() {
        let b = m.jnt_bodyid[j];
        // an anchor counts for both bodies that the joint connects
        for b in [b, m.body_parentid[b]] {
            size[b] = size[b].max(distance(d.xanchor[j], d.xipos[b]));
        }
    }
    for g in (0..m.ngeom()).filter(|g| m.geom_rbound[*g] > 0.0) {
        let b = m.geom_bodyid[g];
        size[b] = size[b].max(distance(d.geom_xpos[g], d.xipos[b]) + m.geom_rbound[g]);
    }
    size
}

/// Computes the sizes of bodies, and the model's statistics: MuJoCo's `setStat`.
fn add_statistics(m: &mut CompiledModel, d: &Data) {
    let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let mut cover = |centre: [f64; 3], radius: f64| {
        for k in 0..3 {
            min[k] = min[k].min(centre[k] - radius);
            max[k] = max[k].max(centre[k] + radius);
        }
    };
    for b in 1..m.nbody() {
        cover(d.xpos[b], 0.0);
        cover(d.xipos[b], 0.0);
    }
    d.xanchor.iter().for_each(|anchor| cover(*anchor, 0.0));
    d.site_xpos.iter().for_each(|site| cover(*site, 0.0));
    for g in 0..m.ngeom() {
        let [x, y, _] = m.geom_size[g];
        let plane = m.geom_rbound[g] == 0.0;
        let radius = match x.max(y) {
            _ if !plane => m.geom_rbound[g],
            infinite if infinite <= 0.0 => 0.01,
            half => half * 0.1,
        };
        cover(d.geom_xpos[g], radius);
    }
    (m.stat.meansize, m.stat.meanmass) = match m.nbody() - 1 {
        0 => (0.2, 1.0),
        n => {
            let sizes = &body_sizes(m, d)[1..];
            let sizes = sizes.iter().map(|size| size / n as f64).sum();
            (sizes, m.body_mass[1..].iter().sum::<f64>() / n as f64)
        }
    };
    (m.stat.extent, m.stat.center) = if min[0] <= max[0] {
        let sides = (0..3).map(|k| max[k] - min[k]);
        let extent = sides.fold(2.0 * m.stat.meansize, f64::max);
        (extent, std::array::from_fn(|k| (min[k] + max[k]) / 2.0))
    } else {
        (2.0, [0.0; 3])
    };
}
