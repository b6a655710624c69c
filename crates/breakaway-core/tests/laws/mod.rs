#![allow(dead_code)] // each test uses what it needs
//! The paper's joint under every friction law.

use breakaway_core::joint::{
    CoulombStiction, ElastoPlastic, Gms, Joint, Lugre, TwoRegion, default_shares,
};
use breakaway_core::test_models::paper_joint;

/// e of the elasto-plastic joint.
pub(crate) const ELASTIC_SHARE: f64 = 0.7;

pub(crate) fn elasto_plastic(friction: Lugre<f64>) -> Joint<f64> {
    Joint::ElastoPlastic(ElastoPlastic { friction, elastic_share: ELASTIC_SHARE })
}

/// Elements of equal stiffness whose force follows its level within 0.1 ms or so.
pub(crate) fn gms(friction: Lugre<f64>, elements: u32) -> Gms<f64> {
    let (stiffness_shares, level_shares) = default_shares(elements);
    Gms { friction, attraction_n_per_s: 1e6, elements, stiffness_shares, level_shares }
}

pub(crate) fn two_region(law: Lugre<f64>) -> Joint<f64> {
    Joint::TwoRegion(TwoRegion {
        stiction_n: law.stiction_n,
        coulomb_n: law.coulomb_n,
        stiffness_n_per_m: law.stiffness_n_per_m,
        damping_n_s_per_m: law.damping_n_s_per_m,
        engagement_length_m: law.engagement_length_m,
        residual_n: law.residual_n,
        backward_ratio: law.backward_ratio,
    })
}

pub(crate) fn coulomb_stiction(law: Lugre<f64>) -> Joint<f64> {
    Joint::CoulombStiction(CoulombStiction {
        stiction_n: law.stiction_n,
        coulomb_n: law.coulomb_n,
        viscous_n_s_per_m: law.viscous_n_s_per_m,
        stribeck_velocity_m_per_s: law.stribeck_velocity_m_per_s,
        engagement_length_m: law.engagement_length_m,
        residual_n: law.residual_n,
        backward_ratio: law.backward_ratio,
    })
}

/// Every law with the numbers of one joint.
pub(crate) fn all(law: Lugre<f64>) -> Vec<(&'static str, Joint<f64>)> {
    vec![
        ("lugre", Joint::Lugre(law)),
        ("elasto_plastic", elasto_plastic(law)),
        ("gms of 4", Joint::Gms(gms(law, 4))),
        ("gms of 10", Joint::Gms(gms(law, 10))),
        ("two_region", two_region(law)),
        ("coulomb_stiction", coulomb_stiction(law)),
    ]
}

/// Those of [`all`] whose levels can differ between the directions.
pub(crate) fn all_with_backward_ratio(law: Lugre<f64>) -> Vec<(&'static str, Joint<f64>)> {
    let mut all = all(law);
    all.retain(|(_, joint)| {
        let mut found = false;
        joint.map(&mut |name, number| {
            found |= name.field() == "backward_ratio";
            number
        });
        found
    });
    all
}

/// A joint whose level does not fall along the guide.
pub(crate) fn endless() -> Lugre<f64> {
    Lugre { engagement_length_m: 1e9, ..paper_joint() }
}
