//! What findings say and why checks are skipped, beside recordings in this package's folder. After an
//! intended change, read what differs, and record again with
//! `GYM_UPDATE_KEPT=1 cargo test --package broken-envs --test it recorded`.

use std::collections::BTreeMap;
use std::path::Path;

use gym_conform::CHECKS;
use gym_testing::kept;

use super::bites::REPORTS;

fn compare(name: &str, text: &str) {
    kept(&Path::new(env!("CARGO_MANIFEST_DIR")).join(name), text);
}

/// Returns a text with `#` for each number that has a fraction, which may depend on chance, and for the number of an
/// environment, which is how many were made before.
fn masked(mut rest: &str) -> String {
    let mut text = String::new();
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, number) = rest.split_at(at);
        let end = number.find(|c: char| !c.is_ascii_digit() && c != '.');
        let (number, after) = number.split_at(end.unwrap_or(number.len()));
        let digits = number.trim_end_matches('.');
        if digits.contains('.') || before.ends_with("\"number\":") {
            text += before.trim_end_matches('-');
            text += "#";
        } else {
            text += before;
            text += number;
        }
        rest = after;
    }
    text + rest
}

/// Returns the start and the end of a text, up to quoted text, which may depend on chance.
fn ends(text: &str) -> String {
    const START: usize = 120;
    const END: usize = 60;
    let text = masked(&text.replace('\n', " "));
    let text = text.split("Some(\"").next().unwrap_or_default();
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= START + END {
        return text.trim_end().to_owned();
    }
    let (start, end) = (&letters[..START], &letters[letters.len() - END..]);
    let [start, end] = [start, end].map(|part| part.iter().collect::<String>());
    format!("{} ... {}", start.trim_end(), end.trim())
}

#[test]
fn findings_say_what_they_said() {
    let lines = REPORTS.iter().flat_map(|report| {
        let found = report.findings.iter();
        found.map(|finding| format!("{}: {}\n", report.id, ends(&finding.message)))
    });
    let text: String = lines.collect();
    compare("findings.txt", &text);
}

/// Each reason, with the number of environments of which it is told.
#[test]
fn checks_are_skipped_for_the_reasons_they_were() {
    let place = |name: &str| CHECKS.iter().position(|check| check.name == name);
    let mut reasons = BTreeMap::new();
    for skipped in REPORTS.iter().flat_map(|report| &report.skipped) {
        let reason = (place(skipped.check), skipped.check, ends(&skipped.reason));
        *reasons.entry(reason).or_insert(0) += 1;
    }
    let lines = reasons
        .iter()
        .map(|((_, check, reason), count)| format!("{check}: {reason} ({count})\n"));
    let text: String = lines.collect();
    compare("skipped.txt", &text);
}

#[test]
fn checks_have_the_reasons_and_remedies_they_had() {
    let lines = CHECKS.iter().map(|check| {
        let (severity, name) = (check.severity, check.name);
        format!("{severity:?} {name}\n  {}\n  {}\n", check.why, check.mend)
    });
    let text: String = lines.collect();
    compare("checks.txt", &text);
    for finding in REPORTS.iter().flat_map(|report| &report.findings) {
        let check = CHECKS.iter().find(|check| check.name == finding.check);
        let check = check.expect("a finding is of a check");
        assert_eq!(
            (finding.severity, finding.why, finding.mend),
            (check.severity, check.why, check.mend),
            "{}",
            finding.check
        );
    }
}

/// A crate that nothing links registers nothing, which is no pass.
#[test]
fn a_suite_of_no_environments_says_how_to_register_one() {
    let panic = std::panic::catch_unwind(|| gym_conform::assert_conforms("no_such_crate"));
    let panic = panic.unwrap_err();
    let expected = "`no_such_crate` registers no environment: put `gym_core::register!(...)` at the top \
                    level of a module, and let there be one gym-core in `cargo tree --duplicates`";
    assert_eq!(panic.downcast_ref::<String>().unwrap(), expected);
}
