use super::*;

fn found(names: &str) -> Option<([usize; 3], Match, Option<LengthUnit>)> {
    let names: Vec<&str> = names.split('|').collect();
    axes(&names).map(|axes| (axes.columns, axes.by, axes.unit))
}

#[test]
fn coordinates_are_found_under_many_names() {
    for names in [
        "x|y|z",
        "\"X\"|\"Y\"|\"Z\"",
        "//X|Y|Z",
        "x [m]|y [m]|z [m]",
        "x_mm|y_mm|z_mm",
        "X1 (m)|Y1 (m)|Z1 (m)",
        "pos_x|pos_y|pos_z",
        "posX|posY|posZ",
        "px|py|pz",
        "X_coord|Y_coord|Z_coord",
        "Xcoord|Ycoord|Zcoord",
        "Points_m_XYZ:0|Points_m_XYZ:1|Points_m_XYZ:2",
        "Points:0|Points:1|Points:2",
        "Points_0|Points_1|Points_2",
        "Points[0]|Points[1]|Points[2]",
        "coord1|coord2|coord3",
        "position.x|position.y|position.z",
        "field.point.x|field.point.y|field.point.z",
        "world x|world y|world z",
        "easting|northing|elevation",
        "Easting (m)|Northing (m)|Height (m)",
        "E|N|H",
        "x|y|height",
        "UTM_Easting|UTM_Northing|Z",
        "head_x|head_y|head_z",
        "tx|ty|tz",
        "Longitude|Latitude|Altitude",
        "lon|lat|ellipsoidal height",
    ] {
        let columns = found(names).map(|(columns, ..)| columns);
        assert_eq!(columns, Some([0, 1, 2]), "{names}");
        let shifted = format!("id|{names}|intensity");
        let columns = found(&shifted).map(|(columns, ..)| columns);
        assert_eq!(columns, Some([1, 2, 3]), "{shifted}");
    }
}

#[test]
fn other_vectors_and_words_are_not_coordinates() {
    for names in [
        "vx|vy|vz",
        "vel_x|vel_y|vel_z",
        "nx|ny|nz",
        "a|b|c",
        "x|y",
        "normal_x|normal_y|normal_z",
        "lat|lon",
    ] {
        assert_eq!(found(names), None, "{names}");
    }
    // Two unknown kinds: neither is better.
    assert_eq!(found("left_x|left_y|left_z|right_x|right_y|right_z"), None);
    assert_eq!(found("vel_x|vel_y|vel_z|pos_x|pos_y|pos_z").unwrap().0, [3, 4, 5]);
    assert_eq!(found("lon|lat|alt|x|y|z").unwrap().0, [3, 4, 5]);
    assert_eq!(found("x_old|y_old|z_old|z|x|y").unwrap().0, [4, 5, 3]);
}

#[test]
fn marker_columns_are_several_points_per_row() {
    let of = |names: &str| markers(&names.split('|').collect::<Vec<&str>>()).len();
    assert_eq!(of("frame|x0|y0|z0|x1|y1|z1|x2|y2|z2"), 3);
    assert_eq!(
        of("time|marker0_x|marker0_y|marker0_z|marker1_x|marker1_y|marker1_z|marker2_x|marker2_y|marker2_z"),
        3
    );
    for other in [
        "x|y|z",
        "x1|y1|z1|x2|y2|z2|x3|y3|z3",
        "t|x1|y1|z1|x2|y2|z2",
        "t|x|y|z|x1|y1|z1|x2|y2|z2",
    ] {
        assert_eq!(of(other), 0, "{other}");
    }
}

#[test]
fn units_are_given_in_brackets_or_as_the_last_word() {
    for (names, unit) in [
        ("x [m]|y [m]|z [m]", Some(LengthUnit::Metre)),
        ("x (cm)|y (cm)|z (cm)", Some(LengthUnit::Centimetre)),
        ("x_mm|y_mm|z_mm", Some(LengthUnit::Millimetre)),
        ("X1 (ft)|Y1 (ft)|Z1 (ft)", Some(LengthUnit::Foot)),
        ("Points_m_XYZ:0|Points_m_XYZ:1|Points_m_XYZ:2", Some(LengthUnit::Metre)),
        ("x|y|z", None),
        ("x (raw)|y (raw)|z (raw)", None),
    ] {
        assert_eq!(found(names).unwrap().2, unit, "{names}");
    }
}

#[test]
fn colors_and_normals_are_found_under_many_names() {
    for (names, expected) in [
        ("Rf|Gf|Bf", "red green blue"),
        ("R|G|B|A", "red green blue alpha"),
        ("RGB:0|RGB:1|RGB:2", "red green blue"),
        ("colR|colG|colB", "red green blue"),
        ("Rouge|Vert|Bleu", "red green blue"),
        ("Nx|Ny|Nz", "nx ny nz"),
        ("Normals:0|Normals:1|Normals:2", "nx ny nz"),
        ("red|green", ""),
    ] {
        let names: Vec<&str> = names.split('|').collect();
        let roles: Vec<&str> = colors_and_normals(&names).into_iter().map(|(_, role)| role).collect();
        assert_eq!(roles.join(" "), expected);
    }
}
