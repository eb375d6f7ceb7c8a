//! The ids of ale-py 0.12.1, and the two older families that ale-py has dropped.

/// Registers a game: `ids!("breakout", "Breakout", 4)`, where 4 is the frame skip of its
/// `Deterministic` ids. Games that ale-py had before version 5 have the older ids too.
macro_rules! ids {
    ($name:expr, $title:literal, v5) => {
        ids!(@id $name, concat!("ALE/", $title, "-v5"), r#""frameskip": 4, "repeat_action_probability": 0.25"#);
    };
    ($name:expr, $title:literal, $deterministic:literal) => {
        ids!($name, $title, v5);
        ids!(@versions $name, $title, "", r#""frameskip": [2, 5]"#);
        ids!(@versions $name, $title, "NoFrameskip", r#""frameskip": 1"#);
        ids!(@versions $name, $title, "Deterministic", concat!(r#""frameskip": "#, $deterministic));
    };
    (@versions $name:expr, $title:literal, $family:literal, $frameskip:expr) => {
        ids!(@id $name, concat!($title, $family, "-v0"), concat!($frameskip, r#", "repeat_action_probability": 0.25"#));
        ids!(@id $name, concat!($title, $family, "-v4"), concat!($frameskip, r#", "repeat_action_probability": 0.0"#));
        ids!(@id $name, concat!($title, "-ram", $family, "-v0"),
            concat!($frameskip, r#", "repeat_action_probability": 0.25, "obs_type": "ram""#));
        ids!(@id $name, concat!($title, "-ram", $family, "-v4"),
            concat!($frameskip, r#", "repeat_action_probability": 0.0, "obs_type": "ram""#));
    };
    (@id $name:expr, $id:expr, $kwargs:expr) => {
        gym_core::register!(
            gym_core::Registration::new::<crate::env::AtariEnv>($id)
                .description("Play a game of the Atari 2600, from its picture or its RAM.")
                .keys(crate::env::keys::keys)
                .names(crate::env::names)
                .kwargs(concat!(
                    r#"{"game": ""#, $name, r#"", "max_num_frames_per_episode": 108000, "#, $kwargs, "}"
                ))
        );
    };
}
pub(crate) use ids;
