//! Default classes.

use mujoco_engine::Model;
use serde_json::Value;

/// A kind of element, attributes that each element of it has, and attributes of a class.
type Row = (&'static str, &'static str, &'static [&'static str]);

const ROWS: &[Row] = &[
    (
        "joint",
        "",
        &[
            "type='slide'",
            "pos='1 2 3'",
            "axis='1 0 0'",
            "range='-1 2'",
            "limited='true' range='0 1'",
            "ref='1'",
            "springref='2'",
            "stiffness='3'",
            "damping='4'",
            "armature='5'",
            "margin='0.5'",
            "springdamper='1 2'",
            "frictionloss='6'",
            "actuatorfrcrange='-1 1'",
            "actuatorgravcomp='true'",
            "solreflimit='0.5 2'",
            "solimplimit='0.5 0.6'",
            "solreffriction='0.5 2'",
            "solimpfriction='0.5 0.6'",
        ],
    ),
    (
        "geom",
        "size='0.1 0.2 0.3'",
        &[
            "type='box'",
            "pos='1 2 3'",
            "quat='1 1 0 0'",
            "euler='10 20 30'",
            "axisangle='1 0 0 30'",
            "zaxis='1 1 0'",
            "xyaxes='0 1 0 1 0 0'",
            "density='2'",
            "mass='3'",
            "friction='0.5 0.6 0.7'",
            "condim='4'",
            "contype='2'",
            "conaffinity='2'",
            "margin='0.5'",
            "gap='0.25'",
            "priority='2'",
            "solmix='2'",
            "solref='0.5 2'",
            "solimp='0.5 0.6'",
            "rgba='1 0 0 1'",
            "material='a'",
            "group='2'",
            "fluidshape='ellipsoid' fluidcoef='1 2 3 4 5'",
            "type='capsule' fromto='0 0 0 1 1 1'",
            "type='box' shellinertia='true'",
        ],
    ),
    ("geom", "", &["size='0.3'", "type='mesh' mesh='m'"]),
    (
        "site",
        "",
        &[
            "type='box'",
            "size='0.1 0.2 0.3'",
            "pos='1 2 3'",
            "quat='1 1 0 0'",
            "type='capsule' fromto='0 0 0 1 1 1'",
            "rgba='1 0 0 1'",
            "group='2'",
        ],
    ),
    (
        "camera",
        "",
        &[
            "mode='track'",
            "mode='targetbody' target='b'",
            "pos='1 2 3'",
            "quat='1 1 0 0'",
            "fovy='30'",
            "projection='orthographic'",
            "resolution='20 10'",
        ],
    ),
    (
        "light",
        "",
        &["type='directional'", "pos='1 2 3'", "dir='0 1 0'"],
    ),
    (
        "material",
        "name='a'",
        &[
            "rgba='1 0 0 1'",
            "texture='t'",
            "texrepeat='2 3'",
            "texuniform='true'",
        ],
    ),
    (
        "pair",
        "geom1='g' geom2='h'",
        &[
            "condim='4'",
            "friction='0.5 0.6 0.7 0.8 0.9'",
            "solref='0.5 2'",
            "solreffriction='0.5 2'",
            "solimp='0.5 0.6'",
            "margin='0.5'",
            "gap='0.25'",
        ],
    ),
    ("pair", "", &["geom1='g' geom2='h'"]),
    (
        "equality",
        "joint1='j'",
        &["active='false'", "solref='0.5 2'", "solimp='0.5 0.6'"],
    ),
    (
        "tendon",
        "",
        &[
            "range='-1 2'",
            "limited='true' range='0 1'",
            "actuatorfrcrange='-1 1'",
            "margin='0.5'",
            "solreflimit='0.5 2'",
            "solimplimit='0.5 0.6'",
            "solreffriction='0.5 2'",
            "solimpfriction='0.5 0.6'",
            "frictionloss='1'",
            "stiffness='2'",
            "damping='3'",
            "armature='4'",
            "springlength='0.5 0.6'",
        ],
    ),
    (
        "mesh",
        "name='m'",
        &["scale='1 2 3'", "inertia='shell'", "maxhullvert='4'"],
    ),
    (
        "general",
        "joint='j'",
        &[
            "gear='2 3'",
            "ctrlrange='-1 2'",
            "ctrllimited='true' ctrlrange='0 1'",
            "forcerange='-1 2'",
            "dyntype='filter' dynprm='0.5'",
            "dyntype='integrator' actrange='-1 2'",
            "dyntype='filter' actearly='true'",
            "gaintype='affine' gainprm='1 2 3'",
            "biastype='affine' biasprm='1 2 3'",
            "group='2'",
        ],
    ),
    ("motor", "joint='j'", &["gear='2'", "ctrlrange='-1 2'"]),
    (
        "position",
        "joint='j'",
        &["kp='2'", "kv='3'", "timeconst='0.5'"],
    ),
    ("velocity", "joint='j'", &["kv='3'"]),
    (
        "intvelocity",
        "joint='j' actrange='0 1'",
        &["kp='2'", "kv='3'"],
    ),
    ("damper", "joint='j' ctrlrange='0 1'", &["kv='3'"]),
    (
        "cylinder",
        "joint='j'",
        &["timeconst='2'", "area='3'", "bias='1 2 3'"],
    ),
    (
        "muscle",
        "joint='j' lengthrange='0 1'",
        &["timeconst='0.5 0.6'", "scale='3'", "force='4'"],
    ),
    ("adhesion", "body='b' ctrlrange='0 1'", &["gain='3'"]),
];

/// Compiles a model with these default classes and `element`, which is of one kind.
fn compiled(kind: &str, defaults: &str, element: &str) -> Result<Value, String> {
    let at = |kinds: &[&str], or: &str| {
        let own = kinds.contains(&kind);
        if own { element } else { or }.to_owned()
    };
    let tendon = match kind {
        "tendon" => element
            .replace("<tendon", "<fixed")
            .replace("/>", "><joint joint='j' coef='2'/></fixed>"),
        _ => String::new(),
    };
    let actuators = [
        "general",
        "motor",
        "position",
        "velocity",
        "intvelocity",
        "damper",
        "cylinder",
        "muscle",
        "adhesion",
    ];
    let other = if kind == "pair" {
        "<geom name='h' size='1'/>"
    } else {
        ""
    };
    let text = format!(
        "<mujoco>{defaults}<asset>{mesh}<texture name='t' type='2d' builtin='flat' width='2' height='2'/>{material}</asset>\
         <worldbody>{camera}{light}{other}<body name='b'>{joint}{geom}{site}</body></worldbody><contact>{pair}</contact>\
         <equality>{equality}</equality><tendon>{tendon}</tendon><actuator>{actuator}</actuator></mujoco>",
        mesh = at(&["mesh"], "<mesh name='m'/>")
            .replace("/>", " vertex='0 0 0 1 0 0 0 1 0 0 0 1 1 1 1'/>"),
        material = at(&["material"], "<material name='a'/>"),
        camera = at(&["camera"], ""),
        light = at(&["light"], ""),
        joint = at(&["joint"], "<joint/>").replace("<joint", "<joint name='j'"),
        geom = at(&["geom"], "<geom size='1'/>").replace("<geom", "<geom name='g'"),
        site = at(&["site"], ""),
        pair = at(&["pair"], ""),
        equality = at(&["equality"], "").replace("<equality", "<joint"),
        actuator = at(&actuators, ""),
    );
    let model = Model::from_xml(&text).map_err(|error| format!("{text}: {error}"))?;
    Ok(serde_json::to_value(model).unwrap())
}

/// What a class says of its elements, an element could say itself; so could the class of the whole
/// model, and a class around the element's.
#[test]
fn classes_say_what_elements_could_say() {
    let mut unlike = Vec::new();
    for (kind, base, all) in ROWS {
        let plain = compiled(kind, "", &format!("<{kind} {base}/>"));
        for own in *all {
            let said = compiled(kind, "", &format!("<{kind} {base} {own}/>"));
            if said.is_err() || said == plain {
                unlike.push(format!("{kind}: {own} says nothing: {said:?}"));
            }
            let class = format!("<{kind} {own}/>");
            for (defaults, named) in [
                (class.clone(), ""),
                (format!("<default class='c'>{class}</default>"), "class='c'"),
                (
                    format!("<default class='c'>{class}<default class='d'/></default>"),
                    "class='d'",
                ),
            ] {
                let defaults = format!("<default>{defaults}</default>");
                let by_class = compiled(kind, &defaults, &format!("<{kind} {base} {named}/>"));
                if by_class != said {
                    unlike.push(format!("{kind}: {own} in {defaults}: {by_class:?}"));
                }
            }
        }
    }
    assert!(unlike.is_empty(), "{}: {unlike:#?}", unlike.len());
}

/// The same attributes with other values: words for other words, and numbers a half larger, the second a quarter more.
fn otherwise(attributes: &str) -> String {
    const WORDS: &[(&str, &str)] = &[
        ("true", "false"),
        ("slide", "ball"),
        ("box", "ellipsoid"),
        ("ellipsoid", "none"),
        ("capsule", "cylinder"),
        ("track", "trackcom"),
        ("targetbody", "targetbodycom"),
        ("directional", "spot"),
        ("orthographic", "perspective"),
        ("shell", "exact"),
        ("filter", "filterexact"),
        ("integrator", "none"),
        ("affine", "none"),
        // (no limit, and whole numbers)
        ("maxhullvert='4'", "maxhullvert='-1'"),
        ("20 10", "30 20"),
    ];
    if let Some((_, other)) = WORDS.iter().find(|(word, _)| *word == attributes) {
        return (*other).to_owned();
    }
    let value = |value: &str| {
        if let Some((_, other)) = WORDS.iter().find(|(word, _)| *word == value) {
            return (*other).to_owned();
        }
        let words = value.split(' ').enumerate();
        let words = words.map(|(i, word)| {
            let more = if i == 1 { 0.25 } else { 0.0 };
            word.parse::<f64>()
                .map_or(word.to_owned(), |x| (1.5 * x + more).to_string())
        });
        words.collect::<Vec<_>>().join(" ")
    };
    let parts = attributes.split('\'').enumerate();
    let parts = parts.map(|(i, part)| {
        if i % 2 == 1 {
            value(part)
        } else {
            part.to_owned()
        }
    });
    parts.collect::<Vec<_>>().join("'")
}

/// What an element says goes before what its class says, and what a class says before the class around it and that of
/// the whole model.
#[test]
fn the_nearest_word_counts() {
    let (mut unlike, mut compared) = (Vec::new(), 0);
    for (kind, base, all) in ROWS {
        for far in *all {
            let near = otherwise(far);
            let said = compiled(kind, "", &format!("<{kind} {base} {near}/>"));
            if near == *far || said.is_err() {
                continue;
            }
            compared += 1;
            let [class, inner] = [*far, &near].map(|own| format!("<{kind} {own}/>"));
            let plain = format!("<{kind} {base}/>");
            let named = plain.replace("/>", " class='d'/>");
            let loud = plain.replace("/>", &format!(" {near}/>"));
            let loudest = named.replace("/>", &format!(" {near}/>"));
            for (defaults, element) in [
                (class.clone(), loud),
                (
                    format!("<default class='d'>{class}</default>"),
                    loudest.clone(),
                ),
                (
                    format!("{class}<default class='d'>{inner}</default>"),
                    named.clone(),
                ),
                (
                    format!(
                        "<default class='c'>{class}<default class='d'>{inner}</default></default>"
                    ),
                    named,
                ),
                (
                    format!("<default class='c'>{class}<default class='d'/></default>"),
                    loudest,
                ),
            ] {
                let found = compiled(kind, &format!("<default>{defaults}</default>"), &element);
                if found != said {
                    unlike.push(format!(
                        "{kind}: {element} in {defaults}: {:?}",
                        found.err()
                    ));
                }
            }
        }
    }
    assert!(unlike.is_empty(), "{}: {unlike:#?}", unlike.len());
    assert!(compared > 90, "{compared}");
}
