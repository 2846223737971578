// Pyramids for three.js: reflections of any roughness and view in MeshStandardMaterial and
// MeshPhysicalMaterial, by the look-ups of `bake --target pyramid`.
import {
    ClampToEdgeWrapping,
    CompressedArrayTexture,
    CompressedCubeTexture,
    Data3DTexture,
    DataTexture,
    HalfFloatType,
    LinearFilter,
    LinearMipmapLinearFilter,
    Matrix3,
    RGB_BPTC_UNSIGNED_Format,
    RGBAFormat,
    UnsignedByteType,
    Vector3,
    Vector4,
} from 'three';
import { read } from 'three/addons/libs/ktx-parse.module.js';
import { ZSTDDecoder } from 'three/addons/libs/zstddec.module.js';

// Pixels by their number in Vulkan: format, type, and the array of their bytes.
const PIXELS = {
    97: [RGBAFormat, HalfFloatType, Uint16Array],
    143: [RGB_BPTC_UNSIGNED_Format, UnsignedByteType, Uint8Array],
};

const KEY = 'octaglossPyramid';

// The images of the KTX2 file `bytes` by mip level, and its keys.
async function opened(bytes) {
    const file = read(bytes);
    const pixels = PIXELS[file.vkFormat];
    if (!pixels) throw new Error('a pyramid for three.js has pixels f16 or bc6h; bake it with one of them');
    const decoder = new ZSTDDecoder();
    await decoder.init();
    const [format, type, Numbers] = pixels;
    const mipmaps = file.levels.map(({ levelData, uncompressedByteLength }, level) => {
        const packed = file.supercompressionScheme === 2;
        const raw = packed ? decoder.decode(levelData, uncompressedByteLength) : levelData;
        const aligned = raw.slice();
        const data = new Numbers(aligned.buffer, 0, aligned.byteLength / Numbers.BYTES_PER_ELEMENT);
        const [width, height] = [file.pixelWidth >> level, file.pixelHeight >> level];
        return { data, width, height, depth: file.pixelDepth };
    });
    const [layers, faces] = [Math.max(file.layerCount, 1), file.faceCount];
    return { mipmaps, format, type, layers, faces, keys: file.keyValue };
}

// The faces of a cube whose levels have them one after the other.
export function facesOf(mipmaps) {
    const [{ width, height }] = mipmaps;
    return Array.from({ length: 6 }, (_, face) => ({
        width,
        height,
        mipmaps: mipmaps.map((level) => {
            const length = level.data.length / 6;
            return { ...level, data: level.data.subarray(face * length, (face + 1) * length) };
        }),
    }));
}

function linear(texture) {
    texture.magFilter = LinearFilter;
    const { mipmaps } = texture.isCubeTexture ? texture.image[0] : texture;
    texture.minFilter = mipmaps.length > 1 ? LinearMipmapLinearFilter : LinearFilter;
    texture.wrapS = texture.wrapT = texture.wrapR = ClampToEdgeWrapping;
    texture.generateMipmaps = false;
    texture.flipY = false;
    texture.needsUpdate = true;
    return texture;
}

function textOf(value) {
    const text = value instanceof Uint8Array ? new TextDecoder().decode(value) : (value ?? '');
    return text.replace(/\0.*$/s, '');
}

// The 256 numbers of the file's light as uniforms of the struct OctaglossLight.
function lightOf(uniform) {
    const vector = (at) => new Vector4(...uniform.slice(at, at + 4));
    const turned = [0, 4, 8].flatMap((at) => uniform.slice(at, at + 3));
    return {
        world_from_source: new Matrix3().fromArray(turned),
        scale: uniform[12],
        unscale: uniform[13],
        clamp_: uniform[14],
        pad: 0,
        harmonics: Array.from({ length: 25 }, (_, k) => vector(16 + 4 * k)),
        suns: Array.from({ length: 8 }, (_, k) => {
            const [red, green, blue] = [0, 4, 8].map((at) => vector(116 + 16 * k + at));
            const energy = new Vector3(...uniform.slice(128 + 16 * k, 131 + 16 * k));
            return { red, green, blue, energy, pad: 0 };
        }),
    };
}

// Light around the material, in place of what comes from scene.environment: irradiance and albedo, with which
// three.js computes diffuse light and multiple scattering, and reflections instead of radiance times a split
// sum.
const IRRADIANCE = `
    #if defined(USE_ANISOTROPY) && defined(OCTAGLOSS_ROWS)
        float octagloss_stretch = material.anisotropy;
    #else
        const float octagloss_stretch = 0.0;
    #endif
    if (octagloss_share > 0.0) {
        vec3 lit = inverseTransformDirection(geometryNormal, viewMatrix);
        iblIrradiance = PI * octagloss_share * octagloss_irradiance(lit);
        material.dfg = octagloss_albedo(
            max(dot(geometryNormal, geometryViewDir), 0.01), material.roughness, octagloss_stretch);
        radiance = vec3(0.0);
        clearcoatRadiance = vec3(0.0);
    }
`;
const REFLECTION = `
    if (octagloss_share > 0.0) {
        vec3 viewer = inverseTransformDirection(geometryViewDir, viewMatrix);
        vec3 facing = inverseTransformDirection(geometryNormal, viewMatrix);
        vec3 specular = mix(material.specularColor, material.diffuseColor, material.metalness);
        #if defined(USE_ANISOTROPY) && defined(OCTAGLOSS_ROWS)
            reflectedLight.indirectSpecular += octagloss_share * octagloss_reflect(
                facing, viewer, inverseTransformDirection(material.anisotropyT, viewMatrix),
                material.roughness, material.anisotropy, specular, material.specularF90);
        #else
            reflectedLight.indirectSpecular += octagloss_share * octagloss_reflect_isotropic(
                facing, viewer, material.roughness, specular, material.specularF90);
        #endif
        #ifdef USE_CLEARCOAT
            clearcoatSpecularIndirect += octagloss_share * octagloss_reflect_isotropic(
                inverseTransformDirection(geometryClearcoatNormal, viewMatrix), viewer,
                material.clearcoatRoughness, material.clearcoatF0, material.clearcoatF90);
        #endif
    }
`;

// The light of one environment, for any number of materials.
class Pyramid {
    #uniforms;
    #code;
    #intensity = 1;
    #enabled = true;

    constructor(uniforms, code) {
        this.#uniforms = uniforms;
        // Structs of uniforms are set one by one, where three.js has no blocks for these materials.
        const rows = uniforms.octagloss_rows.value ? '#define OCTAGLOSS_ROWS\n' : '';
        this.#code = `${rows}uniform float octagloss_share;\n${code.replace(
            /layout\(std140\) uniform \w+ \{ (.*?;) \};/,
            'uniform $1',
        )}`;
    }

    /** Uses the pyramid in `target`: a material, or those of an object and all in it. */
    use(target) {
        if (target.isMaterial) return this.#patch(target);
        target.traverse(({ material }) => {
            for (const own of [material ?? []].flat()) if (own.isMeshStandardMaterial) this.#patch(own);
        });
        return this;
    }

    #patch(material) {
        if (!material.isMeshStandardMaterial) {
            throw new TypeError('a pyramid lights MeshStandardMaterial and MeshPhysicalMaterial');
        }
        const [uniforms, code] = [this.#uniforms, this.#code];
        material.onBeforeCompile = (shader) => {
            Object.assign(shader.uniforms, uniforms);
            const parts = [
                ['#include <lights_physical_pars_fragment>', (own) => `${own}\n${code}`],
                ['#include <lights_fragment_maps>', (own) => own + IRRADIANCE],
                ['#include <lights_fragment_end>', (own) => own + REFLECTION],
            ];
            for (const [chunk, changed] of parts) {
                if (!shader.fragmentShader.includes(chunk)) {
                    throw new Error(`three.js has no ${chunk} here; its release is another than 0.187`);
                }
                shader.fragmentShader = shader.fragmentShader.replace(chunk, changed(chunk));
            }
        };
        const kinds = [uniforms.octagloss_maps.value.isCubeTexture, Boolean(uniforms.octagloss_rows.value)];
        material.customProgramCacheKey = () => `octagloss pyramid, on a cube and with rows: ${kinds}`;
        material.needsUpdate = true;
        return this;
    }

    /** Whether materials read the pyramid; else scene.environment, as without it. */
    get enabled() {
        return this.#enabled;
    }

    set enabled(enabled) {
        this.#enabled = enabled;
        this.#uniforms.octagloss_share.value = enabled ? this.#intensity : 0;
    }

    /** Factor of its light. */
    get intensity() {
        return this.#intensity;
    }

    set intensity(intensity) {
        this.#intensity = intensity;
        this.enabled = this.#enabled;
    }

    dispose() {
        this.#uniforms.octagloss_maps.value.dispose();
        this.#uniforms.octagloss_tables.value.dispose();
        this.#uniforms.octagloss_rows.value?.dispose();
    }
}

// The table of anisotropic reflections as a texture.
async function rowsOf(bytes) {
    const { mipmaps, format, type } = await opened(bytes);
    const [{ data, width, height, depth }] = mipmaps;
    if (!depth) throw new Error('the file of `rows` is no table; write it by octagloss reader --rows');
    const texture = new Data3DTexture(data, width, height, depth);
    [texture.format, texture.type] = [format, type];
    return linear(texture);
}

// A pyramid of its files: maps, tables and, for anisotropy, rows as bytes, the GLSL as text.
export async function pyramidOf(file, tables, code, rows) {
    const [levels, table] = await Promise.all([opened(file), opened(tables)]);
    if (!levels.keys[KEY]) throw new Error('the file is no pyramid; bake it with the target pyramid');
    const { uniform } = JSON.parse(textOf(levels.keys[KEY]));
    const { mipmaps, format, type, layers, faces } = levels;
    const [{ width, height }] = mipmaps;
    const maps =
        faces === 6
            ? new CompressedCubeTexture(facesOf(mipmaps), format, type)
            : new CompressedArrayTexture(mipmaps, width, height, layers, format, type);
    const [{ data, width: columns, height: lines }] = table.mipmaps;
    const uniforms = {
        octagloss_share: { value: 1 },
        octagloss_lights: { value: [lightOf(uniform)] },
        octagloss_maps: { value: linear(maps) },
        octagloss_tables: { value: linear(new DataTexture(data, columns, lines, table.format, table.type)) },
        octagloss_rows: { value: rows ? await rowsOf(rows) : null },
    };
    return new Pyramid(uniforms, code);
}
