//! Macro syntax of a group of settings.

/// Writes a group of settings once: each field with its name in files, its default and its description. `decided` names
/// the type of the same group with no choice left open; where none can be left open, the group is its own.
macro_rules! group {
    (
        $(#[$doc:meta])* $group:ident decided $decided:ident {
            $(
                $(#[doc = $field_doc:literal])* $(#[serde($($serde:tt)*)])?
                $field:ident: $type:ty = $default:expr, $key:literal $described:ident { $($text:tt)* }
            )+
        }
    ) => {
        $crate::scene::style::describe::group! {
            $(#[$doc])* ///
            /// Some may be left open.
            $group {
                $(
                    $(#[doc = $field_doc])* $(#[serde($($serde)*)])?
                    $field: $type = $default, $key $described { $($text)* }
                )+
            }
        }

        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $decided {
            $($(#[doc = $field_doc])* pub $field: <$type as $crate::scene::describe::Setting>::Decided,)+
        }

        impl $group {
            /// Returns the group with every open choice replaced by its default.
            pub(super) fn decided(&self) -> $decided {
                $decided { $($field: $crate::scene::describe::Setting::decided(&self.$field),)+ }
            }
        }

        impl Default for $decided {
            fn default() -> Self {
                $group::default().decided()
            }
        }
    };
    (
        $(#[$doc:meta])* $group:ident {
            $(
                $(#[$field_doc:meta])*
                $field:ident: $type:ty = $default:expr, $key:literal $described:ident { $($text:tt)* }
            )+
        }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(default)]
        pub struct $group {
            $($(#[$field_doc])* #[serde(rename = $key)] pub $field: $type,)+
        }

        impl $group {
            $(
                #[doc = concat!("The description of `", stringify!($field), "`.")]
                pub const $described: $crate::scene::describe::Described = $crate::scene::describe::Described {
                    key: $key,
                    $($text)*
                    ..$crate::scene::describe::Described::USUAL
                };
            )+

            /// Shows each setting with its description to `edit`, and takes the edited value.
            pub(super) fn edit(
                &mut self,
                edit: &mut dyn FnMut(
                    &'static $crate::scene::describe::Described,
                    $crate::scene::describe::Value,
                ) -> $crate::scene::describe::Value,
            ) {
                $($crate::scene::describe::Setting::edit(&mut self.$field, &Self::$described, edit);)+
            }
        }

        impl Default for $group {
            fn default() -> Self {
                Self { $($field: $default,)+ }
            }
        }
    };
}
pub(in crate::scene::style) use group;
