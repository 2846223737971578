import type { CompressedCubeTexture, LightProbe } from 'three';
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
