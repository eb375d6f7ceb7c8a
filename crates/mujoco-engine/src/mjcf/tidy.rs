//! Text that MuJoCo's parser takes, and that is not XML, as XML: attributes without a space between
//! them, `&` and `<` in values, `--` in comments, a document type, a second declaration.

use std::borrow::Cow;

/// Returns `text` as XML with the same lines. Text that MuJoCo's parser refuses too stays as it is.
pub(crate) fn tidy(text: &str) -> Cow<'_, str> {
    let mut out = String::with_capacity(text.len() + text.len() / 16);
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        escape(&rest[..start], &mut out);
        rest = &rest[start..];
        let length = if let Some(comment) = rest.strip_prefix("<!--") {
            let Some(end) = comment.find("-->") else {
                break;
            };
            out.push_str("<!--");
            out.push_str(&comment[..end].replace('-', " "));
            out.push_str("-->");
            end + 7
        } else if rest.starts_with("<![CDATA[") {
            let Some(end) = rest.find("]]>") else { break };
            out.push_str(&rest[..end + 3]);
            end + 3
        } else if rest.starts_with("<!DOCTYPE") || rest.starts_with("<?xml ") {
            let Some(end) = rest.find('>') else { break };
            let declaration = &rest[..=end];
            if out.is_empty() && rest.starts_with("<?") || declaration.contains('[') {
                out.push_str(declaration);
            } else {
                out.extend(declaration.chars().filter(|c| *c == '\n'));
            }
            end + 1
        } else {
            tag(rest, &mut out)
        };
        rest = &rest[length..];
    }
    out.push_str(rest);
    if out == text {
        Cow::Borrowed(text)
    } else {
        Cow::Owned(out)
    }
}

/// Copies a tag; returns its length.
fn tag(rest: &str, out: &mut String) -> usize {
    let mut at = 0;
    let stops = |byte: u8| matches!(byte, b'>' | b'"' | b'\'');
    while let Some(next) = rest[at..].bytes().position(stops) {
        out.push_str(&rest[at..at + next]);
        at += next;
        let quote = &rest[at..=at];
        if quote == ">" {
            out.push('>');
            return at + 1;
        }
        let Some(length) = rest[at + 1..].find(quote) else {
            break;
        };
        out.push_str(quote);
        escape(&rest[at + 1..at + 1 + length], out);
        out.push_str(quote);
        at += length + 2;
        let follows = rest[at..].chars().next();
        if follows.is_some_and(|c| c.is_alphabetic() || c == '_') {
            out.push(' ');
        }
    }
    out.push_str(&rest[at..]);
    rest.len()
}

/// Copies a text with `<`, and `&` without a reference, as references.
fn escape(text: &str, out: &mut String) {
    let mut rest = text;
    let is_odd = |byte: u8| matches!(byte, b'&' | b'<');
    while let Some(start) = rest.bytes().position(is_odd) {
        out.push_str(&rest[..start]);
        let reference = |name: &str| rest[start + 1..].starts_with(name);
        out.push_str(match &rest[start..=start] {
            "<" => "&lt;",
            _ if ["amp;", "lt;", "gt;", "quot;", "apos;", "#"]
                .into_iter()
                .any(reference) =>
            {
                "&"
            }
            _ => "&amp;",
        });
        rest = &rest[start + 1..];
    }
    out.push_str(rest);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn xml_stays_and_the_rest_becomes_xml() {
        let xml = "<?xml version=\"1.0\"?>\n<a b='1' c=\"2\"><!-- x --><d/>text &amp; &#65;</a>";
        assert!(matches!(tidy(xml), Cow::Borrowed(text) if text == xml));
        for (given, expected) in [
            ("<a b=\"1\"c='2'd=\"3\"/>", "<a b=\"1\" c='2' d=\"3\"/>"),
            ("<a b=\"x & y < z\"/>", "<a b=\"x &amp; y &lt; z\"/>"),
            ("<a b='>' c=''/>", "<a b='>' c=''/>"),
            ("<a><!-- b -- c --></a>", "<a><!-- b    c --></a>"),
            ("<!DOCTYPE a>\n<a/>", "\n<a/>"),
            ("\n<?xml version=\"1.0\"?><a/>", "\n<a/>"),
            ("<a b=\"", "<a b=\""),
            ("<a", "<a"),
            ("<!-- a", "<!-- a"),
        ] {
            assert_eq!(tidy(given), expected, "{given}");
        }
    }
}
