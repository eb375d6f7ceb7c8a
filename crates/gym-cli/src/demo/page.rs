//! The page of the demo: one file, which needs no network.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::policy::Episode;

/// A family with its environments. A card is `None` until the environment was played.
pub(super) struct Section {
    pub(super) name: &'static str,
    /// What to do to play more of it.
    pub(super) missing: Option<String>,
    pub(super) cards: Vec<Option<Card>>,
}

/// An environment that was played.
pub(super) struct Card {
    pub(super) id: String,
    pub(super) description: &'static str,
    /// The good policy, as a phrase; `None` for random actions.
    pub(super) policy: Option<&'static str>,
    /// The spaces of observations and actions.
    pub(super) spaces: [String; 2],
    /// Whether a person can play it with keys.
    pub(super) has_keys: bool,
    /// The bytes of a GIF.
    pub(super) picture: Vec<u8>,
    pub(super) episodes: Vec<Episode>,
}

impl Section {
    pub(super) fn new(name: &'static str) -> Self {
        Self {
            name,
            missing: None,
            cards: Vec::new(),
        }
    }

    /// Returns the section's HTML; an empty text if there is nothing to show yet.
    fn html(&self, number: usize) -> String {
        let cards: String = self.cards.iter().flatten().map(Card::html).collect();
        let missing = self.missing.as_ref().map_or_else(String::new, |missing| {
            format!("<p class=\"missing\">{}</p>\n", escaped(missing))
        });
        if cards.is_empty() && missing.is_empty() {
            return String::new();
        }
        let name = escaped(self.name);
        format!(
            "<section id=\"f{number}\">\n<h2>{name}</h2>\n{missing}<div class=\"cards\">\n{cards}</div>\n</section>\n"
        )
    }
}

impl Card {
    fn html(&self) -> String {
        let Self {
            id,
            description,
            policy,
            spaces: [observation, action],
            has_keys,
            picture,
            episodes,
        } = self;
        let (id, last) = (escaped(id), episodes.len().saturating_sub(1));
        let (policy, option) = match policy {
            Some(policy) => (
                format!("the good policy {}", escaped(policy)),
                " --policy good",
            ),
            None => ("random actions".to_owned(), ""),
        };
        let column = |value: fn(&Episode) -> f64| episodes.iter().map(value).collect::<Vec<_>>();
        let returns = chart("return", &column(|episode| episode.episode_return));
        let lengths = chart("length", &column(|episode| episode.length as f64));
        let keys = if *has_keys {
            format!("<dt>Play it yourself</dt><dd><code>cargo xtask play {id}</code></dd>")
        } else {
            String::new()
        };
        format!(
            "<article>\n<div class=\"picture\"><img alt=\"An episode of {id}\" src=\"data:image/gif;base64,{}\"></div>\n\
             <h3>{id}</h3>\n<p>{}</p>\n<div class=\"charts\">{returns}{lengths}</div>\n\
             <dl><dt>Observation</dt><dd><code>{}</code></dd><dt>Action</dt><dd><code>{}</code></dd>\
             <dt>Played by</dt><dd>{policy}, seeds 0 to {last}</dd>\
             <dt>Again</dt><dd><code>cargo xtask run {id}{option} --seeds 0..{}</code></dd>{keys}</dl>\n</article>\n",
            STANDARD.encode(picture),
            escaped(description),
            escaped(&one_line(observation)),
            escaped(&one_line(action)),
            episodes.len(),
        )
    }
}

/// Returns the page with all that was played so far.
pub(super) fn html(sections: &[Section]) -> String {
    let cards = || sections.iter().flat_map(|section| &section.cards);
    let (played, all) = (cards().flatten().count(), cards().count());
    let mut body = String::new();
    let mut links = String::new();
    for (number, section) in sections.iter().enumerate() {
        let text = section.html(number);
        if !text.is_empty() {
            links += &format!("<a href=\"#f{number}\">{}</a>\n", escaped(section.name));
        }
        body += &text;
    }
    let state = if played < all {
        format!("<p class=\"missing\">{played} of {all} tasks so far: reload for the rest.</p>\n")
    } else {
        String::new()
    };
    format!(
        "{HEAD}{state}<nav>\n{links}</nav>\n</header>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}

/// Returns `text` with the characters escaped that have a meaning in HTML.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            c => escaped.push(c),
        }
    }
    escaped
}

/// Returns the text of a space in one line. (numpy breaks long arrays into lines.)
fn one_line(space: &str) -> String {
    space.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns a figure: the mean of one value per episode, and a plot of the values.
fn chart(name: &str, values: &[f64]) -> String {
    /// The width of the plot, and the heights of plot and margin.
    const SIZE: [f64; 3] = [150.0, 48.0, 4.0];
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let [width, height, margin] = SIZE;
    let across = (width - 2.0 * margin) / values.len().saturating_sub(1).max(1) as f64;
    let up = (height - 2.0 * margin) / (high - low).max(f64::MIN_POSITIVE);
    let points = values.iter().enumerate().map(|(i, value)| {
        // equal values are a line in the middle
        let y = if high > low {
            (value - low) * up
        } else {
            height / 2.0 - margin
        };
        (margin + across * i as f64, height - margin - y)
    });
    let line: String = points
        .clone()
        .map(|(x, y)| format!("{x:.1},{y:.1} "))
        .collect();
    let dots: String = points
        .map(|(x, y)| format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.5\"/>"))
        .collect();
    format!(
        "<figure><figcaption>{name} <b>{mean:.2}</b></figcaption>\
         <svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{name} of each episode\">\
         <polyline points=\"{}\"/>{dots}</svg><small>{low:.1} to {high:.1}</small></figure>",
        line.trim_end()
    )
}

/// The page before the links to its sections.
const HEAD: &str = include_str!("head.html");

#[cfg(test)]
mod tests {
    use gym::Value;

    use super::*;

    fn card(returns: &[f64]) -> Card {
        let episode = |(seed, episode_return): (u64, &f64)| Episode {
            seed,
            episode_return: *episode_return,
            length: 7,
            terminated: true,
            truncated: false,
            last_reward: 0.0,
            last_observation: Value::Null,
        };
        Card {
            id: "a/<b>-v0".into(),
            description: "Balance \"it\" & win.",
            policy: None,
            spaces: ["Box([0\n 1], (2,))".into(), "Discrete(2)".into()],
            has_keys: true,
            picture: b"GIF".to_vec(),
            episodes: (0..).zip(returns).map(episode).collect(),
        }
    }

    #[test]
    fn text_of_an_environment_is_no_html() {
        let html = card(&[1.0, 3.0]).html();
        for text in [
            "a/&lt;b&gt;-v0",
            "Balance &quot;it&quot; &amp; win.",
            "Box([0 1], (2,))",
        ] {
            assert!(html.contains(text), "{text}: {html}");
        }
        assert!(!html.contains("<b>-v0"), "{html}");
    }

    #[test]
    fn a_card_has_means_and_commands() {
        let html = card(&[1.0, 3.0]).html();
        assert!(
            html.contains("return <b>2.00</b>") && html.contains("1.0 to 3.0"),
            "{html}"
        );
        assert!(html.contains("length <b>7.00</b>"), "{html}");
        assert!(
            html.contains("cargo xtask run a/&lt;b&gt;-v0 --seeds 0..2<"),
            "{html}"
        );
        assert!(html.contains("cargo xtask play"), "{html}");
        // one episode, and equal ones, stay in the picture
        for returns in [&[5.0][..], &[5.0, 5.0, 5.0]] {
            let html = card(returns).html();
            assert!(!html.contains("NaN") && !html.contains("inf"), "{html}");
            assert_eq!(html.matches("<circle").count(), 2 * returns.len(), "{html}");
        }
    }

    #[test]
    fn an_unfinished_page_says_so() {
        let mut section = Section::new("Toys");
        section.cards = vec![Some(card(&[1.0])), None];
        let mut empty = Section::new("Later");
        empty.cards.push(None);
        let page = html(&[section, empty]);
        assert!(page.contains("1 of 3 tasks so far"), "{page}");
        assert!(
            page.contains("<h2>Toys</h2>") && !page.contains("Later"),
            "{page}"
        );
        let mut section = Section::new("Toys");
        section.cards = vec![Some(card(&[1.0]))];
        section.missing = Some("bring <it>".into());
        let page = html(&[section]);
        assert!(
            !page.contains("so far") && page.contains("bring &lt;it&gt;"),
            "{page}"
        );
        assert!(page.ends_with("</html>\n"));
    }
}
