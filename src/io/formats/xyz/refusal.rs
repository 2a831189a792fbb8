//! Numbers in rows that are not points, where the columns have no names.

use super::rows::{Kind, ParsedRows};
use crate::io::columns::likeness::{Poses, is_camera_matrix, is_grid, poses};
use crate::io::error::{Fault, Place};

/// Fails for poses of cameras and for grids of values. `line` is the line of the first row.
pub(super) fn refuse(rows: &ParsedRows, kinds: &[Kind], line: usize) -> Result<(), Fault> {
    let are_numbers = kinds.iter().all(|kind| matches!(kind, Kind::Number | Kind::Required));
    if !are_numbers {
        return Ok(());
    }
    let columns = &rows.columns;
    let problem = if let Some(found) = poses(columns) {
        let [x, y, z] = match found {
            Poses::Stamped => [1, 2, 3],
            Poses::ThreeByFour | Poses::FourByFour => [3, 7, 11],
        };
        format!(
            "each row is {}: this is a trajectory, not a point cloud. Name it with --poses next to the frames, or read \
             its positions as points with --columns x={x},y={y},z={z}",
            found.row()
        )
    } else if is_camera_matrix(columns) {
        "three rows of a camera matrix are not points: name the file with --intrinsics next to depth \
         images, or say which columns are coordinates, such as --columns x=0,y=1,z=2"
            .to_owned()
    } else if is_grid(columns) {
        format!(
            "{} rows of {} numbers of one kind are a grid or an image without a header, not a point per row: put the \
             lines ncols, nrows, xllcorner, yllcorner and cellsize before it (ESRI ASCII grid), or say which columns \
             are coordinates, such as --columns x=0,y=1,z=2",
            rows.len(),
            columns.len()
        )
    } else {
        return Ok(());
    };
    Err(Fault::new(Place::Line(line), problem))
}
