// Starts headless Chromium and counts failed checks, for the tests of the page.
//
// A test's arguments are PROGRAM [CHROMIUM]. PICTURES=DIRECTORY keeps the pictures there.
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import puppeteer from 'puppeteer-core';

export const here = fileURLToPath(new URL('.', import.meta.url));
export const root = join(here, '..');
export const [program, chromium = '/usr/bin/chromium'] = process.argv.slice(2);
if (!program) {
    console.error(`usage: node ${basename(process.argv[1])} PROGRAM [CHROMIUM]`);
    process.exit(2);
}

let failures = 0;
// Prints a check's outcome; `ok` false fails the run.
export function report(what, ok, detail) {
    console.log(`${ok ? 'ok    ' : 'FAILED'} ${what}: ${detail}`);
    failures += ok ? 0 : 1;
}

export const work = mkdtempSync(join(tmpdir(), 'octagloss-web-'));
export const pictures = process.env.PICTURES ?? join(work, 'pictures');
mkdirSync(pictures, { recursive: true });

const common = [
    '--no-sandbox',
    '--no-first-run',
    '--disable-quic',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
];

let browser;
// Starts the browser, instead of the one before.
export async function launch(args, defaultViewport) {
    await browser?.close();
    browser = await puppeteer.launch({
        executablePath: chromium,
        headless: true,
        protocolTimeout: 600_000,
        defaultViewport,
        args: [...common, ...args],
    });
    return browser;
}

// Runs `checks` and ends the process: with status 0 when everything agrees, else 1. `close` ends the server.
export async function runChecks(checks, subject, close) {
    try {
        await checks();
    } catch (error) {
        report('run', false, error.stack);
    } finally {
        await browser?.close();
        close();
        rmSync(work, { recursive: true, force: true });
    }
    console.log(failures === 0 ? `${subject} agrees` : `${failures} checks failed`);
    process.exit(failures === 0 ? 0 : 1);
}

// A new tab. Any error in it is a failure, and any warning but those with one of the words `expected`.
export async function newPage(name, expected = []) {
    const page = await browser.newPage();
    page.on('pageerror', (error) => report(name, false, error.message));
    page.on('console', (message) => {
        const text = message.text();
        const failed = ['error', 'warn'].includes(message.type());
        if (failed && !expected.some((words) => text.includes(words))) report(name, false, text);
    });
    return page;
}

// Drops a file onto the page.
export const dropFile = (page, name, bytes) =>
    page.evaluate(
        (name, bytes) => {
            const files = new DataTransfer();
            files.items.add(new File([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))], name));
            dispatchEvent(new DragEvent('drop', { dataTransfer: files, cancelable: true }));
        },
        name,
        bytes.toString('base64'),
    );
