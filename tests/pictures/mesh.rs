//! Triangles as they are drawn: by both renderers alike, without holes, as brute force in double precision finds them.

use crate::common::{self, camera_at, draw, draw_on_cpu, draw_with, plain, software};
use glam::{DMat3, DVec3, Vec3};
use image::{Rgba, RgbaImage};
use pointreel::cloud::{MeshRecords, Textures, TriangleRecord, VertexRecord, oct_encode};
use pointreel::math::Aabb;
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::render::Renderer;
use pointreel::render::cpu::CpuRenderer;
use pointreel::render::gpu::{ContextOptions, GpuRenderer};
use pointreel::scene::{
    Camera, Content, EyeDome, Lighting, PacketParams, PointShape, Primitive, ScenePacket, Strategy, Style,
};
use std::sync::Arc;

const SIZE: [u32; 2] = [210, 160];

fn vertex(position: Vec3, color: [u8; 3]) -> VertexRecord {
    VertexRecord {
        position: position.to_array(),
        color: [color[0], color[1], color[2], 255],
        texture_place: [0.0; 2],
        normal: VertexRecord::NO_NORMAL,
        texture: VertexRecord::NO_TEXTURE,
    }
}

fn triangle(vertices: &[VertexRecord], corners: [u32; 3]) -> TriangleRecord {
    let [a, b, c] = corners.map(|corner| Vec3::from_array(vertices[corner as usize].position));
    TriangleRecord {
        corners,
        normal: oct_encode((b - a).cross(c - a).normalize_or_zero()),
    }
}

fn point(vertex: u32) -> TriangleRecord {
    TriangleRecord {
        corners: [vertex; 3],
        normal: [0; 2],
    }
}

fn records(vertices: Vec<VertexRecord>, faces: &[[u32; 3]]) -> MeshRecords {
    let triangles = faces.iter().map(|&corners| triangle(&vertices, corners)).collect();
    MeshRecords::new(Arc::new(vertices), Arc::new(triangles))
}

/// A closed sphere of `rings` times twice as many quads, each of two triangles, in many colours; with normals or flat.
fn ball(rings: u32, is_smooth: bool, color: impl Fn(u32) -> [u8; 3]) -> MeshRecords {
    let columns = 2 * rings;
    let mut vertices = Vec::new();
    for ring in 0..=rings {
        for column in 0..columns {
            let (sine, cosine) = (std::f32::consts::PI * ring as f32 / rings as f32).sin_cos();
            let turn = std::f32::consts::TAU * column as f32 / columns as f32;
            let place = Vec3::new(sine * turn.cos(), cosine, sine * turn.sin());
            let mut vertex = vertex(place, color(ring * columns + column));
            if is_smooth {
                vertex.normal = oct_encode(place);
            }
            vertices.push(vertex);
        }
    }
    let mut faces = Vec::new();
    for ring in 0..rings {
        for column in 0..columns {
            let [left, right] = [column, (column + 1) % columns];
            let at = |ring: u32, column: u32| ring * columns + column;
            // At the poles one of the two has zero area.
            faces.push([at(ring, left), at(ring, right), at(ring + 1, left)]);
            faces.push([at(ring + 1, left), at(ring, right), at(ring + 1, right)]);
        }
    }
    records(vertices, &faces)
}

fn many_colors(index: u32) -> [u8; 3] {
    [index * 7, index * 13, index * 29].map(|channel| channel as u8)
}

fn camera(distance: f64) -> Camera {
    Camera {
        azimuth_deg: 25.0,
        elevation_deg: 17.0,
        ..camera_at(distance)
    }
}

fn packet(mesh: MeshRecords, camera: &Camera, style: Style) -> ScenePacket {
    let positions: Vec<Vec3> = mesh
        .vertices
        .iter()
        .map(|vertex| Vec3::from_array(vertex.position))
        .collect();
    ScenePacket {
        viewport_px: SIZE,
        view: camera.transform(DVec3::ZERO, SIZE),
        content: Content::Mesh(Arc::new(mesh)),
        style: Style {
            primitive: Primitive::Mesh,
            ..style
        }
        .painted(),
        ground: None,
        posed_images: None,
        params: PacketParams::default(),
        bounds: Aabb::from_points(&positions),
    }
}

/// Equal images but for pixels on edges, which are rounded to either side.
#[track_caller]
fn assert_same_picture(packet: &ScenePacket, min_psnr_db: f64, what: &str) {
    let (gpu, cpu) = (draw(packet), draw_on_cpu(packet));
    let psnr = psnr_db(mean_squared_error(&gpu, &cpu).unwrap());
    let background = *gpu.get_pixel(0, 0);
    let drawn = gpu.pixels().filter(|&&pixel| pixel != background).count();
    assert!(drawn > 1000, "{what}: {drawn} pixels are drawn");
    assert!(psnr >= min_psnr_db, "{what}: {psnr:.1} dB");
}

/// With some vertices that belong to no triangle.
fn with_points(mesh: &MeshRecords) -> MeshRecords {
    let mut vertices = mesh.vertices.to_vec();
    let mut triangles = mesh.triangles.to_vec();
    for index in 0..60u32 {
        let turn = index as f32 * 2.4;
        let place = Vec3::new(turn.cos(), (index as f32 - 30.0) / 25.0, turn.sin()) * 1.15;
        triangles.insert((index * 3) as usize, point(vertices.len() as u32));
        vertices.push(vertex(place, many_colors(index + 5)));
    }
    MeshRecords::new(Arc::new(vertices), Arc::new(triangles))
}

#[test]
fn both_renderers_draw_the_same_in_every_light_from_far_and_near() {
    for is_smooth in [false, true] {
        for &lighting in Lighting::ALL {
            // From 0.99 on the near plane cuts triangles, and at 0.5 the eye is inside.
            for distance in [3.0, 1.3, 1.01, 0.5] {
                let style = Style::default().with(|style| crate::common::set_lighting(style, lighting));
                let mesh = ball(9, is_smooth, many_colors);
                let what = format!("{lighting} from {distance}, smooth: {is_smooth}");
                assert_same_picture(&packet(mesh, &camera(distance), style), 50.0, &what);
            }
        }
    }
}

#[test]
fn points_between_triangles_are_the_same_squares_and_disks() {
    for &shape in PointShape::ALL {
        for lighting in [Lighting::PerFragment, Lighting::BlinnPhong] {
            let style = Style::default().with(|style| {
                style.points.shape = shape;
                style.points.size_px = 5.0;
                style.light.lighting = lighting;
                style.light.eye_dome = EyeDome::On;
            });
            let mesh = with_points(&ball(9, true, many_colors));
            // Squares are snapped to a 256th of a pixel.
            assert_same_picture(
                &packet(mesh, &camera(3.0), style),
                34.0,
                &format!("{shape}, {lighting}"),
            );
        }
    }
}

/// Nearest distance along the view axis at the centre of a pixel, by all triangles in double precision; and how far
/// inside its triangle that is, as a fraction of it.
fn nearest(packet: &ScenePacket, x: u32, y: u32) -> Option<(f64, f64)> {
    let mesh = packet.content.mesh().unwrap();
    let view = &packet.view;
    let rotation = view.view_from_frame_rotation.as_dmat3();
    let ndc = [
        2.0 * (f64::from(x) + 0.5) / f64::from(SIZE[0]) - 1.0,
        1.0 - 2.0 * (f64::from(y) + 0.5) / f64::from(SIZE[1]),
    ];
    let ray = DVec3::new(
        ndc[0] / f64::from(view.focal[0]),
        ndc[1] / f64::from(view.focal[1]),
        -1.0,
    );
    let mut best: Option<(f64, f64)> = None;
    for index in 0..mesh.triangles.len() {
        let [a, b, c] = mesh
            .corners(index)
            .map(|corner| rotation * (corner.as_dvec3() - view.eye_high.as_dvec3() - view.eye_low.as_dvec3()));
        let matrix = DMat3::from_cols(b - a, c - a, -ray);
        if matrix.determinant() == 0.0 {
            continue;
        }
        let DVec3 { x: p, y: q, z: depth } = matrix.inverse() * -a;
        let inside = p.min(q).min(1.0 - p - q);
        if inside >= 0.0 && depth >= f64::from(view.near) && best.is_none_or(|(nearest, _)| depth < nearest) {
            best = Some((depth, inside));
        }
    }
    best
}

#[test]
fn depths_match_double_precision_rays() {
    for distance in [3.0, 1.2, 0.5] {
        let packet = packet(ball(9, true, many_colors), &camera(distance), Style::default());
        let mut renderer = CpuRenderer::new();
        renderer.prepare(&packet).unwrap();
        let depths = renderer.draw_depths().unwrap();
        let mut differing = 0;
        for (index, &found) in depths.depth.iter().enumerate() {
            let [x, y] = [index as u32 % SIZE[0], index as u32 / SIZE[0]];
            match nearest(&packet, x, y) {
                Some((expected, _)) => differing += usize::from((f64::from(found) - expected).abs() > 1e-4 * expected),
                None => differing += usize::from(found.is_finite()),
            }
        }
        // Silhouettes that pass through a pixel centre.
        assert!(differing <= 2, "{differing} pixels from {distance}");
    }
}

#[test]
fn a_closed_white_mesh_has_no_pixel_that_is_not_white() {
    for (rings, distance) in [(3, 1.8), (40, 1.8), (150, 2.6), (40, 0.5)] {
        let packet = packet(ball(rings, false, |_| [255; 3]), &camera(distance), plain());
        for (picture, by) in [(draw_on_cpu(&packet), "processor"), (draw(&packet), "GPU")] {
            for row in picture.rows() {
                let row: Vec<u8> = row.map(|pixel| pixel.0[0]).collect();
                assert!(row.iter().all(|channel| [0, 255].contains(channel)), "{by}");
                // The outline of a ball is convex.
                let changes = row.windows(2).filter(|pair| pair[0] != pair[1]).count();
                assert!(changes <= 2, "a hole: {rings} rings from {distance}, {by}");
            }
            let white = picture.pixels().filter(|pixel| pixel.0[0] == 255).count();
            assert!(white > 2000, "{white}");
        }
    }
}

#[test]
fn every_strategy_draws_the_same_bytes() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let mesh = with_points(&ball(9, true, many_colors));
    let mut packet = packet(mesh, &camera(1.6), Style::default());
    let expected = draw_with(&mut renderer, &packet);
    for &strategy in Strategy::ALL {
        packet.style.drawing.strategy = strategy;
        assert!(draw_with(&mut renderer, &packet) == expected, "{strategy}");
    }
    assert_eq!(renderer.stats().drawn_instances, 9 * 18 * 2 + 60);
}

#[test]
fn a_mesh_in_many_chunks_gives_the_same_image() {
    let options = ContextOptions {
        max_chunk_records: Some(101),
        ..software()
    };
    let mut in_chunks = GpuRenderer::new(common::open(&options)).unwrap();
    let packet = packet(with_points(&ball(9, true, many_colors)), &camera(1.6), Style::default());
    assert!(draw_with(&mut in_chunks, &packet) == draw(&packet));
    assert!(in_chunks.stats().draw_calls > 5, "{}", in_chunks.stats().draw_calls);
}

#[test]
fn triangles_stay_on_the_gpu_until_their_colors_change() {
    let mut renderer = GpuRenderer::new(common::context()).unwrap();
    let mesh = ball(5, true, many_colors);
    let first = packet(mesh.clone(), &camera(2.0), Style::default());
    draw_with(&mut renderer, &first);
    let moved = ScenePacket {
        view: camera(2.5).transform(DVec3::ZERO, SIZE),
        ..first.clone()
    };
    draw_with(&mut renderer, &moved);
    assert_eq!(renderer.stats().uploads, 1);
    draw_with(
        &mut renderer,
        &packet(ball(5, true, |_| [9; 3]), &camera(2.5), Style::default()),
    );
    assert_eq!(renderer.stats().uploads, 2);
}

/// A square of edge 2 around the origin, seen along its normal.
fn square(color: [u8; 3]) -> Vec<VertexRecord> {
    [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]]
        .map(|[x, y]| vertex(Vec3::new(x, y, 0.0), color))
        .to_vec()
}

const SQUARE: [[u32; 3]; 2] = [[0, 1, 2], [2, 1, 3]];

fn drawn_by_both(packet: &ScenePacket) -> [(RgbaImage, &'static str); 2] {
    [(draw_on_cpu(packet), "processor"), (draw(packet), "GPU")]
}

fn center(picture: &RgbaImage) -> [u8; 3] {
    let [red, green, blue, _] = picture.get_pixel(SIZE[0] / 2, SIZE[1] / 2).0;
    [red, green, blue]
}

#[test]
fn points_and_triangles_hide_each_other_by_depth() {
    for lighting in [Lighting::Unlit, Lighting::Lambert] {
        for (z, expected) in [(-0.1, [200, 100, 50]), (0.1, [1, 2, 3])] {
            let mut vertices = square([200, 100, 50]);
            vertices.push(vertex(Vec3::new(0.0, 0.0, z), [1, 2, 3]));
            let mut mesh = records(vertices, &SQUARE);
            for is_first in [true, false] {
                let mut triangles: Vec<TriangleRecord> =
                    SQUARE.iter().map(|&face| triangle(&mesh.vertices, face)).collect();
                triangles.insert(if is_first { 0 } else { 2 }, point(4));
                mesh = mesh.with_triangles(triangles);
                let style = plain().with(|style| {
                    style.light.lighting = lighting;
                    style.points.size_px = 4.0;
                });
                // Seen straight from the front a matt surface has the colour of the file; a point is unlit anyway.
                for (picture, by) in drawn_by_both(&packet(mesh.clone(), &camera_at(3.0), style)) {
                    let found = center(&picture);
                    let max = found.iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max().unwrap();
                    assert!(max <= 1, "{lighting}, {z}, {by}: {found:?}");
                }
            }
        }
    }
}

#[test]
fn colors_between_corners_are_perspective_correct() {
    // A floor that recedes from the eye: perspective moves its centre far up in the image.
    let places = [
        [-1.0, -1.0, 2.0],
        [1.0, -1.0, 2.0],
        [-1.0, -1.0, -8.0],
        [1.0, -1.0, -8.0],
    ];
    let colors = [[0; 3], [0; 3], [250; 3], [250; 3]];
    let vertices: Vec<_> = places
        .iter()
        .zip(colors)
        .map(|(&place, color)| vertex(Vec3::from_array(place), color))
        .collect();
    let packet = packet(records(vertices, &SQUARE), &camera_at(3.0), plain());
    let px = camera_at(3.0).to_px(DVec3::new(0.1, -1.0, -3.0), SIZE).unwrap();
    for (picture, by) in drawn_by_both(&packet) {
        let found = picture.get_pixel(px.x as u32, px.y as u32).0[0];
        assert!(found.abs_diff(125) <= 4, "{by}: {found}");
    }
}

#[test]
fn textures_are_interpolated_and_multiplied_as_linear_light() {
    let mut picture = RgbaImage::new(2, 2);
    let texels = [
        [255, 0, 0, 255],
        [0, 255, 0, 255],
        [0, 0, 255, 255],
        [255, 255, 255, 255],
    ];
    for (index, texel) in (0..).zip(texels) {
        picture.put_pixel(index % 2, index / 2, Rgba(texel));
    }
    for (tint, max) in [(255u8, 255u8), (188, 188)] {
        let mut vertices = square([tint; 3]);
        for (vertex, place) in vertices
            .iter_mut()
            .zip([[0.0, 1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 0.0]])
        {
            (vertex.texture_place, vertex.texture) = (place, 1);
        }
        let textures = Textures::of(vec![RgbaImage::new(1, 1), picture.clone()]);
        let mesh = records(vertices, &SQUARE).with_textures(Arc::new(textures));
        let packet = packet(mesh, &camera_at(3.0), plain());
        // The texel centres, the upper left one first.
        let places = [[-0.5, 0.5], [0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]];
        for (drawn, by) in drawn_by_both(&packet) {
            for (texel, [x, y]) in texels.iter().zip(places) {
                let px = camera_at(3.0).to_px(DVec3::new(x, y, 0.0), SIZE).unwrap();
                let found = drawn.get_pixel(px.x as u32, px.y as u32).0;
                for channel in 0..3 {
                    let expected = if texel[channel] == 255 { max } else { 0 };
                    // A pixel is a fiftieth of a texel wide: the next texel contributes that much.
                    assert!(
                        found[channel].abs_diff(expected) <= 60,
                        "{by}: {found:?}, not {texel:?}"
                    );
                }
            }
        }
        assert_same_picture(&packet, 50.0, &format!("tint {tint}"));
    }
}

/// Numbers of all sizes and no size: an image or nothing, and never a panic.
#[test]
fn extreme_vertices_are_handled() {
    let extremes = [0.0, 1e-45, -1e-38, 1e-20, 1.0, 1e30, -3e38, f32::MAX];
    let vertices: Vec<VertexRecord> = (0..300usize)
        .map(|index| {
            let pick = |factor: usize| extremes[index * factor % extremes.len()];
            vertex(Vec3::new(pick(1), pick(3), pick(5)), [9; 3])
        })
        .collect();
    let faces: Vec<[u32; 3]> = (0..298).map(|index| [index, index + 1, index + 2]).collect();
    for distance in [1e-30, 1.5, 1e20] {
        for &lighting in Lighting::ALL {
            let style = Style::default().with(|style| crate::common::set_lighting(style, lighting));
            let packet = packet(records(vertices.clone(), &faces), &camera_at(distance), style);
            assert_eq!(draw_on_cpu(&packet).dimensions(), (SIZE[0], SIZE[1]));
        }
    }
}
