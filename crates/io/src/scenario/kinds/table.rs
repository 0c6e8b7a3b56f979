//! What all kinds have in common: a key, and a table that is read.

use std::fmt;

use forwardstep_sim::RobotSetup;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{DeserializeOwned, VariantAccess};

use super::super::choice::Choice;
use super::super::de::ValueDe;
use super::super::fault::Fault;
use super::super::template::RobotTemplate;
use super::{
    AgentReferenceTable, DelayKind, KindTable, LawKind, LawTable, ReferenceKind, ReferenceTable, RobotKind, RobotTable,
    ScheduleKind,
};

/// A key with what stands under it.
pub(super) struct Table<T: ?Sized> {
    pub(super) key: &'static str,
    description: &'static str,
    read: fn(Choice<'_, '_>) -> Result<Box<T>, Fault>,
    /// Of its table; `None` for a word that stands alone.
    schema: Option<fn(&mut SchemaGenerator) -> Schema>,
}

impl<T: ?Sized> Table<T> {
    /// What `read` reads, which is an `F`.
    fn of<F: JsonSchema>(
        KindTable { key, description }: KindTable,
        read: fn(Choice<'_, '_>) -> Result<Box<T>, Fault>,
    ) -> Self {
        Table { key, description, read, schema: Some(SchemaGenerator::subschema_for::<F>) }
    }
}

impl<T: ?Sized> Clone for Table<T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T: ?Sized> Copy for Table<T> {}

impl<T: ?Sized> fmt::Debug for Table<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key)
    }
}

#[derive(Clone, Debug)]
pub(super) struct RobotEntry {
    pub(super) table: Table<dyn RobotKind>,
    pub(super) usual_law: &'static str,
    pub(super) template: Option<RobotTemplate>,
}

impl RobotEntry {
    pub(super) fn of<F: RobotKind + DeserializeOwned + JsonSchema + 'static>() -> Self {
        let RobotTable { key, description, usual_law, template } = F::table();
        let table: Table<dyn RobotKind> =
            Table::of::<F>(KindTable { key, description }, |table| Ok(Box::new(read::<F>(table)?)));
        RobotEntry { table, usual_law, template }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct LawEntry {
    pub(super) table: Table<dyn LawKind>,
    pub(super) made_for: &'static str,
    pub(super) suits: fn(&RobotSetup) -> bool,
}

impl LawEntry {
    pub(super) fn of<F: LawKind + DeserializeOwned + JsonSchema + 'static>() -> Self {
        let LawTable { key, description, made_for } = F::table();
        let table: Table<dyn LawKind> =
            Table::of::<F>(KindTable { key, description }, |table| Ok(Box::new(read::<F>(table)?)));
        LawEntry { table, made_for, suits: F::suits }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct ReferenceEntry {
    pub(super) table: Table<dyn ReferenceKind>,
    /// What agents may state of their own.
    pub(super) of_agents: Option<Table<AgentReferenceTable>>,
}

impl ReferenceEntry {
    pub(super) fn of<F: ReferenceKind + DeserializeOwned + JsonSchema + 'static>() -> Self {
        let ReferenceTable { key, description, own_roots } = F::table();
        let table: Table<dyn ReferenceKind> =
            Table::of::<F>(KindTable { key, description }, |table| Ok(Box::new(read::<F>(table)?)));
        let of_agents = own_roots.then(|| {
            let table = KindTable { key, description };
            Table::of::<AgentReferenceTable>(table, |table| Ok(Box::new(read::<AgentReferenceTable>(table)?)))
        });
        ReferenceEntry { table, of_agents }
    }
}

/// A kind of delay.
pub(super) fn delay<F: DelayKind + DeserializeOwned + JsonSchema + 'static>() -> Table<dyn DelayKind> {
    Table::of::<F>(F::table(), |table| Ok(Box::new(read::<F>(table)?)))
}

/// A kind of switching.
pub(super) fn schedule<F: ScheduleKind + DeserializeOwned + JsonSchema + 'static>() -> Table<dyn ScheduleKind> {
    Table::of::<F>(F::table(), |table| Ok(Box::new(read::<F>(table)?)))
}

/// A kind of switching that is a word without a table.
pub(super) fn word<F: ScheduleKind + Default + 'static>() -> Table<dyn ScheduleKind> {
    let KindTable { key, description } = F::table();
    let read = |word: Choice<'_, '_>| word.unit_variant().map(|()| -> Box<dyn ScheduleKind> { Box::new(F::default()) });
    Table { key, description, read, schema: None }
}

/// The struct of a table.
fn read<F: DeserializeOwned>(table: Choice<'_, '_>) -> Result<F, Fault> {
    F::deserialize(table.content()?)
}

/// What stands at `place`: the key of one of `tables`, with that table.
pub(super) fn chosen<'t, T: ?Sized + 't>(
    mut tables: impl Iterator<Item = &'t Table<T>> + Clone,
    place: ValueDe<'_, '_>,
) -> Result<(&'static str, Box<T>), Fault> {
    let keys: Vec<&'static str> = tables.clone().map(|table| table.key).collect();
    let choice = place.choice(&keys)?;
    match tables.find(|table| table.key == choice.key) {
        Some(table) => Ok((table.key, (table.read)(choice).map_err(|fault| fault.at(&place.span()))?)),
        None => Err(choice.unknown(&keys)),
    }
}

/// One of these keys, each with its table.
pub(super) fn choice<'t, T: ?Sized + 't>(
    description: &str,
    tables: impl Iterator<Item = &'t Table<T>>,
    generator: &mut SchemaGenerator,
) -> Schema {
    let one = |table: &Table<T>| {
        let Table { key, description, schema, .. } = table;
        let Some(schema) = schema else {
            return json_schema!({ "description": description, "type": "string", "const": key });
        };
        json_schema!({
            "description": description,
            "type": "object",
            "properties": { *key: schema(generator) },
            "required": [key],
            "additionalProperties": false,
        })
    };
    let all: Vec<Schema> = tables.map(one).collect();
    json_schema!({ "description": description, "oneOf": all })
}
