// Real spherical harmonics to order 4: `basis` of crates/core/src/light/sh/coefficients.rs.

// Evaluates the basis at the unit vector `d`.
fn harmonic_basis(d: vec3<f32>) -> array<f32, 25> {
    let x = d.x;
    let y = d.y;
    let z = d.z;
    let xx = x * x;
    let yy = y * y;
    let zz = z * z;
    return array<f32, 25>(
        0.28209479,
        0.48860251 * y,
        0.48860251 * z,
        0.48860251 * x,
        1.09254843 * x * y,
        1.09254843 * y * z,
        0.31539157 * (3.0 * zz - 1.0),
        1.09254843 * x * z,
        0.54627422 * (xx - yy),
        0.59004359 * y * (3.0 * xx - yy),
        2.89061144 * x * y * z,
        0.45704580 * y * (5.0 * zz - 1.0),
        0.37317633 * z * (5.0 * zz - 3.0),
        0.45704580 * x * (5.0 * zz - 1.0),
        1.44530572 * z * (xx - yy),
        0.59004359 * x * (xx - 3.0 * yy),
        2.50334294 * x * y * (xx - yy),
        1.77013077 * y * z * (3.0 * xx - yy),
        0.94617470 * x * y * (7.0 * zz - 1.0),
        0.66904654 * y * z * (7.0 * zz - 3.0),
        0.10578555 * (35.0 * zz * zz - 30.0 * zz + 3.0),
        0.66904654 * x * z * (7.0 * zz - 3.0),
        0.47308735 * (xx - yy) * (7.0 * zz - 1.0),
        1.77013077 * x * z * (xx - 3.0 * yy),
        0.62583574 * (xx * xx - 6.0 * xx * yy + yy * yy));
}
