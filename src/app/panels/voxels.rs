//! Choices about the octree: how deep it goes, and which of its cells are drawn as voxels or surfels.

use super::settings::{choice, heading, row, rows};
use crate::levels::Lod;
use crate::levels::octree::StopCriterion;
use crate::scene::{Primitive, Style, VoxelLight};
use egui::{Slider, Ui};

/// The sections of the settings for what draws cells of the octree.
pub(super) fn octree_ui(ui: &mut Ui, settings: &mut Style) {
    if settings.primitive == Primitive::Voxel {
        heading(ui, "Cubes");
        rows(ui, "cubes", |ui| light(ui, &mut settings.voxels.light));
    }
    heading(ui, "Octree");
    rows(ui, "octree", |ui| stop(ui, &mut settings.levels.stop));
    heading(ui, "Level of detail");
    rows(ui, "lod", |ui| lod(ui, &mut settings.levels.lod));
}

fn light(ui: &mut Ui, voxel_light: &mut VoxelLight) {
    choice(
        ui,
        "Light on",
        "What the light of voxels falls on",
        voxel_light,
        &[
            (
                "Normals",
                VoxelLight::Normals,
                "The surface in a voxel: the mean normal of its points",
            ),
            ("Faces", VoxelLight::Faces, "The faces of the cubes"),
        ],
    );
}

/// The choices of a list are kinds; the number of a kind that is chosen anew is the usual one.
fn kind<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    tooltip: &str,
    value: &mut T,
    kinds: &[(&str, T, &str)],
) {
    let same_kind = |a: &T, b: &T| std::mem::discriminant(a) == std::mem::discriminant(b);
    let usual = kinds
        .iter()
        .map(|(_, usual, _)| *usual)
        .find(|usual| same_kind(usual, value))
        .unwrap_or(*value);
    let mut chosen = usual;
    choice(ui, name, tooltip, &mut chosen, kinds);
    if !same_kind(&chosen, value) {
        *value = chosen;
    }
}

fn stop(ui: &mut Ui, stop: &mut StopCriterion) {
    kind(
        ui,
        "Divide",
        "When cells of the octree are no longer divided (its stop criterion)",
        stop,
        &[
            (
                "By spacing",
                StopCriterion::Spacing,
                "Until voxels would be smaller than the spacing of the points in them: closed surfaces",
            ),
            (
                "By loss",
                StopCriterion::PAPER,
                "Until few enough points share a voxel; all voxels have one size",
            ),
            (
                "To a level",
                StopCriterion::Depth(9),
                "Down to a level of the octree; all voxels have one size",
            ),
            (
                "By points",
                StopCriterion::PointsPerOctant(8),
                "While a cell holds more than so many points; voxels have several sizes",
            ),
        ],
    );
    match stop {
        StopCriterion::Spacing => {}
        StopCriterion::Loss(delta) => {
            // Shown in percent, kept as a fraction.
            let mut percent = *delta * 100.0;
            let slider = Slider::new(&mut percent, 0.0..=Style::MAX_DELTA * 100.0)
                .max_decimals(1)
                .suffix(" %");
            row(
                ui,
                "Loss δ",
                "The share of points that may share a voxel at the deepest level, percent",
                slider,
            );
            // Whole tenths only: each other value divides the octrees of all frames anew.
            *delta = (percent * 10.0).round() / 1000.0;
        }
        StopCriterion::Depth(depth) => row(
            ui,
            "Leaf level",
            "Level of all leaves; an edge of the octree's cube is 2 to the power of it voxels long",
            Slider::new(depth, Lod::LEVELS),
        ),
        StopCriterion::PointsPerOctant(points) => row(
            ui,
            "Points a leaf",
            "Most points in a leaf of the octree",
            Slider::new(points, 1..=10_000).logarithmic(true),
        ),
    }
}

fn lod(ui: &mut Ui, lod: &mut Lod) {
    kind(
        ui,
        "Level of detail",
        "Which cells of the octree are drawn",
        lod,
        &[
            (
                "Pixel threshold",
                Lod::default(),
                "Cells that are small on the screen are drawn as one voxel or surfel",
            ),
            ("Fixed level", Lod::Level(7), "All cells of one level"),
            (
                "Budget",
                Lod::Budget(50_000),
                "The finest picture of at most so many voxels or surfels",
            ),
            (
                "Frame time",
                Lod::FrameTimeMs(16.0),
                "As many voxels or surfels as this machine draws in the time asked for",
            ),
        ],
    );
    match lod {
        Lod::ThresholdPx(lod_px) => row(
            ui,
            "Threshold τ",
            "Octants whose edge is shorter than this on the screen are drawn as one voxel, pixels",
            Slider::new(lod_px, 0.5..=64.0)
                .logarithmic(true)
                .max_decimals(1)
                .suffix(" px"),
        ),
        Lod::Level(level) => row(
            ui,
            "Level",
            "Level of the octree whose cells are drawn; 0 is the cube around the cloud",
            Slider::new(level, Lod::LEVELS),
        ),
        Lod::Budget(voxels) => row(
            ui,
            "Voxels",
            "Most voxels a picture",
            Slider::new(voxels, 1_000..=10_000_000).logarithmic(true),
        ),
        Lod::FrameTimeMs(time_ms) => row(
            ui,
            "Time",
            "Time that a picture should take, milliseconds",
            Slider::new(time_ms, 2.0..=200.0)
                .logarithmic(true)
                .max_decimals(0)
                .suffix(" ms"),
        ),
    }
}
