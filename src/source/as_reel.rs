//! The frames of another source as a sequence file with some options would return them: losses can be seen before a
//! file is written.

use super::{About, Capabilities, DecodeFailure, DecodedFrame, Decoder, DepthImages, FrameEntry, Source};
use crate::progress::Progress;
use crate::reel::{NewFrame, ReelDecoder, ReelFile, ReelOptions, write_to_memory};
use crate::rgbd::{Filters, Sensor};
use crate::wire::RawImages;
use std::ops::Range;
use std::sync::Arc;

/// Frames of another source, each encoded and decoded by itself on every request.
pub struct AsReel {
    source: Arc<dyn Source>,
    options: ReelOptions,
}

impl AsReel {
    /// The frames of `source`, stored with these options.
    pub fn new(source: Arc<dyn Source>, options: ReelOptions) -> Self {
        Self { source, options }
    }
}

impl std::fmt::Debug for AsReel {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("AsReel")
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

impl Source for AsReel {
    fn frames(&self) -> Range<usize> {
        self.source.frames()
    }

    fn entry(&self, index: usize) -> Arc<FrameEntry> {
        self.source.entry(index)
    }

    fn decoder(&self) -> Box<dyn Decoder> {
        Box::new(ThroughReel {
            decoder: self.source.decoder(),
            options: self.options.clone(),
        })
    }

    fn about(&self) -> About<'_> {
        let About {
            inputs: _,
            fps,
            reel: _,
            recordings: _,
            assumptions,
            notes,
            damage,
        } = self.source.about();
        About {
            // These frames were not opened by the user: a session that names the inputs would open the original
            // instead.
            inputs: &[],
            fps,
            // The open file is not the one that would be written.
            reel: None,
            // To choose another topic, the inputs have to be opened again.
            recordings: &[],
            assumptions,
            notes,
            damage,
        }
    }

    fn capabilities(&self) -> Capabilities<'_> {
        // Each field by name, without `..`: a new capability cannot be lost unnoticed.
        let Capabilities {
            groups,
            meshes: _,
            samples: _,
            growth,
            live,
            depth_images,
            posed_images,
            image_files,
        } = self.source.capabilities();
        Capabilities {
            groups,
            // A sequence file holds points, but no faces.
            meshes: None,
            // A sample read from a frame alone has not been encoded, and the levels of a file are made from the whole
            // frame.
            samples: None,
            growth,
            live,
            depth_images: depth_images.map(|_| self as &dyn DepthImages),
            posed_images,
            image_files,
        }
    }
}

/// Frames that are no longer images: a file holds their points, and the cameras that took them are still available
/// here.
impl DepthImages for AsReel {
    fn sensor(&self, index: usize) -> Option<Sensor> {
        self.source.sensor(index)
    }

    /// Returns `None`: the raw images recorded before filtering are not stored in the file.
    fn raw_images(&self, _index: usize) -> Option<Result<RawImages, DecodeFailure>> {
        None
    }

    fn filters(&self) -> Option<Filters> {
        self.source.filters()
    }

    fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>> {
        let filtered = self.source.filtered(filters)?;
        Some(Arc::new(Self::new(filtered, self.options.clone())))
    }
}

/// Decodes, encodes, and decodes that.
struct ThroughReel {
    decoder: Box<dyn Decoder>,
    options: ReelOptions,
}

impl Decoder for ThroughReel {
    fn decode(
        &mut self,
        index: usize,
        entry: &FrameEntry,
        _max_points: usize,
        progress: &Progress,
    ) -> Result<DecodedFrame, DecodeFailure> {
        let original = self.decoder.decode(index, entry, usize::MAX, progress)?.cloud;
        let frame = NewFrame {
            cloud: &original,
            name: &entry.name,
            time: entry.time,
        };
        let file = ReelFile::of_bytes(write_to_memory(&[frame], &self.options)?)?;
        let decoded = ReelDecoder::new(Arc::new(file), u64::MAX).decode(0, usize::MAX, progress)?;
        Ok(decoded.cloud.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assumption::{Assumption, Evidence, Subject};
    use crate::cloud::{Positions, RawCloud};
    use crate::photos::ViewSet;
    use crate::reel::Precision;
    use crate::rgbd::{Camera, Distortion, Rig};
    use crate::source::{
        FrameList, Groups, Growth, HasPosedImages, ImageFiles, Live, LiveState, LiveStatus, Meshes, SequenceError,
        StreamRecording,
    };
    use crate::wire::View;
    use glam::DVec2;
    use std::path::{Path, PathBuf};

    #[test]
    fn frames_match_those_of_a_written_file() {
        let retained = |precision| {
            let options = ReelOptions {
                precision,
                ..ReelOptions::default()
            };
            let list: Arc<dyn Source> = Arc::new(FrameList::new(vec![FrameEntry::file("a.ply")], |_, _| {
                let places = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.01, 0.0, 0.0]];
                Ok(RawCloud::from_positions(Positions::F32(places.to_vec())))
            }));
            let source = AsReel::new(list, options);
            let entry = source.entry(0);
            let decoded = source.decoder().decode(0, &entry, usize::MAX, &Progress::default());
            decoded.unwrap().cloud
        };
        assert_eq!(
            retained(Precision::Bits(2)).positions.len(),
            2,
            "two points share a cell"
        );
        let lossless = retained(Precision::Lossless).positions;
        assert_eq!(lossless.len(), 3);
        assert!(matches!(lossless, Positions::F32(_)));
    }

    /// A source that can do all that a source can.
    struct Able {
        list: FrameList,
        inputs: [PathBuf; 1],
        assumptions: Vec<Assumption>,
        notes: Vec<String>,
        filters: Filters,
    }

    impl Source for Able {
        fn frames(&self) -> Range<usize> {
            self.list.frames()
        }

        fn entry(&self, index: usize) -> Arc<FrameEntry> {
            self.list.entry(index)
        }

        fn decoder(&self) -> Box<dyn Decoder> {
            self.list.decoder()
        }

        fn about(&self) -> About<'_> {
            About {
                inputs: &self.inputs,
                fps: Some(12.5),
                reel: None,
                recordings: &[],
                assumptions: &self.assumptions,
                notes: &self.notes,
                damage: &self.notes[1..],
            }
        }

        fn capabilities(&self) -> Capabilities<'_> {
            Capabilities {
                groups: Some(self),
                meshes: Some(self),
                samples: Some(&self.list),
                growth: Some(self),
                live: Some(self),
                depth_images: Some(self),
                posed_images: Some(self),
                image_files: Some(self),
            }
        }
    }

    impl Groups for Able {
        fn group(&self, _index: usize) -> Range<usize> {
            0..2
        }
    }

    impl Meshes for Able {
        fn mesh_decoder(&self) -> Box<dyn Decoder> {
            self.list.decoder()
        }
    }

    impl Growth for Able {
        fn may_grow(&self) -> bool {
            true
        }

        fn is_live(&self) -> bool {
            true
        }

        fn look_again(&self) -> Result<usize, SequenceError> {
            Ok(7)
        }

        fn changed_since(&self, since: usize) -> Vec<usize> {
            vec![since]
        }
    }

    impl Live for Able {
        fn status(&self) -> LiveStatus {
            LiveStatus {
                state: LiveState::Connected,
                received_frames: 3,
                lost_frames: 0,
                bytes_per_s: 0.0,
                frames_per_s: 0.0,
                delay_s: None,
                buffered_s: 0.0,
                buffered_bytes: 0,
                reconnects: 0,
                recording: None,
            }
        }

        fn frames_behind(&self, _shown: usize) -> Option<u64> {
            None
        }

        fn look_from(&self, _view: View) {}

        fn start_recording(&self, _path: &Path) -> Result<(), String> {
            Ok(())
        }

        fn stop_recording(&self) -> Result<Option<StreamRecording>, String> {
            Ok(None)
        }
    }

    impl DepthImages for Able {
        fn sensor(&self, _index: usize) -> Option<Sensor> {
            let depth = Camera::new([4, 4], DVec2::splat(4.0), DVec2::splat(1.5), Distortion::None).unwrap();
            Some(Sensor {
                rig: Arc::new(Rig { depth, color: None }),
                world_from_camera: None,
            })
        }

        fn raw_images(&self, _index: usize) -> Option<Result<RawImages, DecodeFailure>> {
            Some(Err("not asked for".into()))
        }

        fn filters(&self) -> Option<Filters> {
            Some(self.filters)
        }

        fn filtered(&self, filters: Filters) -> Option<Arc<dyn Source>> {
            Some(Arc::new(able(filters)))
        }
    }

    impl HasPosedImages for Able {
        fn posed_images(&self, _index: usize) -> Option<Arc<ViewSet>> {
            Some(Arc::default())
        }
    }

    impl ImageFiles for Able {
        fn image_files(&self) -> Vec<PathBuf> {
            vec!["color.png".into()]
        }
    }

    fn able(filters: Filters) -> Able {
        Able {
            list: FrameList::new(vec![FrameEntry::file("a.ply"), FrameEntry::file("b.ply")], |_, _| {
                Ok(RawCloud::from_positions(Positions::F32(vec![[0.0; 3]])))
            }),
            inputs: ["scan".into()],
            assumptions: vec![Assumption::new(Subject::Frames, "2", "a test", Evidence::File)],
            notes: vec!["a note".to_owned(), "it is cut".to_owned()],
            filters,
        }
    }

    #[test]
    fn capabilities_that_survive_a_file_are_retained() {
        let inner = able(Filters::NONE);
        let whole = format!("{:?}", inner.capabilities());
        let reel: &dyn Source = &AsReel::new(Arc::new(inner), ReelOptions::default());
        assert!(!whole.contains("false"), "{whole}");
        let lost = whole.replace("meshes: true", "meshes: false");
        let lost = lost.replace("samples: true", "samples: false");
        assert_eq!(format!("{:?}", reel.capabilities()), lost);
        assert_eq!((reel.group(1), reel.fps()), (0..2, Some(12.5)));
        assert!(reel.may_grow() && reel.is_live());
        assert_eq!((reel.look_again().unwrap(), reel.changed_since(5)), (7, vec![5]));
        assert_eq!(reel.live().map(|live| live.status().received_frames), Some(3));
        assert!(reel.sensor(0).is_some() && reel.posed_images(0).is_some() && reel.raw_images(0).is_none());
        assert_eq!(reel.images(), [PathBuf::from("color.png")]);
        assert_eq!(
            (reel.notes(), reel.damage()),
            (
                &["a note".to_owned(), "it is cut".to_owned()][..],
                &["it is cut".to_owned()][..]
            )
        );
        assert_eq!((reel.assumptions().len(), reel.inputs().len()), (1, 0));
        let other: Filters = "temporal".parse().unwrap();
        let filtered = reel.filtered(other).unwrap();
        assert_eq!((reel.filters(), filtered.filters()), (Some(Filters::NONE), Some(other)));
        assert_eq!(
            format!("{:?}", filtered.capabilities()),
            lost,
            "it goes through the file as well"
        );
    }
}
