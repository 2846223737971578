// Expected pictures of a sphere from the program's queries, and their difference from rendered ones.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, s, b) => a.map((v, c) => v + s * b[c]);
const unit = (a) => a.map((v) => v / Math.hypot(...a));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// Right and up vectors of a viewer at `eye` (a unit vector) looking at the origin.
function axesOf(eye) {
    const right = unit(cross(Math.abs(eye[1]) > 0.9 ? [0, 0, 1] : [0, 1, 0], eye));
    return [right, cross(eye, right)];
}

// Pixels of an orthographic view of the unit sphere from `eye` (a unit vector), rows upwards: index, normal
// and mirrored view direction. Excludes the rim, where a pixel covers many normals.
export function spherePixels(size, eye, step, [right, up] = axesOf(eye)) {
    const pixels = [];
    for (let j = step >> 1; j < size; j += step) {
        for (let i = step >> 1; i < size; i += step) {
            const [x, y] = [(2 * i + 1) / size - 1, (2 * j + 1) / size - 1];
            const rr = x * x + y * y;
            if (rr > 0.8) continue;
            const normal = unit([0, 1, 2].map((c) => right[c] * x + up[c] * y + eye[c] * Math.sqrt(1 - rr)));
            const cosine = dot(normal, eye);
            pixels.push({
                at: j * size + i,
                normal,
                cosine,
                mirrored: unit(
                    add(
                        eye.map((v) => -v),
                        2 * cosine,
                        normal,
                    ),
                ),
            });
        }
    }
    return pixels;
}

// Look-up direction of both engines: the mirrored one, bent towards the normal by roughness^4 (three:
// envmap_physical_pars_fragment.glsl.js; Filament: getReflectedVector in surface_light_indirect.fs).
export const drawn = ({ mirrored, normal }, roughness) =>
    unit(
        add(
            mirrored.map((v) => v * (1 - roughness ** 4)),
            roughness ** 4,
            normal,
        ),
    );

// Single-scattering reflectance of a white GGX metal for the view's cosine: height-correlated Smith, by 4096
// points, for the mean over tangents.
export function reflected(cosine, roughness, anisotropy = 0) {
    const across = roughness * roughness;
    const along = across + (1 - across) * anisotropy ** 2;
    const masking = ([x, y, z]) => Math.hypot(along * x, across * y, z);
    const sine = Math.sqrt(1 - cosine * cosine);
    const count = 4096;
    let sum = 0;
    for (let k = 0; k < count; k++) {
        let bits = 0;
        for (let b = 0, n = k; b < 12; b++, n >>= 1) bits = bits * 2 + (n & 1);
        const [u, v] = [(k + 0.5) / count, (bits + 0.5) / count];
        // Turns by the golden ratio, which no pattern of the points repeats.
        const turn = 2 * Math.PI * ((k * 0.6180339887) % 1);
        const view = [sine * Math.cos(turn), sine * Math.sin(turn), cosine];
        const slope = Math.sqrt(u / (1 - u));
        const facet = [along * Math.cos(2 * Math.PI * v), across * Math.sin(2 * Math.PI * v)];
        const half = unit([slope * facet[0], slope * facet[1], 1]);
        const vh = dot(view, half);
        const light = add(
            view.map((w) => -w),
            2 * vh,
            half,
        );
        if (light[2] <= 0 || vh <= 0) continue;
        const visibility = 0.5 / (light[2] * masking(view) + cosine * masking(light));
        sum += (visibility * light[2] * 4 * vh) / half[2];
    }
    return sum / count;
}

// Reflectance of a white sheen: Charlie's distribution, Ashikhmin's visibility, by 4096 points.
export function sheenReflected(cosine, roughness) {
    const alpha = roughness * roughness;
    const view = [Math.sqrt(1 - cosine * cosine), 0, cosine];
    const count = 4096;
    let sum = 0;
    for (let k = 0; k < count; k++) {
        // A lattice of equal solid angles.
        const [z, phi] = [(k + 0.5) / count, k * Math.PI * (3 - Math.sqrt(5))];
        const s = Math.sqrt(1 - z * z);
        const light = [s * Math.cos(phi), s * Math.sin(phi), z];
        const half = unit(add(view, 1, light));
        const distribution =
            ((2 + 1 / alpha) * Math.sqrt(1 - half[2] * half[2]) ** (1 / alpha)) / (2 * Math.PI);
        sum += (distribution * z) / (4 * (z + cosine - z * cosine));
    }
    return (2 * Math.PI * sum) / count;
}

const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

// Relative RMS error of the luminance of `shown` against `expected`, lists of colours.
export function relativeError(shown, expected) {
    if (shown.length !== expected.length || shown.length < 100)
        throw new Error(`${shown.length} pixels to compare`);
    const sum = (f) => shown.reduce((total, _, k) => total + f(k), 0);
    const error = sum((k) => [0, 1, 2].reduce((e, c) => e + (shown[k][c] - expected[k][c]) ** 2, 0) / 3);
    return Math.sqrt(error / sum((k) => luminance(expected[k]) ** 2));
}

// Greatest difference of a channel over the channel's greatest expected value.
export function channelError(shown, expected) {
    if (shown.length !== expected.length || shown.length < 100)
        throw new Error(`${shown.length} pixels to compare`);
    const error = (c) => {
        const greatest = Math.max(...expected.map((rgb) => rgb[c]));
        return Math.max(...expected.map((rgb, k) => Math.abs(shown[k][c] - rgb[c]))) / greatest;
    };
    return Math.max(...[0, 1, 2].map(error));
}

// View directions: the six sides of the world, and a corner.
export const EYES = [
    [1, 0, 0],
    [-1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [0, 0, 1],
    [0, 0, -1],
    unit([1, 0.7, -0.5]),
];

// `count` directions of equal solid angles.
export const lattice = (count) =>
    Array.from({ length: count }, (_, k) => {
        const [y, phi] = [1 - (2 * k + 1) / count, k * Math.PI * (3 - Math.sqrt(5))];
        const s = Math.sqrt(1 - y * y);
        return [s * Math.cos(phi), y, s * Math.sin(phi)];
    });

// Share of bands above the second in the irradiance of hdr/labelled.exr.
export const BANDS = 0.03;

// Pixels of a square view of 90 degrees `looking` along a unit vector, rows upwards: index and direction.
export function skyPixels(size, looking, step) {
    const right = unit(cross(looking, Math.abs(looking[1]) > 0.9 ? [0, 0, 1] : [0, 1, 0]));
    const up = cross(right, looking);
    const pixels = [];
    for (let j = step >> 1; j < size; j += step) {
        for (let i = step >> 1; i < size; i += step) {
            const [x, y] = [(2 * i + 1) / size - 1, (2 * j + 1) / size - 1];
            pixels.push({ at: j * size + i, direction: unit(add(add(looking, x, right), y, up)) });
        }
    }
    return pixels;
}
