//! Painting egui on the CPU: known pixels, damage compared with painting all, and with egui-wgpu's images.

mod agreement;
mod beside;
mod changes;
mod known;

use egui::epaint::{ClippedShape, ImageDelta};
use egui::{
    Color32, ColorImage, Context, FontId, RawInput, Rect, Shape, TextureId, TextureOptions, TexturesDelta, pos2,
};
use image::RgbaImage;
use pointreel::app::paint::{PixelRect, SoftwarePainter};

/// A painter with its pixels, at one pixel per point.
struct Window {
    ctx: Context,
    painter: SoftwarePainter,
    size_px: [u32; 2],
    pictures: Vec<(TextureId, RgbaImage)>,
    pixels: Vec<u32>,
    last_damage: Vec<PixelRect>,
}

impl Window {
    fn new(size_px: [u32; 2]) -> Self {
        let mut window = Self {
            ctx: Context::default(),
            painter: SoftwarePainter::new(),
            size_px,
            pictures: Vec::new(),
            // A marker colour reveals unpainted pixels.
            pixels: vec![0x00ab_cdef; (size_px[0] * size_px[1]) as usize],
            last_damage: Vec::new(),
        };
        window.run(|_| {});
        window
    }

    /// A pass of egui, in which texts can be laid out.
    fn run(&mut self, mut what: impl FnMut(&Context)) {
        let mut output = self.ctx.run_ui(RawInput::default(), |ui| what(ui.ctx()));
        self.painter.update_textures(&mut output.textures_delta);
    }

    fn set_texture(&mut self, id: TextureId, image: ColorImage, options: TextureOptions, corner: Option<[usize; 2]>) {
        let delta = match corner {
            None => ImageDelta::full(image, options),
            Some(corner) => ImageDelta::partial(corner, image, options),
        };
        let mut changes = TexturesDelta::default();
        changes.push(id, delta);
        self.painter.update_textures(&mut changes);
    }

    fn show(&mut self, shapes: Vec<Shape>) {
        self.show_clipped(Rect::EVERYTHING, shapes);
    }

    fn show_clipped(&mut self, clip_rect: Rect, shapes: Vec<Shape>) {
        self.show_each(shapes.into_iter().map(|shape| (clip_rect, shape)).collect());
    }

    /// Shows shapes, each with its clip rectangle, and paints the changes.
    fn show_each(&mut self, shapes: Vec<(Rect, Shape)>) {
        let shapes = shapes.into_iter().map(|(clip_rect, shape)| ClippedShape {
            clip_rect,
            shape,
            transform_after_tessellation: egui::emath::TSTransform::IDENTITY,
        });
        self.painter.show(&self.ctx, shapes.collect(), 1.0, self.size_px);
        self.last_damage = self.painter.take_damage();
        let pictures: Vec<_> = self.pictures.iter().map(|(id, image)| (*id, image)).collect();
        self.painter.paint(&pictures, &self.last_damage, &mut self.pixels);
    }

    fn show_texts(&mut self, texts: &[&str]) {
        let mut shapes = Vec::new();
        self.run(|ctx| {
            shapes.clear();
            for (line, text) in texts.iter().enumerate() {
                let font = FontId::proportional(14.0);
                let galley = ctx.fonts_mut(|fonts| fonts.layout_no_wrap((*text).to_owned(), font, Color32::WHITE));
                let place = pos2(5.0, 5.0 + 25.0 * line as f32);
                shapes.push(Shape::galley(place, galley, Color32::WHITE));
            }
        });
        self.show(shapes);
    }

    fn paint_all(&mut self) {
        let pictures: Vec<_> = self.pictures.iter().map(|(id, image)| (*id, image)).collect();
        let all = [PixelRect::of_size(self.size_px)];
        self.painter.paint(&pictures, &all, &mut self.pixels);
    }
}

/// Numbers that look random and are the same each time.
#[derive(Debug, Clone)]
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        // The linear congruential generator of Numerical Recipes; its low bits are poor.
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    fn between(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * self.below(4096) as f32 / 4096.0
    }
}

fn opaque_picture(width: u32, height: u32, seed: u64) -> RgbaImage {
    let mut random = Random(seed);
    RgbaImage::from_fn(width, height, |_, _| {
        let [red, green, blue, ..] = random.next().to_le_bytes();
        image::Rgba([red, green, blue, 255])
    })
}
