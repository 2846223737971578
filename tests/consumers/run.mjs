// Loads what `octagloss bake --target` writes into the engines themselves, in headless Chromium, renders with them, and
// compares with the program's own answers (`octagloss query`).
//
//   node tests/consumers/run.mjs PROGRAM [CHROMIUM]
//
// Exit status 0 when every picture agrees, 1 otherwise.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import puppeteer from 'puppeteer-core';
import { checkBabylon } from './babylon.mjs';
import { checkFilament } from './filament.mjs';
import { checkThree } from './three.mjs';

const here = fileURLToPath(new URL('.', import.meta.url));
const root = join(here, '..', '..');
const [program, chromium = '/usr/bin/chromium'] = process.argv.slice(2);
if (!program) {
    console.error('usage: node run.mjs PROGRAM [CHROMIUM]');
    process.exit(2);
}
const work = mkdtempSync(join(tmpdir(), 'octagloss-consumers-'));
const environment = join(root, 'hdr', 'labelled.exr');

const octagloss = (args, input) =>
    execFileSync(program, args, { input, encoding: 'utf8', maxBuffer: 1 << 28, stdio: ['pipe', 'pipe', 'inherit'] });

// The program's own radiance for each of `directions`.
export function query(directions, roughness) {
    const csv = 'x,y,z\n' + directions.map((d) => d.join(',')).join('\n') + '\n';
    const rows = octagloss(['query', environment, '--directions', '-', '--roughness', String(roughness), '--quiet'], csv);
    return rows.trim().split('\n').slice(1).map((row) => row.split(',').slice(3).map(Number));
}

// Irradiance over pi for each of `normals`.
export function diffuse(normals) {
    const csv = 'x,y,z\n' + normals.map((d) => d.join(',')).join('\n') + '\n';
    const rows = octagloss(['query', environment, '--directions', '-', '--lobe', 'cosine', '--quiet'], csv);
    return rows.trim().split('\n').slice(1).map((row) => row.split(',').slice(3).map(Number));
}

const types = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };
const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
    if (path === '/favicon.ico') {
        response.writeHead(204).end();
        return;
    }
    const file = path.startsWith('/bake/') ? join(work, path.slice(6)) : join(here, path);
    try {
        const body = readFileSync(file);
        response.writeHead(200, { 'content-type': types[extname(file)] ?? 'application/octet-stream' }).end(body);
    } catch {
        response.writeHead(404).end();
    }
});
await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
const origin = `http://127.0.0.1:${server.address().port}`;

let browser;
let failures = 0;
// Tells a check; `ok` false fails the run.
function tell(what, ok, detail) {
    console.log(`${ok ? 'ok    ' : 'FAILED'} ${what}: ${detail}`);
    failures += ok ? 0 : 1;
}

async function open(name) {
    const page = await browser.newPage();
    page.on('pageerror', (error) => tell(name, false, error.message));
    page.on('console', (message) => {
        if (message.type() === 'error') tell(name, false, message.text());
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
        args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
    });
    const bake = (folder, args) =>
        octagloss(['bake', environment, '--quiet', '--name', 'world', '-o', join(work, folder), ...args]);
    await checkThree({ open, bake, query, diffuse, tell });
    await checkFilament({ open, bake, query, diffuse, tell });
    await checkBabylon({ open, bake, query, diffuse, tell });
} catch (error) {
    tell('run', false, error.stack);
} finally {
    await browser?.close();
    server.close();
    rmSync(work, { recursive: true, force: true });
}
console.log(failures === 0 ? 'all engines agree' : `${failures} checks failed`);
process.exit(failures === 0 ? 0 : 1);
