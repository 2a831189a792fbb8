//! A way to draw that was chosen by its measured time and error, or with a session. It is of the open sequence, so it
//! is used for this one alone: the settings that it has changed come back with the next.

use super::State;
use crate::app::features::quality::MeasuredWay;
use crate::app::side::Side;
use crate::scene::Settings;

impl State {
    /// Draws the open sequence as `way`, which was measured with it.
    pub fn draw_as_measured(&mut self, way: &Settings) {
        let before = self.usual_style(self.style);
        self.draw_as(way);
        let chosen = self.style;
        self.measured_way = Some(MeasuredWay { before, chosen });
    }

    /// Settings as they are for other sequences.
    fn usual_style(&self, style: Settings) -> Settings {
        self.measured_way.map_or(style, |way| way.undone(style))
    }

    /// The settings, those of A where two ways to draw are compared.
    pub(super) fn style_of_a(&self) -> Settings {
        let comparison = self.comparison.as_ref();
        let of_a = comparison.filter(|comparison| comparison.edited == Side::B);
        of_a.map_or(self.style, |comparison| comparison.other)
    }

    /// What is kept of the settings.
    pub(super) fn style_to_keep(&self) -> Settings {
        self.usual_style(self.style_of_a())
    }

    /// The open sequence is left: others are drawn as before it was measured.
    pub(super) fn forget_measured_way(&mut self) {
        self.style = self.usual_style(self.style);
        self.measured_way = None;
    }
}
