// Moment opacity map: what a texel stores, and the optical depth that it stands for.
//
// A texel's fragments are a measure on [-1, 1]: at a distance d behind the texel's front x = (d - s) / (d + s), with a distance s
// that lies in the middle. Most light is lost close behind the front, and what lies far behind it is many times what
// is lost there: on even depths the bounds are as wide as the part of that which one of their points takes. Masses Ω_i = -ln(1 - opacity) at x_i. Stored are m + 1
// sums in fixed point, Σ Ω and Σ Ω (1 + T_k(x)) / 2 for k from 1 to m, with Chebyshev's polynomials T_k: none is negative,
// so that a carry shows. A word after them counts the carries.
//
// Of all measures with these moments those of m/2 + 1 points, x among them, bound the mass before x (Chebyshev, Markov,
// Stieltjes; Peters and Klein 2015, Münstermann et al. 2018). With t = (T_0, …, T_{m/2}) and G_ij = ∫ T_i T_j, which is
// (b_{i+j} + b_{|i-j|}) / 2, the other points are the zeros in y of K(x, y) = t(x)ᵀ G⁻¹ t(y), and the mass at y is
// 1 / K(y, y). Both bounds rise with x, and so does what lies at a fixed place between them.

// An opaque fibre counts as this much: exp(-8) = 3e-4. More of it would leave less of the moments to the others.
const MOMENT_OPAQUE: f32 = 8.0;
// Steps of the sums. With 15 carries a sum holds an optical depth of 1,048,576.
const MOMENT_SCALE: f32 = 65536.0;
const MOMENT_CARRY_BITS: u32 = 4u;
const MOMENT_CARRY_MASK: u32 = 15u;
// A sum that has run over even so; the texel is then taken to be filled evenly.
const MOMENT_OVERFLOWED: u32 = 0x80000000u;
const MOMENT_OVERFLOW_DEPTH: f32 = 1048576.0;

// The moments are moved towards those of 1 / sqrt(1 - x²), which are 0: by what single precision needs, and by the
// rounding of the sums. Measured on hair: half of the latter leaves moments that no measure has.
const MOMENT_BIAS: f32 = 1e-5;
const MOMENT_BIAS_STEPS: f32 = 32.0;
// Where between the bounds the transmittance is taken to lie. Not the mass: of dense hair that is a lot at x, of which any part
// would leave a lit surface dark. Of 0.3 to 0.6 the one that errs least at the first eight fibres of a texel of dense hair, and that
// is neither too bright nor too dark there.
const MOMENT_PART: f32 = 0.45;
// The least pivot: far below what the bias leaves.
const MOMENT_PIVOT: f32 = 1e-7;
// Points farther than a thousand half-extents carry no mass.
const MOMENT_NEAREST_INVERSE: f32 = 1e-3;

// The place of a distance behind the front, in units of s, at least 0.
fn moment_place(d: f32) -> f32 {
    return (d - 1.0) / (d + 1.0);
}

// G = L D Lᵀ, with the rows of L below 1.
struct MomentFactors {
    l10: f32,
    l20: f32,
    l21: f32,
    l30: f32,
    l31: f32,
    l32: f32,
    // 1 / D; the first is 1.
    d1: f32,
    d2: f32,
    // 0 with four moments.
    d3: f32,
}

// From b_1 … b_6 over b_0; with four the last two are not read.
fn moment_factors(b: array<f32, 6>, six: bool) -> MomentFactors {
    var f: MomentFactors;
    f.l10 = b[0];
    f.l20 = b[1];
    let pivot_1 = max(0.5 * (b[1] + 1.0) - b[0] * b[0], MOMENT_PIVOT);
    f.d1 = 1.0 / pivot_1;
    f.l21 = (0.5 * (b[2] + b[0]) - b[0] * b[1]) * f.d1;
    let pivot_2 = max(0.5 * (b[3] + 1.0) - b[1] * b[1] - f.l21 * f.l21 * pivot_1, MOMENT_PIVOT);
    f.d2 = 1.0 / pivot_2;
    f.d3 = 0.0;
    if six {
        f.l30 = b[2];
        f.l31 = (0.5 * (b[3] + b[1]) - b[0] * b[2]) * f.d1;
        f.l32 = (0.5 * (b[4] + b[0]) - b[1] * b[2] - f.l21 * f.l31 * pivot_1) * f.d2;
        let rest = 0.5 * (b[5] + 1.0) - b[2] * b[2] - f.l31 * f.l31 * pivot_1 - f.l32 * f.l32 * pivot_2;
        f.d3 = 1.0 / max(rest, MOMENT_PIVOT);
    }
    return f;
}

// L⁻¹ t(y) without its first component, which is 1.
fn moment_orthogonal(f: MomentFactors, y: f32) -> vec3f {
    let p1 = y - f.l10;
    let p2 = 2.0 * y * y - 1.0 - f.l20 - f.l21 * p1;
    let p3 = (4.0 * y * y - 3.0) * y - f.l30 - f.l31 * p1 - f.l32 * p2;
    return vec3f(p1, p2, p3);
}

fn moment_mass(f: MomentFactors, y: f32) -> f32 {
    let p = moment_orthogonal(f, y);
    return 1.0 / (1.0 + p.x * p.x * f.d1 + p.y * p.y * f.d2 + p.z * p.z * f.d3);
}

// The mass at the point x - 1 / s: what lies before x, then all of it.
fn moment_mass_at(f: MomentFactors, x: f32, s: f32) -> vec2f {
    if !(abs(s) > MOMENT_NEAREST_INVERSE) { return vec2f(0.0); }
    let mass = moment_mass(f, x - 1.0 / s);
    return vec2f(select(0.0, mass, s > 0.0), mass);
}

// Bounds of the part of the whole mass that lies before x, from b_1 … b_m over b_0: without and with the mass at x, of which
// `own` does not count.
fn moment_before(b: array<f32, 6>, x: f32, own: f32, six: bool) -> vec2f {
    let f = moment_factors(b, six);
    let p = moment_orthogonal(f, x);
    // K(x, ·) = Σ k_j T_j, and its Taylor polynomial at x.
    let k3 = p.z * f.d3;
    let k2 = p.y * f.d2 - f.l32 * k3;
    let k1 = p.x * f.d1 - f.l21 * k2 - f.l31 * k3;
    let f0 = 1.0 + p.x * p.x * f.d1 + p.y * p.y * f.d2 + p.z * p.z * f.d3;
    let f1 = k1 + 4.0 * x * k2 + (12.0 * x * x - 3.0) * k3;
    let f2 = 2.0 * k2 + 12.0 * x * k3;
    let f3 = 4.0 * k3;
    // With y = x - 1/s the zeros are those of f0 s³ - f1 s² + f2 s - f3, whose first coefficient is never small: a zero
    // at infinity becomes s = 0.
    let a = -f1 / f0;
    let c = f2 / f0;
    let here = 1.0 / f0;
    var sums = vec2f(0.0);
    if !six {
        let root = sqrt(max(0.25 * a * a - c, 0.0));
        sums = moment_mass_at(f, x, root - 0.5 * a) + moment_mass_at(f, x, -root - 0.5 * a);
    } else {
        let e = -f3 / f0;
        // All three are real: Viète's cosines.
        let third = a / 3.0;
        let q = max(third * third - c / 3.0, 0.0);
        let r = third * (third * third - 0.5 * c) + 0.5 * e;
        let root = sqrt(q);
        let angle = acos(clamp(r / max(q * root, 1e-30), -1.0, 1.0)) / 3.0;
        for (var i = 0u; i < 3u; i++) {
            var s = -2.0 * root * cos(angle + 2.0943951 * f32(i)) - third;
            // The cosines' rounding, which is of the largest zero's size.
            let slope = (3.0 * s + 2.0 * a) * s + c;
            if abs(slope) > 1e-6 * q { s -= (((s + a) * s + c) * s + e) / slope; }
            sums += moment_mass_at(f, x, s);
        }
    }
    // With the mass at x the others' are 1. Each is off by rounding of its zero where two lie close together, and so by more
    // than their sum may be.
    let others = sums.x * (1.0 - here) / max(sums.y, 1e-30);
    return vec2f(others, others + max(here - own, 0.0));
}
