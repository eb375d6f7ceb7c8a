//! The machine code of what steps worlds in lanes.
//!
//! A formula over one number or many has the vector instructions of the function that it is compiled into. What is compiled
//! out of line, also a closure of it, has none of them: it calls a function for each sum and product of lanes. The results
//! are the same, but a step takes longer.
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

use std::collections::BTreeSet;
use std::process::Command;

#[test]
fn no_formula_over_lanes_is_out_of_line() {
    let Ok(output) = Command::new("objdump")
        .args(["--disassemble", "--demangle", "--no-show-raw-insn"])
        .arg(std::env::current_exe().unwrap())
        .output()
    else {
        println!("skipped: there is no `objdump`");
        return;
    };
    let (mut function, mut out_of_line) = ("", BTreeSet::new());
    let mut vectors = 0;
    let code = String::from_utf8_lossy(&output.stdout);
    for line in code.lines() {
        if let Some(name) = line.strip_suffix(">:") {
            // (a test program inlines less of the standard library than a release)
            function = name
                .split_once("<mujoco_engine")
                .map_or("", |(_, name)| name);
        } else if line.contains("%zmm") {
            vectors += 1;
        } else if !function.is_empty()
            && line.contains("call ")
            && line.contains("fearless_simd_kernel")
        {
            out_of_line.insert(function);
        }
    }
    assert!(vectors > 10_000, "{vectors} instructions of 8 numbers");
    assert!(out_of_line.is_empty(), "{out_of_line:#?}");
}
