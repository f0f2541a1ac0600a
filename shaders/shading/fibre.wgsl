// What the models of a dielectric fibre share: angles in the fibre's frame, Bravais' index, Fresnel, absorption on the
// inclined path, and the tables' look-ups. θ is the inclination from the normal plane, φ the azimuth between light and eye.
//
// Marschner et al. 2003; d'Eon et al. 2011; Hunz 2016 §3.3 with the corrections listed in the reference.

const FIBRE_PI: f32 = 3.14159265;
const FIBRE_HALF_PI: f32 = 1.57079633;
const FIBRE_TAU: f32 = 6.28318531;
// The least cos θ_d that 1 / cos² θ_d is taken of: the factor stays finite where both directions lie along the tangent.
const FIBRE_MIN_COS_THETA_D: f32 = 0.01;

// The four lobes; R has no colour.
struct FibreLobes {
    r: f32,
    tt: vec3f,
    trt: vec3f,
    residual: vec3f,
}

struct FibrePair {
    theta_i: f32,
    theta_o: f32,
    cos_i: f32,
    cos_o: f32,
    // φ_o - φ_i from 0 to π: every round section is symmetric.
    phi: f32,
}

// θ from the parts along and across the tangent: exact to the last bits up to ±π/2.
fn fibre_pair(tangent: vec3f, wi: vec3f, wo: vec3f) -> FibrePair {
    let across_i = cross(tangent, wi);
    let across_o = cross(tangent, wo);
    var pair: FibrePair;
    pair.cos_i = length(across_i);
    pair.cos_o = length(across_o);
    pair.theta_i = fibre_atan2(dot(tangent, wi), pair.cos_i);
    pair.theta_o = fibre_atan2(dot(tangent, wo), pair.cos_o);
    let unit_i = fibre_unit_across(tangent, across_i, pair.cos_i);
    let unit_o = fibre_unit_across(tangent, across_o, pair.cos_o);
    pair.phi = fibre_atan2(length(cross(unit_i, unit_o)), dot(unit_i, unit_o));
    return pair;
}

// The azimuth from one direction to another around the tangent, from -π to π.
fn fibre_turn(tangent: vec3f, from_direction: vec3f, to_direction: vec3f) -> f32 {
    let across_from = cross(tangent, from_direction);
    let across_to = cross(tangent, to_direction);
    return fibre_atan2(dot(tangent, cross(across_from, across_to)), dot(across_from, across_to));
}

// A unit vector across the fibre; a fixed one where the direction lies along the tangent and has no azimuth.
fn fibre_unit_across(tangent: vec3f, across: vec3f, size: f32) -> vec3f {
    if size > 1e-7 { return across / size; }
    return normalize(cross(tangent, select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(tangent.y) > 0.7)));
}

// Some drivers' own arc functions err by 1e-4. Minimax of atan(x)/x on [0, tan π/8] after two reductions: 2e-7.
fn fibre_atan2(y: f32, x: f32) -> f32 {
    let large = max(abs(x), abs(y));
    let small = min(abs(x), abs(y));
    if large == 0.0 { return 0.0; }
    var t = small / large;
    var base = 0.0;
    if t > 0.41421356 {
        base = 0.78539816;
        t = (t - 1.0) / (t + 1.0);
    }
    let z = t * t;
    var angle = base + t + t * z * (-0.333329491539 + z * (0.199777106478 + z * (-0.138776856032 + z * 0.0805374449538)));
    if abs(y) > abs(x) { angle = FIBRE_HALF_PI - angle; }
    if x < 0.0 { angle = FIBRE_PI - angle; }
    return select(angle, -angle, y < 0.0);
}

fn fibre_asin(x: f32) -> f32 {
    let s = clamp(x, -1.0, 1.0);
    return fibre_atan2(s, sqrt((1.0 - s) * (1.0 + s)));
}

// An angle brought to -π…π.
fn fibre_wrap(angle: f32) -> f32 {
    return angle - FIBRE_TAU * round(angle / FIBRE_TAU);
}

// cos θ_i / cos² θ_d, what turns M_p N_p into the value with its cosine.
fn fibre_cosine_factor(pair: FibrePair) -> f32 {
    let cos_d = max(cos(0.5 * (pair.theta_o - pair.theta_i)), FIBRE_MIN_COS_THETA_D);
    return pair.cos_i / (cos_d * cos_d);
}

// What a round cylinder of unit radius does to rays of one inclination.
struct FibreCylinder {
    eta: f32,
    cos_theta: f32,
    // 1 / η', Bravais' index; 0 along the tangent, where η' is infinite.
    inverse_eta_prime: f32,
    // Cosine of the inclination inside.
    cos_theta_t: f32,
}

fn fibre_cylinder(eta: f32, theta: f32) -> FibreCylinder {
    let sin_theta = sin(theta);
    let cos_theta = max(cos(theta), 0.0);
    // η² - sin² θ = (η² - 1) + cos² θ, which keeps its digits for η near 1.
    let root = sqrt((eta - 1.0) * (eta + 1.0) + cos_theta * cos_theta);
    return FibreCylinder(eta, cos_theta, cos_theta / root, root / eta);
}

// Unpolarised reflectance of index η at a cosine of incidence from 0 to 1.
fn fibre_fresnel(eta: f32, cosine: f32) -> f32 {
    let c = clamp(cosine, 0.0, 1.0);
    let c_t = sqrt((eta - 1.0) * (eta + 1.0) + c * c) / eta;
    let perpendicular = (c - eta * c_t) / (c + eta * c_t);
    let parallel = (eta * c - c_t) / (eta * c + c_t);
    return clamp(0.5 * (perpendicular * perpendicular + parallel * parallel), 0.0, 1.0);
}

// A(p, h) for all paths at once, at offset h = sin γ_i. `tint`: the strand's own further transmittance of one crossing.
fn fibre_attenuations(cylinder: FibreCylinder, sigma_a: vec3f, h: f32, cos_gamma_i: f32) -> FibreLobes {
    let f = fibre_fresnel(cylinder.eta, cylinder.cos_theta * cos_gamma_i);
    let sin_gamma_t = h * cylinder.inverse_eta_prime;
    let cos_gamma_t = sqrt(max((1.0 - sin_gamma_t) * (1.0 + sin_gamma_t), 0.0));
    let t = exp(-sigma_a * (2.0 * cos_gamma_t / cylinder.cos_theta_t));
    let tt = (1.0 - f) * (1.0 - f) * t;
    let again = f * t;
    let trt = tt * again;
    return FibreLobes(f, tt, trt, trt * again / max(vec3f(1.0) - again, vec3f(1e-7)));
}

// The strand's colour is the further transmittance of one crossing: once in TT, twice in TRT, thrice in what follows.
fn fibre_tinted(lobes: FibreLobes, colour: vec3f) -> FibreLobes {
    let twice = colour * colour;
    return FibreLobes(lobes.r, lobes.tt * colour, lobes.trt * twice, lobes.residual * twice * colour);
}

fn fibre_gaussian(beta: f32, x: f32) -> f32 {
    let t = x / beta;
    return exp(-0.5 * t * t);
}

// 1 - e^(-x) for x ≥ 0 without cancellation.
fn fibre_one_minus_exp(x: f32) -> f32 {
    if x < 0.1 { return x * (1.0 - x * (0.5 - x * (0.16666667 - x * 0.041666667))); }
    return 1.0 - exp(-x);
}

// Number of the strand as a random number from 0 to 1 (PCG, Jarzynski and Olano 2020).
fn fibre_random(strand: u32, seed: u32) -> f32 {
    let state = (strand ^ (seed * 0x9e3779b9u)) * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return f32(((word >> 22u) ^ word) >> 8u) / 16777216.0;
}

// How many times as rough as its model says the fibre is here. Slot 13 of the parameters: the strand's part, and the tip's.
fn fibre_roughness(fibre: Fibre) -> f32 {
    let variation = material_value(13u);
    let own = 1.0 + variation.x * (2.0 * fibre_random(fibre.strand, 3u) - 1.0);
    return own * mix(1.0, variation.y, fibre.coordinate);
}

// --- azimuthal functions by intervals of γ_i -----------------------------------------------------------------------
//
// ½ ∫ A(p, h) l(φ - Φ(p, h)) dh, l the logistic of scale s trimmed to -π…π, Φ = 2p γ_t - 2γ_i + pπ. Within an interval of
// γ_i Φ and the weight ½ A cos γ_i are taken as linear; the integral of that is exact, for any s: nothing is missed by a
// narrow logistic that falls between two samples, and the sum keeps all energy.

// A logistic's integral and that integral's own integral, continued over the wraps at odd multiples of π.
struct FibreLogistic {
    s: f32,
    // 1 / tanh(π / 2s).
    inverse: f32,
}

fn fibre_logistic(s: f32) -> FibreLogistic {
    let e = exp(-FIBRE_PI / s);
    return FibreLogistic(s, (1.0 + e) / fibre_one_minus_exp(FIBRE_PI / s));
}

struct FibreNode {
    x: f32,
    // Wraps, and the integral within the last wrap from -½ to ½.
    wraps: f32,
    part: f32,
    // Integral of the integral.
    second: f32,
    density: f32,
}

fn fibre_node(l: FibreLogistic, x: f32) -> FibreNode {
    let wraps = round(x / FIBRE_TAU);
    let r = x - FIBRE_TAU * wraps;
    let y = abs(r) / l.s;
    let e = exp(-y);
    let size = 0.5 * (1.0 - e) / (1.0 + e) * l.inverse;
    var node: FibreNode;
    node.x = x;
    node.wraps = wraps;
    node.part = select(size, -size, r < 0.0);
    // ln cosh(y/2) = y/2 + ln(1 + e^-y) - ln 2.
    node.second = wraps * (x - FIBRE_PI * wraps) + l.inverse * l.s * (0.5 * y + log(0.5 + 0.5 * e));
    node.density = e / ((1.0 + e) * (1.0 + e) * l.s) * l.inverse;
    return node;
}

// ∫ of density × weight over an interval, per unit of the interval, weights `a` to `b`.
fn fibre_interval(l: FibreLogistic, p: FibreNode, q: FibreNode, a: vec3f, b: vec3f) -> vec3f {
    let step = q.x - p.x;
    if abs(step) < l.s || abs(step) < 1e-3 {
        let middle = fibre_node(l, p.x + 0.5 * step);
        return (a * p.density + b * q.density) / 6.0 + (a + b) * (middle.density / 3.0);
    }
    let turns = q.wraps - p.wraps;
    let rise = turns + (q.part - p.part);
    // The integral counted from the first end, so that no digits are lost to the wraps.
    let mean = (q.second - p.second) / step - p.wraps - p.part;
    return max((b * rise - (b - a) * mean) / step, vec3f(0.0));
}

// The mean of the logistic over the half circle around x.
fn fibre_half_circle(l: FibreLogistic, x: f32) -> f32 {
    let p = fibre_node(l, x - FIBRE_HALF_PI);
    let q = fibre_node(l, x + FIBRE_HALF_PI);
    return ((q.wraps - p.wraps) + (q.part - p.part)) / FIBRE_PI;
}

// The azimuthal functions at φ, by `intervals` of γ_i; `spread`: averaged over the half circle of lights around φ.
fn fibre_azimuthal(cylinder: FibreCylinder, sigma_a: vec3f, s: f32, phi: f32, intervals: u32, spread: bool) -> FibreLobes {
    let l = fibre_logistic(s);
    let step = FIBRE_PI / f32(intervals);
    var sum: FibreLobes;
    var before: array<FibreNode, 3>;
    var weight_before: FibreLobes;
    for (var i = 0u; i <= intervals; i++) {
        let gamma = FIBRE_HALF_PI * (2.0 * f32(i) / f32(intervals) - 1.0);
        // sin and cos by the distance from the nearer end, so that grazing rays keep their digits.
        let h = sin(gamma);
        let cos_gamma = sin(FIBRE_PI * f32(min(i, intervals - i)) / f32(intervals));
        let gamma_t = fibre_asin(h * cylinder.inverse_eta_prime);
        var weight = fibre_attenuations(cylinder, sigma_a, h, cos_gamma);
        let half = 0.5 * cos_gamma;
        weight = FibreLobes(weight.r * half, weight.tt * half, weight.trt * half, weight.residual * half);
        sum.residual += weight.residual;
        let x = vec3f(phi + 2.0 * gamma, phi - 2.0 * gamma_t + 2.0 * gamma - FIBRE_PI,
            phi - 4.0 * gamma_t + 2.0 * gamma - FIBRE_TAU);
        if spread {
            sum.r += weight.r * fibre_half_circle(l, x.x);
            if TRANSMITS { sum.tt += weight.tt * fibre_half_circle(l, x.y); }
            sum.trt += weight.trt * fibre_half_circle(l, x.z);
            continue;
        }
        let now = array<FibreNode, 3>(fibre_node(l, x.x), fibre_node(l, x.y), fibre_node(l, x.z));
        if i > 0u {
            sum.r += fibre_interval(l, before[0], now[0], vec3f(weight_before.r), vec3f(weight.r)).x;
            if TRANSMITS { sum.tt += fibre_interval(l, before[1], now[1], weight_before.tt, weight.tt); }
            sum.trt += fibre_interval(l, before[2], now[2], weight_before.trt, weight.trt);
        }
        before = now;
        weight_before = weight;
    }
    // The trapezoids of ½ cos γ sum to (step / 2) cot(step / 2) and not to 1.
    let scale = 2.0 * sin(0.5 * step) / cos(0.5 * step);
    return FibreLobes(sum.r * scale, sum.tt * scale, sum.trt * scale, sum.residual * (scale / FIBRE_TAU));
}

// --- tables --------------------------------------------------------------------------------------------------------

// Where this hair's tables begin, in words of `shading_tables`; their sizes.
fn fibre_tables() -> vec4u { return bitcast<vec4u>(material_value(15u)); }

// Azimuthal functions: rows of |θ| from 0 to π/2, columns of φ from 0 to π, ten values each, as f32 or as f16.
// Read one by one: drivers that run on a CPU leave out those that the model does not take.
fn fibre_entry(base: u32, index: u32) -> FibreLobes {
    var tt = vec3f(0.0);
    if FIBRE_TABLE_F16 {
        let at = base + index * 5u;
        let a = unpack2x16float(shading_tables[at]);
        let c = unpack2x16float(shading_tables[at + 2u]);
        let d = unpack2x16float(shading_tables[at + 3u]);
        let e = unpack2x16float(shading_tables[at + 4u]);
        if TRANSMITS { tt = vec3f(a.y, unpack2x16float(shading_tables[at + 1u])); }
        return FibreLobes(a.x, tt, vec3f(c, d.x), vec3f(d.y, e));
    }
    let at = base + index * 10u;
    if TRANSMITS { tt = fibre_three(at + 1u); }
    return FibreLobes(bitcast<f32>(shading_tables[at]), tt, fibre_three(at + 4u), fibre_three(at + 7u));
}

fn fibre_three(at: u32) -> vec3f {
    return bitcast<vec3f>(vec3u(shading_tables[at], shading_tables[at + 1u], shading_tables[at + 2u]));
}

fn fibre_mixed(a: FibreLobes, b: FibreLobes, t: f32) -> FibreLobes {
    return FibreLobes(mix(a.r, b.r, t), mix(a.tt, b.tt, t), mix(a.trt, b.trt, t), mix(a.residual, b.residual, t));
}

// The azimuthal functions at |θ| and φ; table 0, or 1: averaged over the half circle around φ.
fn fibre_look_up(theta: f32, phi: f32, table: u32) -> FibreLobes {
    let place = fibre_tables();
    let size = place.z;
    let words = select(10u, 5u, FIBRE_TABLE_F16);
    let base = place.y + table * size * size * words;
    let last = f32(size - 1u);
    let y = clamp(abs(theta) / FIBRE_HALF_PI, 0.0, 1.0) * last;
    let x = clamp(phi / FIBRE_PI, 0.0, 1.0) * last;
    let row = min(u32(y), size - 2u);
    let column = min(u32(x), size - 2u);
    let at = row * size + column;
    let t = x - f32(column);
    let low = fibre_mixed(fibre_entry(base, at), fibre_entry(base, at + 1u), t);
    let high = fibre_mixed(fibre_entry(base, at + size), fibre_entry(base, at + size + 1u), t);
    return fibre_mixed(low, high, y - f32(row));
}

// Functions of one inclination, from the host: rows of θ from -π/2 to π/2.
const FIBRE_ANGLES: u32 = 128u;
const FIBRE_ANGLE_WORDS: u32 = 24u;
// The integral over all lights; the part of the light that is scattered (Sadeghi); ã_f = 1 - √((1-ā_f)² - ā_b²); β̄_f²; Ā_b; Δ̄_b; σ̄_b.
const FIBRE_UNIFORM: u32 = 0u;
const FIBRE_ALBEDO: u32 = 3u;
const FIBRE_A_F: u32 = 6u;
const FIBRE_VARIANCE_F: u32 = 9u;
const FIBRE_A_B: u32 = 12u;
const FIBRE_DELTA_B: u32 = 15u;
const FIBRE_SIGMA_B: u32 = 18u;

fn fibre_angle(theta: f32, field: u32) -> vec3f {
    let y = clamp(theta / FIBRE_PI + 0.5, 0.0, 1.0) * f32(FIBRE_ANGLES - 1u);
    let row = min(u32(y), FIBRE_ANGLES - 2u);
    let at = fibre_tables().x + row * FIBRE_ANGLE_WORDS + field;
    let next = at + FIBRE_ANGLE_WORDS;
    return mix(fibre_three(at), fibre_three(next), y - f32(row));
}

// --- dual scattering -----------------------------------------------------------------------------------------------

// Densities d_f, d_b.
fn fibre_densities() -> vec2f { return material_value(14u).xy; }

struct FibreForward {
    // What arrives through fibres, and the variance of its inclination.
    transmittance: vec3f,
    variance: vec3f,
}

// Light that has met fibres on its way: the number met is Poisson's of mean n, so e^-n comes straight and
// d_f Σ_k>0 P(k) ã_fᵏ = d_f (e^(-n(1-ã_f)) - e^-n) through fibres, on average n ã_f / (1 - e^(-n ã_f)) of them.
fn fibre_forward(theta_i: f32, fibres: f32) -> FibreForward {
    let a_f = fibre_angle(theta_i, FIBRE_A_F);
    let met = max(fibres, 0.0) * a_f;
    let some = vec3f(fibre_one_minus_exp(met.x), fibre_one_minus_exp(met.y), fibre_one_minus_exp(met.z));
    let count = select(vec3f(1.0), met / max(some, vec3f(1e-20)), some > vec3f(1e-20));
    return FibreForward(fibre_densities().x * exp(met - fibres) * some, fibre_angle(theta_i, FIBRE_VARIANCE_F) * count);
}

// What the fibres around send back (Zinke et al. 2008): 2 Ā_b g(θ_i + θ_o - Δ̄_b, σ̄_b² + `variance`) s̃_b / cos² θ_d, times
// cos θ_i; `around` is s̃_b π.
fn fibre_back(pair: FibrePair, variance: vec3f, around: f32) -> vec3f {
    let sigma = fibre_angle(pair.theta_i, FIBRE_SIGMA_B);
    let spread = max(sigma * sigma + variance, vec3f(1e-12));
    let off = vec3f(pair.theta_i + pair.theta_o) - fibre_angle(pair.theta_i, FIBRE_DELTA_B);
    let gaussian = exp(-0.5 * off * off / spread) * inverseSqrt(FIBRE_TAU * spread);
    return fibre_angle(pair.theta_i, FIBRE_A_B) * gaussian
        * (2.0 / FIBRE_PI * around * fibre_cosine_factor(pair) * fibre_densities().y);
}
