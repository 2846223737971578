//! Rays through the pixels of an octahedral map, in either layout, against triangles: what drawing into the
//! map must show.
//!
//! A ray from the origin along p meets the triangle a, b, c at the point of barycentric coordinates l /
//! sum(l) with l = [a b c]^-1 p, by Cramer's rule. With |p| = 1 in the 1-norm, the point is at distance 1 /
//! sum(l) in that norm. No projection, clipping or rasterisation takes part.

use glam::{DVec2, DVec3};
use octagloss::internals::direct::{Corner, DirectMap, Triangles, check_near};
use octagloss::internals::sphere::octahedral::{octahedron_from_oct, texel_centre};
use octagloss::{Error, Result};

/// Distance from an edge, in pixels, below which rasterisers may decide either way: they snap corners to a
/// sixteenth of a pixel at the coarsest (Vulkan's four bits).
pub(crate) const DOUBT: f64 = 1.0 / 16.0;

/// Sine of the angle between a triangle's plane and the origin, relative to its corners, below which double
/// precision does not resolve on which side the origin is.
const EDGE_ON: f64 = 1e-13;

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// Index of the triangle.
    pub(crate) triangle: usize,
    /// `near` over the distance in the 1-norm.
    pub(crate) depth: f64,
    /// The corners' values, interpolated in space.
    pub(crate) value: [f64; 4],
    /// Greatest change of the depth within a pixel, to first order.
    pub(crate) depth_change: f64,
    /// Greatest change of each value.
    pub(crate) value_change: [f64; 4],
}

/// A pixel and a triangle that it may show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cover {
    /// More than [`DOUBT`] inside the triangle.
    Inside(Hit),
    /// Closer to an edge, or to the cut by the near surface; for a triangle in a plane through the origin, to
    /// that plane.
    Doubtful,
    /// Outside.
    Outside,
}

/// The corners of triangle `index`.
pub(crate) fn corners_of(triangles: &Triangles, index: usize) -> [Corner; 3] {
    std::array::from_fn(|k| triangles.corners()[triangles.indices()[3 * index + k] as usize])
}

/// Triangles seen from the origin, in an octahedral map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleOracle<'a> {
    triangles: &'a Triangles,
    map: DirectMap,
    near: f64,
}

impl<'a> TriangleOracle<'a> {
    /// An oracle for `map`. Points nearer than `near` in the 1-norm are invisible.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a cube, an odd size, 0, or an invalid `near`.
    pub(crate) fn new(triangles: &'a Triangles, map: DirectMap, near: f32) -> Result<Self> {
        check_near(near)?;
        let size = map.size();
        if !map.is_octahedral() {
            return Err(Error::Parameter(format!("{map:?} has no octants; choose an octahedral map")));
        }
        if size == 0 || size % 2 == 1 {
            return Err(Error::Parameter(format!("a map of {size} x {size} pixels; choose an even size")));
        }
        Ok(Self { triangles, map, near: f64::from(near) })
    }

    /// The point on the octahedron at the centre of pixel (`x`, `y`), and how it moves along rows and columns
    /// of pixels, in the octant of that centre.
    fn point(&self, x: u32, y: u32) -> [DVec3; 3] {
        let size = self.map.size();
        let pixel = 2.0 / f64::from(size);
        let sign = |t: f64| if t >= 0.0 { 1.0 } else { -1.0 };
        if self.map.squares() == 1 {
            let uv = texel_centre(size, x, y);
            let p = octahedron_from_oct(uv);
            let (sx, sz) = (sign(uv.x), sign(uv.y));
            return if p.y >= 0.0 {
                [p, pixel * DVec3::new(1.0, -sx, 0.0), pixel * DVec3::new(0.0, -sz, 1.0)]
            } else {
                [p, pixel * DVec3::new(0.0, -sx, -sx * sz), pixel * DVec3::new(-sx * sz, -sz, 0.0)]
            };
        }
        // x and z are half the sum and the difference of the coordinates from the square's middle, of which
        // the lower square is the mirror image. In halves of pixels they are integers, so that 0 is exact.
        let lower = x >= size;
        let from_middle = |at: u32| 2.0 * f64::from(at % size) + 1.0 - f64::from(size);
        let half = if lower { -0.5 } else { 0.5 };
        let (across, down) = (half * from_middle(x), 0.5 * from_middle(y));
        let on_plane = |x: f64, z: f64, height: f64| DVec3::new(x, 2.0 * half * height, z) * pixel;
        let (px, pz) = (down + across, down - across);
        let (sx, sz) = (sign(px), sign(pz));
        [
            on_plane(0.5 * px, 0.5 * pz, 0.5 * (f64::from(size) - px.abs() - pz.abs())),
            on_plane(half, -half, half * (sz - sx)),
            on_plane(0.5, 0.5, -0.5 * (sx + sz)),
        ]
    }

    /// Triangle `index` at pixel (`x`, `y`).
    pub(crate) fn cover(&self, x: u32, y: u32, index: usize) -> Cover {
        let corners = corners_of(self.triangles, index);
        let [a, b, c] = corners.map(|corner| DVec3::from_array(corner.position.map(f64::from)));
        let [p, along_row, along_column] = self.point(x, y);
        let gradient = |normal: DVec3| DVec2::new(normal.dot(along_row), normal.dot(along_column));
        // Distance in pixels from the line where a linear function vanishes.
        let distance = |height: f64, gradient: DVec2| match height {
            0.0 => 0.0,
            _ => height / gradient.length(),
        };

        let normals = [b.cross(c), c.cross(a), a.cross(b)];
        let determinant = a.dot(normals[0]);
        let heights = normals.map(|normal| normal.dot(p));
        let gradients = normals.map(gradient);
        if determinant.abs() <= EDGE_ON * a.length() * b.length() * c.length() {
            return self.edge_on([a, b, c], normals, p, |k| distance(heights[k], gradients[k]).abs());
        }
        let weights = heights.map(|height| height / determinant);
        let weight_gradients = gradients.map(|gradient| gradient / determinant);
        let sum: f64 = weights.iter().sum();
        let sum_gradient: DVec2 = weight_gradients.iter().sum();
        let depth = self.near * sum;
        let depth_gradient = self.near * sum_gradient;
        let least = (0..3)
            .map(|k| distance(weights[k], weight_gradients[k]))
            .fold(distance(1.0 - depth, depth_gradient), f64::min);
        // Behind the viewer a weight is negative.
        if least < -DOUBT {
            return Cover::Outside;
        }
        if least <= DOUBT {
            return Cover::Doubtful;
        }
        let values = corners.map(|corner| corner.value.map(f64::from));
        let mean = |weights: [f64; 3], k: usize| (0..3).map(|i| weights[i] * values[i][k]).sum::<f64>();
        let value = std::array::from_fn(|k| mean(weights, k) / sum);
        // The gradient of a quotient.
        let change = |k: usize| {
            let across: DVec2 = (0..3).map(|i| weight_gradients[i] * values[i][k]).sum();
            ((across - sum_gradient * value[k]) / sum).length()
        };
        Cover::Inside(Hit {
            triangle: index,
            depth,
            value,
            depth_change: depth_gradient.length(),
            value_change: std::array::from_fn(change),
        })
    }

    /// A triangle in a plane through the origin, which is seen from its edge: a line at most.
    fn edge_on(
        &self,
        corners: [DVec3; 3],
        normals: [DVec3; 3],
        p: DVec3,
        distance: impl Fn(usize) -> f64,
    ) -> Cover {
        let scale = corners.iter().map(|corner| corner.length()).fold(0.0, f64::max);
        let has_plane = |k: &usize| normals[*k].length() > EDGE_ON.sqrt() * scale * scale;
        if let Some(far) = (0..3).filter(has_plane).map(distance).reduce(f64::max) {
            return if far > DOUBT { Cover::Outside } else { Cover::Doubtful };
        }
        // All corners on one line through the origin: a point. The map's density varies by less than 3.
        let angle = 3.0 * 2.0 / f64::from(self.map.size());
        let is_close = |corner: &DVec3| corner.cross(p).length() <= angle * corner.length() * p.length();
        if corners.iter().any(is_close) { Cover::Doubtful } else { Cover::Outside }
    }

    /// Every triangle that pixel (`x`, `y`) certainly shows, and the number of others that it may show.
    pub(crate) fn pixel(&self, x: u32, y: u32) -> (Vec<Hit>, usize) {
        let mut hits = Vec::new();
        let mut doubtful = 0;
        for index in 0..self.triangles.count() {
            match self.cover(x, y, index) {
                Cover::Inside(hit) => hits.push(hit),
                Cover::Doubtful => doubtful += 1,
                Cover::Outside => {}
            }
        }
        (hits, doubtful)
    }
}
