//! Where files go: all or none of several, through links and into pipes and devices, with the permissions that were there.

use super::{Folder, read};

const CHART: &str = "chart --x v=1:9:3 --y l=0.05:0.1:3 -q";

#[test]
fn of_several_files_none_is_written_where_one_cannot_be() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder.csv")).unwrap();
    for bad in ["b.xyz", "b", "missing/b.svg", "folder.csv"] {
        for order in [format!("-o a.json -o {bad}"), format!("-o {bad} -o a.json")] {
            for command in
                [CHART, "steady", "hopf --along v=1:12", "simulate --duration 1", "basin --samples 2"]
            {
                let run = folder.run(&format!("{command} {order}"));
                assert_eq!(run.exit_code, 2, "{command} {order}: {}", run.messages);
                assert!(run.messages.contains(bad), "{}", run.messages);
                assert_eq!(folder.files(), ["folder.csv"], "{command} {order}");
            }
        }
    }
}

#[test]
fn a_file_is_replaced_as_a_whole() {
    let folder = Folder::new();
    std::fs::write(folder.path("a.csv"), "what was there before is longer than what comes\n".repeat(1000))
        .unwrap();
    folder.succeed(&format!("{CHART} -o a.csv -o b.csv"));
    assert!(read(&folder.path("a.csv")) == read(&folder.path("b.csv")));
    assert_eq!(folder.files(), ["a.csv", "b.csv"]);
}

#[cfg(unix)]
mod unix {
    use super::{CHART, Folder, read};
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    use std::process::{Command, Stdio};

    fn mode(folder: &Folder, name: &str) -> u32 {
        std::fs::metadata(folder.path(name)).unwrap().permissions().mode() & 0o7777
    }

    #[test]
    fn permissions_of_what_is_replaced_are_kept() {
        let folder = Folder::new();
        folder.succeed(&format!("{CHART} -o new.csv"));
        for (name, bits) in [("private.csv", 0o600), ("shared.csv", 0o664), ("odd.csv", 0o751)] {
            std::fs::write(folder.path(name), "before").unwrap();
            std::fs::set_permissions(folder.path(name), PermissionsExt::from_mode(bits)).unwrap();
            folder.succeed(&format!("{CHART} -o {name}"));
            assert_eq!(mode(&folder, name), bits, "{name}");
            assert!(read(&folder.path(name)) == read(&folder.path("new.csv")));
        }
    }

    #[test]
    fn links_are_written_through() {
        let folder = Folder::new();
        std::fs::create_dir(folder.path("elsewhere")).unwrap();
        std::fs::write(folder.path("elsewhere/target.csv"), "before").unwrap();
        std::fs::set_permissions(folder.path("elsewhere/target.csv"), PermissionsExt::from_mode(0o600))
            .unwrap();
        symlink("elsewhere/target.csv", folder.path("link.csv")).unwrap();
        symlink("link.csv", folder.path("chain.csv")).unwrap();
        symlink("elsewhere/none_yet.csv", folder.path("dangling.csv")).unwrap();
        symlink("circle.csv", folder.path("circle.csv")).unwrap();
        folder.succeed(&format!("{CHART} -o plain.csv"));
        let plain = read(&folder.path("plain.csv"));
        for (name, target) in [
            ("link.csv", "elsewhere/target.csv"),
            ("chain.csv", "elsewhere/target.csv"),
            ("dangling.csv", "elsewhere/none_yet.csv"),
        ] {
            std::fs::write(folder.path("elsewhere/target.csv"), "before").unwrap();
            folder.succeed(&format!("{CHART} -o {name}"));
            assert!(std::fs::symlink_metadata(folder.path(name)).unwrap().is_symlink(), "{name}");
            assert!(read(&folder.path(target)) == plain, "{name}");
        }
        assert_eq!(mode(&folder, "elsewhere/target.csv"), 0o600);
        let refused = folder.run(&format!("{CHART} -o circle.csv"));
        assert!(
            refused.exit_code == 2 && refused.messages.contains("levels of symbolic links"),
            "{}",
            refused.messages
        );
        let names = std::fs::read_dir(folder.path("elsewhere")).unwrap().count();
        assert_eq!(names, 2, "nothing unfinished is left beside the target");
    }

    #[test]
    fn pipes_and_devices_are_written_to_and_stay() {
        let folder = Folder::new();
        folder.succeed(&format!("{CHART} -o plain.csv -o plain.parquet"));
        for ending in ["csv", "parquet"] {
            let pipe = folder.path(&format!("pipe.{ending}"));
            assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
            let reader = Command::new("cat").arg(&pipe).stdout(Stdio::piped()).spawn().unwrap();
            folder.succeed(&format!("{CHART} -o pipe.{ending}"));
            assert!(
                reader.wait_with_output().unwrap().stdout == read(&folder.path(&format!("plain.{ending}")))
            );
            assert!(std::fs::metadata(&pipe).unwrap().file_type().is_fifo());
        }
        symlink("/dev/null", folder.path("null.csv")).unwrap();
        folder.succeed(&format!("{CHART} -o null.csv"));
        assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        assert!(std::fs::symlink_metadata(folder.path("null.csv")).unwrap().is_symlink());
    }

    /// Through a link to it standard output takes the file too, also where it goes into a file itself.
    #[cfg(target_os = "linux")]
    #[test]
    fn standard_output_is_a_place_for_files() {
        let folder = Folder::new();
        folder.succeed(&format!("{CHART} -o plain.csv"));
        symlink("/dev/stdout", folder.path("output.csv")).unwrap();
        let through_a_pipe = folder.succeed(&format!("{CHART} -o output.csv"));
        assert!(through_a_pipe.output.as_bytes() == read(&folder.path("plain.csv")));
        let table = folder.succeed(&CHART.replace(" -q", "")).output;
        let status = Command::new(env!("CARGO_BIN_EXE_kingpin"))
            .args(CHART.replace(" -q", "").split_whitespace())
            .args(["-o", "output.csv"])
            .current_dir(folder.path(""))
            .stdout(std::fs::File::create(folder.path("both.txt")).unwrap())
            .status()
            .unwrap();
        assert!(status.success());
        let both = String::from_utf8(read(&folder.path("both.txt"))).unwrap();
        assert_eq!(both, format!("{}{table}", through_a_pipe.output));
    }
}
