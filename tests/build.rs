//! Converts the cells of `docs/notebook.ipynb` to one program, which a test runs.

use std::path::Path;

fn main() {
    println!("cargo::rerun-if-changed=../docs/notebook.ipynb");
    let notebook = std::fs::read_to_string("../docs/notebook.ipynb").expect("the notebook");
    let notebook: serde_json::Value = serde_json::from_str(&notebook).expect("JSON");
    let cells = notebook["cells"].as_array().expect("cells");
    let code = cells
        .iter()
        .filter(|cell| cell["cell_type"] == "code")
        .map(program)
        .collect::<String>();
    let path = Path::new(&std::env::var("OUT_DIR").expect("set by Cargo")).join("notebook.rs");
    std::fs::write(
        path,
        format!("fn notebook() -> Result<(), Box<dyn std::error::Error>> {{\n{code}Ok(())\n}}\n"),
    )
    .expect("room on the disk");
}

/// Returns a cell's statements. A final expression, which the kernel would show, and the kernel's
/// commands, such as `:dep`, are dropped.
fn program(cell: &serde_json::Value) -> String {
    let lines = cell["source"].as_array().expect("lines");
    let text: String = lines
        .iter()
        .map(|line| line.as_str().expect("text"))
        .collect();
    let mut lines: Vec<&str> = text.lines().filter(|line| !line.starts_with(':')).collect();
    let shown = lines.pop().unwrap_or_default();
    let shown = if shown.ends_with([';', '}']) {
        shown.to_owned()
    } else {
        format!("let _shown = {shown};")
    };
    lines
        .iter()
        .chain([&shown.as_str()])
        .map(|line| format!("{line}\n"))
        .collect()
}
