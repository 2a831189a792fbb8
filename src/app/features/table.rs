//! The table of features: a line for each. All that the window does with every feature goes through it.

use super::assumptions::Assumptions;
use super::benchmark::Benchmark;
use super::beside::Beside;
use super::camera_path::PathEditor;
use super::clipping::Clipping;
use super::comparison::Comparison;
use super::export::Export;
use super::feature::{Feature, FeatureOf};
use super::inspection::Inspection;
use super::labels::Labels;
use super::notes::Notes;
use super::palette::Palette;
use super::photos::Photos;
use super::quality::MeasuredQuality;
use super::save::Save;
use super::temporal::Temporal;
use super::thumbnails::Thumbnails;
use super::timeline::Timeline;
use super::trails::Trails;
use std::marker::PhantomData;

/// Declares what features there are.
macro_rules! features {
    ($($(#[$doc:meta])* $name:ident: $feature:ty,)*) => {
        /// The features of the window, in the order in which they are updated, laid out and painted.
        #[derive(Debug, Default)]
        pub struct Features {
            $($(#[$doc])* pub $name: $feature,)*
        }

        impl Features {
            /// What a window with the state `S` does with each of them.
            pub(in crate::app) fn rows<S: 'static>() -> [&'static dyn Feature<S>; [$(stringify!($name)),*].len()]
            where
                $(FeatureOf<$feature>: Feature<S>,)*
            {
                [$(const { &FeatureOf::<$feature>(PhantomData) }),*]
            }
        }
    };
}

features! {
    /// Commands by their names.
    palette: Palette,
    /// Markers and curve of the open sequence.
    timeline: Timeline,
    /// Another way to draw beside the one of the settings.
    comparison: Option<Comparison>,
    /// Another sequence beside the open one; never together with `comparison`.
    beside: Option<Beside>,
    /// What is known of the open sequence's ways to draw, from fast to exact.
    quality: MeasuredQuality,
    /// What other poses add to the picture.
    temporal: Temporal,
    /// The camera path that is being made.
    path: PathEditor,
    /// The ways of points through time.
    trails: Trails,
    /// What was clicked on.
    inspection: Inspection,
    /// Texts at points.
    labels: Labels,
    /// A text that is kept with the open sequence.
    notes: Notes,
    /// Photographs of what is shown.
    photos: Photos,
    /// What was assumed about the open sequence.
    assumptions: Assumptions,
    /// What is known of what is clipped.
    clipping: Clipping,
    /// Small pictures of the frames.
    thumbnails: Thumbnails,
    /// What a person would export.
    export: Export,
    /// As what a person would save the sequence.
    save: Save,
    /// The benchmark window's content.
    benchmark: Benchmark,
}
