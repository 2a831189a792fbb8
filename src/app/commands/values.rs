//! Commands that take a value: a script gives it, or an item of a menu.

use super::common::{Row, needs_sequence};
use crate::app::command::Command;
use crate::app::presets::built_in;
use crate::app::state::{State, WindowRequest};
use crate::scene::describe::Described;
use crate::timeline::{MAX_SPEED, MIN_SPEED};
use std::path::PathBuf;

pub(super) const ROWS: &[Row] = &[
    Row::taking(Command::new("open"), "Open by name", "INPUT", |state, input| {
        state.open_paths(vec![PathBuf::from(input)]);
        Ok(())
    }),
    Row::taking(Command::new("compare"), "Compare by name", "INPUT", |state, input| {
        state.compare_paths(vec![PathBuf::from(input)]);
        Ok(())
    })
    .applies(needs_sequence),
    Row::taking(Command::new("frame"), "Go to a frame", "NUMBER", |state, number| {
        let count = state.player.as_ref().map_or(0, |player| player.sequence().len());
        match number.parse::<usize>() {
            Ok(place) if (1..=count).contains(&place) => {
                state.play_with(|player, now| player.seek(place - 1, now));
                Ok(())
            }
            _ => Err(format!("frames are numbered from 1 to {count}")),
        }
    })
    .applies(needs_sequence),
    Row::taking(Command::new("speed"), "Play at a speed", "FACTOR", |state, factor| {
        let is_offered = |speed: &f64| (MIN_SPEED..=MAX_SPEED).contains(&speed.abs());
        let Some(speed) = factor.parse().ok().filter(is_offered) else {
            return Err(format!(
                "speeds are numbers from {MIN_SPEED} to {MAX_SPEED}, or below 0 backward"
            ));
        };
        state.play_with(|player, now| player.set_speed(speed, now));
        Ok(())
    })
    .applies(needs_sequence),
    Row::taking(Command::new("view"), "Look from a view", "TEXT", |state, text| {
        let camera = text.parse().map_err(|error| format!("{error}"))?;
        state.camera = camera;
        Ok(())
    }),
    Row::taking(Command::new("set"), "Change a setting", "NAME VALUE", set),
    Row::taking(Command::PRESET, "Take a preset", "NAME", preset),
    Row::taking(
        Command::BUILT_IN_PRESET,
        "Take a built-in preset",
        "NAME",
        built_in_preset,
    ),
    Row::taking(Command::DELETE_PRESET, "Delete a preset", "NAME", |state, name| {
        state.kept.presets.delete(name)
    }),
    Row::taking(
        Command::new("picture"),
        "Save picture to a file",
        "FILE",
        |state, file| {
            state.request(WindowRequest::Screenshot(Some(PathBuf::from(file))));
            Ok(())
        },
    )
    .applies(needs_sequence),
    Row::taking(Command::new("click"), "Click on the picture", "X Y", |state, place| {
        let shares: Vec<f32> = place
            .split_whitespace()
            .filter_map(|share| share.parse().ok())
            .collect();
        let &[x, y] = &shares[..] else {
            return Err("a place is two shares of the picture, as 0.5 0.5 for its middle".to_owned());
        };
        let rect = state.viewport.rect;
        state.click_at(rect.min + rect.size() * egui::vec2(x, y));
        Ok(())
    })
    .applies(needs_sequence),
];

/// Gives a setting the value that the command line would.
fn set(state: &mut State, text: &str) -> Result<(), String> {
    let (name, value) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    let is_it = |described: &Described| {
        described.key == name || described.flag == name || described.other_flags.contains(&name)
    };
    let settings = state.style.settings();
    let Some((described, _)) = settings.into_iter().find(|(described, _)| is_it(described)) else {
        return Err(format!(
            "there is no setting {name}: they are called as on the command line, without --"
        ));
    };
    let given = described.parse(value.trim())?;
    state.style.edit(&mut |other, before| {
        let chosen = given.iter().find(|(key, _)| *key == other.key);
        chosen.map_or(before, |(_, value)| *value)
    });
    Ok(())
}

/// Draws as a preset of this name says.
fn preset(state: &mut State, name: &str) -> Result<(), String> {
    let is_name = |other: &str| other.eq_ignore_ascii_case(name);
    if let Some(preset) = state.kept.presets.list().iter().find(|preset| is_name(&preset.name)) {
        state.style = preset.settings;
        return Ok(());
    }
    built_in_preset(state, name)
}

/// Draws as the built-in preset of this name says.
fn built_in_preset(state: &mut State, name: &str) -> Result<(), String> {
    let built_in = built_in();
    let Some((.., style)) = built_in.iter().find(|(other, ..)| other.eq_ignore_ascii_case(name)) else {
        return Err(format!("there is no preset {name}"));
    };
    state.draw_as(style);
    Ok(())
}
