//! The list of assumptions as the window shows it: assumptions of the sequence joined with the user's choices, by
//! subject.

use super::change::{Change, Field};
use super::read_rows::{FileKind, ReadRow};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::scene::{Choice, Primitive, UpAxis};
use crate::sequence::{ColorSource, OpenOptions};
use std::cmp::Reverse;

/// Facts about the open sequence.
pub(in crate::app) struct Given<'a> {
    /// Made by the sequence and the first look.
    pub(in crate::app) assumptions: Vec<Assumption>,
    /// The guessed up axis and its reason.
    pub(in crate::app) guessed_up: Option<(UpAxis, &'static str)>,
    /// The up axis that the user has chosen.
    pub(in crate::app) chosen_up: Option<UpAxis>,
    /// The primitive of the settings; `Auto` where it is guessed.
    pub(in crate::app) primitive: Choice<Primitive>,
    /// The guessed primitive.
    pub(in crate::app) guessed_primitive: Option<Primitive>,
    /// Primitives that the files do not have, with the reason.
    pub(in crate::app) lacks: Vec<(Primitive, String)>,
    /// The colours of the settings; `Auto` where they are guessed.
    pub(in crate::app) colors: ColorSource,
    /// Colour sources offered for points.
    pub(in crate::app) offered_colors: &'a [ColorSource],
    /// Options with which the inputs were opened; `None` if they cannot be opened again.
    pub(in crate::app) open: Option<&'a OpenOptions>,
    /// The kind of the files.
    pub(in crate::app) file_kind: FileKind,
    /// True if there are filters of depth images that can be changed.
    pub(in crate::app) has_filters: bool,
}

/// The assumptions about one subject.
#[derive(Debug, Clone)]
pub(in crate::app) struct Group {
    pub(in crate::app) subject: Subject,
    pub(in crate::app) lines: Vec<Line>,
    /// The command-line option that changes them.
    pub(in crate::app) option: Option<&'static str>,
    /// Empty where nothing can be changed in the window.
    pub(in crate::app) alternatives: Vec<Alternative>,
    pub(in crate::app) field: Option<Field>,
    /// The automatic choice, where the user has chosen something else.
    pub(in crate::app) reset: Option<Change>,
}

/// One assumption, or the user's choice in its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::app) struct Line {
    pub(in crate::app) value: String,
    pub(in crate::app) why: String,
    /// `None`: the user has chosen it.
    pub(in crate::app) evidence: Option<Evidence>,
}

/// A value that can be had at a click.
#[derive(Debug, Clone)]
pub(in crate::app) struct Alternative {
    pub(in crate::app) label: String,
    pub(in crate::app) hint: String,
    pub(in crate::app) change: Change,
    pub(in crate::app) is_current: bool,
    /// Why it cannot be chosen.
    pub(in crate::app) lack: Option<String>,
}

impl Group {
    /// The weakest evidence of its assumptions; `None` if the user has chosen.
    pub(in crate::app) fn weakest(&self) -> Option<Evidence> {
        self.lines.iter().filter_map(|line| line.evidence).max()
    }
}

/// All groups, weakest evidence first, the user's choices last.
pub(in crate::app) fn groups(given: &Given<'_>) -> Vec<Group> {
    let chosen = ReadRow::ALL.iter().filter(|row| chosen_reading(row, given).is_some());
    let mut subjects: Vec<Subject> = given.assumptions.iter().map(|assumption| assumption.subject).collect();
    subjects.extend(chosen.map(|row| row.subject));
    subjects.sort_unstable();
    subjects.dedup();
    let mut groups: Vec<Group> = subjects.into_iter().map(|subject| group(subject, given)).collect();
    // The least certain assumptions come first.
    groups.sort_by_key(|group| Reverse(group.weakest()));
    groups
}

fn group(subject: Subject, given: &Given<'_>) -> Group {
    let of_subject = || {
        given
            .assumptions
            .iter()
            .filter(|assumption| assumption.subject == subject)
    };
    let lines = of_subject().map(|assumption| Line {
        value: assumption.value.clone(),
        why: assumption.why.clone(),
        evidence: Some(assumption.evidence),
    });
    let assumed = Group {
        subject,
        lines: lines.collect(),
        option: match of_subject().next() {
            Some(_) => of_subject().find_map(|assumption| assumption.option),
            None => subject.option(),
        },
        alternatives: Vec::new(),
        field: None,
        reset: None,
    };
    match subject {
        Subject::UpAxis => with_up(assumed, given),
        Subject::Primitive => with_primitives(assumed, given),
        Subject::Colors => with_colors(assumed, given),
        _ => match assumed.option.and_then(ReadRow::of_option) {
            Some(row) => with_reading(assumed, row, given),
            None => assumed,
        },
    }
}

fn by_user(value: String) -> Vec<Line> {
    vec![Line {
        value,
        why: String::new(),
        evidence: None,
    }]
}

fn with_up(mut group: Group, given: &Given<'_>) -> Group {
    if let Some(up) = given.chosen_up {
        group.lines = by_user(up.label().to_owned());
        group.reset = Some(Change::Up(None));
    } else {
        for (line, (up, _)) in group.lines.iter_mut().zip(given.guessed_up) {
            up.label().clone_into(&mut line.value);
        }
    }
    let hint = given.guessed_up.map(|(up, why)| format!("{}: {why}", up.label()));
    group.alternatives = vec![Alternative {
        label: "Auto".to_owned(),
        hint: hint.unwrap_or_default(),
        change: Change::Up(None),
        is_current: given.chosen_up.is_none(),
        lack: None,
    }];
    let axes = UpAxis::ALL.iter().map(|&(_, axis)| Alternative {
        label: axis.label().to_owned(),
        hint: "The axis of the file that points up on screen".to_owned(),
        change: Change::Up(Some(axis)),
        is_current: given.chosen_up == Some(axis),
        lack: None,
    });
    group.alternatives.extend(axes);
    group
}

fn with_primitives(mut group: Group, given: &Given<'_>) -> Group {
    if !given.primitive.is_open() {
        group.lines = by_user(given.primitive.to_string());
        group.reset = Some(Change::Primitive(Choice::Auto));
    }
    let guessed = given.guessed_primitive.map(|primitive| format!("{primitive}s"));
    let words = Choice::all().zip(Choice::<Primitive>::WORDS.list);
    let alternatives = words.map(|(primitive, word)| Alternative {
        label: word.title.to_owned(),
        hint: match (&guessed, primitive) {
            (Some(guessed), Choice::Auto) => format!("{} ({guessed})", word.hint),
            _ => word.hint.to_owned(),
        },
        change: Change::Primitive(primitive),
        is_current: given.primitive == primitive,
        lack: given
            .lacks
            .iter()
            .find_map(|(lacking, lack)| (primitive == *lacking).then(|| lack.clone())),
    });
    group.alternatives = alternatives.collect();
    group
}

fn with_colors(mut group: Group, given: &Given<'_>) -> Group {
    if given.colors != ColorSource::Auto {
        group.lines = by_user(given.colors.to_string());
        group.reset = Some(Change::Colors(ColorSource::Auto));
    }
    let sources = std::iter::once(&ColorSource::Auto).chain(given.offered_colors);
    let alternatives = sources.map(|&source| Alternative {
        label: source.to_string(),
        hint: "As View > Colours does, for whatever is opened".to_owned(),
        change: Change::Colors(source),
        is_current: given.colors == source,
        lack: None,
    });
    group.alternatives = alternatives.collect();
    group
}

/// The choice of a row in words, where it was made by the user and can be taken back.
fn chosen_reading(row: &ReadRow, given: &Given<'_>) -> Option<String> {
    (row.chosen)(options_of(row, given)?)
}

/// The options that a row changes; `None` where it can change nothing.
fn options_of<'a>(row: &ReadRow, given: &Given<'a>) -> Option<&'a OpenOptions> {
    let can_change = row.subject != Subject::FilteredPoints || given.has_filters;
    given.open.filter(|_| can_change)
}

fn with_reading(mut group: Group, row: &ReadRow, given: &Given<'_>) -> Group {
    let Some(open) = options_of(row, given) else {
        return group;
    };
    if let Some(value) = chosen_reading(row, given) {
        // Values that were found with the choice applied say more than the choice alone.
        if group.lines.is_empty() {
            group.lines = by_user(value);
        } else {
            group.lines.iter_mut().for_each(|line| line.evidence = None);
        }
        group.reset = Some(Change::Read(row.automatic.clone()));
    }
    let automatic = ("Auto".to_owned(), row.automatic.clone());
    let all = std::iter::once(automatic).chain((row.offered)(given.file_kind));
    let alternatives = all.map(|(label, change)| Alternative {
        label,
        hint: "Opens the inputs again".to_owned(),
        is_current: change.is_in(open),
        change: Change::Read(change),
        lack: None,
    });
    group.alternatives = alternatives.collect();
    group.field = row.field;
    group
}

#[cfg(test)]
mod tests {
    use super::super::change::ReadChange;
    use super::*;

    fn usual() -> OpenOptions {
        let mut open = OpenOptions::default();
        ReadChange::Filters(crate::rgbd::Filters::USUAL).apply(&mut open);
        open
    }

    fn given(assumptions: Vec<Assumption>, open: &OpenOptions) -> Given<'_> {
        Given {
            assumptions,
            guessed_up: Some((UpAxis::Z, "the ground is a plane")),
            chosen_up: None,
            primitive: Choice::Auto,
            guessed_primitive: Some(Primitive::Point),
            lacks: vec![(Primitive::Mesh, "there are no triangles".to_owned())],
            colors: ColorSource::Auto,
            offered_colors: &[ColorSource::Normal, ColorSource::Uniform],
            open: Some(open),
            file_kind: FileKind::Binary,
            has_filters: true,
        }
    }

    fn assumed(subject: Subject) -> Assumption {
        Assumption::new(subject, "some value", "some reason", Evidence::Statistics)
    }

    #[test]
    fn subjects_with_alternatives_have_a_place_in_the_window() {
        let open = usual();
        for group in groups(&given(Subject::all().map(assumed).collect(), &open)) {
            let has_place = assumed(group.subject).window.is_some();
            assert_eq!(has_place, !group.alternatives.is_empty(), "{:?}", group.subject);
            let current = group.alternatives.iter().filter(|alternative| alternative.is_current);
            assert!(current.count() <= 1, "{:?}", group.subject);
        }
    }

    #[test]
    fn a_choice_replaces_the_assumption_and_can_be_undone() {
        let mut open = usual();
        ReadChange::Columns(Some(crate::io::ColumnMap::of_width(5))).apply(&mut open);
        ReadChange::DepthScale(Some(5000.0)).apply(&mut open);
        let mut given = given(vec![assumed(Subject::UpAxis), assumed(Subject::Columns)], &open);
        given.chosen_up = Some(UpAxis::NegY);
        given.colors = ColorSource::Normal;
        given.assumptions.push(assumed(Subject::Colors));
        let groups = groups(&given);
        let of = |subject| groups.iter().find(|group| group.subject == subject).unwrap();
        for (subject, value) in [
            (Subject::UpAxis, "-Y"),
            (Subject::Colors, "normal"),
            (Subject::DepthScale, "5000 per metre"),
            (Subject::Columns, "some value"),
        ] {
            let group = of(subject);
            assert_eq!((group.lines[0].value.as_str(), group.weakest()), (value, None));
            assert!(group.reset.is_some(), "{subject:?}");
        }
        assert_eq!(groups.len(), 4);
    }

    #[test]
    fn inputs_that_cannot_be_reopened_offer_no_reading_alternatives() {
        let open = usual();
        let mut given = given(vec![assumed(Subject::Columns), assumed(Subject::Primitive)], &open);
        given.open = None;
        let [columns, primitive] = &groups(&given)[..] else {
            panic!("two")
        };
        assert!(columns.alternatives.is_empty() && columns.option.is_some());
        let mesh = primitive
            .alternatives
            .iter()
            .find(|alternative| alternative.label == "Mesh");
        assert_eq!(mesh.unwrap().lack.as_deref(), Some("there are no triangles"));
    }
}
