//! FLIP against the authors' evaluator and against properties of any such measure.

use super::*;
use image::Rgba;

const SIZE_PX: [u32; 2] = [64, 48];

/// An image from a formula; channels are taken modulo 256.
fn picture(color: impl Fn(u32, u32) -> [u32; 3]) -> RgbaImage {
    RgbaImage::from_fn(SIZE_PX[0], SIZE_PX[1], |x, y| {
        let [red, green, blue] = color(x, y).map(|channel| channel as u8);
        Rgba([red, green, blue, 255])
    })
}

fn solid(color: [u8; 3]) -> RgbaImage {
    picture(|_, _| color.map(u32::from))
}

fn disk(center_x: u32) -> RgbaImage {
    picture(|x, y| {
        if x.abs_diff(center_x).pow(2) + y.abs_diff(24).pow(2) <= 225 {
            [230, 180, 40]
        } else {
            [20, 40, 90]
        }
    })
}

fn noise(shift: u32) -> RgbaImage {
    picture(|x, y| {
        let x = x + shift;
        [x * 37 + y * 101 + x * y * 13, x * x * 5 + y * 59, x * 83 + y * y * 7]
    })
}

fn error_of(reference: &RgbaImage, test: &RgbaImage, pixels_per_degree: f64) -> ErrorMap {
    let [reference, test] = [reference, test].map(|image| Perceived::of(image, pixels_per_degree));
    reference.flip(&test).unwrap()
}

/// Mean, largest, and the errors at (20, 24), (0, 0) and (63, 47), as the authors' evaluator gives them (Python package
/// `flip-evaluator` 1.7, `evaluate(reference, test, "LDR", applyMagma=False)`) at 67.02064 and 20 pixels a degree.
#[test]
fn errors_match_the_authors_evaluator() {
    let gradient = |brighter: u32| picture(|x, y| [(4 * x + brighter).min(255), 5 * y, 255 - 4 * x]);
    let checks = picture(|x, y| [if (x / 2 + y / 2) % 2 == 0 { 200 } else { 60 }; 3]);
    let line = picture(|x, _| [if x == 20 { 255 } else { 0 }; 3]);
    let [black, white] = [0, 255].map(|value| solid([value; 3]));
    let [red, green, blue] = [[255, 0, 0], [0, 255, 0], [0, 0, 255]].map(solid);
    #[rustfmt::skip]
    let cases = [
        ("gradient", gradient(0), gradient(10),
            [0.120_554_5, 0.206_174_3, 0.088_139_2, 0.026_126_6, 0.116_624_5],
            [0.118_912_6, 0.208_910_0, 0.087_615_3, 0.024_769_6, 0.091_695_3]),
        ("noise", noise(0), noise(1),
            [0.203_292_9, 0.842_345_3, 0.227_992_1, 0.422_574_0, 0.787_344_8],
            [0.825_054_7, 0.988_977_4, 0.854_669_5, 0.477_655_7, 0.974_805_0]),
        ("disk", disk(32), disk(34),
            [0.146_039_3, 0.901_260_0, 0.598_412_7, 0.0, 0.0], [0.085_843_7, 0.985_008_4, 0.600_011_6, 0.0, 0.0]),
        ("checks", checks, solid([148; 3]),
            [0.088_935_9, 0.660_381_9, 0.120_698_0, 0.574_422_8, 0.574_422_8],
            [0.726_975_1, 0.863_946_1, 0.637_842_0, 0.609_444_0, 0.609_444_0]),
        ("black, white", black.clone(), white,
            [0.967_365_1, 0.967_387_9, 0.967_387_9, 0.967_387_9, 0.967_387_9],
            [0.967_365_3, 0.967_391_3, 0.967_391_3, 0.967_391_3, 0.967_391_3]),
        ("red, green", red, green.clone(),
            [0.986_649_6, 0.986_665_2, 0.986_665_2, 0.986_665_3, 0.986_665_3],
            [0.986_649_7, 0.986_666_7, 0.986_666_7, 0.986_666_7, 0.986_666_7]),
        ("green, blue", green, blue, [1.0; 5], [1.0; 5]),
        ("line", black, line,
            [0.082_536_8, 0.975_738_6, 0.975_738_6, 0.0, 0.0], [0.035_978_0, 0.994_714_0, 0.994_714_0, 0.0, 0.0]),
    ];
    for (name, reference, test, near, far) in cases {
        for (pixels_per_degree, expected) in [(PIXELS_PER_DEGREE, near), (20.0, far)] {
            let map = error_of(&reference, &test, pixels_per_degree);
            let at = |x: usize, y: usize| f64::from(map.errors[y * SIZE_PX[0] as usize + x]);
            let found = [map.mean(), f64::from(map.max()), at(20, 24), at(0, 0), at(63, 47)];
            for (found, expected) in found.into_iter().zip(expected) {
                // Both compute in f32; theirs gives 0.967 365 for the mean of black against white, which is 0.967 387
                // at every pixel.
                assert!(
                    (found - expected).abs() < 3e-5,
                    "{name} at {pixels_per_degree} pixels a degree: {found} for {expected}"
                );
            }
        }
    }
}

#[test]
fn equal_images_have_no_error() {
    for image in [noise(0), disk(30), solid([255; 3])] {
        let map = flip(&image, &image).unwrap();
        assert_eq!((map.mean(), map.max()), (0.0, 0.0));
    }
}

#[test]
fn a_larger_difference_is_a_larger_error() {
    let gray = |value: u8| solid([value; 3]);
    let means: Vec<f64> = [100, 101, 105, 120, 160, 255]
        .map(|value| flip(&gray(100), &gray(value)).unwrap().mean())
        .into();
    assert!(means.windows(2).all(|pair| pair[0] < pair[1]), "{means:?}");
    assert!(means.iter().all(|mean| (0.0..=1.0).contains(mean)), "{means:?}");
    // An edge that moves farther and farther.
    let moved: Vec<f64> = (30..36).map(|x| flip(&disk(30), &disk(x)).unwrap().mean()).collect();
    assert!(moved.windows(2).all(|pair| pair[0] < pair[1]), "{moved:?}");
}

#[test]
fn fine_noise_counts_less_than_a_constant_change() {
    // A one-pixel checkerboard against its mean, and the same difference as a constant change.
    let checks = picture(|x, y| [if (x + y) % 2 == 0 { 120 } else { 136 }; 3]);
    let flat = solid([128; 3]);
    let brighter = solid([136; 3]);
    let [noise, change] = [&checks, &brighter].map(|test| flip(&flat, test).unwrap().mean());
    assert!(noise < 0.5 * change, "{noise} and {change}");
}

#[test]
fn a_region_of_the_image_can_be_evaluated() {
    let map = ErrorMap {
        size_px: [2, 2],
        errors: vec![0.0, 0.5, 1.0, 0.1],
    };
    assert!((map.mean() - 0.4).abs() < 1e-7);
    assert_eq!(map.mean_where(|pixel| pixel == 1 || pixel == 2), 0.75);
    assert_eq!(map.mean_where(|_| false), 0.0);
    assert_eq!(map.max(), 1.0);
}

#[test]
fn odd_sizes_are_handled() {
    for size in [[0, 0], [1, 1], [1, 9], [5, 1]] {
        let [black, white] =
            [0, 255].map(|value| RgbaImage::from_pixel(size[0], size[1], Rgba([value, value, value, 255])));
        let map = flip(&black, &white).unwrap();
        assert_eq!(map.errors.len(), (size[0] * size[1]) as usize);
        assert!(
            map.errors.iter().all(|error| (error - 0.967_4).abs() < 1e-3),
            "{size:?}"
        );
    }
    let error = flip(&RgbaImage::new(2, 2), &RgbaImage::new(2, 3)).unwrap_err();
    assert_eq!(error.test_px, [2, 3]);
}

#[test]
fn results_do_not_depend_on_thread_count() {
    let [reference, test] = [noise(0), noise(1)];
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone = one.install(|| flip(&reference, &test).unwrap());
    assert_eq!(flip(&reference, &test).unwrap(), alone);
}
