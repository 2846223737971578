//! The OEM's cells: a quadtree whose nodes store their energy, its centroid and covariance on the sphere, and
//! its radius.
//!
//! The kernel's argument s = |l - R|^2/4 is linear in l, so its mean over a cell's energy is exactly
//! (|centroid - R|^2 + trace of the covariance)/4 and its variance R.covariance.R/4 (the centre of mass of
//! Barnes and Hut 1986, the clusters of Walter et al. 2005, "Lightcuts"). Energies are those above the least
//! radiance c of each channel, E - c*w, so that a constant environment is black and dark cells stay coarse.
//!
//! Centroid and covariance are those of the luminance. What sets red and blue apart is their tint
//! (crates/core/src/geometry/tint.rs); green's follows, since that of the luminance is zero.
//!
//! The finest cells hold texels of the OEM, or of the source. Texels of the source belong to the cell that
//! contains their centroid, whole: their moments are exact, so nothing is spread over an OEM texel. A cell's
//! reach encloses its texels, whatever their size.

use crate::common::parallel;
use crate::geometry::panorama_row::RunSums;
use crate::geometry::source_texels::SourceGrid;
use crate::geometry::source_texels::{SourceTexels, longest_run};
use crate::geometry::tent::{Patch, Reconstruction, Texel, tents};
use crate::geometry::tint::{TINT_FIELDS, Tint};
use crate::light::environment::{Environment, LUMINANCE, Rgb, exact_luminance};
use crate::light::light_scale::LightScale;
use crate::light::oem::Oem;
use glam::{DVec3, Vec3, Vec3Swizzles as _};

/// Four sibling cells, field by field, so that one visit evaluates all four.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct Quad {
    pub(super) x: [f32; 4],
    pub(super) y: [f32; 4],
    pub(super) z: [f32; 4],
    /// Covariance of the directions: xx, yy, zz, yz, zx, xy.
    pub(super) covariance: [[f32; 4]; 6],
    /// Greatest distance from the centroid.
    pub(super) radius: [f32; 4],
    /// Luminance of the energy.
    pub(super) luminance: [f32; 4],
    pub(super) red: [f32; 4],
    pub(super) green: [f32; 4],
    pub(super) blue: [f32; 4],
    /// The tint of red, in the order of [`Tint::to_fields`].
    pub(super) red_tint: [[f32; 4]; TINT_FIELDS],
    /// That of blue.
    pub(super) blue_tint: [[f32; 4]; TINT_FIELDS],
}

/// Fields of [`Quad`], each of four floats.
pub const QUAD_FIELDS: usize = size_of::<Quad>() / 16;

/// A smaller share of a texel's energy above the least radiance is rounding error. Without the cut, black
/// texels would enlarge the radius of their cells.
pub(crate) const RESIDUE: f32 = 1.0 / (1 << 21) as f32;

/// A channel whose mean is below the luminance's by more than this factor is nearly black: its errors count
/// as if its mean were that share of the luminance's.
pub(crate) const DIMMEST: f64 = 100.0;

/// A channel's energy up to this counts as zero. Its product with a difference of directions, 2^-24, would be
/// subnormal, which GPUs flush, and the reciprocal of a subnormal luminance infinite. [`omitted_radiance`]
/// bounds the effect on an answer.
pub(crate) const FAINT: f32 = 1.0 / (1_u128 << 94) as f32;

/// Bound of the radiance that energies up to [`FAINT`] in the texels of an OEM of `inner` texels add to an
/// answer, for any lobe.
///
/// Energies e add the sum of e Kbar_t/W, with Kbar_t the kernel's mean over texel t in (u, v), whose area is
/// (2/n)^2. The sum of Kbar_t times that area is the kernel's integral over the square, which is at most W:
/// no solid angle is smaller than its area in (u, v).
pub fn omitted_radiance(inner: u32) -> f64 {
    f64::from(FAINT) * f64::from(inner).powi(2) / 4.0
}

/// One cell while the tree is built.
#[derive(Clone, Copy, Default)]
struct Cell {
    patch: Patch,
    energy: Vec3,
    luminance: f32,
    /// Of red and blue.
    tints: [Tint; 2],
}

impl Cell {
    /// Light of one colour.
    fn one_colour(patch: Patch, energy: Vec3) -> Self {
        Self { patch, energy, luminance: energy.dot(Vec3::from(LUMINANCE)), tints: [Tint::default(); 2] }
    }

    /// Adds the tints of `member`, a part whose centroid is `apart` from this cell's, whose energies are
    /// known.
    #[inline(always)]
    fn absorb_tints(&mut self, member: &Self, apart: Vec3) {
        let excess = member.energy - self.energy * (member.luminance / self.luminance);
        for (tint, (part, excess)) in self.tints.iter_mut().zip(member.tints.iter().zip([excess.x, excess.z]))
        {
            tint.absorb(part, &member.patch, apart, excess);
        }
    }
}

/// One level of quads: the quad of cell (i, j) of the level above is at `first` + j * `width` + i.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellLevel {
    pub(super) first: u32,
    pub(super) width: u32,
}

/// Texels of the finest cells, for their subdivision.
#[derive(Debug)]
pub(super) enum Finest {
    /// Blocks, which are not subdivided.
    Blocks,
    /// Texels of an OEM of `n` x `n`, with their energies above the least radiance.
    Texels { n: u32, reconstruction: Reconstruction, energies: Vec<Rgb> },
    /// Texels of the source.
    Source(Members),
}

/// Consecutive texels of one row of the source.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Run {
    /// The first texel's column, and its row counted through all images.
    pub(super) column: u32,
    pub(super) row: u32,
    pub(super) count: u32,
}

/// The texels of the source in every cell.
#[derive(Debug)]
pub(super) struct Members {
    pub(super) texels: SourceTexels,
    /// Cells along an edge.
    width: u32,
    /// First run of each cell, row by row, and the number of all runs.
    starts: Vec<u32>,
    runs: Vec<Run>,
}

impl Members {
    /// Assigns the texels to `width` x `width` cells.
    fn new(texels: SourceTexels, width: u32) -> Self {
        let (columns, rows) = texels.sides();
        let longest = longest_run(columns);
        let of_row = |row: u32| {
            let mut runs: Vec<(u32, Run)> = Vec::new();
            let mut column = 0;
            texels.for_each_centroid(row, |centroid| {
                let cell = cell_of(centroid, width);
                match runs.last_mut() {
                    Some((last, run)) if *last == cell && run.count < longest => run.count += 1,
                    _ => runs.push((cell, Run { column, row, count: 1 })),
                }
                column += 1;
            });
            runs
        };
        let by_row = parallel::map(0..rows, of_row);
        // A stable counting sort.
        let mut starts = vec![0_u32; width as usize * width as usize + 1];
        for (cell, _) in by_row.iter().flatten() {
            starts[*cell as usize + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let mut runs = vec![Run::default(); starts[starts.len() - 1] as usize];
        for (cell, run) in by_row.iter().flatten() {
            let place = &mut next[*cell as usize];
            runs[*place as usize] = *run;
            *place += 1;
        }
        Self { texels, width, starts, runs }
    }

    /// The runs of texels in the cell in column `i` of row `j`.
    pub(super) fn in_cell(&self, i: u32, j: u32) -> &[Run] {
        let cell = (j * self.width + i) as usize;
        &self.runs[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

/// Tables with which `shaders/adaptive.wgsl` subdivides cells of a source.
pub struct SubdivisionTables {
    /// Cells along an edge.
    pub width: u32,
    /// The source's own grid.
    pub grid: SourceGrid,
    /// First run of each cell and the number of runs, then every run's column, row and number of texels.
    pub members: Vec<u32>,
    /// Cosine and sine of the longitudes of a panorama's columns, then of the polar angles of its rows.
    pub angles: Vec<[f32; 2]>,
}

/// The cell, of `width` x `width`, that contains the direction of `centroid`.
#[inline(always)]
fn cell_of(centroid: Vec3, width: u32) -> u32 {
    let a = centroid.abs();
    let per_sum = 1.0 / (a.x + a.y + a.z);
    let (u, v) = (a.x * per_sum, a.z * per_sum);
    let (u, v) = if centroid.y >= 0.0 { (u, v) } else { (1.0 - v, 1.0 - u) };
    let half = 0.5 * width as f32;
    let place = |t: f32, sign: f32| ((half + t.copysign(sign) * half) as u32).min(width - 1);
    place(v, centroid.z) * width + place(u, centroid.x)
}

/// The light of the source that cells are built from, times the scale of the other tables.
#[derive(Clone, Copy, Debug)]
pub struct SourceLight<'a> {
    texels: &'a [Rgb],
    scale: LightScale,
}

impl<'a> SourceLight<'a> {
    /// The light of `environment`, times `scale`.
    pub fn new(environment: &'a Environment, scale: LightScale) -> Self {
        Self { texels: environment.texels(), scale }
    }

    /// The radiance of texel `index`.
    #[inline]
    pub(super) fn radiance(&self, index: usize) -> Vec3 {
        Vec3::from(self.scale.scaled_texel(self.texels[index]))
    }

    /// The least radiance of each channel.
    fn least(&self) -> Vec3 {
        let least =
            |chunk: &[Rgb]| chunk.iter().fold(Vec3::INFINITY, |least, texel| least.min(Vec3::from(*texel)));
        let least =
            parallel::map(self.texels.chunks(1 << 16), least).into_iter().fold(Vec3::INFINITY, Vec3::min);
        Vec3::from(self.scale.scaled_texel(least.to_array()))
    }
}

/// The texels of a source and their light.
struct Lit<'a> {
    texels: &'a SourceTexels,
    light: SourceLight<'a>,
    least: Vec3,
}

impl Lit<'_> {
    /// Appends the light of `run` to `cells`; raises `faint` to the greatest luminance that is cut.
    #[inline(always)]
    fn gather(&self, run: &Run, cells: &mut Vec<Cell>, faint: &mut f64) {
        let Run { column: first, row: y, count } = *run;
        let weights = Vec3::from(LUMINANCE);
        let source_row = self.texels.source_row(y);
        // The energy of the texel in column `x`.
        let mut energy = |x: u32, solid_angle: f32| {
            let above = self.light.radiance(source_row + self.texels.source_column(x)) - self.least;
            let all = above * solid_angle;
            let lit = all.cmpgt(Vec3::splat(FAINT));
            if lit.all() {
                return all;
            }
            // A lobe's answer is a mean of radiance: what is cut adds at most its greatest.
            *faint = faint.max(exact_luminance(Vec3::select(lit, Vec3::ZERO, above).to_array()));
            Vec3::select(lit, all, Vec3::ZERO)
        };
        match self.texels.panorama_row(y).filter(|_| count > 1) {
            Some(row) => {
                let (mut sums, mut sum) = (RunSums::default(), Vec3::ZERO);
                let (mut from, mut to) = (u32::MAX, 0);
                for x in first..first + count {
                    let own = energy(x, row.solid_angle());
                    let luminance = own.dot(weights);
                    sum += own;
                    row.add(&mut sums, first, x, own, luminance);
                    if luminance > 0.0 {
                        (from, to) = (from.min(x), x);
                    }
                }
                if from <= to {
                    let patch = row.patch(&sums, first, [from, to]);
                    let tints = row.tints(&sums, first, sum);
                    cells.push(Cell { tints, ..Cell::one_colour(patch, sum) });
                }
            }
            None => {
                for x in first..first + count {
                    let Texel { patch, solid_angle } = self.texels.at(x, y);
                    let energy = energy(x, solid_angle);
                    cells.push(Cell::one_colour(patch, energy));
                }
            }
        }
    }
}

/// The quadtree over the octahedral square.
#[derive(Debug)]
pub struct Cells {
    /// The least radiance of each channel.
    pub(super) least: Rgb,
    /// Mean radiance over the sphere.
    pub(super) mean: [f64; 3],
    pub(super) quads: Vec<Quad>,
    /// Levels from the finest (texels, or blocks of them) to the root, whose quad is the last.
    pub(super) levels: Vec<CellLevel>,
    pub(super) finest: Finest,
    /// Bound of the luminance that energies counted as zero add to an answer.
    pub(super) omitted: f64,
    /// Total energy of a source.
    energy: Option<[f64; 3]>,
}

impl Cells {
    /// Builds the cells of `oem`, down to blocks of `block` x `block` texels: 1 for all queries, more if all
    /// lobes will be much wider than a block.
    ///
    /// # Panics
    /// If `block` is zero.
    pub fn new(oem: &Oem, block: u32, reconstruction: Reconstruction) -> Self {
        assert!(block > 0, "blocks of at least one texel");
        let n = oem.size().inner;
        let least = oem.least_radiance();
        let [red, green, blue, _] = oem.totals();
        let mean = [red, green, blue].map(|total| total / (4.0 * std::f64::consts::PI));
        let tents = tents(n, reconstruction);
        let texel = |x: u32, y: u32| {
            let [r, g, b, w] = oem.texel(x, y);
            let all = Vec3::new(r, g, b);
            let above = all - Vec3::from(least) * w;
            let energy =
                Vec3::select(above.cmpgt((all * RESIDUE).max(Vec3::splat(FAINT))), above, Vec3::ZERO);
            Cell::one_colour(tents.at(x, y), energy)
        };

        let width = n.div_ceil(block);
        let mut cells = vec![Cell::default(); width as usize * width as usize];
        parallel::for_each(cells.chunks_mut(width as usize).zip(0..width), |(row, j)| {
            let range = |k: u32| k * block..((k + 1) * block).min(n);
            let mut members = Vec::with_capacity((block * block) as usize);
            for (cell, i) in row.iter_mut().zip(0..width) {
                members.clear();
                for y in range(j) {
                    members.extend(range(i).map(|x| texel(x, y)));
                }
                *cell = merge(members.iter());
            }
        });
        let finest = if block == 1 {
            let energies = cells.iter().map(|cell| cell.energy.to_array()).collect();
            Finest::Texels { n, reconstruction, energies }
        } else {
            Finest::Blocks
        };
        let copied = |j: u32, row: &mut [Cell]| row.copy_from_slice(row_of(&cells, width, j));
        let (quads, levels, _) = pyramid(width, copied);
        Self { least, mean, quads, levels, finest, omitted: omitted_radiance(n), energy: None }
    }

    /// Builds `width` x `width` cells of the `light` of a source whose texels are `texels`, and those above.
    pub fn of_source(texels: SourceTexels, light: SourceLight<'_>, width: u32) -> Self {
        let members = Members::new(texels, width);
        let lit = Lit { texels: &members.texels, light, least: light.least() };
        let row = |j: u32, row: &mut [Cell]| {
            let (mut gathered, mut faint) = (Vec::new(), 0.0_f64);
            let mut total = DVec3::ZERO;
            for (cell, i) in row.iter_mut().zip(0..width) {
                gathered.clear();
                members.in_cell(i, j).iter().for_each(|run| lit.gather(run, &mut gathered, &mut faint));
                *cell = if gathered.len() > 1 { merge_many(&gathered) } else { merge(gathered.iter()) };
                total += cell.energy.as_dvec3();
            }
            (total, faint)
        };
        let (quads, levels, sums) = pyramid(width, row);
        let least = lit.least.to_array();
        let above: DVec3 = sums.iter().map(|(total, _)| total).sum();
        let sphere = 4.0 * std::f64::consts::PI;
        let energy = (above + lit.least.as_dvec3() * sphere).to_array();
        let omitted = sums.iter().map(|(_, faint)| *faint).fold(0.0, f64::max);
        Self {
            least,
            mean: energy.map(|energy| energy / sphere),
            quads,
            levels,
            finest: Finest::Source(members),
            omitted,
            energy: Some(energy),
        }
    }

    /// The tints of red and blue of a leaf's cell, if they count.
    #[inline(always)]
    pub(super) fn tints(&self, cell: u32) -> Option<[Tint; 2]> {
        let quad = self.quads.get(cell as usize >> 2)?;
        let k = cell as usize & 3;
        Some([Tint::from_fields(&quad.red_tint, k), Tint::from_fields(&quad.blue_tint, k)])
    }

    /// Mean luminance over the sphere.
    pub(super) fn mean_luminance(&self) -> f64 {
        exact_luminance(self.mean)
    }

    /// Factors that make an error of a channel comparable with one of the luminance: means of luminance over
    /// channel, at most [`DIMMEST`].
    pub(super) fn channel_weights(&self) -> [f32; 3] {
        let luminance = self.mean_luminance();
        self.mean
            .map(|mean| if luminance < DIMMEST * mean { (luminance / mean) as f32 } else { DIMMEST as f32 })
    }

    /// Total energy of the source's light; `None` for cells of an OEM.
    pub(crate) const fn energy(&self) -> Option<[f64; 3]> {
        self.energy
    }

    /// The least radiance of each channel.
    pub const fn least(&self) -> [f32; 3] {
        self.least
    }

    /// Bound of the radiance that energies counted as zero add to an answer.
    pub const fn omitted(&self) -> f64 {
        self.omitted
    }

    /// The tables with which shaders subdivide cells of a source; `None` for those of an OEM.
    pub fn source_tables(&self) -> Option<SubdivisionTables> {
        let Finest::Source(Members { texels, width, starts, runs }) = &self.finest else { return None };
        let runs = runs.iter().flat_map(|run| [run.column, run.row, run.count]);
        Some(SubdivisionTables {
            width: *width,
            grid: texels.grid(),
            members: starts.iter().copied().chain(runs).collect(),
            angles: texels.angles(),
        })
    }

    /// Sibling cells in the layout of `shaders/common/quad.wgsl`.
    pub fn quad_fields(&self) -> Vec<[[f32; 4]; QUAD_FIELDS]> {
        let fields = |quad: &Quad| {
            let Quad { x, y, z, covariance, radius, luminance, red, green, blue, red_tint, blue_tint } =
                *quad;
            let mut fields = [[0.0; 4]; QUAD_FIELDS];
            fields[..3].copy_from_slice(&[x, y, z]);
            fields[3..9].copy_from_slice(&covariance);
            fields[9..14].copy_from_slice(&[radius, luminance, red, green, blue]);
            let (red_fields, blue_fields) = fields[14..].split_at_mut(TINT_FIELDS);
            red_fields.copy_from_slice(&red_tint);
            blue_fields.copy_from_slice(&blue_tint);
            fields
        };
        self.quads.iter().map(fields).collect()
    }
}

/// Row `j` of cells, `width` a row.
fn row_of(cells: &[Cell], width: u32, j: u32) -> &[Cell] {
    &cells[j as usize * width as usize..][..width as usize]
}

/// The quads over `width` x `width` cells, and their levels; `fill` makes a row of the cells. Also returns
/// what that does, row by row.
fn pyramid<T: Send>(
    width: u32,
    fill: impl Fn(u32, &mut [Cell]) -> T + Sync,
) -> (Vec<Quad>, Vec<CellLevel>, Vec<T>) {
    let half = |width: u32| width.div_ceil(2);
    let sides = std::iter::successors(Some(half(width)), |side| (*side > 1).then(|| half(*side)));
    let mut quads = vec![Quad::default(); sides.map(|side| side as usize * side as usize).sum()];
    let (first, rest) = quads.split_at_mut((half(width) * half(width)) as usize);
    let mut levels = vec![CellLevel { first: 0, width: half(width) }];
    let mut cells = vec![Cell::default(); first.len()];
    let above = half(width) as usize;
    let rows = first.chunks_mut(above).zip(cells.chunks_mut(above)).zip(0..half(width));
    // Two rows at a time: they stay in the cache.
    let start = || [(); 2].map(|()| vec![Cell::default(); width as usize]);
    let made = parallel::map_with(rows, start, |below, ((quads, parents), j)| {
        let rows = (2 * j..width.min(2 * j + 2)).zip(below.iter_mut());
        let made: Vec<T> = rows.map(|(j, row)| fill(j, row)).collect();
        let [upper, lower] = &*below;
        gather_quads([upper, if 2 * j + 1 < width { lower } else { &[] }], quads, parents);
        made
    });
    let (mut width, mut start, mut rest) = (half(width), first.len(), rest);
    while width > 1 {
        let above = half(width) as usize;
        let (own, further) = rest.split_at_mut(above * above);
        let place = u32::try_from(start).expect("fewer than 2^32 cells");
        levels.push(CellLevel { first: place, width: half(width) });
        let mut parents = vec![Cell::default(); above * above];
        let rows = own.chunks_mut(above).zip(parents.chunks_mut(above)).zip(0..half(width));
        parallel::for_each(rows, |((quads, parents), j)| {
            let lower = if 2 * j + 1 < width { row_of(&cells, width, 2 * j + 1) } else { &[] };
            gather_quads([row_of(&cells, width, 2 * j), lower], quads, parents);
        });
        (cells, width, rest) = (parents, half(width), further);
        start += above * above;
    }
    (quads, levels, made.into_iter().flatten().collect())
}

/// Makes a row of `quads` and of their `parents` from two rows of cells, the second of which may be empty.
fn gather_quads(rows: [&[Cell]; 2], quads: &mut [Quad], parents: &mut [Cell]) {
    let black = Cell::default();
    for (i, (quad, parent)) in quads.iter_mut().zip(parents).enumerate() {
        let siblings = [(0, 0), (1, 0), (0, 1), (1, 1)]
            .map(|(di, dj): (usize, usize)| rows[dj].get(2 * i + di).unwrap_or(&black));
        *quad = Quad::new(siblings);
        *parent = merge(siblings.into_iter());
    }
}

/// [`merge`] for any number of cells: sums in double precision around the first lit one.
fn merge_many(members: &[Cell]) -> Cell {
    let members = || members.iter().filter(|member| member.luminance > 0.0);
    let Some(first) = members().next() else { return Cell::default() };
    let mut luminance = 0.0;
    let (mut energy, mut offset) = (DVec3::ZERO, DVec3::ZERO);
    let (mut diagonal, mut mixed) = (DVec3::ZERO, DVec3::ZERO);
    for member in members() {
        let share = f64::from(member.luminance);
        let apart = (member.patch.centroid - first.patch.centroid).as_dvec3();
        luminance += share;
        energy += member.energy.as_dvec3();
        offset += apart * share;
        diagonal += (member.patch.diagonal.as_dvec3() + apart * apart) * share;
        mixed += (member.patch.mixed.as_dvec3() + apart.yzx() * apart.zxy()) * share;
    }
    let offset = offset / luminance;
    let mut patch = Patch {
        centroid: (first.patch.centroid.as_dvec3() + offset).as_vec3(),
        diagonal: (diagonal / luminance - offset * offset).as_vec3(),
        mixed: (mixed / luminance - offset.yzx() * offset.zxy()).as_vec3(),
        radius: 0.0,
    };
    let mut union = Cell { energy: energy.as_vec3(), luminance: luminance as f32, ..Cell::default() };
    for member in members() {
        let apart = member.patch.centroid - patch.centroid;
        patch.radius = patch.radius.max((apart.length() + member.patch.radius) * (1.0 + 1e-6));
        union.absorb_tints(member, apart);
    }
    Cell { patch, ..union }
}

/// Merges cells, centred by luminance; cells without energy contribute nothing.
fn merge<'a>(members: impl ExactSizeIterator<Item = &'a Cell> + Clone) -> Cell {
    if members.len() == 1
        && let Some(only) = members.clone().next()
    {
        return *only;
    }
    let members = || members.clone().filter(|member| member.luminance > 0.0);
    let mut union = Cell::default();
    let mut offset = Vec3::ZERO;
    for member in members() {
        if union.luminance == 0.0 {
            union.patch.centroid = member.patch.centroid;
        }
        union.luminance += member.luminance;
        union.energy += member.energy;
        // Sum differences, which float32 resolves.
        offset += (member.patch.centroid - union.patch.centroid) * member.luminance;
    }
    if union.luminance == 0.0 {
        return union;
    }
    let share = 1.0 / union.luminance;
    union.patch.centroid += offset * share;
    for member in members() {
        let apart = member.patch.centroid - union.patch.centroid;
        let share = member.luminance * share;
        union.patch.diagonal += (member.patch.diagonal + apart * apart) * share;
        union.patch.mixed += (member.patch.mixed + apart.yzx() * apart.zxy()) * share;
        union.patch.radius = union.patch.radius.max((apart.length() + member.patch.radius) * (1.0 + 1e-6));
        union.absorb_tints(member, apart);
    }
    union
}

impl Quad {
    fn new(siblings: [&Cell; 4]) -> Self {
        let field = |get: fn(&Cell) -> f32| siblings.map(get);
        let tints = |channel: usize| {
            let siblings = siblings.map(|cell| cell.tints[channel].to_fields());
            std::array::from_fn(|f| siblings.map(|fields| fields[f]))
        };
        Self {
            x: field(|cell| cell.patch.centroid.x),
            y: field(|cell| cell.patch.centroid.y),
            z: field(|cell| cell.patch.centroid.z),
            covariance: [
                field(|cell| cell.patch.diagonal.x),
                field(|cell| cell.patch.diagonal.y),
                field(|cell| cell.patch.diagonal.z),
                field(|cell| cell.patch.mixed.x),
                field(|cell| cell.patch.mixed.y),
                field(|cell| cell.patch.mixed.z),
            ],
            radius: field(|cell| cell.patch.radius),
            luminance: field(|cell| cell.luminance),
            red: field(|cell| cell.energy.x),
            green: field(|cell| cell.energy.y),
            blue: field(|cell| cell.energy.z),
            red_tint: tints(0),
            blue_tint: tints(1),
        }
    }
}
