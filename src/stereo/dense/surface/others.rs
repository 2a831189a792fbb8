//! Cross-view checks of one view's depths: rejection of doubtful depths, and depths to fill its gaps.

use super::map::Map;
use crate::rgbd::DepthImage;
use glam::DVec3;
use rayon::prelude::*;

/// Depths are of one place if they differ by less, as a part.
pub(super) const SAME: f64 = 0.01;

/// Relative depth difference beyond which something nearer than the measured depth is looked through.
pub(super) const BEFORE: f64 = 0.02;

/// Number of views that may look through a place for each that has measured it. Views that agree by chance are few.
const MAX_AGAINST: f64 = 0.25;

/// Maximum difference of the colour channels of one position in two images.
// With 20 out of 255: 23.31 dB instead of 23.63 (room) and 21.70 instead of 21.74 (temple), 0.92 and 0.42 drawn with
// both.
const ALIKE: u8 = 8;

/// Discards measurements where more views look through them than [`MAX_AGAINST`] of those that agree: a speck in the
/// air, before the eye, is as large as a house.
pub(super) fn forget_doubted(maps: &mut [Map<'_>]) {
    let doubted: Vec<Vec<usize>> = (0..maps.len())
        .into_par_iter()
        .map(|index| {
            let pixels = 0..maps[index].depths.len();
            pixels.filter(|&at| is_doubted(maps, index, at)).collect()
        })
        .collect();
    for (map, doubted) in maps.iter_mut().zip(doubted) {
        for at in doubted {
            map.depths[at] = 0.0;
            map.is_measured[at] = false;
        }
    }
}

fn is_doubted(maps: &[Map<'_>], index: usize, at: usize) -> bool {
    let map = &maps[index];
    let Some(place) = map.place(at).filter(|_| map.is_measured[at]) else {
        return false;
    };
    let (mut with_it, mut against) = (0.0, 0.0);
    for (_, other) in maps.iter().enumerate().filter(|(other, _)| *other != index) {
        let Some((distance, measured)) = other.measured_at(place) else {
            continue;
        };
        if (distance - measured).abs() <= SAME * measured {
            with_it += 1.0;
        } else if distance < measured * (1.0 - BEFORE) {
            against += 1.0;
        }
    }
    against > MAX_AGAINST * with_it
}

/// Returns true if a view has measured something behind a position.
pub(super) fn is_looked_through(maps: &[Map<'_>], place: DVec3) -> bool {
    let mut seen = maps.iter().filter_map(|map| map.measured_at(place));
    seen.any(|(distance, measured)| distance < measured * (1.0 - BEFORE))
}

/// Adds depths that two views agree on, where there are none and no view looks through them: the periphery of a set, or
/// the area next to something nearer, is seen by two. They are not trusted over others. Precondition: one image for
/// each map.
pub(super) fn add_pairs(maps: &mut [Map<'_>], of_two: &[DepthImage]) {
    let added = |(map, of_two): (&Map<'_>, &DepthImage)| -> Vec<(usize, f32)> {
        let depths = of_two.metres().iter().copied().enumerate();
        let lacking = depths.filter(|&(at, depth)| depth > 0.0 && map.depths[at] == 0.0);
        let is_free = |&(at, depth): &(usize, f32)| {
            let place = map.place_at(at, f64::from(depth));
            place.is_some_and(|place| !is_looked_through(maps, place))
        };
        lacking.filter(is_free).collect()
    };
    let added: Vec<Vec<(usize, f32)>> = maps.par_iter().zip(of_two).map(added).collect();
    for (map, added) in maps.iter_mut().zip(added) {
        for (at, depth) in added {
            map.depths[at] = depth;
        }
    }
}

/// Takes depths that other views have measured, where there are none: of those in the same colour in this one, the
/// nearest.
pub(super) fn carry_over(maps: &mut [Map<'_>]) {
    let carried: Vec<Vec<f32>> = maps.par_iter().map(|map| carried(map, maps)).collect();
    for (map, carried) in maps.iter_mut().zip(carried) {
        map.depths = carried;
    }
}

fn carried(map: &Map<'_>, maps: &[Map<'_>]) -> Vec<f32> {
    let mut depths = map.depths.clone();
    for other in maps.iter().filter(|other| other.number != map.number) {
        for at in (0..other.depths.len()).filter(|&at| other.is_measured[at]) {
            let Some((here, distance)) = other.place(at).and_then(|place| map.at_place(place)) else {
                continue;
            };
            let is_nearest = depths[here] == 0.0 || distance < f64::from(depths[here]);
            let colors = [map, other].map(|map| map.view.image.pixels());
            if map.depths[here] == 0.0 && is_nearest && is_alike(colors[0][here], colors[1][at]) {
                depths[here] = distance as f32;
            }
        }
    }
    depths
}

fn is_alike(first: [u8; 3], second: [u8; 3]) -> bool {
    first
        .iter()
        .zip(second)
        .all(|(first, second)| first.abs_diff(second) < ALIKE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::{Camera, ColorImage, Distortion};
    use crate::stereo::View;
    use glam::{DAffine3, DVec2};

    const SIZE: [u32; 2] = [32, 24];
    const PIXELS: usize = 32 * 24;
    const WALL: f32 = 4.0;

    /// The pixel of the central column and row.
    const CENTER: usize = 32 * 12 + 16;

    fn camera() -> Camera {
        Camera::new(SIZE, DVec2::splat(30.0), DVec2::new(16.0, 12.0), Distortion::None).unwrap()
    }

    fn image(color: [u8; 3]) -> ColorImage {
        ColorImage::new(SIZE, vec![color; PIXELS]).unwrap()
    }

    /// Views of a wall, slightly apart, in their colours.
    fn maps<'a>(camera: &'a Camera, images: &'a [ColorImage]) -> Vec<Map<'a>> {
        let map = |(number, image): (usize, &'a ColorImage)| Map {
            view: View {
                image,
                camera,
                camera_from_world: DAffine3::from_translation(DVec3::new(-0.02 * number as f64, 0.0, 0.0)),
            },
            number,
            depths: vec![WALL; PIXELS],
            is_measured: vec![true; PIXELS],
        };
        images.iter().enumerate().map(map).collect()
    }

    #[test]
    fn depths_others_see_through_are_removed_and_walls_stay() {
        let (camera, images) = (camera(), vec![image([90; 3]); 7]);
        let mut maps = maps(&camera, &images);
        // Two have something in front of it, and five see through it.
        for map in &mut maps[..2] {
            map.depths[CENTER] = 2.0;
        }
        forget_doubted(&mut maps);
        for (index, map) in maps.iter().enumerate() {
            let forgotten = map.depths.iter().filter(|&&depth| depth == 0.0).count();
            assert_eq!(forgotten, usize::from(index < 2), "view {index}");
            assert_eq!(map.is_measured[CENTER], index >= 2);
        }
        // All of them have it.
        let mut of_all = self::maps(&camera, &images);
        for map in &mut of_all {
            map.depths.fill(2.0);
        }
        forget_doubted(&mut of_all);
        assert!(of_all.iter().all(|map| map.depths == [2.0; PIXELS]));
    }

    fn forget_center(map: &mut Map<'_>) {
        map.depths[CENTER] = 0.0;
        map.is_measured[CENTER] = false;
    }

    #[test]
    fn depths_two_views_agree_on_are_used_unless_a_third_sees_through() {
        let (camera, images) = (camera(), vec![image([90; 3]); 3]);
        let of_two = |depth: f32| {
            let mut depths = vec![0.0; PIXELS];
            depths[CENTER] = depth;
            vec![DepthImage::new(SIZE, depths).unwrap(); 3]
        };
        let taken = |depth: f32| {
            let mut maps = maps(&camera, &images);
            forget_center(&mut maps[0]);
            add_pairs(&mut maps, &of_two(depth));
            assert_eq!(maps[1].depths[CENTER], WALL, "what was measured stays");
            assert!(!maps[0].is_measured[CENTER]);
            maps[0].depths[CENTER]
        };
        assert_eq!(taken(4.01), 4.01);
        assert_eq!(taken(2.0), 0.0);
        assert_eq!(taken(6.0), 6.0);
    }

    #[test]
    fn the_nearest_depth_of_the_same_color_is_transferred() {
        let camera = camera();
        let images = [image([90; 3]), image([90; 3]), image([97, 90, 90]), image([98, 90, 90])];
        let mut maps = maps(&camera, &images);
        forget_center(&mut maps[0]);
        maps[2].depths.fill(3.0);
        maps[3].depths.fill(2.0);
        carry_over(&mut maps);
        // Taken from the third, whose colour matches, and not from the fourth.
        assert!((maps[0].depths[CENTER] - 3.0).abs() < 1e-6);
        assert!(!maps[0].is_measured[CENTER]);
        assert_eq!(maps[0].depths[0], WALL);
    }
}
