//! Height fields: their elevations, from the text, a picture or a file in MuJoCo's format, and the
//! checks of their arrays.

use std::collections::HashSet;
use std::io::Cursor;

use png::{Decoder, Limits, Transformations};

use super::check::{same, same_length};
use super::values::finite;
use crate::Result;
use crate::error::ensure;
use crate::math::spatial::EPS;
use crate::mjcf::spec::{Hfield, Spec};
use crate::mjcf::store::Assets;
use crate::model::{CompiledModel, GeomType, Hfields};

/// The most bytes of a decoded picture.
const MOST_PIXELS: usize = 256 << 20;

/// Rows, columns and elevations, row by row from the least y.
type Grid = (usize, usize, Vec<f32>);

/// Adds the height fields.
pub(super) fn add_hfields(
    m: &mut CompiledModel,
    spec: &Spec,
    assets: &mut Assets<'_>,
) -> Result<()> {
    let mut names = HashSet::new();
    let all = &mut *m.hfields;
    for field in &spec.hfields {
        let (place, name) = (&field.place, &*field.name);
        if !names.insert(name) {
            let reason = format!("there is a height field {name:?} already");
            return Err(place.attribute("name", reason));
        }
        let (rows, columns, mut elevations) = match &field.path {
            None => (field.rows, field.columns, field.elevations.clone()),
            Some(path) => {
                let bytes = assets.read(path);
                let grid = bytes.and_then(|bytes| read(field, &bytes));
                grid.map_err(|reason| {
                    place.attribute("file", format!("{}: {reason}", path.display()))
                })?
            }
        };
        elevations.resize(rows * columns, 0.0);
        spread(&mut elevations);
        all.hfield_size.push(field.size);
        all.hfield_nrow.push(rows);
        all.hfield_ncol.push(columns);
        all.hfield_adr.push(all.hfield_data.len());
        all.hfield_data.append(&mut elevations);
    }
    Ok(())
}

/// Moves the elevations to 0 to 1.
fn spread(elevations: &mut [f32]) {
    let least = elevations.iter().fold(1e10, |least, x| f32::min(least, *x));
    let most = elevations.iter().fold(-1e10, |most, x| f32::max(most, *x));
    for x in elevations {
        *x -= least;
        if f64::from(most - least) > EPS {
            *x /= most - least;
        }
    }
}

/// Reads a file: a picture in the format PNG, or else in MuJoCo's format.
fn read(field: &Hfield, bytes: &[u8]) -> Result<Grid, String> {
    let kind = field.content_type.as_deref().map(str::to_ascii_lowercase);
    let extension = field.path.as_deref().and_then(|path| path.extension());
    let named = extension.is_some_and(|name| name.eq_ignore_ascii_case("png"));
    match kind.as_deref() {
        Some("image/png") => picture(bytes),
        None if named => picture(bytes),
        None | Some("image/vnd.mujoco.hfield") => binary(bytes),
        Some(kind) => Err(format!(
            "{kind:?} is no format of height fields: use image/png or image/vnd.mujoco.hfield"
        )),
    }
}

/// Two integers, the numbers of rows and columns, and the elevations in single precision.
fn binary(bytes: &[u8]) -> Result<Grid, String> {
    let (words, rest) = bytes.as_chunks::<4>();
    let Some(([rows, columns], words)) = words.split_first_chunk() else {
        return Err("the numbers of rows and columns are missing".to_owned());
    };
    let [rows, columns] = [rows, columns].map(|word| i32::from_le_bytes(*word).max(0) as usize);
    if words.is_empty() || !rest.is_empty() || rows.checked_mul(columns) != Some(words.len()) {
        return Err(format!(
            "{rows} rows and {columns} columns do not fit {} bytes of elevations",
            bytes.len() - 8
        ));
    }
    let elevations = words.iter().map(|word| f32::from_le_bytes(*word));
    Ok((rows, columns, elevations.collect()))
}

/// The first channel of a picture, whose first row has the greatest y.
fn picture(bytes: &[u8]) -> Result<Grid, String> {
    let limits = Limits { bytes: MOST_PIXELS };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::EXPAND | Transformations::STRIP_16);
    let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
    let size = reader
        .output_buffer_size()
        .filter(|size| *size <= MOST_PIXELS);
    let size = size.ok_or("the picture is too large")?;
    let mut pixels = vec![0; size];
    let info = reader
        .next_frame(&mut pixels)
        .map_err(|error| error.to_string())?;
    let (rows, columns) = (info.height as usize, info.width as usize);
    let channels = info.color_type.samples();
    let lines = pixels[..info.buffer_size()].rchunks(info.line_size);
    let pixels = lines.flat_map(|line| line.chunks(channels).map(|pixel| f32::from(pixel[0])));
    Ok((rows, columns, pixels.collect()))
}

pub(super) fn check(m: &CompiledModel) -> Result<()> {
    for g in (0..m.ngeom()).filter(|g| m.geom_type[*g] == GeomType::Hfield) {
        let id = m.geom_dataid[g];
        ensure!(
            usize::try_from(id).is_ok_and(|id| id < m.nhfield()),
            "geom_dataid[{g}] is {id}, and there are {} height fields",
            m.nhfield()
        );
    }
    arrays(&m.hfields)
}

fn arrays(m: &Hfields) -> Result<()> {
    same_length!(m, m.hfield_size.len(), hfield_nrow hfield_ncol hfield_adr);
    finite("hfield_size", m.hfield_size.as_flattened())?;
    let mut next = 0;
    for (i, size) in m.hfield_size.iter().enumerate() {
        ensure!(
            size.iter().all(|x| *x > 0.0),
            "hfield_size[{i}] must be positive"
        );
        let (rows, columns) = (m.hfield_nrow[i], m.hfield_ncol[i]);
        let count = rows.saturating_mul(columns);
        ensure!(
            count > 0 && count <= m.hfield_data.len() - next,
            "height field {i} has {rows} rows and {columns} columns, and there are {} elevations",
            m.hfield_data.len() - next
        );
        same("hfield_adr", i, m.hfield_adr[i], next)?;
        next += count;
    }
    let length = m.hfield_data.len();
    ensure!(
        length == next,
        "hfield_data has {length} elements, expected {next}"
    );
    let wrong = m.hfield_data.iter().position(|x| !x.is_finite());
    ensure!(
        wrong.is_none(),
        "number {} of hfield_data is not finite",
        wrong.unwrap_or_default()
    );
    Ok(())
}
