//! Completing a frame: neighbours, normals, radii and colours, as pure functions on slices.
//!
//! Nothing here depends on timing or on the number of threads in rayon's pool: the same points give the same bits.

mod color;
mod normal_errors;
pub mod screen;
mod search;
mod surface;
#[cfg(test)]
pub(crate) mod test_shapes;
#[cfg(test)]
mod tests;

pub use color::classes::{class_color, class_name, class_of};
pub use color::color_maps::ColorMap;
pub(crate) use color::color_places::{NO_PLACE, Placer};
pub use color::color_scale::{ColorScale, histogram, quantile_range};
pub use color::colors::fake_color;
pub use normal_errors::NormalErrors;
pub use search::nearest_point::NearestPoint;
pub use search::neighbours::{Neighbours, nearest_neighbours};
pub use surface::curved_splats::{Disk, curved_splats};
pub use surface::file_surface::FileSurface;
pub use surface::options::{DEFAULT_NEIGHBOURS, PlaneFit, SurfaceOptions};
pub use surface::outlier::outliers;
pub use surface::radii::LONE_RADIUS;

use crate::cloud::Ellipse;
use crate::progress::Progress;
use glam::Vec3;
use search::places::Places;
use search::point_tree::PointTree;
use surface::blocks::SlotSurface;
use surface::normals::SlotPlanes;
use surface::steps::{NEIGHBOURS_STEPS, OUTWARDS_STEPS, PLANES_STEPS, RADII_STEPS, REPRESENTATIVES_STEPS, TREE_STEPS};

/// Method by which the signs of normals were decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Orientation {
    /// They are as the file has them.
    File,
    /// All normals point to where the sensor stood.
    Sensor,
    /// They agree over the neighbourhood graph of all points, and each connected component faces outwards.
    Neighbours,
    /// Orientation propagated from representatives, one point in 64, with which the normals of those around it agree:
    /// right nearly everywhere on smooth surfaces, by chance where two sheets are nearer to each other than these
    /// points.
    Representatives,
}

/// The surface around each point, in the order of the points.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Unit normals, oriented by [`Surface::orientation`].
    pub normals: Vec<Vec3>,
    /// Method by which the signs of the normals were decided.
    pub orientation: Orientation,
    /// Splat radii in scene units; positive and finite.
    pub radii: Vec<f32>,
    /// The points whose neighbours define no plane, ascending: they lie on a line or in one place, as far as f32
    /// coordinates tell, or there are fewer than three. Their normals are across the line, or +Z.
    pub without_plane: Vec<u32>,
    /// Basis of the normals.
    pub basis: NormalBasis,
}

/// The planes that fit the points around each point best, in the order of the points.
#[derive(Debug, Clone, PartialEq)]
pub struct Planes {
    /// Unit normals, each of any sign.
    pub normals: Vec<Vec3>,
    /// The points whose neighbours define no plane, ascending: see [`Surface::without_plane`].
    pub without_plane: Vec<u32>,
    /// Basis of the normals.
    pub basis: NormalBasis,
}

/// Basis of estimated normals: the neighbours, and the noise that was found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NormalBasis {
    /// Neighbours of each point that were searched for.
    pub neighbours: usize,
    /// Standard deviation of the noise in point spacings; 0 if not measured.
    pub noise: f32,
    /// True if neighbourhoods were merged with their neighbours' and are as good as [`WIDENED_NEIGHBOURS`] points.
    pub is_widened: bool,
}

impl NormalBasis {
    /// Number of neighbours that normals are as good as estimated from.
    pub fn reach(&self) -> usize {
        if self.is_widened {
            WIDENED_NEIGHBOURS
        } else {
            self.neighbours
        }
    }
}

/// Neighbours of a plain fit whose normals are as good on a noisy plane as those of widened neighbourhoods.
pub const WIDENED_NEIGHBOURS: usize = 40;

/// Most points whose neighbourhoods are widened: their lists of neighbours are in memory at once.
pub const MAX_WIDENED: usize = 1 << 23;

/// Estimates normals alone, from `k` neighbours and without turning them to one side.
pub fn estimate_planes(positions: &[Vec3], k: usize, fit: PlaneFit) -> Planes {
    let neighbours = Some(k.min(usize::from(u16::MAX)) as u16);
    estimate_planes_with(positions, SurfaceOptions { neighbours, fit })
}

/// The normals of [`estimate_surface`] with these options, each of any sign.
pub fn estimate_planes_with(positions: &[Vec3], options: SurfaceOptions) -> Planes {
    let tree = PointTree::new(positions);
    let basis = basis_of(&tree, options);
    let neighbours = tree.neighbours(basis.neighbours);
    let planes = planes_of(&tree, &neighbours, options.fit, basis);
    Planes {
        normals: tree.to_file_order(&planes.normals),
        without_plane: tree.to_file_indices(&planes.without_plane),
        basis,
    }
}

/// Returns the basis of the normals of a cloud.
fn basis_of(tree: &PointTree, options: SurfaceOptions) -> NormalBasis {
    if let Some(neighbours) = options.neighbours {
        return NormalBasis {
            neighbours: usize::from(neighbours),
            ..NormalBasis::default()
        };
    }
    let noise = surface::noise::noise(tree);
    NormalBasis {
        neighbours: DEFAULT_NEIGHBOURS,
        noise: noise as f32,
        is_widened: tree.len() <= MAX_WIDENED && surface::wide_planes::share_of_neighbours(noise as f32) > 0.0,
    }
}

/// The planes of all points of a tree. Precondition: `neighbours` are those of the basis.
fn planes_of(tree: &PointTree, neighbours: &Neighbours, fit: PlaneFit, basis: NormalBasis) -> SlotPlanes {
    let refine = |planes: &mut SlotPlanes| {
        if fit == PlaneFit::Robust {
            surface::robust_planes::refine(tree, neighbours, 0, &planes.without_plane, &mut planes.normals);
        }
    };
    if !basis.is_widened {
        let mut planes = surface::normals::fit_planes(tree, neighbours, 0..tree.len());
        refine(&mut planes);
        return planes;
    }
    let (mut planes, mut neighbourhoods) = surface::normals::fit_neighbourhoods(tree, neighbours);
    refine(&mut planes);
    if fit == PlaneFit::Robust {
        surface::wide_planes::set_normals(&mut neighbourhoods, &planes.normals);
    }
    let share = surface::wide_planes::share_of_neighbours(basis.noise);
    let SlotPlanes { normals, without_plane } = &mut planes;
    surface::wide_planes::widen(neighbourhoods, neighbours, share, without_plane, normals);
    planes
}

/// Points that were moved onto the surface around them.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// The positions, in the order of the points.
    pub positions: Vec<Vec3>,
    /// Median of the distances by which points moved.
    pub median_distance: f32,
    /// The largest of them.
    pub max_distance: f32,
}

impl Smoothed {
    /// Reports in words how far points were moved.
    pub fn told(&self, radius_spacings: f32) -> String {
        let count = self.positions.len();
        format!(
            "{count} points are smoothed (moving least squares within {radius_spacings} point spacings): moved by {} \
             in the median, {} at most",
            self.median_distance, self.max_distance
        )
    }
}

/// Moves finite `positions` onto the surface around them, from neighbourhoods of a radius in point spacings (moving
/// least squares; Alexa et al. 2003). Advances `progress` by the number of points; once that is cancelled, the result
/// is not usable.
pub fn smooth(positions: &[Vec3], radius_spacings: f32, progress: &Progress) -> Smoothed {
    let smoothed = if let Some(places) = Places::of(positions) {
        let distinct = smooth_distinct(&places.positions, radius_spacings, progress);
        progress.advance(positions.len() - places.positions.len());
        places.spread(&distinct)
    } else {
        smooth_distinct(positions, radius_spacings, progress)
    };
    let distances = smoothed.iter().zip(positions).map(|(to, from)| to.distance(*from));
    let mut distances: Vec<f32> = distances.collect();
    let center = distances.len() / 2;
    let median_distance = match distances.get(center) {
        Some(_) => *distances.select_nth_unstable_by(center, f32::total_cmp).1,
        None => 0.0,
    };
    Smoothed {
        positions: smoothed,
        median_distance,
        max_distance: distances.iter().copied().fold(0.0, f32::max),
    }
}

fn smooth_distinct(positions: &[Vec3], radius_spacings: f32, progress: &Progress) -> Vec<Vec3> {
    let tree = PointTree::new(positions);
    let projected = surface::smoothing::projected(&tree, radius_spacings, progress);
    let mut smoothed = tree.to_file_order(&projected);
    for (to, &from) in smoothed.iter_mut().zip(positions) {
        let scaled = *to * tree.unit();
        *to = if scaled.is_finite() { scaled } else { from };
    }
    smoothed
}

/// Most points whose normals are made to agree over all of their neighbourhood graph.
///
/// That takes one thread half a microsecond a point and 100 bytes, most of a frame's time and memory; surfels with a
/// back side, as clouds without a sensor have, look the same with any sign. Playing sequences have fewer points a
/// frame, and keep the exact signs.
pub const MAX_JOINED: usize = 1 << 21;

/// Estimates normals and radii with the default [`SurfaceOptions`].
///
/// Normals point to `sensor` if it is given; else they are made consistent over the neighbourhood graph, and each
/// connected component faces outwards: of all points up to [`MAX_JOINED`], beyond it of representatives. Positions
/// must be finite. Any number of points is valid: a point without a surface around it (fewer than three distinct points
/// nearby, or all in a line) gets a normal perpendicular to those, or +Z if there are none.
///
/// Takes at most some 70 bytes per point in addition to the positions and the result; 130 where all points are joined,
/// and 100 more where neighbourhoods are widened.
pub fn estimate_surface(positions: &[Vec3], sensor: Option<Vec3>) -> Surface {
    estimate_surface_observed(positions, sensor, SurfaceOptions::default(), &Progress::default())
}

/// [`estimate_surface`] with options, which advances `progress` by [`surface_steps`]. Once that is cancelled, the rest
/// is skipped and the result is not usable.
pub fn estimate_surface_observed(
    positions: &[Vec3],
    sensor: Option<Vec3>,
    options: SurfaceOptions,
    progress: &Progress,
) -> Surface {
    let orientation = orientation_of(positions.len(), sensor);
    surface_oriented_by(orientation, positions, sensor, options, progress)
}

/// [`estimate_surface`] for an image that is soon replaced: without a sensor, points agree with representatives however
/// few they are.
pub(crate) fn estimate_surface_fast(positions: &[Vec3], sensor: Option<Vec3>, options: SurfaceOptions) -> Surface {
    let orientation = orientation_of(usize::MAX, sensor);
    surface_oriented_by(orientation, positions, sensor, options, &Progress::default())
}

fn surface_oriented_by(
    orientation: Orientation,
    positions: &[Vec3],
    sensor: Option<Vec3>,
    options: SurfaceOptions,
    progress: &Progress,
) -> Surface {
    if let Some(places) = Places::of(positions) {
        let surface = surface_of_distinct(orientation, &places.positions, sensor, options, progress);
        let copies = positions.len() - places.positions.len();
        progress.advance(surface_steps(copies, sensor));
        return Surface {
            normals: places.spread(&surface.normals),
            orientation: surface.orientation,
            radii: places.spread(&surface.radii),
            without_plane: places.points_of(&surface.without_plane),
            basis: surface.basis,
        };
    }
    surface_of_distinct(orientation, positions, sensor, options, progress)
}

fn surface_of_distinct(
    orientation: Orientation,
    positions: &[Vec3],
    sensor: Option<Vec3>,
    options: SurfaceOptions,
    progress: &Progress,
) -> Surface {
    let estimated = estimated_surface(positions, sensor, orientation, options, progress);
    estimated.unwrap_or_else(|| Surface {
        normals: vec![Vec3::Z; positions.len()],
        orientation,
        radii: vec![0.0; positions.len()],
        without_plane: Vec::new(),
        basis: NormalBasis::default(),
    })
}

/// Method that decides the signs of this many estimated normals.
fn orientation_of(points: usize, sensor: Option<Vec3>) -> Orientation {
    match sensor {
        Some(_) => Orientation::Sensor,
        // Above this size, the forest over all points took four fifths of the time, and its result is invisible where
        // back faces are drawn.
        None if points <= MAX_JOINED => Orientation::Neighbours,
        None => Orientation::Representatives,
    }
}

/// `None` once `progress` is cancelled.
fn estimated_surface(
    positions: &[Vec3],
    sensor: Option<Vec3>,
    orientation: Orientation,
    options: SurfaceOptions,
    progress: &Progress,
) -> Option<Surface> {
    let goes_on = |steps: usize| {
        progress.advance(steps * positions.len());
        (!progress.is_cancelled()).then_some(())
    };
    let mut tree = PointTree::new(positions);
    // Computing surfaces of single points on demand (`LazySurface`) was removed: any search needs this tree over all
    // points first, which is a quarter to a third of the whole estimation.
    goes_on(TREE_STEPS)?;
    let basis = basis_of(&tree, options);
    let joins_all = orientation == Orientation::Neighbours;
    let mut by_slot = if joins_all || basis.is_widened {
        let neighbours = tree.neighbours(basis.neighbours);
        goes_on(NEIGHBOURS_STEPS)?;
        let planes = planes_of(&tree, &neighbours, options.fit, basis);
        goes_on(PLANES_STEPS)?;
        let neighbours = match basis.neighbours {
            DEFAULT_NEIGHBOURS => neighbours,
            _ => tree.neighbours(DEFAULT_NEIGHBOURS),
        };
        let radii = surface::radii::closing_radii(&tree, &neighbours, &planes.normals);
        goes_on(RADII_STEPS)?;
        let mut normals = planes.normals;
        if joins_all {
            surface::orientation::face_outwards(&tree, &neighbours, &mut normals);
            goes_on(OUTWARDS_STEPS)?;
        }
        SlotSurface {
            normals,
            radii,
            without_plane: planes.without_plane,
        }
    } else {
        surface::blocks::surface(&tree, basis.neighbours, options.fit, progress)?
    };
    tree.forget_boxes();
    if let Some(sensor) = sensor {
        surface::orientation::face_sensor(&tree, sensor, 0, &mut by_slot.normals);
    } else if orientation == Orientation::Representatives {
        surface::orientation::face_as_representatives(&tree, DEFAULT_NEIGHBOURS, &mut by_slot.normals);
        goes_on(REPRESENTATIVES_STEPS)?;
    }
    let without_plane = tree.to_file_indices(&by_slot.without_plane);
    let SlotSurface { normals, radii, .. } = by_slot;
    let order = tree.into_file_order();
    // Each frees its memory before the next is reordered.
    let in_file_order = |normals: Vec<Vec3>| order.of(&normals);
    let normals = in_file_order(normals);
    Some(Surface {
        normals,
        orientation,
        radii: order.of(&radii),
        without_plane,
        basis,
    })
}

/// Steps that [`estimate_surface_observed`] takes: about a hundredth of a microsecond each.
pub fn surface_steps(points: usize, sensor: Option<Vec3>) -> usize {
    let per_point = TREE_STEPS + NEIGHBOURS_STEPS + PLANES_STEPS + RADII_STEPS;
    let orientation = match orientation_of(points, sensor) {
        Orientation::File | Orientation::Sensor => 0,
        Orientation::Neighbours => OUTWARDS_STEPS,
        Orientation::Representatives => REPRESENTATIVES_STEPS,
    };
    points * (per_point + orientation)
}

/// The radii of [`estimate_surface`] for points that have normals.
///
/// `normals` are of unit length, or zero where the tangent plane has to be estimated.
///
/// # Panics
/// Precondition: as many normals as positions.
pub fn splat_radii(positions: &[Vec3], normals: &[Vec3]) -> Vec<f32> {
    assert_eq!(positions.len(), normals.len(), "one normal for each point");
    if let Some(places) = Places::of(positions) {
        return places.spread(&radii_of_distinct(&places.positions, &places.gather(normals)));
    }
    radii_of_distinct(positions, normals)
}

fn radii_of_distinct(positions: &[Vec3], normals: &[Vec3]) -> Vec<f32> {
    let tree = PointTree::new(positions);
    let neighbours = tree.neighbours(DEFAULT_NEIGHBOURS);
    let mut normals = tree.to_slot_order(normals);
    surface::normals::fill_missing(&tree, &neighbours, &mut normals);
    tree.to_file_order(&surface::radii::closing_radii(&tree, &neighbours, &normals))
}

/// Ellipses that close the surface as the circles of [`splat_radii`] do, with less area; `None` where a circle is
/// right.
///
/// `normals` are of unit length, or zero where the tangent plane has to be estimated. The radius of the circle is the
/// quadratic mean of the half axes: see [`Ellipse::radius_of_quadratic_mean`].
///
/// # Panics
/// Precondition: as many normals as positions.
pub fn splat_ellipses(positions: &[Vec3], normals: &[Vec3]) -> Vec<Option<Ellipse>> {
    assert_eq!(positions.len(), normals.len(), "one normal for each point");
    if let Some(places) = Places::of(positions) {
        return places.spread(&ellipses_of_distinct(&places.positions, &places.gather(normals)));
    }
    ellipses_of_distinct(positions, normals)
}

fn ellipses_of_distinct(positions: &[Vec3], normals: &[Vec3]) -> Vec<Option<Ellipse>> {
    let tree = PointTree::new(positions);
    let neighbours = tree.neighbours(DEFAULT_NEIGHBOURS);
    let mut normals = tree.to_slot_order(normals);
    surface::normals::fill_missing(&tree, &neighbours, &mut normals);
    tree.to_file_order(&surface::ellipses::closing_ellipses(&tree, &neighbours, &normals))
}
