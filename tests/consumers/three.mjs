// three.js: KTX2 (half floats) and DDS (BC6H) as scene.environment, harmonics as LightProbe, and pyramids.
import { join } from 'node:path';
import { BANDS, EYES, channelError, drawn, reflected, relativeError, spherePixels } from './pictures.mjs';
import { sunny } from './program.mjs';

// Roughness of the six levels, so that no two levels are mixed: 1 - sqrt(1 - level/5).
const LADDER = [2, 3, 4, 5].map((level) => 1 - Math.sqrt(1 - level / 5));
// The engine adds the normal's change from pixel to pixel to the roughness, filters bilinearly, and has its
// own reflectance look-up table for metals.
const TOLERANCE = 0.02;
// Diffuse spheres with the sun in the environment and as a lamp, greatest difference of a channel.
const SUNLIT = 0.02;

// Spheres by the pyramid against the true BRDF. Multiple scattering is three.js's own.
const TRUE = 0.03;
// Against the CPU's look-up, which reads the same levels.
const DISC = 0.005;

// Roughness and anisotropy of brushed spheres.
const BRUSHED = [
    [0.3, 0.5],
    [0.5, 0.7],
];

export async function checkThree({ open, work, octagloss, bake, query, frames, diffuse, check }) {
    bake('three', ['--target', 'three']);
    bake('three-dds', ['--target', 'three', '--pixel', 'bc6h', '--format', 'dds']);
    bake('three-unflipped', ['--target', 'three', '--flip', 'none']);
    const page = await open('three.html');
    const render = async (url, roughness, eye, metalness = 1) =>
        page.evaluate((options) => window.sphere(options), { url, metalness, roughness, eye });

    // Expected sphere: single reflection by the lobe, the rest as diffuse.
    const expectedOf = (pixels, roughness) => {
        const lobes = query(
            pixels.map((p) => drawn(p, roughness)),
            roughness,
        );
        const rest = diffuse(pixels.map((p) => p.normal));
        return pixels.map((p, k) => {
            const once = reflected(p.cosine, roughness);
            return lobes[k].map((v, c) => once * v + (1 - once) * rest[k][c]);
        });
    };
    const shownAt = (picture, pixels) => pixels.map(({ at }) => picture.pixels.slice(4 * at, 4 * at + 3));

    const files = [
        ['KTX2 f16', '/bake/three/world_pmrem.ktx2', EYES],
        ['DDS bc6h', '/bake/three-dds/world_pmrem.dds', EYES.slice(-2)],
    ];
    const expected = new Map();
    for (const [name, url, eyes] of files) {
        for (const roughness of LADDER) {
            let [worst, levels] = [0, 0];
            for (const eye of eyes) {
                const picture = await render(url, roughness, eye);
                const pixels = spherePixels(picture.size, eye, 16);
                const key = `${roughness} ${eye}`;
                if (!expected.has(key)) expected.set(key, expectedOf(pixels, roughness));
                worst = Math.max(worst, relativeError(shownAt(picture, pixels), expected.get(key)));
                levels = picture.levels;
            }
            check(
                `three ${name}, roughness ${roughness.toFixed(3)}, ${eyes.length} views, ${levels} levels`,
                worst < TOLERANCE && levels === 6,
                `relative error ${worst.toFixed(4)}`,
            );
        }
    }
    // The true reflection by a pyramid, and by the engine's own split sum.
    const pyramids = { f16: [], bc6h: ['--pixel', 'bc6h'], cube: ['--map', 'cube'] };
    for (const [kind, options] of Object.entries(pyramids))
        bake(`three-pyramid-${kind}`, ['--target', 'pyramid', ...options]);
    for (const roughness of [0.2, 0.4, 0.7, 1]) {
        const worst = { f16: 0, bc6h: 0, cube: 0, off: 0 };
        for (const eye of EYES.slice(-2)) {
            const pixels = spherePixels(512, eye, 32);
            const once = frames(
                pixels.map(({ normal }) => [normal, eye]),
                roughness,
            );
            const rest = diffuse(pixels.map((p) => p.normal));
            const truth = pixels.map((p, k) => {
                const share = 1 - reflected(p.cosine, roughness);
                return once[k].map((v, c) => v + share * rest[k][c]);
            });
            for (const kind of Object.keys(worst)) {
                const own = kind === 'off' ? 'f16' : kind;
                const url = `/bake/three-pyramid-${own}/world_pyramid.ktx2`;
                const environment = '/bake/three/world_pmrem.ktx2';
                const options = { url, environment, roughness, eye, enabled: kind !== 'off' };
                const picture = await page.evaluate((options) => window.pyramid(options), options);
                const error = relativeError(shownAt(picture, pixels), truth);
                worst[kind] = Math.max(worst[kind], error);
            }
        }
        for (const kind of Object.keys(pyramids)) {
            check(
                `three pyramid ${kind}, roughness ${roughness}, 2 views`,
                worst[kind] < TRUE,
                `relative error ${worst[kind].toFixed(4)}`,
            );
        }
        // Its lobe of roughness 1 is bent to the normal, which is right there.
        const least = roughness < 1 ? 2 * worst.f16 : 0;
        check(
            `three PMREM, roughness ${roughness}, the switch is off`,
            worst.off > least,
            `relative error ${worst.off.toFixed(4)}`,
        );
    }
    // Files with a sun, which the page adds as a disc, against the CPU's own look-up of the squares.
    const discs = { squares: [], cube: ['--map', 'cube'], turned: ['--rotate-y', '5'] };
    for (const [kind, options] of Object.entries(discs))
        bake(`three-disc-${kind}`, ['--target', 'pyramid', ...options], sunny);
    for (const roughness of [0.2, 0.4, 0.7]) {
        const eye = EYES.at(-1);
        const pixels = spherePixels(512, eye, 8);
        const normals = pixels.map((p) => p.normal);
        const views = normals.map((normal) => [normal, eye]);
        const [once, rest] = [frames(views, roughness, 0, 'pyramid', sunny), diffuse(normals, sunny)];
        const own = pixels.map((p, k) => {
            const share = 1 - reflected(p.cosine, roughness);
            return once[k].map((v, c) => v + share * rest[k][c]);
        });
        const errors = {};
        for (const kind of Object.keys(discs)) {
            const url = `/bake/three-disc-${kind}/world_pyramid.ktx2`;
            const environment = '/bake/three/world_pmrem.ktx2';
            // Less by what the engine adds, the change of normals over a pixel in the middle of the sphere.
            const options = { url, environment, roughness: roughness - 2 / 512, eye, enabled: true };
            const picture = await page.evaluate((options) => window.pyramid(options), options);
            errors[kind] = relativeError(shownAt(picture, pixels), own);
        }
        const { squares, cube, turned } = errors;
        check(
            `three pyramid with a sun, roughness ${roughness}`,
            Math.max(squares, cube) < DISC && turned > 4 * DISC,
            `relative error ${squares.toFixed(4)}, cube ${cube.toFixed(4)}, turned ${turned.toFixed(4)}`,
        );
    }
    // Brushed along the parallels, as three.js derives tangents from a sphere's coordinates.
    const rows = '/bake/three-pyramid-f16/rows.ktx2';
    octagloss(['reader', '--rows', join(work, 'three-pyramid-f16', 'rows.ktx2'), '--size', '512', '--quiet']);
    for (const [roughness, anisotropy] of BRUSHED) {
        const worst = { with: 0, without: 0 };
        for (const eye of EYES.slice(-2)) {
            // Around the poles the tangent turns from pixel to pixel.
            const pixels = spherePixels(512, eye, 32).filter(({ normal }) => Math.abs(normal[1]) < 0.95);
            const views = pixels.map(({ normal: [x, y, z] }) => [[x, y, z], eye, [z, 0, -x]]);
            const once = frames(views, roughness, anisotropy);
            const rest = diffuse(pixels.map((p) => p.normal));
            const truth = pixels.map((p, k) => {
                const share = 1 - reflected(p.cosine, roughness, anisotropy);
                return once[k].map((v, c) => v + share * rest[k][c]);
            });
            for (const kind of Object.keys(worst)) {
                const url = '/bake/three-pyramid-f16/world_pyramid.ktx2';
                const environment = '/bake/three/world_pmrem.ktx2';
                const options = { url, environment, roughness, anisotropy, eye, enabled: true };
                if (kind === 'with') options.rows = rows;
                const picture = await page.evaluate((options) => window.pyramid(options), options);
                worst[kind] = Math.max(worst[kind], relativeError(shownAt(picture, pixels), truth));
            }
        }
        check(
            `three pyramid, roughness ${roughness}, anisotropy ${anisotropy}, 2 views`,
            worst.with < TRUE && worst.without > 2 * worst.with,
            `relative error ${worst.with.toFixed(4)}, ${worst.without.toFixed(4)} without the table`,
        );
    }
    // The comparison detects a cube with the wrong flip.
    const eye = EYES.at(-1);
    const picture = await render('/bake/three-unflipped/world_pmrem.ktx2', LADDER[0], eye);
    const pixels = spherePixels(picture.size, eye, 16);
    const error = relativeError(shownAt(picture, pixels), expected.get(`${LADDER[0]} ${eye}`));
    check(
        'three, a cube that is not flipped is seen',
        error > 10 * TOLERANCE,
        `relative error ${error.toFixed(4)}`,
    );
    let worst = 0;
    for (const eye of EYES) {
        const picture = await render('/bake/three/world_sh.json', 1, eye, 0);
        const pixels = spherePixels(picture.size, eye, 16);
        const expected = diffuse(pixels.map((p) => p.normal));
        worst = Math.max(worst, relativeError(shownAt(picture, pixels), expected));
    }
    check('three LightProbe, 7 views', worst < BANDS, `relative error ${worst.toFixed(4)}`);

    // A sky whose sun is a lamp, in its place and elsewhere.
    bake('three-sun', ['--target', 'three', '--extract-sun'], sunny);
    bake('three-sun-turned', ['--target', 'three', '--extract-sun', '--rotate-y', '20'], sunny);
    const sunlit = async (sun) => {
        let worst = 0;
        for (const eye of EYES) {
            const urls = { harmonics: '/bake/three-sun/world_sh.json', sun: `/bake/${sun}/sun.gltf` };
            const picture = await page.evaluate((options) => window.sunlit(options), { ...urls, eye });
            const pixels = spherePixels(picture.size, eye, 16);
            const expected = diffuse(
                pixels.map((p) => p.normal),
                sunny,
            );
            worst = Math.max(worst, channelError(shownAt(picture, pixels), expected));
        }
        return worst;
    };
    const right = await sunlit('three-sun');
    check('three, the sun as a lamp, 7 views', right < SUNLIT, `worst channel ${right.toFixed(4)}`);
    const turned = await sunlit('three-sun-turned');
    check('three, a sun elsewhere is seen', turned > 4 * SUNLIT, `worst channel ${turned.toFixed(4)}`);
    await page.close();
}
