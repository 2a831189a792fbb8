//! Levels of detail in images: surfels of octree cells compared with all surfels.

use crate::common::{camera_at, colored_sphere, covered, draw, plain};
use glam::DVec3;
use pointreel::levels::Lod;
use pointreel::measure::{flip, mean_squared_error, psnr_db};
use pointreel::scene::{BackFaces, LevelStructure, Scene, ScenePacket, Style};
use pointreel::sequence::PreparedFrame;

const SIZE: [u32; 2] = [240, 240];
const POINTS: u32 = 40_000;
const BLACK: [u8; 3] = [0; 3];

fn by_octree(lod: Lod) -> Style {
    plain().with(|style| {
        style.levels.surfel_lod = true;
        style.levels.lod = lod;
    })
}

fn packet(frame: &PreparedFrame, distance: f64, style: &Style) -> ScenePacket {
    Scene::default().packet(frame, DVec3::ZERO, &camera_at(distance), style, SIZE)
}

/// From afar a fraction of the surfels makes nearly the same image, and a closed one.
#[test]
fn few_surfels_represent_many() {
    let frame = colored_sphere(POINTS, &by_octree(Lod::default()));
    let all = packet(&frame, 4.0, &plain());
    let truth = draw(&all);
    let mut errors = Vec::new();
    for lod_px in [1.0, 2.0, 4.0] {
        let few = packet(&frame, 4.0, &by_octree(Lod::ThresholdPx(lod_px)));
        assert_eq!(few.content.shapes().unwrap().len(), few.content.points().unwrap().len());
        let picture = draw(&few);
        let error = flip(&truth, &picture).unwrap().mean();
        errors.push((few.content.points().unwrap().len(), error));
        // Coarser disks extend beyond the outline by their own size; no holes open.
        let (expected, found) = (covered(&truth, BLACK), covered(&picture, BLACK));
        assert!(
            found >= expected * 99 / 100 && found <= expected * 125 / 100,
            "{found} pixels instead of {expected} at {lod_px} px"
        );
    }
    assert!(errors.is_sorted_by(|a, b| a.0 > b.0 && a.1 < b.1), "{errors:?}");
    assert!(errors[0].0 < POINTS as usize / 2, "{errors:?}");
    assert!(errors[2].0 < POINTS as usize / 20, "{errors:?}");
    assert!(errors[0].1 < 0.02, "{errors:?}");
}

/// Surfels culled by normal cones would not have been drawn.
#[test]
fn back_facing_surfels_are_culled_without_visible_change() {
    let style = by_octree(Lod::ThresholdPx(0.0));
    let frame = colored_sphere(POINTS, &style);
    let two_sided = style.with(|style| style.surfels.back_faces = BackFaces::Drawn);
    let front = packet(&frame, 2.0, &style);
    let both = packet(&frame, 2.0, &two_sided);
    assert_eq!(both.content.points().unwrap().len(), POINTS as usize);
    // From twice the radius away a quarter of a sphere is visible.
    let share = front.content.points().unwrap().len() as f64 / f64::from(POINTS);
    assert!((0.25..0.45).contains(&share), "{share}");
    let drawn = draw(&front);
    let style = style.painted();
    let culled_by_the_gpu = draw(&ScenePacket { style, ..both });
    // Weights are summed in a different order.
    let error = mean_squared_error(&culled_by_the_gpu, &drawn).unwrap();
    assert!(psnr_db(error) > 50.0, "{} dB", psnr_db(error));
}

#[test]
fn a_frame_without_an_octree_shows_all_its_surfels() {
    let frame = colored_sphere(POINTS, &plain());
    assert!(frame.levels.surfels().is_none());
    let packet = packet(&frame, 4.0, &by_octree(Lod::Level(3)));
    assert_eq!(packet.content.points().unwrap().len(), POINTS as usize);
}

#[test]
fn a_surfel_budget_is_respected() {
    let frame = colored_sphere(POINTS, &by_octree(Lod::default()));
    for budget in [500, 5_000] {
        let drawn = packet(&frame, 3.0, &by_octree(Lod::Budget(budget)))
            .content
            .points()
            .unwrap()
            .len();
        assert!(
            (budget as usize / 4..=budget as usize).contains(&drawn),
            "{drawn} of {budget}"
        );
    }
}

/// A plain list keeps a budget without an octree: surfels that are fewer and larger still close the surface.
#[test]
fn a_list_respects_a_budget_without_an_octree() {
    let of_list = |lod| {
        let mut style = by_octree(lod);
        style.levels.structure = LevelStructure::None;
        style
    };
    let frame = colored_sphere(POINTS, &of_list(Lod::default()));
    assert!(frame.levels.octree().is_none());
    let all = packet(&frame, 4.0, &plain());
    // A list has no projected sizes.
    let whole = packet(&frame, 4.0, &of_list(Lod::ThresholdPx(8.0)));
    assert_eq!(draw(&whole), draw(&all));
    let few = packet(&frame, 4.0, &of_list(Lod::Budget(12_000)));
    assert_eq!(few.content.record_count(), 10_000);
    let (truth, picture) = (draw(&all), draw(&few));
    let [of_all, of_few] = [&truth, &picture].map(|picture| covered(picture, BLACK));
    assert!(of_few >= of_all, "{of_few} of {of_all} pixels");
    let error = mean_squared_error(&truth, &picture).unwrap();
    assert!(psnr_db(error) > 25.0, "{} dB", psnr_db(error));
}
