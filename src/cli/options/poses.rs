//! Derived-frame options: colours by the distance of each point to another frame (change map), ghosts (onion skin), and
//! the trails of points.

use super::arguments::FrameRange;
use crate::cli::terminal::warnings;
use crate::composition::{ChangeColors, ComposeOptions, OnionSkin, TrailLook, TrailRequest, Trails};
use crate::headless::Headless;
use crate::messages::frame_with_index;
use crate::progress::Progress;
use crate::scene::Style;
use anyhow::bail;
use clap::Args;
use std::sync::Arc;

/// Options for derived frames.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Other frames")]
pub(in crate::cli) struct PosesArgs {
    /// Colour points by their distance to the frame K later (negative: earlier), cloud to cloud
    #[arg(long, hide_short_help = true, value_name = "K", allow_negative_numbers = true)]
    change: Option<i64>,

    /// Distance of the last colour of --change [default: the 99th percentile]
    #[arg(
        long,
        hide_short_help = true,
        value_name = "LENGTH",
        requires = "change",
        value_parser = super::values::not_negative_f64,
    )]
    change_range: Option<f64>,

    /// Draw N frames before and after as ghosts (onion skin)
    #[arg(long, hide_short_help = true, value_name = "0..8", value_parser = clap::value_parser!(u8).range(0..=8))]
    onion: Option<u8>,

    /// Frames between ghosts [default: 1]
    #[arg(
        long,
        hide_short_help = true,
        value_name = "N",
        requires = "onion",
        value_parser = clap::value_parser!(u16).range(1..),
    )]
    onion_step: Option<u16>,

    /// Draw the trajectories of the points with these indices
    #[arg(long, hide_short_help = true, value_name = "INDEX,…", value_delimiter = ',')]
    trail: Vec<u32>,

    /// Exclude input images from texturing, by number, counted from 0
    #[arg(
        long,
        alias = "exclude-images",
        hide_short_help = true,
        value_name = "N,…",
        value_delimiter = ','
    )]
    leave_out: Vec<usize>,
}

impl PosesArgs {
    /// All requested options, for images of the frames of `range`.
    pub(in crate::cli) fn options(
        &self,
        range: FrameRange,
        headless: &Headless,
        style: &Style,
    ) -> anyhow::Result<ComposeOptions> {
        let onion = |count: u8| OnionSkin {
            is_on: true,
            before: count.into(),
            after: count.into(),
            step: self.onion_step.map_or(1, usize::from),
            ..OnionSkin::default()
        };
        let trails = self.trails(range, headless, style)?;
        let looks = |trails: &Trails| (0..trails.trail_count()).map(TrailLook::picked).collect();
        Ok(ComposeOptions {
            change: self.change.map(|step| ChangeColors {
                step,
                range: self.change_range,
            }),
            onion: self.onion.map(onion),
            trails: trails.map(|trails| {
                let looks = looks(&trails);
                (Arc::new(trails), looks)
            }),
            skipped_photos: self.leave_out.clone(),
        })
    }

    /// The trails that were asked for, through the frames of `range`; where they end is said.
    fn trails(&self, range: FrameRange, headless: &Headless, style: &Style) -> anyhow::Result<Option<Trails>> {
        if self.trail.is_empty() {
            return Ok(None);
        }
        let sequence = headless.sequence();
        let chosen_in = headless.frame(range.first, style)?;
        let points_in_file = chosen_in.frame.points_in_file();
        let is_missing = |index: &&u32| **index as usize >= points_in_file;
        if let Some(index) = self.trail.iter().find(is_missing) {
            bail!(
                "point {index} does not exist: {} has {points_in_file} points, counted from 0",
                frame_with_index(range.first, sequence.len())
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
        let trails = Trails::trace(&request, sequence, |_| None, &Progress::default());
        for broken in trails.iter().flat_map(Trails::breaks) {
            let text = broken.text(|frame| frame_with_index(frame, sequence.len()));
            warnings::warn(&format!("trails break: {text}"));
        }
        Ok(trails)
    }
}
