//! `docs/notebook.ipynb` runs, and contains its outputs.

include!(concat!(env!("OUT_DIR"), "/notebook.rs"));

#[test]
fn its_cells_run() {
    notebook().unwrap();
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
