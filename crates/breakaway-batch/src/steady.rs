//! Friction of a joint that slides steadily, at many positions and velocities.

use breakaway_core::joint::{Joint, Law, steady};
use breakaway_core::{Dual, Real};

use crate::instructions::{Instructions, Kernel};
use crate::lanes::Wide;

/// The fields of [`breakaway_core::joint::Steady`], one value for each point.
#[derive(Clone, Debug, PartialEq)]
pub struct SteadyFriction {
    /// g in N.
    pub level_n: Vec<f64>,
    /// σ in N s/m.
    pub viscous_n_s_per_m: Vec<f64>,
    /// c in N s/m.
    pub damping_n_s_per_m: Vec<f64>,
    /// ω in 1/s.
    pub rate_per_s: Vec<f64>,
    /// λ.
    pub lead: Vec<f64>,
}

/// The steady friction force over velocity, with exact derivatives, one value for each point.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionCurve {
    /// R in N.
    pub force_n: Vec<f64>,
    /// dR/dv in N s/m.
    pub slope_n_s_per_m: Vec<f64>,
    /// d²R/dv² in N s²/m².
    pub curvature_n_s2_per_m2: Vec<f64>,
}

/// F_s(x) in N at each position in m.
#[must_use]
pub fn breakaway_forces(joint: &Joint<f64>, position_m: &[f64]) -> Vec<f64> {
    position_m.iter().map(|&x| joint.breakaway_force(x)).collect()
}

/// What friction is while the part slides steadily, at pairs of position in m and velocity in m/s.
///
/// # Panics
/// If there are not as many positions as velocities.
///
/// # Example
/// ```
/// use breakaway_batch::steady_friction;
/// use breakaway_core::{joint::Joint, test_models::paper_joint};
/// let joint = Joint::Lugre(paper_joint());
/// assert_eq!(steady_friction(&joint, &[0.0, 0.0], &[0.0, 10.0]).level_n, [450.0, 360.0]);
/// ```
#[must_use]
pub fn steady_friction(
    joint: &Joint<f64>,
    position_m: &[f64],
    velocity_m_per_s: &[f64],
) -> SteadyFriction {
    let points = Points { joint, position_m, velocity_m_per_s };
    let columns = points.columns::<Settled, 5>();
    let [level_n, viscous_n_s_per_m, damping_n_s_per_m, rate_per_s, lead] = columns;
    SteadyFriction { level_n, viscous_n_s_per_m, damping_n_s_per_m, rate_per_s, lead }
}

/// The curve of the steady friction force, at pairs of position in m and velocity in m/s.
///
/// # Panics
/// If there are not as many positions as velocities.
///
/// # Example
/// ```
/// use breakaway_batch::friction_curve;
/// use breakaway_core::{joint::Joint, test_models::paper_joint};
/// // The curve of equation (3) has its turning point at v_s / √2.
/// let at = 0.09 / 2.0_f64.sqrt();
/// let curve = friction_curve(&Joint::Lugre(paper_joint()), &[0.0], &[at]);
/// assert!((curve.slope_n_s_per_m[0] + 857.8).abs() < 0.1);
/// assert!(curve.curvature_n_s2_per_m2[0].abs() < 1e-9);
/// ```
#[must_use]
pub fn friction_curve(
    joint: &Joint<f64>,
    position_m: &[f64],
    velocity_m_per_s: &[f64],
) -> FrictionCurve {
    let points = Points { joint, position_m, velocity_m_per_s };
    let [force_n, slope_n_s_per_m, curvature_n_s2_per_m2] = points.columns::<Bent, 3>();
    FrictionCurve { force_n, slope_n_s_per_m, curvature_n_s2_per_m2 }
}

/// What is asked of a joint at a point. A type and not a closure: see [`breakaway_core::real::Block`].
trait Asked<const COLUMNS: usize> {
    /// What a point is computed with.
    type Number<V: Wide>: Real;

    fn at<V: Wide>(joint: &Joint<Self::Number<V>>, x: V, v: V) -> [V; COLUMNS];
}

struct Settled;

impl Asked<5> for Settled {
    type Number<V: Wide> = V;

    #[inline(always)]
    fn at<V: Wide>(joint: &Joint<V>, x: V, v: V) -> [V; 5] {
        let found = steady(joint, x, v);
        [
            found.level_n,
            found.viscous_n_s_per_m,
            found.damping_n_s_per_m,
            found.rate_per_s,
            found.lead,
        ]
    }
}

/// A number with its first and second derivative.
type Bending<V> = Dual<Dual<V, 1>, 1>;

struct Bent;

impl Asked<3> for Bent {
    type Number<V: Wide> = Bending<V>;

    #[inline(always)]
    fn at<V: Wide>(joint: &Joint<Bending<V>>, x: V, v: V) -> [V; 3] {
        let fixed = Dual { value: x, derivative: [V::zero()] };
        let x = Dual { value: fixed, derivative: [Dual::zero()] };
        let v = Dual::variable(Dual::variable(v, 0), 0);
        let Dual { value: force, derivative: [slope] } = steady(joint, x, v).force_n(v);
        [force.value, slope.value, slope.derivative[0]]
    }
}

#[derive(Clone, Copy)]
struct Points<'a> {
    joint: &'a Joint<f64>,
    position_m: &'a [f64],
    velocity_m_per_s: &'a [f64],
}

impl Points<'_> {
    fn columns<A: Asked<COLUMNS>, const COLUMNS: usize>(self) -> [Vec<f64>; COLUMNS] {
        assert_eq!(self.position_m.len(), self.velocity_m_per_s.len());
        let asked = std::marker::PhantomData::<A>;
        Instructions::fastest().run(Columns { points: self, asked })
    }
}

struct Columns<'a, A, const COLUMNS: usize> {
    points: Points<'a>,
    asked: std::marker::PhantomData<A>,
}

impl<A: Asked<COLUMNS>, const COLUMNS: usize> Kernel for Columns<'_, A, COLUMNS> {
    type Output = [Vec<f64>; COLUMNS];

    #[inline(always)]
    fn run<V: Wide, const N: usize>(self) -> [Vec<f64>; COLUMNS] {
        let Points { joint, position_m, velocity_m_per_s } = self.points;
        let joint = joint.map(&mut |_, value| A::Number::<V>::constant(value));
        let mut columns = [const { Vec::new() }; COLUMNS];
        for (x, v) in position_m.chunks(N).zip(velocity_m_per_s.chunks(N)) {
            let values = A::at(&joint, side_by_side::<V, N>(x), side_by_side::<V, N>(v));
            for (column, value) in columns.iter_mut().zip(values) {
                column.extend((0..x.len()).map(|lane| value.extract(lane)));
            }
        }
        columns
    }
}

/// At most as many values as there are lanes; those beyond the last repeat it.
#[inline(always)]
fn side_by_side<V: Wide, const N: usize>(values: &[f64]) -> V {
    let mut lanes = [values[values.len() - 1]; N];
    lanes[..values.len()].copy_from_slice(values);
    V::gather(&lanes)
}
