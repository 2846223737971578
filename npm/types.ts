// Uses of the package that its types must accept, and one that they must refuse.
import { bake, close, configure, info, query, targets } from 'octagloss';
import { loadEnvironment, loadPyramid } from 'octagloss/three';
import type { Scene, WebGLRenderer } from 'three';

export async function use(bytes: Uint8Array, scene: Scene, renderer: WebGLRenderer): Promise<number> {
    configure({ workers: 2 });
    const { files, report, preview } = await bake(bytes, {
        target: ['three', 'filament'],
        size: 64,
        skybox: 'source',
        preview: true,
        signal: AbortSignal.timeout(1000),
    });
    // @ts-expect-error A size is a number.
    await bake(bytes, { size: '64' });
    const { texture, probe } = await loadEnvironment('sky_pmrem.ktx2', { renderer, sh: null });
    scene.environment = texture;
    if (probe) scene.add(probe);
    const pyramid = await loadPyramid('sky/sky_pyramid.ktx2', { scene });
    pyramid.use(scene).enabled = false;
    // @ts-expect-error A pyramid has one format.
    await loadPyramid(bytes, { scene, format: 'exr' });
    const answers: Float32Array = await query(bytes, { directions: [0, 1, 0], roughness: 0.5 });
    const names: string[] = (await targets()).map(({ name }) => name);
    close();
    return (
        files.length +
        report.levels.length +
        (preview?.length ?? 0) +
        answers.length +
        names.length +
        (await info(bytes)).width
    );
}
