//! Normals in a companion file of the points that they belong to.
//!
//! Tools of the Point Cloud Library write `7.pcd` and `7_normal.pcd`: the same number of rows in each, coordinates in
//! one, normals in the other. The contents of a file are determined from its header alone, so that a folder of such
//! files costs one small read per file.

use crate::cloud::RawCloud;
use crate::io::columns::attributes;
use crate::io::contents::Part;
use crate::io::error::{Fault, IoError};
use crate::io::files::watched;
use crate::io::format::Format;
use crate::io::formats::xyz;
use crate::io::list::first_bytes;
use crate::io::meshes::mesh;
use crate::io::options::ReadOptions;
use crate::io::read::read_part_observed;
use crate::progress::Progress;
use std::io::Read as _;
use std::path::Path;

/// Max bytes read of a file to determine its content: headers have a few hundred bytes.
const HEAD_BYTES: u64 = 1 << 16;

/// Number of examined lines of a text.
const TEXT_LINES: usize = 8;

/// Contents of the rows of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RowContents {
    /// They have coordinates.
    Points,
    /// They have normals and no coordinates.
    Normals,
    /// They have neither.
    Other,
}

/// Returns the contents of the rows of the file at `path`; `None` if its beginning does not determine them.
pub(crate) fn rows_of(path: &Path) -> Option<RowContents> {
    // Reading a pipe may never end.
    if !path.metadata().ok()?.is_file() {
        return None;
    }
    let mut head = Vec::new();
    let file = crate::regular_file::open(path).ok()?;
    file.take(HEAD_BYTES).read_to_end(&mut head).ok()?;
    let format = Format::detect(path, &head)?;
    if format == xyz::FORMAT {
        return rows_of_text(&head);
    }
    let columns = format.codec()?.columns.as_ref()?;
    let names = (columns.point_names)(&head)?;
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Some(if attributes::has_positions(&names) {
        RowContents::Points
    } else if attributes::has_normals(&names) {
        RowContents::Normals
    } else {
        RowContents::Other
    })
}

/// Text whose lines have fewer than three numbers holds no points. One such line is not conclusive: it may count the
/// points.
fn rows_of_text(head: &[u8]) -> Option<RowContents> {
    let is_separator = |byte: &u8| byte.is_ascii_whitespace() || b",;".contains(byte);
    let numbers_in = |line: &[u8]| {
        let words = line.split(is_separator).filter(|word| !word.is_empty());
        let numbers = words.map(|word| std::str::from_utf8(word).ok()?.parse::<f64>().ok());
        numbers.collect::<Option<Vec<f64>>>().map_or(0, |n| n.len())
    };
    let lines = head.split(|&byte| byte == b'\n').map(numbers_in);
    let counts: Vec<usize> = lines.filter(|&count| count > 0).take(TEXT_LINES).collect();
    (counts.len() > 1 && counts.iter().all(|&count| count < 3)).then_some(RowContents::Other)
}

/// Reads a whole file like [`crate::io::read_part_observed`], with the normals in the file at `normals`. The file's own
/// normals take precedence. Normals that cannot be read, or whose number differs from the points', are skipped with a
/// warning.
pub(crate) fn read_with_normals(
    path: &Path,
    normals: &Path,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<RawCloud, IoError> {
    // Normals belong to the vertices: a mesh is sampled once it has them.
    let mut cloud = read_part_observed(path, &Part::Whole, &options.of_meshes(), progress)?;
    if cloud.attributes.normals.is_none() {
        join(&mut cloud, path, normals, options, progress);
    }
    if progress.is_cancelled() {
        return Err(IoError::Cancelled { path: path.to_owned() });
    }
    if let Some(format) = Format::detect(path, &first_bytes(path)?)
        && let Some(count) = options.of_format(format).sample_count
        && !cloud.faces.is_empty()
    {
        mesh::sample(&mut cloud, count, options).map_err(|fault| fault.of(path, format))?;
    }
    Ok(cloud)
}

fn join(cloud: &mut RawCloud, path: &Path, normals: &Path, options: &ReadOptions, progress: &Progress) {
    let points = cloud.positions.len();
    let options = options.holding(cloud.byte_size());
    match read_normals(normals, &options, progress) {
        Ok(read) if read.len() == points => cloud.attributes.normals = Some(read),
        Ok(read) => cloud.warnings.push(format!(
            "{} has {} normals, but {} has {points} points: these normals are ignored, and estimated where they are \
             needed",
            normals.display(),
            read.len(),
            path.display()
        )),
        Err(error) => cloud.warnings.push(format!(
            "{error}; the points of {} are there without these normals",
            path.display()
        )),
    }
}

fn read_normals(path: &Path, options: &ReadOptions, progress: &Progress) -> Result<Vec<[f32; 3]>, IoError> {
    let bytes = watched::read_file(path, options.left_bytes(), progress)?;
    let options = options.holding(bytes.len());
    let unknown = || IoError::unknown(path, &bytes);
    let format = Format::detect(path, &bytes).ok_or_else(unknown)?;
    let columns = format.codec().and_then(|codec| codec.columns.as_ref());
    let normals = match columns {
        Some(columns) => (columns.normals)(&bytes, &options, progress),
        None => Err(Fault::header("normals are read from PLY and PCD")),
    };
    normals.map_err(|fault| fault.of(path, format))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::num::NonZeroUsize;

    const PCD: &str = "VERSION .7\nFIELDS normal_x normal_y normal_z curvature\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 \
        1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n0 0 1 9\n0 1 0 9\n";
    const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float nx\nproperty float ny\nproperty float \
        nz\nend_header\n0 0 1\n0 1 0\n";
    const POINTS: &str = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float \
        z\nend_header\n1 2 3\n4 5 6\n";
    const NORMALS: [[f32; 3]; 2] = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]];

    fn read_pair(points: &str, normals: &str) -> RawCloud {
        let folder = tempfile::tempdir().unwrap();
        let [path, sidecar] = ["a.ply", "a_normal.pcd"].map(|name| folder.path().join(name));
        fs::write(&path, points).unwrap();
        fs::write(&sidecar, normals).unwrap();
        let options = ReadOptions::default();
        read_with_normals(&path, &sidecar, &options, &Progress::default()).unwrap()
    }

    #[test]
    fn the_header_determines_what_rows_contain() {
        let folder = tempfile::tempdir().unwrap();
        let rows = |name: &str, text: &str| {
            let path = folder.path().join(name);
            fs::write(&path, text).unwrap();
            rows_of(&path)
        };
        assert_eq!(rows("a.pcd", PCD), Some(RowContents::Normals));
        assert_eq!(rows("a.ply", PLY), Some(RowContents::Normals));
        assert_eq!(rows("a.ply", POINTS), Some(RowContents::Points));
        assert_eq!(
            rows("a.ply", &POINTS.replace(" y\n", " ny\n")),
            Some(RowContents::Other)
        );
        let labels = PCD.replace("normal_z", "label");
        assert_eq!(rows("a.pcd", &labels), Some(RowContents::Other));
        assert_eq!(rows("a.txt", "1\n2\n3\n"), Some(RowContents::Other));
        assert_eq!(rows("a.txt", "2\n1 2 3\n4 5 6\n"), None, "counted points");
        assert_eq!(rows("a.txt", "x y z\n1 2 3\n"), None);
        assert_eq!(rows("a.ply", "ply\nformat ascii 1.0\nelement"), None, "not written yet");
        assert_eq!(rows("a.ply", ""), None);
        assert_eq!(rows_of(folder.path()), None);
        assert_eq!(rows_of(&folder.path().join("missing.ply")), None);
    }

    #[test]
    fn normals_of_any_format_are_joined() {
        for normals in [PCD, PLY] {
            let cloud = read_pair(POINTS, normals);
            assert_eq!(cloud.attributes.normals.as_deref(), Some(&NORMALS[..]));
            assert_eq!(cloud.positions.len(), 2);
            assert_eq!(cloud.warnings, [""; 0]);
        }
    }

    #[test]
    fn mismatched_normals_are_skipped_and_reported() {
        let fewer = PLY.replace("vertex 2", "vertex 1");
        let cut = PLY.replace("0 1 0\n", "0 1");
        for (normals, expected) in [
            (fewer.as_str(), "has 1 normals, but"),
            (cut.as_str(), "vertex 1: the file ends here"),
            (POINTS, "expected nx, ny and nz"),
            ("", "missing line `DATA`"),
        ] {
            let cloud = read_pair(POINTS, normals);
            assert_eq!((cloud.positions.len(), cloud.attributes.normals), (2, None));
            let [warning] = cloud.warnings.as_slice() else {
                panic!("{:?}", cloud.warnings)
            };
            assert!(warning.contains(expected), "{warning}");
            assert!(warning.contains("a_normal.pcd"), "{warning}");
        }
    }

    #[test]
    fn points_with_normals_retain_them() {
        let own = POINTS
            .replace(
                "property float z\n",
                "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n",
            )
            .replace("1 2 3\n4 5 6\n", "1 2 3 1 0 0\n4 5 6 1 0 0\n");
        let cloud = read_pair(&own, PCD);
        assert_eq!(cloud.attributes.normals, Some(vec![[1.0, 0.0, 0.0]; 2]));
    }

    #[test]
    fn a_mesh_is_sampled_with_the_normals_of_its_vertices() {
        let folder = tempfile::tempdir().unwrap();
        let [path, sidecar] = ["a.ply", "a_normal.ply"].map(|name| folder.path().join(name));
        let mesh = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        fs::write(&path, mesh).unwrap();
        fs::write(&sidecar, PLY.replace("vertex 2", "vertex 3") + "0 1 0\n").unwrap();
        let options = ReadOptions::default().with_sample_count(NonZeroUsize::new(50));
        let cloud = read_with_normals(&path, &sidecar, &options, &Progress::default()).unwrap();
        assert_eq!((cloud.positions.len(), cloud.faces.len()), (50, 0));
        // The triangle lies in a plane perpendicular to Z; the normals of its vertices lean towards Y.
        assert!(cloud.attributes.normals.unwrap().iter().all(|normal| normal[1] > 0.0));
        assert_eq!(cloud.warnings, [""; 0]);
    }
}
