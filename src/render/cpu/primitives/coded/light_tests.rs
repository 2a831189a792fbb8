//! Tests of pixel colours against the light of known normals, computed for each point separately.

use super::tests::{COLOR, packet_of_surfels};
use super::transform::homogeneous;
use super::*;
use crate::analysis::test_shapes::Random;
use crate::cloud::{coarser_normal, quantise_normal};
use crate::render::constants::{HEADLIGHT_AMBIENT, HEADLIGHT_SHININESS, HEADLIGHT_SPECULAR};
use crate::render::cpu::rows::bands_of;
use crate::render::cpu::view::PixelView;
use crate::scene::{BackFaces, Camera, Footprint, Lighting, NormalBits, OffsetBits, PicturePlane, Projection, UpAxis};
use glam::{DVec3, Vec3};
use image::RgbaImage;

/// Camera that looks from aside, so that neither the centre of the cloud nor most points are ahead.
const CAMERA: Camera = Camera {
    target_in_world: DVec3::new(0.6, -0.4, 0.0),
    distance: 4.0,
    azimuth_deg: 20.0,
    elevation_deg: 15.0,
    fov_deg: 60.0,
    up: UpAxis::Y,
    projection: Projection::Perspective,
    plane: PicturePlane::CENTERED,
};

/// Cells are smaller than half a pixel.
const DEPTH: u32 = 10;

/// Points on a grid, far enough from each other to be alone in their pixels, with normals that are drawn as they are;
/// half of them face the eye within 10 to 20 degrees, where the light has a highlight.
fn surfels(bits: u32) -> Vec<([f32; 3], Vec3)> {
    let mut random = Random(5);
    let normals = quantised_normals(bits);
    let towards_eye = (CAMERA.eye_in_world() - CAMERA.target_in_world).as_vec3();
    let mut surfels = Vec::new();
    for row in 0..12 {
        for column in 0..16 {
            let [x, y] = [column as f32 - 7.5, row as f32 - 5.5].map(|step| 0.2 * step);
            let near = towards_eye.normalize() + 0.3 * random.cube();
            let any = random.cube();
            let wanted = if column % 2 == 0 { near } else { any };
            let index = coarser_normal(quantise_normal(wanted.normalize_or(Vec3::X)), bits);
            surfels.push(([x, y, 0.4 * random.cube().z], normals[index as usize]));
        }
    }
    surfels
}

/// Computes the colour of a point of [`COLOR`] with this normal, 0 to 255: the headlight for light that comes along
/// `from_eye`.
fn lit(normal: Vec3, from_eye: DVec3) -> [f64; 3] {
    let facing = normal.as_dvec3().dot(from_eye.normalize()).abs();
    let factor = f64::from(HEADLIGHT_AMBIENT) + f64::from(1.0 - HEADLIGHT_AMBIENT) * facing;
    let white = 255.0 * f64::from(HEADLIGHT_SPECULAR) * facing.powi(HEADLIGHT_SHININESS as i32);
    [0, 1, 2].map(|channel| (f64::from(COLOR[channel]) * factor + white).min(255.0))
}

/// Draws the points and compares each one's pixel with `expected`, by its normal and its place. Returns how many
/// different colours there are.
fn assert_pixels(
    footprint: Footprint,
    lighting: Lighting,
    normal_bits: NormalBits,
    expected: impl Fn(Vec3, DVec3, DVec3) -> [f64; 3],
) -> usize {
    let surfels = surfels(normal_bits.bits());
    let mut packet = packet_of_surfels(&surfels, DEPTH, &CAMERA);
    packet.viewport_px = [640, 480];
    packet.view = CAMERA.transform(DVec3::ZERO, packet.viewport_px);
    packet.style.codes.footprint = footprint;
    packet.style.light.lighting = lighting;
    packet.style.codes.normal_bits = normal_bits;
    // At cell centres.
    packet.style.codes.offset_bits = OffsetBits::None;
    packet.style.surfels.back_faces = BackFaces::Drawn;
    let mut image = RgbaImage::new(640, 480);
    let bands = bands_of(&packet, &mut image, 4).map(TileRow::Bytes);
    let coded = Coded::of(&packet).expect("a byte code");
    assert!(draw(&coded, &packet, bands.collect()) > 0, "nodes are drawn");

    let view = PixelView::new(&packet);
    let cloud = &packet.content.coded().expect("a byte code").cloud;
    let eye = CAMERA.eye_in_world();
    let to_center = packet.bounds.center().as_dvec3() - eye;
    let cells = cloud.cells(cloud.depth());
    assert_eq!(cells.len(), surfels.len(), "each has a cell of its own");
    let mut colors = std::collections::BTreeSet::new();
    for cell in cells {
        let center = cloud.cube().cell_center(cloud.depth(), cell);
        let distance = |surfel: &&([f32; 3], Vec3)| Vec3::from_array(surfel.0).distance(center);
        let surfel = surfels.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let (_, normal) = surfel.expect("a point");
        let facing = normal.as_dvec3().dot((center.as_dvec3() - eye).normalize());
        // A narrow mask leaves some of the background in its pixels.
        if footprint == Footprint::Masks && facing.abs() < 0.5 {
            continue;
        }
        let seen = homogeneous(&view, view.rotate(view.offset_from_eye(center.to_array())));
        let [x, y] = [seen.x / seen.z, seen.y / seen.z].map(|px| px as u32);
        let found = image.get_pixel(x, y).0;
        let wanted = expected(*normal, center.as_dvec3() - eye, to_center);
        for (found, wanted) in found.into_iter().zip(wanted) {
            // The byte is rounded, and one of its colour may be too.
            let error = (f64::from(found) - wanted).abs();
            assert!(
                error <= 1.0,
                "{footprint} {lighting} {normal}: {found} for {wanted} at {x} {y}"
            );
        }
        colors.insert(found);
    }
    colors.len()
}

const FOOTPRINTS: [Footprint; 2] = [Footprint::Pixels, Footprint::Masks];

/// Lighting once per normal: from the eye to the centre of the cloud, wherever the point is.
#[test]
fn per_surfel_light_uses_the_normal_and_a_viewer_at_infinity() {
    for footprint in FOOTPRINTS {
        for &bits in NormalBits::ALL {
            let lighting = Lighting::PerSurfel;
            let colors = assert_pixels(footprint, lighting, bits, |normal, _, to_center| lit(normal, to_center));
            assert!(colors > 80, "{colors}: light makes colours differ");
        }
    }
}

/// Finer lighting uses the direction from the eye to each point.
#[test]
fn finer_light_uses_the_direction_from_the_eye() {
    for footprint in FOOTPRINTS {
        for lighting in [Lighting::PerVertex, Lighting::PerFragment] {
            let bits = NormalBits::Thirteen;
            let colors = assert_pixels(footprint, lighting, bits, |normal, from_eye, _| lit(normal, from_eye));
            assert!(colors > 80, "{colors}: light makes colours differ");
        }
    }
}

#[test]
fn without_light_colors_are_unchanged() {
    for footprint in FOOTPRINTS {
        let colors = assert_pixels(footprint, Lighting::Unlit, NormalBits::Thirteen, |_, _, _| {
            [0, 1, 2].map(|channel| f64::from(COLOR[channel]))
        });
        assert_eq!(colors, 1);
    }
}
