// The direction of least variance of a covariance matrix, by Jacobi rotations.
//
// **How it works.** Each rotation zeroes one off-diagonal entry. The axes are renamed after each rotation, so that all
// rotations are the same few lines, and no variable is indexed by another. The CPU uses the roots of the characteristic
// polynomial instead (math/symmetric_eigen.rs), in double precision: in single precision, two close roots lose half of
// their digits, which rotations never do (Golub and Van Loan, Matrix Computations, 8.5).

struct Symmetric {
    xx: f32,
    yy: f32,
    zz: f32,
    xy: f32,
    yz: f32,
    zx: f32,
}

fn smallest_eigenvector(covariance: Symmetric) -> vec3f {
    var m = covariance;
    var x = vec3f(1.0, 0.0, 0.0);
    var y = vec3f(0.0, 1.0, 0.0);
    var z = vec3f(0.0, 0.0, 1.0);
    // Five sweeps over all three entries; since the count is a multiple of three, all axes have their own names again.
    for (var turn = 0u; turn < 15u; turn++) {
        let apart = m.yy - m.xx;
        let sum = abs(apart) + sqrt(apart * apart + 4.0 * m.xy * m.xy);
        var tangent = 0.0;
        if (sum > 0.0) {
            tangent = select(-2.0, 2.0, apart >= 0.0) * m.xy / sum;
        }
        let cosine = inverseSqrt(1.0 + tangent * tangent);
        let sine = tangent * cosine;
        m = Symmetric(
            m.yy + tangent * m.xy,
            m.zz,
            m.xx - tangent * m.xy,
            sine * m.zx + cosine * m.yz,
            cosine * m.zx - sine * m.yz,
            0.0,
        );
        let turned_x = cosine * x - sine * y;
        let turned_y = sine * x + cosine * y;
        x = turned_y;
        y = z;
        z = turned_x;
    }
    if (m.xx <= m.yy && m.xx <= m.zz) {
        return x;
    }
    if (m.yy <= m.zz) {
        return y;
    }
    return z;
}
