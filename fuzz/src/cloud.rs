//! What readers hand over.

#[path = "../../src/cloud/attributes.rs"]
mod attributes;
#[path = "../../src/cloud/ellipse.rs"]
mod ellipse;
#[path = "../../src/cloud/image_grid.rs"]
mod image_grid;
#[path = "../../src/cloud/quantised_normal.rs"]
mod quantised_normal;
#[path = "../../src/cloud/raw.rs"]
mod raw;
#[path = "../../src/cloud/record.rs"]
mod record;
#[path = "../../src/cloud/sample.rs"]
mod sample;
#[path = "../../src/cloud/scalar_field.rs"]
mod scalar_field;
#[path = "../../src/cloud/textures.rs"]
mod textures;
#[path = "../../src/cloud/texturing.rs"]
mod texturing;
#[path = "../../src/cloud/unit.rs"]
mod unit;

pub use attributes::Attributes;
pub use ellipse::Ellipse;
pub use image_grid::ImageGrid;
pub use quantised_normal::*;
pub use raw::*;
pub(crate) use sample::even_places;
pub use scalar_field::ScalarField;
pub use textures::Textures;
pub use texturing::Texturing;
pub use unit::LengthUnit;
