//! Commands that are divided among processes, and what `merge` makes of the folder.

use crate::{Folder, read};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// The files of the result of a command, in one process and in shards.
const RESULTS: [&str; 4] = ["json", "csv", "parquet", "svg"];

/// Chunks in a folder, in order.
fn chunks(folder: &Folder, name: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder.path(name)).unwrap().map(|entry| entry.unwrap().path());
    let mut chunks: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|end| end == "parquet")).collect();
    chunks.sort();
    chunks
}

/// Runs a command in one process, and in shards by as many, the last first; the results must be the same, to the last byte.
#[track_caller]
fn check(folder: &Folder, command: &str, shards: usize) {
    let out = |name: &str| RESULTS.map(|ending| format!("-o {name}.{ending}")).join(" ");
    let whole = folder.succeed(&format!("{command} {}", out("whole")));
    for shard in (1..=shards).rev() {
        let threads = 1 + shard % 2;
        let run =
            folder.succeed(&format!("{command} --shard {shard}/{shards} -o chunks --threads {threads}"));
        assert!(
            run.output.is_empty() && run.messages.contains(&format!("shard {shard}/{shards}: ")),
            "{run:?}"
        );
        assert_eq!(shard == 1, folder.run("merge chunks").exit_code == 0, "{shard}");
    }
    let merged = folder.succeed(&format!("merge chunks {}", out("merged")));
    assert_eq!(merged.output, whole.output);
    for ending in RESULTS {
        let [whole, merged] = ["whole", "merged"].map(|name| read(&folder.path(&format!("{name}.{ending}"))));
        assert!(whole == merged, "{command}: {ending}");
    }
    std::fs::remove_dir_all(folder.path("chunks")).unwrap();
}

#[test]
fn charts_of_shards_are_those_of_one_process() {
    let folder = Folder::new();
    check(&folder, "chart --x v=0.1:12:61 --y l=0.02:0.3:37", 3);
    // Fewer points than shards would want, an infinite end, and limits over it.
    check(&folder, "chart --x v=1:9:3 --y r=1:inf:2 --overlay l=0.05,0.1 -s M_f=0.01 -s mu_s=0.5", 7);
    // With what a file says, and does not say: its name is told.
    std::fs::write(folder.path("Rolle_ä.toml"), "# Für Möbel\nl = 0.1\nm_w = 0.4\nr = inf\n").unwrap();
    check(&folder, "chart --x v=1:9:12 --y l=0.05:0.2:10 --wheel Rolle_ä.toml", 2);
}

#[test]
fn basins_of_shards_are_those_of_one_process() {
    let folder = Folder::new();
    check(&folder, "basin --x psi=-1:1:24 --y Omega=-60:60:20 -s v=6", 3);
    check(&folder, "basin --samples 300 --seed 7 -s v=6", 2);
    let sliding = "--contact sliding --duration 30 -s r=inf -s c_u=0.1";
    check(&folder, &format!("basin --x psi=-0.2:0.2:4 --y Omega=-1:1:3 {sliding}"), 2);
}

#[test]
fn margins_of_shards_are_those_of_one_process() {
    let folder = Folder::new();
    check(&folder, "margin --along v=5:7:3 --kind release-angle", 2);
    // Values without uniform motion, an unstable one, and edges that are undecided.
    check(&folder, "margin --along v=0.02:60:4 --duration 2", 3);
}

#[test]
fn the_folder_is_all_that_is_needed() {
    let folder = Folder::new();
    std::fs::write(folder.path("roll.toml"), "l = 0.1\nm_w = 0.4\n").unwrap();
    let command = "chart --x v=1:9:12 --y k=50:200:10 --wheel roll.toml";
    folder.succeed(&format!("{command} -o whole.json -q"));
    folder.succeed(&format!("{command} --shard 1/1 -o chunks"));
    std::fs::write(folder.path("roll.toml"), "l = 0.2\n").unwrap();
    let merged = folder.succeed("merge chunks -o merged.json");
    assert!(merged.messages.contains("roll.toml does not say"), "{}", merged.messages);
    assert!(read(&folder.path("whole.json")) == read(&folder.path("merged.json")));
    // The file is another one now.
    let refused = folder.run(&format!("{command} --shard 1/1 -o chunks"));
    assert_eq!(refused.exit_code, 2);
    assert!(refused.messages.contains("l was 0.1, now it is 0.2"), "{}", refused.messages);
}

#[test]
fn what_is_there_is_not_computed_again() {
    let folder = Folder::new();
    let command = "basin --x psi=-1:1:24 --y Omega=-60:60:20 -s v=6 --shard 1/2 -o chunks";
    folder.succeed(command);
    let kept = chunks(&folder, "chunks");
    let times = || kept.iter().map(|path| path.metadata().unwrap().modified().unwrap()).collect::<Vec<_>>();
    let before = times();
    assert_eq!(kept.len(), 4);
    let again = folder.succeed(command);
    assert!(
        again.messages.contains("4 chunks in chunks, of which 4 were there before"),
        "{}",
        again.messages
    );
    assert_eq!(times(), before);
    // One that was damaged is computed anew, and is what it was.
    let content = read(&kept[2]);
    std::fs::write(&kept[2], &content[1..]).unwrap();
    assert!(folder.succeed(command).messages.contains("of which 3 were there before"));
    assert!(read(&kept[2]) == content);
}

#[test]
fn what_is_missing_damaged_or_of_another_computation_is_told() {
    let folder = Folder::new();
    let command = "chart --x v=0.1:12:31 --y l=0.02:0.3:17";
    let refused = |arguments: &str, exit_code: i32, words: &[&str]| {
        let run = folder.run(arguments);
        assert_eq!(run.exit_code, exit_code, "{arguments}: {}", run.messages);
        for word in words {
            assert!(run.messages.contains(word), "{arguments}: no `{word}` in {}", run.messages);
        }
    };
    for shard in ["1/3", "3/3"] {
        folder.succeed(&format!("{command} --shard {shard} -o chunks -q"));
    }
    refused("merge chunks", 1, &["4 of 13 chunks are not there, of --shard 2/3"]);
    // Another number of shards would overlap.
    refused(&format!("{command} --shard 2/4 -o chunks"), 2, &["--out", "divided into 3 shards, now into 4"]);
    refused(
        &format!("{command} -s k=90 --shard 2/3 -o chunks"),
        2,
        &["another computation", "k_q was 100.0, now it is 90.0"],
    );
    folder.succeed(&format!("{command} --shard 2/3 -o chunks -q"));
    folder.succeed("merge chunks -q");
    let kept = chunks(&folder, "chunks");
    let content = read(&kept[4]);
    let mut changed = content.clone();
    changed[content.len() / 2] ^= 1;
    std::fs::write(&kept[4], &changed).unwrap();
    refused("merge chunks -o a.json", 1, &["00000004-", "not what was written", "--shard 2/3 again"]);
    std::fs::write(&kept[4], &content).unwrap();
    // A chunk from the folder of another wheel.
    folder.succeed(&format!("{command} -s k=90 --shard 2/3 -o others -q"));
    let stranger = &chunks(&folder, "others")[0];
    std::fs::copy(stranger, folder.path("chunks").join(stranger.file_name().unwrap())).unwrap();
    refused("merge chunks", 2, &["is a chunk of another computation", "move it away"]);
    refused("merge others", 1, &["--shard 1/3, --shard 3/3"]);
    refused("merge nowhere", 2, &["there is no such file", "--shard"]);
    refused(&format!("{command} --shard 2/1 -o chunks"), 2, &["--shard", "I/N", "3/10"]);
    refused(&format!("{command} --shard 1/2"), 2, &["--out"]);
    refused(&format!("{command} --shard 1/2 -o a -o b"), 2, &["--out a and b", "one folder"]);
    refused("basin --resume --shard 1/2 -o a", 2, &["--resume"]);
    let left: BTreeSet<String> = folder.files().into_iter().collect();
    assert_eq!(left, ["chunks", "others"].map(str::to_owned).into());
}
