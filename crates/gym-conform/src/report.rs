//! Findings about an environment, for people and for programs.

use std::fmt::{self, Write};
use std::str::FromStr;

use serde::Serialize;

use crate::checks::CHECKS;
use crate::finding::{Finding, Severity};
use gym_core::{Error, Result};

/// The findings about one environment.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// The environment.
    pub id: String,
    /// The rules that the environment breaks.
    pub findings: Vec<Finding>,
    /// The rules that the environment breaks with a reason in its registration.
    pub excused: Vec<Excused>,
    /// The rules that were not checked.
    pub skipped: Vec<Skipped>,
}

/// A rule that may be broken.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Excused {
    /// The name of the check.
    pub check: &'static str,
    /// The reason.
    pub reason: &'static str,
}

/// A rule that was not checked.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Skipped {
    /// The name of the check.
    pub check: &'static str,
    /// The reason.
    pub reason: String,
}

impl Report {
    /// Returns whether there is no finding, or only warnings.
    pub fn passes(&self) -> bool {
        self.findings
            .iter()
            .all(|finding| finding.severity == Severity::Warning)
    }

    fn verdict(&self) -> &'static str {
        match &self.findings[..] {
            [] => "ok",
            _ if self.passes() => "ok, with warnings",
            _ => "BROKEN",
        }
    }
}

/// The format of [`Report`]s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// For people.
    #[default]
    Text,
    /// A list of reports, with the fields of [`Report`].
    Json,
    /// JUnit's XML, which services for continuous integration display: a test suite for each
    /// environment, a test case for each check.
    Junit,
}

impl FromStr for Format {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "text" => Ok(Self::Text),
            "json" => Ok(Self::Json),
            "junit" => Ok(Self::Junit),
            _ => Err(Error::argument(
                "format",
                format!("unknown format `{text}`: the formats are text, json and junit"),
            )),
        }
    }
}

impl Format {
    /// Writes `reports` in this format.
    pub fn write(self, reports: &[Report]) -> String {
        let mut out = String::new();
        // Writing to a string does not fail.
        let _ = match self {
            Self::Text => write_text(&mut out, reports),
            Self::Json => {
                out = serde_json::to_string_pretty(reports).unwrap_or_default() + "\n";
                Ok(())
            }
            Self::Junit => write_junit(&mut out, reports),
        };
        out
    }
}

fn write_text(out: &mut String, reports: &[Report]) -> fmt::Result {
    for report in reports {
        writeln!(out, "{}: {}", report.id, report.verdict())?;
        for finding in &report.findings {
            for line in finding.to_string().lines() {
                writeln!(out, "  {line}")?;
            }
        }
        for Excused { check, reason } in &report.excused {
            writeln!(out, "  excused: {check}: {reason}")?;
        }
    }
    let broken = reports.iter().filter(|report| !report.passes()).count();
    let checks = CHECKS.len();
    writeln!(
        out,
        "{} environments, {checks} checks each, {broken} broken",
        reports.len()
    )
}

fn write_junit(out: &mut String, reports: &[Report]) -> fmt::Result {
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(out, "<testsuites>")?;
    for report in reports {
        let Report {
            id,
            findings,
            excused,
            skipped,
        } = report;
        let failures = findings
            .iter()
            .filter(|finding| finding.severity == Severity::Error)
            .count();
        let (tests, skips) = (CHECKS.len(), excused.len() + skipped.len());
        writeln!(
            out,
            r#"  <testsuite name="{}" tests="{tests}" failures="{failures}" skipped="{skips}">"#,
            Xml(id)
        )?;
        for check in CHECKS {
            write!(
                out,
                r#"    <testcase classname="{}" name="{}">"#,
                Xml(id),
                check.name
            )?;
            for finding in findings
                .iter()
                .filter(|finding| finding.check == check.name)
            {
                match finding.severity {
                    Severity::Error => {
                        let text = finding.to_string();
                        write!(
                            out,
                            r#"<failure message="{}">{}</failure>"#,
                            Xml(&finding.message),
                            Xml(&text)
                        )?;
                    }
                    Severity::Warning => {
                        write!(
                            out,
                            "<system-out>{}</system-out>",
                            Xml(&finding.to_string())
                        )?;
                    }
                }
            }
            let excuse = excused
                .iter()
                .find(|excused| excused.check == check.name)
                .map(|excused| excused.reason);
            let skip = skipped.iter().find(|skipped| skipped.check == check.name);
            if let Some(reason) = excuse.or(skip.map(|skipped| &*skipped.reason)) {
                write!(out, r#"<skipped message="{}"/>"#, Xml(reason))?;
            }
            writeln!(out, "</testcase>")?;
        }
        writeln!(out, "  </testsuite>")?;
    }
    writeln!(out, "</testsuites>")
}

/// A text, escaped for XML.
struct Xml<'a>(&'a str);

impl fmt::Display for Xml<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.chars().try_for_each(|c| match c {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            '"' => f.write_str("&quot;"),
            // XML allows no other control characters
            '\n' | '\t' => f.write_char(c),
            '\u{fffe}' | '\u{ffff}' => f.write_char('\u{fffd}'),
            c if c.is_control() => f.write_char('\u{fffd}'),
            c => f.write_char(c),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Vec<Report> {
        let finding = Finding {
            check: "reward-finite",
            severity: Severity::Error,
            message: "seed 0: \"<NaN>\" & more".into(),
            why: "it hurts",
            mend: "do not",
        };
        let warning = Finding {
            check: "described",
            severity: Severity::Warning,
            ..finding.clone()
        };
        let skipped = vec![Skipped {
            check: "render-modes",
            reason: "no painter".into(),
        }];
        let excused = vec![Excused {
            check: "any-thread",
            reason: "one window",
        }];
        let report = |id: &str, findings| Report {
            id: id.into(),
            findings,
            excused: vec![],
            skipped: vec![],
        };
        vec![
            Report {
                excused,
                skipped,
                ..report("a/Good-v0", vec![])
            },
            report("a/Fair-v0", vec![warning]),
            report("a/Bad-v0", vec![finding]),
        ]
    }

    #[test]
    fn text() {
        let text = Format::Text.write(&sample());
        assert!(text.starts_with(
            "a/Good-v0: ok\n  excused: any-thread: one window\na/Fair-v0: ok, with warnings\n"
        ));
        assert!(
            text.contains("a/Bad-v0: BROKEN\n  error: reward-finite: seed 0"),
            "{text}"
        );
        assert!(
            text.contains("    why: it hurts\n    mend: do not\n"),
            "{text}"
        );
        let last = format!("3 environments, {} checks each, 1 broken\n", CHECKS.len());
        assert!(text.ends_with(&last), "{text}");
    }

    #[test]
    fn json() {
        let json: serde_json::Value = serde_json::from_str(&Format::Json.write(&sample())).unwrap();
        assert_eq!(json[2]["findings"][0]["severity"], "error");
        assert_eq!(json[0]["excused"][0]["reason"], "one window");
    }

    #[test]
    fn junit_is_escaped_and_complete() {
        let xml = Format::Junit.write(&sample());
        assert!(
            xml.contains(r#"<failure message="seed 0: &quot;&lt;NaN&gt;&quot; &amp; more">"#),
            "{xml}"
        );
        for finding in sample().iter().flat_map(|report| &report.findings) {
            let whole = format!(">{}</", Xml(&finding.to_string()));
            assert!(xml.contains(&whole), "{whole} in {xml}");
        }
        assert_eq!(xml.matches("<testcase").count(), 3 * CHECKS.len());
        assert_eq!(
            (
                xml.matches("<failure").count(),
                xml.matches("<skipped").count()
            ),
            (1, 2)
        );
        assert!(Xml("\u{1b}[0m").to_string().starts_with('\u{fffd}'));
    }

    #[test]
    fn formats_have_names() {
        assert_eq!("junit".parse::<Format>().unwrap(), Format::Junit);
        assert!(
            "xml"
                .parse::<Format>()
                .unwrap_err()
                .to_string()
                .contains("text, json and junit")
        );
    }
}
