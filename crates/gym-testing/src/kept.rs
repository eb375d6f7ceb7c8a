use std::path::Path;

/// Compares a text with the file that keeps it, line by line. If the environment variable
/// `GYM_UPDATE_KEPT` is set, stores the text first.
///
/// # Panics
/// If a line differs, or the file cannot be written.
pub fn kept(path: &Path, text: &str) {
    if std::env::var_os("GYM_UPDATE_KEPT").is_some() {
        std::fs::write(path, text).expect("a place for the file");
    }
    let kept = std::fs::read_to_string(path).unwrap_or_default();
    let path = path.display();
    for (line, (kept, text)) in kept.lines().zip(text.lines()).enumerate() {
        assert_eq!(text, kept, "{path}, line {}", line + 1);
    }
    assert_eq!(
        text.lines().count(),
        kept.lines().count(),
        "lines of {path}"
    );
}
