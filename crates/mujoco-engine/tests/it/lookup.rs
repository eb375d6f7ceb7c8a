//! Names and numbers of objects: each kind has its own.

use mujoco_engine::Model;
use mujoco_engine::model::ObjectType;

/// `n` elements, of which the first is called `name` and the last `x`.
fn row(element: &str, name: &str, n: usize) -> String {
    let (start, end) = match element.split_once(' ') {
        Some((start, rest)) => (start, format!(" {rest}")),
        None => (element, "/>".to_owned()),
    };
    let one = |name: String| format!("<{start}{name}{end}");
    let named = |name: &str| one(format!(" name='{name}'"));
    named(name) + &one(String::new()).repeat(n - 2) + &named("x")
}

/// A model whose kinds have different numbers of objects; the last of each kind is called `x`.
fn model() -> Model {
    let text = format!(
        "<mujoco><worldbody>{cameras}<body name='body' pos='0 0 5' mocap='true'/>\
         <body name='x'>{joints}{geoms}{sites}</body></worldbody>\
         <tendon>{tendons}</tendon><equality><joint joint1='x' name='e'/><joint joint1='x'/></equality>\
         <actuator>{actuators}</actuator><sensor>{sensors}</sensor><keyframe>{keys}</keyframe></mujoco>",
        joints = row("joint armature='1'/>", "joint", 4),
        geoms = row("geom size='1'/>", "geom", 5),
        sites = row("site", "site", 6),
        cameras = row("camera", "camera", 7),
        tendons = row("fixed ><joint joint='x' coef='1'/></fixed>", "tendon", 8),
        actuators = row(
            "general joint='x' dyntype='integrator' actlimited='false'/>",
            "actuator",
            9
        ),
        sensors = row("framepos objtype='body' objname='x'/>", "sensor", 10),
        keys = row("key", "key", 11),
    );
    Model::from_xml(&text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

#[test]
fn each_kind_has_its_own_names() {
    let m = model();
    type Find = fn(&Model, &str) -> Option<usize>;
    let kinds: [(&str, usize, Option<ObjectType>, Find); 9] = [
        ("body", 2, Some(ObjectType::Body), |m, name| m.body_id(name)),
        ("joint", 3, Some(ObjectType::Joint), |m, name| {
            m.joint_id(name)
        }),
        ("geom", 4, Some(ObjectType::Geom), |m, name| m.geom_id(name)),
        ("site", 5, Some(ObjectType::Site), |m, name| m.site_id(name)),
        ("camera", 6, Some(ObjectType::Camera), |m, name| {
            m.camera_id(name)
        }),
        ("tendon", 7, Some(ObjectType::Tendon), |m, name| {
            m.tendon_id(name)
        }),
        ("actuator", 8, Some(ObjectType::Actuator), |m, name| {
            m.actuator_id(name)
        }),
        ("sensor", 9, None, |m, name| m.sensor_id(name)),
        ("key", 10, None, |m, name| m.key_id(name)),
    ];
    for (name, last, kind, find) in kinds {
        let first = usize::from(name == "body");
        assert_eq!(find(&m, "x"), Some(last), "{name}");
        for (other, ..) in kinds {
            let known = (other == name).then_some(first);
            assert_eq!(find(&m, other), known, "{other} as a {name}");
            if let Some(kind) = kind {
                assert_eq!(m.id(kind, other), known, "{other} as a {name}");
            }
        }
        assert_eq!((find(&m, ""), find(&m, "X")), (None, None), "{name}");
        if let Some(kind) = kind {
            assert_eq!(m.id(kind, "x"), Some(last), "{name}");
            for id in 0..last + 2 {
                let known = match id {
                    0 if name == "body" => Some("world"),
                    id if id == first => Some(name),
                    id if id == last => Some("x"),
                    _ => None,
                };
                assert_eq!(m.name(kind, id), known, "{name} {id}");
            }
        }
    }
    assert_eq!(m.id(ObjectType::XBody, "x"), Some(2));
    assert_eq!(m.name(ObjectType::XBody, 1), Some("body"));
    assert_eq!(
        (
            m.id(ObjectType::Unknown, "x"),
            m.name(ObjectType::Unknown, 0)
        ),
        (None, None)
    );
}

#[test]
fn each_kind_has_its_own_number() {
    let m = model();
    let numbers = [
        m.nbody(),
        m.njnt(),
        m.ngeom(),
        m.nsite(),
        m.ntendon(),
        m.nu(),
        m.nsensor(),
    ];
    assert_eq!(numbers, [3, 4, 5, 6, 8, 9, 10]);
    assert_eq!(
        (m.nq(), m.nv(), m.na(), m.neq(), m.nmocap()),
        (4, 4, 9, 2, 1)
    );
    assert_eq!(
        (m.nsensordata(), m.ntree(), m.nmesh(), m.nhfield()),
        (30, 1, 0, 0)
    );
    let two = Model::from_xml(
        "<mujoco><asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/>\
         <mesh name='n' vertex='0 0 0 1 0 0 0 1 0 0 0 2'/>\
         <hfield name='h' nrow='2' ncol='2' size='1 1 1 1'/></asset><worldbody><geom type='hfield' hfield='h'/>\
         <body><freejoint/><geom type='mesh' mesh='m'/></body>\
         <body><joint type='ball'/><geom type='mesh' mesh='n'/></body></worldbody></mujoco>",
    )
    .unwrap();
    assert_eq!((two.nq(), two.nv(), two.njnt(), two.ntree()), (11, 9, 2, 2));
    assert_eq!(
        (two.nmesh(), two.nhfield(), two.nsensordata(), two.na()),
        (2, 1, 0, 0)
    );
    let none = Model::from_xml("<mujoco/>").unwrap();
    let numbers = [
        none.nq(),
        none.nv(),
        none.nu(),
        none.na(),
        none.njnt(),
        none.ngeom(),
        none.nsite(),
    ];
    assert_eq!(numbers, [0; 7]);
    let numbers = [
        none.ntendon(),
        none.ntree(),
        none.nmocap(),
        none.neq(),
        none.nsensor(),
        none.nsensordata(),
    ];
    assert_eq!((none.nbody(), numbers), (1, [0; 6]));
}
