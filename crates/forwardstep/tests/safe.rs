//! What commands write where the user says never costs what was there, and what they print can be pasted.

use std::fs;
use std::process::Command;

use crate::support::{folder, forwardstep, names, stderr, stdout};

const MASSES: &str = "format = 2\ntitle = \"masses\"\n[time]\nend_s = 4\n[[agents]]\nname = \"m\"\ncount = 2\n\
                      robot.point_mass = { mass_kg = 2, dimension = 1 }\nstart.position_m = [[0.0], [1.0]]\n\
                      [reference.consensus]\nroots_per_s = [1.0, 2.0]\nexchange = \"position\"\n[law.adaptive]\ndamping.gain = 5\nadaptation_gain = 2\n[network]\nedges.ring = {}\n";

#[test]
fn regress_no_plot_and_no_upgrade_replaces_a_file_of_somebody_else() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("own.toml"), MASSES).unwrap();
    fs::write(path("old.toml"), MASSES.replace("format = 2", "format = 1")).unwrap();
    fs::write(path("own.svg"), "<svg/>").unwrap();
    for (arguments, kept) in [
        (&["smoothness", "theorem-2", "--orders", "1,2", "--plot", "own.toml"][..], "own.toml"),
        (&["smoothness", "theorem-2", "--orders", "1,2", "--plot", "own.svg"], "own.svg"),
        (&["upgrade", "old.toml", "--out", "own.toml"], "own.toml"),
    ] {
        let before = fs::read(path(kept)).unwrap();
        let said = stderr(&forwardstep(&folder, arguments).code(2));
        assert!(said.contains("already exists, and this command did not write it"), "{said}");
        assert_eq!(fs::read(path(kept)).unwrap(), before, "{arguments:?}");
    }
    // Its own are replaced, and what is upgraded in place.
    for _ in 0..2 {
        forwardstep(&folder, &["smoothness", "theorem-2", "--orders", "1", "--plot", "drawn.svg"]).code(0);
    }
    forwardstep(&folder, &["upgrade", "old.toml"]).code(0);
    assert!(fs::read_to_string(path("old.toml")).unwrap().contains("format = 2"));
    assert_eq!(names(folder.path()), ["drawn.svg", "old.toml", "own.svg", "own.toml"]);
}

#[test]
fn regress_what_an_attack_saved_and_somebody_edited_is_kept() {
    let folder = folder();
    let path = folder.path().join("found.toml");
    let attack = || forwardstep(&folder, &["attack", "24", "--seconds", "1", "--out", "found.toml"]);
    attack().code(0);
    attack().code(0);
    let edited = fs::read_to_string(&path).unwrap().replace("end_s = ", "end_s = 1");
    fs::write(&path, &edited).unwrap();
    attack().code(2);
    assert_eq!(fs::read_to_string(&path).unwrap(), edited);
    let said = stderr(&forwardstep(&folder, &["attack", "24", "--pieces", "2000000"]).code(2));
    assert!(said.contains("1..=1000"), "{said}");
}

#[cfg(unix)]
#[test]
fn regress_a_file_that_may_not_grow_leaves_the_one_before_it_whole() {
    let folder = folder();
    forwardstep(&folder, &["check", "theorem-2", "--certificate", "own.json"]);
    let before = fs::read(folder.path().join("own.json")).unwrap();
    let limited = Command::new("sh")
        .current_dir(&folder)
        .args(["-c", "ulimit -f 1; exec \"$0\" check theorem-2 --certificate own.json"])
        .arg(assert_cmd::cargo::cargo_bin("forwardstep"))
        .output()
        .unwrap();
    let said = String::from_utf8(limited.stderr).unwrap();
    assert!(limited.status.code() == Some(2) && said.contains("cannot write `own.json`"), "{said}");
    assert_eq!(fs::read(folder.path().join("own.json")).unwrap(), before);
    assert_eq!(names(folder.path()), ["own.json"]);
}

#[test]
fn regress_files_of_others_under_the_names_of_a_run_stay_where_it_is_replaced() {
    let folder = folder();
    fs::write(folder.path().join("own.toml"), MASSES).unwrap();
    for name in ["shapes.json", "rows.journal"] {
        forwardstep(&folder, &["run", "own.toml", "--out", "run"]).code(0);
        fs::write(folder.path().join("run").join(name), "mine").unwrap();
        let said = stderr(&forwardstep(&folder, &["run", "own.toml", "--out", "run", "--force"]).code(2));
        assert!(said.contains(name), "{said}");
        assert_eq!(fs::read_to_string(folder.path().join("run").join(name)).unwrap(), "mine");
        fs::remove_dir_all(folder.path().join("run")).unwrap();
    }
    // `--force` is not advised where it is refused.
    fs::create_dir(folder.path().join("full")).unwrap();
    fs::write(folder.path().join("full/x"), "mine").unwrap();
    forwardstep(&folder, &["run", "own.toml", "--out", "run"]).code(0);
    for arguments in [&["run", "own.toml", "--out", "full"][..], &["report", "run", "--out", "full"]] {
        let said = stderr(&forwardstep(&folder, arguments).code(2));
        assert!(said.contains("is not empty") && !said.contains("--force"), "{said}");
    }
    assert!(stderr(&forwardstep(&folder, &["run", "own.toml", "--out", "run"]).code(2)).contains("--force"));
}

#[test]
fn regress_the_folder_of_a_run_that_was_cut_off_is_not_taken_for_the_run_before() {
    let folder = folder();
    fs::write(folder.path().join("own.toml"), MASSES).unwrap();
    forwardstep(&folder, &["run", "own.toml", "--out", "run"]).code(0);
    forwardstep(&folder, &["check", "run"]).code(0);
    // What a run leaves that began there and was killed.
    std::thread::sleep(std::time::Duration::from_millis(20));
    fs::write(folder.path().join("run/rows.journal"), "forwardstep rows").unwrap();
    let said = stderr(&forwardstep(&folder, &["check", "run"]).code(2));
    assert!(said.contains("a run that was cut off") && said.contains("forwardstep report run"), "{said}");
}

#[test]
fn regress_commands_that_are_printed_can_be_pasted() {
    let folder = folder();
    let said = stdout(&forwardstep(&folder, &["new", "my own.toml", "--agents", "2", "--untried"]).code(0));
    assert!(said.contains("forwardstep run 'my own.toml'"), "{said}");
    fs::write(folder.path().join("it's old.toml"), MASSES.replace("format = 2", "format = 1")).unwrap();
    let said = stderr(&forwardstep(&folder, &["check", "it's old.toml"]).code(2));
    assert!(said.contains(r"forwardstep upgrade 'it'\''s old.toml'"), "{said}");
}

#[test]
fn regress_new_names_the_robots_that_it_knows() {
    let folder = folder();
    for (name, meant) in
        [("planar_am", "did you mean `planar_arm`?"), ("ur5", "did you mean `ur5e`?"), ("robot", "`spacecraft`")]
    {
        let said = stderr(&forwardstep(&folder, &["new", "x.toml", "--robot", name]).code(2));
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(meant) && said.contains("`vehicle`") && said.contains("my-arm.urdf"), "{said}");
    }
    let said = stderr(&forwardstep(&folder, &["new", "x.toml", "--agents", "1"]).code(2));
    assert!(said.contains("--leader"), "{said}");
}

#[test]
fn regress_tables_with_other_separators_and_units_left_out_are_understood() {
    let folder = folder();
    let tracked = "format = 2\n[time]\nend_s = 4\n[[agents]]\nname = \"m\"\nrobot.point_mass = { mass_kg = 2, dimension = 1 }\n\
                   start.position_m = [0.0]\ntarget.csv.file = \"target.csv\"\n[reference.tracking]\nroots_per_s = [1.0, 2.0]\n[law.adaptive]\ndamping.gain = 5\nadaptation_gain = 2\n";
    fs::write(folder.path().join("own.toml"), tracked).unwrap();
    for (table, says) in
        [("t_s;x\n0;1\n4;2\n", "commas separate the columns"), ("t,x\n0,1\n4,2\n", "did you mean `t_s`?")]
    {
        fs::write(folder.path().join("target.csv"), table).unwrap();
        let said = stderr(&forwardstep(&folder, &["check", "own.toml"]).code(2));
        assert!(said.split_whitespace().collect::<Vec<_>>().join(" ").contains(says), "{said}");
    }
}
