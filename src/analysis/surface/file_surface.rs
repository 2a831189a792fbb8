//! The surface of a cloud as its file has it: in the order of the file, with holes.

use crate::analysis::{Surface, SurfaceOptions, estimate_surface_observed};
use crate::cloud::{CloudError, Frame, RawCloud};
use crate::progress::Progress;

/// The surface around each point, in the order of the file; zeros where a point is none.
#[derive(Debug, Clone, PartialEq)]
pub struct FileSurface {
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Splat radii, scene units.
    pub radii: Vec<f32>,
}

impl FileSurface {
    /// Estimates the surface around the points of `cloud` as [`estimate_surface`](crate::analysis::estimate_surface)
    /// does; `None` for a cloud without points.
    ///
    /// # Errors
    /// Points that cannot become a frame.
    pub fn of(cloud: &RawCloud, options: SurfaceOptions) -> Result<Option<Self>, CloudError> {
        let (_, Some((min, max))) = cloud.positions.finite_bounds() else {
            return Ok(None);
        };
        let positions = RawCloud {
            sensor: cloud.sensor,
            ..RawCloud::from_positions(cloud.positions.clone())
        };
        let frame = Frame::from_raw(positions, min * 0.5 + max * 0.5)?;
        let never = Progress::default();
        let surface = estimate_surface_observed(frame.positions(), frame.sensor(), options, &never);
        let Surface { normals, radii, .. } = surface;
        let mut surface = Self {
            normals: vec![[0.0; 3]; cloud.positions.len()],
            radii: vec![0.0; cloud.positions.len()],
        };
        for (place, &index) in frame.file_index().iter().enumerate() {
            surface.normals[index as usize] = normals[place].to_array();
            surface.radii[index as usize] = radii[place];
        }
        Ok(Some(surface))
    }
}
