//! The OEM and its exact table on the GPU, as four planes each: float32 bits and 64-bit words.

use crate::Context;
use crate::device::readback;
use octagloss_core::common::error::Result;
use octagloss_core::light::oem::{Oem, OemSize};

/// Channels: red, green and blue energy, solid angle.
pub(crate) const CHANNELS: usize = 4;

/// Memory layout of the planes of an OEM; the uniform `Table` of the shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Table {
    /// Texels along an edge of the square.
    pub inner: u32,
    /// Texels of border on every side.
    pub border: u32,
    /// Texels along an edge, border included.
    pub side: u32,
    /// Texels from row to row: `side` rounded up to a multiple of 4.
    pub pitch: u32,
}

impl Table {
    /// The layout of an OEM of `size`.
    pub const fn new(size: OemSize) -> Self {
        let side = size.bordered();
        Self { inner: size.inner, border: size.border, side, pitch: side.next_multiple_of(4) }
    }

    /// Entries of a plane.
    pub const fn count(self) -> u64 {
        self.pitch as u64 * self.side as u64
    }

    /// Reads `side` x `side` values of each channel from its plane, converted by `value`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Gpu`] if the device fails.
    pub async fn read<V: Copy + Default, W: bytemuck::Pod>(
        self,
        context: &Context,
        planes: &[wgpu::Buffer; CHANNELS],
        value: impl Fn(W) -> V,
    ) -> Result<Vec<[V; CHANNELS]>> {
        let mut values = vec![[V::default(); CHANNELS]; self.side as usize * self.side as usize];
        for (channel, plane) in planes.iter().enumerate() {
            let words: Vec<W> = readback::read(context, plane).await?;
            let rows = values.chunks_exact_mut(self.side as usize);
            for (row, words) in rows.zip(words.chunks_exact(self.pitch as usize)) {
                for (place, word) in row.iter_mut().zip(words) {
                    place[channel] = value(*word);
                }
            }
        }
        Ok(values)
    }
}

/// Remedy that names the largest edge, in texels, whose planes of `bytes` per entry fit a binding.
fn largest_that_fits(bytes: u64) -> impl FnOnce(u64) -> String {
    move |available| {
        let edge = (available / bytes).isqrt() / 4 * 4;
        format!("choose `oem_size` plus twice `border` of at most {edge}")
    }
}

/// L*w (red, green, blue) and w of every texel, border included, one float32 plane per channel.
#[derive(Clone, Debug)]
pub struct OemPlanes {
    size: OemSize,
    /// The planes.
    pub planes: [wgpu::Buffer; CHANNELS],
    table: wgpu::Buffer,
}

impl OemPlanes {
    /// Planes for an OEM of `size`, all zero.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Limit`] if a plane is larger than the device can bind.
    pub fn new(context: &Context, size: OemSize) -> Result<Self> {
        let table = Table::new(size);
        let bytes = 4 * table.count();
        context.fits(&format!("an OEM plane of {0} x {0}", table.side), bytes, largest_that_fits(4))?;
        let planes = std::array::from_fn(|_| context.storage("OEM plane", bytes));
        Ok(Self { size, planes, table: context.uniform("OEM table", &table) })
    }

    /// Size of the OEM.
    pub const fn size(&self) -> OemSize {
        self.size
    }

    /// Memory layout of the planes.
    pub const fn table(&self) -> Table {
        Table::new(self.size)
    }

    /// The [`Table`] at binding 0 and the planes at 1 to 4, where stages have them.
    pub(super) fn bindings(&self) -> Vec<(u32, wgpu::BindingResource<'_>)> {
        (0..)
            .zip(std::iter::once(&self.table).chain(&self.planes).map(wgpu::Buffer::as_entire_binding))
            .collect()
    }

    /// Reads the planes back.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Gpu`] if the device fails.
    pub async fn read(&self, context: &Context) -> Result<Oem> {
        let texels = self.table().read(context, &self.planes, |energy: f32| energy).await?;
        Ok(Oem::from_bordered(self.size, texels))
    }
}

/// The exact table of an OEM: inclusive 64-bit sums as (low, high) words, one plane per channel, and their
/// exponents.
#[derive(Clone, Debug)]
pub struct SatPlanes {
    size: OemSize,
    /// The planes.
    pub planes: [wgpu::Buffer; CHANNELS],
    /// Four `i32`: F of each channel, see [`octagloss_core::light::sat::FixedPoint`].
    pub exponents: wgpu::Buffer,
}

impl SatPlanes {
    /// Planes for the table of an OEM of `size`.
    ///
    /// # Errors
    /// [`octagloss_core::common::error::Error::Limit`] if a plane is larger than the device can bind.
    pub fn new(context: &Context, size: OemSize) -> Result<Self> {
        Self::check_fits(context, size)?;
        let bytes = 8 * Table::new(size).count();
        let planes = std::array::from_fn(|_| context.storage("SAT plane", bytes));
        Ok(Self { size, planes, exponents: context.storage("fixed-point exponents", 16) })
    }

    /// Checks that the planes for an OEM of `size` fit.
    pub fn check_fits(context: &Context, size: OemSize) -> Result<()> {
        let table = Table::new(size);
        let what = format!("a SAT plane of {0} x {0}", table.side);
        context.fits(&what, 8 * table.count(), largest_that_fits(8))
    }

    /// Size of the OEM summed.
    pub const fn size(&self) -> OemSize {
        self.size
    }
}
