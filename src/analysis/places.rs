//! Distinct places of a cloud in which many points lie exactly where another one does.
//!
//! Joined scans and repeated frames have such copies. Twelve neighbours that are copies of two points span no plane and
//! leave no gap to close, so the surface is estimated once per place.

use super::Surface;
use glam::Vec3;

/// The distinct places of some points.
#[derive(Debug)]
pub(super) struct Places {
    /// Each differs from the one before it.
    pub(super) positions: Vec<Vec3>,
    /// The place of each point.
    of_points: Vec<u32>,
}

impl Places {
    /// `None` where hardly any point is a copy. Copies are looked for among neighbours in memory: frames are in Morton
    /// order, in which they stand together.
    pub(super) fn of(points: &[Vec3]) -> Option<Self> {
        /// Fewer copies than one point in so many hardly take neighbours from the others.
        const RARE: usize = 16;
        let copies = points.windows(2).filter(|pair| pair[0] == pair[1]).count();
        if copies == 0 || copies * RARE < points.len() {
            return None;
        }
        let mut positions: Vec<Vec3> = Vec::with_capacity(points.len() - copies);
        let mut of_points = Vec::with_capacity(points.len());
        for &point in points {
            if positions.last() != Some(&point) {
                positions.push(point);
            }
            of_points.push(positions.len() as u32 - 1);
        }
        Some(Self { positions, of_points })
    }

    /// What is known of each place, for each point.
    pub(super) fn spread<T: Copy>(&self, of_places: &[T]) -> Vec<T> {
        self.of_points.iter().map(|&place| of_places[place as usize]).collect()
    }

    /// What each place has of the first of its points.
    pub(super) fn gather<T: Copy>(&self, of_points: &[T]) -> Vec<T> {
        let mut gathered = Vec::with_capacity(self.positions.len());
        for (&place, &value) in self.of_points.iter().zip(of_points) {
            if place as usize == gathered.len() {
                gathered.push(value);
            }
        }
        gathered
    }

    /// The surface around each place, for each point.
    pub(super) fn spread_surface(&self, surface: &Surface) -> Surface {
        let mut is_without = vec![false; self.positions.len()];
        for &place in &surface.without_plane {
            is_without[place as usize] = true;
        }
        let points = (0u32..).zip(&self.of_points);
        Surface {
            normals: self.spread(&surface.normals),
            orientation: surface.orientation,
            radii: self.spread(&surface.radii),
            without_plane: points
                .filter(|(_, place)| is_without[**place as usize])
                .map(|(point, _)| point)
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_shapes::{self, Random};
    use super::super::{estimate_surface, splat_ellipses, splat_radii};
    use super::*;

    /// Each point five times in a row.
    fn five_times<T: Copy>(values: &[T]) -> Vec<T> {
        values.iter().flat_map(|&value| [value; 5]).collect()
    }

    #[test]
    fn copies_change_neither_normals_nor_radii() {
        let points = test_shapes::sphere(700, &mut Random(3)).positions;
        let alone = estimate_surface(&points, None);
        let copied = estimate_surface(&five_times(&points), None);
        assert_eq!(copied.normals, five_times(&alone.normals));
        assert_eq!(copied.radii, five_times(&alone.radii));
        assert!(copied.without_plane.is_empty());
        let normals = five_times(&alone.normals);
        assert_eq!(
            splat_radii(&five_times(&points), &normals),
            five_times(&splat_radii(&points, &alone.normals))
        );
        assert_eq!(
            splat_ellipses(&five_times(&points), &normals),
            five_times(&splat_ellipses(&points, &alone.normals))
        );
    }

    #[test]
    fn points_without_a_plane_are_all_copies() {
        let line: Vec<Vec3> = (0..20).map(|place| Vec3::X * place as f32).collect();
        let alone = estimate_surface(&line, None);
        let copied = estimate_surface(&five_times(&line), None);
        assert_eq!(copied.without_plane.len(), 5 * alone.without_plane.len());
        assert_eq!(copied.without_plane.len(), 100);
    }

    #[test]
    fn a_few_copies_are_points_like_others() {
        let mut points = vec![Vec3::ONE; 2];
        points.extend((0..40).map(|place| Vec3::Y * place as f32));
        assert!(Places::of(&points).is_none());
        assert!(Places::of(&[]).is_none());
        assert!(Places::of(&[Vec3::ZERO; 3]).is_some_and(|places| places.positions.len() == 1));
    }
}
