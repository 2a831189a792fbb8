//! A way to draw that was chosen by its measured time and error, or with a session. Who draws and how many pixels is no
//! part of a document; that of such a way is used for the open sequence alone, and comes back with the next.

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
    pub(super) fn usual_style(&self, style: Settings) -> Settings {
        self.measured_way.map_or(style, |way| way.undone(style))
    }

    /// The settings, those of A where two ways to draw are compared.
    pub(super) fn style_of_a(&self) -> Settings {
        let comparison = self.comparison.as_ref();
        let of_a = comparison.filter(|comparison| comparison.edited == Side::B);
        of_a.map_or(self.style, |comparison| comparison.other)
    }
}
