//! Camera frusta of the input images: one pyramid each in the rendered view, from the camera to the corners of its
//! image. A click on a camera moves to its position.

use super::Photos;
use crate::app::theme::{ACCENT, ODD};
use crate::app::widgets::overlay::PictureOverlay;
use crate::photos::{Photo, ViewSet};
use egui::{CursorIcon, Rect, Role, Sense, Stroke, Ui, Vec2, WidgetInfo};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// Length of the pyramid axis, as a fraction of the distance between the camera and its target.
const LENGTH: f64 = 0.08;

/// Half the edge of the clickable area of a camera, points.
const GRAB: f32 = 8.0;

/// Radius of the knob at a camera, points.
const RADIUS: f32 = 3.5;

/// From the camera around the corners of the image, and a roof over its upper side; in the world.
fn pyramid(photo: &Photo, midpoint: DVec3) -> [Vec<DVec3>; 3] {
    let length = LENGTH * (midpoint - photo.center()).length();
    let [width, height] = photo.camera.size_px().map(f64::from);
    let world_from_camera = photo.camera_from_world.inverse();
    // Lens distortion is ignored: corners of a wide-angle image may have no rays.
    let corner = |x: f64, y: f64| {
        let slope = (DVec2::new(x, y) - 0.5 - photo.camera.principal_px()) / photo.camera.focal_px();
        world_from_camera.transform_point3(length * slope.extend(1.0))
    };
    let [a, b, c, d] = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]].map(|[x, y]| corner(x, y));
    let eye = photo.center();
    let roof = corner(0.5 * width, -0.25 * height);
    [vec![a, b, c, d, a, eye, b, roof, a], vec![c, eye], vec![d, eye]]
}

/// Paints all of them; the number of the one that was clicked.
pub(in crate::app) fn frusta_ui(
    ui: &Ui,
    canvas: &PictureOverlay<'_>,
    set: &Arc<ViewSet>,
    photos: &mut Photos,
) -> Option<usize> {
    let mut clicked = None;
    let midpoints = photos.centers_of(set);
    for (number, (photo, &midpoint)) in set.photos.iter().zip(&*midpoints).enumerate() {
        let color = if photos.is_used(number) { ACCENT } else { ODD };
        for line in pyramid(photo, midpoint) {
            canvas.polyline(&line, Stroke::new(1.0, color));
        }
        let Some(center) = canvas.place(photo.center()) else {
            continue;
        };
        canvas.knob(center, RADIUS, color);
        let area = Rect::from_center_size(center, Vec2::splat(2.0 * GRAB));
        let response = ui
            .interact(area, ui.scope_id().with(("image", number)), Sense::click())
            .on_hover_cursor(CursorIcon::PointingHand)
            .on_hover_text(&photo.name);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("View from {}", photo.name)));
        if response.clicked() {
            clicked = Some(number);
        }
    }
    clicked
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::{Camera, Distortion};
    use glam::DAffine3;

    #[test]
    fn a_frustum_reaches_from_the_camera_to_the_corners_of_its_image() {
        let camera = Camera::new([4, 2], DVec2::splat(2.0), DVec2::new(1.5, 0.5), Distortion::None);
        let photo = Photo {
            name: String::new(),
            path: String::new().into(),
            camera: camera.unwrap(),
            camera_from_world: DAffine3::from_translation(DVec3::new(0.0, 0.0, 5.0)),
            mask: None,
            depth: None,
            depth_range: None,
        };
        let [around, right, left] = pyramid(&photo, DVec3::ZERO);
        let length = 5.0 * LENGTH;
        let eye = DVec3::new(0.0, 0.0, -5.0);
        assert_eq!(right[1], eye);
        assert!(right[0].distance(eye + length * DVec3::new(1.0, 0.5, 1.0)) < 1e-12);
        assert!(left[0].distance(eye + length * DVec3::new(-1.0, 0.5, 1.0)) < 1e-12);
        // The roof is above: y points down in a camera.
        assert!(around[7].y < around[0].y);
    }
}
