//! How each finding begins, beside a recording, `tests/plugins/broken/findings.txt`. After an
//! intended change, read what differs, and record again with
//! `GYM_UPDATE_KEPT=1 cargo test --package broken-envs --test it recorded`.

use std::path::Path;

use gym_testing::kept;

use super::bites::REPORTS;

/// Returns the start of a text, up to its first fraction or quoted text: these may depend on chance.
fn start(text: &str) -> String {
    const MOST: usize = 120;
    let start: String = text.replace('\n', " ").chars().take(MOST).collect();
    let start = start.split("Some(\"").next().unwrap_or_default();
    let digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    let mut points = start.match_indices('.').map(|(place, _)| place);
    let fraction = points.find(|&point| {
        let (before, after) = (&start[..point], &start[point + 1..]);
        digit(before.chars().next_back()) && digit(after.chars().next())
    });
    let whole = fraction.map_or(start, |point| {
        start[..point].trim_end_matches(|c: char| c.is_ascii_digit() || c == '-')
    });
    whole.trim_end().to_owned()
}

#[test]
fn findings_begin_as_they_did() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("findings.txt");
    let lines = REPORTS.iter().flat_map(|report| {
        let found = report.findings.iter();
        found.map(|finding| format!("{}: {}\n", report.id, start(&finding.message)))
    });
    let text: String = lines.collect();
    kept(&path, &text);
}
