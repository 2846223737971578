// Positions of the blurred tables: `Octaves` of src/gpu/fitted.rs.

// Border of every blurred square, in texels.
const OCTAVE_BORDER = 40u;

struct OctaglossOctave {
    // Texels along an edge of the grid to blur, and of the box that blurs it when applied twice.
    fine: u32,
    box_side: u32,
    // Texels along an edge of the blurred square.
    coarse: u32,
    // Entries along an edge of its table: the bordered square plus a first row and column of zeros.
    side: u32,
    // Its first texel, entry, tile and row in the arrays over all octaves.
    first_texel: u32,
    first_entry: u32,
    first_tile: u32,
    first_row: u32,
}

struct OctaglossModel {
    // Boxes per lobe, the first row of their parameters, and the first box that reads the next wider blur.
    boxes: u32,
    first_parameters: u32,
    first_wider: u32,
    // Intervals of the grid of nodes along a side.
    intervals: u32,
}

struct OctaglossOctaves {
    // Texels along an edge of the OEM's square.
    inner: u32,
    // The finest octave; the coarsest is 1.
    finest: u32,
    // Entries of all octaves: those of the next environment in the same buffer follow.
    entries: u32,
    // The least alpha that the tables resolve.
    sharpest: f32,
    // The boxes of most directions, and those around cone points: none if there are no others.
    models: array<OctaglossModel, 2>,
    // 1 over pi times the lobe's integral as a polynomial over roughness 0.09 to 1, lowest power first, four
    // coefficients per vector.
    peak: array<vec4<f32>, 3>,
    // Convolution weights of harmonics of order 1 to 4 as polynomials over roughness 0.65 to 1, lowest power
    // first.
    zonal: array<vec4<f32>, 8>,
    // Octaves from 1 on.
    octaves: array<OctaglossOctave, 7>,
}
