//! Task outcomes: a message of a dedicated type for each kind of task, handled by the feature that knows the type.

use super::tasks::TaskFailed;
use std::any::{Any, type_name};

/// A result type of a task. Declared next to the type; nothing else lists it.
pub trait Message: Send + 'static {}

impl Message for TaskFailed {}

/// Outcome of a task.
pub struct Outcome {
    message: Box<dyn Any + Send>,
    name: &'static str,
}

impl std::fmt::Debug for Outcome {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_tuple("Outcome").field(&self.name).finish()
    }
}

impl<M: Message> From<M> for Outcome {
    fn from(message: M) -> Self {
        Self {
            message: Box::new(message),
            name: type_name::<M>(),
        }
    }
}

impl Outcome {
    /// Gives the message to `take` if it is of its type; else it comes back.
    pub(in crate::app) fn give<M: Message>(self, take: impl FnOnce(M)) -> Result<(), Self> {
        let Self { message, name } = self;
        match message.downcast::<M>() {
            Ok(message) => {
                take(*message);
                Ok(())
            }
            Err(message) => Err(Self { message, name }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug)]
    struct Number(u8);

    impl Message for Number {}

    #[test]
    fn a_message_is_taken_by_the_receiver_of_its_type() {
        let mut taken = 0;
        let outcome = Outcome::from(Number(7));
        assert!(format!("{outcome:?}").contains("Number"));
        let outcome = outcome.give(|_: TaskFailed| panic!("another type")).unwrap_err();
        outcome.give(|Number(number)| taken = number).unwrap();
        assert_eq!(taken, 7);
    }
}
