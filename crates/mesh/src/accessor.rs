//! Reads typed values from the buffers of a glTF file; every range is checked before it is read.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::{Accessor, Root};

/// Why a file is rejected, without its name.
pub(super) type Refusal = String;

/// The structure of a file, in which the crate `gltf` has checked all indices and enums, and its buffers.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    pub(super) root: &'a Root,
    pub(super) data: Vec<Vec<u8>>,
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

impl Buffers<'_> {
    /// The bytes of buffer view `index`, and its stride if it has one.
    pub(super) fn view(&self, index: usize) -> Result<(&[u8], Option<usize>), Refusal> {
        let view = &self.root.buffer_views[index];
        let number = view.buffer.value();
        let data = &self.data[number];
        let (offset, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let bytes = range(data, offset, length).ok_or_else(|| {
            let held = data.len();
            format!("bufferView {index}: {length} bytes at {offset} exceed buffer {number} of {held} bytes")
        })?;
        // Some exporters write 0 for a packed layout.
        Ok((bytes, view.byte_stride.map(|stride| stride.0).filter(|stride| *stride > 0)))
    }

    /// `count` elements of `size` bytes in buffer view `view`, from its byte `offset` on.
    fn elements(
        &self,
        view: usize,
        offset: u64,
        count: u64,
        size: usize,
    ) -> Result<impl Iterator<Item = &[u8]>, Refusal> {
        let (bytes, stride) = self.view(view)?;
        let stride = stride.unwrap_or(size);
        if stride < size {
            return Err(format!(
                "bufferView {view}: byteStride {stride} is less than the {size} bytes of an element"
            ));
        }
        let ends = |steps: u64| steps.checked_mul(stride as u64)?.checked_add(size as u64);
        let length = count.checked_sub(1).map_or(Some(0), ends);
        let bytes = length.and_then(|length| range(bytes, offset, length)).ok_or_else(|| {
            let length = bytes.len();
            format!(
                "{count} elements of {size} bytes, {stride} apart, at offset {offset} exceed bufferView \
                 {view} of {length} bytes"
            )
        })?;
        Ok((0..count as usize).map(move |k| &bytes[k * stride..][..size]))
    }

    /// The bytes of every element of `accessor`, with sparse elements substituted.
    fn each(&self, accessor: &Accessor, size: usize) -> Result<impl Iterator<Item = &[u8]>, Refusal> {
        let count = accessor.count.0;
        let offset = accessor.byte_offset.unwrap_or_default().0;
        let dense = accessor.buffer_view.map(|view| self.elements(view.value(), offset, count, size));
        let mut dense = dense.transpose()?;
        let mut replaced: Vec<(u64, &[u8])> = Vec::new();
        if let Some(sparse) = &accessor.sparse {
            let amount = sparse.count.0;
            if amount > count {
                return Err(format!("{amount} sparse elements exceed the count of {count}"));
            }
            let component = sparse.indices.component_type.unwrap().0;
            let (view, offset) = (sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0);
            let targets = self.elements(view, offset, amount, component.size())?;
            let (view, offset) = (sparse.values.buffer_view.value(), sparse.values.byte_offset.0);
            for (target, value) in targets.zip(self.elements(view, offset, amount, size)?) {
                let place = u64::from(unsigned(target));
                if place >= count || replaced.last().is_some_and(|(last, _)| *last >= place) {
                    return Err(format!("sparse index {place} is not ascending below {count}"));
                }
                replaced.push((place, value));
            }
        }
        let mut replaced = replaced.into_iter().peekable();
        Ok((0..count).map(move |k| {
            let element = dense.as_mut().and_then(Iterator::next).unwrap_or(&ZEROS[..size]);
            replaced.next_if(|(place, _)| *place == k).map_or(element, |(_, bytes)| bytes)
        }))
    }

    fn accessor(&self, index: usize, most: usize) -> Result<(&Accessor, ComponentType, Type), Refusal> {
        let accessor = &self.root.accessors[index];
        // Check before any allocation: elements without a buffer view take no bytes of the file.
        if accessor.count.0 > most as u64 {
            let count = accessor.count.0;
            return Err(format!("accessor {index}: {count} elements; at most {most} are supported"));
        }
        Ok((accessor, accessor.component_type.unwrap().0, accessor.type_.unwrap()))
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
        let elements = self.each(accessor, component.size());
        Ok(elements.map_err(|message| format!("accessor {index}: {message}"))?.map(unsigned).collect())
    }

    /// The vectors in accessor `index`, at most `most`, each of `kinds`; missing components are 1. Accepts
    /// floats, and normalised integers if `fractions` are allowed.
    pub(super) fn vectors<const N: usize>(
        &self,
        index: usize,
        most: usize,
        kinds: &[Type],
        fractions: bool,
    ) -> Result<Vec<[f32; N]>, Refusal> {
        let (accessor, component, kind) = self.accessor(index, most)?;
        let fraction =
            fractions && accessor.normalized && matches!(component, ComponentType::U8 | ComponentType::U16);
        if !kinds.contains(&kind) || !(component == ComponentType::F32 || fraction) {
            let normalized = if accessor.normalized { ", normalized" } else { "" };
            return Err(format!(
                "accessor {index}: {kind:?} of {}{normalized} where {kinds:?} of FLOAT is required",
                name(component)
            ));
        }
        let number = |bytes: &[u8]| match component {
            ComponentType::F32 => f32::from_bits(unsigned(bytes)),
            ComponentType::U8 => unsigned(bytes) as f32 / 255.0,
            _ => unsigned(bytes) as f32 / 65535.0,
        };
        let elements = self.each(accessor, component.size() * kind.multiplicity());
        let elements = elements.map_err(|message| format!("accessor {index}: {message}"))?;
        let mut vectors = Vec::with_capacity(accessor.count.0 as usize);
        for (k, bytes) in elements.enumerate() {
            let mut vector = [1.0; N];
            for (value, bytes) in vector.iter_mut().zip(bytes.chunks_exact(component.size())) {
                *value = number(bytes);
                if !value.is_finite() {
                    return Err(format!("accessor {index}, element {k}: {value} is not finite"));
                }
            }
            vectors.push(vector);
        }
        Ok(vectors)
    }
}

/// The element of accessors without a buffer view, of any size.
static ZEROS: [u8; 64] = [0; 64];

/// `length` bytes of `bytes` from `offset` on, if there are that many.
fn range(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    bytes.get(start..start.checked_add(usize::try_from(length).ok()?)?)
}

/// The integer of up to four `bytes`, the lowest first.
fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, byte| number << 8 | u32::from(*byte))
}
