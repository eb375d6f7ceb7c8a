//! The modules of some crates stand in an order. Each names only earlier ones, so that a drawing of
//! their imports has no arrow that points up, and no circle.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Crates with the order of their top-level modules, the "rooms".
const CRATES: [(&str, &[&str]); 3] = [
    (
        "gym-core",
        &[
            "value", "drawing", "spec", "spaces", "env", "play", "vector", "wrappers", "registry",
        ],
    ),
    (
        "gym-sim",
        &[
            "numpy",
            "rng",
            "version",
            "observation",
            "view",
            "keyframe",
            "viewer",
            "arguments",
            "pixels",
            "simulation",
            "start",
            "naming",
            "task",
            "together",
            "load",
            "episode",
            "settings",
            "env",
            "entry",
        ],
    ),
    (
        "mujoco-engine",
        &["error", "math", "model", "physics", "mjcf", "compile"],
    ),
];

/// A source file.
struct Source {
    path: PathBuf,
    /// The number of modules around its items, without those within the file.
    depth: usize,
    /// The text without comments and unit tests.
    code: String,
}

/// Appends the source files of a room, whose file or folder is `path`.
fn collect(path: &Path, depth: usize, found: &mut Vec<Source>) {
    if path.is_dir() {
        for entry in fs::read_dir(path).unwrap() {
            collect(&entry.unwrap().path(), depth + 1, found);
        }
    } else if path.extension().is_some_and(|extension| extension == "rs") {
        let is_mod = path.file_name().is_some_and(|name| name == "mod.rs");
        found.push(Source {
            path: path.to_owned(),
            depth: depth - usize::from(is_mod),
            code: code(&fs::read_to_string(path).unwrap()),
        });
    }
}

/// Returns a text without comments and unit tests.
fn code(text: &str) -> String {
    let lines = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    let code = lines.collect::<Vec<_>>().join("\n");
    let (code, _) = code
        .split_once("\n#[cfg(test)]\nmod tests")
        .unwrap_or((&code, ""));
    code.to_owned()
}

/// Returns the first names of the paths that `text` begins with: for `{a::x, b}`, `a` and `b`.
fn first_names(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    if let Some(list) = text.strip_prefix('{') {
        let (mut depth, mut start) = (0, 0);
        for (i, c) in list.char_indices() {
            match c {
                '}' if depth == 0 => {
                    found.push(&list[start..]);
                    break;
                }
                ',' if depth == 0 => {
                    found.push(&list[start..]);
                    start = i + 1;
                }
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
        }
    } else {
        found.push(text);
    }
    let name = |path: &str| path.find(|c: char| !(c.is_alphanumeric() || c == '_'));
    let found = found.into_iter().map(str::trim_start);
    let found = found.map(|path| &path[..name(path).unwrap_or(path.len())]);
    found.filter(|name| !name.is_empty()).collect()
}

/// Returns the names that follow each `prefix`.
fn names<'a>(code: &'a str, prefix: &str) -> Vec<&'a str> {
    let found = code.match_indices(prefix);
    // a path after `$` is part of a macro's expansion
    let found = found.filter(|(at, _)| !code[..*at].ends_with('$'));
    found
        .flat_map(|(at, _)| first_names(&code[at + prefix.len()..]))
        .collect()
}

/// Returns the top-level names of a crate that a file names: those after `crate::`, and after as
/// many `super::` as lead to the top.
fn top_level_names(source: &Source) -> Vec<&str> {
    let Source { code, depth, .. } = source;
    let mut found = names(code, "crate::");
    let up = "super::".repeat(*depth);
    for (at, _) in code.match_indices(&up) {
        let is_part = code[..at].ends_with("super::");
        if !is_part {
            found.extend(first_names(&code[at + up.len()..]));
        }
    }
    found
}

/// Returns the faults of a crate: modules that name a later one.
fn faults(name: &str, rooms: &[&str]) -> Vec<String> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../crates/{name}/src"));
    let lib = code(&fs::read_to_string(src.join("lib.rs")).unwrap());
    let mut modules: Vec<_> = lib
        .lines()
        .filter_map(|line| line.trim_start_matches("pub ").strip_prefix("mod "))
        .filter_map(|rest| rest.strip_suffix(';'))
        .collect();
    let mut known = rooms.to_vec();
    modules.sort_unstable();
    known.sort_unstable();
    assert_eq!(modules, known, "the modules of {name}");

    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    let mut files = Vec::new();
    for (place, room) in rooms.iter().enumerate() {
        places.insert((*room).to_owned(), place);
        let mut sources = Vec::new();
        let file = src.join(room).with_extension("rs");
        if file.is_file() {
            collect(&file, 1, &mut sources);
        }
        if src.join(room).is_dir() {
            collect(&src.join(room), 1, &mut sources);
        }
        files.extend(sources.into_iter().map(|source| (place, source)));
    }
    for (place, room) in rooms.iter().enumerate() {
        // what `lib.rs` re-exports
        for name in reexports(&lib, room) {
            places.insert(name.to_owned(), place);
        }
    }
    for (place, source) in &files {
        // exported macros
        for rest in source.code.split("#[macro_export]").skip(1) {
            if let Some(name) = rest
                .split_once("_rules!")
                .and_then(|(_, rest)| rest.split('{').next())
            {
                places.insert(name.trim().to_owned(), *place);
            }
        }
    }
    let mut faults = Vec::new();
    for (place, source) in &files {
        for name in top_level_names(source) {
            let path = source.path.display();
            match places.get(name) {
                Some(named) if named <= place => {}
                Some(named) => faults.push(format!(
                    "{path} names {name}, which is in the later module `{}`",
                    rooms[*named]
                )),
                None => faults.push(format!("{path} names {name}, which is in no module")),
            }
        }
    }
    faults
}

/// Returns the names that `lib.rs` re-exports from a room: the last name of each path.
fn reexports<'a>(lib: &'a str, room: &str) -> Vec<&'a str> {
    let prefix = format!("pub use {room}::");
    let mut found = Vec::new();
    for (at, _) in lib.match_indices(&prefix) {
        let list = lib[at + prefix.len()..]
            .split(';')
            .next()
            .unwrap_or_default();
        let paths = list.split([',', '{', '}']).map(str::trim);
        let names = paths.map(|path| path.rsplit([':', ' ']).next().unwrap_or(path));
        found.extend(names.filter(|name| !name.is_empty()));
    }
    found
}

#[test]
fn each_room_names_only_earlier_rooms() {
    for (name, rooms) in CRATES {
        let faults = faults(name, rooms);
        assert!(faults.is_empty(), "{name}:\n{}", faults.join("\n"));
    }
}

#[test]
fn an_arrow_that_points_up_is_found() {
    let faults = faults(
        "mujoco-engine",
        &["error", "math", "physics", "model", "mjcf", "compile"],
    );
    assert!(faults.len() > 50, "{faults:?}");
}

#[test]
fn names_are_read_in_each_form() {
    let source = |depth, text: &str| Source {
        path: PathBuf::new(),
        depth,
        code: code(text),
    };
    let text =
        "use crate::{Result, model::{Pair, Plan}};\nfn f() { crate::physics::step() } // crate::no";
    assert_eq!(
        top_level_names(&source(1, text)),
        ["Result", "model", "physics"]
    );
    assert!(top_level_names(&source(1, "$crate::Error::Model")).is_empty());
    let text = "use super::near;\nuse super::super::{far, wide::W};\n#[cfg(test)]\nmod tests { use super::super::super::x; }";
    assert_eq!(top_level_names(&source(2, text)), ["far", "wide"]);
    assert_eq!(top_level_names(&source(1, "use super::near;")), ["near"]);
}
