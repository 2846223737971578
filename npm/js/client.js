// Runs calls in workers. A call is cancelled by ending its worker.

// Instances with more memory end after their call, for WebAssembly's memory never shrinks.
const MAX_KEPT = 256 * 1024 * 1024;

// JSON has no NaN and Infinity; as texts they are refused by name.
const finite = (_, value) => (typeof value === 'number' && !Number.isFinite(value) ? String(value) : value);

async function bytesOf(source) {
    if (typeof source?.arrayBuffer === 'function') return new Uint8Array(await source.arrayBuffer());
    if (source instanceof ArrayBuffer) return new Uint8Array(source);
    if (ArrayBuffer.isView(source))
        return new Uint8Array(source.buffer, source.byteOffset, source.byteLength);
    throw new TypeError('the environment is no Uint8Array, ArrayBuffer, Blob or File');
}

// `spawn(onmessage, onerror)` starts a worker with post(message), terminate() and, where a worker keeps its
// process alive, keep(whether). `load()` loads the package's own module.
export function client(spawn, load) {
    let module;
    let most = 1;
    let count = 0;
    const idle = [];
    const waiting = [];

    function next() {
        while (waiting.length > 0 && (idle.length > 0 || count < most)) start(waiting.shift());
    }

    function start(call) {
        let worker = idle.pop();
        if (!worker) {
            worker = spawn(
                (message) => worker.call?.answer(message),
                (error) => worker.call?.fail(error),
            );
            count += 1;
        }
        worker.keep?.(true);
        worker.call = call;
        call.worker = worker;
        worker.post(call.message);
    }

    // Frees the worker of `call`, or ends it.
    function release(call, ended) {
        const { worker } = call;
        if (!worker) {
            waiting.splice(waiting.indexOf(call), 1);
            return;
        }
        worker.call = undefined;
        if (ended) {
            worker.terminate();
            count -= 1;
        } else {
            worker.keep?.(false);
            idle.push(worker);
        }
        next();
    }

    async function ask(kind, source, { signal, onProgress, input, ...options } = {}, more = {}) {
        signal?.throwIfAborted();
        const bytes = await bytesOf(source);
        module ??= load();
        // A failed download is tried again by the next call.
        const compiled = await module.catch((error) => {
            module = undefined;
            throw error;
        });
        signal?.throwIfAborted();
        const name = input ?? source.name ?? 'environment';
        const message = {
            kind,
            module: compiled,
            input: name,
            bytes,
            options: JSON.stringify(options, finite),
            progress: Boolean(onProgress),
            ...more,
        };
        return new Promise((resolve, reject) => {
            const cancel = () => settle(true, () => reject(signal.reason));
            const settle = (ended, then) => {
                signal?.removeEventListener('abort', cancel);
                release(call, ended);
                then();
            };
            const call = {
                message,
                answer({ progress, result, error, memory }) {
                    if (progress !== undefined) onProgress?.(progress);
                    else if (error) settle(error.ended, () => reject(new Error(error.message)));
                    else settle(memory > MAX_KEPT, () => resolve({ result, memory }));
                },
                fail: (error) => settle(true, () => reject(error)),
            };
            signal?.addEventListener('abort', cancel, { once: true });
            waiting.push(call);
            next();
        });
    }

    return {
        async bake(source, options) {
            const {
                result: { files, reports, warnings, preview },
                memory,
            } = await ask('bake', source, options);
            const parsed = reports.map((report) => JSON.parse(report));
            return { files, report: parsed[0], reports: parsed, warnings, preview, memory };
        },
        async info(source, options) {
            return JSON.parse((await ask('info', source, options)).result);
        },
        async query(source, { directions, roughness, ...options }) {
            const numbers = (value) => Float64Array.from(value ?? []);
            const more = {
                directions: numbers(directions),
                roughness: numbers(typeof roughness === 'number' ? [roughness] : roughness),
            };
            return (await ask('query', source, options, more)).result;
        },
        async targets() {
            return JSON.parse((await ask('targets', new Uint8Array())).result);
        },
        configure({ workers, module: given } = {}) {
            if (workers !== undefined) {
                if (!Number.isInteger(workers) || workers < 1)
                    throw new RangeError(`workers is ${workers}; 1 or more are needed`);
                most = workers;
            }
            if (given !== undefined) module = Promise.resolve(given);
        },
        close() {
            for (const worker of idle.splice(0)) {
                worker.terminate();
                count -= 1;
            }
        },
    };
}
