// Where the blurred table of each octave lies: `Octaves` of src/gpu/blur.rs.

struct OctaglossOctave {
    // Texels along an edge of the grid that is blurred, and of the box that blurs it when applied twice.
    fine: u32,
    box_side: u32,
    // Texels along an edge of the blurred square.
    coarse: u32,
    // Entries along an edge of its table: those of the bordered square and a first row and column of zeros.
    side: u32,
    // The first of its texels, of its entries, of the tiles that it is blurred in, and of its rows among all
    // octaves'.
    first_texel: u32,
    first_entry: u32,
    first_tile: u32,
    first_row: u32,
}

struct OctaglossOctaves {
    // Texels along an edge of the OEM's square.
    inner: u32,
    // The finest octave; the coarsest is 1.
    finest: u32,
    // Texels of border around every blurred square.
    border: u32,
    // Boxes of a lobe, the first row of their parameters, and the first box that reads a blur twice as wide.
    boxes: u32,
    first_parameters: u32,
    first_wider: u32,
    // The least alpha that the tables resolve.
    sharpest: f32,
    pad_0: u32,
    // 1 over pi times a lobe's integral as a polynomial over roughness 0.13 to 1, lowest power first, four to
    // a vector.
    peak: array<vec4<f32>, 3>,
    // What convolution leaves of harmonics of order 1 to 4, as polynomials over roughness 0.65 to 1, lowest
    // power first.
    zonal: array<vec4<f32>, 8>,
    // By octave, from 1 on.
    octaves: array<OctaglossOctave, 6>,
}
