//! Imports between the modules of `src`: no module imports itself through others. Files that documents name.

use std::collections::BTreeMap;
use std::path::Path;

/// A module by its names from the root.
type Module = Vec<String>;

/// Reads the modules of `folder` and of those in it.
fn modules(folder: &Path, module: &Module, found: &mut BTreeMap<Module, String>) {
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let own = match name.as_str() {
            "mod" | "lib" | "main" => module.clone(),
            _ => [&module[..], &[name]].concat(),
        };
        if path.is_dir() {
            modules(&path, &own, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.insert(own, std::fs::read_to_string(&path).expect("text"));
        }
    }
}

/// Adds the paths of the import tree at the start of `text`, `b` and `c::d` of `{b, c::d}`, after `before`.
/// Returns the rest of the text.
fn add_paths<'a>(before: &Module, mut text: &'a str, found: &mut Vec<Module>) -> &'a str {
    let mut path = before.clone();
    loop {
        text = text.trim_start();
        if let Some(group) = text.strip_prefix('{') {
            text = group;
            while !text.trim_start().starts_with('}') && !text.is_empty() {
                text = add_paths(&path, text, found);
                text = &text[text.find([',', '}']).unwrap_or(text.len())..];
                text = text.strip_prefix(',').unwrap_or(text);
            }
            return text.trim_start().strip_prefix('}').unwrap_or("");
        }
        let end = text.find(|c: char| c != '_' && !c.is_alphanumeric()).unwrap_or(text.len());
        path.push(text[..end].to_owned());
        text = &text[end..];
        match text.strip_prefix("::") {
            Some(rest) => text = rest,
            None => break,
        }
    }
    found.push(path);
    text
}

/// The modules that `text`, of `module`, names by paths from the root or the parent; without tests.
fn imports(module: &Module, text: &str, all: &BTreeMap<Module, String>) -> Vec<Module> {
    let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let code = code.join("\n");
    let code = code.split("\nmod tests {").next().expect("a part");
    let mut paths = Vec::new();
    for start in ["crate::", "super::"].iter().flat_map(|start| code.match_indices(start)) {
        if !code[..start.0].ends_with("::") {
            add_paths(&Vec::new(), &code[start.0..], &mut paths);
        }
    }
    let resolved = |path: Module| -> Module {
        let mut full = if path[0] == "super" { module.clone() } else { Vec::new() };
        for name in path {
            match name.as_str() {
                "crate" | "self" => {}
                "super" => drop(full.pop()),
                _ => full.push(name),
            }
        }
        while !all.contains_key(&full) {
            full.pop().expect("the root is a module");
        }
        full
    };
    paths.into_iter().map(resolved).filter(|path| path != module && !path.is_empty()).collect()
}

/// A module that imports itself through others, with those on the way.
fn circle(all: &BTreeMap<Module, String>) -> Option<String> {
    let edges: BTreeMap<&Module, Vec<Module>> =
        all.iter().map(|(module, text)| (module, imports(module, text, all))).collect();
    // Modules without imports that remain have no part in a circle.
    let mut rest = edges.clone();
    loop {
        let before = rest.len();
        let kept: Vec<Module> = rest.keys().map(|module| (*module).clone()).collect();
        rest.retain(|_, targets| targets.iter().any(|target| kept.contains(target)));
        if rest.len() == before {
            break;
        }
    }
    let mut way = vec![*rest.keys().next()?];
    loop {
        let next = edges[way[way.len() - 1]].iter().find(|target| rest.contains_key(target))?;
        let (next, _) = rest.get_key_value(next)?;
        way.push(next);
        if let Some(start) = way[..way.len() - 1].iter().position(|module| module == next) {
            return Some(
                way[start..].iter().map(|module| module.join("::")).collect::<Vec<_>>().join(" -> "),
            );
        }
    }
}

#[test]
fn imports_have_no_circles() {
    let mut all = BTreeMap::new();
    modules(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &Vec::new(), &mut all);
    // The root names every module.
    all.insert(Vec::new(), String::new());
    let module = |path: &str| path.split("::").map(str::to_owned).collect::<Module>();
    let job = module("bake::job");
    let used = imports(&job, &all[&job], &all);
    assert!(
        ["bake::level", "chain", "reflector"].iter().all(|path| used.contains(&module(path))),
        "{used:?}"
    );
    assert_eq!(circle(&all), None);
}

#[test]
fn circles_are_found() {
    let of = |sources: &[(&str, &str)]| {
        let module = |path: &str| path.split("::").map(str::to_owned).collect::<Module>();
        let mut all: BTreeMap<_, _> =
            sources.iter().map(|(m, text)| (module(m), (*text).to_owned())).collect();
        all.insert(Vec::new(), String::new());
        circle(&all)
    };
    let one = ("a", "use crate::b::{self, c::{D, E}};");
    assert_eq!(of(&[one, ("b", ""), ("b::c", "use super::F;")]), None);
    assert_eq!(
        of(&[one, ("b", ""), ("b::c", "fn f(x: super::super::a::G) {}")]).as_deref(),
        Some("a -> b::c -> a")
    );
    assert_eq!(
        of(&[one, ("b", "// use crate::a;\nfn g() {}\nmod tests {\nuse crate::a;"), ("b::c", "")]),
        None
    );
    assert_eq!(of(&[one, ("b", "use super::{e, a::H};"), ("e", "")]).as_deref(), Some("a -> b -> a"));
}

#[test]
fn documents_name_files_that_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut count = 0;
    for document in ["docs/architecture.md", "docs/contributing.md"] {
        let text = std::fs::read_to_string(root.join(document)).expect("a document");
        // The npm and Python packages are not in the crate's.
        let is_path = |word: &&str| {
            ["src/", "shaders/", "tests/"].iter().any(|folder| word.starts_with(folder))
                && !word.contains("NAME")
                && word.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c))
        };
        for path in text.split('`').skip(1).step_by(2).filter(is_path) {
            assert!(root.join(path).exists(), "{document} names {path}, which there is not");
            count += 1;
        }
    }
    assert!(count > 40, "{count}");
}
