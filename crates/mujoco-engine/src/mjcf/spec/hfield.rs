//! Height fields.

use std::path::PathBuf;

use super::{file_of, replace_some};
use crate::Result;
use crate::mjcf::xml::{Element, Place};

/// The largest number of points of a height field that the text gives.
const MOST_POINTS: usize = 1 << 24;

/// A height field, before its file is read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hfield {
    pub(crate) place: Place,
    pub(crate) name: String,
    pub(crate) path: Option<PathBuf>,
    pub(crate) content_type: Option<String>,
    pub(crate) size: [f64; 4],
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// Row by row from the least y; empty if all are 0.
    pub(crate) elevations: Vec<f32>,
}

impl Hfield {
    /// Reads a height field whose file is in `folder` beside the model.
    pub(crate) fn read(element: &mut Element<'_, '_>, folder: &str, strip: bool) -> Result<Self> {
        let mut field = Self {
            place: element.place(),
            ..Self::default()
        };
        (field.name, field.path) = file_of(element, folder, strip)?;
        replace_some(&mut field.content_type, element.text("content_type")?);
        let size = element.numbers("size")?;
        field.size = size.ok_or_else(|| element.missing("size"))?;
        if field.size.iter().any(|x| *x <= 0.0) {
            return Err(field.place.attribute("size", "must be positive"));
        }
        for (name, count) in [("nrow", &mut field.rows), ("ncol", &mut field.columns)] {
            *count = element.integer::<usize>(name)?.unwrap_or_default();
        }
        let given = element.list_of::<f32>("elevation", "a number")?;
        let points = field.rows.saturating_mul(field.columns);
        if field.path.is_some() {
            if points > 0 || given.is_some() {
                let reason = "gives the elevations: leave out nrow, ncol and elevation";
                return Err(field.place.attribute("file", reason));
            }
            return Ok(field);
        }
        if points == 0 || points > MOST_POINTS {
            let reason = format!(
                "has {} rows and {} columns: give a file, or nrow and ncol with 1 to {MOST_POINTS} points",
                field.rows, field.columns
            );
            return Err(field.place.error(reason));
        }
        if let Some(given) = given {
            if given.len() != points {
                let reason = format!(
                    "has {} numbers, expected nrow * ncol: {points}",
                    given.len()
                );
                return Err(field.place.attribute("elevation", reason));
            }
            // the text begins with the greatest y
            field.elevations = given.rchunks(field.columns).flatten().copied().collect();
        }
        Ok(field)
    }
}
