//! What the source file of an environment says about it.

/// The text after `//!`: the module's own documentation.
pub(super) fn module_docs(source: &str) -> String {
    let lines = source.lines().map_while(|line| line.strip_prefix("//!"));
    lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>().join("\n")
}

/// A field of a struct or a variant of an enum.
#[derive(Debug, PartialEq)]
pub(super) struct Member {
    pub(super) name: String,
    /// The type of a field; empty for a variant.
    pub(super) kind: String,
    pub(super) docs: String,
}

/// The documented members of `pub struct NAME` or `pub enum NAME`; none if there is no such item.
pub(super) fn members(source: &str, item: &str) -> Vec<Member> {
    let mut members = Vec::new();
    let mut docs = Vec::new();
    let lines = source.lines().map(str::trim).skip_while(|line| *line != format!("pub {item} {{"));
    for line in lines.skip(1).take_while(|line| *line != "}") {
        if let Some(text) = line.strip_prefix("///") {
            docs.push(text.trim());
        } else if !line.starts_with('#') {
            let member = line.trim_end_matches(',').trim_start_matches("pub ");
            let (name, kind) = member.split_once(": ").unwrap_or((member, ""));
            members.push(Member { name: name.into(), kind: kind.into(), docs: docs.join(" ") });
            docs.clear();
        }
    }
    members
}

/// Rustdoc's links to items as plain code, without the brackets around it.
pub(super) fn without_item_links(text: &str) -> String {
    // where more code follows at once, both become one: [`f`]`(x)` is `f(x)`
    text.replace("`]`", "").replace("[`", "`").replace("`]", "`")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "//! Title.\n//!\n//! More, with [`Config`] and [`f`]`(x)`.\n\nuse x;\n\n\
        #[serde(default)]\npub struct Config {\n    /// First\n    /// line.\n    pub g: f64,\n    \
        #[serde(skip)]\n    /// Other.\n    pub map: Option<Vec<String>>,\n}\n\
        discrete! {\n    pub enum Action {\n        /// Left.\n        Left,\n    }\n}\n";

    #[test]
    fn module_docs_end_with_their_lines() {
        let docs = module_docs(SOURCE);
        assert_eq!(without_item_links(&docs), "Title.\n\nMore, with `Config` and `f(x)`.");
    }

    #[test]
    fn members_have_names_types_and_docs() {
        let member = |name: &str, kind: &str, docs: &str| Member {
            name: name.into(),
            kind: kind.into(),
            docs: docs.into(),
        };
        assert_eq!(
            members(SOURCE, "struct Config"),
            [member("g", "f64", "First line."), member("map", "Option<Vec<String>>", "Other.")]
        );
        assert_eq!(members(SOURCE, "enum Action"), [member("Left", "", "Left.")]);
        assert_eq!(members(SOURCE, "enum Engine"), []);
    }
}
