//! From coordinates to images along the path of files: PLY with double properties, discovery, loader, traversal,
//! renderer.

use super::{brute_force, common};
use glam::{DVec3, Vec3};
use image::RgbaImage;
use pointreel::cloud::oct_decode;
use pointreel::levels::octree::StopCriterion;
use pointreel::levels::{LevelsKey, LevelsKind, SelectView};
use pointreel::scene::{BackFaces, Background, Camera, Primitive, Scene, Style, UpAxis};
use pointreel::sequence::{Loader, LoaderOptions, Needs, PreparedFrame, Sequence};
use pointreel::timeline::Direction;
use std::collections::BTreeMap;
use std::sync::Arc;

pub(crate) const SIZE_PX: [u32; 2] = [192, 128];
const BACKGROUND: [u8; 3] = [1, 2, 3];

/// A cloud that was read from a file.
pub(crate) struct Chain {
    pub(crate) origin: DVec3,
    pub(crate) frame: Arc<PreparedFrame>,
}

/// A binary PLY of doubles.
pub(super) fn ply(positions: &[DVec3]) -> Vec<u8> {
    let count = positions.len();
    let mut file = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {count}\n\
         property double x\nproperty double y\nproperty double z\nend_header\n"
    )
    .into_bytes();
    for coordinate in positions.iter().flat_map(DVec3::to_array) {
        file.extend(coordinate.to_le_bytes());
    }
    file
}

/// Writes `positions` to a file, and loads it with surfels and an octree.
pub(crate) fn load(positions: &[DVec3], delta: f32) -> Chain {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scan_0.ply"), ply(positions)).unwrap();
    let sequence = Arc::new(Sequence::discover(&[folder.path().to_owned()]).unwrap());
    let loader = Loader::new(Arc::clone(&sequence), LoaderOptions::default()).unwrap();
    let needs = Needs {
        shapes: true,
        levels: Some(LevelsKey {
            kind: LevelsKind::Surfels,
            stop: StopCriterion::Loss(delta),
        }),
        ..Needs::default()
    };
    loader.request(0, Direction::Forward, &needs);
    Chain {
        frame: loader.wait(0, &needs).unwrap(),
        origin: sequence.origin(),
    }
}

impl Chain {
    pub(crate) fn positions(&self) -> &[Vec3] {
        self.frame.frame.positions()
    }

    /// Normal and radius of each point by the bits of its position: the order of points does not matter.
    pub(crate) fn surface(&self) -> BTreeMap<[u32; 3], (Vec3, f32)> {
        let shapes = self.frame.shapes.as_ref().unwrap();
        let points = self.frame.points.iter().zip(shapes.iter());
        points
            .map(|(point, shape)| {
                let key = point.position.map(f32::to_bits);
                (key, (oct_decode(shape.normal), shape.radius))
            })
            .collect()
    }

    /// A camera that shows all of it.
    pub(crate) fn camera(&self) -> Camera {
        Camera::framing(&self.frame.frame.bounds(), self.origin, UpAxis::Y)
    }

    pub(crate) fn select_view(&self, camera: &Camera, lod_px: f32) -> SelectView {
        camera.transform(self.origin, SIZE_PX).select_view(lod_px)
    }

    /// The image of it as `primitive`, without back-face culling.
    pub(crate) fn draw(&self, camera: &Camera, primitive: Primitive) -> RgbaImage {
        let style = Style::default().with(|style| {
            style.primitive = primitive;
            style.surfels.back_faces = BackFaces::Drawn;
            style.points.size_px = 3.0;
            style.backdrop.background = Background::solid(BACKGROUND);
        });
        let packet = Scene::default().packet(&self.frame, self.origin, camera, &style, SIZE_PX);
        common::draw(&packet)
    }

    /// Expected results of any cloud: the points of the file, a surface that is defined, an octree that holds them, the
    /// visible set of brute force, and something to see from `camera`.
    pub(crate) fn check(&self, name: &str, file: &[DVec3], delta: f32, camera: &Camera) {
        self.check_positions(name, file);
        for (normal, radius) in self.surface().into_values() {
            assert!(normal.is_normalized(), "{name}: normal {normal}");
            assert!(radius > 0.0 && radius.is_finite(), "{name}: radius {radius}");
        }
        let tree = self.frame.levels.octree().unwrap();
        brute_force::check_octree(name, tree, self.positions(), delta);
        for turn in 0..4 {
            let mut turned = *camera;
            turned.orbit(77.0 * f64::from(turn), 20.0 * f64::from(turn) - 30.0);
            // From afar, and from inside or next to it.
            turned.zoom([1.0, 0.4, 0.1, 3.0][turn as usize]);
            for lod_px in [0.0, 2.0, 30.0] {
                let view = self.select_view(&turned, lod_px);
                brute_force::check_visible_set(name, tree, self.positions(), &view);
            }
        }
        for primitive in [Primitive::Point, Primitive::Voxel] {
            let image = self.draw(camera, primitive);
            let covered = common::covered(&image, BACKGROUND);
            assert!(covered > 0, "{name}: nothing is drawn as {primitive}");
        }
        // Disks may be too thin for a pixel; drawing them must not fail.
        self.draw(camera, Primitive::Surfel);
    }

    /// Every point of the file is there once, relative to the origin.
    fn check_positions(&self, name: &str, file: &[DVec3]) {
        assert_eq!(self.frame.frame.dropped_points(), 0, "{name}");
        let sorted = |positions: Vec<Vec3>| -> Vec<[f32; 3]> {
            // Adding 0 turns −0 into 0.
            let mut positions: Vec<_> = positions.iter().map(|p| (*p + 0.0).to_array()).collect();
            positions.sort_by(|a, b| a.partial_cmp(b).unwrap());
            positions
        };
        let expected = file.iter().map(|&position| (position - self.origin).as_vec3());
        assert!(
            sorted(self.positions().to_vec()) == sorted(expected.collect()),
            "{name}: points are lost or moved"
        );
    }
}
