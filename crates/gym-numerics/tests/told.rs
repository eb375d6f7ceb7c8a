//! Texts of users in messages: where they are cut, and how their numbers are written.

use gym_numerics::text::{brief, printable, shortened};

#[test]
fn a_long_number_is_written_with_an_exponent_where_it_stands_alone() {
    let long = format!("12{}", "0".repeat(30));
    let with_point = format!("{long}.5");
    for (before, after) in [
        ("", ""),
        (" ", " "),
        ("-", ","),
        ("[", "]"),
        ("(", ")"),
        ("=", "\n"),
        ("±", ";"),
        ("/", "/"),
        (": ", "\""),
    ] {
        for number in [&long, &with_point] {
            assert_eq!(
                brief(&format!("{before}{number}{after}")),
                format!("{before}1.2e31{after}")
            );
        }
        // a second number, and short ones
        let told = brief(&format!("7{before}{long}{after} 0.5 {long}!")).into_owned();
        let first = if before.is_empty() {
            format!("7{long}").parse::<f64>().unwrap()
        } else {
            1.2e31
        };
        let start = if before.is_empty() {
            String::new()
        } else {
            format!("7{before}")
        };
        assert_eq!(told, format!("{start}{first:e}{after} 0.5 1.2e31!"));
    }
    for before in ["\"", "'", "`", "_", "x", "é"] {
        let message = format!("{before}{long} is a name");
        assert_eq!(brief(&message), message);
    }
    // as many digits as a float may have, none, one more, digits behind a point, and no number at all
    for (message, told) in [
        ("1".repeat(25), "1".repeat(25)),
        (
            "1".repeat(26),
            format!("{:e}", 11_111_111_111_111_111_111_111_111_f64),
        ),
        (
            format!("0.{}", "1".repeat(23)),
            format!("0.{}", "1".repeat(23)),
        ),
        (format!("0.{}", "1".repeat(24)), format!("{:e}", 1.0 / 9.0)),
        (
            format!(".{}", "1".repeat(40)),
            format!(".{}", "1".repeat(40)),
        ),
        (
            format!("1.2.{}", "3".repeat(40)),
            format!("1.2.{}", "3".repeat(40)),
        ),
        ("9".repeat(400), "9".repeat(400)),
    ] {
        assert_eq!(brief(&message), told);
    }
}

#[test]
fn long_texts_are_cut_between_characters() {
    for letter in ["a", "é", "𝄞"] {
        let text = |length: usize| letter.repeat(length);
        assert_eq!(shortened(&text(200)), text(200));
        assert_eq!(shortened(&text(201)), text(200) + "...");
        assert_eq!(brief(&text(1000)), text(1000));
        assert_eq!(
            brief(&format!("<{}>", text(999))),
            format!("<{} ... {}>", text(199), text(100))
        );
    }
}

/// Characters that are hidden, or that move others, are escaped; letters and signs of every script stay.
#[test]
fn hidden_characters_are_shown() {
    for hidden in [
        '\0',
        '\t',
        '\n',
        '\r',
        '\u{1b}',
        '\u{7f}',
        '\u{85}',
        '\u{9f}',
        '\u{ad}',
        '\u{61c}',
        '\u{200b}',
        '\u{200e}',
        '\u{2028}',
        '\u{2029}',
        '\u{202a}',
        '\u{202e}',
        '\u{2066}',
        '\u{2069}',
        '\u{feff}',
        '\u{fff9}',
        '\u{e0001}',
    ] {
        assert_eq!(
            printable(&format!("a{hidden}b")),
            format!("a{}b", hidden.escape_unicode()),
            "{hidden:?}"
        );
    }
    for shown in [' ', '~', 'é', 'ß', 'Ж', '中', 'ع', '€', '→', '\u{a0}', '🙂'] {
        assert_eq!(
            printable(&format!("a{shown}b")),
            format!("a{shown}b"),
            "{shown:?}"
        );
    }
}
