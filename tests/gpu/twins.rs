//! Constants and structs that a shader and Rust both declare are the same. Both sides are read from their
//! sources: no list has to be kept, but for what has another name or no twin.

use crate::reflection::{Shader, files};
use octagloss_gpu::live::LiveEnvironment;
use octagloss_gpu::shadow::ShadowMap;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Constants of shaders, by file, whose twin in Rust has another name or is one of several of its name.
const RENAMED: &[(&str, &str, &str)] = &[
    ("adaptive.wgsl", "DIMMEST", "cells::DIMMEST"),
    ("common/charlie.wgsl", "NOTHING", "profiles::NOTHING"),
    ("common/kernel.wgsl", "SHAPE_GGX", "GGX"),
    ("common/kernel.wgsl", "SHAPE_PHONG", "PHONG"),
    ("common/kernel.wgsl", "SHAPE_WIDE_PHONG", "WIDE_PHONG"),
    ("common/kernel.wgsl", "SHAPE_CONE", "kernel::CONE"),
    ("common/kernel.wgsl", "SHAPE_COSINE", "kernel::COSINE"),
    ("common/light.wgsl", "SUNS", "suns::COUNT"),
    ("common/reduction.wgsl", "GROUPS", "fixed_point::GROUPS"),
    ("common/reduction.wgsl", "GROUP_SIZE", "fixed_point::GROUP_SIZE"),
    ("common/reduction.wgsl", "TEXELS", "fixed_point::TEXELS"),
    ("common/anisotropic.wgsl", "BLEND", "reflect::BLEND"),
    ("common/anisotropic.wgsl", "NARROWEST", "anisotropic::NARROWEST"),
    ("common/anisotropic.wgsl", "BLEND_ALBEDO_NODES", "blend::ALBEDO_NODES"),
    ("common/anisotropic.wgsl", "BLEND_MEAN_NODES", "blend::MEAN_NODES"),
    ("common/anisotropic.wgsl", "BLEND_RATIOS_AT", "blend::RATIOS_AT"),
    ("common/anisotropic.wgsl", "BLEND_RATIO_NODES", "blend::RATIO_NODES"),
    ("common/anisotropic.wgsl", "BLEND_SHARES_AT", "blend::SHARES_AT"),
    ("common/anisotropic.wgsl", "BLEND_SHARE_NODES", "blend::SHARE_NODES"),
    ("common/anisotropic.wgsl", "BLEND_STRIP", "blend::STRIP"),
    ("common/anisotropic.wgsl", "ROW_LAYERS", "anisotropic::LAYERS"),
    ("common/anisotropic.wgsl", "ROW_PAIRS", "anisotropic::PAIRS"),
    ("common/anisotropic.wgsl", "ROW_MIDDLE", "anisotropic::MIDDLE"),
    ("common/anisotropic.wgsl", "ROW_NODES", "anisotropic::NODES"),
    ("common/anisotropic.wgsl", "ROW_SHARP", "anisotropic::SHARP"),
    ("common/anisotropic.wgsl", "SKEWED", "anisotropic::SKEWED"),
    ("common/anisotropic.wgsl", "TILTED", "anisotropic::TILTED"),
    ("common/reflect.wgsl", "ALBEDO_NODES", "albedo::NODES"),
    ("common/reflect.wgsl", "COSINE_FROM", "reads::COSINE_FROM"),
    ("common/reflect.wgsl", "DIP", "albedo::DIP"),
    ("common/reflect.wgsl", "LEAST_ALPHA", "albedo::LEAST_ALPHA"),
    ("common/reflect.wgsl", "LAYERS", "reads::LAYERS"),
    ("common/reflect.wgsl", "LEAST_COSINE", "frame::LEAST_COSINE"),
    ("common/reflect.wgsl", "NODES", "reads::NODES"),
    ("common/reflect.wgsl", "READS", "places::READS"),
    ("common/rows.wgsl", "ROW", "stage::ROW"),
    ("common/view_scene.wgsl", "BALLS", "look::ROW"),
    ("common/view_texture.wgsl", "MIRROR", "texture::MIRROR"),
    ("common/view_texture.wgsl", "NEAREST", "texture::NEAREST"),
    ("common/view_scene.wgsl", "MAX_LEVELS", "frame::MAX_LEVELS"),
    ("common/source_pieces.wgsl", "CUBE", "source_texels::CUBE"),
    ("common/source_pieces.wgsl", "PANORAMA", "source_texels::PANORAMA"),
    // The GPU's differences are less exact.
    ("common/tints.wgsl", "TINT_ROUNDING", "2.0 * adaptive::TINT_ROUNDING"),
    ("direct/cull.wgsl", "GROUP_SIZE", "list::GROUP_SIZE"),
    ("direct/offsets.wgsl", "GROUP_SIZE", "list::GROUP_SIZE"),
    ("direct/split.wgsl", "GROUP_SIZE", "list::GROUP_SIZE"),
    ("direct/split.wgsl", "CUT_EDGES", "Cut::Edges"),
    ("direct/split.wgsl", "CUT_OCTANTS", "Cut::Octants"),
    ("direct/unwrap.wgsl", "BY_ALPHA", "Remedy::Alpha"),
    ("direct/unwrap.wgsl", "DROP", "Remedy::Drop"),
    ("direct/unwrap.wgsl", "ONE_SIDE", "Remedy::OneSide"),
    ("pack.wgsl", "EDGE", "box_filter::EDGE"),
    ("view/scene.wgsl", "MAX_PROBES", "uniforms::MAX_PROBES"),
    ("pyramid/cells.wgsl", "GROUP_SIZE", "build_pyramid::GROUP_SIZE"),
    ("pyramid/levels.wgsl", "EDGE", "build_pyramid::EDGE"),
    ("common/pyramid_maps.wgsl", "NODES_A_ROW", "pyramid::NODES_A_ROW"),
    ("common/pyramid_squares.wgsl", "SQUARES", "pyramid::SQUARES"),
    ("pyramid/query.wgsl", "GROUP_SIZE", "pyramid::GROUP_SIZE"),
    ("common/areas.wgsl", "FINEST", "suns::FINEST"),
    ("common/areas.wgsl", "GROUP_SIZE", "build_pyramid::GROUP_SIZE"),
    ("pyramid/levels.wgsl", "LARGE", "sharp::LARGE"),
    ("pyramid/levels.wgsl", "MARGIN", "sharp::MARGIN"),
    ("pyramid/light.wgsl", "GROUP_SIZE", "build_pyramid::GROUP_SIZE"),
];

/// Constants that only their shader uses, or that are derived from others.
const OWN: &[(&str, &[&str])] = &[
    (
        "adaptive.wgsl",
        &[
            "BATCH",
            "DEPTH",
            "GROUP_SIZE",
            "LEAF_FIELDS",
            "LEAVES",
            "MEMBERS",
            "PARTS",
            "PIECES",
            "SOURCE_DEPTH",
            "STACK",
        ],
    ),
    ("common/anisotropic.wgsl", &["ROW_SIZE"]),
    ("common/charlie.wgsl", &["ERROR_OF_S", "MIN_X"]),
    ("common/view_draw.wgsl", &["GREATEST"]),
    ("direct/split.wgsl", &["CORNERS"]),
    ("direct/unwrap.wgsl", &["PI"]),
    ("lamp.wgsl", &["PLACES"]),
    ("reparameterise.wgsl", &["CHUNK"]),
    ("common/seeds.wgsl", &["HALF"]),
    ("common/excess.wgsl", &["MOMENTS", "MOMENTS_OF_SUN"]),
    ("pyramid/cells.wgsl", &["LANES_A_SQUARE", "SQUARES_A_GROUP"]),
    ("pyramid/levels.wgsl", &["PART"]),
    ("pyramid/seeds.wgsl", &["NONE"]),
    ("pyramid/suns.wgsl", &["NONE"]),
    ("sat_f32.wgsl", &["GROUP_SIZE"]),
    ("sat_scan.wgsl", &["EDGE", "PART", "SKEW"]),
    ("view/scene.wgsl", &["MAX_RADIANCE"]),
];

/// Structs in buffers that no struct in Rust has.
const OWN_STRUCTS: &[&str] = &[
    // What passes of a build hand on, of the GPU alone.
    "Excess",
    // Exponents and sizes, which a stage copies.
    "OctaglossTable",
    // Four greatest patterns and four 64-bit sums, of the GPU alone.
    "Partial",
    // Of the GPU alone.
    "Seeds",
];

/// A struct in Rust: the stem of its file, its name, names and types of its fields.
struct Struct {
    owner: String,
    name: String,
    fields: Vec<(String, String)>,
}

/// What the sources in Rust declare.
#[derive(Default)]
struct Sources {
    /// Expressions of constants and discriminants, by name, with the stem of their file or their enum.
    constants: BTreeMap<String, Vec<(String, String)>>,
    /// What short names of types stand for.
    aliases: BTreeMap<String, String>,
    /// Structs with `repr(C)`.
    structs: Vec<Struct>,
}

impl Sources {
    fn read() -> Self {
        let mut sources = Self::default();
        for member in ["core", "gpu", "view"] {
            sources.walk(&Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name(member).join("src"));
        }
        sources
    }

    fn walk(&mut self, folder: &Path) {
        let mut paths: Vec<_> = std::fs::read_dir(folder)
            .expect("a folder of sources")
            .map(|entry| entry.expect("an entry").path())
            .collect();
        paths.sort();
        for path in paths {
            if path.is_dir() {
                self.walk(&path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let named = if path.ends_with("mod.rs") { folder } else { &path };
                let stem = named.file_stem().expect("a name").to_string_lossy().into_owned();
                self.parse(&stem, &std::fs::read_to_string(&path).expect("text"));
            }
        }
    }

    fn parse(&mut self, stem: &str, text: &str) {
        let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.starts_with("//")).collect();
        let mut at = 0;
        let mut is_c = false;
        while at < lines.len() {
            let line = without_visibility(lines[at]);
            let block = |from: usize| lines[from + 1..].iter().take_while(|line| **line != "}").copied();
            if let Some(rest) = line.strip_prefix("const ")
                && let Some((name, _)) = rest.split_once(':')
            {
                let end = (at..lines.len()).find(|k| lines[*k].ends_with(';')).unwrap_or(at);
                let whole = lines[at..=end].join(" ");
                if let Some((_, value)) = whole.trim_end_matches(';').split_once(" = ") {
                    self.constant(name, stem, value);
                }
            } else if let Some(alias) = line.strip_prefix("type ").and_then(|rest| rest.strip_suffix(';'))
                && let Some((name, ty)) = alias.split_once(" = ")
            {
                self.aliases.insert(name.to_owned(), ty.to_owned());
            } else if let Some(name) = line.strip_prefix("enum ").and_then(|rest| rest.strip_suffix(" {")) {
                for value in block(at).filter_map(|line| line.strip_suffix(',')?.split_once(" = ")) {
                    self.constant(value.0, name, value.1);
                }
            } else if let Some(name) = line.strip_prefix("struct ").and_then(|rest| rest.strip_suffix(" {"))
                && is_c
            {
                let field = |line: &str| {
                    let (name, ty) = without_visibility(line).strip_suffix(',')?.split_once(": ")?;
                    Some((name.to_owned(), ty.to_owned()))
                };
                let fields = block(at).filter_map(field).collect();
                self.structs.push(Struct { owner: stem.to_owned(), name: name.to_owned(), fields });
            }
            is_c = lines[at].starts_with("#[repr(C") || is_c && line.starts_with("#[");
            at += 1;
        }
    }

    fn constant(&mut self, name: &str, owner: &str, value: &str) {
        let known = self.constants.entry(name.to_owned()).or_default();
        known.push((owner.to_owned(), value.to_owned()));
    }

    /// The values of the expression `text` of `owner`; `None` if a constant in it has no or several values.
    fn values(&self, owner: &str, text: &str) -> Option<Vec<f64>> {
        let mut parser = Parser { sources: self, owner, rest: text };
        let values = parser.sum()?;
        parser.rest.trim().is_empty().then_some(values)
    }

    /// The values of the constant `path`, of `owner` by preference.
    fn named(&self, owner: &str, path: &str) -> Option<Vec<f64>> {
        let (of, name) = match path.rsplit_once("::") {
            Some((of, name)) => (of.rsplit("::").next().expect("a part"), name),
            None => (owner, path),
        };
        let known = self.constants.get(name)?;
        let own: Vec<_> = known.iter().filter(|(owner, _)| owner == of).collect();
        let all = if own.is_empty() { known.iter().collect() } else { own };
        let mut values = all.iter().map(|(owner, text)| self.values(owner, text));
        let first = values.next()??;
        values.all(|other| other.as_ref() == Some(&first)).then_some(first)
    }

    /// Bytes of a type of words, named in the file `owner`.
    fn size(&self, owner: &str, ty: &str) -> Option<usize> {
        if let Some(array) = ty.strip_prefix('[') {
            let (element, count) = array.strip_suffix(']')?.rsplit_once("; ")?;
            return Some(self.size(owner, element)? * self.values(owner, count)?[0] as usize);
        }
        match ty {
            "u32" | "i32" | "f32" => Some(4),
            _ if self.aliases.contains_key(ty) => self.size(owner, &self.aliases[ty]),
            _ => Some(self.layout(self.named_struct(owner, ty.rsplit("::").next()?)?)?.1),
        }
    }

    /// The struct `name`, of the file `owner` by preference.
    fn named_struct(&self, owner: &str, name: &str) -> Option<&Struct> {
        let all = || self.structs.iter().filter(|one| one.name == name);
        all().find(|one| one.owner == owner).or_else(|| all().next())
    }

    /// Names and offsets of fields without padding, and the size.
    fn layout(&self, whole: &Struct) -> Option<(Vec<(String, usize)>, usize)> {
        let mut at = 0;
        let mut members = Vec::new();
        for (name, ty) in &whole.fields {
            if !name.starts_with("pad") {
                members.push((name.clone(), at));
            }
            at += self.size(&whole.owner, ty)?;
        }
        Some((members, at))
    }
}

fn without_visibility(line: &str) -> &str {
    let Some(rest) = line.strip_prefix("pub") else { return line };
    let rest = rest.strip_prefix('(').and_then(|rest| Some(rest.split_once(')')?.1)).unwrap_or(rest);
    rest.trim_start()
}

/// Evaluates the expressions of constants: numbers, arrays, ranges, sums, products, shifts, names.
struct Parser<'a> {
    sources: &'a Sources,
    owner: &'a str,
    rest: &'a str,
}

impl<'a> Parser<'a> {
    fn takes(&mut self, token: &str) -> bool {
        self.rest = self.rest.trim_start();
        let taken = self.rest.strip_prefix(token);
        self.rest = taken.unwrap_or(self.rest);
        taken.is_some()
    }

    fn word(&mut self) -> &'a str {
        self.rest = self.rest.trim_start();
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == ':';
        let end = self.rest.find(|c| !is_part(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        word
    }

    fn binary(&mut self, first: Vec<f64>, second: Vec<f64>, of: fn(f64, f64) -> f64) -> Option<Vec<f64>> {
        (first.len() == 1 && second.len() == 1).then(|| vec![of(first[0], second[0])])
    }

    fn sum(&mut self) -> Option<Vec<f64>> {
        let mut value = self.product()?;
        loop {
            value = if self.takes("..=") {
                let end = self.product()?;
                vec![value[0], end[0]]
            } else if self.takes("<<") {
                let by = self.product()?;
                self.binary(value, by, |a, b| a * b.exp2())?
            } else if self.takes("+") {
                let other = self.product()?;
                self.binary(value, other, |a, b| a + b)?
            } else if self.takes("-") {
                let other = self.product()?;
                self.binary(value, other, |a, b| a - b)?
            } else {
                return Some(value);
            };
        }
    }

    fn product(&mut self) -> Option<Vec<f64>> {
        let mut value = self.postfix()?;
        loop {
            value = if self.takes("*") {
                let other = self.postfix()?;
                self.binary(value, other, |a, b| a * b)?
            } else if self.takes("/") {
                let other = self.postfix()?;
                self.binary(value, other, |a, b| a / b)?
            } else {
                return Some(value);
            };
        }
    }

    fn postfix(&mut self) -> Option<Vec<f64>> {
        let mut value = self.primary()?;
        loop {
            value = if self.takes("as ") {
                self.word();
                value
            } else if self.takes(".len()") {
                vec![value.len() as f64]
            } else if self.takes("[") {
                let index = self.sum()?;
                self.takes("]").then(|| value.get(index[0] as usize).map(|value| vec![*value]))??
            } else {
                return Some(value);
            };
        }
    }

    fn primary(&mut self) -> Option<Vec<f64>> {
        if self.takes("(") {
            let value = self.sum()?;
            return self.takes(")").then_some(value);
        }
        if self.takes("[") {
            let mut values = Vec::new();
            while !self.takes("]") {
                values.extend(self.sum()?);
                self.takes(",");
            }
            return Some(values);
        }
        self.rest = self.rest.trim_start();
        if self.rest.starts_with(|c: char| c.is_ascii_digit()) {
            return self.number().map(|number| vec![number]);
        }
        match self.word() {
            "size_of::" if self.takes("<") => {
                let (ty, rest) = self.rest.split_once(">()")?;
                self.rest = rest;
                Some(vec![self.sources.size(self.owner, ty)? as f64])
            }
            "f64::from" | "u32::from" => self.primary(),
            // Harmonics up to an order.
            "count" => self.primary().map(|order| vec![(order[0] + 1.0) * (order[0] + 1.0)]),
            path => self.sources.named(self.owner, path),
        }
    }

    fn number(&mut self) -> Option<f64> {
        let bytes = self.rest.as_bytes();
        let mut end = 0;
        while let Some(byte) = bytes.get(end) {
            let is_range = *byte == b'.' && bytes.get(end + 1) == Some(&b'.');
            let is_sign = matches!(byte, b'-' | b'+') && bytes[end - 1] == b'e';
            if is_range || !(byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.') || is_sign) {
                break;
            }
            end += 1;
        }
        let (text, rest) = self.rest.split_at(end);
        self.rest = rest;
        let text = text.replace('_', "");
        let text = text
            .trim_end_matches("u32")
            .trim_end_matches("u128")
            .trim_end_matches("f32")
            .trim_end_matches("usize");
        text.trim_end_matches("f64").parse().ok()
    }
}

/// The file, of `file` and its includes, that declares the constant `name`.
fn declaring(file: &'static str, name: &str) -> &'static str {
    fn closure(path: &'static str, found: &mut Vec<&'static str>) {
        let (path, text) =
            octagloss_shaders::FILES.iter().find(|(listed, _)| *listed == path).expect("a listed file");
        if !found.contains(path) {
            found.push(path);
            let includes =
                text.lines().filter_map(|line| line.strip_prefix("#include \"")?.strip_suffix('"'));
            includes.for_each(|included| closure(included, found));
        }
    }
    let mut paths = Vec::new();
    closure(file, &mut paths);
    let declares = |path: &&&str| {
        let (_, text) =
            octagloss_shaders::FILES.iter().find(|(listed, _)| listed == *path).expect("a listed file");
        text.lines().any(|line| line.starts_with(&format!("const {name} ")))
    };
    paths.iter().find(declares).expect("a declaration")
}

/// How `value` of the constant `name` of the shader file `path` differs from its twin's.
fn difference(sources: &Sources, path: &str, name: &str, value: &[f64]) -> Option<String> {
    if OWN.iter().any(|(file, names)| *file == path && names.contains(&name)) {
        return None;
    }
    let stem = Path::new(path).file_stem().expect("a name").to_string_lossy().into_owned();
    let renamed = RENAMED.iter().find(|(file, constant, _)| (*file, *constant) == (path, name));
    let field = name.strip_prefix("FIELD_").map(str::to_lowercase);
    let expected = match (renamed, field) {
        (Some((.., text)), _) => sources.values(&stem, text),
        // The position of a field, in vectors of four floats.
        (None, Some(field)) => {
            let quad = sources.named_struct("cells", "Quad").and_then(|quad| sources.layout(quad));
            let member = quad.and_then(|(members, _)| members.into_iter().find(|(name, _)| *name == field));
            member.map(|(_, offset)| vec![offset as f64 / 16.0])
        }
        (None, None) => sources.named(&stem, name),
    };
    let Some(expected) = expected else {
        return Some(format!("{name} of {path} has no or several twins: list it in RENAMED or OWN"));
    };
    // Shaders have float32.
    let expected: Vec<f64> = expected.iter().map(|number| f64::from(*number as f32)).collect();
    (value != expected).then(|| format!("{name} of {path} is {value:?}, in Rust {expected:?}"))
}

#[test]
fn constants_have_the_values_of_their_twins() {
    let sources = Sources::read();
    let mut seen = BTreeSet::new();
    for file in files() {
        let shader = Shader::of_file(file);
        for name in shader.module.constants.iter().filter_map(|(_, constant)| constant.name.clone()) {
            let path = declaring(file, &name);
            let value = shader.constant(&name).expect("a constant");
            assert_eq!(difference(&sources, path, &name, &value), None);
            seen.insert((path, name));
        }
    }
    // The compiler drops constants without a concrete type, which would go unchecked. Readers of files are in
    // no shader of ours; their test changes each constant.
    let is_ours = |path: &str| !path.starts_with("common/pyramid_file");
    for (path, text) in octagloss_shaders::FILES.iter().filter(|(path, _)| is_ours(path)) {
        for name in text.lines().filter_map(|line| line.strip_prefix("const ")?.split([' ', ':']).next()) {
            assert!(seen.contains(&(*path, name.to_owned())), "{path}: give {name} a concrete type");
        }
    }
    let own = OWN.iter().flat_map(|(path, names)| names.iter().map(move |name| (*path, *name)));
    let listed = RENAMED.iter().map(|(path, name, _)| (*path, *name)).chain(own);
    for (path, name) in listed {
        assert!(seen.contains(&(path, name.to_owned())), "{path} declares no {name}");
    }
    assert!(seen.len() > 80, "{} constants", seen.len());
    // Other values, other names and other places are detected.
    assert_eq!(difference(&sources, "sat_scan.wgsl", "TILE", &[64.0]), None);
    assert!(difference(&sources, "sat_scan.wgsl", "TILE", &[32.0]).is_some());
    assert!(difference(&sources, "sat_scan.wgsl", "TILES", &[64.0]).is_some());
    assert!(difference(&sources, "common/quad.wgsl", "FIELD_RED", &[9.0]).is_some());
    assert!(difference(&sources, "common/pyramid.wgsl", "INTERVALS", &[64.0]).is_some());
}

#[test]
fn structs_have_the_layouts_of_their_twins() {
    let sources = Sources::read();
    let layouts: Vec<_> =
        sources.structs.iter().filter_map(|one| Some((&one.name, sources.layout(one)?))).collect();
    let twin = |shader: &Shader, name: &str| {
        let layout = shader.layout(name)?;
        layouts.iter().find(|(_, known)| *known == layout).map(|(name, _)| (*name).clone())
    };
    let mut twins = BTreeSet::new();
    let mut own = BTreeSet::new();
    // Look-ups are in callers' shaders only.
    let callers = [LiveEnvironment::draw_wgsl(0), ShadowMap::wgsl(0)];
    let callers = callers.iter().map(|source| ("a caller's shader", Shader::parse("a caller's", source)));
    let shaders = files().map(|file| (file, Shader::of_file(file)));
    for (file, shader) in shaders.chain(callers) {
        for name in shader.structs_in_buffers() {
            if OWN_STRUCTS.contains(&name.as_str()) {
                own.insert(name);
            } else {
                let layout = shader.layout(&name);
                let twin = twin(&shader, &name);
                twins.insert(
                    twin.unwrap_or_else(|| panic!("{file}: {name} is no struct in Rust: {layout:?}")),
                );
            }
        }
    }
    assert!(own.iter().eq(OWN_STRUCTS.iter().collect::<BTreeSet<_>>()), "{own:?}");
    assert!(twins.len() > 15, "{twins:?}");
    // Swapped, moved and additional members are detected.
    let finds = |from: &str, to: &str| {
        let source = octagloss_shaders::source("sat_scan.wgsl");
        assert!(source.contains(from), "the source must contain {from}");
        twin(&Shader::parse("a wrong scan", &source.replace(from, to)), "Scan").is_some()
    };
    assert!(finds("// Tiles along an edge.", "// Tiles."), "a comment changes nothing");
    assert!(!finds("    side: u32,\n    pitch: u32,", "    pitch: u32,\n    side: u32,"), "swapped members");
    assert!(!finds("    tiles: u32,\n", "    @align(16) tiles: u32,\n"), "a member moved");
    assert!(!finds("    channel: u32,\n", "    channel: u32,\n    more: u32,\n"), "an additional member");
}
