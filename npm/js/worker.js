// The worker in browsers.
import { serve } from './serve.js';

serve(
    (message, transferred = []) => postMessage(message, transferred),
    (listener) => addEventListener('message', ({ data }) => listener(data)),
);
