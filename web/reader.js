// Reads a file with an instance of its own: WebAssembly ends at a panic, and the picture must not.
import init, { read } from './octagloss.js';

addEventListener('message', async ({ data: { module, name, bytes } }) => {
    try {
        await init({ module_or_path: module });
        read(name, bytes);
        postMessage({ bytes }, [bytes.buffer]);
    } catch (error) {
        const panicked = error instanceof WebAssembly.RuntimeError;
        postMessage({ refused: panicked ? `${name}: corrupt: its decoder broke off; write the file anew` : error.message });
    }
});
