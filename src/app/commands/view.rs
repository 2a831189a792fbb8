//! Commands of the camera and of the content of the image.

use super::common::{Row, group};
use crate::app::command::{Chord, Command, Menu};
use crate::app::open_panels::PanelId;
use crate::app::state::{State, WindowRequest};
use crate::scene::{Projection, ViewPreset};
use egui::Key;

/// The keys change sizes by this factor.
const SIZE_STEP: f32 = 1.25;

pub(super) const ROWS: &[Row] = &[
    Row::new(Command::RESET_VIEW, "Reset view", State::reset_view)
        .what("Reset the view")
        .also(&["home", "default view", "initial view", "reset camera"])
        .keys(group::VIEW, "R", &[Chord::plain(Key::R)]),
    Row::new(Command::FRAME_ALL, "Frame everything", State::frame_all)
        .hint("Moves back until all points are seen, outliers as well")
        .also(&[
            "zoom to fit",
            "zoom all",
            "zoom extents",
            "show all",
            "outliers",
            "bounds",
            "fit view",
            "centre",
        ])
        .keys(group::VIEW, "Shift+R", &[Chord::shift(Key::R)]),
    Row::new(Command::FRONT, "Front", |state| {
        state.camera.look_from(ViewPreset::Front);
    })
    .what("Front view")
    .keys(group::VIEW, "1", &[Chord::plain(Key::Num1)]),
    Row::new(Command::BACK, "Back", |state| state.camera.look_from(ViewPreset::Back))
        .what("Back view")
        .also(&["rear", "behind"])
        .keys(group::VIEW, "2", &[Chord::plain(Key::Num2)]),
    Row::new(Command::LEFT, "Left", |state| state.camera.look_from(ViewPreset::Left))
        .what("Left view")
        .also(&["side view"])
        .keys(group::VIEW, "3", &[Chord::plain(Key::Num3)]),
    Row::new(Command::RIGHT, "Right", |state| {
        state.camera.look_from(ViewPreset::Right);
    })
    .what("Right view")
    .also(&["side view"])
    .keys(group::VIEW, "4", &[Chord::plain(Key::Num4)]),
    Row::new(Command::TOP, "Top", |state| state.camera.look_from(ViewPreset::Top))
        .what("Top view")
        .also(&["bird's-eye view", "bird", "plan view", "above", "map view", "nadir"])
        .keys(group::VIEW, "5", &[Chord::plain(Key::Num5)]),
    Row::new(Command::BOTTOM, "Bottom", |state| {
        state.camera.look_from(ViewPreset::Bottom);
    })
    .what("Bottom view")
    .also(&["below", "underside"])
    .keys(group::VIEW, "6", &[Chord::plain(Key::Num6)]),
    Row::new(
        Command::LOOK_FROM_SENSOR,
        "Look from the sensor",
        State::look_from_sensor,
    )
    .also(&["camera view", "sensor pose", "viewpoint"])
    .hint("The view of the depth camera, in the size of its image, pixel by pixel")
    .applies(|state| match state.sensor() {
        Some(_) => Ok(()),
        None => Err("No camera is known: depth images have one, point files do not"),
    }),
    Row::new(Command::TOGGLE_ORTHOGRAPHIC, "Orthographic", State::toggle_projection)
        .what("Orthographic or perspective projection")
        .also(&["parallel projection", "isometric", "ortho"])
        .keys(group::VIEW, "O", &[Chord::plain(Key::O)])
        .on_if(|state| state.camera.projection == Projection::Orthographic),
    Row::new(Command::TOGGLE_TURNTABLE, "Turntable", |state| {
        state.motion.turntable.is_on ^= true;
    })
    .what("Turntable: orbit by itself")
    .also(&["spin", "rotate", "auto-rotate", "revolve", "animate camera"])
    .keys(group::VIEW, "T", &[Chord::plain(Key::T)])
    .on_if(|state| state.motion.turntable.is_on),
    Row::new(Command::TOGGLE_GRID, "Grid", |state| state.style.backdrop.grid ^= true)
        .what("Grid on the ground")
        .also(&["ground plane", "floor"])
        .keys(group::VIEW, "G", &[Chord::plain(Key::G)])
        .on_if(|state| state.style.backdrop.grid),
    Row::new(Command::TOGGLE_SCALE_BAR, "Scale bar", |state| {
        state.appearance.shows_scale_bar ^= true;
    })
    .what("Show or hide the scale bar")
    .also(&["ruler", "scale"])
    .on_if(|state| state.appearance.shows_scale_bar),
    Row::new(
        Command::new("focus"),
        "Focus on the point under the pointer",
        State::focus_at_pointer,
    )
    .also(&["centre on point", "pivot", "look at", "rotation centre", "orbit centre"])
    .keys(group::VIEW, "F", &[Chord::plain(Key::F)]),
    Row::new(Command::COPY_VIEW, "Copy view", State::copy_view)
        .what("Copy the view as text")
        .also(&["copy camera", "share view", "save viewpoint"])
        .keys(group::VIEW, "Ctrl+C", &[Chord::ctrl(Key::C)]),
    Row::new(Command::PASTE_VIEW, "Paste view", |state| {
        state.request(WindowRequest::PasteView);
    })
    .what("Paste a view")
    .also(&["paste camera", "restore view", "load viewpoint"])
    .keys(group::VIEW, "Ctrl+V", &[Chord::ctrl(Key::V)]),
    Row::new(Command::new("copy file name"), "Copy file name", State::copy_file_name)
        .what("Copy the name of the file that is shown")
        .also(&["path", "clipboard"])
        .in_menu(Menu::Edit)
        .applies(|state| match state.shown_file() {
            Some(_) => Ok(()),
            None => Err("No file is shown"),
        }),
    Row::new(Command::new("larger"), "Larger points or splats", |state| {
        state.scale_size(SIZE_STEP);
    })
    .also(&["bigger points", "increase point size", "thicker points"])
    .keys(
        group::VIEW,
        "+",
        &[Chord::any_shift(Key::Plus), Chord::any_shift(Key::Equals)],
    )
    .repeating(),
    Row::new(Command::new("smaller"), "Smaller points or splats", |state| {
        state.scale_size(1.0 / SIZE_STEP);
    })
    .also(&["decrease point size", "thinner points"])
    .keys(group::VIEW, "-", &[Chord::any_shift(Key::Minus)])
    .repeating(),
    Row::new(Command::panel(PanelId::SETTINGS), "Settings", |state| {
        state.panels.toggle(PanelId::SETTINGS);
    })
    .what("Settings: show or hide the panel")
    .also(&[
        "preferences",
        "options",
        "properties",
        "hide panel",
        "sidebar",
        "hide ui",
        "inspector",
    ])
    .keys(group::VIEW, "F2", &[Chord::plain(Key::F2)])
    .on_if(|state| state.panels.has(PanelId::SETTINGS)),
    Row::new(Command::panel(PanelId::STATISTICS), "Statistics", |state| {
        state.panels.toggle(PanelId::STATISTICS);
    })
    .what("Statistics: frames per second, points, memory")
    .also(&["fps", "performance", "frame rate", "info", "profiler", "ram", "vram"])
    .keys(group::VIEW, "F3", &[Chord::plain(Key::F3)])
    .on_if(|state| state.panels.has(PanelId::STATISTICS)),
    Row::new(Command::panel(PanelId::LEGEND), "Legend", |state| {
        state.panels.toggle(PanelId::LEGEND);
    })
    .what("Show or hide the legend")
    .also(&["colour bar", "scalar bar", "colour scale", "key"])
    .on_if(|state| state.panels.has(PanelId::LEGEND)),
];

impl State {
    /// The file of the frame that is shown, as it is called beyond the program.
    fn shown_file(&self) -> Option<String> {
        let player = self.player.as_ref()?;
        let path = &player.sequence().entry(player.shown()?.index).path;
        path.is_file().then(|| path.display().to_string())
    }

    fn copy_file_name(&mut self) {
        if let Some(name) = self.shown_file() {
            self.notices.info(format!("Copied {name}"));
            self.request(WindowRequest::Copy(name));
        }
    }
}
