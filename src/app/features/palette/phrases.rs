//! Phrases that users typed, and the entries that they wanted: one of the first three has to hold one of the texts on
//! the right (`""`: nothing at all may be found).

use super::tests::texts_of;
use crate::app::{State, StateOptions};
use crate::cloud::{Positions, RawCloud, ScalarField};
use crate::playback::Player;
use crate::sequence::{FrameEntry, Sequence};
use std::sync::Arc;
use std::time::Duration;

/// Number of entries that a user looks at.
const SEEN: usize = 3;

/// Phrases of the first users. Credit: own.
const PHRASES: &[(&str, &[&str])] = &[
    ("background white", &["background: white"]),
    ("screenshot", &["save image"]),
    ("take picture", &["save image"]),
    ("reset view", &["reset the view"]),
    ("home", &["reset the view"]),
    ("zoom to fit", &["frame everything"]),
    ("export video", &["export"]),
    ("record screen", &["export"]),
    ("gif", &["export video as gif"]),
    ("mp4", &["export video as mp4"]),
    ("crop", &["clip to a box"]),
    ("bounding box", &["clip to a box"]),
    ("height", &["colours: height"]),
    ("color by height", &["colours: height"]),
    ("colormap", &["colour map"]),
    ("histogram", &["histogram"]),
    ("gps", &[""]),
    ("outliers", &["frame everything"]),
    ("remove outliers", &["convert"]),
    ("noise", &["depth images: filters"]),
    ("spin", &["turntable"]),
    ("rotate", &["turntable"]),
    ("turntable", &["turntable"]),
    ("convert", &["save as"]),
    ("save ply", &["save as"]),
    ("transform", &["convert"]),
    ("downsample", &["save as"]),
    ("accumulate", &["onion skin"]),
    ("bird", &["top view"]),
    ("top view", &["top view"]),
    ("front", &["front view"]),
    ("axes", &["up axis"]),
    ("up", &["up axis"]),
    ("go to frame", &["go to frame"]),
    ("frame 12", &["go to frame 12"]),
    ("slow motion", &["speed"]),
    ("1/2", &["speed 0.5"]),
    ("faster", &["speed"]),
    ("fps", &["frames per second"]),
    ("loop", &["loop mode"]),
    ("point size", &["point size"]),
    ("point size 4", &["set point size to 4"]),
    ("bigger points", &["larger points"]),
    ("hide points", &["primitive"]),
    ("wireframe", &["mesh"]),
    ("dark mode", &["theme: dark"]),
    ("transparent", &["background: transparent"]),
    ("fullscreen", &["full screen"]),
    ("hide panel", &["hide the panel"]),
    ("photographs", &["images"]),
    ("cameras", &["images and cameras"]),
    ("edl", &["eye-dome lighting"]),
    ("shadows", &["shadows"]),
    ("ambient occlusion", &["ambient occlusion"]),
    ("measure", &["measure"]),
    ("distance", &["measure", "colours: distance"]),
    ("label", &["label"]),
    ("compare", &["compare"]),
    ("benchmark", &["benchmark"]),
    ("delete", &[""]),
];

/// Phrases after the menus of other programs. Credit: own.
const OF_OTHER_PROGRAMS: &[(&str, &[&str])] = &[
    ("keyboard shortcuts", &["keys and mouse"]),
    ("help", &["keys and mouse"]),
    ("preferences", &["settings"]),
    ("open file", &["open files"]),
    ("import", &["open files", "open a folder"]),
    ("load folder", &["open a folder"]),
    ("save project", &["save the session"]),
    ("exit", &["quit"]),
    ("undo", &["undo"]),
    ("point budget", &["level of detail: budget"]),
    ("point budget 1000000", &["budget 1000000"]),
    ("rainbow", &["colour map: turbo"]),
    ("jet", &["colour map: turbo"]),
    ("grayscale", &["colour map: grey"]),
    ("viridis", &["colour map: viridis"]),
    ("rgb", &["colours: from the file"]),
    ("color by class", &["colours: class"]),
    ("classification", &["colours: class"]),
    ("elevation", &["colours: height"]),
    ("normals", &["colours: normal", "normals"]),
    ("solid color", &["colours: one colour"]),
    ("log scale", &["logarithm"]),
    ("color bar", &["legend"]),
    ("scale bar", &["scale bar"]),
    ("show grid", &["grid"]),
    ("ground plane", &["grid on the ground"]),
    ("perspective", &["perspective"]),
    ("orthographic", &["orthographic"]),
    ("fov 60", &["field of view: 60"]),
    ("field of view", &["field of view"]),
    ("ssao", &["ambient occlusion"]),
    ("msaa", &["antialiasing"]),
    ("anti-aliasing", &["antialiasing"]),
    ("brightness", &["gamma"]),
    ("gamma 2", &["set gamma to 2"]),
    ("cross section", &["clip to a box"]),
    ("clipping plane", &["clip to a box"]),
    ("cloud to cloud distance", &["change map"]),
    ("ghosting", &["onion skin"]),
    ("trajectories", &["trails"]),
    ("next frame", &["next frame"]),
    ("pause", &["play or pause"]),
    ("ping pong", &["loop mode"]),
    ("speed 2", &["speed 2 "]),
    ("2x", &["speed 2 "]),
    ("fps 24", &["frames per second: 24"]),
    ("seek 100", &["go to frame 100"]),
    ("keyframe", &["add a keyframe"]),
    ("fly through", &["camera path"]),
    ("camera animation", &["camera path"]),
    ("annotation", &["label"]),
    ("ruler", &["measure"]),
    ("voxels", &["primitive: voxels"]),
    ("triangles", &["primitive: mesh"]),
    ("gaussian splats", &["primitive", "kernel: gaussian"]),
    ("splat size 2", &["set splat scale to 2"]),
    ("black background", &["background: black"]),
    ("light theme", &["theme: light"]),
    ("software rendering", &["renderer"]),
    ("resolution 50%", &["set resolution to 50"]),
    ("subsample", &["save as"]),
    ("flip upside down", &["up axis"]),
    ("bottm view", &["bottom view"]),
    ("trun table", &["turntable"]),
    ("hole filling", &["holes"]),
    ("pick point", &["point values"]),
    ("side by side", &["compare"]),
    ("frame rate", &["frames per second", "statistics"]),
    ("thumbnails", &["thumbnails"]),
    ("reload from disk quickly", &[""]),
    ("spreadsheet", &[""]),
    ("xyzzy", &[""]),
];

fn failures(state: &State, phrases: &[(&str, &[&str])]) -> Vec<String> {
    let failure = |&(phrase, expected): &(&str, &[&str])| {
        let found = texts_of(state, phrase);
        let seen: Vec<String> = found.iter().take(SEEN).map(|text| text.to_lowercase()).collect();
        let is_right = match expected {
            [""] => seen.is_empty(),
            _ => expected
                .iter()
                .any(|text| seen.iter().any(|entry| entry.contains(text))),
        };
        (!is_right).then(|| format!("{phrase:?}: {seen:?}, not {expected:?}"))
    };
    phrases.iter().filter_map(failure).collect()
}

#[test]
fn everyday_phrases_find_the_right_command() {
    let state = State::new(StateOptions::default());
    for (name, phrases) in [("people", PHRASES), ("other programs", OF_OTHER_PROGRAMS)] {
        let failures = failures(&state, phrases);
        let right = phrases.len() - failures.len();
        assert!(
            10 * right >= 9 * phrases.len(),
            "{name}: {right} of {}: {failures:#?}",
            phrases.len()
        );
    }
}

/// Phrases about fields, where the file has them. Credit: own.
const OF_FIELDS: &[(&str, &[&str])] = &[
    ("intensity", &["colours: intensity"]),
    ("ring", &["colours: ring"]),
    ("gps", &["colours: gps time"]),
    ("gps_time", &["colours: gps time"]),
    ("color by intensity", &["colours: intensity"]),
    ("return number", &["colours: return number"]),
    ("scalar field", &["colours: "]),
    ("frame 2", &["go to frame 2"]),
];

#[test]
fn fields_of_the_file_are_found() {
    let entries = (0..2).map(|frame| FrameEntry::file(format!("/scans/drive_{frame}.ply")));
    let sequence = Sequence::with_decoder(entries.collect(), |_| {
        let mut cloud = RawCloud::from_positions(Positions::F32(vec![[0.0; 3], [1.0; 3]]));
        let names = ["intensity", "ring", "gps_time", "return_number"];
        cloud.attributes.scalars = names.map(|name| ScalarField::new(name, vec![0.0, 1.0])).into();
        Ok(cloud)
    });
    let mut state = State::new(StateOptions::default());
    state.open(Arc::new(sequence));
    let shown = |state: &State| state.player.as_ref().and_then(Player::shown).is_some();
    for step in 1..1000 {
        state.update(Duration::from_millis(10 * step));
        if shown(&state) {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(shown(&state), "the frame is read");
    assert_eq!(failures(&state, OF_FIELDS), [""; 0]);
    // Past the last frame.
    assert!(!texts_of(&state, "frame 3").contains(&"Go to frame 3".to_owned()));
}
