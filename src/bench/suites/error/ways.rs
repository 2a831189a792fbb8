//! The ways to draw that are compared: the default, and what it becomes when one choice after the other changes.

use crate::levels::Lod;
use crate::levels::octree::StopCriterion;
use crate::scene::{
    Backdrop, Background, CodeStyle, Footprint, LevelStyle, LightStyle, Lighting, PointStyle,
    Primitive, RendererChoice, Splatting, Strategy, Style, SurfelStyle, VoxelLight, VoxelStyle,
};
use std::fmt::Write as _;

/// Behind the object: a grey of medium lightness, so that it is no colour of most objects.
pub(super) const BACKGROUND: [u8; 3] = [119; 3];

/// Shares of a picture's edges that are drawn, beside all of it.
const RESOLUTIONS: [f32; 2] = [0.75, 0.5];

/// LOD thresholds of surfels and of voxels in pixels, beside the default of 1.
const THRESHOLDS_PX: [f32; 3] = [2.0, 4.0, 8.0];

/// Acceptable losses, beside leaves as large as the spacing of points.
const DELTAS: [f32; 4] = [0.02, 0.05, 0.2, 0.5];

/// All ways, first those of the processor, then those of the adapter if there is one.
pub(super) fn ways(has_adapter: bool) -> Vec<Style> {
    let base = Style {
        renderer: RendererChoice::Cpu,
        primitive: Primitive::Surfel,
        backdrop: Backdrop {
            background: Background::solid(BACKGROUND),
            ..Backdrop::default()
        },
        ..Style::default()
    };
    let mut ways = of_renderer(&base);
    if has_adapter {
        let base = Style {
            renderer: RendererChoice::Gpu,
            ..base
        };
        ways.extend(of_renderer(&base));
        for primitive in [Primitive::Surfel, Primitive::Voxel, Primitive::Point] {
            let others = Strategy::ALL
                .iter()
                .filter(|&&strategy| strategy != base.strategy);
            ways.extend(others.map(|&strategy| Style {
                primitive,
                strategy,
                ..base
            }));
        }
    }
    ways
}

fn of_renderer(base: &Style) -> Vec<Style> {
    let point = Style {
        primitive: Primitive::Point,
        ..*base
    };
    let voxel = Style {
        primitive: Primitive::Voxel,
        ..*base
    };
    let detail = Style {
        levels: LevelStyle {
            surfel_lod: true,
            ..base.levels
        },
        ..*base
    };
    let mut ways = Vec::new();
    ways.extend([1.0, 2.0, 3.0].map(|point_size_px| Style {
        points: PointStyle {
            size_px: point_size_px,
        },
        ..point
    }));
    // A picture of depths is none of colours.
    let modes = Splatting::ALL
        .iter()
        .filter(|&&mode| mode != Splatting::Visibility);
    ways.extend(modes.map(|&splatting| Style {
        surfels: SurfelStyle {
            splatting,
            ..base.surfels
        },
        ..*base
    }));
    ways.extend([0.7, 1.4].map(|splat_scale| Style {
        surfels: SurfelStyle {
            splat_scale,
            ..base.surfels
        },
        ..*base
    }));
    ways.extend(
        [Lighting::PerSurfel, Lighting::PerVertex].map(|lighting| Style {
            light: LightStyle {
                lighting,
                ..base.light
            },
            ..*base
        }),
    );
    for coarse in [detail, voxel] {
        ways.push(coarse);
        ways.extend(THRESHOLDS_PX.map(|threshold| Style {
            levels: LevelStyle {
                lod: Lod::ThresholdPx(threshold),
                ..coarse.levels
            },
            ..coarse
        }));
    }
    ways.push(Style {
        levels: LevelStyle {
            lod: Lod::ThresholdPx(0.0),
            ..voxel.levels
        },
        ..voxel
    });
    ways.push(Style {
        voxels: VoxelStyle {
            light: VoxelLight::Faces,
        },
        ..voxel
    });
    ways.extend(DELTAS.map(|delta| Style {
        levels: LevelStyle {
            stop: StopCriterion::Loss(delta),
            ..voxel.levels
        },
        ..voxel
    }));
    let enlarged = Style {
        surfels: SurfelStyle {
            splatting: Splatting::TwoPassEnlarged,
            ..base.surfels
        },
        ..*base
    };
    if base.renderer == RendererChoice::Cpu {
        // The GPU draws exact disks whatever it says.
        ways.extend(
            [Footprint::Masks, Footprint::Pixels].map(|footprint| Style {
                levels: LevelStyle {
                    lod: Lod::ThresholdPx(0.0),
                    ..base.levels
                },
                codes: CodeStyle {
                    footprint,
                    ..base.codes
                },
                ..*base
            }),
        );
        ways.push(Style {
            codes: CodeStyle {
                footprint: Footprint::Masks,
                ..base.codes
            },
            ..*base
        });
    }
    for whole in [*base, enlarged, detail, voxel, point] {
        ways.extend(RESOLUTIONS.map(|resolution| Style {
            resolution,
            ..whole
        }));
    }
    ways
}

/// A way in a few words: what differs from the default is said.
pub(super) fn label(way: &Style) -> String {
    let default = Style::default();
    let mut label = way.primitive.to_string();
    let mut say = |text: String| {
        // Writing to a String cannot fail.
        let _ = write!(label, " {text}");
    };
    match way.primitive {
        Primitive::Auto | Primitive::Surfel => {
            say(way.surfels.splatting.to_string());
            if way.surfels.splat_scale != default.surfels.splat_scale {
                say(format!("×{}", way.surfels.splat_scale));
            }
            if way.codes.footprint != default.codes.footprint {
                say(format!("of {}", way.codes.footprint));
            }
            if way.light.lighting != default.light.lighting {
                say(format!("lit per {}", way.light.lighting));
            }
        }
        Primitive::Voxel => {
            say(stop(way));
            if way.voxels.light != default.voxels.light {
                say(format!("lit by {}", way.voxels.light));
            }
        }
        Primitive::Point => say(format!("{} px", way.points.size_px)),
    }
    if let (true, Lod::ThresholdPx(threshold)) =
        (way.draws_cells() || way.draws_codes(), way.levels.lod)
    {
        say(format!("τ {threshold}"));
    }
    if way.resolution < 1.0 {
        say(format!("at {:.0} %", way.resolution * 100.0));
    }
    say(match way.renderer {
        RendererChoice::Gpu => format!("GPU {}", way.strategy),
        RendererChoice::Cpu | RendererChoice::Auto => "CPU".to_owned(),
    });
    label
}

/// When the octree's cells are no longer divided.
pub(super) fn stop(way: &Style) -> String {
    match way.octree_stop() {
        StopCriterion::Spacing => "by spacing".to_owned(),
        StopCriterion::Loss(delta) => format!("δ {:.0} %", delta * 100.0),
        other => format!("{other:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_way_is_measured_twice_and_each_has_its_words() {
        let ways = ways(true);
        let labels: HashSet<String> = ways.iter().map(label).collect();
        assert_eq!(
            labels.len(),
            ways.len(),
            "{:?}",
            ways.iter().map(label).collect::<Vec<_>>()
        );
        let of_processor = super::ways(false);
        assert!(
            of_processor
                .iter()
                .all(|way| way.renderer == RendererChoice::Cpu)
        );
        // Three footprints of byte codes are the processor's; twelve strategies the adapter's.
        assert_eq!(ways.len(), 2 * of_processor.len() - 3 + 12);
        let first = label(&of_processor[0]);
        assert_eq!(first, "point 1 px CPU");
    }
}
