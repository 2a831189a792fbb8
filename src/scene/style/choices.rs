//! Enums whose variants have words, which stand on the command line and in files.

/// Writes an enum of unit variants once: its list, its words, titles and hints, and how a word is read back, also in
/// files. With `auto`, a setting may leave the choice open, as a [`Choice`](super::Choice) of it: then comes the
/// variant where nothing decides otherwise, with the title and the hint of the open choice.
macro_rules! choices {
    (
        $(#[$doc:meta])* $name:ident, $what:literal, auto $usual:ident = $auto_title:literal, $auto_hint:literal {
            $($(#[$variant_doc:meta])* $variant:ident = $word:literal, $title:literal, $hint:literal
                $(, also [$($also:literal),+])?;)+
        }
    ) => {
        $crate::scene::style::choices! {
            $(#[$doc])* $name, $what {
                $($(#[$variant_doc])* $variant = $word, $title, $hint $(, also [$($also),+])?;)+
            }
        }

        impl $crate::scene::style::Automatic for $name {
            const USUAL: Self = Self::$usual;

            const OPEN_WORDS: &'static $crate::scene::describe::Words = &$crate::scene::describe::Words {
                what: $what,
                list: &[
                    $crate::scene::describe::Word {
                        word: "auto", title: $auto_title, hint: $auto_hint, also: &[],
                    },
                    $($crate::scene::describe::Word {
                        word: $word, title: $title, hint: $hint, also: &[$($($also),+)?],
                    }),+
                ],
            };
        }
    };
    (
        $(#[$doc:meta])* $name:ident, $what:literal {
            $($(#[$variant_doc:meta])* $variant:ident = $word:literal, $title:literal, $hint:literal
                $(, also [$($also:literal),+])?;)+
        }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $name { $(#[doc = concat!($hint, ".")] $(#[$variant_doc])* $variant,)+ }

        impl $name {
            /// Every choice, in the order the window lists them.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// Names of the choices, in the same order.
            pub const WORDS: &'static $crate::scene::describe::Words = &$crate::scene::describe::Words {
                what: $what,
                list: &[$($crate::scene::describe::Word {
                        word: $word, title: $title, hint: $hint, also: &[$($($also),+)?],
                    }),+],
            };

            /// The word for it on the command line and in reports.
            pub fn name(self) -> &'static str {
                Self::WORDS.list[self as usize].word
            }
        }

        impl $crate::scene::describe::Setting for $name {
            type Decided = Self;

            fn decided(&self) -> Self {
                *self
            }

            fn value(&self) -> $crate::scene::describe::Value {
                $crate::scene::describe::Value::Word(*self as usize)
            }

            fn from_value(value: $crate::scene::describe::Value) -> Option<Self> {
                match value {
                    $crate::scene::describe::Value::Word(place) => Self::ALL.get(place).copied(),
                    _ => None,
                }
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.name())
            }
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let text = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
                text.parse().map_err(serde::de::Error::custom)
            }
        }

        impl std::str::FromStr for $name {
            type Err = $crate::scene::ParseChoiceError;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                Self::WORDS.place_of(text).map(|place| Self::ALL[place])
            }
        }
    };
}
pub(crate) use choices;
