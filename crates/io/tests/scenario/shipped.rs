//! The scenarios that come with the program, and the schema of their format.

use std::collections::BTreeSet;

use forwardstep_io::scenario::{SHIPPED_SCENARIOS, SHIPPED_TABLES, open_scenario, schema};

use super::mutated::SYSTEMS;

#[test]
fn every_shipped_scenario_is_sound() {
    for shipped in SHIPPED_SCENARIOS {
        let scenario = open_scenario(shipped.name).unwrap_or_else(|error| panic!("{}: {error}", shipped.name));
        assert_eq!(scenario.name, shipped.name);
        assert_ne!(scenario.title, shipped.name, "a title of its own");
        assert!(scenario.goal.is_some(), "{} has no goal", shipped.name);
    }
}

#[test]
fn every_scenario_file_is_shipped() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    let mut shipped: Vec<_> = SHIPPED_SCENARIOS.iter().map(|scenario| format!("{}.toml", scenario.name)).collect();
    shipped.extend(SHIPPED_TABLES.iter().map(|table| table.name.to_owned()));
    files.sort();
    shipped.sort();
    assert_eq!(files, shipped);
}

/// All keys of a document, but for names that a user makes up.
fn keys(table: &toml::Table, found: &mut BTreeSet<String>) {
    for (key, value) in table {
        found.insert(key.clone());
        values(value, found, key == "locked");
    }
}

fn values(value: &toml::Value, found: &mut BTreeSet<String>, made_up: bool) {
    match value {
        toml::Value::Table(table) if !made_up => keys(table, found),
        toml::Value::Array(list) => list.iter().for_each(|entry| values(entry, found, made_up)),
        _ => {}
    }
}

#[test]
fn the_schema_knows_every_key_and_describes_it() {
    let schema = serde_json::to_value(schema()).unwrap();
    let mut known = BTreeSet::new();
    let mut undescribed = Vec::new();
    collect(&schema, &mut known, &mut undescribed);
    assert!(undescribed.is_empty(), "without a description: {undescribed:?}");
    let mut used = BTreeSet::new();
    for text in SHIPPED_SCENARIOS.iter().map(|scenario| scenario.text).chain(SYSTEMS) {
        keys(&text.parse().unwrap(), &mut used);
    }
    let unknown: Vec<_> = used.difference(&known).collect();
    assert!(unknown.is_empty(), "not in the schema: {unknown:?}");
}

/// The names of all properties, and those that have no description.
fn collect(schema: &serde_json::Value, known: &mut BTreeSet<String>, undescribed: &mut Vec<String>) {
    match schema {
        serde_json::Value::Object(object) => {
            if let Some(serde_json::Value::Object(properties)) = object.get("properties") {
                for (key, property) in properties {
                    known.insert(key.clone());
                    // A choice is described beside its only property.
                    if property.get("description").is_none() && object.get("description").is_none() {
                        undescribed.push(key.clone());
                    }
                }
            }
            object.values().for_each(|value| collect(value, known, undescribed));
        }
        serde_json::Value::Array(list) => list.iter().for_each(|value| collect(value, known, undescribed)),
        _ => {}
    }
}

#[test]
fn the_schema_refuses_unknown_keys() {
    let schema = serde_json::to_value(schema()).unwrap();
    assert_eq!(schema["additionalProperties"], false);
    assert_eq!(schema["properties"]["format"]["const"], 2);
    assert_eq!(schema["required"], serde_json::json!(["format", "time", "agents", "reference"]));
}

#[test]
fn the_schema_refuses_what_the_reader_refuses_of_single_values() {
    let schema = serde_json::to_value(schema()).unwrap();
    let parts = &schema["$defs"];
    for (place, bound) in [
        (&schema["properties"]["agents"], "minItems"),
        (&parts["AgentFile"]["properties"]["name"], "pattern"),
        (&parts["NetworkFile"], "oneOf"),
        (&parts["NetworkFile"]["properties"]["phases"], "minItems"),
        (&parts["ConsensusFile"]["properties"]["roots_per_s"], "minItems"),
        (&parts["RootFile"]["anyOf"][0], "exclusiveMinimum"),
        (&parts["PairFile"]["properties"]["real"], "exclusiveMinimum"),
        (&parts["PlanarArmFile"]["properties"]["mass_kg"]["items"], "exclusiveMinimum"),
        (&parts["GoalFile"], "minProperties"),
    ] {
        assert!(place.get(bound).is_some(), "no {bound} in {place}");
    }
}
