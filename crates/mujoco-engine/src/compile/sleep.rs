//! The flag `sleep`: which trees of bodies may fall asleep.

use super::constants::body_sizes;
use super::fuse::Kept;
use crate::error::ensure;
use crate::mjcf::spec::{Sleep, Spec};
use crate::model::sleep_policy::{ALLOWED, AUTO, AUTO_ALLOWED, AUTO_NEVER, INIT, NEVER};
use crate::model::{
    CompiledModel, DynamicsType, EqualityType, Integrator, JointType, TransmissionType,
};
use crate::physics::trees_of_tendon;
use crate::{Data, Model, Result};

/// Adds the policies, if the flag is on and some tree may fall asleep: one that has no actuator,
/// unless its body says `sleep="never"`.
pub(super) fn add_policies(m: &mut CompiledModel, spec: &Spec, bodies: &[Kept<'_>]) -> Result<()> {
    let Some(flag) = &spec.sleep else {
        return Ok(());
    };
    let mut policies = vec![AUTO; m.ntree()];
    let tree = |body: usize| usize::try_from(m.body_treeid[body]).ok();
    for (id, kept) in bodies.iter().enumerate() {
        let policy = match kept.body.sleep {
            Sleep::Auto => continue,
            Sleep::Never => NEVER,
            Sleep::Allowed => ALLOWED,
            Sleep::Init => INIT,
        };
        let root = tree(id).filter(|_| tree(m.body_parentid[id]).is_none());
        let Some(tree) = root else {
            let reason = "only the first body of those that move together has it";
            return Err(kept.body.place.attribute("sleep", reason));
        };
        policies[tree] = policy;
    }
    let mut keep_awake = |tree: usize| {
        if policies[tree] == AUTO {
            policies[tree] = AUTO_NEVER;
        }
        policies[tree]
    };
    for i in 0..m.nu() {
        for tree in trees_of_actuator(m, i) {
            keep_awake(tree);
        }
    }
    for t in 0..m.ntendon() {
        let trees = all_trees_of_tendon(m, t);
        let pulls = m.tendon_stiffness[t] != 0.0
            || m.tendon_damping[t] != 0.0
            || m.tendon_stiffnesspoly[t] != [0.0; 2]
            || m.tendon_dampingpoly[t] != [0.0; 2]
            || (0..m.nu()).any(|i| {
                m.actuator_trntype[i] == TransmissionType::Tendon
                    && usize::try_from(m.actuator_trnid[i][0]) == Ok(t)
            });
        if trees.len() < 2 || (trees.len() == 2 && !pulls) {
            continue;
        }
        for tree in trees {
            if matches!(keep_awake(tree), ALLOWED | INIT) {
                let reason = "sleep is not possible for what a tendon pulls toward other bodies";
                return Err(flag.attribute("sleep", reason));
            }
        }
    }
    for policy in &mut policies {
        if *policy == AUTO {
            *policy = AUTO_ALLOWED;
        }
    }
    if policies
        .iter()
        .all(|policy| [AUTO_NEVER, NEVER].contains(policy))
    {
        return Ok(());
    }
    m.tree_sleep_policy = policies;
    limits(m).map_err(|error| flag.attribute("sleep", error.to_string()))
}

fn trees_of_actuator(m: &CompiledModel, i: usize) -> Vec<usize> {
    let id = usize::try_from(m.actuator_trnid[i][0]).unwrap_or(0);
    let body = match m.actuator_trntype[i] {
        TransmissionType::Joint | TransmissionType::JointInParent => m.jnt_bodyid[id],
        TransmissionType::Site | TransmissionType::SliderCrank => m.site_bodyid[id],
        TransmissionType::Body => id,
        TransmissionType::Tendon => return all_trees_of_tendon(m, id),
    };
    usize::try_from(m.body_treeid[body]).into_iter().collect()
}

fn all_trees_of_tendon(m: &CompiledModel, t: usize) -> Vec<usize> {
    trees_of_tendon(m, t).collect()
}

/// Refuses what MuJoCo or this engine cannot combine with trees that sleep.
fn limits(m: &CompiledModel) -> Result<()> {
    let sleeps = |tree: usize| ![AUTO_NEVER, NEVER].contains(&m.tree_sleep_policy[tree]);
    ensure!(
        m.opt.integrator != Integrator::RK4,
        "bodies that may fall asleep are not supported with the integrator RK4"
    );
    ensure!(
        !m.eq_type.contains(&EqualityType::Tendon),
        "bodies that may fall asleep do not go with equality constraints of tendons"
    );
    for i in 0..m.nu() {
        let active = m.actuator_dyntype[i] != DynamicsType::None;
        ensure!(
            !active || !trees_of_actuator(m, i).into_iter().any(sleeps),
            "actuator {i} has an activation and moves bodies that may fall asleep, which is not supported"
        );
    }
    Ok(())
}

/// Checks the arrays of a model whose flag is on.
pub(super) fn check(m: &CompiledModel) -> Result<()> {
    if !m.opt.sleeps() {
        return Ok(());
    }
    super::check::equal_lengths(
        m.ntree(),
        &[("tree_sleep_policy", m.tree_sleep_policy.len())],
    )?;
    super::check::equal_lengths(m.nv(), &[("dof_length", m.dof_length.len())])?;
    super::values::finite("dof_length", &m.dof_length)?;
    for (tree, policy) in m.tree_sleep_policy.iter().enumerate() {
        ensure!(
            (AUTO_NEVER..=INIT).contains(policy),
            "tree_sleep_policy[{tree}] is {policy}: use 1 to 5"
        );
    }
    limits(m)
}

/// Adds the lengths by which velocities are compared.
pub(super) fn add_lengths(m: &mut CompiledModel, d: &Data) {
    let sizes = body_sizes(m, d);
    m.dof_length = (0..m.nv())
        .map(|i| {
            let joint = m.dof_jntid[i];
            let offset = i - m.jnt_dofadr[joint];
            match m.jnt_type[joint] {
                JointType::Slide => 1.0,
                JointType::Free if offset < 3 => 1.0,
                _ => sizes[m.dof_bodyid[i]],
            }
        })
        .collect();
}

/// Refuses trees that are to sleep from the start, and cannot.
pub(super) fn check_start(m: &CompiledModel, spec: &Spec) -> Result<()> {
    let (Some(flag), true) = (&spec.sleep, m.tree_sleep_policy.contains(&INIT)) else {
        return Ok(());
    };
    if m.revision.wakes_from_the_start() {
        return Ok(());
    }
    // boxed, as unoptimised builds would copy them on the stack
    let m = Box::new(Model::new(m.clone())?);
    let d = Box::new(Data::new(&m));
    let mut trees = d.tree_asleep.iter().zip(&m.tree_sleep_policy);
    match trees.position(|(asleep, policy)| *policy == INIT && *asleep < 0) {
        None => Ok(()),
        Some(tree) => {
            let body = m.dof_bodyid[m.plan().trees[tree].start];
            let name = m.names.body[body].as_deref().unwrap_or("");
            let reason = format!(
                "body {name:?} cannot sleep from the start: all bodies that constraints connect must"
            );
            Err(flag.attribute("sleep", reason))
        }
    }
}
