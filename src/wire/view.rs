//! View of a client: a server answers with the points visible in this view.

use super::bytes::{Fields, Written};
use super::error::WireError;
use super::message::{Kind, Message};
use glam::{DVec3, Mat3};

/// Bytes of a view as this version writes it.
const LAYOUT_BYTES: usize = 92;

/// Maximum width and height of an image.
const MAX_EDGE_PX: u32 = 1 << 14;

/// Maximum number of pixels of an image: a server has numbers for each.
const MAX_PIXELS: u64 = 1 << 24;

/// Tolerance for the orthonormality of the axes: deviation from right angles and from length 1.
const MAX_SKEW: f32 = 1e-3;

/// Name of the part being read, for errors.
const WHAT: &str = "a view";

/// A view of the frames of a stream, and the pixels of its image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Eye position (camera centre), in the coordinates of the frames.
    pub eye: DVec3,
    /// From the axes of the frames to the view's: right, up, backward.
    pub rotation: Mat3,
    /// Nothing nearer along the view axis is seen.
    pub near: f32,
    /// Width and height of the image.
    pub size_px: [u32; 2],
    /// Pixels from the view axis for a slope of 1, rightwards and downwards.
    pub px_per_slope: [f32; 2],
    /// Principal point: the pixel where the view axis meets the image.
    pub center_px: [f32; 2],
}

impl View {
    /// As a message.
    pub fn message(&self) -> Message {
        let mut payload = Written(Vec::with_capacity(LAYOUT_BYTES));
        payload
            .u32(LAYOUT_BYTES as u32)
            .f64s(&self.eye.to_array())
            .f32s(&self.rotation.to_cols_array())
            .f32s(&[self.near])
            .u32(self.size_px[0])
            .u32(self.size_px[1])
            .f32s(&self.px_per_slope)
            .f32s(&self.center_px);
        debug_assert_eq!(payload.0.len(), LAYOUT_BYTES);
        Message::new(Kind::View, payload.0)
    }

    /// Parses a view from a payload. Trailing data from a later version is ignored.
    ///
    /// # Errors
    /// [`WireError`], if the view is invalid.
    pub fn parse(payload: &[u8]) -> Result<Self, WireError> {
        let mut fields = Fields::new(payload, WHAT);
        let bytes = fields.u32()? as usize;
        if !(LAYOUT_BYTES..=payload.len()).contains(&bytes) {
            let reason = format!("it claims {bytes} bytes, expected {LAYOUT_BYTES} to {}", payload.len());
            return Err(WireError::malformed(WHAT, reason));
        }
        let view = Self {
            eye: DVec3::from_array(fields.f64s()?),
            rotation: Mat3::from_cols_array(&fields.f32s()?),
            near: fields.f32s::<1>()?[0],
            size_px: [fields.u32()?, fields.u32()?],
            px_per_slope: fields.f32s()?,
            center_px: fields.f32s()?,
        };
        match view.fault() {
            None => Ok(view),
            Some(reason) => Err(WireError::malformed(WHAT, reason)),
        }
    }

    /// Returns a description of the fault, if the view is invalid.
    fn fault(&self) -> Option<String> {
        let [width, height] = self.size_px;
        let is_size = |edge: u32| (1..=MAX_EDGE_PX).contains(&edge);
        if !is_size(width) || !is_size(height) || u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Some(format!(
                "a picture of {width} × {height} pixels, and {MAX_EDGE_PX} on a side and {MAX_PIXELS} are read"
            ));
        }
        let skew = self.rotation * self.rotation.transpose() - Mat3::IDENTITY;
        let is_rotation = skew.to_cols_array().iter().all(|entry| entry.abs() < MAX_SKEW);
        let numbers = self.px_per_slope.iter().chain(&self.center_px);
        let is_finite = self.eye.is_finite() && numbers.clone().all(|number| number.is_finite());
        let is_seen = self.px_per_slope.iter().all(|number| *number != 0.0);
        let is_near = self.near >= 0.0 && self.near < f32::INFINITY;
        (!is_rotation || !is_finite || !is_seen || !is_near).then(|| format!("no camera sees so: {self:?}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn view() -> View {
        View {
            eye: DVec3::new(4e6, -2.5, 0.1),
            rotation: Mat3::from_rotation_y(0.7) * Mat3::from_rotation_x(-0.3),
            near: 0.01,
            size_px: [1600, 900],
            px_per_slope: [900.0, -900.0],
            center_px: [800.5, 450.0],
        }
    }

    #[test]
    fn a_view_round_trips_and_trailing_bytes_are_ignored() {
        let message = view().message();
        assert_eq!((message.kind, message.payload.len()), (Kind::View, LAYOUT_BYTES));
        assert_eq!(View::parse(&message.payload).unwrap(), view());
        let mut longer = message.payload.clone();
        longer[0] += 8;
        assert!(View::parse(&longer).is_err(), "claims more than there is");
        longer.extend([7; 8]);
        assert_eq!(View::parse(&longer).unwrap(), view());
        for end in 0..LAYOUT_BYTES {
            assert!(View::parse(&message.payload[..end]).is_err(), "{end} bytes");
        }
    }

    #[test]
    fn impossible_views_are_rejected() {
        type Change = fn(&mut View);
        let changes: [(Change, &str); 8] = [
            (|view| view.size_px = [0, 10], "0 × 10 pixels"),
            (|view| view.size_px = [u32::MAX, 1], "4294967295 × 1 pixels"),
            (|view| view.size_px = [1 << 14, 1 << 14], "16384 × 16384 pixels"),
            (|view| view.rotation *= 2.0, "no camera"),
            (|view| view.rotation.x_axis.x = f32::NAN, "no camera"),
            (|view| view.eye.z = f64::INFINITY, "no camera"),
            (|view| view.px_per_slope[1] = 0.0, "no camera"),
            (|view| view.near = -1.0, "no camera"),
        ];
        for (change, expected) in changes {
            let mut wrong = view();
            change(&mut wrong);
            let error = View::parse(&wrong.message().payload).unwrap_err().to_string();
            assert!(error.starts_with("a view: ") && error.contains(expected), "{error}");
        }
    }

    proptest! {
        #[test]
        fn any_bytes_give_a_view_or_an_error(
            mut bytes in prop::collection::vec(any::<u8>(), 0..200), length in 90u32..110,
        ) {
            if let Some(head) = bytes.first_chunk_mut() {
                *head = length.to_le_bytes();
            }
            if let Ok(view) = View::parse(&bytes) {
                prop_assert_eq!(View::parse(&view.message().payload).unwrap(), view);
            }
        }
    }
}
