//! A piezo stack and its amplifier.

use super::{ActuatorState, Command};
use crate::parameters::parameters;
use crate::real::Real;

parameters! {
    /// A preloaded stack: a spring whose rest length follows its voltage, with hysteresis.
    ///
    /// ```text
    /// dV/dt = clip((s V_max − V) / τ, −I_max / C, I_max / C)         amplifier: lag, and current
    /// u     = d [(1 − h) V + h w Σ_i play_i(V)] / V_max               free stroke
    /// play_i ← clip(play_i, V − r_i, V + r_i),  r_i = i V_max / 16     Prandtl and Ishlinskii
    /// w     = 1 / Σ_i (1 − r_i / V_max) = 8 / 27,  i = 1 … 4           so that u = d at V_max
    /// F     = k (u − Δx) − c dΔx/dt                                    force, Δx its lengthening
    /// ```
    ///
    /// The blocking force is k d; the first resonance of the stack, held at its foot, is
    /// sqrt(k / m) / 2π. Hysteresis is rate independent; creep and heat in the ceramic are not
    /// modeled. The play operators are those of M. A. Krasnosel'skii and A. V. Pokrovskii,
    /// *Systems with Hysteresis* (1989), with equal weights. Cycled over the full voltage, the stroke
    /// stays h 5/27 d above zero at 0 V, and both branches are at most h 10/27 d apart.
    pub struct Piezo {
        /// d in m: free stroke at the full voltage.
        pub stroke_m,
        /// k in N/m.
        pub stiffness_n_per_m,
        /// m in kg: the mass at the tip that gives the first resonance.
        pub tip_mass_kg,
        /// c in N s/m.
        pub damping_n_s_per_m,
        /// h, 0 to below 1: the share of the stroke that lags.
        pub hysteresis_share,
        /// F_0 in N: the stack is pressed by this much when relaxed.
        pub preload_n,
        /// C in F.
        pub capacitance_f,
        /// tan δ: dielectric loss at 1 kHz; it heats and does not act on the motion.
        pub loss_tangent,
        /// V_max in V.
        pub voltage_max_v,
        /// I_max in A.
        pub current_max_a,
        /// 1 / (2 π τ) in Hz.
        pub amplifier_bandwidth_hz,
    }
}

/// What the amplifier did in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Charged<R> {
    /// u before the step, m.
    pub before_m: R,
    /// I in A, the mean of the step.
    pub current_a: R,
    /// 1 where the current was at its limit.
    pub limited: R,
}

impl<R: Real> Charged<R> {
    /// What a tip without a stack has.
    #[inline(always)]
    pub(super) fn none() -> Self {
        Self { before_m: R::zero(), current_a: R::zero(), limited: R::zero() }
    }
}

impl<R: Real> Piezo<R> {
    /// r_i / V_max of the play operators.
    pub const PLAY: [f64; 4] = [1.0 / 16.0, 2.0 / 16.0, 3.0 / 16.0, 4.0 / 16.0];
    /// w of each of them.
    pub const WEIGHT: f64 = 8.0 / 27.0;

    /// Moves the voltage and the free stroke by `h` seconds.
    #[inline(always)]
    pub(super) fn charge(
        &self,
        state: &mut ActuatorState<R>,
        command: &Command<R>,
        h: R,
    ) -> Charged<R> {
        R::section("stack: dV/dt = clip((s V_max - V) / tau, -I_max / C, I_max / C)");
        let target = command.stack_share.clamp(R::zero(), R::one()) * self.voltage_max_v;
        let per_s = R::constant(-2.0 * core::f64::consts::PI) * self.amplifier_bandwidth_hz;
        let share = (R::one() - (per_s * h).exp()).named("amplifier_share");
        let wanted = ((target - state.voltage_v) * share).named("wanted_change_v");
        let most = (self.current_max_a * h / self.capacitance_f).named("most_v");
        let change = wanted.clamp(-most, most).named("change_v");
        state.voltage_v = (state.voltage_v + change).named("voltage_v");
        let before_m = state.stroke_m;
        self.play(state);
        state.stroke_m = self.free_stroke(state);
        Charged {
            before_m,
            current_a: self.capacitance_f * change / h,
            limited: R::flag(change.lt(wanted) | wanted.lt(change)),
        }
    }

    #[inline(always)]
    fn play(&self, state: &mut ActuatorState<R>) {
        R::section("stack, hysteresis: play_i = clip(play_i, V - r_i, V + r_i)");
        let v = state.voltage_v;
        let [r1, r2, r3, r4] = Self::PLAY;
        state.play_1_v = self.played(state.play_1_v, v, r1);
        state.play_2_v = self.played(state.play_2_v, v, r2);
        state.play_3_v = self.played(state.play_3_v, v, r3);
        state.play_4_v = self.played(state.play_4_v, v, r4);
    }

    #[inline(always)]
    fn played(&self, play: R, v: R, share: f64) -> R {
        let r = (R::constant(share) * self.voltage_max_v).named("play_range_v");
        play.clamp(v - r, v + r).named("play_v")
    }

    /// u in m for the voltage and the play operators of `state`.
    #[inline(always)]
    pub fn free_stroke(&self, state: &ActuatorState<R>) -> R {
        let played = state.play_1_v + state.play_2_v + state.play_3_v + state.play_4_v;
        let lagging = self.hysteresis_share * R::constant(Self::WEIGHT) * played;
        let direct = (R::one() - self.hysteresis_share).mul_add(state.voltage_v, lagging);
        ((self.stroke_m / self.voltage_max_v).named("stroke_m_per_v") * direct.named("direct_v"))
            .named("stroke_m")
    }
}
