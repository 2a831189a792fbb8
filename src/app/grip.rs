//! Dragging of the 3-D view: from a button press on it until that button is released.
//!
//! **How it works.** egui detects a drag only where it sees the button down at the end of a pass, and drops the pointer
//! motion between the last pass and the release: at 10 frames per second a short, fast drag is lost as a whole, and
//! long ones end short. So the pointer's events are followed one by one, all of them that came since the last pass. A
//! pointer that trembles during a click is not a drag: the first [`Grip::SLACK`] points are held back, and are made up
//! for once they are left.

use egui::{Event, Modifiers, PointerButton, Pos2, Vec2};

/// A button held down on the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grip {
    button: PointerButton,
    modifiers: Modifiers,
    /// Up to here the pointer was followed.
    place: Pos2,
    is_dragging: bool,
}

/// Drag displacement of the pointer on the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pull {
    /// The button that is held.
    pub(super) button: PointerButton,
    /// The keys that are held.
    pub(super) modifiers: Modifiers,
    /// Points to the right and down.
    pub(super) by: Vec2,
}

impl Grip {
    /// A click may move as far as this, points: as egui has it.
    const SLACK: f32 = 6.0;

    /// Follows `events`, the latest of which left `modifiers`. `is_on_picture` is true where a button press grabs the
    /// image. Returns the drags, in order.
    pub(super) fn follow(
        grip: &mut Option<Self>,
        events: &[Event],
        modifiers: Modifiers,
        is_on_picture: impl Fn(Pos2) -> bool,
    ) -> Vec<Pull> {
        if let Some(held) = grip {
            held.modifiers = modifiers;
        }
        let mut pulls = Vec::new();
        for event in events {
            match *event {
                Event::PointerMoved(place) => {
                    pulls.extend(grip.as_mut().and_then(|held| held.pull(place)));
                }
                Event::PointerButton {
                    pos,
                    button,
                    pressed: true,
                    modifiers,
                } if grip.is_none() && is_on_picture(pos) => {
                    *grip = Some(Self {
                        button,
                        modifiers,
                        place: pos,
                        is_dragging: false,
                    });
                }
                Event::PointerButton {
                    pos,
                    button,
                    pressed: false,
                    ..
                } if grip.is_some_and(|held| held.button == button) => {
                    pulls.extend(grip.take().and_then(|mut held| held.pull(pos)));
                }
                Event::WindowFocused(false) => *grip = None,
                _ => {}
            }
        }
        pulls
    }

    fn pull(&mut self, to: Pos2) -> Option<Pull> {
        let by = to - self.place;
        self.is_dragging |= by.length() > Self::SLACK;
        if !self.is_dragging || by == Vec2::ZERO {
            return None;
        }
        self.place = to;
        Some(Pull {
            button: self.button,
            modifiers: self.modifiers,
            by,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{pos2, vec2};
    use proptest::prelude::*;

    fn button(pos: Pos2, button: PointerButton, pressed: bool) -> Event {
        Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers: Modifiers::NONE,
        }
    }

    fn press(pos: Pos2) -> Event {
        button(pos, PointerButton::Primary, true)
    }

    fn release(pos: Pos2) -> Event {
        button(pos, PointerButton::Primary, false)
    }

    fn follow(grip: &mut Option<Grip>, events: &[Event]) -> Vec2 {
        Grip::follow(grip, events, Modifiers::NONE, |pos| pos.x >= 0.0)
            .iter()
            .map(|pull| pull.by)
            .fold(Vec2::ZERO, |sum, by| sum + by)
    }

    proptest! {
        /// However events are split into passes, the image is dragged from the press to the release of the button.
        #[test]
        fn no_part_of_a_drag_is_lost(
            path in prop::collection::vec((0f32..500.0, 0f32..500.0), 0..12),
            pass_length in 1usize..15,
        ) {
            let (from, to) = (pos2(10.0, 20.0), pos2(310.0, 220.0));
            let moves = path.iter().map(|&(x, y)| Event::PointerMoved(pos2(x, y)));
            let events: Vec<Event> = std::iter::once(press(from)).chain(moves).chain([release(to)]).collect();
            let mut grip = None;
            let dragged = events
                .chunks(pass_length)
                .fold(Vec2::ZERO, |sum, pass| sum + follow(&mut grip, pass));
            prop_assert!((dragged - vec2(300.0, 200.0)).length() < 0.01, "{:?}", dragged);
            prop_assert_eq!(grip, None);
        }
    }

    #[test]
    fn a_shaky_click_is_not_a_drag() {
        let mut grip = None;
        let at = pos2(50.0, 50.0);
        let tremble = [
            press(at),
            Event::PointerMoved(at + vec2(3.0, -2.0)),
            release(at + vec2(1.0, 1.0)),
        ];
        assert_eq!(follow(&mut grip, &tremble), Vec2::ZERO);
        // Moving away slowly: none of the motion held back is lost.
        assert_eq!(follow(&mut grip, &[press(at)]), Vec2::ZERO);
        let steps = (1..=20).map(|step| follow(&mut grip, &[Event::PointerMoved(at + vec2(step as f32, 0.0))]));
        assert_eq!(steps.fold(Vec2::ZERO, |sum, by| sum + by), vec2(20.0, 0.0));
    }

    #[test]
    fn only_a_button_pressed_on_the_image_drags_it() {
        let mut grip = None;
        let far = pos2(200.0, 0.0);
        let elsewhere = pos2(-10.0, 0.0);
        assert_eq!(
            follow(&mut grip, &[press(elsewhere), Event::PointerMoved(far), release(far)]),
            Vec2::ZERO
        );
        assert_eq!(follow(&mut grip, &[Event::PointerMoved(elsewhere)]), Vec2::ZERO);

        // Another button neither takes over the drag nor releases it.
        let second = |pressed| button(far, PointerButton::Secondary, pressed);
        let pulls = Grip::follow(
            &mut grip,
            &[press(pos2(0.0, 0.0)), second(true), second(false), release(far)],
            Modifiers::NONE,
            |_| true,
        );
        assert_eq!(pulls.len(), 1);
        assert_eq!(
            (pulls[0].button, pulls[0].by),
            (PointerButton::Primary, vec2(200.0, 0.0))
        );

        // A window without focus is not notified that the button was released.
        assert_eq!(
            follow(&mut grip, &[press(far), Event::WindowFocused(false)]),
            Vec2::ZERO
        );
        assert_eq!(grip, None);
    }
}
