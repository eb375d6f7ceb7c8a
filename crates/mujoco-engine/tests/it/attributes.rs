//! Every attribute that MuJoCo's schema has is read, or refused on purpose.

use mujoco_engine::Model;

/// The elements of MJCF that the engine reads: their path, attributes that they need, and the
/// attributes that the schema of MuJoCo 3.12 has, but for those in [`REFUSED`].
const ELEMENTS: [(&str, &str, &str); 50] = [
    (
        "compiler",
        "",
        "alignfree angle assetdir autolimits balanceinertia boundinertia boundmass conflict coordinate discardvisual eulerseq \
     fitaabb fusestatic inertiafromgeom inertiagrouprange meshdir saveinertial settotalmass strippath texturedir usethread",
    ),
    (
        "compiler/lengthrange",
        "",
        "accel interval inttotal maxforce mode timeconst timestep tolrange useexisting uselimit",
    ),
    (
        "option",
        "",
        "actuatorgroupdisable ccd_iterations ccd_tolerance cone density gravity impratio integrator iterations jacobian ls_iterations ls_tolerance magnetic \
     noslip_iterations noslip_tolerance o_friction o_margin o_solimp o_solref sdf_initpoints sdf_iterations sleep_tolerance \
     solver timestep tolerance viscosity wind",
    ),
    (
        "option/flag",
        "",
        "actuation autoreset clampctrl constraint contact damper diagexact energy equality eulerdamp filterparent frictionloss \
     fwdinv gravity invdiscrete island limit midphase multiccd nativeccd override refsafe sensor sleep spring warmstart",
    ),
    ("default", "", "class"),
    (
        "asset/mesh",
        r#"name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1""#,
        "builtin class content_type face file inertia material maxhullvert name normal params refpos refquat scale smoothnormal \
     texcoord vertex",
    ),
    (
        "asset/hfield",
        r#"name="h" nrow="2" ncol="2" size="1 1 1 1""#,
        "content_type elevation file name ncol nrow size",
    ),
    (
        "asset/texture",
        r#"name="t" builtin="flat" width="8" height="8""#,
        "builtin colorspace content_type file fileback filedown filefront fileleft fileright fileup gridlayout gridsize height \
     hflip mark markrgb name nchannel random rgb1 rgb2 type vflip width",
    ),
    (
        "asset/material",
        r#"name="m""#,
        "class emission metallic name reflectance rgba roughness shininess specular texrepeat texture texuniform",
    ),
    (
        "asset/material/layer",
        r#"role="rgb" texture="t""#,
        "role texture",
    ),
    (
        "contact/pair",
        r#"geom1="g" geom2="g2""#,
        "adhesion class condim friction gap geom1 geom2 margin name solimp solref solreffriction",
    ),
    (
        "contact/exclude",
        r#"body1="world" body2="b""#,
        "body1 body2 name",
    ),
    (
        "tendon/spatial",
        "",
        "actuatorfrclimited actuatorfrcrange armature class damping frictionloss group limited margin material name range rgba \
     solimpfriction solimplimit solreffriction solreflimit springlength stiffness user width",
    ),
    ("tendon/spatial/site", r#"site="s""#, "site"),
    ("tendon/spatial/geom", r#"geom="g""#, "geom sidesite"),
    ("tendon/spatial/pulley", r#"divisor="2""#, "divisor"),
    (
        "tendon/fixed",
        "",
        "actuatorfrclimited actuatorfrcrange armature class damping frictionloss group limited margin name range solimpfriction \
     solimplimit solreffriction solreflimit springlength stiffness user",
    ),
    ("tendon/fixed/joint", r#"joint="j" coef="1""#, "coef joint"),
    (
        "equality/connect",
        r#"body1="b" anchor="0 0 0""#,
        "active anchor body1 body2 class name site1 site2 solimp solref",
    ),
    (
        "equality/weld",
        r#"body1="b""#,
        "active anchor body1 body2 class name relpose site1 site2 solimp solref torquescale",
    ),
    (
        "equality/joint",
        r#"joint1="j""#,
        "active class joint1 joint2 name polycoef solimp solref",
    ),
    (
        "equality/tendon",
        r#"tendon1="t""#,
        "active class name polycoef solimp solref tendon1 tendon2",
    ),
    (
        "actuator/general",
        "",
        "actearly actlimited actrange biasprm biastype body class cranklength cranksite ctrllimited ctrlrange dynprm dyntype \
     forcelimited forcerange gainprm gaintype gear group input joint jointinparent lengthrange name refsite site slidersite \
     tendon user",
    ),
    (
        "actuator/motor",
        "",
        "class cranklength cranksite ctrllimited ctrlrange forcelimited forcerange gear group joint jointinparent lengthrange \
     name refsite site slidersite tendon user",
    ),
    (
        "actuator/position",
        "",
        "class cranklength cranksite ctrllimited ctrlrange dampratio forcelimited forcerange gear group inheritrange joint \
     jointinparent kp kv lengthrange name refsite site slidersite tendon timeconst user",
    ),
    (
        "actuator/velocity",
        "",
        "class cranklength cranksite ctrllimited ctrlrange forcelimited forcerange gear group joint jointinparent kv lengthrange \
     name refsite site slidersite tendon user",
    ),
    (
        "actuator/intvelocity",
        "",
        "actlimited actrange class cranklength cranksite ctrllimited ctrlrange dampratio forcelimited forcerange gear group \
     inheritrange joint jointinparent kp kv lengthrange name refsite site slidersite tendon user",
    ),
    (
        "actuator/damper",
        "",
        "class cranklength cranksite ctrlrange forcelimited forcerange gear group joint jointinparent kv lengthrange name refsite \
     site slidersite tendon user",
    ),
    (
        "actuator/cylinder",
        "",
        "area bias class cranklength cranksite ctrllimited ctrlrange diameter forcelimited forcerange gear group joint \
     jointinparent lengthrange name refsite site slidersite tendon timeconst user",
    ),
    (
        "actuator/muscle",
        "",
        "class cranklength cranksite ctrllimited ctrlrange force forcelimited forcerange fpmax fvmax gear group joint \
     jointinparent lengthrange lmax lmin name range scale slidersite tausmooth tendon timeconst user vmax",
    ),
    (
        "actuator/adhesion",
        "",
        "body class ctrlrange forcelimited forcerange gain group name user",
    ),
    (
        "keyframe/key",
        "",
        "act ctrl mpos mquat name qpos qvel time",
    ),
    (
        "body/inertial",
        r#"pos="0 0 0" mass="1""#,
        "axisangle diaginertia euler fullinertia mass pos quat xyaxes zaxis",
    ),
    (
        "body/joint",
        "",
        "actuatorfrclimited actuatorfrcrange actuatorgravcomp armature axis class damping frictionloss group limited margin name \
     pos range ref solimpfriction solimplimit solreffriction solreflimit springdamper springref stiffness type user",
    ),
    ("body/freejoint", "", "align group name"),
    (
        "body/geom",
        r#"size="1""#,
        "adhesion axisangle class conaffinity condim contype density euler fitscale fluidcoef fluidshape friction fromto gap group hfield \
     margin mass material mesh name pos priority quat rgba shellinertia size solimp solmix solref surfacevel type user xyaxes \
     zaxis",
    ),
    (
        "body/site",
        "",
        "axisangle class euler fromto group material name pos quat rgba size type user xyaxes zaxis",
    ),
    (
        "body/camera",
        "",
        "axisangle class euler focal focalpixel fovy ipd mode name output pos principal principalpixel projection quat resolution \
     sensorsize target user xyaxes zaxis",
    ),
    (
        "body/light",
        "",
        "active ambient attenuation bulbradius castshadow class cutoff diffuse dir directional exponent intensity mode name pos \
     range softness specular target texture type",
    ),
    ("sensor/touch", r#"site="s""#, "cutoff name noise user site"),
    (
        "sensor/camprojection",
        r#"site="s" camera="c""#,
        "cutoff name noise user camera site",
    ),
    (
        "sensor/rangefinder",
        r#"site="s""#,
        "cutoff name noise user camera data site",
    ),
    (
        "sensor/jointpos",
        r#"joint="j""#,
        "cutoff name noise user joint",
    ),
    (
        "sensor/framepos",
        r#"objtype="body" objname="b""#,
        "cutoff name noise user objname objtype reftype",
    ),
    (
        "sensor/framelinacc",
        r#"objtype="body" objname="b""#,
        "cutoff name noise user objname objtype",
    ),
    (
        "sensor/subtreecom",
        r#"body="b""#,
        "cutoff name noise user body",
    ),
    (
        "sensor/insidesite",
        r#"site="s" objtype="body" objname="b""#,
        "cutoff name noise user objname objtype site",
    ),
    (
        "sensor/distance",
        r#"geom1="g" geom2="g2""#,
        "cutoff name noise user body1 body2 geom1 geom2",
    ),
    (
        "sensor/contact",
        "",
        "cutoff name noise user body1 body2 data geom1 geom2 num reduce site subtree1 subtree2",
    ),
    ("sensor/clock", "", "cutoff name noise user"),
];

/// Attributes that are refused: histories of controls and sensors, and features of 3.12 alone.
const REFUSED: &str = "actdim armature damping delay ffrange interp interval nsample velrange";

/// A model with the element, which has an attribute that nothing has.
fn with(path: &str, given: &str, attribute: &str) -> String {
    let (outer, name) = path.rsplit_once('/').unwrap_or(("", path));
    let within = match name {
        "spatial" => r#"<site site="s"/><site site="s2"/>"#,
        "fixed" => r#"<joint joint="j" coef="1"/>"#,
        _ => "",
    };
    let mut text = format!("<{name} {given} {attribute}>{within}</{name}>");
    let in_body = outer == "body";
    for outer in outer
        .rsplit('/')
        .filter(|outer| !outer.is_empty() && !in_body)
    {
        let named = if outer == "material" {
            r#" name="m""#
        } else {
            ""
        };
        text = format!("<{outer}{named}>{text}</{outer}>");
    }
    let (of_body, of_model) = if in_body { (&*text, "") } else { ("", &*text) };
    format!(
        r#"<mujoco>{of_model}<worldbody><geom name="g" size="1"/><geom name="g2" size="1"/><site name="s"/><site name="s2"/>
           <camera name="c"/><body name="b"><joint name="j"/><geom size=".1"/>{of_body}</body></worldbody></mujoco>"#
    )
}

#[test]
fn every_attribute_of_the_schema_is_read() {
    for (path, given, attributes) in ELEMENTS {
        let error = Model::from_xml(&with(path, given, "nothing='1'"))
            .unwrap_err()
            .to_string();
        let known = error
            .split_once("the attributes that are, are ")
            .unwrap_or_else(|| panic!("{path}: {error}"))
            .1;
        let known: Vec<_> = known.split(", ").collect();
        for attribute in attributes.split_whitespace() {
            assert!(
                known.contains(&attribute),
                "{path}: {attribute} is not read"
            );
        }
        for attribute in REFUSED
            .split_whitespace()
            .filter(|name| !attributes.split_whitespace().any(|own| own == *name))
        {
            assert!(!known.contains(&attribute), "{path}: {attribute} is read");
        }
    }
}
