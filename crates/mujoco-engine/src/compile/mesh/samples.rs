//! Made meshes for tests, from a number: points alone, blocks of quadrilaterals, wedges.

use super::{Format, Inertia, Options};
use crate::compile::hull::samples::{Random, points};

/// A mesh file and how to compile it.
pub(crate) fn made(number: u64) -> (Format, Vec<u8>, Options) {
    let random = &mut Random(number);
    let options = options(number, random);
    match number % 3 {
        0 => {
            let kind = [0, 1, 2, 3, 7, 9, 11][random.below(7) as usize];
            let points: Vec<[f32; 3]> = points(kind, random)
                .into_iter()
                .map(|p| p.map(|x| x as f32))
                .collect();
            (Format::Msh, msh(&points), options)
        }
        1 => (Format::Obj, block(random).into_bytes(), options),
        _ => (Format::Stl, wedges(random), options),
    }
}

fn options(number: u64, random: &mut Random) -> Options {
    let mut options = Options::default();
    if number % 4 == 1 {
        options.scale = [0.1, 0.25, 1.5];
        options.smooth = true;
    }
    if number % 4 >= 2 {
        options.position = [random.signed(), 0.5, random.signed()];
        options.orientation = [1.0, random.signed(), 0.25, random.signed()];
        options.inertia = [
            Inertia::Legacy,
            Inertia::Exact,
            Inertia::Shell,
            Inertia::Convex,
        ][number as usize / 4 % 4];
    }
    if number % 5 == 4 {
        options.max_hull_vertices = Some(6);
    }
    if number % 7 == 6 {
        options.scale[2] = -options.scale[2];
    }
    options
}

/// Vertices alone.
pub(super) fn msh(points: &[[f32; 3]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for count in [points.len() as i32, 0, 0, 0] {
        bytes.extend(count.to_le_bytes());
    }
    bytes.extend(points.iter().flatten().flat_map(|x| x.to_le_bytes()));
    bytes
}

/// A box of bent quadrilaterals and hexagons.
fn block(random: &mut Random) -> String {
    let mut text = String::from("# a block\r\no block\nvn 0 0 1\n");
    let mut at = |x: f64, y: f64, z: f64| {
        let [a, b, c] = [(); 3].map(|()| random.signed() / 16.0);
        text += &format!("v {:.6} {:.9} {:e}\n", x + a, y + b, z + c);
    };
    for z in [0.0, 1.5] {
        for (x, y) in [
            (0.0, 0.0),
            (1.0, -0.5),
            (2.0, 0.0),
            (2.0, 1.0),
            (1.0, 1.5),
            (0.0, 1.0),
        ] {
            at(x, y, z);
        }
    }
    text += "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n";
    for i in 0..6 {
        let j = (i + 1) % 6;
        text += &format!("f {} {} {} -{}\n", i + 1, j + 1, j + 7, 6 - i);
    }
    text.replace("vn 0 0 1\n", "")
}

/// Tetrahedra that have no faces in common.
fn wedges(random: &mut Random) -> Vec<u8> {
    let mut triangles: Vec<[[f32; 3]; 3]> = Vec::new();
    for i in 0..1 + random.below(4) {
        let mut corner = |x: f64, y: f64, z: f64| {
            let [a, b, c] = [(); 3].map(|()| random.signed() / 8.0);
            [(x + a + i as f64) as f32, (y + b) as f32, (z + c) as f32]
        };
        let [o, x, y, z] = [
            corner(0.0, 0.0, 0.0),
            corner(1.0, 0.0, 0.0),
            corner(0.0, 1.0, 0.0),
            corner(0.0, 0.0, 1.0),
        ];
        triangles.extend([[o, y, x], [o, x, z], [o, z, y], [x, y, z]]);
    }
    stl(&triangles)
}

/// Binary STL.
pub(super) fn stl(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}
