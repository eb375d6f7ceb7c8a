//! A section may stand twice: the second goes on from the first.

use mujoco_engine::Model;
use serde_json::Value;

/// A section or a part of one, and attributes of which each changes the model of [`compiled`].
const ROWS: &[(&str, &str, &[[&str; 2]])] = &[
    (
        "compiler",
        "",
        &[
            ["angle='radian'", "eulerseq='zyx'"],
            ["boundmass='3'", "boundinertia='7'"],
            ["settotalmass='9'", "autolimits='false'"],
            ["inertiafromgeom='true'", "fusestatic='true'"],
            ["inertiagrouprange='1 2'", "coordinate='local'"],
        ],
    ),
    (
        "option",
        "",
        &[
            ["timestep='0.5'", "gravity='1 2 3'"],
            ["wind='1 2 3'", "density='2'"],
            ["viscosity='3'", "magnetic='4 5 6'"],
            ["integrator='RK4'", "cone='elliptic'"],
            ["solver='CG'", "jacobian='sparse'"],
            ["iterations='7'", "tolerance='0.5'"],
            ["ls_iterations='7'", "ls_tolerance='0.5'"],
            ["noslip_iterations='7'", "noslip_tolerance='0.5'"],
            ["ccd_iterations='7'", "ccd_tolerance='0.5'"],
            ["impratio='2'", "actuatorgroupdisable='1 3'"],
        ],
    ),
    (
        "flag",
        "option",
        &[
            ["contact='disable'", "energy='enable'"],
            ["gravity='disable'", "warmstart='disable'"],
            ["multiccd='enable'", "sensor='disable'"],
        ],
    ),
    (
        "statistic",
        "",
        &[
            ["meaninertia='3'", "meanmass='4'"],
            ["meansize='5'", "extent='6'"],
            ["center='1 2 3'", "extent='7'"],
        ],
    ),
];

/// Compiles a model that begins with these sections.
fn compiled(sections: &str) -> Value {
    let text = format!(
        "<mujoco>{sections}<worldbody><geom size='1'/><body><inertial pos='0 0 0' mass='2' diaginertia='5 5 5'/>\
         <joint name='j' limited='true' range='.1 .2'/><geom size='1' group='1' euler='10 20 30'/>\
         <body><geom size='1'/></body></body></worldbody><actuator><motor joint='j'/></actuator></mujoco>"
    );
    let model = Model::from_xml(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
    serde_json::to_value(&*model).unwrap()
}

#[test]
fn the_second_of_two_sections_adds_to_the_first() {
    for (name, around, pairs) in ROWS {
        let section = |own: &str| match *around {
            "" => format!("<{name} {own}/>"),
            around => format!("<{around}><{name} {own}/></{around}>"),
        };
        let plain = compiled("");
        for [one, other] in *pairs {
            let both = compiled(&section(&format!("{one} {other}")));
            assert_ne!(both, plain, "{one} {other}");
            for [first, second] in [[one, other], [other, one]] {
                let apart = [section(first), section(""), section(second)].concat();
                assert_eq!(compiled(&apart), both, "{apart}");
            }
        }
    }
}

/// Of what both say, the second counts.
#[test]
fn the_second_of_two_sections_goes_before_the_first() {
    let option = "<option timestep='1' gravity='1 2 3' integrator='RK4' iterations='3'>\
        <flag contact='disable' energy='enable'/></option>";
    let plain = "<option timestep='2' gravity='3 2 1' integrator='Euler' iterations='4'>\
        <flag contact='enable' energy='disable'/></option>";
    let compiler = "<compiler angle='radian' eulerseq='zyx' boundmass='4' settotalmass='9' inertiafromgeom='true'/>";
    let other = "<compiler angle='degree' eulerseq='XYZ' boundmass='3' settotalmass='8' inertiafromgeom='false'/>";
    let statistic = "<statistic extent='5' meanmass='6'/>";
    let less = "<statistic extent='4' meanmass='5'/>";
    for [one, second] in [[option, plain], [compiler, other], [statistic, less]] {
        for [first, second] in [[one, second], [second, one]] {
            let found = compiled(&[first, second].concat());
            assert_eq!(found, compiled(second), "{first}{second}");
        }
    }
}

/// Of several layers with the colour of a material, the last counts; layers of other roles have no effect.
#[test]
fn the_last_layer_is_the_texture() {
    let texture = |layers: &str| {
        let text = format!(
            "<mujoco><asset><texture name='a' builtin='flat' type='2d' width='2' height='2'/>\
             <texture name='b' builtin='flat' type='2d' width='2' height='2'/>\
             <material name='m'>{layers}</material></asset>\
             <worldbody><geom size='1' material='m'/></worldbody></mujoco>"
        );
        let model = Model::from_xml(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
        serde_json::to_value(&*model).unwrap()
    };
    let layer = |role: &str, texture: &str| format!("<layer role='{role}' texture='{texture}'/>");
    let [a, b] = ["a", "b"].map(|name| texture(&layer("rgb", name)));
    assert_ne!(a, b);
    assert_ne!(a, texture(""));
    for role in ["rgb", "rgba"] {
        assert_eq!(texture(&layer(role, "b")), b, "{role}");
        let two = layer(role, "a") + &layer(role, "b");
        assert_eq!(texture(&two), b, "{role}");
    }
    for role in ["normal", "emissive", "orm"] {
        let two = layer("rgb", "a") + &layer(role, "b");
        assert_eq!(texture(&two), a, "{role}");
    }
}
