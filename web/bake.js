// The page's Bake side: files, options, progress, previews and downloads. Workers do the work.
import { bake, configure, targets } from './octagloss/browser.js';

// The command line's words; `options` names them for the module.
const NUMBERS = [
    ['size', 'edge of level 0', '1 to 16384'],
    ['levels', 'number of levels', ''],
    ['irradiance', 'edge of an irradiance cube', 'none'],
    ['skybox', 'edge of an unfiltered cube, or source', 'none'],
    ['sh-order', 'highest band of harmonics', '2'],
    ['rotate-y', 'degrees about +Y', '0'],
    ['scale', 'factor for the radiance', '1'],
    ['oem-size', 'edge of the octahedral map', "lobes'"],
    ['border', 'its border', "filter's"],
];
const TEXTS = [
    ['filter', 'adaptive:E, pyramid, box', 'adaptive:0.005'],
    ['sh-window', 'window of harmonics', 'none'],
    ['exposure', 'of the preview, in EV', 'auto'],
];
const CHOICES = [
    ['format', 'ktx2 ktx dds exr hdr'],
    ['pixel', 'f16 f32 rgb9e5 r11g11b10f bc6h'],
    ['ladder', 'linear filament unity babylon'],
    ['chain', 'sampled solved mixed'],
    ['lobe', 'ggx phong cone cosine charlie'],
    ['out-layout', 'faces cross cross-vertical strip strip-vertical equirect octahedral parts mips'],
    ['overflow', 'clamp compress error'],
    ['flip', 'none x z'],
    ['map', 'octahedral cube'],
    ['diffuse', 'none cube sh both'],
    ['layout', 'auto equirect cross strip octahedral'],
    ['pad', 'black edge'],
];
const SWITCHES = ['extract-sun', 'sunless', 'bounds', 'mirror', 'crop', 'sanitize', 'strict'];
// The first ones are always shown.
const COMMON = ['size', 'levels', 'format', 'pixel', 'skybox', 'irradiance', 'extract-sun'];
const UNITS = [
    [1e6, 'MB'],
    [1e3, 'kB'],
    [1, 'B'],
];

const camel = (word) => word.replace(/-./g, (match) => match[1].toUpperCase());
const sized = (bytes) =>
    UNITS.map(([unit, name]) => bytes >= unit && `${(bytes / unit).toPrecision(3)} ${name}`).find(Boolean) ??
    '0 B';

function element(tag, properties = {}, ...children) {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
}

async function compiled() {
    const response = await fetch(new URL('./octagloss/octagloss_npm_bg.wasm.gz', import.meta.url));
    if (!response.ok) throw new Error(`octagloss_npm_bg.wasm.gz: ${response.status} ${response.statusText}`);
    // If the server declares .gz as an encoding, the browser has unpacked it already.
    const encoded = response.headers.get('Content-Encoding') !== null;
    const unpacked = encoded ? response.body : response.body.pipeThrough(new DecompressionStream('gzip'));
    return WebAssembly.compileStreaming(
        new Response(unpacked, { headers: { 'Content-Type': 'application/wasm' } }),
    );
}

// Fills `side`, the page's element; returns add(files), which lists environments to bake.
export function open(side, close) {
    const jobs = [];
    let running;
    const fields = new Map();

    const field = (word, hint, input) => {
        fields.set(word, input);
        input.name = word;
        return element('label', { title: hint }, element('span', { textContent: word }), input);
    };
    const made = new Map();
    for (const [word, hint, placeholder] of [...NUMBERS, ...TEXTS]) {
        made.set(
            word,
            field(
                word,
                hint,
                element('input', {
                    placeholder: placeholder || 'preset',
                    autocomplete: 'off',
                    spellcheck: false,
                }),
            ),
        );
    }
    for (const [word, choices] of CHOICES) {
        const select = element('select', {}, element('option', { value: '', textContent: 'preset' }));
        select.append(...choices.split(' ').map((choice) => element('option', { textContent: choice })));
        made.set(word, field(word, choices, select));
    }
    for (const word of SWITCHES) {
        const label = field(word, word, element('input', { type: 'checkbox' }));
        label.className = 'switch';
        made.set(word, label);
    }
    const common = element('div', { className: 'fields' }, ...COMMON.map((word) => made.get(word)));
    const rest = element(
        'div',
        { className: 'fields' },
        ...[...made].filter(([word]) => !COMMON.includes(word)).map(([, label]) => label),
    );

    const list = element('ul', { id: 'bake-jobs' });
    const chosen = element('input', {
        type: 'file',
        id: 'bake-file',
        multiple: true,
        hidden: true,
        accept: '.hdr,.exr,.png,.jpg,.jpeg,.ktx2,.ktx,.dds',
    });
    const names = element('div', { className: 'targets' });
    const command = element('code', { id: 'bake-command' });
    const message = element('p', { id: 'bake-message', role: 'status', hidden: true });
    const bar = element('progress', { id: 'bake-progress', max: 1, value: 0, hidden: true });
    const start = element('button', {
        id: 'bake-start',
        textContent: 'Bake',
        disabled: true,
        type: 'submit',
    });
    const cancel = element('button', {
        id: 'bake-cancel',
        textContent: 'Cancel',
        disabled: true,
        type: 'button',
    });
    const zip = element('button', {
        id: 'bake-zip',
        textContent: 'Download all (.zip)',
        disabled: true,
        type: 'button',
    });
    const form = element(
        'form',
        {},
        element(
            'header',
            {},
            element('h1', { textContent: 'Bake' }),
            element('button', {
                type: 'button',
                title: 'Back to the viewer',
                textContent: 'Close',
                onclick: close,
            }),
        ),
        element(
            'button',
            { type: 'button', className: 'drop', id: 'bake-choose', onclick: () => chosen.click() },
            element('b', { textContent: 'Choose environments' }),
            ' or drop them here: .hdr, .exr, .png, .jpg, .ktx2. Nothing is uploaded.',
        ),
        chosen,
        element('fieldset', {}, element('legend', { textContent: 'target' }), names),
        element(
            'fieldset',
            {},
            element('legend', { textContent: 'options' }),
            common,
            element('details', {}, element('summary', { textContent: 'more options' }), rest),
        ),
        element('p', { className: 'command' }, command),
        element('div', { className: 'actions' }, start, cancel, zip),
        bar,
        message,
        list,
    );
    side.replaceChildren(form);

    // The options for the module, and the words for the command line.
    function request() {
        const targeted = [...names.querySelectorAll('input:checked')].map((input) => input.value);
        const [options, words] = [{}, []];
        if (targeted.length > 0) {
            options.target = targeted;
            words.push('--target', targeted.join(','));
        }
        for (const [word, input] of fields) {
            const value = input.type === 'checkbox' ? input.checked : input.value.trim();
            if (value === '' || value === false) continue;
            const number = NUMBERS.some(([name]) => name === word) && value !== 'source';
            options[camel(word)] = number && Number.isFinite(Number(value)) ? Number(value) : value;
            if (word !== 'exposure')
                words.push(
                    ...(value === true
                        ? [`--${word}`]
                        : word === 'pad'
                          ? [`--pad=${value}`]
                          : [`--${word}`, value]),
                );
        }
        return { options, words };
    }

    const stem = (name) => name.replace(/\.[^.]*$/, '') || name;

    function update() {
        const { words, options } = request();
        const several = jobs.length !== 1;
        const output = several
            ? 'baked'
            : options.target || ['exr', 'hdr'].includes(options.format)
              ? stem(jobs[0].file.name)
              : `${stem(jobs[0].file.name)}.${options.format ?? 'ktx2'}`;
        const inputs = jobs.length > 0 ? jobs.map((job) => job.file.name) : ['INPUT'];
        // Shells split at spaces; lines break between words only.
        const quoted = (word) => (/^[\w.,:/=+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);
        const all = ['octagloss', 'bake', ...inputs, ...words, '-o', output].map((word) =>
            element('span', { textContent: quoted(word) }),
        );
        command.replaceChildren(...all.flatMap((word, index) => (index > 0 ? [' ', word] : [word])));
        start.disabled = running !== undefined || jobs.length === 0;
        cancel.disabled = running === undefined;
        zip.disabled = running !== undefined || !jobs.some((job) => job.result);
        bar.hidden = running === undefined;
        bar.value = jobs.reduce((sum, job) => sum + job.share, 0) / Math.max(1, jobs.length);
        for (const job of jobs) job.remove.disabled = running !== undefined;
    }

    function say(text) {
        message.textContent = text;
        message.hidden = !text;
    }

    function shown(job, state, text = '') {
        job.item.dataset.state = state;
        job.status.textContent = text;
    }

    function forget(job) {
        for (const address of job.addresses) URL.revokeObjectURL(address);
        job.addresses = [];
        job.result = undefined;
        job.share = 0;
        job.details.replaceChildren();
    }

    function add(files) {
        say('');
        for (const file of files) {
            const other = jobs.find((job) => stem(job.file.name) === stem(file.name));
            if (other && other.file.name !== file.name) {
                const both = `${other.file.name} and ${file.name}`;
                say(`${both} would be written as ${stem(file.name)}; rename one or bake them separately`);
                continue;
            }
            if (other) take(other);
            const job = { file, share: 0, addresses: [] };
            job.status = element('span', { className: 'status' });
            job.details = element('div', { className: 'details' });
            job.remove = element('button', {
                type: 'button',
                textContent: 'Remove',
                onclick: () => {
                    take(job);
                    update();
                },
            });
            job.item = element(
                'li',
                {},
                element(
                    'div',
                    { className: 'line' },
                    element('b', { textContent: file.name }),
                    element('span', { textContent: sized(file.size) }),
                    job.status,
                    job.remove,
                ),
                job.details,
            );
            job.item.dataset.name = file.name;
            shown(job, 'waiting');
            jobs.push(job);
            list.append(job.item);
        }
        update();
    }

    function take(job) {
        forget(job);
        job.item.remove();
        jobs.splice(jobs.indexOf(job), 1);
    }

    // An address of `bytes` for a link or a picture, until the job's next bake.
    function address(job, bytes, type) {
        const made = URL.createObjectURL(new Blob([bytes], { type }));
        job.addresses.push(made);
        return made;
    }

    function done(job, seconds) {
        const { files, warnings, preview } = job.result;
        const total = files.reduce((sum, file) => sum + file.bytes.length, 0);
        shown(job, 'done', `${files.length} files, ${sized(total)}, ${seconds.toFixed(1)} s`);
        const download = ({ name, bytes }) =>
            element(
                'li',
                {},
                element('a', {
                    href: address(job, bytes, 'application/octet-stream'),
                    download: name.split('/').pop(),
                    textContent: name,
                }),
                ` ${sized(bytes.length)}`,
            );
        job.details.replaceChildren(
            ...warnings.map((warning) => element('p', { className: 'warning', textContent: warning })),
            element('ul', { className: 'files' }, ...files.map(download)),
            element('img', { src: address(job, preview, 'image/png'), alt: `levels of ${job.file.name}` }),
        );
    }

    async function one(job, options, signal) {
        const begun = performance.now();
        shown(job, 'running', 'reading');
        const onProgress = (share) => {
            job.share = share;
            shown(job, 'running', `${Math.floor(100 * share)} %`);
            update();
        };
        try {
            job.result = await bake(job.file, { ...options, preview: true, signal, onProgress });
            done(job, (performance.now() - begun) / 1000);
        } catch (error) {
            const cancelled = signal.aborted && error === signal.reason;
            shown(job, cancelled ? 'cancelled' : 'failed', cancelled ? 'cancelled' : error.message);
        }
        job.share = 1;
        update();
    }

    form.onsubmit = async (event) => {
        event.preventDefault();
        if (start.disabled) return;
        running = new AbortController();
        say('');
        const { options } = request();
        for (const job of jobs) {
            forget(job);
            shown(job, 'waiting', 'waiting');
        }
        update();
        const { signal } = running;
        // Two at a time, where there are cores for them: each may take a gigabyte.
        const wait = [...jobs];
        const workers = Math.min(2, navigator.hardwareConcurrency ?? 1, jobs.length);
        configure({ workers });
        await Promise.all(
            Array.from({ length: workers }, async () => {
                while (wait.length > 0) await one(wait.shift(), options, signal);
            }),
        );
        running = undefined;
        const count = (state) => jobs.filter((job) => job.item.dataset.state === state).length;
        const cancelled = count('cancelled');
        const ended = `${count('done')} baked, ${count('failed')} failed`;
        say(cancelled > 0 ? `${ended}, ${cancelled} cancelled` : ended);
        update();
    };
    cancel.onclick = () => running?.abort();
    zip.onclick = async () => {
        const { downloadZip } = await import('./client-zip.js');
        const baked = jobs.filter((job) => job.result);
        const entries = baked.flatMap((job) =>
            job.result.files.map(({ name, bytes }) => ({
                name: `${stem(job.file.name)}/${name}`,
                input: bytes,
            })),
        );
        const made = URL.createObjectURL(await downloadZip(entries).blob());
        element('a', {
            href: made,
            download: baked.length === 1 ? `${stem(baked[0].file.name)}.zip` : 'baked.zip',
        }).click();
        setTimeout(() => URL.revokeObjectURL(made), 60_000);
    };
    chosen.onchange = () => {
        add(chosen.files);
        // The same file may be chosen again.
        chosen.value = '';
    };
    form.oninput = update;
    // Enter in a field must not leave the page.
    form.autocomplete = 'off';
    update();

    configure({ module: compiled() });
    targets().then(
        (all) => {
            names.replaceChildren(
                ...all.map(({ name, reader, verified }) =>
                    element(
                        'label',
                        {
                            className: 'switch',
                            title: `${reader}; ${verified ? 'tested with ' + verified : 'untested in it'}`,
                        },
                        element('input', { type: 'checkbox', value: name, checked: name === 'three' }),
                        element('span', { textContent: name }),
                    ),
                ),
            );
            update();
            side.dataset.ready = 'true';
        },
        (error) => say(`The Bake side did not start: ${error.message}`),
    );
    return { add };
}
