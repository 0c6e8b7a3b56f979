//! `[[external_wrenches]]` as they are written.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, SeqAccess, Visitor};

use super::at::At;
use super::edges_file::LIST_OR_CHOICE;
use super::formula_text::{FORMULA, FormulaText};
use super::values::{Item, NotNegative, Rows};

/// Something that acts on agents from outside for a while. Pushes that overlap add up.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PushFile {
    /// Who is pushed: agents by name, or a counted population by its own name, which means all of it.
    #[schemars(length(min = 1))]
    pub on: At<Vec<At<String>>>,
    /// When it begins, in s. Default: 0, or with the first row of its table.
    #[schemars(range(min = 0))]
    pub from_s: Option<At<f64>>,
    /// How long it lasts, in s. Default: for ever, or until the last row of its table.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub for_s: Option<At<f64>>,
    /// What acts.
    pub by: At<ByFile>,
}

/// What acts on an agent.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ByFile {
    /// A torque on every axis of a robot whose axes are all angles, in N m.
    #[serde(rename = "torque_n_m")]
    TorqueNM(At<CourseFile>),
    /// A force along every axis of a robot whose axes are all lengths, in N.
    ForceN(At<CourseFile>),
    /// A torque or force on every axis of any robot, in N m or N as each axis has it.
    Effort(At<CourseFile>),
    /// A torque about the axes of the body of a rotorcraft or a spacecraft, in N m: about x, y, z.
    #[serde(rename = "body_torque_n_m")]
    BodyTorqueNM(At<CourseFile>),
    /// What is added to the equations of a chain: a list of one number for a chain of derivatives, whose last equation it enters; one for
    /// each equation of a chain in feedback form. In a table of CSV they are `w1`, `w2`, ….
    Disturbance(At<CourseFile>),
    /// A force and a torque on a link of a URDF, or on the outer link of a planar arm, at its end-effector.
    Wrench(WrenchFile),
    /// Virtual springs and dampers on axes, as of a hand that leads them along a path.
    VirtualSpringOnAxes(VirtualSpringOnAxesFile),
    /// A virtual spring and damper on a point of a link, or on the end-effector of a planar arm, as of a hand that leads it along a path.
    VirtualSpringOnPoint(VirtualSpringOnPointFile),
}

/// A force and a torque that act on a link.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WrenchFile {
    /// The link of the URDF, fixed ones such as `tool0` too. Planar arms are pushed at their end-effector.
    pub link: Option<At<String>>,
    /// Where the force acts, in the frame of the link, in m. Default: its origin.
    pub at_m: Option<At<[f64; 3]>>,
    /// What the components refer to. Default: base.
    pub axes: Option<At<AxesFile>>,
    /// The force, in N: x, y, z; for a planar arm x, y. Default: none.
    pub force_n: Option<At<CourseFile>>,
    /// The torque, in N m: about x, y, z; for a planar arm a list of one number. Default: none.
    pub torque_n_m: Option<At<CourseFile>>,
}

/// What the components of a force refer to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AxesFile {
    /// The base frame: the direction stays while the link turns.
    Base,
    /// The frame of the link: the direction turns with it.
    Link,
}

/// Virtual springs on some axes: torque = stiffness · (target − position) − damping · velocity on each.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VirtualSpringOnAxesFile {
    /// The axes it holds, by name. Default: all.
    pub axes: Option<At<Vec<At<String>>>>,
    /// One number, or one for each axis it holds; in N m/rad or N/m as each axis has it.
    #[schemars(with = "OneOrEach")]
    pub stiffness: At<Item>,
    /// One number, or one for each axis it holds; in N m s/rad or N s/m. Default: 0.
    #[schemars(with = "Option<OneOrEach>")]
    pub damping: Option<At<Item>>,
    /// Where it leads axes that are all angles, in rad; one entry for each axis it holds.
    pub target_rad: Option<At<CourseFile>>,
    /// Where it leads axes that are all lengths, in m.
    pub target_m: Option<At<CourseFile>>,
    /// Where it leads any axes, in rad or m as each axis has it.
    pub target: Option<At<CourseFile>>,
}

/// A virtual spring on a point: force = stiffness · (target − position) − damping · velocity.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VirtualSpringOnPointFile {
    /// The link of the URDF that it holds. Planar arms are held at their end-effector.
    pub link: Option<At<String>>,
    /// The point it holds, in the frame of the link, in m. Default: its origin.
    pub at_m: Option<At<[f64; 3]>>,
    /// In N/m.
    #[schemars(range(min = 0))]
    pub stiffness_n_per_m: At<f64>,
    /// In N s/m. Default: 0.
    #[schemars(range(min = 0))]
    pub damping_n_s_m: Option<At<f64>>,
    /// Where it leads the point, in the base frame, in m: x, y, z; for a planar arm x, y from the shoulder.
    pub target_m: At<CourseFile>,
}

/// Several numbers over time: a list of numbers and formulas in t, or rows of a table.
#[derive(Clone, Debug)]
pub enum CourseFile {
    /// Each by itself.
    Each(Vec<At<FunctionFile>>),
    /// All of them from a table.
    Table(Box<CourseTableFile>),
}

/// A number, or a formula in t.
#[derive(Clone, Debug, PartialEq, JsonSchema)]
#[schemars(untagged)]
pub enum FunctionFile {
    /// Always the same.
    Number(f64),
    /// Such as `"2*sin(3*t)"`.
    Formula(FormulaText),
}

/// A table over time. Nothing acts before its first row, nor after its last.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum CourseTableFile {
    /// A CSV file.
    Csv(CourseCsvFile),
    /// Rows written here.
    Rows(CourseRowsFile),
}

/// A CSV file over time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CourseCsvFile {
    /// The CSV file, beside the scenario file. Its first line names its columns: `t_s`, rising, and one for each number, by the
    /// names of the axes, or `x`, `y`, `z`.
    pub file: At<String>,
    /// What holds between two rows. Default: linear.
    #[serde(default)]
    pub interpolate: InterpolateFile,
}

/// Rows over time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CourseRowsFile {
    /// The times of the rows, in s; rising. They may begin before the run.
    #[schemars(with = "Vec<f64>", length(min = 2))]
    pub times_s: At<Vec<At<f64>>>,
    /// The rows, a list of numbers each; as many as times.
    #[schemars(with = "Vec<Vec<f64>>", length(min = 2))]
    pub values: At<Rows>,
    /// What holds between two rows. Default: linear.
    #[serde(default)]
    pub interpolate: InterpolateFile,
}

/// What a table says between two rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InterpolateFile {
    /// The straight line from row to row.
    #[default]
    Linear,
    /// The earlier row; the last one only says when the one before it ends.
    Hold,
}

/// Stands for a number or a list of numbers, none negative, in the schema.
struct OneOrEach;

impl JsonSchema for OneOrEach {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "OneOrEach".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let number = generator.subschema_for::<NotNegative>();
        json_schema!({ "anyOf": [number, { "type": "array", "items": number }] })
    }
}

impl<'de> Deserialize<'de> for CourseFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct CourseVisitor;
        impl<'de> Visitor<'de> for CourseVisitor {
            type Value = CourseFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of numbers and formulas, or a table of csv or rows")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<CourseFile, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(seq)).map(CourseFile::Each)
            }

            fn visit_newtype_struct<D: Deserializer<'de>>(self, choice: D) -> Result<CourseFile, D::Error> {
                Box::deserialize(choice).map(CourseFile::Table)
            }
        }
        deserializer.deserialize_newtype_struct(LIST_OR_CHOICE, CourseVisitor)
    }
}

impl JsonSchema for CourseFile {
    fn schema_name() -> Cow<'static, str> {
        "Course".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "Numbers over time: a list of numbers and formulas in t, or rows of a table.",
            "anyOf": [
                { "type": "array", "items": { "anyOf": [{ "type": "number" }, { "type": "string" }] } },
                generator.subschema_for::<CourseTableFile>()
            ]
        })
    }
}

impl<'de> Deserialize<'de> for FunctionFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct FunctionVisitor;
        impl<'de> Visitor<'de> for FunctionVisitor {
            type Value = FunctionFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a formula in t")
            }

            fn visit_newtype_struct<D: Deserializer<'de>>(self, value: D) -> Result<FunctionFile, D::Error> {
                value.deserialize_any(self)
            }

            fn visit_f64<E>(self, value: f64) -> Result<FunctionFile, E> {
                Ok(FunctionFile::Number(value))
            }

            fn visit_str<E>(self, formula: &str) -> Result<FunctionFile, E> {
                Ok(FunctionFile::Formula(FormulaText(formula.to_owned())))
            }
        }
        deserializer.deserialize_newtype_struct(FORMULA, FunctionVisitor)
    }
}
