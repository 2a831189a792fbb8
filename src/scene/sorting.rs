//! Surfels from back to front: the reference of all modes that blend without sorting.
//!
//! How it works: a splat that is drawn over all splats behind it needs neither a depth test nor a second pass (the 4D
//! media paper §V-B calls it the proper solution, too slow to use). The order is by centres along the view
//! axis, so splats that intersect are blended as wholes. Each view is sorted again, and uploaded again to an adapter.

use super::{Content, Surfels, ViewTransform};
use crate::cloud::PointRecord;
use crate::scene::clip::at;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Returns the content with its surfels from back to front, anything else as it is.
pub(in crate::scene) fn sorted(view: &ViewTransform, content: &Content) -> Content {
    let Content::Surfels(Surfels { points, shapes }) = content else {
        return content.clone();
    };
    let order = back_to_front(points, view);
    Content::Surfels(Surfels {
        points: Arc::new(at(points, &order)),
        shapes: Arc::new(at(shapes, &order)),
    })
}

/// The indices of points by decreasing depth; of equal depths in their own order.
fn back_to_front(points: &[PointRecord], view: &ViewTransform) -> Vec<u32> {
    // The third axis of a view points towards the viewer.
    let towards_viewer = view.view_from_frame_rotation.row(2).as_dvec3();
    let nearness = |point: &PointRecord| towards_viewer.dot(Vec3::from_array(point.position).as_dvec3());
    let mut order: Vec<(f64, u32)> = points.par_iter().map(nearness).zip(0..points.len() as u32).collect();
    order.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    order.into_iter().map(|(_, index)| index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::ShapeRecord;
    use crate::math::Aabb;
    use crate::scene::remade::Remade;
    use crate::scene::{Camera, UpAxis};
    use bytemuck::Zeroable as _;
    use glam::DVec3;
    use proptest::prelude::*;

    fn surfels(positions: &[[f32; 3]]) -> Content {
        let points = positions.iter().map(|&position| PointRecord {
            position,
            color: [0; 4],
        });
        Content::Surfels(Surfels {
            points: Arc::new(points.collect()),
            shapes: Arc::new(vec![ShapeRecord::zeroed(); positions.len()]),
        })
    }

    fn view(azimuth_deg: f64) -> ViewTransform {
        let bounds = Aabb {
            min: Vec3::splat(-9.0),
            max: Vec3::splat(9.0),
        };
        let camera = Camera {
            azimuth_deg,
            elevation_deg: 20.0,
            ..Camera::framing(&bounds, DVec3::ZERO, UpAxis::Y)
        };
        camera.transform(DVec3::ZERO, [64, 64])
    }

    proptest! {
        #[test]
        fn depths_decrease(positions in prop::collection::vec(prop::array::uniform3(-9f32..9.0), 0..200),
            azimuth_deg in 0f64..360.0) {
            let view = view(azimuth_deg);
            let sorted = sorted(&view, &surfels(&positions));
            let depth = |point: &PointRecord| {
                let offset = Vec3::from_array(point.position) - view.eye_high - view.eye_low;
                -(view.view_from_frame_rotation * offset).z
            };
            let depths: Vec<f32> = sorted.points().unwrap().iter().map(depth).collect();
            prop_assert!(depths.is_sorted_by(|a, b| a + 1e-4 >= *b), "{depths:?}");
            let mut places: Vec<_> = sorted.points().unwrap().iter().map(|point| point.position).collect();
            let mut expected = positions;
            for list in [&mut places, &mut expected] {
                list.sort_by(|a, b| a.partial_cmp(b).unwrap());
            }
            prop_assert_eq!(places, expected);
        }
    }

    #[test]
    fn an_unchanged_view_keeps_its_allocation() {
        let mut sorting = Remade::default();
        let mut sort = |content, view| sorting.get(view, content, sorted);
        let content = surfels(&[[0.0; 3], [1.0; 3]]);
        let first = sort(content.clone(), view(0.0));
        assert_eq!(sort(content.clone(), view(0.0)), first);
        let turned = sort(content.clone(), view(180.0));
        assert_ne!(turned, first);
        assert_eq!(
            turned.points().unwrap()[0].position,
            first.points().unwrap()[1].position
        );
        assert_ne!(sort(surfels(&[[0.0; 3]]), view(180.0)), turned);
        assert_eq!(sort(Content::Nothing, view(0.0)), Content::Nothing);
    }
}
