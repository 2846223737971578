// Drives the Scene side of web/dist in headless Chromium, and compares its pictures with `octagloss view
// --scene`.
//
//   node web/scene-test.mjs PROGRAM [CHROMIUM]
//
// PICTURES=DIRECTORY keeps the pictures there. Exit status 0 when everything agrees, 1 otherwise.
import { spawnSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import {
    capture,
    checkBroken,
    checkIdle,
    difference,
    drop,
    launch,
    open,
    program,
    programPicture,
    refusal,
    report,
    root,
    run,
    said,
    set,
    shot,
    state,
    webgpu,
    work,
} from './driver.mjs';

// Drivers snap corners to a grid: SwiftShader to 1/16 of a pixel, so an edge moves by at most 1/32, and other
// drivers by less. A pixel on an edge changes if the edge moves over its centre: with a probability of the
// movement of both drivers, at most 1/16. Pictures have edges, and so have the maps that they reflect: twice
// that, of the pixels on edges. Inside of faces drivers round one channel to either of two levels, at most
// 1/2 in the mean.
const most = ({ edges }) => ({ mean: 0.5 + (255 * edges) / 16, share: edges / 8 });
const agrees = (found) => found.mean <= most(found).mean && found.share <= most(found).share;
const bound = (found) =>
    `at most ${most(found).mean.toFixed(3)} and ${(100 * most(found).share).toFixed(3)} %`;

// The option of the command line for a setting.
const option = ([word, value]) => [`--${word.replaceAll('_', '-')}`, value];

// Compares the page's picture of `settings` with the program's; `scene` are arguments of --scene.
async function check(page, name, settings, scene = []) {
    await set(page, { panel: false, moving: false, ...settings });
    const wanted = programPicture(name, ['--scene', ...scene, ...Object.entries(settings).flatMap(option)]);
    const found = await difference(page, await shot(page, name), wanted);
    report(name, agrees(found), `${said(found)} (${bound(found)})`);
    return wanted;
}

// A binary glTF file: a metal box before a red wall, and an emitting one, whose JSON `change` edits.
function glb(change = () => {}, edit = () => {}) {
    const corners = [];
    const indices = [];
    const quad = (at) => {
        const first = corners.length;
        corners.push(...at);
        indices.push(...[0, 1, 2, 0, 2, 3].map((k) => first + k));
    };
    const sides = [-0.5, 0.5];
    for (const axis of [0, 1, 2]) {
        for (const side of sides) {
            const corner = (a, b) => {
                const at = [0, 0, 0];
                [at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]] = [side, a * side * 2, b];
                return at;
            };
            quad([corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)]);
        }
    }
    const box = indices.length;
    quad([[-2, -1, -1], [2, -1, -1], [2, 1, -1], [-2, 1, -1]]);
    quad([[-2, -1, 1], [-2, -1, -1], [-2, 1, -1], [-2, 1, 1]]);
    const positions = new Float32Array(corners.flat());
    const numbers = new Uint16Array(indices);
    edit(positions, numbers);
    const bytes = Buffer.concat([Buffer.from(positions.buffer), Buffer.from(numbers.buffer)]);
    const views = [
        { buffer: 0, byteOffset: 0, byteLength: positions.byteLength },
        { buffer: 0, byteOffset: positions.byteLength, byteLength: numbers.byteLength },
    ];
    const accessor = (first, count) => ({
        bufferView: 1,
        byteOffset: 2 * first,
        componentType: 5123,
        count,
        type: 'SCALAR',
    });
    const low = [0, 1, 2].map((c) => Math.min(...corners.map((corner) => corner[c])));
    const high = [0, 1, 2].map((c) => Math.max(...corners.map((corner) => corner[c])));
    const json = {
        asset: { version: '2.0' },
        scene: 0,
        scenes: [{ nodes: [0] }],
        nodes: [{ mesh: 0 }],
        meshes: [
            {
                primitives: [0, 1, 2].map((k) => ({
                    attributes: { POSITION: 0 },
                    indices: 1 + k,
                    material: k,
                })),
            },
        ],
        materials: [
            { pbrMetallicRoughness: { roughnessFactor: 0.1 } },
            { pbrMetallicRoughness: { metallicFactor: 0, baseColorFactor: [0.8, 0.1, 0.1, 1] } },
            { pbrMetallicRoughness: { metallicFactor: 0 }, emissiveFactor: [0.1, 0.9, 0.2] },
        ],
        buffers: [{ byteLength: bytes.length }],
        bufferViews: views,
        accessors: [
            { bufferView: 0, componentType: 5126, count: corners.length, type: 'VEC3', min: low, max: high },
            accessor(0, box),
            accessor(box, 6),
            accessor(box + 6, 6),
        ],
    };
    change(json);
    const padded = (chunk, fill) => Buffer.concat([chunk, Buffer.alloc(-chunk.length & 3, fill)]);
    const chunk = (kind, content) => {
        const header = Buffer.alloc(8);
        header.writeUInt32LE(content.length, 0);
        header.write(kind, 4, 'latin1');
        return Buffer.concat([header, content]);
    };
    const text = Buffer.from(JSON.stringify(json));
    const chunks = [chunk('JSON', padded(text, 0x20)), chunk('BIN\0', padded(bytes, 0))];
    const header = Buffer.alloc(12);
    header.write('glTF', 0);
    header.writeUInt32LE(2, 4);
    header.writeUInt32LE(12 + chunks[0].length + chunks[1].length, 8);
    return Buffer.concat([header, ...chunks]);
}

// The program's message for a scene file that it refuses.
function programMessage(name, bytes) {
    writeFileSync(join(work, name), bytes);
    const args = ['view', '--scene', name, '--screenshot', 'none.png', '--size', '8x8'];
    const { status, stderr } = spawnSync(resolve(program), args, { cwd: work, encoding: 'utf8' });
    if (status !== 1) throw new Error(`${name}: the program ended with status ${status}: ${stderr}`);
    return stderr.trim().replace(/^octagloss: (error: )?/, '');
}

// A software driver takes a second or more for a frame.
const slow = { timeout: 300_000, polling: 200 };

await run(async () => {
    const browser = await launch(webgpu);
    console.log(await browser.version());
    const page = await open('page');
    await page.evaluate(() => document.getElementById('scene').click());
    await page.waitForFunction(() => window.octagloss.state().side === 'scene', slow);
    // A software driver draws larger maps for minutes.
    const quick = { oem_size: 32, filter: 'pyramid', probes: 1 };
    await page.evaluate((settings) => window.octagloss.set(settings), quick);
    const first = await state(page);
    await page.waitForFunction((was) => window.octagloss.state().scene_time > was, slow, first.scene_time);
    const before = await capture(page, 'scene-panel');
    const later = (was) => window.octagloss.state().scene_time > was + 1;
    await page.waitForFunction(later, slow, first.scene_time);
    const moved = await difference(page, await capture(page, 'scene-panel-later'), before);
    report('the scene moves', moved.share > 0.01, `on ${first.adapter}; ${said(moved)}`);

    const wanted = await check(page, 'scene', { scene_time: 2.5, ...quick });
    await check(page, 'scene-later', { scene_time: 4, ...quick });
    const other = await difference(page, await shot(page, 'scene-later'), wanted);
    report('a second frame differs', !agrees(other), `${said(other)} (${bound(other)})`);
    await checkIdle(page, 'the scene');

    await check(page, 'scene-options', { scene_time: 1, roughness: 0.4, proxy: 'sphere', ...quick });
    await set(page, { roughness: null });
    const small = { ...quick, scene_time: 2.5, probes: 2, proxy: 'none', tone: 'aces', exposure: 1 };
    for (const direct of ['clip-mask', 'strict-split', 'cube', 'whole-cube', 'octants'])
        await check(page, `scene-${direct}`, { ...small, direct });

    for (const [change, words] of [
        [{ proxy: 'cone' }, 'proxy must be none, box or sphere'],
        [{ direct: 'magic' }, 'direct must be octants, '],
        [{ filter: 'box' }, 'use pyramid'],
        [{ roughness: 2 }, 'roughness 2 is outside [0, 1]'],
        [{ probes: 0 }, '1 to 8'],
        [{ oem_size: 100 }, 'a power of two'],
        [{ probe_budget: -1 }, '0 to 10000 milliseconds'],
        [{ metal: 1 }, 'unknown field'],
    ]) {
        const message = await refusal(page, change);
        report(`${JSON.stringify(change)} is refused`, message.includes(words), message);
    }

    const timed = await page.evaluate(async () =>
        (await navigator.gpu.requestAdapter()).features.has('timestamp-query'),
    );
    await page.evaluate(() => window.octagloss.set({ gpu_times: true, probe_budget: 1 }));
    await page.waitForFunction(() => {
        const { gpu_times, message } = window.octagloss.state();
        return message || gpu_times.picture !== undefined;
    }, slow);
    const { gpu_times, message } = await state(page);
    const times = Object.entries(gpu_times);
    const measured = times.length > 5 && times.every(([, seconds]) => seconds >= 0);
    const detail = times.map(([pass, seconds]) => `${pass} ${(1e3 * seconds).toFixed(2)} ms`).join(', ');
    report('GPU times', timed ? measured : message.includes('timestamp'), message ?? detail);
    await set(page, { gpu_times: false, probe_budget: null });

    // A scene of one's own, from its first look.
    const mine = { scene_time: 1, oem_size: 64, filter: 'pyramid', tone: 'neutral', exposure: 0 };
    await drop(page, 'mine.glb', glb(), (name) => window.octagloss.state().scene === name);
    writeFileSync(join(work, 'mine.glb'), glb());
    await check(page, 'scene-file', mine, [join(work, 'mine.glb')]);
    const node = (change) => (json) => Object.assign(json.nodes[0], change);
    for (const [name, bytes] of [
        ['truncated.glb', glb().subarray(0, 700)],
        ['text.glb', Buffer.from('no scene')],
        ['nan.glb', glb(undefined, (positions) => (positions[4] = NaN))],
        ['range.glb', glb(undefined, (_, numbers) => (numbers[7] = 999))],
        ['empty.glb', glb((json) => (json.scenes[0].nodes = []))],
        ['cycle.glb', glb(node({ children: [0] }))],
        [
            'texture.glb',
            glb((json) => (json.materials[1].pbrMetallicRoughness.baseColorTexture = { index: 7 })),
        ],
    ])
        await checkBroken(page, name, bytes, programMessage(name, bytes));
    await checkBroken(page, 'sky.hdr', Buffer.from('#?RADIANCE'), 'unknown mesh format');

    await page.evaluate(() => document.getElementById('scene').click());
    await page.waitForFunction(() => window.octagloss.state().side === 'view');
    await set(page, { roughness: 0.3, panel: false });
    const sky = programPicture('back', [
        ...[join(root, 'hdr/sky.exr'), '--roughness', 0.3, '--pitch', (0.07 * 180) / Math.PI],
    ]);
    const back = await difference(page, await shot(page, 'back'), sky);
    report('back at the environment', agrees(back), said(back));
});
