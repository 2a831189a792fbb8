//! What the software renderer draws surfels from; greyed out where the GPU draws, or the splatting mode has no
//! visibility pass.

use super::settings::{choice, rows};
use crate::scene::{Footprint, NormalBits, OffsetBits, Splatting, Style};
use egui::Ui;

/// The choice of footprints, and of the precision of byte codes. `draws_on_processor` says who draws with these
/// settings.
pub(super) fn footprints_ui(ui: &mut Ui, settings: &mut Style, draws_on_processor: bool) {
    let has_visibility_pass = !matches!(
        settings.surfels.splatting,
        Splatting::Regular | Splatting::NoDepth
    );
    ui.add_enabled_ui(draws_on_processor && has_visibility_pass, |ui| {
        rows(ui, "footprints", |ui| {
            footprint(ui, settings);
            if settings.codes.footprint != Footprint::Disks {
                precision(ui, settings);
            }
        });
    });
}

fn footprint(ui: &mut Ui, settings: &mut Style) {
    choice(
        ui,
        "Footprint",
        "What the CPU renderer draws surfels from; the GPU draws exact disks",
        &mut settings.codes.footprint,
        &[
            (
                "Exact disks",
                Footprint::Disks,
                "Pixel by pixel, from the records of the points",
            ),
            (
                "Masks",
                Footprint::Masks,
                "Looked up by normal, place and size, from the byte code of the octree",
            ),
            (
                "Pixels",
                Footprint::Pixels,
                "One for each cell, from the byte code of the octree",
            ),
        ],
    );
}

fn precision(ui: &mut Ui, settings: &mut Style) {
    choice(
        ui,
        "Normals",
        "Bits of a normal of the byte code; light is worked out once for each direction",
        &mut settings.codes.normal_bits,
        &[
            ("13 bits", NormalBits::Thirteen, "8192 directions"),
            ("15 bits", NormalBits::Fifteen, "32,768 directions"),
            ("17 bits", NormalBits::Seventeen, "131,072 directions"),
        ],
    );
    choice(
        ui,
        "Offsets",
        "Bits of the way from the middle of a cell to the surface, along the normal",
        &mut settings.codes.offset_bits,
        &[
            (
                "None",
                OffsetBits::None,
                "Splats stand in the middles of cells: gaps at grazing angles",
            ),
            (
                "2 bits",
                OffsetBits::Two,
                "A quarter of the cell's diagonal",
            ),
            (
                "3 bits",
                OffsetBits::Three,
                "An eighth of the cell's diagonal",
            ),
        ],
    );
}
