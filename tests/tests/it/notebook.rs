//! `docs/notebook.ipynb` runs, and contains its outputs.

include!(concat!(env!("OUT_DIR"), "/notebook.rs"));

#[test]
fn its_cells_run() {
    notebook().unwrap();
}

/// Cargo refuses a dependency whose package has another name than its folder's manifest.
#[test]
fn pages_name_the_package_of_the_facade() {
    let manifest = include_str!("../../../crates/gym/Cargo.toml");
    let name = manifest
        .lines()
        .find_map(|line| line.strip_prefix("name = "))
        .unwrap();
    for (page, text) in [
        ("README.md", include_str!("../../../README.md")),
        (
            "first-steps.md",
            include_str!("../../../docs/first-steps.md"),
        ),
        (
            "notebook.ipynb",
            include_str!("../../../docs/notebook.ipynb"),
        ),
    ] {
        let text = text.replace("\\\"", "\"");
        let dependencies: Vec<_> = text
            .lines()
            .filter(|line| line.contains("gym = {"))
            .collect();
        assert!(!dependencies.is_empty(), "{page}");
        for dependency in dependencies {
            let named = format!("package = {name}");
            assert!(dependency.contains(&named), "{page}: {dependency}");
        }
    }
}

#[test]
fn it_was_run_and_shows_pictures() {
    let text = include_str!("../../../docs/notebook.ipynb");
    let notebook: serde_json::Value = serde_json::from_str(text).unwrap();
    let cells = notebook["cells"].as_array().unwrap();
    let code = || cells.iter().filter(|cell| cell["cell_type"] == "code");
    assert!(
        code().all(|cell| cell["execution_count"].is_number()),
        "a cell was not executed"
    );
    let outputs: Vec<_> = code()
        .flat_map(|cell| cell["outputs"].as_array().unwrap())
        .collect();
    assert!(
        outputs
            .iter()
            .all(|output| output["output_type"] != "error")
    );
    for shown in ["image/png", "image/svg+xml", "text/html"] {
        assert!(
            outputs
                .iter()
                .any(|output| output["data"].get(shown).is_some()),
            "no {shown}"
        );
    }
    assert!(text.contains("data:image/gif;base64,"), "no animation");
}
