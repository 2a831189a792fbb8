//! Commands of playback.

use super::common::{Row, group, needs_sequence};
use crate::app::command::{Chord, Command};
use crate::app::state::State;
use crate::playback::Player;
use crate::timeline::{LoopMode, MAX_SPEED, MIN_SPEED};
use egui::Key;
use std::time::Duration;

pub(super) const ROWS: &[Row] = &[
    Row::new(Command::TOGGLE_PLAY, "Play", |state| state.play_with(Player::toggle))
        .what("Play or pause")
        .also(&["start", "stop", "resume", "playback"])
        .keys(group::PLAYING, "Space", &[Chord::plain(Key::Space)])
        .titled(|state| match &state.player {
            Some(player) if player.is_playing() => "Pause".into(),
            _ => "Play".into(),
        })
        .applies(needs_sequence),
    Row::new(Command::NEXT_FRAME, "Next frame", |state| state.step_frames(1))
        .also(&["step forward", "advance"])
        .keys(group::PLAYING, "Right", &[Chord::plain(Key::ArrowRight)])
        .repeating()
        .applies(needs_sequence),
    Row::new(Command::PREVIOUS_FRAME, "Previous frame", |state| state.step_frames(-1))
        .also(&["step backward", "step back"])
        .keys(group::PLAYING, "Left", &[Chord::plain(Key::ArrowLeft)])
        .repeating()
        .applies(needs_sequence),
    Row::new(Command::new("ten frames on"), "Ten frames on", |state| {
        state.step_frames(10);
    })
    .also(&["skip forward", "jump forward"])
    .keys(group::PLAYING, "Shift+Right", &[Chord::shift(Key::ArrowRight)])
    .repeating()
    .applies(needs_sequence),
    Row::new(Command::new("ten frames back"), "Ten frames back", |state| {
        state.step_frames(-10);
    })
    .also(&["skip back", "jump back"])
    .keys(group::PLAYING, "Shift+Left", &[Chord::shift(Key::ArrowLeft)])
    .repeating()
    .applies(needs_sequence),
    Row::new(Command::FIRST, "First frame", |state| {
        state.play_with(|player, now| player.seek(0, now));
    })
    .also(&["start", "beginning", "go to start", "rewind"])
    .keys(group::PLAYING, "Home", &[Chord::plain(Key::Home)])
    .applies(needs_sequence),
    Row::new(Command::LAST, "Last frame", |state| {
        state.play_with(|player, now| player.seek(usize::MAX, now));
    })
    .also(&["end", "go to end"])
    .keys(group::PLAYING, "End", &[Chord::plain(Key::End)])
    .applies(needs_sequence),
    Row::new(
        Command::new("follow"),
        "Follow the newest frame of a folder that grows",
        |state| {
            state.play_with(|player, now| player.follow_newest(!player.follows_newest(), now));
        },
    )
    .also(&["live", "watch", "tail", "latest"])
    .keys(group::PLAYING, "Shift+End", &[Chord::shift(Key::End)])
    .applies(needs_sequence),
    Row::new(Command::NEXT_LOOP_MODE, "Once, loop or ping-pong", |state| {
        state.play_with(|player, now| {
            let next = next_loop_mode(player.clock().loop_mode());
            player.set_loop_mode(next, now);
        });
    })
    .what("Loop mode: once, loop, ping-pong")
    .also(&["repeat", "cycle", "bounce"])
    .keys(group::PLAYING, "L", &[Chord::plain(Key::L)])
    .applies(needs_sequence),
    Row::new(Command::SLOWER, "Slower", |state| {
        state.play_with(|player, now| {
            let next = |speed| SPEEDS.iter().rev().copied().find(|&s| s < speed - 1e-9);
            change_speed(player, now, next);
        });
    })
    .what("Slower: lower speed")
    .also(&["slow motion", "slow down", "playback speed"])
    .keys(group::PLAYING, "[", &[Chord::any_shift(Key::OpenBracket)])
    .repeating()
    .applies(needs_sequence),
    Row::new(Command::FASTER, "Faster", |state| {
        state.play_with(|player, now| {
            let next = |speed| SPEEDS.iter().copied().find(|&s| s > speed + 1e-9);
            change_speed(player, now, next);
        });
    })
    .what("Faster: higher speed")
    .also(&["fast forward", "speed up", "playback speed"])
    .keys(group::PLAYING, "]", &[Chord::any_shift(Key::CloseBracket)])
    .repeating()
    .applies(needs_sequence),
    Row::new(Command::REVERSE, "Reverse", |state| {
        state.play_with(|player, now| player.set_speed(-player.clock().speed(), now));
    })
    .what("Reverse: play backward")
    .also(&["rewind", "backwards"])
    .keys(group::PLAYING, "Backspace", &[Chord::plain(Key::Backspace)])
    .applies(needs_sequence),
];

impl State {
    /// Pauses and steps by `count` frames, forward or back.
    pub fn step_frames(&mut self, count: i64) {
        self.play_with(|player, now| player.step(count, now));
    }
}

/// The speeds that the keys step through.
pub(super) const SPEEDS: [f64; 9] = [0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 10.0];

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
