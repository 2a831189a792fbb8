//! Grouping of images from several cameras into time steps, by a common clock.
//!
//! *How it works.* The clock of an image is the time in its name if names have such, otherwise the number that counts,
//! otherwise its index in its folder. Images in the order of their clocks belong to one time step until one is more
//! than half of the usual step later than the first, or from a camera that is already present. So numbers have to be
//! equal, and stamps of a common trigger may differ by network delays. A camera that lost an image has none in that
//! time step, and no other is affected.

use crate::io::files::timestamps::times_of_names;
use crate::natural::natural_order;
use crate::source::FrameEntry;
use crate::source::files::number;
use std::path::PathBuf;
use std::time::Duration;

/// An image or a folder with its place in time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Timed {
    pub(super) entry: FrameEntry,
    /// In steps or in seconds, as all of one pairing.
    clock: f64,
}

impl Timed {
    /// A name, by its place in time.
    pub(super) fn at(name: PathBuf, number: u64) -> Self {
        let mut entry = FrameEntry::file(name);
        entry.number = Some(number);
        Self {
            entry,
            clock: number as f64,
        }
    }

    pub(super) fn clock(&self) -> f64 {
        self.clock
    }
}

/// Group of images taken together: the image index for each camera, or none.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Together {
    pub(super) clock: f64,
    pub(super) of_each: Vec<Option<usize>>,
}

/// The files of each camera in natural order, with their clocks.
pub(super) fn timed(cameras: Vec<Vec<PathBuf>>) -> Vec<Vec<Timed>> {
    let in_order = |mut paths: Vec<PathBuf>| {
        paths.sort_by(|left, right| natural_order(left, right));
        let mut entries: Vec<FrameEntry> = paths.into_iter().map(FrameEntry::file).collect();
        number(&mut entries);
        entries
    };
    let mut cameras: Vec<Vec<FrameEntry>> = cameras.into_iter().map(in_order).collect();
    let times: Vec<Vec<Option<Duration>>> = cameras.iter().map(|entries| times_of(entries)).collect();
    let have_times = times.iter().flatten().all(Option::is_some);
    let have_numbers = cameras.iter().flatten().all(|entry| entry.number.is_some());
    if have_times {
        for (entries, times) in cameras.iter_mut().zip(times) {
            for (entry, time) in entries.iter_mut().zip(times) {
                entry.time = time;
            }
        }
    }
    let of_camera = |entries: Vec<FrameEntry>| {
        let clocked = entries.into_iter().enumerate();
        let clocked = clocked.map(|(at, entry)| Timed {
            clock: match (entry.time, entry.number) {
                (Some(time), _) => time.as_secs_f64(),
                (None, Some(number)) if have_numbers => number as f64,
                _ => at as f64,
            },
            entry,
        });
        clocked.collect()
    };
    cameras.into_iter().map(of_camera).collect()
}

fn times_of(entries: &[FrameEntry]) -> Vec<Option<Duration>> {
    let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
    times_of_names(&names)
}

/// Returns the time steps of cameras, each sorted by its clock.
pub(super) fn together(cameras: &[Vec<Timed>]) -> Vec<Together> {
    let max_apart = 0.5 * usual_step(cameras.iter().map(Vec::as_slice));
    let mut all: Vec<(f64, usize, usize)> = cameras
        .iter()
        .enumerate()
        .flat_map(|(camera, images)| images.iter().enumerate().map(move |(at, of)| (of.clock, camera, at)))
        .collect();
    all.sort_by(|left, right| {
        left.0
            .total_cmp(&right.0)
            .then((left.1, left.2).cmp(&(right.1, right.2)))
    });
    let mut time_steps: Vec<Together> = Vec::new();
    for (clock, camera, at) in all {
        let last = time_steps.last_mut();
        let last = last.filter(|last| last.of_each[camera].is_none() && clock - last.clock < max_apart);
        if let Some(last) = last {
            last.of_each[camera] = Some(at);
        } else {
            let mut of_each = vec![None; cameras.len()];
            of_each[camera] = Some(at);
            time_steps.push(Together { clock, of_each });
        }
    }
    time_steps
}

/// Returns the entry of `others` that belongs to the same time step as `clock`.
pub(super) fn matching(others: &[Timed], clock: f64) -> Option<&Timed> {
    let max_apart = 0.5 * usual_step([others]);
    let nearest = others.iter().min_by(|left, right| {
        let apart = |of: &Timed| (of.clock - clock).abs();
        apart(left).total_cmp(&apart(right))
    });
    nearest.filter(|other| (other.clock - clock).abs() < max_apart)
}

/// The median step of all cameras.
fn usual_step<'a>(cameras: impl IntoIterator<Item = &'a [Timed]>) -> f64 {
    let steps = cameras
        .into_iter()
        .flat_map(|images| images.windows(2).map(|pair| pair[1].clock - pair[0].clock));
    let mut steps: Vec<f64> = steps.filter(|&step| step > 0.0).collect();
    let center = steps.len() / 2;
    if steps.is_empty() {
        return 1.0;
    }
    *steps.select_nth_unstable_by(center, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cameras(names: &[&[&str]]) -> Vec<Vec<Timed>> {
        let folders = names.iter().enumerate();
        let paths = folders.map(|(camera, names)| {
            names
                .iter()
                .map(|name| PathBuf::from(format!("cam{camera}/{name}")))
                .collect()
        });
        timed(paths.collect())
    }

    /// Names of the images of each time step, one line per time step.
    fn lines(names: &[&[&str]]) -> Vec<String> {
        let cameras = cameras(names);
        let time_steps = together(&cameras).into_iter();
        let name = |(camera, at): (usize, Option<usize>)| match at {
            Some(at) => cameras[camera][at].entry.name.clone(),
            None => "-".to_owned(),
        };
        time_steps
            .map(|time_step| {
                let names: Vec<String> = time_step.of_each.into_iter().enumerate().map(name).collect();
                names.join(" ")
            })
            .collect()
    }

    #[test]
    fn images_with_one_number_are_one_time_step() {
        let names: &[&[&str]] = &[&["0.png", "1.png", "2.png", "10.png"], &["f_0001.jpg", "f_0002.jpg"]];
        assert_eq!(
            lines(names),
            ["0.png -", "1.png f_0001.jpg", "2.png f_0002.jpg", "10.png -"]
        );
    }

    #[test]
    fn timestamps_of_one_trigger_may_differ_slightly() {
        let names: &[&[&str]] = &[
            &[
                "1305031102.100000.png",
                "1305031102.200000.png",
                "1305031102.300000.png",
            ],
            &["1305031102.104000.png", "1305031102.296000.png"],
        ];
        assert_eq!(
            lines(names),
            [
                "1305031102.100000.png 1305031102.104000.png",
                "1305031102.200000.png -",
                "1305031102.300000.png 1305031102.296000.png",
            ]
        );
        assert!(cameras(names)[1][0].entry.time.is_some());
    }

    #[test]
    fn names_without_numbers_are_paired_by_order() {
        let names: &[&[&str]] = &[&["a.png", "b.png"], &["u.png", "v.png"]];
        assert_eq!(lines(names), ["a.png u.png", "b.png v.png"]);
    }

    #[test]
    fn a_camera_is_never_twice_in_a_time_step() {
        // Bursts: two images right after one another.
        let names: &[&[&str]] = &[
            &["1.png", "2.png", "100.png", "101.png", "200.png"],
            &["1.png", "100.png"],
        ];
        assert_eq!(
            lines(names),
            ["1.png 1.png", "2.png -", "100.png 100.png", "101.png -", "200.png -"]
        );
        assert_eq!(lines(&[]), [""; 0]);
        assert_eq!(lines(&[&[], &["7.png"]]), ["- 7.png"]);
    }

    #[test]
    fn points_belong_to_the_time_step_of_their_number() {
        let clouds = timed(vec![vec![PathBuf::from("points/2.ply"), PathBuf::from("points/4.ply")]]).remove(0);
        let name = |clock: f64| matching(&clouds, clock).map(|of| of.entry.name.clone());
        assert_eq!(name(2.0).as_deref(), Some("2.ply"));
        assert_eq!(name(4.0).as_deref(), Some("4.ply"));
        assert_eq!(name(3.0), None);
        assert_eq!(matching(&[], 0.0), None);
    }
}
