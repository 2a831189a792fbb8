//! One frame of a sequence: the decoder's output, the validated frame, and the records a renderer draws.

mod attributes;
mod cell_scalars;
mod cells;
pub(crate) mod codes;
mod drawable;
mod dropped;
mod ellipse;
mod error;
mod frame;
mod image_grid;
mod made_from;
mod mesh;
mod mesh_records;
mod no_data;
mod quantised_normal;
mod raw;
mod record;
mod sample;
mod scalar_field;
mod space;
mod textures;
mod texturing;
mod unit;
mod value_sample;

pub use attributes::Attributes;
pub(crate) use attributes::usable_radii;
pub use cells::{Cells, TooManyCells};
pub use dropped::Dropped;
pub(crate) use ellipse::ELLIPSE_STEPS;
pub use ellipse::{Ellipse, decode_ellipse, encode_ellipse};
pub use error::CloudError;
pub use frame::Frame;
pub use image_grid::ImageGrid;
pub use made_from::MadeFrom;
pub use mesh::Mesh;
pub use mesh_records::MeshRecords;
pub(crate) use no_data::make_holes;
pub use no_data::{FoundIn, MissingPoints, MissingValue, NoData};
pub use quantised_normal::{
    FINEST_NORMAL_BITS, coarser_normal, largest_normal_error, quantise_direction, quantise_normal,
    quantised_directions, quantised_normals,
};
pub use raw::{AxisConvention, ColorDepth, Positions, RawCloud};
pub use record::{PointRecord, ShapeRecord, TriangleRecord, VertexRecord, VoxelRecord, oct_decode, oct_encode};
pub(crate) use sample::{even_places, radius_factor};
pub use scalar_field::ScalarField;
pub use space::Space;
pub use textures::{TexturePlace, Textures};
pub use texturing::Texturing;
pub use unit::LengthUnit;
pub(crate) use value_sample::MAX_SAMPLE;
pub use value_sample::{ValueKind, ValueSample};
