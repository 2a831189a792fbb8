//! Pairing of colour images with depth images.

use super::folder::name_of;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Maximum time difference between timestamps of the same time step.
pub(super) const MAX_APART: Duration = Duration::from_millis(20);

/// Names that a note lists.
const NAMED: usize = 3;

/// The depth images with their colour images, and a sentence for each leftover.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    pub(super) colors: Vec<Option<PathBuf>>,
    pub(super) notes: Vec<String>,
}

/// Pairs images by the key that `key` extracts from their names: images with the same key belong to one time step.
pub(super) fn by_key(depths: &[PathBuf], colors: &[PathBuf], key: impl Fn(&str) -> Option<String>) -> Pairs {
    let keyed = colors.iter().filter_map(|path| Some((key(name_of(path))?, path)));
    let by_key: HashMap<String, &PathBuf> = keyed.collect();
    let color_of = |path: &PathBuf| by_key.get(&key(name_of(path))?).map(|&color| color.clone());
    Pairs::of(depths, colors, depths.iter().map(color_of).collect())
}

/// Pairs by their names without extensions; else by the first or the last number in them; else one by one, if their
/// numbers are equal.
pub(super) fn by_name(depths: &[PathBuf], colors: &[PathBuf]) -> Pairs {
    let keys: [fn(&str) -> Option<String>; 3] = [
        |name| Some(stem(name).to_owned()),
        |name| numbers(name).next(),
        |name| numbers(name).last(),
    ];
    let is_unique = |key: &fn(&str) -> Option<String>, paths: &[PathBuf]| {
        let mut seen = std::collections::HashSet::new();
        paths
            .iter()
            .filter_map(|path| key(name_of(path)))
            .all(|key| seen.insert(key))
    };
    for key in keys {
        if is_unique(&key, depths) && is_unique(&key, colors) {
            let pairs = by_key(depths, colors, key);
            if pairs.colors.iter().any(Option::is_some) {
                return pairs;
            }
        }
    }
    let in_order = depths.len() == colors.len();
    let color_of = |index: usize| in_order.then(|| colors[index].clone());
    Pairs::of(depths, colors, (0..depths.len()).map(color_of).collect())
}

/// The nearest in time, if it is near enough. Precondition: a time for each image.
pub(super) fn by_time(depths: &[(Duration, PathBuf)], colors: &[(Duration, PathBuf)]) -> Pairs {
    let mut by_time: Vec<&(Duration, PathBuf)> = colors.iter().collect();
    by_time.sort_by_key(|(time, _)| *time);
    let color_of = |(time, _): &(Duration, PathBuf)| {
        let at = nearest(by_time.len(), |index| by_time[index].0, *time)?;
        Some(by_time[at].1.clone())
    };
    let paths = |images: &[(Duration, PathBuf)]| images.iter().map(|(_, path)| path.clone()).collect::<Vec<_>>();
    Pairs::of(&paths(depths), &paths(colors), depths.iter().map(color_of).collect())
}

/// The index, of `count` ascending times, that is nearest to `time` and not more than [`MAX_APART`] away.
pub(super) fn nearest(count: usize, at: impl Fn(usize) -> Duration, time: Duration) -> Option<usize> {
    let (mut low, mut high) = (0, count);
    while low < high {
        let center = usize::midpoint(low, high);
        if at(center) < time {
            low = center + 1;
        } else {
            high = center;
        }
    }
    let around = low.saturating_sub(1)..(low + 1).min(count);
    around
        .map(|index| (at(index).abs_diff(time), index))
        .min()
        .filter(|(apart, _)| *apart <= MAX_APART)
        .map(|(_, index)| index)
}

impl Pairs {
    fn of(depths: &[PathBuf], all_colors: &[PathBuf], colors: Vec<Option<PathBuf>>) -> Self {
        let mut notes = Vec::new();
        // Without any colour images none are missing.
        if !all_colors.is_empty() {
            let alone = depths.iter().zip(&colors).filter(|(_, color)| color.is_none());
            let alone: Vec<&Path> = alone.map(|(depth, _)| depth.as_path()).collect();
            notes.extend(note(&alone, "depth", "colour", "their points have no colours"));
            let used: std::collections::HashSet<&PathBuf> = colors.iter().flatten().collect();
            let unused = all_colors.iter().filter(|color| !used.contains(color));
            let unused: Vec<&Path> = unused.map(PathBuf::as_path).collect();
            notes.extend(note(&unused, "colour", "depth", "they are skipped"));
        }
        Self { colors, notes }
    }
}

fn note(alone: &[&Path], kind: &str, other: &str, result: &str) -> Option<String> {
    let named: Vec<&str> = alone.iter().take(NAMED).map(|path| name_of(path)).collect();
    let more = if alone.len() > NAMED { ", …" } else { "" };
    (!alone.is_empty()).then(|| {
        format!(
            "{} {kind} images have no {other} image, {result}: {}{more}",
            alone.len(),
            named.join(", ")
        )
    })
}

fn stem(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

/// The runs of digits of a name without its extension, without leading zeros.
fn numbers(name: &str) -> impl Iterator<Item = String> {
    let runs = stem(name).split(|c: char| !c.is_ascii_digit());
    let runs = runs.filter(|run| !run.is_empty());
    runs.map(|run| run.trim_start_matches('0').to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(names: &[&str]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    fn paired(depths: &[&str], colors: &[&str]) -> (Vec<Option<String>>, Vec<String>) {
        let pairs = by_name(&paths(depths), &paths(colors));
        let names = pairs.colors.into_iter();
        (
            names.map(|path| path.map(|path| name_of(&path).to_owned())).collect(),
            pairs.notes,
        )
    }

    #[test]
    fn images_are_paired_by_name() {
        for (depths, colors) in [
            (["d/1.png", "d/2.png"], ["c/1.jpg", "c/2.jpg"]),
            (["d/depth_1.png", "d/depth_2.png"], ["c/rgb_001.png", "c/rgb_002.png"]),
            // A number and a time, where the times differ.
            (["d/01-0000.png", "d/02-0033.png"], ["c/01-0007.png", "c/02-0041.png"]),
            (["d/a.png", "d/b.png"], ["c/x.png", "c/y.png"]),
        ] {
            let (found, notes) = paired(&depths, &colors);
            let expected = colors.map(|color| Some(name_of(Path::new(color)).to_owned()));
            assert_eq!((found, notes), (expected.to_vec(), Vec::new()));
        }
    }

    #[test]
    fn unpaired_images_are_reported() {
        let (found, notes) = paired(&["1.png", "2.png", "3.png"], &["2.jpg", "4.jpg"]);
        assert_eq!(found, [None, Some("2.jpg".to_owned()), None]);
        assert_eq!(
            notes,
            [
                "2 depth images have no colour image, their points have no colours: 1.png, 3.png",
                "1 colour images have no depth image, they are skipped: 4.jpg"
            ]
        );
        assert_eq!(paired(&["1.png"], &[]), (vec![None], Vec::new()));
        assert_eq!(paired(&["a.png", "b.png"], &["x.png"]).0, [None, None]);
    }

    #[test]
    fn the_nearest_time_within_twenty_milliseconds_counts() {
        let stamped = |times: &[u64]| -> Vec<(Duration, PathBuf)> {
            let image = |&at: &u64| (Duration::from_millis(at), PathBuf::from(at.to_string()));
            times.iter().map(image).collect()
        };
        let pairs = by_time(&stamped(&[1000, 1033, 1100, 1190]), &stamped(&[1210, 1001, 1039, 1020]));
        let found: Vec<Option<&str>> = pairs.colors.iter().map(|path| path.as_deref()?.to_str()).collect();
        assert_eq!(found, [Some("1001"), Some("1039"), None, Some("1210")]);
        assert_eq!(pairs.notes.len(), 2);
    }
}
