//! Part of a run of packets that belongs to one revolution.

/// Part of the packets of a revolution that belongs to that revolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TurnPart {
    /// From this cycle of the first packet to before that cycle of the last one.
    Cycles { first: u8, end: u8 },
    /// The columns of a frame.
    Frame(FrameId),
}

/// A frame of a sensor that numbers them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FrameId {
    pub(super) number: u32,
    /// The measurement at which frames begin: those before it are of the frame before. Zero, unless the sensor measures
    /// in a window of azimuths across its first measurement.
    pub(super) seam: u16,
}
