//! An attitude as it is written. The doc comments of this file are descriptions of the published JSON schema.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};

use super::at::At;

/// An attitude: a quaternion of any length, vector part first, or a turn about an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum AttitudeStartFile {
    /// As a quaternion.
    Quaternion([f64; 4]),
    /// As a turn.
    Turn(TurnFile),
}

/// A turn of the body from the inertial frame.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TurnFile {
    /// Turned about this axis, of any length.
    pub axis: At<[f64; 3]>,
    /// By this angle, in rad.
    pub angle_rad: At<f64>,
}

/// Where a spacecraft starts. Default: at rest, aligned with the inertial frame, wheels still.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WheelStartFile {
    /// Turned about this axis, of any length.
    pub axis: Option<At<[f64; 3]>>,
    /// By this angle, in rad.
    pub angle_rad: Option<At<f64>>,
    /// Or the attitude as a quaternion of any length, vector part first.
    pub quaternion: Option<At<[f64; 4]>>,
    /// Angular velocity in coordinates of the body, in rad/s.
    pub rate_rad_s: Option<At<[f64; 3]>>,
    /// Momentum of each wheel about its axis, in N m s.
    pub wheel_momentum_n_m_s: Option<At<Vec<At<f64>>>>,
}

impl<'de> Deserialize<'de> for AttitudeStartFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AttitudeVisitor;
        impl<'de> Visitor<'de> for AttitudeVisitor {
            type Value = AttitudeStartFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a quaternion of four numbers, vector part first, or { axis = [x, y, z], angle_rad = … }")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<AttitudeStartFile, A::Error> {
                let list = Vec::<f64>::deserialize(SeqAccessDeserializer::new(seq))?;
                let found = list.len();
                let four = list.try_into().map_err(|_| A::Error::invalid_length(found, &self))?;
                Ok(AttitudeStartFile::Quaternion(four))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<AttitudeStartFile, A::Error> {
                TurnFile::deserialize(MapAccessDeserializer::new(map)).map(AttitudeStartFile::Turn)
            }
        }
        deserializer.deserialize_any(AttitudeVisitor)
    }
}

impl JsonSchema for AttitudeStartFile {
    fn schema_name() -> Cow<'static, str> {
        "AttitudeStart".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "An attitude: a quaternion of any length, vector part first, or a turn about an axis.",
            "anyOf": [
                { "type": "array", "items": { "type": "number" }, "minItems": 4, "maxItems": 4 },
                generator.subschema_for::<TurnFile>()
            ]
        })
    }
}
