//! The targets. A failing assertion is a defect, like a panic.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Display;

use gym::canvas::Blank;
use gym::registry::{self, EnvId};
use gym::sim::engine::{self, CompiledModel, Data, Model, Revision, step};
use gym::trace::Trace;
use gym::{BoxEnv, Env, EnvExt, EnvSpec, Kwargs, Reset, Snapshot, Space, Value};
use serde_json::Value as Json;

/// The steps that an environment takes if it was made.
const STEPS: usize = 12;

/// Requests above this size would fill the memory or take too long, so they are skipped. Requests
/// beyond any memory are tried, because they must be refused.
const REASONABLE: f64 = 300.0;
const BEYOND_ANY_MEMORY: f64 = 1e15;

/// Tries an id.
pub fn ids(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else {
        return;
    };
    if let Ok(id) = text.parse::<EnvId>() {
        assert_eq!(
            id.to_string().parse::<EnvId>().ok(),
            Some(id),
            "what an id prints as is not that id"
        );
    }
    match registry::resolve(text) {
        Ok((registration, _)) => assert!(registry::find(registration.id()).is_ok()),
        Err(error) => explains(&error),
    }
    if let Err(error) = gym::make(text) {
        explains(&error);
    }
}

/// Tries the frame of a bridge worker.
#[cfg(unix)]
pub fn frames(input: &[u8]) {
    use gym::bridge::wire::{decoded, encoded};
    let Some(value) = decoded(input) else { return };
    assert!(
        encoded(&value) == input,
        "{value} is written otherwise than it was read"
    );
}

/// Tries a program for the Atari 2600, after a byte that selects its cartridge: several frames,
/// drawn and undrawn, must end and give the same state.
pub fn roms(input: &[u8]) {
    use gym::atari::Display;
    use gym::atari::cartridge::{Cartridge, Scheme};
    use gym::atari::console::{Console, Input};

    let Some((&choice, rom)) = input.split_first() else {
        return;
    };
    let scheme = Scheme::ALL[usize::from(choice) % Scheme::ALL.len()];
    let mut seen = Console::new(
        Cartridge::new(rom, scheme),
        Display::NTSC,
        [choice; 128],
        choice,
    );
    let mut unseen = seen.clone();
    for frame in 0..4 {
        let input = Input {
            port_a: choice.wrapping_mul(frame),
            charge: [Some(700); 4],
            ..Input::default()
        };
        seen.frame(&input);
        unseen.frame_unseen(&input);
    }
    assert_eq!(
        seen.ram(),
        unseen.ram(),
        "a frame that is not seen plays otherwise"
    );
    let state = seen.state();
    assert!(
        unseen.set_state(&state),
        "a state of the console is refused"
    );
}

/// Tries `{"id": ..., "kwargs": {...}, "options": {...}}`.
pub fn arguments(input: &[u8]) {
    let Some(request) = object(input) else { return };
    let Some(id) = request.get("id").and_then(Json::as_str) else {
        return;
    };
    let part = |name: &str| {
        request
            .get(name)
            .and_then(Json::as_object)
            .cloned()
            .unwrap_or_default()
    };
    let (kwargs, options): (Kwargs, Kwargs) = (part("kwargs"), part("options"));
    match gym::builder(id).args(kwargs).build() {
        Ok(mut env) => {
            let _ = env.reset(Reset {
                seed: Some(0.into()),
                options,
            });
            play(&mut env);
        }
        Err(error) => explains(&error),
    }
}

/// Where each kind of file stands in a model: its name, and the element that names it.
pub(crate) const ASSETS: [(&str, &str); 6] = [
    ("a.stl", "mesh"),
    ("a.obj", "mesh"),
    ("a.msh", "mesh"),
    ("a.png", "hfield"),
    ("a.bin", "hfield"),
    ("a.png", "texture"),
];

/// Tries a file of a mesh, a height field or a texture, after a byte that selects which, and how the
/// model uses it.
pub fn assets(input: &[u8]) {
    let Some((&choice, content)) = input.split_first() else {
        return;
    };
    let (name, kind) = ASSETS[usize::from(choice) % ASSETS.len()];
    let revision = Revision::ALL[usize::from(choice / 6) % Revision::ALL.len()];
    let inertia = ["convex", "exact", "legacy", "shell"][usize::from(choice / 24) % 4];
    let (asset, geom) = match kind {
        "mesh" => (
            format!(r#"<mesh name="a" file="{name}" inertia="{inertia}"/>"#),
            r#"<body pos="0 0 .5"><freejoint/><geom type="mesh" mesh="a"/></body>"#,
        ),
        "hfield" => (
            format!(r#"<hfield name="a" file="{name}" size="1 1 .2 .1"/>"#),
            r#"<geom type="hfield" hfield="a"/>"#,
        ),
        _ => (
            format!(
                r#"<texture name="a" type="2d" file="{name}"/><material name="a" texture="a"/>"#
            ),
            r#"<geom size="1" material="a"/>"#,
        ),
    };
    let text = format!(
        r#"<mujoco><asset>{asset}</asset><worldbody><geom type="plane" size="0 0 1" pos="0 0 -1"/>{geom}
        <body pos=".1 0 .4"><freejoint/><geom type="box" size=".1 .1 .1"/></body></worldbody></mujoco>"#
    );
    let files = [("model.xml", text.as_bytes()), (name, content)];
    let files = files.map(|(path, bytes)| (path.to_owned(), bytes.to_vec()));
    match Model::from_files(&files.into(), "model.xml", revision) {
        Ok(model) => simulate(&model, &mut Data::new(&model)),
        Err(error) => assert!(
            error.to_string().contains("line "),
            "`{error}` does not say where"
        ),
    }
}

/// The most bodies and geoms of a model that is also stepped, and the most iterations of its solver;
/// what is larger legitimately takes long.
const SMALL: usize = 60;
const ITERATIONS: usize = 1000;

fn is_small(model: &Model) -> bool {
    model.nbody() <= SMALL && model.ngeom() <= SMALL && model.opt.iterations <= ITERATIONS
}

fn simulate(model: &Model, data: &mut Data) {
    for _ in 0..STEPS {
        step(model, data);
    }
}

/// Tries a compiled model, as [`Model::change`] would make it.
pub fn models(input: &[u8]) {
    let Ok(compiled) = serde_json::from_slice::<CompiledModel>(input) else {
        return;
    };
    match Model::new(compiled) {
        Ok(mut model) if is_small(&model) => {
            simulate(&model, &mut Data::new(&model));
            // its constants may be beyond all numbers once they are computed again
            if model.change(|_| {}).is_ok() {
                simulate(&model, &mut Data::new(&model));
            }
        }
        Ok(_) => {}
        Err(error) => explains(&error),
    }
}

/// Tries `[INDEX, DATA]`: data of the engine for one of the models of [`mjcf`].
pub fn data(input: &[u8]) {
    thread_local! {
        static MODELS: Vec<Model> = crate::seeds::compiled();
    }
    let Ok((index, mut data)) = serde_json::from_slice::<(usize, Data)>(input) else {
        return;
    };
    MODELS.with(|models| {
        let model = &models[index % models.len()];
        match data.check(model) {
            Ok(()) => {
                data.resume(model);
                simulate(model, &mut data);
                data.reset(model);
                let mut fresh = Data::new(model);
                for data in [&mut data, &mut fresh] {
                    simulate(model, data);
                }
                assert_eq!(data.qpos, fresh.qpos, "a reset does not forget");
            }
            Err(error) => explains(&error),
        }
    });
}

/// Tries a model in MJCF.
pub fn mjcf(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else {
        return;
    };
    let model = match Model::from_xml(text) {
        Ok(model) => model,
        Err(error) => {
            let lines = 1 + text.matches('\n').count();
            let engine::Error::Mjcf {
                line,
                element,
                reason,
                ..
            } = &error
            else {
                panic!("`{error}` does not say where")
            };
            assert!(
                (1..=lines).contains(&(*line as usize)),
                "`{error}`: the text has {lines} lines"
            );
            assert!(
                !element.is_empty() && reason.len() > 10,
                "`{error}` does not say what to do"
            );
            return;
        }
    };
    if is_small(&model) {
        simulate(&model, &mut Data::new(&model));
    }
}

/// Tries `{"id": ..., "snapshot": ...}`.
pub fn snapshots(input: &[u8]) {
    thread_local! {
        static ENVS: RefCell<BTreeMap<String, BoxEnv>> = const { RefCell::new(BTreeMap::new()) };
    }
    let Some(request) = object(input) else { return };
    let (Some(id), Some(state)) = (
        request.get("id").and_then(Json::as_str),
        request.get("snapshot"),
    ) else {
        return;
    };
    let Ok(snapshot) = serde_json::from_value::<Snapshot>(state.clone()) else {
        return;
    };
    let env = ENVS.with_borrow_mut(|envs| {
        if !envs.contains_key(id) {
            let mut env = gym::make(id).ok()?;
            env.reset(0).ok()?;
            envs.insert(id.to_owned(), env);
        }
        envs.get(id).cloned()
    });
    let Some(mut env) = env else { return };
    let before = env.snapshot().expect("a snapshot of a fresh episode");
    match env.restore(&snapshot) {
        Ok(()) => {
            look(&env);
            steps(&mut env);
        }
        Err(error) => {
            explains(&error);
            assert_eq!(
                env.snapshot().ok(),
                Some(before),
                "a refused snapshot changes the environment"
            );
        }
    }
}

/// Tries a trace as JSON.
pub fn traces(input: &[u8]) {
    let Ok(mut trace) = serde_json::from_slice::<Trace>(input) else {
        return;
    };
    if !trace
        .wrappers
        .iter()
        .all(|wrapper| wrapper.kwargs.values().all(is_reasonable))
    {
        return;
    }
    trace.events.truncate(STEPS);
    match trace.replay() {
        Ok(answers) => {
            let again = trace.replay().expect("what works once works twice");
            // an unseeded reset may differ
            let seeded = trace
                .events
                .first()
                .and_then(|event| event.reset.as_ref())
                .is_some();
            if seeded {
                let _ = answers.first_difference(&again);
            }
        }
        Err(error) => explains(&error),
    }
}

/// Tries `{"space": ..., "value": ...}`.
pub fn spaces(input: &[u8]) {
    let Some(request) = object(input) else { return };
    let Some(description) = request.get("space") else {
        return;
    };
    if !is_reasonable(description) {
        return;
    }
    let Ok(space) = serde_json::from_value::<Space>(description.clone()) else {
        return;
    };
    let stored = serde_json::to_value(&space).expect("a space has a stored form");
    let read: Space = serde_json::from_value(stored).expect("a stored space is read");
    assert_eq!(read, space, "a stored space is another one");
    let _ = space.to_string();
    let is_array = space.is_flattenable();
    let mut sampler = space.sampler(0);
    for _ in 0..3 {
        let value = sampler.sample();
        space.check(&value).expect("a sample is an element");
        let json = space.to_json(&value).expect("an element has a JSON form");
        assert_eq!(space.from_json(&json).expect("and back"), value);
        if let Ok(flat) = space.flatten(&value) {
            space
                .flatten_space()
                .expect("its flat space")
                .check(&flat)
                .expect("flat elements lie in it");
            assert_eq!(space.unflatten(&flat).expect("and back"), value, "{space}");
            let _ = space.unflatten(&Value::Null);
        } else {
            assert!(
                !is_array || space.flatten_space().is_err(),
                "an element does not flatten"
            );
        }
    }
    if let Some(json) = request.get("value")
        && let Ok(value) = space.from_json(json)
    {
        let _ = space.check(&value);
        let _ = space.flatten(&value);
        let _ = space.unflatten(&value);
    }
}

/// Tries a spec as JSON.
pub fn specs(input: &[u8]) {
    let Ok(spec) = serde_json::from_slice::<EnvSpec>(input) else {
        return;
    };
    let text = serde_json::to_string(&spec).expect("a spec has a stored form");
    assert_eq!(
        serde_json::from_str::<EnvSpec>(&text).ok().as_ref(),
        Some(&spec),
        "a stored spec is another one"
    );
    let size = spec
        .render_size
        .is_none_or(|(width, height)| f64::from(width) * f64::from(height) < 1e6);
    let wrappers = &spec.additional_wrappers;
    if !size
        || wrappers.len() > 4
        || !wrappers
            .iter()
            .all(|wrapper| wrapper.kwargs.values().all(is_reasonable))
    {
        return;
    }
    match spec.make() {
        Ok(mut env) => {
            assert!(env.spec().is_some(), "what is made from a spec has one");
            let _ = env.reset(0);
            play(&mut env);
            let _ = env.render();
        }
        Err(error) => explains(&error),
    }
}

/// Makes the calls of an environment's user.
fn play(env: &mut BoxEnv) {
    look(env);
    steps(env);
    let Ok(snapshot) = env.snapshot() else { return };
    let text = serde_json::to_string(&snapshot).expect("a snapshot has a stored form");
    let read = serde_json::from_str(&text).expect("a stored snapshot is read");
    env.restore(&read)
        .expect("an environment takes its own snapshot back");
    env.close();
    let _ = env.step(&Value::Null);
}

fn steps(env: &mut BoxEnv) {
    let Ok(mut actions) = env.action_sampler(1) else {
        return;
    };
    for _ in 0..STEPS {
        match env.step(&actions.sample()) {
            Ok(step) if step.done() => drop(env.reset(())),
            Ok(_) => (),
            Err(error) => explains(&error),
        }
    }
    look(env);
}

fn look(env: &BoxEnv) {
    let _ = (
        env.observation_space(),
        env.action_space(),
        env.info_map(),
        env.ansi(),
        env.describe(),
    );
    env.draw(&mut Blank);
}

/// Asserts that an error has an explanation.
fn explains(error: &impl Display) {
    assert!(
        error.to_string().len() > 10,
        "`{error}` does not say what to do"
    );
}

fn object(input: &[u8]) -> Option<serde_json::Map<String, Json>> {
    serde_json::from_slice(input).ok()
}

/// Whether all sizes in `json` are small, or so large that they must be refused.
fn is_reasonable(json: &Json) -> bool {
    let size = |x: f64| x.abs() <= REASONABLE || x.abs() >= BEYOND_ANY_MEMORY;
    match json {
        Json::Number(number) => number.as_f64().is_none_or(size),
        Json::Array(items) => {
            let product: f64 = items
                .iter()
                .filter_map(Json::as_f64)
                .map(f64::abs)
                .filter(|x| *x > 1.0)
                .product();
            size(product) && items.iter().all(is_reasonable)
        }
        Json::Object(map) => map.values().all(is_reasonable),
        _ => true,
    }
}
