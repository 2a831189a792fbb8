//! Distinct places of a cloud in which many points lie exactly where another one does.
//!
//! Joined scans and repeated frames have such copies. Twelve neighbours that are copies of two points span no plane and
//! leave no gap to close, so the surface is estimated once per place.

use glam::Vec3;

/// The distinct places of some points.
#[derive(Debug)]
pub(in crate::analysis) struct Places {
    /// Each differs from the one before it.
    pub(in crate::analysis) positions: Vec<Vec3>,
    /// The place of each point.
    of_points: Vec<u32>,
}

impl Places {
    /// `None` where hardly any point is a copy. Copies are looked for among neighbours in memory: frames are in Morton
    /// order, in which they stand together.
    pub(in crate::analysis) fn of(points: &[Vec3]) -> Option<Self> {
        /// Fewer copies than one in this many points hardly take neighbours from the others.
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

    /// Scatters per-position data to all points.
    pub(in crate::analysis) fn spread<T: Copy>(&self, of_places: &[T]) -> Vec<T> {
        self.of_points.iter().map(|&place| of_places[place as usize]).collect()
    }

    /// The points of some places, ascending.
    pub(in crate::analysis) fn points_of(&self, places: &[u32]) -> Vec<u32> {
        let mut is_meant = vec![false; self.positions.len()];
        for &place in places {
            is_meant[place as usize] = true;
        }
        let points = (0u32..).zip(&self.of_points);
        points
            .filter(|(_, place)| is_meant[**place as usize])
            .map(|(point, _)| point)
            .collect()
    }

    /// Gathers for each position the value of the first of its points.
    pub(in crate::analysis) fn gather<T: Copy>(&self, of_points: &[T]) -> Vec<T> {
        let mut gathered = Vec::with_capacity(self.positions.len());
        for (&place, &value) in self.of_points.iter().zip(of_points) {
            if place as usize == gathered.len() {
                gathered.push(value);
            }
        }
        gathered
    }
}
