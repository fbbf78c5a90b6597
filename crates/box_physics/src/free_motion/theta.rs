//! Theta series as polynomials: the coefficients by powers of cos 2x.

/// Number of terms of each series. With a nome p ≤ e^{−π} the first omitted terms are p^{16} = 1e-22 and
/// p^{20} = 5e-28 of the leading one.
pub(super) const TERMS: usize = 4;

/// Number of series: `l_a`, `l_b`, `l_c`, their common denominator, Re Z, ∓Im Z.
pub(super) const SERIES: usize = 6;

/// `sin (2k+1)x = sin x · P_k(cos 2x)`, one row per k, by powers.
const SINES: [[f64; 4]; TERMS] = [
    [1.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 0.0, 0.0],
    [-1.0, 2.0, 4.0, 0.0],
    [-1.0, -4.0, 4.0, 8.0],
];
/// `cos (2k+1)x = cos x · Q_k(cos 2x)`. With cosh and sinh the identities are the same.
const COSINES: [[f64; 4]; TERMS] = [
    [1.0, 0.0, 0.0, 0.0],
    [-1.0, 2.0, 0.0, 0.0],
    [-1.0, -2.0, 4.0, 0.0],
    [1.0, -4.0, -4.0, 8.0],
];
/// `cos 2kx = T_k(cos 2x)`, the Chebyshev polynomials, doubled except for k = 0.
const EVEN: [[f64; 4]; TERMS] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 2.0, 0.0, 0.0],
    [-2.0, 0.0, 4.0, 0.0],
    [0.0, -6.0, 0.0, 8.0],
];
const ALTERNATING: [f64; TERMS] = [1.0, -1.0, 1.0, -1.0];

pub(super) const fn odd(k: usize) -> f64 {
    (2 * k + 1) as f64
}

/// p⁰ … p¹²; the highest power needed is k(k+1) for k = 3.
pub(super) fn powers(p: f64) -> [f64; 13] {
    let mut powers = [1.0; 13];
    for n in 1..13 {
        powers[n] = powers[n - 1] * p;
    }
    powers
}

/// Σ (−1)^k p^{k(k+1)} f(k)
pub(super) fn alternating_sum(powers: &[f64; 13], f: impl Fn(usize) -> f64) -> f64 {
    (0..TERMS)
        .map(|k| ALTERNATING[k] * powers[k * (k + 1)] * f(k))
        .sum()
}

/// θ₂(0)/2p^{1/4}, θ₃(0), θ₄(0).
pub(super) fn constants(p: &[f64; 13]) -> [f64; 3] {
    let (odd, even) = (p[1] + p[9], p[4]);
    [
        1.0 + (p[2] + (p[6] + p[12])),
        1.0 + 2.0 * (even + odd),
        1.0 + 2.0 * (even - odd),
    ]
}

/// θ₂(x), θ₁(x), θ₃(x), θ₄(x) over their leading factors, and the two series of Z with the given functions of
/// y. Coefficients are by powers n of v, times p^{n·`lower`} (v = cosh 2x · p if `lower` is 1).
pub(super) fn base_series(
    powers: &[f64; 13],
    lower: usize,
    re: &[f64; TERMS],
    im: &[f64; TERMS],
) -> [[f64; SERIES]; 4] {
    let mut rows = [[0.0; SERIES]; 4];
    for (n, row) in rows.iter_mut().enumerate() {
        for k in n..TERMS {
            let odd = powers[k * (k + 1) - n * lower];
            let even = powers[k * k - n * lower] * EVEN[k][n];
            let (sine, cosine) = (ALTERNATING[k] * odd * SINES[k][n], odd * COSINES[k][n]);
            row[0] += cosine;
            row[1] += sine;
            row[2] += even;
            row[3] += ALTERNATING[k] * even;
            row[4] += re[k] * sine;
            row[5] += im[k] * ALTERNATING[k] * cosine;
        }
    }
    rows
}

/// Multiplies by the constant factors: amplitudes, ratios of theta constants, and the sign that conjugates Z.
pub(super) fn finish(
    mut rows: [[f64; SERIES]; 4],
    amplitudes: [f64; 3],
    factors: [f64; 3],
    sigma: f64,
) -> [[f64; SERIES]; 4] {
    for row in &mut rows {
        for k in 0..3 {
            row[k] *= amplitudes[k] * factors[k];
        }
        row[5] *= -sigma;
    }
    rows
}
