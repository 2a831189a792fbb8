//! Frames merged into one.
//!
//! **Ghosts.** Other frames become points of the same frame: some of their points, evenly taken, in a tint. The
//! fraction of points sets how faint a ghost is: screen-door transparency instead of blending, which every renderer and
//! every primitive draws alike, as blended surfels have no order and voxels no transparency. The indices in the file of
//! the merged frame lead back: those below the number of the original frame's points are its slots, all others are
//! ghosts.

use crate::cloud::{CloudError, Frame, Positions, RawCloud, ShapeRecord, decode_ellipse, oct_decode};
use crate::sequence::{ColorSource, Coloring, Needs, PrepareCounters, PreparedFrame, prepare};
use std::sync::Arc;

/// Another frame in the image of one.
#[derive(Debug, Clone)]
pub struct Ghost {
    /// The pose.
    pub frame: Arc<PreparedFrame>,
    /// Fraction of its points that is drawn, 0 to 1.
    pub share: f32,
    /// Its colour, 8-bit red, green and blue; points that are dark are drawn darker.
    pub tint: [u8; 3],
}

/// Equal if they are the same allocation in the same look.
impl PartialEq for Ghost {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.frame, &other.frame) && self.share == other.share && self.tint == other.tint
    }
}

impl Ghost {
    /// The slots of its points that are drawn, evenly taken in their order.
    fn slots(&self) -> impl Iterator<Item = usize> {
        let count = self.frame.points.len();
        // Fewer points, not blending: blended surfels have no order, and voxels no transparency.
        let drawn = (f64::from(self.share.clamp(0.0, 1.0)) * count as f64).round() as usize;
        (0..drawn).map(move |place| place * count / drawn)
    }

    /// The tint at least half as bright as it is, more where the point is bright.
    fn color(&self, [red, green, blue, _]: [u8; 4]) -> [u8; 4] {
        let luma = (2 * u32::from(red) + 5 * u32::from(green) + u32::from(blue)) / 8;
        let [red, green, blue] = self.tint.map(|channel| (u32::from(channel) * (255 + luma) / 510) as u8);
        [red, green, blue, 255]
    }
}

/// Merges the points of `pose` as they are drawn and those of `ghosts`, with everything in `needs` except colours.
/// Where surfels are needed, ghosts without shapes are skipped.
pub fn with_ghosts(pose: &PreparedFrame, ghosts: &[Ghost], needs: &Needs) -> Result<PreparedFrame, CloudError> {
    let has_shapes = pose.shapes.is_some() && needs.shapes;
    let (mut positions, mut colors, mut shapes) = (Vec::new(), Vec::new(), Vec::new());
    let mut add = |frame: &PreparedFrame, slot: usize, color: [u8; 4]| {
        positions.push(frame.points[slot].position);
        colors.push(color);
        if let Some(known) = frame.shapes.as_ref().filter(|_| has_shapes) {
            shapes.push(known[slot]);
        }
    };
    for (slot, point) in pose.points.iter().enumerate() {
        add(pose, slot, point.color);
    }
    for ghost in ghosts {
        if has_shapes && ghost.frame.shapes.is_none() {
            continue;
        }
        for slot in ghost.slots() {
            add(&ghost.frame, slot, ghost.color(ghost.frame.points[slot].color));
        }
    }
    let mut raw = RawCloud::from_positions(Positions::F32(positions));
    raw.attributes.colors = Some(colors);
    if has_shapes {
        let normal = |shape: &ShapeRecord| oct_decode(shape.normal).to_array();
        // As they are drawn: shapes that were prepared as ellipses may now be drawn as disks.
        let ellipse = |shape: &ShapeRecord| {
            let packed = if needs.ellipses { shape.ellipse } else { 0 };
            decode_ellipse(shape.normal, packed)
        };
        let radius = |shape: &ShapeRecord| ellipse(shape).radius_of_quadratic_mean(shape.radius);
        raw.attributes.normals = Some(shapes.iter().map(normal).collect());
        raw.attributes.radii = Some(shapes.iter().map(radius).collect());
        raw.attributes.ellipses = needs.ellipses.then(|| shapes.iter().map(ellipse).collect());
    }
    raw.unit = pose.frame.unit();
    let frame = Arc::new(Frame::from_raw(raw, pose.frame.space())?);
    let needs = Needs {
        shapes: has_shapes,
        colors: Coloring::of(ColorSource::File),
        ..*needs
    };
    let counters = PrepareCounters::default();
    // The legend of the frame stays valid.
    Ok(prepare(pose.index, frame, 0.0, &needs, &counters).painted_as(pose))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::Ellipse;
    use crate::levels::octree::StopCriterion;
    use crate::levels::{LevelsKey, LevelsKind};
    use glam::{DVec3, Vec3};

    /// Points on a line from `start`, dark and bright by turns.
    fn pose(index: usize, start: f32, count: usize, needs: &Needs) -> Arc<PreparedFrame> {
        let positions = (0..count).map(|point| [start + point as f32, 0.0, 0.0]);
        let mut raw = RawCloud::from_positions(Positions::F32(positions.collect()));
        let color = |point| [[0, 0, 0, 255], [255; 4]][point % 2];
        raw.attributes.colors = Some((0..count).map(color).collect());
        raw.attributes.normals = Some(vec![[0.0, 0.0, 1.0]; count]);
        raw.attributes.radii = Some(vec![0.25; count]);
        let frame = Arc::new(Frame::from_raw(raw, DVec3::ZERO).unwrap());
        let counters = PrepareCounters::default();
        Arc::new(prepare(index, frame, 0.0, needs, &counters))
    }

    fn needs() -> Needs {
        Needs {
            shapes: true,
            levels: Some(LevelsKey {
                kind: LevelsKind::Surfels,
                stop: StopCriterion::default(),
            }),
            // The automatic choice ignores black and white.
            colors: Coloring::of(ColorSource::File),
            ..Needs::default()
        }
    }

    #[test]
    fn the_pose_stays_complete_and_ghosts_are_a_tinted_sample() {
        let pose_of = |index, start| pose(index, start, 100, &needs());
        let (now, before) = (pose_of(5, 0.0), pose_of(4, 1000.0));
        let ghost = Ghost {
            frame: before,
            share: 0.3,
            tint: [200, 100, 50],
        };
        let merged = with_ghosts(&now, &[ghost], &needs()).unwrap();
        assert_eq!((merged.index, merged.frame.len()), (5, 130));
        assert!(merged.levels.surfels().is_some());
        let (points, shapes) = (&merged.points, merged.shapes.as_ref().unwrap());
        let mut ghosts = 0;
        for (slot, &index) in merged.frame.file_index().iter().enumerate() {
            let shape = shapes[slot];
            assert_eq!((shape.radius, oct_decode(shape.normal)), (0.25, Vec3::Z));
            if let Some(point) = now.points.get(index as usize) {
                assert_eq!(*point, points[slot]);
            } else {
                ghosts += 1;
                assert!(points[slot].position[0] >= 1000.0);
                let [red, green, blue, _] = points[slot].color;
                assert!([[100, 50, 25], [200, 100, 50]].contains(&[red, green, blue]));
            }
        }
        assert_eq!(ghosts, 30);
    }

    #[test]
    fn a_ghost_without_shapes_is_skipped_only_for_surfels() {
        let now = pose(0, 0.0, 10, &needs());
        let bare = Ghost {
            frame: pose(1, 50.0, 10, &Needs::default()),
            share: 1.0,
            tint: [255; 3],
        };
        let bare = std::slice::from_ref(&bare);
        let points = |needs: &Needs| with_ghosts(&now, bare, needs).unwrap().points.len();
        assert_eq!(points(&needs()), 10);
        assert_eq!(points(&Needs::default()), 20);
    }

    #[test]
    fn ellipses_of_a_file_stay_alongside_estimated_ones() {
        let needs = Needs {
            ellipses: true,
            ..needs()
        };
        let in_rows = (0..100).map(|point| [(point % 10) as f32, (point / 10) as f32, 0.0]);
        let mut raw = RawCloud::from_positions(Positions::F32(in_rows.collect()));
        let prepared = |raw: &RawCloud| {
            let frame = Arc::new(Frame::from_raw(raw.clone(), DVec3::ZERO).unwrap());
            Arc::new(prepare(0, frame, 0.0, &needs, &PrepareCounters::default()))
        };
        let estimated = prepared(&raw);
        let ellipse = Ellipse {
            axis: Vec3::new(0.6, 0.8, 0.0),
            ratio: 0.3,
        };
        raw.attributes.normals = Some(vec![[0.0, 0.0, 1.0]; 100]);
        raw.attributes.radii = Some(vec![0.25; 100]);
        raw.attributes.ellipses = Some(vec![ellipse; 100]);
        let of_file = prepared(&raw);
        let ghost = Ghost {
            frame: Arc::clone(&estimated),
            share: 1.0,
            tint: [255; 3],
        };
        let merged = with_ghosts(&of_file, &[ghost], &needs).unwrap();
        let half_axes =
            |shape: &ShapeRecord| decode_ellipse(shape.normal, shape.ellipse).half_axes_of_quadratic_mean(shape.radius);
        let shapes = merged.shapes.as_ref().unwrap();
        for (&index, shape) in merged.frame.file_index().iter().zip(shapes.iter()) {
            let expected = match index {
                0..100 => ellipse.half_axes(0.25),
                ghost => half_axes(&estimated.shapes.as_ref().unwrap()[ghost as usize - 100]),
            };
            for (found, expected) in half_axes(shape).into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-4 * expected, "{found} for {expected}");
            }
        }
        let disks = Needs {
            ellipses: false,
            ..needs
        };
        let alone = with_ghosts(&estimated, &[], &disks).unwrap();
        assert_eq!(alone.frame.ellipses(), None);
    }

    #[test]
    fn shares_are_clamped_to_the_available_points() {
        for (share, expected) in [(0.0, 0), (0.5, 5), (1.0, 10), (7.0, 10), (f32::NAN, 0)] {
            let ghost = Ghost {
                frame: pose(0, 0.0, 10, &needs()),
                share,
                tint: [0; 3],
            };
            let slots: Vec<usize> = ghost.slots().collect();
            assert_eq!(slots.len(), expected);
            assert!(slots.is_sorted() && slots.last().is_none_or(|&slot| slot < 10));
        }
    }
}
