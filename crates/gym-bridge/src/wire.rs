//! Values as bytes: a tag, then little-endian numbers.

use std::io::{self, BufRead};

use gym_core::{Array, DType, GraphInstance, Value};

const NULL: u8 = 0;
const FALSE: u8 = 1;
const TRUE: u8 = 2;
const INT: u8 = 3;
const FLOAT: u8 = 4;
const TEXT: u8 = 5;
const ARRAY: u8 = 6;
const TUPLE: u8 = 7;
const DICT: u8 = 8;
const GRAPH: u8 = 9;
const ONE_OF: u8 = 10;

/// The most values in a frame: more than a reply of any real environment has.
const MOST_VALUES: u32 = 10_000_000;

/// Encodes a value as the bytes of a frame.
pub fn encoded(value: &Value) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(value, &mut bytes);
    bytes
}

/// Decodes the bytes of a frame; `None` if they are invalid or longer than one value.
pub fn decoded(mut bytes: &[u8]) -> Option<Value> {
    let length = bytes.len() as u64;
    let mut reader = Reader::new(&mut bytes, length);
    let value = reader.value()?;
    reader.is_done().then_some(value)
}

pub(crate) fn write(value: &Value, out: &mut Vec<u8>) {
    match value {
        Value::Null => out.push(NULL),
        Value::Bool(is) => out.push(if *is { TRUE } else { FALSE }),
        Value::Int(i) => {
            out.push(INT);
            out.extend(i.to_le_bytes());
        }
        Value::Float(x) => {
            out.push(FLOAT);
            out.extend(x.to_le_bytes());
        }
        Value::Text(text) => {
            out.push(TEXT);
            write_text(text, out);
        }
        Value::Array(array) => write_array(array, out),
        Value::Tuple(items) => {
            out.push(TUPLE);
            write_length(items.len(), out);
            items.iter().for_each(|item| write(item, out));
        }
        Value::Dict(entries) => {
            out.push(DICT);
            write_length(entries.len(), out);
            for (key, value) in entries {
                write_text(key, out);
                write(value, out);
            }
        }
        Value::Graph(graph) => {
            out.push(GRAPH);
            write(&graph.nodes, out);
            match &graph.edges {
                Some(edges) => write(edges, out),
                None => out.push(NULL),
            }
            match &graph.edge_links {
                Some(links) => write_array(links, out),
                None => out.push(NULL),
            }
        }
        Value::OneOf(index, value) => {
            out.push(ONE_OF);
            write_length(*index, out);
            write(value, out);
        }
    }
}

/// Writes a length. Any length that fits into memory as a frame fits into `u32`.
fn write_length(length: usize, out: &mut Vec<u8>) {
    out.extend(u32::try_from(length).unwrap_or(u32::MAX).to_le_bytes());
}

fn write_text(text: &str, out: &mut Vec<u8>) {
    write_length(text.len(), out);
    out.extend(text.as_bytes());
}

fn write_array(array: &Array, out: &mut Vec<u8>) {
    let code = DType::ALL
        .iter()
        .position(|dtype| *dtype == array.dtype())
        .unwrap_or_default();
    out.extend([ARRAY, code as u8, array.shape().len() as u8]);
    array
        .shape()
        .iter()
        .for_each(|length| write_length(*length, out));
    out.extend(array.to_bytes());
}

/// Reads values from a stream as they arrive. Methods return `None` for invalid bytes and if the
/// stream fails.
pub(crate) struct Reader<'a, R> {
    stream: &'a mut R,
    /// The bytes of the frame that were not read yet.
    left: u64,
    /// The values that the frame may still have: a value needs more memory than its bytes.
    values_left: u32,
    failure: Option<io::Error>,
}

impl<'a, R: BufRead> Reader<'a, R> {
    /// Starts reading a frame of `length` bytes.
    pub(crate) fn new(stream: &'a mut R, length: u64) -> Self {
        Self {
            stream,
            left: length,
            values_left: MOST_VALUES,
            failure: None,
        }
    }

    /// Returns why reading failed: the stream's error, or `None` for invalid bytes.
    pub(crate) fn into_failure(self) -> Option<io::Error> {
        self.failure
    }

    /// Whether the whole frame was read.
    pub(crate) fn is_done(&self) -> bool {
        self.left == 0
    }

    /// Subtracts `count` from the number of unread bytes of the frame; `None` if fewer are left.
    fn reserve(&mut self, count: usize) -> Option<()> {
        self.left = self.left.checked_sub(count.try_into().ok()?)?;
        Some(())
    }

    fn or_failure<T>(&mut self, read: io::Result<T>) -> Option<T> {
        read.map_err(|error| self.failure = Some(error)).ok()
    }

    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.reserve(N)?;
        let mut bytes = [0; N];
        let read = self.stream.read_exact(&mut bytes);
        self.or_failure(read).map(|()| bytes)
    }

    pub(crate) fn byte(&mut self) -> Option<u8> {
        self.bytes().map(|[byte]| byte)
    }

    pub(crate) fn float(&mut self) -> Option<f64> {
        self.bytes().map(f64::from_le_bytes)
    }

    fn length(&mut self) -> Option<usize> {
        self.bytes()
            .and_then(|bytes| u32::from_le_bytes(bytes).try_into().ok())
    }

    fn text(&mut self) -> Option<String> {
        let length = self.length()?;
        // checked before the allocation, so that a wrong length allocates no more memory than the
        // frame has bytes
        self.reserve(length)?;
        let mut text = vec![0; length];
        let read = self.stream.read_exact(&mut text);
        self.or_failure(read)?;
        String::from_utf8(text).ok()
    }

    pub(crate) fn value(&mut self) -> Option<Value> {
        let mut value = Value::Null;
        self.value_into(&mut value)?;
        Some(value)
    }

    /// Reads into `value`: an array of the same dtype and shape keeps its memory.
    pub(crate) fn value_into(&mut self, value: &mut Value) -> Option<()> {
        /// More levels than the space or info of any real environment.
        const DEPTH: usize = 64;
        self.nested(value, DEPTH)
    }

    fn nested(&mut self, value: &mut Value, depth: usize) -> Option<()> {
        let depth = depth.checked_sub(1)?;
        self.values_left = self.values_left.checked_sub(1)?;
        let inner = |this: &mut Self| {
            let mut value = Value::Null;
            this.nested(&mut value, depth).map(|()| value)
        };
        match (self.byte()?, value) {
            (NULL, value) => *value = Value::Null,
            (FALSE, value) => *value = Value::Bool(false),
            (TRUE, value) => *value = Value::Bool(true),
            (INT, value) => *value = Value::Int(self.bytes().map(i64::from_le_bytes)?),
            (FLOAT, value) => *value = Value::Float(self.float()?),
            (TEXT, value) => *value = Value::Text(self.text()?),
            (ARRAY, Value::Array(array)) => self.array_into(array)?,
            (ARRAY, value) => *value = Value::Array(self.array()?),
            (TUPLE, Value::Tuple(items)) => {
                let length = self.length()?;
                items.truncate(length);
                for i in 0..length {
                    match items.get_mut(i) {
                        Some(item) => self.nested(item, depth)?,
                        None => items.push(inner(self)?),
                    }
                }
            }
            (TUPLE, value) => {
                // allocate as values arrive
                let items = (0..self.length()?).map(|_| inner(self));
                *value = Value::Tuple(items.collect::<Option<_>>()?);
            }
            (DICT, Value::Dict(entries)) => {
                let length = self.length()?;
                entries.truncate(length);
                for i in 0..length {
                    let key = self.text()?;
                    match entries.get_mut(i) {
                        Some((old, value)) => {
                            *old = key;
                            self.nested(value, depth)?;
                        }
                        None => entries.push((key, inner(self)?)),
                    }
                }
            }
            (DICT, value) => {
                let entries = (0..self.length()?).map(|_| Some((self.text()?, inner(self)?)));
                *value = Value::Dict(entries.collect::<Option<_>>()?);
            }
            (GRAPH, value) => {
                let mut part = || match inner(self)? {
                    Value::Null => Some(None),
                    value => Some(Some(value)),
                };
                let (nodes, edges) = (part()??, part()?);
                let edge_links = match part()? {
                    None => None,
                    Some(Value::Array(links)) => Some(links),
                    Some(_) => return None,
                };
                *value = Value::Graph(Box::new(GraphInstance {
                    nodes,
                    edges,
                    edge_links,
                }));
            }
            (ONE_OF, value) => *value = Value::OneOf(self.length()?, Box::new(inner(self)?)),
            _ => return None,
        }
        Some(())
    }

    fn array(&mut self) -> Option<Array> {
        let mut array = Array::default();
        self.array_into(&mut array)?;
        Some(array)
    }

    fn array_into(&mut self, array: &mut Array) -> Option<()> {
        let dtype = *DType::ALL.get(usize::from(self.byte()?))?;
        let shape: Vec<usize> = (0..self.byte()?)
            .map(|_| self.length())
            .collect::<Option<_>>()?;
        let count = shape
            .iter()
            .try_fold(1usize, |count, length| count.checked_mul(*length))?;
        self.reserve(count.checked_mul(dtype.size())?)?;
        if array.dtype() != dtype || array.shape() != shape {
            *array = Array::zeros(dtype, shape).ok()?;
        }
        let read = array.read_from(self.stream);
        self.or_failure(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples() -> Vec<Value> {
        let graph = GraphInstance {
            nodes: Value::Array([1.0f64, 2.0].into()),
            edges: Some(Value::Tuple(vec![Value::Text("a".into())])),
            edge_links: None,
        };
        vec![
            Value::Null,
            Value::Bool(true),
            Value::Int(i64::MIN),
            Value::Float(-0.0),
            Value::Text("Grüße".into()),
            Value::Array(Array::zeros(DType::U8, [2, 3]).unwrap()),
            Value::Array([f32::INFINITY, -1.5].into()),
            Value::Tuple(vec![Value::Int(1), Value::Array([1i64].into())]),
            Value::Dict(vec![
                ("a".into(), Value::Bool(false)),
                ("b".into(), Value::Array([0.5f64].into())),
            ]),
            Value::Graph(Box::new(graph)),
            Value::OneOf(2, Box::new(Value::Int(3))),
        ]
    }

    /// A stream that records the size of each read.
    struct Counted<'a> {
        bytes: &'a [u8],
        taken: Vec<usize>,
    }

    impl io::Read for Counted<'_> {
        fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
            let count = self.bytes.read(out)?;
            self.taken.push(count);
            Ok(count)
        }
    }

    #[test]
    fn an_array_is_read_from_the_stream_into_its_place() {
        const LENGTH: usize = 1 << 20;
        let numbers: Vec<f32> = (0..LENGTH).map(|i| i as f32).collect();
        let bytes = encoded(&Value::Array(numbers.into()));
        let stream = Counted {
            bytes: &bytes,
            taken: Vec::new(),
        };
        // the buffer's end splits a number
        let mut stream = io::BufReader::with_capacity(1 << 16, stream);
        let mut value = Value::Array(Array::zeros(DType::F32, [LENGTH]).unwrap());
        let place = value
            .as_array()
            .and_then(Array::as_slice::<f32>)
            .unwrap()
            .as_ptr();
        Reader::new(&mut stream, bytes.len() as u64)
            .value_into(&mut value)
            .expect("it was written");
        let read = value.as_array().and_then(Array::as_slice::<f32>).unwrap();
        assert_eq!(read.as_ptr(), place, "no second array");
        assert!(read.iter().enumerate().all(|(i, x)| *x == i as f32));
        let taken = &stream.get_ref().taken;
        assert_eq!(taken.iter().sum::<usize>(), bytes.len(), "each byte once");
        assert!(
            taken.len() <= bytes.len() / (1 << 16) + 2,
            "in large parts: {}",
            taken.len()
        );
    }

    #[test]
    fn values_come_back_into_any_buffer() {
        for value in samples() {
            let bytes = encoded(&value);
            for mut buffer in samples() {
                let mut stream = bytes.as_slice();
                let mut reader = Reader::new(&mut stream, bytes.len() as u64);
                reader.value_into(&mut buffer).expect("it was written");
                assert_eq!(buffer, value);
                assert!(reader.is_done() && stream.is_empty());
            }
        }
    }

    #[test]
    fn damaged_bytes_are_refused() {
        for value in samples() {
            let bytes = encoded(&value);
            for cut in 0..bytes.len() {
                assert!(decoded(&bytes[..cut]).is_none(), "{value:?} cut at {cut}");
                let ended = Reader::new(&mut &bytes[..cut], bytes.len() as u64).value();
                assert!(ended.is_none(), "{value:?}, whose stream ends at {cut}");
            }
            let longer = [&bytes[..], &[NULL]].concat();
            assert!(decoded(&longer).is_none(), "{value:?} and a byte more");
            for i in 0..bytes.len() {
                for byte in [0, 1, 6, 7, 8, 255] {
                    let mut damaged = bytes.clone();
                    damaged[i] = byte;
                    // every input ends, and needs no more memory than its bytes
                    let _ = decoded(&damaged);
                }
            }
        }
        let tags: Vec<u8> = samples().iter().map(|value| encoded(value)[0]).collect();
        for tag in (0..=u8::MAX).filter(|tag| *tag != FALSE && !tags.contains(tag)) {
            let bytes = [vec![tag], vec![0; 64]].concat();
            for mut buffer in samples() {
                let mut stream = bytes.as_slice();
                let read = Reader::new(&mut stream, bytes.len() as u64).value_into(&mut buffer);
                assert!(read.is_none(), "{tag} is no kind of value");
            }
        }
        let deep = [TUPLE, 1, 0, 0, 0].repeat(10_000);
        assert!(decoded(&deep).is_none(), "no stack overflows");
        // in memory, a value of one byte takes dozens
        let nulls = |count: u32| {
            let mut bytes = vec![TUPLE];
            bytes.extend(count.to_le_bytes());
            bytes.resize(bytes.len() + count as usize, NULL);
            bytes
        };
        assert!(decoded(&nulls(MOST_VALUES)).is_none(), "with its tuple");
        assert!(decoded(&nulls(1000)).is_some());
    }
}
