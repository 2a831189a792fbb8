//! Validation of a directory against itself and against the available bytes: before anything of a group is allocated,
//! decoded or drawn.

use super::directory::{Directory, FrameRecord};
use crate::reel::error::Fault;

impl Directory {
    /// An error where frames cannot be as the directory says. Its group has `data_bytes` bytes of data.
    pub(in crate::reel) fn check(&self, data_bytes: u64) -> Result<(), Fault> {
        // Everything is validated, as checksums do not authenticate the writer.
        let mut before: Option<&FrameRecord> = None;
        for frame in &self.frames {
            let result = check_sections(frame, data_bytes)
                .and_then(|()| check_points(frame))
                .and_then(|()| check_before(frame, before));
            result.map_err(|Fault(problem)| Fault::new(format!("frame {}: {problem}", frame.name)))?;
            before = Some(frame);
        }
        Ok(())
    }
}

/// All levels are in sections, in their order, and only the last section has the points.
fn check_sections(frame: &FrameRecord, data_bytes: u64) -> Result<(), Fault> {
    let Some((last, others)) = frame.sections.split_last() else {
        return Err(Fault::new("it has no section"));
    };
    if let Some(section) = others.iter().position(|section| section.levels.is_empty()) {
        return Err(Fault::new(format!(
            "section {section} adds no level, and is not the last"
        )));
    }
    let (levels, all) = (last.levels.end, frame.counts.len());
    if levels != all {
        return Err(Fault::new(format!("its sections have {levels} of {all} levels")));
    }
    for section in &frame.sections {
        let end = section.offset.checked_add(section.bytes());
        if end.is_none_or(|end| end > data_bytes) {
            let (bytes, offset) = (section.bytes(), section.offset);
            let problem = format!("{bytes} bytes from byte {offset} on, and its group has {data_bytes}");
            return Err(Fault::new(format!("a section claims {problem}")));
        }
    }
    Ok(())
}

/// Individually stored points are in a section of their own, at least one in each of the deepest nodes.
fn check_points(frame: &FrameRecord) -> Result<(), Fault> {
    let [placed, outside] = frame.points;
    let nodes = frame.counts.last().copied().unwrap_or(0);
    if !frame.has_points() {
        return match placed + outside {
            0 => Ok(()),
            points => Err(Fault::new(format!("it has {points} points and no section of them"))),
        };
    }
    if placed < nodes || (nodes == 0 && placed > 0) {
        return Err(Fault::new(format!("it has {placed} points in {nodes} nodes")));
    }
    Ok(())
}

/// Checks that a frame encoded relative to the previous one has its nodes, in sections of the same levels.
fn check_before(frame: &FrameRecord, before: Option<&FrameRecord>) -> Result<(), Fault> {
    let levels =
        |frame: &FrameRecord| -> Vec<_> { frame.sections.iter().map(|section| section.levels.clone()).collect() };
    let fits = before.is_some_and(|before| {
        before.schema == frame.schema
            && before.counts == frame.counts
            && before.points == frame.points
            && levels(before) == levels(frame)
    });
    if frame.is_inter && !fits {
        return Err(Fault::new(
            "it is encoded relative to a previous frame that has other points",
        ));
    }
    Ok(())
}
