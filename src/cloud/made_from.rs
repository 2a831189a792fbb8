//! Source data of a cloud's points, for consumers that can create them again.
//!
//! **How it works.** A GPU creates the points of a depth image itself, from fewer bytes than these take. The data it
//! needs for that is known only to later modules (`rgbd::DepthFrame`), and accompanies the cloud through all stages
//! before. So its type is not named here; the consumer names it. Every change or removal of points drops it.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// See the module's text. Ignored when clouds are compared.
#[derive(Clone)]
pub struct MadeFrom {
    what: Arc<dyn Any + Send + Sync>,
    byte_size: usize,
}

impl MadeFrom {
    /// Wraps source data `what`, which takes `byte_size` bytes in addition to the points.
    pub fn new<T: Any + Send + Sync>(what: Arc<T>, byte_size: usize) -> Self {
        Self { what, byte_size }
    }

    /// Returns the shared allocation, if it is of type `T`.
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
