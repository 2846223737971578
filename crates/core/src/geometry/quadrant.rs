//! Tables of squares whose texels are mirror images of each other.

use crate::common::parallel;
use glam::Vec3;

/// What a table holds of a texel, of a square in x and z. Numbers are those of all mirror images.
pub trait Mirrored: Copy + Default + Send + Sync {
    /// That of the mirror image in the diagonal x = z.
    fn turned(self) -> Self {
        self
    }

    /// That of a mirror image along the axes, where `signs` are negative.
    fn mirrored(self, signs: Vec3) -> Self {
        let _ = signs;
        self
    }
}

impl Mirrored for f32 {}
impl Mirrored for f64 {}

/// Values of the texels of a square that is symmetric in both axes and both diagonals.
#[derive(Debug)]
pub struct Quadrant<T> {
    side: u32,
    values: Vec<T>,
}

impl<T: Mirrored> Quadrant<T> {
    /// Of a square of `side` texels. `value` is called for one of each pair in the quadrant of the greatest
    /// columns and rows.
    pub(crate) fn new(side: u32, value: impl Fn(u32, u32) -> T + Sync) -> Self {
        let half = side.div_ceil(2);
        let (first, edge) = (side - half, half as usize);
        let mut values = vec![T::default(); edge * edge];
        parallel::for_each(values.chunks_mut(edge.max(1)).zip(first..side), |(row, y)| {
            for (place, x) in row.iter_mut().zip(first..=y) {
                *place = value(x, y);
            }
        });
        for y in 0..edge {
            for x in y + 1..edge {
                values[y * edge + x] = values[x * edge + y].turned();
            }
        }
        Self { side, values }
    }

    /// Texels along an edge of the square.
    pub(crate) const fn side(&self) -> u32 {
        self.side
    }

    /// Those of the quadrant of the greatest columns and rows, row by row.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The value of the texel in column `x` and row `y`.
    #[inline]
    pub fn at(&self, x: u32, y: u32) -> T {
        let half = self.side.div_ceil(2);
        let first = self.side - half;
        let fold = |k: u32| if k >= first { (k - first, 1.0) } else { (half - 1 - k, -1.0) };
        let ((x, sign_x), (y, sign_z)) = (fold(x), fold(y));
        self.values[y as usize * half as usize + x as usize].mirrored(Vec3::new(sign_x, 1.0, sign_z))
    }
}
