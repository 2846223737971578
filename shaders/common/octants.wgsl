// Octants of the octahedral map, numbered by bits: 1 for x < 0, 2 for y < 0, 4 for z < 0.

fn signs_of_octant(octant: u32) -> vec3<f32> {
    let negative = (vec3<u32>(octant) & vec3<u32>(1u, 2u, 4u)) != vec3<u32>();
    return select(vec3<f32>(1.0), vec3<f32>(-1.0), negative);
}

// The octant of a pixel's centre in a map of `squares` squares of even edge `size`.
fn octant_of_pixel(squares: u32, size: u32, pixel: vec2<u32>) -> u32 {
    if squares == 2u {
        return octant_in_rectangle(size, pixel);
    }
    return octant_in_square(size, pixel);
}

// The quadratic layout, in integers: no centre lies on an axis,
// and those on a fold diagonal belong to y >= 0.
fn octant_in_square(size: u32, pixel: vec2<u32>) -> u32 {
    // Distances from the axes in half pixels.
    let from_axes = abs(2 * vec2<i32>(pixel) + 1 - i32(size));
    let lower = from_axes.x + from_axes.y > i32(size);
    let left = 2u * pixel.x < size;
    let back = 2u * pixel.y < size;
    return select(0u, 1u, left) | select(0u, 2u, lower) | select(0u, 4u, back);
}

// The rectangular layout: y >= 0 in the left square. No centre lies on the squares' sides; those on the
// diagonals, where x = 0 or z = 0, belong to the positive side.
fn octant_in_rectangle(size: u32, pixel: vec2<u32>) -> u32 {
    let is_lower = pixel.x >= size;
    let column = select(pixel.x, pixel.x - size, is_lower);
    // Distances from the square's middle in half pixels.
    let across = 2 * i32(column) + 1 - i32(size);
    let down = 2 * i32(pixel.y) + 1 - i32(size);
    let towards_x = select(across, -across, is_lower);
    return select(0u, 1u, down + towards_x < 0) | select(0u, 2u, is_lower)
        | select(0u, 4u, down - towards_x < 0);
}
