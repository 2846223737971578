// Tests the built package in Node.js against the command line.
//
//   node npm/test.mjs PROGRAM [--smoke]
//
// Exit status 0 when everything agrees, 1 otherwise.
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, relative, win32 } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const root = fileURLToPath(new URL('..', import.meta.url));
const [program, how] = process.argv.slice(2);
if (!program || (how !== undefined && how !== '--smoke')) {
    console.error('usage: node test.mjs PROGRAM [--smoke]');
    process.exit(2);
}
// PACKAGE is the folder to test, such as that of an installed package. Windows imports URLs only: a drive is
// taken for a scheme.
const packageUrl = pathToFileURL(join(process.env.PACKAGE ?? join(root, 'npm/dist'), 'node.js')).href;
const { bake, info, query, targets, configure, close } = await import(packageUrl);

let failures = 0;
function report(what, ok, detail) {
    console.log(`${ok ? 'ok    ' : 'FAILED'} ${what}: ${detail}`);
    failures += ok ? 0 : 1;
}

const work = mkdtempSync(join(tmpdir(), 'octagloss-npm-'));
const octagloss = (...args) =>
    execFileSync(program, args.map(String), {
        encoding: 'utf8',
        maxBuffer: 1 << 28,
        stdio: ['ignore', 'pipe', 'inherit'],
    });
const sky = join(root, 'hdr/sky.exr');
const bytes = readFileSync(sky);

function write(folder, files) {
    for (const { name, bytes } of files) {
        mkdirSync(dirname(join(folder, name)), { recursive: true });
        writeFileSync(join(folder, name), bytes);
    }
}

const listed = (folder) =>
    readdirSync(folder, { recursive: true, withFileTypes: true })
        .filter((entry) => entry.isFile())
        .map((entry) =>
            relative(folder, join(entry.parentPath ?? entry.path, entry.name)).replaceAll('\\', '/'),
        )
        .sort();

// Mathematical functions of the platforms differ by a rounding, which moves few half floats.
const MAX = 1e-5;
const error = (a, b) =>
    Math.max(...JSON.parse(octagloss('compare', a, b, '--json')).levels.map((level) => level.rel_rmse));

// Bakes `input` with both, and compares files and levels.
async function compare(name, input, words, args, chains) {
    const [ours, theirs] = [join(work, name, 'npm'), join(work, name, 'program')];
    const baked = await bake(readFileSync(input), { input: 'sky.exr', name: 'sky', ...words });
    write(ours, baked.files);
    mkdirSync(theirs, { recursive: true });
    octagloss('bake', input, '--engine', 'cpu', '--quiet', '--force', ...args(theirs));
    report(
        `${name}: the same files`,
        String(listed(ours)) === String(listed(theirs)),
        listed(ours).join(' '),
    );
    for (const chain of chains) {
        const most = error(join(ours, chain), join(theirs, chain));
        report(
            `${name}: ${chain} agrees`,
            most <= MAX,
            `relative RMS error ${most.toExponential(1)} (at most ${MAX})`,
        );
    }
    return { baked, ours, theirs };
}
const targeted = (target) => (folder) => ['--target', target, '--name', 'sky', '--size', 64, '-o', folder];

const json = (folder, name) => JSON.parse(readFileSync(join(folder, name), 'utf8'));

async function refused(what, promise, words) {
    const message = await promise.then(
        () => 'it was taken',
        (error) => `${error instanceof Error ? '' : 'no Error: '}${error.message}`,
    );
    report(
        `${what} is refused`,
        words.every((word) => message.includes(word)) && !message.includes('--'),
        message,
    );
}

try {
    const shares = [];
    const three = await compare(
        'three',
        sky,
        { target: 'three', size: 64, onProgress: (share) => shares.push(share) },
        targeted('three'),
        ['sky_pmrem.ktx2'],
    );
    const rises = shares.every((share, index) => share > (shares[index - 1] ?? -1)) && shares.at(-1) === 1;
    report('progress rises to 1', shares.length > 5 && rises, `${shares.length} calls`);
    const flatten = ({ coefficients }) => coefficients.flat();
    const [ours, theirs] = [three.ours, three.theirs].map((folder) => flatten(json(folder, 'sky_sh.json')));
    const worst = Math.max(
        ...ours.map((value, index) => Math.abs(value - theirs[index]) / Math.abs(theirs[0])),
    );
    report(
        'three: harmonics agree',
        ours.length === 27 && worst < 1e-9,
        `${worst.toExponential(1)} of the first`,
    );
    // The report's keys, values that do not depend on the platform, and its file.
    const stable = ({
        recipe,
        oem,
        target,
        sh,
        conventions,
        input_files: [{ bytes, blake3 }],
        warnings,
        levels,
    }) =>
        JSON.stringify([
            recipe,
            oem,
            target,
            sh.order,
            conventions,
            bytes,
            blake3,
            warnings,
            levels.map(({ size, roughness, pixel }) => [size, roughness, pixel]),
        ]);
    report(
        'three: reports agree',
        stable(three.baked.report) === stable(json(three.theirs, 'report.json')) &&
            stable(three.baked.report) === stable(json(three.ours, 'report.json')),
        three.baked.report.generator,
    );
    const sharper = join(work, 'sharper');
    octagloss(
        'bake',
        sky,
        '--target',
        'three',
        '--name',
        'sky',
        '--size',
        64,
        '--rotate-y',
        1,
        '--engine',
        'cpu',
        '--quiet',
        '-o',
        sharper,
    );
    const turned = error(join(three.ours, 'sky_pmrem.ktx2'), join(sharper, 'sky_pmrem.ktx2'));
    report('a bake that is turned by 1 degree is seen', turned > 10 * MAX, turned.toExponential(1));

    // A second bake, in the same instance.
    const again = await bake(bytes, { input: 'sky.exr', name: 'sky', target: 'three', size: 64 });
    const same = again.files
        .filter(({ name }) => name !== 'report.json')
        .every(({ name, bytes }) => Buffer.compare(bytes, readFileSync(join(three.ours, name))) === 0);
    report(
        'a second bake gives the same bytes',
        same && again.files.length === 3,
        `${again.files.length} files`,
    );

    // Outputs are named after the input's file, without the folders of either system.
    for (const input of [
        '/maps/a b/noon.exr',
        win32.join('C:\\', 'maps', 'a b', 'noon.exr'),
        'maps\\noon.exr',
    ]) {
        const { files } = await bake(bytes, { input, size: 8, levels: 2 });
        report(`the name of ${input}`, files[0].name === 'noon.ktx2', files[0].name);
    }

    // Broken files and wrong options.
    await refused('half of a file', bake(bytes.subarray(0, bytes.length / 2), { input: 'half.exr' }), [
        'half.exr: ',
    ]);
    await refused('a text', bake(Buffer.from('no image'), { input: 'text.hdr' }), ['text.hdr: not an image']);
    await refused('no byte', bake(new Uint8Array(), { input: 'empty.exr' }), ['empty.exr: ', '0 bytes']);
    await refused('an unknown target', bake(bytes, { target: 'quake' }), ['`target` is "quake"', 'three']);
    await refused('an unknown option', bake(bytes, { taget: 'three' }), ['`taget`', 'target']);
    await refused('a size of 0', bake(bytes, { size: 0 }), ['`size` is 0', '16384']);
    await refused('a scale that is no number', bake(bytes, { scale: NaN }), ['`scale`', 'NaN']);
    await refused('a size beyond the memory', bake(bytes, { size: 16384 }), ['needs', 'limit', '`size`']);
    await refused('no bytes', bake('sky.exr'), ['Uint8Array']);

    // Cancelled in the middle; the next call works.
    const controller = new AbortController();
    const begun = performance.now();
    const cancelled = bake(bytes, {
        size: 512,
        signal: controller.signal,
        onProgress: () => controller.abort(),
    });
    const reason = await cancelled.then(
        () => 'it was finished',
        (error) => error.name,
    );
    report(
        'a bake is cancelled',
        reason === 'AbortError',
        `${reason} after ${((performance.now() - begun) / 1000).toFixed(2)} s`,
    );
    const never = await bake(bytes, { signal: AbortSignal.abort() }).catch((error) => error.name);
    report('a cancelled call does not begin', never === 'AbortError', never);

    // Queries.
    const directions = [0, 1, 0, 1, 0, 0, -0.3, 0.2, 5, 0, -2, 0.1];
    const csv = 'x,y,z\n0,1,0\n1,0,0\n-0.3,0.2,5\n0,-2,0.1\n';
    const found = await query(bytes, { directions, roughness: 0.4, bound: true });
    const rows = execFileSync(
        program,
        ['query', sky, '--directions', '-', '--roughness', '0.4', '--bound', '--engine', 'cpu', '--quiet'],
        { input: csv, encoding: 'utf8' },
    );
    const wanted = rows
        .trim()
        .split('\n')
        .slice(1)
        .flatMap((row) => row.split(',').slice(3).map(Number));
    const off = Math.max(...wanted.map((value, index) => Math.abs(value - found[index]) / Math.abs(value)));
    report('queries agree', found.length === wanted.length && off < 1e-5, `${off.toExponential(1)} off`);
    await refused('a sun nowhere', bake(bytes, { extractSun: 'up' }), ['`extractSun` is "up"', 'directions']);
    await refused('a roughness of 2', query(bytes, { directions, roughness: 2 }), [
        '`roughness` 2',
        '0 to 1',
    ]);
    const described = await info(bytes, { input: 'sky.exr' });
    const native = JSON.parse(octagloss('info', sky, '--json'));
    report(
        'infos agree',
        described.width === native.width &&
            String(described.max) === String(native.max) &&
            described.format === native.format &&
            Math.abs(described.sun.irradiance[0] / native.sun.irradiance[0] - 1) < 1e-9,
        described.format,
    );
    const converted = (map) => {
        const file = join(work, `${map}.exr`);
        octagloss('convert', sky, '--layout', map, '--size', 16, '--border', 2, '-o', file, '--quiet');
        return readFileSync(file);
    };
    const cube = await info(converted('cube'));
    report('a map is that of the header', cube.layout === 'row strip' && cube.width === 96, cube.layout);
    await refused('another map', info(converted('healpix')), ['its map is healpix', 'no environment has']);
    await refused('another layout', info(converted('octahedral'), { layout: 'equirect' }), [
        'its map is octahedral',
        '`layout` is equirect',
    ]);

    if (how !== '--smoke') {
        await compare('generic', sky, { target: 'generic', size: 64 }, targeted('generic'), [
            'specular.ktx2',
        ]);
        await compare('filament', sky, { target: 'filament', size: 64 }, targeted('filament'), [
            'sky_ibl.ktx',
            'sky_skybox.ktx',
        ]);
        await compare('bevy', sky, { target: ['bevy', 'babylon'], size: 64 }, targeted('bevy,babylon'), [
            'bevy/sky_specular.ktx2',
            'bevy/sky_diffuse.ktx2',
        ]);
        await compare('oem', sky, { target: 'oem', size: 64 }, targeted('oem'), []);
        await compare(
            'one file',
            sky,
            { size: 32, irradiance: 8, skybox: 'source', extractSun: true, sunless: true, pixel: 'bc6h' },
            (folder) => [
                ...'--size 32 --irradiance 8 --skybox source --extract-sun --sunless --pixel bc6h -o'.split(
                    ' ',
                ),
                join(folder, 'sky.ktx2'),
            ],
            ['sky.ktx2', 'sky.irradiance.ktx2'],
        );
        await compare(
            'lights',
            sky,
            { size: 8, extractSun: '34,35:0,-90' },
            (folder) => [...'--size 8 --extract-sun=34,35:0,-90 -o'.split(' '), join(folder, 'sky.ktx2')],
            ['sky.ktx2'],
        );
        await compare(
            'images',
            sky,
            { size: 16, format: 'exr', bounds: true, rotateY: 30, mirror: true, scale: 2 },
            (folder) => [
                ...'--size 16 --format exr --bounds --rotate-y 30 --mirror --scale 2 -o'.split(' '),
                folder,
            ],
            ['.'],
        );
        for (const map of ['octahedral', 'cube']) {
            await compare(
                `pyramid, ${map}`,
                sky,
                { target: 'pyramid', map, size: 64 },
                (folder) => [...targeted('pyramid')(folder), '--map', map],
                ['sky_pyramid.ktx2'],
            );
        }
        await compare(
            'pyramid',
            sky,
            { size: 32, filter: 'pyramid', chain: 'solved' },
            (folder) => [
                ...'--size 32 --filter pyramid --chain solved -o'.split(' '),
                join(folder, 'sky.ktx2'),
            ],
            ['sky.ktx2'],
        );
        // In floats: a single half that is rounded the other way is too much for a level of 384 texels.
        await compare(
            'studio',
            join(root, 'hdr/studio.hdr'),
            { size: 32, pixel: 'f32' },
            (folder) => ['--size', 32, '--pixel', 'f32', '-o', join(folder, 'sky.ktx2')],
            ['sky.ktx2'],
        );
        // A picture and a cube as sources.
        const cube = join(work, 'one file/program/sky.ktx2');
        await compare(
            'ktx2',
            cube,
            { size: 16, pixel: 'f32' },
            (folder) => ['--size', 16, '--pixel', 'f32', '-o', join(folder, 'sky.ktx2')],
            ['sky.ktx2'],
        );
        const { preview } = await bake(bytes, { size: 64, target: ['three', 'unity'], preview: true });
        const png = join(work, 'preview.png');
        writeFileSync(png, preview);
        await compare(
            'png',
            png,
            { size: 16, layout: 'equirect', pad: 'edge' },
            (folder) => [...'--size 16 --layout equirect --pad=edge -o'.split(' '), join(folder, 'sky.ktx2')],
            ['sky.ktx2'],
        );
        octagloss(
            'bake',
            sky,
            '--size',
            64,
            '--target',
            'three,unity',
            '--preview',
            join(work, 'program.png'),
            '--engine',
            'cpu',
            '--quiet',
            '-o',
            join(work, 'preview'),
        );
        const size = (png) => [png.readUInt32BE(16), png.readUInt32BE(20)].join(' x ');
        const sizes = [size(Buffer.from(preview)), size(readFileSync(join(work, 'program.png')))];
        report('previews have one size', sizes[0] === sizes[1], sizes[0]);
        const names = (await targets()).map(({ name }) => name);
        const help = octagloss('bake', '--help').split('--target <TARGET>')[1].split('\n      --')[0];
        const inHelp = [...help.matchAll(/^ {10}([a-z-]+): /gm)].map(([, name]) => name);
        report('all targets are listed', names.join() === inHelp.join(), names.join(' '));

        // Several at once; one of them cancelled.
        configure({ workers: 2 });
        const stop = new AbortController();
        const many = [1, 2, 3].map((k) =>
            bake(bytes, { size: 16 * k, signal: k === 2 ? stop.signal : undefined }).then(
                ({ files }) => files[0].bytes.length,
                (error) => error.name,
            ),
        );
        stop.abort();
        const ended = await Promise.all(many);
        report(
            'one of three bakes is cancelled',
            ended[1] === 'AbortError' && ended[0] > 0 && ended[2] > ended[0],
            ended.join(' '),
        );

        // A panic or a trap ends the worker; all truncations are errors.
        let thrown = 0;
        const cut = [...Array(40).keys()].map((k) => Math.floor((bytes.length * (k + 0.5)) / 41));
        for (const length of cut)
            await info(bytes.subarray(0, length), { input: 'cut.exr' }).catch((error) => {
                thrown += error.message.startsWith('cut.exr: ') ? 1 : 0;
            });
        report('truncated files are errors', thrown === cut.length, `${thrown} of ${cut.length}`);
    }
    close();
    // The process ends by itself while an idle worker waits.
    const script = `import { info } from ${JSON.stringify(packageUrl)};
        import { readFileSync } from 'node:fs';
        console.log((await info(readFileSync(${JSON.stringify(sky)}))).width);`;
    const ran = spawnSync(process.execPath, ['--input-type=module', '--eval', script], {
        encoding: 'utf8',
        timeout: 60_000,
    });
    report(
        'an idle worker lets the process end',
        ran.status === 0,
        `status ${ran.status}, width ${ran.stdout.trim()}${ran.stderr}`,
    );
} catch (error) {
    report('run', false, error.stack);
} finally {
    rmSync(work, { recursive: true, force: true });
}
console.log(failures === 0 ? 'the package agrees' : `${failures} checks failed`);
process.exit(failures === 0 ? 0 : 1);
