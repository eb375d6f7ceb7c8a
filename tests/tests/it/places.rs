//! A family declares itself in its crate. Outside of it, its crate is named only where Cargo needs
//! it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The files that name every family: members and dependencies, features, the re-export.
const PLACES: [&str; 3] = [
    "Cargo.toml",
    "crates/gym/Cargo.toml",
    "crates/gym/src/lib.rs",
];

/// The lines in these files that a family needs, with the comment of its feature.
const LINES: usize = 8;

/// Files that may name the crates of some families, each with the reason.
const EXCEPTIONS: [(&str, &str); 14] = [
    (
        "xtask/src/web/test.rs",
        "robots that a test drops into the gallery",
    ),
    (
        "crates/gym-cli/Cargo.toml",
        "the bridge, whose environments are written in Python",
    ),
    (
        "crates/gym-cli/src/new.rs",
        "a test of names that are taken",
    ),
    ("crates/gym-cli/src/workspace.rs", "paths in a test"),
    (
        "crates/gym-core/src/registry/mod.rs",
        "an example in an error",
    ),
    (
        "crates/gym-policies/",
        "it depends on the families whose policies it has",
    ),
    ("crates/gym-ppo/Cargo.toml", "the bridge, as gym-cli"),
    (
        "crates/gym-python/python/",
        "classes with the methods that one of Gymnasium's families has",
    ),
    (
        "crates/gym-python/src/",
        "Gymnasium's types of numbers and its errors",
    ),
    (
        "crates/gym-robotics/",
        "AntMaze is Gymnasium's Ant in a maze",
    ),
    (
        "crates/gym-web/Cargo.toml",
        "the small module, for work on the page",
    ),
    (
        "crates/gym-web/profile.toml",
        "where episodes spend their time",
    ),
    (
        "crates/mujoco-engine/src/physics/lanes/tests.rs",
        "the models of the tasks, which step together",
    ),
    ("xtask/Cargo.toml", "the families that are quick to build"),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Appends the manifests and sources below `folder`, as paths from the root, without tests.
fn collect(folder: &str, files: &mut Vec<String>) {
    for entry in fs::read_dir(root().join(folder)).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        let path = format!("{folder}/{name}");
        let is_source = [".rs", ".toml", ".py", ".js"]
            .iter()
            .any(|end| name.ends_with(end));
        if entry.path().is_dir() {
            let is_other = name.starts_with('.') || name == "target" || name == "tests";
            if !is_other {
                collect(&path, files);
            }
        } else if is_source {
            files.push(path);
        }
    }
}

/// Returns the families by the name of their feature: the crates that call `family!`.
fn families() -> BTreeSet<String> {
    let mut families = BTreeSet::new();
    for entry in fs::read_dir(root().join("crates")).unwrap() {
        let folder = entry.unwrap().path();
        let lib = fs::read_to_string(folder.join("src/lib.rs")).unwrap_or_default();
        let name = folder.file_name().unwrap().to_str().unwrap().to_owned();
        if lib.contains("gym_core::family!(") {
            families.insert(name.strip_prefix("gym-").unwrap().to_owned());
        }
    }
    families
}

/// Whether a line of a file names the crate of a family, or its feature.
fn names(path: &str, line: &str, family: &str) -> bool {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let names_it = |name: &str| {
        line.match_indices(name).any(|(at, _)| {
            let (before, after) = (
                line[..at].chars().next_back(),
                line[at + name.len()..].chars().next(),
            );
            !before.is_some_and(is_part) && !after.is_some_and(is_part)
        })
    };
    // (a keyword of a package is no feature)
    let is_manifest = path.ends_with(".toml") && !line.starts_with("keywords");
    names_it(&format!("gym-{family}"))
        || names_it(&format!("gym_{family}"))
        || (is_manifest
            && (names_it(&format!("gym/{family}")) || line.contains(&format!("\"{family}\""))))
}

#[test]
fn a_family_is_named_in_few_places_outside_of_its_crate() {
    let families = families();
    assert!(families.len() >= 8, "{families:?}");
    let mut files = vec!["Cargo.toml".to_owned()];
    for folder in ["crates", "xtask", "fuzz"] {
        collect(folder, &mut files);
    }
    let mut lines = BTreeMap::<&str, usize>::new();
    let mut others = Vec::new();
    for path in &files {
        let text = fs::read_to_string(root().join(path)).unwrap();
        for family in &families {
            let is_own = path.starts_with(&format!("crates/gym-{family}/"));
            let is_exception = EXCEPTIONS.iter().any(|(place, _)| path.starts_with(place));
            let found = text.lines().filter(|line| names(path, line, family));
            // (the second engine of Box2D has a feature of its own)
            let found =
                found.filter(|line| !line.contains("gym-box2d/") && !line.contains("# all that"));
            if is_own || is_exception {
                continue;
            }
            let found = found.count();
            if PLACES.contains(&path.as_str()) {
                *lines.entry(family).or_default() += found;
            } else if found > 0 {
                others.push(format!("{path} names gym-{family}"));
            }
        }
    }
    assert!(others.is_empty(), "read the registry instead: {others:#?}");
    for (family, count) in lines {
        // and the comment of its feature
        assert!(count < LINES, "{count} lines for gym-{family}");
    }
}

/// Each family has its own name and position, and comes after those of Gymnasium's notebook.
#[test]
fn families_come_in_the_order_of_the_notebook() {
    let families = gym::registry::by_family(gym::registry::all());
    let declared = families.iter().filter(|(family, _)| family.order > 0);
    let declared: Vec<_> = declared
        .map(|(family, _)| (family.order, family.name))
        .collect();
    let names: Vec<_> = declared.iter().map(|(_, name)| *name).collect();
    assert_eq!(
        names[..5],
        ["Classic control", "Toy text", "Box2D", "MuJoCo", "Atari"]
    );
    let orders: BTreeSet<_> = declared.iter().map(|(order, _)| order).collect();
    assert_eq!(orders.len(), declared.len(), "{declared:?}");
    assert_eq!(declared.len(), self::families().len(), "{declared:?}");
}
