//! Models of files in memory are those of files on the disk.

use std::collections::BTreeMap;

use mujoco_engine::{CompiledModel, Model, Revision};

use crate::assets::Folder;

const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// The files of a robot in two folders: a part, an attached model, a mesh and a height field.
const FILES: [(&str, &str); 5] = [
    (
        "robot/scene.xml",
        r#"<mujoco>
  <compiler meshdir="../shapes/./"/>
  <include file="../robot/parts/arm.xml"/>
  <asset><model name="kid" file="parts/kid.xml"/><hfield name="hills" file="hills.bin" size="1 1 1 1"/></asset>
  <worldbody><geom type="hfield" hfield="hills"/><frame><attach model="kid" body="b" prefix="k_"/></frame></worldbody>
</mujoco>"#,
    ),
    (
        "robot/parts/arm.xml",
        r#"<mujoco><asset><mesh file="tip.obj"/></asset>
<worldbody><body><freejoint/><geom type="mesh" mesh="tip"/></body></worldbody></mujoco>"#,
    ),
    (
        "robot/parts/kid.xml",
        r#"<mujoco model="kid"><worldbody><body name="b"><geom size="1"/></body></worldbody></mujoco>"#,
    ),
    ("shapes/tip.obj", TETRAHEDRON),
    (
        "robot/hills.bin",
        "\u{2}\0\0\0\u{2}\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0",
    ),
];

fn in_memory(files: &[(&str, &str)]) -> BTreeMap<String, Vec<u8>> {
    let owned = |(path, text): &(&str, &str)| ((*path).to_owned(), text.as_bytes().to_vec());
    files.iter().map(owned).collect()
}

#[test]
fn a_model_of_files_in_memory_is_that_of_the_disk() {
    let folder = Folder::new("in-memory", &FILES);
    let files = in_memory(&FILES);
    for revision in [Revision::default(), Revision::V3_12] {
        let path = folder.path().join("robot/scene.xml");
        let of_disk = Model::from_path_with(path, revision).unwrap();
        let of_memory = Model::from_files(&files, "robot/scene.xml", revision).unwrap();
        assert_eq!(
            (of_disk.nmesh(), of_disk.nhfield(), of_disk.nbody()),
            (1, 1, 3)
        );
        let (a, b): (&CompiledModel, &CompiledModel) = (&of_disk, &of_memory);
        assert_eq!(a, b, "{revision}");
    }
}

/// What is wrong is told as for files on the disk: by file and line.
#[test]
fn files_that_are_missing_or_name_each_other_are_refused() {
    let include = |file: &str| format!("<mujoco>\n<include file=\"{file}\"/></mujoco>");
    let mesh = |file: &str| format!("<mujoco>\n<asset><mesh file=\"{file}\"/></asset></mujoco>");
    let (part, long) = (include("part.xml"), " ".repeat((8 << 20) + 1));
    let message = |main: &str, others: &[(&str, &str)]| {
        let mut files = in_memory(others);
        files.insert("main.xml".to_owned(), main.as_bytes().to_vec());
        Model::from_files(&files, "main.xml", Revision::default())
            .unwrap_err()
            .to_string()
    };
    for (text, others, parts) in [
        (
            &part,
            &[][..],
            ["main.xml", "line 2: <include>", "there is no file part.xml"],
        ),
        (
            &part,
            &[("part.xml", &*part)],
            ["part.xml", "line 2", "included already"],
        ),
        (
            &include("main.xml"),
            &[],
            ["main.xml", "line 2", "included already"],
        ),
        (
            &include("a/../main.xml"),
            &[],
            ["main.xml", "line 2", "included already"],
        ),
        (
            &part,
            &[("part.xml", "<mujoco>\n<x/></mujoco>")],
            ["part.xml", "line 2: <x>", ""],
        ),
        (
            &mesh("../x.obj"),
            &[("x.obj", TETRAHEDRON)],
            ["line 2: <mesh>", "no file ../x.obj", ""],
        ),
        (
            &mesh("/x.obj"),
            &[("x.obj", TETRAHEDRON)],
            ["line 2: <mesh>", "no file /x.obj", ""],
        ),
        (
            &mesh("broken.obj"),
            &[("broken.obj", "f 0 1 2\n")],
            ["line 2: <mesh>", "broken.obj", "line 1 of the OBJ"],
        ),
        (
            &mesh("sub"),
            &[("sub/x.obj", TETRAHEDRON)],
            ["line 2: <mesh>", "no file sub", ""],
        ),
        (&long, &[], ["main.xml", "longer than 8388608 bytes", ""]),
    ] {
        let message = message(text, others);
        for part in parts {
            assert!(message.contains(part), "{part:?} in {message}");
        }
    }
    let error = Model::from_files(&BTreeMap::new(), "main.xml", Revision::default());
    let error = error.unwrap_err().to_string();
    assert_eq!(error, "main.xml: there is no such file");
}

/// A binary STL file with the triangles of a tetrahedron, one corner of which is at a height.
fn stl(height: f32) -> Vec<u8> {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, height],
    ];
    let mut bytes = vec![0; 80];
    bytes.extend(4_u32.to_le_bytes());
    for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
        bytes.extend([0; 12]);
        let numbers = face.iter().flat_map(|corner: &usize| corners[*corner]);
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn a_binary_stl_file_is_read_up_to_its_limits() {
    let model = r#"<mujoco><asset><mesh name="m" file="m.stl"/></asset><worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>"#;
    let read = |bytes: Vec<u8>| {
        let files = [("m.stl", bytes), ("model.xml", model.as_bytes().to_vec())];
        let files = files.map(|(path, bytes)| (path.to_owned(), bytes)).into();
        Model::from_files(&files, "model.xml", Revision::default())
            .map_err(|error| error.to_string())
    };
    let found = read(stl(1.0)).unwrap();
    // corners that triangles share are one
    assert_eq!(
        (
            found.nmesh(),
            found.meshes.mesh_vertnum[0],
            found.meshes.mesh_facenum[0]
        ),
        (1, 4, 4)
    );
    let with_count = |count: i32| {
        let mut bytes = stl(1.0);
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        bytes
    };
    let too_far = "vertex 3 has a number that is not finite, or too large";
    let most = 1_073_741_824.0_f32;
    for (bytes, words) in [
        (stl(most.next_up()), too_far),
        (stl(-most.next_up()), too_far),
        (stl(f32::INFINITY), too_far),
        (
            stl(f32::NAN),
            "has a number that is not finite, or too large",
        ),
        (with_count(0), "1 to 200,000 are allowed"),
        (with_count(-1), "1 to 200,000 are allowed"),
        (with_count(200_001), "1 to 200,000 are allowed"),
        (with_count(3), "3 triangles"),
        (with_count(5), "5 triangles"),
        (stl(1.0)[..83].to_vec(), "84"),
    ] {
        let error = read(bytes).unwrap_err();
        assert!(error.contains(words), "{error} has not {words}");
    }
    assert!(!read(stl(most)).is_err_and(|error| error.contains(too_far)));
}
