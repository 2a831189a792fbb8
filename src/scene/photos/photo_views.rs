//! View-dependent texturing (Yang et al. 2006 §3): camera poses of the posed images relative to the rendered view, and
//! their visibility.
//!
//! **How it works.** Surfaces are drawn first, into the sums of deferred shading; then each pixel queries the posed
//! images once. (The paper queries them for every fragment of every splat.) Images that look at a position from near
//! the eye's direction count most: `w = exp(−θ²/σ²)`, with θ between the directions from the position to both (§3.2).
//! An image does not see a position behind its visible surface (§3.3): that is determined by a depth map for each, from
//! its file or drawn of the whole surface as it sees it.
//!
//! Weights are taken relative to the first view that is no longer blended ([`PhotoViews::blended`]), so that none of
//! them appears or vanishes at once while the eye moves (Buehler et al. 2001).
//!
//! Surfaces can be relit with depth-map normals of the surfaces in the images (§4.1): `render/cpu/photos/normals.rs`.

use crate::photos::PosedImage;
use crate::scene::style::Primitive;
use crate::scene::{Content, PhotoClipping, PhotoGains, PhotoHoles, PhotoRelight, ScenePacket, ViewTransform, gap_px};
use glam::{DMat3, DVec3, Vec3, Vec4};

/// Data of the posed images needed to colour one rendered image.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotoViews {
    /// Views, one for each posed image.
    pub views: Vec<PhotoView>,
    /// `1/σ²`, per square radian.
    pub per_sigma2: f32,
    /// Maximum number of views blended at a position, from 1 up.
    pub blended: usize,
    /// Clipping of positions where the posed images show something else.
    pub clipping: PhotoClipping,
    /// Hole filling of positions that no posed image sees.
    pub holes: PhotoHoles,
    /// Maximum width of gaps in the surface that are closed; 0: none ([`gap_px`]).
    pub gap_px: u32,
    /// Relighting: selects normals from the depths of the views, and their colours.
    pub relight: PhotoRelight,
}

/// Camera pose of one posed image, relative to the rendered view.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotoView {
    /// Rows of the matrix from the view space of the rendered image into the camera's: x right, y down, z forward.
    pub camera_from_view: [Vec4; 3],
    /// Camera centre, in the view space of the rendered image.
    pub center: Vec3,
    /// Focal lengths in texels of the finest level.
    pub focal: [f32; 2],
    /// Principal point: where the camera's axis meets the image, texels from its upper left corner.
    pub principal: [f32; 2],
    /// Width and height of the finest level.
    pub size: [f32; 2],
    /// Colour gain by which the image is multiplied.
    pub gain: Vec3,
}

impl PhotoViews {
    /// Maximum number of posed images queried at a position, starting with those that look at it as the eye does: in a
    /// hollow, most are queried in vain.
    // The limit also lets the shader sort the images in registers.
    pub const MAX_ASKED: usize = 16;

    /// Returns true if holes, which none of the images sees, are filled from their surroundings.
    pub fn fills_holes(&self) -> bool {
        self.holes == PhotoHoles::Filled
    }

    /// Returns the views of a packet; `None` where surfaces have other colours.
    pub fn of(packet: &ScenePacket) -> Option<Self> {
        let shown = packet.posed_images.as_ref()?;
        let style = &packet.style.photos;
        let angle = shown.posed_images.neighbour_angle() * style.angle;
        let views = shown.posed_images.all().iter();
        Some(Self {
            views: views
                .map(|posed_image| {
                    let mut view = PhotoView::of(posed_image, shown.origin, &packet.view);
                    if style.gains == PhotoGains::Off {
                        view.gain = Vec3::ONE;
                    }
                    view
                })
                .collect(),
            per_sigma2: 1.0 / (angle * angle).max(f32::MIN_POSITIVE),
            blended: style.blended(),
            clipping: style.clipping,
            holes: style.holes,
            gap_px: gap_px(packet),
            relight: style.relight,
        })
    }
}

impl PhotoView {
    fn of(posed_image: &PosedImage, origin: DVec3, view: &ViewTransform) -> Self {
        let view_from_frame = view.view_from_frame_rotation.as_dmat3();
        let eye = view.eye_high.as_dvec3() + view.eye_low.as_dvec3();
        let camera_from_view = posed_image.camera_from_world.matrix3 * view_from_frame.transpose();
        let center = posed_image.center() - origin;
        let offset = posed_image.camera_from_world.matrix3 * (eye - center);
        let pinhole = &posed_image.pinhole;
        let [focal, principal] = [pinhole.focal_px(), pinhole.principal_px() + 0.5];
        Self {
            camera_from_view: [0, 1, 2].map(|axis| camera_from_view.row(axis).extend(offset[axis]).as_vec4()),
            center: (view_from_frame * (center - eye)).as_vec3(),
            focal: focal.as_vec2().to_array(),
            principal: principal.as_vec2().to_array(),
            size: pinhole.size_px().map(|edge| edge as f32),
            gain: posed_image.gain,
        }
    }
}

/// Returns the packet of the surface as a posed image sees it, for its depths alone.
pub fn seen_by_photo(packet: &ScenePacket, posed_image: &PosedImage) -> Option<ScenePacket> {
    let shown = packet.posed_images.as_ref()?;
    let surface = shown.surface.clone()?;
    let size_px = posed_image.pinhole.size_px();
    let longest = size_px[0].max(size_px[1]);
    let scale = f64::from(longest.min(shown.posed_images.depth_edge_px())) / f64::from(longest);
    let viewport_px = size_px.map(|edge| ((f64::from(edge) * scale).round() as u32).max(1));
    let view = view_of(posed_image, shown.origin, packet, viewport_px);
    let mut seen = packet.for_depths(view, viewport_px);
    // The whole surface, not the nodes selected for the rendered image: these change with the view, and do not cover
    // the surface outside it.
    seen.content = Content::Surfels(surface);
    seen.style.primitive = Primitive::Surfel;
    Some(seen)
}

/// Returns the view transform of a posed image, in a rendered image of `viewport_px` of all of it.
fn view_of(posed_image: &PosedImage, origin: DVec3, packet: &ScenePacket, viewport_px: [u32; 2]) -> ViewTransform {
    /// Near plane, as a fraction of the distance to the centre of the cloud or of its radius.
    const NEAR: f64 = 1e-3;
    // From x right, y down, z forward to x right, y up, z backward.
    let flip = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    let eye = posed_image.center() - origin;
    let eye_high = eye.as_vec3();
    let pinhole = &posed_image.pinhole;
    let (focal, principal) = (pinhole.focal_px(), pinhole.principal_px() + 0.5);
    let [width, height] = pinhole.size_px().map(f64::from);
    let far = (packet.bounds.center().as_dvec3() - eye).length();
    ViewTransform {
        view_from_frame_rotation: (flip * posed_image.camera_from_world.matrix3).as_mat3(),
        eye_high,
        eye_low: (eye - eye_high.as_dvec3()).as_vec3(),
        focal: [(2.0 * focal.x / width) as f32, (2.0 * focal.y / height) as f32],
        near: (NEAR * far.max(f64::from(packet.bounds.radius())).max(f64::MIN_POSITIVE)) as f32,
        pixels_per_unit_at_1: (focal.y / height * f64::from(viewport_px[1])) as f32,
        center_ndc: [
            (2.0 * principal.x / width - 1.0) as f32,
            (1.0 - 2.0 * principal.y / height) as f32,
        ],
        rows_of_whole: [0.0, 1.0],
        telephoto: 1.0,
        up: packet.view.up,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photos::{PhotoImage, Texture};
    use crate::rgbd::{Camera, Distortion};
    use crate::scene::UpAxis;
    use glam::{DAffine3, DQuat, DVec2};

    fn posed_image() -> PosedImage {
        let rotation = DQuat::from_euler(glam::EulerRot::YXZ, 0.4, 2.8, -0.3);
        let (focal, principal) = (DVec2::new(310.0, 305.0), DVec2::new(140.0, 132.5));
        PosedImage {
            name: String::new(),
            number: 0,
            pinhole: Camera::new([320, 240], focal, principal, Distortion::None).unwrap(),
            camera_from_world: DAffine3::from_rotation_translation(rotation, DVec3::new(0.3, -0.2, 4.0)),
            texture: Texture::new(PhotoImage::new([320, 240], vec![[0; 4]; 320 * 240]).unwrap()),
            is_masked: false,
            gain: Vec3::ONE,
            depth: None,
        }
    }

    /// For places of the world, relative to an origin, seen by some camera.
    #[test]
    fn image_positions_match_the_posed_image() {
        let posed_image = posed_image();
        let origin = DVec3::new(100.0, -50.0, 20.0);
        let mut moved = posed_image;
        moved.camera_from_world *= DAffine3::from_translation(-origin);
        let mut camera = crate::scene::Camera::framing(&crate::math::Aabb::EMPTY, origin, UpAxis::Y);
        camera.distance = 3.0;
        camera.target_in_world = origin;
        let view = camera.transform(origin, [640, 480]);
        let seen = PhotoView::of(&moved, origin, &view);
        for place in [DVec3::ZERO, DVec3::new(0.4, -0.3, 0.2), DVec3::new(-0.5, 0.1, -0.6)] {
            let in_view = view.to_view(place.as_vec3());
            let [x, y, z] = seen.camera_from_view.map(|row| row.dot(in_view.extend(1.0)));
            let in_camera = moved.camera_from_world.transform_point3(origin + place);
            assert!((DVec3::new(x.into(), y.into(), z.into()) - in_camera).length() < 1e-5);
            let px = moved.pinhole.pixel(in_camera).unwrap() + 0.5;
            let found = DVec2::new(
                f64::from(x / z * seen.focal[0] + seen.principal[0]),
                f64::from(y / z * seen.focal[1] + seen.principal[1]),
            );
            assert!((found - px).length() < 1e-2, "{found} {px}");
        }
        let center = view.to_view((moved.center() - origin).as_vec3());
        assert!((center - seen.center).length() < 1e-5);
    }
}
