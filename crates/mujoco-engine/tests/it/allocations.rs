//! A step allocates nothing. The first call stores where it started, in buffers that stay.

use std::f64::consts::TAU;
use std::fmt::Write;

use gym_numerics::RandomState;
use mujoco_engine::{Data, Model, Revision, forward, step};

/// Points as the attribute `vertex`.
fn vertices(points: impl Iterator<Item = [f64; 3]>) -> String {
    points.fold(String::new(), |mut text, [x, y, z]| {
        write!(text, "{x} {y} {z} ").unwrap();
        text
    })
}

/// Meshes and every other shape in a heap, on a height field and a plane; range finders see all.
fn heap(option: &str, margin: &str) -> String {
    let mut random = RandomState::new(0);
    let rock = vertices((0..60).map(|_| std::array::from_fn(|_| random.uniform(-0.1, 0.1))));
    let side = |k: u32| f64::from(k) * TAU / 24.0;
    let prism = (0..48).map(|k| {
        let angle = side(k / 2);
        [
            0.1 * angle.cos(),
            0.1 * angle.sin(),
            if k % 2 == 0 { -0.07 } else { 0.07 },
        ]
    });
    let block = (0..8).map(|k| [1, 2, 4].map(|bit| if k & bit == 0 { -0.08 } else { 0.08 }));
    let field: String = (0..64).map(|k| format!("{} ", k * k % 7)).collect();
    let shapes = [
        r#"type="mesh" mesh="rock""#,
        r#"type="mesh" mesh="prism""#,
        r#"type="mesh" mesh="block""#,
        r#"type="box" size=".08 .1 .06""#,
        r#"type="cylinder" size=".08 .07""#,
        r#"type="capsule" size=".06 .08""#,
        r#"type="ellipsoid" size=".1 .07 .05""#,
        r#"type="sphere" size=".08""#,
    ];
    let mut bodies = String::new();
    for k in 0..16 {
        let [x, y, z] = [k % 2, k / 2 % 2, k / 4].map(|place| 0.15 * f64::from(place));
        let shape = shapes[(k % 8) as usize];
        write!(
            bodies,
            r#"<body pos="{} {} {}" euler="{} 20 {}"><freejoint/><geom {shape} margin="{margin}"/>
            <site name="{k}" pos="0 0 .2"/></body>"#,
            x - 0.1,
            y - 0.1,
            z + 0.3,
            17 * k,
            31 * k,
        )
        .unwrap();
    }
    let sensors: String = (0..16)
        .map(|k| format!(r#"<rangefinder site="{k}"/>"#))
        .collect();
    format!(
        r#"<mujoco><option {option}</option><asset>
        <mesh name="rock" inertia="shell" vertex="{rock}"/><mesh name="prism" inertia="shell" vertex="{}"/>
        <mesh name="block" inertia="shell" vertex="{}"/>
        <hfield name="field" nrow="8" ncol="8" size=".6 .6 .1 .1" elevation="{field}"/></asset>
        <worldbody><geom type="hfield" hfield="field"/><geom type="plane" size="0 0 1"/>{bodies}</worldbody>
        <sensor>{sensors}</sensor></mujoco>"#,
        vertices(prism),
        vertices(block),
    )
}

#[test]
fn contacts_of_meshes_and_rays_do_not_allocate() {
    let mut most = 0;
    for revision in Revision::ALL {
        for (option, margin) in [
            (">", "0"),
            ("cone=\"elliptic\" integrator=\"implicitfast\">", ".02"),
            ("solver=\"CG\"><flag multiccd=\"disable\"/>", "0"),
            ("solver=\"PGS\" noslip_iterations=\"2\">", ".01"),
        ] {
            let text = heap(option, margin);
            let m = Model::from_xml_with(&text, revision).unwrap();
            let mut d = Data::new(&m);
            forward(&m, &mut d);
            for i in 0..100 {
                let count = allocation_counter::measure(|| step(&m, &mut d)).count_total;
                assert_eq!(count, 0, "{revision} {option} step {i}");
                most = most.max(d.contact.len());
            }
        }
    }
    assert!(most > 30, "{most}");
}
