// Environments for three.js: loads a file that was baked for it, or bakes one on the spot.
import { CompressedCubeTexture, LightProbe, LinearFilter, LinearMipmapLinearFilter } from 'three';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { read } from 'three/addons/libs/ktx-parse.module.js';
import { facesOf, pyramidOf } from './pyramid.js';

const KTX2 = [0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb];

async function fetched(url, signal) {
    const response = await fetch(url, { signal });
    if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
    return response;
}

// The target that the KTX2 file `bytes` was baked for; undefined for other files. Version 0.2 wrote the
// target alone, later ones the recipe.
function targetOf(bytes) {
    if (!KTX2.every((byte, index) => bytes[index] === byte)) return undefined;
    const { octaglossRecipe, octaglossTarget } = read(bytes).keyValue;
    const value = octaglossRecipe ?? octaglossTarget;
    const text = value instanceof Uint8Array ? new TextDecoder().decode(value) : value;
    const whole = text?.replace(/\0.*$/s, '');
    return octaglossRecipe ? JSON.parse(whole).target : whole;
}

// KTX2Loader makes one texture of an uncompressed cube, with the six faces one after the other.
function cubeOf(loaded) {
    if (loaded.isCubeTexture) return loaded;
    const { mipmaps, format, type } = loaded;
    loaded.dispose();
    return new CompressedCubeTexture(facesOf(mipmaps), format, type);
}

async function textureOf(bytes, renderer) {
    const loader = new KTX2Loader().detectSupport(renderer);
    const { buffer, byteOffset, byteLength } = bytes;
    const loaded = await new Promise((resolve, reject) => {
        loader.parse(buffer.slice(byteOffset, byteOffset + byteLength), resolve, reject);
    }).finally(() => loader.dispose());
    const texture = cubeOf(loaded);
    texture.minFilter = LinearMipmapLinearFilter;
    texture.magFilter = LinearFilter;
    texture.isPMREMTexture = true;
    texture.needsUpdate = true;
    return texture;
}

function probeOf({ coefficients }) {
    const probe = new LightProbe();
    probe.sh.fromArray(coefficients.slice(0, 9).flat());
    return probe;
}

export async function loadEnvironment(source, { renderer, sh, signal, ...options } = {}) {
    if (!renderer) throw new TypeError('loadEnvironment needs the renderer: { renderer }');
    const url = typeof source === 'string' || source instanceof URL ? String(source) : undefined;
    const file = url === undefined ? source : await fetched(url, signal).then((response) => response.blob());
    let bytes = new Uint8Array(file instanceof Blob ? await file.arrayBuffer() : file);
    const target = targetOf(bytes);
    if (target !== undefined && target !== 'three') {
        throw new Error(
            `${url ?? file.name ?? 'the file'}: baked for ${target}; bake the source with the target three`,
        );
    }
    let [harmonics, result] = [null, null];
    if (target === 'three') {
        // The name that a bake gives the harmonics.
        const shUrl =
            sh === undefined && url?.includes('_pmrem.ktx2') ? url.replace('_pmrem.ktx2', '_sh.json') : sh;
        if (shUrl) harmonics = await fetched(shUrl, signal).then((response) => response.json());
    } else {
        const { bake } = await import('./browser.js');
        const input = file.name ?? url?.split(/[?#]/)[0].split('/').pop() ?? 'environment';
        result = await bake(bytes, { input, ...options, target: 'three', format: 'ktx2', signal });
        const made = (suffix) => result.files.find(({ name }) => name.endsWith(suffix))?.bytes;
        bytes = made('_pmrem.ktx2');
        harmonics = JSON.parse(new TextDecoder().decode(made('_sh.json')));
    }
    const texture = await textureOf(bytes, renderer);
    return { texture, probe: harmonics && probeOf(harmonics), result };
}

// Loads `--target pyramid` from its folder, or bakes it.
export async function loadPyramid(source, { scene, tables, reader, rows, signal, ...options } = {}) {
    const url = typeof source === 'string' || source instanceof URL ? String(source) : undefined;
    const bytesAt = async (place) =>
        new Uint8Array(await fetched(place, signal).then((response) => response.arrayBuffer()));
    const file = url === undefined ? source : await bytesAt(url);
    const bytes = new Uint8Array(file instanceof Blob ? await file.arrayBuffer() : file);
    let files;
    if (targetOf(bytes) === 'pyramid') {
        const beside = (name) => url?.replace(/[^/]*$/, name);
        const stem = read(bytes).faceCount === 6 ? 'pyramid_cube' : 'pyramid';
        const tablesAt = tables ?? beside(`${stem}_tables.ktx2`);
        const readerAt = reader ?? beside(`${stem}.glsl`);
        if (!tablesAt || !readerAt) {
            throw new TypeError('a pyramid in memory needs the addresses of its files: { tables, reader }');
        }
        const code = fetched(readerAt, signal).then((response) => response.text());
        files = [bytes, await bytesAt(tablesAt), await code];
    } else {
        const { bake } = await import('./browser.js');
        const input = source.name ?? url?.split(/[?#]/)[0].split('/').pop() ?? 'environment';
        const result = await bake(bytes, { input, ...options, target: 'pyramid', signal });
        const made = (suffix) => result.files.find(({ name }) => name.endsWith(suffix)).bytes;
        const code = new TextDecoder().decode(made('.glsl'));
        files = [made('_pyramid.ktx2'), made('_tables.ktx2'), code];
    }
    const pyramid = await pyramidOf(...files, rows && (await bytesAt(rows)));
    if (scene) pyramid.use(scene);
    return pyramid;
}
