//! `pointreel help TOPIC`: short pages across commands, each with its options and examples.

use super::wrap::wrapped;
use crate::messages::listed;
use crate::spelling::is_same_word;
use clap::{Arg, Command};
use std::ffi::OsString;
use std::fmt::Write as _;

/// A page of the help.
struct Topic {
    name: &'static str,
    /// Other words that people ask for it by.
    synonyms: &'static [&'static str],
    title: &'static str,
    text: &'static str,
    /// The commands and options that the page is about, without dashes.
    options: &'static [(&'static str, &'static [&'static str])],
    examples: &'static [&'static str],
}

const TOPICS: &[Topic] = &[
    Topic {
        name: "colours",
        synonyms: &["color", "color-map", "scalar", "intensity"],
        title: "Colours of points",
        text: "By default points have the colours of the file if these differ, else their intensity, class, height or \
               normal. --colors chooses the source: file (also rgb), scalar:NAME (`pointreel info` lists the names; \
               intensity chooses the best one), height or height:z, distance, time, class, normal or uniform. Scalars \
               go through a colour map; its range is in values (0..255) or percentiles (p5..p95). --legend draws the \
               colour bar.",
        options: &[(
            "render",
            &["colors", "color-map", "color-range", "color-log", "legend", "change"],
        )],
        examples: &[
            "pointreel render scan.las -o intensity.png --colors intensity --color-range p5..p95 --legend",
            "pointreel scan.las --colors height:z --color-map turbo",
        ],
    },
    Topic {
        name: "lod",
        synonyms: &["level-of-detail", "octree", "performance", "speed"],
        title: "Level of detail",
        text: "Voxels are always drawn from an octree; surfels and adaptive points are with --surfel-lod. One of --lod \
               (screen-space size in pixels), --lod-level, --lod-budget and --lod-time chooses the nodes; one of \
               --spacing, --delta, --depth and --octant-points decides how far the octree is subdivided. \
               --render-scale and --point-size-mode also trade detail for speed.",
        options: &[(
            "render",
            &[
                "surfel-lod",
                "lod-structure",
                "lod",
                "lod-level",
                "lod-budget",
                "lod-time",
                "lod-metric",
                "spacing",
                "delta",
                "depth",
                "octant-points",
                "render-scale",
            ],
        )],
        examples: &[
            "pointreel scan.las --surfel-lod --lod 2",
            "pointreel render scan.las -o voxels.png --primitive voxel --lod-level 8",
        ],
    },
    Topic {
        name: "rgbd",
        synonyms: &["rgb-d", "depth", "realsense", "kinect"],
        title: "Depth images (RGB-D)",
        text: "Recordings of depth cameras open as sequences: folders of depth and colour images (TUM, Redwood, \
               BundleFusion, ScanNet …), RealSense .bag, Azure Kinect .mkv, MCAP and ROS bags. Intrinsics, poses and \
               the depth scale are detected; options override them. Depth is filtered for display; info, check and \
               convert read it unfiltered.",
        options: &[(
            "render",
            &[
                "depth-images",
                "color-images",
                "intrinsics",
                "depth-scale",
                "poses",
                "invert-poses",
                "merge-frames",
                "merge-cells",
                "rgbd-filters",
                "from-sensor",
            ],
        )],
        examples: &[
            "pointreel recording/ --depth-images 'depth/*.png' --color-images 'rgb/*.png' --depth-scale 5000",
            "pointreel convert recording/ room.ply --merge-frames 0..99 --merge-cells 0.01",
        ],
    },
    Topic {
        name: "images",
        synonyms: &["photos", "photographs", "colmap", "multi-view", "texturing", "stereo"],
        title: "Posed images and multi-view video",
        text: "A COLMAP, Meshroom, OpenMVG, Bundler or NeRF project shows its sparse reconstruction textured from the \
               input images, view-dependently: each surface point is coloured by the cameras closest to the viewpoint. \
               One calibration plus a folder of images per camera or per time step opens as multi-view video. --dense \
               reconstructs a dense cloud by stereo.",
        options: &[(
            "render",
            &[
                "photos",
                "photo-views",
                "photo-angle",
                "clipping",
                "holes",
                "photo-gaps",
                "relight",
                "photo-gains",
                "photo-camera",
                "leave-out",
                "dense",
            ],
        )],
        examples: &[
            "pointreel project/sparse/0 --dense",
            "pointreel render project/ -o view.png --photo-camera 12 --leave-out 12",
        ],
    },
    Topic {
        name: "live",
        synonyms: &["stream", "network", "tcp", "http", "record"],
        title: "Live streams and remote files",
        text: "`pointreel serve INPUT --live` streams any input; `pointreel tcp://ADDRESS:PORT` shows the stream and \
               keeps the last seconds for rewinding. Without --live, serve offers a .reel file over HTTP, of which \
               players read only what they show. Streams are neither encrypted nor authenticated: anyone who can reach \
               the port can watch. --follow shows the newest file of a growing folder.",
        options: &[
            (
                "serve",
                &["listen", "live", "fps", "once", "depth-coding", "color-coding", "cors"],
            ),
            ("view", &["live-seconds", "stream", "record", "follow", "bandwidth"]),
        ],
        examples: &[
            "pointreel serve demo: --live --listen 0.0.0.0:8089",
            "pointreel tcp://127.0.0.1:8089 --record take1.pointreel-stream",
        ],
    },
    Topic {
        name: "camera",
        synonyms: &["view", "viewpoint", "turntable", "path", "video"],
        title: "Camera, turntables and camera paths",
        text: "The camera frames the cloud unless it is placed: by --azimuth, --elevation and --distance, or by --view \
               with a view copied in the window (Ctrl+C). The up axis is estimated unless --up is given. Videos orbit \
               with --turntable, follow the keyframes of --path (saved in the window), or stand still while the \
               sequence plays.",
        options: &[(
            "render",
            &[
                "view",
                "up",
                "azimuth",
                "elevation",
                "distance",
                "fov",
                "orthographic",
                "frame-all",
                "from-sensor",
                "photo-camera",
                "video",
                "path",
                "turntable",
                "turns",
                "fps",
                "seconds",
            ],
        )],
        examples: &[
            "pointreel render scan.ply -o front.png --up z --azimuth 30 --elevation 20",
            "pointreel render scan.ply --video turn.mp4 --turntable 120",
        ],
    },
    Topic {
        name: "formats",
        synonyms: &["files", "input", "ply", "las", "pcd", "convert"],
        title: "Formats",
        text: "Formats are detected from file contents. Read: PLY, PCD, LAS, LAZ, COPC, E57, PTS, PTX, XYZ and other \
               text, .bin of floats (KITTI), NPY and NPZ, OBJ, STL, OFF, glTF, Draco, PCAP of spinning LiDARs, MCAP, \
               ROS bags, RGB-D recordings, COLMAP and similar projects, and .reel sequence files. A folder or a \
               pattern is a sequence with one frame per file, in natural order. Written by convert: ply, ply-ascii, \
               pcd, las, laz, xyz, npy and .reel.",
        options: &[
            (
                "info",
                &[
                    "columns",
                    "no-data",
                    "color-depth",
                    "only",
                    "topic",
                    "merge-scans",
                    "sample",
                ],
            ),
            (
                "convert",
                &["format", "frames", "voxel", "transform", "precision", "merge"],
            ),
        ],
        examples: &[
            "pointreel convert scans/ walk.reel",
            "pointreel info points.bin --columns 7:x=0,y=1,z=2,intensity=3",
        ],
    },
];

/// A line with the names of all topics.
pub(super) fn line() -> String {
    format!("More: pointreel help TOPIC, with one of {}", names().join(", "))
}

fn names() -> Vec<String> {
    TOPICS.iter().map(|topic| topic.name.to_owned()).collect()
}

/// The name in `words`, a command line with the name of the program, if it is not a command: `pointreel help NAME`.
fn asked<'a>(words: &'a [OsString], command: &Command) -> Option<&'a str> {
    match words {
        [_, help, name] if help == "help" => name.to_str().filter(|name| command.find_subcommand(name).is_none()),
        _ => None,
    }
}

/// The page that `words` ask for, if their name is a topic: `pointreel help TOPIC`.
pub(super) fn page(words: &[OsString], command: &Command) -> Option<String> {
    Some(topic(asked(words, command)?)?.page(command))
}

/// Returns an error message if `words` ask for help about neither a command nor a topic, with the names of both.
pub(super) fn unknown(words: &[OsString], command: &Command) -> Option<String> {
    let name = asked(words, command)?;
    if name == "help" || name.starts_with('-') || topic(name).is_some() {
        return None;
    }
    let commands: Vec<_> = command
        .get_subcommands()
        .map(|command| command.get_name().to_owned())
        .collect();
    Some(format!(
        "no help for `{name}`: expected a command ({}) or a topic ({})",
        listed(&commands, "or"),
        listed(&names(), "or")
    ))
}

fn topic(name: &str) -> Option<&'static Topic> {
    let is_asked = |topic: &&Topic| {
        let mut names = topic.synonyms.iter().chain([&topic.name]);
        names.any(|it| is_same_word(it, name))
    };
    let exact = TOPICS.iter().find(|topic| is_same_word(topic.name, name));
    exact.or_else(|| TOPICS.iter().find(is_asked))
}

/// Width of texts.
const WIDTH: usize = 100;

/// Width of names of options.
const NAMES_WIDTH: usize = 34;

impl Topic {
    fn page(&self, command: &Command) -> String {
        let mut page = format!("{}\n\n{}\n", self.title, wrapped(self.text, WIDTH));
        for (name, options) in self.options {
            // Writing to a String cannot fail.
            let _ = writeln!(page, "\nOptions of {name}:");
            let of_command = command.find_subcommand(name);
            for option in options.iter().filter_map(|option| option_of(of_command?, option)) {
                page.push_str(&row(option));
            }
        }
        page.push_str("\nExamples:\n");
        for example in self.examples {
            let _ = writeln!(page, "  {example}");
        }
        page
    }
}

fn option_of<'a>(command: &'a Command, long: &str) -> Option<&'a Arg> {
    command.get_arguments().find(|option| option.get_long() == Some(long))
}

/// An option and its text.
fn row(option: &Arg) -> String {
    let long = option.get_long().unwrap_or_default();
    let names = option.get_value_names().filter(|_| option.get_action().takes_values());
    let value = match names.and_then(|names| names.first()) {
        Some(name) if option.is_require_equals_set() => format!("[=<{name}>]"),
        Some(name) => format!(" <{name}>"),
        None => String::new(),
    };
    let text = option.get_help().map(ToString::to_string).unwrap_or_default();
    let mut lines = text.lines();
    let first = lines.next().unwrap_or_default();
    let mut row = format!("  {:NAMES_WIDTH$} {first}\n", format!("--{long}{value}"));
    for line in lines {
        let _ = writeln!(row, "  {:NAMES_WIDTH$} {line}", "");
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Arguments, command};
    use clap::Parser as _;

    #[test]
    fn every_option_and_example_of_a_topic_exists() {
        let command = command();
        for topic in TOPICS {
            for (name, options) in topic.options {
                let of_command = command.find_subcommand(name).unwrap();
                for option in *options {
                    assert!(option_of(of_command, option).is_some(), "{}: --{option}", topic.name);
                }
            }
            for example in topic.examples {
                let words = example.replace('\'', "");
                let words: Vec<OsString> = words.split(' ').map(OsString::from).collect();
                let parsed = Arguments::try_parse_from(crate::cli::line::spelt(words, &command));
                assert!(parsed.is_ok(), "{example}: {:?}", parsed.err());
            }
        }
    }

    #[test]
    fn topics_are_found_by_common_names() {
        let of = |name: &str| page(&["p", "help", name].map(OsString::from), &command());
        for (name, title) in [
            ("colors", "Colours"),
            ("octree", "Level of detail"),
            ("colmap", "Posed images"),
        ] {
            assert!(of(name).unwrap().starts_with(title), "{name}");
        }
        assert_eq!(of("render"), None);
        assert_eq!(of("weather"), None);
    }

    #[test]
    fn unknown_topics_are_answered_with_the_known_ones() {
        let of = |name: &str| unknown(&["p", "help", name].map(OsString::from), &command());
        let message = of("weather").unwrap();
        assert!(
            message.contains("view, render") && message.contains("colours, lod"),
            "{message}"
        );
        for known in ["render", "colors", "octree", "help"] {
            assert_eq!(of(known), None, "{known}");
        }
    }
}
