//! Reflection of the shaders: they stay within the limits of baseline WebGPU, and those for callers have our
//! names alone.

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Expression, Handle, ImageClass, Literal, Module, Type, TypeInner};
use octagloss_gpu::live::LiveEnvironment;
use octagloss_gpu::live_probes::LiveProbes;
use octagloss_gpu::shadow::ShadowMap;
use octagloss_shaders::READERS;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A shader, parsed and validated with baseline WebGPU capabilities only.
pub(super) struct Shader {
    pub(super) module: Module,
    info: ModuleInfo,
}

impl Shader {
    pub(super) fn parse(name: &str, source: &str) -> Self {
        let module = naga::front::wgsl::parse_str(source)
            .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
        // WGSL core has halves in 32-bit words; naga lists them as a capability for older APIs.
        let info = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32)
            .validate(&module)
            .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
        Self { module, info }
    }

    pub(super) fn of_file(path: &str) -> Self {
        Self::parse(path, &octagloss_shaders::source(path))
    }

    fn size(&self, ty: Handle<Type>) -> u32 {
        self.module.types[ty].inner.size(self.module.to_ctx())
    }

    /// Returns names and offsets of a struct's members, without padding, and its size.
    pub(super) fn layout(&self, name: &str) -> Option<(Vec<(String, usize)>, usize)> {
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
    pub(super) fn constant(&self, name: &str) -> Option<Vec<f64>> {
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
pub(super) fn files() -> impl Iterator<Item = &'static str> {
    // The files in common/ hold only functions; common/sat.wgsl needs the includer's table declaration.
    octagloss_shaders::FILES.iter().map(|(path, _)| *path).filter(|path| !path.starts_with("common/"))
}

/// Returns the files of the compute stages.
fn stages() -> impl Iterator<Item = &'static str> {
    files().filter(|path| !path.starts_with("view/"))
}

impl Shader {
    /// Returns the names of the structs in uniforms and storage buffers.
    pub(super) fn structs_in_buffers(&self) -> BTreeSet<String> {
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

/// Every entry point of the compute stages, as `file name`.
pub(super) fn entry_points() -> Vec<String> {
    let of_file = |file| {
        let names = Shader::of_file(file).module.entry_points;
        names.into_iter().map(move |entry| format!("{file} {}", entry.name)).collect::<Vec<_>>()
    };
    stages().flat_map(of_file).collect()
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
    assert!(counted > 40, "{counted} entry points");
    // Parsing validates the viewer's with baseline capabilities, too.
    assert!(files().filter(|path| path.starts_with("view/")).map(Shader::of_file).count() > 5);
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

#[test]
fn every_shader_on_disk_is_listed() {
    fn walk(folder: &Path, root: &Path, found: &mut Vec<(String, String)>) {
        for entry in std::fs::read_dir(folder).expect("the folder of shaders") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                walk(&path, root, found);
                continue;
            }
            if path.extension().is_some_and(|extension| extension == "rs" || extension == "toml") {
                continue;
            }
            let name = path.strip_prefix(root).expect("below the root").components();
            let name: Vec<_> = name.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
            found.push((name.join("/"), std::fs::read_to_string(&path).expect("text")));
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shaders");
    let mut on_disk = Vec::new();
    walk(&root, &root, &mut on_disk);
    on_disk.sort();
    let mut listed: Vec<(String, String)> = octagloss_shaders::FILES
        .iter()
        .map(|(path, text)| ((*path).to_owned(), (*text).to_owned()))
        .collect();
    let readers = READERS.iter().map(|(name, text)| (format!("readers/{name}"), (*text).to_owned()));
    listed.extend(readers);
    listed.sort();
    let names = |files: &[(String, String)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&listed), names(&on_disk));
    assert!(listed == on_disk, "embedded texts must equal those on disk");
}

/// Names at module scope of `module` without our prefix.
fn foreign(module: &Module) -> Vec<String> {
    let names = (module.types.iter().map(|(_, ty)| &ty.name))
        .chain(module.constants.iter().map(|(_, constant)| &constant.name))
        .chain(module.overrides.iter().map(|(_, constant)| &constant.name))
        .chain(module.global_variables.iter().map(|(_, variable)| &variable.name))
        .chain(module.functions.iter().map(|(_, function)| &function.name));
    let is_ours = |name: &&String| name.starts_with("octagloss_") || name.starts_with("Octagloss");
    names.flatten().filter(|name| !is_ours(name)).cloned().collect()
}

#[test]
fn shaders_for_callers_have_only_names_with_our_prefix() {
    let radiance = [LiveEnvironment::wgsl(0), LiveProbes::wgsl(0)].map(|source| (source, 7));
    let reflections =
        [LiveEnvironment::reflect_wgsl(0), LiveProbes::reflect_wgsl(0)].map(|source| (source, 9));
    for (first, resources) in radiance.iter().chain(&reflections) {
        // One shader takes all three kinds.
        let all = first.clone() + &LiveEnvironment::draw_wgsl(1) + &ShadowMap::wgsl(2);
        let module = Shader::parse("a caller's shader", &all).module;
        assert_eq!(foreign(&module), [""; 0]);
        assert!(module.functions.len() > 15 && module.global_variables.len() == *resources);
    }
    // Without the prefix they are detected.
    let bare = Shader::parse("a stage", &octagloss_shaders::source("lamp.wgsl")).module;
    assert!(foreign(&bare).iter().any(|name| name == "Lamp"));
}
