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
