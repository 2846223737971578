import type { CompressedCubeTexture, LightProbe, Material, Object3D } from 'three';
import type { BakeOptions, BakeResult } from './index.js';

export interface EnvironmentOptions extends Omit<BakeOptions, 'target' | 'format'> {
    /** The renderer, for the texture formats that it supports. */
    renderer: object;
    /** Harmonics of a baked file. Default: NAME_sh.json beside NAME_pmrem.ktx2; null for none. */
    sh?: string | null;
}

export interface LoadedEnvironment {
    /** For scene.environment, scene.background and envMap. */
    texture: CompressedCubeTexture;
    /**
     * Diffuse light for materials that do not read scene.environment. MeshStandardMaterial has it from the
     * texture, and would add both. Null for a baked file without harmonics.
     */
    probe: LightProbe | null;
    /** The bake, if the source was baked on the spot. */
    result: BakeResult | null;
}

/** Loads a .ktx2 file that was baked for three.js, or bakes any other environment. */
export function loadEnvironment(
    source: string | URL | Blob | ArrayBuffer | Uint8Array,
    options: EnvironmentOptions,
): Promise<LoadedEnvironment>;

export interface PyramidOptions extends Omit<BakeOptions, 'target' | 'format'> {
    /** Objects whose MeshStandardMaterial and MeshPhysicalMaterial use the pyramid at once. */
    scene?: Object3D;
    /** Address of pyramid_tables.ktx2, for a cube pyramid_cube_tables.ktx2. Default: beside the file. */
    tables?: string;
    /** Address of pyramid.glsl, for a cube pyramid_cube.glsl. Default: beside the file. */
    reader?: string;
    /**
     * Address of the table of anisotropic reflections, by `octagloss reader --rows` (and `--map cube`), for the
     * anisotropy of MeshPhysicalMaterial. Default: none; materials reflect as without anisotropy.
     */
    rows?: string;
}

export interface Pyramid {
    /** Uses the pyramid in a material, or in those of an object and all in it. */
    use(target: Material | Object3D): Pyramid;
    /** Whether materials read the pyramid. Otherwise they read scene.environment, as without it. */
    enabled: boolean;
    /** Factor of its light. */
    intensity: number;
    dispose(): void;
}

/**
 * Loads NAME_pyramid.ktx2 of the target pyramid, or bakes any other environment: reflections of any roughness
 * and view by the true BRDF, without a split sum, and irradiance.
 */
export function loadPyramid(
    source: string | URL | Blob | ArrayBuffer | Uint8Array,
    options?: PyramidOptions,
): Promise<Pyramid>;
