// Bevy: the pair that `bake --target bevy` writes, as EnvironmentMapLight and Skybox, on any Vulkan driver.
// The engine is compiled first, which takes minutes.
//
//   node tests/consumers/bevy.mjs PROGRAM
//
// Exit status 0 when every picture agrees, 1 otherwise.
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { EYES, relativeError, skyPixels, spherePixels } from './pictures.mjs';
import { finish, programAt, root, check } from './program.mjs';

// Edge of the pictures (bevy/src/main.rs).
const SIZE = 256;
// Roughness of the seven levels except the mirror, so that no two levels are mixed.
const LADDER = [1, 2, 3, 4, 5, 6].map((level) => level / 6);
// Cubes are filtered bilinearly.
const TOLERANCE = 0.02;

const [program] = process.argv.slice(2);
if (!program) {
    console.error('usage: node bevy.mjs PROGRAM');
    process.exit(2);
}
const work = mkdtempSync(join(tmpdir(), 'octagloss-bevy-'));
const { bake, query, diffuse } = programAt(program, work);

// Pictures of jobs { subject, roughness, folder, eye }: rows upwards of four floats.
function pictures(jobs) {
    const lines = jobs.map(({ subject, roughness, folder, eye }) =>
        [subject, roughness, `${folder}/world_specular.ktx2`, `${folder}/world_diffuse.ktx2`, ...eye].join(
            ' ',
        ),
    );
    const built = [
        'run',
        '--release',
        '--locked',
        '--quiet',
        '--manifest-path',
        join(root, 'tests/consumers/bevy/Cargo.toml'),
        '--target-dir',
        join(root, 'target/bevy'),
        '--',
        work,
    ];
    const bytes = execFileSync('cargo', built, {
        input: `${lines.join('\n')}\n`,
        maxBuffer: 1 << 30,
        stdio: ['pipe', 'pipe', 'inherit'],
    });
    const floats = new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
    if (floats.length !== jobs.length * SIZE * SIZE * 4) throw new Error(`${bytes.length} bytes of pictures`);
    return jobs.map((_, k) => floats.subarray(k * SIZE * SIZE * 4, (k + 1) * SIZE * SIZE * 4));
}

// The engine bends the mirrored direction towards the normal (environment_map.wgsl,
// radiance_sample_direction).
function drawn({ mirrored, normal }, roughness) {
    const alpha = Math.max(roughness, 0.089) ** 2;
    const smooth = 1 - alpha;
    const share = smooth * (Math.sqrt(smooth) + alpha);
    const mixed = mirrored.map((v, c) => normal[c] + share * (v - normal[c]));
    return mixed.map((v) => v / Math.hypot(...mixed));
}

const expectedOf = {
    // Single reflection by the lobe, the rest as diffuse. The engine's reflectance fit (pbr_lighting.wgsl,
    // F_AB) sums to 1 - 0.55 roughness for a white metal, for any view.
    metal: (pixels, roughness) => {
        const lobes = query(
            pixels.map((p) => drawn(p, roughness)),
            roughness,
        );
        const rest = diffuse(pixels.map((p) => p.normal));
        const once = 1 - 0.55 * roughness;
        return pixels.map((_, k) => lobes[k].map((v, c) => once * v + (1 - once) * rest[k][c]));
    },
    recipe: (pixels, roughness) => expectedOf.metal(pixels, roughness),
    diffuse: (pixels) => diffuse(pixels.map((p) => p.normal)),
    sky: (pixels) =>
        query(
            pixels.map((p) => p.direction),
            0,
        ),
};

try {
    bake('bevy', ['--target', 'bevy']);
    bake('bevy-unflipped', ['--target', 'bevy', '--flip', 'none']);
    for (const kind of ['specular', 'diffuse']) {
        copyFileSync(join(work, `bevy/world_${kind}.ktx2`), join(work, `sky_${kind}.ktx2`));
    }
    const checks = [
        // Letters have hard edges, on which two bilinear filters differ.
        { what: 'skybox', subject: 'sky', roughness: 0, eyes: EYES, most: 0.12 },
        ...LADDER.map((roughness) => ({
            what: 'EnvironmentMapLight on metal',
            subject: 'metal',
            roughness,
            eyes: EYES,
            most: TOLERANCE,
        })),
        {
            what: 'EnvironmentMapLight on a diffuse surface',
            subject: 'diffuse',
            roughness: 1,
            eyes: EYES,
            most: TOLERANCE,
        },
        {
            what: 'metal in the light of docs/engines.md',
            subject: 'recipe',
            roughness: LADDER[2],
            eyes: EYES,
            most: TOLERANCE,
        },
        // The comparison detects a cube with the wrong flip.
        { what: 'skybox that is not flipped', subject: 'sky', roughness: 0, eyes: [EYES[4]], least: 0.3 },
        {
            what: 'metal under a cube that is not flipped',
            subject: 'metal',
            roughness: LADDER[1],
            eyes: [EYES.at(-1)],
            least: 0.2,
        },
        {
            what: 'diffuse surface under a cube that is not flipped',
            subject: 'diffuse',
            roughness: 1,
            eyes: [EYES.at(-1)],
            least: 0.2,
        },
    ];
    const jobs = checks.flatMap(({ subject, roughness, eyes, least }) =>
        eyes.map((eye) => ({ subject, roughness, folder: least ? 'bevy-unflipped' : 'bevy', eye })),
    );
    const shown = pictures(jobs);
    for (const { what, subject, roughness, eyes, most, least } of checks) {
        const errors = eyes.map((eye) => {
            const picture = shown.shift();
            const pixels = subject === 'sky' ? skyPixels(SIZE, eye, 5) : spherePixels(SIZE, eye, 8);
            const colours = pixels.map(({ at }) => Array.from(picture.subarray(4 * at, 4 * at + 3)));
            return relativeError(colours, expectedOf[subject](pixels, roughness));
        });
        const [error, ok] = least
            ? [Math.min(...errors), Math.min(...errors) > least]
            : [Math.max(...errors), Math.max(...errors) < most];
        const of = subject === 'metal' ? `, roughness ${roughness.toFixed(3)}` : '';
        check(
            `bevy ${what}${of}, ${eyes.length} views`,
            ok,
            `relative error ${error.toFixed(4)}${least ? ', as it must' : ''}`,
        );
    }
} catch (error) {
    check('run', false, error.stack);
} finally {
    rmSync(work, { recursive: true, force: true });
}
finish('Bevy and the program');
