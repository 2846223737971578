//! Reflection of the shaders: layouts, constants, bindings and sizes equal Rust's and stay within the limits
//! of baseline WebGPU.

use super::entry_points::ENTRY_POINTS;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Expression, Handle, ImageClass, Literal, Module, Type, TypeInner};
use octagloss::internals::gpu::device::shader;
use octagloss::internals::gpu::device::shader::Queries;
use octagloss::internals::gpu::shared::Struct;
use octagloss::internals::gpu::{box_filter, fitted};
use octagloss::internals::target::READERS;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A shader, parsed and validated with baseline WebGPU capabilities only.
struct Shader {
    module: Module,
    info: ModuleInfo,
}

impl Shader {
    fn parse(name: &str, source: &str) -> Self {
        let module = naga::front::wgsl::parse_str(source)
            .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
        // WGSL core has halves in 32-bit words; naga lists them as a capability for older APIs.
        let info = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
            .validate(&module)
            .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
        Self { module, info }
    }

    fn of_file(path: &str) -> Self {
        Self::parse(path, &shader::source(path))
    }

    fn size(&self, ty: Handle<Type>) -> u32 {
        self.module.types[ty].inner.size(self.module.to_ctx())
    }

    /// Returns names and offsets of a struct's members, without padding, and its size.
    fn layout(&self, name: &str) -> Option<(Vec<(String, usize)>, usize)> {
        let (_, ty) = self.module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name))?;
        let TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is a struct") };
        let member =
            |member: &naga::StructMember| (member.name.clone().expect("a name"), member.offset as usize);
        Some((
            members.iter().map(member).filter(|(name, _)| !name.starts_with("pad")).collect(),
            *span as usize,
        ))
    }

    /// Returns the numbers of a named constant.
    fn constant(&self, name: &str) -> Option<Vec<f64>> {
        let constant = self.module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name))?.1;
        let literal = |expression: Handle<Expression>| match self.module.global_expressions[expression] {
            Expression::Literal(Literal::U32(value)) => f64::from(value),
            Expression::Literal(Literal::I32(value)) => f64::from(value),
            Expression::Literal(Literal::F32(value)) => f64::from(value),
            ref other => panic!("{name} is {other:?}"),
        };
        Some(match &self.module.global_expressions[constant.init] {
            Expression::Compose { components, .. } => components.iter().map(|c| literal(*c)).collect(),
            _ => vec![literal(constant.init)],
        })
    }
}

/// Returns the files with entry points, which are complete shaders.
fn files() -> impl Iterator<Item = &'static str> {
    // The files in common/ hold only functions; common/sat.wgsl needs the includer's table declaration.
    shader::FILES.iter().map(|(path, _)| *path).filter(|path| !path.starts_with("common/"))
}

/// Returns the files of the compute stages.
fn stages() -> impl Iterator<Item = &'static str> {
    files().filter(|path| !path.starts_with("view/"))
}

/// Describes how the layout of struct `name` differs from the expected `members` and `size`.
fn layout_difference(shader: &Shader, name: &str, members: &[(&str, usize)], size: usize) -> Option<String> {
    let Some((found, span)) = shader.layout(name) else { return Some(format!("no struct {name}")) };
    let expected: Vec<(String, usize)> = members
        .iter()
        .filter(|(name, _)| !name.starts_with("pad"))
        .map(|(name, offset)| ((*name).to_owned(), *offset))
        .collect();
    (found != expected || span != size)
        .then(|| format!("{name}: {found:?} of {span} bytes, in Rust {expected:?} of {size}"))
}

/// Collects a file of `shaders/` and those that it includes.
fn closure(path: &str, found: &mut Vec<&'static str>) {
    let (path, text) = shader::FILES.iter().find(|(listed, _)| *listed == path).expect("a listed file");
    if found.contains(path) {
        return;
    }
    found.push(path);
    for line in text.lines() {
        if let Some(included) = line.strip_prefix("#include \"").and_then(|rest| rest.strip_suffix('"')) {
            closure(included, found);
        }
    }
}

/// Returns the file of `file`'s includes whose line begins with `declaration`.
fn declaring(file: &str, declaration: &str) -> &'static str {
    let mut paths = Vec::new();
    closure(file, &mut paths);
    let declares = |path: &&&str| {
        let (_, text) = shader::FILES.iter().find(|(listed, _)| listed == *path).expect("a listed file");
        text.lines().any(|line| line.starts_with(declaration))
    };
    let found: Vec<_> = paths.iter().filter(declares).collect();
    assert_eq!(found.len(), 1, "{file}: {declaration} is declared in {found:?}");
    found[0]
}

/// Fails unless `declared` and `expected` hold the same names.
fn assert_same_names(kind: &str, declared: &BTreeSet<(&str, String)>, expected: &BTreeSet<(&str, String)>) {
    let untold: Vec<_> = declared.difference(expected).collect();
    let stale: Vec<_> = expected.difference(declared).collect();
    assert!(untold.is_empty(), "{kind} that shared.rs does not list: {untold:?}");
    assert!(stale.is_empty(), "{kind} that no shader declares: {stale:?}");
}

fn structs() -> Vec<Struct> {
    let all = octagloss::internals::gpu::shared::structs();
    #[cfg(feature = "view")]
    let all = [all, octagloss::internals::view::shared::structs()].concat();
    all
}

/// Whether this build has the Rust side of the shader file `path`: the viewer's is in the feature `view`.
fn is_built(path: &str) -> bool {
    cfg!(feature = "view") || !(path.starts_with("view/") || path.starts_with("common/view_"))
}

impl Shader {
    /// Returns the names of the structs in uniforms and storage buffers.
    fn structs_in_buffers(&self) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        let mut waiting: Vec<Handle<Type>> = self
            .module
            .global_variables
            .iter()
            .filter(|(_, global)| {
                matches!(global.space, AddressSpace::Uniform | AddressSpace::Storage { .. })
            })
            .map(|(_, global)| global.ty)
            .collect();
        while let Some(ty) = waiting.pop() {
            match &self.module.types[ty].inner {
                TypeInner::Array { base, .. } => waiting.push(*base),
                TypeInner::Struct { members, .. } => {
                    found.insert(self.module.types[ty].name.clone().expect("a struct's name"));
                    waiting.extend(members.iter().map(|member| member.ty));
                }
                _ => {}
            }
        }
        found
    }
}

#[test]
fn struct_layouts_match_rust() {
    let expected = structs();
    let mut declared = BTreeSet::new();
    let shaders = files().filter(|file| is_built(file)).map(|file| (file, Shader::of_file(file)));
    // The look-up of shadows is in callers' shaders only.
    let of_caller = Shader::parse("a caller's shader", &shader::queries(&[Queries::Shadow(0)]));
    for (file, shader) in shaders.chain([("common/shadow.wgsl", of_caller)]) {
        for name in shader.structs_in_buffers() {
            let path = declaring(file, &format!("struct {name} {{"));
            if let Some((_, _, members, size)) = expected.iter().find(|s| (s.0, s.1) == (path, name.as_str()))
            {
                assert_eq!(layout_difference(&shader, &name, members, *size), None, "{file}");
            }
            declared.insert((path, name));
        }
    }
    let names = expected.iter().map(|(path, name, ..)| (*path, (*name).to_owned())).collect();
    assert_same_names("structs", &declared, &names);
    // Swapped, moved and additional members must be detected.
    let seen = |from: &str, to: &str| {
        let source = shader::source("sat_scan.wgsl");
        assert!(source.contains(from), "the source must contain {from}");
        let wrong = Shader::parse("a wrong scan", &source.replace(from, to));
        let (.., members, size) = expected.iter().find(|s| s.1 == "Scan").expect("the scan's uniform");
        layout_difference(&wrong, "Scan", members, *size).is_some()
    };
    assert!(!seen("// Tiles along an edge.", "// Tiles."), "a comment changes nothing");
    assert!(seen("    side: u32,\n    pitch: u32,", "    pitch: u32,\n    side: u32,"), "swapped members");
    assert!(seen("    tiles: u32,\n", "    @align(16) tiles: u32,\n"), "a member moved");
    assert!(seen("    channel: u32,\n", "    channel: u32,\n    more: u32,\n"), "an additional member");
}

/// Constants that only their shader uses, or that are derived from others.
const OWN_CONSTANTS: &[(&str, &[&str])] = &[
    (
        "adaptive.wgsl",
        &["BATCH", "DEPTH", "LEAF_FIELDS", "LEAVES", "MEMBERS", "PARTS", "PIECES", "SOURCE_DEPTH", "STACK"],
    ),
    ("blur.wgsl", &["SCAN_SIZE"]),
    ("common/charlie.wgsl", &["ERROR_OF_S", "MIN_X"]),
    ("common/fitted.wgsl", &["UNIT"]),
    ("common/view_draw.wgsl", &["GREATEST"]),
    ("direct/cull.wgsl", &["SCAN_SIZE"]),
    ("direct/offsets.wgsl", &["SCAN_SIZE"]),
    ("direct/split.wgsl", &["CORNERS", "SCAN_SIZE"]),
    ("direct/unwrap.wgsl", &["PI"]),
    ("harmonics.wgsl", &["HIGH_WORD", "LOW_WORD", "SKEW"]),
    ("reparameterise.wgsl", &["CHUNK"]),
    ("sat_f32.wgsl", &["GROUP_SIZE"]),
    ("sat_scan.wgsl", &["EDGE", "PART", "SCAN_SIZE", "SKEW"]),
];

#[test]
fn constants_match_rust() {
    let expected = octagloss::internals::gpu::shared::constants();
    #[cfg(feature = "view")]
    let expected = [expected, octagloss::internals::view::shared::constants()].concat();
    let mut declared = BTreeSet::new();
    for file in files().filter(|file| is_built(file)) {
        let shader = Shader::of_file(file);
        for name in shader.module.constants.iter().filter_map(|(_, constant)| constant.name.clone()) {
            let path = declaring(file, &format!("const {name} "));
            if let Some((_, _, numbers)) = expected.iter().find(|c| (c.0, c.1) == (path, name.as_str())) {
                // Shaders have float32.
                let numbers: Vec<f64> = numbers.iter().map(|number| f64::from(*number as f32)).collect();
                assert_eq!(shader.constant(&name), Some(numbers), "{name} of {path}");
            }
            declared.insert((path, name));
        }
    }
    // The compiler drops constants without a concrete type, which would go unchecked.
    let lines = shader::FILES.iter().flat_map(|(path, text)| text.lines().map(move |line| (*path, line)));
    for (path, line) in lines.filter(|(path, line)| is_built(path) && line.starts_with("const ")) {
        let seen = declared.iter().any(|(file, name)| {
            *file == path
                && line.strip_prefix("const ").is_some_and(|rest| rest.starts_with(&format!("{name} ")))
        });
        assert!(seen, "{path}: give this constant a concrete type: {line}");
    }
    let own = OWN_CONSTANTS.iter().filter(|(path, _)| is_built(path));
    let own = own.flat_map(|(path, names)| names.iter().map(|name| (*path, *name)));
    let names = expected.iter().map(|(path, name, _)| (*path, *name)).chain(own);
    let names = names.map(|(path, name)| (path, name.to_owned())).collect();
    assert_same_names("constants", &declared, &names);
    let source = shader::source("sat_scan.wgsl").replace("const TILE = 64u;", "const TILE = 32u;");
    assert_eq!(
        Shader::parse("smaller tiles", &source).constant("TILE"),
        Some(vec![32.0]),
        "the value must be read from the source"
    );
    let fails = |declared: &BTreeSet<_>| {
        std::panic::catch_unwind(|| assert_same_names("constants", declared, &names)).is_err()
    };
    let mut more = declared.clone();
    more.insert(("copy.wgsl", "NEW".to_owned()));
    let mut fewer = declared;
    fewer.pop_first();
    assert!(fails(&more) && fails(&fewer), "new and missing names must be detected");
}

/// The resources and workgroup of one entry point.
struct Uses {
    workgroup_size: [u32; 3],
    bindings: BTreeMap<u32, String>,
    workgroup_bytes: u32,
}

impl Shader {
    fn entry_points(&self) -> Vec<(String, Uses)> {
        let module = &self.module;
        let uses = |(index, entry): (usize, &naga::EntryPoint)| {
            let info = self.info.get_entry_point(index);
            let mut bindings = BTreeMap::new();
            let mut workgroup_bytes = 0;
            for (handle, global) in module.global_variables.iter().filter(|(h, _)| !info[*h].is_empty()) {
                let kind = match global.space {
                    AddressSpace::Uniform => "uniform",
                    AddressSpace::Storage { access } if access.contains(naga::StorageAccess::STORE) => {
                        "write"
                    }
                    AddressSpace::Storage { .. } => "read",
                    AddressSpace::Handle => match module.types[global.ty].inner {
                        TypeInner::Image { class: ImageClass::Storage { .. }, .. } => "store",
                        _ => "texture",
                    },
                    AddressSpace::WorkGroup => {
                        workgroup_bytes += self.size(global.ty).next_multiple_of(16);
                        continue;
                    }
                    AddressSpace::Private => continue,
                    other => panic!("{:?} in {other:?}", global.name),
                };
                let binding = global.binding.expect("a resource's binding");
                let name = global.name.as_deref().expect("a name");
                let taken = bindings.insert(100 * binding.group + binding.binding, format!("{kind} {name}"));
                assert_eq!(taken, None, "one resource per binding, {handle:?}");
            }
            (entry.name.clone(), Uses { workgroup_size: entry.workgroup_size, bindings, workgroup_bytes })
        };
        module.entry_points.iter().enumerate().map(uses).collect()
    }
}

#[test]
fn bindings_match_rust() {
    let mut found = Vec::new();
    for file in stages() {
        for (name, uses) in Shader::of_file(file).entry_points() {
            let bindings: Vec<(u32, String)> = uses.bindings.into_iter().collect();
            found.push((file, name, uses.workgroup_size, bindings));
        }
    }
    found.sort();
    assert_eq!(found.len(), ENTRY_POINTS.len(), "entry points");
    for ((file, name, size, bindings), expected) in found.iter().zip(ENTRY_POINTS) {
        let bindings: Vec<(u32, &str)> = bindings.iter().map(|(at, what)| (*at, what.as_str())).collect();
        assert_eq!((*file, name.as_str(), *size, &bindings[..]), *expected);
    }
}

/// Limits of WebGPU that every adapter has.
const STORAGE_BUFFERS: usize = 8;
const STORAGE_TEXTURES: usize = 4;
const UNIFORM_BUFFERS: usize = 12;
const INVOCATIONS: u32 = 256;
const WORKGROUP_BYTES: u32 = 16_384;

/// Lists what `uses` exceeds of the baseline limits.
fn beyond_baseline(uses: &Uses) -> Option<String> {
    let count = |kinds: &[&str]| {
        let kind = |what: &&String| kinds.iter().any(|kind| what.starts_with(kind));
        uses.bindings.values().filter(kind).count()
    };
    let invocations: u32 = uses.workgroup_size.iter().product();
    let found = [
        (count(&["read ", "write "]) > STORAGE_BUFFERS, "storage buffers"),
        (count(&["store "]) > STORAGE_TEXTURES, "storage textures"),
        (count(&["uniform "]) > UNIFORM_BUFFERS, "uniform buffers"),
        (invocations > INVOCATIONS || uses.workgroup_size[2] > 64, "invocations"),
        (uses.workgroup_bytes > WORKGROUP_BYTES, "workgroup memory"),
    ];
    let names: Vec<&str> = found.iter().filter(|(beyond, _)| *beyond).map(|(_, name)| *name).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

#[test]
fn every_entry_point_keeps_to_baseline_limits() {
    let mut counted = 0;
    for file in stages() {
        for (name, uses) in Shader::of_file(file).entry_points() {
            assert_eq!(beyond_baseline(&uses), None, "{file}: {name}");
            counted += 1;
        }
    }
    assert_eq!(counted, ENTRY_POINTS.len());
    let first = |source: &str| {
        let (_, uses) = Shader::parse("a greedy shader", source).entry_points().swap_remove(0);
        beyond_baseline(&uses)
    };
    let buffers: String = (0..9)
        .map(|k| format!("@group(0) @binding({k}) var<storage, read_write> b{k}: array<u32>;\n"))
        .collect();
    let stores: String = (0..9).map(|k| format!("b{k}[0] = 1u;")).collect();
    let greedy = format!("{buffers}@compute @workgroup_size(1) fn f() {{ {stores} }}");
    assert_eq!(first(&greedy).as_deref(), Some("storage buffers"));
    let large = "var<workgroup> a: array<u32, 4097>; @compute @workgroup_size(257) fn f() { a[0] = 1u; }";
    assert_eq!(first(large).as_deref(), Some("invocations, workgroup memory"));
}

/// The viewer's entry points.
const VIEW_ENTRY_POINTS: &[(&str, &[&str])] = &[
    (
        "view/box.wgsl",
        &[
            "cover",
            "cover_error",
            "cover_picture",
            "cover_samples",
            "mesh_error",
            "mesh_picture",
            "mesh_samples",
            "oem",
            "sat",
            "transform",
        ],
    ),
    (
        "view/fitted.wgsl",
        &[
            "cover",
            "cover_error",
            "cover_picture",
            "cover_samples",
            "mesh_error",
            "mesh_picture",
            "mesh_samples",
            "transform",
        ],
    ),
    (
        "view/levels.wgsl",
        &[
            "cover",
            "cover_error",
            "cover_picture",
            "cover_samples",
            "mesh_error",
            "mesh_picture",
            "mesh_samples",
            "transform",
        ],
    ),
    ("view/present.wgsl", &["cover", "show"]),
    ("view/scene.wgsl", &["cover_glossy", "glossy", "glossy_corner", "matte", "matte_corner"]),
    ("view/scene_pose.wgsl", &["pose_glossy", "pose_matte"]),
    (
        "view/truth.wgsl",
        &[
            "cover",
            "cover_error",
            "cover_picture",
            "cover_samples",
            "mesh_error",
            "mesh_picture",
            "mesh_samples",
            "transform",
        ],
    ),
];

#[test]
fn the_viewer_s_entry_points_are_listed() {
    let mut found = Vec::new();
    for file in files().filter(|path| path.starts_with("view/")) {
        // Parsing also validates with baseline WebGPU capabilities only.
        let module = Shader::of_file(file).module;
        let mut names: Vec<String> = module.entry_points.iter().map(|entry| entry.name.clone()).collect();
        names.sort();
        found.push((file, names));
    }
    let expected: Vec<(&str, Vec<String>)> = VIEW_ENTRY_POINTS
        .iter()
        .map(|(file, names)| (*file, names.iter().map(|name| (*name).to_owned()).collect()))
        .collect();
    assert_eq!(found, expected);
}

#[test]
fn every_shader_on_disk_is_listed() {
    fn walk(folder: &Path, root: &Path, found: &mut Vec<(String, String)>) {
        for entry in std::fs::read_dir(folder).expect("the folder of shaders") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                walk(&path, root, found);
                continue;
            }
            let name = path.strip_prefix(root).expect("below the root").components();
            let name: Vec<_> = name.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
            found.push((name.join("/"), std::fs::read_to_string(&path).expect("text")));
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut on_disk = Vec::new();
    walk(&root, &root, &mut on_disk);
    on_disk.sort();
    let mut listed: Vec<(String, String)> =
        shader::FILES.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect();
    let readers = READERS.iter().map(|(name, text)| (format!("readers/{name}"), (*text).to_owned()));
    listed.extend(readers);
    listed.sort();
    let names = |files: &[(String, String)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&listed), names(&on_disk));
    assert!(listed == on_disk, "embedded texts must equal those on disk");
}

#[test]
fn query_functions_go_into_any_group_of_a_caller_s_shader() {
    for group in [0, 3] {
        let source = format!(
            "{}\n@group(2) @binding(0) var<storage, read_write> out: array<vec4<f32>>;\n\
             @compute @workgroup_size(1) fn f() {{\n\
             out[0] = vec4<f32>(octagloss_ggx(vec3<f32>(0.0, 1.0, 0.0), 0.5), 1.0);\n\
             out[1] = vec4<f32>(octagloss_box(vec3<f32>(0.0, 1.0, 0.0), 0.5), 1.0); }}",
            box_filter::wgsl(group)
        );
        let (_, uses) = Shader::parse("a caller's shader", &source).entry_points().swap_remove(0);
        let found: Vec<(u32, &str)> = uses.bindings.iter().map(|(at, what)| (*at, what.as_str())).collect();
        let mut expected = vec![
            (100 * group, "uniform octagloss_table"),
            (100 * group + 1, "texture octagloss_low"),
            (100 * group + 2, "texture octagloss_high"),
            (200, "write out"),
        ];
        expected.sort_unstable();
        assert_eq!(found, expected);
    }
}

#[test]
fn boxes_and_fitted_lobes_go_into_one_shader() {
    let ask = |queries: &[Queries]| {
        format!(
            "{}\n@group(1) @binding(0) var<storage, read_write> out: array<vec4<f32>>;\n\
             @compute @workgroup_size(1) fn f() {{\n\
             out[0] = vec4<f32>(octagloss_ggx(vec3<f32>(0.0, 1.0, 0.0), 0.5), 1.0);\n\
             out[1] = vec4<f32>(octagloss_fitted(vec3<f32>(0.0, 1.0, 0.0), 0.5), 1.0); }}",
            shader::queries(queries)
        )
    };
    let (boxes, fitted) = (Queries::Boxes(0), Queries::Fitted(3));
    for order in [[boxes, fitted], [fitted, boxes]] {
        let (_, uses) = Shader::parse("a caller's shader", &ask(&order)).entry_points().swap_remove(0);
        let found: Vec<(u32, &str)> = uses.bindings.iter().map(|(at, what)| (*at, what.as_str())).collect();
        let expected = [
            (0, "uniform octagloss_table"),
            (1, "texture octagloss_low"),
            (2, "texture octagloss_high"),
            (100, "write out"),
            (300, "uniform octagloss_octaves"),
            (301, "uniform octagloss_lights"),
            (302, "read octagloss_entries"),
            (303, "read octagloss_parameters"),
            (304, "texture octagloss_oems"),
        ];
        assert_eq!(found, expected);
    }
    assert!(
        naga::front::wgsl::parse_str(&ask(&[boxes])).is_err(),
        "functions that were not requested must be absent"
    );
    assert_eq!(fitted::wgsl(2), shader::queries(&[Queries::Fitted(2)]));
}
