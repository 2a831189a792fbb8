//! Records of selected nodes gathered, for renderers that do not hold those of all nodes, and of visible points, for
//! renderers that do not make them.

use crate::scene::{Content, ScenePacket};

/// The last content that was gathered, so that images of the same nodes are drawn from the same records.
#[derive(Debug, Default)]
pub(super) struct Gathered {
    /// Cached input content, and the gathered result.
    last: Option<(Content, Content)>,
}

impl Gathered {
    /// Content whose records are all there.
    pub(super) fn content(&mut self, content: &Content) -> Content {
        if let Some((of, gathered)) = &self.last
            && of == content
        {
            return gathered.clone();
        }
        let Some(surfels) = content.gathered() else {
            self.last = None;
            return content.clone();
        };
        let gathered = Content::Surfels(surfels);
        self.last = Some((content.clone(), gathered.clone()));
        gathered
    }

    /// Returns the same packet with all of its records gathered.
    pub(super) fn packet(&mut self, packet: &ScenePacket) -> ScenePacket {
        ScenePacket {
            content: self.content(&packet.content),
            ..packet.clone()
        }
    }
}
