// A reader of EXT_lights_image_based that follows the extension's text sentence by sentence:
// extensions/2.0/Vendor/EXT_lights_image_based/README.md of KhronosGroup/glTF. It shares no code with the
// program. Where the text is silent it follows Babylon.js: RGBD is in gamma 2.2, and cubes are looked up with
// x negated, from glTF's right-handed world into the left-handed one of cube maps. It takes the rotation as
// that of the environment; Babylon.js turns the other way.
import { decode } from 'fast-png';

const NAME = 'EXT_lights_image_based';
const GAMMA = 2.2;

// The JSON and the binary chunk of a .glb.
export function chunksOf(glb) {
    const view = new DataView(glb.buffer, glb.byteOffset, glb.byteLength);
    const [magic, version, length] = [0, 4, 8].map((at) => view.getUint32(at, true));
    if (magic !== 0x46546c67 || version !== 2 || length !== glb.length) throw new Error('no binary glTF 2');
    const chunks = [];
    for (let at = 12; at < length;) {
        const [size, kind] = [view.getUint32(at, true), view.getUint32(at + 4, true)];
        chunks.push({ kind, bytes: glb.subarray(at + 8, at + 8 + size) });
        at += 8 + size;
    }
    const [json, binary] = chunks;
    if (json.kind !== 0x4e4f534a || binary.kind !== 0x004e4942) throw new Error('chunks are not JSON, BIN');
    return { root: JSON.parse(new TextDecoder().decode(json.bytes)), binary: binary.bytes };
}

// A .glb of the two chunks.
export function withRoot(root, binary) {
    const text = new TextEncoder().encode(JSON.stringify(root));
    const padded = Math.ceil(text.length / 4) * 4;
    const bytes = new Uint8Array(28 + padded + binary.length).fill(0x20, 20, 20 + padded);
    const view = new DataView(bytes.buffer);
    const words = [0x46546c67, 2, bytes.length, padded, 0x4e4f534a];
    words.forEach((word, k) => view.setUint32(4 * k, word, true));
    bytes.set(text, 20);
    view.setUint32(20 + padded, binary.length, true);
    view.setUint32(24 + padded, 0x004e4942, true);
    bytes.set(binary, 28 + padded);
    return bytes;
}

// "PNG's - assumed to be HDR images packed in RGBD format", if they have four channels: RGB divided by alpha.
function rgbd(png) {
    const { width, height, channels, depth, data } = decode(png);
    if (channels !== 4 || depth !== 8 || width !== height) throw new Error(`${width}x${height}x${channels}`);
    const texel = (i, j) => {
        const at = 4 * (j * width + i);
        return [0, 1, 2].map((c) => (data[at + c] / 255) ** GAMMA / (data[at + 3] / 255));
    };
    // "each saved image must be flipped ... to correspond with the way glTF references texture space": the
    // first row is the lowest.
    return { size: width, texel: (i, j) => texel(i, height - 1 - j) };
}

// Face, s and t from 0 to 1 (OpenGL 4.6, table 8.19), in the extension's order: +X, -X, +Y, -Y, +Z, -Z.
function placeOf([x, y, z]) {
    const [a, b, c] = [Math.abs(x), Math.abs(y), Math.abs(z)];
    let [face, s, t, m] = [z > 0 ? 4 : 5, z > 0 ? x : -x, -y, c];
    if (a >= b && a >= c) [face, s, t, m] = [x > 0 ? 0 : 1, x > 0 ? -z : z, -y, a];
    else if (b >= c) [face, s, t, m] = [y > 0 ? 2 : 3, x, y > 0 ? z : -z, b];
    return [face, (s / m + 1) / 2, (t / m + 1) / 2];
}

// Bilinear within a face.
function faceAt({ size, texel }, s, t) {
    const clamped = (v) => Math.min(Math.max(v, 0), size - 1);
    const [x, y] = [clamped(s * size - 0.5), clamped(t * size - 0.5)];
    const [i, j] = [Math.floor(x), Math.floor(y)];
    const [u, v] = [x - i, y - j];
    const [right, below] = [Math.min(i + 1, size - 1), Math.min(j + 1, size - 1)];
    const corners = [texel(i, j), texel(right, j), texel(i, below), texel(right, below)];
    const weights = [(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v];
    return [0, 1, 2].map((c) => corners.reduce((sum, corner, k) => sum + weights[k] * corner[c], 0));
}

// `direction` rotated by the inverse of the unit quaternion `[x, y, z, w]`.
function unrotated([x, y, z, w], direction) {
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const axis = [-x, -y, -z];
    const t = cross(axis, direction).map((c) => 2 * c);
    const u = cross(axis, t);
    return direction.map((c, k) => c + w * t[k] + u[k]);
}

// Real harmonics of "An Efficient Representation for Irradiance Environment Maps", equation 3, which the text
// cites, in the order of l and m.
const harmonics = ([x, y, z]) => [
    0.282095,
    0.488603 * y,
    0.488603 * z,
    0.488603 * x,
    1.092548 * x * y,
    1.092548 * y * z,
    0.315392 * (3 * z * z - 1),
    1.092548 * x * z,
    0.546274 * (x * x - y * y),
];

// The light of the first scene.
export function lightOf(glb) {
    const { root, binary } = chunksOf(glb);
    if (!root.extensionsUsed.includes(NAME)) throw new Error(`extensionsUsed has no ${NAME}`);
    const light = root.extensions[NAME].lights[root.scenes[root.scene].extensions[NAME].light];
    const { rotation = [0, 0, 0, 1], intensity = 1, irradianceCoefficients } = light;
    const image = (index) => {
        const { bufferView, mimeType } = root.images[index];
        const { byteOffset = 0, byteLength } = root.bufferViews[bufferView];
        if (mimeType !== 'image/png') throw new Error(`image ${index} is ${mimeType}`);
        return rgbd(binary.subarray(byteOffset, byteOffset + byteLength));
    };
    const levels = light.specularImages.map((faces) => faces.map(image));
    levels.forEach((faces, level) => {
        const size = light.specularImageSize >> level;
        if (faces.length !== 6 || faces.some((face) => face.size !== size)) throw new Error(`level ${level}`);
    });
    if (irradianceCoefficients.length !== 9) throw new Error('there are no nine coefficients');
    const inCube = (direction) => unrotated(rotation, direction);
    return {
        levels: levels.length,
        // "The various mip levels evenly map to roughness values from 0 to 1."
        roughnessOf: (level) => level / (levels.length - 1),
        // Specular radiance.
        radiance: (level, direction) => {
            const [x, y, z] = inCube(direction);
            const [face, s, t] = placeOf([-x, y, z]);
            return faceAt(levels[level][face], s, t).map((c) => c * intensity);
        },
        irradiance: (normal) => {
            const basis = harmonics(inCube(normal));
            return [0, 1, 2].map((c) =>
                basis.reduce((sum, y, k) => sum + y * irradianceCoefficients[k][c] * intensity, 0),
            );
        },
    };
}
