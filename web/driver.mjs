// Drives web/dist in headless Chromium over WebGPU (SwiftShader), for the tests of the page.
//
// A test's arguments are PROGRAM [CHROMIUM]. PICTURES=DIRECTORY keeps the pictures there.
import { execFileSync, spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { createInterface } from 'node:readline';
import * as harness from './harness.mjs';

export { program, report, root, work, pictures } from './harness.mjs';
const { dropFile, here, newPage, pictures, program, report } = harness;

// Small, because the CPU draws every pixel.
export const width = 320;
export const height = 240;

const server = spawn(join(here, 'serve'), ['0'], { stdio: ['ignore', 'pipe', 'ignore'] });
export const origin = await new Promise((resolve, reject) => {
    createInterface(server.stdout).once('line', resolve);
    server.once('exit', (status) => reject(new Error(`web/serve ended with status ${status}`)));
});

export const webgpu = [
    '--enable-unsafe-webgpu',
    '--use-webgpu-adapter=swiftshader',
    // Without Vulkan and without a GPU the canvas is black.
    '--enable-features=Vulkan',
    '--use-vulkan=swiftshader',
    '--use-angle=vulkan',
];

// Starts the browser, instead of the one before.
export const launch = (args, viewport = { width, height, deviceScaleFactor: 1 }) =>
    harness.launch(['--force-color-profile=srgb', ...args], viewport);

// Runs `checks` and ends the process.
export const run = (checks) => harness.runChecks(checks, 'the page', () => server.kill());

// Opens the page; any error or warning in it is a failure.
export async function open(name) {
    const page = await newPage(name);
    await page.evaluateOnNewDocument(() => {
        window.frames_asked = 0;
        const ask = window.requestAnimationFrame.bind(window);
        window.requestAnimationFrame = (then) => {
            window.frames_asked += 1;
            return ask(then);
        };
    });
    await page.goto(origin);
    await page.waitForFunction('window.ready === true', { timeout: 300_000 });
    return page;
}

export const state = (page) => page.evaluate(() => window.octagloss.state());
export const settled = (page) =>
    page.waitForFunction(() => window.octagloss.state()?.settled, { timeout: 300_000, polling: 200 });

// Changes settings and waits for the picture.
export async function set(page, change) {
    await page.evaluate((change) => window.octagloss.set(change), change);
    await settled(page);
}

// The message of a change that must be refused.
export const refusal = (page, change) =>
    page.evaluate((change) => {
        try {
            window.octagloss.set(change);
            return 'it was taken';
        } catch (error) {
            return error.message;
        }
    }, change);

// Checks that nothing is drawn while nothing changes.
export async function checkIdle(page, name) {
    const asked = await page.evaluate('window.frames_asked');
    await new Promise((resolve) => setTimeout(resolve, 1500));
    const idle = (await page.evaluate('window.frames_asked')) - asked;
    const what = `${name}: nothing is drawn while nothing changes`;
    report(what, asked > 0 && idle === 0, `${idle} of ${asked} frames`);
}

// Screenshot as PNG, without buttons, of the page as it is.
export async function capture(page, name) {
    const shown = await state(page);
    await page.evaluate((hidden) => {
        document.getElementById('buttons').hidden = hidden;
    }, !shown.panel);
    const png = await page.screenshot({ path: join(pictures, `${name}.png`) });
    return Buffer.from(png).toString('base64');
}

// Screenshot of the final picture.
export async function shot(page, name) {
    await settled(page);
    return capture(page, name);
}

// The picture that `octagloss view` writes with `args`.
export function programPicture(name, args, size = [width, height]) {
    const path = join(pictures, `${name}-program.png`);
    const common = ['--screenshot', path, '--force', '--quiet', '--samples', '1', '--size', size.join('x')];
    const stdio = ['ignore', 'inherit', 'ignore'];
    execFileSync(program, ['view', ...common, ...args.map(String)], { stdio });
    return readFileSync(path).toString('base64');
}

// Mean absolute difference of two pictures in steps of 255; the share of pixels with a channel off by more
// than 2; and the share of pixels of the second that differ as much from a neighbour: those on edges.
export const difference = (page, a, b) =>
    page.evaluate(
        async (a, b) => {
            const pixels = async (png) => {
                const bytes = Uint8Array.from(atob(png), (c) => c.charCodeAt(0));
                const image = await createImageBitmap(new Blob([bytes], { type: 'image/png' }), {
                    colorSpaceConversion: 'none',
                });
                const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
                context.drawImage(image, 0, 0);
                return context.getImageData(0, 0, image.width, image.height);
            };
            const [found, wanted] = [await pixels(a), await pixels(b)];
            const { width, height, data } = wanted;
            if (found.width !== width || found.height !== height)
                return { mean: Infinity, share: 1, edges: 0 };
            const apart = (left, i, right, j) =>
                [0, 1, 2].map((c) => Math.abs(left[i + c] - right[j + c]));
            let [sum, off, edges] = [0, 0, 0];
            for (let y = 0; y < height; y++) {
                for (let x = 0; x < width; x++) {
                    const i = 4 * (y * width + x);
                    const by = apart(found.data, i, data, i);
                    sum += by[0] + by[1] + by[2];
                    off += Math.max(...by) > 2 ? 1 : 0;
                    const beside = [
                        [x + 1 < width, i + 4],
                        [x > 0, i - 4],
                        [y + 1 < height, i + 4 * width],
                        [y > 0, i - 4 * width],
                    ];
                    const edge = beside.some(([is, j]) => is && Math.max(...apart(data, i, data, j)) > 2);
                    edges += edge ? 1 : 0;
                }
            }
            const count = width * height;
            return { mean: sum / (3 * count), share: off / count, edges: edges / count };
        },
        a,
        b,
    );

export const said = ({ mean, share }) =>
    `${mean.toFixed(4)} of 255 off in the mean, ${(100 * share).toFixed(3)} % of the pixels by more than 2`;

// Opens a file with the page's file chooser, and waits for `then` of its state.
export async function choose(page, path, then) {
    const [chooser] = await Promise.all([
        page.waitForFileChooser(),
        page.evaluate(() => document.getElementById('choose').click()),
    ]);
    await chooser.accept([path]);
    await page.waitForFunction(then, { timeout: 120_000, polling: 200 }, basename(path));
    await settled(page);
}

// Drops a file onto the page, and waits for `then` of its state.
export async function drop(page, name, bytes, then) {
    await dropFile(page, name, bytes);
    await page.waitForFunction(then, { timeout: 120_000, polling: 200 }, name);
    await settled(page);
}

// Drops a broken file: the page must name it, with a message that contains `why`, and keep the picture.
export async function checkBroken(page, name, bytes, why) {
    const before = await shot(page, `before-${name}`);
    const shown = await state(page);
    await drop(page, name, bytes, (name) => window.octagloss.state().message?.startsWith(name));
    const after = await state(page);
    report(`${name} is refused`, after.message.includes(why), after.message);
    const kept = await difference(page, await shot(page, `after-${name}`), before);
    const same = ['environment', 'scene'].every((key) => after[key] === shown[key]);
    report(`${name}: the picture stays`, same && kept.mean === 0, said(kept));
}
