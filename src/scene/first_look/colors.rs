//! Default colour source of the points if none was chosen, with the reason.

use crate::assumption::{Assumption, Evidence, Subject};
use crate::cloud::Frame;
use crate::sequence::{ColorHints, ColorSource, Coloring, FieldName};

/// A guessed colour source.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ColorGuess {
    /// Colour source of the points.
    pub source: ColorSource,
    /// The reason, a clause; empty if the file has informative colours.
    pub why: String,
    /// Available colour sources: those that the first frame has, with each of its fields.
    pub offered: Vec<ColorSource>,
}

impl ColorGuess {
    /// As [`Coloring::default`] colours `frame`.
    pub(super) fn of(frame: &Frame, hints: &ColorHints) -> Self {
        let source = Coloring::default().paint(hints, frame).source();
        let lack = match frame.colors() {
            None => "the file has no colours",
            Some(_) => "all colours of the file are alike, black or white",
        };
        let because = match source {
            ColorSource::File => "",
            ColorSource::Scalar(_) => ", and this field varies",
            ColorSource::Class => ", and the classes vary",
            ColorSource::Height(_) => ", and the ground tells most by its height",
            _ => ", so normals show the shape",
        };
        let why = match source {
            ColorSource::File => String::new(),
            _ => format!("{lack}{because}"),
        };
        Self {
            source,
            why,
            offered: offered(frame),
        }
    }

    /// `None` if the colours are the file's: nothing was decided.
    pub(super) fn assumption(&self) -> Option<Assumption> {
        let is_decided = !self.why.is_empty();
        is_decided.then(|| {
            Assumption::new(
                Subject::Colors,
                self.source.to_string(),
                &self.why,
                Evidence::Statistics,
            )
        })
    }
}

/// Every source that a frame has, except those that need more than a name.
fn offered(frame: &Frame) -> Vec<ColorSource> {
    let fields = frame.scalar_fields().iter();
    let fields = fields.map(|field| ColorSource::Scalar(Some(FieldName::new(&field.name))));
    let general = ColorSource::ALL.into_iter().filter(|source| {
        !matches!(source, ColorSource::Scalar(_) | ColorSource::Time | ColorSource::Auto) && source.is_of(frame)
    });
    general.chain(fields).collect()
}
