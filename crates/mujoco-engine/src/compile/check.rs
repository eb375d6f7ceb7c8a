//! Refuses models on which the engine would compute wrong results or panic.

use std::fmt::Display;

use super::{features, hfields, meshes, sleep, textures, values};
use crate::error::ensure;
use crate::mjcf::{MOST, MOST_KEYS};
use crate::model::{CompiledModel, GeomType, JointType};
use crate::{Error, Model, Result};

impl Model {
    /// Checks the model, and precomputes what the engine needs.
    ///
    /// # Errors
    /// [`Error::Model`] if arrays have different lengths, ids point nowhere, numbers are not
    /// finite, a number is one that MJCF refuses (such as a negative mass, damping or friction, a
    /// range in the wrong order, an impedance outside 0 to 1), or the model needs an unsupported
    /// feature; the message names the array and the element.
    pub fn new(mut compiled: CompiledModel) -> Result<Self> {
        compiled.complete();
        check(&compiled)?;
        compiled.meshes.mark_checked();
        Self::planned(compiled)
    }
}

impl TryFrom<CompiledModel> for Model {
    type Error = Error;

    fn try_from(compiled: CompiledModel) -> Result<Self> {
        Self::new(compiled)
    }
}

/// Checks lengths, ids, order and ranges of everything that the engine reads.
pub(super) fn check(m: &CompiledModel) -> Result<()> {
    counts(m)?;
    lengths(m)?;
    bodies(m)?;
    joints(m)?;
    geoms(m)?;
    meshes::check(m)?;
    hfields::check(m)?;
    textures::check(m)?;
    others(m)?;
    features::check(m)?;
    sleep::check(m)?;
    values::check(m)
}

fn bad(what: String) -> Error {
    Error::Model(what)
}

/// Checks that every named array has the length of its group.
macro_rules! same_length {
    ($m:ident, $length:expr, $($field:ident)+) => {
        $crate::compile::check::equal_lengths($length, &[$((stringify!($field), $m.$field.len())),+])?;
    };
}

pub(super) use same_length;

pub(super) fn equal_lengths(expected: usize, arrays: &[(&str, usize)]) -> Result<()> {
    for (name, length) in arrays {
        ensure!(
            *length == expected,
            "{name} has {length} elements, expected {expected}"
        );
    }
    Ok(())
}

/// Refuses more than [`MOST`] objects of a kind: the engine allocates products of these numbers.
fn counts(m: &CompiledModel) -> Result<()> {
    let keys = m.key_time.len();
    ensure!(
        keys <= MOST_KEYS,
        "{keys} keyframes: more than {MOST_KEYS} are not supported"
    );
    for (kind, count) in [
        ("bodies", m.nbody()),
        ("geoms", m.ngeom()),
        ("meshes", m.nmesh()),
        ("height fields", m.nhfield()),
        ("joints", m.njnt()),
        ("degrees of freedom", m.nv()),
        ("actuators", m.nu()),
        ("tendons", m.ntendon()),
        ("parts of tendons", m.wrap_objid.len()),
        ("equality constraints", m.neq()),
        ("sensors", m.nsensor()),
        ("pairs", m.pair_dim.len()),
        ("excludes", m.exclude_signature.len()),
    ] {
        ensure!(
            count <= MOST,
            "{count} {kind}: more than {MOST} are not supported"
        );
    }
    Ok(())
}

fn lengths(m: &CompiledModel) -> Result<()> {
    same_length!(m, m.nq(), qpos_spring);
    same_length!(
        m, m.nbody(),
        body_rootid body_weldid body_treeid body_jntnum body_jntadr body_dofnum body_dofadr
        body_geomnum body_geomadr body_simple body_pos body_quat body_ipos body_iquat body_mass
        body_subtreemass body_inertia body_invweight0 body_mocapid body_gravcomp
    );
    same_length!(
        m, m.njnt(),
        jnt_qposadr jnt_dofadr jnt_bodyid jnt_limited jnt_pos jnt_axis jnt_range jnt_margin
        jnt_stiffness jnt_stiffnesspoly jnt_solref jnt_solimp jnt_actfrclimited jnt_actfrcrange jnt_actgravcomp
    );
    same_length!(
        m, m.nv(),
        dof_frictionloss dof_solref dof_solimp dof_jntid dof_parentid dof_treeid dof_simplenum
        dof_armature dof_damping dof_dampingpoly dof_invweight0 dof_m0
    );
    same_length!(
        m, m.ngeom(),
        geom_bodyid geom_contype geom_conaffinity geom_condim geom_priority geom_size geom_rbound
        geom_pos geom_quat geom_friction geom_solmix geom_solref geom_solimp geom_margin geom_gap geom_adhesion
        geom_rgba geom_group geom_matid geom_fluid geom_surfacevel
    );
    same_length!(m, m.mat_rgba.len(), mat_texid mat_texrepeat mat_texuniform mat_emission mat_specular mat_shininess);
    same_length!(m, m.nsite(), site_pos site_quat site_type site_size site_rgba site_group);
    same_length!(
        m, m.cam_bodyid.len(),
        cam_mode cam_targetbodyid cam_pos cam_quat cam_fovy cam_projection cam_resolution cam_sensorsize
        cam_intrinsic
    );
    same_length!(
        m, m.nu(),
        actuator_trntype actuator_gear actuator_dyntype actuator_gaintype actuator_biastype
        actuator_dynprm actuator_gainprm actuator_biasprm actuator_ctrllimited actuator_ctrlrange
        actuator_forcelimited actuator_forcerange actuator_actlimited actuator_actrange
        actuator_actadr actuator_actearly actuator_group actuator_lengthrange actuator_length0
        actuator_acc0 actuator_cranklength
    );
    same_length!(
        m, m.ntendon(),
        tendon_num tendon_limited tendon_range tendon_margin tendon_stiffness tendon_damping
        tendon_stiffnesspoly tendon_dampingpoly tendon_frictionloss tendon_armature tendon_lengthspring tendon_length0 tendon_invweight0
        tendon_actfrclimited tendon_actfrcrange tendon_solref_lim tendon_solimp_lim
        tendon_solref_fri tendon_solimp_fri
    );
    same_length!(m, m.wrap_objid.len(), wrap_type wrap_prm);
    same_length!(m, m.neq(), eq_objtype eq_obj1id eq_obj2id eq_active0 eq_solref eq_solimp eq_data);
    same_length!(
        m, m.nsensor(),
        sensor_objtype sensor_objid sensor_reftype sensor_refid sensor_intprm sensor_dim sensor_adr sensor_cutoff
        sensor_noise
    );
    same_length!(
        m, m.pair_dim.len(),
        pair_geom1 pair_geom2 pair_solref pair_solreffriction pair_solimp pair_margin pair_gap pair_adhesion
        pair_friction
    );
    same_length!(m, m.key_time.len(), key_qpos key_qvel key_ctrl key_act key_mpos key_mquat);
    Ok(())
}

/// Requires an element of an array to be the number that follows from others.
pub(super) fn same<T>(array: &str, i: usize, is: T, of: T) -> Result<()>
where
    T: Copy + Display + PartialEq,
{
    ensure!(is == of, "{array}[{i}] is {is}, expected {of}");
    Ok(())
}

fn bodies(m: &CompiledModel) -> Result<()> {
    ensure!(m.nbody() > 0, "there is no body: body 0 must be the world");
    ensure!(
        m.body_parentid[0] == 0 && m.body_jntnum[0] == 0 && m.body_dofnum[0] == 0,
        "body 0 must be the world"
    );
    let (mut next, mut mocaps) = ([0; 3], 0);
    for b in 0..m.nbody() {
        let parent = m.body_parentid[b];
        ensure!(
            b == 0 || parent < b,
            "body_parentid[{b}] is {parent}, which is not before the body"
        );
        let inherited = |own: bool, ids: &[usize]| if own { b } else { ids[parent] };
        let root = inherited(b == 0 || parent == 0, &m.body_rootid);
        same("body_rootid", b, m.body_rootid[b], root)?;
        let mocap = m.body_mocapid[b] >= 0;
        ensure!(
            !mocap || (b > 0 && parent == 0 && m.body_jntnum[b] == 0),
            "body {b} is a mocap body, but not a child of the world without joints"
        );
        if mocap {
            same("body_mocapid", b, m.body_mocapid[b], mocaps)?;
            mocaps += 1;
        }
        let weld = inherited(b == 0 || mocap || m.body_jntnum[b] > 0, &m.body_weldid);
        same("body_weldid", b, m.body_weldid[b], weld)?;
        let parts = [
            ("jnt", m.body_jntnum[b], m.body_jntadr[b], m.njnt()),
            ("dof", m.body_dofnum[b], m.body_dofadr[b], m.nv()),
            ("geom", m.body_geomnum[b], m.body_geomadr[b], m.ngeom()),
        ];
        for ((name, number, address, total), next) in parts.into_iter().zip(&mut next) {
            ensure!(
                number <= total - *next,
                "body_{name}num[{b}] is {number}, beyond the last"
            );
            let expected = if number == 0 { -1 } else { *next as i32 };
            ensure!(
                address == expected,
                "body_{name}adr[{b}] is {address}: the bodies' elements must follow each other, and it is -1 where there is none"
            );
            *next += number;
        }
    }
    ensure!(
        next == [m.njnt(), m.nv(), m.ngeom()],
        "joints, dofs or geoms belong to no body"
    );
    Ok(())
}

fn joints(m: &CompiledModel) -> Result<()> {
    let (mut qpos, mut dof) = (0, 0);
    for j in 0..m.njnt() {
        let body = m.jnt_bodyid[j];
        ensure!(
            owns(m.body_jntadr.get(body), m.body_jntnum.get(body), j),
            "jnt_bodyid[{j}] is {body}, which lacks the joint"
        );
        ensure!(
            m.jnt_qposadr[j] == qpos && m.jnt_dofadr[j] == dof,
            "joint {j} does not follow the joint before it"
        );
        let (nq, nv) = (m.jnt_type[j].nq(), m.jnt_type[j].nv());
        let free = m.jnt_type[j] == JointType::Free;
        ensure!(
            !free || (m.body_jntnum[body] == 1 && m.body_parentid[body] == 0),
            "joint {j} is free, but not the only one of a child of the world"
        );
        ensure!(
            !free || !m.jnt_limited[j],
            "joint {j} is free, and cannot be limited"
        );
        qpos += nq;
        for i in dof..dof + nv {
            ensure!(
                m.dof_jntid.get(i) == Some(&j) && m.dof_bodyid[i] == body,
                "dof {i} is not of joint {j}"
            );
            let parent = if i > m.body_dofadr[body].max(0) as usize {
                i as i32 - 1
            } else {
                m.last_dof(m.body_parentid[body])
            };
            same("dof_parentid", i, m.dof_parentid[i], parent)?;
            let mut before = i as i32 - 1;
            while before > parent {
                before = m.dof_parentid[before as usize];
            }
            ensure!(
                before == parent,
                "dof_parentid[{i}] is {parent}: a degree of freedom must follow its parent or a descendant of it"
            );
            let tree = match usize::try_from(parent) {
                Ok(parent) => m.dof_treeid[parent],
                Err(_) if i == 0 => 0,
                Err(_) => m.dof_treeid[i - 1] + 1,
            };
            same("dof_treeid", i, m.dof_treeid[i], tree)?;
        }
        dof += nv;
    }
    ensure!(
        qpos == m.nq() && dof == m.nv(),
        "qpos0 or the dofs do not fit the joints"
    );
    for b in 0..m.nbody() {
        let dof = m.last_dof(b);
        let tree = usize::try_from(dof).map_or(-1, |dof| m.dof_treeid[dof] as i32);
        same("body_treeid", b, m.body_treeid[b], tree)?;
    }
    for (i, &count) in m.dof_simplenum.iter().enumerate() {
        ensure!(
            count <= m.nv() - i,
            "dof_simplenum[{i}] is {count}, beyond the last"
        );
    }
    Ok(())
}

fn owns(address: Option<&i32>, number: Option<&usize>, element: usize) -> bool {
    match (address.map(|a| usize::try_from(*a)), number) {
        (Some(Ok(address)), Some(number)) => (address..address + number).contains(&element),
        _ => false,
    }
}

fn geoms(m: &CompiledModel) -> Result<()> {
    for g in 0..m.ngeom() {
        let body = m.geom_bodyid[g];
        ensure!(
            owns(m.body_geomadr.get(body), m.body_geomnum.get(body), g),
            "geom_bodyid[{g}] is {body}, which lacks the geom"
        );
        ensure!(
            matches!(m.geom_condim[g], 1 | 3 | 4 | 6),
            "geom_condim[{g}] is {}: use 1, 3, 4 or 6",
            m.geom_condim[g]
        );
        let needed = match m.geom_type[g] {
            GeomType::Plane | GeomType::Hfield | GeomType::Mesh => 0,
            GeomType::Sphere => 1,
            GeomType::Capsule | GeomType::Cylinder => 2,
            GeomType::Ellipsoid | GeomType::Box => 3,
        };
        ensure!(
            m.geom_size[g][..needed].iter().all(|&s| s > 0.0),
            "geom_size[{g}] must be positive"
        );
        let material = usize::try_from(m.geom_matid[g]);
        ensure!(
            material.is_ok_and(|id| id < m.mat_rgba.len()) || m.geom_matid[g] == -1,
            "geom_matid[{g}] is {}, and there are {} materials",
            m.geom_matid[g],
            m.mat_rgba.len()
        );
    }
    Ok(())
}

fn others(m: &CompiledModel) -> Result<()> {
    let body = |what: &str, ids: &[usize]| match ids.iter().position(|&b| b >= m.nbody()) {
        Some(i) => Err(bad(format!(
            "{what}[{i}] is {}, but there are {} bodies",
            ids[i],
            m.nbody()
        ))),
        None => Ok(()),
    };
    body("site_bodyid", &m.site_bodyid)?;
    body("cam_bodyid", &m.cam_bodyid)?;
    for (i, &target) in m.cam_targetbodyid.iter().enumerate() {
        ensure!(
            m.cam_mode[i] <= 4,
            "cam_mode[{i}] is {}: use 0 to 4",
            m.cam_mode[i]
        );
        let exists = usize::try_from(target).is_ok_and(|b| b < m.nbody());
        ensure!(
            exists || target == -1,
            "cam_targetbodyid[{i}] is {target}, and there are {} bodies",
            m.nbody()
        );
    }
    for k in 0..m.key_time.len() {
        ensure!(
            m.key_qpos[k].len() == m.nq()
                && m.key_qvel[k].len() == m.nv()
                && m.key_ctrl[k].len() == m.nu()
                && m.key_act[k].len() == m.na()
                && m.key_mpos[k].len() == 3 * m.nmocap()
                && m.key_mquat[k].len() == 4 * m.nmocap(),
            "keyframe {k} has another size than the model"
        );
    }
    Ok(())
}
