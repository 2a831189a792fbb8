//! Lists of several tasks as one, in order: each begins where the sum of the lengths before it is.

use rayon::prelude::*;

/// All of `parts`, side by side.
pub(super) fn compact<T: Copy + Default + Send + Sync>(parts: &[Vec<T>]) -> Vec<T> {
    let count = parts.iter().map(Vec::len).sum();
    let mut all = vec![T::default(); count];
    let mut rest = all.as_mut_slice();
    let mut places = Vec::with_capacity(parts.len());
    for part in parts {
        let (place, after) = rest.split_at_mut(part.len());
        places.push(place);
        rest = after;
    }
    places
        .into_par_iter()
        .zip(parts)
        .for_each(|(place, part)| place.copy_from_slice(part));
    all
}
