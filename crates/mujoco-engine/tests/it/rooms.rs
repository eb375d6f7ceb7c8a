//! The modules of the crate have an order. Each module names only earlier modules, so that a drawing
//! of their imports has no arrow that points up, and no circle.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The top-level modules ("rooms"): each names only earlier ones.
const ROOMS: [&str; 6] = ["error", "math", "model", "physics", "mjcf", "compile"];

/// Returns the source files of a room.
fn sources(place: &Path) -> Vec<PathBuf> {
    if place.is_file() {
        return vec![place.to_owned()];
    }
    let entries = fs::read_dir(place).unwrap();
    let mut found: Vec<PathBuf> = entries
        .flat_map(|entry| sources(&entry.unwrap().path()))
        .collect();
    found.sort();
    found
}

/// Returns the code of a file without comments.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let lines = text.lines();
    lines
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect::<Vec<_>>()
        .join("\n")
}

/// Returns the first names of the paths after `prefix`: for `crate::{a::x, b}`, `a` and `b`.
fn names<'a>(code: &'a str, prefix: &str) -> Vec<&'a str> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices(prefix) {
        // a path after `$` is part of a macro's expansion
        if code[..at].ends_with('$') {
            continue;
        }
        let path = &code[at + prefix.len()..];
        let Some(list) = path.strip_prefix('{') else {
            found.push(path);
            continue;
        };
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
    }
    let name = |path: &'a str| {
        let path = path.trim_start();
        let end = path.find(|c: char| !(c.is_alphanumeric() || c == '_'));
        &path[..end.unwrap_or(path.len())]
    };
    let found = found.into_iter().map(name);
    found.filter(|name| !name.is_empty()).collect()
}

#[test]
fn each_room_names_only_earlier_rooms() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let lib = code(&src.join("lib.rs"));
    let modules: Vec<_> = lib
        .lines()
        .filter_map(|line| line.trim_start_matches("pub ").strip_prefix("mod "))
        .filter_map(|rest| rest.strip_suffix(';'))
        .collect();
    assert_eq!(modules, ROOMS, "the rooms of lib.rs");

    // the room of each name that `lib.rs` re-exports
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    for (place, room) in ROOMS.iter().enumerate() {
        places.insert(room, place);
        for name in names(&lib, &format!("pub use {room}::")) {
            places.insert(name, place);
        }
    }
    let mut files = 0;
    let mut faults = Vec::new();
    for (place, room) in ROOMS.iter().enumerate() {
        let whole = src.join(room);
        let one = whole.with_extension("rs");
        for file in sources(if one.is_file() { &one } else { &whole }) {
            files += 1;
            for name in names(&code(&file), "crate::") {
                match places.get(name) {
                    Some(named) if *named <= place => {}
                    Some(named) => faults.push(format!(
                        "{} names {name}, which is in the later room `{}`",
                        file.display(),
                        ROOMS[*named]
                    )),
                    None => {
                        faults.push(format!("{}: `crate::{name}` is in no room", file.display()));
                    }
                }
            }
        }
    }
    assert!(files > 90, "{files} files");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn an_arrow_that_points_up_is_found() {
    let code = "use crate::{Result, model::{Pair, Plan}};\nfn f() { crate::physics::step() }";
    assert_eq!(names(code, "crate::"), ["Result", "model", "physics"]);
    assert!(names("$crate::Error::Model", "crate::").is_empty());
}
