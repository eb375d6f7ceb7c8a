//! The text of the model.

use std::fmt::Write;

use super::{Config, FLOOR, Kind, TERRAIN};

/// The joints of the legs.
pub(super) const HINGES: usize = 16;

/// The legs: name, place and direction of the hip.
const LEGS: [(&str, [f64; 2], i32); 4] = [
    ("front_left", [0.2, 0.2], 45),
    ("front_right", [0.2, -0.2], -45),
    ("back_right", [-0.2, -0.2], -135),
    ("back_left", [-0.2, 0.2], 135),
];

/// The rays, in rows from above: y at the start of each, height at the start, and x and height at
/// the end, which is behind it.
const RAYS: [([&str; 5], &str, &str); 4] = [
    (
        ["-0.02", "-0.01", "0", "0.01", "0.02"],
        "0.11",
        "0.34 0 0.115",
    ),
    (
        ["-0.02", "-0.02", "0", "0.01", "0.02"],
        "0.1",
        "0.36 0 0.11",
    ),
    (
        ["-0.02", "-0.01", "0", "0.01", "0.02"],
        "0.09",
        "0.38 0 0.105",
    ),
    (["-0.02", "-0.01", "0", "0.01", "0.02"], "0.08", "0.4 0 0.1"),
];

const WALLS: &str = r#"<geom class="wall" pos="-15.7 0 0.7" zaxis="1 0 1" size="1 15 0.5"/>
    <geom class="wall" pos="0 -15.7 0.7" zaxis="0 1 1" size="15 1 0.5"/>
    <geom class="wall" pos="15.7 0 0.7" zaxis="-1 0 1" size="1 15 0.5"/>
    <geom class="wall" pos="0 15.7 0.7" zaxis="0 -1 1" size="15 1 0.5"/>
    <site name="target" type="cylinder" pos="0 0 0.05" size="0.4 0.06" material="goal"/>"#;

const BALL: &str = r#"<body name="ball" pos="0 0 3">
      <freejoint name="ball_root"/>
      <geom name="ball" size="0.15" priority="1" condim="6" friction="0.7 0.005 0.005" solref="-10000 -30" material="tool"/>
    </body>"#;

const BUMPS: &str =
    r#"<geom name="terrain" type="hfield" hfield="terrain" pos="0 0 -0.01" material="ground"/>"#;

pub(super) fn text(config: &Config) -> String {
    let (mut legs, mut rays) = (String::new(), String::new());
    let (mut couplings, mut tendons) = (String::new(), String::new());
    let (mut equalities, mut actuators) = (String::new(), String::new());
    let (mut forces, mut torques) = (String::new(), String::new());
    for (leg, [x, y], turn) in LEGS {
        let text = include_str!("../../../models/quadruped_leg.xml");
        let text = text
            .replace("{leg}", leg)
            .replace("{turn}", &turn.to_string());
        legs += &text
            .replace("{x}", &x.to_string())
            .replace("{y}", &y.to_string());
        couplings += &tendon("coupling", leg, ["0.333", "0.333", "0.333"]);
        tendons += &tendon("extend", leg, ["0.25", "-0.5", "0.25"]);
        tendons += &tendon("lift", leg, ["0.5", "", "-0.5"]);
        equalities += &format!("\n    <tendon class=\"coupling\" tendon1=\"coupling_{leg}\"/>");
        for (part, kind, range) in [
            ("yaw", "joint", "-1 1"),
            ("lift", "tendon", "-1 1.1"),
            ("extend", "tendon", "-0.8 0.8"),
        ] {
            actuators += &format!(
                "\n    <general name=\"{part}_{leg}\" {kind}=\"{part}_{leg}\" ctrlrange=\"{range}\"/>"
            );
        }
        forces += &format!("\n    <force name=\"force_{leg}\" site=\"toe_{leg}\"/>");
        torques += &format!("\n    <torque name=\"torque_{leg}\" site=\"toe_{leg}\"/>");
    }
    let mut sensors = forces + &torques;
    if config.goal == Kind::Escape {
        for (row, (starts, height, end)) in RAYS.into_iter().enumerate() {
            for (k, y) in starts.into_iter().enumerate() {
                let name = format!("ray_{row}{k}");
                // writing to a string cannot fail
                let _ = write!(
                    rays,
                    "<site name=\"{name}\" class=\"ray\" fromto=\"0.41 {y} {height} {end}\" rgba=\"0 0 0 0\"/>\n      "
                );
                sensors += &format!("\n    <rangefinder name=\"{name}\" site=\"{name}\"/>");
            }
        }
    }
    let floor = match config.goal {
        Kind::Speed => 20.0 * config.speed,
        Kind::Escape => 40.0,
        Kind::Fetch => FLOOR,
    };
    let field = format!(
        "<asset><hfield name=\"terrain\" nrow=\"{0}\" ncol=\"{0}\" size=\"{TERRAIN} {TERRAIN} 5 0.1\"/></asset>",
        super::terrain::POINTS
    );
    let (assets, scenery, ball) = match config.goal {
        Kind::Speed => ("", "", ""),
        Kind::Escape => (&*field, BUMPS, ""),
        Kind::Fetch => ("", WALLS, BALL),
    };
    include_str!("../../../models/quadruped.xml")
        .replace("{assets}", assets)
        .replace("{floor}", &floor.to_string())
        .replace("{scenery}", scenery)
        .replace("{rays}", rays.trim_end())
        .replace("{legs}", legs.trim_end())
        .replace("{ball}", ball)
        .replace("{tendons}", &(couplings + &tendons))
        .replace("{equalities}", &equalities)
        .replace("{actuators}", &actuators)
        .replace("{sensors}", &sensors)
}

/// A tendon of a leg: the sum of the angles of pitch, knee and ankle with factors, of which an empty
/// one leaves its joint out.
fn tendon(name: &str, leg: &str, factors: [&str; 3]) -> String {
    let joints = ["pitch", "knee", "ankle"].into_iter().zip(factors);
    let joints = joints.filter(|(_, factor)| !factor.is_empty());
    let joints: String = joints
        .map(|(joint, factor)| format!("<joint joint=\"{joint}_{leg}\" coef=\"{factor}\"/>"))
        .collect();
    format!("\n    <fixed name=\"{name}_{leg}\">{joints}</fixed>")
}
