// Drives the Bake side of web/dist in headless Chromium: bakes, downloads, loads the files in three.js, and
// compares them with the command line.
//
//   node web/bake-test.mjs PROGRAM [CHROMIUM]
//
// PICTURES=DIRECTORY keeps screenshots there. SMOKE=1 runs the first checks only. Exit status 0 when
// everything agrees, 1 otherwise.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { drawn, reflected, relativeError, spherePixels, EYES } from '../tests/consumers/pictures.mjs';
import {
    dropFile,
    here,
    launch,
    newPage,
    pictures,
    program,
    report,
    root,
    runChecks,
    work,
} from './harness.mjs';

const downloads = join(work, 'downloads');
mkdirSync(downloads);
const octagloss = (args, input) =>
    execFileSync(program, args.map(String), {
        input,
        encoding: 'utf8',
        maxBuffer: 1 << 28,
        stdio: ['pipe', 'pipe', 'inherit'],
    });
const environment = join(root, 'hdr/labelled.exr');
const studio = join(root, 'hdr/studio.hdr');

// The page at /, as a static server has it; the package and three.js below /node_modules.
const types = {
    '.html': 'text/html',
    '.js': 'text/javascript',
    '.css': 'text/css',
    '.wasm': 'application/wasm',
    '.json': 'application/json',
};
const folders = [
    ['/node_modules/octagloss/', join(root, 'npm/dist')],
    ['/node_modules/', join(here, 'node_modules')],
    ['/test/', here],
    ['/example/', join(root, 'npm/examples')],
    ['/made/', work],
    ['/', join(here, 'dist')],
];
const asked = [];
const server = createServer((request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
    asked.push([request.method, path]);
    const [prefix, folder] = folders.find(([prefix]) => path.startsWith(prefix));
    // The example's own file.
    const own =
        path === '/example/sky_pmrem.ktx2' || path === '/example/sky_sh.json'
            ? join(work, path.slice(9))
            : undefined;
    try {
        const body = readFileSync(own ?? join(folder, path.slice(prefix.length) || 'index.html'));
        response
            .writeHead(200, {
                'content-type':
                    types[extname(path)] ?? (path === '/' ? 'text/html' : 'application/octet-stream'),
            })
            .end(body);
    } catch {
        response.writeHead(404).end();
    }
});
await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
const origin = `http://127.0.0.1:${server.address().port}`;

// The browser's own words about its GPU, and about files that are missing on purpose.
const expected = ['GPU stall', 'WebGPU Context Provider', '404'];
async function open(name, path, ready) {
    const page = await newPage(name, expected);
    await page.goto(`${origin}${path}`);
    await page.waitForFunction(ready, { timeout: 120_000 });
    return page;
}

const shot = (page, name) => page.screenshot({ path: join(pictures, `${name}.png`) });
const text = (page, selector) => page.$eval(selector, (element) => element.textContent);
const job = (name, inside = '') => `#bake-jobs > li[data-name="${name}"] ${inside}`;

async function choose(page, ...files) {
    const input = await page.$('#bake-file');
    await input.uploadFile(...files);
}

async function drop(page, name, bytes) {
    await dropFile(page, name, bytes);
    await page.waitForSelector(job(name));
}

async function fill(page, values) {
    for (const [word, value] of Object.entries(values)) {
        await page.$eval(
            `#bake [name="${word}"]`,
            (input, value) => {
                input.value = value;
                input.dispatchEvent(new Event('input', { bubbles: true }));
            },
            String(value),
        );
    }
}

const finished = (page) =>
    page.waitForFunction(
        () =>
            document.getElementById('bake-cancel').disabled &&
            document.getElementById('bake-message').textContent !== '',
        { timeout: 300_000, polling: 100 },
    );

async function run(page) {
    await page.click('#bake-start');
    await finished(page);
    return text(page, '#bake-message');
}

async function downloaded(page, selector, name) {
    const path = join(downloads, name);
    rmSync(path, { force: true });
    await page.click(selector);
    for (let tries = 0; !existsSync(path); tries++) {
        if (tries > 200) throw new Error(`${name} was not downloaded: ${readdirSync(downloads)}`);
        await new Promise((resolve) => setTimeout(resolve, 50));
    }
    return path;
}

// As in npm/test.mjs.
const MAX = 1e-5;
const error = (a, b) =>
    Math.max(...JSON.parse(octagloss(['compare', a, b, '--json'])).levels.map((level) => level.rel_rmse));

async function checks() {
    const browser = await launch(
        [
            '--use-angle=swiftshader',
            '--enable-unsafe-swiftshader',
            '--ignore-gpu-blocklist',
            '--disable-features=WebGPU,WebGPUService',
        ],
        { width: 1100, height: 800 },
    );
    const client = await browser.target().createCDPSession();
    await client.send('Browser.setDownloadBehavior', { behavior: 'allow', downloadPath: downloads });

    // The Bake side, without a viewer.
    const page = await open('page', '/', 'window.ready === true');
    const early = asked.some(([, path]) => path.includes('octagloss/'));
    report('the module is loaded on demand', !early, `${asked.length} files first`);
    await page.click('#open-bake');
    await page.waitForSelector('#bake[data-ready=true]');
    await choose(page, environment);
    await fill(page, { size: 128 });
    await shot(page, 'bake-chosen');
    const command = await text(page, '#bake-command');
    report(
        'the command is shown',
        command === 'octagloss bake labelled.exr --target three --size 128 -o labelled',
        command,
    );
    const said = await run(page);
    await shot(page, 'bake-done');
    report(
        'one file is baked',
        said === '1 baked, 0 failed',
        `${said}: ${await text(page, job('labelled.exr', '.status'))}`,
    );
    const links = await page.$$eval(job('labelled.exr', '.files a'), (all) =>
        all.map((link) => link.textContent),
    );
    report(
        'its files',
        String(links) === 'labelled_pmrem.ktx2,labelled_sh.json,report.json',
        links.join(' '),
    );
    const drawnPreview = await page.$eval(job('labelled.exr', 'img'), (image) =>
        image.decode().then(() => [image.naturalWidth, image.naturalHeight]),
    );
    report('its preview', drawnPreview[0] > 500 && drawnPreview[1] > 200, drawnPreview.join(' x '));

    const pmrem = await downloaded(
        page,
        job('labelled.exr', '.files li:nth-child(1) a'),
        'labelled_pmrem.ktx2',
    );
    const sh = await downloaded(page, job('labelled.exr', '.files li:nth-child(2) a'), 'labelled_sh.json');
    const folder = join(work, 'program');
    octagloss([
        'bake',
        environment,
        '--target',
        'three',
        '--size',
        128,
        '--engine',
        'cpu',
        '--quiet',
        '-o',
        folder,
    ]);
    const off = error(pmrem, join(folder, 'labelled_pmrem.ktx2'));
    report('the download agrees with the program', off <= MAX, `relative RMS error ${off.toExponential(1)}`);

    // A broken file beside a good one, and a second bake.
    const exr = readFileSync(environment);
    await drop(page, 'half.exr', exr.subarray(0, exr.length / 2));
    await choose(page, studio);
    const both = await run(page);
    const broken = await text(page, job('half.exr', '.status'));
    await shot(page, 'bake-broken');
    report(
        'a broken file fails alone',
        both === '2 baked, 1 failed' && broken.startsWith('half.exr: '),
        `${both}: ${broken}`,
    );
    const archive = await downloaded(page, '#bake-zip', 'baked.zip');
    const unpacked = join(work, 'zip');
    execFileSync('python3', ['-m', 'zipfile', '-e', archive, unpacked]);
    const second = error(join(unpacked, 'labelled/labelled_pmrem.ktx2'), pmrem);
    report(
        'the zip holds the second bake',
        second === 0 && existsSync(join(unpacked, 'studio/studio_pmrem.ktx2')),
        `${readdirSync(unpacked, { recursive: true }).length} entries`,
    );

    // Cancelled, and wrong options.
    await fill(page, { size: 1024 });
    await page.click('#bake-start');
    await page.waitForFunction(
        (selector) => /^\d+ %$/.test(document.querySelector(selector).textContent),
        { timeout: 120_000 },
        job('labelled.exr', '.status'),
    );
    await shot(page, 'bake-running');
    await page.click('#bake-cancel');
    await finished(page);
    const ended = await text(page, '#bake-message');
    report('a bake is cancelled', /, [123] cancelled$/.test(ended), ended);
    await fill(page, { size: 64, filter: 'nonsense' });
    await run(page);
    const wrong = await text(page, job('labelled.exr', '.status'));
    report('a wrong filter is named', wrong.includes('`filter` is "nonsense"'), wrong);
    report(
        'nothing is uploaded',
        asked.every(([method]) => method === 'GET'),
        `${asked.length} requests`,
    );

    if (!process.env.SMOKE) {
        await page.setViewport({ width: 420, height: 800 });
        await page.click('#bake summary');
        await shot(page, 'bake-narrow');

        // three.js with the downloaded files, and with the source.
        writeFileSync(join(work, 'labelled_pmrem.ktx2'), readFileSync(pmrem));
        writeFileSync(join(work, 'labelled_sh.json'), readFileSync(sh));
        writeFileSync(join(work, 'labelled.exr'), exr);
        const probe = await open('three.js', '/test/bake-test.html', 'window.ready === true');
        const load = (...args) => probe.evaluate((args) => window.load(...args), args);
        const file = await load('file', '/made/labelled_pmrem.ktx2');
        const spot = await load('spot', '/made/labelled.exr', { size: 128 });
        report(
            'three.js loads a file and bakes one',
            file.levels === 5 &&
                spot.levels === 5 &&
                !file.baked &&
                spot.baked &&
                file.probe.length === 27 &&
                String(file.probe) === String(spot.probe),
            `${file.levels} levels`,
        );
        const ask = (directions, ...args) => {
            const csv = 'x,y,z\n' + directions.map((d) => d.join(',')).join('\n') + '\n';
            const rows = octagloss(
                ['query', environment, '--directions', '-', '--engine', 'cpu', '--quiet', ...args],
                csv,
            );
            return rows
                .trim()
                .split('\n')
                .slice(1)
                .map((row) => row.split(',').slice(3).map(Number));
        };
        const eye = EYES.at(-1);
        const seen = async (key, roughness, pixels) => {
            const picture = await probe.evaluate((options) => window.sphere(options), {
                key,
                roughness,
                eye,
            });
            return pixels.map(({ at }) => picture.pixels.slice(4 * at, 4 * at + 3));
        };
        const pixels = spherePixels(256, eye, 8);
        const rest = ask(
            pixels.map((p) => p.normal),
            '--lobe',
            'cosine',
        );
        for (const level of [1, 2, 3, 4]) {
            // Those of the levels, so that no two are mixed.
            const roughness = 1 - Math.sqrt(1 - level / 4);
            const lobes = ask(
                pixels.map((p) => drawn(p, roughness)),
                '--roughness',
                String(roughness),
            );
            const expected = pixels.map((p, k) => {
                const once = reflected(p.cosine, roughness);
                return lobes[k].map((v, c) => once * v + (1 - once) * rest[k][c]);
            });
            const [a, b] = [await seen('file', roughness, pixels), await seen('spot', roughness, pixels)];
            const [first, other] = [relativeError(a, expected), relativeError(b, a)];
            report(
                `three.js at roughness ${roughness.toFixed(3)}`,
                first < 0.03 && other < 1e-4,
                `relative error ${first.toFixed(4)}, on the spot ${other.toExponential(1)} apart`,
            );
        }
        // Nine harmonics of irradiance.
        const matt = relativeError(await seen('file', undefined, pixels), rest);
        report('three.js with the probe', matt < 0.05, `relative error ${matt.toFixed(4)}`);
        const refused = await probe.evaluate(() =>
            window.load('x', '/made/generic.ktx2').then(
                () => 'it was taken',
                (error) => error.message,
            ),
        );
        report('a missing file is named', refused.includes('/made/generic.ktx2: 404'), refused);
        octagloss([
            'bake',
            environment,
            '--target',
            'bevy',
            '--size',
            16,
            '--quiet',
            '-o',
            join(work, 'bevy'),
        ]);
        const foreign = await probe.evaluate(() =>
            window.load('x', '/made/bevy/labelled_specular.ktx2').then(
                () => 'it was taken',
                (error) => error.message,
            ),
        );
        report("another engine's file is refused", foreign.includes('baked for bevy'), foreign);

        // The example of the package.
        octagloss([
            'bake',
            join(root, 'hdr/sky.exr'),
            '--target',
            'three',
            '--name',
            'sky',
            '--size',
            128,
            '--quiet',
            '-o',
            join(work, 'sky'),
        ]);
        for (const name of ['sky_pmrem.ktx2', 'sky_sh.json'])
            writeFileSync(join(work, name), readFileSync(join(work, 'sky', name)));
        const example = await open('example', '/example/three.html', 'document.querySelector("canvas")');
        await example.waitForNetworkIdle();
        await shot(example, 'example-file');
        const colours = async () => {
            const png = Buffer.from(await example.screenshot()).toString('base64');
            return example.evaluate(async (png) => {
                const image = await createImageBitmap(
                    await (await fetch(`data:image/png;base64,${png}`)).blob(),
                );
                const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
                context.drawImage(image, 0, 0);
                const { data } = context.getImageData(0, 0, image.width, image.height);
                return new Set(
                    Array.from(
                        { length: data.length / 4 },
                        (_, k) => (data[4 * k] << 16) | (data[4 * k + 1] << 8) | data[4 * k + 2],
                    ),
                ).size;
            }, png);
        };
        const before = await colours();
        report('the example draws', before > 500, `${before} colours`);
    }
}

await runChecks(checks, 'the Bake side', () => server.close());
