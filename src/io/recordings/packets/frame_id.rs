//! Numbers of the frames of a sensor.

/// A frame of a sensor that numbers them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FrameId {
    pub(super) number: u32,
    /// The measurement at which frames begin: those before it are of the frame before. Zero, unless the sensor measures
    /// in a window of azimuths across its first measurement.
    pub(super) seam: u16,
}
