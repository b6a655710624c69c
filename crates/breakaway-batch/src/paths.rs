//! The paths of numbers as text.

use std::collections::HashMap;

/// Paths that are all different: where some are the same, those of the elements of an array, each is
/// told by its number from 0.
///
/// # Example
/// ```
/// use breakaway_batch::paths::numbered;
/// let paths = ["mass_kg", "shares", "shares"].map(String::from).to_vec();
/// assert_eq!(numbered(paths), ["mass_kg", "shares.0", "shares.1"]);
/// ```
#[must_use]
pub fn numbered(mut paths: Vec<String>) -> Vec<String> {
    let mut counts: HashMap<String, usize> = HashMap::new();
    for path in &paths {
        *counts.entry(path.clone()).or_default() += 1;
    }
    let mut next: HashMap<String, usize> = HashMap::new();
    for path in &mut paths {
        if counts[path] > 1 {
            let place = next.entry(path.clone()).or_default();
            *place += 1;
            *path = format!("{path}.{}", *place - 1);
        }
    }
    paths
}
