//! Clustering of contexts that share a table of a static coder.
//!
//! How it works: every context begins with a table of its own. As long as two of them together take fewer bits than
//! separately, tables included, the two that gain most are merged (greedy agglomeration). So short streams have one
//! table or two, and long ones as many as the contexts warrant.

use super::frequencies::Counts;

/// Maximum number of tables of a stream: all of them together stay in the cache of a core.
pub(in crate::reel) const MAX_TABLES: usize = 12;

/// Contexts that share a table.
#[derive(Debug)]
struct Cluster {
    contexts: Vec<usize>,
    counts: Counts,
    cost: u64,
}

/// For each context the number of its table, and the contents of each table. Contexts that never came have the first.
pub(in crate::reel) fn clustered(contexts: &[Counts]) -> (Vec<u8>, Vec<Counts>) {
    let mut clusters: Vec<Cluster> = contexts
        .iter()
        .enumerate()
        .filter(|(_, counts)| !counts.is_empty())
        .map(|(context, counts)| Cluster {
            contexts: vec![context],
            counts: counts.clone(),
            cost: counts.cost(),
        })
        .collect();
    let gain = |a: &Cluster, b: &Cluster| (a.cost + b.cost) as i64 - a.counts.cost_and(&b.counts) as i64;
    // For each pair, the later one comes first.
    let mut gains: Vec<Vec<i64>> = (0..clusters.len())
        .map(|later| {
            (0..later)
                .map(|earlier| gain(&clusters[later], &clusters[earlier]))
                .collect()
        })
        .collect();
    loop {
        let pairs = gains.iter().enumerate().flat_map(|(later, gains)| {
            let earlier = gains.iter().enumerate();
            earlier.map(move |(earlier, &gain)| (gain, later, earlier))
        });
        let Some((gain_of_best, later, earlier)) = pairs.max() else {
            break;
        };
        if gain_of_best <= 0 && clusters.len() <= MAX_TABLES {
            break;
        }
        let merged = clusters.remove(later);
        gains.remove(later);
        gains[later..].iter_mut().for_each(|gains| {
            gains.remove(later);
        });
        let into = &mut clusters[earlier];
        into.counts = into.counts.and(&merged.counts);
        into.cost = into.counts.cost();
        into.contexts.extend(merged.contexts);
        for other in 0..clusters.len() {
            let (later, earlier) = (other.max(earlier), other.min(earlier));
            if later != earlier {
                gains[later][earlier] = gain(&clusters[later], &clusters[earlier]);
            }
        }
    }
    let mut tables = vec![0; contexts.len()];
    for (table, cluster) in clusters.iter().enumerate() {
        for &context in &cluster.contexts {
            tables[context] = table as u8;
        }
    }
    (tables, clusters.into_iter().map(|cluster| cluster.counts).collect())
}
