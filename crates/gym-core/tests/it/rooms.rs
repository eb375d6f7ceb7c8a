//! The modules of the crate have an order. Each module names only earlier modules.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The top-level modules ("rooms"), in the order of `lib.rs`.
const ROOMS: [&str; 9] = [
    "value", "drawing", "spec", "spaces", "env", "play", "vector", "wrappers", "registry",
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Returns the code of a file without comments.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    text.lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect::<Vec<_>>()
        .join("\n")
}

/// Returns the paths after `prefix`: for `crate::{a::x, b}`, these are `a::x` and `b`. A nested
/// list counts as one path.
fn paths<'a>(code: &'a str, prefix: &str) -> Vec<&'a str> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices(prefix) {
        // a path after `$` is part of a macro's expansion
        if code[..at].ends_with('$') {
            continue;
        }
        let path = &code[at + prefix.len()..];
        let Some(list) = path.strip_prefix('{') else {
            let end = path.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
            found.push(&path[..end.unwrap_or(path.len())]);
            continue;
        };
        let mut depth = 0;
        let mut start = 0;
        for (i, c) in list.char_indices() {
            match c {
                '}' if depth == 0 => {
                    found.push(list[start..i].trim());
                    break;
                }
                ',' if depth == 0 => {
                    found.push(list[start..i].trim());
                    start = i + 1;
                }
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
        }
    }
    found.retain(|path| !path.is_empty());
    found
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

    // the module of each name that `lib.rs` re-exports
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    for (place, room) in ROOMS.iter().enumerate() {
        places.insert(room, place);
        for path in paths(&lib, &format!("pub use {room}::")) {
            places.insert(path.rsplit("::").next().unwrap_or(path), place);
        }
    }
    // the module of each exported macro
    let files: Vec<(usize, PathBuf, String)> = ROOMS
        .iter()
        .enumerate()
        .flat_map(|(place, room)| {
            sources(&src.join(room))
                .into_iter()
                .map(move |path| (place, path))
        })
        .map(|(place, path)| (place, path.clone(), code(&path)))
        .collect();
    assert!(files.len() > 60, "{} files", files.len());
    let exported: Vec<(String, usize)> = files
        .iter()
        .flat_map(|(place, _, code)| {
            code.split("#[macro_export]")
                .skip(1)
                .filter_map(|rest| rest.split("_rules!").nth(1))
                .filter_map(|rest| rest.split('{').next())
                .map(move |name| (name.trim().to_owned(), *place))
        })
        .collect();
    for (name, place) in &exported {
        // (`arguments` is a module too, in the same top-level module)
        places.insert(name, *place);
    }

    let mut faults = Vec::new();
    for (place, file, code) in &files {
        for path in paths(code, "crate::") {
            let name = path.split("::").next().unwrap_or(path);
            match places.get(name) {
                Some(named) if named <= place => {}
                Some(named) => faults.push(format!(
                    "{} names {name}, which is in the later room `{}`",
                    file.display(),
                    ROOMS[*named]
                )),
                None => faults.push(format!("{}: `crate::{name}` is in no room", file.display())),
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
