//! The octahedral map by perspective projections, one frustum a face.
//!
//! Engelhardt and Dachsbacher 2008, section 3.2. A face's frustum has its apex in the octahedron's centre
//! and its edges through the face's three vertices; its image plane is m.p = 1 for a normal m with positive
//! components, mirrored into the other octants. The frustum's edges meet that plane in a triangle, which
//! goes to the layout's triangle affinely: the point of direction d has the barycentric coordinates m_k
//! |d_k| / (m.|d|), and so (ax, by, cz) / (ax + by + cz) with (a, b, c) = m. With the face as image plane,
//! m = (1, 1, 1), this is the planar projection. Every other plane samples less evenly: see `docs/maps.md`.

use super::map::{Place, SphereMap, Texel};
use super::octahedral::{
    mirrored_oct, oct_from_direction, octahedron_from_oct, rectangle_solid_angle, wrap_oct, wrap_texel,
};
use glam::{DVec2, DVec3};

/// The map for a given image plane normal. Wrapping is that of [`super::octahedral`].
#[derive(Clone, Copy, Debug)]
pub struct OctahedralPerspective {
    normal: DVec3,
}

/// With the faces as image planes: the planar projection, in [`super::octahedral`]'s layout.
pub const PLANAR: OctahedralPerspective = OctahedralPerspective::with_image_plane(DVec3::ONE);

impl OctahedralPerspective {
    /// The map whose image plane in the octant x, y, z >= 0 has the normal `normal`, of any length.
    ///
    /// # Panics
    /// If a component is not positive: the frustum would not intersect the plane.
    pub const fn with_image_plane(normal: DVec3) -> Self {
        assert!(normal.x > 0.0 && normal.y > 0.0 && normal.z > 0.0, "the image plane crosses the frustum");
        Self { normal }
    }
}

impl SphereMap for OctahedralPerspective {
    fn direction(&self, _: u32, uv: DVec2) -> DVec3 {
        (octahedron_from_oct(wrap_oct(uv)) / self.normal).normalize()
    }

    fn locate(&self, direction: DVec3) -> Place {
        Place { component: 0, uv: oct_from_direction(direction * self.normal) }
    }

    fn density(&self, _: u32, uv: DVec2) -> f64 {
        let squared = (octahedron_from_oct(uv) / self.normal).length_squared();
        1.0 / (squared * squared.sqrt() * self.normal.x * self.normal.y * self.normal.z)
    }

    fn solid_angle(&self, _: u32, low: DVec2, high: DVec2) -> f64 {
        rectangle_solid_angle(low, high, |p| p / self.normal)
    }

    fn wrap_texel(&self, size: u32, component: u32, x: i64, y: i64) -> Option<Texel> {
        let (x, y) = wrap_texel(size, x, y);
        Some(Texel { component, x, y })
    }

    fn mirrored(&self, place: Place, axis: usize) -> Option<Place> {
        Some(Place { uv: mirrored_oct(place.uv, axis), ..place })
    }
}
