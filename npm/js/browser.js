// The package in browsers.
import { client } from './client.js';

async function load() {
    const response = await fetch(new URL('./octagloss_npm_bg.wasm', import.meta.url));
    if (!response.ok) throw new Error(`octagloss_npm_bg.wasm: ${response.status} ${response.statusText}`);
    // Servers that do not know the type prevent compilation while the file arrives.
    if (response.headers.get('Content-Type')?.startsWith('application/wasm'))
        return WebAssembly.compileStreaming(response);
    return WebAssembly.compile(await response.arrayBuffer());
}

function spawn(onmessage, onerror) {
    const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
    worker.onmessage = ({ data }) => onmessage(data);
    worker.onerror = ({ message }) =>
        onerror(new Error(`the worker did not start: ${message ?? 'worker.js was not loaded'}`));
    return { post: (message) => worker.postMessage(message), terminate: () => worker.terminate() };
}

export const { bake, info, query, targets, configure, close } = client(spawn, load);
