// Runs the program (bakes and queries of one environment) and reports checks.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

export const root = fileURLToPath(new URL('../..', import.meta.url));
export const environment = join(root, 'hdr', 'labelled.exr');
export const sunny = join(root, 'hdr', 'sky.exr');

// The code in `language` under the heading `engine` of docs/engines.md.
export function recipe(engine, language) {
    const sections = readFileSync(join(root, 'docs', 'engines.md'), 'utf8').split(/^## /m);
    const section = sections.find((text) => text.startsWith(`${engine}\n`)) ?? '';
    const [, code] = section.split(`\n\`\`\`${language}\n`);
    if (!code) throw new Error(`docs/engines.md: no ${language} under ${engine}`);
    return code.split(/^```$/m)[0];
}

// `program` and the folder `work` for its outputs.
export function programAt(program, work) {
    const octagloss = (args, input) =>
        execFileSync(program, args, {
            input,
            encoding: 'utf8',
            maxBuffer: 1 << 28,
            stdio: ['pipe', 'pipe', 'inherit'],
        });
    const ask = (directions, args, source = environment) => {
        const csv = 'x,y,z\n' + directions.map((d) => d.join(',')).join('\n') + '\n';
        const rows = octagloss(['query', source, '--directions', '-', '--quiet', ...args], csv);
        return rows
            .trim()
            .split('\n')
            .slice(1)
            .map((row) => row.split(',').slice(3).map(Number));
    };
    return {
        work,
        octagloss: (args) => octagloss(args),
        bake: (folder, args, source = environment) =>
            octagloss(['bake', source, '--quiet', '--name', 'world', '-o', join(work, folder), ...args]),
        // Radiance of a lobe around each of `directions`.
        query: (directions, roughness, lobe = 'ggx') =>
            ask(directions, ['--roughness', String(roughness), '--lobe', lobe]),
        // Light that white metal of `roughness` reflects to `views`, pairs of a normal and a direction.
        frames: (views, roughness, anisotropy = 0, filter = 'reference', source = environment) => {
            const columns = views[0].length === 3 ? 'nx,ny,nz,vx,vy,vz,tx,ty,tz' : 'nx,ny,nz,vx,vy,vz';
            const csv = [columns, ...views.map((view) => view.flat().join(','))].join('\n') + '\n';
            const args = [
                '--frames',
                '-',
                '--filter',
                filter,
                '--roughness',
                String(roughness),
                '--anisotropy',
                String(anisotropy),
                '--quiet',
            ];
            const rows = octagloss(['query', source, ...args], csv)
                .trim()
                .split('\n')
                .slice(1);
            return rows.map((row) => row.split(',').slice(-3).map(Number));
        },
        // Irradiance over pi for each of `normals`.
        diffuse: (normals, source) => ask(normals, ['--lobe', 'cosine'], source),
    };
}

let failures = 0;

// Prints a check's outcome; `ok` false fails the run.
export function check(what, ok, detail) {
    console.log(`${ok ? 'ok    ' : 'FAILED'} ${what}: ${detail}`);
    failures += ok ? 0 : 1;
}

// Prints the summary and exits with status 0 if every check passed, 1 otherwise.
export function finish(who) {
    console.log(failures === 0 ? `${who} agree` : `${failures} checks failed`);
    process.exit(failures === 0 ? 0 : 1);
}
