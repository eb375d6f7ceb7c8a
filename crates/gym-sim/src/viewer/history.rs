//! What sensors measured.

use std::ops::Range;

use mujoco_engine::model::SensorType;
use mujoco_engine::{CompiledModel, Data};

/// The most values of a number that are recorded.
pub const HISTORY: usize = 256;
/// The time of the model between two of them, in s.
pub const SAMPLE: f64 = 0.02;
/// The most numbers that are recorded, of all sensors together: 2 MB.
const MOST: usize = 1024;

/// A sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Its name, or its number.
    pub name: String,
    /// What it measures.
    pub kind: SensorType,
    first: usize,
    dim: usize,
}

impl Sensor {
    /// The positions of its values in [`Data::sensordata`].
    #[must_use]
    pub fn range(&self) -> Range<usize> {
        self.first..self.first + self.dim
    }
}

pub(super) fn of(model: &CompiledModel) -> Vec<Sensor> {
    let sensor = |i: usize| {
        let name = model.names.sensor.get(i).and_then(Option::as_deref);
        Sensor {
            name: name.map_or_else(|| format!("sensor {i}"), str::to_owned),
            kind: model.sensor_type[i],
            first: model.sensor_adr[i],
            dim: model.sensor_dim[i],
        }
    };
    (0..model.nsensor()).map(sensor).collect()
}

/// The last values of the sensors: rows in a ring.
#[derive(Clone, Debug)]
pub(super) struct Samples {
    rows: Vec<f64>,
    /// The numbers of a row.
    width: usize,
    /// The next row, and how many there are.
    next: usize,
    count: usize,
    /// The time from which the next row is taken.
    due: f64,
}

impl Samples {
    pub(super) fn new(model: &CompiledModel) -> Self {
        let width = model.nsensordata().min(MOST);
        Self {
            rows: vec![0.0; width * HISTORY],
            width,
            next: 0,
            count: 0,
            due: f64::NEG_INFINITY,
        }
    }

    pub(super) fn clear(&mut self) {
        (self.next, self.count, self.due) = (0, 0, f64::NEG_INFINITY);
    }

    /// Records the sensors, if it is time.
    pub(super) fn take(&mut self, data: &Data) {
        if data.time < self.due {
            return;
        }
        // half a nanosecond early rather than a timestep late
        self.due = data.time + SAMPLE - 5e-10;
        let row = &mut self.rows[self.next * self.width..][..self.width];
        row.copy_from_slice(&data.sensordata[..self.width]);
        self.next = (self.next + 1) % HISTORY;
        self.count = (self.count + 1).min(HISTORY);
    }

    /// The values of a column, the oldest first.
    pub(super) fn column(&self, column: Option<usize>) -> impl ExactSizeIterator<Item = f64> {
        let column = column.filter(|column| *column < self.width);
        let count = column.map_or(0, |_| self.count);
        let first = self.next + HISTORY - self.count;
        let at = move |k: usize| (first + k) % HISTORY * self.width + column.unwrap_or(0);
        (0..count).map(move |k| self.rows[at(k)])
    }
}
