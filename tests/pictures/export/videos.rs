//! Videos, decoded again by the crate `image` and by `ffmpeg`.

use super::{headless, headless_of, near_by};
use image::codecs::gif::GifDecoder;
use image::codecs::webp::WebPDecoder;
use image::{AnimationDecoder as _, Frame, RgbaImage};
use pointreel::composition::ComposeOptions;
use pointreel::export::{ExportError, Picture, PictureSize, Video, draw_picture, export_video, open_sink};
use pointreel::measure::{mean_squared_error, psnr_db};
use pointreel::progress::Progress;
use pointreel::render::AnyRenderer;
use pointreel::scene::{CameraPath, Keyframe, Style};
use pointreel::sequence::Sequence;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;
use std::process::Command;

const SIZE_PX: [u32; 2] = [96, 64];

static NO_OPTIONS: ComposeOptions = ComposeOptions::NONE;

/// Seven images around the demo at 30 fps, one per frame of it.
fn turntable(style: &Style) -> CameraPath {
    let headless = headless(AnyRenderer::cpu());
    let (_, camera) = near_by(&headless, style);
    CameraPath::turntable(camera, 1.0, [7.0, 30.0], [3.0, 1.0]).unwrap()
}

fn video<'a>(path: &'a CameraPath, style: &'a Style) -> Video<'a> {
    Video {
        path,
        style,
        options: &NO_OPTIONS,
        size: PictureSize::opaque(SIZE_PX),
        per_second: 30.0,
        speed: 1.0,
    }
}

/// Writes a video of the demo; the frames that it shows.
fn export(video: &Video<'_>, output: &Path) -> Vec<usize> {
    let mut shown = Vec::new();
    let mut headless = headless(AnyRenderer::cpu());
    let failed = export_video(&mut headless, video, output, &Progress::default(), &mut |picture| {
        assert_eq!(picture.done, shown.len() + 1);
        assert_eq!(picture.total, video.picture_count());
        shown.push(picture.stats.index);
    });
    assert!(failed.unwrap().is_empty());
    shown
}

/// The images that a video should show.
fn expected(video: &Video<'_>) -> Vec<RgbaImage> {
    let mut headless = headless(AnyRenderer::cpu());
    (0..video.picture_count())
        .map(|picture| {
            let (camera, frame) = video.path.at(picture as f64 * video.speed / video.per_second);
            let frame = headless.frame(frame % 24, video.style).unwrap();
            draw_picture(
                &mut headless,
                &Picture {
                    frame: &frame,
                    camera: &camera,
                    style: video.style,
                    size: video.size,
                },
            )
            .unwrap()
        })
        .collect()
}

fn decoded(file: &Path) -> Vec<Frame> {
    let reader = BufReader::new(File::open(file).unwrap());
    match file.extension().unwrap().to_str() {
        Some("gif") => GifDecoder::new(reader).unwrap().into_frames(),
        _ => WebPDecoder::new(reader).unwrap().into_frames(),
    }
    .collect_frames()
    .unwrap()
}

fn delays_ms(frames: &[Frame]) -> Vec<u32> {
    frames
        .iter()
        .map(|frame| {
            let (numerator, denominator) = frame.delay().numer_denom_ms();
            numerator / denominator
        })
        .collect()
}

#[test]
fn a_webp_stores_every_frame_exactly() {
    let style = Style::default();
    let path = turntable(&style);
    for is_transparent in [false, true] {
        let mut video = video(&path, &style);
        video.size.is_transparent = is_transparent;
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.webp");
        assert_eq!(export(&video, &file), (3..10).collect::<Vec<_>>());
        let frames = decoded(&file);
        assert_eq!(delays_ms(&frames), [33, 34, 33, 33, 34, 33, 33]);
        let pictures: Vec<RgbaImage> = frames.into_iter().map(Frame::into_buffer).collect();
        let expected = expected(&video);
        assert_eq!(pictures.len(), expected.len());
        for (picture, expected) in pictures.iter().zip(&expected) {
            assert!(picture == expected, "transparent: {is_transparent}");
        }
    }
}

#[test]
fn a_gif_stores_every_frame_approximately() {
    let style = Style::default();
    let path = turntable(&style);
    let video = video(&path, &style);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.gif");
    export(&video, &file);
    let frames = decoded(&file);
    // 30 per second, in hundredths of a second.
    assert_eq!(delays_ms(&frames), [30, 40, 30, 30, 40, 30, 30]);
    for (frame, expected) in frames.iter().zip(expected(&video)) {
        let db = psnr_db(mean_squared_error(&expected, frame.buffer()).unwrap());
        // The cloud, which has the colours of a palette, fills the image.
        assert!(db >= 33.0, "{db} dB");
    }
}

#[test]
fn a_gif_of_few_colors_is_exact() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.gif");
    let style = Style::default();
    let path = turntable(&style);
    let mut sink = open_sink(&file, &video(&path, &style).stream()).unwrap();
    let pictures: Vec<RgbaImage> = (0..7)
        .map(|index| {
            RgbaImage::from_fn(SIZE_PX[0], SIZE_PX[1], |x, y| {
                let is_inside = (20..40).contains(&x) && (index..index + 9).contains(&y);
                image::Rgba(if is_inside {
                    [x as u8, 7, 250, 255]
                } else {
                    [9, 9, 9, 255]
                })
            })
        })
        .collect();
    // The last two are identical.
    for picture in pictures.iter().chain(pictures.last()) {
        sink.push(picture).unwrap();
    }
    sink.finish().unwrap();
    let frames = decoded(&file);
    assert_eq!(frames.len(), 8);
    for (frame, picture) in frames.iter().zip(pictures.iter().chain(pictures.last())) {
        assert!(frame.buffer() == picture);
    }
}

#[test]
fn png_files_are_renamed_together() {
    let style = Style::default();
    let path = turntable(&style);
    let mut video = video(&path, &style);
    video.size.is_transparent = true;
    let folder = tempfile::tempdir().unwrap();
    export(&video, &folder.path().join("new/folder"));
    export(&video, &folder.path().join("named/turn_{frame}.png"));
    for (index, expected) in expected(&video).iter().enumerate() {
        for name in [
            format!("new/folder/{index:04}.png"),
            format!("named/turn_{index:04}.png"),
        ] {
            assert!(image::open(folder.path().join(name)).unwrap().to_rgba8() == *expected);
        }
    }
    assert_eq!(fs::read_dir(folder.path().join("named")).unwrap().count(), 7);
}

#[test]
fn equal_input_makes_equal_bytes() {
    let style = Style::default();
    let path = turntable(&style);
    let video = video(&path, &style);
    let folder = tempfile::tempdir().unwrap();
    for extension in ["gif", "webp"] {
        let files = ["a", "b"].map(|name| folder.path().join(format!("{name}.{extension}")));
        let bytes = files.map(|file| {
            export(&video, &file);
            fs::read(file).unwrap()
        });
        assert!(bytes[0] == bytes[1], "{extension}");
    }
}

fn ffmpeg_is_there() -> bool {
    Command::new("ffmpeg").arg("-version").output().is_ok()
}

#[test]
fn a_cancelled_video_leaves_nothing() {
    let style = Style::default();
    let path = turntable(&style);
    let video = video(&path, &style);
    let folder = tempfile::tempdir().unwrap();
    let mut names = vec!["a.gif", "a.webp", "folder", "more/{frame}.png"];
    names.extend(ffmpeg_is_there().then_some("a.mp4"));
    for name in names {
        let mut headless = headless(AnyRenderer::cpu());
        let output = folder.path().join(name);
        let progress = Progress::default();
        let cancelled = export_video(&mut headless, &video, &output, &progress, &mut |picture| {
            if picture.done == 5 {
                progress.cancel();
            }
        });
        assert!(matches!(cancelled, Err(ExportError::Cancelled)), "{name}");
        let left: Vec<_> = fs::read_dir(folder.path()).unwrap().collect();
        assert!(left.is_empty(), "{name}: {left:?}");
    }
    // An existing file stays unchanged.
    let retained = folder.path().join("kept.gif");
    fs::write(&retained, "before").unwrap();
    let mut headless = headless(AnyRenderer::cpu());
    let progress = Progress::default();
    progress.cancel();
    let cancelled = export_video(&mut headless, &video, &retained, &progress, &mut |_| {});
    assert!(cancelled.is_err());
    assert_eq!(fs::read(&retained).unwrap(), b"before");
}

#[test]
fn an_mp4_is_made_by_ffmpeg() {
    let style = Style::default();
    let path = turntable(&style);
    let video = video(&path, &style);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.mp4");
    if !ffmpeg_is_there() {
        let mut headless = headless(AnyRenderer::cpu());
        let error = export_video(&mut headless, &video, &file, &Progress::default(), &mut |_| {});
        assert!(error.unwrap_err().to_string().contains("apt-get install ffmpeg"));
        return;
    }
    export(&video, &file);
    let raw = Command::new("ffmpeg")
        .args(["-loglevel", "error", "-i"])
        .arg(&file)
        .args(["-f", "rawvideo", "-pix_fmt", "rgba", "-"])
        .output()
        .unwrap();
    let expected = expected(&video);
    let picture_bytes = expected[0].as_raw().len();
    assert_eq!(raw.stdout.len(), expected.len() * picture_bytes);
    for (bytes, expected) in raw.stdout.chunks(picture_bytes).zip(&expected) {
        let picture = RgbaImage::from_raw(SIZE_PX[0], SIZE_PX[1], bytes.to_vec()).unwrap();
        let db = psnr_db(mean_squared_error(expected, &picture).unwrap());
        // Half of the chroma resolution is gone.
        assert!(db >= 28.0, "{db} dB");
    }
    // Players start before they have received all of it: the index precedes the images.
    let bytes = fs::read(&file).unwrap();
    let place = |name: &[u8]| bytes.windows(4).position(|four| four == name).unwrap();
    assert!(place(b"moov") < place(b"mdat"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn formats_reject_unsupported_options() {
    let style = Style::default();
    let path = turntable(&style);
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str, change: &dyn Fn(&mut Video<'_>)| {
        let mut video = video(&path, &style);
        change(&mut video);
        let error = open_sink(&folder.path().join(name), &video.stream()).err();
        error.map_or_else(String::new, |error| error.to_string())
    };
    let odd = of("a.mp4", &|video| video.size.size_px = [95, 64]);
    assert!(odd.contains("95x64") && odd.contains("even edges"), "{odd}");
    let fast = of("a.gif", &|video| video.per_second = 60.0);
    assert!(fast.contains("at most 50"), "{fast}");
    let clear = of("a.gif", &|video| video.size.is_transparent = true);
    assert!(clear.contains("choose .webp"), "{clear}");
    let wide = of("a.webp", &|video| video.size.size_px = [16_384, 2]);
    assert!(wide.contains("1 to 16383"), "{wide}");
    let other = of("a.avi", &|_| {});
    assert!(other.contains("a.avi") && other.contains(".mp4"), "{other}");
    let one_name = of("a.png", &|_| {});
    assert!(one_name.contains("{frame}.png"), "{one_name}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_time_path_plays_backwards_holds_and_restarts() {
    let style = Style::default();
    let (_, camera) = near_by(&headless(AnyRenderer::cpu()), &style);
    let key = |time_s: f64, frame: f64| Keyframe { time_s, camera, frame };
    let keys = vec![
        key(0.0, 2.0),
        key(2.0, 0.0),
        key(4.0, 0.0),
        key(4.5, 22.0),
        key(6.5, 26.0),
    ];
    let path = CameraPath::new(keys, true).unwrap();
    let video = Video {
        per_second: 2.0,
        speed: 2.0,
        ..video(&path, &style)
    };
    let folder = tempfile::tempdir().unwrap();
    // One second of the path each.
    let shown = export(&video, &folder.path().join("a.webp"));
    assert_eq!(shown, [2, 1, 0, 0, 0, 23, 1, 2]);
}

#[test]
fn a_broken_frame_is_reported_and_the_previous_one_stays() {
    let style = Style::default();
    let demo = Sequence::demo();
    let sources = demo.entries().into_iter().map(|source| (*source).clone());
    let broken = demo.entry(4).path.clone();
    let sequence = Sequence::with_decoder(sources.collect(), move |source| {
        if source.path == broken {
            return Err("torn".into());
        }
        let index = demo.entries().iter().position(|known| known.path == source.path);
        demo.decode(index.unwrap()).map_err(Into::into)
    });
    let path = turntable(&style);
    let folder = tempfile::tempdir().unwrap();
    let mut shown = Vec::new();
    let failed = export_video(
        &mut headless_of(sequence, AnyRenderer::cpu()),
        &video(&path, &style),
        &folder.path().join("a.gif"),
        &Progress::default(),
        &mut |picture| shown.push(picture.stats.index),
    );
    assert_eq!(shown, [3, 3, 5, 6, 7, 8, 9]);
    let failed: Vec<usize> = failed.unwrap().iter().map(|(frame, _)| *frame).collect();
    assert_eq!(failed, [4]);
}
