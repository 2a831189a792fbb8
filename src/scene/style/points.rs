//! How points are drawn that stay points.

/// How points are drawn that stay points.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct PointStyle {
    /// Edge of a drawn point in pixels.
    #[serde(rename = "point_size_px")]
    pub size_px: f32,
}

impl Default for PointStyle {
    fn default() -> Self {
        Self { size_px: 2.0 }
    }
}
