//! Properties of every space, id, spec and snapshot, checked on random ones.

use gym::registry::EnvId;
use gym::spaces::{
    BoxSpace, DictSpace, Discrete, GraphSpace, MultiBinary, MultiDiscrete, OneOfSpace,
    SequenceSpace, TextSpace, TupleSpace,
};
use gym::{DType, Env, EnvExt, EnvSpec, Registration, Snapshot, Space, WrapperSpec, registry};
use proptest::prelude::*;

fn dtype() -> impl Strategy<Value = DType> {
    prop::sample::select(vec![
        DType::I8,
        DType::U8,
        DType::I32,
        DType::I64,
        DType::F32,
        DType::F64,
    ])
}

fn shape() -> impl Strategy<Value = Vec<usize>> {
    prop::collection::vec(1usize..4, 0..3)
}

fn boxed() -> impl Strategy<Value = BoxSpace> {
    (
        0i32..100,
        0i32..28,
        shape(),
        dtype(),
        any::<bool>(),
        any::<bool>(),
    )
        .prop_filter_map(
            "bounds of the type",
            |(low, width, shape, dtype, open_below, open_above)| {
                let low = if open_below {
                    f64::NEG_INFINITY
                } else {
                    f64::from(low)
                };
                let high = if open_above {
                    f64::INFINITY
                } else {
                    f64::from(low.max(0.0) as i32 + width)
                };
                BoxSpace::uniform(low, high, shape, dtype).ok()
            },
        )
}

/// Generates a space whose elements are numbers or arrays.
fn leaf() -> impl Strategy<Value = Space> {
    let discrete = (1i64..9, -5i64..5)
        .prop_map(|(n, start)| Discrete::new(n).unwrap().with_start(start).unwrap());
    let nvec = prop::collection::vec(1i64..6, 1..4);
    prop_oneof![
        boxed().prop_map(Space::from),
        discrete.prop_map(Space::from),
        nvec.prop_map(|nvec| MultiDiscrete::new(nvec).unwrap().into()),
        shape().prop_map(|shape| MultiBinary::new(shape).unwrap().into()),
    ]
}

/// Generates any space.
fn space() -> impl Strategy<Value = Space> {
    let text = (0usize..3, 0usize..5, "[a-zé]{1,6}").prop_map(|(min, more, charset)| {
        TextSpace::new(min, min + more)
            .unwrap()
            .with_charset(&charset)
            .unwrap()
            .into()
    });
    let graph = (leaf(), proptest::option::of(leaf()))
        .prop_filter_map("nodes and edges of a graph", |(node, edge)| {
            GraphSpace::new(node, edge).ok()
        });
    let simple = prop_oneof![4 => leaf(), 1 => text, 1 => graph.prop_map(Space::from)];
    simple.prop_recursive(3, 12, 3, |inner| {
        let some = prop::collection::vec(inner.clone(), 1..4);
        prop_oneof![
            some.clone()
                .prop_map(|spaces| TupleSpace::new(spaces).into()),
            some.clone().prop_map(|spaces| {
                let keys = ["b", "a", "c"];
                DictSpace::new(keys.into_iter().zip(spaces)).unwrap().into()
            }),
            some.prop_map(|spaces| OneOfSpace::new(spaces).unwrap().into()),
            inner.prop_map(|space| SequenceSpace::new(space).into()),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn samples_are_elements(space in space(), seed: u64) {
        let (mut a, mut b) = (space.sampler(seed), space.sampler(seed));
        for _ in 0..3 {
            let value = a.sample();
            prop_assert!(space.contains(&value), "{value} of {space}");
            prop_assert_eq!(space.check(&value).err().map(|error| error.to_string()), None);
            prop_assert_eq!(b.sample(), value);
        }
    }

    #[test]
    fn elements_survive_json(space in space(), seed: u64) {
        let value = space.sampler(seed).sample();
        let text = space.to_json(&value).unwrap().to_string();
        prop_assert_eq!(space.from_json(&serde_json::from_str(&text).unwrap()).unwrap(), value);
    }

    #[test]
    fn spaces_survive_json(space in space()) {
        let text = serde_json::to_string(&space).unwrap();
        let read: Space = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(read.to_string(), space.to_string());
        prop_assert_eq!(read, space);
    }

    #[test]
    fn flattening_is_undone(space in space(), seed: u64) {
        let Ok(flat_space) = space.flatten_space() else {
            // a `OneOf` space with a subspace of variable length
            prop_assert!(!space.is_flattenable());
            return Ok(());
        };
        let value = space.sampler(seed).sample();
        let flat = space.flatten(&value).unwrap();
        prop_assert!(flat_space.contains(&flat), "{flat} of {flat_space}");
        prop_assert_eq!(space.unflatten(&flat).unwrap(), value);
        if space.is_flattenable() {
            prop_assert_eq!(flat.as_array().map(gym::Array::len), space.flatdim().ok());
        }
    }

    #[test]
    fn text_is_an_id_or_is_refused(text in "\\PC{0,24}") {
        if let Ok(id) = text.parse::<EnvId>() {
            prop_assert_eq!(id.to_string().parse::<EnvId>().unwrap(), id);
        } else {
            prop_assert!(gym::make(&text).is_err());
        }
    }

    #[test]
    fn ids_have_three_parts(namespace in proptest::option::of("[a-z_]{1,8}"), name in "[A-Z][A-Za-z0-9.]{0,12}", version: Option<u32>) {
        let id = EnvId { namespace, name, version };
        prop_assert_eq!(id.to_string().parse::<EnvId>().unwrap(), id);
    }

    #[test]
    fn specs_survive_json(
        index: prop::sample::Index,
        steps in proptest::option::of(1u32..1000),
        order_enforce: bool,
        disable_env_checker: bool,
        delay in 0usize..5,
    ) {
        let all = registry::self_contained();
        let registration: &Registration = index.get(&all);
        let spec = EnvSpec { max_episode_steps: steps, order_enforce, disable_env_checker, ..registration.spec().unwrap() };
        let spec = spec.wrapped(WrapperSpec::new("DelayObservation").arg("delay", delay));
        let read: EnvSpec = serde_json::from_str(&serde_json::to_string(&spec).unwrap()).unwrap();
        prop_assert_eq!(&read, &spec);
        prop_assert_eq!(read.make().unwrap().spec(), Some(spec));
    }
}

proptest! {
    // making a track or a terrain takes time
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn snapshots_survive_json(index: prop::sample::Index, seed: u64, steps in 0usize..30) {
        let all = registry::self_contained();
        let id = index.get(&all).id();
        // no checker, because some observation spaces have bounds that are known to be too narrow
        let make = || gym::builder(id).disable_env_checker(true).build();
        let mut env = make().unwrap();
        let mut actions = env.action_sampler(seed).unwrap();
        env.reset(seed).unwrap();
        for _ in 0..steps {
            if env.step(&actions.sample()).unwrap().done() {
                env.reset(()).unwrap();
            }
        }
        let text = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
        let snapshot: Snapshot = serde_json::from_str(&text).unwrap();
        let mut restored = make().unwrap();
        restored.restore(&snapshot).unwrap();
        let action = actions.sample();
        prop_assert_eq!(restored.step(&action).unwrap(), env.step(&action).unwrap());
        prop_assert_eq!(restored.snapshot().unwrap(), env.snapshot().unwrap());
    }
}
