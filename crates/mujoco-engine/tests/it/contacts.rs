//! Contacts of geoms in random poses (most of them touch), compared with libmujoco's to the last
//! bit. `recorded/contacts/record.py` describes the poses, and recorded the contacts.

use std::collections::{BTreeMap, BTreeSet};

use gym_numerics::RandomState;
use mujoco_engine::{Data, Model, forward};

use super::digest::Digest;

const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
const TURNS: [[f64; 4]; 6] = [
    [1.0, 0.0, 0.0, 0.0],
    [HALF, HALF, 0.0, 0.0],
    [HALF, 0.0, HALF, 0.0],
    [HALF, 0.0, 0.0, HALF],
    [0.0, 1.0, 0.0, 0.0],
    [0.5, 0.5, 0.5, 0.5],
];
const LENGTHS: [f64; 6] = [0.0, 0.05, 0.1, 0.125, 0.2, 0.07];

fn one_of<T: Copy>(random: &mut RandomState, values: &[T; 6]) -> T {
    values[random.uniform(0.0, 6.0) as usize]
}

fn turn(random: &mut RandomState) -> [f64; 4] {
    if random.uniform(0.0, 1.0) < 0.7 {
        return one_of(random, &TURNS);
    }
    let quat: [f64; 4] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
    let [w, x, y, z] = quat;
    let length = (w * w + x * x + y * y + z * z).sqrt();
    quat.map(|x| x / length)
}

fn place(random: &mut RandomState) -> f64 {
    let [mut first, mut second] = [(); 2].map(|()| one_of(random, &LENGTHS));
    for length in [&mut first, &mut second] {
        if random.uniform(0.0, 1.0) < 0.5 {
            *length = -*length;
        }
    }
    let noise = if random.uniform(0.0, 1.0) < 0.3 {
        random.uniform(-0.1, 0.1)
    } else {
        0.0
    };
    first + second + noise
}

fn turned([w, x, y, z]: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let (tx, ty, tz) = (
        2.0 * (y * v[2] - z * v[1]),
        2.0 * (z * v[0] - x * v[2]),
        2.0 * (x * v[1] - y * v[0]),
    );
    [
        v[0] + w * tx + (y * tz - z * ty),
        v[1] + w * ty + (z * tx - x * tz),
        v[2] + w * tz + (x * ty - y * tx),
    ]
}

fn product(p: [f64; 4], q: [f64; 4]) -> [f64; 4] {
    [
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    ]
}

fn pose(random: &mut RandomState) -> Vec<f64> {
    let quat = turn(random);
    let mut centre = [0.0; 3];
    let spot: [f64; 3] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
    if random.uniform(0.0, 1.0) < 0.5 {
        centre = spot;
    }
    let away = turned(quat, std::array::from_fn(|_| place(random)));
    let other = product(quat, turn(random));
    let beside: [f64; 3] = std::array::from_fn(|k| centre[k] + away[k]);
    [&centre[..], &quat, &beside, &other].concat()
}

/// Returns the contacts' numbers, with 0 instead of -0.
fn words(d: &Data) -> Vec<u64> {
    let of = |contact: &mujoco_engine::Contact| {
        let geoms = contact.geom.map(|g| g as u64);
        let numbers = std::iter::once(&contact.dist)
            .chain(&contact.pos)
            .chain(&contact.frame);
        let bits = numbers.map(|x| (x + 0.0).to_bits());
        geoms.into_iter().chain(bits).collect::<Vec<_>>()
    };
    let count = d.contact.len() as u64;
    std::iter::once(count)
        .chain(d.contact.iter().flat_map(of))
        .collect()
}

/// Returns a digest of the contacts; adds the kinds of the geoms that touch to `kinds`.
fn digest(m: &Model, seed: u32, poses: usize, kinds: &mut BTreeSet<[String; 2]>) -> u64 {
    let (mut random, mut d) = (RandomState::new(seed), Data::new(m));
    let mut digest = Digest::default();
    for _ in 0..poses {
        d.qpos = pose(&mut random);
        forward(m, &mut d);
        words(&d).into_iter().for_each(|word| digest.word(word));
        for contact in &d.contact {
            kinds.insert(contact.geom.map(|geom| format!("{:?}", m.geom_type[geom])));
        }
    }
    digest.0
}

#[test]
fn contacts_are_libmujocos() {
    let more =
        std::env::var_os("GYM_MUJOCO_CONTACTS").map(|path| std::fs::read_to_string(path).unwrap());
    let text = concat!(
        include_str!("../recorded/contacts/3.12.txt"),
        include_str!("../recorded/contacts/4.0.txt"),
        include_str!("../recorded/contacts/3.17.txt"),
        include_str!("../recorded/contacts/pairs.txt")
    );
    let (mut models, mut kinds) = (BTreeMap::new(), BTreeSet::new());
    let (mut compared, mut unlike) = (0, Vec::new());
    let lines = text.lines();
    for line in lines.chain(more.as_deref().unwrap_or_default().lines()) {
        let (name, rest) = line.split_once(' ').unwrap();
        if rest.starts_with('<') {
            models.insert(name, rest);
            continue;
        }
        let [version, seed, poses, expected] = rest.split(' ').collect::<Vec<_>>()[..] else {
            panic!("{line}");
        };
        let m = Model::from_xml_with(models[name], version.parse().unwrap()).unwrap();
        let (seed, poses) = (seed.parse().unwrap(), poses.parse().unwrap());
        let found = digest(&m, seed, poses, &mut kinds);
        if format!("{found:016x}") != expected {
            unlike.push(line);
        }
        compared += 1;
    }
    assert!(
        unlike.is_empty(),
        "{} of {compared}: {unlike:#?}",
        unlike.len()
    );
    assert!(compared >= 100);
    let moving = ["Sphere", "Capsule", "Ellipsoid", "Cylinder", "Box", "Mesh"];
    for (i, first) in ["Plane", "Hfield"].iter().chain(&moving).enumerate() {
        for second in &moving[i.saturating_sub(2)..] {
            let pair = [*first, *second].map(str::to_owned);
            assert!(kinds.contains(&pair), "no contact of {pair:?}");
        }
    }
}
