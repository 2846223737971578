// Filament: KTX 1 as IndirectLight, with its harmonics, and Skybox.
import { BANDS, EYES, drawn, relativeError, skyPixels, spherePixels } from './pictures.mjs';

// Roughness of the five levels except the sharpest.
const LADDER = [2, 3, 4].map((level) => 1 - Math.sqrt(1 - level / 4));
// R11G11B10F rounds by up to 1/128, the picture has eight bits, and cubes are filtered bilinearly.
const TOLERANCE = 0.02;

export async function checkFilament({ open, bake, query, diffuse, check }) {
    bake('filament', ['--target', 'filament']);
    bake('filament-flipped', ['--target', 'filament', '--flip', 'x']);
    const page = await open('filament.html');
    const call = (name, options) => page.evaluate((f, o) => window[f](o), name, options);
    const shownAt = (picture, pixels) => pixels.map(({ at }) => picture.pixels.slice(4 * at, 4 * at + 3));

    const skyError = async (folder, looking) => {
        const picture = await call('sky', { url: `/bake/${folder}/world_skybox.ktx`, looking });
        const pixels = skyPixels(picture.size, looking, 9);
        return relativeError(
            shownAt(picture, pixels),
            query(
                pixels.map((p) => p.direction),
                0,
            ),
        );
    };
    let worst = 0;
    for (const looking of EYES.slice(0, 6)) worst = Math.max(worst, await skyError('filament', looking));
    // Letters have hard edges, on which two bilinear filters differ.
    check('filament skybox, 6 views', worst < 0.12, `relative error ${worst.toFixed(4)}`);
    const flipped = await skyError('filament-flipped', EYES[4]);
    check('filament, a cube that is flipped is seen', flipped > 0.3, `relative error ${flipped.toFixed(4)}`);

    for (const roughness of LADDER) {
        worst = 0;
        for (const eye of EYES.slice(-3)) {
            const given = { url: '/bake/filament/world_ibl.ktx', metallic: 1, roughness, eye };
            const picture = await call('sphere', given);
            const pixels = spherePixels(picture.size, eye, 16);
            // A white metal reflects all light: the engine compensates for multiple scattering.
            const expected = query(
                pixels.map((p) => drawn(p, roughness)),
                roughness,
            );
            worst = Math.max(worst, relativeError(shownAt(picture, pixels), expected));
        }
        check(
            `filament IBL, roughness ${roughness.toFixed(3)}, 3 views`,
            worst < TOLERANCE,
            `relative error ${worst.toFixed(4)}`,
        );
    }

    worst = 0;
    for (const eye of EYES) {
        const given = { url: '/bake/filament/world_ibl.ktx', metallic: 0, roughness: 1, eye };
        const picture = await call('sphere', given);
        const pixels = spherePixels(picture.size, eye, 16);
        const expected = diffuse(pixels.map((p) => p.normal));
        worst = Math.max(worst, relativeError(shownAt(picture, pixels), expected));
    }
    check('filament, diffuse, 7 views', worst < BANDS, `relative error ${worst.toFixed(4)}`);
    await page.close();
}
