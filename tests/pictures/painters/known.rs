//! Shapes whose pixels are known.

use super::{Window, opaque_picture};
use egui::epaint::{Mesh, RectShape, Vertex};
use egui::{
    Color32, ColorImage, CornerRadius, Pos2, Rect, Shape, TextureFilter, TextureId, TextureOptions, Vec2, pos2, vec2,
};
use image::RgbaImage;
use pointreel::app::paint::PixelRect;
use std::sync::Arc;

const RED: Color32 = Color32::from_rgb(255, 0, 0);

/// Adds one to the blue of each pixel that it covers.
const ONE: Color32 = Color32::from_rgba_premultiplied(0, 0, 1, 0);

fn count(pixels: &[u32], color: u32) -> usize {
    pixels.iter().filter(|&&pixel| pixel == color).count()
}

fn rect(x: f32, y: f32, width: f32, height: f32) -> Rect {
    Rect::from_min_size(pos2(x, y), vec2(width, height))
}

fn triangles(points: &[Pos2], indices: &[u32], color: Color32) -> Mesh {
    let vertices = points.iter().map(|&at| Vertex::untextured(at, color));
    Mesh {
        indices: indices.to_vec(),
        vertices: vertices.collect(),
        texture_id: TextureId::default(),
    }
}

fn image_mesh(texture: TextureId, at: Rect) -> Shape {
    let mut mesh = Mesh::with_texture(texture);
    let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    mesh.add_rect_with_uv(at, whole, Color32::WHITE);
    Shape::mesh(mesh)
}

#[test]
fn a_rectangle_of_10_by_7_is_70_pixels() {
    let at = rect(5.0, 3.0, 10.0, 7.0);
    let mut mesh = Mesh::default();
    mesh.add_colored_rect(at, RED);
    let filled = RectShape::filled(at, CornerRadius::ZERO, RED);
    for shape in [Shape::mesh(mesh), filled.into()] {
        let mut window = Window::new([40, 30]);
        window.show(vec![shape]);
        assert_eq!(count(&window.pixels, 0x00ff_0000), 70);
        assert_eq!(count(&window.pixels, 0), 40 * 30 - 70);
        assert_eq!(window.pixels[40 * 3 + 5], 0x00ff_0000);
        assert_eq!(window.pixels[40 * 9 + 14], 0x00ff_0000);
    }
}

#[test]
fn a_pixel_belongs_to_the_rectangle_containing_its_center() {
    // Centres on the left and upper edge are inside, those on the right and lower edge are not.
    for (at, expected) in [
        (rect(1.5, 1.5, 2.0, 2.0), [1, 3]),
        (rect(1.51, 1.51, 2.0, 2.0), [2, 4]),
        (rect(1.49, 1.49, 2.0, 2.0), [1, 3]),
    ] {
        let mut mesh = Mesh::default();
        mesh.add_colored_rect(at, RED);
        let mut window = Window::new([6, 6]);
        window.show(vec![Shape::mesh(mesh)]);
        for y in 0..6 {
            for x in 0..6 {
                let is_inside = [x, y].iter().all(|at| (expected[0]..expected[1]).contains(at));
                assert_eq!(window.pixels[6 * y + x] != 0, is_inside, "{at}: {x}, {y}");
            }
        }
    }
}

#[test]
fn triangles_that_share_edges_cover_every_pixel_once() {
    // Fans around a position inside the square: pixel centres lie on many of their edges.
    for center in [pos2(20.0, 20.0), pos2(20.5, 20.5), pos2(17.3, 29.8)] {
        for parts in [4_u32, 7, 36] {
            let mut points = vec![center];
            let edge = |at: f32| {
                let (side, along) = ((at * 4.0).floor(), (at * 4.0).fract() * 32.0);
                match side as u32 {
                    0 => pos2(4.0 + along, 4.0),
                    1 => pos2(36.0, 4.0 + along),
                    2 => pos2(36.0 - along, 36.0),
                    _ => pos2(4.0, 36.0 - along),
                }
            };
            // The corners are among the points, so that the fan fills the square.
            let ring = 4 * parts;
            points.extend((0..ring).map(|part| edge(part as f32 / ring as f32)));
            // Every second one with the opposite winding.
            let indices: Vec<u32> = (0..ring)
                .flat_map(|part| {
                    let (a, b) = (1 + part, 1 + (part + 1) % ring);
                    if part % 2 == 0 { [0, a, b] } else { [0, b, a] }
                })
                .collect();
            let mut window = Window::new([40, 40]);
            window.show(vec![Shape::mesh(triangles(&points, &indices, ONE))]);
            assert_eq!(count(&window.pixels, 1), 32 * 32, "{center}, {parts}");
            assert_eq!(count(&window.pixels, 0), 40 * 40 - 32 * 32);
        }
    }
}

#[test]
fn the_halves_of_a_rotated_square_share_no_pixel() {
    for turn in 0..30 {
        let axis = Vec2::angled(turn as f32 * 0.1) * 15.0;
        let points = [axis, axis.rot90(), -axis, -axis.rot90()].map(|at| pos2(20.0, 20.0) + at);
        let half = Color32::from_rgba_premultiplied(0, 0, 100, 128);
        let mut window = Window::new([40, 40]);
        window.show(vec![Shape::mesh(triangles(&points, &[0, 1, 2, 0, 2, 3], half))]);
        let covered = count(&window.pixels, 100);
        assert_eq!(covered + count(&window.pixels, 0), 1600, "{turn}");
        assert!((430..=470).contains(&covered), "{turn}: {covered} of 450");
    }
}

#[test]
fn nothing_is_painted_outside_the_clip_rectangle() {
    let mut mesh = Mesh::default();
    mesh.add_colored_rect(rect(-1e7, -1e7, 2e7, 2e7), RED);
    let mut window = Window::new([40, 30]);
    window.show_clipped(rect(10.4, 5.5, 10.0, 8.0), vec![Shape::mesh(mesh)]);
    assert_eq!(count(&window.pixels, 0x00ff_0000), 10 * 8);
    for (index, &pixel) in window.pixels.iter().enumerate() {
        let (x, y) = (index % 40, index / 40);
        // Edges are rounded like those of egui-wgpu.
        let is_inside = (10..20).contains(&x) && (6..14).contains(&y);
        assert_eq!(pixel != 0, is_inside, "{x}, {y}");
    }
}

#[test]
fn an_image_is_copied_pixel_by_pixel() {
    let id = TextureId::User(3);
    let picture = opaque_picture(31, 17, 5);
    let mut window = Window::new([50, 40]);
    window.painter.set_picture(id, 1, TextureFilter::Nearest);
    window.pictures = vec![(id, picture.clone())];
    for filter in [TextureFilter::Nearest, TextureFilter::Linear] {
        window.painter.set_picture(id, 1, filter);
        window.show(vec![image_mesh(id, rect(7.0, 9.0, 31.0, 17.0))]);
        for (x, y, pixel) in picture.enumerate_pixels() {
            let [red, green, blue, _] = pixel.0.map(u32::from);
            let shown = window.pixels[(50 * (y + 9) + x + 7) as usize];
            assert_eq!(shown, red << 16 | green << 8 | blue, "{filter:?} {x} {y}");
        }
    }
    assert_eq!(count(&window.pixels, 0), 50 * 40 - 31 * 17);

    // A new version is a change; the same one is not.
    window.painter.set_picture(id, 1, TextureFilter::Linear);
    assert_eq!(window.painter.take_damage(), []);
    window.painter.set_picture(id, 2, TextureFilter::Linear);
    let place = PixelRect {
        min: [7, 9],
        max: [38, 26],
    };
    assert_eq!(window.painter.take_damage(), [place]);
}

#[test]
fn a_smaller_image_is_scaled_linearly() {
    let id = TextureId::User(0);
    let mut picture = RgbaImage::new(2, 1);
    picture.put_pixel(0, 0, image::Rgba([0, 0, 0, 255]));
    picture.put_pixel(1, 0, image::Rgba([200, 100, 40, 255]));
    let mut window = Window::new([8, 2]);
    window.painter.set_picture(id, 1, TextureFilter::Linear);
    window.pictures = vec![(id, picture)];
    window.show(vec![image_mesh(id, rect(0.0, 0.0, 8.0, 2.0))]);
    let reds: Vec<u32> = window.pixels[..8].iter().map(|pixel| pixel >> 16).collect();
    assert_eq!(reds, [0, 0, 25, 75, 125, 175, 200, 200]);
    assert_eq!(window.pixels[..8], window.pixels[8..]);
}

#[test]
fn a_line_separates_two_images() {
    let ids = [TextureId::User(0), TextureId::User(1)];
    let pictures = [opaque_picture(20, 10, 1), opaque_picture(20, 10, 2)];
    let mut window = Window::new([20, 10]);
    for id in ids {
        window.painter.set_picture(id, 1, TextureFilter::Nearest);
    }
    window.pictures = ids.into_iter().zip(pictures.clone()).collect();
    let whole = rect(0.0, 0.0, 20.0, 10.0);
    let sides = [rect(0.0, 0.0, 8.0, 10.0), rect(8.0, 0.0, 12.0, 10.0)];
    let shapes = ids.iter().zip(sides);
    let shapes = shapes.map(|(&id, side)| (side, image_mesh(id, whole)));
    window.show_each(shapes.collect());
    for (index, &pixel) in window.pixels.iter().enumerate() {
        let (x, y) = (index as u32 % 20, index as u32 / 20);
        let [red, green, blue, _] = pictures[usize::from(x >= 8)].get_pixel(x, y).0;
        assert_eq!(pixel, u32::from_be_bytes([0, red, green, blue]));
    }
    // An image that is not supplied is skipped.
    window.pictures.remove(0);
    window.paint_all();
    assert!(window.pixels.chunks(20).all(|row| row[..8] == [0; 8]));
}

#[test]
fn textures_are_wrapped_as_requested() {
    let id = TextureId::Managed(77);
    let texel = |blue: u8| Color32::from_rgb(0, 0, blue);
    let image = ColorImage::new([3, 1], vec![texel(10), texel(20), texel(30)]);
    for (options, expected) in [
        (TextureOptions::NEAREST, [10, 10, 10, 10, 20, 30, 30, 30, 30]),
        (TextureOptions::NEAREST_REPEAT, [10, 20, 30, 10, 20, 30, 10, 20, 30]),
        (
            TextureOptions::NEAREST_MIRRORED_REPEAT,
            [30, 20, 10, 10, 20, 30, 30, 20, 10],
        ),
    ] {
        let mut window = Window::new([9, 1]);
        window.set_texture(id, image.clone(), options, None);
        let mut mesh = Mesh::with_texture(id);
        let uv = Rect::from_min_max(pos2(-1.0, 0.0), pos2(2.0, 1.0));
        mesh.add_rect_with_uv(rect(0.0, 0.0, 9.0, 1.0), uv, Color32::WHITE);
        window.show(vec![Shape::mesh(mesh)]);
        assert_eq!(window.pixels, expected, "{options:?}");
    }
}

#[test]
fn undrawable_meshes_are_skipped() {
    let far = 3e38;
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, far, -far, 2e6];
    let mut shapes = Vec::new();
    for value in bad {
        for place in 0..6 {
            let mut points = [pos2(2.0, 2.0), pos2(30.0, 3.0), pos2(5.0, 20.0)];
            if place % 2 == 0 {
                points[place / 2].x = value;
            } else {
                points[place / 2].y = value;
            }
            shapes.push(Shape::mesh(triangles(&points, &[0, 1, 2], RED)));
            let mut textured = triangles(&points, &[0, 1, 2], Color32::TRANSPARENT);
            for vertex in &mut textured.vertices {
                vertex.uv = pos2(value, value);
            }
            shapes.push(Shape::mesh(textured));
        }
    }
    let points = [pos2(2.0, 2.0), pos2(30.0, 3.0), pos2(5.0, 20.0)];
    // No such vertex, no area, no third corner, no such texture, no such image.
    for indices in [&[0, 1, 3][..], &[0, 1, u32::MAX], &[0, 1, 1], &[0, 1]] {
        let mesh = triangles(&points, indices, RED);
        // egui's own constructor checks the indices.
        shapes.push(Shape::Mesh(Arc::new(mesh)));
    }
    shapes.push(image_mesh(TextureId::Managed(99), rect(0.0, 0.0, 9.0, 9.0)));
    shapes.push(image_mesh(TextureId::User(99), rect(0.0, 0.0, 9.0, 9.0)));
    for shape in shapes {
        let mut window = Window::new([40, 30]);
        window.show(vec![shape.clone()]);
        // Triangles with corners far outside the window are skipped, those at extreme coordinates may be clipped.
        assert_eq!(count(&window.pixels, 0), 40 * 30, "{shape:?}");
    }
    // A target that is too short must not cause a failure.
    let mut window = Window::new([40, 30]);
    window.show(vec![Shape::rect_filled(rect(0.0, 0.0, 40.0, 30.0), 0, RED)]);
    let all = [PixelRect::of_size([100, 100])];
    let mut short = vec![7; 40 * 12 + 5];
    window.painter.paint(&[], &all, &mut short);
    assert_eq!(count(&short, 0x00ff_0000), 40 * 12);
}

#[test]
fn a_new_glyph_changes_nothing_that_is_shown() {
    let mut window = Window::new([200, 60]);
    window.show_texts(&["abc"]);
    assert!(window.pixels.iter().any(|&pixel| pixel != 0));
    window.show_texts(&["abc"]);
    assert_eq!(window.last_damage, []);
    // The atlas grows by new glyphs; the image stays.
    window.show_texts(&["abc", "xyz"]);
    let [damage] = window.last_damage[..] else {
        panic!("{:?}", window.last_damage);
    };
    assert!(damage.min[1] > 25, "{damage:?}");
    let before = window.pixels.clone();
    window.paint_all();
    assert!(window.pixels == before);
}
