//! Painting only changes gives the same image as painting all.

use super::{Random, opaque_picture};
use egui::epaint::{ClippedShape, CubicBezierShape, ImageDelta, Mesh, RectShape, Vertex};
use egui::{
    Color32, ColorImage, Context, CornerRadius, FontId, Pos2, RawInput, Rect, Shape, Stroke, StrokeKind, TextureFilter,
    TextureId, TextureOptions, TexturesDelta, Vec2, pos2, vec2,
};
use image::RgbaImage;
use pointreel::app::paint::{PixelRect, SoftwarePainter};

const PICTURES: [TextureId; 2] = [TextureId::User(0), TextureId::User(1)];
const TEXTURES: [TextureId; 2] = [TextureId::Managed(50), TextureId::Managed(51)];

/// The data stored between passes to make a shape again.
#[derive(Debug, Clone)]
enum What {
    Shape(Shape),
    Text(String, Pos2, Color32),
}

struct Scene {
    random: Random,
    size_px: [u32; 2],
    scale: f32,
    things: Vec<(Rect, What)>,
    versions: [u64; 2],
    filters: [TextureFilter; 2],
    pictures: Vec<(TextureId, RgbaImage)>,
    textures: TexturesDelta,
}

impl Scene {
    fn new(seed: u64) -> Self {
        let mut scene = Self {
            random: Random(seed),
            size_px: [160, 120],
            scale: 1.0,
            things: Vec::new(),
            versions: [1; 2],
            filters: [TextureFilter::Nearest; 2],
            pictures: PICTURES.map(|id| (id, opaque_picture(70, 50, seed))).to_vec(),
            textures: TexturesDelta::default(),
        };
        for id in TEXTURES {
            scene.set_texture(id, None);
        }
        for _ in 0..25 {
            scene.insert();
        }
        scene
    }

    fn set_texture(&mut self, id: TextureId, corner: Option<[usize; 2]>) {
        let size = if corner.is_some() { [3, 2] } else { [9, 7] };
        let texels = (0..size[0] * size[1]).map(|_| self.color()).collect();
        let image = ColorImage::new(size, texels);
        let options = [TextureOptions::LINEAR, TextureOptions::NEAREST_REPEAT];
        let options = options[(self.random.below(2)) as usize];
        self.textures.push(
            id,
            match corner {
                None => ImageDelta::full(image, options),
                Some(corner) => ImageDelta::partial(corner, image, options),
            },
        );
    }

    fn color(&mut self) -> Color32 {
        let [red, green, blue, alpha, ..] = (self.random.next() << 8).to_le_bytes();
        match self.random.below(4) {
            0 => Color32::from_rgb(red, green, blue),
            1 => Color32::from_rgb_additive(red / 4, green / 4, blue / 4),
            _ => Color32::from_rgba_unmultiplied(red, green, blue, alpha),
        }
    }

    fn place(&mut self) -> Pos2 {
        let place = pos2(self.random.between(-20.0, 160.0), self.random.between(-20.0, 120.0));
        match self.random.below(3) {
            0 => place,
            1 => place.round(),
            _ => place.floor() + Vec2::splat(0.5),
        }
    }

    fn rect(&mut self) -> Rect {
        let size = vec2(self.random.between(0.0, 60.0), self.random.between(0.0, 40.0));
        Rect::from_min_size(self.place(), size)
    }

    fn clip(&mut self) -> Rect {
        match self.random.below(3) {
            0 => self.rect(),
            _ => Rect::EVERYTHING,
        }
    }

    fn what(&mut self) -> What {
        let color = self.color();
        What::Shape(match self.random.below(8) {
            0 => {
                let rect = self.rect();
                let radius = CornerRadius::same(self.random.below(9) as u8);
                let mut shape = RectShape::new(
                    rect,
                    radius,
                    color,
                    Stroke::new(self.random.between(0.0, 3.0), self.color()),
                    StrokeKind::Middle,
                );
                shape.blur_width = self.random.below(2) as f32 * 6.0;
                shape.into()
            }
            1 => Shape::circle_filled(self.place(), self.random.between(0.5, 20.0), color),
            2 => Shape::line_segment(
                [self.place(), self.place()],
                Stroke::new(self.random.between(0.3, 4.0), color),
            ),
            3 => {
                let points = [(); 4].map(|()| self.place());
                let stroke = Stroke::new(2.0, color);
                let curve = CubicBezierShape::from_points_stroke(points, false, Color32::TRANSPARENT, stroke);
                Shape::Vec(vec![Shape::Noop, curve.into(), Shape::Vec(Vec::new())])
            }
            4 => {
                let id = [PICTURES, TEXTURES].concat()[self.random.below(4) as usize];
                let at = match self.random.below(2) {
                    0 => self.rect(),
                    _ => Rect::from_min_size(self.place().round(), vec2(70.0, 50.0)),
                };
                let mut mesh = Mesh::with_texture(id);
                let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
                let tint = [Color32::WHITE, color][self.random.below(2) as usize];
                mesh.add_rect_with_uv(at, whole, tint);
                Shape::mesh(mesh)
            }
            5 => {
                let id = [TextureId::default(), TEXTURES[0]][self.random.below(2) as usize];
                let mut mesh = Mesh::with_texture(id);
                for _ in 0..6 {
                    let vertex = Vertex {
                        pos: self.place(),
                        uv: if id == TEXTURES[0] {
                            pos2(self.random.between(-1.0, 2.0), self.random.between(-1.0, 2.0))
                        } else {
                            Pos2::ZERO
                        },
                        color: self.color(),
                    };
                    mesh.vertices.push(vertex);
                }
                mesh.indices = vec![0, 1, 2, 3, 4, 5];
                Shape::mesh(mesh)
            }
            _ => {
                let word = self.random.below(500).to_string();
                return What::Text(word, self.place(), color);
            }
        })
    }

    fn insert(&mut self) {
        let thing = (self.clip(), self.what());
        let at = self.random.below(self.things.len() as u64 + 1) as usize;
        self.things.insert(at, thing);
    }

    fn any(&mut self) -> usize {
        self.random.below(self.things.len() as u64) as usize
    }

    fn change(&mut self) {
        if self.things.len() < 12 {
            self.insert();
        }
        match self.random.below(14) {
            0 | 1 if self.things.len() < 40 => self.insert(),
            2 | 3 => {
                let at = self.any();
                self.things.remove(at);
            }
            4 | 5 => {
                let by = self.place().to_vec2() * 0.1;
                let at = self.any();
                match &mut self.things[at].1 {
                    What::Shape(shape) => shape.translate(by),
                    What::Text(_, place, _) => *place += by,
                }
            }
            6 => {
                let (at, what) = (self.any(), self.what());
                let (word, color) = (self.random.below(500).to_string(), self.color());
                match &mut self.things[at].1 {
                    What::Text(text, _, _) if self.random.below(2) == 0 => *text = word,
                    What::Text(_, _, old) => *old = color,
                    other @ What::Shape(_) => *other = what,
                }
            }
            7 => {
                let (at, clip) = (self.any(), self.clip());
                self.things[at].0 = clip;
            }
            8 => {
                let (a, b) = (self.any(), self.any());
                self.things.swap(a, b);
            }
            9 => {
                let at = self.any();
                let moved = self.things.remove(at);
                self.things.push(moved);
            }
            10 => {
                let which = self.random.below(2) as usize;
                self.versions[which] += 1;
                let size = [70 - self.random.below(2) as u32 * 30, 50];
                let seed = self.random.next();
                self.pictures[which].1 = opaque_picture(size[0], size[1], seed);
                if self.random.below(3) == 0 {
                    self.filters[which] = TextureFilter::Linear;
                }
            }
            11 => {
                let id = TEXTURES[self.random.below(2) as usize];
                let corner = (self.random.below(2) == 0).then_some([2, 3]);
                self.set_texture(id, corner);
            }
            12 if self.random.below(8) == 0 => {
                self.size_px = [100 + self.random.below(80) as u32, 80 + self.random.below(60) as u32];
            }
            13 if self.random.below(8) == 0 => {
                self.scale = [1.0, 1.25, 2.0][self.random.below(3) as usize];
            }
            // No change.
            _ => {}
        }
    }

    /// The output of egui.
    fn shapes(&self, ctx: &Context) -> Vec<ClippedShape> {
        let things = self.things.iter().map(|(clip_rect, what)| {
            let shape = match what {
                What::Shape(shape) => shape.clone(),
                What::Text(text, place, color) => {
                    let font = FontId::proportional(13.0);
                    let galley = ctx.fonts_mut(|fonts| fonts.layout_no_wrap(text.clone(), font, *color));
                    Shape::galley(*place, galley, *color)
                }
            };
            ClippedShape {
                clip_rect: *clip_rect,
                shape,
                transform_after_tessellation: egui::emath::TSTransform::IDENTITY,
            }
        });
        things.collect()
    }
}

/// A window's buffer, and the changes since it was painted.
struct Buffer {
    pixels: Vec<u32>,
    pending: Vec<PixelRect>,
}

/// Several threads paint a window this large, one thread paints parts of it.
#[test]
fn a_large_window_is_the_same_in_one_piece_and_in_parts() {
    let mut scene = Scene::new(5);
    scene.size_px = [2560, 1920];
    let ctx = Context::default();
    let mut painter = SoftwarePainter::new();
    let mut input = RawInput::default();
    let root = input.viewports.entry(egui::ViewportId::ROOT).or_default();
    root.native_pixels_per_point = Some(16.0);
    let mut shapes = Vec::new();
    let mut output = ctx.run_ui(input, |ui| shapes = scene.shapes(ui.ctx()));
    for changes in [&mut output.textures_delta, &mut scene.textures] {
        painter.update_textures(changes);
    }
    painter.show(&ctx, shapes, output.pixels_per_point, scene.size_px);
    let pictures = scene.pictures.iter().map(|(id, image)| (*id, image));
    let pictures: Vec<_> = pictures.collect();
    let mut pixels = [0x0012_3456, 0x0065_4321].map(|fill| vec![fill; 2560 * 1920]);
    let [in_one, in_parts] = &mut pixels;
    painter.paint(&pictures, &[PixelRect::of_size(scene.size_px)], in_one);
    for row in 0..3 {
        let part = PixelRect {
            min: [0, 640 * row],
            max: [2560, 640 * (row + 1)],
        };
        painter.paint(&pictures, &[part], in_parts);
    }
    assert!(in_one == in_parts);
    let mut colors = in_one.clone();
    colors.sort_unstable();
    colors.dedup();
    assert!(colors.len() > 100, "{} colours", colors.len());
}

#[test]
fn partial_repaints_match_full_repaints_over_a_thousand_changes() {
    let (mut damaged_px, mut all_px, mut unchanged) = (0, 0, 0);
    for seed in 1..=4 {
        let mut scene = Scene::new(seed);
        let ctx = Context::default();
        let mut painter = SoftwarePainter::new();
        // A painter that knows the textures, but only the current shapes.
        let mut fresh = SoftwarePainter::new();
        let mut buffers: Vec<Buffer> = Vec::new();
        let mut size_px = [0; 2];
        for step in 0..250 {
            for _ in 0..scene.random.below(4) {
                scene.change();
            }
            let mut input = RawInput::default();
            let root = input.viewports.entry(egui::ViewportId::ROOT).or_default();
            root.native_pixels_per_point = Some(scene.scale);
            let mut shapes = Vec::new();
            let mut output = ctx.run_ui(input, |ui| shapes = scene.shapes(ui.ctx()));
            for changes in [&mut output.textures_delta, &mut scene.textures] {
                fresh.update_textures(&mut changes.clone());
                painter.update_textures(changes);
            }
            for (index, id) in PICTURES.into_iter().enumerate() {
                painter.set_picture(id, scene.versions[index], scene.filters[index]);
                fresh.set_picture(id, 0, scene.filters[index]);
            }
            let scale = output.pixels_per_point;
            fresh.show(&ctx, Vec::new(), scale, scene.size_px);
            fresh.show(&ctx, shapes.clone(), scale, scene.size_px);
            painter.show(&ctx, shapes, scale, scene.size_px);
            let damage = painter.take_damage();
            assert_eq!(painter.take_damage(), [], "taken once");

            let count = (scene.size_px[0] * scene.size_px[1]) as usize;
            if size_px != scene.size_px {
                size_px = scene.size_px;
                // The system supplies new ones, with arbitrary contents.
                let new = |fill| Buffer {
                    pixels: vec![fill; count],
                    pending: vec![PixelRect::of_size(size_px)],
                };
                buffers = vec![new(0x0012_3456), new(0x0065_4321), new(7)];
            }
            let pictures: Vec<_> = scene.pictures.iter().map(|(id, image)| (*id, image)).collect();
            for buffer in &mut buffers {
                buffer.pending.extend(&damage);
            }
            // The first is painted each time, the others alternately: they are two frames old.
            for index in [0, 1 + step % 2] {
                let Buffer { pixels, pending } = &mut buffers[index];
                painter.paint(&pictures, pending, pixels);
                pending.clear();
            }
            let mut whole = vec![0x00de_adbe; count];
            fresh.paint(&pictures, &[PixelRect::of_size(size_px)], &mut whole);
            for index in [0, 1 + step % 2] {
                let wrong = (0..count).filter(|&at| buffers[index].pixels[at] != whole[at]);
                let wrong: Vec<_> = wrong
                    .map(|at| [at as u32 % size_px[0], at as u32 / size_px[0]])
                    .collect();
                assert!(
                    wrong.is_empty(),
                    "seed {seed}, step {step}, buffer {index}: {} pixels, {:?} … are not as painted whole; damage \
                     {damage:?}",
                    wrong.len(),
                    &wrong[..wrong.len().min(4)]
                );
            }
            damaged_px += damage.iter().map(PixelRect::area_px).sum::<u64>();
            all_px += count as u64;
            unchanged += usize::from(damage.is_empty());
        }
    }
    // Otherwise it would not test damage.
    assert!(damaged_px < all_px / 2, "{damaged_px} of {all_px}");
    assert!(unchanged > 100, "{unchanged} of 1000");
}
