//! The groups of unknowns of a matrix that influence each other: its diagonal blocks once it is permuted to block triangular form.
//!
//! Source: Tarjan, "Depth-first search and linear graph algorithms" (1972).

/// The group of every row and column of the column-major n-by-n `matrix`, numbered from zero, and their number: two are in one
/// group if each influences the other, perhaps through others.
pub(crate) fn strong_components(matrix: &[f64], n: usize) -> (Vec<usize>, usize) {
    const UNSEEN: usize = usize::MAX;
    let mut group = vec![UNSEEN; n];
    let mut order = vec![UNSEEN; n];
    let mut lowest = vec![0; n];
    let mut waiting = Vec::new();
    let (mut groups, mut seen) = (0, 0);
    for root in 0..n {
        if order[root] != UNSEEN {
            continue;
        }
        // Nodes on the way, each with the next neighbour to look at.
        let mut way = vec![(root, 0)];
        (order[root], lowest[root]) = (seen, seen);
        seen += 1;
        waiting.push(root);
        while let Some((node, next)) = way.pop() {
            // The column of a node holds what it influences.
            let neighbour = (next..n).find(|&row| row != node && matrix[row + n * node] != 0.0);
            let Some(neighbour) = neighbour else {
                if lowest[node] == order[node] {
                    while let Some(member) = waiting.pop() {
                        group[member] = groups;
                        if member == node {
                            break;
                        }
                    }
                    groups += 1;
                }
                if let Some(&(before, _)) = way.last() {
                    lowest[before] = lowest[before].min(lowest[node]);
                }
                continue;
            };
            way.push((node, neighbour + 1));
            if order[neighbour] == UNSEEN {
                (order[neighbour], lowest[neighbour]) = (seen, seen);
                seen += 1;
                waiting.push(neighbour);
                way.push((neighbour, 0));
            } else if group[neighbour] == UNSEEN {
                lowest[node] = lowest[node].min(order[neighbour]);
            }
        }
    }
    (group, groups)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn groups_are_those_of_mutual_reach(entries in prop::collection::vec(prop::bool::weighted(0.2), 49)) {
            let n = 7;
            let matrix: Vec<f64> = entries.iter().map(|entry| f64::from(u8::from(*entry))).collect();
            let (group, count) = strong_components(&matrix, n);
            // Warshall's transitive closure.
            let mut reaches: Vec<bool> = (0..n * n).map(|at| at / n == at % n || matrix[at] != 0.0).collect();
            for middle in 0..n {
                for from in 0..n {
                    for to in 0..n {
                        reaches[to + n * from] |= reaches[to + n * middle] && reaches[middle + n * from];
                    }
                }
            }
            for one in 0..n {
                for other in 0..n {
                    let mutual = reaches[one + n * other] && reaches[other + n * one];
                    prop_assert_eq!(mutual, group[one] == group[other]);
                }
            }
            prop_assert_eq!(group.iter().max().map_or(0, |last| last + 1), count);
        }
    }
}
