//! Seed inputs, generated with the library.

use gym::sim::engine::{Data, Model, step};
use gym::trace::{Event, Trace};
use gym::{Env, EnvExt, Reset, Space, registry};
use png::{ColorType, Compression, Encoder, Filter};
use serde_json::{Value as Json, json};

/// Returns the registered ids, and invalid ones.
pub fn ids() -> Vec<Vec<u8>> {
    let known = registry::self_contained()
        .into_iter()
        .map(|registration| registration.id().as_bytes().to_vec());
    let other = [
        "CartPole",
        "a/b/C-v0",
        "x y-v1",
        "-v1",
        "A-v4294967296",
        "CartPole-v01",
        "å/ß.é-v1",
    ];
    known
        .chain(other.map(|id| id.as_bytes().to_vec()))
        .collect()
}

/// Returns elements of spaces of every kind, encoded like the frames of a bridge worker.
#[cfg(unix)]
pub fn frames() -> Vec<Vec<u8>> {
    let elements = spaces().into_iter().filter_map(|request| {
        let request: Json = serde_json::from_slice(&request).ok()?;
        let space: Space = serde_json::from_value(request.get("space")?.clone()).ok()?;
        Some(gym::bridge::wire::encoded(&space.sampler(0).sample()))
    });
    elements.collect()
}

/// Returns programs that write all registers, for each size of cartridge.
pub fn roms() -> Vec<Vec<u8>> {
    let program = |choice: u8| {
        let size = [2048, 4096, 8192, 8192, 16384, 16384, 8192, 8192][usize::from(choice) % 8];
        // lda $80; inc $80; sta 0,x; inx; jmp $F000
        let code = [0xa5, 0x80, 0xe6, 0x80, 0x95, 0x00, 0xe8, 0x4c, 0x00, 0xf0];
        let mut rom: Vec<u8> = code.iter().copied().cycle().take(size).collect();
        rom[size - 4..].copy_from_slice(&[0x00, 0xf0, 0x00, 0xf0]);
        [vec![choice], rom].concat()
    };
    (0..16).map(program).collect()
}

/// Returns every id with its default arguments written out.
pub fn arguments() -> Vec<Vec<u8>> {
    let requests = registry::self_contained().into_iter().map(|registration| {
        let table = registration.arguments().unwrap_or_default().into_iter();
        let kwargs: gym::Kwargs = table
            .map(|argument| (argument.name.to_owned(), argument.default))
            .collect();
        json!({
            "id": registration.id(),
            "kwargs": kwargs,
            "options": {"low": -0.1, "high": 0.1, "x_init": 0.5},
        })
    });
    requests
        .map(|request| request.to_string().into_bytes())
        .collect()
}

/// Returns the models of the MuJoCo tasks, and small models with features that no task's model has.
pub fn mjcf() -> Vec<Vec<u8>> {
    const SMALL: &str = r#"<mujoco><option density="2" viscosity="1" wind="1 0 0" solver="PGS"/><worldbody>
        <geom type="plane" size="0 0 1"/>
        <body pos="0 0 0.1"><freejoint/><geom type="cylinder" size="0.1 0.05" priority="1" gap="0.01"/></body>
        <body pos="0 0 0.4" euler="10 20 30"><joint type="slide" limited="true" range="-1 1"/>
        <inertial pos="0 0 0" mass="1" fullinertia="1 1 1 0.1 0 0"/><geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.05"/></body>
        </worldbody><contact><exclude body1="world" body2="world"/></contact></mujoco>"#;
    const MESHES: &str = r#"<mujoco><default><mesh inertia="exact"/></default><asset>
        <mesh name="m" vertex="0 0 0 1 0 0 1 1 0 0 1 0 .2 .1 1 .9 .1 1 .9 .8 1 .1 .9 1" scale=".1 .1 -.1" maxhullvert="6"/>
        <mesh name="n" vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 2 1 0 1 3 0 3 2 1 2 3" refpos=".1 .2 .3" refquat="1 0 1 0"
        inertia="legacy" normal="0 0 1 0 0 1 0 0 1 0 0 1" texcoord="0 0 1 0 0 1 1 1" smoothnormal="true"/></asset><worldbody>
        <geom type="plane" size="0 0 1"/><body pos="0 0 .1"><freejoint/><geom type="mesh" mesh="m"/></body>
        <body pos="0 0 .3"><freejoint/><geom type="mesh" mesh="n"/><geom type="capsule" mesh="n" fitscale=".5"/></body>
        </worldbody></mujoco>"#;
    const FIELDS: &str = r#"<mujoco><option cone="elliptic" noslip_iterations="2" jacobian="sparse"/><asset>
        <hfield name="h" nrow="3" ncol="4" elevation="0 1 2 3 1 0 2 1 3 2 1 0" size="1 2 .3 .1"/>
        <texture name="t" type="2d" builtin="checker" rgb1="1 0 0" rgb2="0 0 1" width="8" height="6" mark="random"/>
        <texture name="u" type="cube" builtin="gradient" width="4" mark="edge"/><material name="m" texture="t" texrepeat="2 3"/>
        <mesh name="b" builtin="supersphere" params="8 .5 .6"/></asset><worldbody>
        <light pos="0 0 3" dir="0 0 -1"/><camera name="c" mode="targetbody" target="p" pos="1 1 1"/>
        <geom type="hfield" hfield="h" material="m"/>
        <body name="p" pos="0 0 .6"><freejoint align="true"/><geom type="ellipsoid" size=".1 .2 .1"/><geom type="mesh" mesh="b" mass=".1"/></body>
        <body pos=".3 .3 .9"><joint type="ball" range="0 90"/><geom type="box" size=".1 .1 .2" solref="-100 -10" condim="6"/></body>
        </worldbody></mujoco>"#;
    const COPIES: &str = r#"<mujoco model="copies"><option integrator="implicit"><flag eulerdamp="disable" energy="enable"/></option>
        <default><geom density="900"/><default class="a"><joint armature=".01" stiffness="2" springref="10"/><site size=".01"/></default></default>
        <worldbody><frame pos="0 0 1" euler="0 30 0" childclass="a">
        <replicate count="3" offset=".4 0 0" euler="0 0 20" sep="_"><body name="b"><joint name="j" axis="0 1 0" frictionloss=".1" damping=".2"/>
        <geom type="capsule" size=".05 .1"/><site name="s" pos="0 0 .1"/><body pos="0 0 .3"><joint name="k" type="slide" limited="true" range="-.1 .1"/>
        <geom name="g" size=".06"/><site name="e"/></body></body></replicate></frame></worldbody>
        <tendon><fixed name="f" range="-1 1" stiffness="3"><joint joint="j_0" coef="2"/><joint joint="k_1" coef="-1"/></fixed>
        <spatial name="w" width=".01" damping="1"><site site="s_0"/><geom geom="g_1"/><site site="e_2"/></spatial></tendon>
        <equality><connect body1="b_0" body2="b_1" anchor="0 0 .1"/><joint joint1="j_1" joint2="j_2" polycoef="0 1 .1 0 0"/>
        <tendon tendon1="f" tendon2="w"/><weld body1="b_2" relpose="0 0 0 1 0 0 0"/></equality>
        <actuator><position joint="j_0" kp="10" dampratio="1" ctrlrange="-1 1"/><muscle tendon="w" lengthrange=".1 2"/>
        <intvelocity joint="k_0" kp="3" actrange="-1 1"/><general site="e_1" gear="1 0 0 0 1 0" biastype="affine" dyntype="filterexact" dynprm=".1"/></actuator>
        <sensor><touch site="s_0"/><rangefinder site="s_1"/><tendonpos tendon="w"/><framelinacc objtype="site" objname="e_0"/>
        <distance geom1="g_0" geom2="g_1" cutoff="2"/><contact geom1="g_0" data="found force" num="2" reduce="mindist"/><subtreeangmom body="b_0"/></sensor>
        <keyframe><key name="k" time="1" qpos="0 0 0 0 0 0"/></keyframe></mujoco>"#;
    let texts = gym::mujoco::models().map(|(_, text)| text);
    texts
        .chain([SMALL, MESHES, FIELDS, COPIES])
        .map(|text| text.as_bytes().to_vec())
        .collect()
}

/// Returns the models of [`mjcf`], compiled.
pub fn models() -> Vec<Vec<u8>> {
    let models = compiled();
    models
        .iter()
        .map(|model| serde_json::to_vec(&**model).expect("a model has a stored form"))
        .collect()
}

/// Returns data of each of these models after some steps.
pub fn data() -> Vec<Vec<u8>> {
    let seed = |(index, model): (usize, &Model)| {
        let mut data = Data::new(model);
        (0..3).for_each(|_| step(model, &mut data));
        serde_json::to_vec(&(index, data)).expect("data has a stored form")
    };
    compiled().iter().enumerate().map(seed).collect()
}

/// The models that [`data`] is of.
pub(crate) fn compiled() -> Vec<Model> {
    let texts = mjcf().into_iter();
    let model = |text: Vec<u8>| Model::from_xml(str::from_utf8(&text).ok()?).ok();
    texts.filter_map(model).collect()
}

/// Returns files of meshes, height fields and textures, each after the byte that selects how a model
/// uses it.
pub fn assets() -> Vec<Vec<u8>> {
    const CORNERS: [[f32; 3]; 5] = [
        [0.0, 0.0, 0.0],
        [0.3, 0.0, 0.0],
        [0.0, 0.3, 0.0],
        [0.0, 0.0, 0.3],
        [0.1, 0.1, 0.2],
    ];
    const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let floats = |numbers: &[[f32; 3]]| -> Vec<u8> {
        let numbers = numbers.as_flattened().iter();
        numbers.flat_map(|x| x.to_le_bytes()).collect()
    };
    let ints =
        |numbers: &[i32]| -> Vec<u8> { numbers.iter().flat_map(|x| x.to_le_bytes()).collect() };
    let mut stl = [vec![0; 80], ints(&[4])].concat();
    for face in FACES {
        stl.extend(floats(&[[0.0, 0.0, 1.0]]));
        stl.extend(floats(&face.map(|i| CORNERS[i])));
        stl.extend([0, 0]);
    }
    let mut obj = String::from("# a tetrahedron\no a\n");
    for [x, y, z] in CORNERS {
        obj += &format!("v {x} {y} {z}\nvt {x} {y}\nvn {x} {y} 1\n");
    }
    obj += "f 1 3 2\nf 1/1 2/2 4/4\nf 1//1 4//4 3//3\nf 2/2/2 3/3/3 4/4/4\nf -1 -2 -3 -4\n";
    let faces: Vec<i32> = FACES.as_flattened().iter().map(|i| *i as i32).collect();
    let msh = [ints(&[5, 0, 0, 4]), floats(&CORNERS), ints(&faces)].concat();
    let field = [ints(&[2, 3]), floats(&[[0.5, -1.0, 2.0], [3.0, 0.25, 7.0]])].concat();
    // not compressed, so that a change of a byte is one of a pixel
    let picture = |width: u32, color: ColorType, pixels: &[u8]| {
        let mut png = Vec::new();
        let mut encoder = Encoder::new(&mut png, width, 2);
        encoder.set_color(color);
        encoder.set_compression(Compression::NoCompression);
        encoder.set_filter(Filter::NoFilter);
        let written = encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(pixels));
        written.expect("as many bytes as pixels have");
        png
    };
    let grey = picture(3, ColorType::Grayscale, &[9, 200, 3, 1, 2, 255]);
    let colors = picture(1, ColorType::Rgb, &[1, 2, 3, 250, 7, 8]);
    let contents = [stl, obj.into_bytes(), msh, grey, field, colors];
    let choices = (0..96u8).map(|choice| {
        let content = &contents[usize::from(choice) % contents.len()];
        [&[choice][..], content].concat()
    });
    choices.collect()
}

/// Returns a snapshot of every environment, several steps into an episode.
pub fn snapshots() -> Vec<Vec<u8>> {
    let mut seeds = Vec::new();
    for registration in registry::self_contained() {
        let id = registration.id();
        let taken = gym::make(id).and_then(|mut env| {
            env.reset(0)?;
            let mut actions = env.action_sampler(0)?;
            for _ in 0..5 {
                env.step(&actions.sample())?;
            }
            env.snapshot()
        });
        if let Ok(snapshot) = taken {
            seeds.push(
                json!({"id": id, "snapshot": snapshot})
                    .to_string()
                    .into_bytes(),
            );
        }
    }
    seeds
}

/// Returns a trace of every environment.
pub fn traces() -> Vec<Vec<u8>> {
    let traces = registry::self_contained()
        .into_iter()
        .filter_map(|registration| {
            let env = gym::make(registration.id()).ok()?;
            let space = env.action_space();
            let mut actions = space.sampler(0);
            let reset = Event {
                reset: Some((&Reset::seed(7)).into()),
                ..Event::default()
            };
            let step = |_| {
                Some(Event {
                    step: Some(space.to_json(&actions.sample()).ok()?),
                    ..Event::default()
                })
            };
            let events = std::iter::once(Some(reset))
                .chain((0..3).map(step))
                .collect::<Option<_>>()?;
            let trace = Trace {
                id: registration.id().into(),
                events,
                ..Trace::default()
            };
            serde_json::to_vec(&trace).ok()
        });
    traces.collect()
}

/// Returns spaces of every kind, each with an element.
pub fn spaces() -> Vec<Vec<u8>> {
    let of_envs = registry::self_contained()
        .into_iter()
        .filter_map(|registration| gym::make(registration.id()).ok());
    let mut all: Vec<Json> = of_envs
        .flat_map(|env| [json!(env.observation_space()), json!(env.action_space())])
        .collect();
    // a small image space covers the same code as a large one
    all.retain(|space| {
        space["shape"]
            .as_array()
            .is_none_or(|shape| shape.len() < 3)
    });
    let leaf = json!({
        "type": "Box",
        "low": [-1.0, "-inf"],
        "high": [1.0, "inf"],
        "shape": [2],
        "dtype": "float64",
    });
    let discrete = json!({"type": "Discrete", "n": 3, "start": -1, "dtype": "int64"});
    let pair = json!({"type": "Tuple", "spaces": [leaf, discrete]});
    all.extend([
        json!({"type": "MultiDiscrete", "nvec": [2, 3], "start": [0, 1], "dtype": "int64"}),
        json!({"type": "MultiBinary", "shape": [2, 2]}),
        json!({"type": "Text", "min_length": 1, "max_length": 5, "charset": "abc"}),
        json!({"type": "Dict", "spaces": [["a", leaf], ["b", pair]]}),
        json!({"type": "Sequence", "feature_space": discrete, "stack": false}),
        json!({"type": "Graph", "node_space": leaf, "edge_space": discrete}),
        json!({"type": "OneOf", "spaces": [leaf, pair]}),
        leaf,
        discrete,
        pair,
    ]);
    let mut seeds = Vec::new();
    for description in all {
        // the element as JSON
        let space = serde_json::from_value::<Space>(description.clone());
        let value = space
            .as_ref()
            .ok()
            .and_then(|space| space.to_json(&space.sampler(1).sample()).ok());
        seeds.push(
            json!({"space": description, "value": value})
                .to_string()
                .into_bytes(),
        );
    }
    seeds
}

/// Returns the spec of every environment, with wrappers.
pub fn specs() -> Vec<Vec<u8>> {
    let stacks = [
        json!([]),
        json!([
            {"name": "TimeLimit", "kwargs": {"max_episode_steps": 7}},
            {"name": "Autoreset", "kwargs": {}},
        ]),
        json!([
            {"name": "FrameStackObservation", "kwargs": {"stack_size": 3, "padding_type": "zero"}},
        ]),
        json!([
            {"name": "FlattenObservation"},
            {"name": "DelayObservation", "kwargs": {"delay": 2}},
        ]),
        json!([
            {"name": "NormalizeObservation", "kwargs": {"epsilon": 1e-8}},
            {"name": "NormalizeReward", "kwargs": {"gamma": 0.9}},
        ]),
        json!([
            {"name": "RescaleAction", "kwargs": {"min_action": -0.5, "max_action": 0.5}},
            {"name": "ClipAction"},
        ]),
        json!([
            {
                "name": "StickyAction",
                "kwargs": {"repeat_action_probability": 0.5, "repeat_action_duration": [1, 3]},
            },
        ]),
        json!([
            {"name": "ResizeObservation", "kwargs": {"shape": [7, 5]}},
            {"name": "GrayscaleObservation", "kwargs": {"keep_dim": true}},
        ]),
        json!([{"name": "DiscretizeObservation", "kwargs": {"bins": 5, "multidiscrete": true}}]),
        json!([
            {"name": "TimeAwareObservation", "kwargs": {"flatten": false, "normalize_time": true}},
        ]),
        json!([
            {"name": "RepeatAction", "kwargs": {"num_repeats": 3}},
            {"name": "ClipReward", "kwargs": {"min_reward": -1, "max_reward": "inf"}},
        ]),
        json!([
            {"name": "RecordEpisodeStatistics", "kwargs": {"buffer_length": 5}},
            {"name": "MaxAndSkipObservation", "kwargs": {"skip": 2}},
        ]),
        json!([
            {"name": "DiscretizeAction", "kwargs": {"bins": [3, 2]}},
            {"name": "DtypeObservation", "kwargs": {"dtype": "uint8"}},
        ]),
        json!([
            {"name": "RescaleObservation", "kwargs": {"min_obs": [0, 0, 0], "max_obs": 1}},
            {"name": "ReshapeObservation", "kwargs": {"shape": [3, 1]}},
        ]),
        json!([
            {
                "name": "AddWhiteNoise",
                "kwargs": {"probability_of_noise_per_pixel": 0.5, "is_noise_grayscale": true},
            },
        ]),
        json!([
            {"name": "AddRenderObservation", "kwargs": {"render_only": false}},
            {"name": "FilterObservation", "kwargs": {"filter_keys": ["pixels"]}},
        ]),
    ];
    let mut seeds = Vec::new();
    for (i, stack) in stacks.iter().enumerate() {
        for registration in registry::self_contained().iter().skip(i % 3).step_by(3) {
            let Ok(spec) = registration.spec() else {
                continue;
            };
            let mut json = json!(spec);
            json["additional_wrappers"] = stack.clone();
            json["render_mode"] = if i >= 14 {
                json!("rgb_array")
            } else {
                Json::Null
            };
            json["render_size"] = if i >= 14 { json!([24, 16]) } else { Json::Null };
            seeds.push(json.to_string().into_bytes());
        }
    }
    seeds
}
