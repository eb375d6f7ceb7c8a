//! Meshes of models in MJCF. `recorded/assets.py` recorded the digests of libmujoco's arrays.

use std::fs;
use std::path::{Path, PathBuf};

use mujoco_engine::Model;
use serde_json::Value;

use super::digest::Digest;

/// Meshes by their attributes, in all ways, and shapes fitted to them.
const TEXT: &str = r#"<mujoco>
  <compiler fitaabb="false"/>
  <default>
    <mesh scale="1 .5 .5"/>
    <default class="turned"><mesh scale="-1 1 1" maxhullvert="6"/></default>
  </default>
  <asset>
    <material name="red" rgba="1 0 0 1"/>
    <mesh name="points" vertex="0 0 0 1 0 0 1 1 0 0 1 0 .2 .1 1 .9 .1 1 .9 .8 1.1 .1 .9 1 .5 .5 .5" material="red"/>
    <mesh name="turned" class="turned" vertex="0 0 0 1 0 0 1 1 0 0 1 0 .2 .1 1 .9 .1 1 .9 .8 1.1 .1 .9 1"/>
    <mesh name="faces" vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 2 1 0 1 3 0 3 2 1 2 3" inertia="exact"
      refpos=".1 .2 .3" refquat="1 .2 0 -.5" smoothnormal="true"/>
    <mesh name="shell" vertex="0 0 0 1 0 0 0 1 0 0 0 1 .3 .3 .4" face="0 2 1 0 1 4 0 4 2 1 2 4" inertia="shell"
      normal="0 0 -1 1 0 0 0 1 0 0 0 1 0 0 2" texcoord="0 0 1 0 0 1 1 1 .5 .5"/>
    <mesh name="bent" vertex="0 0 0 2 0 0 0 2 0 0 0 2 .1 .1 .1" face="0 2 1 0 1 3 0 3 2 1 2 4 2 3 4 3 1 4" inertia="convex"/>
    <mesh name="unused" vertex="0 0 0 1 0 0 0 3 0 0 0 1"/>
  </asset>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body pos="0 0 1">
      <freejoint/>
      <geom type="mesh" mesh="points" pos=".1 .2 .3" euler="10 20 30"/>
      <frame pos="1 0 0" euler="0 0 90">
        <geom type="mesh" mesh="turned" density="700" fluidshape="ellipsoid"/>
        <geom type="mesh" mesh="shell" mass=".5" contype="0" conaffinity="0"/>
      </frame>
    </body>
    <body pos="2 0 1">
      <joint axis="1 2 3"/>
      <geom type="mesh" mesh="faces"/>
      <body pos="0 0 1"><joint/><geom type="mesh" mesh="bent" mass="0"/><geom type="capsule" mesh="points" fitscale="1.5"/></body>
    </body>
    <body pos="4 0 1">
      <freejoint/>
      <geom mesh="points" size="1 2 3" fitscale=".5"/>
      <geom type="cylinder" mesh="turned" pos="1 0 0"/>
      <geom type="ellipsoid" mesh="faces" quat="1 2 3 4"/>
      <geom type="box" mesh="shell" shellinertia="true"/>
    </body>
  </worldbody>
</mujoco>"#;

/// The arrays that are compared, in groups.
const ARRAYS: [&str; 3] = [
    "mesh_vertadr mesh_vertnum mesh_vert mesh_normaladr mesh_normalnum mesh_normal mesh_texcoordadr mesh_texcoordnum \
     mesh_texcoord mesh_faceadr mesh_facenum mesh_face mesh_facenormal mesh_facetexcoord mesh_graphadr mesh_graph \
     mesh_extrema mesh_polyadr mesh_polynum mesh_polynormal mesh_polyvertadr mesh_polyvertnum mesh_polyvert \
     mesh_polymapadr mesh_polymapnum mesh_polymap mesh_pos mesh_quat",
    "geom_type geom_dataid geom_matid geom_size geom_aabb geom_rbound geom_pos geom_quat geom_fluid",
    "body_mass body_inertia body_ipos body_iquat",
];

/// A digest of the numbers of each group of arrays.
fn digests(m: &Model) -> [u64; 3] {
    fn add(numbers: &Value, digest: &mut Digest) {
        let bits = match numbers {
            Value::Array(numbers) => return numbers.iter().for_each(|number| add(number, digest)),
            number => number.as_i64().map_or_else(
                || number.as_f64().unwrap().to_bits(),
                |number| number as u64,
            ),
        };
        digest.word(bits);
    }
    let figures = serde_json::to_value(m).unwrap();
    ARRAYS.map(|names| {
        let mut digest = Digest::default();
        for name in names.split_whitespace() {
            add(&figures[name], &mut digest);
        }
        digest.0
    })
}

#[test]
fn meshes_are_libmujocos() {
    let bounds = TEXT.replace("fitaabb=\"false\"", "fitaabb=\"true\"");
    for (version, text, expected) in [
        (
            "3.12.0",
            TEXT,
            [
                0xff2d_7d0b_8c24_9b3b,
                0xd3eb_fdee_9cf3_5d95,
                0xd7f4_9733_fa9e_074d,
            ],
        ),
        (
            "3.12.0",
            &bounds,
            [
                0xff2d_7d0b_8c24_9b3b,
                0x3b2a_8359_1bb9_ee25,
                0x23bf_e3ee_1b48_18a3,
            ],
        ),
        (
            "4.0.0",
            TEXT,
            [
                0x3701_414b_c209_030d,
                0xdce4_80cb_3500_a2bd,
                0x18fd_cb20_3758_cdd7,
            ],
        ),
        (
            "4.0.0",
            &bounds,
            [
                0x3701_414b_c209_030d,
                0x1aa7_21cf_8162_9ac0,
                0xa173_89d1_5a9d_1686,
            ],
        ),
    ] {
        let m = Model::from_xml_with(text, version.parse().unwrap()).unwrap();
        assert_eq!(digests(&m), expected, "{version}: {:x?}", digests(&m));
    }
}

const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// A folder of files, which is removed at the end.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let name = format!("mujoco-engine-{name}-{}", std::process::id());
        let folder = Self(std::env::temp_dir().join(name));
        for (file, text) in files {
            let path = folder.0.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    pub(crate) fn model(&self, file: &str) -> mujoco_engine::Result<Model> {
        Model::from_path(self.0.join(file))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A model that shows a mesh of this name, on line 2.
fn shows(mesh: &str, name: &str, more: &str) -> String {
    format!(
        "<mujoco>{more}\n<asset>{mesh}</asset><worldbody><geom type=\"mesh\" mesh=\"{name}\" contype=\"0\" conaffinity=\"0\"/></worldbody></mujoco>"
    )
}

/// The file of a mesh is in the folder that `meshdir` names beside the model, or else beside the
/// file that names it. Its name is that of the file, up to the last dot.
#[test]
fn files_are_found() {
    let part = "<asset><mesh file=\"arm.v2.obj\"/><mesh file=\"hand.OBJ\"/></asset>";
    let arm = |folder: &str| {
        let compiler = format!("<compiler meshdir=\"{folder}\"/>");
        shows("<mesh file=\"arm.v2.obj\"/>", "arm.v2", &compiler)
    };
    let typed = "<mesh file=\"meshes/data\" content_type=\"model/obj\" scale=\"2 2 2\"/>";
    let stripped = "<mesh name=\"x\" file=\"nowhere/arm.v2.obj\"/>";
    let strip = "<compiler strippath=\"true\" assetdir=\"meshes\"/>";
    let folder = Folder::new(
        "found",
        &[
            ("meshes/arm.v2.obj", TETRAHEDRON),
            ("meshes/data", TETRAHEDRON),
            ("parts/hand.OBJ", TETRAHEDRON),
            ("parts/part.xml", &format!("<mujoco>{part}</mujoco>")),
            ("own.xml", &arm("meshes")),
            ("typed.xml", &shows(typed, "data", "")),
            ("stripped.xml", &shows(stripped, "x", strip)),
            (
                "whole.xml",
                &shows(
                    "",
                    "hand",
                    "<compiler meshdir=\"meshes\"/><include file=\"parts/part.xml\"/>",
                ),
            ),
            ("missing.xml", &arm("parts")),
        ],
    );
    for (file, meshes) in [
        ("own.xml", 1),
        ("typed.xml", 1),
        ("stripped.xml", 1),
        ("whole.xml", 2),
    ] {
        let m = folder
            .model(file)
            .unwrap_or_else(|error| panic!("{file}: {error}"));
        assert_eq!((m.nmesh(), m.meshes.mesh_vertnum[0]), (meshes, 4), "{file}");
        assert!(m.geom_rbound[0] > 0.5, "{file}");
    }
    let error = folder.model("missing.xml").unwrap_err().to_string();
    assert!(
        error.contains("line 2: <mesh> attribute \"file\": there is no file"),
        "{error}"
    );
    let error = Model::from_xml(&arm("meshes")).unwrap_err().to_string();
    assert!(error.contains("a text has no folder"), "{error}");
}

/// A file that is no mesh is an error that names the model, the line, the element and the file.
#[test]
fn files_that_are_no_meshes_are_refused() {
    let flat = TETRAHEDRON.replace("v 0 0 1", "v 1 1 0");
    let stl = format!("{}\u{1}\u{1}\u{1}\u{1}", " ".repeat(80));
    let folder = Folder::new(
        "refused",
        &[
            ("folder.obj/x", ""),
            ("empty.obj", ""),
            ("short.stl", &stl),
            ("odd.obj", "f 0 1 2\n"),
            ("flat.obj", &flat),
            ("far.obj", &TETRAHEDRON.replace("0 0 1", "0 0 1e30")),
            ("text.txt", TETRAHEDRON),
            ("good.obj", TETRAHEDRON),
        ],
    );
    let huge = fs::File::create(folder.0.join("huge.stl")).unwrap();
    huge.set_len(300 << 20).unwrap();
    for (file, message) in [
        ("folder.obj", "not a regular file"),
        ("empty.obj", "at least 4 vertices"),
        ("short.stl", "with 16843009 triangles"),
        ("odd.obj", "line 1 of the OBJ file"),
        ("flat.obj", "the volume is too small"),
        ("text.txt", "no format of meshes: use stl, obj or msh"),
        ("huge.stl", "more than 268435456 bytes"),
    ] {
        let model = shows(&format!("<mesh name=\"m\" file=\"{file}\"/>"), "m", "");
        fs::write(folder.0.join("model.xml"), model).unwrap();
        let error = folder.model("model.xml").unwrap_err().to_string();
        for part in [
            message,
            "model.xml",
            "line 2: <mesh> attribute \"file\"",
            file,
        ] {
            assert!(error.contains(part), "{file}: {part}: {error}");
        }
    }
    // many names of one file count as many files
    let many: String = (0..4001)
        .map(|i| format!("<mesh name=\"{i}\" file=\"good.obj\"/>"))
        .collect();
    fs::write(folder.0.join("model.xml"), shows(&many, "1", "")).unwrap();
    let error = folder.model("model.xml").unwrap_err().to_string();
    assert!(error.contains("more than 4000 meshes"), "{error}");
}

/// A mesh in the text is refused like one in a file.
#[test]
fn attributes_that_are_no_meshes_are_refused() {
    let four = "vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\"";
    for (mesh, message) in [
        (
            "<mesh name=\"m\"/>",
            "<mesh>: a mesh needs at least 4 vertices",
        ),
        ("<mesh name=\"m\" vertex=\"0 0 0 1\"/>", "a multiple of 3"),
        (
            "<mesh name=\"m\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 nan\"/>",
            "vertex 3",
        ),
        (
            "<mesh name=\"m\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1e39\"/>",
            "vertex 3",
        ),
        (
            "<mesh name=\"m\" vertex=\"0 0 0 x\"/>",
            "attribute \"vertex\": \"x\"",
        ),
        (
            &format!("<mesh name=\"m\" {four} face=\"0 1 4\"/>"),
            "face 0 names vertex 4",
        ),
        (
            &format!("<mesh name=\"m\" {four} face=\"0 1 -1\"/>"),
            "face 0 names vertex -1",
        ),
        (
            &format!("<mesh name=\"m\" {four} face=\"0 1 1.5\"/>"),
            "attribute \"face\": \"1.5\"",
        ),
        (
            &format!("<mesh name=\"m\" {four} maxhullvert=\"3\"/>"),
            "attribute \"maxhullvert\"",
        ),
        (
            &format!("<mesh name=\"m\" {four} inertia=\"none\"/>"),
            "attribute \"inertia\"",
        ),
        (
            &format!("<mesh name=\"m\" {four} scale=\"1 0 1\"/>"),
            "<mesh>",
        ),
        (
            &format!("<mesh name=\"m\" {four} scale=\"1e200 1e200 1\"/>"),
            "line",
        ),
        (
            &format!("<mesh name=\"m\" {four} refquat=\"0 0 0 0\"/>"),
            "<mesh>",
        ),
        (
            &format!("<mesh name=\"m\" {four} texcoord=\"0 1 1 1\"/>"),
            "texture coordinates",
        ),
        (
            &format!("<mesh name=\"m\" {four} builtin=\"wedge\"/>"),
            "attribute \"builtin\"",
        ),
        (
            &format!("<mesh name=\"m\" {four}/><mesh name=\"m\" {four}/>"),
            "there is a mesh \"m\" already",
        ),
        (&format!("<mesh {four}/>"), "attribute \"name\": missing"),
        (
            &format!("<mesh name=\"m\" {four}><plugin/></mesh>"),
            "<plugin>",
        ),
    ] {
        let error = Model::from_xml(&shows(mesh, "m", ""))
            .unwrap_err()
            .to_string();
        assert!(error.starts_with("line 2: <"), "{mesh}: {error}");
        assert!(error.contains(message), "{mesh}: {error}");
    }
    let geom = |geom: &str| {
        let text = format!(
            "<mujoco><asset><mesh name=\"m\" {four}/></asset>\n<worldbody>{geom}</worldbody></mujoco>"
        );
        Model::from_xml(&text).unwrap_err().to_string()
    };
    for (text, message) in [
        ("<geom type=\"mesh\"/>", "attribute \"mesh\": missing"),
        ("<geom type=\"mesh\" mesh=\"n\"/>", "there is no mesh \"n\""),
        (
            "<geom type=\"plane\" mesh=\"m\"/>",
            "attribute \"mesh\": only spheres",
        ),
        (
            "<geom type=\"mesh\" mesh=\"m\" shellinertia=\"true\"/>",
            "attribute \"shellinertia\"",
        ),
        (
            "<geom type=\"capsule\" mesh=\"m\" fromto=\"0 0 0 1 1 1\"/>",
            "attribute \"fromto\"",
        ),
        (
            "<geom type=\"box\" mesh=\"m\" fitscale=\"-1\"/>",
            "attribute \"size\"",
        ),
    ] {
        let error = geom(text);
        assert!(
            error.starts_with("line 2: <geom>") && error.contains(message),
            "{text}: {error}"
        );
    }
}

/// `discardvisual` drops meshes that only pictures show, as in libmujoco; before 3.17, a shape keeps
/// the mesh that it was fitted to.
#[test]
fn discarded_meshes_leave_no_gap() {
    let mesh = |name| format!("<mesh name=\"{name}\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\"/>");
    let meshes: String = ["shown", "fitted", "unused", "touched", "paired"]
        .map(mesh)
        .concat();
    let text = format!(
        "<mujoco><compiler discardvisual=\"true\"/><asset>{meshes}</asset><worldbody><body><freejoint/>\
         <geom type=\"mesh\" mesh=\"shown\" contype=\"0\" conaffinity=\"0\"/><geom type=\"box\" mesh=\"fitted\"/>\
         <geom name=\"t\" type=\"mesh\" mesh=\"touched\"/></body>\
         <geom name=\"p\" type=\"mesh\" mesh=\"paired\" contype=\"0\" conaffinity=\"0\"/></worldbody>\
         <contact><pair geom1=\"t\" geom2=\"p\"/></contact></mujoco>"
    );
    for (version, ids) in [("3.12.0", [2, 0, 1]), ("4.0.0", [2, -1, 1])] {
        let m = Model::from_xml_with(&text, version.parse().unwrap()).unwrap();
        assert_eq!((m.nmesh(), &m.geom_dataid[..]), (3, &ids[..]), "{version}");
    }
}
