//! Compared render modes: those that differ in their behaviour from image to image.

use crate::bench::suites::error::variants::base;
use crate::levels::Lod;
use crate::levels::octree::StopCriterion;
use crate::scene::{PointShape, PointSizing, Primitive, RendererChoice, Settings, Splatting, VoxelLight};

/// All modes, first the CPU's, then the adapter's if there is one.
pub(super) fn variants(has_adapter: bool) -> Vec<Settings> {
    let base = base();
    let mut variants = of_renderer(&base);
    if has_adapter {
        variants.extend(of_renderer(
            &base.with(|style| style.drawing.renderer = RendererChoice::Gpu.into()),
        ));
    }
    variants
}

fn of_renderer(base: &Settings) -> Vec<Settings> {
    let with_splatting = |mode| base.with(|style| style.surfels.splatting = mode);
    let of = |primitive: Primitive| base.with(|style| style.primitive = primitive.into());
    let detail = |threshold_px| {
        base.with(|style| {
            style.levels.surfel_lod = true;
            style.levels.lod = Lod::ThresholdPx(threshold_px);
        })
    };
    let voxel = of(Primitive::Voxel);
    let point = of(Primitive::Point);
    let points = |sizing, shape| {
        point.with(|style| {
            style.points.sizing = sizing;
            style.points.shape = shape;
        })
    };
    vec![
        *base,
        with_splatting(Splatting::TwoPassEnlarged),
        with_splatting(Splatting::Opaque),
        detail(1.0),
        detail(4.0),
        of(Primitive::Ellipse),
        voxel,
        voxel.with(|style| style.levels.lod = Lod::ThresholdPx(4.0)),
        voxel.with(|style| style.voxels.light = VoxelLight::Faces),
        voxel.with(|style| style.levels.stop = StopCriterion::PAPER),
        point,
        points(PointSizing::Projected, PointShape::Square),
        points(PointSizing::Adaptive, PointShape::Gaussian),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::super::error::variants::label;
    use std::collections::HashSet;

    #[test]
    fn each_mode_has_its_words() {
        let variants = super::variants(true);
        let labels: HashSet<String> = variants.iter().map(label).collect();
        assert_eq!(labels.len(), variants.len(), "{labels:?}");
    }
}
