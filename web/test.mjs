// Drives web/dist in headless Chromium over WebGPU (SwiftShader), and compares its pictures with `octagloss
// view`.
//
//   node web/test.mjs PROGRAM [CHROMIUM]
//
// PICTURES=DIRECTORY keeps the pictures there. Exit status 0 when everything agrees, 1 otherwise.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import {
    checkBroken,
    checkIdle,
    choose,
    difference,
    drop,
    height,
    launch,
    open,
    origin,
    pictures,
    programPicture,
    refusal,
    report,
    root,
    run,
    said,
    set,
    settled,
    shot,
    state,
    webgpu,
    width,
    work,
} from './driver.mjs';

const sky = join(root, 'hdr/sky.exr');
const studio = join(root, 'hdr/studio.hdr');

// Tolerance for the drivers' rounding and for pixels on edges. The sky's ground has one colour over up to
// half of a picture: if a channel lies between two levels, drivers round it differently, which is 1/2 * 1/3
// in the mean.
const most = { mean: 0.2, share: 0.005 };
const agrees = ({ mean, share }) => mean <= most.mean && share <= most.share;

// The program's picture of the page's default view, with the given changes.
function expected(name, file, { roughness = 0.3, filter = 'pyramid', size, yaw = 0, ...others }) {
    const degrees = (radians) => (radians * 180) / Math.PI;
    const args = [file, '--roughness', roughness, '--filter', filter, '--yaw', degrees(yaw)];
    const more = Object.entries(others).flatMap(([option, value]) => [`--${option}`, value]);
    return programPicture(name, [...args, '--pitch', degrees(0.07), ...more], size);
}

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
    await checkBroken(page, 'broken.obj', Buffer.from('f 1 2 3'), 'broken.obj');
    await set(page, { object: 'sphere' });
}

await run(async () => {
    const browser = await launch(webgpu);
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

    await check(page, 'at-first', sky, { roughness: 0.2 });
    await set(page, { roughness: 0.3 });
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
    const brushed = { filter: 'reflect', anisotropy: 0.6, clearcoat: 0.5 };
    await check(page, 'brushed', sky, { roughness: 0.4, ...brushed });
    console.log(`       other filters: ${since()}`);
    await set(page, { filter: 'pyramid', roughness: 0.3, anisotropy: 0, clearcoat: 0 });

    await checkIdle(page, 'the sky');

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

    const refused = await refusal(page, { roughness: 2 });
    report('a roughness of 2 is refused', refused.includes('roughness 2 is outside'), refused);
    from = performance.now();
    await checkShaders(page);
    console.log(`       shaders: ${since()}`);

    // A display with two pixels a point needs a real browser option; emulated ones report one to the page.
    await launch([...webgpu, '--force-device-scale-factor=2', '--window-size=500,290'], null);
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

    // Without an adapter, and without the interface.
    const without = await launch(['--disable-features=WebGPU,WebGPUService']);
    for (const [what, before] of [
        ['adapter', () => {}],
        ['navigator.gpu', () => delete Navigator.prototype.gpu],
    ]) {
        const page = await without.newPage();
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
});
