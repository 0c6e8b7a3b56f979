//! Text made to hurt: nothing panics, overflows the stack or takes for ever.

use std::sync::LazyLock;

use forwardstep_io::urdf::{FrictionPolicy, shipped_robot};
use forwardstep_io::{SourceText, UrdfOptions, read_urdf};
use proptest::prelude::*;

use super::{ARM, BASE, LIMIT, joint, read, robot};

static UR5E: LazyLock<&str> = LazyLock::new(|| shipped_robot("ur5e").unwrap_or_default());

/// Reads, and shows all that there is to say, so that no place in the text is out of range.
fn show(text: &str) -> String {
    let options = UrdfOptions {
        locked: vec![("wrist_3_joint".to_owned(), 0.5)],
        friction: FrictionPolicy::Ignore,
        ..UrdfOptions::default()
    };
    match read_urdf(&SourceText::new("hostile.urdf", text), &options) {
        Ok(robot) => robot.notices.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"),
        Err(error) => format!("{:?}", miette::Report::new(error)),
    }
}

/// Words that mean something to the reader.
const WORDS: &[&str] = &[
    "<link name=\"forearm_link\"/>",
    "</joint>",
    "<joint name='a' type='revolute'>",
    "type=\"floating\"",
    "<inertial>",
    "<!--",
    "<![CDATA[",
    "<!DOCTYPE r [<!ENTITY a 'b'>]>",
    "&a;",
    "&#32;",
    "\u{feff}",
    "é",
    "1e308",
    "-1e308",
    "nan",
    "0 0 0",
    "xmlns='u'",
    "xmlns:xacro='http://www.ros.org/wiki/xacro'",
    "<xacro:x/>",
    "${pi}",
    "base_link",
    "tool0",
    "=",
    "\"",
    "/>",
    " ",
];

#[derive(Clone, Debug)]
enum Edit {
    Insert(prop::sample::Index, &'static str),
    Delete(prop::sample::Index, usize),
    Replace(prop::sample::Index, char),
    Move(prop::sample::Index, usize, prop::sample::Index),
    Truncate(prop::sample::Index),
}

fn edit() -> impl Strategy<Value = Edit> {
    let at = any::<prop::sample::Index>;
    prop_oneof![
        8 => (at(), prop::sample::select(WORDS)).prop_map(|(at, word)| Edit::Insert(at, word)),
        4 => (at(), 1..60_usize).prop_map(|(at, length)| Edit::Delete(at, length)),
        8 => (at(), any::<char>()).prop_map(|(at, letter)| Edit::Replace(at, letter)),
        4 => (at(), 1..400_usize, at()).prop_map(|(from, length, to)| Edit::Move(from, length, to)),
        1 => at().prop_map(Edit::Truncate),
    ]
}

fn apply(text: &mut Vec<char>, edit: &Edit) {
    if text.is_empty() {
        return;
    }
    match edit {
        Edit::Insert(at, word) => {
            let at = at.index(text.len());
            text.splice(at..at, word.chars());
        }
        Edit::Delete(at, length) => {
            let at = at.index(text.len());
            text.drain(at..(at + length).min(text.len()));
        }
        Edit::Replace(at, letter) => {
            let at = at.index(text.len());
            text[at] = *letter;
        }
        Edit::Move(from, length, to) => {
            let from = from.index(text.len());
            let moved: Vec<char> = text[from..(from + length).min(text.len())].to_vec();
            let to = to.index(text.len());
            text.splice(to..to, moved);
        }
        Edit::Truncate(at) => text.truncate(at.index(text.len())),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn prop_no_edit_of_a_robot_panics(edits in prop::collection::vec(edit(), 1..6)) {
        let mut text: Vec<char> = UR5E.chars().collect();
        for edit in &edits {
            apply(&mut text, edit);
        }
        show(&text.into_iter().collect::<String>());
    }

    #[test]
    fn prop_no_text_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        show(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn prop_no_heap_of_elements_panics(words in prop::collection::vec(prop::sample::select(WORDS), 0..40)) {
        show(&format!("<robot name='r'>{}</robot>", words.concat()));
    }

    #[test]
    fn prop_no_numbers_panic(numbers in prop::collection::vec(any::<f64>(), 16)) {
        let n = |k: usize| format!("{:e}", numbers[k]);
        let link = format!(
            r#"<link name="arm"><inertial><origin xyz="{} {} {}" rpy="{} {} {}"/><mass value="{}"/><inertia ixx="{}" iyy="{}" izz="{}" ixy="{}" ixz="{}" iyz="{}"/></inertial></link>"#,
            n(0), n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10), n(11), n(12),
        );
        let axis = format!(r#"<axis xyz="{} {} {}"/>{LIMIT}"#, n(13), n(14), n(15));
        show(&robot(&[BASE, &link, &joint("revolute", &axis)]));
    }
}

#[test]
fn deep_nesting_is_refused_or_ignored_without_recursion() {
    let depth = 300_000;
    let nested = format!("{}{}", "<a>".repeat(depth), "</a>".repeat(depth));
    assert!(read(&robot(&[&nested])).unwrap_err().contains("the robot has no links"));
    assert!(read(&"<robot>".repeat(depth)).unwrap_err().contains("never closed"));
}

#[test]
fn long_chains_do_not_recurse() {
    let links: String = (1..=50_000)
        .map(|k| {
            format!(
                r#"<link name="l{k}"/><joint name="j{k}" type="fixed"><parent link="l{}"/><child link="l{k}"/></joint>"#,
                k - 1
            )
        })
        .collect();
    let first = ARM.replace("arm", "l0");
    let turning = joint("revolute", &format!(r#"<axis xyz="0 0 1"/>{LIMIT}"#));
    let text = robot(&[BASE, &first, &turning.replace("arm", "l0"), &links]);
    let read = read(&text).unwrap();
    assert_eq!(read.links.len(), 50_002);
    assert_eq!(read.robot.axes.len(), 1);
}

#[test]
fn files_beyond_any_robot_are_refused() {
    let nodes = "<a/>".repeat(1 << 21);
    assert_eq!(
        read(&robot(&[&nodes])).unwrap_err(),
        "r.urdf: more than 2097152 XML nodes\n  help: no robot has so many: look whether this is the file that you mean"
    );
    let bytes = " ".repeat(1 << 26);
    assert_eq!(
        read(&robot(&[&bytes])).unwrap_err(),
        "r.urdf: more than 67108864 bytes\n  help: no robot has so many: look whether this is the file that you mean"
    );
    let namespaces = r#"<a xmlns:b="c"/>"#.repeat(1001);
    assert_eq!(
        read(&robot(&[&namespaces])).unwrap_err(),
        "r.urdf: more than 1000 namespace declarations\n  help: no robot has so many: look whether this is the file that you mean"
    );
    let joints: String = (0..1001)
        .map(|k| {
            format!(
                r#"<link name="l{k}"/><joint name="j{k}" type="continuous"><parent link="base"/><child link="l{k}"/></joint>"#
            )
        })
        .collect();
    assert_eq!(
        read(&robot(&[BASE, &joints])).unwrap_err(),
        "r.urdf: more than 1000 moving joints\n  help: make those fixed that need not move: every one costs time at every step"
    );
}

/// The parser compares every attribute of an element with all others.
#[test]
fn regress_an_element_with_very_many_attributes_is_refused_at_once() {
    let attributes = |count: usize| (0..count).map(|k| format!(" a{k}='<=>'")).collect::<String>();
    let first = "<!-- <a x='1' -->";
    let error = read(&robot(&[first, &format!("<link name=\"l\"{}/>", attributes(400_000))])).unwrap_err();
    assert!(error.contains(": more than 100 attributes of one element"), "{error}");
    // What stands in comments and texts is no attribute, and other elements have their own.
    let many = format!("<!--{0}--><![CDATA[<a{0}]]><a{1}/><b{1}/>", " x='1'".repeat(200), attributes(60));
    let error = read(&robot(&[&many])).unwrap_err();
    assert!(!error.contains("attributes of one element"), "{error}");
}

#[test]
fn entities_are_not_expanded() {
    let bomb = r#"<?xml version="1.0"?>
<!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
<robot name="&b;"/>"#;
    assert!(read(bomb).unwrap_err().starts_with("r.urdf:2:1: a document type declaration"));
}
