//! A way to draw that was chosen by its measured time and error, or with a session. It is of the open sequence, so it
//! is used for this one alone: the settings that it has changed come back with the next.

use super::MeasuredQuality;
use crate::app::features::feature::Feature;
use crate::app::features::quality::MeasuredWay;
use crate::app::side::Side;
use crate::app::state::State;
use crate::scene::Style;

impl State {
    /// Draws the open sequence as `way`, which was measured with it.
    pub fn draw_as_measured(&mut self, way: &Style) {
        let before = self.usual_style(self.style);
        self.draw_as(way);
        let chosen = self.style;
        self.opening.measured_way = Some(MeasuredWay { before, chosen });
    }

    /// Settings as they are for other sequences.
    fn usual_style(&self, style: Style) -> Style {
        self.opening.measured_way.map_or(style, |way| way.undone(style))
    }

    /// The settings, those of A where two ways to draw are compared.
    pub(in crate::app) fn style_of_a(&self) -> Style {
        let comparison = self.features.comparison.as_ref();
        let of_a = comparison.filter(|comparison| comparison.edited == Side::B);
        of_a.map_or(self.style, |comparison| comparison.other)
    }

    /// What is kept of the settings.
    pub(in crate::app) fn style_to_keep(&self) -> Style {
        self.usual_style(self.style_of_a())
    }

    /// The open sequence is left: others are drawn as before it was measured.
    pub(in crate::app) fn forget_measured_way(&mut self) {
        self.style = self.usual_style(self.style);
        self.opening.measured_way = None;
    }
}

impl Feature<State> for MeasuredQuality {
    /// Reads what was measured of the open sequence before.
    fn update(state: &mut State) -> bool {
        let Some(player) = &state.player else {
            return false;
        };
        state.features.quality.look(&state.graphics.adapter, player.sequence())
    }

    fn forget_sequence(state: &mut State) {
        state.forget_measured_way();
        state.features.quality.forget();
    }
}
