// EXT_lights_image_based: a .glb with RGBD in PNG, in a reader that follows the extension's text, and in
// Babylon.js by the recipe of docs/engines.md.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pixelsOf, shownAt, worstDiffuse } from './babylon.mjs';
import { chunksOf, lightOf, withRoot } from './lights-image-based.mjs';
import { BANDS, EYES, lattice, relativeError } from './pictures.mjs';

// RGBD has eight bits, and faces are filtered bilinearly.
const TOLERANCE = 0.02;
// Letters have hard edges, which texels of the 256 of level 0 blur.
const SHARP = 0.05;
// Degrees about the vertical, no symmetry of a cube.
const TURN = 120;

const directions = lattice(4000);

// Relative errors of the reader's light.
const levelError = (light, level, query) =>
    relativeError(
        directions.map((d) => light.radiance(level, d)),
        query(directions, light.roughnessOf(level)),
    );
const irradianceError = (light, diffuse) =>
    relativeError(
        directions.map((d) => light.irradiance(d).map((c) => c / Math.PI)),
        diffuse(directions),
    );

// `glb` with `change` applied to its light.
function edited(glb, change) {
    const { root, binary } = chunksOf(glb);
    change(root.extensions.EXT_lights_image_based.lights[0]);
    return withRoot(root, binary);
}

function checkText({ query, diffuse, check }, { glb, unflipped, turned, undone }) {
    const light = lightOf(glb);
    const agrees = (what, error, most) =>
        check(`gltf as the text says, ${what}`, error < most, `relative error ${error.toFixed(4)}`);
    for (let level = 0; level < light.levels; level++) {
        const what = `level ${level} of ${light.levels}, roughness ${light.roughnessOf(level)}`;
        agrees(what, levelError(light, level, query), level === 0 ? SHARP : TOLERANCE);
    }
    agrees('irradiance', irradianceError(light, diffuse), BANDS);
    agrees('a turn undone by the rotation', levelError(lightOf(undone), 2, query), TOLERANCE);
    agrees('its irradiance', irradianceError(lightOf(undone), diffuse), BANDS);

    // The comparison detects wrong files.
    const seen = (what, error, most) =>
        check(`gltf, ${what}, is seen`, error > most, `relative error ${error.toFixed(4)}`);
    const wrong = {
        'a cube that is not flipped': unflipped,
        'a cube that is turned': turned,
        'faces in another order': edited(glb, (light) =>
            light.specularImages.forEach((faces) => faces.reverse()),
        ),
        'half the intensity': edited(glb, (light) => (light.intensity = 0.5)),
    };
    for (const [what, file] of Object.entries(wrong))
        seen(what, levelError(lightOf(file), 2, query), 10 * TOLERANCE);
    const reordered = edited(glb, ({ irradianceCoefficients: list }) =>
        list.splice(1, 3, ...list.slice(1, 4).reverse()),
    );
    seen('coefficients in another order', irradianceError(lightOf(reordered), diffuse), 3 * BANDS);
}

async function checkBabylon({ open, query, diffuse, check }) {
    const page = await open('babylon.html');
    const errorOf = async (file, roughness, eye) => {
        const url = `/bake/${file}`;
        const picture = await page.evaluate((o) => window.sphere(o), { url, metallic: 1, roughness, eye });
        const pixels = pixelsOf(picture, eye, 16);
        const mirrored = pixels.map((p) => p.mirrored);
        return relativeError(shownAt(picture, pixels), query(mirrored, roughness));
    };
    for (const roughness of [0.25, 0.5, 0.75, 1]) {
        let worst = 0;
        for (const eye of EYES) worst = Math.max(worst, await errorOf('gltf/world_ibl.glb', roughness, eye));
        check(
            `gltf in babylon, roughness ${roughness}, ${EYES.length} views`,
            worst < TOLERANCE,
            `relative error ${worst.toFixed(4)}`,
        );
    }
    for (const folder of ['gltf-unflipped', 'gltf-turned']) {
        const error = await errorOf(`${folder}/world_ibl.glb`, 0.5, EYES.at(-1));
        check(`${folder} in babylon is seen`, error > 10 * TOLERANCE, `relative error ${error.toFixed(4)}`);
    }
    const error = await worstDiffuse(page, '/bake/gltf/world_ibl.glb', diffuse);
    check('gltf in babylon, diffuse', error < BANDS, `relative error ${error.toFixed(4)}`);
    await page.close();
}

export async function checkGltf(parts) {
    const { bake, work } = parts;
    const baked = (folder, more = []) => {
        bake(folder, ['--target', 'gltf-ext', ...more]);
        return readFileSync(join(work, folder, 'world_ibl.glb'));
    };
    const glb = baked('gltf');
    const unflipped = baked('gltf-unflipped', ['--flip', 'none']);
    const turned = baked('gltf-turned', ['--rotate-y', String(TURN)]);
    const half = (-TURN * Math.PI) / 360;
    const undone = edited(turned, (light) => (light.rotation = [0, Math.sin(half), 0, Math.cos(half)]));
    checkText(parts, { glb, unflipped, turned, undone });
    await checkBabylon(parts);
}
