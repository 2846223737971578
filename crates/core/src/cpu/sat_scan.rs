//! Scans of an OEM into an exact summed-area table. All give the same bits.

use crate::common::parallel;
use crate::light::oem::Oem;
use crate::light::sat::{FixedPoint, Sat, Scan};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU8, Ordering};

impl Sat {
    /// The table of `oem`.
    ///
    /// # Panics
    /// If a Hensley radix is below 2.
    pub fn new(oem: &Oem, scan: Scan) -> Self {
        let fixed = FixedPoint::of_square(oem);
        let side = oem.size().bordered() as usize;
        let mut entries = vec![[0; 4]; side * side];
        self::scan(scan, fixed, oem.texels(), side, &mut entries);
        Self::from_entries(oem.size(), fixed, entries)
    }
}

/// Fills `out` with the inclusive sums of `texels`, with rows of `width`.
///
/// # Panics
/// If `out` has not the size of `texels`, if that is not a whole number of rows, or if a Hensley radix is
/// below 2.
pub fn scan(scan: Scan, fixed: FixedPoint, texels: &[[f32; 4]], width: usize, out: &mut [[u64; 4]]) {
    assert!(
        width > 0 && texels.len().is_multiple_of(width) && out.len() == texels.len(),
        "whole rows, and as many out"
    );
    if texels.is_empty() {
        return;
    }
    match scan {
        Scan::Serial => serial(fixed, texels, width, out),
        Scan::Blocks => blocks(fixed, texels, width, out),
        Scan::Hensley { radix } => hensley(radix, fixed, texels, width, out),
    }
}

#[inline(always)]
fn add(a: [u64; 4], b: [u64; 4]) -> [u64; 4] {
    std::array::from_fn(|k| a[k].wrapping_add(b[k]))
}

fn serial(fixed: FixedPoint, texels: &[[f32; 4]], width: usize, out: &mut [[u64; 4]]) {
    for k in 0..texels.len() {
        let (x, y) = (k % width, k / width);
        let left = if x > 0 { out[k - 1] } else { [0; 4] };
        let above = if y > 0 { out[k - width] } else { [0; 4] };
        let corner = if x > 0 && y > 0 { out[k - width - 1] } else { [0; 4] };
        let value = fixed.quantise(texels[k]);
        out[k] = std::array::from_fn(|c| {
            value[c].wrapping_add(left[c]).wrapping_add(above[c]).wrapping_sub(corner[c])
        });
    }
}

/// Rows of a block. One block of one strip is a task, long enough to be worth scheduling.
const BLOCK_ROWS: usize = 32;

/// One strip of columns per thread. A block of rows of one strip needs the block above it and the sums along
/// its rows from the strip to the left, so the blocks are processed as a wavefront: the input is read once
/// and the output written once.
fn blocks(fixed: FixedPoint, texels: &[[f32; 4]], width: usize, out: &mut [[u64; 4]]) {
    let wavefront = Wavefront::new(fixed, texels, width, out);
    rayon::scope(|scope| wavefront.run(scope, 0, 0));
}

/// Columns from `left` on, as a piece of every row.
struct Strip<'a> {
    left: usize,
    rows: Vec<&'a mut [[u64; 4]]>,
}

struct Wavefront<'a> {
    fixed: FixedPoint,
    texels: &'a [[f32; 4]],
    width: usize,
    strips: Vec<Mutex<Strip<'a>>>,
    /// Sums along the rows of each block, up to the last finished strip.
    carries: Vec<Mutex<[[u64; 4]; BLOCK_ROWS]>>,
    /// Number of blocks that each block of each strip still waits for.
    waits: Vec<AtomicU8>,
    arch: crate::common::vector::Arch,
}

impl<'a> Wavefront<'a> {
    fn new(fixed: FixedPoint, texels: &'a [[f32; 4]], width: usize, out: &'a mut [[u64; 4]]) -> Self {
        let height = texels.len() / width;
        let columns = width.div_ceil(rayon::current_num_threads());
        let mut strips: Vec<Strip<'_>> = (0..width)
            .step_by(columns)
            .map(|left| Strip { left, rows: Vec::with_capacity(height) })
            .collect();
        for row in out.chunks_exact_mut(width) {
            for (strip, piece) in strips.iter_mut().zip(row.chunks_mut(columns)) {
                strip.rows.push(piece);
            }
        }
        let blocks = height.div_ceil(BLOCK_ROWS);
        let waits = (0..strips.len() * blocks)
            .map(|task| AtomicU8::new(u8::from(task >= blocks) + u8::from(task % blocks > 0)))
            .collect();
        let carries = (0..blocks).map(|_| Mutex::new([[0; 4]; BLOCK_ROWS])).collect();
        let strips = strips.into_iter().map(Mutex::new).collect();
        Self { fixed, texels, width, strips, carries, waits, arch: crate::common::vector::Arch::new() }
    }

    /// Processes `block` of `strip` and all blocks that become ready.
    fn run<'s>(&'s self, scope: &rayon::Scope<'s>, mut strip: usize, mut block: usize) {
        loop {
            self.sum(strip, block);
            let right = strip + 1 < self.strips.len() && self.is_free(strip + 1, block);
            let below = block + 1 < self.carries.len() && self.is_free(strip, block + 1);
            match (right, below) {
                (true, true) => {
                    scope.spawn(move |scope| self.run(scope, strip + 1, block));
                    block += 1;
                }
                (true, false) => strip += 1,
                (false, true) => block += 1,
                (false, false) => return,
            }
        }
    }

    /// Records one finished dependency; true if none is left.
    fn is_free(&self, strip: usize, block: usize) -> bool {
        self.waits[strip * self.carries.len() + block].fetch_sub(1, Ordering::AcqRel) == 1
    }

    fn sum(&self, strip: usize, block: usize) {
        const ALONE: &str = "no two tasks share a strip or a block at once";
        let mut strip = self.strips[strip].try_lock().expect(ALONE);
        let mut carries = self.carries[block].try_lock().expect(ALONE);
        let Strip { left, rows } = &mut *strip;
        let (above, rows) = rows.split_at_mut(block * BLOCK_ROWS);
        self.arch.dispatch(BlockSums {
            fixed: self.fixed,
            texels: &self.texels[block * BLOCK_ROWS * self.width + *left..],
            width: self.width,
            above: above.last().map(|row| &**row),
            rows: &mut rows[..],
            carries: &mut *carries,
        });
    }
}

/// The table of a block below the row `above` and to the right of the sums `carries`, which it updates.
struct BlockSums<'a, 'b> {
    fixed: FixedPoint,
    /// From the block's first texel on, with rows of `width`.
    texels: &'a [[f32; 4]],
    width: usize,
    above: Option<&'a [[u64; 4]]>,
    rows: &'a mut [&'b mut [[u64; 4]]],
    carries: &'a mut [[u64; 4]],
}

impl pulp::NullaryFnOnce for BlockSums<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let zeros;
        let mut above = match self.above {
            Some(above) => above,
            None => {
                zeros = vec![[0; 4]; self.rows[0].len()];
                &zeros
            }
        };
        for ((row, texels), carry) in
            self.rows.iter_mut().zip(self.texels.chunks(self.width)).zip(self.carries)
        {
            let mut run = *carry;
            for ((out, texel), above) in row.iter_mut().zip(texels).zip(above) {
                run = add(run, self.fixed.quantise(*texel));
                *out = add(run, *above);
            }
            *carry = run;
            above = row;
        }
    }
}

/// Passes of out[i] = sum over k < radix of in[i - k * radix^pass], along rows until they are summed, then
/// along columns, ping-pong.
fn hensley(radix: u32, fixed: FixedPoint, texels: &[[f32; 4]], width: usize, out: &mut [[u64; 4]]) {
    assert!(radix >= 2, "a radix of at least 2");
    let height = texels.len() / width;
    let passes: Vec<(usize, usize)> = [(width, 1), (height, width)]
        .into_iter()
        .flat_map(|(length, step)| {
            std::iter::successors(Some(1), |stride| Some(stride * radix as usize))
                .take_while(move |stride| *stride < length)
                .map(move |stride| (step, stride))
        })
        .collect();
    let mut other = vec![[0; 4]; texels.len()];
    // The last pass writes `out`.
    let (mut front, mut back) =
        if passes.len().is_multiple_of(2) { (out, &mut other[..]) } else { (&mut other[..], out) };
    parallel::for_each(std::iter::zip(front.chunks_mut(width), texels.chunks(width)), |(values, texels)| {
        std::iter::zip(values, texels).for_each(|(value, texel)| *value = fixed.quantise(*texel));
    });
    for (step, stride) in passes {
        let from = &*front;
        parallel::for_each(back.chunks_mut(width).enumerate(), |(y, row)| {
            for (x, value) in row.iter_mut().enumerate() {
                let (k, along) = (y * width + x, if step == 1 { x } else { y });
                *value = (0..radix as usize)
                    .take_while(|sample| sample * stride <= along)
                    .fold([0; 4], |sum, sample| add(sum, from[k - sample * stride * step]));
            }
        });
        std::mem::swap(&mut front, &mut back);
    }
}
