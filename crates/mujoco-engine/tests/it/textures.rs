//! Textures and materials, compared with the arrays of libmujoco 3.12.0 and 4.0.0, which are equal.

use std::fs;

use mujoco_engine::model::TextureType;
use mujoco_engine::{Model, Revision};

use crate::assets::Folder;

const COLORS: &str = r#"rgb1="1 .5 .25" rgb2="0 .1 .9""#;

fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// The pixels of a texture.
fn pixels(m: &Model, id: usize) -> &[u8] {
    let t = &m.textures;
    let bytes = t.tex_width[id] * t.tex_height[id] * t.tex_nchannel[id];
    &t.tex_data[t.tex_adr[id]..][..bytes]
}

#[test]
fn patterns_are_libmujocos() {
    let text = format!(
        r#"<mujoco><asset>
        <texture name="a" type="2d" builtin="gradient" {COLORS} width="5" height="4"/>
        <texture name="b" type="2d" builtin="checker" {COLORS} width="5" height="4" mark="edge" markrgb=".2 .3 .4"/>
        <texture name="c" type="2d" builtin="flat" {COLORS} width="5" height="4" mark="cross" markrgb=".2 .3 .4"/>
        <texture name="d" type="cube" builtin="gradient" {COLORS} width="4"/>
        <texture name="e" type="cube" builtin="checker" {COLORS} width="5" mark="cross"/>
        <texture type="skybox" builtin="gradient" {COLORS} width="2"/>
        <material name="a" texture="a" texrepeat="2 3" texuniform="true" specular=".25" shininess=".75" emission=".125"/>
        <material name="b" texture="b"/>
        <material name="c"><layer role="rgb" texture="c"/></material>
        <material name="d" texture="d"/>
        <material name="e" texture="e"/>
        <material name="f"/>
        </asset><worldbody><geom size="1" material="a"/></worldbody></mujoco>"#
    );
    for revision in Revision::ALL {
        let m = Model::from_xml_with(&text, revision).unwrap();
        assert_eq!(m.mat_texid, [0, 1, 2, 3, 4, -1]);
        assert_eq!(m.mat_texrepeat[..2], [[2.0, 3.0], [1.0, 1.0]]);
        let first = (
            m.mat_texuniform[0],
            m.mat_specular[0],
            m.mat_shininess[0],
            m.mat_emission[0],
        );
        assert_eq!(first, (true, 0.25, 0.75, 0.125));
        let t = &m.textures;
        assert_eq!(t.tex_width, [5, 5, 5, 4, 5, 0], "nobody has the sky");
        assert_eq!(t.tex_height, [4, 4, 4, 24, 30, 0]);
        assert_eq!(t.tex_adr, [0, 60, 120, 180, 468, 918]);
        let digests = [0, 1, 2, 3, 4].map(|id| fnv(pixels(&m, id)));
        let expected = [
            0x1283_c2a4_3b66_58f9,
            0x3143_3712_5d3c_f3be,
            0xd183_9d73_5200_a6a5,
            0xe153_be60_f25b_fe71,
            0x2042_75e0_541f_9ded,
        ];
        assert_eq!(digests, expected, "{digests:x?}");
    }
}

/// A PNG of two rows, with the bytes of its pixels.
fn png(color: png::ColorType, width: u32, bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, 2);
    encoder.set_color(color);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(bytes)
        .unwrap();
    file
}

/// A model with one texture that a material has.
fn textured(texture: &str) -> String {
    format!(
        "<mujoco><compiler texturedir=\"images\"/><asset>\n<texture {texture}/><material name=\"m\" texture=\"t\"/></asset>\
         <worldbody><geom size=\"1\" material=\"m\"/></worldbody></mujoco>"
    )
}

/// The files of a height field and of a texture count together: either alone is small enough.
#[test]
fn files_of_all_kinds_have_one_limit() {
    let folder = Folder::new("together", &[("none.txt", "")]);
    let grey = png(png::ColorType::Grayscale, 2, &[10, 20, 30, 40]);
    for name in ["t.png", "h.png"] {
        // readers of PNG ignore what follows a picture
        let path = folder.path().join(name);
        fs::write(&path, &grey).unwrap();
        let file = fs::File::options().write(true).open(path).unwrap();
        file.set_len(150 << 20).unwrap();
    }
    let field = r#"<hfield name="h" file="h.png" size="1 1 1 1"/>"#;
    let texture = r#"<texture type="2d" file="t.png"/><material name="m" texture="t"/>"#;
    let load = |assets: &str, geom: &str| {
        let text = format!(
            "<mujoco><asset>{assets}</asset><worldbody><geom {geom}/></worldbody></mujoco>"
        );
        fs::write(folder.path().join("m.xml"), text).unwrap();
        folder.model("m.xml").map_err(|error| error.to_string())
    };
    load(field, r#"type="hfield" hfield="h""#).unwrap();
    load(texture, r#"size="1" material="m""#).unwrap();
    let both = load(
        &format!("{field}{texture}"),
        r#"type="hfield" hfield="h" material="m""#,
    );
    let error = both.unwrap_err();
    for part in ["t.png", "all assets together", "268435456 bytes"] {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn files_give_their_pixels() {
    let folder = Folder::new("textures", &[("images/none.txt", "")]);
    let images = folder.path().join("images");
    let grey = png(png::ColorType::Grayscale, 2, &[10, 20, 30, 40]);
    fs::write(images.join("t.png"), &grey).unwrap();
    let clear = png(
        png::ColorType::Rgba,
        2,
        &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16],
    );
    fs::write(images.join("clear.png"), clear).unwrap();
    let strip = png(png::ColorType::Grayscale, 4, &[1, 2, 3, 4, 5, 6, 7, 8]);
    fs::write(images.join("strip.png"), strip).unwrap();
    fs::write(images.join("not.png"), "not a picture").unwrap();
    let load = |texture: &str| {
        fs::write(folder.path().join("m.xml"), textured(texture)).unwrap();
        folder.model("m.xml").map_err(|error| error.to_string())
    };
    let of = |texture: &str| pixels(&load(texture).unwrap(), 0).to_vec();
    // the name of the file is the texture's
    let grey = |bytes: &[u8]| bytes.iter().flat_map(|x| [*x; 3]).collect::<Vec<u8>>();
    assert_eq!(of(r#"type="2d" file="t.png""#), grey(&[10, 20, 30, 40]));
    assert_eq!(
        of(r#"type="2d" file="t.png" hflip="true""#),
        grey(&[20, 10, 40, 30])
    );
    assert_eq!(
        of(r#"type="2d" file="t.png" vflip="true""#),
        grey(&[30, 40, 10, 20])
    );
    assert_eq!(
        of(r#"type="2d" file="t.png" nchannel="1""#),
        [10, 20, 30, 40]
    );
    let clear = |more: &str| of(&format!(r#"name="t" type="2d" file="clear.png" {more}"#));
    assert_eq!(clear(""), [1, 2, 3, 5, 6, 7, 9, 10, 11, 13, 14, 15]);
    assert_eq!(clear(r#"nchannel="4""#)[..4], [1, 2, 3, 4]);
    // one face for all sides; faces in a grid; a file for a face
    let cube = load(r#"file="t.png""#).unwrap();
    assert_eq!(
        (cube.textures.tex_type[0], cube.textures.tex_height[0]),
        (TextureType::Cube, 2)
    );
    let grid = of(r#"name="t" file="strip.png" gridsize="1 2" gridlayout="BL" rgb1="0 0 0""#);
    let faces: Vec<&[u8]> = grid.chunks(12).collect();
    assert_eq!(
        (faces.len(), faces[5], faces[1]),
        (6, &*grey(&[1, 2, 5, 6]), &*grey(&[3, 4, 7, 8]))
    );
    assert_eq!(
        faces[0], [0; 12],
        "the first colour, where there is no face"
    );
    let sky =
        r#"name="t" type="skybox" file="strip.png" gridsize="1 2" gridlayout="BL" rgb1="0 0 0""#;
    assert_eq!(of(sky), grid, "a sky has the faces of a cube");
    let up = of(r#"name="t" fileup="t.png""#);
    assert_eq!((&up[24..36], up[0]), (&*grey(&[10, 20, 30, 40]), 204));

    // the folders of all files of textures are left out
    for texture in [r#"file="no/t.png""#, r#"name="t" fileback="no/t.png""#] {
        let text = textured(texture).replace("<compiler", "<compiler strippath=\"true\"");
        fs::write(folder.path().join("m.xml"), text).unwrap();
        folder.model("m.xml").unwrap();
    }

    for (texture, words) in [
        (
            r#"name="t" type="2d" file="none.png""#,
            "attribute \"file\": there is no file",
        ),
        (
            r#"name="t" type="2d" file="not.png""#,
            "not.png: this is no PNG file",
        ),
        (r#"name="t" type="2d""#, "give a file"),
        (
            r#"name="t" type="2d" builtin="flat""#,
            "needs a width and a height",
        ),
        (
            r#"name="t" builtin="flat" width="100000""#,
            "make it smaller",
        ),
        (r#"name="t" file="strip.png""#, "attribute \"gridsize\""),
        (r#"name="t" file="t.png" gridlayout="RX""#, "'X' is no face"),
        (
            r#"name="u" type="2d" file="t.png""#,
            "there is no texture \"t\"",
        ),
        (
            r#"name="t" type="2d" file="t.ktx" content_type="image/ktx""#,
            "image/png",
        ),
    ] {
        let error = load(texture).unwrap_err();
        assert!(
            error.contains("line 2") && error.contains(words),
            "{texture}: {error}"
        );
    }
}

/// Each face of a cube can have a file of its own.
#[test]
fn a_cube_has_a_file_for_each_face() {
    let folder = Folder::new("faces", &[("images/none.txt", "")]);
    let sides = ["right", "left", "up", "down", "front", "back"];
    let mut files = String::new();
    for (face, side) in (1..).zip(sides) {
        let picture = png(png::ColorType::Grayscale, 2, &[face; 4]);
        let path = folder.path().join(format!("images/{side}.png"));
        fs::write(path, picture).unwrap();
        files += &format!(" file{side}=\"{side}.png\"");
    }
    let load = |texture: &str| {
        fs::write(folder.path().join("m.xml"), textured(texture)).unwrap();
        folder.model("m.xml")
    };
    let faces: Vec<u8> = (1..=6).flat_map(|face| [face; 12]).collect();
    let cube = load(&format!("name=\"t\" {files}")).unwrap();
    assert_eq!(pixels(&cube, 0), faces);
    // some of them
    let cube = load(r#"name="t" fileback="back.png" fileleft="left.png" rgb1="0 0 0""#).unwrap();
    let faces: Vec<u8> = [0, 2, 0, 0, 0, 6]
        .into_iter()
        .flat_map(|face| [face; 12])
        .collect();
    assert_eq!(pixels(&cube, 0), faces);
    // all of one size
    let large = png(png::ColorType::Grayscale, 3, &[9; 6]);
    fs::write(folder.path().join("images/large.png"), large).unwrap();
    let error = load(r#"name="t" fileleft="left.png" fileback="large.png""#).unwrap_err();
    let error = error.to_string();
    assert!(
        error.contains("a face of 3x2 pixels, not of 2x2"),
        "{error}"
    );
}

#[test]
fn damaged_textures_are_refused() {
    let text = textured(r#"name="t" type="2d" builtin="flat" width="4" height="3""#);
    let m = Model::from_xml(&text).unwrap();
    let refuses = |change: fn(&mut mujoco_engine::CompiledModel), words: &str| {
        let mut compiled = m.clone().into_compiled();
        change(&mut compiled);
        let error = Model::new(compiled).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    refuses(|m| m.mat_texid[0] = 1, "mat_texid[0]");
    refuses(|m| m.textures.tex_width[0] = usize::MAX, "texture 0");
    refuses(|m| m.textures.tex_data.truncate(9), "texture 0");
    refuses(|m| m.textures.tex_data.push(0), "tex_data");
    refuses(|m| m.textures.tex_nchannel[0] = 2, "tex_nchannel[0]");
    refuses(|m| m.textures.tex_adr.clear(), "tex_adr");
    let text = serde_json::to_string(&m).unwrap();
    let again: Model = serde_json::from_str(&text).unwrap();
    assert_eq!(again.textures, m.textures);
}
