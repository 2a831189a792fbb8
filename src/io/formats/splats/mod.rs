//! Gaussian splats: each point is an ellipsoid with three sizes, a rotation, an opacity, and a colour as spherical
//! harmonics (Kerbl et al. 2023).
//!
//! From most sides the two large axes of an ellipsoid are visible, so the splat lies across the smallest one: an
//! ellipse with these half axes, and their geometric mean for its radius. They are shown as disks of that radius, which
//! keeps the area. The harmonics' constant term is the colour seen on average from all sides; those that change with
//! direction are ignored.

pub(in crate::io) mod arrays;
pub(in crate::io) mod bare;
pub(in crate::io) mod spz;

use crate::cloud::{AxisConvention, Ellipse, RawCloud};
use glam::{Mat3, Quat, Vec3};

/// Memory of a splat in a cloud: position, colour, normal, radius, ellipse; the lists of shapes grow as they are
/// created.
pub(super) const SPLAT_BYTES: usize = 16 + 2 * 32;

/// Constant term of spherical harmonics: 1 / (2 √π).
const HARMONIC: f32 = 0.282_094_79;

/// Half the root of 2: no other part of a unit quaternion than its largest is beyond it.
pub(super) const LARGEST_OF_OTHERS: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// Constant terms of harmonics as 8 bits, made by `channel`; NaNs are grey, and counted.
pub(super) fn colors_of_harmonics(
    [red, green, blue]: [&[f32]; 3],
    channel: impl Fn(f32) -> u8,
) -> (Vec<[u8; 4]>, usize) {
    const GREY: u8 = 128;
    let mut broken = 0;
    let color = |((&red, &green), &blue): ((&f32, &f32), &f32)| {
        let harmonics = [red, green, blue];
        if harmonics.iter().any(|harmonic| harmonic.is_nan()) {
            broken += 1;
            return [GREY, GREY, GREY, u8::MAX];
        }
        let [red, green, blue] = harmonics.map(&channel);
        [red, green, blue, u8::MAX]
    };
    let colors = red.iter().zip(green).zip(blue).map(color).collect();
    (colors, broken)
}

/// Adds warnings about splats whose colours are not numbers, and about those that a splat renderer would not show.
pub(super) fn warn_of_colors(cloud: &mut RawCloud, broken: usize) {
    let colors = cloud.attributes.colors.as_deref().unwrap_or_default();
    let count = colors.len();
    if broken > 0 {
        cloud.warnings.push(format!(
            "splats: {broken} of {count} splats have a colour that is not a number, shown grey"
        ));
    }
    let unseen = colors.iter().filter(|color| color[3] == 0).count();
    if unseen > 0 {
        cloud.warnings.push(format!(
            "splats: {unseen} of {count} splats are transparent (opacity below 1/255), but shown like the others: \
             pictures of points and disks do not use opacities"
        ));
    }
}

/// Splat shape as stored in a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct SplatShape {
    /// Natural logarithms of the half axes; minus infinity where splats are flat.
    pub(super) log_scales: [f32; 3],
    /// Rotation quaternion of any length; a zero-length one counts as no rotation.
    pub(in crate::io) rotation: Quat,
}

/// Gives `cloud` the normals, radii and ellipses of its splats, and the axes in which training programs leave them.
/// Reports the number with an unusable shape or opacity; `logits` are the opacities of the file, if its numbers may be
/// NaN.
pub(super) fn put_shapes(cloud: &mut RawCloud, logits: &[f32], shape: impl Fn(usize) -> SplatShape) {
    let count = cloud.positions.len();
    cloud
        .warnings
        .extend(Unusable::of((0..count).map(&shape), logits).warning(count));
    let splat = |index: usize| {
        let shape = shape(index);
        if !shape.has_scales() {
            return ([0.0; 3], (0.0, Ellipse::CIRCLE));
        }
        let SplatShape { log_scales, rotation } = shape;
        let Splat {
            normal,
            radius,
            ellipse,
        } = Splat::of(log_scales, axes(rotation));
        (normal.to_array(), (radius, ellipse))
    };
    let (normals, (radii, ellipses)) = (0..count).map(splat).unzip();
    let attributes = &mut cloud.attributes;
    attributes.normals = Some(normals);
    attributes.radii = Some(radii);
    attributes.ellipses = Some(ellipses);
    cloud.convention = Some(AxisConvention::UsuallyYDown);
}

/// Splats with unusable attributes.
#[derive(Debug, Default)]
struct Unusable {
    scales: usize,
    rotations: usize,
    /// Without a scale or a rotation.
    shapes: usize,
    opacities: usize,
}

impl Unusable {
    fn of(shapes: impl Iterator<Item = SplatShape>, logits: &[f32]) -> Self {
        let mut unusable = Self {
            opacities: logits.iter().filter(|logit| !logit.is_finite()).count(),
            ..Self::default()
        };
        for shape in shapes {
            let (has_scales, turns) = (shape.has_scales(), has_direction(shape.rotation));
            unusable.scales += usize::from(!has_scales);
            unusable.rotations += usize::from(!turns);
            unusable.shapes += usize::from(!has_scales || !turns);
        }
        unusable
    }

    fn warning(&self, count: usize) -> Option<String> {
        let mut reasons = Vec::new();
        if self.shapes > 0 {
            reasons.push(format!(
                "{} of {count} splats have no usable scale or rotation ({} a scale that is not a number or infinite, \
                 shown as disks of an estimated size; {} a rotation of no length, shown unturned)",
                self.shapes, self.scales, self.rotations
            ));
        }
        if self.opacities > 0 {
            reasons.push(format!(
                "{} of {count} splats have an opacity that is not finite",
                self.opacities
            ));
        }
        (!reasons.is_empty()).then(|| format!("splats: {}", reasons.join("; ")))
    }
}

impl SplatShape {
    /// Returns true if the half axes are lengths that can be drawn: of flat splats one is zero.
    fn has_scales(&self) -> bool {
        let scales = self.log_scales.map(f32::exp);
        let is_length = |scale: &f32| scale.is_finite();
        scales.iter().all(is_length) && scales.iter().filter(|scale| **scale > 0.0).count() >= 2
    }
}

fn has_direction(rotation: Quat) -> bool {
    let length = rotation.length();
    length > 0.0 && length.is_finite()
}

fn axes(rotation: Quat) -> Mat3 {
    let length = rotation.length();
    if has_direction(rotation) {
        Mat3::from_quat(rotation / length)
    } else {
        Mat3::IDENTITY
    }
}

/// A channel of the constant term of spherical harmonics as 8 bits.
pub(super) fn channel_of_harmonic(harmonic: f32) -> u8 {
    byte(0.5 + HARMONIC * harmonic)
}

/// An opacity from minus to plus infinity as 8 bits.
pub(super) fn alpha_of_logit(logit: f32) -> u8 {
    byte(1.0 / (1.0 + (-logit).exp()))
}

/// A fraction as 8 bits; 0 for NaN.
pub(in crate::io) fn byte(fraction: f32) -> u8 {
    (fraction.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// The four components of a unit quaternion from three known ones, in their order; the other one, at index `largest`,
/// is the largest and positive.
pub(super) fn with_largest([a, b, c]: [f32; 3], largest: u32) -> [f32; 4] {
    let left = (1.0 - (a * a + b * b + c * c)).max(0.0).sqrt();
    match largest {
        0 => [left, a, b, c],
        1 => [a, left, b, c],
        2 => [a, b, left, c],
        _ => [a, b, c, left],
    }
}

/// Visible disk of an ellipsoid.
struct Splat {
    normal: Vec3,
    radius: f32,
    ellipse: Ellipse,
}

impl Splat {
    /// Creates a splat from its sizes, given as logarithms as in the file, along the columns of `axes`.
    fn of(log_scales: [f32; 3], axes: Mat3) -> Self {
        let [x, y, z] = log_scales;
        let smallest = if z <= x && z <= y { 2 } else { usize::from(y <= x) };
        let [a, b] = [(smallest + 1) % 3, (smallest + 2) % 3];
        let [longer, shorter] = if log_scales[a] >= log_scales[b] { [a, b] } else { [b, a] };
        Self {
            normal: axes.col(smallest),
            radius: f32::midpoint(log_scales[longer], log_scales[shorter]).exp(),
            ellipse: Ellipse {
                axis: axes.col(longer),
                ratio: (log_scales[shorter] - log_scales[longer]).exp(),
            },
        }
    }
}
