//! Draco: compressed point clouds and meshes, by the crate `draco-core`.
//!
//! The crate limits the unpacked size of a file, and refuses memory that a file merely claims; a panic within it
//! becomes an error.

use crate::cloud::{Positions, RawCloud, ScalarField};
use crate::io::columns::column::{Column, Scalar, Values};
use crate::io::columns::unique_names::UniqueNames;
use crate::io::columns::{arrays, attributes};
use crate::io::error::{Fault, Place};
use crate::io::format::{Format, Magic, Traits};
use crate::io::options::ReadOptions;
use draco_core::{
    DataType, DecodeLimits, DecoderBuffer, GeometryAttributeType, Mesh, MeshDecoder, PointAttribute, PointIndex,
};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Draco.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "Draco",
    extensions: &["drc"],
    magic: &[Magic::start(b"DRACO")],
    ..Traits::PLAIN
});

pub(in crate::io) fn decode(bytes: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    /// Memory of a point and a face in bytes: in the cloud, and in addition to it while it is read.
    const POINT_BYTES: u64 = 64;
    const FACE_BYTES: u64 = 64;
    let limits = DecodeLimits::default()
        .with_max_points((options.left_bytes() / POINT_BYTES).min(u64::from(u32::MAX)))
        .with_max_faces(options.left_bytes() / FACE_BYTES)
        .with_max_decoded_bytes(options.left_bytes() / 2);
    let unpack = || {
        let mut mesh = Mesh::new();
        let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
        MeshDecoder::new().decode(&mut buffer, &mut mesh).map_err(|error| {
            Fault::new(
                Place::Byte(buffer.position()),
                format!("{error}: the file is damaged or truncated, or needs a higher --max-memory"),
            )
        })?;
        cloud(&mesh)
    };
    catch_unwind(AssertUnwindSafe(unpack)).unwrap_or_else(|_| Err(Fault::header("the compressed data are damaged")))
}

fn cloud(mesh: &Mesh) -> Result<RawCloud, Fault> {
    let count = mesh.num_points();
    let attribute = |kind| mesh.named_attribute(kind);
    let positions = attribute(GeometryAttributeType::Position)
        .filter(|positions| positions.num_components() == 3)
        .ok_or_else(|| Fault::header("the points have no positions of three numbers"))?;
    let coordinates = columns(positions, count)?;
    let coordinates = coordinates.each_ref();
    let is_wide = !matches!(positions.data_type(), DataType::Float32);
    let mut cloud = RawCloud::from_positions(if is_wide {
        Positions::F64(arrays::vectors_f64(coordinates, count))
    } else {
        Positions::F32(arrays::vectors_f32(coordinates, count))
    });
    if let Some(normals) = attribute(GeometryAttributeType::Normal)
        && normals.num_components() == 3
    {
        cloud.attributes.normals = Some(arrays::vectors_f32(columns(normals, count)?.each_ref(), count));
    }
    if let Some(colors) = attribute(GeometryAttributeType::Color)
        && (3..=4).contains(&colors.num_components())
    {
        let alpha = (colors.num_components() == 4)
            .then(|| column(colors, 3, count))
            .transpose()?;
        let channels = columns(colors, count)?;
        arrays::set_colors(&mut cloud, channels.each_ref(), alpha.as_ref(), count);
    }
    add_fields(mesh, count, &mut cloud)?;
    let faces = mesh.faces().iter().map(|face| face.map(|point| point.0));
    cloud.faces = faces.collect();
    if cloud.faces.iter().flatten().any(|&point| point as usize >= count) {
        return Err(Fault::header("a face refers to a point that is not there"));
    }
    Ok(cloud)
}

/// Makes a scalar field of each number of the attributes without another place in a cloud.
fn add_fields(mesh: &Mesh, count: usize, cloud: &mut RawCloud) -> Result<(), Fault> {
    let mut names = UniqueNames::default();
    for index in 0..mesh.num_attributes() {
        let attribute = mesh.attribute(index);
        let kind = attribute.attribute_type();
        let is_first = mesh.named_attribute_id(kind) == index;
        let is_taken = match kind {
            GeometryAttributeType::Position => is_first,
            GeometryAttributeType::Normal => is_first && cloud.attributes.normals.is_some(),
            GeometryAttributeType::Color => is_first && cloud.attributes.colors.is_some(),
            GeometryAttributeType::TexCoord | GeometryAttributeType::Generic => false,
            GeometryAttributeType::Invalid => true,
        };
        if is_taken {
            continue;
        }
        let name = attribute_name(mesh, attribute, index);
        let numbers = usize::from(attribute.num_components());
        for component in 0..numbers {
            let name = match numbers {
                1 => name.clone(),
                _ => format!("{name}_{component}"),
            };
            let Column {
                values: Values::Parsed(values),
                ..
            } = column(attribute, component, count)?
            else {
                continue;
            };
            let name = names.take(&name, attributes::plain_scalar_name);
            cloud.attributes.scalars.push(ScalarField::from_f64(name, &values));
        }
    }
    attributes::sort_fields(&mut cloud.attributes.scalars);
    Ok(())
}

/// The name that the file has for an attribute, or its kind and place.
fn attribute_name(mesh: &Mesh, attribute: &PointAttribute, index: i32) -> String {
    /// Entries of metadata that are names, as the encoders of Draco and of glTF write them.
    const NAMES: [&str; 3] = ["name", "attribute_name", "NAME"];
    let metadata = mesh.attribute_metadata_by_unique_id(attribute.unique_id());
    let named = NAMES.iter().find_map(|key| metadata?.metadata().get_string(key));
    let named = named
        .map(|name| name.trim_end_matches('\0').trim())
        .filter(|name| !name.is_empty());
    let kind = match attribute.attribute_type() {
        GeometryAttributeType::Position => "position",
        GeometryAttributeType::Normal => "normal",
        GeometryAttributeType::Color => "color",
        GeometryAttributeType::TexCoord => "tex_coord",
        GeometryAttributeType::Generic | GeometryAttributeType::Invalid => "generic",
    };
    named.map_or_else(|| format!("{kind}_{index}"), str::to_owned)
}

fn columns(attribute: &PointAttribute, count: usize) -> Result<[Column<'static>; 3], Fault> {
    Ok([
        column(attribute, 0, count)?,
        column(attribute, 1, count)?,
        column(attribute, 2, count)?,
    ])
}

/// One component of an attribute for every point; several points may share a value.
fn column(attribute: &PointAttribute, component: usize, count: usize) -> Result<Column<'static>, Fault> {
    let wrong = || Fault::header("the values of an attribute are not all there");
    let scalar = match attribute.data_type() {
        DataType::Int8 => Scalar::I8,
        DataType::Uint8 | DataType::Bool => Scalar::U8,
        DataType::Int16 => Scalar::I16,
        DataType::Uint16 => Scalar::U16,
        DataType::Int32 => Scalar::I32,
        DataType::Uint32 => Scalar::U32,
        DataType::Int64 => Scalar::I64,
        DataType::Uint64 => Scalar::U64,
        DataType::Float32 => Scalar::F32,
        DataType::Float64 => Scalar::F64,
        DataType::Invalid => return Err(wrong()),
    };
    let step = usize::try_from(attribute.byte_stride()).map_err(|_| wrong())?;
    let bytes = attribute.buffer().data();
    let values = (0..count)
        .map(|point| {
            let value = attribute.mapped_index(PointIndex(point as u32)).0 as usize;
            let start = value.checked_mul(step)? + component * scalar.byte_size();
            let raw = bytes.get(start..start + scalar.byte_size())?;
            Some(scalar.read(raw, false))
        })
        .collect::<Option<Vec<f64>>>()
        .ok_or_else(wrong)?;
    Ok(Column {
        name: String::new(),
        scalar,
        values: Values::Parsed(values),
    })
}
