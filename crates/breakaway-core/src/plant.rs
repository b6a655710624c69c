//! Newton's law for the part, and the two ways to integrate it with its joint.

use crate::disturbance::Factors;
use crate::joint::{Bristle, JointState, Law};
use crate::parameters::parameters;
use crate::real::Real;

parameters! {
    /// What moves: the part on its seat.
    pub struct PlantState {
        /// x in m: 0 at the seat, l_f when free.
        pub position_m,
        /// v in m/s.
        pub velocity_m_per_s,
        /// z in m, deflection of the bristles.
        pub bristle_m,
        /// 1 while a law with a slip event slides, else 0.
        pub sliding,
        /// R in N before its disturbance, at the middle of the last step. Start it at zero.
        pub joint_force_n,
    }
}

impl<R: Real> PlantState<R> {
    /// At rest on the seat, bristles relaxed.
    pub fn at_rest() -> Self {
        let zero = R::zero();
        Self {
            position_m: zero,
            velocity_m_per_s: zero,
            bristle_m: zero,
            sliding: zero,
            joint_force_n: zero,
        }
    }

    #[inline(always)]
    fn joint(&self) -> JointState<R> {
        JointState { bristle_m: self.bristle_m, sliding: self.sliding }
    }
}

/// How the plant is stepped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Integrator {
    /// Linearly implicit midpoint: second order, stable on the stiff bristle at the control period.
    LinearlyImplicitMidpoint,
    /// Classical Runge-Kutta of order four, explicit: the oracle, at a step of 0.1 us.
    Rk4,
}

/// m dv/dt = F − R,  dx/dt = v,  with R = 0 beyond the end of the guide.
#[derive(Clone, Copy, Debug)]
pub struct Plant<'a, R, L> {
    /// The joint that holds the part.
    pub joint: &'a L,
    /// m in kg.
    pub mass_kg: R,
    /// F in N, constant over a step.
    pub force_n: R,
    /// The disturbance, constant over a step.
    pub factors: Factors<R>,
}

impl<R: Real, L: Law<R>> Plant<'_, R, L> {
    /// Steps by `h` seconds; gives the mean joint force in N over the step, disturbance included.
    #[inline(always)]
    pub fn step(&self, integrator: Integrator, state: &mut PlantState<R>, h: R) -> R {
        let settled = self.joint.settle(
            state.joint(),
            state.position_m,
            state.velocity_m_per_s,
            self.factors.friction_level,
        );
        (state.bristle_m, state.sliding) = (settled.bristle_m, settled.sliding);
        match integrator {
            Integrator::LinearlyImplicitMidpoint => self.linearly_implicit_midpoint(state, h),
            Integrator::Rk4 => self.rk4(state, h),
        }
    }

    #[inline(always)]
    fn engaged(&self, x: R) -> R::Mask {
        x.lt(self.joint.engagement_length_m())
    }

    /// The bristle equation is linear in (v, z) once its coefficients are frozen at a predicted
    /// midpoint velocity; the midpoint rule then has the closed form below. With k = h/2,
    /// w = v + k F/m and q = k n/m (n the factor on the joint force):
    ///
    /// ```text
    /// v_m = w − q R_m,   R_m = k_e z_m + c ż_m + σ v_m,   z_m = z + k ż_m,   ż_m = α v_m − (A/g) z_m
    /// den = g [1 + q σ + q k α (k_e + c/k)] + k A (1 + q σ)
    /// v_m = [g (w − q k_e z) + k A (w + q c/k z)] / den
    /// R_m = (w − v_m) / q
    /// z_m = (R_m + c/k z − σ v_m) / (k_e + c/k)
    /// ```
    ///
    /// Multiplying through by g leaves one division; collecting powers of g leaves the shortest
    /// chain after the exponential in g, which is what a single run waits for, and coefficients
    /// that change at a redraw only. R_m = (w − v_m) / q is the joint force of the first line. A
    /// part whose middle is beyond the guide moves by w alone; its R_m is zero, and its bristle relaxes.
    /// Derivation and error constants: `docs/derivations/linearly_implicit_midpoint.md`.
    #[inline(always)]
    fn linearly_implicit_midpoint(&self, state: &mut PlantState<R>, h: R) -> R {
        let (v, z) = (state.velocity_m_per_s, state.bristle_m);
        let k = R::constant(0.5) * h;
        let k_over_m = k / self.mass_kg;
        let x_mid = k.mul_add(v, state.position_m);
        let n = self.factors.joint_force;
        let q = k_over_m * n;
        let w = k_over_m.mul_add(self.force_n, v);
        let v_predicted = (-q).mul_add(state.joint_force_n, w);
        let level = self.factors.friction_level;
        let b = self.joint.freeze(&state.joint(), x_mid, v_predicted, level);

        let g = b.friction_level_n;
        let (k_e, c_over_k) = (b.stiffness_n_per_m, b.damping_n_s_per_m / k);
        let viscous = match b.viscous_n_s_per_m {
            Some(sigma) => q.mul_add(sigma, R::one()), // 1 + q σ, divided out below
            None => R::one(),
        };
        let per_level = (q * k * b.stretch).mul_add(k_e + c_over_k, viscous) / viscous;
        let slip = k * b.relaxation_n_per_m * b.speed_m_per_s; // k A
        let two_over_den = R::constant(2.0) / viscous / g.mul_add(per_level, slip);
        let driven = g.mul_add((q * k_e).mul_add(-z, w), slip * (q * c_over_k).mul_add(z, w));

        let two_w = w + w;
        let two_v = R::select(self.engaged(x_mid), driven * two_over_den, two_w);
        let lost = two_w - two_v; // 2 q R_m
        let per_lost = R::constant(0.5) / k_over_m * (R::one() / n); // 1 / (2 q)
        let per_force = R::one() / (k_e + c_over_k);
        let kept = (per_force * c_over_k).mul_add(R::constant(2.0), -R::one()) * z;
        let kept = match b.viscous_n_s_per_m {
            Some(sigma) => (-(per_force * sigma)).mul_add(two_v, kept),
            None => kept,
        };
        state.joint_force_n = lost * per_lost;
        state.position_m = k.mul_add(two_v, state.position_m);
        state.velocity_m_per_s = two_v - v;
        state.bristle_m = (per_force * R::constant(2.0) * per_lost).mul_add(lost, kept);
        n * state.joint_force_n
    }

    /// (dx/dt, dv/dt, dz/dt) and the joint force in N, disturbance included.
    #[inline(always)]
    fn rates(&self, state: &JointState<R>, x: R, v: R, z: R) -> ([R; 3], R) {
        let b: Bristle<R> = self.joint.freeze(state, x, v, self.factors.friction_level);
        let z_rate = b.rate(v, z);
        let force = self.factors.joint_force * b.force(v, z, z_rate);
        let engaged = self.engaged(x);
        let joint_force = R::select(engaged, force, R::zero());
        let z_rate = R::select(engaged, z_rate, R::zero());
        ([v, (self.force_n - joint_force) / self.mass_kg, z_rate], joint_force)
    }

    #[inline(always)]
    fn rk4(&self, state: &mut PlantState<R>, h: R) -> R {
        let joint = state.joint();
        let start = [state.position_m, state.velocity_m_per_s, state.bristle_m];
        let at = |slope: &[R; 3], step: R| {
            let [x, v, z] = core::array::from_fn(|i| start[i] + step * slope[i]);
            self.rates(&joint, x, v, z)
        };
        let half = R::constant(0.5) * h;
        let (k1, r1) = at(&[R::zero(); 3], R::zero());
        let (k2, r2) = at(&k1, half);
        let (k3, r3) = at(&k2, half);
        let (k4, r4) = at(&k3, h);
        let mean =
            |a: R, b: R, c: R, d: R| (a + d + R::constant(2.0) * (b + c)) * R::constant(1.0 / 6.0);
        let [x, v, z]: [R; 3] =
            core::array::from_fn(|i| start[i] + h * mean(k1[i], k2[i], k3[i], k4[i]));
        let z = R::select(self.engaged(x), z, R::zero());
        (state.position_m, state.velocity_m_per_s, state.bristle_m) = (x, v, z);
        let joint_force = mean(r1, r2, r3, r4);
        state.joint_force_n = joint_force / self.factors.joint_force;
        joint_force
    }
}

/// A step of `h` seconds with the motion imposed instead of the force, as on a test rig: velocity
/// `v` in m/s over the step. Gives the joint force in N at the middle of the step, undisturbed.
///
/// ```text
/// z_m = (z + k α v) / (1 + k A / g),   k = h / 2
/// ```
///
/// The midpoint rule again, second order and stable for any step. The velocity of `state` is set
/// to `v`. Beyond the end of the guide the force is zero.
#[inline(always)]
pub fn impose_motion<R: Real>(joint: &impl Law<R>, state: &mut PlantState<R>, v: R, h: R) -> R {
    let (zero, one) = (R::zero(), R::one());
    let settled = joint.settle(state.joint(), state.position_m, v, one);
    (state.bristle_m, state.sliding) = (settled.bristle_m, settled.sliding);
    let k = R::constant(0.5) * h;
    let x_mid = k.mul_add(v, state.position_m);
    let b = joint.freeze(&settled, x_mid, v, one);
    let relaxed = one + k * b.relaxation() / b.friction_level_n;
    let z_mid = (k * b.stretch).mul_add(v, state.bristle_m) / relaxed;
    let engaged = x_mid.lt(joint.engagement_length_m());
    let force = R::select(engaged, b.force(v, z_mid, b.rate(v, z_mid)), zero);
    state.bristle_m = R::select(engaged, R::constant(2.0) * z_mid - state.bristle_m, zero);
    state.position_m = h.mul_add(v, state.position_m);
    state.velocity_m_per_s = v;
    state.joint_force_n = force;
    force
}
