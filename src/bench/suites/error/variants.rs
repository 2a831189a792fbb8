//! Compared render modes: the default, and its variants with one choice changed at a time.

use crate::bench::BenchError;
use crate::bench::run::Run;
use crate::levels::octree::StopCriterion;
use crate::levels::{Lod, LodMetric};
use crate::scene::describe::{Described, Label, Place, Value, Values};
use crate::scene::{
    Antialiasing, Background, Footprint, Kernel, LevelStructure, Lighting, NormalSource, PointLight, PointShape,
    PointSizing, Primitive, RendererChoice, Settings, SplatFilter, SplatGeometry, Splatting, Strategy, VoxelLight,
};

/// Behind the object: a grey of medium lightness, so that most objects do not have that colour.
pub(in crate::bench::suites) const BACKGROUND: [u8; 3] = [119; 3];

/// Resolution scales to draw at, as fractions of an image's edges, in addition to full resolution.
const RESOLUTIONS: [f32; 2] = [0.75, 0.5];

/// LOD thresholds of surfels and of voxels in pixels, in addition to the default of 1.
const THRESHOLDS_PX: [f32; 3] = [2.0, 4.0, 8.0];

/// Acceptable losses, in addition to leaves as large as the spacing of points.
const DELTAS: [f32; 4] = [0.02, 0.05, 0.2, 0.5];

/// Factors on the radii of splats.
const SPLAT_SCALES: [f32; 4] = [0.7, 1.2, 1.4, 2.0];

/// Factors on them in the second pass alone, in addition to 2.
const ENLARGEMENTS: [f32; 2] = [1.2, 1.5];

/// Selects the modes of `all` that the options of a run request.
///
/// # Errors
/// If there are none.
pub(in crate::bench::suites) fn selected(run: &Run<'_>, all: Vec<Settings>) -> Result<Vec<Settings>, BenchError> {
    let modes = &run.options.modes;
    let variants: Vec<Settings> = all.into_iter().filter(|way| modes.admit(&way.decided())).collect();
    if variants.is_empty() {
        return Err(BenchError::Nothing(
            "none of the requested render modes is available on this machine".to_owned(),
        ));
    }
    Ok(variants)
}

/// The default surfels on the CPU, on [`BACKGROUND`].
pub(in crate::bench::suites) fn base() -> Settings {
    Settings::default().with(|style| {
        style.primitive = Primitive::Surfel.into();
        style.backdrop.background = Background::solid(BACKGROUND);
        style.drawing.renderer = RendererChoice::Cpu.into();
        // Like the truth and all other primitives: without light, an image of points is another image.
        style.points.light = PointLight::Normals;
    })
}

/// All modes, first the CPU's, then the adapter's if there is one.
pub(super) fn variants(has_adapter: bool) -> Vec<Settings> {
    let base = base();
    let mut variants = of_renderer(&base);
    if has_adapter {
        let base = base.with(|style| style.drawing.renderer = RendererChoice::Gpu.into());
        variants.extend(of_renderer(&base));
        for primitive in [Primitive::Surfel, Primitive::Voxel, Primitive::Point] {
            let others = Strategy::ALL
                .iter()
                .filter(|&&strategy| strategy != base.drawing.strategy);
            let base = base.with(|style| style.primitive = primitive.into());
            variants.extend(others.map(|&strategy| base.with(|style| style.drawing.strategy = strategy)));
        }
        variants.push(base.with(|style| style.surfels.geometry = SplatGeometry::Triangle));
    }
    variants
}

fn of_renderer(base: &Settings) -> Vec<Settings> {
    let point = base.with(|style| style.primitive = Primitive::Point.into());
    let voxel = base.with(|style| style.primitive = Primitive::Voxel.into());
    let mesh = base.with(|style| style.primitive = Primitive::Mesh.into());
    let detail = base.with(|style| style.levels.surfel_lod = true);
    let mut variants = of_points(&point);
    variants.extend(of_splats(base));
    // Where the file has triangles.
    variants.push(mesh);
    variants.extend(of_structures(base, &voxel));
    variants.extend(of_codes(base));
    let enlarged = base.with(|style| style.surfels.splatting = Splatting::TwoPassEnlarged);
    for whole in [*base, enlarged, detail, voxel, point] {
        variants.extend(RESOLUTIONS.map(|resolution| whole.with(|style| style.drawing.resolution = resolution)));
    }
    let opaque = base.with(|style| style.surfels.splatting = Splatting::Opaque);
    for stepped in [*base, opaque, mesh, voxel, point] {
        variants.extend(
            [Antialiasing::Fxaa, Antialiasing::Supersample]
                .map(|antialiasing| stepped.with(|style| style.drawing.antialiasing = antialiasing)),
        );
    }
    variants
}

/// Points by their size, shape and light.
fn of_points(point: &Settings) -> Vec<Settings> {
    let of_scene = |sizing, shape| {
        point.with(|style| {
            style.points.sizing = sizing;
            style.points.shape = shape;
        })
    };
    let mut variants = Vec::from([1.0, 2.0, 3.0].map(|size_px| point.with(|style| style.points.size_px = size_px)));
    for sizing in [PointSizing::Projected, PointSizing::Adaptive] {
        variants.extend([PointShape::Disk, PointShape::Gaussian].map(|shape| of_scene(sizing, shape)));
    }
    variants.push(of_scene(PointSizing::Projected, PointShape::Square));
    let blended = of_scene(PointSizing::Adaptive, PointShape::Gaussian);
    variants.push(blended.with(|style| style.levels.surfel_lod = true));
    variants
}

/// Surfels, ellipses and sprites by mode, size, light and filter.
fn of_splats(base: &Settings) -> Vec<Settings> {
    // Depth images cannot be compared with colour images.
    let modes = Splatting::ALL.iter().filter(|&&mode| mode != Splatting::Visibility);
    let mut variants: Vec<Settings> = modes
        .map(|&splatting| base.with(|style| style.surfels.splatting = splatting))
        .collect();
    variants.extend(SPLAT_SCALES.map(|splat_scale| base.with(|style| style.surfels.splat_scale = splat_scale)));
    let enlarged = base.with(|style| style.surfels.splatting = Splatting::TwoPassEnlarged);
    variants.extend(ENLARGEMENTS.map(|factor| enlarged.with(|style| style.surfels.enlargement = factor)));
    variants.extend([Kernel::Hat, Kernel::Flat].map(|kernel| base.with(|style| style.surfels.kernel = kernel)));
    variants.push(base.with(|style| style.surfels.normals = NormalSource::Screen));
    variants.extend(
        [Lighting::PerSurfel, Lighting::PerVertex, Lighting::Physical]
            .map(|lighting| base.with(|style| style.light.lighting = lighting.into())),
    );
    let ellipse = base.with(|style| style.primitive = Primitive::Ellipse.into());
    let sprite = base.with(|style| style.primitive = Primitive::Sprite.into());
    variants.extend([ellipse, sprite]);
    variants.push(ellipse.with(|style| style.surfels.splatting = Splatting::TwoPassEnlarged));
    variants.extend([ellipse, sprite].map(|splats| splats.with(|style| style.surfels.splatting = Splatting::Opaque)));
    for filter in [SplatFilter::Ewa, SplatFilter::Clamp] {
        variants.extend([*base, ellipse].map(|splats| splats.with(|style| style.surfels.filter = filter)));
    }
    variants
}

/// Returns level-of-detail structures by what they omit.
fn of_structures(base: &Settings, voxel: &Settings) -> Vec<Settings> {
    let detail = base.with(|style| style.levels.surfel_lod = true);
    let mut variants = Vec::new();
    // The octree follows below.
    for &structure in LevelStructure::ALL
        .iter()
        .filter(|&&structure| structure != LevelStructure::Octree)
    {
        let coarse = detail.with(|style| style.levels.structure = structure);
        // A plain list has no cells to which a threshold could apply.
        let lods = match structure {
            LevelStructure::None => [Lod::Budget(1 << 16), Lod::Budget(1 << 14)],
            _ => [Lod::ThresholdPx(1.0), Lod::ThresholdPx(4.0)],
        };
        variants.extend(lods.map(|lod| coarse.with(|style| style.levels.lod = lod)));
    }
    let by_area = detail.with(|style| style.levels.metric = LodMetric::Area);
    variants
        .extend([Lod::ThresholdPx(1.0), Lod::ThresholdPx(4.0)].map(|lod| by_area.with(|style| style.levels.lod = lod)));
    let ellipse = detail.with(|style| style.primitive = Primitive::Ellipse.into());
    for coarse in [detail, ellipse, *voxel] {
        variants.push(coarse);
        variants
            .extend(THRESHOLDS_PX.map(|threshold| coarse.with(|style| style.levels.lod = Lod::ThresholdPx(threshold))));
    }
    variants.push(voxel.with(|style| style.levels.lod = Lod::ThresholdPx(0.0)));
    variants.push(voxel.with(|style| style.voxels.light = VoxelLight::Faces));
    variants.extend(DELTAS.map(|delta| voxel.with(|style| style.levels.stop = StopCriterion::Loss(delta))));
    variants
}

/// From the octree's byte code.
fn of_codes(base: &Settings) -> Vec<Settings> {
    let whole = base.with(|style| style.levels.lod = Lod::ThresholdPx(0.0));
    let mut variants: Vec<Settings> = [Footprint::Masks, Footprint::Pixels]
        .map(|footprint| whole.with(|style| style.codes.footprint = footprint))
        .into();
    variants.push(base.with(|style| style.codes.footprint = Footprint::Masks));
    variants
}

/// A mode in a few words: primitive, detail and renderer, as in the descriptions of settings.
pub(in crate::bench::suites) fn label(way: &Settings) -> String {
    let (drawn, usual) = (way.decided(), Settings::default().settings());
    let mut told: Vec<(Place, String)> = way
        .settings()
        .into_iter()
        .zip(usual)
        .filter(|((described, _), _)| (described.when)(&drawn))
        .filter_map(|((described, value), (_, usual))| {
            let (place, pattern) = match described.label {
                Label::Always(place, pattern) => Some((place, pattern)),
                Label::Unusual(place, pattern) => (value != usual).then_some((place, pattern)),
                Label::If(when, place, pattern) => when(&drawn).then_some((place, pattern)),
                Label::Untold => None,
            }?;
            Some((place, told(described, value, pattern)?))
        })
        .collect();
    // Stable: entries with the same place stay in the order of the descriptions.
    told.sort_by_key(|(place, _)| *place);
    let words: Vec<String> = told.into_iter().map(|(_, text)| text).collect();
    words.join(" ")
}

/// A value by the pattern of a label.
fn told(described: &Described, value: Value, pattern: &str) -> Option<String> {
    Some(match (&described.values, value) {
        (Values::Words(words), Value::Word(place)) => pattern
            .replace("{title}", words.list[place].title)
            .replace("{}", words.list[place].word),
        (Values::Number(numbers), Value::Number(number)) => pattern.replace("{}", &numbers.told(number)),
        (Values::Kinds(kinds), Value::Kind(place, number)) => {
            let kind = &kinds[place];
            let number = kind.number.as_ref().map(|told| told.numbers.told(number));
            let kind = kind.label.replace("{}", &number.unwrap_or_default());
            pattern.replace("{}", &kind)
        }
        (Values::Environment, Value::Environment(environment)) => pattern.replace("{}", &environment.to_string()),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_variant_is_measured_twice_and_each_has_its_own_words() {
        let variants = variants(true);
        let labels: HashSet<String> = variants.iter().map(label).collect();
        assert_eq!(
            labels.len(),
            variants.len(),
            "{:?}",
            variants.iter().map(label).collect::<Vec<_>>()
        );
        let of_processor = super::variants(false);
        assert!(
            of_processor
                .iter()
                .all(|way| way.drawing.renderer == RendererChoice::Cpu)
        );
        // Twelve strategies and a geometry are the adapter's.
        assert_eq!(variants.len(), 2 * of_processor.len() + 13);
        let first = label(&of_processor[0]);
        assert_eq!(first, "point 1 px lit by normals CPU");
    }
}
