// The glTF Sample Renderer: the three KTX2 cubes of the glTF IBL Sampler's layout, and the table of
// `octagloss dfg`.
import { join } from 'node:path';
import { EYES, relativeError, sheenReflected, skyPixels, spherePixels } from './pictures.mjs';

// Levels of 256 texels down to 2, and the tested ones.
const LEVELS = 8;
const LADDER = [1, 2, 3, 4, 5].map((level) => level / (LEVELS - 1));
// The picture has eight bits, and cubes are filtered bilinearly.
const TOLERANCE = 0.02;
// Edge of the page's pictures.
const SIZE = 512;

const metal = (roughness) => ({ pbrMetallicRoughness: { metallicFactor: 1, roughnessFactor: roughness } });
// Without specular reflection a dielectric is only diffuse, and a black one shows only its sheen.
const dielectric = (base, more = {}) => ({
    pbrMetallicRoughness: { baseColorFactor: [base, base, base, 1], metallicFactor: 0 },
    extensions: { KHR_materials_specular: { specularFactor: 0 }, ...more },
});
const sheen = (roughness) =>
    dielectric(0, {
        KHR_materials_sheen: { sheenColorFactor: [1, 1, 1], sheenRoughnessFactor: roughness },
    });

// Keeps the brightest value just below the eight-bit maximum.
const exposureOf = (expected) => 0.9 / Math.max(...expected.flat());

export async function checkKhronos({ open, octagloss, work, bake, query, diffuse, check }) {
    bake('khronos', ['--target', 'khronos']);
    bake('khronos-flipped', ['--target', 'khronos', '--flip', 'z']);
    octagloss(['dfg', '--quiet', '--charlie', '-o', join(work, 'dfg.ktx2')]);
    const page = await open('khronos.html');
    const call = (name, folder, options) =>
        page.evaluate((f, o) => window[f](o), name, {
            folder: `/bake/${folder}`,
            table: '/bake/dfg.ktx2',
            ...options,
        });
    const shownAt = (picture, pixels) => pixels.map(({ at }) => picture.pixels.slice(4 * at, 4 * at + 3));

    // The worst error over `eyes` against `expectedOf` pixels of the sphere, and whether all levels were
    // used.
    const sphereError = async (folder, material, eyes, expectedOf) => {
        let [worst, all] = [0, true];
        for (const eye of eyes) {
            const pixels = spherePixels(SIZE, eye, 16);
            const expected = expectedOf(pixels);
            const picture = await call('sphere', folder, { material, eye, exposure: exposureOf(expected) });
            worst = Math.max(worst, relativeError(shownAt(picture, pixels), expected));
            all &&= picture.levels === LEVELS;
        }
        return [worst, all];
    };
    const skyError = async (folder, looking) => {
        const pixels = skyPixels(SIZE, looking, 9);
        const expected = query(
            pixels.map((p) => p.direction),
            0,
        );
        const picture = await call('sky', folder, { looking, exposure: exposureOf(expected) });
        return relativeError(shownAt(picture, pixels), expected);
    };
    let worst = 0;
    for (const looking of EYES.slice(0, 6)) worst = Math.max(worst, await skyError('khronos', looking));
    // Letters have hard edges, on which two bilinear filters differ.
    check('khronos background, 6 views', worst < 0.12, `relative error ${worst.toFixed(4)}`);
    const flipped = await skyError('khronos-flipped', EYES[0]);
    check('khronos, a cube that is flipped is seen', flipped > 0.3, `relative error ${flipped.toFixed(4)}`);

    for (const roughness of LADDER) {
        // A white metal reflects all light, straight along the mirrored view.
        const [error, all] = await sphereError('khronos', metal(roughness), EYES, (pixels) =>
            query(
                pixels.map((p) => p.mirrored),
                roughness,
            ),
        );
        check(
            `khronos GGX, roughness ${roughness.toFixed(3)}, ${EYES.length} views`,
            error < TOLERANCE && all,
            `relative error ${error.toFixed(4)}`,
        );
    }
    for (const roughness of LADDER) {
        const eyes = EYES.slice(-2);
        const expectedOf = (pixels) => {
            const lobes = query(
                pixels.map((p) => p.mirrored),
                roughness,
                'charlie',
            );
            return pixels.map((p, k) => lobes[k].map((v) => v * sheenReflected(p.cosine, roughness)));
        };
        const [error] = await sphereError('khronos', sheen(roughness), eyes, expectedOf);
        check(
            `khronos Charlie and its table, roughness ${roughness.toFixed(3)}, ${eyes.length} views`,
            error < TOLERANCE,
            `relative error ${error.toFixed(4)}`,
        );
    }
    const [error] = await sphereError('khronos', dielectric(1), EYES, (pixels) =>
        diffuse(pixels.map((p) => p.normal)),
    );
    check(
        `khronos Lambertian, ${EYES.length} views`,
        error < TOLERANCE,
        `relative error ${error.toFixed(4)}`,
    );
    await page.close();
}
