//! Files that a scenario names, from memory: the same setup and the same messages as from a folder.

use std::collections::BTreeMap;
use std::path::Path;

use forwardstep_io::SourceText;
use forwardstep_io::scenario::{Inputs, Scenario, ScenarioError, read_scenario};
use miette::Diagnostic;

const TEXT: &str = r#"format = 2
time = { end_s = 2 }
[[agents]]
name = "arm"
count = 2
robot.urdf = { file = "robots/slider.urdf" }
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position_velocity"
[law.adaptive]
damping.gain = 8
adaptation_gain = 10
[network]
delay.log.file = "radio.csv"
edges.csv.file = "./edges.csv"
"#;
const SLIDER: &str = r#"<robot name="slider">
  <link name="rail"/>
  <link name="body"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="rail"/><child link="body"/><axis xyz="1 0 0"/>
    <limit lower="-3" upper="3" velocity="2" effort="50"/></joint>
</robot>
"#;
const RADIO: &str = "from,to,send_s,delay_s\narm-1,arm-2,0,0.1\narm-2,arm-1,0,0.2\n";
const EDGES: &str = "from,to,weight\narm-1,arm-2,0.5\narm-2,arm-1,0.7\n";

type Files = BTreeMap<&'static str, Vec<u8>>;

/// The files that the scenario names, by paths below its folder.
fn files() -> Files {
    [("robots/slider.urdf", SLIDER), ("radio.csv", RADIO), ("edges.csv", EDGES)].map(|(n, t)| (n, t.into())).into()
}

fn read(inputs: impl Into<Inputs>) -> Result<Scenario, ScenarioError> {
    read_scenario("test", &SourceText::new("test.toml", TEXT), inputs)
}

fn from_memory(files: &Files) -> Result<Scenario, ScenarioError> {
    read(files.clone().into_iter().collect::<Inputs>())
}

fn write(files: &Files, folder: &Path) {
    std::fs::create_dir(folder.join("robots")).unwrap();
    files.iter().for_each(|(name, bytes)| std::fs::write(folder.join(name), bytes).unwrap());
}

#[test]
fn the_same_files_give_the_same_setup_from_memory_and_from_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    write(&files(), folder.path());
    let (there, here) = (read(Some(folder.path())).unwrap(), from_memory(&files()).unwrap());
    assert_eq!(format!("{:?}", there.setup), format!("{:?}", here.setup));
    // What a run keeps, in the order of reading.
    let kept = |scenario: &Scenario| {
        scenario.inputs.iter().map(|input| (input.name.clone(), input.source.text().to_owned())).collect::<Vec<_>>()
    };
    assert_eq!(kept(&there), kept(&here));
    assert_eq!(here.inputs.len(), 3);
    assert_eq!(here.inputs[0].source.name(), "robots/slider.urdf");
}

#[test]
fn mistakes_have_the_same_messages_and_places_from_memory_and_from_a_folder() {
    let with = |name, bytes: &[u8]| {
        let mut files = files();
        files.insert(name, bytes.to_vec());
        files
    };
    let without = |name| {
        let mut files = files();
        files.remove(name);
        files
    };
    let cases = [
        (with("robots/slider.urdf", SLIDER.replace("\"2\"", "\"two\"").as_bytes()), "robots/slider.urdf:3:"),
        (with("radio.csv", RADIO.replace("0.2", "-1").as_bytes()), "radio.csv:3:15: "),
        (with("edges.csv", EDGES.replace("arm-2,0.5", "arm-9,0.5").as_bytes()), "edges.csv:2:7: "),
        (with("edges.csv", b"from,to\narm-1,\xff"), "byte 0xff in line 2, column 7"),
        (with("radio.csv", &vec![b'x'; (1 << 26) + 1]), "larger than 64 MiB"),
        (without("radio.csv"), "there is no such file"),
    ];
    for (files, part) in cases {
        let folder = tempfile::tempdir().unwrap();
        write(&files, folder.path());
        let there = read(Some(folder.path())).unwrap_err();
        let here = from_memory(&files).unwrap_err();
        let below = format!("{}/", folder.path().display());
        assert_eq!(there.to_string().replace(&below, "").replace("./", ""), here.to_string().replace("./", ""));
        assert!(here.to_string().contains(part), "{here}");
        let help = |error: &ScenarioError| error.help().map(|help| help.to_string());
        assert_eq!(help(&there), help(&here), "{here}");
    }
}

#[test]
fn a_file_with_a_name_is_preferred_to_the_folder_and_no_shipped_robot_replaces_it() {
    let folder = tempfile::tempdir().unwrap();
    write(&files(), folder.path());
    let in_folder = Inputs::from(Some(folder.path()));
    let heavier = SLIDER.replace("\"2\"", "\"3\"");
    let scenario = read(in_folder.clone().file("robots//slider.urdf", heavier)).unwrap();
    let first = read(in_folder.clone()).unwrap().setup.agents[0].robot.theta[0];
    assert_eq!((first, scenario.setup.agents[0].robot.theta[0]), (2.0, 3.0));
    assert!(scenario.inputs[1].source.name().starts_with(folder.path().to_str().unwrap()), "from the folder");

    // At a path of its own, there or nowhere.
    let moved = folder.path().join("moved.csv");
    std::fs::rename(folder.path().join("edges.csv"), &moved).unwrap();
    assert_eq!(read(in_folder.clone().file_at("edges.csv", &moved)).unwrap().inputs.len(), 3);
    let error = read(in_folder.file_at("robots/slider.urdf", "nowhere.urdf")).unwrap_err();
    assert!(error.to_string().contains("there is no such file"), "{error}");

    let text = TEXT.replace("robots/slider.urdf", "ur5e.urdf");
    let read = |inputs| read_scenario("test", &SourceText::new("test.toml", text.as_str()), inputs);
    let tables = || Inputs::default().file("radio.csv", RADIO).file("edges.csv", EDGES);
    assert_eq!(read(tables()).unwrap().setup.agents[0].robot.axes.len(), 6);
    read(tables().file_at("ur5e.urdf", "nowhere.urdf")).unwrap_err();
}

#[test]
fn a_name_that_is_nearly_given_is_offered() {
    let mut files = files();
    let edges = files.remove("edges.csv").unwrap();
    files.insert("edge.csv", edges);
    let error = from_memory(&files).unwrap_err();
    assert_eq!(error.to_string(), "test.toml:15:18: cannot read the table `./edges.csv`: there is no such file");
    assert!(error.help().unwrap().to_string().contains("edge.csv"));
    assert!(!error.help().unwrap().to_string().contains("urdf"));
}
