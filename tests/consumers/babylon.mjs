// Babylon.js: .env (RGBD in PNG) as scene.environmentTexture of a left-handed scene, in which the engine's
// glTF loader negates x.
import { BANDS, EYES, relativeError, spherePixels } from './pictures.mjs';

// Levels of 256 texels whose roughness is below 1: alpha = 2^(level/0.8)/256.
const LEVELS = [2, 3, 4, 5, 6];
const roughnessOf = (level) => Math.sqrt(2 ** (level / 0.8) / 256);
// RGBD has eight bits, the engine adds 0.0005 to alpha and filters bilinearly.
const TOLERANCE = 0.02;

const turned = ([x, y, z]) => [-x, y, z];

// Pixels of the unit sphere in the world of glTF, seen by the engine's camera, whose axes come with the
// picture.
export const pixelsOf = ({ size, right, up }, eye, step) =>
    spherePixels(size, eye, step, [right, up]).map(({ at, normal, mirrored }) => ({
        at,
        normal: turned(normal),
        mirrored: turned(mirrored),
    }));

export const shownAt = (picture, pixels) => pixels.map(({ at }) => picture.pixels.slice(4 * at, 4 * at + 3));

// Greatest error of views of a diffuse sphere.
export async function worstDiffuse(page, url, diffuse) {
    let worst = 0;
    for (const eye of EYES) {
        const picture = await page.evaluate((o) => window.sphere(o), { url, metallic: 0, roughness: 1, eye });
        const pixels = pixelsOf(picture, eye, 16);
        const error = relativeError(shownAt(picture, pixels), diffuse(pixels.map((p) => p.normal)));
        worst = Math.max(worst, error);
    }
    return worst;
}

export async function checkBabylon({ open, bake, query, diffuse, check }) {
    bake('babylon', ['--target', 'babylon']);
    bake('babylon-unflipped', ['--target', 'babylon', '--flip', 'none']);
    const page = await open('babylon.html');
    const errorOf = async (folder, level, eye) => {
        const roughness = roughnessOf(level);
        const url = `/bake/${folder}/world_ibl.env`;
        const picture = await page.evaluate((o) => window.sphere(o), { url, metallic: 1, roughness, eye });
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

    const diffuseError = await worstDiffuse(page, '/bake/babylon/world_ibl.env', diffuse);
    check('babylon .env, diffuse', diffuseError < BANDS, `relative error ${diffuseError.toFixed(4)}`);
    await page.close();
}
