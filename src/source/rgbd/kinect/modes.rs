//! Depth camera modes: the region of the sensor that an image covers.
//!
//! The table comes from the SDK (`transformation/mode_specific_calibration.c`): narrow modes crop the centre of the
//! sensor of 1024 × 1024 pixels, binned ones combine blocks of 2 × 2.

/// A mode of the depth camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DepthMode {
    /// As `K4A_DEPTH_MODE` has it.
    pub(super) name: &'static str,
    /// The size of the whole sensor in pixels of the mode.
    pub(super) sensor_px: [u32; 2],
    /// Offset of the image's first pixel on the sensor, in pixels.
    pub(super) offset_px: [u32; 2],
    pub(super) size_px: [u32; 2],
}

const MODES: [DepthMode; 4] = [
    DepthMode {
        name: "NFOV_2X2BINNED",
        sensor_px: [512, 512],
        offset_px: [96, 90],
        size_px: [320, 288],
    },
    DepthMode {
        name: "NFOV_UNBINNED",
        sensor_px: [1024, 1024],
        offset_px: [192, 180],
        size_px: [640, 576],
    },
    DepthMode {
        name: "WFOV_2X2BINNED",
        sensor_px: [512, 512],
        offset_px: [0, 0],
        size_px: [512, 512],
    },
    DepthMode {
        name: "WFOV_UNBINNED",
        sensor_px: [1024, 1024],
        offset_px: [0, 0],
        size_px: [1024, 1024],
    },
];

/// The mode of images of this size, which has to match the tag, if there is one of a known mode. Sizes differ from mode
/// to mode.
pub(super) fn of_depth(tag: Option<&str>, size_px: [u32; 2]) -> Result<DepthMode, String> {
    let [width, height] = size_px;
    let named = MODES.iter().find(|mode| Some(mode.name) == tag);
    if let Some(DepthMode { name, size_px, .. }) = named.filter(|mode| mode.size_px != [width, height]) {
        let [expected_width, expected_height] = size_px;
        return Err(format!(
            "the depth images have {width} × {height} pixels, and those of the mode {name} {expected_width} × \
             {expected_height}: name the depth camera by --intrinsics fx,fy,cx,cy or a file"
        ));
    }
    MODES
        .iter()
        .find(|mode| mode.size_px == size_px)
        .copied()
        .ok_or_else(|| {
            let sizes = MODES.map(|mode| format!("{} × {}", mode.size_px[0], mode.size_px[1]));
            format!(
                "the depth images have {width} × {height} pixels, and modes of the camera {}: name the depth camera by \
             --intrinsics fx,fy,cx,cy or a file",
                sizes.join(", ")
            )
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_recognised_by_their_sizes() {
        for mode in MODES {
            for tag in [None, Some(mode.name), Some("A_LATER_MODE")] {
                assert_eq!(of_depth(tag, mode.size_px), Ok(mode));
            }
            // The region is within the sensor.
            for axis in 0..2 {
                assert!(mode.offset_px[axis] + mode.size_px[axis] <= mode.sensor_px[axis]);
            }
        }
        let error = of_depth(Some("NFOV_UNBINNED"), [512, 512]).unwrap_err();
        assert!(error.contains("512 × 512") && error.contains("640 × 576"), "{error}");
        assert!(of_depth(None, [640, 480]).unwrap_err().contains("--intrinsics"));
    }
}
