//! Made sets of points for tests, from a seed, without transcendental functions: lattices, noise
//! about planes and points, needles, lenses, duplicates.

/// SplitMix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % n
    }

    /// Between -1 and 1.
    pub(crate) fn signed(&mut self) -> f64 {
        self.below(1 << 53) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A negative power of ten, from 10^-`least` to 10^-`most`.
    fn tiny(&mut self, least: u64, most: u64) -> f64 {
        let mut x = 1.0;
        for _ in 0..least + self.below(most - least + 1) {
            x /= 10.0;
        }
        x
    }

    fn point(&mut self) -> [f64; 3] {
        [self.signed(), self.signed(), self.signed()]
    }

    fn unit(&mut self) -> [f64; 3] {
        loop {
            let v = self.point();
            let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            if (0.01..1.0).contains(&square) {
                return v.map(|x| x / square.sqrt());
            }
        }
    }
}

/// The number of kinds that [`points`] knows.
pub(crate) const KINDS: u64 = 12;

/// A set of points of a kind.
pub(crate) fn points(kind: u64, random: &mut Random) -> Vec<[f64; 3]> {
    let most = if random.below(2) == 0 { 20 } else { 150 };
    let n = 4 + random.below(most);
    let steps = 2 + random.below(4);
    let tiny = random.tiny(0, 16);
    let noise = random.tiny(8, 16);
    let base: Vec<[f64; 3]> = (0..4 + random.below(8)).map(|_| random.point()).collect();
    let turn = turn(random);
    (0..n)
        .map(|_| {
            let lattice = [(); 3].map(|()| random.below(steps) as f64);
            let p = random.point();
            match kind {
                0 => p,
                1 => random.unit(),
                2 => lattice,
                3 => turned(&turn, lattice),
                4 => [p[0], p[1], p[2] * tiny],
                5 => [p[0], p[1] * tiny, p[2] * noise],
                6 => {
                    let near = base[random.below(base.len() as u64) as usize];
                    [0, 1, 2].map(|k| near[k] + p[k] * noise)
                }
                7 => {
                    let mut face = p;
                    let k = random.below(3) as usize;
                    face[k] = if random.below(2) == 0 { 1.0 } else { -1.0 };
                    [0, 1, 2].map(|k| face[k] + p[k] * noise)
                }
                8 => {
                    let cap = (1.0 - (p[0] * p[0] + p[1] * p[1]) / 2.0) * tiny;
                    [p[0], p[1], if random.below(2) == 0 { cap } else { -cap }]
                }
                9 => random.unit().map(|x| (x * 64.0).round() / 64.0),
                10 => {
                    let lattice = turned(&turn, lattice);
                    [0, 1, 2].map(|k| lattice[k] + p[k] * noise)
                }
                _ => turned(&turn, [lattice[0], lattice[1], p[2].signum()])
                    .map(|x| f64::from(x as f32)),
            }
        })
        .collect()
}

/// A rotation.
fn turn(random: &mut Random) -> [[f64; 3]; 3] {
    let x = random.unit();
    let y = random.unit();
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let z = cross(x, y);
    let length = (z[0] * z[0] + z[1] * z[1] + z[2] * z[2]).sqrt();
    if length < 1e-3 {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    }
    let z = z.map(|z| z / length);
    [x, cross(z, x), z]
}

fn turned(turn: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    turn.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// FNV-1a of integers.
pub(crate) fn digest(integers: &[i32]) -> u64 {
    integers
        .iter()
        .flat_map(|i| i.to_le_bytes())
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
}
