//! Painting egui on the CPU: the program's own window of 1280×800, with all panels and text.
//!
//! Measured: the cost of a frame from egui's shapes to pixels, that is comparing the shapes with those of the last
//! frame, tessellating the new ones and painting the damage; for a window that is all new, one in which only the 3-D
//! image is another one (as large as it is shown, or half as large and scaled), one with another label, and one that is
//! the same. Next to them a copy of the same number of pixels, in the same run, and egui's own tessellation of the
//! whole window.
//!
//! Not measured: running the panels; drawing the 3-D image; handing the pixels to the window system.

#![allow(clippy::unwrap_used, reason = "a helper of a benchmark that cannot go on ends it")]

use criterion::{Criterion, criterion_group, criterion_main};
use egui::epaint::ClippedShape;
use egui::{
    Align2, Color32, Context, FontId, Id, LayerId, Order, RawInput, Rect, TextureFilter, TextureId, pos2, vec2,
};
use image::RgbaImage;
use pointreel::app::paint::{PixelRect, SoftwarePainter};
use pointreel::app::panels::window_ui;
use pointreel::app::{State, apply_theme};
use std::hint::black_box;
use walk::{options, sequence, state_on};

#[path = "../tests/common/walk.rs"]
mod walk;

const SIZE_PX: [u32; 2] = [1280, 800];

const PICTURE: TextureId = TextureId::User(0);

struct Window {
    ctx: Context,
    state: State,
    painter: SoftwarePainter,
    pixels: Vec<u32>,
}

impl Window {
    fn open() -> Self {
        let mut state = state_on(sequence(&[]), options());
        state.viewport.texture = Some(PICTURE);
        let ctx = Context::default();
        apply_theme(&ctx);
        let mut window = Self {
            ctx,
            state,
            painter: SoftwarePainter::new(),
            // One extra row, for a window that is one pixel taller.
            pixels: vec![0; (SIZE_PX[0] * (SIZE_PX[1] + 1)) as usize],
        };
        // Lets panels settle and popups finish fading in.
        for _ in 0..20 {
            window.run("1.0 ms");
        }
        window
    }

    /// A pass of the panels, with a label over them.
    fn run(&mut self, label: &str) -> Vec<ClippedShape> {
        let [width, height] = SIZE_PX.map(|edge| edge as f32);
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(width, height))),
            ..RawInput::default()
        };
        let state = &mut self.state;
        let mut output = self.ctx.run_ui(input, |ui| {
            window_ui(ui, state);
            let layer = LayerId::new(Order::Foreground, Id::unique("label"));
            let font = FontId::proportional(13.0);
            let place = pos2(40.0, 60.0);
            let painter = ui.ctx().layer_painter(layer);
            painter.text(place, Align2::LEFT_TOP, label, font, Color32::WHITE);
        });
        self.painter.update_textures(&mut output.textures_delta);
        output.shapes
    }

    /// Shows shapes and paints the changes; returns the number of pixels.
    fn frame(&mut self, shapes: &[ClippedShape], pictures: &[(TextureId, &RgbaImage)], size_px: [u32; 2]) -> u64 {
        self.painter.show(&self.ctx, shapes.to_vec(), 1.0, size_px);
        let damage = self.painter.take_damage();
        self.painter.paint(pictures, &damage, &mut self.pixels);
        damage.iter().map(PixelRect::area_px).sum()
    }
}

fn painting(criterion: &mut Criterion) {
    let mut window = Window::open();
    let shapes = window.run("1.0 ms");
    let other = window.run("1.1 ms");
    // Both galleys stay cached, as for a label that moves back and forth.
    let [width, height] = window.state.viewport.size_px;
    let pixel = |x: u32, y: u32| image::Rgba([x as u8, y as u8, (x + y) as u8, 255]);
    let picture = RgbaImage::from_fn(width, height, pixel);
    let half = RgbaImage::from_fn(width.div_ceil(2), height.div_ceil(2), pixel);
    let pictures = [(PICTURE, &picture)];
    let mut version = 0;
    let mut set_picture = |window: &mut Window, filter: TextureFilter| {
        version += 1;
        window.painter.set_picture(PICTURE, version, filter);
    };

    let mut group = criterion.benchmark_group(format!("paint/{}x{}", SIZE_PX[0], SIZE_PX[1]));
    set_picture(&mut window, TextureFilter::Nearest);
    let mut is_higher = false;
    group.bench_function("whole window", |bencher| {
        bencher.iter(|| {
            is_higher = !is_higher;
            let size_px = [SIZE_PX[0], SIZE_PX[1] + u32::from(is_higher)];
            let painted_px = window.frame(&shapes, &pictures, size_px);
            assert!(painted_px >= u64::from(SIZE_PX[0] * SIZE_PX[1]));
        });
    });
    group.bench_function("whole window, tessellated by egui", |bencher| {
        bencher.iter(|| window.ctx.tessellate(shapes.clone(), 1.0));
    });
    let count = (SIZE_PX[0] * SIZE_PX[1]) as usize;
    copying(&mut group, "copy of as many pixels as the window's", count);

    window.frame(&shapes, &pictures, SIZE_PX);
    let shown_px = u64::from(width) * u64::from(height);
    group.bench_function(format!("picture of {width}x{height}"), |bencher| {
        bencher.iter(|| {
            set_picture(&mut window, TextureFilter::Nearest);
            assert_eq!(window.frame(&shapes, &pictures, SIZE_PX), shown_px);
        });
    });
    group.bench_function("picture of half the resolution", |bencher| {
        bencher.iter(|| {
            set_picture(&mut window, TextureFilter::Linear);
            let pictures = [(PICTURE, &half)];
            assert_eq!(window.frame(&shapes, &pictures, SIZE_PX), shown_px);
        });
    });
    let name = "copy of as many pixels as the picture's";
    copying(&mut group, name, shown_px as usize);

    let mut turn = 0;
    group.bench_function("one changed label", |bencher| {
        bencher.iter(|| {
            turn += 1;
            let shapes = [&shapes, &other][turn % 2];
            let painted_px = window.frame(shapes, &pictures, SIZE_PX);
            assert!(painted_px < 4000, "{painted_px}");
        });
    });
    window.frame(&shapes, &pictures, SIZE_PX);
    group.bench_function("nothing changed", |bencher| {
        bencher.iter(|| assert_eq!(window.frame(&shapes, &pictures, SIZE_PX), 0));
    });
    group.finish();
}

fn copying(group: &mut criterion::BenchmarkGroup<'_, criterion::measurement::WallTime>, name: &str, count: usize) {
    let from = vec![0x0012_3456_u32; count];
    let mut to = vec![0_u32; count];
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            to.copy_from_slice(black_box(&from));
            black_box(&mut to);
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(50);
    targets = painting
}
criterion_main!(benches);
