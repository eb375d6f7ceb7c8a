//! Expected graphs are those of Qhull at commit d1c2fc0c, called as MuJoCo calls it.

use super::samples::{KINDS, Random, digest, points};
use super::{HullError, MOST_POINTS, convex_hull};

fn lattice(steps: usize) -> Vec<[f64; 3]> {
    let coordinates = |i: usize| [i % steps, i / steps % steps, i / steps / steps];
    (0..steps * steps * steps)
        .map(|i| coordinates(i).map(|x| x as f64))
        .collect()
}

fn graph(points: &[[f64; 3]], most: Option<u32>) -> Vec<i32> {
    convex_hull(points, most).unwrap().to_integers()
}

#[test]
fn a_cube_has_qhulls_order() {
    #[rustfmt::skip]
    let expected = [
        8, 12,
        0, 7, 11, 18, 22, 29, 33, 37,
        3, 2, 0, 1, 5, 4, 7, 6,
        1, 2, 3, 4, 6, 7, -1, 0, 2, 7, -1, 0, 1, 3, 4, 5, 7, -1, 0, 2, 4, -1,
        3, 2, 5, 0, 6, 7, -1, 4, 2, 7, -1, 4, 0, 7, -1, 1, 2, 5, 0, 6, 4, -1,
        2, 3, 0, 3, 1, 0, 1, 5, 0, 5, 4, 0, 3, 5, 1, 5, 3, 7,
        6, 2, 0, 4, 6, 0, 6, 3, 2, 3, 6, 7, 5, 6, 4, 6, 5, 7,
    ];
    assert_eq!(graph(&lattice(2), None), expected);
}

#[test]
fn points_within_edges_and_faces_are_no_vertices() {
    let cube = convex_hull(&lattice(2), None).unwrap();
    let lattice = convex_hull(&lattice(3), None).unwrap();
    assert_eq!(lattice.points, [8, 6, 0, 2, 20, 18, 26, 24]);
    assert_eq!(lattice.edges, cube.edges);
}

#[test]
fn at_most_so_many_vertices() {
    let octahedron = [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    #[rustfmt::skip]
    let all = [
        6, 8, 0, 5, 10, 15, 20, 25, 3, 2, 5, 0, 1, 4,
        2, 4, 3, 5, -1, 2, 3, 4, 5, -1, 0, 3, 4, 1, -1, 5, 0, 2, 1, -1, 5, 0, 2, 1, -1, 0, 3, 4, 1, -1,
        5, 3, 1, 3, 5, 0, 3, 4, 1, 4, 3, 0, 5, 2, 0, 2, 5, 1, 2, 4, 0, 4, 2, 1,
    ];
    #[rustfmt::skip]
    let five = [
        5, 6, 0, 5, 10, 15, 19, 3, 4, 5, 0, 1,
        2, 4, 3, 1, -1, 0, 4, 3, 2, -1, 0, 4, 3, 1, -1, 2, 0, 1, -1, 2, 0, 1, -1,
        5, 3, 1, 3, 5, 0, 3, 4, 1, 4, 3, 0, 5, 4, 0, 4, 5, 1,
    ];
    assert_eq!(graph(&octahedron, None), all);
    assert_eq!(graph(&octahedron, Some(6)), all);
    assert_eq!(graph(&octahedron, Some(5)), five);
}

#[test]
fn a_point_just_above_a_face_is_a_vertex() {
    let (low, high) = (-1.0, 1e-14);
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.5, 0.5, high],
        [0.5, 0.5, low],
    ];
    #[rustfmt::skip]
    let expected = [
        6, 8, 0, 5, 10, 15, 20, 25, 5, 4, 2, 1, 0, 3,
        3, 4, 2, 5, -1, 2, 3, 4, 5, -1, 5, 0, 3, 1, -1, 0, 2, 4, 1, -1, 5, 0, 3, 1, -1, 0, 2, 4, 1, -1,
        5, 1, 0, 5, 2, 1, 3, 5, 0, 5, 3, 2, 2, 4, 1, 1, 4, 0, 3, 4, 2, 4, 3, 0,
    ];
    assert_eq!(graph(&points, None), expected);
}

/// For each kind of samples, how many of 25 sets Qhull refuses, and the digest of its graphs'.
const QHULL: [(usize, u64); KINDS as usize] = [
    (0, 0x50cc_d73d_655d_e3f0),
    (0, 0x8cda_6897_0b18_0821),
    (0, 0xe221_8d45_438d_5b12),
    (0, 0x4d4a_8608_a651_f3cf),
    (2, 0x94af_a697_e4f4_50aa),
    (13, 0x30e3_d308_2280_4761),
    (0, 0xb8f3_d82a_d50c_4d0c),
    (0, 0x1930_5b98_986e_a7b8),
    (5, 0x9688_89ca_2b34_ba0e),
    (0, 0x5817_107e_392a_84dd),
    (0, 0x9231_0b35_f952_edc8),
    (0, 0xa388_c0b0_ed1f_7e00),
];

#[test]
fn three_hundred_sets_have_qhulls_graphs() {
    for (kind, expected) in (0..KINDS).zip(QHULL) {
        let mut refused = 0;
        let mut digests = Vec::new();
        for seed in 0..25 {
            let points = points(kind, &mut Random(1000 * kind + seed));
            let most = (seed % 8 == 7).then_some(4 + seed as u32);
            let digest = convex_hull(&points, most).map_or(0, |graph| digest(&graph.to_integers()));
            refused += usize::from(digest == 0);
            digests.extend([digest as i32, (digest >> 32) as i32]);
        }
        assert_eq!((refused, digest(&digests)), expected, "kind {kind}");
    }
}

#[test]
fn bad_sets_are_refused() {
    let error = |points: &[[f64; 3]], most| convex_hull(points, most).unwrap_err();
    assert_eq!(error(&[], None), HullError::TooFew(0));
    assert_eq!(error(&lattice(2)[..3], None), HullError::TooFew(3));
    assert_eq!(error(&lattice(2), Some(3)), HullError::MaxVertices(3));
    let too_many = vec![[0.0; 3]; MOST_POINTS + 1];
    let most = MOST_POINTS;
    assert_eq!(
        error(&too_many, None),
        HullError::TooMany {
            found: most + 1,
            most
        }
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e71] {
        let mut points = lattice(2);
        points[5][1] = bad;
        assert_eq!(error(&points, None), HullError::NotFinite(5));
    }
    let flat: [fn(f64) -> [f64; 3]; 5] = [
        |_| [1.0, 2.0, 3.0],
        |t| [t, 2.0 * t, 3.0 * t],
        |t| [t, t * t, 0.0],
        |t| [t, t * t, t + t * t],
        |t| [0.0, t, t * t],
    ];
    for of in flat {
        let points: Vec<[f64; 3]> = (0..50).map(|i| of(f64::from(i) / 7.0)).collect();
        assert_eq!(error(&points, None), HullError::Flat);
    }
}

/// Sets that no mesh has: every one gives a graph or an error, and a graph is closed.
#[test]
fn hostile_sets_neither_panic_nor_hang() {
    let special = [
        0.0,
        -0.0,
        1.0,
        1e-300,
        5e-324,
        1e69,
        -1e69,
        1e-16,
        f64::NAN,
        f64::INFINITY,
    ];
    for seed in 0..3000 {
        let random = &mut Random(seed);
        let kind = random.below(KINDS);
        let mut points = points(kind, random);
        let scale = special[random.below(8) as usize];
        for point in &mut points {
            for x in point.iter_mut() {
                match random.below(200) {
                    0 => *x = special[random.below(if seed % 4 == 0 { 10 } else { 8 }) as usize],
                    1 => *x *= scale,
                    _ => {}
                }
            }
        }
        for _ in 0..random.below(4) {
            let copy = points[random.below(points.len() as u64) as usize];
            points.push(copy);
        }
        let most = (random.below(4) == 0).then(|| 4 + random.below(10) as u32);
        let Ok(graph) = convex_hull(&points, most) else {
            continue;
        };
        assert_eq!(graph.faces.len(), 2 * graph.points.len() - 4, "seed {seed}");
        assert!(
            graph
                .edges
                .iter()
                .all(|&i| i >= -1 && i < graph.points.len() as i32)
        );
        assert!(
            graph
                .faces
                .iter()
                .flatten()
                .all(|i| graph.points.contains(i)),
            "seed {seed}"
        );
        let neighbors: Vec<&[i32]> = graph.edges.split(|&i| i == -1).collect();
        for (v, list) in graph
            .points
            .iter()
            .zip(0..)
            .map(|(_, v)| (v, neighbors[v as usize]))
        {
            assert!(
                list.iter().all(|&u| neighbors[u as usize].contains(&v)),
                "seed {seed}"
            );
        }
    }
}
