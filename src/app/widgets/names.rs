//! Names of controls without a text of their own.

use egui::Response;

/// Gives a control a name of its own for screen readers and tests.
pub(in crate::app) fn named(response: &Response, name: impl Into<String>) {
    let name = name.into();
    response
        .ctx
        .accesskit_node_builder(response.id, |node| node.set_label(name));
}
