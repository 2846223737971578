// Answers calls in a worker, by an instance of the module.
import init, * as engine from './octagloss_npm.js';

let instance;

// Errors that the instance does not survive: panics, and traps such as those of failed allocations.
function described(error, input, isRead) {
    const panicked = error?.name === 'Panic';
    if (!panicked && !(error instanceof WebAssembly.RuntimeError))
        return { message: error.message, ended: false };
    const message = isRead
        ? `${input}: octagloss stopped: ${error.message}; a smaller size or source needs less memory`
        : `${input}: corrupt, or too large for WebAssembly: the decoder failed; re-export the file`;
    return { message, ended: true };
}

async function answer({ kind, module, input, bytes, options, progress, directions, roughness }, post) {
    let isRead = false;
    try {
        instance ??= await init({ module_or_path: module });
        let result;
        if (kind === 'bake') {
            let last = -1;
            const report = (share) => {
                const step = Math.floor(share * 200);
                if (step > last) post({ progress: share });
                last = Math.max(step, last);
            };
            result = engine.bake(
                input,
                bytes,
                options,
                () => {
                    isRead = true;
                },
                progress ? report : undefined,
            );
        } else if (kind === 'info') {
            result = engine.info(input, bytes, options);
        } else if (kind === 'targets') {
            result = engine.targets();
        } else {
            result = engine.query(input, bytes, options, directions, roughness);
        }
        const buffers = [
            ...(result.files ?? []).map((file) => file.bytes.buffer),
            ...(result.preview ? [result.preview.buffer] : []),
        ];
        post({ result, memory: instance.memory.buffer.byteLength }, buffers);
    } catch (error) {
        post({ error: described(error, input, isRead) });
    }
}

// `post(message, transferred)` answers; `listen(listener)` passes calls on.
export function serve(post, listen) {
    listen((call) => answer(call, post));
}
