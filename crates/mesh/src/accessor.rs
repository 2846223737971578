//! Reads typed values from the buffers of a glTF file; every range is checked before it is read.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Root, buffer};

/// Why a file is rejected, without its name.
pub(super) type Refusal = String;

/// The structure of a file and its buffers.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    pub(super) root: &'a Root,
    pub(super) data: Vec<Vec<u8>>,
}

/// Elements of an accessor, `stride` bytes apart.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Elements<'a> {
    fn get(&self, index: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..][..self.size]
    }
}

/// Name of a component type in error messages.
fn name(component: ComponentType) -> String {
    let word = match component {
        ComponentType::I8 => "BYTE",
        ComponentType::U8 => "UNSIGNED_BYTE",
        ComponentType::I16 => "SHORT",
        ComponentType::U16 => "UNSIGNED_SHORT",
        ComponentType::U32 => "UNSIGNED_INT",
        ComponentType::F32 => "FLOAT",
    };
    format!("{word} ({})", component.as_gl_enum())
}

fn valid<T: Copy>(value: &Checked<T>) -> Result<T, Refusal> {
    match value {
        Checked::Valid(value) => Ok(*value),
        Checked::Invalid => Err("not a valid glTF value".to_owned()),
    }
}

impl Buffers<'_> {
    /// The bytes of buffer view `index`, and its stride if it has one.
    pub(super) fn view(&self, index: usize) -> Result<(&[u8], Option<usize>), Refusal> {
        let view: &buffer::View =
            self.root.buffer_views.get(index).ok_or_else(|| format!("bufferView {index} does not exist"))?;
        let number = view.buffer.value();
        let data = self.data.get(number).ok_or_else(|| format!("buffer {number} does not exist"))?;
        let (offset, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let bytes = range(data, offset, length).ok_or_else(|| {
            let held = data.len();
            format!("bufferView {index}: {length} bytes at {offset} exceed buffer {number} of {held} bytes")
        })?;
        // Some exporters write 0 for a packed layout.
        Ok((bytes, view.byte_stride.map(|stride| stride.0).filter(|stride| *stride > 0)))
    }

    /// `count` elements of `size` bytes in buffer view `view`, from its byte `offset` on.
    fn elements(&self, view: usize, offset: u64, count: u64, size: usize) -> Result<Elements<'_>, Refusal> {
        let (bytes, stride) = self.view(view)?;
        let stride = stride.unwrap_or(size);
        if stride < size {
            return Err(format!(
                "bufferView {view}: byteStride {stride} is less than the {size} bytes of an element"
            ));
        }
        let length = match count.checked_sub(1) {
            None => Some(0),
            Some(steps) => {
                steps.checked_mul(stride as u64).and_then(|length| length.checked_add(size as u64))
            }
        };
        let bytes = length.and_then(|length| range(bytes, offset, length)).ok_or_else(|| {
            let length = bytes.len();
            format!(
                "{count} elements of {size} bytes, {stride} apart, at offset {offset} exceed bufferView \
                 {view} of {length} bytes"
            )
        })?;
        Ok(Elements { bytes, stride, size })
    }

    /// Calls `take` with the bytes of every element of accessor `index`, with sparse elements substituted.
    fn each(
        &self,
        index: usize,
        accessor: &Accessor,
        size: usize,
        mut take: impl FnMut(&[u8]) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        let wrong = |message: Refusal| format!("accessor {index}: {message}");
        let count = accessor.count.0;
        let offset = accessor.byte_offset.unwrap_or_default().0;
        let dense = accessor.buffer_view.map(|view| self.elements(view.value(), offset, count, size));
        let dense = dense.transpose().map_err(wrong)?;
        let zeros = vec![0; size];
        let mut replaced = Vec::new().into_iter().peekable();
        if let Some(sparse) = &accessor.sparse {
            let amount = sparse.count.0;
            if amount > count {
                return Err(wrong(format!("{amount} sparse elements exceed the count of {count}")));
            }
            let component = valid(&sparse.indices.component_type).map_err(wrong)?.0;
            let (view, offset) = (sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0);
            let targets = self.elements(view, offset, amount, component.size()).map_err(wrong)?;
            let (view, offset) = (sparse.values.buffer_view.value(), sparse.values.byte_offset.0);
            let values = self.elements(view, offset, amount, size).map_err(wrong)?;
            let mut all: Vec<(u64, &[u8])> = Vec::with_capacity(amount as usize);
            for k in 0..amount as usize {
                let place = u64::from(unsigned(component, targets.get(k)).map_err(wrong)?);
                if place >= count || all.last().is_some_and(|(last, _)| *last >= place) {
                    return Err(wrong(format!("sparse index {place} is not ascending below {count}")));
                }
                all.push((place, values.get(k)));
            }
            replaced = all.into_iter().peekable();
        }
        for k in 0..count {
            let element = match (replaced.next_if(|(place, _)| *place == k), &dense) {
                (Some((_, bytes)), _) => bytes,
                (None, Some(dense)) => dense.get(k as usize),
                (None, None) => &zeros,
            };
            take(element).map_err(|message| format!("accessor {index}, element {k}: {message}"))?;
        }
        Ok(())
    }

    fn accessor(&self, index: usize, most: usize) -> Result<(&Accessor, ComponentType, Type), Refusal> {
        let wrong = |message: Refusal| format!("accessor {index}: {message}");
        let accessor = self.root.accessors.get(index).ok_or_else(|| wrong("it does not exist".to_owned()))?;
        // Check before any allocation: elements without a buffer view take no bytes of the file.
        if accessor.count.0 > most as u64 {
            return Err(wrong(format!("{} elements; at most {most} are supported", accessor.count.0)));
        }
        let component = valid(&accessor.component_type).map_err(wrong)?.0;
        Ok((accessor, component, valid(&accessor.type_).map_err(wrong)?))
    }

    /// The indices in accessor `index`, at most `most`.
    pub(super) fn indices(&self, index: usize, most: usize) -> Result<Vec<u32>, Refusal> {
        let (accessor, component, kind) = self.accessor(index, most)?;
        let allowed = matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        if kind != Type::Scalar || !allowed {
            return Err(format!(
                "accessor {index}: indices of {kind:?} {}; they must be unsigned integer scalars",
                name(component)
            ));
        }
        let mut indices = Vec::with_capacity(accessor.count.0 as usize);
        self.each(index, accessor, component.size(), |bytes| {
            indices.push(unsigned(component, bytes)?);
            Ok(())
        })?;
        Ok(indices)
    }

    /// The vectors in accessor `index`, at most `most`, each of `kinds`; missing components are 1. Accepts
    /// floats, and normalised integers if `fractions` are allowed.
    pub(super) fn vectors<const N: usize>(
        &self,
        index: usize,
        most: usize,
        kinds: &[Type],
        fractions: Fractions,
    ) -> Result<Vec<[f32; N]>, Refusal> {
        let (accessor, component, kind) = self.accessor(index, most)?;
        let fraction = fractions == Fractions::Allowed
            && accessor.normalized
            && matches!(component, ComponentType::U8 | ComponentType::U16);
        if !kinds.contains(&kind) || !(component == ComponentType::F32 || fraction) {
            let normalized = if accessor.normalized { ", normalized" } else { "" };
            return Err(format!(
                "accessor {index}: {kind:?} of {}{normalized} where {kinds:?} of FLOAT is required",
                name(component)
            ));
        }
        let (each, parts) = (component.size(), kind.multiplicity().min(N));
        let mut vectors = Vec::with_capacity(accessor.count.0 as usize);
        self.each(index, accessor, each * kind.multiplicity(), |bytes| {
            let mut vector = [1.0; N];
            for (value, bytes) in vector.iter_mut().zip(bytes.chunks_exact(each)).take(parts) {
                *value = match (component, bytes) {
                    (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
                    (ComponentType::U8, _) => unsigned(component, bytes)? as f32 / 255.0,
                    _ => unsigned(component, bytes)? as f32 / 65535.0,
                };
                if !value.is_finite() {
                    return Err(format!("{value} is not finite"));
                }
            }
            vectors.push(vector);
            Ok(())
        })?;
        Ok(vectors)
    }
}

/// Whether normalised integers are accepted as fractions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fractions {
    Allowed,
    Refused,
}

/// `length` bytes of `bytes` from `offset` on, if there are that many.
fn range(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    bytes.get(start..start.checked_add(usize::try_from(length).ok()?)?)
}

fn unsigned(component: ComponentType, bytes: &[u8]) -> Result<u32, Refusal> {
    match (component, bytes) {
        (ComponentType::U8, &[a]) => Ok(u32::from(a)),
        (ComponentType::U16, &[a, b]) => Ok(u32::from(u16::from_le_bytes([a, b]))),
        (ComponentType::U32, &[a, b, c, d]) => Ok(u32::from_le_bytes([a, b, c, d])),
        _ => Err(format!("{} is not an unsigned integer", name(component))),
    }
}
