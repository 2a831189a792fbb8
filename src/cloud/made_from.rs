//! What the points of a cloud were made from, for whoever can make them anew.
//!
//! **How it works.** A graphics card makes the points of a depth image itself, from fewer bytes than these take. What
//! it needs for that is known to rooms further right alone (`rgbd::DepthFrame`), and goes with the cloud through all
//! that is done to it before. So its type is not named here; whoever asks for it names it. Whatever changes points,
//! or leaves some out, drops it.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// See the module's text. It says nothing about whether clouds are equal.
#[derive(Clone)]
pub struct MadeFrom {
    what: Arc<dyn Any + Send + Sync>,
    byte_size: usize,
}

impl MadeFrom {
    /// `what` takes so many bytes beside the points.
    pub fn new<T: Any + Send + Sync>(what: Arc<T>, byte_size: usize) -> Self {
        Self { what, byte_size }
    }

    /// The same allocation, if it is one of these.
    pub fn get<T: Any + Send + Sync>(&self) -> Option<Arc<T>> {
        Arc::downcast(Arc::clone(&self.what)).ok()
    }

    /// Bytes that it takes.
    pub fn byte_size(&self) -> usize {
        self.byte_size
    }
}

impl fmt::Debug for MadeFrom {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = formatter.debug_struct("MadeFrom");
        debug.field("byte_size", &self.byte_size).finish_non_exhaustive()
    }
}

impl PartialEq for MadeFrom {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
