//! Records of selected nodes brought together, where who draws does not keep those of all nodes.

use crate::scene::{Content, ScenePacket};

/// The last content that was gathered, so that pictures of the same nodes are drawn from the same records.
#[derive(Debug, Default)]
pub(super) struct Gathered {
    /// What it was, and what became of it.
    last: Option<(Content, Content)>,
}

impl Gathered {
    /// Content without selected nodes.
    pub(super) fn content(&mut self, content: &Content) -> Content {
        let Content::Selected(selected) = content else {
            self.last = None;
            return content.clone();
        };
        let known = self.last.take().filter(|(of, _)| of == content);
        let (_, gathered) = self
            .last
            .insert(known.unwrap_or_else(|| (content.clone(), Content::Surfels(selected.gathered()))));
        gathered.clone()
    }

    /// The same packet without selected nodes.
    pub(super) fn packet(&mut self, packet: &ScenePacket) -> ScenePacket {
        ScenePacket {
            content: self.content(&packet.content),
            ..packet.clone()
        }
    }
}
