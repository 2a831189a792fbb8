//! Unsupported parts of a PLY file that do not become part of a cloud: lists that points have, properties of faces in
//! addition to their corners, and the harmonics of splats.

use super::faces::FaceList;
use super::header::{Element, PlyHeader, Property, PropertyKind};
use super::retained_columns::POINTS;
use super::splats::is_unread;
use crate::cloud::Dropped;

/// Returns the dropped properties of all elements that have rows.
pub(super) fn dropped(header: &PlyHeader) -> Vec<Dropped> {
    let filled = header.elements.iter().filter(|element| element.count > 0);
    filled.filter_map(of_element).collect()
}

fn of_element(element: &Element) -> Option<Dropped> {
    let list = FaceList::of(element);
    let is_lost = |&(place, property): &(usize, &Property)| match list {
        Some(list) => place != list.property,
        None => element.name == POINTS && matches!(property.kind, PropertyKind::List { .. }),
    };
    let lost = element.properties.iter().enumerate().filter(is_lost);
    let names: Vec<String> = lost.map(|(_, property)| format!("`{}`", property.name)).collect();
    let what = if list.is_some() {
        "properties of faces"
    } else {
        "lists of points"
    };
    (!names.is_empty()).then(|| Dropped::noted(format!("{what} are not read: {}", names.join(", "))))
}

/// Returns the dropped properties of splats, which are points here.
pub(super) fn dropped_of_splats(header: &PlyHeader) -> Option<Dropped> {
    let vertex = header.elements.iter().find(|element| element.name == POINTS)?;
    let unread = vertex.properties.iter().filter(|property| is_unread(&property.name));
    let names: Vec<&str> = unread.map(|property| property.name.as_str()).collect();
    let (first, last) = (names.first()?, names.last()?);
    Some(Dropped::quiet(format!(
        "colours of splats that change with direction (`{first}` to `{last}`) are not read"
    )))
}
