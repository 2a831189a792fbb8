//! One entry point in SPIR-V, in the Metal Shading Language and in HLSL, by naga with the options of wgpu.

use super::back_ends::EntryPoint;
use naga::back::{hlsl, msl, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::{AddressSpace, Module, ResourceBinding, StorageAccess, TypeInner};
use std::collections::BTreeMap;

/// Checks that wgpu requests where a driver has none.
const BOUNDS: BoundsCheckPolicies = BoundsCheckPolicies {
    index: BoundsCheckPolicy::Restrict,
    buffer: BoundsCheckPolicy::Restrict,
    image_load: BoundsCheckPolicy::Restrict,
    binding_array: BoundsCheckPolicy::Unchecked,
};

/// Capabilities that wgpu lets SPIR-V use on every Vulkan device.
const CAPABILITIES: [spv::Capability; 7] = [
    spv::Capability::Shader,
    spv::Capability::Matrix,
    spv::Capability::Sampled1D,
    spv::Capability::Image1D,
    spv::Capability::ImageQuery,
    spv::Capability::DerivativeControl,
    spv::Capability::StorageImageExtendedFormats,
];

/// The bindings, as far as registers depend on them.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Uniform,
    ReadOnlyStorage,
    Storage,
    Texture,
}

fn bindings(module: &Module) -> BTreeMap<ResourceBinding, Kind> {
    let bound = module.global_variables.iter();
    let bound = bound.filter_map(|(_, global)| Some((global.binding?, global)));
    let with_kind = bound.map(|(binding, global)| {
        let kind = match (global.space, &module.types[global.ty].inner) {
            (AddressSpace::Uniform, _) => Kind::Uniform,
            (AddressSpace::Storage { access }, _) if access.contains(StorageAccess::STORE) => Kind::Storage,
            (AddressSpace::Storage { .. }, _) => Kind::ReadOnlyStorage,
            (AddressSpace::Handle, TypeInner::Image { .. }) => Kind::Texture,
            (space, ty) => panic!("{binding:?} is {ty:?} in {space:?}: say here how it is bound"),
        };
        (binding, kind)
    });
    with_kind.collect()
}

/// All bindings in order, numbered from 0 within each of up to three sets of registers, and the number in each set.
fn numbered<T>(
    module: &Module,
    set: impl Fn(Kind) -> usize,
    target: impl Fn(Kind, u8) -> T,
) -> (BTreeMap<ResourceBinding, T>, [u8; 3]) {
    let mut counts = [0; 3];
    let mut targets = BTreeMap::new();
    for (binding, kind) in bindings(module) {
        let count = &mut counts[set(kind)];
        targets.insert(binding, target(kind, *count));
        *count += 1;
    }
    (targets, counts)
}

pub(super) fn write_spirv(entry: &EntryPoint<'_>, version: (u8, u8)) -> Result<(), String> {
    let binding_map = bindings(entry.whole).into_keys().map(|binding| {
        let info = spv::BindingInfo {
            descriptor_set: binding.group,
            binding: binding.binding,
            binding_array_size: None,
        };
        (binding, info)
    });
    let options = spv::Options {
        lang_version: version,
        binding_map: binding_map.collect(),
        fake_missing_bindings: false,
        capabilities: Some(CAPABILITIES.into_iter().collect()),
        bounds_check_policies: BOUNDS,
        ..spv::Options::default()
    };
    let pipeline = spv::PipelineOptions {
        shader_stage: entry.stage,
        entry_point: entry.name.to_owned(),
    };
    let words = spv::write_vec(entry.module, entry.info, &options, Some(&pipeline));
    let found = spirv_entry_points(&words.map_err(|error| error.to_string())?)?;
    if found == [entry.name] {
        Ok(())
    } else {
        Err(format!("has the entry points {found:?}"))
    }
}

/// Names of the entry points of a SPIR-V module (specification, section 2.3).
fn spirv_entry_points(words: &[u32]) -> Result<Vec<String>, String> {
    const MAGIC: u32 = 0x0723_0203;
    const HEADER_WORDS: usize = 5;
    const OP_ENTRY_POINT: u32 = 15;
    // The opcode, the stage and the function precede the name.
    const NAME_AT: usize = 3;
    if words.first() != Some(&MAGIC) {
        return Err(format!("begins with {:08x?}", words.first()));
    }
    let mut rest = words.get(HEADER_WORDS..).ok_or("half a header")?;
    let mut names = Vec::new();
    while let Some(&first) = rest.first() {
        let length = (first >> 16) as usize;
        let instruction = rest.get(..length).filter(|words| !words.is_empty());
        let instruction = instruction.ok_or("an instruction of a wrong length")?;
        if first & 0xffff == OP_ENTRY_POINT {
            let bytes = instruction.iter().skip(NAME_AT);
            let bytes = bytes.flat_map(|word| word.to_le_bytes());
            let name = bytes.take_while(|&byte| byte != 0).map(char::from);
            names.push(name.collect());
        }
        rest = &rest[length..];
    }
    Ok(names)
}

pub(super) fn write_msl(entry: &EntryPoint<'_>, version: (u8, u8)) -> Result<(), String> {
    let set = |kind| usize::from(kind == Kind::Texture);
    let (resources, [buffers, ..]) = numbered(entry.whole, set, |kind, slot| msl::BindTarget {
        buffer: (kind != Kind::Texture).then_some(slot),
        texture: (kind == Kind::Texture).then_some(slot),
        mutable: kind == Kind::Storage,
        ..msl::BindTarget::default()
    });
    let resources = msl::EntryPointResources {
        resources,
        sizes_buffer: Some(buffers),
        ..msl::EntryPointResources::default()
    };
    let options = msl::Options {
        lang_version: version,
        per_entry_point_map: [(entry.name.to_owned(), resources)].into(),
        fake_missing_bindings: false,
        bounds_check_policies: BOUNDS,
        ..msl::Options::default()
    };
    let pipeline = msl::PipelineOptions {
        entry_point: Some((entry.stage, entry.name.to_owned())),
        ..msl::PipelineOptions::default()
    };
    let (text, info) =
        msl::write_string(entry.module, entry.info, &options, &pipeline).map_err(|error| error.to_string())?;
    has_entry_point(&text, &info.entry_point_names)
}

pub(super) fn write_hlsl(entry: &EntryPoint<'_>, model: hlsl::ShaderModel) -> Result<(), String> {
    // Constant buffers, read-only and read-write resources: registers b, t and u.
    let set = |kind| match kind {
        Kind::Uniform => 0,
        Kind::ReadOnlyStorage | Kind::Texture => 1,
        Kind::Storage => 2,
    };
    let register = |register: u8| hlsl::BindTarget {
        register: register.into(),
        ..hlsl::BindTarget::default()
    };
    let (binding_map, [constant_buffers, ..]) = numbered(entry.whole, set, |kind, number| hlsl::BindTarget {
        restrict_indexing: kind == Kind::Uniform,
        ..register(number)
    });
    let options = hlsl::Options {
        shader_model: model,
        binding_map,
        fake_missing_bindings: false,
        special_constants_binding: Some(register(constant_buffers)),
        ..hlsl::Options::default()
    };
    let pipeline = hlsl::PipelineOptions {
        entry_point: Some((entry.stage, entry.name.to_owned())),
    };
    let mut text = String::new();
    let info = hlsl::Writer::new(&mut text, &options, &pipeline)
        .write(entry.module, entry.info, entry.fragment.as_ref())
        .map_err(|error| error.to_string())?;
    has_entry_point(&text, &info.entry_point_names)
}

/// Returns true if there is a function of the one name that naga gave the entry point (`vertex` is a word of Metal).
/// Nothing calls it.
fn has_entry_point<E: ToString>(text: &str, names: &[Result<String, E>]) -> Result<(), String> {
    let [name] = names else {
        return Err(format!("has {} entry points", names.len()));
    };
    let name = name.as_ref().map_err(ToString::to_string)?;
    if text.contains(&format!(" {name}(")) {
        Ok(())
    } else {
        Err(format!("has no function {name}:\n{text}"))
    }
}
