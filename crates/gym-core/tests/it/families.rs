//! Families and pages: how lists, books and galleries group environments.

use gym_core::registry::{self, Clip, Family, by_family, by_page, shown};
use gym_core::{Configure, Env, NoArguments, Outcome, Registration, Reset, Result, Space};

gym_core::family!(Family::new("Seams", 7).page("seams.md"));

/// An environment that only registrations name.
#[derive(Clone, Debug)]
struct Still;

impl Env for Still {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(1)
    }

    fn action_space(&self) -> Space {
        Space::discrete(1)
    }

    fn reset_into(&mut self, _: &Reset, _: &mut i64) -> Result<()> {
        Ok(())
    }

    fn step_into(&mut self, _: &i64, _: &mut i64) -> Result<Outcome> {
        Ok(Outcome::default())
    }
}

impl Configure for Still {
    type Config = NoArguments;

    fn configure(_: NoArguments, _version: u32) -> Result<Self> {
        Ok(Self)
    }
}

fn still(id: &str, package: &'static str, module: &'static str) -> Registration {
    Registration::dynamic::<Still>(id).source(package, module, "")
}

fn ids(registrations: &[Registration]) -> Vec<&str> {
    registrations.iter().map(Registration::id).collect()
}

/// A family without a declaration comes first, under the name of its crate.
#[test]
fn families_have_the_declared_order() {
    let registrations = [
        still("z-v0", "rust-gym-core", "x"),
        still("b-v0", "b-crate", "x"),
        still("run-time-v0", "", ""),
        still("a-v0", "a-crate", "x"),
        still("a-v1", "a-crate", "x"),
    ];
    let families = by_family(registrations);
    let headings: Vec<_> = families
        .iter()
        .map(|(family, _)| (family.name, family.order))
        .collect();
    assert_eq!(
        headings,
        [
            ("a-crate", 0),
            ("b-crate", 0),
            ("registered at run time", 0),
            ("Seams", 7)
        ]
    );
    assert_eq!(ids(&families[0].1), ["a-v0", "a-v1"]);
    let (seams, _) = families[3];
    assert_eq!(
        (seams.page, seams.package),
        (Some("seams.md"), "rust-gym-core")
    );
    assert_eq!(families[0].0.page, None);
}

#[test]
fn ids_of_a_module_share_a_page() {
    let pages = by_page([
        still("a/Other-v0", "a", "a::two"),
        still("a/Walk-v0", "a", "a::one"),
        still("a/Walk-v1", "a", "a::one"),
        still("a/Hike-v0", "a", "a::one"),
        still("rented/One-v0", "a", "a::three").needs("a key", || false),
        still("rented/One-v1", "a", "a::three").needs("a key", || false),
        still("rented/Two-v0", "a", "a::three").needs("a key", || false),
        still("later/One-v0", "", ""),
        still("later/Two-v0", "", ""),
    ]);
    let pages: Vec<_> = pages.iter().map(|page| ids(page)).collect();
    assert_eq!(
        pages,
        [
            vec!["later/One-v0"],
            vec!["later/Two-v0"],
            vec!["a/Walk-v0", "a/Walk-v1", "a/Hike-v0"],
            vec!["rented/One-v0", "rented/One-v1"],
            vec!["rented/Two-v0"],
            vec!["a/Other-v0"],
        ]
    );
}

#[test]
fn the_newest_version_or_the_clip_stands_for_a_page() {
    let walks = ["a/Walk-v0", "a/Walk-v1", "a/Zigzag-v0"].map(|id| still(id, "a", "a"));
    assert_eq!(shown(&walks).unwrap().id(), "a/Walk-v1");
    let clip = Clip {
        seeds: 0..1,
        every: 1,
        frames: 1,
        size: (8, 8),
    };
    let [first, second, third] = walks;
    let walks = [first, second, third.clip(clip)];
    assert_eq!(shown(&walks).unwrap().id(), "a/Zigzag-v0");
    assert!(shown(&[]).is_none());
}

/// A requirement of a family is one of each of its environments.
#[test]
fn a_registration_knows_its_family() {
    let seams = registry::find("seams/Budget-v4").unwrap();
    assert_eq!(seams.family().name, "Seams");
    assert!(seams.needs.is_none());
    let need = Family::new("Rented", 1)
        .needs("a key", || false)
        .needs
        .unwrap();
    assert!(need.what == "a key" && !need.is_met());
}

/// A warning tells of an id that is out of date, and of the version chosen; the newest has none.
#[test]
fn an_id_resolves_to_its_version_or_the_newest_with_a_warning() {
    for id in ["resolved/Two-v1", "resolved/Two-v3", "resolved/Plain"] {
        registry::register(still(id, "", "")).unwrap();
    }
    for (asked, found, warning) in [
        ("resolved/Two-v3", "resolved/Two-v3", None),
        (
            "resolved/Two-v1",
            "resolved/Two-v1",
            Some("`resolved/Two-v1` is out of date: consider upgrading to `resolved/Two-v3`"),
        ),
        (
            "resolved/Two",
            "resolved/Two-v3",
            Some("using the latest version `resolved/Two-v3` of the unversioned `resolved/Two`"),
        ),
        ("resolved/Plain", "resolved/Plain", None),
    ] {
        let (registration, told) = registry::resolve(asked).unwrap();
        assert_eq!((registration.id(), told.as_deref()), (found, warning));
    }
    for (id, words) in [
        ("resolved/Two-v2", "resolved/Two"),
        ("resolved/Plain-v0", "resolved/Plain"),
        ("resolved/None-v0", "None"),
    ] {
        let error = registry::resolve(id).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    for id in ["resolved/Two-v3", "resolved/Two", "resolved/Plain-v1"] {
        assert!(registry::register(still(id, "", "")).is_err(), "{id}");
    }
}
