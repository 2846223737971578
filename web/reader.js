// Reads a file with a separate WebAssembly instance, so that a panic does not stop the viewer.
import init, { read } from './octagloss.js';

addEventListener('message', async ({ data: { module, side, name, bytes } }) => {
    try {
        await init({ module_or_path: module });
        read(side, name, bytes);
        postMessage({ bytes }, [bytes.buffer]);
    } catch (error) {
        const panicked = error instanceof WebAssembly.RuntimeError;
        postMessage({
            refused: panicked ? `${name}: corrupt: the decoder failed; re-export the file` : error.message,
        });
    }
});
