//! Composition from the frame of a sequence to the packet of an image: one ordered list of stages ([`STAGES`]), for all
//! renderings.
//!
//! | stage | takes | applies | gives |
//! |---|---|---|---|
//! | frame | a frame of the sequence | always | the frame as it is ([`Composed::of`]) |
//! | change map | another frame | [`ComposeOptions::change`] | the same points in other colours |
//! | onion skin | neighbouring frames | [`ComposeOptions::onion`] | the frame among ghosts |
//! | trails | paths of points | [`ComposeOptions::trails`] | the frame among tubes |
//! | images | posed images of the frame | [`photos_apply`] | curved splats, outliers, depths |
//! | in view | surfels of the visible points | [`StandIns::in_view`] | these instead of all points |
//! | levels | the frame with levels of detail | [`StandIns::coarse`] | fewer records while the camera moves |
//! | packet | the camera | always | the packet ([`packet`]) |
//!
//! **How it works.** A stage examines the [`Inputs`] and gives a [`Step`] where it applies: all of its inputs for one
//! frame, compared by identity. Blocking callers ([`compose`]: headless images, exports, thumbnails) run stage after
//! stage. The window gathers the steps of one [`Lane`] into a [`Request`], starts it on a task if it differs from the
//! last one, and shows the plain frame meanwhile.
//!
//! A new stage is a file with its [`Step`], a row in `stages.rs`, and its options in [`ComposeOptions`].

mod change;
mod composed;
mod composer;
mod depths_ahead;
mod drawable;
mod ghosts;
mod in_view;
mod inputs;
mod levels;
mod onion;
mod onion_skin;
mod options;
mod packet;
mod photos;
mod points_in_view;
mod stages;
mod step;
mod trails;

pub use composed::{Coarse, Composed, Measured, Problem};
pub use composer::{Request, compose, with_stand_ins};
pub use depths_ahead::DepthsAhead;
pub use drawable::can_draw;
pub use ghosts::{Ghost, with_ghosts};
pub use in_view::ViewOfFrame;
pub use inputs::{Frames, Inputs, StandIns, WholeFrame};
pub use levels::{has_moving_levels, in_cells};
pub use onion_skin::OnionSkin;
pub use options::{ChangeColors, ComposeOptions, TrailLook};
pub use packet::{Drawn, PictureView, packet};
pub use photos::{PHOTO_BYTES, on_surface, photos_apply};
pub use points_in_view::points_in_view;
pub use stages::STAGES;
pub use step::{Lane, MakeStep, Stage, Step};
pub use trails::{BreakReason, TrailBreak, TrailMeasure, TrailRequest, Trails};
