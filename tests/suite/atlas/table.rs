//! Many octahedral maps of the sphere or of a hemisphere in one table.
//!
//! Engelhardt and Dachsbacher 2008, section 5.3: squares pack without waste where paraboloids leave a fifth
//! of the texture empty. A tile is a square with its border; its side is a power of two. The border lets
//! bilinear look-ups read their tile only. The exact summed-area table of the whole atlas is one scan, and
//! serves every tile: sums are modulo 2^64, so a tile's boxes are differences of its entries, whatever lies
//! left of it and above.

use super::squares::Squares;
use glam::{DVec2, DVec3};
use octagloss::internals::environment::Rgb;
use octagloss::internals::oem::{Oem, OemSize};
use octagloss::internals::sat::{Sat, Scan};
use octagloss::internals::sphere::octahedral::{oct_from_direction, wrap_texel};
use octagloss::internals::sphere::oem_lookup::rectangular_place;
use octagloss::{Error, Result};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

/// The directions of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Domain {
    /// The sphere, in the quadratic layout.
    Sphere,
    /// The directions with y >= 0, as in the first layer of the rectangular layout: u = x - z, v = x + z for
    /// |x| + |y| + |z| = 1. Its border repeats the horizon.
    Hemisphere,
}

impl Domain {
    /// Coordinates in [-1, 1]^2 of `direction`; `None` outside the domain.
    pub(crate) fn coordinates(self, direction: DVec3) -> Option<DVec2> {
        match (self, rectangular_place(direction)) {
            (Self::Sphere, _) => Some(oct_from_direction(direction)),
            (Self::Hemisphere, (0, at)) => Some(at),
            (Self::Hemisphere, _) => None,
        }
    }

    /// The texel of the square of `inner` texels that (`x`, `y`), which may lie in the border, repeats.
    fn texel(self, inner: u32, x: i64, y: i64) -> (u32, u32) {
        let clamped = |k: i64| k.clamp(0, i64::from(inner) - 1) as u32;
        match self {
            Self::Sphere => wrap_texel(inner, x, y),
            Self::Hemisphere => (clamped(x), clamped(y)),
        }
    }
}

/// A tile of an [`Atlas`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tile {
    x: u32,
    y: u32,
    side: u32,
    border: u32,
    domain: Domain,
    /// Distinguishes it from later tiles at the same place, and from tiles of other atlases.
    number: u64,
}

impl Tile {
    /// Column and row of its first texel in the atlas.
    pub(crate) const fn corner(&self) -> [u32; 2] {
        [self.x, self.y]
    }

    /// Texels along an edge of its map and of the border.
    pub(crate) const fn size(&self) -> OemSize {
        OemSize { inner: self.side - 2 * self.border, border: self.border }
    }

    /// Its directions.
    pub(crate) const fn domain(&self) -> Domain {
        self.domain
    }

    /// Where `direction` is in the atlas, in texels; `None` outside the tile's domain. A bilinear look-up
    /// there reads this tile only.
    pub(crate) fn place(&self, direction: DVec3) -> Option<DVec2> {
        let OemSize { inner, border } = self.size();
        let corner = DVec2::new(f64::from(self.x + border), f64::from(self.y + border));
        Some(corner + (self.domain.coordinates(direction)? + 1.0) * (f64::from(inner) / 2.0))
    }
}

/// A square of texels [L_r*w, L_g*w, L_b*w, w] that tiles are allocated in; zero where there is none.
#[derive(Clone, Debug)]
pub(crate) struct Atlas {
    side: u32,
    texels: Vec<[f32; 4]>,
    border: u32,
    free: Squares,
    /// Numbers of the tiles, by corner.
    tiles: BTreeMap<[u32; 2], u64>,
}

/// Number of tiles allocated so far, in any atlas.
static ALLOCATED: AtomicU64 = AtomicU64::new(0);

impl Atlas {
    /// An empty atlas of `side` x `side` texels whose tiles have `border` texels around their maps.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `side` is not a power of two from 4 to 16384, or `border` is 0 or leaves no
    /// map.
    pub(crate) fn new(side: u32, border: u32) -> Result<Self> {
        if !side.is_power_of_two() || !(MIN..=MAX).contains(&side) {
            return Err(Error::Parameter(format!(
                "an atlas of {side} texels; choose a power of two from {MIN} to {MAX}"
            )));
        }
        if border == 0 || u64::from(side) <= 2 * u64::from(border) {
            return Err(Error::Parameter(format!(
                "tiles with a border of {border} in an atlas of {side} texels; choose 1 to {}",
                side / 2 - 1
            )));
        }
        Ok(Self {
            side,
            texels: vec![[0.0; 4]; side as usize * side as usize],
            border,
            free: Squares::new(side),
            tiles: BTreeMap::new(),
        })
    }

    /// Allocates a tile of `side` x `side` texels, border included, of zeros; `None` if no square of that
    /// size is free.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `side` is not a power of two, larger than twice the border and at most the
    /// atlas's.
    pub(crate) fn allocate(&mut self, side: u32, domain: Domain) -> Result<Option<Tile>> {
        let (whole, border) = (self.side, self.border);
        if !side.is_power_of_two() || side <= 2 * border || side > whole {
            return Err(Error::Parameter(format!(
                "a tile of {side} texels; choose a power of two above {} and up to {whole}",
                2 * border
            )));
        }
        let Some([x, y]) = self.free.take(side) else { return Ok(None) };
        let number = ALLOCATED.fetch_add(1, Ordering::Relaxed);
        self.tiles.insert([x, y], number);
        Ok(Some(Tile { x, y, side, border, domain, number }))
    }

    /// Releases `tile` and clears its texels.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it was released before or is of another atlas.
    pub(crate) fn release(&mut self, tile: Tile) -> Result<()> {
        self.check(tile)?;
        self.tiles.remove(&tile.corner());
        self.fill(tile, |_, _| [0.0; 4]);
        self.free.give(tile.corner(), tile.side);
        Ok(())
    }

    /// Writes the map of `tile` from the texels of its square, without the border, and fills the border.
    ///
    /// # Errors
    /// Those of [`Atlas::release`], and [`Error::Parameter`] for another number of texels.
    pub(crate) fn write(&mut self, tile: Tile, square: &[[f32; 4]]) -> Result<()> {
        self.check(tile)?;
        let OemSize { inner, border } = tile.size();
        if square.len() != inner as usize * inner as usize {
            return Err(Error::Parameter(format!(
                "{} texels for a tile of {inner} x {inner}; give one for each",
                square.len()
            )));
        }
        let border = i64::from(border);
        self.fill(tile, |i, j| {
            let (x, y) = tile.domain.texel(inner, i64::from(i) - border, i64::from(j) - border);
            square[(y * inner + x) as usize]
        });
        Ok(())
    }

    /// Sets the texels of `tile` by column and row.
    fn fill(&mut self, tile: Tile, texel: impl Fn(u32, u32) -> [f32; 4]) {
        let pitch = self.side as usize;
        for j in 0..tile.side {
            let start = (tile.y + j) as usize * pitch + tile.x as usize;
            let row = &mut self.texels[start..start + tile.side as usize];
            row.iter_mut().zip(0..).for_each(|(place, i)| *place = texel(i, j));
        }
    }

    fn check(&self, tile: Tile) -> Result<()> {
        if self.tiles.get(&tile.corner()) == Some(&tile.number) {
            return Ok(());
        }
        Err(Error::Parameter(format!(
            "the tile at ({}, {}) is not in this atlas; allocate it first",
            tile.x, tile.y
        )))
    }

    /// Radiance of `tile` along `direction`, bilinear; `None` outside its domain.
    ///
    /// # Errors
    /// Those of [`Atlas::release`].
    pub(crate) fn radiance(&self, tile: Tile, direction: DVec3) -> Result<Option<Rgb>> {
        self.check(tile)?;
        let Some(at) = tile.place(direction) else { return Ok(None) };
        let low = (at - 0.5).floor();
        let share = at - 0.5 - low;
        let (x, y) = (low.x as u32, low.y as u32);
        let [upper, lower] = [y, y + 1].map(|y| {
            let [left, right] = [x, x + 1].map(|x| {
                let [energy @ .., w] = self.texels[(y * self.side + x) as usize];
                energy.map(|channel| f64::from(channel / w))
            });
            mixed(left, right, share.x)
        });
        Ok(Some(mixed(upper, lower, share.y).map(|channel| channel as f32)))
    }

    /// All texels, as one square without a border.
    pub(crate) fn oem(&self) -> Oem {
        Oem::from_square(OemSize { inner: self.side, border: 0 }, self.texels.clone())
    }

    /// Texels that no tile has.
    pub(crate) fn free_texels(&self) -> u64 {
        self.free.area()
    }

    /// The exact tables of all tiles, by one scan of the atlas.
    pub(crate) fn sat(&self, scan: Scan) -> AtlasSat {
        AtlasSat { sat: Sat::new(&self.oem(), scan) }
    }
}

/// Largest edge of an atlas in texels.
const MAX: u32 = 16_384;

/// Fewest texels along an edge of an atlas: two by two, and a border of one.
const MIN: u32 = 4;

fn mixed(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    std::array::from_fn(|c| a[c] * (1.0 - share) + b[c] * share)
}

/// The exact table of an [`Atlas`]. All tiles have the fixed-point exponents of the whole.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AtlasSat {
    sat: Sat,
}

impl AtlasSat {
    /// The table of the whole atlas.
    pub(crate) const fn whole(&self) -> &Sat {
        &self.sat
    }

    /// The table of `tile`, border included: the same bits as a scan of its texels with these exponents.
    pub(crate) fn tile(&self, tile: Tile) -> Sat {
        let ([x, y], side) = (tile.corner().map(i64::from), i64::from(tile.size().bordered()));
        let entry = |k: i64| self.sat.bordered_box(x, y, x + k % side + 1, y + k / side + 1);
        Sat::from_entries(tile.size(), self.sat.fixed_point(), (0..side * side).map(entry).collect())
    }
}
