//! Options of estimating normals.

/// Number of neighbours that normals and radii are estimated from.
///
/// Twelve are two rings of a triangulated surface: enough to average noise out of a normal and to enclose a point on
/// all sides, few enough not to reach round corners. The point itself is not counted.
// Fewer leave more of a surface open and need larger disks (random samples of a sphere and a torus): 12 leave less than
// 0.02 %, 10 leave 0.04 % with 1.05 times the area, 9 0.05 % with 1.1 times, 8 0.1 % with 1.16 times.
pub const DEFAULT_NEIGHBOURS: usize = 12;

/// Method of fitting a plane to neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum PlaneFit {
    /// Least squares (principal components): all points count alike (Hoppe et al. 1992). Fastest, and best against
    /// noise that all have.
    #[default]
    Plain,
    /// Principal components of points weighted by their distance from the plane (Cauchy's weights; Holland and Welsch
    /// 1977): points far off the surface hardly count, nor does the other side of an edge. Takes several times as long.
    Robust,
}

impl PlaneFit {
    /// All methods, in the order of a list.
    pub const ALL: [Self; 2] = [Self::Plain, Self::Robust];

    /// Its word in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "least squares",
            Self::Robust => "robust",
        }
    }
}

/// Options of estimating normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub struct SurfaceOptions {
    /// Neighbours that a normal is estimated from; `None` for [`DEFAULT_NEIGHBOURS`], widened where the cloud is noisy.
    pub neighbours: Option<u16>,
    /// Method of fitting planes to them.
    pub fit: PlaneFit,
}

impl SurfaceOptions {
    /// Options where no one has chosen.
    pub const AUTO: Self = Self {
        neighbours: None,
        fit: PlaneFit::Plain,
    };
}
