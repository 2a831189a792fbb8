//! Input images as a renderer needs them: without distortion, scaled to their budget, with all their mip levels.

use super::texture::Texture;
use crate::cloud::{PointRecord, ShapeRecord};
use crate::photos::sets::photo::center_of;
use crate::rgbd::{Camera, DepthImage};
use glam::{DAffine3, DVec3, Vec3};
use std::sync::Arc;

/// Images of one scene for view-dependent texturing of its surface (Yang et al. 2006 §3). Immutable; shared by packets.
#[derive(Debug)]
pub struct PosedImages {
    all: Vec<Arc<PosedImage>>,
    neighbour_angle: f32,
    surface: Option<PhotoSurface>,
    is_by_stereo: bool,
}

/// Surface for view-dependent texturing instead of the points' own disks: disks, with the same number of records of
/// both kinds. Built from few points, whose own disks were too large and flat for its outlines, or made from the images
/// themselves.
#[derive(Debug, Clone)]
pub struct PhotoSurface {
    /// Positions, relative to the origin of the sequence, and colours: of points, those that disks stand for.
    pub points: Arc<Vec<PointRecord>>,
    /// Normals and radii.
    pub shapes: Arc<Vec<ShapeRecord>>,
}

impl PhotoSurface {
    /// Bytes of its records.
    pub fn byte_size(&self) -> usize {
        size_of_val(self.points.as_slice()) + size_of_val(self.shapes.as_slice())
    }
}

/// A posed image: its texture and its camera.
#[derive(Debug)]
pub struct PosedImage {
    /// Its name in its set.
    pub name: String,
    /// Its number in its set, from 0.
    pub number: usize,
    /// The pinhole of the finest level of its texture, without distortion; centres of pixels are at integers.
    pub pinhole: Camera,
    /// From the world's axes to the camera's: x to the right, y down, z forward.
    pub camera_from_world: DAffine3,
    /// Its colours. Where alpha is 0, it shows nothing of the scene: beyond the lens, or masked out.
    pub texture: Texture,
    /// True if alpha separates the scene from its background.
    pub is_masked: bool,
    /// Colour gain by which its colours are multiplied, so that the colours of all images agree.
    pub gain: Vec3,
    /// Depth map: the distance of the shown surfaces along its axis in units of the scene, if a file provides it.
    pub depth: Option<DepthImage>,
}

impl PosedImage {
    /// Returns the camera centre.
    pub fn center(&self) -> DVec3 {
        center_of(self.camera_from_world)
    }
}

impl PosedImages {
    /// Default angle between neighbours for a single image, and for images that were all taken from one position,
    /// radians.
    const USUAL_ANGLE: f64 = 0.3;

    /// The longest edge of depth maps rendered from points, texels.
    // A held-out ring has 37.3, 39.3, 40.1 dB with 512, and 36.2, 34.5, 33.8 with 256: its disks are where they should
    // be.
    const DEPTH_EDGE_PX: u32 = 512;

    /// Maximum edge length of depth maps drawn from stereo surfaces, texels. Their outlines are a few pixels off: next
    /// to depth steps, that much of an image may show the background, and steps are as wide as that number of texels.
    // *Room* and *temple* have 23.09 and 21.26 dB with 512, 23.33 and 21.32 with 256, 23.38 and 21.35 with 160.
    const DEPTH_EDGE_BY_STEREO_PX: u32 = 160;

    /// Creates a set of these posed images, whose numbers grow, with the median angle between each and its nearest
    /// neighbour, radians ([`ViewSet::median_neighbour_angle`](crate::photos::ViewSet::median_neighbour_angle)).
    pub fn new(posed_images: Vec<PosedImage>, neighbour_angle: Option<f64>) -> Self {
        Self {
            all: posed_images.into_iter().map(Arc::new).collect(),
            neighbour_angle: neighbour_angle.unwrap_or(Self::USUAL_ANGLE) as f32,
            surface: None,
            is_by_stereo: false,
        }
    }

    /// Marks the surface as known by stereo alone.
    #[must_use]
    pub fn by_stereo(self) -> Self {
        Self {
            is_by_stereo: true,
            ..self
        }
    }

    /// Returns a copy with a surface of its own, if there is one: that is by stereo.
    #[must_use]
    pub fn with_surface(&self, surface: Option<PhotoSurface>) -> Self {
        Self {
            all: self.all.clone(),
            is_by_stereo: self.is_by_stereo || surface.is_some(),
            surface,
            ..*self
        }
    }

    /// The surface that was made of them; [`Self::without`] leaves it as it is.
    pub fn surface(&self) -> Option<&PhotoSurface> {
        self.surface.as_ref()
    }

    /// The one of this number in its set.
    pub fn numbered(&self, number: usize) -> Option<&PosedImage> {
        let found = self.all.binary_search_by_key(&number, |posed_image| posed_image.number);
        found.ok().map(|at| &*self.all[at])
    }

    /// All of them, by their numbers.
    pub fn all(&self) -> &[Arc<PosedImage>] {
        &self.all
    }

    /// Returns a copy excluding some images, by their numbers in the set. The angle between views is kept as it is.
    #[must_use]
    pub fn without(&self, skipped: &[usize]) -> Self {
        let retained = self
            .all
            .iter()
            .filter(|posed_image| !skipped.contains(&posed_image.number));
        Self {
            all: retained.cloned().collect(),
            surface: self.surface.clone(),
            ..*self
        }
    }

    /// Returns the median angle between a view and the nearest other one as seen from the centre of the scene, radians.
    pub fn neighbour_angle(&self) -> f32 {
        self.neighbour_angle
    }

    /// The longest edge of the depth maps rendered of the scene in them, texels.
    pub fn depth_edge_px(&self) -> u32 {
        if self.is_by_stereo {
            Self::DEPTH_EDGE_BY_STEREO_PX
        } else {
            Self::DEPTH_EDGE_PX
        }
    }

    /// Bytes of their texels and of their surface.
    pub fn byte_size(&self) -> usize {
        let textures = self.all.iter().map(|posed_image| &posed_image.texture);
        let surface = self.surface.as_ref().map_or(0, PhotoSurface::byte_size);
        textures.map(Texture::byte_size).sum::<usize>() + surface
    }
}

#[cfg(test)]
mod tests {
    use super::super::photo_image::PhotoImage;
    use super::*;
    use crate::rgbd::Distortion;
    use glam::{DMat3, DVec2};

    #[test]
    fn a_posed_image_knows_its_camera_position() {
        let place = DVec3::new(4.0, -2.0, 0.5);
        let posed_image = PosedImage {
            name: String::new(),
            number: 0,
            pinhole: Camera::new([4, 4], DVec2::splat(4.0), DVec2::splat(1.5), Distortion::None).unwrap(),
            camera_from_world: DAffine3::from_mat3_translation(DMat3::IDENTITY, -place),
            texture: Texture::new(PhotoImage::new([4, 4], vec![[0; 4]; 16]).unwrap()),
            is_masked: false,
            gain: Vec3::ONE,
            depth: None,
        };
        assert!((posed_image.center() - place).length() < 1e-12);
        let all = PosedImages::new(vec![posed_image], None);
        assert_eq!(all.byte_size(), 4 * (16 + 4 + 1));
        assert!(all.neighbour_angle() > 0.0);
        assert!(all.without(&[0]).all().is_empty() && all.without(&[1]).all().len() == 1);
        let surface = PhotoSurface {
            points: Arc::new(vec![bytemuck::Zeroable::zeroed(); 2]),
            shapes: Arc::new(vec![bytemuck::Zeroable::zeroed(); 2]),
        };
        let with_surface = all.with_surface(Some(surface));
        assert_eq!(with_surface.byte_size(), all.byte_size() + 2 * (16 + 16));
        assert!(all.surface().is_none() && with_surface.without(&[0]).surface().is_some());
        assert_eq!(all.depth_edge_px(), 512);
        assert_eq!(with_surface.without(&[0]).depth_edge_px(), 160);
        assert_eq!(
            all.with_surface(None).by_stereo().with_surface(None).depth_edge_px(),
            160
        );
    }
}
