// The worker in Node.js.
import { parentPort } from 'node:worker_threads';
import { serve } from './serve.js';

serve(
    (message, transferred = []) => parentPort.postMessage(message, transferred),
    (listener) => parentPort.on('message', listener),
);
