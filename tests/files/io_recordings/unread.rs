//! Recordings without point clouds: their topics are named.

use super::{bare_header, folder, record};
use pointreel::io;

/// A bag with messages on topics of these types, packed into a chunk with an index or loose.
fn bag(topics: &[(&str, &str, u32)], is_packed: bool) -> Vec<u8> {
    let mut connections = Vec::new();
    let mut messages = Vec::new();
    let mut index = Vec::new();
    for (id, (topic, kind, count)) in topics.iter().enumerate() {
        let id = (id as u32).to_le_bytes();
        connections.extend(record(
            &[("op", &[7]), ("conn", &id), ("topic", topic.as_bytes())],
            &bare_header(&[("type", kind.as_bytes())]),
        ));
        for _ in 0..*count {
            messages.extend(record(&[("op", &[2]), ("conn", &id), ("time", &[1; 8])], &[0; 20]));
        }
        index.extend(record(
            &[
                ("op", &[4]),
                ("ver", &[1, 0, 0, 0]),
                ("conn", &id),
                ("count", &count.to_le_bytes()),
            ],
            &vec![0; 12 * *count as usize],
        ));
    }
    let mut file = b"#ROSBAG V2.0\n".to_vec();
    if is_packed {
        let size = (messages.len() as u32).to_le_bytes();
        file.extend(record(
            &[("op", &[5]), ("compression", b"none"), ("size", &size)],
            &messages,
        ));
        file.extend(index);
        file.extend(connections);
    } else {
        file.extend(connections);
        file.extend(messages);
    }
    file
}

#[test]
fn unsupported_topics_are_listed_with_types_counts_and_converters() {
    let folder = folder();
    let path = folder.path().join("a.bag");
    for is_packed in [true, false] {
        let refusal = |topics: &[(&str, &str, u32)]| {
            std::fs::write(&path, bag(topics, is_packed)).unwrap();
            io::read(&path).unwrap_err().to_string()
        };
        let error = refusal(&[("/imu", "sensor_msgs/Imu", 200), ("/scan", "sensor_msgs/LaserScan", 40)]);
        for words in [
            "holds no point cloud (ROS bag file)",
            "/imu (sensor_msgs/Imu, 200), /scan (sensor_msgs/LaserScan, 40)",
            "laser_geometry",
        ] {
            assert!(error.contains(words), "{words}: {error}");
        }
        let error = refusal(&[("/points", "point_cloud_interfaces/msg/CompressedPointCloud2", 3)]);
        assert!(
            error.contains("CompressedPointCloud2, 3)") && error.contains("republish"),
            "{error}"
        );
        let error = refusal(&[("/packets", "velodyne_msgs/VelodyneScan", 9)]);
        assert!(error.contains("packets of the sensor"), "{error}");
        let error = refusal(&[("/odom", "nav_msgs/Odometry", 9)]);
        assert!(
            error.contains("/odom (nav_msgs/Odometry, 9)") && error.contains("expected one of type"),
            "{error}"
        );
    }
    std::fs::write(&path, b"#ROSBAG V2.0\n").unwrap();
    let error = io::read(&path).unwrap_err().to_string();
    assert!(error.contains("no topic is in it"), "{error}");
}
