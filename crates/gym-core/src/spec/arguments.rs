//! Arguments as data: one definition gives the constructor's struct, its JSON and its table.
//!
//! Spec, JSON, defaults, tables of the documentation and error texts follow from
//! [`arguments!`](crate::arguments!), for plugins too.

use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value as Json;

use crate::spec::Kwargs;
use crate::value::error::quoted;
use crate::value::{Error, Result};

/// A struct of arguments, such as an environment's `Config`. Write it with
/// [`arguments!`](crate::arguments!).
pub trait Arguments: Clone + PartialEq + Default + Serialize + DeserializeOwned {
    /// The table: each argument, in the order of the fields.
    fn table() -> Vec<Argument>;

    /// Sets an argument that is a number. Returns `false` if no such argument has this name.
    fn set_number(&mut self, name: &str, x: f64) -> bool;
}

/// One argument of an environment or a wrapper.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Argument {
    /// Its name in JSON and as a field.
    pub name: &'static str,
    /// Its type in the words of JSON, such as `number` or `list of 3 numbers`.
    pub kind: String,
    /// The unit, such as `m/s²`; empty if it has none.
    pub unit: &'static str,
    /// Its meaning.
    pub meaning: String,
    /// The versions of the id that take it, as a Rust pattern such as `1..`; empty for all of them.
    pub versions: &'static str,
    /// The value if it is not given.
    pub default: Json,
    /// Whether it must be given: it has no default and is not an `Option`.
    pub required: bool,
    takes: fn(u32) -> bool,
}

impl Argument {
    /// Whether an id of this version takes it.
    pub fn is_taken(&self, version: u32) -> bool {
        (self.takes)(version)
    }

    /// An entry of the table, without its default value: [`arguments!`](crate::arguments!) calls
    /// it.
    #[doc(hidden)]
    pub fn new<T: ArgumentType>(name: &'static str, unit: &'static str, docs: &str) -> Self {
        let meaning = docs.split_whitespace().collect::<Vec<_>>().join(" ");
        Self {
            name,
            kind: T::kind(),
            unit,
            meaning,
            versions: "",
            default: Json::Null,
            required: false,
            takes: |_| true,
        }
    }

    /// Makes it required if it has no default expression and its type is not optional.
    #[doc(hidden)]
    #[must_use]
    pub fn required(mut self, optional: bool, default: &str) -> Self {
        self.required = !optional && default.is_empty();
        self
    }

    /// Restricts it to some versions.
    #[doc(hidden)]
    #[must_use]
    pub fn versions(mut self, versions: &'static str, takes: fn(u32) -> bool) -> Self {
        (self.versions, self.takes) = (versions, takes);
        self
    }
}

/// The arguments that a version takes, each with its value in `defaults`.
pub fn table<C: Arguments>(defaults: &C, version: u32) -> Vec<Argument> {
    let values = serde_json::to_value(defaults).unwrap_or_default();
    let mut table = C::table();
    table.retain(|argument| argument.is_taken(version));
    for argument in &mut table {
        argument.default = values.get(argument.name).cloned().unwrap_or_default();
    }
    table
}

/// The arguments from JSON; missing ones have their value in `defaults`.
///
/// # Errors
/// [`Error::InvalidArgument`] about `whose` arguments for a name that the version does not take,
/// and for a value of another type.
pub fn read<C: Arguments>(defaults: &C, version: u32, given: &Kwargs, whose: &str) -> Result<C> {
    if given.is_empty() {
        return Ok(defaults.clone());
    }
    check_names(&C::table(), version, given)
        .and_then(|()| merge(serde_json::to_value(defaults), given))
        .and_then(|all| {
            parse(all).map_err(|error| explain(&error, given, |one| parse::<C>(one).is_err()))
        })
        .map_err(|reason| Error::argument(whose, reason))
}

// not in the macro, so that the compiler makes one copy of these functions (of `parse`, one for
// each type), not one for each call

/// An error text that names the argument missing from the table, for this version.
fn check_names(
    table: &[Argument],
    version: u32,
    given: &Kwargs,
) -> std::result::Result<(), String> {
    let taken = || {
        table
            .iter()
            .filter(|argument| argument.is_taken(version))
            .map(|argument| argument.name)
    };
    let Some(unknown) = given
        .keys()
        .find(|name| taken().all(|taken| taken != *name))
    else {
        return Ok(());
    };
    let near = crate::spec::nearest(unknown, taken());
    let near = near
        .map(|near| format!(": did you mean `{near}`?"))
        .unwrap_or_default();
    Err(
        match taken()
            .map(|name| format!("`{name}`"))
            .collect::<Vec<_>>()
            .join(", ")
        {
            none if none.is_empty() => {
                format!(
                    "unknown argument `{}`: it takes no arguments",
                    quoted(unknown)
                )
            }
            all => format!(
                "unknown argument `{}`{near} (known are {all})",
                quoted(unknown)
            ),
        },
    )
}

/// The default values, overridden by the given ones.
fn merge(
    defaults: serde_json::Result<Json>,
    given: &Kwargs,
) -> std::result::Result<Kwargs, String> {
    let Json::Object(mut all) = defaults.map_err(|error| error.to_string())? else {
        return Err("arguments are a JSON object".into());
    };
    all.extend(
        given
            .iter()
            .map(|(name, value)| (name.clone(), value.clone())),
    );
    Ok(all)
}

#[inline(never)]
fn parse<C: Arguments>(arguments: Kwargs) -> std::result::Result<C, String> {
    serde_json::from_value(Json::Object(arguments)).map_err(|error| error.to_string())
}

/// Returns serde's message, preceded by the name of the wrong argument, which serde does not tell.
/// `fails` tells whether the arguments are invalid.
fn explain(error: &str, given: &Kwargs, fails: fn(Kwargs) -> bool) -> String {
    let mut alone = given
        .iter()
        .map(|(name, value)| (name, Kwargs::from_iter([(name.clone(), value.clone())])));
    let wrong = alone
        .find_map(|(name, one)| fails(one).then(|| format!("`{name}`: ")))
        .unwrap_or_default();
    let hint = if error.contains("invalid type: null") {
        " (NaN and infinite numbers become null: give a finite number)"
    } else {
        ""
    };
    format!("{wrong}{error}{hint}")
}

/// The type of an argument. Implement it for types of your own that are arguments.
pub trait ArgumentType {
    /// Whether an argument of this type without a default may be left out.
    const OPTIONAL: bool = false;

    /// The type in the words of JSON: `boolean`, `number`, `list of strings`.
    fn kind() -> String;

    /// Converts a number to this type, if it is a number type.
    fn from_number(x: f64) -> Option<Self>
    where
        Self: Sized,
    {
        let _ = x;
        None
    }
}

impl ArgumentType for f64 {
    fn kind() -> String {
        f32::kind()
    }

    fn from_number(x: f64) -> Option<f64> {
        Some(x)
    }
}

macro_rules! kinds {
    ($($kind:literal: $($type:ty),+;)+) => {
        $($(
            impl ArgumentType for $type {
                fn kind() -> String {
                    $kind.to_owned()
                }
            }
        )+)+
    };
}

kinds! {
    "boolean": bool;
    "number": f32;
    "integer": i8, i16, i32, i64, u8, u16, u32, u64, usize;
    "string": String, std::path::PathBuf;
    "object": serde_json::Map<String, Json>;
    "any value": Json;
    "type of number": crate::value::DType;
}

impl<T: ArgumentType> ArgumentType for Option<T> {
    const OPTIONAL: bool = true;

    fn kind() -> String {
        format!("{} or null", T::kind())
    }

    fn from_number(x: f64) -> Option<Self> {
        T::from_number(x).map(Some)
    }
}

impl<T: ArgumentType> ArgumentType for Vec<T> {
    fn kind() -> String {
        format!("list of {}s", T::kind())
    }
}

impl<T: ArgumentType, const N: usize> ArgumentType for [T; N] {
    fn kind() -> String {
        format!("list of {N} {}s", T::kind())
    }
}

/// Defines a struct of arguments: with serde, [`Default`], and the table of [`Arguments`].
///
/// A field without a default value must be given in JSON, unless it is an `Option`; `Default` uses
/// the default of its type. A field has documentation, optionally a unit and the versions of the id
/// that have it, and a default value. A field with `#[flatten]` is another such struct and
/// contributes its arguments; its default value may be left out, and `#[flatten(name = 3..)]`
/// changes the versions of one of them. `AsRef` and `AsMut` give the flattened struct.
///
/// `const struct` also defines the constant `DEFAULT` with the default values.
///
/// The crate needs `serde` with the feature `derive`. Types without a JSON counterpart must
/// implement [`ArgumentType`].
///
/// ```
/// gym_core::arguments! {
///     /// Arguments.
///     #[derive(Copy)]
///     pub struct Config {
///         /// Acceleration of gravity.
///         #[unit = "m/s²"]
///         pub gravity: f64 = 9.8,
///         /// Whether each step is worth 0, and the last one -1.
///         #[versions = 1..]
///         pub sutton_barto_reward: bool = false,
///     }
/// }
/// # fn main() {
/// use gym_core::Arguments;
///
/// assert_eq!(Config::default(), Config { gravity: 9.8, sutton_barto_reward: false });
/// let table = Config::table();
/// assert_eq!((table[0].name, &*table[0].kind, table[0].unit), ("gravity", "number", "m/s²"));
/// assert_eq!(table[0].meaning, "Acceleration of gravity.");
/// assert!(table[1].is_taken(1) && !table[1].is_taken(0));
/// # }
/// ```
#[macro_export]
macro_rules! arguments {
    (
        $(#[$meta:meta])*
        $visibility:vis struct $name:ident {
            $(
                $(#[doc = $docs:literal])*
                $(#[unit = $unit:literal])?
                $(#[versions = $versions:pat])?
                $(#[flatten $(($($other:ident = $when:pat),+))?])?
                pub $field:ident: $type:ty $(= $default:expr)?
            ),* $(,)?
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, ::serde::Serialize, ::serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        $visibility struct $name {
            $(
                $(#[doc = $docs])*
                $(#[doc = concat!("\n\nUnit: ", $unit, ".")])?
                $(#[doc = concat!("\n\nVersions: `", stringify!($versions), "`.")])?
                $(
                    #[serde(flatten)]
                    $($(#[doc = concat!("\n\nVersions of `", stringify!($other), "`: `", stringify!($when), "`.")])+)?
                )?
                pub $field: $type,
            )*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $crate::arguments!(@default $($default)?)),* }
            }
        }

        impl $crate::Arguments for $name {
            fn table() -> Vec<$crate::Argument> {
                <[Vec<$crate::Argument>]>::concat(&[$($crate::arguments!(
                    @rows $field: $type, concat!($($unit)?), concat!($($docs, "\n"),*), [$($versions)?],
                    [$(flatten $($($other = $when),+)?)?], [$($default)?]
                )),*])
            }

            fn set_number(&mut self, name: &str, x: f64) -> bool {
                $($crate::arguments!(@number self, name, x, $field, [$(flatten $($($other),+)?)?]);)*
                let _ = (name, x);
                false
            }
        }

        $($crate::arguments!(@as_ref $name, $field: $type, [$(flatten $($($other),+)?)?]);)*
    };
    (@as_ref $name:ident, $field:ident: $type:ty, []) => {};
    (@as_ref $name:ident, $field:ident: $type:ty, [flatten $($other:ident),*]) => {
        impl AsRef<$type> for $name {
            fn as_ref(&self) -> &$type {
                &self.$field
            }
        }

        impl AsMut<$type> for $name {
            fn as_mut(&mut self) -> &mut $type {
                &mut self.$field
            }
        }
    };
    (@number $self:ident, $name:ident, $x:ident, $field:ident, []) => {
        if $name == stringify!($field) {
            let value = $crate::ArgumentType::from_number($x);
            let is_number = value.is_some();
            value.into_iter().for_each(|value| $self.$field = value);
            return is_number;
        }
    };
    (@number $self:ident, $name:ident, $x:ident, $field:ident, [flatten $($other:ident),*]) => {
        if $crate::Arguments::set_number(&mut $self.$field, $name, $x) {
            return true;
        }
    };
    ($(#[$meta:meta])* $visibility:vis const struct $name:ident { $($body:tt)* }) => {
        $crate::arguments! { $(#[$meta])* $visibility struct $name { $($body)* } }
        $crate::arguments! { @constant $name { $($body)* } }
    };
    (@constant $name:ident { $($(#[$meta:meta])* pub $field:ident: $type:ty = $default:expr),* $(,)? }) => {
        impl $name {
            /// The default values.
            pub const DEFAULT: Self = Self { $($field: $default),* };
        }
    };
    (@default) => { Default::default() };
    (@default $default:expr) => { $default };
    (@rows $field:ident: $type:ty, $unit:expr, $docs:expr, [$($versions:pat)?], [], [$($default:expr)?]) => {
        vec![
            $crate::Argument::new::<$type>(stringify!($field), $unit, $docs)
                $(.versions(stringify!($versions), |version| matches!(version, $versions)))?
                .required(<$type as $crate::ArgumentType>::OPTIONAL, stringify!($($default)?)),
        ]
    };
    (@rows $field:ident: $type:ty, $unit:expr, $docs:expr, [], [flatten $($other:ident = $when:pat),*], [$($default:expr)?]) => {
        <$type as $crate::Arguments>::table()
            .into_iter()
            .map(|argument| match argument.name {
                $(stringify!($other) => argument.versions(stringify!($when), |version| matches!(version, $when)),)*
                _ => argument,
            })
            .collect()
    };
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    crate::arguments! {
        /// Of a picture.
        #[derive(Copy, Eq)]
        pub(crate) struct Picture {
            /// Width
            /// of the picture.
            #[unit = "px"]
            #[versions = 4..]
            pub width: u32 = 480,
            /// The camera.
            #[versions = 3 | 5..]
            pub camera: Option<i64>,
        }
    }

    crate::arguments! {
        /// Arguments.
        pub(crate) struct Config {
            /// Gravity.
            #[unit = "m/s²"]
            pub gravity: f64 = -9.8,
            /// The map.
            pub desc: Option<Vec<String>>,
            /// The picture.
            #[flatten(camera = 2..)]
            pub picture: Picture = Picture { width: 64, ..Picture::default() },
            /// Rewards.
            pub rewards: [f64; 3] = [1.0, 0.0, 0.0],
        }
    }

    #[test]
    fn the_table_says_each_fact() {
        let table = table(&Config::default(), 5);
        let row = |i: usize| {
            let Argument {
                name,
                kind,
                unit,
                meaning,
                versions,
                default,
                ..
            } = &table[i];
            json!([name, kind, unit, meaning, versions, default])
        };
        assert_eq!(
            row(0),
            json!(["gravity", "number", "m/s²", "Gravity.", "", -9.8])
        );
        assert_eq!(
            row(1),
            json!(["desc", "list of strings or null", "", "The map.", "", null])
        );
        assert_eq!(
            row(2),
            json!(["width", "integer", "px", "Width of the picture.", "4..", 64])
        );
        assert_eq!(
            row(3),
            json!(["camera", "integer or null", "", "The camera.", "2..", null])
        );
        assert_eq!(row(4)[1], json!("list of 3 numbers"));
        assert_eq!(table.len(), 5);
    }

    #[test]
    fn versions_decide_what_is_taken() {
        let names = |version| {
            table(&Config::default(), version)
                .iter()
                .map(|argument| argument.name)
                .collect::<Vec<_>>()
        };
        assert_eq!(names(1), ["gravity", "desc", "rewards"]);
        assert_eq!(names(3), ["gravity", "desc", "camera", "rewards"]);
        let names: Vec<_> = Picture::table()
            .into_iter()
            .filter(|row| row.is_taken(4))
            .map(|row| row.name)
            .collect();
        assert_eq!(
            names,
            ["width"],
            "flattening elsewhere changes nothing here"
        );
    }

    fn given(json: &Json) -> Result<Config> {
        let given = json.as_object().expect("an object").clone();
        read(
            &Config {
                gravity: 1.0,
                ..Config::default()
            },
            4,
            &given,
            "`A-v4`",
        )
    }

    #[test]
    fn what_is_given_goes_before_the_defaults() {
        let config = given(&json!({"camera": 2, "desc": ["S"]})).unwrap();
        assert_eq!(
            (config.gravity, config.picture),
            (
                1.0,
                Picture {
                    width: 64,
                    camera: Some(2)
                }
            )
        );
        assert_eq!(config.desc, Some(vec!["S".to_owned()]));
        let stored = serde_json::to_value(&config).unwrap();
        assert_eq!(stored["width"], 64, "flat in JSON too");
        assert_eq!(serde_json::from_value::<Config>(stored).unwrap(), config);
    }

    #[test]
    fn errors_name_the_argument() {
        let message = |json: Json| given(&json).unwrap_err().to_string();
        let unknown = message(json!({"gravty": 1.0}));
        assert!(
            unknown.contains("`gravty`: did you mean `gravity`? (known are `gravity`, `desc`"),
            "{unknown}"
        );
        let kind = message(json!({"gravity": 1.0, "width": "wide"}));
        assert!(
            kind.contains("`A-v4`") && kind.contains("`width`: invalid type: string"),
            "{kind}"
        );
        let null = message(json!({"gravity": null}));
        assert!(null.contains("NaN"), "{null}");
        assert!(serde_json::from_value::<Config>(json!({"gravty": 1.0})).is_err());
        let old = read(&Picture::default(), 1, &given_one("width"), "`A-v1`")
            .unwrap_err()
            .to_string();
        assert!(
            old.contains("unknown argument `width`: it takes no arguments"),
            "{old}"
        );
    }

    #[test]
    fn numbers_are_set_by_name() {
        let mut config = Config::default();
        assert!(config.set_number("gravity", 2.5) && config.gravity == 2.5);
        assert!(
            !config.set_number("width", 2.0)
                && !config.set_number("rewards", 2.0)
                && !config.set_number("none", 2.0)
        );
    }

    fn given_one(name: &str) -> Kwargs {
        [(name.to_owned(), json!(1))].into_iter().collect()
    }
}
