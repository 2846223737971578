// Babylon.js: .env (RGBD in PNG) as scene.environmentTexture of a left-handed scene, in which the engine's
// glTF loader negates x.
import { EYES, relativeError, spherePixels } from './pictures.mjs';

// Levels of 256 texels whose roughness is below 1: alpha = 2^(level/0.8)/256.
const LEVELS = [2, 3, 4, 5, 6];
const roughnessOf = (level) => Math.sqrt(2 ** (level / 0.8) / 256);
// RGBD has eight bits, the engine adds 0.0005 to alpha and filters bilinearly.
const TOLERANCE = 0.02;

const turned = ([x, y, z]) => [-x, y, z];

// Pixels of the unit sphere in the world of glTF, seen by the engine's camera, whose axes come with the
// picture.
const pixelsOf = ({ size, right, up }, eye, step) =>
    spherePixels(size, eye, step, [right, up]).map(({ at, normal, mirrored }) => ({
        at,
        normal: turned(normal),
        mirrored: turned(mirrored),
    }));

export async function checkBabylon({ open, bake, query, diffuse, check }) {
    bake('babylon', ['--target', 'babylon']);
    bake('babylon-unflipped', ['--target', 'babylon', '--flip', 'none']);
    const page = await open('babylon.html');
    const render = (options) => page.evaluate((o) => window.sphere(o), options);
    const shownAt = (picture, pixels) => pixels.map(({ at }) => picture.pixels.slice(4 * at, 4 * at + 3));
    const errorOf = async (folder, level, eye) => {
        const roughness = roughnessOf(level);
        const picture = await render({ url: `/bake/${folder}/world_ibl.env`, roughness, eye });
        const pixels = pixelsOf(picture, eye, 16);
        return relativeError(
            shownAt(picture, pixels),
            query(
                pixels.map((p) => p.mirrored),
                roughness,
            ),
        );
    };
    for (const level of LEVELS) {
        let worst = 0;
        for (const eye of EYES) worst = Math.max(worst, await errorOf('babylon', level, eye));
        check(
            `babylon .env, level ${level}, roughness ${roughnessOf(level).toFixed(3)}, ${EYES.length} views`,
            worst < TOLERANCE,
            `relative error ${worst.toFixed(4)}`,
        );
    }
    // The comparison detects a cube with the wrong flip.
    const unflipped = await errorOf('babylon-unflipped', 3, EYES.at(-1));
    check(
        'babylon, a cube that is not flipped is seen',
        unflipped > 10 * TOLERANCE,
        `relative error ${unflipped.toFixed(4)}`,
    );

    // Irradiance over pi, as evaluated by the engine's shader from its parser's result
    // (harmonicsFunctions.fx, computeEnvironmentIrradiance).
    const found = await page.evaluate((url) => window.polynomial(url), '/bake/babylon/world_ibl.env');
    const normals = [];
    for (let k = 0; k < 200; k++) {
        const [y, phi] = [1 - (2 * k + 1) / 200, k * Math.PI * (3 - Math.sqrt(5))];
        normals.push([Math.sqrt(1 - y * y) * Math.cos(phi), y, Math.sqrt(1 - y * y) * Math.sin(phi)]);
    }
    const irradiance = (normal) => {
        const [x, y, z] = turned(normal);
        const terms = { x, y, z, xx: x * x, yy: y * y, zz: z * z, xy: x * y, yz: y * z, zx: z * x };
        return [0, 1, 2].map((c) =>
            Object.entries(terms).reduce((sum, [name, t]) => sum + t * found[name][c], 0),
        );
    };
    const error = relativeError(normals.map(irradiance), diffuse(normals));
    // Share of bands above the second in this environment's irradiance.
    check('babylon spherical polynomial', error < 0.03, `relative error ${error.toFixed(4)}`);
    await page.close();
}
