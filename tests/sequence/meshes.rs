//! Triangles of frames: read on request, and not before.

use super::*;
use pointreel::analysis::SurfaceOptions;
use pointreel::scene::{Camera, Content, FirstLook, Primitive, Scene, Settings, UpAxis};

const SQUARE: &str = "OFF\n5 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n5 5 5\n3 0 1 2\n3 2 1 3\n";

const MESH: Needs = Needs {
    shapes: false,
    ellipses: false,
    mesh: true,
    levels: None,
    colors: Coloring::of(ColorSource::Auto),
    surface: SurfaceOptions::AUTO,
    smoothing: 0.0,
    hints: ColorHints::NONE,
};

const POINTS: Needs = Needs { mesh: false, ..MESH };

/// A sequence of one file, rendered as sampled points.
fn sequence_of(name: &str, text: &str) -> (Arc<Sequence>, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), text).unwrap();
    let read = ReadOptions::default().with_mesh_sample_count(NonZeroUsize::new(100));
    let options = OpenOptions {
        read,
        ..OpenOptions::default()
    };
    let sequence = Sequence::open(&[folder.path().join(name)], &options).unwrap();
    (Arc::new(sequence), folder)
}

#[test]
fn triangles_are_read_once_and_only_when_drawn() {
    let (sequence, _folder) = sequence_of("a.off", SQUARE);
    let loader = loader(&sequence, 1, usize::MAX);
    let points = loader.wait(0, &POINTS).unwrap();
    assert_eq!((points.points.len(), loader.stats().decoded), (100, 1));
    assert!(points.mesh.is_none() && points.frame.has_faces() && !points.satisfies(&MESH));
    let with_mesh = loader.wait(0, &MESH).unwrap();
    assert_eq!(loader.stats().decoded, 2);
    assert!(Arc::ptr_eq(&with_mesh.points, &points.points));
    let records = with_mesh.triangles().unwrap();
    assert_eq!((records.vertices.len(), records.triangles.len()), (5, 3));
    assert!(records.has_points());
    assert!(with_mesh.byte_size() > points.byte_size());
    // Existing data stays for later requests.
    let again = loader.wait(0, &POINTS).unwrap();
    assert!(again.satisfies(&MESH));
    let uniform = Needs {
        colors: Coloring::of(ColorSource::Uniform),
        ..MESH
    };
    let repainted = loader.wait(0, &uniform).unwrap();
    assert_eq!(loader.stats().decoded, 2);
    let of_mesh = repainted.triangles().unwrap().vertices[0].color;
    assert_eq!(of_mesh, repainted.points[0].color);
    assert_ne!(of_mesh, records.vertices[0].color);
}

#[test]
fn vertices_coincide_with_points_however_far_from_zero() {
    let far = "OFF\n4 2 0\n4510720 0 0\n4510721 0 0\n4510720 1 0\n4510721 1 0\n3 0 1 2\n3 2 1 3\n";
    let (sequence, _folder) = sequence_of("a.off", far);
    assert_ne!(sequence.origin(), DVec3::ZERO);
    let frame = loader(&sequence, 1, usize::MAX).wait(0, &MESH).unwrap();
    let vertices = frame.mesh.as_ref().unwrap().mesh().vertices();
    let in_file: Vec<DVec3> = vertices
        .positions()
        .iter()
        .map(|place| sequence.origin() + place.as_dvec3())
        .collect();
    for expected in [DVec3::new(4_510_720.0, 0.0, 0.0), DVec3::new(4_510_721.0, 1.0, 0.0)] {
        assert!(in_file.contains(&expected), "{expected} in {in_file:?}");
    }
}

#[test]
fn a_cloud_without_faces_falls_back_to_auto_with_a_notice() {
    let (sequence, _folder) = sequence_of("a.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0.1\n");
    let loader = loader(&sequence, 1, usize::MAX);
    let frame = loader.wait(0, &MESH).unwrap();
    assert_eq!(loader.stats().decoded, 1);
    assert!(frame.mesh.is_none() && frame.satisfies(&MESH));
    let look = FirstLook::of(&[&frame.frame], sequence.origin());
    let style = Settings {
        primitive: Primitive::Mesh.into(),
        ..Settings::default()
    };
    let auto = Settings::default().resolved(&look);
    assert_eq!(style.resolved(&look).primitive, auto.primitive);
    assert!(look.lack_of(Primitive::Mesh).unwrap().contains("no triangles"));
    assert_eq!(look.lack_of(Primitive::Surfel), None);
    // A single frame without faces among others shows its points.
    let camera = Camera::framing(&frame.frame.bounds(), sequence.origin(), UpAxis::Y);
    let packet = Scene::default().packet(&frame, sequence.origin(), &camera, &style.decided(), [64, 64]);
    assert!(matches!(packet.content, Content::Points(_)));

    let (sequence, _folder) = sequence_of("a.off", SQUARE);
    let look = FirstLook::of(&[&sequence.frame(0).unwrap()], sequence.origin());
    assert_eq!(style.resolved(&look).primitive, Primitive::Mesh);
    assert_eq!(look.lack_of(Primitive::Mesh), None);
    assert_eq!(Settings::default().resolved(&look).primitive, Primitive::Mesh);
}

#[test]
fn animation_frames_have_separate_triangles_and_points() {
    let Some(path) = super::data::shared("models/CesiumMan.glb") else {
        return;
    };
    let read = ReadOptions::default().with_mesh_sample_count(NonZeroUsize::new(500));
    let sequence = Sequence::open(
        &[path],
        &OpenOptions {
            read,
            ..OpenOptions::default()
        },
    )
    .unwrap();
    let loader = loader(&Arc::new(sequence), 2, usize::MAX);
    let mut before = None;
    for index in [0, 7, 1] {
        let frame = loader.wait(index, &MESH).unwrap();
        assert_eq!(frame.points.len(), 500);
        let mesh = frame.mesh.as_ref().unwrap().mesh();
        assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (3273, 4672));
        // Its texture is not part of the vertex colours.
        assert_eq!(mesh.texturing().unwrap().textures.places().len(), 1);
        let bounds = mesh.vertices().bounds();
        assert!(frame.frame.bounds().extent().length() <= bounds.extent().length() + 1e-4);
        assert_ne!(before.replace(bounds), Some(bounds), "it moves");
    }
}
