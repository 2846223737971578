// Runs the recipe of docs/engines.md for `engine`, with files renamed as in `files` and the variables
// `given`.
async function runRecipe(engine, files, given) {
    let code = await (await fetch(`/recipe/${engine}`)).text();
    for (const [name, url] of Object.entries(files)) {
        if (!code.includes(name)) throw new Error(`the recipe of ${engine} has no ${name}`);
        code = code.replace(name, url);
    }
    const AsyncFunction = (async () => {}).constructor;
    return new AsyncFunction(...Object.keys(given), code)(...Object.values(given));
}
