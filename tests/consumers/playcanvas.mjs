// PlayCanvas: the environment atlas (RGBP in PNG) as scene.envAtlas.
import { EYES, relativeError, spherePixels } from './pictures.mjs';

// Roughness of the six levels except the mirror.
const LADDER = [1, 2, 3, 4, 5].map((level) => level / 5);
// RGBP has eight bits, and panoramas of down to 14x6 texels are filtered bilinearly.
const TOLERANCE = 0.03;
// Letters have hard edges, on which two filters differ.
const SHARP = 0.15;

export async function checkPlayCanvas({ open, bake, query, diffuse, check }) {
    bake('playcanvas', ['--target', 'playcanvas']);
    bake('playcanvas-unflipped', ['--target', 'playcanvas', '--flip', 'none']);
    bake('playcanvas-rotated', ['--target', 'playcanvas', '--rotate-y', '90']);
    const page = await open('playcanvas.html');
    const errorOf = async (folder, metal, roughness, eye) => {
        const url = `/bake/${folder}/world_envatlas.png`;
        const picture = await page.evaluate((o) => window.sphere(o), { url, metal, roughness, eye });
        const pixels = spherePixels(picture.size, eye, 8);
        const shown = pixels.map(({ at }) => picture.pixels.slice(4 * at, 4 * at + 3));
        const expected = metal
            ? query(
                  pixels.map((p) => p.mirrored),
                  roughness,
              )
            : diffuse(pixels.map((p) => p.normal));
        return relativeError(shown, expected);
    };
    const surfaces = [
        { what: 'mirror', metal: true, roughness: 0, most: SHARP, eyes: EYES },
        ...LADDER.map((roughness) => ({
            what: `roughness ${roughness.toFixed(1)}`,
            metal: true,
            roughness,
            most: TOLERANCE,
            eyes: EYES.slice(-2),
        })),
        { what: 'diffuse', metal: false, roughness: 1, most: TOLERANCE, eyes: EYES },
    ];
    for (const { what, metal, roughness, most, eyes } of surfaces) {
        let worst = 0;
        for (const eye of eyes) worst = Math.max(worst, await errorOf('playcanvas', metal, roughness, eye));
        check(
            `playcanvas atlas, ${what}, ${eyes.length} views`,
            worst < most,
            `relative error ${worst.toFixed(4)}`,
        );
    }
    // The comparison detects an atlas that is mirrored or rotated.
    for (const folder of ['playcanvas-unflipped', 'playcanvas-rotated']) {
        const error = await errorOf(folder, true, LADDER[0], EYES.at(-1));
        check(`${folder} is seen`, error > 10 * TOLERANCE, `relative error ${error.toFixed(4)}`);
    }
    await page.close();
}
