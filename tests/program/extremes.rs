//! Files whose coordinates no image can be drawn of: an error that names the file, the limits and the remedy.

use std::fs;
use std::path::Path;
use std::process::Command;

/// 60 points of a helix, times a factor.
fn write_helix(path: &Path, factor: f64) {
    let line = |index: u32| {
        let angle = f64::from(index) * 0.3;
        let [x, y, z] = [angle.cos(), angle.sin(), f64::from(index) * 0.05].map(|number| number * factor);
        format!("{x:e} {y:e} {z:e}\n")
    };
    fs::write(path, (0..60).map(line).collect::<String>()).unwrap();
}

#[test]
fn coordinates_beyond_single_precision_are_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    for (factor, times_as_large) in [(1e-30, "1e30"), (1e30, "1e-30"), (1e38, "1e-38")] {
        let cloud = folder.path().join("helix.xyz");
        let image = folder.path().join("helix.png");
        write_helix(&cloud, factor);
        let output = Command::new(env!("CARGO_BIN_EXE_pointreel"))
            .args(["render", cloud.to_str().unwrap(), "-o", image.to_str().unwrap()])
            .args(["--size", "32x32", "--renderer", "cpu"])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && !image.exists(), "× {factor:e}: {said}");
        for part in [
            "helix.xyz",
            "1e-12 to 1e12",
            &format!("{times_as_large} times as large"),
        ] {
            assert!(said.contains(part), "× {factor:e}: no {part:?} in {said}");
        }
    }
}

#[test]
fn coordinates_of_nine_orders_up_and_down_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let images = [1e-9, 1.0, 1e9].map(|factor| {
        let cloud = folder.path().join("helix.xyz");
        write_helix(&cloud, factor);
        let output = Command::new(env!("CARGO_BIN_EXE_pointreel"))
            .args([
                "render",
                cloud.to_str().unwrap(),
                "-o",
                "-",
                "--primitive",
                "point",
                "--up",
                "z",
            ])
            .args(["--size", "64x48", "--renderer", "cpu", "--bg", "#000000"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        image::load_from_memory(&output.stdout).unwrap().to_rgba8()
    });
    let lit = |image: &image::RgbaImage| image.pixels().filter(|pixel| *pixel != image.get_pixel(0, 0)).count();
    assert!(lit(&images[1]) > 60, "{}", lit(&images[1]));
    for image in &images {
        assert!(
            lit(image).abs_diff(lit(&images[1])) < 5,
            "{} {}",
            lit(image),
            lit(&images[1])
        );
    }
}
