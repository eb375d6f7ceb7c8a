//! What is wrong with a model is told in words that name it.

use mujoco_engine::Model;

/// What a section of a model may name.
pub(super) const WORLD: &str = r#"<geom name="g" type="sphere" size=".1"/><geom name="x" type="box" size=".1 .1 .1"/><site name="s"/><site name="t" pos="1 0 0"/><body name="b"><joint name="j"/><geom name="h" size=".1"/></body><body name="f"><freejoint name="free"/><geom size=".1"/></body><body name="l"><joint name="ball" type="ball"/><geom size=".1"/></body>"#;

/// Parts of the world, and their errors.
const PARTS: &[(&str, &str)] = &[
    (
        r#"<body><body><freejoint/><geom size=".1"/></body></body>"#,
        r#"<freejoint> attribute "type": a free joint belongs to a body directly in the world"#,
    ),
    (
        r#"<body><freejoint/><joint/><geom size=".1"/></body>"#,
        r#"<freejoint> attribute "type": a free joint must be the only joint of its body"#,
    ),
    (
        r#"<body mocap="true"><joint/><geom size=".1"/></body>"#,
        r#"<body> attribute "mocap": a mocap body belongs to the world and has no joints"#,
    ),
    (
        r#"<body><joint/><geom type="plane" size="1 1 1"/></body>"#,
        r#"<geom> attribute "type": a plane belongs to the world, a mocap body, or a body fixed to one"#,
    ),
    (
        r#"<geom type="plane" size="1 1 0"/>"#,
        r#"<geom> attribute "size": a plane has two half sizes, which may be 0, and a positive spacing"#,
    ),
    (
        "<body><joint/></body>",
        "<body>: it has joints and therefore needs mass and inertia: give it a geom, or an <inertial>",
    ),
    (
        r#"<body><inertial pos="0 0 0"/></body>"#,
        r#"<inertial> attribute "mass": missing: it must be given"#,
    ),
    (
        r#"<body><inertial mass="1" diaginertia="1 1 1"/></body>"#,
        r#"<inertial> attribute "pos": missing: it must be given"#,
    ),
    (
        r#"<body><inertial pos="0 0 0" mass="1" diaginertia="1 1 3"/></body>"#,
        "<inertial>: the moments of inertia 1, 1, 3 are impossible: two must sum to at least the third",
    ),
    (
        r#"<body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1" fullinertia="1 1 1 0 0 0"/></body>"#,
        r#"<inertial> attribute "fullinertia": only one of diaginertia, fullinertia"#,
    ),
    (
        r#"<body><inertial pos="0 0 0" mass="1" fullinertia="1 1 1 0 0 0" euler="1 2 3"/></body>"#,
        r#"<inertial> attribute "fullinertia": does not go with an orientation, which it implies"#,
    ),
    (
        r#"<geom type="sphere"/>"#,
        r#"<geom> attribute "size": this shape has a radius, which must be positive"#,
    ),
    (
        r#"<geom size=".1" condim="2"/>"#,
        r#"<geom> attribute "condim": is 2: use 1, 3, 4 or 6"#,
    ),
    (
        r#"<geom size=".1" quat="0 0 0 0"/>"#,
        r#"<geom> attribute "quat": the quaternion is zero"#,
    ),
    (
        r#"<geom size=".1" zaxis="0 0 0"/>"#,
        r#"<geom> attribute "zaxis": the axis is zero"#,
    ),
    (
        r#"<geom size=".1" xyaxes="1 0 0 2 0 0"/>"#,
        r#"<geom> attribute "xyaxes": the axes are zero or parallel"#,
    ),
    (
        r#"<geom type="capsule" size=".1" fromto="1 1 1 1 1 1"/>"#,
        r#"<geom> attribute "fromto": the ends are too close"#,
    ),
    (
        r#"<geom type="sphere" size=".1" fromto="0 0 0 1 1 1"/>"#,
        r#"<geom> attribute "fromto": only capsules, cylinders, ellipsoids and boxes have ends: give type="capsule""#,
    ),
    (
        r#"<geom size=".1" class="none"/>"#,
        r#"<geom> attribute "class": there is no class "none": the classes are main"#,
    ),
    (
        r#"<geom size=".1" material="none"/>"#,
        r#"<geom> attribute "material": there is no material "none""#,
    ),
    (
        r#"<geom size=".1" group="x"/>"#,
        r#"<geom> attribute "group": "x" is not a whole number in range"#,
    ),
    (
        r#"<geom size=".1" type="cone"/>"#,
        r#"<geom> attribute "type": "cone" is not supported: use plane, hfield, sphere, capsule, ellipsoid, cylinder, box, mesh"#,
    ),
    (
        r#"<geom size=".1 .2 .3 .4"/>"#,
        r#"<geom> attribute "size": too many numbers: at most 3 are expected"#,
    ),
    (
        r#"<geom size=".1" density="-1"/>"#,
        r#"<geom> attribute "density": must not be negative"#,
    ),
    (
        r#"<body><joint range="2 1"/><geom size=".1"/></body>"#,
        r#"<joint> attribute "range": the lower limit must be less than the upper one"#,
    ),
    (
        r#"<body><joint type="ball" range="1 2"/><geom size=".1"/></body>"#,
        r#"<joint> attribute "range": of a ball joint begins with 0"#,
    ),
    (
        r#"<camera fovy="200"/>"#,
        r#"<camera> attribute "fovy": must lie between 0 and 180 degrees"#,
    ),
    (
        r#"<light dir="0 0 0"/>"#,
        r#"<light> attribute "dir": the direction is zero"#,
    ),
    (
        r#"<body><joint type="ball"/><joint type="hinge"/><geom size=".1"/></body>"#,
        r#"<joint> attribute "type": nothing that turns follows a ball joint"#,
    ),
    (
        r#"<body><joint type="ball"/><joint type="ball"/><geom size=".1"/></body>"#,
        r#"<joint> attribute "type": nothing that turns follows a ball joint"#,
    ),
    (
        r#"<body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>"#,
        r#"<inertial>: the body has one already"#,
    ),
    (
        r#"<geom type="capsule" size=".1" fromto="0 0 0 1 1 1" pos="0 0 1"/>"#,
        r#"<geom> attribute "fromto": does not go with pos, which it implies"#,
    ),
    (
        r#"<camera fovy="50" sensorsize=".1 .1" focal=".1 .1" resolution="9 9"/>"#,
        r#"<camera> attribute "sensorsize": does not go with fovy"#,
    ),
    (
        r#"<light type="spot" directional="true"/>"#,
        r#"<light> attribute "type": does not go with directional"#,
    ),
    (
        r#"<geom size=".1"><site/></geom>"#,
        r#"<site>: not supported within <geom>"#,
    ),
    (
        r#"<geom size=".1"/><x:geom xmlns:x="other" size=".1"/>"#,
        r#"<geom>: an element of another namespace is not part of MJCF"#,
    ),
];

/// Sections beside [`WORLD`], and their errors.
const SECTIONS: &[(&str, &str)] = &[
    (
        r#"<tendon><spatial armature="1"><site site="s"/><geom geom="g"/><site site="t"/></spatial></tendon>"#,
        r#"<spatial> attribute "armature": does not go with a path around geoms"#,
    ),
    (
        r#"<tendon><spatial><site site="s"/><geom geom="g"/></spatial></tendon>"#,
        "<spatial>: part 1 of the path: a pulley has sites behind it, a site a neighbour, and a geom is between sites",
    ),
    (
        r#"<tendon><spatial><site site="s"/><geom geom="x"/><site site="t"/></spatial></tendon>"#,
        r#"<geom> attribute "geom": a tendon runs around spheres and cylinders only"#,
    ),
    (
        r#"<tendon><fixed><joint joint="free" coef="1"/></fixed></tendon>"#,
        r#"<joint> attribute "joint": "free" is free or a ball: only a slide or hinge is supported here"#,
    ),
    (
        r#"<equality><connect anchor="0 0 0"/></equality>"#,
        "<connect>: needs body1, or site1 and site2",
    ),
    (
        r#"<equality><joint joint1="ball"/></equality>"#,
        r#"<joint> attribute "joint1": "ball" is free or a ball: only a slide or hinge is supported here"#,
    ),
    (
        r#"<actuator><general joint="j" actrange="0 1"/></actuator>"#,
        r#"<general> attribute "actrange": there is no activation"#,
    ),
    (
        "<actuator><motor/></actuator>",
        r#"<motor> attribute "joint": missing: it must be given (or tendon, or site)"#,
    ),
    (
        r#"<actuator><motor joint="j" refsite="s"/></actuator>"#,
        r#"<motor> attribute "refsite": goes with site only"#,
    ),
    (
        r#"<actuator><motor joint="j" cranklength="1"/></actuator>"#,
        r#"<motor> attribute "slidersite": goes with cranksite only"#,
    ),
    (
        r#"<actuator><position joint="j" kv="1" dampratio="1"/></actuator>"#,
        r#"<position> attribute "dampratio": does not go with kv"#,
    ),
    (
        r#"<actuator><position joint="free" inheritrange="1"/></actuator>"#,
        r#"<position> attribute "inheritrange": needs a slide, hinge or tendon with a range"#,
    ),
    (
        r#"<sensor><ballquat joint="j"/></sensor>"#,
        r#"<ballquat> attribute "joint": must be a ball joint"#,
    ),
    (
        r#"<sensor><framequat objtype="body" objname="b" cutoff="1"/></sensor>"#,
        r#"<framequat> attribute "cutoff": axes and quaternions have no cutoff"#,
    ),
    (
        r#"<asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1" maxhullvert="3"/></asset>"#,
        r#"<mesh> attribute "maxhullvert": is 3: use at least 4, or -1 for no limit"#,
    ),
    (
        r#"<asset><texture name="t" builtin="flat" width="4" height="4" nchannel="2"/></asset>"#,
        r#"<texture> attribute "nchannel": must be 1, 3 or 4"#,
    ),
    (
        r#"<asset><texture name="t"/></asset>"#,
        r#"<texture> attribute "file": missing: give a file, the files of faces, or a builtin pattern"#,
    ),
    (
        r#"<actuator><motor cranksite="s" cranklength="1"/></actuator>"#,
        r#"<motor> attribute "slidersite": missing: a slider-crank needs it"#,
    ),
    (
        r#"<actuator><motor cranksite="s" slidersite="t"/></actuator>"#,
        r#"<motor> attribute "cranklength": must be positive"#,
    ),
    (
        r#"<actuator><motor cranksite="s" slidersite="t" cranklength="-1"/></actuator>"#,
        r#"<motor> attribute "cranklength": must be positive"#,
    ),
    (
        r#"<actuator><muscle joint="j" lmin="1"/></actuator>"#,
        r#"<muscle> attribute "lmin": must be less than 1, and lmax greater"#,
    ),
    (
        r#"<actuator><muscle joint="j" lmax="1"/></actuator>"#,
        r#"<muscle> attribute "lmin": must be less than 1, and lmax greater"#,
    ),
    (
        r#"<actuator><muscle joint="j" range="1 1"/></actuator>"#,
        r#"<muscle> attribute "range": must rise"#,
    ),
    (
        r#"<actuator><muscle joint="j" scale="0"/></actuator>"#,
        r#"scale, vmax, fpmax and fvmax must be positive"#,
    ),
    (
        r#"<actuator><muscle joint="j" vmax="0"/></actuator>"#,
        r#"scale, vmax, fpmax and fvmax must be positive"#,
    ),
    (
        r#"<actuator><muscle joint="j" fpmax="0"/></actuator>"#,
        r#"scale, vmax, fpmax and fvmax must be positive"#,
    ),
    (
        r#"<actuator><muscle joint="j" fvmax="0"/></actuator>"#,
        r#"scale, vmax, fpmax and fvmax must be positive"#,
    ),
    (
        r#"<equality><weld body1="b" body2="b"/></equality>"#,
        r#"<weld>: relates an object to itself"#,
    ),
    (
        r#"<equality><joint joint1="j" joint2="j"/></equality>"#,
        r#"<joint>: relates an object to itself"#,
    ),
    (
        r#"<equality><connect site1="s" site2="s"/></equality>"#,
        r#"<connect>: relates an object to itself"#,
    ),
    (
        r#"<tendon><fixed/></tendon>"#,
        r#"<fixed>: needs elements within: joint"#,
    ),
    (
        r#"<tendon><spatial/></tendon>"#,
        r#"<spatial>: needs elements within: site"#,
    ),
    (
        r#"<option actuatorgroupdisable="31"/>"#,
        r#"<option> attribute "actuatorgroupdisable": groups are 0 to 30"#,
    ),
    (
        r#"<option actuatorgroupdisable="3 -1"/>"#,
        r#"<option> attribute "actuatorgroupdisable": groups are 0 to 30"#,
    ),
    (
        r#"<asset><texture name="t" builtin="flat" width="4" height="4"/><texture name="t" builtin="flat" width="4" height="4"/></asset>"#,
        r#"<texture> attribute "name": there is a texture "t" already"#,
    ),
    (
        r#"<asset><texture name="t" type="cube" builtin="flat" width="4" height="4" gridsize="4 4"/></asset>"#,
        r#"<texture> attribute "gridsize": needs 1 to 12 faces"#,
    ),
    (
        r#"<asset><texture name="t" type="cube" builtin="flat" width="4" height="4" gridsize="0 3"/></asset>"#,
        r#"<texture> attribute "gridsize": needs 1 to 12 faces"#,
    ),
];

/// Whole texts, and their errors.
const TEXTS: &[(&str, &str)] = &[
    (
        r#"<mujoco><compiler eulerseq="xy"/></mujoco>"#,
        r#"<compiler> attribute "eulerseq": needs three of xyzXYZ"#,
    ),
    (
        r#"<mujoco><compiler autolimits="false"/><worldbody><body><joint range="0 1"/><geom size=".1"/></body></worldbody></mujoco>"#,
        r#"<joint> attribute "range": needs limited="true" here, where autolimits is false"#,
    ),
    (
        r#"<mujoco><default class="other"/></mujoco>"#,
        r#"<default> attribute "class": the outermost class is "main", not "other""#,
    ),
    (
        "<robot/>",
        "<robot>: not supported: the outermost element is <mujoco>",
    ),
];

#[test]
fn each_refusal_says_what_is_wrong() {
    let world = |part: &str| format!("<mujoco><worldbody>{part}</worldbody></mujoco>");
    let section = |part: &str| format!("<mujoco><worldbody>{WORLD}</worldbody>{part}</mujoco>");
    // what the sections name is right
    Model::from_xml(&section("")).unwrap();
    let parts = PARTS.iter().map(|(part, error)| (world(part), *error));
    let sections = SECTIONS.iter().map(|(part, error)| (section(part), *error));
    let texts = TEXTS
        .iter()
        .map(|(text, error)| ((*text).to_owned(), *error));
    let mut wrong = Vec::new();
    for (text, expected) in parts.chain(sections).chain(texts) {
        let told = Model::from_xml(&text).err().map(|error| error.to_string());
        if !told.as_deref().is_some_and(|told| told.contains(expected)) {
            wrong.push(format!("{text}\n{expected}\n{told:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// A line with a right element of each kind that a world may have twice.
const GOOD_PARTS: &str = r#"<body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><joint axis="1 0 0"/><geom type="capsule" size=".1" fromto="0 0 0 0 0 1"/></body><body><freejoint/><geom type="box" size=".1 .1 .1" quat="1 0 0 0"/></body><body mocap="true"/><geom type="plane" size="1 1 1"/><site size=".1"/><camera pos="0 0 1"/><light pos="0 0 1"/><frame pos="0 0 1"/>"#;

/// A line with a right element of each kind that a section may have twice.
const GOOD_SECTIONS: &str = r#"<asset><mesh name="good" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><hfield name="good" nrow="2" ncol="2" size="1 1 1 1"/><texture name="good" builtin="flat" width="4" height="4"/><material name="good" texture="good"/></asset><contact><pair name="good" geom1="g" geom2="h"/><exclude body1="b" body2="f"/></contact><tendon><spatial name="good" range="0 1"><site site="s"/><geom geom="g"/><site site="t"/></spatial><fixed name="fine"><joint joint="j" coef="1"/></fixed></tendon><equality><connect name="good" body1="b" anchor="0 0 0"/><weld body1="f"/><joint joint1="j"/><tendon tendon1="good"/></equality><actuator><general name="good" joint="j"/><motor joint="j"/><position joint="j" kp="1"/><muscle tendon="good" lengthrange="0 1"/></actuator><sensor><jointpos name="good" joint="j"/><ballquat joint="ball"/><framequat objtype="body" objname="b"/><touch site="s"/></sensor><keyframe><key name="good" time="1"/></keyframe><option timestep=".001"/><compiler angle="radian"/><default><default class="good"/></default>"#;

/// Elements of a section after others of their kind, each with what the others have not: a fault.
const SECOND: &[(&str, &str)] = &[
    (
        r#"<asset><mesh name="good" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>"#,
        "mesh",
    ),
    (
        r#"<asset><mesh name="n" vertex="0 0 0 1 0 0 0 1 0"/></asset>"#,
        "mesh",
    ),
    (r#"<asset><mesh name="n" file="none.stl"/></asset>"#, "mesh"),
    (
        r#"<asset><hfield name="good" nrow="2" ncol="2" size="1 1 1 1"/></asset>"#,
        "hfield",
    ),
    (
        r#"<asset><hfield name="n" file="none.png" size="1 1 1 1"/></asset>"#,
        "hfield",
    ),
    (
        r#"<asset><texture name="n" type="2d" file="none.png"/></asset>"#,
        "texture",
    ),
    (
        r#"<asset><material name="n" texture="none"/></asset>"#,
        "material",
    ),
    (
        r#"<contact><pair geom1="g" geom2="none"/></contact>"#,
        "pair",
    ),
    (r#"<contact><pair geom1="g"/></contact>"#, "pair"),
    (
        r#"<contact><exclude body1="b" body2="none"/></contact>"#,
        "exclude",
    ),
    (
        r#"<tendon><spatial range="1 0"><site site="s"/><site site="t"/></spatial></tendon>"#,
        "spatial",
    ),
    (
        r#"<tendon><spatial springlength="2 1"><site site="s"/><site site="t"/></spatial></tendon>"#,
        "spatial",
    ),
    (
        r#"<tendon><spatial><site site="s"/></spatial></tendon>"#,
        "spatial",
    ),
    (
        r#"<tendon><spatial><site site="s"/><site site="none"/></spatial></tendon>"#,
        "site",
    ),
    (
        r#"<tendon><spatial><site site="s"/><geom geom="g" sidesite="none"/><site site="t"/></spatial></tendon>"#,
        "geom",
    ),
    (
        r#"<tendon><fixed><joint joint="none" coef="1"/></fixed></tendon>"#,
        "joint",
    ),
    (
        r#"<tendon><fixed name="fine"><joint joint="j" coef="1"/></fixed></tendon>"#,
        "fixed",
    ),
    (
        r#"<equality><connect body1="none" anchor="0 0 0"/></equality>"#,
        "connect",
    ),
    (r#"<equality><weld body1="none"/></equality>"#, "weld"),
    (r#"<equality><joint joint1="none"/></equality>"#, "joint"),
    (r#"<equality><joint joint1="ball"/></equality>"#, "joint"),
    (r#"<equality><tendon tendon1="none"/></equality>"#, "tendon"),
    (r#"<actuator><general joint="none"/></actuator>"#, "general"),
    (
        r#"<actuator><general name="good" joint="j"/></actuator>"#,
        "general",
    ),
    (
        r#"<actuator><motor joint="j" ctrlrange="1 0"/></actuator>"#,
        "motor",
    ),
    (
        r#"<actuator><motor joint="j" forcerange="1 0"/></actuator>"#,
        "motor",
    ),
    (r#"<actuator><motor site="none"/></actuator>"#, "motor"),
    (r#"<actuator><motor tendon="none"/></actuator>"#, "motor"),
    (
        r#"<actuator><motor cranksite="s" slidersite="none" cranklength="1"/></actuator>"#,
        "motor",
    ),
    (
        r#"<actuator><position site="s" refsite="none"/></actuator>"#,
        "position",
    ),
    (
        r#"<actuator><adhesion body="none" ctrlrange="0 1"/></actuator>"#,
        "adhesion",
    ),
    (r#"<actuator><muscle tendon="good"/></actuator>"#, "muscle"),
    (r#"<sensor><jointpos joint="none"/></sensor>"#, "jointpos"),
    (
        r#"<sensor><jointpos name="good" joint="j"/></sensor>"#,
        "jointpos",
    ),
    (r#"<sensor><jointpos joint="ball"/></sensor>"#, "jointpos"),
    (r#"<sensor><touch site="none"/></sensor>"#, "touch"),
    (
        r#"<sensor><framepos objtype="body" objname="b" reftype="site" refname="none"/></sensor>"#,
        "framepos",
    ),
    (r#"<keyframe><key mpos="1"/></keyframe>"#, "key"),
    (r#"<keyframe><key name="good"/></keyframe>"#, "key"),
    (
        r#"<keyframe><key ctrl="1 2 3 4 5 6 7 8 9"/></keyframe>"#,
        "key",
    ),
];

/// After right elements of its kind, a wrong one is named by its own line, not by theirs.
#[test]
fn the_second_of_two_elements_is_named_by_its_line() {
    let world =
        |part: &str| format!("<mujoco><worldbody>\n{GOOD_PARTS}\n{part}\n</worldbody></mujoco>");
    let section = |part: &str| {
        format!("<mujoco><worldbody>{WORLD}</worldbody>\n{GOOD_SECTIONS}\n{part}\n</mujoco>")
    };
    // the elements before are right
    for text in [world(""), section("")] {
        Model::from_xml(&text).unwrap();
    }
    let parts = PARTS.iter().map(|(part, _)| (world(part), ""));
    let sections = SECTIONS.iter().map(|(part, _)| (section(part), ""));
    let second = SECOND.iter().map(|(part, name)| (section(part), *name));
    let mut wrong = Vec::new();
    for (text, name) in parts.chain(sections).chain(second) {
        let told = Model::from_xml(&text).err().map(|error| error.to_string());
        let start = format!("line 3: <{name}");
        if !told.as_deref().is_some_and(|told| told.starts_with(&start)) {
            wrong.push(format!(
                "{}\n{start}\n{told:?}",
                text.lines().nth(2).unwrap()
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}
