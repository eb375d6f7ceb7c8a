//! Worlds in columns have the bits of worlds that step one by one.

use std::sync::Arc;

use fearless_simd::Level;
use mujoco_engine::lanes::{Derived, Group, Stride, Worlds, differ_in_stiffness};
use mujoco_engine::physics::rne_post_constraint;
use mujoco_engine::{CompiledModel, Data, Model, step};

/// A robot that hops on a floor: its worlds step together.
const HOPPER: &str = r#"<mujoco>
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body name="torso" pos="0 0 0.9">
      <joint type="slide" axis="0 0 1"/><joint type="slide" axis="1 0 0"/>
      <joint axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0  0 0 0.4" size="0.05"/>
      <body name="leg">
        <joint name="knee" axis="0 1 0" damping="1" range="-60 60" limited="true"/>
        <geom type="capsule" fromto="0 0 0  0.1 0 -0.8" size="0.04"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="knee" gear="20" ctrlrange="-1 1" ctrllimited="true"/></actuator>
</mujoco>"#;

/// A pendulum on a ball joint, with an activation: its worlds step one by one.
const BALL: &str = r#"<mujoco>
  <worldbody>
    <body>
      <joint type="ball"/><geom size="0.1" pos="0.3 0 0"/>
      <body pos="0.5 0 0"><joint name="hinge" axis="0 1 0"/><geom size="0.1" pos="0.3 0 0"/></body>
    </body>
  </worldbody>
  <actuator><general joint="hinge" dyntype="integrator" gainprm="3"/></actuator>
</mujoco>"#;

/// An arm, a box and a ball on a floor, three trees, with a tendon that has a limit.
const PILE: &str = r#"<mujoco>
  <option {option}/>
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body pos="0 0 0.5">
      <joint name="shoulder" axis="0 1 0" range="-80 80" limited="true" {friction}/>
      <geom type="capsule" fromto="0 0 0  0.3 0 0" size="0.04"/>
      <body pos="0.3 0 0">
        <joint name="elbow" axis="0 1 0" damping="0.1"/>
        <geom type="capsule" fromto="0 0 0  0.3 0 0" size="0.04"/>
      </body>
    </body>
    <body pos="0.5 0 0.1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>
    <body pos="0.5 0.05 0.3"><freejoint/><geom size="0.1"/></body>
  </worldbody>
  <tendon><fixed name="both" limited="true" range="-1.5 1">
    <joint joint="shoulder" coef="1"/><joint joint="elbow" coef="0.5"/></fixed></tendon>
  <actuator><motor joint="shoulder" gear="20"/><motor joint="elbow" gear="5"/></actuator>
</mujoco>"#;

fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut seed = seed;
    move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

fn compare(text: &str, len: usize) {
    let model = Arc::new(Model::from_xml(text).unwrap());
    let m = &*model;
    let reads = [Derived::Xpos, Derived::CfrcExt];
    let mut worlds = Worlds::new(&model, len, &reads);
    let mut alone: Vec<Data> = (0..len).map(|_| Data::new(m)).collect();
    let mut random = random(3);
    for (world, data) in alone.iter_mut().enumerate() {
        data.qvel.fill_with(&mut random);
        worlds.qvel[world * m.nv()..][..m.nv()].copy_from_slice(&data.qvel);
    }
    for timesteps in [1, 4, 4, 7, 4, 4, 4, 40, 4, 60] {
        for (world, data) in alone.iter_mut().enumerate() {
            data.ctrl.fill_with(&mut random);
            worlds.ctrl[world * m.nu()..][..m.nu()].copy_from_slice(&data.ctrl);
        }
        worlds.step(timesteps);
        for data in &mut alone {
            (0..timesteps).for_each(|_| step(m, data));
            rne_post_constraint(m, data);
        }
        for (world, data) in alone.iter().enumerate() {
            let what = format!("world {world} of {len}, {timesteps} timesteps");
            let part = |column: &[f64], n: usize| -> Vec<u64> {
                let own = column[world * n..][..n].iter();
                own.map(|x| x.to_bits()).collect()
            };
            let bits = |own: &[f64]| -> Vec<u64> { own.iter().map(|x| x.to_bits()).collect() };
            assert_eq!(worlds.time[world], data.time, "{what}");
            assert_eq!(part(&worlds.qpos, m.nq()), bits(&data.qpos), "{what}");
            assert_eq!(part(&worlds.qvel, m.nv()), bits(&data.qvel), "{what}");
            assert_eq!(part(&worlds.act, m.na()), bits(&data.act), "{what}");
            let [xpos, cfrc_ext] = reads.map(|array| worlds.array(array).unwrap());
            let n = m.nbody();
            assert_eq!(part(xpos, 3 * n), bits(data.xpos.as_flattened()), "{what}");
            let forces = data.cfrc_ext.as_flattened();
            assert_eq!(part(cfrc_ext, 6 * n), bits(forces), "{what}");
        }
    }
}

/// Worlds of models that differ in the stiffness of joints have the bits of worlds alone.
#[test]
fn worlds_of_other_stiffness_step_together() {
    let springs = |stiffness: f64| {
        let text = HOPPER.replace("<joint ", &format!("<joint stiffness=\"{stiffness}\" "));
        Arc::new(Model::from_xml(&text).unwrap())
    };
    let base = springs(20.0);
    let models: Vec<_> = (0..8).map(|world| springs(f64::from(10 + world))).collect();
    let stride = Stride {
        steps: 4,
        settles: false,
        contact_forces: false,
        reads: Vec::new(),
    };
    let mut group = Group::new(&base, &stride, Level::new(), 8);
    let mut together: Vec<Data> = models.iter().map(|m| Data::new(m)).collect();
    let mut alone = together.clone();
    let mut random = random(4);
    for _ in 0..30 {
        group.clear();
        for ((m, together), alone) in models.iter().zip(&mut together).zip(&mut alone) {
            alone.ctrl.fill_with(&mut random);
            together.ctrl.clone_from(&alone.ctrl);
            let added = group.add(m, together, alone.ctrl.iter().copied());
            assert_eq!(added.is_some(), Group::can_step(Level::new()));
            (0..stride.steps).for_each(|_| step(m, alone));
        }
        group.step();
        for (world, (m, together)) in models.iter().zip(&mut together).enumerate() {
            if !group.is_empty() {
                group.collect(world, together);
            }
            if !together.catch_up(m, &stride) {
                (0..stride.steps).for_each(|_| step(m, together));
            }
            assert_eq!(together.qpos, alone[world].qpos, "{world}");
            assert_eq!(together.qvel, alone[world].qvel, "{world}");
        }
    }
    assert!((1..8).all(|world| alone[world].qpos != alone[0].qpos));
}

#[test]
fn only_models_that_differ_in_stiffness_alone_step_together() {
    let with = |change: fn(&mut CompiledModel)| {
        let mut m = Model::from_xml(HOPPER).unwrap().into_compiled();
        m.jnt_stiffness.fill(20.0);
        change(&mut m);
        m
    };
    let base = with(|_| ());
    for (what, change, differs) in [
        ("nothing", (|_| ()) as fn(&mut CompiledModel), false),
        ("one stiffness", |m| m.jnt_stiffness[1] = 30.0, true),
        ("a spring less", |m| m.jnt_stiffness[1] = 0.0, false),
        ("a damping", |m| m.dof_damping[1] = 3.0, false),
        (
            "both",
            |m| {
                m.jnt_stiffness[1] = 30.0;
                m.opt.timestep = 0.001;
            },
            false,
        ),
    ] {
        assert_eq!(differ_in_stiffness(&base, &with(change)), differs, "{what}");
        assert_eq!(differ_in_stiffness(&with(change), &base), differs, "{what}");
    }
}

#[test]
fn worlds_that_step_together_have_the_bits_of_one() {
    for len in [1, 9, 64, 77] {
        compare(HOPPER, len);
    }
}

/// Worlds of several trees step together, whether their constraints have stages for several worlds or
/// each world makes its rows, or solves, alone.
#[test]
fn worlds_of_several_trees_have_the_bits_of_one() {
    for (option, friction) in [
        ("timestep=\"0.004\"", ""),
        ("integrator=\"RK4\"", ""),
        ("", "frictionloss=\"0.2\""),
        ("cone=\"elliptic\" impratio=\"3\"", "frictionloss=\"0.2\""),
        ("solver=\"CG\"", "frictionloss=\"0.2\""),
        ("solver=\"PGS\" noslip_iterations=\"2\"", ""),
    ] {
        let text = PILE.replace("{option}", option);
        let text = text.replace("{friction}", friction);
        let model = Arc::new(Model::from_xml(&text).unwrap());
        let level = Level::new();
        let stride = Stride {
            steps: 1,
            settles: false,
            contact_forces: true,
            reads: vec![Derived::CfrcExt],
        };
        let data = Data::new(&model);
        let added = Group::new(&model, &stride, level, 1).add(&model, &data, [0.0; 2]);
        assert_eq!(added.is_some(), Group::can_step(level), "{option}");
        for len in [1, 7, 8, 9, 67] {
            compare(&text, len);
        }
    }
}

#[test]
fn worlds_that_cannot_step_together_step_one_by_one() {
    compare(BALL, 5);
}

#[test]
fn a_world_that_diverges_starts_anew() {
    let model = Arc::new(Model::from_xml(HOPPER).unwrap());
    let mut worlds = Worlds::new(&model, 16, &[]);
    worlds.qvel[3 * model.nv()] = 1e12;
    worlds.ctrl[5] = f64::NAN;
    worlds.step(2);
    assert!(
        worlds
            .qpos
            .iter()
            .chain(&*worlds.qvel)
            .all(|x| x.abs() < 10.0)
    );
    worlds.reset(7);
    assert_eq!(worlds.time[7], 0.0);
    assert_eq!(worlds.qpos[7 * model.nq()..][..model.nq()], model.qpos0);
    assert_eq!(worlds.array(Derived::Xpos), None);
}

/// Worlds whose numbers are not finite leave nothing in the memory that they share with others: the
/// others keep their bits, and after `reset` all are as new.
#[test]
fn worlds_that_diverge_leave_nothing_behind() {
    const LEN: usize = 24;
    for text in [HOPPER, BALL] {
        let model = Arc::new(Model::from_xml(text).unwrap());
        let (nq, nv, nu) = (model.nq(), model.nv(), model.nu());
        let new = || Worlds::new(&model, LEN, &[Derived::Xpos, Derived::CfrcExt]);
        let (mut used, mut fresh) = (new(), new());
        let step = |worlds: &mut Worlds, i: usize| {
            for world in 0..LEN {
                let control = (7 * (i + world) % 11) as f64 / 5.0 - 1.0;
                worlds.ctrl[world * nu..][..nu].fill(control);
            }
            worlds.step(4);
        };
        let bits = |worlds: &Worlds, world: usize| -> Vec<u64> {
            let own = [
                &worlds.qpos[world * nq..][..nq],
                &worlds.qvel[world * nv..][..nv],
            ];
            own.concat().iter().map(|x| x.to_bits()).collect()
        };
        for (i, bad) in [f64::NAN, f64::INFINITY, 9e9, -1e300, 1e7]
            .into_iter()
            .cycle()
            .take(30)
            .enumerate()
        {
            for world in (0..LEN).step_by(2) {
                used.qpos[world * nq..][..nq].fill(bad);
                used.qvel[world * nv..][..nv].fill(bad);
            }
            step(&mut used, i);
            step(&mut fresh, i);
            for world in (1..LEN).step_by(2) {
                assert_eq!(bits(&used, world), bits(&fresh, world), "{i} {world}");
            }
        }
        (0..LEN).for_each(|world| used.reset(world));
        let mut fresh = new();
        for i in 0..40 {
            step(&mut used, i);
            step(&mut fresh, i);
            for world in 0..LEN {
                assert_eq!(bits(&used, world), bits(&fresh, world), "{i} {world}");
            }
        }
    }
}
