//! Broken faces of a mesh: their number, the reason for the first, and the position where the file ends within them.
//!
//! A few faces with vertices that do not exist are skipped, as are those after the end of a truncated file. Where many
//! are broken, the faces belong to another file: then all are ignored, and the points are a plain cloud.

use crate::cloud::RawCloud;
use crate::io::error::Fault;

/// Inverse of the maximum fraction of broken faces: if more than one in this number is broken, none is used.
const MAX_BROKEN: usize = 4;

/// Broken faces found so far.
#[derive(Debug, Default)]
pub(in crate::io) struct BrokenFaces {
    /// Number of examined faces.
    all: usize,
    broken: usize,
    first: Option<Fault>,
    /// Why nothing was read from some face on.
    end: Option<Fault>,
}

impl BrokenFaces {
    /// Counts a face, which cannot be used for this reason.
    pub(in crate::io) fn count(&mut self, fault: Option<Fault>) {
        self.all += 1;
        self.broken += usize::from(fault.is_some());
        self.first = self.first.take().or(fault);
    }

    /// Nothing is read from here on.
    pub(in crate::io) fn end(&mut self, fault: Fault) {
        self.end.get_or_insert(fault);
    }

    /// Adds usable faces to `cloud`, and warns about the others.
    pub(in crate::io) fn put_into(self, triangles: Vec<[u32; 3]>, cloud: &mut RawCloud) {
        let is_other = self.broken * MAX_BROKEN > self.all;
        let has_faces = !is_other && !triangles.is_empty();
        if let Some(Fault { place, problem, .. }) = self.first {
            let count = self.broken;
            cloud.warnings.push(if is_other {
                format!(
                    "{place}: {problem}; {count} of {} faces are like this, so all points are there, and the faces are \
                     skipped",
                    self.all
                )
            } else {
                format!(
                    "{place}: {problem}; {count} of {} faces are skipped for this reason",
                    self.all
                )
            });
        }
        if let Some(Fault { place, problem, .. }) = self.end {
            cloud.warnings.push(format!(
                "{place}: {problem}; all points are there, the faces {}are skipped",
                if has_faces { "from there on " } else { "" }
            ));
        }
        if has_faces {
            cloud.faces = triangles;
        }
    }
}

/// Returns the fault of a face that names a vertex that does not exist.
pub(in crate::io) fn no_vertex(list: &str, row: usize, index: f64, vertex_count: usize) -> Fault {
    Fault::entry(
        list,
        row,
        format!(
            "it names vertex {index}, expected a whole number from 0 to below {vertex_count}, the count of vertices: \
             the file is damaged, or its faces belong to another one"
        ),
    )
}
