//! Every vector wrapper forwards the methods that it does not change: the test calls each method of
//! `VectorEnv` on every wrapper around a spy.

use std::any::Any;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};

use gym::render::{
    Frame, Metadata, RecordVectorVideo, RecordVectorVideoConfig, RenderMode, Rendered,
};
use gym::spaces::BoxSpace;
use gym::vector::{Autoreset, Columns, Progress, VectorKind, VectorReset, VectorSpec};
use gym::wrappers::{
    ClipReward, NormalizeReward, RecordEpisodeStatistics, RescaleObservation, TransformAction,
    TransformObservation, TransformReward,
};
use gym::{
    BoxEnv, DType, Env, Error, Inspect, Result, Snapshot, Space, Value, VectorEnv, VectorEnvExt,
    VectorWrap, WrapperSpec, registry,
};

const N: usize = 3;

/// A vector that records its calls, and whose results differ from all defaults.
struct Spy {
    calls: Arc<Mutex<BTreeSet<&'static str>>>,
    state: i64,
    env: BoxEnv,
}

impl Spy {
    fn note(&self, call: &'static str) {
        self.calls.lock().unwrap().insert(call);
    }

    fn fill(&self, columns: &mut Columns, progress: Progress) -> Result<()> {
        columns.prepare(&VectorEnv::single_observation_space(self), N)?;
        if let Value::Array(array) = &mut columns.observations {
            array.as_mut_slice::<f32>().unwrap().fill(0.5);
        }
        columns.progress.fill(progress);
        Ok(())
    }
}

impl VectorEnv for Spy {
    fn num_envs(&self) -> usize {
        self.note("num_envs");
        N
    }

    fn single_observation_space(&self) -> Space {
        self.note("single_observation_space");
        Space::boxed([-1.0; 2], [1.0; 2])
    }

    fn single_action_space(&self) -> Space {
        self.note("single_action_space");
        Space::boxed([-2.0], [2.0])
    }

    fn observation_space(&self) -> Result<Space> {
        self.note("observation_space");
        BoxSpace::uniform(-7.0, 7.0, [N, 2], DType::F32).map(Space::from)
    }

    fn action_space(&self) -> Result<Space> {
        self.note("action_space");
        BoxSpace::uniform(-8.0, 8.0, [N, 1], DType::F32).map(Space::from)
    }

    fn autoreset(&self) -> Autoreset {
        self.note("autoreset");
        Autoreset::SameStep
    }

    fn reset_into(&mut self, _reset: &VectorReset, columns: &mut Columns) -> Result<()> {
        self.note("reset_into");
        self.fill(columns, Progress::Started)
    }

    fn step_into(&mut self, _actions: &Value, columns: &mut Columns) -> Result<()> {
        self.note("step_into");
        self.state += 1;
        self.fill(columns, Progress::Stepped)
    }

    fn info(&self, index: usize, visit: &mut dyn FnMut(&str, Value)) {
        self.note("info");
        visit("spy", Value::Int(index as i64));
    }

    fn final_info(&self, _index: usize, visit: &mut dyn FnMut(&str, Value)) {
        self.note("final_info");
        visit("last", Value::Int(1));
    }

    fn column_infos(&self, visit: &mut dyn FnMut(&str, Value)) {
        self.note("column_infos");
        visit("column", Value::Int(2));
    }

    fn visit_envs(&mut self, visit: &mut dyn FnMut(usize, &mut dyn Any)) -> Result<()> {
        self.note("visit_envs");
        visit(0, &mut self.env);
        Ok(())
    }

    fn inspect(&mut self, index: usize, _visit: &mut dyn FnMut(&mut dyn Inspect)) -> Result<()> {
        assert_eq!(index, 1);
        self.note("inspect");
        Ok(())
    }

    fn render(&mut self) -> Result<Vec<Rendered>> {
        self.note("render");
        Ok((0..N)
            .map(|_| Rendered::Frame(Frame::new(4, 4).unwrap()))
            .collect())
    }

    fn metadata(&self) -> Metadata {
        self.note("metadata");
        Metadata {
            render_fps: 77,
            ..Metadata::default()
        }
    }

    fn spec(&self) -> Option<VectorSpec> {
        self.note("spec");
        self.env
            .spec()
            .map(|spec| VectorSpec::new(spec, N, VectorKind::Sync))
    }

    fn describe(&self) -> String {
        self.note("describe");
        "a spy".into()
    }

    fn snapshot(&self) -> Result<Snapshot> {
        self.note("snapshot");
        Snapshot::of(&self.state)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.note("restore");
        snapshot.get().map(|state| self.state = state)
    }

    fn close(&mut self) {
        self.note("close");
    }
}

/// A third-party wrapper that changes nothing.
struct Idle<V> {
    envs: V,
}

impl<V: VectorEnv> gym::VectorWrapper for Idle<V> {
    fn inner(&self) -> &dyn VectorEnv {
        &self.envs
    }

    fn inner_mut(&mut self) -> &mut dyn VectorEnv {
        &mut self.envs
    }
}

type Wrap = fn(Box<dyn VectorEnv>) -> Box<dyn VectorEnv>;

fn videos() -> std::path::PathBuf {
    std::env::temp_dir().join(format!("gym-spy-{}", std::process::id()))
}

fn drawn() -> BoxEnv {
    gym::builder("Pendulum-v1")
        .render_mode(RenderMode::RgbArray)
        .build()
        .unwrap()
}

/// Returns every wrapper, and whether it changes the spaces of observations and actions.
fn wrappers() -> Vec<(&'static str, [bool; 2], Wrap)> {
    fn video(envs: Box<dyn VectorEnv>) -> Box<dyn VectorEnv> {
        let mut config = RecordVectorVideoConfig::from(videos());
        config.common.video_length = 1;
        Box::new(
            RecordVectorVideo::new(envs, config)
                .unwrap()
                .step_trigger(|_| true),
        )
    }
    vec![
        ("Idle", [false, false], |envs| Box::new(Idle { envs })),
        ("ClipAction", [false, true], |envs| {
            Box::new(envs.clip_action().unwrap())
        }),
        ("ClipReward", [false, false], |envs| {
            Box::new(envs.clip_reward((-1.0, 1.0)).unwrap())
        }),
        ("NormalizeObservation", [true, false], |envs| {
            Box::new(envs.normalize_observation().unwrap())
        }),
        ("NormalizeReward", [false, false], |envs| {
            Box::new(NormalizeReward::new(envs, 0.9).unwrap())
        }),
        ("RecordEpisodeStatistics", [false, false], |envs| {
            Box::new(RecordEpisodeStatistics::new(envs))
        }),
        ("RecordVideo", [false, false], video),
        ("RescaleAction", [false, true], |envs| {
            Box::new(envs.rescale_action((-1.0, 1.0)).unwrap())
        }),
        ("FlattenObservation", [false, false], |envs| {
            Box::new(envs.flatten_observation().unwrap())
        }),
        ("ReshapeObservation", [true, false], |envs| {
            Box::new(envs.reshape_observation([1, 2]).unwrap())
        }),
        ("DtypeObservation", [true, false], |envs| {
            Box::new(envs.dtype_observation(DType::F64).unwrap())
        }),
        ("DiscretizeObservation", [true, false], |envs| {
            Box::new(envs.discretize_observation(3).unwrap())
        }),
        ("DiscretizeAction", [false, true], |envs| {
            Box::new(envs.discretize_action([3]).unwrap())
        }),
        ("RescaleObservation", [true, false], |envs| {
            Box::new(envs.rescale_observation((-5.0, 5.0)).unwrap())
        }),
        ("TransformAction", [false, false], |envs| {
            Box::new(TransformAction::new(envs, Value::clone, None))
        }),
        ("TransformObservation", [false, false], |envs| {
            Box::new(TransformObservation::new(envs, Value::clone, None))
        }),
        ("TransformReward", [false, false], |envs| {
            Box::new(TransformReward::new(envs, |reward| reward))
        }),
    ]
}

/// Returns the methods of the trait, read from its source, so that the test covers new methods.
fn methods() -> BTreeSet<String> {
    let source = include_str!("../../../crates/gym-core/src/vector/mod.rs");
    let (_, body) = source.split_once("pub trait VectorEnv").expect("the trait");
    let (body, _) = body.split_once("\n}\n").expect("its end");
    let names = body.lines().filter_map(|line| line.strip_prefix("    fn "));
    names
        .map(|rest| rest.split(['(', '<']).next().unwrap_or_default().to_owned())
        .collect()
}

/// Every registered vector wrapper is tested here.
#[test]
fn every_wrapper_is_among_them() {
    let here: BTreeSet<&str> = wrappers().iter().map(|(name, ..)| *name).collect();
    let registered: BTreeSet<&str> = registry::wrappers()
        .iter()
        .filter(|wrapper| wrapper.wraps_vectors())
        .map(|wrapper| wrapper.name)
        .collect();
    let lacking: Vec<_> = registered.difference(&here).collect();
    // these wrappers need other observations than the spy's: `vector_maps.rs` and the tests of
    // gym-minigrid cover these wrappers
    assert_eq!(
        lacking,
        [
            &"DictObservationSpaceWrapper",
            &"FilterObservation",
            &"FlatObsWrapper",
            &"GrayscaleObservation",
            &"ImgObsWrapper",
            &"OneHotPartialObsWrapper",
            &"ResizeObservation"
        ]
    );
}

#[test]
fn every_method_reaches_the_vector_within() {
    for (name, [observes, acts], wrap) in wrappers() {
        let calls = Arc::new(Mutex::new(BTreeSet::new()));
        let spy = Spy {
            calls: calls.clone(),
            state: 0,
            env: drawn(),
        };
        let mut envs = wrap(Box::new(spy));
        calls.lock().unwrap().clear();

        let mut columns = envs.columns().unwrap();
        assert_eq!(
            (envs.num_envs(), envs.autoreset()),
            (N, Autoreset::SameStep),
            "{name}"
        );
        assert_eq!(envs.metadata().render_fps, 77, "{name}");
        envs.inspect(1, &mut |_| ()).unwrap();
        let observation = envs.observation_space().unwrap();
        let expected = BoxSpace::uniform(-7.0, 7.0, [N, 2], DType::F32)
            .unwrap()
            .into();
        assert_eq!(observation == expected, !observes, "{name}: {observation}");
        let action = envs.action_space().unwrap();
        let expected = BoxSpace::uniform(-8.0, 8.0, [N, 1], DType::F32)
            .unwrap()
            .into();
        assert_eq!(action == expected, !acts, "{name}: {action}");
        envs.reset_into(&().into(), &mut columns).unwrap();
        let actions = action.sampler(0).sample();
        envs.step_into(&actions, &mut columns).unwrap();
        columns.has_final[1] = true;

        let infos = envs.infos(&columns);
        assert_eq!(infos["spy"], Value::Array([0i64, 1, 2].into()), "{name}");
        assert_eq!(infos["column"], Value::Int(2), "{name}");
        let last = infos["final_info"].get("last").unwrap();
        assert_eq!(last, &Value::Array([0i64, 1, 0].into()), "{name}");
        assert_eq!(
            envs.call(|_, env: &mut BoxEnv| env.describe())
                .unwrap()
                .len(),
            1,
            "{name}"
        );
        assert_eq!(envs.render().unwrap().len(), N, "{name}");
        assert!(
            envs.describe().contains("a spy") && envs.describe().contains(name),
            "{name}"
        );
        let snapshot = envs.snapshot().unwrap();
        envs.step_into(&actions, &mut columns).unwrap();
        envs.restore(&snapshot).unwrap();
        assert_eq!(envs.layer::<Spy>().unwrap().state, 1, "{name}");
        envs.layer_mut::<Spy>().unwrap().state = 9;
        assert_eq!(envs.layer::<Spy>().unwrap().state, 9, "{name}");
        assert!(envs.layer::<ClipReward<Spy>>().is_none());
        if let Some(spec) = envs.spec() {
            assert_eq!(spec.vector_wrappers.len(), 1, "{name}");
            assert_eq!(spec.vector_wrappers[0].name, name);
        } else {
            assert!(
                name.starts_with("Transform") || ["Idle", "RecordVideo"].contains(&name),
                "{name}"
            );
        }
        envs.close();

        let mut reached: BTreeSet<String> = calls
            .lock()
            .unwrap()
            .iter()
            .map(ToString::to_string)
            .collect();
        // a wrapper that replaces a space returns its own
        if observes {
            reached.extend(["observation_space", "single_observation_space"].map(str::to_owned));
        }
        if acts {
            reached.extend(["action_space", "single_action_space"].map(str::to_owned));
        }
        // a wrapper without a spec does not ask for the inner spec
        reached.insert("spec".into());
        // `layer` uses these to find the inner vector
        reached.extend(["within", "within_mut"].map(str::to_owned));
        assert_eq!(reached, methods(), "{name}");
    }
    std::fs::remove_dir_all(videos()).unwrap();
}

/// An environment that steps the first sub-environment and fails in the second.
struct HalfWay {
    calls: u32,
}

impl VectorEnv for HalfWay {
    fn num_envs(&self) -> usize {
        2
    }

    fn single_observation_space(&self) -> Space {
        Space::boxed([-1.0; 2], [1.0; 2])
    }

    fn single_action_space(&self) -> Space {
        Space::boxed([-1.0], [1.0])
    }

    fn autoreset(&self) -> Autoreset {
        Autoreset::NextStep
    }

    fn reset_into(&mut self, _: &VectorReset, columns: &mut Columns) -> Result<()> {
        columns.prepare(&self.single_observation_space(), 2)?;
        columns.progress.fill(Progress::Started);
        Ok(())
    }

    fn step_into(&mut self, _: &Value, columns: &mut Columns) -> Result<()> {
        self.calls += 1;
        if self.calls == 2 {
            return Err(Error::custom("refused"));
        }
        columns.prepare(&self.single_observation_space(), 2)?;
        if let Value::Array(array) = &mut columns.observations {
            array
                .as_mut_slice::<f32>()
                .unwrap()
                .copy_from_slice(&[0.5, -0.5, 0.0, 0.0]);
        }
        columns.rewards.copy_from_slice(&[8.0, 0.0]);
        columns
            .progress
            .copy_from_slice(&[Progress::Stepped, Progress::Unchanged]);
        Err(Error::custom("the second fails").at_env(1))
    }
}

/// If one sub-environment fails, the other sub-environments keep their steps; a refused step is not
/// counted.
#[test]
fn an_error_of_one_does_not_hide_the_step_of_the_others() {
    let actions = Value::Array(gym::Array::from([0.0f32, 0.0]).reshape([2, 1]).unwrap());
    let step = |envs: &mut dyn VectorEnv| {
        let mut columns = Columns::default();
        envs.reset_into(&().into(), &mut columns).unwrap();
        assert!(
            envs.step_into(&actions, &mut columns)
                .unwrap_err()
                .to_string()
                .contains("the second")
        );
        let first = columns.clone();
        assert!(
            envs.step_into(&actions, &mut columns)
                .unwrap_err()
                .to_string()
                .contains("refused")
        );
        columns.progress.clone_from(&first.progress);
        assert_eq!(columns, first, "a call that is refused changes no row");
        first
    };
    let halfway = || HalfWay { calls: 0 };
    assert_eq!(
        step(&mut ClipReward::new(halfway(), (None, 3.0)).unwrap()).rewards,
        [3.0, 0.0]
    );
    assert_eq!(
        step(&mut TransformReward::new(halfway(), |x| x + 1.0)).rewards,
        [9.0, 0.0]
    );
    let mut envs = RescaleObservation::new(halfway(), (-10.0, 10.0)).unwrap();
    assert_eq!(
        step(&mut envs).observations.as_slice::<f32>().unwrap(),
        [5.0, -5.0, 0.0, 0.0]
    );
    let mut envs = RecordEpisodeStatistics::new(halfway());
    step(&mut envs);
    let error = envs.snapshot().unwrap_err().to_string();
    assert!(
        error.contains("HalfWay(num_envs=2) has no snapshots"),
        "{error}"
    );
    let mut envs = NormalizeReward::new(halfway(), 0.5).unwrap();
    let columns = step(&mut envs);
    assert_eq!(
        (envs.statistics().count() - 1e-4).round(),
        1.0,
        "one reward was taken in"
    );
    assert_eq!(columns.rewards[1], 0.0);
    let mut envs = halfway().normalize_observation().unwrap();
    step(&mut envs);
    assert_eq!(
        (envs.statistics().count() - 1e-4).round(),
        3.0,
        "two of the reset, one of the step"
    );
}

/// A third-party wrapper has no spec unless it implements `spec`. If the wrapper is registered, its
/// spec rebuilds the wrapper.
#[test]
fn a_wrapper_that_leaves_out_its_spec_has_none() {
    let envs = gym::make_vec("CartPole-v1", 2, None).unwrap();
    assert!(Idle { envs }.spec().is_none());
    let unknown = gym::make_vec("CartPole-v1", 2, None)
        .unwrap()
        .spec()
        .unwrap();
    let error = unknown
        .wrapped(WrapperSpec::new("Idle"))
        .make()
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("unknown wrapper `Idle`") && error.contains("ClipReward"),
        "{error}"
    );
}

mod with_everything_imported {
    use gym::vector::*;
    use gym::wrappers::*;

    #[test]
    fn calls_are_not_ambiguous() {
        let mut envs = gym::make_vec("CartPole-v1", 2, None).unwrap();
        let mut columns = envs.columns().unwrap();
        envs.reset_into(&0.into(), &mut columns).unwrap();
        let mut envs = ClipReward::new(envs, (0.0, 0.5)).unwrap();
        envs.reset(1).unwrap();
        let actions = envs.action_sampler(0).unwrap().sample();
        assert_eq!(envs.step(&actions).unwrap().rewards, [0.5, 0.5]);
        assert!(envs.spec().is_some() && envs.num_envs() == 2);
    }
}
