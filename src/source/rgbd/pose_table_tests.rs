use super::*;

fn read(text: &str) -> Result<Option<Trajectory>, RgbdError> {
    of_text(Path::new("poses.txt"), text)
}

/// A turn by 90° around y, and a translation.
fn pose() -> DAffine3 {
    DAffine3::from_rotation_translation(
        DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2),
        DVec3::new(1.0, 2.0, 3.0),
    )
}

fn first(text: &str) -> DAffine3 {
    let trajectory = read(text).unwrap().unwrap();
    let poses = trajectory.poses_of(&[Some(Duration::from_secs(5))], &[Some(0)], &["0.png".to_owned()]);
    poses[0].unwrap()
}

#[test]
fn headers_state_the_order_of_quaternions() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for (header, row) in [
        (
            "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []",
            format!("5000000000,1,2,3,{half},0,{half},0"),
        ),
        ("# tx ty tz qw qx qy qz", format!("1 2 3 {half} 0 {half} 0")),
        ("# timestamp qw qx qy qz tx ty tz", format!("5 {half} 0 {half} 0 1 2 3")),
        ("timestamp,tx,ty,tz,qw,qx,qy,qz", format!("5.0,1,2,3,{half},0,{half},0")),
        ("# timestamp tx ty tz qx qy qz qw", format!("5 1 2 3 0 {half} 0 {half}")),
        ("#sec,nsec,x,y,z,qx,qy,qz,qw", format!("5,0,1,2,3,0,{half},0,{half}")),
        (
            "num,t_sec,t_nsec,x,y,z,qx,qy,qz,qw",
            format!("0,5,0,1,2,3,0,{half},0,{half}"),
        ),
        (
            "%time,field.header.frame_id,field.pose.position.x,field.pose.position.y,field.pose.position.z,\
             field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w",
            format!("5000000000000000000,map,1,2,3,0,{half},0,{half}"),
        ),
    ] {
        let found = if header.starts_with('%') {
            let trajectory = read(&format!("{header}\n{row}\n")).unwrap().unwrap();
            trajectory.pose(0, Some(Duration::from_secs(5_000_000_000))).unwrap()
        } else {
            first(&format!("{header}\n{row}\n"))
        };
        assert!(found.abs_diff_eq(pose(), 1e-9), "{header}: {found}");
    }
}

#[test]
fn headers_without_a_quaternion_are_refused() {
    for header in [
        "# time x y z roll pitch yaw",
        "t,x,y,z,q0,q1,q2,q3",
        "# tx ty tz qw qx qy",
    ] {
        let error = read(&format!("{header}\n0 1 2 3 0 0 0 1\n")).unwrap_err().to_string();
        assert!(error.contains("qx qy qz qw"), "{header}: {error}");
    }
}

#[test]
fn names_numbers_and_brackets_may_precede_a_pose() {
    let rows = "0 0 1 1 0 1 0 2 -1 0 0 3";
    assert!(first(&format!("0.png {rows} 0 0 0 1\n")).abs_diff_eq(pose(), 1e-9));
    assert!(first(&format!("0 {rows}\n1 {rows}\n")).abs_diff_eq(pose(), 1e-9));
    let stamped = read(&format!("1561000444390857630,{}\n", rows.replace(' ', ","))).unwrap();
    let time = Duration::from_nanos(1_561_000_444_390_857_630);
    assert!(stamped.unwrap().pose(0, Some(time)).unwrap().abs_diff_eq(pose(), 1e-9));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let graph = format!("VERTEX_SE3:QUAT 0 1 2 3 0 {half} 0 {half}\nEDGE_SE3:QUAT 0 1 0\n");
    assert!(first(&graph).abs_diff_eq(pose(), 1e-9));
    assert!(read("1 2 3 4\n").unwrap().is_none());
}
