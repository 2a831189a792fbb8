//! The blocks of pcapng: packets, and their metadata.
//!
//! <https://www.ietf.org/archive/id/draft-ietf-opsawg-pcapng-02.html>

use super::layout::{ByteOrder, Interface, Layout, Section, ticks_per_second};
use super::link::Link;
use pcap_parser::pcapng::{Block, parse_block_be, parse_block_le, parse_sectionheaderblock};
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// Kind, length and byte order of a section; kind, length and more of other blocks.
pub(super) const HEAD_BYTES: usize = 12;

/// Magic bytes at the start of each section, in either byte order.
pub(super) const SECTION: [u8; 4] = [0x0a, 0x0d, 0x0d, 0x0a];

/// The byte order of a section, in the big one.
const BIG_ENDIAN: [u8; 4] = [0x1a, 0x2b, 0x3c, 0x4d];

/// Kinds of blocks with packets.
const PACKETS: [u32; 2] = [3, 6];

/// A packet in a block.
pub(super) struct InBlock {
    /// `None` where the block does not say it.
    pub(super) time: Option<Duration>,
    pub(super) link: Link,
    /// Byte range of the packet within the block.
    pub(super) bytes: Range<usize>,
    /// True if the packet was truncated: longer than its captured bytes.
    pub(super) is_cut: bool,
}

/// The byte order of a block that begins with `head`, [`HEAD_BYTES`] long.
pub(super) fn order(head: &[u8], layout: &Layout) -> ByteOrder {
    match layout {
        _ if head.starts_with(&SECTION) => {
            if head.ends_with(&BIG_ENDIAN) {
                ByteOrder::Big
            } else {
                ByteOrder::Little
            }
        }
        Layout::Blocks(section) => section.order,
        Layout::Records(records) => records.order,
    }
}

/// Returns true if the interpretation of later blocks depends on the block that begins with `head`.
pub(super) fn matters(head: &[u8], order: ByteOrder) -> bool {
    head.starts_with(&SECTION) || order.u32(head, 0).is_some_and(|kind| PACKETS.contains(&kind))
}

/// A block whose content contradicts its kind.
pub(super) struct Damaged;

/// The packet in a block, if there is one, of an interface that `layout` knows; metadata goes to `layout`.
pub(super) fn read(layout: &mut Arc<Layout>, bytes: &[u8], order: ByteOrder) -> Result<Option<InBlock>, Damaged> {
    if bytes.starts_with(&SECTION) {
        parse_sectionheaderblock(bytes).map_err(|_| Damaged)?;
        *layout = Arc::new(Layout::Blocks(Section {
            order,
            interfaces: Vec::new(),
        }));
        return Ok(None);
    }
    let parsed = match order {
        ByteOrder::Little => parse_block_le(bytes),
        ByteOrder::Big => parse_block_be(bytes),
    };
    let range = |data: &[u8], captured: u32| {
        let begin = data.as_ptr() as usize - bytes.as_ptr() as usize;
        begin..begin + data.len().min(captured as usize)
    };
    Ok(match parsed.map_err(|_| Damaged)?.1 {
        Block::InterfaceDescription(block) => {
            let interface = Interface {
                link: Link::of(block.linktype.0),
                ticks_per_second: ticks_per_second(block.if_tsresol).ok_or(Damaged)?,
                // The crate reads it as little-endian.
                offset_s: match order {
                    ByteOrder::Little => block.if_tsoffset,
                    ByteOrder::Big => block.if_tsoffset.swap_bytes(),
                },
            };
            if let Layout::Blocks(section) = Arc::make_mut(layout) {
                section.interfaces.push(interface);
            }
            None
        }
        Block::EnhancedPacket(block) => interface(layout, block.if_id).map(|interface| InBlock {
            time: Some(interface.time(u64::from(block.ts_high) << 32 | u64::from(block.ts_low))),
            link: interface.link,
            bytes: range(block.data, block.caplen),
            is_cut: block.caplen < block.origlen,
        }),
        Block::SimplePacket(block) => interface(layout, 0).map(|interface| InBlock {
            time: None,
            link: interface.link,
            bytes: range(block.data, block.origlen),
            is_cut: block.data.len() < block.origlen as usize,
        }),
        _ => None,
    })
}

fn interface(layout: &Layout, index: u32) -> Option<Interface> {
    match layout {
        Layout::Blocks(section) => section.interfaces.get(index as usize).copied(),
        Layout::Records(_) => None,
    }
}
