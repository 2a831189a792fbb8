//! `pointreel compare` as a user calls it: its results for images with known errors, and for files that are not images.

use image::{DynamicImage, GrayImage, ImageBuffer, Luma, Rgb, Rgba, RgbaImage};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn compare(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .arg("compare")
        .args(arguments)
        .env("RUST_BACKTRACE", "0")
        .output()
        .unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A folder with images.
struct Pictures(tempfile::TempDir);

impl Pictures {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn with(&self, name: &str, image: impl Into<DynamicImage>) -> PathBuf {
        let path = self.path(name);
        image.into().save(&path).unwrap();
        path
    }

    fn with_bytes(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, bytes).unwrap();
        path
    }
}

fn solid(size: [u32; 2], value: u8) -> RgbaImage {
    RgbaImage::from_pixel(size[0], size[1], Rgba([value, value, value, 255]))
}

fn answer_in_json(reference: &Path, test: &Path) -> Value {
    let output = compare(&[text(reference), text(test), "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn equal_images_have_no_difference() {
    let pictures = Pictures::new();
    let path = pictures.with("a.png", solid([20, 12], 90));
    let answer = answer_in_json(&path, &path);
    let expected = serde_json::json!({
        "reference": text(&path), "test": text(&path), "size_px": [20, 12],
        "psnr_db": null, "flip_mean": 0.0, "flip_max": 0.0, "ssim": 1.0,
        "different_pixels": 0, "different_share": 0.0, "largest_difference": 0,
    });
    assert_eq!(answer, expected);
    let output = compare(&[text(&path), text(&path)]);
    assert_eq!(stderr(&output), "");
    let table = String::from_utf8(output.stdout).unwrap();
    for expected in [
        "PSNR                inf",
        "SSIM                1.00000",
        "0.00 % (0 of 240)",
    ] {
        assert!(table.contains(expected), "{table}");
    }
}

#[test]
fn known_images_have_known_errors() {
    let pictures = Pictures::new();
    let reference = pictures.with("reference.png", solid([20, 15], 100));
    // Every pixel 10 steps brighter: 20 log10(255 / 10), and SSIM in closed form.
    let brighter = pictures.with("brighter.png", solid([20, 15], 110));
    let answer = answer_in_json(&reference, &brighter);
    let number = |answer: &Value, name: &str| answer[name].as_f64().unwrap();
    assert!((number(&answer, "psnr_db") - 28.130_8).abs() < 1e-4, "{answer}");
    let similarity = (2.0 * 100.0 * 110.0 + 6.5025) / (100.0 * 100.0 + 110.0 * 110.0 + 6.5025);
    assert!((number(&answer, "ssim") - similarity).abs() < 1e-9, "{answer}");
    assert_eq!(answer["different_pixels"], 300);
    assert_eq!(answer["largest_difference"], 10);
    // Three pixels of 300.
    let mut dotted = solid([20, 15], 100);
    for x in 4..7 {
        dotted.put_pixel(x, 7, Rgba([100, 20, 100, 255]));
    }
    let dotted = pictures.with("dotted.png", dotted);
    let answer = answer_in_json(&reference, &dotted);
    assert_eq!(number(&answer, "different_share"), 0.01);
    assert_eq!(answer["largest_difference"], 80);
    let table = String::from_utf8(compare(&[text(&reference), text(&dotted)]).stdout).unwrap();
    assert!(table.contains("1.00 % (3 of 300)"), "{table}");
    assert!(table.contains("80 of 255"), "{table}");
}

#[test]
fn images_smaller_than_the_window_have_no_ssim() {
    let pictures = Pictures::new();
    let path = pictures.with("small.png", solid([10, 40], 7));
    assert_eq!(answer_in_json(&path, &path)["ssim"], Value::Null);
    let table = String::from_utf8(compare(&[text(&path), text(&path)]).stdout).unwrap();
    assert!(table.contains("none (below 11x11 pixels)"), "{table}");
}

#[test]
fn other_channels_and_depths_are_read_as_8_bit_rgba() {
    let pictures = Pictures::new();
    let size = [16, 16];
    let reference = pictures.with("rgba.png", solid(size, 128));
    let gray = pictures.with("gray.png", GrayImage::from_pixel(16, 16, Luma([128])));
    let rgb = pictures.with("rgb.png", image::RgbImage::from_pixel(16, 16, Rgb([128; 3])));
    let sixteen = ImageBuffer::<Luma<u16>, _>::from_pixel(16, 16, Luma([128 * 257]));
    let sixteen = pictures.with("sixteen.png", sixteen);
    let clear = pictures.with("clear.png", RgbaImage::from_pixel(16, 16, Rgba([128, 128, 128, 9])));
    for (test, warning) in [
        (gray, ""),
        (rgb, ""),
        (sixteen, "sixteen.png has 16 bits a channel"),
        (clear, "clear.png is not opaque"),
    ] {
        let output = compare(&[text(&reference), text(&test), "--json"]);
        assert!(output.status.success(), "{}", stderr(&output));
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(answer["psnr_db"], Value::Null, "{}", test.display());
        assert!(stderr(&output).contains(warning), "{}", stderr(&output));
        assert_eq!(stderr(&output).is_empty(), warning.is_empty());
    }
}

#[test]
fn a_heatmap_shows_where_images_differ() {
    let pictures = Pictures::new();
    let reference = pictures.with("reference.png", solid([60, 40], 30));
    let mut test = solid([60, 40], 30);
    for (x, y) in (40..50).flat_map(|x| (10..20).map(move |y| (x, y))) {
        test.put_pixel(x, y, Rgba([250, 250, 250, 255]));
    }
    let test = pictures.with("test.png", test);
    let heatmap = pictures.with_bytes("heatmap.png", b"what stood here before");
    let arguments = [text(&reference), text(&test), "--heatmap", text(&heatmap)];
    let output = compare(&arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    let map = image::open(&heatmap).unwrap().into_rgba8();
    assert_eq!(map.dimensions(), (60, 40));
    assert_eq!(map.get_pixel(5, 30).0, [0, 0, 4, 255]);
    let [red, green, _, alpha] = map.get_pixel(45, 15).0;
    assert!(red > 240 && green > 100 && alpha == 255, "{red} {green}");
    // No other files are left, and only JSON goes to stdout.
    assert_eq!(fs::read_dir(pictures.0.path()).unwrap().count(), 3);
    let output = compare(&[arguments.as_slice(), &["--json"]].concat());
    assert!(serde_json::from_slice::<Value>(&output.stdout).is_ok());
}

/// A PNG file of 8-bit RGBA that has only a header, with this size.
fn header_alone(width: u32, height: u32) -> Vec<u8> {
    let mut chunk = b"IHDR".to_vec();
    chunk.extend(width.to_be_bytes());
    chunk.extend(height.to_be_bytes());
    chunk.extend([8, 6, 0, 0, 0]);
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    file.extend((chunk.len() as u32 - 4).to_be_bytes());
    let sum = crc32fast::hash(&chunk);
    file.extend(&chunk);
    file.extend(sum.to_be_bytes());
    // Decoders search for the first data before they report the size.
    file.extend([0, 0, 0, 0]);
    file.extend(b"IDAT");
    file.extend(crc32fast::hash(b"IDAT").to_be_bytes());
    file
}

#[test]
fn failures_name_the_file_and_exit_with_1() {
    let pictures = Pictures::new();
    let good = pictures.with("good.png", solid([20, 20], 1));
    let other = pictures.with("other.png", solid([20, 21], 1));
    let whole = fs::read(&good).unwrap();
    let cut = pictures.with_bytes("cut.png", &whole[..whole.len() / 2]);
    let curved = pictures.with_bytes("bent.png", b"\x89PNG\r\n\x1a\nand then nothing of the kind");
    let words = pictures.with_bytes("words.png", b"a letter");
    let empty = pictures.with_bytes("empty.png", b"");
    let huge = pictures.with_bytes("huge.png", &header_alone(60_000, 60_000));
    let endless = pictures.with_bytes("endless.png", &header_alone(0x7fff_ffff, 0x7fff_ffff));
    let lying = pictures.with_bytes("lying.png", &header_alone(4000, 4000));
    let missing = pictures.path("missing.png");
    let nowhere = pictures.path("no/such/folder/map.png");
    let folder = pictures.0.path();
    let cases: [(&[&Path], &[&str]); 12] = [
        (&[&good, &other], &["good.png has 20x20", "other.png has 20x21"]),
        (&[&missing, &good], &["missing.png does not exist"]),
        (&[&good, &missing], &["missing.png does not exist"]),
        (&[&good, folder], &["is not a file"]),
        (&[&good, &words], &["words.png is not a PNG image"]),
        (&[&good, &empty], &["empty.png is not a PNG image"]),
        (&[&good, &cut], &["cut.png is a broken PNG image"]),
        (&[&good, &curved], &["bent.png is a broken PNG image"]),
        (
            &[&huge, &good],
            &["huge.png claims 60000x60000 pixels", "at most 33554432"],
        ),
        (&[&endless, &good], &["endless.png claims", "at most 33554432"]),
        (&[&lying, &good], &["lying.png is a broken PNG image"]),
        (&[&good, &good, &nowhere], &["map.png cannot be written"]),
    ];
    for (paths, expected) in cases {
        let mut arguments: Vec<&str> = paths.iter().copied().map(text).collect();
        if arguments.len() == 3 {
            arguments.insert(2, "--heatmap");
        }
        let output = compare(&arguments);
        let stderr = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {stderr}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        assert_eq!(stderr.lines().count(), 1, "{arguments:?}: {stderr}");
        assert!(!stderr.contains("panicked"), "{stderr}");
        for part in expected {
            assert!(stderr.contains(part), "{arguments:?}: {stderr}");
        }
    }
}

#[test]
fn a_heatmap_does_not_overwrite_the_compared_images() {
    let pictures = Pictures::new();
    let path = pictures.with("a.png", solid([20, 20], 1));
    let before = fs::read(&path).unwrap();
    // The same file under another name.
    let roundabout = pictures.0.path().join("./a.png");
    for (target, expected) in [
        (text(&roundabout), "is compared itself"),
        (text(pictures.0.path()), "is not a file"),
    ] {
        let output = compare(&[text(&path), text(&path), "--heatmap", target]);
        assert_eq!(output.status.code(), Some(1));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
    assert_eq!(fs::read(&path).unwrap(), before);
}

#[test]
fn wrong_usage_exits_with_2() {
    for arguments in [&[] as &[&str], &["one.png"], &["a.png", "b.png", "--heatmap"]] {
        assert_eq!(compare(arguments).status.code(), Some(2), "{arguments:?}");
    }
}
