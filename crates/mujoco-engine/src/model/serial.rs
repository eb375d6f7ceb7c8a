//! The serialised form of a model, compiled once.
//!
//! What serde derives is generic over the format, and would be compiled again in each crate that
//! stores a model. Here the format is behind a pointer.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::CompiledModel;

impl Serialize for CompiledModel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        erased_serde::serialize(erased(&Fields(self)), serializer)
    }
}

impl<'de> Deserialize<'de> for CompiledModel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        read(&mut <dyn erased_serde::Deserializer<'_>>::erase(
            deserializer,
        ))
        .map_err(D::Error::custom)
    }
}

/// What serde derived.
struct Fields<'a>(&'a CompiledModel);

impl Serialize for Fields<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        CompiledModel::serialize(self.0, serializer)
    }
}

fn erased<'a>(fields: &'a Fields<'_>) -> &'a dyn erased_serde::Serialize {
    fields
}

fn read(
    deserializer: &mut dyn erased_serde::Deserializer<'_>,
) -> erased_serde::Result<CompiledModel> {
    CompiledModel::deserialize(deserializer)
}
