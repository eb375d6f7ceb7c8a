//! Trees of bodies that rest fall asleep: MuJoCo's `engine_sleep`.
//!
//! A tree whose velocities stay below a tolerance for ten steps falls asleep, together with all trees
//! of its island. Its velocities are then zero, it has no constraints, and its sensors keep their
//! values. What touches it, or pushes it, wakes it.
//!
//! Stages compute frames and inertias of sleeping trees too, because they do not change. Forces and
//! accelerations of the last step before a tree slept are kept.

use super::collision::collision;
use super::rows::reached_limits;
use super::{ALL, first_stages, last_stages, measure};
use crate::model::sleep_policy::{AUTO_NEVER, INIT, NEVER};
use crate::model::{
    CompiledModel, Disable, EqualityType, ObjectType, Pair, SensorType, Stage, TransmissionType,
    WrapType,
};
use crate::{Data, Model};

/// `tree_asleep` of a tree that is awake: -1 minus the number of steps before it may fall asleep.
pub(crate) const AWAKE: i32 = -11;

/// MuJoCo's `mjtSleepState`.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Static,
    Asleep,
    Awake,
}

fn of_body(m: &CompiledModel, awake: &[bool], body: usize) -> State {
    match usize::try_from(m.body_treeid[body]) {
        Ok(tree) if awake[tree] => State::Awake,
        Ok(_) => State::Asleep,
        Err(_) if m.body_mocapid[m.body_rootid[body]] >= 0 => State::Awake,
        Err(_) => State::Static,
    }
}

/// The trees that a tendon moves.
pub(crate) fn trees_of_tendon(m: &CompiledModel, tendon: usize) -> impl Iterator<Item = usize> {
    let parts = m.tendon_adr[tendon]..m.tendon_adr[tendon] + m.tendon_num[tendon];
    let tree = move |w: usize| {
        let id = usize::try_from(m.wrap_objid[w]).ok()?;
        let body = match m.wrap_type[w] {
            WrapType::Pulley => return None,
            WrapType::Joint => m.jnt_bodyid[id],
            WrapType::Site => m.site_bodyid[id],
            WrapType::Sphere | WrapType::Cylinder => m.geom_bodyid[id],
        };
        usize::try_from(m.body_treeid[body]).ok()
    };
    let first = parts.start;
    parts.filter_map(move |w| tree(w).filter(|found| (first..w).all(|w| tree(w) != Some(*found))))
}

/// The first two trees of a tendon, and how many there are.
fn ends_of_tendon(m: &CompiledModel, tendon: usize) -> ([usize; 2], usize) {
    let mut trees = trees_of_tendon(m, tendon);
    let first = trees.next();
    let second = trees.next();
    let number = usize::from(first.is_some()) + usize::from(second.is_some()) + trees.count();
    ([first.unwrap_or(0), second.unwrap_or(0)], number)
}

fn of_tendon(m: &CompiledModel, awake: &[bool], tendon: usize) -> State {
    let ([first, second], number) = ends_of_tendon(m, tendon);
    let is_awake = match number {
        0 => return State::Static,
        1 => awake[first],
        2 => awake[first] || awake[second],
        _ => true,
    };
    if is_awake {
        State::Awake
    } else {
        State::Asleep
    }
}

/// Whether the spring of a tendon has no energy: it moves no tree that is awake.
pub(super) fn tendon_rests(m: &CompiledModel, awake: &[bool], tendon: usize) -> bool {
    of_tendon(m, awake, tendon) != State::Awake
}

fn of_actuator(m: &CompiledModel, awake: &[bool], actuator: usize) -> State {
    let [id, reference] = m.actuator_trnid[actuator];
    let id = usize::try_from(id).unwrap_or(0);
    let site = |id: usize| of_body(m, awake, m.site_bodyid[id]);
    match m.actuator_trntype[actuator] {
        TransmissionType::Joint | TransmissionType::JointInParent => {
            of_body(m, awake, m.jnt_bodyid[id])
        }
        TransmissionType::Site => site(id),
        TransmissionType::SliderCrank => {
            let slider = usize::try_from(reference).map_or(State::Static, site);
            if [site(id), slider].contains(&State::Awake) {
                State::Awake
            } else {
                State::Asleep
            }
        }
        TransmissionType::Tendon => of_tendon(m, awake, id),
        TransmissionType::Body => of_body(m, awake, id),
    }
}

fn of_object(m: &CompiledModel, awake: &[bool], kind: ObjectType, id: i32) -> State {
    let Ok(id) = usize::try_from(id) else {
        return State::Awake;
    };
    let body = |body: usize| of_body(m, awake, body);
    match kind {
        ObjectType::Unknown => State::Awake,
        ObjectType::Body | ObjectType::XBody => body(id),
        ObjectType::Joint => body(m.jnt_bodyid[id]),
        ObjectType::Geom => body(m.geom_bodyid[id]),
        ObjectType::Site => body(m.site_bodyid[id]),
        ObjectType::Camera => body(m.cam_bodyid[id]),
        ObjectType::Tendon => of_tendon(m, awake, id),
        ObjectType::Actuator => of_actuator(m, awake, id),
    }
}

/// Whether an equality constraint relates no two objects of which one is awake.
pub(super) fn equality_rests(m: &CompiledModel, awake: &[bool], i: usize) -> bool {
    let kind = match m.eq_type[i] {
        EqualityType::Connect | EqualityType::Weld => m.eq_objtype[i],
        EqualityType::Joint => ObjectType::Joint,
        EqualityType::Tendon => ObjectType::Tendon,
    };
    let rests = |id: i32| id < 0 || of_object(m, awake, kind, id) != State::Awake;
    rests(m.eq_obj1id[i]) && rests(m.eq_obj2id[i])
}

/// Whether a sensor keeps its value.
pub(super) fn sensor_rests(m: &CompiledModel, awake: &[bool], i: usize) -> bool {
    let kinds = [m.sensor_objtype[i], m.sensor_reftype[i]];
    let in_a_site = m.sensor_type[i] == SensorType::Contact && kinds.contains(&ObjectType::Site);
    if in_a_site || m.sensor_type[i] == SensorType::Rangefinder {
        return false;
    }
    let object = of_object(m, awake, kinds[0], m.sensor_objid[i]);
    let reference = of_object(m, awake, kinds[1], m.sensor_refid[i]);
    match kinds.map(|kind| kind == ObjectType::Unknown) {
        [true, true] => false,
        [true, false] => reference == State::Asleep,
        [false, true] => object == State::Asleep,
        [false, false] => object != State::Awake && reference != State::Awake,
    }
}

/// Whether no contact of a pair is looked for.
pub(super) fn rests(m: &CompiledModel, awake: &[bool], pair: &Pair) -> bool {
    let bodies = pair.geom.map(|g| m.geom_bodyid[g]);
    let states = bodies.map(|body| of_body(m, awake, body));
    if pair.listed {
        return !states.contains(&State::Awake);
    }
    let fixed = bodies.map(|body| m.body_weldid[body] == 0);
    let asleep = states.map(|state| state == State::Asleep);
    asleep == [true; 2] || (asleep[0] && fixed[1]) || (asleep[1] && fixed[0])
}

/// Whether a tree may sleep: MuJoCo's `treeCanSleep`.
fn can_sleep(m: &Model, d: &Data, tree: usize, tolerance: f64) -> bool {
    if [AUTO_NEVER, NEVER].contains(&m.tree_sleep_policy[tree]) {
        return false;
    }
    let zero = |numbers: &[f64]| numbers.iter().all(|x| x.to_bits() == 0);
    let dofs = m.plan().trees[tree].clone();
    let bodies = m.dof_bodyid[dofs.start]..m.nbody();
    let mut bodies = bodies.take_while(|&b| usize::try_from(m.body_treeid[b]) == Ok(tree));
    bodies.all(|b| zero(&d.xfrc_applied[b]))
        && zero(&d.qfrc_applied[dofs.clone()])
        && if tolerance == 0.0 {
            zero(&d.qvel[dofs])
        } else {
            let speed = |i: usize| m.dof_length[i] * d.qvel[i].abs();
            dofs.map(speed).fold(0.0, f64::max) < tolerance
        }
}

/// Wakes a tree and those that sleep with it: MuJoCo's `mj_wakeIsland`.
fn wake(asleep: &mut [i32], tree: usize, value: i32) -> bool {
    let Ok(mut next) = usize::try_from(asleep[tree]) else {
        asleep[tree] = asleep[tree].min(value);
        return false;
    };
    asleep[tree] = value;
    while next != tree {
        let Some(of_next) = asleep
            .get(next)
            .and_then(|next| usize::try_from(*next).ok())
        else {
            break;
        };
        asleep[next] = value;
        next = of_next;
    }
    true
}

/// The first of the trees that sleep together.
fn first_of_cycle(asleep: &[i32], tree: usize) -> usize {
    let (mut least, mut at) = (tree, tree);
    for _ in 0..asleep.len() {
        match asleep.get(at).and_then(|next| usize::try_from(*next).ok()) {
            Some(next) if next != tree => (least, at) = (least.min(next), next),
            _ => break,
        }
    }
    least
}

fn update(d: &mut Data) {
    let states = d.work.tree_awake.iter_mut().zip(&d.tree_asleep);
    for (awake, asleep) in states {
        *awake = *asleep < 0;
    }
}

/// The positions of a tree.
fn positions(m: &Model, tree: usize) -> impl Iterator<Item = usize> {
    let dofs = &m.plan().trees[tree];
    let joints = m.dof_jntid[dofs.start]..=m.dof_jntid[dofs.end - 1];
    joints.flat_map(|j| m.jnt_qposadr[j]..m.jnt_qposadr[j] + m.jnt_type[j].nq())
}

/// The numbers of a mocap body.
fn mocap(d: &Data, id: usize) -> impl Iterator<Item = f64> {
    d.mocap_pos[id].into_iter().chain(d.mocap_quat[id])
}

/// Whether the mocap body on which a tree stands was moved.
fn is_carried(m: &Model, d: &Data, tree: usize) -> bool {
    let root = m.body_rootid[m.dof_bodyid[m.plan().trees[tree].start]];
    let Ok(id) = usize::try_from(m.body_mocapid[root]) else {
        return false;
    };
    let before = &d.asleep_qpos[m.nq() + 7 * id..];
    let mut numbers = mocap(d, id).zip(before);
    numbers.any(|(now, before)| now.to_bits() != before.to_bits())
}

/// Stores positions.
fn remember(d: &mut Data) {
    let (positions, mut rest) = d.asleep_qpos.split_at_mut(d.qpos.len());
    positions.copy_from_slice(&d.qpos);
    for (pos, quat) in d.mocap_pos.iter().zip(&d.mocap_quat) {
        let (own, others) = rest.split_at_mut(7);
        own[..3].copy_from_slice(pos);
        own[3..].copy_from_slice(quat);
        rest = others;
    }
}

/// Wakes trees that were moved or are pushed: MuJoCo's `mj_wake`.
#[cold]
pub(super) fn wake_disturbed(m: &Model, d: &mut Data) {
    if d.work.settled {
        return;
    }
    update(d);
    for tree in 0..m.ntree() {
        if d.tree_asleep[tree] < 0 {
            continue;
        }
        let moved = |i: usize| d.qpos[i].to_bits() != d.asleep_qpos[i].to_bits();
        if positions(m, tree).any(moved) || is_carried(m, d, tree) || !can_sleep(m, d, tree, 0.0) {
            wake(&mut d.tree_asleep, tree, AWAKE);
        }
    }
    update(d);
}

/// Whether a body is of a tree that sleeps.
pub(super) fn body_sleeps(m: &CompiledModel, awake: &[bool], body: usize) -> bool {
    of_body(m, awake, body) == State::Asleep
}

/// Leaves out the tendons of which all trees sleep, as MuJoCo does: what wakes later in a step is not pulled by them before
/// the next.
#[cold]
pub(super) fn leave_out_tendons(m: &Model, d: &mut Data) {
    for t in 0..m.ntendon() {
        if of_tendon(m, &d.work.tree_awake, t) == State::Asleep {
            d.ten_length[t] = 0.0;
            d.ten_j[m.plan().paths.rows[t].clone()].fill(0.0);
        }
    }
}

/// Wakes trees that a tendon at its limit connects to trees that are awake: MuJoCo's `mj_wakeTendon`.
#[cold]
pub(super) fn wake_by_tendons(m: &Model, d: &mut Data) {
    if d.work.settled || m.ntendon() == 0 {
        return;
    }
    for t in 0..m.ntendon() {
        let ([first, second], number) = ends_of_tendon(m, t);
        let reached = m.tendon_limited[t] && reached_limits(m, t, d.ten_length[t]).count() > 0;
        let awake = [first, second].map(|tree| d.work.tree_awake[tree]);
        if number == 2 && reached && awake[0] != awake[1] {
            let (own, sleeping) = if awake[0] {
                (first, second)
            } else {
                (second, first)
            };
            let value = d.tree_asleep[own];
            wake(&mut d.tree_asleep, sleeping, value);
        }
    }
    update(d);
}

/// Wakes trees that contacts or equality constraints connect to others: MuJoCo's `mj_wakeCollision`
/// and `mj_wakeEquality`.
#[cold]
pub(super) fn wake_by_constraints(m: &Model, d: &mut Data) {
    if d.work.settled {
        return;
    }
    let mut woke = false;
    for contact in &d.contact {
        let bodies = contact.geom.map(|g| m.geom_bodyid[g]);
        let trees = bodies.map(|b| usize::try_from(m.body_treeid[b]).ok());
        let awake = &d.work.tree_awake;
        match trees {
            [Some(first), Some(second)] => {
                if awake[first] != awake[second] {
                    let (own, sleeping) = if awake[first] {
                        (first, second)
                    } else {
                        (second, first)
                    };
                    let value = d.tree_asleep[own];
                    woke |= wake(&mut d.tree_asleep, sleeping, value);
                }
            }
            [Some(tree), None] | [None, Some(tree)] => {
                let other = if trees[0].is_none() {
                    bodies[0]
                } else {
                    bodies[1]
                };
                if !awake[tree] && of_body(m, awake, other) == State::Awake {
                    woke |= wake(&mut d.tree_asleep, tree, AWAKE);
                }
            }
            [None, None] => {}
        }
    }
    if woke {
        update(d);
        collision(m, d);
    }
    for constraint in &m.plan().constraints.equalities {
        wake_by_equality(m, d, constraint.id);
    }
    update(d);
}

fn wake_by_equality(m: &Model, d: &mut Data, i: usize) {
    let body = |id: i32| {
        let id = usize::try_from(id).ok()?;
        Some(match (m.eq_type[i], m.eq_objtype[i]) {
            (EqualityType::Joint, _) => m.jnt_bodyid[id],
            (_, ObjectType::Site) => m.site_bodyid[id],
            _ => id,
        })
    };
    let bodies = [body(m.eq_obj1id[i]), body(m.eq_obj2id[i])];
    let states =
        bodies.map(|body| body.map_or(State::Static, |b| of_body(m, &d.work.tree_awake, b)));
    let trees = bodies.map(|body| body.and_then(|b| usize::try_from(m.body_treeid[b]).ok()));
    if !states.contains(&State::Asleep) || states.contains(&State::Static) || trees[0] == trees[1] {
        return;
    }
    let asleep = &mut d.tree_asleep;
    match trees {
        [Some(first), Some(second)] if states == [State::Asleep; 2] => {
            if first_of_cycle(asleep, first) != first_of_cycle(asleep, second) {
                wake(asleep, first, AWAKE);
                wake(asleep, second, AWAKE);
            }
        }
        _ => {
            let sleeping = if states[0] == State::Asleep {
                trees[0]
            } else {
                trees[1]
            };
            if let Some(tree) = sleeping {
                wake(asleep, tree, AWAKE);
            }
        }
    }
}

/// Stores the forces and accelerations that are about to be computed anew.
#[cold]
pub(super) fn keep_forces(d: &mut Data) {
    let kept = &mut d.work.kept;
    kept.clear();
    kept.extend_from_slice(&d.qfrc_smooth);
    kept.extend_from_slice(&d.qacc_smooth);
}

/// Restores those of trees that sleep.
#[cold]
pub(super) fn restore_forces(m: &Model, d: &mut Data) {
    let (forces, accelerations) = d.work.kept.split_at(m.nv());
    for (tree, awake) in d.work.tree_awake.iter().enumerate() {
        if !awake {
            let dofs = m.plan().trees[tree].clone();
            d.qfrc_smooth[dofs.clone()].copy_from_slice(&forces[dofs.clone()]);
            d.qacc_smooth[dofs.clone()].copy_from_slice(&accelerations[dofs]);
        }
    }
}

/// Lets trees fall asleep whose island rests, and returns whether some did: MuJoCo's `mj_sleep`.
fn sleep(m: &Model, d: &mut Data) -> bool {
    let constrained = d.efc.nefc() > 0;
    if constrained && m.opt.disables(Disable::Island) {
        return false;
    }
    for tree in 0..m.ntree() {
        let asleep = d.tree_asleep[tree];
        if asleep < 0 {
            d.tree_asleep[tree] = if can_sleep(m, d, tree, m.opt.sleep_tolerance) {
                asleep + i32::from(asleep < -1)
            } else {
                AWAKE
            };
        }
    }
    let island = |d: &Data, tree: usize| match d.work.tree_island.get(tree) {
        Some(&island) if constrained && island != usize::MAX => Some(island),
        _ => None,
    };
    let mut slept = false;
    for first in 0..m.ntree() {
        if d.tree_asleep[first] != -1 {
            continue;
        }
        let own = island(d, first);
        let together =
            |d: &Data, tree: usize| tree == first || (own.is_some() && island(d, tree) == own);
        // the island falls asleep at its first tree
        let is_first = !(0..first).any(|tree| together(d, tree));
        let rests = (0..m.ntree()).all(|tree| !together(d, tree) || d.tree_asleep[tree] == -1);
        if !is_first || !rests {
            continue;
        }
        slept = true;
        let mut last = first;
        for tree in first..m.ntree() {
            if !together(d, tree) {
                continue;
            }
            d.tree_asleep[last] = tree as i32;
            d.tree_asleep[tree] = first as i32;
            last = tree;
            let dofs = m.plan().trees[tree].clone();
            d.qvel[dofs.clone()].fill(0.0);
            d.qacc[dofs].fill(0.0);
        }
    }
    slept
}

/// Lets trees fall asleep before velocities and positions are integrated. What depends on velocities
/// is then computed again, but what is integrated are the accelerations from before.
#[cold]
pub(super) fn fall_asleep(m: &Model, d: &mut Data) {
    remember(d);
    if sleep(m, d) {
        d.work.settled = true;
        first_stages(m, d);
        last_stages(m, d);
        measure(m, d, &[Stage::Velocity, Stage::Acceleration]);
        d.work.settled = false;
        update(d);
    }
    for (tree, awake) in d.work.tree_awake.iter().enumerate() {
        if !awake {
            d.work.acc_sum[m.plan().trees[tree].clone()].fill(0.0);
        }
    }
}

/// Whether no degree of freedom that is awake has damping.
#[cold]
pub(super) fn is_undamped(m: &Model, d: &Data) -> bool {
    (0..m.nv()).all(|i| {
        let damped = m.dof_damping[i] != 0.0 || m.dof_dampingpoly[i] != [0.0; 2];
        !damped || !d.work.tree_awake[m.dof_treeid[i]]
    })
}

/// Keeps the positions of trees that sleep where they were.
#[cold]
pub(super) fn stay(m: &Model, d: &mut Data) {
    for tree in 0..m.ntree() {
        if d.tree_asleep[tree] >= 0 {
            for i in positions(m, tree) {
                d.qpos[i] = d.asleep_qpos[i];
            }
        }
    }
    remember(d);
}

/// Lets trees sleep that do from the start: MuJoCo's `mj_resetData`.
#[cold]
pub(crate) fn start(m: &Model, d: &mut Data) {
    update(d);
    remember(d);
    if !m.tree_sleep_policy.contains(&INIT) {
        return;
    }
    let skips = std::mem::replace(&mut d.work.skips, false);
    first_stages(m, d);
    last_stages(m, d);
    measure(m, d, &ALL);
    d.work.skips = skips;
    for (asleep, policy) in d.tree_asleep.iter_mut().zip(&m.tree_sleep_policy) {
        *asleep = if *policy == INIT { -1 } else { AWAKE };
    }
    sleep(m, d);
    for (asleep, policy) in d.tree_asleep.iter_mut().zip(&m.tree_sleep_policy) {
        if *policy == INIT && *asleep < 0 {
            *asleep = AWAKE;
        }
    }
    d.qacc_smooth.fill(0.0);
    d.qfrc_smooth.fill(0.0);
    d.contact.clear();
    d.efc.clear();
    d.solver_niter.clear();
    update(d);
}
