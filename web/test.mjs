// Drives web/dist in headless Chromium over WebGPU (SwiftShader), and compares its pictures with `octagloss
// view`.
//
//   node web/test.mjs PROGRAM [CHROMIUM]
//
// PICTURES=DIRECTORY keeps the pictures there. Exit status 0 when everything agrees, 1 otherwise.
import { execFileSync, spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';
import puppeteer from 'puppeteer-core';

const here = fileURLToPath(new URL('.', import.meta.url));
const root = join(here, '..');
const [program, chromium = '/usr/bin/chromium'] = process.argv.slice(2);
if (!program) {
    console.error('usage: node test.mjs PROGRAM [CHROMIUM]');
    process.exit(2);
}

// Small, because the CPU draws every pixel.
const width = 320;
const height = 240;
const sky = join(root, 'hdr/sky.exr');
const studio = join(root, 'hdr/studio.hdr');

let failures = 0;
// Prints a check's outcome; `ok` false fails the run.
function report(what, ok, detail) {
    console.log(`${ok ? 'ok    ' : 'FAILED'} ${what}: ${detail}`);
    failures += ok ? 0 : 1;
}

const work = mkdtempSync(join(tmpdir(), 'octagloss-web-'));
const pictures = process.env.PICTURES ?? work;
mkdirSync(pictures, { recursive: true });

const server = spawn(join(here, 'serve'), ['0'], { stdio: ['ignore', 'pipe', 'ignore'] });
const origin = await new Promise((resolve, reject) => {
    createInterface(server.stdout).once('line', resolve);
    server.once('exit', (status) => reject(new Error(`web/serve ended with status ${status}`)));
});

const common = [
    '--no-sandbox',
    '--no-first-run',
    '--disable-quic',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    '--force-color-profile=srgb',
];
const launch = (args, defaultViewport = { width, height, deviceScaleFactor: 1 }) =>
    puppeteer.launch({
        executablePath: chromium,
        headless: true,
        protocolTimeout: 600_000,
        defaultViewport,
        args: [...common, ...args],
    });
const webgpu = [
    '--enable-unsafe-webgpu',
    '--use-webgpu-adapter=swiftshader',
    // Without Vulkan and without a GPU the canvas is black.
    '--enable-features=Vulkan',
    '--use-vulkan=swiftshader',
    '--use-angle=vulkan',
];

// Opens the page; any error or warning in it is a failure.
async function open(name) {
    const page = await browser.newPage();
    page.on('pageerror', (error) => report(name, false, error.message));
    page.on('console', (message) => {
        if (['error', 'warn'].includes(message.type())) report(name, false, message.text());
    });
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

const state = (page) => page.evaluate(() => window.octagloss.state());
const settled = (page) =>
    page.waitForFunction(() => window.octagloss.state()?.settled, { timeout: 300_000, polling: 200 });

// Changes settings and waits for the picture.
async function set(page, change) {
    await page.evaluate((change) => window.octagloss.set(change), change);
    await settled(page);
}

// Screenshot as PNG, without buttons.
async function shot(page, name) {
    await settled(page);
    const shown = await state(page);
    await page.evaluate((hidden) => {
        document.getElementById('buttons').hidden = hidden;
    }, !shown.panel);
    const png = await page.screenshot({ path: join(pictures, `${name}.png`) });
    return Buffer.from(png).toString('base64');
}

// The program's picture of the page's default view, with the given changes.
function expected(
    name,
    file,
    { roughness = 0.3, filter = 'fitted:4', size = [width, height], yaw = 0, mesh },
) {
    const path = join(pictures, `${name}-program.png`);
    const degrees = (radians) => String((radians * 180) / Math.PI);
    execFileSync(
        program,
        [
            'view',
            file,
            '--screenshot',
            path,
            '--force',
            '--quiet',
            '--size',
            size.join('x'),
            '--samples',
            '1',
            '--roughness',
            String(roughness),
            '--filter',
            filter,
            '--yaw',
            degrees(yaw),
            '--pitch',
            degrees(0.07),
            ...(mesh ? ['--mesh', mesh] : []),
        ],
        { stdio: ['ignore', 'inherit', 'ignore'] },
    );
    return readFileSync(path).toString('base64');
}

// Mean absolute difference of two pictures in steps of 255, and the share of pixels with a channel off by
// more than 2.
const difference = (page, a, b) =>
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
            if (found.width !== wanted.width || found.height !== wanted.height)
                return { mean: Infinity, share: 1 };
            let [sum, off] = [0, 0];
            for (let i = 0; i < found.data.length; i += 4) {
                const by = [0, 1, 2].map((c) => Math.abs(found.data[i + c] - wanted.data[i + c]));
                sum += by[0] + by[1] + by[2];
                off += Math.max(...by) > 2 ? 1 : 0;
            }
            const count = found.data.length / 4;
            return { mean: sum / (3 * count), share: off / count };
        },
        a,
        b,
    );

// Tolerance for the drivers' rounding and for pixels on edges. The sky's ground has one colour over up to
// half of a picture: if a channel lies between two levels, drivers round it differently, which is 1/2 * 1/3
// in the mean.
const most = { mean: 0.2, share: 0.005 };
const agrees = ({ mean, share }) => mean <= most.mean && share <= most.share;
const said = ({ mean, share }) =>
    `${mean.toFixed(4)} of 255 off in the mean, ${(100 * share).toFixed(3)} % of the pixels by more than 2`;

// Compares a picture of the page with the program's; `view` are additional options for the program.
async function check(page, name, file, change = {}, view = {}) {
    await set(page, { panel: false, ...change });
    const found = await difference(
        page,
        await shot(page, name),
        expected(name, file, { ...change, ...view }),
    );
    report(name, agrees(found), `${said(found)} (at most ${most.mean} and ${100 * most.share} %)`);
}

// Compiles every shader in the browser; invalid ones must fail.
async function checkShaders(page) {
    const compiled = await page.evaluate(async () => {
        const { shader_paths, shader_source } = window.octagloss;
        const device = await (await navigator.gpu.requestAdapter()).requestDevice();
        const compile = async (code) => {
            device.pushErrorScope('validation');
            const module = device.createShaderModule({ code });
            const compiled = (await module.getCompilationInfo()).messages;
            const messages = compiled.map(
                ({ type, lineNum, message }) => `${type}, line ${lineNum}: ${message}`,
            );
            const entries = [...code.matchAll(/@(compute|vertex|fragment)[^{]*?\bfn\s+(\w+)/g)];
            // The pictures test the render pipelines.
            for (const [, , entryPoint] of entries.filter(([, stage]) => stage === 'compute')) {
                await device
                    .createComputePipelineAsync({ layout: 'auto', compute: { module, entryPoint } })
                    .catch((error) => messages.push(`${entryPoint}: ${error.message}`));
            }
            const error = await device.popErrorScope();
            if (error && !messages.length) messages.push(error.message);
            return { entries: entries.map(([, , name]) => name), messages };
        };
        const all = [];
        for (const path of shader_paths()) all.push({ path, ...(await compile(shader_source(path))) });
        const copy = shader_source('copy.wgsl');
        const broken = [
            { path: 'no semicolon', code: copy.replace(';', '') },
            {
                path: 'group too large',
                code: copy.replace(/@workgroup_size\([^)]*\)/, '@workgroup_size(1024)'),
            },
        ];
        for (const { path, code } of broken) all.push({ path, broken: true, ...(await compile(code)) });
        device.destroy();
        return all;
    });
    for (const { path, broken, entries, messages } of compiled) {
        const ok = broken ? messages.length > 0 : messages.length === 0 && entries.length > 0;
        report(
            `Tint: ${path}`,
            ok,
            messages.map((message) => message.split('\n')[0]).join('; ') || entries.join(', '),
        );
    }
}

// Drags the roughness slider with the mouse.
async function checkSlider(page) {
    await set(page, { panel: true, roughness: 0.3 });
    const [before, picture] = [await state(page), await shot(page, 'panel')];
    const [left, top, right, bottom] = before.roughness_slider;
    const x = (roughness) => left + roughness * (right - left);
    await page.mouse.move(x(before.roughness), (top + bottom) / 2);
    await page.mouse.down();
    await page.mouse.move(x(0.5), (top + bottom) / 2, { steps: 4 });
    await page.mouse.move(x(0.7), (top + bottom) / 2, { steps: 4 });
    await page.waitForFunction((was) => window.octagloss.state().roughness !== was, {}, before.roughness);
    await page.mouse.up();
    const after = await shot(page, 'panel-dragged');
    const { roughness } = await state(page);
    // The handle does not reach the ends.
    report('the slider is dragged', Math.abs(roughness - 0.7) < 0.05, `${before.roughness} to ${roughness}`);
    const changed = await difference(page, after, picture);
    report('and the picture follows', !agrees(changed), said(changed));
    await page.keyboard.press('h');
    await page.waitForFunction(() => !window.octagloss.state().panel);
    await check(page, 'dragged', sky, { roughness });
}

// Turns the camera by a finger, then by the mouse.
async function checkTurning(page) {
    const radians = (pixels) => (pixels * Math.PI) / height;
    const [x, y] = [width / 2, height / 2];
    await page.touchscreen.touchStart(x, y);
    await page.touchscreen.touchMove(x + 30, y);
    await page.touchscreen.touchMove(x + 60, y);
    await page.touchscreen.touchEnd();
    await check(page, 'turned-by-a-finger', sky, {}, { yaw: -radians(60) });
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x - 60, y, { steps: 3 });
    await page.mouse.up();
    await check(page, 'turned-back-by-the-mouse', sky);
}

// Drops a mesh.
async function checkMesh(page) {
    // A pyramid on a square, with face normals.
    const corners = ['1 -0.6 1', '1 -0.6 -1', '-1 -0.6 -1', '-1 -0.6 1', '0 1 0'];
    const faces = ['1 2 5', '2 3 5', '3 4 5', '4 1 5', '4 3 2 1'];
    const text = [...corners.map((corner) => `v ${corner}`), ...faces.map((face) => `f ${face}`), ''].join(
        '\n',
    );
    const mesh = join(work, 'pyramid.obj');
    writeFileSync(mesh, text);
    const before = await shot(page, 'before-a-mesh');
    await drop(page, 'pyramid.obj', Buffer.from(text), () => window.octagloss.state().object === 'mesh');
    report(
        'a mesh is another picture',
        !agrees(await difference(page, await shot(page, 'mesh'), before)),
        'pyramid.obj',
    );
    // The camera faces its front.
    await check(page, 'mesh', sky, {}, { mesh, yaw: -Math.PI / 2 });
    await checkBroken(page, 'broken.obj', Buffer.from('f 1 2 3'), 'broken.obj', 'sky.exr');
    await set(page, { object: 'sphere' });
}

// Opens a file with the page's file chooser, and waits for `then` of its state.
async function choose(page, path, then) {
    const [chooser] = await Promise.all([
        page.waitForFileChooser(),
        page.evaluate(() => document.getElementById('choose').click()),
    ]);
    await chooser.accept([path]);
    await page.waitForFunction(then, { timeout: 120_000, polling: 200 }, basename(path));
    await settled(page);
}

// Drops a file onto the page.
async function drop(page, name, bytes, then) {
    await page.evaluate(
        (name, bytes) => {
            const files = new DataTransfer();
            files.items.add(new File([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))], name));
            dispatchEvent(new DragEvent('drop', { dataTransfer: files, cancelable: true }));
        },
        name,
        bytes.toString('base64'),
    );
    await page.waitForFunction(then, { timeout: 120_000, polling: 200 }, name);
    await settled(page);
}

async function checkBroken(page, name, bytes, why, shown = 'studio.hdr') {
    const before = await shot(page, `before-${name}`);
    await drop(page, name, bytes, (name) => window.octagloss.state().message?.startsWith(name));
    const { environment, message } = await state(page);
    report(`${name} is refused`, message.includes(why), message);
    const kept = await difference(page, await shot(page, `after-${name}`), before);
    report(
        `${name}: the picture stays`,
        environment === shown && kept.mean === 0,
        `${environment}; ${said(kept)}`,
    );
}

let browser;
try {
    browser = await launch(webgpu);
    console.log(await browser.version());
    let from = performance.now();
    const since = () => {
        const seconds = ((performance.now() - from) / 1000).toFixed(1);
        from = performance.now();
        return `${seconds} s`;
    };
    const page = await open('page');
    await settled(page);
    const { environment, adapter, message } = await state(page);
    report(
        'the sky is shown',
        environment === 'sky.exr' && message === null,
        `on ${adapter}, after ${since()}`,
    );

    await check(page, 'roughness-0.3', sky);
    const differs = await difference(
        page,
        await shot(page, 'roughness-0.3'),
        expected('roughness-0.35', sky, { roughness: 0.35 }),
    );
    report('another roughness differs', !agrees(differs), said(differs));
    await check(page, 'roughness-0.6', sky, { roughness: 0.6 });
    await check(page, 'box', sky, { roughness: 0.3, filter: 'box' });
    await check(page, 'levels', sky, { filter: 'levels' });
    await check(page, 'adaptive', sky, { filter: 'adaptive' });
    console.log(`       other filters: ${since()}`);
    await set(page, { filter: 'fitted:4' });

    const asked = await page.evaluate('window.frames_asked');
    await new Promise((resolve) => setTimeout(resolve, 1500));
    const idle = (await page.evaluate('window.frames_asked')) - asked;
    report('nothing is drawn while nothing changes', asked > 0 && idle === 0, `${idle} of ${asked} frames`);

    await checkSlider(page);
    await set(page, { roughness: 0.3 });
    await checkTurning(page);

    await choose(page, studio, (name) => window.octagloss.state().environment === name);
    await check(page, 'studio', studio, { roughness: 0.3 });
    const exr = readFileSync(sky);
    await checkBroken(page, 'half.exr', exr.subarray(0, exr.length / 2), 'half.exr: ');
    await checkBroken(page, 'text.hdr', Buffer.from('no image'), 'not an image');
    await drop(page, 'sky.exr', exr, (name) => window.octagloss.state().environment === name);
    report('a good file takes the message away', (await state(page)).message === null, 'sky.exr');

    await checkMesh(page);

    await page.setViewport({ width: 240, height: 300, deviceScaleFactor: 1 });
    await page.waitForFunction(() => String(window.octagloss.state().size) === '240,300', {
        timeout: 60_000,
        polling: 200,
    });
    const resized = await difference(
        page,
        await shot(page, 'resized'),
        expected('resized', sky, { size: [240, 300], yaw: -Math.PI / 2 }),
    );
    report('resized', agrees(resized), said(resized));

    const refused = await page.evaluate(() => {
        try {
            window.octagloss.set({ roughness: 2 });
            return 'it was taken';
        } catch (error) {
            return error.message;
        }
    });
    report('a roughness of 2 is refused', refused.includes('roughness 2 is outside'), refused);
    from = performance.now();
    await checkShaders(page);
    console.log(`       shaders: ${since()}`);
    await browser.close();

    // A display with two pixels a point needs a real browser option; emulated ones report one to the page.
    browser = await launch([...webgpu, '--force-device-scale-factor=2', '--window-size=500,290'], null);
    {
        const page = await open('two pixels a point');
        await set(page, { panel: false });
        const [size, points] = [(await state(page)).size, await page.evaluate('[innerWidth, innerHeight]')];
        report(
            'two pixels a point',
            String(size) === String(points.map((side) => 2 * side)),
            `${size} on ${points}`,
        );
        await check(page, 'two-pixels-a-point', sky, { roughness: 0.3 }, { size });
    }
    await browser.close();

    // Without an adapter, and without the interface.
    browser = await launch(['--disable-features=WebGPU,WebGPUService']);
    for (const [what, before] of [
        ['adapter', () => {}],
        ['navigator.gpu', () => delete Navigator.prototype.gpu],
    ]) {
        const page = await browser.newPage();
        await page.evaluateOnNewDocument(before);
        await page.goto(origin);
        await page.waitForFunction('window.ready === true', { timeout: 60_000 });
        const shown = await page.$eval('#text', (text) => text.checkVisibility() && text.textContent);
        report(
            `without ${what} the page says so`,
            shown && shown.startsWith('WebGPU is not available.'),
            shown,
        );
        await page.screenshot({ path: join(pictures, `no-${what}.png`) });
    }
} catch (error) {
    report('run', false, error.stack);
} finally {
    await browser?.close();
    server.kill();
    rmSync(work, { recursive: true, force: true });
}
console.log(failures === 0 ? 'the page agrees' : `${failures} checks failed`);
process.exit(failures === 0 ? 0 : 1);
