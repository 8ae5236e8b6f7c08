//! Jacobi's elliptic functions in terms of the complementary parameter m₁ = 1 − m, which keeps
//! its digits where m itself rounds to one.

/// sn, cn and dn of an argument in [−K, K].
///
/// `complement` is m₁ = 1 − m in [0, 1]; at 0 the functions are hyperbolic and K is infinite.
/// Method of Bulirsch (Numer. Math. 7, 1965): the arithmetic–geometric mean of 1 and √m₁, then
/// Gauss's transformation upwards on cn/sn, whose steps have no cancellation.
pub fn jacobi(argument: f64, complement: f64) -> (f64, f64, f64) {
    if complement == 0.0 {
        let sech = argument.cosh().recip();
        return (argument.tanh(), sech, sech);
    }
    // The next terms, of second order, are below one rounding.
    if argument.abs() < 1e-9 {
        return (argument, 1.0, 1.0);
    }
    // Converges quadratically: the smallest number that f64 holds needs thirteen means.
    let mut means = [(1.0, 0.0); 16];
    let mut used = 0;
    let (mut arithmetic, mut geometric) = (1.0_f64, complement.sqrt());
    for mean in &mut means {
        *mean = (arithmetic, geometric);
        used += 1;
        let close = (arithmetic - geometric).abs() <= 1e-8 * arithmetic;
        (arithmetic, geometric) = (0.5 * (arithmetic + geometric), (arithmetic * geometric).sqrt());
        if close {
            break;
        }
    }
    let (sine, cosine) = (arithmetic * argument).sin_cos();
    let mut ratio = cosine / sine; // cn/sn
    let mut scaled_ratio = arithmetic * ratio;
    let mut dn = 1.0;
    for (arithmetic, geometric) in means[..used].iter().rev() {
        let square = ratio * scaled_ratio;
        scaled_ratio *= dn;
        dn = (geometric + square) / (arithmetic + square);
        ratio = scaled_ratio / arithmetic;
    }
    let sn = ratio.hypot(1.0).recip().copysign(sine);
    (sn, ratio * sn, dn)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Independent reference: m₁, argument, sn, cn, dn from mpmath at 60 digits. The arguments are 0.001, 0.3, 0.7
    /// and 0.95 of K, to six digits.
    #[rustfmt::skip]
    const REFERENCE: [(f64, f64, f64, f64, f64); 28] = [
        (1.0, 0.0015708, 0.0015707993540314505, 0.9999987662939337, 1.0),
        (1.0, 0.471239, 0.4539905905879338, 0.8910064778987968, 1.0),
        (1.0, 1.09956, 0.8910076915055769, 0.45398820874324775, 1.0),
        (1.0, 1.49226, 0.9969176075135916, 0.07845561693962132, 1.0),
        (0.75, 0.00168575, 0.0016857490019827623, 0.9999985791241417, 0.9999996447812247),
        (0.75, 0.505725, 0.47996752974312334, 0.8772862533929755, 0.9707769015577529),
        (0.75, 1.18003, 0.9036967963165744, 0.42817297944541044, 0.8920947399698027),
        (0.75, 1.60146, 0.9973352841618525, 0.07295430738343661, 0.8667932756669546),
        (0.25, 0.00215652, 0.002156517074860564, 0.9999976747143494, 0.999998256036269),
        (0.25, 0.646955, 0.5779037172859437, 0.8161049525318959, 0.8657485028345796),
        (0.25, 1.50956, 0.9426581066039155, 0.33375993476437693, 0.5775350816534359),
        (0.25, 2.04869, 0.9985428311551193, 0.05396493628939789, 0.5021794109295393),
        (0.01, 0.00369564, 0.003695623259499331, 0.9999931711610454, 0.9999932394496658),
        (0.01, 1.10869, 0.8046250232457431, 0.5937832701977948, 0.5992101353007303),
        (0.01, 2.58695, 0.9909433613129967, 0.134280507407813, 0.16688601536079267),
        (0.01, 3.51086, 0.99982735960038, 0.01858093093825876, 0.1016946335092812),
        (2e-8, 0.0102501, 0.010249741041041108, 0.9999474700245966, 0.9999474700256473),
        (2e-8, 3.07502, 0.995742295365337, 0.09218069874203615, 0.09218080630274612),
        (2e-8, 7.17504, 0.9999988331522452, 0.001527643331413448, 0.0015341753815447876),
        (2e-8, 9.73756, 0.9999999971352558, 7.56933846689852e-5, 0.00016040414074473637),
        (1e-13, 0.0163531, 0.016351642419434657, 0.9998663029576439, 0.9998663029576439),
        (1e-13, 4.90593, 0.9998904103493181, 0.014804299762977785, 0.014804299766354442),
        (1e-13, 11.4472, 0.9999999997719287, 2.135749934798637e-5, 2.1359840317736286e-5),
        (1e-13, 15.5354, 0.9999999999999584, 2.8837300383569834e-7, 4.279707809432969e-7),
        (1e-40, 0.047438, 0.04740244774851374, 0.9988758721420041, 0.9988758721420041),
        (1e-40, 14.2314, 0.9999999999991295, 1.3195064148473669e-6, 1.3195064148473669e-6),
        (1e-40, 33.2066, 1.0, 7.578562784954295e-15, 7.578562784960892e-15),
        (1e-40, 45.0661, 1.0, 5.312196257059645e-20, 5.405499891177365e-20),
    ];

    #[test]
    fn functions_equal_the_reference_in_relative_accuracy() {
        let mut worst = 0.0_f64;
        for (complement, argument, sn, cn, dn) in REFERENCE {
            let found = jacobi(argument, complement);
            for (found, expected) in [(found.0, sn), (found.1, cn), (found.2, dn)] {
                worst = worst.max((found / expected - 1.0).abs() / (1.0 + argument));
            }
            let mirrored = jacobi(-argument, complement);
            assert_eq!((-mirrored.0, mirrored.1, mirrored.2), found);
        }
        // Measured: 9.8e-16, for cn near its zero.
        assert!(worst < 1.5e-15, "{worst:e}");
    }

    /// Closed form: circular and hyperbolic functions in the limits.
    #[test]
    fn limits_are_circular_and_hyperbolic() {
        for k in 1..=40 {
            let argument = 0.037 * f64::from(k);
            let (sn, cn, dn) = jacobi(argument, 1.0);
            assert!((sn - argument.sin()).abs() < 4e-16 && (cn - argument.cos()).abs() < 4e-16 && dn == 1.0);
            let (nearly, exact) = (jacobi(argument, 1e-300), jacobi(argument, 0.0));
            assert!((nearly.0 - exact.0).abs() < 1e-15);
            assert!((nearly.1 - exact.1).abs() < 1e-15 && (nearly.2 - exact.2).abs() < 1e-15);
        }
        for argument in [0.0, 1e-300, 1e-12, 1e-9] {
            let (sn, cn, dn) = jacobi(argument, 0.3);
            assert!((sn - argument).abs() <= 1e-16 * argument && cn == 1.0 && dn == 1.0);
        }
    }

    /// Conserved: sn² + cn² = 1, dn² = cn² + m₁ sn².
    #[test]
    fn identities_hold() {
        for i in 0..60 {
            let complement = 10_f64.powf(-0.5 * f64::from(i));
            let quarter_period = ellip::elliprf(0.0, complement, 1.0).unwrap();
            for j in -10..=10 {
                let (sn, cn, dn) = jacobi(0.1 * f64::from(j) * quarter_period, complement);
                assert!((sn * sn + cn * cn - 1.0).abs() < 5e-16);
                assert!((dn * dn - cn * cn - complement * sn * sn).abs() < 1e-14 * dn * dn);
            }
            let (sn, cn, dn) = jacobi(quarter_period, complement);
            assert!((sn - 1.0).abs() < 1e-15 && cn.abs() < 1e-14 && (dn / complement.sqrt() - 1.0).abs() < 1e-14);
        }
    }
}
