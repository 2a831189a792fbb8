//! The table of features: a line for each. All that the window does with every feature goes through it.

use super::assumptions::Assumptions;
use super::benchmark::{Benchmark, BenchmarkSetup};
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
use super::split_view::SplitView;
use super::temporal::Temporal;
use super::thumbnails::Thumbnails;
use super::timeline::Timeline;
use super::trails::Trails;
use std::marker::PhantomData;

/// Declares the features.
macro_rules! features {
    ($($(#[$doc:meta])* $name:ident: $feature:ty,)*) => {
        /// The features of the window, in the order in which they are updated, laid out and painted.
        #[derive(Debug, Default)]
        pub struct Features {
            $($(#[$doc])* pub $name: $feature,)*
        }

        impl Features {
            /// Returns the feature rows of a window with the state `S`.
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
    /// Second render mode for comparison, in addition to the settings'.
    comparison: Option<Comparison>,
    /// Second sequence for comparison alongside the open one; never together with `comparison`.
    split_view: Option<SplitView>,
    /// Measured quality of the open sequence's render modes, from fast to exact.
    quality: MeasuredQuality,
    /// Derived frames that add to the image.
    temporal: Temporal,
    /// The camera path that is being made.
    path: PathEditor,
    /// Trajectories of points.
    trails: Trails,
    /// Inspection: points that were clicked on.
    inspection: Inspection,
    /// Texts at points.
    labels: Labels,
    /// A text that is stored with the open sequence.
    notes: Notes,
    /// View-dependent texturing: input images of the shown frame.
    photos: Photos,
    /// Assumptions about the open sequence.
    assumptions: Assumptions,
    /// Clipping state.
    clipping: Clipping,
    /// Thumbnails of the frames.
    thumbnails: Thumbnails,
    /// Export settings of the user.
    export: Export,
    /// Settings for saving the sequence.
    save: Save,
    /// Choices for a benchmark that was not started yet.
    benchmark_setup: Option<BenchmarkSetup>,
    /// The benchmark window's content.
    benchmark: Benchmark,
}
