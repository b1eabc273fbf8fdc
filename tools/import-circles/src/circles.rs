//! Circles in the graph of imports.

/// That one file imports an item of another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Import {
    /// Index of the file that imports.
    pub from: usize,
    /// Index of the file that is imported.
    pub to: usize,
    /// The item, as it was written.
    pub path: String,
}

/// The largest sets of files of which each leads to every other by imports.
pub(crate) fn circles(files: usize, imports: &[Import]) -> Vec<Vec<usize>> {
    let reached: Vec<Vec<bool>> = (0..files).map(|file| reached_from(file, files, imports)).collect();
    let mut circles = Vec::new();
    let mut placed = vec![false; files];
    for file in 0..files {
        if placed[file] {
            continue;
        }
        let circle: Vec<usize> =
            (file..files).filter(|&other| reached[file][other] && reached[other][file]).collect();
        circle.iter().for_each(|&member| placed[member] = true);
        if circle.len() > 1 {
            circles.push(circle);
        }
    }
    circles
}

/// The files to which imports lead from a file.
fn reached_from(file: usize, files: usize, imports: &[Import]) -> Vec<bool> {
    let mut reached = vec![false; files];
    let mut open = vec![file];
    while let Some(next) = open.pop() {
        for import in imports.iter().filter(|import| import.from == next) {
            if !std::mem::replace(&mut reached[import.to], true) {
                open.push(import.to);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(edges: &[(usize, usize)]) -> Vec<Import> {
        edges.iter().map(|&(from, to)| Import { from, to, path: String::new() }).collect()
    }

    #[test]
    fn circles_are_told_and_chains_are_not() {
        assert!(circles(4, &graph(&[(0, 1), (1, 2), (0, 2), (2, 3)])).is_empty());
        assert_eq!(
            circles(5, &graph(&[(0, 1), (1, 2), (2, 0), (2, 3), (3, 4), (4, 3)])),
            [vec![0, 1, 2], vec![3, 4]]
        );
    }
}
