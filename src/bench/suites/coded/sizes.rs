//! Bits of each stream per leaf.
//!
//! How it works: every attribute is a stream of its own, one or two whole bytes per value, as the paper keeps them in
//! memory, and is packed by gzip as its files are. Breadth-first codes have attributes of all nodes, so that any prefix
//! is a cloud; depth-first codes those of leaves alone.

use super::columns::{SIZES, row};
use super::subjected::Subjected;
use crate::bench::report::{Cell, Row};
use crate::cloud::coarser_normal;
use crate::levels::octree::coded::{CodedCloud, DepthFirstCode, NodeAttributes};
use crate::levels::octree::{Octree, StopCriterion};
use crate::math::morton::LEVELS;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write as _;
use std::sync::Arc;

/// A stream of attributes: its name, bits per value, the paper's bits per point (§6) and the bytes of a value.
type Stream = (&'static str, f64, &'static str, fn(NodeAttributes) -> Vec<u8>);

const STREAMS: [Stream; 8] = [
    ("offsets, 2 bits", 2.0, "1 to 1.5", |node| {
        vec![node.offset_code() as u8 >> 1]
    }),
    ("offsets, 3 bits", 3.0, "", |node| vec![node.offset_code() as u8]),
    ("normals, 13 bits", 13.0, "5 to 8", |node| normal_bytes(node, 13)),
    ("normals, 15 bits", 15.0, "", |node| normal_bytes(node, 15)),
    ("normals, 17 bits", 17.0, "", |node| normal_bytes(node, 17)),
    ("colours, 24 bits", 24.0, "2 to 6 (8 bits)", |node| node.color.to_vec()),
    ("radii", 8.0, "", |node| vec![node.radius_code()]),
    ("normal cones", 8.0, "", |node| vec![node.cone_code()]),
];

fn normal_bytes(node: NodeAttributes, bits: u32) -> Vec<u8> {
    let index = coarser_normal(node.normal(), bits).to_le_bytes();
    index[..if bits > 16 { 3 } else { 2 }].to_vec()
}

pub(super) fn rows(of: &Subjected<'_>) -> Vec<Row> {
    let (Some(shapes), name) = (&of.frame.shapes, &of.name) else {
        return Vec::new();
    };
    let spacing = usual_leaf_level(&of.octree.with_stop(StopCriterion::Spacing));
    let trees = [
        ("δ 5 %", StopCriterion::PAPER),
        ("by spacing", StopCriterion::Depth(spacing)),
    ];
    let rows_of = |(tree, stop)| {
        let octree = Arc::new(of.octree.with_stop(stop));
        let cloud = CodedCloud::new(&octree, &of.frame.points, shapes);
        let depth_first = DepthFirstCode::of(&octree);
        of_tree(name, tree, &cloud, &depth_first)
    };
    trees.into_iter().flat_map(rows_of).collect()
}

/// The level of the majority of leaves.
fn usual_leaf_level(tree: &Octree) -> u32 {
    let mut counts = [0; LEVELS as usize + 1];
    for voxel in tree.level_voxels(tree.depth()) {
        counts[usize::from(voxel.level)] += 1;
    }
    let levels = (0..).zip(counts);
    levels.max_by_key(|&(_, count)| count).map_or(0, |(level, _)| level)
}

fn of_tree(sequence: &str, tree: &str, cloud: &CodedCloud, depth_first: &DepthFirstCode) -> Vec<Row> {
    let leaves = cloud.level(cloud.depth());
    let per_leaf = |bits: f64| Cell::Number(bits / leaves.len().max(1) as f64);
    let packed_bits = |bytes: &[u8]| 8.0 * gzip_bytes(bytes) as f64;
    let row_of = |stream: &str, cells: Vec<(&str, Cell)>| {
        let mut all = vec![
            ("sequence", Cell::Text(sequence.to_owned())),
            ("tree", Cell::Text(tree.to_owned())),
            ("stream", Cell::Text(stream.to_owned())),
            ("leaves", Cell::Number(leaves.len() as f64)),
        ];
        all.extend(cells);
        row(SIZES, &all)
    };
    let of_masks = |masks: &[u8]| {
        vec![
            ("bits_per_leaf", per_leaf(8.0 * masks.len() as f64)),
            ("gzip_bits_per_leaf", per_leaf(packed_bits(masks))),
            ("paper_bits", Cell::Text("1 to 1.5".to_owned())),
        ]
    };
    let of_attributes = |(stream, bits, paper, bytes_of): Stream| {
        let bytes = |nodes: &[NodeAttributes]| nodes.iter().flat_map(|&node| bytes_of(node)).collect::<Vec<u8>>();
        let all = cloud.attributes();
        row_of(
            stream,
            vec![
                ("bits_per_leaf", per_leaf(bits * all.len() as f64)),
                ("gzip_bits_per_leaf", per_leaf(packed_bits(&bytes(all)))),
                (
                    "gzip_leaf_bits_per_leaf",
                    per_leaf(packed_bits(&bytes(&all[leaves.clone()]))),
                ),
                ("paper_bits", Cell::Text(paper.to_owned())),
            ],
        )
    };
    let masks = [
        ("masks, breadth-first", cloud.masks()),
        ("masks, depth-first", depth_first.masks()),
    ];
    let masks = masks.map(|(stream, masks)| row_of(stream, of_masks(masks)));
    let in_memory = vec![("bits_per_leaf", per_leaf(8.0 * cloud.byte_size() as f64))];
    masks
        .into_iter()
        .chain(STREAMS.map(of_attributes))
        .chain([row_of("all, in memory", in_memory)])
        .collect()
}

/// Bytes of a stream that gzip has packed.
fn gzip_bytes(bytes: &[u8]) -> usize {
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    // Memory takes all that is written.
    let packed = packer.write_all(bytes).and_then(|()| packer.finish());
    packed.map_or(bytes.len(), |packed| packed.len())
}
