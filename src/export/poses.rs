//! What other poses add to pictures: colours by how far each point is from another frame, ghosts, and the ways of
//! points; and what photographs of them add.
//!
//! All of it is a frame made of frames, so that every renderer and every primitive draws it. In the window the same is
//! made of what is in memory, and trails are lines over the picture; here frames are waited for, and trails are tubes
//! of points.

use crate::headless::Headless;
use crate::levels::LevelsKey;
use crate::levels::octree::StopCriterion;
use crate::measure::Change;
use crate::messages::frame_with_index;
use crate::scene::Style;
use crate::sequence::{FrameError, Ghost, Needs, OnionSkin, Paint, PreparedFrame, Trails, with_ghosts};
use std::sync::Arc;

/// Radius of trails, as a share of that of the frame.
const TRAIL_RADIUS: f32 = 0.003;

/// What other poses add to each picture.
#[derive(Debug, Clone, Default)]
pub struct Poses {
    /// The colours of points.
    pub change: Option<ChangeColors>,
    /// Neighbouring poses.
    pub onion: Option<OnionSkin>,
    /// The ways of points, and how each is drawn.
    pub trails: Option<(Trails, Vec<TrailLook>)>,
    /// Photographs that are not put on surfaces, by their numbers.
    pub left_out_photos: Vec<usize>,
}

/// Colours by the distance to another pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangeColors {
    /// How many frames later that is; negative for earlier.
    pub step: i64,
    /// The distance in the last colour, scene units; that which 99 % of the points do not exceed if `None`.
    pub range: Option<f64>,
}

/// How a trail is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrailLook {
    /// Which one.
    pub trail: usize,
    /// Its colour; what is still to come is half as bright.
    pub tint: [u8; 3],
    /// Only so many frames before the shown one; all of them, and those to come, if `None`.
    pub length: Option<usize>,
}

impl TrailLook {
    /// The colour of trails of picked points.
    pub const PICKED_TINT: [u8; 3] = [255, 190, 60];

    /// All of a trail of a picked point.
    pub fn picked(trail: usize) -> Self {
        Self {
            trail,
            tint: Self::PICKED_TINT,
            length: None,
        }
    }
}

/// A pose with what others add to it.
#[derive(Debug, Clone)]
pub struct Dressed {
    /// What is drawn.
    pub frame: Arc<PreparedFrame>,
    /// What could not be read of the pose's file or could not be added, and why.
    pub problems: Vec<String>,
}

impl Poses {
    /// `pose` with all of it. What there is not (a frame beyond the ends, a broken one) is left out, and said.
    ///
    /// # Errors
    /// If all together has more points than a frame can have.
    pub fn dress(&self, pose: &Arc<PreparedFrame>, headless: &Headless, style: &Style) -> Result<Dressed, FrameError> {
        let mut dressed = Dressed {
            frame: Arc::clone(pose),
            problems: pose.frame.warnings().to_vec(),
        };
        if let Some(change) = self.change {
            change.color(&mut dressed, headless, style);
        }
        let needs = headless.needs(style);
        if let Some(onion) = self.onion {
            let mut ghosts = Vec::new();
            for (index, share, tint) in onion.around(pose.index, headless.sequence().len()) {
                match headless.frame_beside(index, style) {
                    Ok(frame) => ghosts.push(Ghost { frame, share, tint }),
                    Err(error) => {
                        let named = frame_with_index(index, headless.sequence().len());
                        dressed.problems.push(format!("{named} is no ghost: {error}"));
                    }
                }
            }
            dressed.add(&ghosts, &needs, headless)?;
        }
        if let Some((trails, looks)) = &self.trails {
            let radius = TRAIL_RADIUS * dressed.frame.frame.bounds().radius();
            let mut tubes = Vec::with_capacity(looks.len());
            for look in looks {
                let range = match look.length {
                    Some(length) => {
                        let frames = trails.frames();
                        let first = pose.index.saturating_sub(length).max(frames.start);
                        first..(pose.index + 1).min(frames.end)
                    }
                    None => trails.frames(),
                };
                let tube = trails.tube_through(look.trail, range, pose.index, radius);
                tubes.push(Ghost {
                    frame: Arc::new(tube.map_err(|reason| invalid(pose, headless, reason))?),
                    share: 1.0,
                    tint: look.tint,
                });
            }
            // Tubes have so many points that a loss would divide the pose's cells as well.
            let depth = dressed.frame.levels.octree().map(|octree| octree.depth());
            let levels = needs.levels.zip(depth).map(|(levels, depth)| LevelsKey {
                stop: StopCriterion::Depth(depth),
                ..levels
            });
            let needs = Needs { levels, ..needs };
            dressed.add(&tubes, &needs, headless)?;
        }
        if self.change.is_none() && style.draws_photographs() {
            dressed.add_photographs(headless, &self.left_out_photos);
        }
        Ok(dressed)
    }
}

impl Dressed {
    fn add_photographs(&mut self, headless: &Headless, left_out: &[usize]) {
        let Some(loaded) = headless.photographs(self.frame.index) else {
            return;
        };
        self.problems.extend_from_slice(&loaded.notes);
        let Some(photographs) = headless.photographs_without(self.frame.index, left_out) else {
            return;
        };
        if !photographs.all().is_empty() {
            self.frame = Arc::new(self.frame.with_photographs(photographs));
        }
    }

    fn add(&mut self, ghosts: &[Ghost], needs: &Needs, headless: &Headless) -> Result<(), FrameError> {
        if !ghosts.is_empty() {
            let merged = with_ghosts(&self.frame, ghosts, needs);
            let merged = merged.map_err(|reason| invalid(&self.frame, headless, reason))?;
            self.frame = Arc::new(merged);
        }
        Ok(())
    }
}

impl ChangeColors {
    fn color(self, dressed: &mut Dressed, headless: &Headless, style: &Style) {
        let index = dressed.frame.index;
        let count = headless.sequence().len();
        let mut keeps = |why: String| {
            let problem = format!("{} keeps its colours: {why}", frame_with_index(index, count));
            dressed.problems.push(problem);
        };
        let other = i64::try_from(index).ok().and_then(|index| {
            let other = usize::try_from(index.checked_add(self.step)?).ok()?;
            (other < count).then_some(other)
        });
        let Some(other) = other else {
            return keeps(format!("there is no frame {} later", self.step));
        };
        let other = match headless.frame_beside(other, style) {
            Ok(other) => other,
            Err(error) => return keeps(error.to_string()),
        };
        let places = dressed.frame.frame.positions();
        match Change::between(places, other.frame.positions(), || true) {
            Some(change) => {
                let range = self.range.unwrap_or(change.usual_range());
                let map = style.colors.map;
                let paint = Paint::change(range, map);
                let colors = change.colors(range, map);
                dressed.frame = Arc::new(dressed.frame.in_colors(&colors, paint));
            }
            None => keeps(format!("{} has no points", frame_with_index(other.index, count))),
        }
    }
}

fn invalid(pose: &PreparedFrame, headless: &Headless, reason: crate::cloud::CloudError) -> FrameError {
    FrameError::Invalid {
        index: pose.index,
        path: headless.sequence().entry(pose.index).path.clone(),
        reason,
    }
}
