//! Values as bytes: a tag, then little-endian numbers.

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
            write_array(&graph.nodes, out);
            for part in [&graph.edges, &graph.edge_links] {
                match part {
                    Some(array) => write_array(array, out),
                    None => out.push(NULL),
                }
            }
        }
        Value::OneOf(index, value) => {
            out.push(ONE_OF);
            write_length(*index, out);
            write(value, out);
        }
    }
}

/// Lengths fit: nothing that is larger fits into the memory of a frame.
fn write_length(length: usize, out: &mut Vec<u8>) {
    out.extend(u32::try_from(length).unwrap_or(u32::MAX).to_le_bytes());
}

fn write_text(text: &str, out: &mut Vec<u8>) {
    write_length(text.len(), out);
    out.extend(text.as_bytes());
}

fn write_array(array: &Array, out: &mut Vec<u8>) {
    let code = DType::ALL.iter().position(|dtype| *dtype == array.dtype()).unwrap_or_default();
    out.extend([ARRAY, code as u8, array.shape().len() as u8]);
    array.shape().iter().for_each(|length| write_length(*length, out));
    out.extend(array.to_bytes());
}

/// Reads values, one after the other; `None` for invalid bytes.
pub(crate) struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    pub(crate) fn byte(&mut self) -> Option<u8> {
        self.take(1).map(|bytes| bytes[0])
    }

    pub(crate) fn float(&mut self) -> Option<f64> {
        self.take(8)?.try_into().ok().map(f64::from_le_bytes)
    }

    fn length(&mut self) -> Option<usize> {
        let length = self.take(4)?.try_into().ok().map(u32::from_le_bytes)?;
        usize::try_from(length).ok()
    }

    fn text(&mut self) -> Option<String> {
        let length = self.length()?;
        String::from_utf8(self.take(length)?.to_vec()).ok()
    }

    pub(crate) fn value(&mut self) -> Option<Value> {
        let mut value = Value::Null;
        self.value_into(&mut value)?;
        Some(value)
    }

    /// Reads into an earlier value: arrays of the same type and shape keep their storage.
    pub(crate) fn value_into(&mut self, value: &mut Value) -> Option<()> {
        /// Deeper than any space or info of a sound environment.
        const DEPTH: usize = 64;
        self.nested(value, DEPTH)
    }

    fn nested(&mut self, value: &mut Value, depth: usize) -> Option<()> {
        let depth = depth.checked_sub(1)?;
        let inner = |this: &mut Self| {
            let mut value = Value::Null;
            this.nested(&mut value, depth).map(|()| value)
        };
        match (self.byte()?, value) {
            (NULL, value) => *value = Value::Null,
            (FALSE, value) => *value = Value::Bool(false),
            (TRUE, value) => *value = Value::Bool(true),
            (INT, value) => *value = Value::Int(self.take(8)?.try_into().ok().map(i64::from_le_bytes)?),
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
                // no more memory than the bytes that are there
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
                    Value::Array(array) => Some(Some(array)),
                    _ => None,
                };
                let (nodes, edges, edge_links) = (part()??, part()?, part()?);
                *value = Value::Graph(Box::new(GraphInstance { nodes, edges, edge_links }));
            }
            (ONE_OF, value) => *value = Value::OneOf(self.length()?, Box::new(inner(self)?)),
            _ => return None,
        }
        Some(())
    }

    /// The type, the shape and the bytes of an array.
    fn array_parts(&mut self) -> Option<(DType, Vec<usize>, &'a [u8])> {
        let dtype = *DType::ALL.get(usize::from(self.byte()?))?;
        let shape: Vec<usize> = (0..self.byte()?).map(|_| self.length()).collect::<Option<_>>()?;
        let count = shape.iter().try_fold(1usize, |count, length| count.checked_mul(*length))?;
        let bytes = self.take(count.checked_mul(dtype.size())?)?;
        Some((dtype, shape, bytes))
    }

    fn array(&mut self) -> Option<Array> {
        let (dtype, shape, bytes) = self.array_parts()?;
        Array::from_bytes(dtype, shape, bytes)
    }

    fn array_into(&mut self, array: &mut Array) -> Option<()> {
        let (dtype, shape, bytes) = self.array_parts()?;
        if array.dtype() == dtype && array.shape() == shape {
            return array.fill_bytes(bytes).then_some(());
        }
        *array = Array::from_bytes(dtype, shape, bytes)?;
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples() -> Vec<Value> {
        let graph = GraphInstance { nodes: [1.0f64, 2.0].into(), edges: None, edge_links: None };
        vec![
            Value::Null,
            Value::Bool(true),
            Value::Int(i64::MIN),
            Value::Float(-0.0),
            Value::Text("Grüße".into()),
            Value::Array(Array::zeros(DType::U8, [2, 3]).unwrap()),
            Value::Array([f32::INFINITY, -1.5].into()),
            Value::Tuple(vec![Value::Int(1), Value::Array([1i64].into())]),
            Value::Dict(vec![("a".into(), Value::Bool(false)), ("b".into(), Value::Array([0.5f64].into()))]),
            Value::Graph(Box::new(graph)),
            Value::OneOf(2, Box::new(Value::Int(3))),
        ]
    }

    #[test]
    fn values_come_back_into_any_buffer() {
        for value in samples() {
            let mut bytes = Vec::new();
            write(&value, &mut bytes);
            for mut buffer in samples() {
                let mut reader = Reader::new(&bytes);
                reader.value_into(&mut buffer).expect("it was written");
                assert_eq!(buffer, value);
                assert!(reader.0.is_empty());
            }
        }
    }

    #[test]
    fn damaged_bytes_are_refused() {
        for value in samples() {
            let mut bytes = Vec::new();
            write(&value, &mut bytes);
            for cut in 0..bytes.len() {
                assert!(Reader::new(&bytes[..cut]).value().is_none(), "{value:?} cut at {cut}");
            }
            for i in 0..bytes.len() {
                for byte in [0, 1, 6, 7, 8, 255] {
                    let mut damaged = bytes.clone();
                    damaged[i] = byte;
                    // any input ends, and needs no more memory than its bytes
                    let _ = Reader::new(&damaged).value();
                }
            }
        }
        let deep = [TUPLE, 1, 0, 0, 0].repeat(10_000);
        assert!(Reader::new(&deep).value().is_none(), "no stack overflows");
    }
}
