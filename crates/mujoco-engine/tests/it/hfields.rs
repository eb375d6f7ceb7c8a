//! Height fields: their elevations from the text and from files, as libmujoco 3.12.0 and 4.0.0 read
//! them, and what is refused.

use std::fs;

use mujoco_engine::Model;

/// Pictures of 8-bit grey, 8-bit colours, 16-bit grey and 2-bit grey, as hexadecimal numbers.
pub(super) const GREY: &str = "89504e470d0a1a0a0000000d4948445200000003000000020800000000b81f39c60000001049444154789c6360e03ac120f79f1d00068b01f72168b0440000000049454e44ae426082";
const COLORS: &str = "89504e470d0a1a0a0000000d4948445200000002000000020802000000fdd49a730000001649444154789c63606462d630b261700b88e2626005000a45019cc193deaa0000000049454e44ae426082";
const DEEP: &str = "89504e470d0a1a0a0000000d4948445200000002000000021000000000074d8ebb0000001249444154789c636064626661f8c5c6ce01000460011aedb92cf90000000049454e44ae426082";
const BITS: &str = "89504e470d0a1a0a0000000d494844520000000400000002020000000010733a1e0000000c49444154789c639066780200013901004564919b0000000049454e44ae426082";

pub(super) fn bytes(hexadecimal: &str) -> Vec<u8> {
    let pairs = hexadecimal.as_bytes().chunks(2);
    let number = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
    pairs.map(number).collect()
}

fn binary(rows: i32, columns: i32, elevations: &[f32]) -> Vec<u8> {
    let sizes = [rows, columns].map(i32::to_le_bytes);
    let elevations = elevations.iter().flat_map(|x| x.to_le_bytes());
    sizes
        .as_flattened()
        .iter()
        .copied()
        .chain(elevations)
        .collect()
}

/// The model of a file with this content, or the error; `test` names the folder.
fn read(test: &str, name: &str, content: &[u8]) -> Result<Model, String> {
    let folder = format!("mujoco-engine-hfields-{test}-{}", std::process::id());
    let folder = std::env::temp_dir().join(folder);
    fs::create_dir_all(&folder).unwrap();
    let text =
        format!("<mujoco><asset><hfield file=\"{name}\" size=\"1 2 3 .4\"/></asset></mujoco>");
    fs::write(folder.join("model.xml"), text).unwrap();
    fs::write(folder.join(name), content).unwrap();
    let m = Model::from_path(folder.join("model.xml"));
    fs::remove_dir_all(folder).unwrap();
    m.map_err(|error| error.to_string())
}

#[test]
fn files_have_libmujocos_elevations() {
    let elevations = binary(2, 3, &[0.5, -1.0, 2.0, 3.0, 0.25, 7.0]);
    let cases: [(&str, Vec<u8>, usize, &[f32]); 5] = [
        (
            "grey.png",
            bytes(GREY),
            2,
            &[
                0.117_647_06,
                1.0,
                0.027_450_98,
                0.0,
                0.039_215_688,
                0.784_313_74,
            ],
        ),
        (
            "colors.PNG",
            bytes(COLORS),
            2,
            &[1.0, 0.130_434_78, 0.0, 0.565_217_4],
        ),
        (
            "deep.png",
            bytes(DEEP),
            2,
            &[1.0, 0.024_096_385, 0.0, 0.008_032_128],
        ),
        (
            "bits.png",
            bytes(BITS),
            2,
            &[
                1.0,
                0.666_666_7,
                0.333_333_34,
                0.0,
                0.0,
                0.333_333_34,
                0.666_666_7,
                1.0,
            ],
        ),
        (
            "field.bin",
            elevations,
            2,
            &[0.1875, 0.0, 0.375, 0.5, 0.156_25, 1.0],
        ),
    ];
    for (name, content, rows, expected) in cases {
        let m = read("good", name, &content).unwrap();
        assert_eq!(m.hfields.hfield_nrow, [rows], "{name}");
        assert_eq!(m.hfields.hfield_ncol, [expected.len() / rows], "{name}");
        assert_eq!(m.hfields.hfield_data, expected, "{name}");
    }
}

#[test]
fn damaged_files_are_refused() {
    for (name, content, reason) in [
        ("field.png", &bytes(GREY)[..40], "field.png: "),
        ("field.png", &[], "field.png: "),
        (
            "field.bin",
            &[1, 2, 3],
            "the numbers of rows and columns are missing",
        ),
        (
            "field.bin",
            &binary(2, 2, &[1.0; 3]),
            "2 rows and 2 columns do not fit 12 bytes",
        ),
        ("field.bin", &binary(-1, 2, &[1.0; 2]), "do not fit"),
        ("field.bin", &binary(0, 0, &[]), "do not fit"),
        (
            "field.bin",
            &binary(i32::MAX, i32::MAX, &[1.0]),
            "do not fit",
        ),
        (
            "field.bin",
            &binary(1, 2, &[1.0, f32::NAN]),
            "hfield_data is not finite",
        ),
    ] {
        let error = read("bad", name, content).unwrap_err();
        assert!(error.contains(reason), "{name}: {error}");
    }
}

/// A model with a height field and a geom, or the error.
fn written(field: &str, geom: &str) -> Result<Model, String> {
    let text = format!(
        "<mujoco><asset><hfield {field}/></asset><worldbody>{geom}<body><freejoint/><geom size=\".1\"/>\
         </body></worldbody></mujoco>"
    );
    Model::from_xml(&text).map_err(|error| error.to_string())
}

#[test]
fn texts_have_libmujocos_elevations() {
    let field = "name=\"a\" nrow=\"2\" ncol=\"3\" size=\"1 2 3 .4\" elevation=\"1 2 3 4 5 9\"";
    let m = written(field, "<geom type=\"hfield\" hfield=\"a\"/>").unwrap();
    let expected = [0.375, 0.5, 1.0, 0.0, 0.125, 0.25];
    assert_eq!(m.hfields.hfield_data, expected);
    assert_eq!(m.geom_size[0], [1.0, 2.0, 0.95]);
    assert_eq!(m.geom_rbound[0], 3.741_657_386_773_941_3);
    let level = "name=\"a\" nrow=\"2\" ncol=\"2\" size=\"1 1 1 1\"";
    let m = written(level, "").unwrap();
    assert_eq!(m.hfields.hfield_data, [0.0; 4]);
    for (field, geom, reason) in [
        (
            field,
            "<geom type=\"hfield\"/>",
            "attribute \"hfield\": missing",
        ),
        (
            field,
            "<geom type=\"hfield\" hfield=\"b\"/>",
            "there is no height field \"b\"",
        ),
        (
            field,
            "<geom size=\"1\" hfield=\"a\"/>",
            "goes only with type=\"hfield\"",
        ),
        (
            field,
            "<body><freejoint/><geom size=\"1\"/><geom type=\"plane\" size=\"1 1 1\"/></body>",
            "a plane belongs to the world",
        ),
        (
            "name=\"a\" nrow=\"2\" ncol=\"2\"",
            "",
            "attribute \"size\": missing",
        ),
        (
            "name=\"a\" nrow=\"2\" ncol=\"2\" size=\"1 1 0 1\"",
            "",
            "must be positive",
        ),
        ("name=\"a\" size=\"1 1 1 1\"", "", "0 rows and 0 columns"),
        (
            "name=\"a\" nrow=\"60000\" ncol=\"60000\" size=\"1 1 1 1\"",
            "",
            "60000 rows",
        ),
        (
            "name=\"a\" nrow=\"2\" ncol=\"2\" size=\"1 1 1 1\" elevation=\"1 2 3\"",
            "",
            "has 3 numbers, expected nrow * ncol: 4",
        ),
        ("name=\"a\" file=\"a.png\" size=\"1 1 1 1\"", "", "file"),
    ] {
        let error = written(field, geom).unwrap_err();
        assert!(error.contains(reason), "{field} {geom}: {error}");
    }
}

/// Compiled models with damaged height fields are refused.
#[test]
fn damaged_arrays_are_refused() {
    let field = "name=\"a\" nrow=\"2\" ncol=\"3\" size=\"1 2 3 .4\"";
    let m = written(field, "<geom type=\"hfield\" hfield=\"a\"/>").unwrap();
    for (name, value, reason) in [
        (
            "geom_dataid",
            "[-1, -1]",
            "geom_dataid[0] is -1, and there are 1 height fields",
        ),
        (
            "geom_dataid",
            "[1, -1]",
            "geom_dataid[0] is 1, and there are 1 height fields",
        ),
        (
            "hfield_nrow",
            "[3]",
            "height field 0 has 3 rows and 3 columns, and there are 6",
        ),
        ("hfield_nrow", "[0]", "height field 0 has 0 rows"),
        // 2^63 + 3: the product with the rows wraps around to 6
        (
            "hfield_ncol",
            "[9223372036854775811]",
            "height field 0 has 2 rows and 9223372036854775811 columns",
        ),
        (
            "hfield_nrow",
            "[1]",
            "hfield_data has 6 elements, expected 3",
        ),
        (
            "hfield_nrow",
            "[2, 3]",
            "hfield_nrow has 2 elements, expected 1",
        ),
        ("hfield_adr", "[1]", "hfield_adr[0] is 1, expected 0"),
        (
            "hfield_size",
            "[[1, 1, 0, 1]]",
            "hfield_size[0] must be positive",
        ),
    ] {
        let mut figures = serde_json::to_value(&m).unwrap();
        figures[name] = serde_json::from_str(value).unwrap();
        let error = serde_json::from_value::<Model>(figures)
            .unwrap_err()
            .to_string();
        assert!(error.contains(reason), "{name}: {error}");
    }
}
