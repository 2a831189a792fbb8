//! Types that can be a setting.

use super::described::Described;
use super::values::Value;
use crate::scene::environment::Environment;
use crate::scene::style::background::Background;
use crate::sequence::Coloring;

/// Type that can be a setting.
pub trait Setting: Sized {
    /// Resolved type, which cannot be left open.
    type Decided;

    /// This value, or the default if it is open.
    fn decided(&self) -> Self::Decided;

    /// As any setting.
    fn value(&self) -> Value;

    /// From any setting; `None` if it is none of these.
    fn from_value(value: Value) -> Option<Self>;

    /// Shows this with its description to `edit`, and takes the edited value.
    fn edit(&mut self, described: &'static Described, edit: &mut dyn FnMut(&'static Described, Value) -> Value) {
        let before = self.value();
        let after = edit(described, before);
        if after != before
            && let Some(value) = Self::from_value(after)
        {
            *self = value;
        }
    }
}

impl Setting for f32 {
    type Decided = Self;

    fn decided(&self) -> Self {
        *self
    }

    fn value(&self) -> Value {
        Value::Number(f64::from(*self))
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Number(number) => Some(number as Self),
            _ => None,
        }
    }
}

impl Setting for bool {
    type Decided = Self;

    fn decided(&self) -> Self {
        *self
    }

    fn value(&self) -> Value {
        Value::Switch(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Switch(is_on) => Some(is_on),
            _ => None,
        }
    }
}

impl Setting for Background {
    type Decided = Self;

    fn decided(&self) -> Self {
        *self
    }

    fn value(&self) -> Value {
        Value::Background(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Background(background) => Some(background),
            _ => None,
        }
    }
}

impl Setting for Environment {
    type Decided = Self;

    fn decided(&self) -> Self {
        *self
    }

    fn value(&self) -> Value {
        Value::Environment(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Environment(environment) => Some(environment),
            _ => None,
        }
    }
}

impl Setting for Coloring {
    type Decided = Self;

    fn decided(&self) -> Self {
        *self
    }

    fn value(&self) -> Value {
        Value::Colors(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Colors(coloring) => Some(coloring),
            _ => None,
        }
    }
}
