//! Names of controls without text.

use egui::Response;

/// Gives a control a name for screen readers and tests.
pub(in crate::app) fn named(response: &Response, name: impl Into<String>) {
    let name = name.into();
    response
        .ctx
        .accesskit_node_builder(response.id, |node| node.set_label(name));
}
