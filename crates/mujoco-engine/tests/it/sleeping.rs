//! Bodies that fall asleep, and that a contact, a tendon, an equality or a control wakes, take steps as in libmujoco, to the
//! last bit. `recorded/sleeping/record.py` recorded the digests.

use super::digest;

/// A version and a model whose sensor differs from libmujoco's in its last bits, by 2e-15 at most: the angular momentum of
/// the world.
const UNLIKE: (&str, &str) = ("4.0", "sensors subtreeangmom");

/// The digest of 200 steps, with random controls in every other tenth of a second.
fn digest(text: &str, version: &str) -> String {
    digest::of_steps(
        (text, version),
        200,
        |_, _| (),
        |_, d, random| {
            let driven = (d.time / 0.1) as u64 % 2 == 1;
            d.ctrl.fill_with(|| {
                if driven {
                    random.uniform(0.0, 1.0)
                } else {
                    0.0
                }
            });
        },
    )
}

#[test]
fn models_whose_bodies_sleep_step_as_in_libmujoco() {
    let world = include_str!("../recorded/sleeping/world.txt").trim_end();
    let models: Vec<_> = include_str!("../recorded/sleeping/models.txt")
        .lines()
        .map(|text| text.replace('@', world))
        .collect();
    let recordings = [
        ("3.12", include_str!("../recorded/sleeping/3.12.txt")),
        ("3.17", include_str!("../recorded/sleeping/3.17.txt")),
        ("4.0", include_str!("../recorded/sleeping/4.0.txt")),
    ];
    let mut unlike = digest::unlike(&models, recordings, digest);
    let all = unlike.len();
    unlike.retain(|one| (one.version, &*one.name) != UNLIKE);
    assert_eq!(all - unlike.len(), 1, "{UNLIKE:?} is not unlike");
    assert!(unlike.is_empty(), "{unlike:#?}");
}
