//! Commands that concern the playing sequence alone.

use crate::app::command::Command;
use crate::playback::Player;
use crate::timeline::{LoopMode, MAX_SPEED, MIN_SPEED};
use std::time::Duration;

/// The speeds that the keys step through.
const SPEEDS: [f64; 9] = [0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 10.0];

/// Does what such a command says; others do nothing.
pub(in crate::app) fn steer(player: &mut Player, command: Command, now: Duration) {
    match command {
        Command::TogglePlay => player.toggle(now),
        Command::Step(count) => player.step(count, now),
        Command::First => player.seek(0, now),
        Command::Last => player.seek(usize::MAX, now),
        Command::ToggleFollow => player.follow_newest(!player.follows_newest(), now),
        Command::NextLoopMode => {
            let next = next_loop_mode(player.clock().loop_mode());
            player.set_loop_mode(next, now);
        }
        Command::Slower => change_speed(player, now, |speed| {
            SPEEDS.iter().rev().copied().find(|&s| s < speed - 1e-9)
        }),
        Command::Faster => change_speed(player, now, |speed| SPEEDS.iter().copied().find(|&s| s > speed + 1e-9)),
        Command::Reverse => player.set_speed(-player.clock().speed(), now),
        _ => {}
    }
}

fn change_speed(player: &mut Player, now: Duration, next: impl Fn(f64) -> Option<f64>) {
    let speed = player.clock().speed();
    if let Some(size) = next(speed.abs()) {
        player.set_speed(size.clamp(MIN_SPEED, MAX_SPEED).copysign(speed), now);
    }
}

/// Off, loop, ping-pong, off …
fn next_loop_mode(mode: LoopMode) -> LoopMode {
    let index = LoopMode::ALL.iter().position(|&other| other == mode).unwrap_or(0);
    LoopMode::ALL[(index + 1) % LoopMode::ALL.len()]
}
