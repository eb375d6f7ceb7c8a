//! Constants that differ between the environments of a vector: lists, and ranges from which each
//! reset draws.

use gym_core::prelude::*;
use gym_core::vector::VectorKind;
use gym_core::{Generator, builder};
use gym_testing::native_equals_sync;

/// A vector whose environments have different constants gives the results of single environments
/// with these constants.
#[test]
fn each_environment_of_a_vector_has_constants_of_its_own() {
    const N: usize = 70;
    let gravity: Vec<f64> = (0..N).map(|i| 1.0 + i as f64 / 7.0).collect();
    let length: Vec<f64> = (0..N).map(|i| 0.2 + i as f64 / 100.0).collect();
    let make = |kind| {
        let vector = builder("CartPole-v1")
            .arg("masspole", 0.2)
            .vector(N)
            .kind(kind);
        vector
            .arg_each("gravity", gravity.clone())
            .arg_each("length", length.clone())
            .build()
            .unwrap()
    };
    native_equals_sync("CartPole-v1", 300, 3, make);
    let native = make(VectorKind::Native);
    let spec = serde_json::to_value(native.spec().unwrap()).unwrap();
    assert_eq!(spec["each"]["length"][1], length[1]);
    let again: gym_core::registry::VectorSpec = serde_json::from_value(spec).unwrap();
    assert_eq!(again, native.spec().unwrap());
    assert_eq!(
        again.make().unwrap().reset(3).unwrap().observations,
        make(VectorKind::Native).reset(3).unwrap().observations
    );
}

/// At each reset, the environment's generator draws the constants of a range for the episode.
#[test]
fn ranges_draw_constants_anew_at_each_reset() {
    use gym_classic::cartpole::{CartPoleDynamics, Config};
    use gym_core::{Dynamics, Reset, Task};
    use gym_native::NativeVectorEnv;
    const N: usize = 40;
    const RANGES: [(&str, f64, f64); 2] = [("gravity", 2.0, 20.0), ("length", 0.2, 2.0)];
    let make = || {
        let vector = builder("CartPole-v1")
            .vector(N)
            .arg_each("length", 0.2..2.0);
        vector.arg_each("gravity", 2.0..20.0).build().unwrap()
    };
    let mut envs = make();
    let mut columns = envs.columns().unwrap();
    envs.reset_into(&5.into(), &mut columns).unwrap();
    // the expected values, computed without the vector
    let start = |rng: &mut Generator| {
        let [gravity, length] = RANGES.map(|(_, low, high)| rng.uniform(low, high));
        let own = CartPoleDynamics::new(Config {
            gravity,
            length,
            ..Config::default()
        })
        .unwrap();
        let state = own.start(&Reset::default(), rng).unwrap();
        (own, state)
    };
    let mut rngs: Vec<Generator> = (0..N as u64).map(|i| Generator::from(5 + i)).collect();
    let mut own: Vec<_> = rngs.iter_mut().map(start).collect();
    let mut actions = envs.action_space().unwrap().sampler(2);
    let mut due = [false; N];
    let mut ends = 0;
    let mut middle = None;
    for step in 0..200 {
        if step == 100 {
            middle = Some((envs.snapshot().unwrap(), actions.clone()));
        }
        let batch = actions.sample();
        envs.step_into(&batch, &mut columns).unwrap();
        let items = batch.as_array().unwrap().as_slice::<i64>().unwrap();
        for i in 0..N {
            let (dynamics, state) = &mut own[i];
            let seen = if due[i] {
                (*dynamics, *state) = start(&mut rngs[i]);
                due[i] = false;
                dynamics.observe(state)
            } else {
                let action = gym_classic::cartpole::Action::ALL[items[i] as usize];
                let next = dynamics.transition(state, &action, &mut rngs[i]).unwrap();
                (*state, due[i]) = (next.state, next.terminated);
                ends += usize::from(next.terminated);
                dynamics.observe(&next.state)
            };
            let row = columns
                .observations
                .as_slice::<f32>()
                .unwrap()
                .as_chunks::<4>()
                .0[i];
            assert_eq!(row, seen, "step {step} of {i}");
        }
    }
    assert!(ends > 100);
    let native = envs.layer::<NativeVectorEnv<CartPoleDynamics>>().unwrap();
    let drawn: Vec<_> = (0..N).map(|i| native.arguments(i)).collect();
    for (i, (dynamics, _)) in own.iter().enumerate() {
        let Config {
            gravity, length, ..
        } = *dynamics.config();
        assert_eq!(
            drawn[i],
            [
                ("gravity".to_owned(), gravity),
                ("length".to_owned(), length)
            ]
        );
    }
    // a snapshot contains the drawn constants
    let (snapshot, mut actions) = middle.unwrap();
    let mut again = make();
    let mut replayed = again.columns().unwrap();
    again.restore(&snapshot).unwrap();
    for _ in 100..200 {
        again.step_into(&actions.sample(), &mut replayed).unwrap();
    }
    assert_eq!(replayed.observations, columns.observations);
    let mut other = builder("CartPole-v1")
        .vector(N)
        .arg_each("gravity", 2.0..3.0)
        .build()
        .unwrap();
    assert!(other.restore(&snapshot).is_err());
}

#[test]
fn what_cannot_differ_is_refused() {
    let error = |name: &str, each: gym_core::registry::Each| {
        let vector = builder("CartPole-v1").vector(2).kind(VectorKind::Native);
        vector.arg_each(name, each).build().unwrap_err().to_string()
    };
    assert_eq!(
        error("gravity", [1.0].into()),
        "invalid argument for gravity: there are 1 values for 2 environments"
    );
    for (low, high) in [(3.0, 1.0), (f64::NEG_INFINITY, 1.0), (1.0, f64::INFINITY)] {
        assert_eq!(
            error("gravity", (low..high).into()),
            format!(
                "invalid argument for gravity: the range from {low:?} to {high:?} needs finite ends, the lower one first"
            )
        );
    }
    assert!(error("gravity", [1.0, 1e9].into()).contains("gravity is 1000000000.0"));
    // the upper and the lower end of a range
    assert!(error("gravity", (1.0..1e9).into()).contains("gravity is 1000000000.0"));
    assert!(error("gravity", (-1e9..1.0).into()).contains("gravity is -1000000000.0"));
    assert!(
        error("x_threshold", (2.4..3.0).into())
            .contains("must give all environments the same spaces")
    );
    assert!(error("mass", [1.0, 2.0].into()).contains("no argument of this name"));
    assert!(
        error("x_threshold", [1.0, 2.0].into())
            .contains("must give all environments the same spaces")
    );
    assert!(
        error("kinematics_integrator", ["euler", "euler"].into())
            .contains("only arguments that are numbers")
    );
    let vector = builder("CartPole-v1")
        .vector(2)
        .kind(VectorKind::Sync)
        .arg_each("gravity", 1.0..2.0);
    assert!(
        vector
            .build()
            .unwrap_err()
            .to_string()
            .contains("ranges need a native vector")
    );
    // a sync vector supports arguments that a native vector does not
    let envs = builder("CartPole-v1")
        .vector(2)
        .arg_each("kinematics_integrator", ["euler", "semi-implicit euler"]);
    assert_eq!(
        envs.build().unwrap().spec().unwrap().vectorization_mode,
        VectorKind::Sync
    );
}

/// A vector refuses a snapshot whose constants lie outside of the vector's ranges, and a snapshot
/// with another number of environments or other arguments. A refused snapshot changes nothing.
#[test]
fn numbers_drawn_outside_of_the_ranges_are_refused() {
    let make = |n: usize, ranges: &[(&str, f64, f64)]| {
        let vector = builder("CartPole-v1").vector(n).kind(VectorKind::Native);
        let vector = ranges.iter().fold(vector, |vector, (name, low, high)| {
            vector.arg_each(name, *low..*high)
        });
        vector.build().unwrap()
    };
    let stored = |n: usize, ranges: &[(&str, f64, f64)]| {
        let mut envs = make(n, ranges);
        envs.reset(7).unwrap();
        envs.snapshot().unwrap()
    };
    const N: usize = 40;
    let own = [("length", 0.5, 0.6)];
    let mut envs = make(N, &own);
    envs.reset(1).unwrap();
    let before = envs.snapshot().unwrap();
    for (n, ranges) in [
        (N, &[("length", 0.3, 0.8)][..]),
        (N, &[("length", 0.3, 0.45)]),
        (N, &[("length", 0.65, 0.8)]),
        (N, &[("length", 0.5, 0.6), ("gravity", 9.0, 10.0)]),
        (N, &[]),
        (N + 1, &own),
        (2 * N, &own),
    ] {
        let error = envs.restore(&stored(n, ranges)).unwrap_err().to_string();
        assert!(error.contains("cannot restore"), "{n}, {ranges:?}: {error}");
        assert_eq!(envs.snapshot().unwrap(), before, "{n}, {ranges:?}");
    }
    // a snapshot of narrower ranges fits
    envs.restore(&stored(N, &[("length", 0.52, 0.58)])).unwrap();
    // numbers that equal the ends of a range fit
    let native = envs
        .layer::<gym_native::NativeVectorEnv<gym_classic::cartpole::CartPoleDynamics>>()
        .unwrap();
    let drawn: Vec<f64> = (0..N).map(|i| native.arguments(i)[0].1).collect();
    let [low, high] = [f64::min, f64::max].map(|end| drawn.iter().copied().reduce(end).unwrap());
    let snapshot = envs.snapshot().unwrap();
    make(N, &[("length", low, high)])
        .restore(&snapshot)
        .unwrap();
    for (low, high) in [(low.next_up(), high), (low, high.next_down())] {
        assert!(
            make(N, &[("length", low, high)])
                .restore(&snapshot)
                .is_err()
        );
    }
}
