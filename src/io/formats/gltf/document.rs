//! The JSON of a glTF file, limited to shapes, their movement and their colour.
//!
//! Every index in it is only a claim: [`at`] reports the invalid ones.

use crate::io::error::{Fault, Place};
use crate::io::options::ReadOptions;
use serde::Deserialize;
use std::collections::HashMap;

/// The object at `index` of `list`.
pub(super) fn at<'a, T>(list: &'a [T], index: usize, what: &str) -> Result<&'a T, Fault> {
    list.get(index).ok_or_else(|| {
        Fault::entry(
            what,
            index,
            format!("the file refers to it, but there are {}: it is damaged", list.len()),
        )
    })
}

macro_rules! objects {
    ($($(#[$doc:meta])* $name:ident { $($(#[$about:meta])* $field:ident: $type:ty),* $(,)? })*) => {
        $(
            $(#[$doc])*
            #[derive(Debug, Default, Deserialize)]
            #[serde(rename_all = "camelCase", default)]
            pub(super) struct $name {
                $($(#[$about])* pub(super) $field: $type,)*
            }
        )*
    };
}

objects! {
    /// The whole.
    Document {
        accessors: Vec<Accessor>,
        animations: Vec<Animation>,
        buffers: Vec<Buffer>,
        buffer_views: Vec<BufferView>,
        extensions_required: Vec<String>,
        images: Vec<Image>,
        materials: Vec<Material>,
        meshes: Vec<Mesh>,
        nodes: Vec<Node>,
        scene: Option<usize>,
        scenes: Vec<Scene>,
        skins: Vec<Skin>,
        textures: Vec<Texture>,
    }
    /// Numbers in a view.
    Accessor {
        buffer_view: Option<usize>,
        byte_offset: usize,
        component_type: u32,
        normalized: bool,
        count: usize,
        r#type: String,
        sparse: Option<Sparse>,
    }
    /// Entries that differ from those in the view.
    Sparse { count: usize, indices: SparsePart, values: SparsePart }
    /// Indices or values of the sparse entries.
    SparsePart { buffer_view: usize, byte_offset: usize, component_type: u32 }
    /// Movements that belong together.
    Animation { channels: Vec<Channel>, samplers: Vec<Sampler> }
    /// Animation channel: connects a sampler to the property it animates.
    Channel { sampler: usize, target: Target }
    /// A property of a node.
    Target { node: Option<usize>, path: String }
    /// Values at times.
    Sampler { input: usize, output: usize, interpolation: Option<String> }
    /// Bytes.
    Buffer { uri: Option<String>, byte_length: usize }
    /// A range of a buffer.
    BufferView {
        buffer: usize,
        byte_offset: usize,
        byte_length: usize,
        byte_stride: Option<usize>,
        extensions: HashMap<String, serde_json::Value>,
    }
    /// An image.
    Image { uri: Option<String>, buffer_view: Option<usize> }
    /// Material: the appearance of a surface.
    Material { pbr_metallic_roughness: Pbr }
    /// The colour of a surface.
    Pbr { base_color_factor: Option<[f32; 4]>, base_color_texture: Option<TextureUse> }
    /// A texture and which coordinates it is looked up with.
    TextureUse { index: usize, tex_coord: usize, extensions: TextureExtensions }
    /// Texture extensions; only the transform is used.
    TextureExtensions {
        #[serde(rename = "KHR_texture_transform")]
        transform: Option<TextureTransform>
    }
    /// Changes texture coordinates.
    TextureTransform { offset: [f32; 2], rotation: f32, scale: Option<[f32; 2]>, tex_coord: Option<usize> }
    /// An image, repeated.
    Texture { source: Option<usize> }
    /// Shapes.
    Mesh { primitives: Vec<Primitive>, weights: Vec<f32> }
    /// A shape of one material.
    Primitive {
        attributes: HashMap<String, usize>,
        indices: Option<usize>,
        material: Option<usize>,
        mode: Option<u32>,
        targets: Vec<HashMap<String, usize>>,
        extensions: HashMap<String, serde_json::Value>,
    }
    /// A thing in a place.
    Node {
        children: Vec<usize>,
        matrix: Option<[f64; 16]>,
        mesh: Option<usize>,
        skin: Option<usize>,
        translation: Option<[f64; 3]>,
        rotation: Option<[f64; 4]>,
        scale: Option<[f64; 3]>,
        weights: Vec<f32>,
    }
    /// Scene: the nodes that are shown.
    Scene { nodes: Vec<usize> }
    /// Bones.
    Skin { inverse_bind_matrices: Option<usize>, joints: Vec<usize> }
}

const MAGIC: &[u8] = b"glTF";
const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// The document, and the bytes of a GLB file that its first buffer has.
pub(super) fn parse<'a>(bytes: &'a [u8], options: &ReadOptions) -> Result<(Document, Option<&'a [u8]>), Fault> {
    /// At most so much memory is taken by an object, which may be two letters in the file, and by an entry of a list.
    const OBJECT_BYTES: u64 = 1024;
    const ENTRY_BYTES: u64 = 64;
    const PACKED: [&str; 3] = [
        "KHR_draco_mesh_compression",
        "EXT_meshopt_compression",
        "KHR_meshopt_compression",
    ];
    let (json, binary) = if bytes.starts_with(MAGIC) {
        chunks(bytes)?
    } else {
        (bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None)
    };
    let sum = |bytes: u64, sign: &u8| match sign {
        b'{' => bytes + OBJECT_BYTES,
        b',' => bytes + ENTRY_BYTES,
        _ => bytes,
    };
    let needed = json.iter().fold(json.len() as u64, sum);
    options.claim("the description of the scene", needed)?;
    let document: Document = serde_json::from_slice(json).map_err(|error| {
        Fault::new(
            Place::Line(error.line()),
            format!("the JSON is not understood ({error})"),
        )
    })?;
    if let Some(name) = document
        .extensions_required
        .iter()
        .find(|name| PACKED.contains(&name.as_str()))
    {
        return Err(packed(name));
    }
    Ok((document, binary))
}

/// Error for shapes with unsupported compression.
pub(super) fn packed(extension: &str) -> Fault {
    Fault::header(format!(
        "the shapes are compressed with {extension}, which is not read: save the file without compression, as with \
         `gltf-transform copy`"
    ))
}

fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    let word = |at: usize| {
        let word = bytes.get(at..at + 4)?;
        Some(u32::from_le_bytes([word[0], word[1], word[2], word[3]]) as usize)
    };
    if word(4) != Some(2) {
        return Err(Fault::header(
            "the container is not of version 2, which is the one that is read",
        ));
    }
    let mut found = Vec::new();
    let mut at = HEADER_BYTES;
    while found.len() < 2
        && let Some(length) = word(at)
    {
        let start = at + CHUNK_HEADER_BYTES;
        let chunk = start.checked_add(length).and_then(|end| bytes.get(start..end));
        let chunk = chunk.ok_or_else(|| {
            Fault::new(
                Place::Byte(at),
                format!("a chunk of {length} bytes goes beyond the end of the file: it is truncated"),
            )
        })?;
        found.push(chunk);
        at = start + length;
    }
    match found[..] {
        [json] => Ok((json, None)),
        [json, binary, ..] => Ok((json, Some(binary))),
        [] => Err(Fault::header("the file ends before its first chunk: it is truncated")),
    }
}
