//! The example of a live sender in Python (`scripts/send_depth.py`): its depth and colour images are drawn.

use super::cli::{pointreel, stderr, text};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// Ends the sender with the test.
struct Sender(Child);

impl Drop for Sender {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn depth_and_color_images_of_a_python_program_are_drawn() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/send_depth.py");
    let child = Command::new("python3")
        .arg(script)
        .args(["--port", "0", "--frames", "500"])
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3, which scripts/install-system-packages.sh --with-tests installs");
    let mut sender = Sender(child);
    let mut line = String::new();
    let mut said = BufReader::new(sender.0.stdout.take().unwrap());
    said.read_line(&mut line).unwrap();
    let url = line.trim().strip_prefix("pointreel ").unwrap().to_owned();
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("ball.png");
    // A second viewer is served after the first.
    for _ in 0..2 {
        let size = ["--renderer", "cpu", "--size", "160x120", "--up", "-y"];
        let output = pointreel(&[&["render", &url, "-o", text(&image)], &size[..]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        let drawn = image::open(&image).unwrap().to_rgb8();
        let count = |is_of: fn([u8; 3]) -> bool| drawn.pixels().filter(|pixel| is_of(pixel.0)).count();
        let of_ball = count(|[red, green, blue]| red > green && green > blue && red > 100);
        let of_wall = count(|[red, _, blue]| red < blue && red > 50);
        assert!(
            of_ball > 1000 && of_wall > 4000,
            "{of_ball} orange and {of_wall} grey pixels"
        );
    }
}
