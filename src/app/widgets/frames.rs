//! Controls for numbers of frames, which say "1 frame" and "2 frames".

use super::numbers::parse_counted;
use crate::messages::counted;
use egui::{DragValue, Slider};

/// A slider over a number of frames.
pub(in crate::app) fn frames_slider(slider: Slider<'_>) -> Slider<'_> {
    slider
        .integer()
        .custom_formatter(|count, _| counted(count as i64, "frame"))
        .custom_parser(parse_counted)
}

/// A number of frames to drag.
pub(in crate::app) fn frames_drag(drag: DragValue<'_>) -> DragValue<'_> {
    drag.max_decimals(0)
        .custom_formatter(|count, _| counted(count as i64, "frame"))
        .custom_parser(parse_counted)
}
