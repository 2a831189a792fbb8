//! Numbers in file names, and the order of files by them.
//!
//! **How it works.** A name is cut into text and numbers; a number may have a sign, a fraction and an exponent, as
//! `printf("%g")` writes it. The text between the numbers is the *skeleton*: names of one sequence share it. If all
//! names of a folder have one skeleton and their numbers look like decimals, files are ordered by value: `0.5` before
//! `0.25` is right for versions and wrong for seconds. Decimals have no trailing zeros, or all the same number of
//! digits; `1.9` followed by `1.10` is a version, and keeps the natural order.

use crate::natural::{natural_order, split_name};
use std::cmp::Ordering;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// A number in a name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NameNumber {
    /// Digits before the point.
    whole: String,
    fraction: Option<String>,
    /// With sign, fraction and exponent.
    pub(super) value: f64,
    has_sign: bool,
    has_exponent: bool,
    /// True if a letter directly precedes the number.
    pub(super) follows_letter: bool,
}

/// A name cut into text and numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SplitName {
    /// The text, with `#` for each number.
    pub(super) skeleton: String,
    pub(super) numbers: Vec<NameNumber>,
}

/// Rule for a minus in front of digits being a sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Minus {
    /// At the start of the name and after a separator: `t_-1`.
    AfterSeparator,
    /// After a letter as well: `t-1`.
    AfterLetter,
}

impl NameNumber {
    /// Returns true if the number has a fraction or an exponent.
    pub(super) fn is_decimal(&self) -> bool {
        self.fraction.is_some() || self.has_exponent
    }

    fn is_plain(&self) -> bool {
        self.fraction.is_none() && !self.has_exponent && !self.has_sign
    }

    fn compare(&self, other: &Self) -> Ordering {
        if self.is_plain() && other.is_plain() {
            let [left, right] = [&self.whole, &other.whole].map(|digits| digits.trim_start_matches('0'));
            return left.len().cmp(&right.len()).then_with(|| left.cmp(right));
        }
        self.value.total_cmp(&other.value)
    }
}

impl SplitName {
    /// Cuts `stem`, a name without its extension.
    pub(super) fn of(stem: &str, minus: Minus) -> Self {
        let chars: Vec<char> = stem.chars().collect();
        let (mut skeleton, mut numbers) = (String::new(), Vec::new());
        let mut at = 0;
        while at < chars.len() {
            if let Some((number, end)) = number_at(&chars, at, minus) {
                numbers.push(number);
                skeleton.push('#');
                at = end;
            } else {
                skeleton.extend(chars[at].to_lowercase());
                at += 1;
            }
        }
        Self { skeleton, numbers }
    }

    /// The letters of the name alone: equal for all numbering styles of one sequence.
    pub(super) fn letters(&self) -> String {
        self.skeleton.chars().filter(|c| c.is_alphabetic()).collect()
    }
}

/// The number that begins at `at`, and the place after it.
fn number_at(chars: &[char], at: usize, minus: Minus) -> Option<(NameNumber, usize)> {
    let is_digit = |place: usize| chars.get(place).is_some_and(char::is_ascii_digit);
    let digits = |start: usize| (start..chars.len()).take_while(|&place| is_digit(place)).count();
    let before = at.checked_sub(1).map(|place| chars[place]);
    let has_sign = chars[at] == '-' && is_digit(at + 1) && is_sign_after(before, minus);
    let start = at + usize::from(has_sign);
    if !is_digit(start) {
        return None;
    }
    let mut end = start + digits(start);
    let whole: String = chars[start..end].iter().collect();
    // In `1.2.3`, a version or a date, no part is a fraction.
    let follows_point = before == Some('.') && at >= 2 && is_digit(at - 2);
    let mut fraction = None;
    if chars.get(end) == Some(&'.') && is_digit(end + 1) && !follows_point {
        let fraction_end = end + 1 + digits(end + 1);
        let is_followed = chars.get(fraction_end) == Some(&'.') && is_digit(fraction_end + 1);
        if !is_followed {
            fraction = Some(chars[end + 1..fraction_end].iter().collect::<String>());
            end = fraction_end;
        }
    }
    // Printed exponents have a sign and two digits: `frame1e5` means something else.
    let has_exponent = matches!(chars.get(end), Some('e' | 'E'))
        && matches!(chars.get(end + 1), Some('+' | '-'))
        && digits(end + 2) >= 2;
    if has_exponent {
        end += 2 + digits(end + 2);
    }
    let value = chars[at..end].iter().collect::<String>().parse().ok()?;
    let number = NameNumber {
        whole,
        fraction,
        value,
        has_sign,
        has_exponent,
        follows_letter: before.is_some_and(char::is_alphabetic),
    };
    Some((number, end))
}

fn is_sign_after(before: Option<char>, minus: Minus) -> bool {
    match before {
        None => true,
        Some(c) if c.is_ascii_digit() => false,
        Some(c) if c.is_alphabetic() => minus == Minus::AfterLetter,
        Some(c) => c != ')' && c != ']',
    }
}

/// The name that determines the place of `file` in a sequence: its stem, or its folder's if each file is in a folder of
/// its own.
pub(super) fn telling_name(file: &Path, is_folder_per_frame: bool) -> String {
    if is_folder_per_frame {
        let folder = file.parent().and_then(Path::file_name).unwrap_or(OsStr::new(""));
        return folder.to_string_lossy().into_owned();
    }
    split_name(file).0.into_owned()
}

/// Returns true if each of several files is in a folder of its own.
pub(super) fn is_folder_per_frame(files: &[PathBuf]) -> bool {
    let mut folders: Vec<Option<&Path>> = files.iter().map(|file| file.parent()).collect();
    folders.sort_unstable();
    files.len() > 1 && folders.windows(2).all(|pair| pair[0] != pair[1])
}

/// Sorts `files`: by value if their names have decimals, naturally otherwise.
pub(super) fn sort(files: &mut [PathBuf]) {
    files.sort_by(|left, right| natural_order(left, right));
    let stems: Vec<String> = files.iter().map(|file| split_name(file).0.into_owned()).collect();
    if let Some(numbers) = hexadecimal(&stems) {
        let mut keyed: Vec<(u64, PathBuf)> = numbers.into_iter().zip(files.iter().cloned()).collect();
        keyed.sort_by_key(|(number, _)| *number);
        for (place, (_, file)) in files.iter_mut().zip(keyed) {
            *place = file;
        }
        return;
    }
    let Some(split) = decimals_of(files) else {
        return;
    };
    let mut keyed: Vec<(SplitName, PathBuf)> = split.into_iter().zip(files.iter().cloned()).collect();
    // Stable: equal numbers stay in natural order.
    keyed.sort_by(|(left, _), (right, _)| {
        let pairs = left.numbers.iter().zip(&right.numbers);
        let mut orders = pairs.map(|(left, right)| left.compare(right));
        orders.find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    });
    for (place, (_, file)) in files.iter_mut().zip(keyed) {
        *place = file;
    }
}

/// The names of `files` if these share a skeleton and have decimals.
pub(super) fn decimals_of(files: &[PathBuf]) -> Option<Vec<SplitName>> {
    let is_folder_per_frame = is_folder_per_frame(files);
    let names: Vec<String> = files
        .iter()
        .map(|file| telling_name(file, is_folder_per_frame))
        .collect();
    let split = |minus: Minus| -> Option<Vec<SplitName>> {
        let split: Vec<SplitName> = names.iter().map(|name| SplitName::of(name, minus)).collect();
        let is_one_sequence = split.windows(2).all(|pair| pair[0].skeleton == pair[1].skeleton);
        is_one_sequence.then_some(split)
    };
    let split = split(Minus::AfterSeparator).or_else(|| split(Minus::AfterLetter))?;
    let count = split.first()?.numbers.len();
    let column = |index: usize| split.iter().map(move |name| &name.numbers[index]);
    let has_decimals = (0..count).any(|index| column(index).any(|number| !number.is_plain()));
    let are_decimals = (0..count).all(|index| {
        let fractions: Vec<&str> = column(index).filter_map(|number| number.fraction.as_deref()).collect();
        let same_length = fractions.windows(2).all(|pair| pair[0].len() == pair[1].len());
        let is_trimmed = |fraction: &&str| fraction.len() == 1 || !fraction.ends_with('0');
        same_length || fractions.iter().all(is_trimmed)
    });
    (has_decimals && are_decimals).then_some(split)
}

/// The numbers that `names` are in hexadecimal digits, if some have letters, some digits, and they follow each other
/// closely.
pub(super) fn hexadecimal(names: &[String]) -> Option<Vec<u64>> {
    let prefix = common_prefix(names);
    let digits = |name: &String| -> Option<u64> {
        let digits = name.get(prefix..).filter(|digits| digits.len() <= 15)?;
        u64::from_str_radix(digits, 16).ok()
    };
    let numbers: Vec<u64> = names.iter().map(digits).collect::<Option<_>>()?;
    // Letters common to all names, as in `f000` and `f001`, are not digits.
    let first_name = names.first()?;
    let shared = |name: &String| {
        first_name
            .bytes()
            .zip(name.bytes())
            .take_while(|(one, other)| one == other)
            .count()
    };
    let shared = names.iter().map(shared).min()?;
    let has = |is: fn(char) -> bool| {
        names
            .iter()
            .any(|name| name.get(shared..).is_some_and(|rest| rest.contains(is)))
    };
    let has_both = has(|c| c.is_ascii_alphabetic()) && has(|c| c.is_ascii_digit());
    let (first, last) = (numbers.iter().min()?, numbers.iter().max()?);
    let is_close = last - first < 4 * numbers.len() as u64;
    (has_both && is_close).then_some(numbers)
}

/// Bytes up to the last separator that all `names` begin with.
fn common_prefix(names: &[String]) -> usize {
    let Some(first) = names.first() else { return 0 };
    let end = first.rfind(|c: char| !c.is_ascii_alphanumeric()).map_or(0, |at| at + 1);
    let is_shared = first.is_char_boundary(end) && names.iter().all(|name| name.starts_with(&first[..end]));
    if is_shared { end } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(names: &[&str]) -> Vec<String> {
        let mut files: Vec<PathBuf> = names.iter().map(PathBuf::from).collect();
        sort(&mut files);
        files.iter().map(|file| file.display().to_string()).collect()
    }

    #[test]
    fn decimals_are_ordered_by_value() {
        for expected in [
            &[
                "c_0.ply",
                "c_0.25.ply",
                "c_0.5.ply",
                "c_0.75.ply",
                "c_1.ply",
                "c_1.25.ply",
            ][..],
            &["t-1.ply", "t-0.5.ply", "t0.ply", "t0.5.ply", "t10.ply"],
            &["-10.ply", "-2.5.ply", "-1.ply", "0.ply", "3.ply"],
            &["s_0.ply", "s_1e-05.ply", "s_0.0002.ply", "s_0.1.ply", "s_1e+06.ply"],
            &["9.5.pcd", "10.0.pcd", "10.25.pcd", "10.5.pcd"],
            &["r2_0.5.las", "r2_0.75.las", "r10_0.25.las", "r10_0.5.las"],
            &["1305031102.25.ply", "1305031102.5.ply", "1305031103.ply"],
            &["0.25/cloud.ply", "0.5/cloud.ply", "1/cloud.ply"],
            &["2024-01-15T10-30-00.25.ply", "2024-01-15T10-30-00.5.ply"],
        ] {
            let mut shuffled = expected.to_vec();
            shuffled.reverse();
            assert_eq!(sorted(&shuffled), expected);
        }
    }

    #[test]
    fn versions_and_plain_numbers_are_in_natural_order() {
        for expected in [
            &["v1.9.ply", "v1.10.ply", "v1.11.ply"][..],
            &["f-1.ply", "f-2.ply", "f-10.ply"],
            &["scan.9", "scan.10", "scan.0100"],
            &["t_03-05.ply", "t_03-10.ply", "t_04-01.ply"],
            &["1.2.9.ply", "1.2.10.ply"],
            &["a.ply", "b_0.5.ply", "b_0.25.ply"],
        ] {
            let mut shuffled = expected.to_vec();
            shuffled.reverse();
            assert_eq!(sorted(&shuffled), expected);
        }
    }

    #[test]
    fn skeletons_are_equal_for_all_numbering_styles() {
        let letters = |stem: &str| SplitName::of(stem, Minus::AfterSeparator).letters();
        for stem in [
            "frame_1",
            "Frame-0002",
            "frame 3",
            "frame4",
            "frame_0.25",
            "frame_-1e-05",
        ] {
            assert_eq!(letters(stem), "frame", "{stem}");
        }
        assert_eq!(letters("20121214T142255.814"), "t");
        assert_eq!(letters("003"), "");
    }

    #[test]
    fn hexadecimal_names_are_numbers() {
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        assert_eq!(hexadecimal(&names(&["9", "a", "10"])), Some(vec![9, 10, 16]));
        assert_eq!(hexadecimal(&names(&["f_0e", "f_0f", "f_10"])), Some(vec![14, 15, 16]));
        for other in [
            &["a", "b", "c"][..],
            &["7", "8", "10"],
            &["e1", "f2", "c10"],
            &["a1", "x2"],
        ] {
            assert_eq!(hexadecimal(&names(other)), None, "{other:?}");
        }
    }
}
