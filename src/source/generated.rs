//! Sources that are no files: words where files are named.

use super::opener::One;
use super::{Example, SequenceError, Shape, Source, Spin, demo};
use std::path::Path;
use std::sync::Arc;

/// Points of a shape when their number is not given.
const USUAL_POINTS: usize = 100_000;

/// Most points that a shape can be asked for.
const MOST_POINTS: usize = 50_000_000;

/// Words before a colon.
pub(super) const WORDS: One = One {
    can_read: |input| !matches!(Generated::of_name(input), Ok(None)),
    open: |input, _| {
        let generated = Generated::of_name(input)?;
        generated.map(Generated::source).ok_or(SequenceError::NoInput)
    },
    beside_others: None,
    is_word: true,
};

/// What an input names that is no file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Generated {
    /// `demo:`: the built-in sequence.
    Demo,
    /// `example:lidar`: a built-in example.
    Example(Example),
    /// `torus:` or `torus:20000`: one frame of a shape, of so many points.
    Shape(Shape, usize),
    /// `spin:torus:20000`: the shape as it turns, live.
    Spin(Shape, usize),
}

impl Generated {
    /// What `input` names; `None` for files.
    ///
    /// # Errors
    /// [`SequenceError::NotGenerated`] for a word that is known before something that is not.
    pub fn of_name(input: &Path) -> Result<Option<Self>, SequenceError> {
        let Some((word, rest)) = input.to_str().and_then(|input| input.split_once(':')) else {
            return Ok(None);
        };
        let named = match word {
            "demo" => rest.is_empty().then_some(Self::Demo),
            "example" => Example::ALL
                .into_iter()
                .find(|example| example.name() == rest)
                .map(Self::Example),
            "spin" => rest
                .split_once(':')
                .or(Some((rest, "")))
                .and_then(|(shape, count)| Some(Self::Spin(shape_of(shape)?, points_of(count)?))),
            _ => match shape_of(word) {
                Some(shape) => points_of(rest).map(|points| Self::Shape(shape, points)),
                None => return Ok(None),
            },
        };
        named.map(Some).ok_or_else(|| SequenceError::NotGenerated {
            input: input.display().to_string(),
            shapes: Shape::ALL.map(Shape::name).join(", "),
            examples: Example::ALL.map(Example::name).join(", "),
            most_points: MOST_POINTS,
        })
    }

    /// Its frames.
    pub fn source(self) -> Arc<dyn Source> {
        match self {
            Self::Demo => Arc::new(demo()),
            Self::Example(example) => example.source(),
            Self::Shape(shape, points) => Arc::new(shape.frame(points)),
            Self::Spin(shape, points) => Arc::new(Spin::new(shape, points)),
        }
    }
}

fn shape_of(name: &str) -> Option<Shape> {
    Shape::ALL.into_iter().find(|shape| shape.name() == name)
}

fn points_of(count: &str) -> Option<usize> {
    if count.is_empty() {
        return Some(USUAL_POINTS);
    }
    let count = count.parse().ok();
    count.filter(|count| (1..=MOST_POINTS).contains(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(input: &str) -> Result<Option<Generated>, String> {
        Generated::of_name(Path::new(input)).map_err(|error| error.to_string())
    }

    #[test]
    fn words_before_a_colon_are_sources() {
        assert_eq!(named("demo:"), Ok(Some(Generated::Demo)));
        assert_eq!(named("example:lidar"), Ok(Some(Generated::Example(Example::Lidar))));
        let sphere = |points| Ok(Some(Generated::Shape(Shape::Sphere, points)));
        assert_eq!(named("sphere:"), sphere(USUAL_POINTS));
        assert_eq!(named("sphere:12"), sphere(12));
        let torus = |points| Ok(Some(Generated::Spin(Shape::Torus, points)));
        assert_eq!(named("spin:torus"), torus(USUAL_POINTS));
        assert_eq!(named("spin:torus:5000"), torus(5000));
        for file in ["scan.ply", "C:\\scans", "a:b", "sphere", "spin", ""] {
            assert_eq!(named(file), Ok(None), "{file}");
        }
    }

    #[test]
    fn what_is_wrong_after_the_colon_is_said() {
        for wrong in [
            "sphere:0",
            "sphere:many",
            "torus:50000001",
            "spin:",
            "spin:dodo:10",
            "spin:torus:-1",
            "demo:1",
            "example:",
            "example:dodo",
        ] {
            let error = named(wrong).unwrap_err();
            assert!(error.contains(wrong), "{error}");
            assert!(
                error.contains("sphere, torus, cube, saddle") && error.contains("lidar, depth"),
                "{error}"
            );
        }
    }
}
