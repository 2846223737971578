//! Shaders as their compiler reads them: layouts, constants, bindings and sizes equal Rust's, and baseline
//! WebGPU holds them.

use super::entry_points::ENTRY_POINTS;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Expression, Handle, ImageClass, Literal, Module, Type, TypeInner};
use octagloss::cpu::leaves::LANES;
use octagloss::environment::LUMINANCE;
use octagloss::gpu::device::shader;
use octagloss::gpu::device::shader::Queries;
use octagloss::gpu::{
    adaptive, blur, box_filter, cells, copy, emitters, fitted, fixed_point, harmonics, lamp,
};
use octagloss::gpu::{mirror, oem, reparameterise, sat_f32, sat_hensley, sat_scan};
use octagloss::realtime::emitters::{COUNT, GRID};
use octagloss::realtime::tables::{KNOTS, OCTAVES, triangle};
use octagloss::target::READERS;
use std::collections::BTreeMap;
use std::path::Path;

/// A shader, parsed and validated with nothing but what every WebGPU has.
struct Shader {
    module: Module,
    info: ModuleInfo,
}

impl Shader {
    fn parse(name: &str, source: &str) -> Self {
        let module = naga::front::wgsl::parse_str(source)
            .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
        // Halves in 32-bit words are of WGSL's core; the compiler counts them apart for older APIs.
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

    /// Names and offsets of a struct's members, padding apart, and its size.
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

    /// The numbers of a named constant.
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

/// Files with entry points, which stand on their own.
fn files() -> impl Iterator<Item = &'static str> {
    // What includes common/sat.wgsl declares the table first; nothing but functions is in common/.
    shader::FILES.iter().map(|(path, _)| *path).filter(|path| !path.starts_with("common/"))
}

/// Those of the compute stages.
fn stages() -> impl Iterator<Item = &'static str> {
    files().filter(|path| !path.starts_with("view/"))
}

/// The first member that is elsewhere, or the size that is another.
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

/// A struct of a shader: its file, its name there, and Rust's members and size.
type Struct = (&'static str, &'static str, &'static [(&'static str, usize)], usize);

fn structs() -> Vec<Struct> {
    let table = (oem::Table::MEMBERS, size_of::<oem::Table>());
    vec![
        ("adaptive.wgsl", "Lobe", adaptive::Lobe::MEMBERS, size_of::<adaptive::Lobe>()),
        ("adaptive.wgsl", "Packet", adaptive::Packet::MEMBERS, size_of::<adaptive::Packet>()),
        ("cells.wgsl", "Level", cells::Level::MEMBERS, size_of::<cells::Level>()),
        ("cells.wgsl", "Tent", cells::Tent::MEMBERS, size_of::<cells::Tent>()),
        ("cells.wgsl", "Table", table.0, table.1),
        (
            "blur.wgsl",
            "OctaglossOctave",
            octagloss::gpu::octaves::Octave::MEMBERS,
            size_of::<octagloss::gpu::octaves::Octave>(),
        ),
        ("blur.wgsl", "OctaglossOctaves", fitted::Octaves::MEMBERS, size_of::<fitted::Octaves>()),
        ("blur.wgsl", "Table", table.0, table.1),
        ("fitted.wgsl", "OctaglossOctaves", fitted::Octaves::MEMBERS, size_of::<fitted::Octaves>()),
        ("fixed_point.wgsl", "Table", table.0, table.1),
        ("harmonics.wgsl", "Table", table.0, table.1),
        ("lamp.wgsl", "Lamp", lamp::Lamp::MEMBERS, size_of::<lamp::Lamp>()),
        ("lamp.wgsl", "Table", table.0, table.1),
        ("least.wgsl", "Table", table.0, table.1),
        ("mirror.wgsl", "Table", table.0, table.1),
        ("pack.wgsl", "Table", table.0, table.1),
        (
            "reparameterise.wgsl",
            "Gather",
            reparameterise::Gather::MEMBERS,
            size_of::<reparameterise::Gather>(),
        ),
        ("sat_hensley.wgsl", "Doubling", sat_hensley::Doubling::MEMBERS, size_of::<sat_hensley::Doubling>()),
        ("sat_scan.wgsl", "Scan", sat_scan::Scan::MEMBERS, size_of::<sat_scan::Scan>()),
        // Four exponents, then the sizes, in a header of 32 bytes; sums as four low and four high words; four
        // greatest patterns and four 64-bit sums.
        ("box_filter.wgsl", "OctaglossTable", &[("exponents", 0), ("inner", 16), ("border", 20)], 32),
        ("box_filter.wgsl", "Sum", &[("low", 0), ("high", 16)], 32),
        ("emitters.wgsl", "Table", table.0, table.1),
        ("fitted.wgsl", "OctaglossEmitter", fitted::EmitterWords::MEMBERS, size_of::<fitted::EmitterWords>()),
        // Least radiance, two vectors of units, 25 harmonics, emitters.
        (
            "harmonics.wgsl",
            "OctaglossLight",
            &[("least", 0), ("scale", 16), ("harmonics", 48), ("emitters", 448)],
            fitted::LIGHT as usize,
        ),
        ("blur.wgsl", "Sum", &[("low", 0), ("high", 16)], 32),
        ("fixed_point.wgsl", "Partial", &[("greatest", 0), ("sums", 16)], 48),
    ]
}

#[test]
fn structs_lie_as_rust_writes_them() {
    for (file, name, members, size) in structs() {
        assert_eq!(layout_difference(&Shader::of_file(file), name, members, size), None, "{file}");
    }
    // One member too early, one renamed, one padded away.
    let seen = |from: &str, to: &str| {
        let source = shader::source("sat_scan.wgsl");
        assert!(source.contains(from), "{from} is in the source");
        let wrong = Shader::parse("a wrong scan", &source.replace(from, to));
        let size = size_of::<sat_scan::Scan>();
        layout_difference(&wrong, "Scan", sat_scan::Scan::MEMBERS, size).is_some()
    };
    assert!(!seen("// Tiles along an edge.", "// Tiles."), "a comment changes nothing");
    assert!(seen("    side: u32,\n    pitch: u32,", "    pitch: u32,\n    side: u32,"), "swapped members");
    assert!(seen("    tiles: u32,\n", "    @align(16) tiles: u32,\n"), "a member moved");
    assert!(seen("    channel: u32,\n", "    channel: u32,\n    more: u32,\n"), "a member more");
}

/// Constants that a shader shares with Rust.
fn constants() -> Vec<(&'static str, &'static str, Vec<f64>)> {
    let one = |value: u32| vec![f64::from(value)];
    vec![
        ("adaptive.wgsl", "LANES", one(LANES as u32)),
        ("adaptive.wgsl", "GROUP_SIZE", one(adaptive::GROUP_SIZE)),
        ("adaptive.wgsl", "LEVELS", one(adaptive::LEVELS as u32)),
        ("adaptive.wgsl", "QUAD_FIELDS", one(15)),
        ("adaptive.wgsl", "LUMINANCE", LUMINANCE.map(f64::from).to_vec()),
        ("box_filter.wgsl", "GROUP_SIZE", one(box_filter::GROUP_SIZE)),
        ("blur.wgsl", "EDGE", one(octagloss::gpu::octaves::EDGE)),
        ("blur.wgsl", "GROUP_SIZE", one(blur::GROUP_SIZE)),
        ("blur.wgsl", "LINE_SIZE", one(blur::LINE_SIZE)),
        ("blur.wgsl", "REACH", one(blur::REACH)),
        ("cells.wgsl", "EDGE", one(cells::EDGE)),
        ("cells.wgsl", "QUAD_FIELDS", one(15)),
        ("copy.wgsl", "GROUP_SIZE", one(copy::GROUP_SIZE)),
        ("emitters.wgsl", "BATCH", one(emitters::BATCH)),
        ("emitters.wgsl", "EDGE", one(emitters::EDGE)),
        ("emitters.wgsl", "GRID", one(GRID)),
        ("emitters.wgsl", "GROUP_SIZE", one(emitters::GROUP_SIZE)),
        ("emitters.wgsl", "KEPT", one(emitters::KEPT)),
        ("fitted.wgsl", "EMITTERS", one(COUNT as u32)),
        ("fitted.wgsl", "FIRST_OCTAVE", one(*OCTAVES.start())),
        ("fitted.wgsl", "GROUP_SIZE", one(fitted::GROUP_SIZE)),
        ("fitted.wgsl", "INTERVALS", one(triangle::INTERVALS as u32)),
        ("fitted.wgsl", "KNOTS", one(KNOTS.len() as u32)),
        ("fitted.wgsl", "NODES", one(triangle::NODES as u32)),
        ("fixed_point.wgsl", "GROUPS", one(fixed_point::GROUPS)),
        ("fixed_point.wgsl", "GROUP_SIZE", one(fixed_point::GROUP_SIZE)),
        ("fixed_point.wgsl", "TEXELS", one(fixed_point::TEXELS)),
        ("harmonics.wgsl", "BATCHES", one(harmonics::BATCHES)),
        ("harmonics.wgsl", "FINEST", one(harmonics::FINEST)),
        ("harmonics.wgsl", "GROUP_SIZE", one(harmonics::GROUP_SIZE)),
        ("lamp.wgsl", "EDGE", one(lamp::EDGE)),
        ("lamp.wgsl", "PLACES", one(lamp::PLACES)),
        ("least.wgsl", "GROUPS", one(fixed_point::GROUPS)),
        ("least.wgsl", "GROUP_SIZE", one(fixed_point::GROUP_SIZE)),
        ("least.wgsl", "TEXELS", one(fixed_point::TEXELS)),
        ("mirror.wgsl", "EDGE", one(mirror::EDGE)),
        ("pack.wgsl", "EDGE", one(box_filter::EDGE)),
        ("reparameterise.wgsl", "EDGE", one(reparameterise::EDGE)),
        ("reparameterise.wgsl", "GROUP_SIZE", one(reparameterise::GROUP_SIZE)),
        ("sat_f32.wgsl", "EDGE", one(sat_f32::EDGE)),
        ("sat_f32.wgsl", "GROUPS", one(sat_f32::GROUPS)),
        ("sat_scan.wgsl", "TILE", one(sat_scan::TILE)),
        ("sat_scan.wgsl", "GROUP_SIZE", one(sat_scan::GROUP_SIZE)),
    ]
}

#[test]
fn constants_are_rust_s() {
    for (file, name, expected) in constants() {
        assert_eq!(Shader::of_file(file).constant(name), Some(expected), "{name} of {file}");
    }
    let source = shader::source("sat_scan.wgsl").replace("const TILE = 64u;", "const TILE = 32u;");
    assert_eq!(Shader::parse("smaller tiles", &source).constant("TILE"), Some(vec![32.0]), "read, not known");
}

/// What one entry point uses.
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
                    other => panic!("{:?} in {other:?}", global.name),
                };
                let binding = global.binding.expect("a resource's binding");
                let name = global.name.as_deref().expect("a name");
                let taken = bindings.insert(100 * binding.group + binding.binding, format!("{kind} {name}"));
                assert_eq!(taken, None, "one resource a binding, {handle:?}");
            }
            (entry.name.clone(), Uses { workgroup_size: entry.workgroup_size, bindings, workgroup_bytes })
        };
        module.entry_points.iter().enumerate().map(uses).collect()
    }
}

#[test]
fn entry_points_take_what_rust_binds() {
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

/// What of `uses` is beyond the baseline.
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

#[test]
fn the_viewer_s_shaders_are_baseline_s() {
    for (file, fragments) in [("box", 8), ("fitted", 6), ("levels", 6), ("truth", 6), ("present", 1)] {
        let file = format!("view/{file}.wgsl");
        assert!(files().any(|path| path == file), "{file} is listed");
        // What is parsed is validated with nothing but what every WebGPU has.
        let shader = Shader::of_file(&file);
        let stage = |entry: &&naga::EntryPoint| entry.stage == naga::ShaderStage::Fragment;
        assert_eq!(shader.module.entry_points.iter().filter(stage).count(), fragments, "{file}");
    }
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
    assert!(listed == on_disk, "texts are those on disk");
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
            (301, "uniform octagloss_light"),
            (302, "read octagloss_entries"),
            (303, "read octagloss_parameters"),
            (304, "texture octagloss_oem"),
        ];
        assert_eq!(found, expected);
    }
    assert!(naga::front::wgsl::parse_str(&ask(&[boxes])).is_err(), "what is not asked for is not there");
    assert_eq!(fitted::wgsl(2), shader::queries(&[Queries::Fitted(2)]));
}
