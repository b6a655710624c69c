//! Friction that varies along the way: a stationary random field.

use core::f64::consts::LOG2_E;

use crate::name::{Name, within};
use crate::parameters::parameters;
use crate::real::{Function, Real};

parameters! {
    /// What makes the field of a run its own: drawn once, from the seed and the run's number.
    pub struct FieldKeys {
        /// A whole number within ±2²⁵.
        pub first,
        /// Another.
        pub second,
        /// Where in its cell the field begins, 0 to 1.
        pub offset,
    }
}

/// How the field is distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum FieldLaw {
    /// 1 + s = 1 + var · b, |b| ≤ 1: bell-shaped, with a standard deviation of 0.428 var.
    Bounded,
    /// 1 + s = 1 + var · z, z normal with variance 1 but for |z| < 4.8.
    Gaussian,
    /// 1 + s = exp(var · z − var²/2).
    LogNormal,
}

/// A factor 1 + s(x) on the friction levels, a stationary random field with smooth slope.
///
/// ```text
/// z(x) = (20/11)^½ Σ_i w_i B(x/h + o − i)       B the quadratic B-spline, h = ℓ / 1.0349
/// ⟨z(x) z(x + d)⟩ = B₅(d/h) / B₅(0)            its spectrum is that of sinc⁶(f h)
/// ```
///
/// B₅ is the quintic B-spline, B₅(0) = 11/20. At the correlation length ℓ the correlation has fallen
/// to 1/e, and at 2.90 ℓ to zero. The w_i are independent, uniform or nearly normal within ±3.56; the offset o is
/// uniform, which makes the field stationary. Mean and correlation are exact; over one cell the
/// variance of a field with a given offset rises and falls by 9 %.
///
/// w_i is a hash of i and two keys of the run, in whole numbers below 2⁵² that double precision holds
/// exactly: no table that repeats or has to be kept for each run, and the same bits in every
/// language. Single precision cannot hold them. Valid for |x| < 500,000 h, 0 ≤ var < 1 (bounded,
/// log-normal) or < 0.2 (Gaussian).
///
/// # Example
/// ```
/// use breakaway_core::variation::{Field, FieldCell, FieldKeys, FieldLaw};
/// let keys = FieldKeys { first: 1_234_567.0, second: -7_654_321.0, offset: 0.3 };
/// let field = Field { law: FieldLaw::Bounded, var: 0.3, correlation_length_m: 1e-3, keys };
/// let mut cell = FieldCell::nowhere();
/// let here = field.factor(&mut cell, 0.02);
/// field.factor(&mut cell, 0.07);
/// assert_eq!(field.factor(&mut cell, 0.02), here);
/// assert!((here - 1.0_f64).abs() <= 0.3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct Field<R> {
    /// How it is distributed.
    pub law: FieldLaw,
    /// Its size.
    pub var: R,
    /// ℓ in m.
    pub correlation_length_m: R,
    /// What makes it the run's own; a batch draws it.
    pub keys: FieldKeys<R>,
}

/// ℓ over the width of a cell: B₅(1.0349…) = B₅(0) / e.
const CELLS_PER_LENGTH: f64 = 1.034_902_840_090_455;
/// (20/11)^½, which makes the variance 1.
const PER_DEVIATION: f64 = 1.348_399_724_926_484_2;

parameters! {
    /// Where in the field the part was last: a cell, and the polynomial of s in it.
    ///
    /// ```text
    /// Σ_i w_i B(u − i) = c_0 + u (c_1 + u c_2),    0 ≤ u < 1 within the cell
    /// ```
    pub struct FieldCell {
        /// The cell's number.
        pub place,
        /// c_0.
        pub constant,
        /// c_1.
        pub linear,
        /// c_2.
        pub square,
    }
}

impl<R: Real> FieldCell<R> {
    /// In no cell that a part can reach.
    pub fn nowhere() -> Self {
        let zero = R::zero();
        Self { place: R::constant(NOWHERE), constant: zero, linear: zero, square: zero }
    }
}

const NOWHERE: f64 = -16_777_216.0; // −2²⁴

impl<R: Real> Field<R> {
    /// Applies `f` to every number.
    pub fn map<S: Real>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> Field<S> {
        Field {
            law: self.law,
            var: f(Name::of("var"), self.var),
            correlation_length_m: f(Name::of("correlation_length_m"), self.correlation_length_m),
            keys: within!("keys", self.keys, f),
        }
    }

    /// h in m, the width of a cell.
    #[inline(always)]
    pub fn cell_m(&self) -> R {
        self.correlation_length_m / R::constant(CELLS_PER_LENGTH)
    }

    /// 1 + s at position `x` in m.
    #[inline(always)]
    pub fn factor(&self, cell: &mut FieldCell<R>, x: R) -> R {
        R::section("friction along the way: 1 + s(x)");
        let per_m =
            (R::constant(CELLS_PER_LENGTH) / self.correlation_length_m).named("cells_per_m");
        let way = per_m.mul_add(x, self.keys.offset).named("way_in_cells");
        let u = self.within_cell(cell, way);
        let sum = cell.square.mul_add(u, cell.linear).mul_add(u, cell.constant);
        match self.law {
            FieldLaw::Bounded => self.var.mul_add(sum, R::one()),
            FieldLaw::Gaussian => self.deviation().mul_add(sum, R::one()),
            FieldLaw::LogNormal => {
                let half_square = (R::constant(-0.5) * self.var * self.var).named("half_square");
                let exponent = self.deviation().mul_add(sum, half_square);
                (exponent * R::constant(LOG2_E)).named("exponent").exp2()
            }
        }
        .named("field_factor")
    }

    #[inline(always)]
    fn deviation(&self) -> R {
        (R::constant(PER_DEVIATION) * self.var).named("deviation")
    }

    /// Goes to the cell that `way` is in; gives where in it, 0 to 1.
    #[inline(always)]
    fn within_cell(&self, cell: &mut FieldCell<R>, way: R) -> R {
        let kept = way - cell.place;
        let left = kept.lt(R::zero()) | R::one().le(kept);
        let from = [way, self.keys.first, self.keys.second];
        let held = [cell.place, cell.constant, cell.linear, cell.square];
        let [place, constant, linear, square] = match self.law {
            FieldLaw::Bounded => R::renewed::<Cell<false>, 3, 4>(left, held, from),
            _ => R::renewed::<Cell<true>, 3, 4>(left, held, from),
        };
        *cell = FieldCell {
            place: place.named("cell"),
            constant: constant.named("cell_constant"),
            linear: linear.named("cell_linear"),
            square: square.named("cell_square"),
        };
        (way - place).named("within_cell")
    }
}

/// The cell of a place and its polynomial, from the place and the two keys.
struct Cell<const NORMAL: bool>;

impl<const NORMAL: bool> Function<3, 4> for Cell<NORMAL> {
    #[inline(always)]
    fn of<R: Real>([way, first, second]: [R; 3]) -> [R; 4] {
        let half = R::constant(0.5);
        let place = (way - half).round();
        let w_0 = knot::<R, NORMAL>(place, first, second);
        let w_1 = knot::<R, NORMAL>(place + R::one(), first, second);
        let w_2 = knot::<R, NORMAL>(place + R::constant(2.0), first, second);
        let (step, next) = (w_1 - w_0, w_2 - w_1);
        [place, half * (w_0 + w_1), step, half * (next - step)]
    }
}

/// w_i. A function: closures are not inlined into the caller's instruction set.
#[inline(always)]
fn knot<R: Real, const NORMAL: bool>(i: R, first: R, second: R) -> R {
    let hash = hash(i, first, second);
    if NORMAL { nearly_normal(hash) } else { hash * R::constant(1.0 / HALF_RANGE) }
}

const HALF_RANGE: f64 = 33_554_432.0; // 2²⁵
const RANGE: f64 = 2.0 * HALF_RANGE;
const HALVES: f64 = 8192.0; // 2¹³

/// A whole number modulo 2²⁶, within ±2²⁵. Exact below 2⁵².
#[inline(always)]
fn wrapped<R: Real>(number: R) -> R {
    (-R::constant(RANGE)).mul_add((number * R::constant(1.0 / RANGE)).round(), number)
}

/// The upper and the lower 13 bits, each within ±2¹².
#[inline(always)]
fn halves<R: Real>(number: R) -> (R, R) {
    let upper = (number * R::constant(1.0 / HALVES)).round();
    (upper, (-R::constant(HALVES)).mul_add(upper, number))
}

/// x → x (2 x + 1) modulo 2²⁶, its halves swapped: a permutation whose every bit depends on all lower
/// ones, and then on the others (Rivest, Robshaw, Sidney and Yin, *The RC6 block cipher*, 1998).
#[inline(always)]
fn mixed<R: Real>(number: R) -> R {
    let permuted = wrapped(number * (number + number + R::one()));
    let (upper, lower) = halves(permuted);
    R::constant(HALVES).mul_add(lower, upper)
}

/// A hash of a whole number below 2²¹ in magnitude, within ±2²⁵.
#[inline(always)]
fn hash<R: Real>(number: R, first: R, second: R) -> R {
    let spread = wrapped(R::constant(27_182_819.0).mul_add(number, first)); // odd, or it would fold
    let once = mixed(spread);
    let twice = mixed(wrapped(once + second));
    wrapped(mixed(wrapped(twice + first)))
}

/// A hash as a nearly normal number within ±3.554: the sum of its two uniform halves, drawn out by the odd
/// polynomial that brings their triangular distribution nearest to the normal one. Mean 0, variance 1,
/// kurtosis 2.99; beyond 2 and 3 lie 4.50 and 0.28 % (normal: 4.55 and 0.27 %).
#[inline(always)]
fn nearly_normal<R: Real>(hash: R) -> R {
    const SCALE: f64 = 1.224_744_871_391_589 * 2.0 / HALVES; // variance 1: (3/2)^½ over 2¹²
    const DRAWN_OUT: [f64; 4] = [
        0.942_419_227_866_708_8,
        0.004_373_246_125_051_813,
        -0.007_143_688_514_209_779,
        0.003_422_603_697_428_782,
    ];
    let (upper, lower) = halves(hash);
    let y = (upper + lower) * R::constant(SCALE);
    let square = y * y;
    let mut drawn = R::constant(DRAWN_OUT[3]);
    for &coefficient in DRAWN_OUT[..3].iter().rev() {
        drawn = drawn.mul_add(square, R::constant(coefficient));
    }
    y * drawn
}
