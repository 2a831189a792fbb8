//! Contents are equal if all of their parts are.

use super::*;
use crate::analysis::screen::ScreenCloud;
use crate::levels::octree::{Octree, StopCriterion};
use crate::scene::{Camera, UpAxis, screen_view};
use glam::{DVec3, Vec3};

/// A content of another variant, with memory of its own, until all were there. The compiler asks for a new variant, as
/// it does for new parts.
fn next(content: &Content) -> Option<Content> {
    Some(match content {
        Content::Nothing => Content::Points(Arc::default()),
        Content::Points(_) => Content::Surfels(Surfels {
            points: Arc::default(),
            shapes: Arc::default(),
        }),
        Content::Surfels(_) => Content::Selected(Selected {
            nodes: nodes(),
            selection: Arc::new(Selection::At(Vec::new())),
        }),
        Content::Selected(_) => Content::Visible(visible()),
        Content::Visible(_) => Content::Voxels(Voxels {
            records: Arc::default(),
            normals: Some(Arc::default()),
            cube_edge: 1.0,
        }),
        Content::Voxels(_) => Content::Mesh(mesh()),
        Content::Mesh(_) => Content::Coded(CodedCells {
            cloud: coded(),
            lod_px: 1.0,
            deepest_level: 3,
        }),
        Content::Coded(_) => return None,
    })
}

/// Returns variants of the content, each with another of its parts changed.
fn changed(content: &Content) -> Vec<Content> {
    match content.clone() {
        Content::Nothing => Vec::new(),
        Content::Points(_) => vec![Content::Points(Arc::default())],
        Content::Surfels(Surfels { points, shapes }) => {
            let of = |points, shapes| Content::Surfels(Surfels { points, shapes });
            vec![of(Arc::default(), shapes), of(points, Arc::default())]
        }
        Content::Selected(Selected {
            nodes: NodeRecords { points, shapes },
            selection,
        }) => {
            let of = |points: &Arc<_>, shapes: &Arc<_>, selection: &Arc<_>| {
                let (points, shapes) = (Arc::clone(points), Arc::clone(shapes));
                Content::Selected(Selected {
                    nodes: NodeRecords { points, shapes },
                    selection: Arc::clone(selection),
                })
            };
            vec![
                of(&Arc::default(), &shapes, &selection),
                of(&points, &Arc::default(), &selection),
                of(&points, &shapes, &Arc::new(Selection::At(Vec::new()))),
            ]
        }
        Content::Visible(_) => vec![Content::Visible(visible())],
        Content::Voxels(Voxels {
            records,
            normals,
            cube_edge,
        }) => {
            let of = |records: &Arc<_>, normals: Option<&Arc<_>>, cube_edge| {
                Content::Voxels(Voxels {
                    records: Arc::clone(records),
                    normals: normals.cloned(),
                    cube_edge,
                })
            };
            vec![
                of(&Arc::default(), normals.as_ref(), cube_edge),
                of(&records, Some(&Arc::default()), cube_edge),
                of(&records, None, cube_edge),
                of(&records, normals.as_ref(), 2.0 * cube_edge),
            ]
        }
        Content::Mesh(_) => vec![Content::Mesh(mesh())],
        Content::Coded(CodedCells {
            cloud,
            lod_px,
            deepest_level,
        }) => {
            let of = |cloud: &Arc<_>, lod_px, deepest_level| {
                Content::Coded(CodedCells {
                    cloud: Arc::clone(cloud),
                    lod_px,
                    deepest_level,
                })
            };
            vec![
                of(&coded(), lod_px, deepest_level),
                of(&cloud, 2.0 * lod_px, deepest_level),
                of(&cloud, lod_px, deepest_level + 1),
            ]
        }
    }
}

fn nodes() -> NodeRecords {
    NodeRecords {
        points: Arc::default(),
        shapes: Arc::default(),
    }
}

fn visible() -> Arc<VisiblePoints> {
    let camera = Camera::framing(
        &crate::math::Aabb::from_points(&[Vec3::ZERO, Vec3::ONE]),
        DVec3::ZERO,
        UpAxis::Y,
    );
    let size_px = [4, 3];
    let cloud = ScreenCloud {
        spacing: 1.0,
        closing: 1.0,
        sensor: None,
    };
    let view = screen_view(&camera.transform(DVec3::ZERO, size_px), size_px);
    Arc::new(VisiblePoints::new(Arc::default(), None, view, cloud, Arc::default()))
}

fn mesh() -> Arc<MeshRecords> {
    Arc::new(MeshRecords::new(Arc::default(), Arc::default()))
}

fn coded() -> Arc<CodedCloud> {
    let octree = Octree::build(&[], &[], StopCriterion::PAPER);
    Arc::new(CodedCloud::new(&Arc::new(octree), &Arc::default(), &Arc::default()))
}

#[test]
fn contents_are_equal_if_all_of_their_parts_are() {
    let all = || std::iter::successors(Some(Content::Nothing), next);
    for (place, content) in all().enumerate() {
        assert_eq!(content, content.clone());
        for (other_place, other) in all().enumerate() {
            let are_nothing = place == 0 && other_place == 0;
            assert_eq!(content == other, are_nothing, "{content:?} {other:?}");
        }
        for (part, other) in changed(&content).iter().enumerate() {
            assert_ne!(content, *other, "part {part}");
            assert_ne!(*other, content, "part {part}");
        }
    }
    assert_eq!(all().count(), 8);
}
