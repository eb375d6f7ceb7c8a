//! The machine code of what steps worlds in lanes.
//!
//! A formula over one number or many has the vector instructions of the function that it is compiled into. What is compiled
//! out of line, also a closure of it, has none of them: the results are the same, but a step takes longer.
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

use std::path::Path;
use std::process::Command;

/// The names of the functions over a `Number` or `Simd` that must be inlined, in the sources in `folder`.
fn inlined(folder: &Path, module: &str, names: &mut Vec<String>) {
    for entry in folder.read_dir().unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_str().unwrap();
        let module = match stem {
            "lib" | "mod" => module.to_owned(),
            _ => format!("{module}::{stem}"),
        };
        if path.is_dir() {
            inlined(&path, &module, names);
            continue;
        }
        let source = std::fs::read_to_string(&path).unwrap();
        for part in source.split("#[inline(always)]").skip(1) {
            let Some((_, function)) = part.split_once("fn ") else {
                continue; // a comment that names it
            };
            let head = function.split('(').next().unwrap();
            if let Some((name, kinds)) = head.split_once('<')
                && (kinds.contains(": Number") || kinds.contains(": Simd"))
            {
                names.push(format!("{module}::{name}"));
            }
        }
    }
}

#[test]
fn no_formula_over_lanes_is_out_of_line() {
    let mut names = Vec::new();
    let sources = concat!(env!("CARGO_MANIFEST_DIR"), "/src");
    inlined(Path::new(sources), "mujoco_engine", &mut names);
    assert!(names.len() > 100, "{} functions", names.len());
    let program = std::env::current_exe().unwrap();
    let Ok(output) = Command::new("nm").arg("--demangle").arg(program).output() else {
        println!("skipped: there is no `nm`");
        return;
    };
    let symbols = String::from_utf8_lossy(&output.stdout);
    assert!(symbols.contains("mujoco_engine::physics"));
    let out_of_line: Vec<_> = symbols
        .lines()
        .filter(|line| {
            // an address, a kind and a name
            let symbol = line.splitn(3, ' ').nth(2).unwrap_or_default();
            let function = symbol.trim_end_matches("::{{closure}}");
            names.iter().any(|name| name == function)
        })
        .collect();
    assert!(out_of_line.is_empty(), "{out_of_line:#?}");
}
