//! Sums of changes of the number of unstable directions.

/// Whether a change of the number of unstable directions is a sum of changes, each with either sign, one of each list. An empty
/// list explains nothing and forbids nothing.
pub(super) fn reachable<'a>(change: usize, lists: impl Iterator<Item = &'a [usize]>) -> bool {
    let mut sums = vec![0_isize];
    for list in lists.filter(|list| !list.is_empty()) {
        let next = sums
            .iter()
            .flat_map(|sum| list.iter().flat_map(move |&part| [sum + part as isize, sum - part as isize]));
        let mut next: Vec<isize> = next.collect();
        next.sort_unstable();
        next.dedup();
        sums = next;
    }
    sums.contains(&(change as isize))
}

#[cfg(test)]
mod tests {
    use super::reachable;

    #[test]
    fn changes_of_the_count_are_sums_with_either_sign() {
        let pair: &[usize] = &[0, 2];
        let one: &[usize] = &[1];
        assert!(reachable(0, [].into_iter()));
        assert!(!reachable(1, [].into_iter()));
        assert!(reachable(1, [one].into_iter()));
        assert!(!reachable(0, [one].into_iter()));
        assert!(reachable(3, [one, pair].into_iter()));
        assert!(reachable(0, [one, one].into_iter()));
        assert!(!reachable(2, [one].into_iter()));
        assert!(reachable(2, [pair, &[]].into_iter()));
    }
}
