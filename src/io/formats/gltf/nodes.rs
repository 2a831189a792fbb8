//! Node transforms of the scene, each within its parent.

use super::animation::{NodePose, unit};
use super::document::{Document, Node, at};
use crate::io::error::Fault;
use glam::{DAffine3, DMat4, DQuat, DVec3};

/// The transform of every node into the scene, and the nodes that the scene shows in the order of the file's tree.
pub(super) struct PlacedNodes {
    pub(super) transforms: Vec<DAffine3>,
    pub(super) shown: Vec<usize>,
}

/// Places the nodes, moved by `changes` (one a node).
pub(super) fn place(document: &Document, changes: &[NodePose]) -> Result<PlacedNodes, Fault> {
    let mut transforms = vec![DAffine3::IDENTITY; document.nodes.len()];
    let mut is_placed = vec![false; document.nodes.len()];
    let mut shown = Vec::new();
    let roots = scene_roots(document)?;
    // Bones need not be in the scene: nodes under other roots are placed as well, but not shown.
    let others = free_nodes(document).filter(|node| !roots.contains(node));
    for (root, is_shown) in roots
        .iter()
        .map(|&root| (root, true))
        .chain(others.map(|node| (node, false)))
    {
        let mut waiting = vec![(root, DAffine3::IDENTITY)];
        while let Some((index, parent)) = waiting.pop() {
            let node = at(&document.nodes, index, "node")?;
            if std::mem::replace(&mut is_placed[index], true) {
                return Err(Fault::entry(
                    "node",
                    index,
                    "it hangs on two nodes, or on itself: the nodes of a scene are a tree, so the file is damaged",
                ));
            }
            transforms[index] = parent * local(node, &changes[index]);
            if is_shown {
                shown.push(index);
            }
            let children = node.children.iter().rev();
            waiting.extend(children.map(|&child| (child, transforms[index])));
        }
    }
    Ok(PlacedNodes { transforms, shown })
}

fn scene_roots(document: &Document) -> Result<Vec<usize>, Fault> {
    let scene = document.scene.or((!document.scenes.is_empty()).then_some(0));
    match scene {
        Some(index) => {
            let mut roots = at(&document.scenes, index, "scene")?.nodes.clone();
            roots.dedup();
            Ok(roots)
        }
        None => Ok(free_nodes(document).collect()),
    }
}

/// Nodes that hang on no other.
fn free_nodes(document: &Document) -> impl Iterator<Item = usize> {
    let mut is_free = vec![true; document.nodes.len()];
    for child in document.nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_free) = is_free.get_mut(*child) {
            *is_free = false;
        }
    }
    (0..is_free.len()).filter(move |&node| is_free[node])
}

fn local(node: &Node, change: &NodePose) -> DAffine3 {
    let (mut scale, mut rotation, mut translation) = match node.matrix {
        Some(matrix) => {
            let matrix = DAffine3::from_mat4(DMat4::from_cols_array(&matrix));
            if change.translation.is_none() && change.rotation.is_none() && change.scale.is_none() {
                return matrix;
            }
            matrix.to_scale_rotation_translation()
        }
        None => (
            DVec3::from_array(node.scale.unwrap_or([1.0; 3])),
            unit(DQuat::from_array(node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]))),
            DVec3::from_array(node.translation.unwrap_or_default()),
        ),
    };
    scale = change.scale.unwrap_or(scale);
    rotation = change.rotation.unwrap_or(rotation);
    translation = change.translation.unwrap_or(translation);
    DAffine3::from_scale_rotation_translation(scale, rotation, translation)
}
