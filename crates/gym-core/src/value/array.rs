//! Numbers of one type in a shape: the dynamic counterpart of `[T; N]`.

use std::fmt;
use std::io::{self, BufRead};

pub use crate::value::data::{DType, Data, Scalar};
use crate::value::number::{Number, Numeric, with_type};
use crate::value::{Error, Result, numpy_fmt};

/// Numbers of one type in a row-major shape. The shape `[]` holds a single number.
#[derive(Debug, PartialEq)]
pub struct Array {
    shape: Vec<usize>,
    data: Data,
}

impl Default for Array {
    /// No numbers: shape `[0]`, `float32`.
    fn default() -> Self {
        Self {
            shape: vec![0],
            data: Data::F32(Vec::new()),
        }
    }
}

impl Clone for Array {
    fn clone(&self) -> Self {
        Self {
            shape: self.shape.clone(),
            data: self.data.clone(),
        }
    }

    fn clone_from(&mut self, source: &Self) {
        self.shape.clone_from(&source.shape);
        self.data.assign(&source.data);
    }
}

impl<T: Scalar> From<Vec<T>> for Array {
    /// A one-dimensional array.
    fn from(values: Vec<T>) -> Self {
        Self {
            shape: vec![values.len()],
            data: T::into_data(values),
        }
    }
}

impl<T: Scalar, const N: usize> From<[T; N]> for Array {
    /// A one-dimensional array.
    fn from(values: [T; N]) -> Self {
        Self::from(values.to_vec())
    }
}

/// The largest number of numbers in an element of a space: some gigabytes. A larger space is
/// refused, before memory runs out.
pub const MAX_ELEMENTS: usize = 1 << 28;

/// Whether two shapes are equal. Shapes have one or two numbers, for which a loop takes less time
/// than a call of `memcmp`.
#[inline]
pub(crate) fn same_shape(a: &[usize], b: &[usize]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b)
}

/// numpy's largest number of axes.
pub(crate) const MAX_AXES: usize = 64;

/// The number of elements of a shape; `None` for more than `usize` counts and for more than
/// [`MAX_AXES`]. An empty array is refused if its other axes have more than [`MAX_ELEMENTS`]: its
/// nested lists would fill the memory.
pub(crate) fn element_count(shape: &[usize]) -> Option<usize> {
    if shape.len() > MAX_AXES {
        return None;
    }
    let axes = shape
        .iter()
        .filter(|n| **n > 0)
        .try_fold(1usize, |product, n| product.checked_mul(*n))?;
    match shape.contains(&0) {
        true => (axes <= MAX_ELEMENTS).then_some(0),
        false => Some(axes),
    }
}

impl Array {
    /// An array of that shape.
    ///
    /// # Errors
    /// [`Error::Custom`] if the shape has another number of elements than `data`.
    pub fn new(shape: impl Into<Vec<usize>>, data: Data) -> Result<Self> {
        let shape = shape.into();
        match element_count(&shape) {
            Some(len) if len == data.len() => Ok(Self { shape, data }),
            _ => Err(Error::custom(format!(
                "shape {shape:?} does not hold {} numbers",
                data.len()
            ))),
        }
    }

    /// Zeros of that type and shape.
    ///
    /// # Errors
    /// [`Error::Custom`] if the numbers do not fit in memory.
    pub fn zeros(dtype: DType, shape: impl Into<Vec<usize>>) -> Result<Self> {
        let shape = shape.into();
        match element_count(&shape).and_then(|len| Data::zeros(dtype, len)) {
            Some(data) => Ok(Self { shape, data }),
            None => Err(Error::custom(format!(
                "an array of shape {shape:?} and type {dtype} does not fit in memory"
            ))),
        }
    }

    /// An array from little-endian bytes; `None` if their number does not fit the shape.
    pub fn from_bytes(dtype: DType, shape: impl Into<Vec<usize>>, bytes: &[u8]) -> Option<Self> {
        let shape = shape.into();
        if element_count(&shape)?.checked_mul(dtype.size()) != Some(bytes.len()) {
            return None;
        }
        let mut array = Self::zeros(dtype, shape).ok()?;
        array.fill_bytes(bytes).then_some(array)
    }

    /// The bytes of the numbers, little-endian, in row-major order.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.data.to_bytes()
    }

    /// Overwrites the numbers from bytes. Returns `false` and changes nothing if the number of
    /// bytes does not fit.
    pub fn fill_bytes(&mut self, bytes: &[u8]) -> bool {
        self.data.fill_bytes(bytes)
    }

    /// Overwrites the numbers with the next bytes of a stream, little-endian, in row-major order.
    ///
    /// # Errors
    /// Errors of the stream; some of the numbers may then be overwritten.
    pub fn read_from(&mut self, stream: &mut impl BufRead) -> io::Result<()> {
        self.data.read_from(stream)
    }

    /// The length of each axis.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Whether the array has this shape.
    #[inline]
    #[must_use]
    pub fn has_shape(&self, shape: &[usize]) -> bool {
        same_shape(&self.shape, shape)
    }

    /// The type of the numbers.
    pub fn dtype(&self) -> DType {
        self.data.dtype()
    }

    /// The numbers, in row-major order.
    pub fn data(&self) -> &Data {
        &self.data
    }

    /// The number of numbers.
    pub fn len(&self) -> usize {
        self.data.len()
    }

    /// Whether there are no numbers.
    pub fn is_empty(&self) -> bool {
        self.data.is_empty()
    }

    /// The numbers, if they are of type `T`.
    pub fn as_slice<T: Scalar>(&self) -> Option<&[T]> {
        T::slice(&self.data)
    }

    /// The numbers, if they are of type `T`.
    pub fn as_mut_slice<T: Scalar>(&mut self) -> Option<&mut [T]> {
        T::slice_mut(&mut self.data)
    }

    /// The numbers, widened to `f64`.
    pub fn iter_f64(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.into_iter()
    }

    /// The number at an index of each axis, widened to `f64`; `None` outside of the shape.
    ///
    /// ```
    /// use gym_core::{Array, Data};
    ///
    /// let array = Array::new([2, 3], Data::U8(vec![0, 1, 2, 10, 11, 12]))?;
    /// assert_eq!(array.get([1, 2]), Some(12.0));
    /// assert_eq!(array.get([2, 0]), None);
    /// assert_eq!((&array).into_iter().sum::<f64>(), 36.0);
    /// # Ok::<(), gym_core::Error>(())
    /// ```
    pub fn get<const N: usize>(&self, index: [usize; N]) -> Option<f64> {
        if N != self.shape.len() || index.iter().zip(&self.shape).any(|(i, n)| i >= n) {
            return None;
        }
        let flat = index
            .iter()
            .zip(&self.shape)
            .fold(0, |flat, (i, n)| flat * n + i);
        Some(self.data.get_f64(flat))
    }

    /// Copies the numbers of another array, cast as by numpy's `astype`.
    ///
    /// # Errors
    /// [`Error::Contract`] if the arrays have different numbers of elements.
    pub fn assign_cast(&mut self, source: &Self) -> Result<()> {
        if self.len() != source.len() {
            let [from, to] = [source.len(), self.len()];
            return Err(Error::Contract(format!(
                "an array has {from} numbers and should have {to}"
            )));
        }
        with_type!(self.dtype(), T => {
            let numbers = self.as_mut_slice::<T>().unwrap_or_default();
            match source.as_slice::<T>() {
                Some(source) => numbers.copy_from_slice(source),
                None => numbers.iter_mut().zip(Number::all(source.data())).for_each(|(x, y)| *x = T::cast(y)),
            }
        });
        Ok(())
    }

    /// Overwrites one number, cast as numpy's `astype`.
    pub fn set_f64(&mut self, index: usize, x: f64) {
        with_type!(self.dtype(), T => {
            if let Some(number) = self.as_mut_slice::<T>().and_then(|numbers| numbers.get_mut(index)) {
                *number = T::cast(Number::Float(x));
            }
        });
    }

    /// Clips each number, or each row of numbers of a batch, to bounds of the same type, as numpy's
    /// `clip`: NaN stays.
    pub fn clip(&mut self, low: &Self, high: &Self) {
        with_type!(self.dtype(), T => {
            let (low, high) = (low.as_slice::<T>().unwrap_or_default(), high.as_slice::<T>().unwrap_or_default());
            for row in self.as_mut_slice::<T>().unwrap_or_default().chunks_exact_mut(low.len().max(1)) {
                for (x, (low, high)) in row.iter_mut().zip(low.iter().zip(high)) {
                    if *x < *low {
                        *x = *low;
                    } else if *x > *high {
                        *x = *high;
                    }
                }
            }
        });
    }

    /// Overwrites each number with the larger of two, as numpy's `maximum`: NaN if either is NaN.
    pub fn maximum(&mut self, other: &Self) {
        with_type!(self.dtype(), T => {
            let numbers = self.as_mut_slice::<T>().unwrap_or_default().iter_mut();
            for (a, b) in numbers.zip(other.as_slice::<T>().unwrap_or_default()) {
                #[expect(clippy::eq_op, reason = "only NaN differs from itself")]
                if b > a || b != b {
                    *a = *b;
                }
            }
        });
    }

    /// Overwrites each number with an integer.
    pub fn fill_int(&mut self, i: i64) {
        with_type!(self.dtype(), T => {
            self.as_mut_slice::<T>().unwrap_or_default().fill(T::cast(Number::Int(i.into())));
        });
    }

    /// Whether no number is infinite or NaN.
    pub fn is_finite(&self) -> bool {
        match &self.data {
            Data::F32(values) => values.iter().all(|x| x.is_finite()),
            Data::F64(values) => values.iter().all(|x| x.is_finite()),
            _ => true,
        }
    }

    /// The same numbers in another shape.
    ///
    /// # Errors
    /// The errors of [`Array::new`].
    pub fn reshape(self, shape: impl Into<Vec<usize>>) -> Result<Self> {
        Self::new(shape, self.data)
    }
}

impl<'a> IntoIterator for &'a Array {
    type Item = f64;
    type IntoIter = Numbers<'a>;

    fn into_iter(self) -> Numbers<'a> {
        Numbers {
            data: &self.data,
            range: 0..self.len(),
        }
    }
}

/// The numbers of an [`Array`] in row-major order, widened to `f64`.
#[derive(Clone, Debug)]
pub struct Numbers<'a> {
    data: &'a Data,
    range: std::ops::Range<usize>,
}

impl Iterator for Numbers<'_> {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        self.range.next().map(|i| self.data.get_f64(i))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.range.size_hint()
    }
}

impl ExactSizeIterator for Numbers<'_> {}

/// Like numpy's `str`, without its alignment: `[0.1 0.2]`, `[[1 2] [3 4]]`.
impl fmt::Display for Array {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fn rows(
            array: &Array,
            axis: usize,
            start: usize,
            f: &mut fmt::Formatter<'_>,
        ) -> fmt::Result {
            let Some((&n, inner)) = array.shape[axis..].split_first() else {
                return f.write_str(&numpy_fmt::scalar(&array.data, start));
            };
            let stride: usize = inner.iter().product();
            f.write_str("[")?;
            for i in 0..n {
                if i > 0 {
                    f.write_str(" ")?;
                }
                rows(array, axis + 1, start + i * stride, f)?;
            }
            f.write_str("]")
        }
        rows(self, 0, 0, f)
    }
}
