// Tone-maps the linear picture for the display: `Present` of crates/view/src/picture/present.rs. The picture
// holds exposed radiance.

struct Present {
    // Upper left corner and size of the picture in the target, and size of the linear picture, in pixels.
    origin: vec2<f32>,
    size: vec2<f32>,
    source: vec2<f32>,
    // 0 neutral, 1 ACES, 2 Reinhard, 3 linear.
    tone: u32,
}

@group(0) @binding(0) var<uniform> present: Present;
@group(0) @binding(1) var picture: texture_2d<f32>;

@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0);
}

// Khronos PBR Neutral: colours below 0.76 keep their hue and chroma except for the Fresnel offset; brighter
// colours are compressed and fade to white.
fn neutral(colour: vec3<f32>) -> vec3<f32> {
    let start = 0.8 - 0.04;
    let least = min(colour.r, min(colour.g, colour.b));
    let offset = select(0.04, least - 6.25 * least * least, least < 0.08);
    let moved = colour - offset;
    let peak = max(moved.r, max(moved.g, moved.b));
    if peak < start {
        return moved;
    }
    let room = 1.0 - start;
    let compressed = 1.0 - room * room / (peak + room - start);
    let white = 1.0 - 1.0 / (0.15 * (peak - compressed) + 1.0);
    return mix(moved * (compressed / peak), vec3<f32>(compressed), white);
}

fn aces(colour: vec3<f32>) -> vec3<f32> {
    return colour * (2.51 * colour + 0.03) / (colour * (2.43 * colour + 0.59) + 0.14);
}

fn toned(colour: vec3<f32>) -> vec3<f32> {
    switch present.tone {
        case 0u: {
            return neutral(colour);
        }
        case 1u: {
            return aces(colour);
        }
        case 2u: {
            return colour / (1.0 + colour);
        }
        default: {
            return colour;
        }
    }
}

fn srgb(linear: vec3<f32>) -> vec3<f32> {
    let x = clamp(linear, vec3<f32>(0.0), vec3<f32>(1.0));
    return select(1.055 * pow(x, vec3<f32>(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3<f32>(0.0031308));
}

fn texel(at: vec2<i32>) -> vec3<f32> {
    return toned(textureLoad(picture, clamp(at, vec2<i32>(0), vec2<i32>(present.source) - 1), 0).rgb);
}

// Tone-maps before averaging, so that edges of bright objects are as wide as others.
@fragment
fn show(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let scale = present.source / present.size;
    let place = at.xy - present.origin;
    let many = vec2<i32>(round(scale));
    var sum = vec3<f32>();
    if all(many >= vec2<i32>(1)) {
        // Average whole texels.
        let first = vec2<i32>(floor(place)) * many;
        for (var j = 0; j < many.y; j++) {
            for (var i = 0; i < many.x; i++) {
                sum += texel(first + vec2<i32>(i, j));
            }
        }
        sum /= f32(many.x * many.y);
    } else {
        let source = place * scale - 0.5;
        let low = vec2<i32>(floor(source));
        let share = source - floor(source);
        sum = mix(
            mix(texel(low), texel(low + vec2<i32>(1, 0)), share.x),
            mix(texel(low + vec2<i32>(0, 1)), texel(low + 1), share.x), share.y);
    }
    return vec4<f32>(srgb(sum), 1.0);
}
