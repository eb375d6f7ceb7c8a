//! Expected numbers are those of libmujoco 3.12.0 and 4.0.0 (the Python wheels for Linux x86-64).

use super::samples::{made, msh, stl};
use super::{Format, Inertia, Mesh, MeshError, Options, Source, inertia_box};
use crate::Revision;
use crate::compile::hull::{Graph, HullError, samples::Random};
use crate::model::GeomType;

/// Half a box: three quadrilaterals and two triangles.
const WEDGE: &str = "# a wedge
o wedge
v 0 0 0
v 2 0 0
v 2 1 0
v 0 1 0
v 0 0.25 1
v 2 0.25 1
f 4 3 2 1
f 1 2 6 5
f 2 3 6
f 3 4 5 6
f 4 1 5
";

fn compile(obj: &str, options: Options, revision: Revision) -> Result<Mesh, MeshError> {
    Mesh::compile(
        Source::read(Format::Obj, obj.as_bytes(), revision)?,
        &options,
        revision,
    )
}

fn wedge(revision: Revision) -> Mesh {
    compile(
        WEDGE,
        Options {
            scale: [0.5, 1.0, 1.0],
            ..Options::default()
        },
        revision,
    )
    .unwrap()
}

#[test]
fn a_wedge_in_3_12() {
    let mesh = wedge(Revision::V3_12);
    let cut = [
        [3, 2, 1],
        [3, 1, 0],
        [0, 1, 5],
        [0, 5, 4],
        [1, 2, 5],
        [2, 3, 4],
        [2, 4, 5],
        [3, 0, 4],
    ];
    assert_eq!(mesh.faces, cut);
    assert_eq!(mesh.vertices[..3], [-0.532_333_97, -0.036_644_023, -0.5]);
    assert_eq!(mesh.normals[..3], [-0.659_238, 0.751_934_4, 0.0]);
    assert_eq!(
        mesh.position,
        [0.5, 0.41666666666666674, 0.3333333333333333]
    );
    assert_eq!(
        mesh.orientation,
        [
            0.32802635650104384,
            0.6264173604240638,
            0.32802635650104384,
            0.6264173604240638
        ]
    );
    assert_eq!(
        mesh.polygons.concat(),
        [1, 0, 3, 2, 3, 4, 5, 2, 5, 4, 0, 1, 4, 3, 0, 2, 5, 1]
    );
    let of_vertex: [&[i32]; 6] = [
        &[0, 2, 3],
        &[0, 2, 4],
        &[0, 1, 4],
        &[0, 1, 3],
        &[1, 2, 3],
        &[1, 2, 4],
    ];
    assert_eq!(mesh.polygons_of_vertex, of_vertex);
    assert_eq!(
        mesh.polygon_normals[0],
        [-0.5695948377626017, -0.8219256175556252, 0.0]
    );
    assert_eq!(
        mesh.moments(1000.0 * mesh.volume),
        [74.25694769558812, 59.42360785996741, 50.3472222222222]
    );
    let extrema = [
        2, 2, 3, 2, 2, 3, 2, 2, 3, 4, 4, 5, 1, 0, 0, 1, 0, 0, 4, 4, 5, 4, 4, 5, 1, 0, 0,
    ];
    assert_eq!(mesh.extrema, extrema);
}

#[test]
fn a_wedge_in_4_0() {
    let mesh = wedge(Revision::V4_0);
    let cut = [
        [3, 2, 0],
        [2, 1, 0],
        [0, 1, 4],
        [1, 5, 4],
        [1, 2, 5],
        [2, 3, 5],
        [3, 4, 5],
        [3, 0, 4],
    ];
    assert_eq!(mesh.faces, cut);
    assert_eq!(
        mesh.position,
        [0.5000000000000001, 0.41666666666666674, 0.3333333333333333]
    );
    assert_eq!(
        mesh.orientation,
        [
            0.32802635650104395,
            0.6264173604240637,
            0.32802635650104395,
            0.6264173604240637
        ]
    );
    assert_eq!(
        mesh.polygons.concat(),
        [3, 4, 5, 2, 1, 0, 3, 2, 5, 4, 0, 1, 4, 3, 0, 2, 5, 1]
    );
    assert_eq!(
        mesh.polygon_normals[0],
        [0.9992973967020609, 0.037479500323294127, 0.0]
    );
    assert_eq!(mesh.polygon_normals[3], [3.330669073875452e-16, 0.0, -1.0]);
    assert_eq!(
        mesh.moments(1000.0 * mesh.volume),
        [74.25694769558814, 59.423607859967426, 50.34722222222222]
    );
}

/// FNV-1a of all arrays, as libmujoco's model has them.
fn add_to_digest(digest: &mut u64, mesh: &Mesh) {
    let mut add = |bytes: &[u8]| {
        for &byte in bytes {
            *digest = (*digest ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    let mut singles = |list: &[f32]| list.iter().for_each(|x| add(&x.to_le_bytes()));
    singles(&mesh.vertices);
    singles(&mesh.normals);
    singles(&mesh.texture);
    let counts = |lists: &[Vec<i32>]| {
        lists
            .iter()
            .map(|list| list.len() as i32)
            .collect::<Vec<_>>()
    };
    let mut integers = |list: &[i32]| list.iter().for_each(|x| add(&x.to_le_bytes()));
    integers(mesh.faces.as_flattened());
    integers(&mesh.face_normals);
    integers(&vec![0; 3 * mesh.faces.len()]);
    integers(&mesh.graph.as_ref().map_or(Vec::new(), Graph::to_integers));
    integers(&mesh.extrema);
    integers(&counts(&mesh.polygons));
    integers(&mesh.polygons.concat());
    let mut doubles = |list: &[f64]| list.iter().for_each(|x| add(&x.to_le_bytes()));
    doubles(mesh.polygon_normals.as_flattened());
    let mut integers = |list: &[i32]| list.iter().for_each(|x| add(&x.to_le_bytes()));
    integers(&counts(&mesh.polygons_of_vertex));
    integers(&mesh.polygons_of_vertex.concat());
    let mut doubles = |list: &[f64]| list.iter().for_each(|x| add(&x.to_le_bytes()));
    let mass = 1000.0 * mesh.volume;
    let (lower, upper) = (mesh.lower, mesh.upper);
    let size = [0, 1, 2].map(|k| f64::max(lower[k].abs(), upper[k].abs()));
    doubles(&mesh.position);
    doubles(&mesh.orientation);
    doubles(&[mass]);
    doubles(&mesh.moments(mass));
    doubles(&size);
    doubles(&[0, 1, 2].map(|k| (upper[k] + lower[k]) / 2.0));
    doubles(&[0, 1, 2].map(|k| (upper[k] - lower[k]) / 2.0));
    doubles(&[(size[0] * size[0] + size[1] * size[1] + size[2] * size[2]).sqrt()]);
}

#[test]
fn sixty_made_meshes_have_libmujocos_bits() {
    let expected = [
        (
            Revision::V3_12,
            [
                0x3a29_5f4e_ba6a_3cc5,
                0xdd8f_5387_a44d_928f,
                0xd643_7200_45e9_23b0,
                0x812e_3d4e_f72d_417f,
                0xdd11_3d24_83bc_8262,
                0x86e3_0eff_c252_6530,
            ],
        ),
        (
            Revision::V4_0,
            [
                0x5774_c123_156e_3baa,
                0x4967_d716_0c27_3815,
                0xdd45_77a8_9c0b_2441,
                0x8f39_7a99_1a9c_e32b,
                0xa4aa_c6ed_dec3_400b,
                0x196b_1bc7_93c5_455b,
            ],
        ),
    ];
    for (revision, expected) in expected {
        let mut refused = 0;
        for (ten, expected) in (0..).zip(expected) {
            let mut digest = 0xcbf2_9ce4_8422_2325;
            for number in 10 * ten..10 * ten + 10 {
                let (format, bytes, options) = made(number);
                let source = Source::read(format, &bytes, revision).unwrap();
                match Mesh::compile(source, &options, revision) {
                    Ok(mesh) => add_to_digest(&mut digest, &mesh),
                    Err(error) => {
                        assert!(matches!(error, MeshError::Flat(..)), "{number}: {error}");
                        refused += 1;
                    }
                }
            }
            assert_eq!(digest, expected, "{revision:?}, meshes from {}", 10 * ten);
        }
        assert_eq!(refused, 2);
    }
}

#[test]
fn an_stl_file_must_have_the_triangles_that_it_declares() {
    let read = |bytes: &[u8]| Source::read(Format::Stl, bytes, Revision::V4_0);
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-0.0, 0.0, 0.0]];
    let file = stl(&[triangle, triangle]);
    let source = read(&file).unwrap();
    // 0 and -0 are two vertices
    assert_eq!(source.vertices.len(), 9);
    assert_eq!(source.faces, [0, 1, 2, 0, 1, 2]);

    assert!(matches!(
        read(&file[..83]),
        Err(MeshError::Header {
            expected: 84,
            found: 83,
            ..
        })
    ));
    let size = read(&file[..file.len() - 1]).unwrap_err();
    assert!(matches!(
        size,
        MeshError::Size {
            declared: 2,
            expected: 184,
            found: 183,
            ..
        }
    ));
    assert!(size.to_string().contains("convert it to binary"), "{size}");
    for count in [0, -1, 200_001, i32::MAX] {
        let mut file = file.clone();
        file[80..84].copy_from_slice(&count.to_le_bytes());
        assert!(
            matches!(read(&file), Err(MeshError::Count { .. })),
            "{count}"
        );
    }
    let mut far = triangle;
    far[1][2] = 1.1e9;
    assert!(matches!(
        read(&stl(&[far])),
        Err(MeshError::NotFinite("vertex", 1))
    ));
}

#[test]
fn an_msh_file_must_have_the_size_that_it_declares() {
    let read = |bytes: &[u8]| Source::read(Format::Msh, bytes, Revision::V4_0);
    let file = msh(&[[0.0; 3]; 4]);
    assert_eq!(read(&file).unwrap().vertices.len(), 12);
    assert!(matches!(
        read(&file[..15]),
        Err(MeshError::Header { expected: 16, .. })
    ));
    assert!(matches!(
        read(&file[..60]),
        Err(MeshError::Size {
            expected: 64,
            found: 60,
            ..
        })
    ));
    for (place, count, name) in [
        (0, 3, "vertices"),
        (0, -5, "vertices"),
        (1, 3, "normals"),
        (2, 5, "texture coordinates"),
        (3, -1, "faces"),
    ] {
        let mut file = file.clone();
        file[4 * place..4 * place + 4].copy_from_slice(&i32::to_le_bytes(count));
        let Err(MeshError::Count { found, what, .. }) = read(&file) else {
            panic!("{place}: {count}");
        };
        assert_eq!((found, what), (i64::from(count), name));
    }
    let mut huge = file.clone();
    huge[..4].copy_from_slice(&i32::MAX.to_le_bytes());
    assert!(matches!(read(&huge), Err(MeshError::Size { .. })));
}

#[test]
fn numbers_of_obj_files_are_rounded_as_tinyobjloader_does() {
    let numbers = |text: &str| {
        let source = Source::read(Format::Obj, text.as_bytes(), Revision::V4_0).unwrap();
        source.vertices
    };
    assert_eq!(
        numbers("v 1 -2.5 +.5\nv 1e3 2E-2 -0.125e+1"),
        [1.0, -2.5, 0.5, 1000.0, 0.02, -1.25]
    );
    // no number, or none at all: 0
    assert_eq!(
        numbers("v nan inf 1e\r\nv \t 7"),
        [0.0, 0.0, 0.0, 7.0, 0.0, 0.0]
    );
    assert_eq!(
        numbers("v 1e999 -1e-999 1e-40"),
        [f32::INFINITY, 0.0, 1e-40]
    );
    // the nearest numbers are 0.725_852_6 and 0.233_084_46
    let numbers = numbers("v 0.725852638483047485 0.233084462583065 0");
    assert_eq!(numbers, [0.725_852_67, 0.233_084_47, 0.0]);
}

#[test]
fn an_obj_file_gives_its_first_object() {
    let read = |text: &str, revision| Source::read(Format::Obj, text.as_bytes(), revision);
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.5 0.25\nvn 0 0 1\n";
    let text = format!("g empty\r\n{corners}o first\nf 1/1/1 2/1/1 -1//1\no second\nf 2 3 4\n");
    let source = read(&text, Revision::V3_12).unwrap();
    assert_eq!(source.faces, [0, 1, 3]);
    assert_eq!(source.face_texture, [0, 0, -1]);
    assert_eq!(source.face_normals, [0, 0, 0]);
    assert_eq!(source.texture, [0.5, 0.75]);

    // an index 0 is none in 4.0, except of vertices
    let zero = format!("{corners}f 1/0 2/0 3/0\n");
    assert_eq!(
        read(&zero, Revision::V4_0).unwrap().face_texture,
        [-1, -1, -1]
    );
    let fault = read(&zero, Revision::V3_12).unwrap_err();
    assert!(matches!(fault, MeshError::Line { line: 7, .. }), "{fault}");
    for revision in [Revision::V3_12, Revision::V4_0] {
        assert!(matches!(
            read("v 0 0 0\nf 1 0 1", revision),
            Err(MeshError::Line { line: 2, .. })
        ));
        assert!(matches!(
            read("f 1 x 1", revision),
            Err(MeshError::Line { line: 1, .. })
        ));
    }
}

#[test]
fn polygons_of_more_than_a_hundred_corners_are_dropped() {
    let polygon = |n: usize| {
        let mut text = String::new();
        for i in 0..n {
            text += &format!("v {} {} 0\n", i, (i * (n - i)));
        }
        text += "f";
        for i in 1..=n {
            text += &format!(" {i}");
        }
        Source::read(Format::Obj, text.as_bytes(), Revision::V4_0)
            .unwrap()
            .faces
            .len()
    };
    assert_eq!(polygon(100), 3 * 98);
    assert_eq!(polygon(101), 0);
}

#[test]
fn bad_meshes_are_refused() {
    let bad = |obj: &str, options| compile(obj, options, Revision::V4_0).unwrap_err();
    let default = Options::default();
    assert_eq!(bad("v 0 0 0\n", default), MeshError::TooFewVertices(1));
    let no_vertex = MeshError::NoVertex {
        face: 1,
        vertex: 6,
        vertices: 6,
    };
    assert_eq!(
        bad(&WEDGE.replace("f 4 3 2 1\n", "f 1 2 3\nf 7 1 2\n"), default),
        no_vertex
    );
    assert_eq!(
        bad(&WEDGE.replace("v 2 1 0", "v 1e39 1 0"), default),
        MeshError::NotFinite("vertex", 2)
    );
    for (points, fault) in [
        ("v 1 1 1\nv 1 1 1\nv 1 1 1\nv 1 1 1\n", "at one place"),
        ("v 1 1 1\nv 2 2 2\nv 3 3 3\nv 4 4 4\n", "on one line"),
        ("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n", "in one plane"),
    ] {
        assert!(matches!(bad(points, default), MeshError::Flat(found, _) if found == fault));
    }
    let inside_out = Options {
        inertia: Inertia::Exact,
        ..default
    };
    let turned = WEDGE.replace("f 2 3 6", "f 3 2 6");
    assert_eq!(bad(&turned, inside_out), MeshError::Orientation(1, 5));
    let mirrored = Options {
        scale: [-1.0, 1.0, 1.0],
        inertia: Inertia::Convex,
        ..default
    };
    // 3.12 leaves the hull of a mirrored mesh inside out
    let fault = compile(WEDGE, mirrored, Revision::V3_12).unwrap_err();
    assert!(matches!(fault, MeshError::NegativeVolume(volume) if volume < -0.9));
    assert!(compile(WEDGE, mirrored, Revision::V4_0).is_ok());
    let tiny = Options {
        scale: [1e-6; 3],
        ..default
    };
    assert!(matches!(bad(WEDGE, tiny), MeshError::Volume(volume) if volume < 1e-15));
    let none = Options {
        scale: [0.0; 3],
        ..default
    };
    assert!(matches!(bad(WEDGE, none), MeshError::Area(0.0)));
    let three = Options {
        max_hull_vertices: Some(3),
        ..default
    };
    assert_eq!(
        bad(WEDGE, three),
        MeshError::Hull(HullError::MaxVertices(3))
    );
}

/// The greatest of three moments of inertia is at most the sum of the others; a plate reaches it.
#[test]
fn moments_that_no_body_has_are_refused() {
    for [a, b, c] in [[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [3.0, 2.0, 1.0]] {
        for moments in [[a, b, c], [c, a, b], [b, c, a]] {
            let sizes = inertia_box(moments, 12.0).unwrap();
            // the moments of a box of mass 12 with these half sizes
            let found =
                [(1, 2), (0, 2), (0, 1)].map(|(i, k)| 4.0 * (sizes[i].powi(2) + sizes[k].powi(2)));
            for (found, known) in found.into_iter().zip(moments) {
                assert!((found - known).abs() < 1e-12, "{moments:?}: {found}");
            }
        }
    }
    for [a, b, c] in [
        [3.0, 1.0, 1.0],
        [2.1, 1.0, 1.0],
        [1.0, 1.0, -1.0],
        [0.0, 0.0, 0.0],
        [-1.0, -1.0, -1.0],
    ] {
        for moments in [[a, b, c], [c, a, b], [b, c, a]] {
            let found = inertia_box(moments, 12.0);
            assert_eq!(found.unwrap_err(), MeshError::Inertia(moments));
        }
    }
}

#[test]
fn attributes_add_what_a_file_lacks() {
    let mut source = Source::read(Format::Obj, WEDGE.as_bytes(), Revision::V4_0).unwrap();
    let texture = Source {
        texture: vec![0.0; 12],
        ..Source::default()
    };
    source.complete(texture.clone()).unwrap();
    assert_eq!(
        source.complete(texture),
        Err(MeshError::Repeated("texcoord"))
    );
    let mesh = Mesh::compile(source.clone(), &Options::default(), Revision::V4_0).unwrap();
    assert_eq!(mesh.face_texture, mesh.faces.as_flattened());
    source.normals = vec![1.0; 4];
    let fault = MeshError::Multiple {
        name: "normal",
        found: 4,
        multiple: 3,
    };
    assert_eq!(
        Mesh::compile(source, &Options::default(), Revision::V4_0),
        Err(fault)
    );
}

#[test]
fn shapes_are_fitted() {
    let mesh = wedge(Revision::V4_0);
    let [x, y, z] = mesh.half_sizes;
    assert_eq!(
        mesh.fit(GeomType::Box, false, 2.0),
        Some(([2.0 * x, 2.0 * y, 2.0 * z], [0.0; 3]))
    );
    let (size, center) = mesh.fit(GeomType::Cylinder, true, 1.0).unwrap();
    assert_eq!(
        center,
        [0, 1, 2].map(|k| (mesh.lower[k] + mesh.upper[k]) / 2.0)
    );
    assert_eq!(
        size,
        [mesh.upper[1] - center[1], mesh.upper[2] - center[2], 0.0]
    );
    assert_eq!(mesh.fit(GeomType::Plane, false, 1.0), None);
}

/// Files with wrong bytes: every one gives a mesh or an error.
#[test]
fn hostile_files_neither_panic_nor_hang() {
    for seed in 0..2000 {
        let random = &mut Random(seed);
        let (format, mut bytes, options) = made(random.below(60));
        for _ in 0..1 + random.below(6) {
            let at = random.below(bytes.len() as u64) as usize;
            match random.below(5) {
                0 => bytes.truncate(at + 1),
                1 => bytes[at] = b" -/.e0\n"[random.below(7) as usize],
                2 => bytes.insert(at, b'9'),
                _ => bytes[at] = random.below(256) as u8,
            }
        }
        let revision = if seed % 2 == 0 {
            Revision::V3_12
        } else {
            Revision::V4_0
        };
        let Ok(source) = Source::read(format, &bytes, revision) else {
            continue;
        };
        if let Ok(mesh) = Mesh::compile(source, &options, revision) {
            assert!(mesh.vertices.iter().all(|x| x.is_finite()), "seed {seed}");
        }
    }
}
