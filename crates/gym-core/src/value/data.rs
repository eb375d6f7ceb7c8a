//! Numbers of one type, chosen at run time.

use std::fmt;
use std::io::{self, BufRead};

use serde::{Deserialize, Serialize};

/// A number type that an [`Array`](crate::Array) can hold.
pub trait Scalar: Copy + Default + fmt::Debug + PartialEq + Send + Sync + 'static {
    /// The [`DType`] of this type.
    const DTYPE: DType;
    /// Wraps numbers of this type.
    fn into_data(values: Vec<Self>) -> Data;
    /// The numbers, if they are of this type.
    fn slice(data: &Data) -> Option<&[Self]>;
    /// The numbers, if they are of this type.
    fn slice_mut(data: &mut Data) -> Option<&mut [Self]>;
}

macro_rules! dtypes {
    ($($(#[$default:meta])? $variant:ident $type:ty, $name:literal, $kind:ident);* $(;)?) => {
        /// The type of an array's numbers, under numpy's names.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum DType {
            $(
                #[doc = concat!("`", $name, "`")]
                #[serde(rename = $name)]
                $(#[$default])?
                $variant
            ),*
        }

        impl DType {
            /// Every type.
            pub const ALL: [Self; 10] = [$(Self::$variant),*];

            /// numpy's name, as in `float32`.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),* }
            }

            /// The size of a number in bytes.
            pub const fn size(self) -> usize {
                match self { $(Self::$variant => size_of::<$type>()),* }
            }

            /// The smallest and the largest finite number of the type, as `f64`.
            pub const fn finite_range(self) -> (f64, f64) {
                match self { $(Self::$variant => (<$type>::MIN as f64, <$type>::MAX as f64)),* }
            }
        }

        /// The numbers of an [`Array`](crate::Array), in row-major order.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Data {
            $(
                #[doc = concat!("`", $name, "`")]
                $variant(Vec<$type>)
            ),*
        }

        impl Data {
            /// The number of numbers.
            pub fn len(&self) -> usize {
                match self { $(Self::$variant(values) => values.len()),* }
            }

            /// Whether there are no numbers.
            pub fn is_empty(&self) -> bool {
                self.len() == 0
            }

            /// Their type.
            pub fn dtype(&self) -> DType {
                match self { $(Self::$variant(_) => DType::$variant),* }
            }

            /// One number, widened (numbers beyond 2^53 are rounded).
            ///
            /// # Panics
            /// If `index` is not below [`len`](Self::len).
            pub fn get_f64(&self, index: usize) -> f64 {
                match self { $(Self::$variant(values) => values[index] as f64),* }
            }

            /// Numbers of `dtype` made from `f64` as numpy's `astype` makes them: integers truncate
            /// towards zero.
            pub fn from_f64(dtype: DType, values: impl IntoIterator<Item = f64>) -> Self {
                let values = values.into_iter();
                match dtype { $(DType::$variant => Self::$variant(values.map(|x| x as $type).collect())),* }
            }

            /// Numbers of `dtype` made from `i64`, wrapping where the type is smaller.
            pub fn from_i64(dtype: DType, values: impl IntoIterator<Item = i64>) -> Self {
                let values = values.into_iter();
                match dtype { $(DType::$variant => Self::$variant(values.map(|x| x as $type).collect())),* }
            }

            /// `len` zeros; `None` if they do not fit in memory.
            pub(crate) fn zeros(dtype: DType, len: usize) -> Option<Self> {
                match dtype { $(DType::$variant => {
                    // try to reserve first, because `vec!` aborts; `vec!` then gets zeroed pages
                    Vec::<$type>::new().try_reserve_exact(len).ok()?;
                    Some(Self::$variant(vec![0 as $type; len]))
                })* }
            }

            /// The bytes of the numbers, little-endian.
            pub(crate) fn to_bytes(&self) -> Vec<u8> {
                match self { $(Self::$variant(values) => {
                    let mut bytes = vec![0; size_of_val(values.as_slice())];
                    let (places, _) = bytes.as_chunks_mut();
                    places.iter_mut().zip(values).for_each(|(place, x)| *place = x.to_le_bytes());
                    bytes
                }),* }
            }

            /// Overwrites the numbers with the next bytes of `stream`. Each byte is copied only
            /// once, from the stream's buffer.
            pub(crate) fn read_from(&mut self, stream: &mut impl BufRead) -> io::Result<()> {
                match self { $(Self::$variant(values) => {
                    let mut done = 0;
                    while done < values.len() {
                        let left = &mut values[done..];
                        let (numbers, _) = stream.fill_buf()?.as_chunks();
                        left.iter_mut().zip(numbers).for_each(|(x, bytes)| *x = <$type>::from_le_bytes(*bytes));
                        let mut count = numbers.len().min(left.len());
                        stream.consume(count * size_of::<$type>());
                        if count == 0 {
                            // the buffer ends in the middle of a number, or the stream has ended
                            let mut bytes = [0; size_of::<$type>()];
                            stream.read_exact(&mut bytes)?;
                            left[0] = <$type>::from_le_bytes(bytes);
                            count = 1;
                        }
                        done += count;
                    }
                }),* }
                Ok(())
            }

            /// Overwrites the numbers from bytes. Returns `false` if the number of bytes does not
            /// fit.
            pub(crate) fn fill_bytes(&mut self, bytes: &[u8]) -> bool {
                match self { $(Self::$variant(values) => {
                    let (numbers, rest) = bytes.as_chunks();
                    let fits = rest.is_empty() && numbers.len() == values.len();
                    if fits {
                        values.iter_mut().zip(numbers).for_each(|(x, bytes)| *x = <$type>::from_le_bytes(*bytes));
                    }
                    fits
                }),* }
            }

            /// Overwrites `self` with `source`, keeping the allocation where the types agree.
            pub(crate) fn assign(&mut self, source: &Self) {
                match (self, source) {
                    $((Self::$variant(to), Self::$variant(from)) => to.clone_from(from),)*
                    (to, from) => *to = from.clone(),
                }
            }
        }

        $(impl Scalar for $type {
            const DTYPE: DType = DType::$variant;

            fn into_data(values: Vec<Self>) -> Data {
                Data::$variant(values)
            }

            fn slice(data: &Data) -> Option<&[Self]> {
                if let Data::$variant(values) = data { Some(values) } else { None }
            }

            fn slice_mut(data: &mut Data) -> Option<&mut [Self]> {
                if let Data::$variant(values) = data { Some(values) } else { None }
            }
        })*
    };
}

dtypes! {
    I8 i8, "int8", integer;
    U8 u8, "uint8", integer;
    I16 i16, "int16", integer;
    U16 u16, "uint16", integer;
    I32 i32, "int32", integer;
    U32 u32, "uint32", integer;
    I64 i64, "int64", integer;
    U64 u64, "uint64", integer;
    F32 f32, "float32", float;
    #[default] F64 f64, "float64", float;
}

impl DType {
    /// Whether the numbers are real.
    pub const fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// Whether the numbers are whole and not negative.
    pub const fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32 | Self::U64)
    }
}

impl fmt::Display for DType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
