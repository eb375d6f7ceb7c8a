//! Wavefront OBJ, as MuJoCo reads it with tinyobjloader: its numbers, its order, its way to cut
//! polygons.

use super::error::MeshError;
use super::polygon::{Corner, Cutter};
use super::source::{Format, MOST_CORNERS, Source};
use crate::Revision;
use crate::compile::hull::MOST_POINTS;
use crate::math::libm;

/// Reads the vertices of the whole file and the faces of its first object or group that has any.
///
/// Lines of other kinds, materials and smoothing groups are ignored. Texture coordinates are turned
/// upside down.
pub(super) fn read(bytes: &[u8], revision: Revision) -> Result<Source, MeshError> {
    let mut reader = Reader {
        revision,
        ..Reader::default()
    };
    for (i, line) in lines(bytes).enumerate() {
        reader.number = i + 1;
        reader.line(line)?;
        let vertices = reader.source.vertices.len() / 3;
        if vertices > MOST_POINTS {
            return Err(MeshError::TooMany {
                what: "vertices",
                found: vertices,
                most: MOST_POINTS,
            });
        }
    }
    reader.finish()
}

/// Lines end with a line feed, a carriage return, or both.
fn lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let end = rest
            .iter()
            .position(|&b| b == b'\n' || b == b'\r')
            .unwrap_or(rest.len());
        let line = &rest[..end];
        let ending = if rest[end..].starts_with(b"\r\n") {
            2
        } else {
            1
        };
        rest = rest.get(end + ending..).unwrap_or_default();
        // a zero byte ends it for a C program
        Some(&line[..line.iter().position(|&b| b == 0).unwrap_or(line.len())])
    })
}

/// The triangles and the lines of an object or group.
#[derive(Debug)]
struct Shape {
    triangles: Vec<[Corner; 3]>,
    lines: Vec<Vec<Corner>>,
}

#[derive(Debug, Default)]
struct Reader {
    revision: Revision,
    source: Source,
    /// The line, from 1.
    number: usize,
    /// Polygons since the last object or group.
    faces: Vec<Vec<Corner>>,
    lines: Vec<Vec<Corner>>,
    points: bool,
    /// The corners of all polygons, lines and points so far.
    corners: usize,
    /// The first object or group that has any.
    first: Option<Shape>,
    cutter: Cutter,
}

impl Reader {
    fn line(&mut self, line: &[u8]) -> Result<(), MeshError> {
        let line = after_spaces(line);
        let keyword = |word: &[u8]| -> Option<Line<'_>> {
            let rest = line.strip_prefix(word)?;
            matches!(rest.first(), Some(b' ' | b'\t')).then(|| Line(&rest[1..]))
        };
        if let Some(mut rest) = keyword(b"v") {
            let vertex = [rest.number(), rest.number(), rest.number()];
            self.source.vertices.extend(vertex);
        } else if let Some(mut rest) = keyword(b"vn") {
            let normal = [rest.number(), rest.number(), rest.number()];
            self.source.normals.extend(normal);
        } else if let Some(mut rest) = keyword(b"vt") {
            let coordinates = [rest.number(), rest.number()];
            self.source.texture.extend(coordinates);
        } else if let Some(rest) = keyword(b"f") {
            let corners = self.corners(rest)?;
            self.faces.push(corners);
        } else if let Some(rest) = keyword(b"l") {
            let corners = self.corners(rest)?;
            self.lines.push(corners);
        } else if let Some(rest) = keyword(b"p") {
            self.corners(rest)?;
            self.points = true;
        } else if keyword(b"g").is_some() {
            self.end_shape(false)?;
        } else if keyword(b"o").is_some() {
            self.end_shape(true)?;
        }
        Ok(())
    }

    fn corners(&mut self, mut rest: Line<'_>) -> Result<Vec<Corner>, MeshError> {
        let counts = [
            &self.source.vertices,
            &self.source.texture,
            &self.source.normals,
        ];
        let [vertices, texture, normals] = counts.map(Vec::len);
        let mut corners = Vec::new();
        rest.0 = after_spaces(rest.0);
        while !rest.0.is_empty() {
            let corner = rest.corner([vertices / 3, texture / 2, normals / 3], self.revision);
            corners.push(corner.map_err(|fault| MeshError::Line {
                line: self.number,
                fault,
            })?);
        }
        self.corners += corners.len();
        if self.corners > MOST_CORNERS {
            let found = self.corners;
            return Err(MeshError::TooMany {
                what: "corners of faces",
                found,
                most: MOST_CORNERS,
            });
        }
        Ok(corners)
    }

    /// Ends an object or group. It is kept if it has faces; an `object`, also if it has lines or
    /// points.
    fn end_shape(&mut self, object: bool) -> Result<(), MeshError> {
        let faces = std::mem::take(&mut self.faces);
        let lines = std::mem::take(&mut self.lines);
        let points = std::mem::take(&mut self.points);
        if self.first.is_some() {
            return Ok(());
        }
        let mut triangles = Vec::new();
        for face in faces {
            self.cutter
                .cut(&self.source.vertices, face, self.revision, &mut triangles)?;
        }
        if !triangles.is_empty()
            || (object && (points || lines.iter().any(|line| !line.is_empty())))
        {
            self.first = Some(Shape { triangles, lines });
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Source, MeshError> {
        self.end_shape(true)?;
        let mut source = self.source;
        source.format = Some(Format::Obj);
        if let Some(Shape { triangles, lines }) = self.first {
            let corners: Vec<Corner> = if triangles.is_empty() {
                // a line is a triangle without area
                lines
                    .iter()
                    .flat_map(|line| line.windows(2))
                    .flat_map(|ends| [ends[0], ends[1], ends[1]])
                    .collect()
            } else {
                triangles.into_iter().flatten().collect()
            };
            source.faces = corners.iter().map(|corner| corner.vertex).collect();
            if !source.normals.is_empty() {
                source.face_normals = corners.iter().map(|corner| corner.normal).collect();
            }
            if !source.texture.is_empty() {
                source.face_texture = corners.iter().map(|corner| corner.texture).collect();
            }
        }
        for coordinates in source.texture.chunks_exact_mut(2) {
            coordinates[1] = 1.0 - coordinates[1];
        }
        Ok(source)
    }
}

fn after_spaces(line: &[u8]) -> &[u8] {
    let spaces = line
        .iter()
        .take_while(|b| matches!(b, b' ' | b'\t'))
        .count();
    &line[spaces..]
}

/// The rest of a line.
#[derive(Clone, Copy, Debug)]
struct Line<'a>(&'a [u8]);

impl Line<'_> {
    /// The next word as a number; 0 if it is none or there is none.
    fn number(&mut self) -> f32 {
        let rest = after_spaces(self.0);
        let end = rest
            .iter()
            .position(|b| matches!(b, b' ' | b'\t'))
            .unwrap_or(rest.len());
        self.0 = &rest[end..];
        parse_number(&rest[..end]).unwrap_or(0.0) as f32
    }

    /// `vertex`, `vertex/texture`, `vertex//normal` or `vertex/texture/normal`, from 1; negative from
    /// the end. From 4.0 on, texture and normal may be 0: none.
    fn corner(
        &mut self,
        [vertices, texture, normals]: [usize; 3],
        revision: Revision,
    ) -> Result<Corner, &'static str> {
        let optional = revision.takes_corner_zero();
        let mut corner = Corner {
            vertex: self.index(vertices, false)?,
            texture: -1,
            normal: -1,
        };
        if self.skip_slash() {
            if self.skip_slash() {
                corner.normal = self.index(normals, optional)?;
            } else {
                corner.texture = self.index(texture, optional)?;
                if self.skip_slash() {
                    corner.normal = self.index(normals, optional)?;
                }
            }
        }
        self.0 = after_spaces(self.0);
        Ok(corner)
    }

    fn skip_slash(&mut self) -> bool {
        match self.0.strip_prefix(b"/") {
            Some(rest) => {
                self.0 = rest;
                true
            }
            None => false,
        }
    }

    /// An index up to the next slash or space, counted from 0.
    fn index(&mut self, count: usize, optional: bool) -> Result<i32, &'static str> {
        let ends = |b: &u8| matches!(b, b'/' | b' ' | b'\t');
        let end = self.0.iter().position(ends).unwrap_or(self.0.len());
        let (word, rest) = self.0.split_at(end);
        self.0 = rest;
        match parse_integer(word) {
            0 if optional => Ok(-1),
            0 => Err("an index is 0, or no number; they begin with 1"),
            index if index > 0 => Ok(index - 1),
            index => Ok(index.saturating_add(i32::try_from(count).unwrap_or(i32::MAX))),
        }
    }
}

/// `atoi`: spaces, a sign, digits; 0 if there are none.
fn parse_integer(word: &[u8]) -> i32 {
    let word = word.trim_ascii_start();
    let (negative, digits) = match word.first() {
        Some(b'-') => (true, &word[1..]),
        Some(b'+') => (false, &word[1..]),
        _ => (false, word),
    };
    let mut value = 0i64;
    for digit in digits.iter().take_while(|b| b.is_ascii_digit()) {
        value = (10 * value + i64::from(digit - b'0')).min(i64::from(i32::MAX));
    }
    (if negative { -value } else { value }) as i32
}

/// A decimal number with tinyobjloader's rounding: digit by digit, so its last bits are often not
/// those of the nearest number.
fn parse_number(word: &[u8]) -> Option<f64> {
    const TENTHS: [f64; 8] = [1.0, 0.1, 0.01, 0.001, 0.0001, 0.00001, 0.000001, 0.0000001];
    let mut rest = word;
    let sign = match rest.first()? {
        b'-' => -1.0,
        _ => 1.0,
    };
    let signed = matches!(rest[0], b'+' | b'-');
    if signed {
        rest = &rest[1..];
    }
    let mut mantissa = 0.0;
    let digit = |rest: &[u8]| {
        rest.first()
            .filter(|b| b.is_ascii_digit())
            .map(|b| f64::from(b - b'0'))
    };
    if rest.first() != Some(&b'.') {
        digit(rest)?;
        while let Some(value) = digit(rest) {
            mantissa *= 10.0;
            mantissa += value;
            rest = &rest[1..];
        }
    }
    match rest.first() {
        None => return Some(sign * mantissa),
        Some(b'.') => {
            rest = &rest[1..];
            let mut place = 1;
            while let Some(value) = digit(rest) {
                mantissa += value
                    * TENTHS
                        .get(place)
                        .copied()
                        .unwrap_or_else(|| libm::pow(10.0, -(place as f64)));
                place += 1;
                rest = &rest[1..];
            }
        }
        Some(b'e' | b'E') => {}
        Some(_) => return Some(sign * mantissa),
    }
    if !matches!(rest.first(), Some(b'e' | b'E')) {
        return Some(sign * mantissa);
    }
    rest = &rest[1..];
    let mut negative = false;
    if let Some(b'+' | b'-') = rest.first() {
        negative = rest[0] == b'-';
        rest = &rest[1..];
    }
    digit(rest)?;
    let mut exponent = 0i32;
    while let Some(value) = digit(rest) {
        exponent = exponent.saturating_mul(10).saturating_add(value as i32);
        rest = &rest[1..];
    }
    if negative {
        exponent = -exponent;
    }
    if exponent == 0 {
        return Some(sign * mantissa);
    }
    let scaled = mantissa * libm::pow(5.0, f64::from(exponent));
    Some(sign * times_power_of_2(scaled, exponent))
}

/// `ldexp`, rounded once: a result below the normal numbers is rounded by the last product alone.
fn times_power_of_2(mut x: f64, mut exponent: i32) -> f64 {
    let power = |exponent: i32| f64::from_bits(((1023 + exponent) as u64) << 52);
    for _ in 0..2 {
        if exponent > 1023 {
            x *= power(1023);
            exponent -= 1023;
        } else if exponent < -1022 {
            x *= power(-1022 + 53);
            exponent += 1022 - 53;
        }
    }
    x * power(exponent.clamp(-1022, 1023))
}
