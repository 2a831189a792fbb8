//! How a group of settings is written.

/// Writes a group of settings once: each field with its name in files, its default and its description.
macro_rules! group {
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

            /// Shows each setting with its description to `edit`, and takes what that makes of it.
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
