//! Faces of OBJ files with many corners, of which some cross themselves, are cut into libmujoco's
//! triangles. `recorded/polygons.py` describes the files, and recorded the digests.

use std::collections::BTreeMap;

use gym_numerics::RandomState;
use mujoco_engine::Model;

use super::digest::Digest;

/// The triangles of 400 files in each version.
const DIGESTS: [(&str, u64); 4] = [
    ("3.12.0", 0xb72f_a3a1_7bbe_ff9b),
    ("3.17.0", 0xe7be_ae4c_4a9a_0554),
    ("4.0.0", 0xe7be_ae4c_4a9a_0554),
    ("4.0.1", 0xe7be_ae4c_4a9a_0554),
];

/// A face with corners of small whole numbers, beside a tetrahedron.
fn object(seed: u32) -> String {
    let mut random = RandomState::new(seed);
    let n = 4 + random.uniform(0.0, 5.0) as usize;
    let side = 2.0 + random.uniform(0.0, 4.0).floor();
    let mut text = String::new();
    for _ in 0..n {
        let [x, y] = [(); 2].map(|()| random.uniform(0.0, side).floor());
        text += &format!("v {x} {y} {}\n", x + 2.0 * y);
    }
    text += "v 0 0 -9\nv 5 0 9\nv 0 5 9\nv -5 -5 9\nf";
    for corner in 1..=n {
        text += &format!(" {corner}");
    }
    for [a, b, c] in [[1, 2, 3], [1, 4, 2], [1, 3, 4], [2, 4, 3]] {
        text += &format!("\nf {} {} {}", n + a, n + b, n + c);
    }
    text + "\n"
}

#[test]
fn faces_are_cut_as_by_libmujoco() {
    let main = "<mujoco><asset><mesh name=\"m\" file=\"m.obj\" inertia=\"shell\"/></asset><worldbody><body>\
                <inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/><geom type=\"mesh\" mesh=\"m\"/></body></worldbody></mujoco>";
    for (version, expected) in DIGESTS {
        let mut digest = Digest::default();
        for seed in 0..400 {
            let files = BTreeMap::from([
                ("main.xml".to_owned(), main.as_bytes().to_vec()),
                ("m.obj".to_owned(), object(seed).into_bytes()),
            ]);
            let m = Model::from_files(&files, "main.xml", version.parse().unwrap()).unwrap();
            let triangles = m.meshes.mesh_face.as_flattened();
            digest.word(triangles.len() as u64);
            triangles
                .iter()
                .for_each(|corner| digest.word(*corner as u64));
        }
        assert_eq!(digest.0, expected, "{version}: 0x{:016x}", digest.0);
    }
}
