//! Numbers of axes and units in files and streams of our own. They are stable: new choices come last.

use super::{AxisConvention, LengthUnit};

/// Axes, in the order of their numbers.
pub(crate) const AXES: [AxisConvention; 5] = [
    AxisConvention::YUp,
    AxisConvention::ZUp,
    AxisConvention::UsuallyZUp,
    AxisConvention::Camera,
    AxisConvention::UsuallyYDown,
];

/// Units, in the order of their numbers.
pub(crate) const UNITS: [LengthUnit; 5] = [
    LengthUnit::Metre,
    LengthUnit::Millimetre,
    LengthUnit::Foot,
    LengthUnit::SurveyFoot,
    LengthUnit::Centimetre,
];

/// The number of a choice, from 1; 0 for none.
pub(crate) fn code_of<T: PartialEq>(choices: &[T], choice: Option<T>) -> u8 {
    let place = choice.and_then(|choice| choices.iter().position(|other| *other == choice));
    place.map_or(0, |place| place as u8 + 1)
}

/// The choice with a number; `None` for 0 and for numbers not assigned yet.
pub(crate) fn choice_of<T: Copy>(choices: &[T], code: u32) -> Option<T> {
    choices.get(code.checked_sub(1)? as usize).copied()
}
