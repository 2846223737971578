// Loads the output of `octagloss bake --target` into the engines in headless Chromium, renders with them, and
// compares the pictures with `octagloss query`.
//
//   node tests/consumers/run.mjs PROGRAM [ENGINE...]
//
// ENGINE: three, filament, babylon, playcanvas, khronos or gltf; all by default. CHROMIUM in the environment
// names the browser. Exit status 0 when every picture agrees, 1 otherwise.
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import puppeteer from 'puppeteer-core';
import { checkBabylon } from './babylon.mjs';
import { checkFilament } from './filament.mjs';
import { checkGltf } from './gltf.mjs';
import { checkKhronos } from './khronos.mjs';
import { checkPlayCanvas } from './playcanvas.mjs';
import { finish, programAt, check, recipe, root } from './program.mjs';
import { checkThree } from './three.mjs';

const here = fileURLToPath(new URL('.', import.meta.url));
const checks = {
    three: checkThree,
    filament: checkFilament,
    babylon: checkBabylon,
    playcanvas: checkPlayCanvas,
    khronos: checkKhronos,
    gltf: checkGltf,
};
const chromium = process.env.CHROMIUM ?? '/usr/bin/chromium';
const [program, ...named] = process.argv.slice(2);
const engines = named.length ? named : Object.keys(checks);
if (!program || engines.some((engine) => !checks[engine])) {
    console.error(`usage: node run.mjs PROGRAM [ENGINE...]; engines: ${Object.keys(checks).join(', ')}`);
    process.exit(2);
}
const work = mkdtempSync(join(tmpdir(), 'octagloss-consumers-'));

const types = {
    '.html': 'text/html',
    '.js': 'text/javascript',
    '.mjs': 'text/javascript',
    '.wasm': 'application/wasm',
};
const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
    if (path === '/favicon.ico') {
        response.writeHead(204).end();
        return;
    }
    if (path.startsWith('/recipe/')) {
        response.writeHead(200, { 'content-type': 'text/plain' }).end(recipe(path.slice(8), 'js'));
        return;
    }
    const folder = [
        ['/bake/', work],
        ['/octagloss/', join(root, 'npm', 'js')],
    ].find(([prefix]) => path.startsWith(prefix));
    const file = folder ? join(folder[1], path.slice(folder[0].length)) : join(here, path);
    try {
        const body = readFileSync(file);
        response
            .writeHead(200, { 'content-type': types[extname(file)] ?? 'application/octet-stream' })
            .end(body);
    } catch {
        response.writeHead(404).end();
    }
});
await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
const origin = `http://127.0.0.1:${server.address().port}`;

let browser;

async function open(name) {
    const page = await browser.newPage();
    page.on('pageerror', (error) => check(name, false, error.message));
    page.on('console', (message) => {
        if (message.type() === 'error') check(name, false, message.text());
    });
    await page.goto(`${origin}/${name}`);
    await page.waitForFunction('window.ready === true', { timeout: 60_000 });
    return page;
}

try {
    browser = await puppeteer.launch({
        executablePath: chromium,
        headless: true,
        protocolTimeout: 600_000,
        args: [
            '--no-sandbox',
            '--use-angle=swiftshader',
            '--enable-unsafe-swiftshader',
            '--ignore-gpu-blocklist',
        ],
    });
    const parts = { open, check, ...programAt(program, work) };
    for (const engine of engines) await checks[engine](parts);
} catch (error) {
    check('run', false, error.stack);
} finally {
    await browser?.close();
    server.close();
    rmSync(work, { recursive: true, force: true });
}
finish(named.length ? named.join(', ') : 'all engines');
