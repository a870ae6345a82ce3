//! The container of RGL's tensor files: a header, a table of named arrays, and the arrays at multiples of 8 bytes.

/// A named array of a file.
#[derive(Clone, Debug)]
pub struct Field {
    /// Name of the array.
    pub name: &'static str,
    /// Lengths of the axes, the last one contiguous.
    pub shape: Vec<usize>,
    /// Values of the array.
    pub values: Values,
}

/// The values of a field.
#[derive(Clone, Debug)]
pub enum Values {
    /// Unsigned bytes.
    Bytes(Vec<u8>),
    /// 32-bit floating-point numbers.
    Singles(Vec<f32>),
}

impl Values {
    /// The format's number for the type of the values, and their length in bytes.
    fn kind(&self) -> (u8, usize) {
        match self {
            Self::Bytes(bytes) => (1, bytes.len()),
            Self::Singles(values) => (10, 4 * values.len()),
        }
    }
}

/// The bytes of a file of these fields: version 1.0, little endian.
#[must_use]
pub fn encode(fields: &[Field]) -> Vec<u8> {
    let mut file = b"tensor_file\0\x01\x00".to_vec();
    file.extend((fields.len() as u32).to_le_bytes());
    let entry = |field: &Field| 2 + field.name.len() + 2 + 1 + 8 + 8 * field.shape.len();
    let start = (file.len() + fields.iter().map(entry).sum::<usize>()).next_multiple_of(8);
    let mut offset = start;
    for field in fields {
        let (kind, length) = field.values.kind();
        file.extend((field.name.len() as u16).to_le_bytes());
        file.extend(field.name.as_bytes());
        file.extend((field.shape.len() as u16).to_le_bytes());
        file.push(kind);
        file.extend((offset as u64).to_le_bytes());
        field.shape.iter().for_each(|side| file.extend((*side as u64).to_le_bytes()));
        offset += length.next_multiple_of(8);
    }
    file.reserve_exact(offset - file.len());
    file.resize(start, 0);
    for field in fields {
        match &field.values {
            Values::Bytes(bytes) => file.extend(bytes),
            Values::Singles(values) => values.iter().for_each(|value| file.extend(value.to_le_bytes())),
        }
        file.resize(file.len().next_multiple_of(8), 0);
    }
    file
}
