//! Subjects whose assumption is changed by reading the inputs with other options, a row each.

use super::change::{Field, ReadChange};
use crate::assumption::Subject;
use crate::cloud::{ColorDepth, NoData};
use crate::io::ColumnMap;
use crate::rgbd::Filters;
use crate::sequence::OpenOptions;
use crate::source::NO_POSES;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Kind of file, which determines the available options.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum FileKind {
    /// Floats without a header (`.bin`).
    Binary,
    /// All others.
    Other,
}

impl FileKind {
    /// By the extension of `path`.
    pub(in crate::app) fn of(path: &Path) -> Self {
        match path.extension() {
            Some(extension) if extension.eq_ignore_ascii_case("bin") => Self::Binary,
            _ => Self::Other,
        }
    }
}

/// Row of the editor that changes a subject.
pub(super) struct ReadRow {
    pub(super) subject: Subject,
    /// The choice in words; `None` where it is automatic.
    pub(super) chosen: fn(&OpenOptions) -> Option<String>,
    pub(super) automatic: ReadChange,
    /// Common values of files.
    pub(super) offered: fn(FileKind) -> Vec<(String, ReadChange)>,
    /// Any other value.
    pub(super) field: Option<Field>,
}

impl ReadRow {
    pub(super) const ALL: &[Self] = &[
        Self {
            subject: Subject::ColorDepth,
            chosen: |open| Some(format!("{} bits", open.color_depth?)),
            automatic: ReadChange::ColorDepth(None),
            offered: |_| {
                let depths = [("0 to 255", ColorDepth::Bits8), ("0 to 65535", ColorDepth::Bits16)];
                let offered = depths.map(|(range, depth)| (range.to_owned(), ReadChange::ColorDepth(Some(depth))));
                offered.to_vec()
            },
            field: None,
        },
        Self {
            subject: Subject::Frames,
            chosen: |open| open.only.as_deref().map(str::to_owned),
            automatic: ReadChange::Only(None),
            offered: |_| Vec::new(),
            field: Some(Field {
                hint: "names of frames, such as body_*",
                parse: |text| match text.trim() {
                    "" => Err("expected a pattern such as body_*".to_owned()),
                    pattern => Ok(ReadChange::Only(Some(Arc::from(pattern)))),
                },
            }),
        },
        Self {
            subject: Subject::MergedPoints,
            chosen: |open| Some(format!("cells of {} m", open.rgbd.merge_edge_m?)),
            automatic: ReadChange::MergeCells(None),
            offered: |_| vec![("None".to_owned(), ReadChange::MergeCells(Some(0.0)))],
            field: Some(Field {
                hint: "edge of cells in metres",
                parse: |text| Ok(ReadChange::MergeCells(Some(positive(text)?))),
            }),
        },
        Self {
            subject: Subject::DepthScale,
            chosen: |open| Some(format!("{} per metre", open.rgbd.depth_scale?)),
            automatic: ReadChange::DepthScale(None),
            offered: |_| {
                let usual = [1000.0, 5000.0, 6553.5, 4000.0, 256.0, 1.0];
                numbers(&usual, |scale| ReadChange::DepthScale(Some(scale)))
            },
            field: Some(Field {
                hint: "depth values per metre",
                parse: |text| Ok(ReadChange::DepthScale(Some(positive(text)?))),
            }),
        },
        Self {
            subject: Subject::Camera,
            chosen: |open| open.rgbd.intrinsics.clone(),
            automatic: ReadChange::Intrinsics(None),
            offered: |_| Vec::new(),
            field: Some(Field {
                hint: "fx,fy,cx,cy or a file",
                parse: |text| Ok(ReadChange::Intrinsics(Some(intrinsics(text)?))),
            }),
        },
        Self {
            subject: Subject::Poses,
            chosen: |open| {
                let file = open.rgbd.poses.as_deref().map(|file| file.display().to_string());
                match (file, open.rgbd.invert_poses) {
                    (Some(file), true) => Some(format!("{file}, world to camera")),
                    (None, true) => Some("world to camera".to_owned()),
                    (file, false) => file,
                }
            },
            automatic: ReadChange::Poses(None),
            offered: |_| {
                let none = ReadChange::Poses(Some(PathBuf::from(NO_POSES)));
                vec![
                    ("None".to_owned(), none),
                    ("World to camera".to_owned(), ReadChange::InvertPoses),
                ]
            },
            field: Some(Field {
                hint: "a file of poses, or none",
                parse: |text| match text.trim() {
                    NO_POSES => Ok(ReadChange::Poses(Some(PathBuf::from(NO_POSES)))),
                    text => Ok(ReadChange::Poses(Some(file(text)?))),
                },
            }),
        },
        Self {
            subject: Subject::Columns,
            chosen: |open| Some(open.read.columns?.to_string()),
            automatic: ReadChange::Columns(None),
            offered: |kind| match kind {
                FileKind::Binary => {
                    let named = (3..=8).map(|width| {
                        let columns = ReadChange::Columns(Some(ColumnMap::of_width(width)));
                        (format!("{width} values per point"), columns)
                    });
                    named.collect()
                }
                FileKind::Other => {
                    let first = "x=0,y=1,z=2".parse().ok();
                    let named = first.map(|columns| ("First three columns".to_owned(), columns));
                    let offered = named.map(|(name, columns)| (name, ReadChange::Columns(Some(columns))));
                    offered.into_iter().collect()
                }
            },
            field: Some(Field {
                hint: "x=0,y=1,z=2",
                parse: |text| Ok(ReadChange::Columns(Some(text.parse()?))),
            }),
        },
        Self {
            subject: Subject::NoData,
            chosen: |open| (open.no_data != NoData::Auto).then(|| open.no_data.to_string()),
            automatic: ReadChange::NoData(NoData::Auto),
            offered: |_| vec![("None".to_owned(), ReadChange::NoData(NoData::None))],
            field: Some(Field {
                hint: "value of missing points",
                parse: |text| text.trim().parse().map(ReadChange::NoData),
            }),
        },
        Self {
            subject: Subject::FrameTimes,
            chosen: |open| Some(format!("{} frames per second", open.fps?)),
            automatic: ReadChange::Fps(None),
            offered: |_| {
                let usual = [10.0, 15.0, 24.0, 25.0, 30.0, 60.0];
                numbers(&usual, |fps| ReadChange::Fps(Some(fps)))
            },
            field: Some(Field {
                hint: "frames per second",
                parse: |text| Ok(ReadChange::Fps(Some(positive(text)?))),
            }),
        },
        Self {
            subject: Subject::FilteredPoints,
            chosen: |open| {
                let filters = open.rgbd.filters;
                (filters != Filters::USUAL).then(|| match filters {
                    Filters::NONE => "none".to_owned(),
                    filters => filters.to_string(),
                })
            },
            automatic: ReadChange::Filters(Filters::USUAL),
            offered: |_| vec![("Off".to_owned(), ReadChange::Filters(Filters::NONE))],
            field: None,
        },
    ];

    /// The row for `option` of the command line.
    pub(super) fn of_option(option: &str) -> Option<&'static Self> {
        // The direction of poses is chosen together with their file.
        let option = if option == "--invert-poses" { "--poses" } else { option };
        Self::ALL.iter().find(|row| row.subject.option() == Some(option))
    }
}

fn numbers(usual: &[f64], change: impl Fn(f64) -> ReadChange) -> Vec<(String, ReadChange)> {
    let named = usual.iter().map(|&number| (number.to_string(), change(number)));
    named.collect()
}

fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        _ => Err(format!("expected a number above 0, found \"{text}\"")),
    }
}

fn intrinsics(text: &str) -> Result<String, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    match numbers {
        Ok(numbers) if numbers.len() == 4 => Ok(text.trim().to_owned()),
        Ok(numbers) => Err(format!("expected 4 numbers fx,fy,cx,cy, found {}", numbers.len())),
        Err(_) => Ok(file(text)?.display().to_string()),
    }
}

/// The next run may start in another folder.
fn file(text: &str) -> Result<PathBuf, String> {
    let path = Path::new(text.trim());
    match std::path::absolute(path) {
        Ok(path) if path.is_file() => Ok(path),
        _ => Err(format!("{} is not a file", path.display())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_offered_value_is_a_choice_except_the_automatic_one() {
        let mut usual = OpenOptions::default();
        ReadChange::Filters(Filters::USUAL).apply(&mut usual);
        for row in ReadRow::ALL {
            assert_eq!((row.chosen)(&usual), None, "{:?}", row.subject);
            let offered = [FileKind::Binary, FileKind::Other].map(|kind| (row.offered)(kind));
            for (label, change) in offered.concat() {
                let mut open = usual.clone();
                change.apply(&mut open);
                assert!((row.chosen)(&open).is_some(), "{label}");
                assert!(change.is_in(&open) && !row.automatic.is_in(&open), "{label}");
                row.automatic.apply(&mut open);
                assert_eq!(open, usual, "{label}");
            }
        }
    }

    #[test]
    fn fields_accept_valid_values_and_state_what_they_expect() {
        let of = |subject: Subject| {
            ReadRow::of_option(subject.option().unwrap())
                .unwrap()
                .field
                .unwrap()
                .parse
        };
        let scale = of(Subject::DepthScale);
        assert_eq!(scale(" 6553.5 "), Ok(ReadChange::DepthScale(Some(6553.5))));
        for text in ["", "0", "-1", "inf", "nan", "five"] {
            assert!(scale(text).is_err_and(|reason| reason.contains("above 0")), "{text}");
        }
        let camera = of(Subject::Camera);
        let numbers = "525, 525, 319.5, 239.5";
        assert_eq!(camera(numbers), Ok(ReadChange::Intrinsics(Some(numbers.to_owned()))));
        assert!(camera("525,525").is_err_and(|reason| reason.contains("found 2")));
        let poses = of(Subject::Poses);
        assert_eq!(poses(" none "), Ok(ReadChange::Poses(Some(NO_POSES.into()))));
        assert!(poses("/none/poses.txt").is_err_and(|reason| reason.contains("is not a file")));
        assert!(ReadRow::of_option("--invert-poses").is_some_and(|row| row.subject == Subject::Poses));
        assert!(camera("/none/camera.txt").is_err_and(|reason| reason.contains("is not a file")));
    }
}
