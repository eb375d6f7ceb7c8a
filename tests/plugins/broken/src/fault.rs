//! The faults of environments.

use serde::{Deserialize, Serialize};

/// A fault, named after the check that finds it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "each is explained where `Walk` commits it")]
pub enum Fault {
    #[default]
    None,
    ActionAccepted,
    #[serde(rename = "action-accepted.held")]
    ActionAcceptedHeld,
    ActionNormalised,
    ActionValidated,
    #[serde(rename = "action-validated.one-element")]
    ActionValidatedOneElement,
    #[serde(rename = "action-validated.one-number")]
    ActionValidatedOneNumber,
    AnyThread,
    #[serde(rename = "any-thread.moved")]
    AnyThreadMoved,
    CloneApart,
    #[serde(rename = "clone-apart.late")]
    CloneApartLate,
    #[serde(rename = "clone-apart.closed")]
    CloneApartClosed,
    CloneContinues,
    Constructs,
    Described,
    DrawingFollows,
    DrawingPure,
    #[serde(rename = "drawing-pure.text")]
    DrawingPureText,
    DrawingSound,
    #[serde(rename = "drawing-sound.at-the-end")]
    DrawingSoundAtTheEnd,
    DrawingVisible,
    #[serde(rename = "drawing-visible.off-the-canvas")]
    DrawingVisibleOffTheCanvas,
    ExceptionsKnown,
    GeneratorLent,
    #[serde(rename = "generator-lent.fixed")]
    GeneratorLentFixed,
    InfoConstant,
    #[serde(rename = "info-constant.type")]
    InfoConstantType,
    InfoConsistent,
    #[serde(rename = "info-consistent.at-the-end")]
    InfoConsistentAtTheEnd,
    FrameRate,
    MetadataComplete,
    NoAllocation,
    NoPanic,
    #[serde(rename = "no-panic.at-the-end")]
    NoPanicAtTheEnd,
    ObservationDtype,
    ObservationFinite,
    ObservationInSpace,
    #[serde(rename = "observation-in-space.held")]
    ObservationInSpaceHeld,
    #[serde(rename = "observation-in-space.huge-action")]
    ObservationInSpaceHugeAction,
    ObservationWhole,
    OptionsAccepted,
    #[serde(rename = "options-accepted.no-json")]
    OptionsAcceptedNoJson,
    OptionsIgnored,
    OptionsMatter,
    OtherSeedOtherEpisode,
    #[serde(rename = "other-seed-other-episode.cut")]
    OtherSeedOtherEpisodeCut,
    RefusalChangesNothing,
    RenderModes,
    ResetCarriesOn,
    #[serde(rename = "reset-carries-on.to-the-next-seed")]
    ResetCarriesOnToTheNextSeed,
    ResetForgets,
    ResetNeeded,
    Resets,
    RewardFinite,
    #[serde(rename = "reward-finite.late")]
    RewardFiniteLate,
    SameSeedSameEpisode,
    #[serde(rename = "same-seed-same-episode.late")]
    SameSeedSameEpisodeLate,
    #[serde(rename = "same-seed-same-episode.interrupted")]
    SameSeedSameEpisodeInterrupted,
    SnapshotContinues,
    #[serde(rename = "snapshot-continues.late")]
    SnapshotContinuesLate,
    #[serde(rename = "snapshot-continues.used")]
    SnapshotContinuesUsed,
    #[serde(rename = "snapshot-continues.unused")]
    SnapshotContinuesUnused,
    SnapshotLegal,
    SnapshotRefused,
    #[serde(rename = "snapshot-refused.changes")]
    SnapshotRefusedChanges,
    SpaceBounded,
    SpaceConstant,
    SpaceNotEmpty,
    SpaceWidth,
    TimeLimit,
}
