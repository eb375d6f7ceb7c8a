//! What an environment shows of a state that was set, stored or left behind.

use gym_core::render::RenderMode;
use gym_core::{EnvExt, Info};
use mujoco_engine::{Model, forward};

use super::*;
use crate::{Common, Measured, Measures, Visit};

const ARM: &str = r#"<mujoco><option timestep="0.004"/><worldbody><geom type="plane" size="2 2 1"/>
    <body name="upper" pos="0 0 1"><joint name="shoulder" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".04"/>
    <body name="lower" pos=".3 0 0"><joint name="elbow" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".04"/>
    <site name="tip" pos=".3 0 0"/></body></body></worldbody>
    <actuator><motor joint="elbow" ctrlrange="-2 3"/></actuator>
    <keyframe><key name="bent" qpos="0.5 -1" qvel="2 3"/><key name="still" qpos="0.1 0.2"/></keyframe></mujoco>"#;

/// Brings an arm's elbow to an angle that is remembered, and shows it by a site.
#[derive(Debug)]
struct Reach;

impl SimTask for Reach {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.data.userdata[0] = start.uniform(1.0, 2.0);
        Ok(())
    }

    fn remembers(&self) -> usize {
        1
    }

    fn show(&self, data: &mut Data) {
        data.site_xpos[0] = [data.userdata[0], data.qpos[1], 7.0];
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        out.vector("angles", data.qpos.iter().copied());
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("angles").positions(..);
    }

    fn measures(&self) -> Measures {
        &[("distance", 1)]
    }

    fn step(&self, simulation: &Simulation, data: &mut Data, action: &Array) -> Measured {
        simulation.step(data, action);
        let distance = (data.userdata[0] - data.qpos[1]).abs();
        Measured::new(-distance, distance > 5.0).with([distance])
    }

    fn info(&self, _: &Simulation, _: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        if let Some([distance]) = measured.map(Measured::numbers) {
            visit("distance", distance);
        }
    }
}

fn env(common: &Common, change: impl FnOnce(&mut Settings)) -> SimEnv {
    let load = || Ok(Arc::new(Model::from_xml(ARM).unwrap()));
    let simulation = Simulation::new(load, common, Stepper::Settled).unwrap();
    let mut settings = Settings::new("Reach", &());
    change(&mut settings);
    SimEnv::new(Arc::new(Reach), simulation, settings).unwrap()
}

fn plain() -> SimEnv {
    env(&Common::default(), |_| ())
}

fn action() -> Array {
    Array::from(vec![1.5_f32])
}

/// Derived arrays are those of the positions, and what the task shows is that of the state.
fn assert_settled(env: &SimEnv, when: &str) {
    let data = env.data().unwrap();
    let mut other = Data::new(&env.simulation().model);
    other.qpos.copy_from_slice(&data.qpos);
    other.qvel.copy_from_slice(&data.qvel);
    forward(&env.simulation().model, &mut other);
    assert_eq!(data.geom_xpos, other.geom_xpos, "{when}");
    assert_eq!(data.cvel, other.cvel, "{when}");
    let shown = [data.userdata[0], data.qpos[1], 7.0];
    assert_eq!(data.site_xpos[0], shown, "{when}");
}

#[test]
fn what_is_shown_is_that_of_the_state_after_whatever_changed_it() {
    let mut env = plain();
    assert!(env.data().is_none());
    env.reset(1).unwrap();
    assert_settled(&env, "after a reset");
    for _ in 0..5 {
        env.step(&action()).unwrap();
        assert_settled(&env, "after a step");
    }
    let snapshot = env.snapshot().unwrap();
    let then = env.data().unwrap().qpos.clone();
    SimEnv::set_state(&mut env, &[0.4, -0.7], &[3.0, 4.0]).unwrap();
    let data = env.data().unwrap();
    assert_eq!(
        (&*data.qpos, &*data.qvel),
        (&[0.4, -0.7][..], &[3.0, 4.0][..])
    );
    assert_settled(&env, "after a state was set");
    env.restore(&snapshot).unwrap();
    assert_eq!(env.data().unwrap().qpos, then);
    assert_settled(&env, "after a restore");
    env.close();
    assert!(env.data().is_none() && env.info_map().is_empty());
}

/// A given start replaces its own part of the state, and what is shown follows.
#[test]
fn a_given_start_replaces_its_own_part() {
    let state = |env: &SimEnv| {
        let data = env.data().unwrap();
        [data.qpos.clone(), data.qvel.clone()]
    };
    let mut drawn = plain();
    drawn.reset(1).unwrap();
    let drawn = state(&drawn);
    let given = [vec![0.3, -0.2], vec![2.0, 1.0]];
    for parts in [[true, false], [false, true], [true, true]] {
        let start = [0, 1].map(|k| parts[k].then(|| given[k].clone()));
        let mut env = env(&Common::default(), |settings| {
            settings.start = start.clone();
        });
        for when in ["at first", "again"] {
            env.reset(1).unwrap();
            let expected = [0, 1].map(|k| start[k].as_ref().unwrap_or(&drawn[k]).clone());
            assert_eq!(state(&env), expected, "{start:?} {when}");
            assert_settled(&env, when);
            env.step(&action()).unwrap();
            assert_settled(&env, "after a step");
        }
    }
}

#[test]
fn a_state_that_is_none_changes_nothing_and_says_which_part_is_wrong() {
    let mut env = plain();
    let none = SimEnv::set_state(&mut env, &[0.0; 2], &[0.0; 2]).unwrap_err();
    assert!(matches!(none, Error::ResetNeeded("set_state")), "{none}");
    env.reset(1).unwrap();
    let before = env.snapshot().unwrap();
    for (qpos, qvel, part, says) in [
        (
            vec![0.0],
            vec![0.0; 2],
            "qpos",
            "the model has 2 numbers, not 1",
        ),
        (
            vec![0.0; 2],
            vec![0.0; 3],
            "qvel",
            "the model has 2 numbers, not 3",
        ),
        (
            vec![0.0, 1.1e10],
            vec![0.0; 2],
            "qpos",
            "11000000000 is not within ±1e10",
        ),
        (
            vec![0.0; 2],
            vec![f64::NAN, 0.0],
            "qvel",
            "NaN is not within ±1e10",
        ),
    ] {
        let error = SimEnv::set_state(&mut env, &qpos, &qvel).unwrap_err();
        let Error::InvalidArgument { target, reason } = error else {
            panic!("{error}");
        };
        assert_eq!((&*target, &*reason), (part, says));
        assert_eq!(env.snapshot().unwrap(), before);
    }
    SimEnv::set_state(&mut env, &[1e10, -1e10], &[1e10, -1e10]).unwrap();
}

/// What a step measured is told until the next reset, also by another environment that continues.
#[test]
fn what_a_step_measured_is_told_until_a_reset() {
    let distance = |env: &SimEnv| -> Option<f64> {
        let info: Info = env.info_map();
        assert!(info.len() <= 1);
        info.get("distance").and_then(Value::as_float)
    };
    let mut env = plain();
    env.reset(1).unwrap();
    assert_eq!(distance(&env), None);
    let step = env.step(&action()).unwrap();
    assert_eq!(distance(&env), Some(-step.reward));
    let mut other = plain();
    other.restore(&env.snapshot().unwrap()).unwrap();
    assert_eq!(distance(&other), Some(-step.reward));
    for env in [&mut env, &mut other] {
        env.reset(()).unwrap();
        assert_eq!(distance(env), None);
    }
    assert_eq!(env.snapshot().unwrap(), other.snapshot().unwrap());
}

#[test]
fn episodes_start_at_a_keyframe_with_its_velocities() {
    for (name, qpos, qvel) in [
        (None, [0.0, 0.0], [0.0, 0.0]),
        (Some("bent"), [0.5, -1.0], [2.0, 3.0]),
        (Some("still"), [0.1, 0.2], [0.0, 0.0]),
        (Some("0"), [0.5, -1.0], [2.0, 3.0]),
    ] {
        let common = Common {
            keyframe: name.map(str::to_owned),
            ..Common::default()
        };
        let mut env = env(&common, |_| ());
        let simulation = env.simulation();
        assert_eq!(simulation.initial_qpos(), qpos, "{name:?}");
        assert_eq!(simulation.initial_qvel(), qvel, "{name:?}");
        for seed in 0..2 {
            env.reset(seed).unwrap();
            let data = env.data().unwrap();
            assert_eq!(
                (&*data.qpos, &*data.qvel),
                (&qpos[..], &qvel[..]),
                "{name:?}"
            );
            env.step(&action()).unwrap();
        }
    }
}

/// An image has no names of numbers; the controls keep theirs.
#[test]
fn numbers_have_names_and_pixels_have_none() {
    let names = plain().names();
    assert_eq!(
        names.observation,
        ["angle of shoulder (rad)", "angle of elbow (rad)"]
    );
    assert_eq!(names.action, ["torque of elbow (N m)"]);
    let pixels = env(&Common::default(), |settings| settings.pixels = Some(8));
    assert!(pixels.names().observation.is_empty());
    assert_eq!(pixels.names().action, names.action);
    let space = pixels.observation_space().to_string();
    assert_eq!(space, "Box(0, 255, (8, 8, 3), uint8)");
    assert_eq!(
        plain().action_space().to_string(),
        "Box(-2.0, 3.0, (1,), float32)"
    );
}

#[test]
fn depths_are_there_where_they_are_asked_for() {
    for depth in [true, false] {
        let mut env = env(&Common::default(), |settings| settings.depth = depth);
        assert!(env.depth((8, 6)).is_none(), "before a reset");
        env.reset(1).unwrap();
        assert_eq!(
            env.depth((8, 6)).map(|depths| depths.len()),
            depth.then_some(48)
        );
        let modes = env.metadata().render_modes;
        assert_eq!(modes.contains(&RenderMode::DepthArray), depth, "{modes:?}");
    }
}

/// A step lasts as many timesteps of 4 ms as frames are skipped.
#[test]
fn a_second_has_as_many_frames_as_steps() {
    for (frame_skip, fps) in [(1, 250), (2, 125), (3, 83), (100, 2), (170, 1), (1000, 1)] {
        let common = Common {
            frame_skip,
            ..Common::default()
        };
        let mut env = env(&common, |_| ());
        assert_eq!(env.metadata().render_fps, fps, "{frame_skip}");
        env.reset(1).unwrap();
        env.step(&action()).unwrap();
        let passed = env.data().unwrap().time;
        assert!(
            (passed - 0.004 * frame_skip as f64).abs() < 1e-9,
            "{passed}"
        );
        assert!((env.simulation().dt - passed).abs() < 1e-9);
    }
}

#[test]
fn a_model_without_what_a_task_needs_is_refused() {
    let env = plain();
    let simulation = env.simulation();
    for (least, refusal) in [
        (2, None),
        (3, Some("the model has 2 legs, the task needs 3")),
        (4, Some("the model has 2 legs, the task needs 4")),
    ] {
        let told = simulation
            .needs("legs", 2, least)
            .err()
            .map(|error| match error {
                Error::InvalidArgument { target, reason } => (target, reason),
                other => panic!("{other}"),
            });
        let refusal = refusal.map(|reason| ("xml_file".to_owned(), reason.to_owned()));
        assert_eq!(told, refusal);
    }
    let found = [
        simulation.body("lower"),
        simulation.joint("elbow"),
        simulation.site("tip"),
        simulation.geom("lower"),
        simulation.sensor("lower"),
        simulation.body("elbow"),
    ];
    let found = found.map(|found| found.map_err(|error| error.to_string()));
    assert_eq!(found[..3], [Ok(2), Ok(1), Ok(0)]);
    for (found, kind) in
        found[3..]
            .iter()
            .zip(["geom \"lower\"", "sensor \"lower\"", "body \"elbow\""])
    {
        let error = found.as_ref().unwrap_err();
        let expected = format!("xml_file: the model has no {kind}");
        assert!(error.replace('`', "").ends_with(&expected), "{error}");
    }
}

/// Both generators draw from the same ranges; of nothing, the first is drawn.
#[test]
fn both_generators_draw_within_their_ranges() {
    let seed = Seed::from(5_u64);
    let both = Box::new((RandomState::from_seed(&seed), Generator::new(&seed)));
    for mut rng in [
        Rng::Generator(Generator::new(&seed)),
        Rng::RandomState(both),
    ] {
        assert_eq!(rng.integer(0), 0);
        let mut counts = [[0; 3]; 3];
        for _ in 0..2000 {
            counts[0][rng.integer(3) as usize] += 1;
            counts[1][rng.choice(&[0.25, 0.5, 0.25])] += 1;
            let third = (3.0 * rng.random()) as usize;
            counts[2][third] += 1;
            assert!((-2.0..3.0).contains(&rng.uniform(-2.0, 3.0)));
        }
        for (counts, shares) in
            counts
                .iter()
                .zip([[1.0 / 3.0; 3], [0.25, 0.5, 0.25], [1.0 / 3.0; 3]])
        {
            for (count, share) in counts.iter().zip(shares) {
                assert!(
                    (f64::from(*count) - 2000.0 * share).abs() < 120.0,
                    "{counts:?}"
                );
            }
        }
    }
}
