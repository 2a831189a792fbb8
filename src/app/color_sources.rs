//! Sources of colours of a frame: those that it has, with their titles.

use crate::cloud::Frame;
use crate::scene::describe::Word;
use crate::scene::{coloring, field_title};
use crate::sequence::{ColorSource, FieldName, plain_field_name};

/// Max number of fields in the list.
const MAX_FIELDS: usize = 64;

/// Why a frame cannot be coloured so, if it cannot.
pub(in crate::app) fn lack_of(source: ColorSource, frame: &Frame) -> Option<&'static str> {
    let has_field = |name: FieldName| {
        frame
            .scalar_fields()
            .iter()
            .any(|field| FieldName::new(&field.name) == name)
    };
    match source {
        ColorSource::File if frame.colors().is_none() => Some("The file has no colours"),
        ColorSource::Scalar(None) if frame.scalar_fields().is_empty() => Some("The file has no scalar"),
        ColorSource::Scalar(Some(name)) if !has_field(name) => Some("The file has no scalar of this name"),
        ColorSource::Time if !source.is_of(frame) => Some("The file does not say when points were measured"),
        ColorSource::Class if !source.is_of(frame) => Some("The file has no classes"),
        _ => None,
    }
}

/// All that a frame can be coloured by. Axis and place of the chosen source stay as they are.
pub(in crate::app) fn sources(
    chosen: ColorSource,
    named: &[(String, FieldName)],
) -> Vec<(&str, ColorSource, &'static str)> {
    let tooltip = "A scalar field of the file through a colour map";
    let fields = named
        .iter()
        .map(|(title, name)| (title.as_str(), ColorSource::Scalar(Some(*name)), tooltip));
    let mut listed = Vec::new();
    for (source, word) in ColorSource::ALL.into_iter().zip(coloring::SOURCES.list) {
        // A frame lists its fields by name.
        let is_named = matches!(source, ColorSource::Scalar(_)) && !named.is_empty();
        let is_detailed = matches!(source, ColorSource::Height(_) | ColorSource::Distance(_));
        let source = if is_detailed && source.name() == chosen.name() {
            chosen
        } else {
            source
        };
        if !is_named || source == chosen {
            listed.push((word.title, source, word.hint));
        }
        if matches!(source, ColorSource::Scalar(_)) {
            listed.extend(fields.clone());
        }
    }
    listed
}

/// The fields of a frame with their titles.
pub(in crate::app) fn fields(frame: Option<&Frame>) -> Vec<(String, FieldName)> {
    let fields = frame.map_or(&[][..], Frame::scalar_fields);
    let fields = fields.iter().take(MAX_FIELDS);
    let mut named: Vec<(String, FieldName)> = fields
        .map(|field| (field_title(&field.name), FieldName::new(&field.name)))
        .collect();
    // Identical titles are disambiguated by their origins.
    let is_twice = |title: &str, all: &[(String, FieldName)]| {
        let is_taken = |word: &Word| word.title == title && word.word != "scalar";
        let of_sources = coloring::SOURCES.list.iter().any(is_taken);
        of_sources || all.iter().filter(|(other, _)| other == title).count() > 1
    };
    let all = named.clone();
    for (title, name) in &mut named {
        if is_twice(title, &all) {
            *title = format!("Field {}", plain_field_name(name.as_str()));
        }
    }
    named
}
