/** An environment: a file's content. A `File` also gives its name. */
export type Source = Uint8Array | ArrayBuffer | ArrayBufferView | Blob;

/** Options of reading, by the command line's words in camel case. */
export interface InputOptions {
    /** Name of the file, for messages and for `name`. Default: that of a `File`, or "environment". */
    input?: string;
    /** Default: auto, the map that the header names, else by the aspect ratio. */
    layout?: 'auto' | 'equirect' | 'cross' | 'strip' | 'faces' | 'octahedral';
    /** Degrees about +Y; +90 maps +Z to +X. */
    rotateY?: number;
    /** Flip left to right. */
    mirror?: boolean;
    /** Factor for the radiance, above 0. */
    scale?: number;
    /** Remove the black bars of a panorama that is not 2:1. */
    crop?: boolean;
    /** Fill up a panorama that is not 2:1. */
    pad?: 'black' | 'edge';
    /** Repair NaN and Inf. */
    sanitize?: boolean;
    /** Treat any repair as an error. */
    strict?: boolean;
    /**
     * Remove the brightest sun (true), this many lights, or those at directions separated by colons, each an
     * azimuth and an elevation in degrees ("34,35") or a vector. A bake writes them to sun.json and sun.gltf.
     */
    extractSun?: boolean | number | string;
}

export interface CallOptions {
    /** Cancels the call: its promise rejects with the signal's reason. */
    signal?: AbortSignal;
}

export type Lobe = 'ggx' | 'phong' | 'cone' | 'cosine' | 'charlie';

/** A target's name; a newer version may have more. */
export type TargetName =
    | 'generic'
    | 'three'
    | 'filament'
    | 'bevy'
    | 'khronos'
    | 'oem'
    | 'babylon'
    | 'playcanvas'
    | 'gltf-ext'
    | 'unity'
    | 'unreal'
    | 'godot'
    | 'blender'
    | (string & {});

export interface BakeOptions extends InputOptions, CallOptions {
    /** Presets for engines; several write a folder each. Without one, a single KTX2 file of a cube. */
    target?: TargetName | TargetName[];
    /** Base name of the files. Default: the input's without its extension. */
    name?: string;
    /** Edge of level 0, 1 to 16384. */
    size?: number;
    levels?: number;
    ladder?: 'linear' | 'filament' | 'unity' | 'babylon';
    chain?: 'sampled' | 'solved' | 'mixed';
    lobe?: Lobe;
    /** adaptive:E, pyramid, box or reference. Default: adaptive:0.005. */
    filter?: string;
    format?: 'ktx2' | 'ktx' | 'dds' | 'exr' | 'hdr';
    outLayout?:
        | 'faces'
        | 'cross'
        | 'cross-vertical'
        | 'strip'
        | 'strip-vertical'
        | 'equirect'
        | 'octahedral'
        | 'parts'
        | 'mips';
    pixel?: 'f16' | 'f32' | 'rgb9e5' | 'r11g11b10f' | 'bc6h';
    overflow?: 'clamp' | 'compress' | 'error';
    /** Edge of an additional irradiance cube, 1 to 1024. */
    irradiance?: number;
    /** Edge of an additional unfiltered cube, 1 to 16384, or as fine as the source. */
    skybox?: number | 'source';
    /** Highest band of spherical harmonics, 2 to 4. */
    shOrder?: number;
    shWindow?: string;
    flip?: 'none' | 'x' | 'z';
    /** Map of a pyramid; default: octahedral. */
    map?: 'octahedral' | 'cube';
    diffuse?: 'none' | 'cube' | 'sh' | 'both';
    /** Files with every texel's certified error bound. */
    bounds?: boolean;
    /** Also write the environment without its sun; needs `extractSun`. */
    sunless?: boolean;
    /** Also draw a picture of spheres along the ladder. */
    preview?: boolean;
    /** Exposure of the preview: auto, or -40 to 40 EV. */
    exposure?: number | 'auto';
    oemSize?: number;
    border?: number;
    scan?: string;
    /** Called with the share of the bake that is done, from 0 to 1. */
    onProgress?: (share: number) => void;
}

export interface NamedFile {
    /** Path in the output's folder, such as sky_pmrem.ktx2; with several targets three/sky_pmrem.ktx2. */
    name: string;
    bytes: Uint8Array;
}

/** report.json, as docs/report.md describes it. */
export interface Report {
    generator: string;
    warnings: string[];
    levels: { level: number; size: number; roughness: number; pixel: string; [key: string]: unknown }[];
    outputs: { path: string; bytes: number }[];
    seconds: number;
    [key: string]: unknown;
}

export interface BakeResult {
    /** The files that the command line writes, reports included. */
    files: NamedFile[];
    /** The first target's report. */
    report: Report;
    /** One report for each target. */
    reports: Report[];
    /** Warnings of reading, baking and writing, each once. */
    warnings: string[];
    /** A PNG picture, if asked for. */
    preview: Uint8Array | null;
    /** Bytes of WebAssembly memory that the worker has. */
    memory: number;
}

export interface QueryOptions extends InputOptions, CallOptions {
    /** Three numbers each, of any length but zero. */
    directions: ArrayLike<number>;
    /** From 0 to 1: one number, or one for each direction. The lobe cosine has none. */
    roughness?: number | ArrayLike<number>;
    lobe?: Lobe;
    filter?: string;
    /**
     * Add four numbers to each answer: certified errors of luminance, red, green and blue; Infinity for
     * mirrors.
     */
    bound?: boolean;
    oemSize?: number;
    border?: number;
}

export interface Info {
    input: string;
    format: string;
    bytes: number;
    layout: string;
    width: number;
    height: number;
    min: [number, number, number];
    max: [number, number, number];
    mean: [number, number, number];
    sun: {
        direction: [number, number, number];
        irradiance: [number, number, number];
        [key: string]: unknown;
    } | null;
    repaired: { negative: number; nan: number; infinite: number; negative_energy_share: number };
    warnings: string[];
}

export interface TargetInfo {
    name: TargetName;
    /** What reads its files. */
    reader: string;
    /** Default edge of level 0. */
    size: number;
    /** The engine that loads its files in a test. */
    verified: string | null;
}

/** Bakes an environment in a worker. */
export function bake(source: Source, options?: BakeOptions): Promise<BakeResult>;

/** Describes an environment. */
export function info(source: Source, options?: InputOptions & CallOptions): Promise<Info>;

/** Radiance of a lobe around directions: red, green and blue each, and with `bound` four certified errors. */
export function query(source: Source, options: QueryOptions): Promise<Float32Array>;

/** The presets for engines. */
export function targets(): Promise<TargetInfo[]>;

/**
 * Sets how many workers run calls at the same time (default 1), and the compiled module, where it is not to
 * be loaded from octagloss_npm_bg.wasm beside the package's files.
 */
export function configure(options: {
    workers?: number;
    module?: WebAssembly.Module | Promise<WebAssembly.Module>;
}): void;

/** Ends idle workers, which otherwise wait for further calls. */
export function close(): void;
