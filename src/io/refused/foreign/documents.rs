//! Web pages, pointers, images, videos, documents and archives: files that were meant to be something else.

use super::looks;
use super::row::{Foreign, ROW};
use crate::io::format::Magic;

const IMAGE_ADVICE: &str = "a single image has no depth: name the folder of a recording of depth images, or of images \
    with their cameras (COLMAP, Metashape, RealityCapture), or make a point cloud with photogrammetry first";

pub(super) const ROWS: &[Foreign] = &[
    Foreign {
        name: "a web page, not a point cloud",
        advice: "the download gave an error or sign-in page instead of the file: download it again, signed in, from \
            the \
            link of the file itself",
        looks_like: Some(looks::web_page),
        extensions: &["html", "htm"],
        ..ROW
    },
    Foreign {
        name: "an error message of a file store, not a point cloud",
        advice: "the download was refused (see the text in the file): download it again with a valid link",
        looks_like: Some(looks::store_error),
        ..ROW
    },
    Foreign {
        name: "a Git LFS pointer",
        advice: "the file itself was not downloaded: run `git lfs pull` in the repository",
        magic: &[Magic::start(b"version https://git-lfs.github.com/spec/")],
        ..ROW
    },
    Foreign {
        name: "a git-annex pointer",
        advice: "the file itself was not downloaded: run `git annex get FILE` (or `datalad get FILE`)",
        looks_like: Some(looks::annex_pointer),
        ..ROW
    },
    Foreign {
        name: "metadata that macOS keeps of another file (AppleDouble)",
        advice: "open the file of the same name without `._`",
        magic: &[Magic::start(b"\x00\x05\x16\x07\x00\x02\x00\x00")],
        ..ROW
    },
    Foreign {
        name: "a TIFF image (or GeoTIFF elevation)",
        writer: "GIS programs and cameras",
        advice: "convert an elevation to points with `gdal_translate -of XYZ FILE.tif points.xyz`; depth images are \
            read as a folder",
        magic: &[
            Magic::start(b"II\x2a\x00"),
            Magic::start(b"MM\x00\x2a"),
            Magic::start(b"II\x2b\x00"),
            Magic::start(b"MM\x00\x2b"),
        ],
        extensions: &["tif", "tiff"],
        ..ROW
    },
    Foreign {
        name: "an image",
        advice: IMAGE_ADVICE,
        magic: &[
            Magic::start(b"\x89PNG\r\n\x1a\n"),
            // Including the fourth byte: the first three may also begin plausible coordinates.
            Magic::start(b"\xff\xd8\xff\xe0"),
            Magic::start(b"\xff\xd8\xff\xe1"),
            Magic::start(b"\xff\xd8\xff\xe2"),
            Magic::start(b"\xff\xd8\xff\xdb"),
            Magic::start(b"\xff\xd8\xff\xee"),
            Magic::start(b"GIF87a"),
            Magic::start(b"GIF89a"),
            Magic::start(b"\x76\x2f\x31\x01"),
            Magic::start(b"#?RADIANCE"),
        ],
        looks_like: Some(|name, bytes| looks::webp(name, bytes) || looks::heif(name, bytes)),
        extensions: &["png", "jpg", "jpeg", "webp", "gif", "bmp", "exr", "heic", "hdr"],
        ..ROW
    },
    Foreign {
        name: "a video",
        advice: "a video has no depth: extract its images (`ffmpeg -i FILE images/%05d.png`) and reconstruct them, for \
            example with COLMAP; of depth cameras, record MKV (Azure Kinect) or a ROS bag",
        magic: &[Magic::start(b"\x1a\x45\xdf\xa3")],
        looks_like: Some(|name, bytes| looks::mpeg_4(name, bytes) || looks::avi(name, bytes)),
        extensions: &["mp4", "mov", "m4v", "avi", "mkv", "webm"],
        ..ROW
    },
    Foreign {
        name: "a program",
        advice: "expected a file of data: is it another one of the folder?",
        magic: &[Magic::start(b"\x7fELF"), Magic::start(b"MZ\x90\x00")],
        ..ROW
    },
    Foreign {
        name: "a PDF document",
        advice: "open the data that the document describes",
        magic: &[Magic::start(b"%PDF-")],
        extensions: &["pdf"],
        ..ROW
    },
    Foreign {
        name: "an Office document",
        writer: "Word, PowerPoint and LibreOffice",
        advice: "save the numbers in it as CSV",
        extensions: &["docx", "pptx", "doc"],
        members: &["[content_types].xml"],
        ..ROW
    },
    Foreign {
        name: "a file compressed with bzip2",
        advice: "unpack it with `bunzip2 FILE`, or `tar xf FILE` for a .tar.bz2",
        magic: &[
            Magic::start(b"BZh1"),
            Magic::start(b"BZh2"),
            Magic::start(b"BZh3"),
            Magic::start(b"BZh4"),
            Magic::start(b"BZh5"),
            Magic::start(b"BZh6"),
            Magic::start(b"BZh7"),
            Magic::start(b"BZh8"),
            Magic::start(b"BZh9"),
        ],
        extensions: &["bz2"],
        ..ROW
    },
    Foreign {
        name: "a file compressed with xz",
        advice: "unpack it with `unxz FILE`, or `tar xf FILE` for a .tar.xz",
        magic: &[Magic::start(b"\xfd7zXZ\x00")],
        extensions: &["xz"],
        ..ROW
    },
    Foreign {
        name: "a file compressed with zstd",
        advice: "unpack it with `zstd -d FILE`, or `tar xf FILE` for a .tar.zst",
        magic: &[Magic::start(b"\x28\xb5\x2f\xfd")],
        extensions: &["zst", "zstd"],
        ..ROW
    },
    Foreign {
        name: "a file compressed with lz4",
        advice: "unpack it with `lz4 -d FILE`",
        magic: &[Magic::start(b"\x04\x22\x4d\x18")],
        extensions: &["lz4"],
        ..ROW
    },
    Foreign {
        name: "a 7-Zip archive",
        advice: "unpack it with `7z x FILE` and open the folder",
        magic: &[Magic::start(b"7z\xbc\xaf\x27\x1c")],
        extensions: &["7z"],
        ..ROW
    },
    Foreign {
        name: "a RAR archive",
        advice: "unpack it with `unrar x FILE` and open the folder",
        magic: &[Magic::start(b"Rar!\x1a\x07")],
        extensions: &["rar"],
        ..ROW
    },
];
