//! Commands of colours: the sources that the open sequence has, and the colour maps.

use super::common::Row;
use crate::analysis::ColorMap;
use crate::app::color_sources::{fields, lack_of, sources};
use crate::app::command::{Command, Offer};
use crate::app::state::State;
use crate::playback::Player;
use crate::scene::coloring::{MAP, MAPS, SOURCES};
use crate::sequence::ColorSource;

pub(super) const ROWS: &[Row] = &[
    Row::taking(
        Command::new("colours"),
        "Colour by a source",
        "SOURCE",
        |state, source| {
            let source = source.parse().map_err(|error| format!("{error}"))?;
            state.style.colors.choose(source);
            Ok(())
        },
    )
    .offers(|state, _| offered_sources(state)),
    Row::taking(
        Command::new("colour map"),
        "Choose a colour map",
        "MAP",
        |state, map| {
            state.style.colors.map = map.parse::<ColorMap>().map_err(|error| format!("{error}"))?;
            Ok(())
        },
    )
    .offers(|_, _| {
        let words = MAPS.list.iter();
        let offer = |word: &'static crate::scene::describe::Word| {
            let text = format!("{}: {}", MAP.title, word.title);
            Offer::new(text, word.word).hint(word.hint).also(word.also)
        };
        words.map(offer).collect()
    }),
];

/// The sources of colours that the shown frame has, and those that it has not with the reason.
fn offered_sources(state: &State) -> Vec<Offer> {
    let shown = state.player.as_ref().and_then(Player::shown);
    let frame = shown.map(|shown| &*shown.frame);
    let named = fields(frame);
    let listed = sources(ColorSource::Auto, &named);
    let offer = |(title, source, hint): (&str, ColorSource, &'static str)| {
        let word = SOURCES.list.iter().find(|word| word.title == title);
        let offer = Offer::new(format!("Colours: {title}"), source.to_string());
        Offer {
            hint,
            also: word.map_or(&["colour by", "scalar field", "attribute"], |word| word.also),
            why_not: frame.and_then(|frame| lack_of(source, frame)),
            ..offer
        }
    };
    listed.into_iter().map(offer).collect()
}
