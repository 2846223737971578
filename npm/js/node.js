// The package in Node.js.
import { readFile } from 'node:fs/promises';
import { Worker } from 'node:worker_threads';
import { client } from './client.js';

const load = async () =>
    WebAssembly.compile(await readFile(new URL('./octagloss_npm_bg.wasm', import.meta.url)));

function spawn(onmessage, onerror) {
    // Options such as --input-type are for the main program only.
    const worker = new Worker(new URL('./node-worker.js', import.meta.url), { execArgv: [] });
    worker.on('message', onmessage);
    worker.on('error', onerror);
    return {
        post: (message) => worker.postMessage(message),
        terminate: () => worker.terminate(),
        // An idle worker does not keep the process alive.
        keep: (whether) => (whether ? worker.ref() : worker.unref()),
    };
}

export const { bake, info, query, targets, configure, close } = client(spawn, load);
