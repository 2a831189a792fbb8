//! Simulated mouse gestures: presses, 125 moves per second, releases.

use egui::{Event, Modifiers, PointerButton, Pos2, Rect, pos2, vec2};
use std::f32::consts::TAU;
use std::time::Duration;

/// Between two moves, as of most mice.
const MOVE_INTERVAL: Duration = Duration::from_millis(8);

/// Once around, or once there and back.
const ROUND: Duration = Duration::from_secs(2);

/// The path of the pointer.
#[derive(Debug, Clone, Copy)]
enum Way {
    /// Circular drag around the centre of a rectangle.
    Around(Rect),
    /// Along a rectangle, to and fro.
    Along(Rect),
}

/// A drag.
#[derive(Debug)]
pub(super) struct Gesture {
    way: Way,
    begin: Duration,
    length: Duration,
    /// Moves so far.
    moves: u32,
    is_pressed: bool,
}

impl Gesture {
    /// Creates a drag around the centre of `rect`.
    pub(super) fn around(rect: Rect, begin: Duration, length: Duration) -> Self {
        Self::new(Way::Around(rect), begin, length)
    }

    /// A drag along `rect`.
    pub(super) fn along(rect: Rect, begin: Duration, length: Duration) -> Self {
        Self::new(Way::Along(rect), begin, length)
    }

    fn new(way: Way, begin: Duration, length: Duration) -> Self {
        Self {
            way,
            begin,
            length,
            moves: 0,
            is_pressed: false,
        }
    }

    /// When the hand moves next.
    pub(super) fn next_deadline(&self) -> Duration {
        self.begin + self.moves * MOVE_INTERVAL
    }

    /// Returns the mouse events up to `now`, and true if the button has been released. The timestamps of moves are
    /// appended to `event_times`.
    pub(super) fn advance(&mut self, now: Duration, event_times: &mut Vec<Duration>) -> (Vec<Event>, bool) {
        let mut events = Vec::new();
        while self.next_deadline() <= now {
            let due = self.next_deadline();
            let place = self.place(due.saturating_sub(self.begin));
            events.push(Event::PointerMoved(place));
            if !self.is_pressed {
                self.is_pressed = true;
                events.push(button(place, true));
            } else if due.saturating_sub(self.begin) >= self.length {
                events.push(button(place, false));
                return (events, true);
            } else {
                event_times.push(due);
            }
            self.moves += 1;
        }
        (events, false)
    }

    fn place(&self, after: Duration) -> Pos2 {
        let rounds = after.as_secs_f32() / ROUND.as_secs_f32();
        match self.way {
            Way::Around(rect) => {
                let radius = 0.25 * rect.width().min(rect.height());
                rect.center() + radius * vec2((rounds * TAU).cos(), (rounds * TAU).sin())
            }
            Way::Along(rect) => {
                let share = 1.0 - (2.0 * rounds.fract() - 1.0).abs();
                pos2(rect.left() + 2.0 + share * (rect.width() - 4.0), rect.center().y)
            }
        }
    }
}

fn button(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drag_presses_once_moves_evenly_and_releases() {
        let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(300.0, 200.0));
        let ms = Duration::from_millis;
        let mut gesture = Gesture::around(rect, ms(1000), ms(80));
        let mut event_times = Vec::new();
        let mut all = Vec::new();
        // The second call comes late: events that were due in the meantime are delivered with their own times.
        for now in [1000, 1050, 1079] {
            let (events, is_over) = gesture.advance(ms(now), &mut event_times);
            assert!(!is_over);
            all.extend(events);
        }
        let (events, is_over) = gesture.advance(ms(1090), &mut event_times);
        all.extend(events);
        assert!(is_over);
        let expected: Vec<_> = (1..10).map(|index| ms(1000 + 8 * index)).collect();
        assert_eq!(event_times, expected);
        let presses: Vec<_> = all
            .iter()
            .filter_map(|event| match event {
                Event::PointerButton { pressed, .. } => Some(*pressed),
                _ => None,
            })
            .collect();
        assert_eq!(presses, [true, false]);
        let is_inside = |event: &Event| match event {
            Event::PointerMoved(place) => rect.contains(*place),
            _ => true,
        };
        assert!(all.iter().all(is_inside));
    }

    #[test]
    fn a_drag_along_a_bar_reaches_both_ends() {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(100.0, 10.0));
        let gesture = Gesture::along(rect, Duration::ZERO, ROUND);
        let x = |ms: u64| gesture.place(Duration::from_millis(ms)).x;
        assert_eq!([x(0), x(1000), x(2000)], [2.0, 98.0, 2.0]);
    }
}
