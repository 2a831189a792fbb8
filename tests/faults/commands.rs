//! The commands that faults are tried on, and the files they work with.

use std::fs;
use std::io::Write as _;
use std::path::Path;

/// Command lines within the folder of files: one row per path through the readers and writers.
pub(crate) const CASES: &[&str] = &[
    "info cube.ply",
    "info --json cube.reel",
    "check frames",
    "check cube.reel",
    "check cube.zip",
    "convert frames --overwrite old.reel",
    "convert cube.las --overwrite old.ply",
    "convert cube.xyz --overwrite old.las",
    "convert cube.pcd new.laz",
    "convert cube.laz new.ply",
    "convert cube.ply new.npy",
    "convert cube.zip new.reel",
    "convert cube.reel new_frames",
    "compare-frames frames --from 0 --to 1",
    "compare old.png picture.png --heatmap new.png",
    "render cube.reel --renderer cpu --size 16x12 -o old.png",
    "render cube.ply --renderer cpu --size 16x12 -o new.tif",
    "render cube.ply --renderer cpu --size 16x12 -o new.webp",
    "render frames --renderer cpu --size 16x12 --video new.gif",
    "render frames --renderer cpu --size 16x12 --video new.webp",
    "render frames --renderer cpu --size 16x12 --video new_{frame}.png",
];

/// Fills `folder` with the files that the commands name. Files that are written over begin as other ones.
pub(crate) fn make_files(folder: &Path) {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let ply = data.join("cube_little_endian.ply");
    fs::copy(&ply, folder.join("cube.ply")).unwrap();
    fs::copy(data.join("cube_compressed.pcd"), folder.join("cube.pcd")).unwrap();
    fs::copy(data.join("cube.xyz"), folder.join("cube.xyz")).unwrap();
    fs::create_dir(folder.join("frames")).unwrap();
    let mut zip = zip::ZipWriter::new(fs::File::create(folder.join("cube.zip")).unwrap());
    for frame in 0..3 {
        let name = format!("{frame}.ply");
        fs::copy(&ply, folder.join("frames").join(&name)).unwrap();
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(&fs::read(&ply).unwrap()).unwrap();
    }
    zip.finish().unwrap();
    let picture = |color: [u8; 3]| image::RgbImage::from_pixel(16, 12, image::Rgb(color));
    picture([9, 9, 9]).save(folder.join("old.png")).unwrap();
    picture([10, 9, 9]).save(folder.join("picture.png")).unwrap();
    for made in ["cube.las", "cube.laz", "cube.reel"] {
        super::run::succeed(folder, &["convert", "cube.ply", made]);
    }
    for (from, old) in [
        ("cube.reel", "old.reel"),
        ("cube.ply", "old.ply"),
        ("cube.las", "old.las"),
    ] {
        fs::copy(folder.join(from), folder.join(old)).unwrap();
    }
}
