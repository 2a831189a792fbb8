//! Numbers of points that have a name and no other meaning here.

/// One number a point, under the name that the file has for it: intensity, classification, time.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarField {
    /// The file's name for it.
    pub name: String,
    /// One entry a point.
    pub values: Vec<f32>,
    /// What is to be added to a value to get the number in the file: not zero where single precision would lose it, as
    /// in GPS times.
    pub offset: f64,
}

impl ScalarField {
    /// Values as the file has them.
    pub fn new(name: impl Into<String>, values: Vec<f32>) -> Self {
        Self {
            name: name.into(),
            values,
            offset: 0.0,
        }
    }

    /// Other values under the same name, to which the same is to be added.
    pub(crate) fn with_values(&self, values: Vec<f32>) -> Self {
        Self {
            name: self.name.clone(),
            values,
            offset: self.offset,
        }
    }

    /// Numbers of double precision, of which the smallest finite one becomes the offset if single precision loses
    /// digits.
    pub fn from_f64(name: impl Into<String>, values: &[f64]) -> Self {
        let is_exact = |value: &f64| !value.is_finite() || f64::from(*value as f32) == *value;
        let offset = if values.iter().all(is_exact) {
            0.0
        } else {
            let finite = values.iter().copied().filter(|value| value.is_finite());
            finite.reduce(f64::min).unwrap_or(0.0).floor()
        };
        Self {
            name: name.into(),
            values: values.iter().map(|value| (value - offset) as f32).collect(),
            offset,
        }
    }
}
