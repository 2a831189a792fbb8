//! Schema of a frame: the attributes it has and how each is written.

use super::floats::{Floats, Lattice};
use crate::reel::error::Fault;
use crate::reel::file::{ByteReader, ByteWriter};
use crate::reel::options::Coding;
use crate::reel::parent_level::ParentValue;

/// Kind of data in a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum StreamKind {
    /// Masks of the octree.
    Geometry,
    /// Numbers of points in cells, and coordinates below cells.
    Position,
    /// Colours without alpha.
    Color,
    /// Normals.
    Normal,
    /// Offsets along normals.
    Offset,
    /// Alpha.
    Alpha,
    /// Radii.
    Radius,
    /// All scalars.
    Scalar,
    /// Ellipses.
    Ellipse,
    /// The order of the file.
    Order,
    /// Displacement of points since the previous frame.
    Motion,
}

impl StreamKind {
    /// Every kind, in the order in which streams stand.
    pub const ALL: [Self; 11] = [
        Self::Geometry,
        Self::Position,
        Self::Color,
        Self::Normal,
        Self::Offset,
        Self::Alpha,
        Self::Radius,
        Self::Scalar,
        Self::Ellipse,
        Self::Order,
        Self::Motion,
    ];

    /// A word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Geometry => "geometry",
            Self::Position => "position",
            Self::Color => "color",
            Self::Normal => "normal",
            Self::Offset => "offset",
            Self::Alpha => "alpha",
            Self::Radius => "radius",
            Self::Scalar => "scalar",
            Self::Ellipse => "ellipse",
            Self::Order => "order",
            Self::Motion => "motion",
        }
    }
}

/// Stored position data of points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) enum Retained {
    /// One point a cell.
    Merged,
    /// Every point, with this number of bits below its cell along each axis.
    Bits(u8),
    /// Every point with its floats.
    Exact,
}

/// Encoding of single numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::reel) enum Values {
    /// There are none.
    None,
    /// In steps, on every level.
    Stepped,
    /// In steps on the levels, and as they are for the points.
    Exact,
}

/// A scalar field.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct ScalarSchema {
    pub(in crate::reel) name: String,
    /// Bits of its steps: code 0 is a missing number, the others go from `min` to `max`.
    pub(in crate::reel) bits: u8,
    pub(in crate::reel) min: f32,
    pub(in crate::reel) max: f32,
    /// True if values are labels, which have no mean.
    pub(in crate::reel) is_label: bool,
}

impl ScalarSchema {
    fn steps(&self) -> f64 {
        f64::from((1u32 << self.bits) - 2).max(1.0)
    }

    /// The largest code.
    pub(in crate::reel) fn max_code(&self) -> u16 {
        ((1u32 << self.bits) - 1) as u16
    }

    /// The code of a value.
    pub(in crate::reel) fn code(&self, value: f32) -> u16 {
        if value.is_nan() {
            return 0;
        }
        let range = f64::from(self.max) - f64::from(self.min);
        let part = if range > 0.0 {
            (f64::from(value) - f64::from(self.min)) / range
        } else {
            0.0
        };
        1 + (part * self.steps()).round().clamp(0.0, self.steps()) as u16
    }

    /// The value of a code.
    pub(in crate::reel) fn value(&self, code: u16) -> f32 {
        if code == 0 {
            return f32::NAN;
        }
        let range = f64::from(self.max) - f64::from(self.min);
        (f64::from(self.min) + range * f64::from(code - 1) / self.steps()) as f32
    }
}

/// Schema of a frame: the attributes it has and how each is written.
#[expect(clippy::struct_excessive_bools, reason = "each is a bit of the file")]
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reel) struct Schema {
    /// Coding of the geometry.
    pub(in crate::reel) coding: Coding,
    /// True if values are predicted from their parents alone: in the fast coding, except in files of version 3.0.
    pub(in crate::reel) is_flat: bool,
    /// True if coordinates are double-precision.
    pub(in crate::reel) is_double: bool,
    pub(in crate::reel) retained: Retained,
    /// True if each cell states how many of the bits below it its points have.
    pub(in crate::reel) has_cell_bits: bool,
    /// Lattice of the coordinates, if they are stored to the last bit.
    pub(in crate::reel) lattice: Option<Lattice>,
    pub(in crate::reel) has_order: bool,
    /// An odd step of colours, or 0 without any.
    pub(in crate::reel) color_step: u8,
    /// Colours of nodes that have children, or several points.
    pub(in crate::reel) color_of_parents: ParentValue,
    pub(in crate::reel) has_alpha: bool,
    /// 13, 15 or 17, or 0 without any.
    pub(in crate::reel) normal_bits: u8,
    pub(in crate::reel) has_exact_normals: bool,
    /// True if some points have no normal.
    pub(in crate::reel) normals_may_miss: bool,
    pub(in crate::reel) offset_bits: u8,
    pub(in crate::reel) radii: Values,
    pub(in crate::reel) has_ellipses: bool,
    pub(in crate::reel) scalars: Vec<ScalarSchema>,
    pub(in crate::reel) has_exact_scalars: bool,
}

impl Schema {
    pub(in crate::reel) fn write(&self, writer: &mut ByteWriter) {
        let flags = [
            self.is_double,
            self.has_order,
            self.has_alpha,
            self.has_exact_normals,
            self.normals_may_miss,
            self.radii != Values::None,
            self.radii == Values::Exact,
            self.has_ellipses,
            self.has_exact_scalars,
            self.coding == Coding::Fast,
            self.lattice.is_some(),
            self.is_flat,
            self.has_cell_bits,
            self.color_of_parents == ParentValue::FirstChild,
        ];
        let bits = flags
            .iter()
            .enumerate()
            .map(|(bit, &is_set)| u64::from(is_set) << bit)
            .sum();
        writer.number(bits);
        writer.byte(match self.retained {
            Retained::Merged => 0,
            Retained::Exact => 255,
            Retained::Bits(bits) => 1 + bits,
        });
        writer.byte(self.color_step);
        writer.byte(self.normal_bits);
        writer.byte(self.offset_bits);
        if let Some(lattice) = self.lattice {
            lattice.write(writer);
        }
        writer.number(self.scalars.len() as u64);
        for scalar in &self.scalars {
            writer.text(&scalar.name);
            writer.byte(scalar.bits | u8::from(scalar.is_label) << 7);
            writer.f32(scalar.min);
            writer.f32(scalar.max);
        }
    }

    pub(in crate::reel) fn read(reader: &mut ByteReader<'_>) -> Result<Self, Fault> {
        let bits = reader.number()?;
        if bits >= 1 << 14 {
            return Err(Fault::new(format!(
                "attributes of kinds that only a later version of pointreel knows ({bits:#b}): update it"
            )));
        }
        let flag = |bit: u32| bits >> bit & 1 != 0;
        let retained = match reader.byte()? {
            0 => Retained::Merged,
            255 => Retained::Exact,
            bits @ 1..=51 => Retained::Bits(bits - 1),
            found => return Err(Fault::new(format!("positions of an unknown kind ({found})"))),
        };
        let [color_step, normal_bits, offset_bits] = [reader.byte()?, reader.byte()?, reader.byte()?];
        if color_step > 0 && color_step % 2 == 0 || ![0, 13, 15, 17].contains(&normal_bits) || offset_bits > 4 {
            return Err(Fault::new(format!(
                "colours in steps of {color_step}, normals of {normal_bits} bits and offsets of {offset_bits} bits"
            )));
        }
        let lattice = flag(10).then(|| Lattice::read(reader)).transpose()?;
        let mut scalars = Vec::new();
        for _ in 0..reader.count("scalars")? {
            let name = reader.text()?;
            let bits = reader.byte()?;
            let scalar = ScalarSchema {
                name,
                bits: bits & 0x7f,
                is_label: bits >> 7 != 0,
                min: reader.f32()?,
                max: reader.f32()?,
            };
            if !(2..=16).contains(&scalar.bits) {
                return Err(Fault::new(format!("a scalar of {} bits", scalar.bits)));
            }
            scalars.push(scalar);
        }
        Ok(Self {
            coding: if flag(9) { Coding::Fast } else { Coding::Compact },
            is_flat: flag(11),
            is_double: flag(0),
            retained,
            has_cell_bits: flag(12),
            lattice,
            has_order: flag(1),
            color_step,
            color_of_parents: if flag(13) {
                ParentValue::FirstChild
            } else {
                ParentValue::Mean
            },
            has_alpha: flag(2),
            normal_bits,
            has_exact_normals: flag(3),
            normals_may_miss: flag(4),
            offset_bits: if normal_bits == 0 { 0 } else { offset_bits },
            radii: match (flag(5), flag(6)) {
                (false, _) => Values::None,
                (true, false) => Values::Stepped,
                (true, true) => Values::Exact,
            },
            has_ellipses: flag(7),
            scalars,
            has_exact_scalars: flag(8),
        })
    }

    /// The numbers that coordinates may be.
    pub(super) fn floats(&self) -> Floats {
        Floats {
            is_double: self.is_double,
            lattice: self.lattice,
        }
    }

    /// Returns true if any attribute of nodes is coded in addition to their positions.
    pub(in crate::reel) fn has_values(&self) -> bool {
        self.color_step > 0 || self.normal_bits > 0 || self.offset_bits > 0 || self.singles() > 0
    }

    /// Numbers that a node has one each of: alpha, radius, scalars, in this order.
    pub(in crate::reel) fn singles(&self) -> usize {
        usize::from(self.has_alpha) + usize::from(self.radii != Values::None) + self.scalars.len()
    }

    /// The largest code of a single number.
    pub(in crate::reel) fn max_code(&self, single: usize) -> u16 {
        let before = self.singles() - self.scalars.len();
        single
            .checked_sub(before)
            .map_or(255, |scalar| self.scalars[scalar].max_code())
    }

    /// Returns the index of the single number that is the radius.
    pub(in crate::reel) fn radius_single(&self) -> Option<usize> {
        (self.radii != Values::None).then_some(usize::from(self.has_alpha))
    }

    /// Returns the stream kind of a single number.
    pub(in crate::reel) fn stream_of_single(&self, single: usize) -> StreamKind {
        match (single, self.has_alpha, self.radii != Values::None) {
            (0, true, _) => StreamKind::Alpha,
            (0, false, true) | (1, true, true) => StreamKind::Radius,
            _ => StreamKind::Scalar,
        }
    }

    /// Bytes that a point takes while it is decoded, rounded up.
    pub(in crate::reel) fn bytes_per_point(&self) -> u64 {
        // Neighbours, plan, cells, values, and the cloud itself.
        250 + 16 * (self.scalars.len() as u64 + 4)
    }
}
