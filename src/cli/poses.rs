//! What other poses add to a picture: colours by how far each point is from another frame, ghosts, and the ways of points.

use super::arguments::FrameRange;
use super::say;
use crate::app::OnionSkin;
use crate::headless::Headless;
use crate::measure::Change;
use crate::octree::StopCriterion;
use crate::scene::{Scene, Settings};
use crate::sequence::{Ghost, Needs, PreparedFrame, TrailRequest, Trails, with_ghosts};
use anyhow::bail;
use clap::Args;
use std::sync::Arc;

/// The colour of trails; what is still to come is half as bright.
const TRAIL_TINT: [u8; 3] = [255, 190, 60];

/// Radius of trails, as a share of that of the frame.
const TRAIL_RADIUS: f32 = 0.003;

/// Which other poses.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct PosesArgs {
    /// Colour points by their distance to the frame that is K later (negative: earlier), up to what 99 % do not exceed; --lighting
    /// none leaves the colours as they are
    #[arg(
        long,
        value_name = "K",
        allow_negative_numbers = true,
        conflicts_with = "video"
    )]
    change: Option<i64>,

    /// The distance in the last colour of --change, scene units
    #[arg(long, value_name = "D", requires = "change", value_parser = super::arguments::not_negative_f64)]
    change_range: Option<f64>,

    /// Draw so many frames before and after as ghosts, 0 to 8
    #[arg(long, value_name = "N", conflicts_with = "video", value_parser = clap::value_parser!(u8).range(0..=8))]
    onion: Option<u8>,

    /// Frames from one ghost to the next
    #[arg(long, value_name = "N", requires = "onion", value_parser = clap::value_parser!(u16).range(1..))]
    onion_step: Option<u16>,

    /// Draw the ways that the points of these indices (counted from 0) take through the frames of --frame, of one frame through all
    #[arg(
        long,
        value_name = "INDEX,…",
        value_delimiter = ',',
        conflicts_with = "video"
    )]
    trail: Vec<u32>,
}

impl PosesArgs {
    /// The trails that were asked for, through the frames of `range`; where they end is said.
    pub(super) fn trails(
        &self,
        range: FrameRange,
        headless: &Headless,
        settings: &Settings,
    ) -> anyhow::Result<Option<Trails>> {
        if self.trail.is_empty() {
            return Ok(None);
        }
        let sequence = headless.sequence();
        let chosen_in = headless.frame(range.first, settings)?;
        let points_in_file = chosen_in.frame.points_in_file();
        let is_missing = |index: &&u32| **index as usize >= points_in_file;
        if let Some(index) = self.trail.iter().find(is_missing) {
            bail!(
                "there is no point {index}: frame {} has {points_in_file} points, counted from 0",
                range.first
            );
        }
        let frames = if range.first == range.last {
            0..sequence.len()
        } else {
            range.first..range.last + 1
        };
        let request = TrailRequest {
            indices: self.trail.clone(),
            chosen_in: range.first,
            points_in_file,
            frames,
        };
        let trails = Trails::trace(&request, sequence, |_| None, |_| true);
        for broken in trails.iter().flat_map(Trails::breaks) {
            say(&format!("warning: trails break: {}", broken.text(0)));
        }
        Ok(trails)
    }

    /// `frame` with what was asked for; as it is where nothing was.
    pub(super) fn with_others(
        &self,
        frame: Arc<PreparedFrame>,
        trails: Option<&Trails>,
        headless: &Headless,
        settings: &Settings,
    ) -> anyhow::Result<Arc<PreparedFrame>> {
        let mut drawn = frame;
        if let Some(step) = self.change {
            drawn = self.in_change_colors(drawn, step, headless, settings)?;
        }
        if let Some(count) = self.onion.map(usize::from) {
            let onion = OnionSkin {
                before: count,
                after: count,
                step: self.onion_step.map_or(1, usize::from),
                ..OnionSkin::default()
            };
            let around = onion.around(drawn.index, headless.sequence().len());
            let ghosts = around.into_iter().map(|(index, share, tint)| {
                let frame = headless.frame(index, settings)?;
                Ok(Ghost { frame, share, tint })
            });
            let ghosts = ghosts.collect::<anyhow::Result<Vec<Ghost>>>()?;
            drawn = Arc::new(with_ghosts(&drawn, &ghosts, &Scene::needs(settings))?);
        }
        if let Some(trails) = trails {
            let radius = TRAIL_RADIUS * drawn.frame.bounds().radius();
            let tubes = (0..trails.trail_count()).map(|trail| {
                Ok(Ghost {
                    frame: Arc::new(trails.tube(trail, drawn.index, radius)?),
                    share: 1.0,
                    tint: TRAIL_TINT,
                })
            });
            let tubes = tubes.collect::<anyhow::Result<Vec<Ghost>>>()?;
            // Tubes have so many points that a loss would divide the pose's cells as well.
            let depth = drawn.octree.as_ref().map(|octree| octree.depth());
            let needs = Needs {
                octree: depth.map(StopCriterion::Depth),
                ..Scene::needs(settings)
            };
            drawn = Arc::new(with_ghosts(&drawn, &tubes, &needs)?);
        }
        Ok(drawn)
    }

    fn in_change_colors(
        &self,
        frame: Arc<PreparedFrame>,
        step: i64,
        headless: &Headless,
        settings: &Settings,
    ) -> anyhow::Result<Arc<PreparedFrame>> {
        let other = i64::try_from(frame.index)?.checked_add(step);
        let other = other.and_then(|other| usize::try_from(other).ok());
        let Some(other) = other.filter(|&other| other < headless.sequence().len()) else {
            say(&format!(
                "warning: frame {} keeps its colours: there is no frame {step} later",
                frame.index
            ));
            return Ok(frame);
        };
        let other = headless.frame(other, settings)?;
        let (places, others) = (frame.frame.positions(), other.frame.positions());
        let Some(change) = Change::between(places, others, || true) else {
            say(&format!(
                "warning: frame {} keeps its colours: frame {} has no points",
                frame.index, other.index
            ));
            return Ok(frame);
        };
        let range = self.change_range.unwrap_or(change.usual_range());
        Ok(Arc::new(frame.in_colors(&change.colors(range))))
    }
}
