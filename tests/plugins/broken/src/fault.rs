//! What can be wrong with an environment.

use serde::{Deserialize, Serialize};

/// A fault, named after the check that finds it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "each is explained where `Walk` commits it")]
pub enum Fault {
    #[default]
    None,
    ActionAccepted,
    ActionNormalised,
    ActionValidated,
    AnyThread,
    CloneApart,
    CloneContinues,
    Constructs,
    Described,
    DrawingPure,
    DrawingSound,
    ExceptionsKnown,
    GeneratorLent,
    InfoConsistent,
    MetadataComplete,
    NoAllocation,
    NoPanic,
    ObservationDtype,
    ObservationFinite,
    ObservationInSpace,
    ObservationWhole,
    OptionsIgnored,
    OtherSeedOtherEpisode,
    RefusalChangesNothing,
    RenderModes,
    ResetCarriesOn,
    ResetForgets,
    ResetNeeded,
    Resets,
    RewardFinite,
    SameSeedSameEpisode,
    SnapshotContinues,
    SnapshotRefused,
    SpaceBounded,
    SpaceConstant,
    SpaceNotEmpty,
    SpaceWidth,
    TimeLimit,
}
