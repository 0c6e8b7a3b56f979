//! Scripts for shells.

use assert_cmd::Command;
use assert_cmd::assert::Assert;

fn forwardstep(arguments: &[&str]) -> Assert {
    Command::cargo_bin("forwardstep").unwrap().args(arguments).assert()
}

#[test]
fn every_command_has_a_manual_page() {
    let page = forwardstep(&["man"]).success();
    let page = String::from_utf8(page.get_output().stdout.clone()).unwrap();
    assert!(page.contains(".TH forwardstep 1") && page.contains("sampling\\-limit"), "{page}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    forwardstep(&["man", path]).success();
    for name in ["forwardstep", "forwardstep-run", "forwardstep-new", "forwardstep-man"] {
        let page = std::fs::read_to_string(folder.path().join(format!("{name}.1"))).unwrap();
        assert!(page.contains(&format!(".TH {name} 1")), "{page}");
    }
    let refused = forwardstep(&["man", &format!("{path}/none")]).code(2);
    let said = String::from_utf8(refused.get_output().stderr.clone()).unwrap();
    assert!(said.contains("there is no folder") && said.contains("/none`"), "{said}");
    // Its own pages are replaced, and nothing else is.
    forwardstep(&["man", path]).success();
    let foreign = folder.path().join("forwardstep-run.1");
    std::fs::write(&foreign, "my notes").unwrap();
    std::fs::remove_file(folder.path().join("forwardstep-new.1")).unwrap();
    let refused = forwardstep(&["man", path]).code(2);
    let said = String::from_utf8(refused.get_output().stderr.clone()).unwrap();
    assert!(said.contains("forwardstep-run.1` already exists, and this command did not write it"), "{said}");
    assert_eq!(std::fs::read_to_string(&foreign).unwrap(), "my notes");
    assert!(!folder.path().join("forwardstep-new.1").exists());
}

/// What a link leads to is not in the folder.
#[cfg(unix)]
#[test]
fn regress_manual_pages_do_not_go_through_links_to_what_others_wrote() {
    let folder = tempfile::tempdir().unwrap();
    let [pages, precious] = ["pages", "precious"].map(|name| folder.path().join(name));
    std::fs::create_dir(&pages).unwrap();
    std::fs::write(&precious, "precious").unwrap();
    std::os::unix::fs::symlink(&precious, pages.join("forwardstep.1")).unwrap();
    forwardstep(&["man", pages.to_str().unwrap()]).code(2);
    assert_eq!(std::fs::read_to_string(&precious).unwrap(), "precious");
}

#[test]
fn shells_have_scripts_that_ask_the_program() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = forwardstep(&["completions", shell]).success();
        let script = String::from_utf8(script.get_output().stdout.clone()).unwrap();
        assert!(script.contains("forwardstep") && script.contains("FORWARDSTEP_COMPLETE"), "{shell}: {script}");
    }
    forwardstep(&["completions", "basic"]).code(2);
}

/// What fish offers behind these words, in a folder with files; the last is still being typed.
fn offered(words: &[&str]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    for name in ["mine.toml", "robot.urdf", "notes.txt", "evil\u{1b}[2J.toml"] {
        std::fs::write(folder.path().join(name), "").unwrap();
    }
    std::fs::create_dir(folder.path().join("more")).unwrap();
    let asked = Command::cargo_bin("forwardstep")
        .unwrap()
        .current_dir(&folder)
        .env("FORWARDSTEP_COMPLETE", "fish")
        .args(["--", "forwardstep"])
        .args(words)
        .assert()
        .success();
    let said = String::from_utf8(asked.get_output().stdout.clone()).unwrap();
    let mut names: Vec<String> = said.lines().map(|line| line.split('\t').next().unwrap().to_owned()).collect();
    names.sort();
    names
}

#[test]
fn names_of_scenarios_and_files_beside_are_offered() {
    let found = offered(&["run", ""]);
    for name in ["six-arms", "theorem-1", "mine.toml", "more/"] {
        assert!(found.contains(&name.to_owned()), "{name}: {found:?}");
    }
    for name in ["robot.urdf", "notes.txt"] {
        assert!(!found.contains(&name.to_owned()), "{found:?}");
    }
    assert!(!found.iter().any(|name| name.contains("evil")), "{found:?}");
    assert_eq!(offered(&["check", "theorem-3"]), ["theorem-3-24-order-4", "theorem-3-a5-order-3"]);
    assert_eq!(offered(&["scenarios", "six-arms-w"]), ["six-arms-with-friction"]);
    assert_eq!(offered(&["robot", "r"]), ["robot.urdf"]);
    assert!(offered(&["new", "--robot", "p"]).contains(&"planar_arm".to_owned()));
    assert!(offered(&["fals"]).contains(&"falsify".to_owned()));
    assert!(offered(&["robot", "--ignore"]).contains(&"--ignore-friction".to_owned()));
    assert!(offered(&["sampling-limit", "theorem-4"]).contains(&"theorem-4".to_owned()));
}

#[test]
fn a_shell_that_is_not_known_gets_a_message() {
    let mut command = Command::cargo_bin("forwardstep").unwrap();
    let asked = command.env("FORWARDSTEP_COMPLETE", "basic").args(["--", "forwardstep", ""]).assert().code(2);
    assert!(String::from_utf8_lossy(&asked.get_output().stderr).contains("unknown shell"));
}

#[cfg(unix)]
#[test]
fn bash_completes_with_the_script() {
    let program = assert_cmd::cargo::cargo_bin("forwardstep");
    let path = format!("{}:{}", program.parent().unwrap().display(), std::env::var("PATH").unwrap());
    let asks = "source <(forwardstep completions bash); COMP_WORDS=(forwardstep run six-arms-o); COMP_CWORD=2; COMP_TYPE=9; \
                _clap_complete_forwardstep forwardstep six-arms-o run; printf '%s\\n' \"${COMPREPLY[@]}\"";
    let said = std::process::Command::new("bash").args(["-c", asks]).env("PATH", path).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&said.stdout).trim(), "six-arms-over-radio", "{said:?}");
}
