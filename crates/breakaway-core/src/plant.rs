//! Newton's law for the part, and the two ways to integrate it with its joint.

use crate::crossing::Motion;
use crate::disturbance::Factors;
use crate::joint::{At, Bristle, ElementState, Elements, Frozen, JointState, Law, Rigid};
use crate::maybe::Maybe;
use crate::name::{Name, within};
use crate::parameters::parameters;
use crate::real::{Block, Real};
use crate::variation::{FieldCell, Variation};

/// What moves: the part on its seat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantState<R> {
    /// x in m: 0 at the seat, l_f when free.
    pub position_m: R,
    /// v in m/s.
    pub velocity_m_per_s: R,
    /// z in m, deflection of the bristles; the mean Σ k_i z_i / k_e of several elements.
    pub bristle_m: R,
    /// 1 while a law with a slip event slides, else 0.
    pub sliding: R,
    /// R in N before its disturbance, at the middle of the last step. Start it at zero.
    pub joint_force_n: R,
    /// What a law with several elements remembers of each; other laws leave it alone.
    pub elements: ElementState<R>,
    /// z_y in m, deflection of the bristles across the motion; zero where nothing vibrates there.
    pub transverse_bristle_m: R,
    /// Where in a field of friction the part was last.
    pub cell: FieldCell<R>,
}

impl<R: Copy> PlantState<R> {
    /// Applies `f` to every number.
    pub fn map<S>(&self, f: &mut impl FnMut(Name<'_>, R) -> S) -> PlantState<S> {
        PlantState {
            position_m: f(Name::of("position_m"), self.position_m),
            velocity_m_per_s: f(Name::of("velocity_m_per_s"), self.velocity_m_per_s),
            bristle_m: f(Name::of("bristle_m"), self.bristle_m),
            sliding: f(Name::of("sliding"), self.sliding),
            joint_force_n: f(Name::of("joint_force_n"), self.joint_force_n),
            elements: within!("elements", self.elements, f),
            transverse_bristle_m: f(Name::of("transverse_bristle_m"), self.transverse_bristle_m),
            cell: within!("cell", self.cell, f),
        }
    }
}

impl<R: Real> PlantState<R> {
    /// At rest on the seat, bristles relaxed.
    #[inline(always)]
    pub fn at_rest() -> Self {
        let zero = R::zero();
        Self {
            position_m: zero,
            velocity_m_per_s: zero,
            bristle_m: zero,
            sliding: zero,
            joint_force_n: zero,
            elements: ElementState::at_rest(),
            transverse_bristle_m: zero,
            cell: FieldCell::nowhere(),
        }
    }

    #[inline(always)]
    pub(crate) fn joint(&self) -> JointState<R> {
        JointState {
            bristle_m: self.bristle_m,
            transverse_bristle_m: self.transverse_bristle_m,
            sliding: self.sliding,
        }
    }

    /// What the bristles of a joint in this state hold, in J.
    #[inline(always)]
    pub fn stored_energy_j(&self, joint: &impl Law<R>) -> R {
        joint.stored_energy_j(self.bristle_m, &self.elements)
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

/// What pushes the part during a step.
///
/// ```text
/// F = F_0                                               rigid: whatever the part does
/// F = max(0, F_0 − S v_m)                               through something compliant that cannot pull
/// F = max(0, F_0 − S v_m) + min(0, F_b − S v_m)         through a grip with play: F_b ≥ F_0
/// ```
///
/// v_m is the part's velocity at the middle of the step, F_0 the force there if the part stood
/// still, and S ≥ 0 how much of it each m/s takes away. A spring of k N/m between part and pusher
/// has S = k h / 2, a damper its own constant. F_b is the force of the face that pulls, as F_0 that of the
/// one that pushes: play of b m makes F_b larger by k b, and without play they are one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push<R> {
    /// F_0 in N.
    pub force_n: R,
    /// S in N s/m; none for a rigid push.
    pub yielding_n_s_per_m: Maybe<R>,
    /// F_b in N; none for what cannot pull.
    pub pull_n: Maybe<R>,
}

impl<R: Real> Push<R> {
    /// The same force whatever the part does.
    #[inline(always)]
    pub fn rigid(force_n: R) -> Self {
        Self { force_n, yielding_n_s_per_m: Maybe::none(), pull_n: Maybe::none() }
    }

    /// A force that falls with the part's velocity, and cannot pull.
    #[inline(always)]
    pub fn yielding(force_n: R, yielding_n_s_per_m: R) -> Self {
        let yielding_n_s_per_m = Maybe::some(yielding_n_s_per_m);
        Self { force_n, yielding_n_s_per_m, pull_n: Maybe::none() }
    }

    /// F in N on a part whose middle velocity is v_free + Y F:
    ///
    /// ```text
    /// F = max(0, (F_0 − S v_free) / (1 + S Y)) + min(0, (F_b − S v_free) / (1 + S Y))
    /// ```
    ///
    /// This is the one F that agrees with both, since neither face's force rises with F.
    #[inline(always)]
    pub fn meets(&self, free_m_per_s: R, mobility_m_per_n_s: R) -> R {
        match self.yielding_n_s_per_m.get() {
            Some(&s) => {
                let stopped = s.mul_add(mobility_m_per_n_s, R::one()).named("stopped");
                let met_n = (-s).mul_add(free_m_per_s, self.force_n) / stopped;
                let pushed_n = R::zero().max(met_n.named("met_n")).named("contact_n");
                match self.pull_n.get() {
                    Some(&pull_n) => {
                        let held_n = (-s).mul_add(free_m_per_s, pull_n) / stopped;
                        (pushed_n + R::zero().min(held_n.named("held_n"))).named("grip_n")
                    }
                    None => pushed_n,
                }
            }
            None => self.force_n,
        }
    }
}

parameters! {
    /// What happened during a step.
    pub struct Moved {
        /// R in N: the mean, disturbance included.
        pub joint_force_n,
        /// F in N.
        pub push_force_n,
        /// Travel over time, m/s.
        pub mean_velocity_m_per_s,
        /// What the velocity gained, m/s; as if the joint had held to the end, where it let go within.
        pub change_m_per_s,
        /// ∫ R dx in J.
        pub joint_work_j,
    }
}

/// m dv/dt = F − R,  dx/dt = v,  with R = 0 beyond the end of the guide.
#[derive(Clone, Copy, Debug)]
pub struct Plant<'a, R, L> {
    /// The joint that holds the part.
    pub joint: &'a L,
    /// m in kg.
    pub mass_kg: R,
    /// F, its numbers constant over a step.
    pub push: Push<R>,
    /// The disturbance, constant over a step.
    pub factors: Factors<R>,
    /// How the friction levels vary otherwise; over a step they are those of its middle.
    pub variation: &'a Variation<R>,
}

/// What a step of the midpoint rule starts from.
#[derive(Clone, Copy)]
struct Midpoint<R: Real> {
    /// k = h/2 in s.
    k: R,
    /// k/m in s/kg.
    k_over_m: R,
    /// q = k n/m in s/kg, n the factor on the joint force.
    q: R,
    /// Whether the joint holds at the start of the step.
    engaged: R::Mask,
    /// Velocity across the motion, if there is any, m/s.
    transverse_m_per_s: Maybe<R>,
}

impl<R: Real, L: Law<R> + Copy> Plant<'_, R, L> {
    /// Steps by `h` seconds from time `t` in s.
    ///
    /// Runge-Kutta steps a rigid push on a law of one bristle; callers see to that. With anything
    /// else it gives numbers that are none.
    #[inline(always)]
    pub fn step(&self, integrator: Integrator, state: &mut PlantState<R>, t: R, h: R) -> Moved<R> {
        let (x, v) = (state.position_m, state.velocity_m_per_s);
        let k = (R::constant(0.5) * h).named("half_step_s");
        let x_mid = k.mul_add(v, x).named("middle_m");
        let level_factor = self.level_factor(&mut state.cell, x_mid, t + k);
        let mut settled = self.joint.settle(state.joint(), x, v, level_factor);
        if self.variation.levels_read_time() {
            let (joint, elements) = (*self.joint, state.elements);
            let letting = LettingGo { joint, settled, elements, x: x_mid, level_factor };
            (settled, state.elements) = R::apart(letting);
            state.transverse_bristle_m = settled.transverse_bristle_m;
        }
        (state.bristle_m, state.sliding) = (settled.bristle_m, settled.sliding);
        match integrator {
            Integrator::LinearlyImplicitMidpoint => {
                let transverse_m_per_s = self.variation.transverse_m_per_s(t + k);
                let at = At {
                    position_m: x_mid,
                    velocity_m_per_s: v,
                    level_factor,
                    transverse_m_per_s,
                    ahead_s: k,
                };
                self.linearly_implicit_midpoint(state, &at)
            }
            Integrator::Rk4 => {
                let (joint, variation) = (*self.joint, *self.variation);
                let Self { mass_kg, push, factors, .. } = *self;
                let stepped =
                    Explicit { joint, variation, mass_kg, push, factors, state: *state, t, h };
                let (next, moved) = R::apart(stepped);
                *state = next;
                moved
            }
        }
    }

    /// What the friction levels are multiplied by at position `x` and time `t`.
    #[inline(always)]
    fn level_factor(&self, cell: &mut FieldCell<R>, x: R, t: R) -> R {
        if self.variation.is_none() {
            return self.factors.friction_level;
        }
        self.factors.friction_level * self.variation.factor(cell, x, t)
    }

    #[inline(always)]
    fn engaged(&self, x: R) -> R::Mask {
        x.lt(self.joint.engagement_length_m())
    }

    /// The law, frozen at a predicted midpoint velocity, gives R_m = R_0 + D v_m; the midpoint rule
    /// m (v_m − v) / k = F − n R_m is then solved in closed form, stuck or sliding. The prediction
    /// takes the joint force of the step before, and the push that goes with it.
    #[inline(always)]
    fn linearly_implicit_midpoint(&self, state: &mut PlantState<R>, begun: &At<R>) -> Moved<R> {
        R::section("prediction: the velocity at the middle of the step, with the last joint force");
        let (v, k) = (begun.velocity_m_per_s, begun.ahead_s);
        let k_over_m = (k / self.mass_kg).named("k_over_m_s_per_kg");
        let q = (k_over_m * self.factors.joint_force).named("q_s_per_kg");
        let v_predicted = match self.push.yielding_n_s_per_m.get() {
            Some(_) => {
                let unpushed = (-q).mul_add(state.joint_force_n, v);
                k_over_m.mul_add(self.push.meets(unpushed, k_over_m), unpushed)
            }
            None => {
                let w = k_over_m.mul_add(self.push.force_n, v).named("w_m_per_s");
                (-q).mul_add(state.joint_force_n, w)
            }
        }
        .named("predicted_m_per_s");
        let at = At { velocity_m_per_s: v_predicted, ..*begun };
        let joint = state.joint();
        let engaged = self.engaged(state.position_m);
        let transverse_m_per_s = begun.transverse_m_per_s;
        let middle = Midpoint { k, k_over_m, q, engaged, transverse_m_per_s };
        self.joint.frozen(&joint, &at, Step { plant: self, state, middle })
    }

    /// One bristle. With w = v + k F/m:
    ///
    /// ```text
    /// v_m = w − q R_m,   R_m = k_e z_m + c ż_m + σ v_m,   z_m = z + k ż_m,   ż_m = α v_m − (A/g) z_m
    /// den = g [1 + q σ + q k α (k_e + c/k)] + k A (1 + q σ)
    /// v_m = [g (w − q k_e z) + k A (w + q c/k z)] / den
    /// Y   = ∂v_m/∂F = (k/m) (g + k A) / den
    /// R_m = (w − v_m) / q
    /// z_m = (R_m + c/k z − σ v_m) / (k_e + c/k)
    /// ```
    ///
    /// Multiplying through by g leaves one division; collecting powers of g leaves the shortest
    /// chain after the exponential in g, which is what a single run waits for, and coefficients
    /// that change at a redraw only. R_m = (w − v_m) / q is the joint force of the first line. A
    /// part that begins beyond the guide moves by w alone; its R_m and its bristle are zero.
    /// Derivation and error constants: `docs/derivations/linearly_implicit_midpoint.md`.
    #[inline(always)]
    fn step_bristle(
        &self,
        state: &mut PlantState<R>,
        at: &Midpoint<R>,
        b: &Bristle<R>,
    ) -> Moved<R> {
        R::section("midpoint: v_m = [g (w - q k_e z) + k A (w + q c/k z)] / den");
        let (v, z) = (state.velocity_m_per_s, state.bristle_m);
        let &Midpoint { k, k_over_m, q, engaged, .. } = at;
        let n = self.factors.joint_force;
        let g = b.friction_level_n;
        let c_over_k = (b.damping_n_s_per_m / k).named("damping_n_per_m");
        let k_e = b.stiffness_n_per_m;
        let viscous = match b.viscous_n_s_per_m.get() {
            Some(&sigma) => q.mul_add(sigma, R::one()).named("viscous"), // 1 + q σ, divided out below
            None => R::one(),
        };
        let stiff = (k_e + c_over_k).named("stiff_n_per_m");
        let per_level = ((q * k * b.stretch).mul_add(stiff, viscous) / viscous).named("per_level");
        let slip = (k * b.relaxation_n_per_m * b.speed_m_per_s).named("slip_n"); // k A
        let den = g.mul_add(per_level, slip).named("den_n");
        let two_over_den = (R::constant(2.0) / viscous / den).named("two_over_den_per_n");
        let force_n = match self.push.yielding_n_s_per_m.get() {
            Some(_) => {
                let half = R::constant(0.5) * two_over_den;
                let free = g.mul_add((q * k_e).mul_add(-z, v), slip * (q * c_over_k).mul_add(z, v));
                let held = self.push.meets(free * half, k_over_m * ((g + slip) * half));
                R::select(engaged, held, self.push.meets(v, k_over_m))
            }
            None => self.push.force_n,
        };
        let w = k_over_m.mul_add(force_n, v).named("w_m_per_s");
        let driven = g.mul_add((q * k_e).mul_add(-z, w), slip * (q * c_over_k).mul_add(z, w));

        let two_w = (w + w).named("two_w_m_per_s");
        let two_v = R::select(engaged, driven.named("driven") * two_over_den, two_w);
        let two_v = two_v.named("two_v_m_per_s");
        R::section("joint force: R_m = (w - v_m) / q; bristle: z_m = (R_m + c/k z) / (k_e + c/k)");
        let lost = (two_w - two_v).named("lost_m_per_s"); // 2 q R_m
        let half_m_over_k = (R::constant(0.5) / k_over_m).named("half_m_over_k_kg_per_s");
        let per_lost = (half_m_over_k * (R::one() / n)).named("per_lost_kg_per_s"); // 1 / (2 q)
        let per_force = (R::one() / stiff).named("per_force_m_per_n");
        let kept_share = (per_force * c_over_k).mul_add(R::constant(2.0), -R::one());
        let kept = kept_share.named("kept_share") * z;
        let kept = match b.viscous_n_s_per_m.get() {
            Some(&sigma) => (-(per_force * sigma)).mul_add(two_v, kept),
            None => kept,
        };
        let per_force = (per_force * R::constant(2.0)).named("two_per_force_m_per_n");
        let held = (per_force * per_lost).mul_add(lost, kept);
        state.bristle_m = R::select(engaged, held, R::zero()).named("bristle_m");
        if let Some(&across) = at.transverse_m_per_s.get() {
            let z = (k * g).mul_add(across, g * state.transverse_bristle_m) / (g + slip);
            let z = z + z - state.transverse_bristle_m;
            state.transverse_bristle_m = R::select(engaged, z, R::zero());
        }
        self.carry(state, at, two_v, lost * per_lost, force_n)
    }

    /// Several elements:
    ///
    /// ```text
    /// R_m = R_0 + D v_m,   v_m = (v + k F/m − q R_0) / (1 + q D),   Y = (k/m) / (1 + q D)
    /// ```
    #[inline(always)]
    fn step_elements(
        &self,
        state: &mut PlantState<R>,
        at: &Midpoint<R>,
        elements: &Elements<'_, R>,
    ) -> Moved<R> {
        let v = state.velocity_m_per_s;
        let &Midpoint { k, k_over_m, q, engaged, .. } = at;
        let mut moving = state.elements;
        let ahead = elements.ahead(&mut moving, k);
        R::section("midpoint: v_m = (v + k F/m - q R_0) / (1 + q D)");
        let resisted = q.mul_add(ahead.resistance_n_s_per_m, R::one()).named("resisted");
        let per_resisted = (R::one() / resisted).named("per_resisted");
        let free = ((-q).mul_add(ahead.force_at_rest_n, v) * per_resisted).named("free_m_per_s");
        let mobility = (k_over_m * per_resisted).named("mobility_m_per_n_s");
        let force_n =
            R::select(engaged, self.push.meets(free, mobility), self.push.meets(v, k_over_m));
        let held = mobility.mul_add(force_n, free);
        let v_mid = R::select(engaged, held, k_over_m.mul_add(force_n, v)).named("middle_m_per_s");
        let joint_force = ahead.resistance_n_s_per_m.mul_add(v_mid, ahead.force_at_rest_n);
        state.bristle_m = elements.finish(&ahead, &mut moving, v_mid, engaged);
        state.elements = moving;
        let joint_force = R::select(engaged, joint_force, R::zero());
        self.carry(state, at, v_mid + v_mid, joint_force, force_n)
    }

    /// No bristle: the force that stops the part within the step, limited to the level.
    ///
    /// ```text
    /// holds:  v_m = v/2,    R = [v + k F/m − (1 + q σ) v/2] / q     if −L_b ≤ R ≤ L
    /// slips:  v_m = (v + k F/m − q R) / (1 + q σ)                   with R = L or −L_b, the nearer
    /// ```
    #[inline(always)]
    fn step_rigid(
        &self,
        state: &mut PlantState<R>,
        at: &Midpoint<R>,
        rigid: &Rigid<R>,
    ) -> Moved<R> {
        let v = state.velocity_m_per_s;
        let &Midpoint { k_over_m, q, engaged, .. } = at;
        let (zero, half) = (R::zero(), R::constant(0.5));
        R::section(
            "rigid joint: the force that stops the part within the step, limited to the level",
        );
        let sigma = R::select(engaged, rigid.viscous_n_s_per_m.unwrap_or(zero), zero);
        let viscous = q.mul_add(sigma, R::one()).named("viscous");
        let level = R::select(engaged, rigid.level_n, zero);
        let backward_level = R::select(engaged, rigid.backward_level_n, zero);

        let stopping = self.push.meets(half * v, zero);
        let wanted = ((-half * viscous).mul_add(v, k_over_m.mul_add(stopping, v))) / q;
        let wanted = wanted.named("wanted_n");
        let friction = wanted.min(level).max(-backward_level).named("friction_n");
        let slips = level.lt(wanted) | wanted.lt(-backward_level);
        let per_viscous = (R::one() / viscous).named("per_viscous");
        let free = ((-q).mul_add(friction, v) * per_viscous).named("free_m_per_s");
        let force_n = R::select(slips, self.push.meets(free, k_over_m * per_viscous), stopping);
        let sliding = (k_over_m * per_viscous).mul_add(force_n, free);
        let two_v = R::select(slips, sliding + sliding, v).named("two_v_m_per_s");
        state.sliding = R::flag(slips);
        let joint_force = (half * sigma).mul_add(two_v, friction);
        self.carry(state, at, two_v, joint_force, force_n)
    }

    /// Ends a step whose middle velocity was `two_v` / 2. Where it leads out of the guide, the joint
    /// force R acts up to there and no further: for the rest of the step, h_r, the part is faster.
    ///
    /// ```text
    /// v ← v + h_r n R / m,   x ← x + h_r² n R / 2 m
    /// ```
    #[inline(always)]
    fn carry(
        &self,
        state: &mut PlantState<R>,
        at: &Midpoint<R>,
        two_v: R,
        joint_force_n: R,
        push_force_n: R,
    ) -> Moved<R> {
        R::section("motion: v = 2 v_m - v, x = x + h v_m");
        let (x, v, k) = (state.position_m, state.velocity_m_per_s, at.k);
        let half = R::constant(0.5);
        state.joint_force_n = joint_force_n.named("joint_force_n");
        state.position_m = k.mul_add(two_v, x).named("position_m");
        state.velocity_m_per_s = (two_v - v).named("velocity_m_per_s");
        let (held_n, end_m) =
            (self.factors.joint_force * joint_force_n, self.joint.engagement_length_m());
        let change = (state.velocity_m_per_s - v).named("change_m_per_s");
        let leaves = at.engaged & end_m.le(state.position_m);
        let motion = Motion {
            position_m: x,
            velocity_m_per_s: v,
            change_m_per_s: change,
            duration_s: k + k,
        };
        let rest = (R::one() - motion.share_at(end_m, leaves)).named("free_share");
        let gained = ((rest + rest) * (at.q * joint_force_n)).named("gained_m_per_s");
        let further_m = (k * rest * gained).named("further_m");
        let held_m = R::select(leaves, end_m - x, k * two_v);
        state.position_m = state.position_m + further_m;
        state.velocity_m_per_s = state.velocity_m_per_s + gained;
        Moved {
            joint_force_n: held_n * (R::one() - rest),
            push_force_n,
            mean_velocity_m_per_s: half.mul_add(two_v, half * rest * gained),
            change_m_per_s: change,
            joint_work_j: held_n * held_m,
        }
    }

    /// (dx/dt, dv/dt, dz/dt) and the joint force in N, disturbance included.
    #[inline(always)]
    fn rates(&self, state: &JointState<R>, t: R, [x, v, z]: [R; 3]) -> ([R; 3], R) {
        let state = JointState { bristle_m: z, ..*state };
        let level = if self.variation.is_none() {
            self.factors.friction_level
        } else {
            self.factors.friction_level * R::apart(Anywhere { variation: *self.variation, x, t })
        };
        let Some(b) = self.joint.freeze(&state, x, v, level) else {
            return ([R::constant(f64::NAN); 3], R::constant(f64::NAN));
        };
        let z_rate = b.rate(v, z);
        let force = self.factors.joint_force * b.force(v, z, z_rate);
        let engaged = self.engaged(x);
        let joint_force = R::select(engaged, force, R::zero());
        let z_rate = R::select(engaged, z_rate, R::zero());
        let push = match self.push.yielding_n_s_per_m.get() {
            Some(_) => R::constant(f64::NAN),
            None => self.push.force_n,
        };
        ([v, (push - joint_force) / self.mass_kg, z_rate], joint_force)
    }

    #[inline(always)]
    fn rk4(&self, state: &mut PlantState<R>, t: R, h: R) -> Moved<R> {
        R::section("Runge-Kutta of order four");
        let joint = state.joint();
        let start = [state.position_m, state.velocity_m_per_s, state.bristle_m];
        let half = R::constant(0.5) * h;
        let after_s = [R::zero(), half, half, h];
        let (mut slopes, mut forces) = ([[R::zero(); 3]; 4], [R::zero(); 4]);
        let mut slope = [R::zero(); 3];
        for stage in 0..4 {
            let ahead = ahead(&start, &slope, after_s[stage]);
            (slope, forces[stage]) = self.rates(&joint, t + after_s[stage], ahead);
            slopes[stage] = slope;
        }
        let [k1, k2, k3, k4] = slopes;
        let mean =
            |a: R, b: R, c: R, d: R| (a + d + R::constant(2.0) * (b + c)) * R::constant(1.0 / 6.0);
        let [x, v, z]: [R; 3] =
            core::array::from_fn(|i| start[i] + h * mean(k1[i], k2[i], k3[i], k4[i]));
        let z = R::select(self.engaged(x), z, R::zero());
        (state.position_m, state.velocity_m_per_s, state.bristle_m) = (x, v, z);
        let [r1, r2, r3, r4] = forces;
        let joint_force = mean(r1, r2, r3, r4);
        state.joint_force_n = joint_force / self.factors.joint_force;
        Moved {
            joint_force_n: joint_force,
            push_force_n: self.push.force_n,
            mean_velocity_m_per_s: (x - start[0]) / h,
            change_m_per_s: v - start[1],
            joint_work_j: joint_force * (x - start[0]),
        }
    }
}

/// start + step · slope.
#[inline(always)]
fn ahead<R: Real>(start: &[R; 3], slope: &[R; 3], step: R) -> [R; 3] {
    core::array::from_fn(|i| start[i] + step * slope[i])
}

/// A step of Runge-Kutta. By value, as every block: what a block refers to stays in memory.
struct Explicit<R, L> {
    joint: L,
    variation: Variation<R>,
    mass_kg: R,
    push: Push<R>,
    factors: Factors<R>,
    state: PlantState<R>,
    t: R,
    h: R,
}

impl<R: Real, L: Law<R> + Copy> Block for Explicit<R, L> {
    type Output = (PlantState<R>, Moved<R>);

    #[inline(always)]
    fn compute(self) -> (PlantState<R>, Moved<R>) {
        let Self { joint, variation, mass_kg, push, factors, mut state, t, h } = self;
        let plant = Plant { joint: &joint, mass_kg, push, factors, variation: &variation };
        let moved = plant.rk4(&mut state, t, h);
        (state, moved)
    }
}

/// What bristles let go where their level fell.
struct LettingGo<R, L> {
    joint: L,
    settled: JointState<R>,
    elements: ElementState<R>,
    x: R,
    level_factor: R,
}

impl<R: Real, L: Law<R>> Block for LettingGo<R, L> {
    type Output = (JointState<R>, ElementState<R>);

    #[inline(always)]
    fn compute(self) -> (JointState<R>, ElementState<R>) {
        let Self { joint, settled, mut elements, x, level_factor } = self;
        (joint.let_go(settled, &mut elements, x, level_factor), elements)
    }
}

/// What the friction levels are multiplied by at a place and a time that the part only passes.
struct Anywhere<R> {
    variation: Variation<R>,
    x: R,
    t: R,
}

impl<R: Real> Block for Anywhere<R> {
    type Output = R;

    #[inline(always)]
    fn compute(self) -> R {
        self.variation.factor(&mut FieldCell::nowhere(), self.x, self.t)
    }
}

/// A step of the midpoint rule, for whatever the law is.
struct Step<'a, 'b, R: Real, L> {
    plant: &'a Plant<'b, R, L>,
    state: &'a mut PlantState<R>,
    middle: Midpoint<R>,
}

impl<R: Real, L: Law<R> + Copy> Frozen<R> for Step<'_, '_, R, L> {
    type Output = Moved<R>;
    #[inline(always)]
    fn bristle(self, bristle: &Bristle<R>) -> Moved<R> {
        self.plant.step_bristle(self.state, &self.middle, bristle)
    }
    #[inline(always)]
    fn elements(self, elements: &Elements<'_, R>) -> Moved<R> {
        self.plant.step_elements(self.state, &self.middle, elements)
    }
    #[inline(always)]
    fn rigid(self, rigid: &Rigid<R>) -> Moved<R> {
        self.plant.step_rigid(self.state, &self.middle, rigid)
    }
}
