//! The window and headless rendering run one list of stages: their packets are equal.

use super::{options, sequence, state_on};
use pointreel::app::State;
use pointreel::composition::{ChangeColors, ComposeOptions, OnionSkin};
use pointreel::headless::Headless;
use pointreel::levels::Lod;
use pointreel::render::AnyRenderer;
use pointreel::scene::{Clip, ClipShape, Primitive, RendererChoice, ScenePacket, Settings};
use pointreel::sequence::{Loader, LoaderOptions};
use std::sync::Arc;
use std::time::{Duration, Instant};

const SIZE_PX: [u32; 2] = [160, 120];

/// A frame with others on both sides.
const INDEX: usize = 5;

/// All that is drawn; arrays by their values, as the allocations are others.
fn told(packet: &ScenePacket) -> String {
    let ScenePacket {
        viewport_px,
        view,
        style,
        content,
        bounds,
        ground,
        posed_images,
        params,
    } = packet;
    format!("{viewport_px:?} {view:?} {style:?} {content:?} {bounds:?} {ground:?} {posed_images:?} {params:?}")
}

/// Waits until the window draws `expected`.
fn assert_drawn(state: &mut State, expected: &str, name: &str) {
    let patience = Instant::now();
    loop {
        let now = state.now() + Duration::from_millis(5);
        state.update(now);
        state.forget_picture();
        let drawn = state.next_packet().map(|packet| told(&packet));
        if drawn.as_deref() == Some(expected) {
            return;
        }
        assert!(
            patience.elapsed() < Duration::from_secs(30),
            "{name}:\n{drawn:?}\nis not\n{expected}"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn assert_same(name: &str, wanted: &ComposeOptions, change: impl Fn(&mut Settings)) {
    let mut state = state_on(sequence(&[]), options());
    let now = state.now();
    state.player.as_mut().unwrap().seek(INDEX, now);
    state.viewport.size_px = SIZE_PX;
    state.style.drawing.renderer = RendererChoice::Cpu.into();
    change(&mut state.style);
    if let Some(change) = wanted.change {
        state.features.temporal.change.is_on = true;
        state.features.temporal.change.step = change.step;
        state.features.temporal.change.range = change.range;
    }
    if let Some(onion) = wanted.onion {
        state.features.temporal.onion = onion;
    }
    super::load_all(&mut state);
    let style = state.drawn_style();
    let sequence = sequence(&[]);
    let loader = Loader::new(Arc::clone(&sequence), LoaderOptions::default()).unwrap();
    let mut headless = Headless::new(sequence, loader, AnyRenderer::cpu());
    let pose = headless.frame(INDEX, &style).unwrap();
    let (composed, problems) = headless.compose(&pose, wanted, &style).unwrap();
    assert!(problems.is_empty(), "{name}: {problems:?}");
    assert_eq!(
        Arc::ptr_eq(&composed.frame, &pose),
        wanted.change.is_none() && wanted.onion.is_none()
    );
    let packet = headless.packet(&composed.frame, &state.camera, &style, SIZE_PX);
    assert_drawn(&mut state, &told(&packet), name);
}

#[test]
fn the_window_draws_the_same_as_headless_rendering() {
    let plain = ComposeOptions::NONE;
    let change = ComposeOptions {
        change: Some(ChangeColors { step: 2, range: None }),
        ..plain.clone()
    };
    let onion = ComposeOptions {
        onion: Some(OnionSkin {
            is_on: true,
            ..OnionSkin::default()
        }),
        ..plain.clone()
    };
    let both = ComposeOptions {
        onion: onion.onion,
        ..change.clone()
    };
    let same = |_: &mut Settings| {};
    for (name, wanted) in [
        ("plain", &plain),
        ("change", &change),
        ("onion", &onion),
        ("both", &both),
    ] {
        assert_same(name, wanted, same);
        assert_same(name, wanted, |style| style.primitive = Primitive::Point.into());
    }
    assert_same("clip", &both, |style| {
        style.clip = Some(Clip::to(ClipShape::Plane {
            normal: glam::DVec3::X,
            offset: 0.0,
        }));
    });
    assert_same("levels", &both, |style| {
        style.levels.surfel_lod = true;
        style.levels.lod = Lod::ThresholdPx(4.0);
    });
    assert_same("voxels", &change, |style| style.primitive = Primitive::Voxel.into());
}
