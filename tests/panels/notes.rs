//! Notes.

use super::{click, window};
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;
use pointreel::app::{Command, PanelId};
use pointreel::sequence::Sequence;
use std::sync::Arc;

#[test]
fn notes_are_stored_with_their_sequence_and_not_shown_for_others() {
    let mut harness = window();
    click(&mut harness, "View");
    click(&mut harness, "Notes…");
    let field = (Role::MultilineTextInput, "Text of the notes");
    harness.get_by_role_and_label(field.0, field.1).click();
    harness.run();
    harness
        .get_by_role_and_label(field.0, field.1)
        .type_text("the left foot slips");
    harness.run();
    assert_eq!(harness.state().document.notes, "the left foot slips");
    harness.state_mut().run(Command::panel(PanelId::new("notes")));
    assert!(!harness.state().panels.has(PanelId::new("notes")));

    let folder = tempfile::tempdir().unwrap();
    let scan = folder.path().join("scan.xyz");
    std::fs::write(&scan, "0 0 0\n1 0 0\n0 1 0\n").unwrap();
    let open = || Arc::new(Sequence::discover(std::slice::from_ref(&scan)).unwrap());
    let state = harness.state_mut();
    state.open(open());
    assert_eq!(state.document.notes, "", "they were of the sequence before");
    state.document.notes = "of the scan".to_owned();
    let session = state.session().unwrap();
    assert_eq!(session.notes, "of the scan");
    let file = folder.path().join("scan.pointreel");
    session.write(&file).unwrap();
    let read = pointreel::document::session_of(&[file]).unwrap().unwrap();
    state.open(Arc::new(Sequence::demo()));
    state.open_session(open(), read);
    assert_eq!(state.document.notes, "of the scan");
}
