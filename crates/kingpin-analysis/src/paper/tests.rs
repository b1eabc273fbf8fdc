//! Everything that `kingpin paper` writes, and what it says when it cannot.

use super::branches::{self, Branches, FIGURE_5_RADIUS, FIGURE_6_LENGTH};
use super::claims::Verdict;
use super::tasks::Tasks;
use super::{PaperRequest, PaperResult};
use crate::error::Error;
use arclength_analysis::Control;
use kingpin_report::ReportError;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

fn run(out: &Path, figure: Option<u8>) -> Result<PaperResult, Error> {
    PaperRequest { figure, out: out.to_owned() }.run(&Control::unobserved(&AtomicBool::new(false)))
}

fn files_in(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<(String, Vec<u8>)> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| {
            let entry = entry.unwrap();
            (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())
        })
        .collect();
    files.sort();
    files
}

fn on_threads<R: Send>(threads: usize, action: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(action)
}

#[test]
fn the_whole_paper_is_the_same_at_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let [one, three] = [1, 3].map(|threads| {
        let out = folder.path().join(threads.to_string());
        let report = on_threads(threads, || run(&out, None)).unwrap();
        assert_eq!(report.files.len(), 21);
        (report, files_in(&out))
    });
    assert_eq!(one.1, three.1);

    let claims = one.0.claims;
    let count = |verdict| claims.iter().filter(|claim| claim.verdict == verdict).count();
    for claim in &claims {
        let contradicted = claim.statement == "The asymmetry is practically not relevant.";
        assert_eq!(
            claim.verdict == Verdict::Contradicted,
            contradicted,
            "{}: {}",
            claim.statement,
            claim.evidence
        );
        assert!(!claim.evidence.contains("NaN"), "{}", claim.evidence);
    }
    // The six misprints and the equations as a whole.
    assert_eq!(count(Verdict::Corrected), 7);

    let page =
        String::from_utf8(one.1.into_iter().find(|(name, _)| name == "report.html").unwrap().1).unwrap();
    assert_eq!(page.matches("<svg").count(), 5);
    assert_eq!(page.matches("<li class=").count(), claims.len());
    for outside in ["<script", "<link", "<img", "src=\"http", "url(http"] {
        assert!(!page.contains(outside), "{outside}");
    }
}

#[test]
fn one_figure_is_written_alone() {
    let folder = tempfile::tempdir().unwrap();
    let report = run(folder.path(), Some(4)).unwrap();
    assert_eq!(report.files.len(), 4);
    let files = files_in(folder.path());
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["figure4.csv", "figure4.pdf", "figure4.png", "figure4.svg"]);
    assert!(files[0].1.starts_with(b"curve,F_Az [N],v [m/s],l [m]\nrolling limit,0,"));
}

#[test]
fn what_cannot_be_done_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let error = run(&out, Some(1)).unwrap_err();
    assert!(error.to_string().contains("figure 1") && error.to_string().contains("allowed: 2"), "{error}");
    assert!(!out.exists());

    let taken = folder.path().join("taken");
    fs::write(&taken, "a file").unwrap();
    let error = run(&taken, Some(2)).unwrap_err();
    assert!(
        matches!(error, Error::Report(ReportError::Unwritable { .. })) && error.to_string().contains("taken"),
        "{error}"
    );

    let stopped = AtomicBool::new(true);
    let request = PaperRequest { figure: None, out: out.clone() };
    let error = request.run(&Control::unobserved(&stopped)).unwrap_err();
    assert!(matches!(error, Error::Stopped));
    assert!(files_in(&out).is_empty());
}

/// Speed, period, largest and smallest caster angle at l = 0.08 m, r = 1 m, by single shooting with a tolerance of 3e-14.
const REFERENCES: [[f64; 4]; 4] = [
    [8.0, 0.14612684668050366, 0.2701391504417376, -0.12019038629884853],
    [4.0, 0.15274192836201247, 0.6351645637341435, -0.5003383285676317],
    [2.0, 0.15469423899444815, 0.7098150349910172, -0.5648677576526538],
    [1.0, 0.15522951404204402, 0.7307800097444889, -0.5801477894905818],
];

#[test]
fn cycles_agree_with_single_shooting_and_straight_running_is_symmetric() {
    let stop = AtomicBool::new(false);
    let control = Control::unobserved(&stop);
    let branches = Branches::compute(&Tasks::new(&control, branches::TASKS)).unwrap();
    let branch = branches.branch(FIGURE_6_LENGTH, FIGURE_5_RADIUS).unwrap();
    for [speed, period, largest, smallest] in REFERENCES {
        let (cycle, _) = branch.cycle_at(speed).unwrap();
        for (computed, reference) in
            [(cycle.period, period), (cycle.max[2], largest), (cycle.min[2], smallest)]
        {
            assert!((computed / reference - 1.0).abs() < 1e-7, "{computed} {reference} at {speed} m/s");
        }
    }
    let straight = branches.branch(FIGURE_6_LENGTH, f64::INFINITY).unwrap();
    assert!(straight.cycles.len() > 10);
    for cycle in &straight.cycles {
        assert!((cycle.max[2] + cycle.min[2]).abs() < 1e-7 * cycle.max[2], "{}", cycle.value);
    }
}
