// Drives web/dist in headless Chromium over WebGPU (SwiftShader), and compares with `octagloss query`.
//
//   node web/test.mjs PROGRAM [CHROMIUM]
//
// Exit status 0 when everything agrees, 1 otherwise.
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
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

let failures = 0;
// Tells a check; `ok` false fails the run.
function tell(what, ok, detail) {
    console.log(`${ok ? 'ok    ' : 'FAILED'} ${what}: ${detail}`);
    failures += ok ? 0 : 1;
}

const octagloss = (args, input) =>
    execFileSync(program, args, { input, encoding: 'utf8', maxBuffer: 1 << 28, stdio: ['pipe', 'pipe', 'inherit'] });

// The program's own radiance for each of `directions`, one number after the other.
function query(file, directions, roughness, filter) {
    const csv = 'x,y,z\n' + directions.map((d) => d.join(',')).join('\n') + '\n';
    const args = ['query', file, '--directions', '-', '--roughness', String(roughness), '--filter', filter,
        '--oem-size', '256', '--quiet'];
    const rows = octagloss([...args, '--engine', 'cpu'], csv).trim().split('\n');
    const first = rows[0].split(',').indexOf('r');
    return rows.slice(1).flatMap((row) => row.split(',').slice(first, first + 3).map(Number));
}

// Directions all over the sphere, none on an axis or a fold: a spiral.
const spiral = Array.from({ length: 100 }, (_, i) => {
    const y = 1 - (2 * i + 1) / 100;
    const turn = i * Math.PI * (3 - Math.sqrt(5)) + 0.1;
    return [Math.sqrt(1 - y * y) * Math.cos(turn), y, Math.sqrt(1 - y * y) * Math.sin(turn)];
});

// The largest difference, as a share of the largest value.
function difference(found, expected) {
    const largest = Math.max(...expected);
    return found.length === expected.length && largest > 0
        ? Math.max(...found.map((value, i) => (Number.isFinite(value) ? Math.abs(value - expected[i]) / largest : Infinity)))
        : Infinity;
}

const server = spawn(join(here, 'serve'), ['0'], { stdio: ['ignore', 'pipe', 'ignore'] });
const origin = await new Promise((resolve, reject) => {
    createInterface(server.stdout).once('line', resolve);
    server.once('exit', (status) => reject(new Error(`web/serve ended with status ${status}`)));
});
const work = mkdtempSync(join(tmpdir(), 'octagloss-web-'));

const common = ['--no-sandbox', '--no-first-run', '--disable-quic', '--disable-background-networking',
    '--disable-component-update', '--disable-sync'];
const launch = (args) =>
    puppeteer.launch({ executablePath: chromium, headless: true, protocolTimeout: 600_000, args: [...common, ...args] });

// The page, any error or warning of which is a failure.
async function open(name) {
    const page = await browser.newPage();
    page.on('pageerror', (error) => tell(name, false, error.message));
    page.on('console', (message) => {
        if (['error', 'warn'].includes(message.type())) tell(name, false, message.text());
    });
    await page.goto(origin);
    await page.waitForFunction('window.ready === true', { timeout: 300_000 });
    return page;
}

const text = (page, id) => page.$eval(`#${id}`, (element) => element.textContent);

// Every entry point of every shader, through the browser's own compiler; and broken ones, which must not pass.
async function checkShaders(page) {
    const compiled = await page.evaluate(async () => {
        const { shader_paths, shader_source } = window.octagloss;
        const device = await (await navigator.gpu.requestAdapter()).requestDevice();
        const compile = async (code) => {
            device.pushErrorScope('validation');
            const module = device.createShaderModule({ code });
            const told = (await module.getCompilationInfo()).messages;
            const messages = told.map(({ type, lineNum, message }) => `${type}, line ${lineNum}: ${message}`);
            const entries = [...code.matchAll(/@compute[^{]*?\bfn\s+(\w+)/g)].map(([, name]) => name);
            for (const entryPoint of entries) {
                await device.createComputePipelineAsync({ layout: 'auto', compute: { module, entryPoint } })
                    .catch((error) => messages.push(`${entryPoint}: ${error.message}`));
            }
            const error = await device.popErrorScope();
            if (error && !messages.length) messages.push(error.message);
            return { entries, messages };
        };
        const all = [];
        for (const path of shader_paths()) all.push({ path, ...(await compile(shader_source(path))) });
        const copy = shader_source('copy.wgsl');
        const broken = [
            { path: 'no semicolon', code: copy.replace(';', '') },
            { path: 'group too large', code: copy.replace(/@workgroup_size\([^)]*\)/, '@workgroup_size(1024)') },
        ];
        for (const { path, code } of broken) all.push({ path, broken: true, ...(await compile(code)) });
        return all;
    });
    for (const { path, broken, entries, messages } of compiled) {
        const ok = broken ? messages.length > 0 : messages.length === 0 && entries.length > 0;
        tell(`Tint: ${path}`, ok, messages.map((message) => message.split('\n')[0]).join('; ') || entries.join(', '));
    }
}

// A file as the page reads it, over WebGPU, against the program.
async function checkFile(page, file, roughness, filter, most) {
    const bytes = readFileSync(file).toString('base64');
    const { found, seconds, reading } = await page.evaluate(
        async (name, bytes, directions, roughness, filter) => {
            const { Environment, gpu } = window.octagloss;
            const data = Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0));
            const start = performance.now();
            const environment = Environment.read(name, data);
            const read = performance.now();
            const found = await gpu.query(environment, Float64Array.from(directions.flat()), roughness, filter, 256);
            return { found: [...found], reading: (read - start) / 1000, seconds: (performance.now() - read) / 1000 };
        },
        basename(file), bytes, spiral, roughness, filter,
    );
    const expected = query(file, spiral, roughness, filter);
    const [own, other] = [difference(found, expected), difference(query(file, spiral, roughness + 0.05, filter), expected)];
    tell(`${filter} at ${roughness}: ${basename(file)}`, own <= most,
        `${own.toExponential(1)} of the peak off (at most ${most}); ${reading.toFixed(2)} s to read, ${seconds.toFixed(2)} s to answer`);
    tell(`${filter} at ${roughness + 0.05} differs: ${basename(file)}`, other > most, `${other.toExponential(1)} of the peak`);
}

let browser;
try {
    browser = await launch(['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader']);
    console.log(await browser.version());
    const page = await open('page');
    const message = await text(page, 'message');
    tell('sky.exr is shown', message.startsWith('sky.exr on '), message);
    const shown = (await text(page, 'answers')).split('\n').map((line) => line.split(': '));
    const axes = shown.map(([direction]) => direction.split(',').map(Number));
    const own = difference(shown.flatMap(([, radiance]) => radiance.split(',').map(Number)),
        query(join(root, 'hdr/sky.exr'), axes, 0.5, 'box'));
    tell('what is shown', axes.length === 6 && own <= 1e-5, `${own.toExponential(1)} of the peak off`);

    await checkShaders(page);
    octagloss(['bake', join(root, 'hdr/studio.hdr'), '--size', '64', '--quiet', '-o', join(work, 'studio.ktx2')]);
    const files = ['sky.exr', 'studio.hdr', 'labelled-cube.exr', 'labelled.exr'].map((name) => join(root, 'hdr', name));
    for (const file of [...files, join(work, 'studio.ktx2')]) {
        await checkFile(page, file, 0.5, 'box', 1e-5);
    }
    await checkFile(page, join(root, 'hdr/sky.exr'), 0.3, 'adaptive', 1e-5);

    const refused = await page.evaluate(() => {
        try {
            window.octagloss.Environment.read('note.txt', new TextEncoder().encode('no image'));
            return 'it was read';
        } catch (error) {
            return error.message;
        }
    });
    tell('what is no image is refused', refused.startsWith('note.txt: not an image'), refused);
    await browser.close();

    // Without an adapter, and without the interface.
    browser = await launch(['--disable-features=WebGPU,WebGPUService']);
    for (const [what, before] of [['adapter', () => {}], ['navigator.gpu', () => delete Navigator.prototype.gpu]]) {
        const page = await browser.newPage();
        await page.evaluateOnNewDocument(before);
        await page.goto(origin);
        await page.waitForFunction('window.ready === true', { timeout: 60_000 });
        const message = await text(page, 'message');
        tell(`no ${what} is told`, message.startsWith('No WebGPU here.'), message);
    }
} catch (error) {
    tell('run', false, error.stack);
} finally {
    await browser?.close();
    server.kill();
    rmSync(work, { recursive: true, force: true });
}
console.log(failures === 0 ? 'the page agrees' : `${failures} checks failed`);
process.exit(failures === 0 ? 0 : 1);
