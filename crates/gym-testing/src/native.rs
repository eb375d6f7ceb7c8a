use gym_core::vector::{BoxVector, Columns, VectorKind};
use gym_core::{VectorEnv, VectorEnvExt};

/// Checks that a native vector gives what a vector of single environments gives, over `steps`
/// random steps. From the middle on, the native vector is a new one with the snapshot of the first.
///
/// `make` makes the vector of a kind, and `what` names it in messages.
///
/// # Panics
/// If the vectors differ, or return an error.
pub fn native_equals_sync(
    what: &str,
    steps: usize,
    seed: u64,
    make: impl Fn(VectorKind) -> BoxVector,
) {
    let [mut native, mut sync] = [VectorKind::Native, VectorKind::Sync].map(&make);
    let [mut fast, mut exact] = [native.columns().unwrap(), sync.columns().unwrap()];
    let mut actions = native.action_space().unwrap().sampler(seed);
    native.reset_into(&seed.into(), &mut fast).unwrap();
    sync.reset_into(&seed.into(), &mut exact).unwrap();
    assert_eq!(fast, exact, "{what}: reset");
    for step in 0..steps {
        if step == steps / 2 {
            let snapshot = native.snapshot().unwrap();
            native = make(VectorKind::Native);
            native.restore(&snapshot).unwrap();
        }
        let actions = actions.sample();
        native.step_into(&actions, &mut fast).unwrap();
        sync.step_into(&actions, &mut exact).unwrap();
        let [shown, expected] = [&fast, &exact].map(rows);
        assert_eq!(shown, expected, "{what}: step {step}");
        let [shown, expected] = [native.infos(&fast), sync.infos(&exact)];
        assert_eq!(shown, expected, "{what}: infos of step {step}");
    }
}

/// The columns of which every row has a meaning.
fn rows(columns: &Columns) -> impl PartialEq + std::fmt::Debug {
    let Columns {
        observations,
        rewards,
        terminated,
        truncated,
        has_final,
        ..
    } = columns;
    (observations, rewards, terminated, truncated, has_final)
}
