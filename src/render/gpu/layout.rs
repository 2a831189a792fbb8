//! Structures that Rust and WGSL share are declared once, in Rust: [`shared_struct`] makes the WGSL of it.

use std::fmt::Write;

/// A structure as WGSL declares it.
#[derive(Debug)]
pub struct Layout {
    /// Its name in WGSL.
    pub name: &'static str,
    /// Bytes of the whole.
    pub size: usize,
    /// In their order.
    pub members: &'static [Member],
}

/// A member of a structure.
#[derive(Debug)]
pub struct Member {
    /// Member name, the same in Rust and WGSL.
    pub name: &'static str,
    /// Bytes before it, in Rust. Tests hold it against WGSL, which has rules of its own.
    pub offset: usize,
    /// Its type in WGSL.
    wgsl_type: fn() -> String,
}

/// A structure with a [`Layout`].
pub(in crate::render) trait Shared {
    /// Its declaration.
    const LAYOUT: Layout;
}

impl Layout {
    /// The WGSL of the structure.
    pub(in crate::render) fn declaration(&self) -> String {
        let mut text = format!("struct {} {{\n", self.name);
        for Member { name, wgsl_type, .. } in self.members {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "    {name}: {},", wgsl_type());
        }
        text + "}\n"
    }
}

impl Member {
    /// Creates a member of this type.
    pub const fn new<T: SharedType>(name: &'static str, offset: usize) -> Self {
        Self {
            name,
            offset,
            wgsl_type: T::wgsl,
        }
    }
}

/// A type that members of shared structures have.
pub trait SharedType {
    /// Its name in WGSL.
    fn wgsl() -> String;
}

macro_rules! shared_types {
    ($($rust:ty: $wgsl:literal),+ $(,)?) => {
        $(impl SharedType for $rust {
            fn wgsl() -> String {
                $wgsl.to_owned()
            }
        })+
    };
}

shared_types! {
    f32: "f32",
    i32: "i32",
    u32: "u32",
    [f32; 2]: "vec2f",
    [f32; 3]: "vec3f",
    [f32; 4]: "vec4f",
    [i32; 2]: "vec2i",
    [u32; 2]: "vec2u",
}

impl<const COUNT: usize> SharedType for [[f32; 4]; COUNT] {
    fn wgsl() -> String {
        format!("array<vec4f, {COUNT}>")
    }
}

/// Declares a structure of Rust that has a [`Layout`].
macro_rules! shared_struct {
    ($(#[$of_struct:meta])* $visibility:vis $rust:ident as $wgsl:literal {
        $($(#[$of_member:meta])* $member:ident: $type:ty),+ $(,)?
    }) => {
        $(#[$of_struct])*
        #[repr(C)]
        #[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        $visibility struct $rust {
            $($(#[$of_member])* $visibility $member: $type),+
        }

        impl $crate::render::gpu::layout::Shared for $rust {
            const LAYOUT: $crate::render::gpu::layout::Layout = $crate::render::gpu::layout::Layout {
                name: $wgsl,
                size: size_of::<Self>(),
                members: &[
                    $($crate::render::gpu::layout::Member::new::<$type>(
                        stringify!($member),
                        std::mem::offset_of!(Self, $member),
                    )),+
                ],
            };
        }
    };
}

pub(in crate::render) use shared_struct;

#[cfg(test)]
mod tests {
    use super::*;

    shared_struct! {
        /// An example.
        Example as "Sample" {
            /// Three numbers.
            place: [f32; 3],
            /// One.
            count: u32,
            /// Several.
            rows: [[f32; 4]; 2],
        }
    }

    #[test]
    fn structures_are_declared_as_wgsl_reads_them() {
        let expected = "struct Sample {\n    place: vec3f,\n    count: u32,\n    rows: array<vec4f, 2>,\n}\n";
        assert_eq!(Example::LAYOUT.declaration(), expected);
        let offsets = Example::LAYOUT.members.iter().map(|member| member.offset);
        assert_eq!(offsets.collect::<Vec<_>>(), [0, 12, 16]);
        assert_eq!(Example::LAYOUT.size, 48);
    }
}
