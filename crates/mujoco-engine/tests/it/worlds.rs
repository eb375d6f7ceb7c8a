//! Worlds in columns have the bits of worlds that step one by one.

use std::sync::Arc;

use fearless_simd::Level;
use mujoco_engine::lanes::{Derived, Group, Stride, Worlds, differ_in_stiffness};
use mujoco_engine::physics::rne_post_constraint;
use mujoco_engine::{CompiledModel, Data, Model, step};

/// A robot that hops on a floor: its worlds step together.
pub(super) const HOPPER: &str = r#"<mujoco>
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
pub(super) const BALL: &str = r#"<mujoco>
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

/// The number of models that are drawn by lot.
const MODELS: usize = 60;

fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut seed = seed;
    move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// What is read of a model's worlds. Those with tendons between sites do not step together if forces on bodies are read.
fn reads(text: &str) -> Vec<Derived> {
    let mut reads = vec![Derived::Xpos];
    if !text.contains("<spatial") {
        reads.push(Derived::CfrcExt);
    }
    reads
}

/// Whether worlds of the model step together where this is read.
pub(super) fn steps_together(text: &str, settles: bool, reads: &[Derived]) -> bool {
    let model = Arc::new(Model::from_xml(text).unwrap_or_else(|error| panic!("{error}: {text}")));
    let stride = Stride {
        steps: 1,
        settles,
        contact_forces: reads.contains(&Derived::CfrcExt),
        reads: reads.to_vec(),
    };
    let mut group = Group::new(&model, &stride, Level::new(), 1);
    let added = group.add(&model, &Data::new(&model), vec![0.0; model.nu()]);
    added.is_some()
}

fn compare(text: &str, len: usize) {
    compare_reading(text, len, &reads(text));
}

pub(super) fn compare_reading(text: &str, len: usize, reads: &[Derived]) {
    let model = Arc::new(Model::from_xml(text).unwrap());
    let m = &*model;
    let mut worlds = Worlds::new(&model, len, reads);
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
            let what = format!("world {world} of {len}, {timesteps} timesteps: {text}");
            let part = |column: &[f64], n: usize| -> Vec<u64> {
                let own = column[world * n..][..n].iter();
                own.map(|x| x.to_bits()).collect()
            };
            let bits = |own: &[f64]| -> Vec<u64> { own.iter().map(|x| x.to_bits()).collect() };
            assert_eq!(worlds.time[world], data.time, "{what}");
            assert_eq!(part(&worlds.qpos, m.nq()), bits(&data.qpos), "{what}");
            assert_eq!(part(&worlds.qvel, m.nv()), bits(&data.qvel), "{what}");
            assert_eq!(part(&worlds.act, m.na()), bits(&data.act), "{what}");
            let (xpos, n) = (worlds.array(Derived::Xpos).unwrap(), m.nbody());
            assert_eq!(part(xpos, 3 * n), bits(data.xpos.as_flattened()), "{what}");
            let cfrc_ext = worlds.array(Derived::CfrcExt);
            assert_eq!(cfrc_ext.is_some(), reads.len() > 1, "{what}");
            if let Some(cfrc_ext) = cfrc_ext {
                let forces = data.cfrc_ext.as_flattened();
                assert_eq!(part(cfrc_ext, 6 * n), bits(forces), "{what}");
            }
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
        let together = steps_together(&text, false, &[Derived::CfrcExt]);
        assert_eq!(together, Group::can_step(Level::new()), "{option}");
        for len in [1, 7, 8, 9, 67] {
            compare(&text, len);
        }
    }
}

/// Models by lot, of what worlds step together: joints, shapes that touch (lying flat too, with both ends of a capsule at the
/// same height), tendons, servos, equalities and options.
fn drawn(lot: &mut impl FnMut(usize) -> usize) -> String {
    fn one_of<'a>(lot: &mut impl FnMut(usize) -> usize, words: &[&'a str]) -> &'a str {
        words[lot(words.len())]
    }
    const OPTIONS: [&str; 9] = [
        "",
        "",
        r#"integrator="RK4""#,
        r#"timestep="0.005" gravity="1 0 -9""#,
        r#"cone="elliptic""#,
        r#"solver="CG""#,
        r#"solver="PGS" iterations="9""#,
        r#"impratio="4""#,
        r#"tolerance="1e-4" ls_iterations="4""#,
    ];
    const JOINTS: [&str; 9] = [
        "",
        r#"type="slide""#,
        r#"range="-20 25" limited="true""#,
        r#"damping="0.4" armature="0.02""#,
        r#"frictionloss="0.1""#,
        r#"stiffness="2" springref="15" ref="5""#,
        r#"range="-10 9" limited="true" margin="0.05" solreflimit="0.03 0.8""#,
        r#"actuatorfrcrange="-1 0.6""#,
        r#"pos="0.02 0.01 0.03" type="slide" range="-0.05 0.02" limited="true""#,
    ];
    const GEOMS: [&str; 9] = [
        "",
        "",
        r#"condim="1""#,
        r#"friction="0.3""#,
        r#"margin="0.03" gap="0.01""#,
        r#"condim="4""#,
        r#"condim="6" friction="1 0.1 0.01""#,
        r#"solref="0.04 0.7" solimp="0.7 0.9 0.01 0.4 3""#,
        r#"contype="0""#,
    ];
    const AXES: [&str; 4] = ["0 1 0", "1 0 0", "0 0 1", "0.6 0 0.8"];
    const SHAPES: [&str; 5] = [
        r#"size="0.1""#,
        r#"type="capsule" size="0.1 0.15""#,
        r#"type="capsule" size="0.1" fromto="-0.15 0 0  0.15 0 0""#,
        r#"type="box" size="0.12 0.15 0.1""#,
        r#"type="capsule" size="0.1 0.1" euler="20 70 0""#,
    ];
    // forces by the control alone, servos, and what steps one by one
    const ACTUATORS: [&[&str]; 4] = [
        &[
            r#"<motor joint="a" gear="9" ctrlrange="-0.5 0.4" ctrllimited="true"/>"#,
            r#"<motor joint="b" gear="-2" forcerange="-0.3 0.7" forcelimited="true"/>"#,
            r#"<motor tendon="t" gear="3"/>"#,
        ],
        &[r#"<motor joint="b" gear="2"/>"#],
        &[
            r#"<position joint="b" kp="20"/>"#,
            r#"<position joint="a" kp="9" ctrlrange="-0.3 0.2" ctrllimited="true"/>"#,
            r#"<position tendon="t" kp="5" gear="-2"/>"#,
        ],
        &[
            r#"<velocity joint="b" kv="2"/>"#,
            r#"<position joint="a" kp="9" kv="0.3" forcerange="-1 0.7" forcelimited="true"/>"#,
            r#"<general joint="a" gaintype="fixed" gainprm="3" biastype="affine" biasprm="0.5 -2 -0.1"/>"#,
        ],
    ];
    const TENDONS: [&str; 5] = [
        r#"<fixed name="t" limited="true" range="-0.2 0.1"><joint joint="a" coef="1"/><joint joint="b" coef="-0.7"/></fixed>"#,
        r#"<fixed name="t" stiffness="3" springlength="0.1"><joint joint="a" coef="1"/></fixed>"#,
        r#"<fixed name="t"><joint joint="b" coef="2"/></fixed>"#,
        r#"<spatial name="t" limited="true" range="0 0.45"><site site="low"/><site site="high"/></spatial>"#,
        r#"<fixed name="t" frictionloss="0.2"><joint joint="a" coef="1"/><joint joint="b" coef="0.5"/></fixed>"#,
    ];
    const EQUALITIES: [&str; 4] = [
        "",
        "",
        "",
        r#"<joint joint1="a" joint2="b" polycoef="0.01 0.5 0.1 0 0"/>"#,
    ];
    let option = one_of(lot, &OPTIONS);
    let mut text = format!(
        r#"<mujoco><option {option}/><worldbody><site name="low" pos="0 0 0.1"/><geom type="plane" size="5 5 1" {}/>"#,
        one_of(lot, &GEOMS)
    );
    text += &format!(
        r#"<body pos="0 0 0.4"><joint name="a" axis="{}" {}/><geom type="capsule" size="0.04" fromto="0 0 0  0.3 0 0" {}/>
        <body pos="0.3 0 0"><joint name="b" axis="{}" {}/><geom type="capsule" size="0.05" fromto="0 0 0  0.3 0 {}" {}/><site name="high" pos="0.2 0.1 0"/></body></body>"#,
        one_of(lot, &AXES),
        one_of(lot, &JOINTS),
        one_of(lot, &GEOMS),
        one_of(lot, &AXES),
        one_of(lot, &JOINTS),
        one_of(lot, &["0", "-0.1"]),
        one_of(lot, &GEOMS),
    );
    for i in 0..lot(4) {
        let (shape, height) = (
            one_of(lot, &SHAPES),
            one_of(lot, &["0.1", "0.0999", "0.25"]),
        );
        text += &format!(
            r#"<body pos="{} 0.{}1 {height}"><freejoint/><geom {shape} {}/></body>"#,
            [0.5, 0.62, 0.4][i],
            lot(3),
            one_of(lot, &GEOMS)
        );
    }
    text += &format!(
        "</worldbody><tendon>{}</tendon><equality>{}</equality><actuator>",
        one_of(lot, &TENDONS),
        one_of(lot, &EQUALITIES)
    );
    let actuators = ACTUATORS[lot(ACTUATORS.len())];
    (0..1 + lot(2)).for_each(|_| text += one_of(lot, actuators));
    text + "</actuator></mujoco>"
}

#[test]
fn worlds_of_models_by_lot_have_the_bits_of_one() {
    let mut numbers = random(5);
    let mut lot = |n: usize| ((numbers() + 1.0) / 2.0 * n as f64) as usize;
    let mut together = 0;
    for _ in 0..MODELS {
        let text = drawn(&mut lot);
        together += usize::from(steps_together(&text, false, &reads(&text)));
        compare(&text, 9);
    }
    assert!(
        !Group::can_step(Level::new()) || together > MODELS / 2,
        "{together}"
    );
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
