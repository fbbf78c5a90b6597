use super::testing::{Case, on, spring};
use super::*;
use glam::DVec3;

#[test]
fn ids_are_unique_and_round_trip() {
    for (k, &i) in Integrator::ALL.iter().enumerate() {
        assert_eq!(i.index(), k);
        assert_eq!(i.id().parse::<Integrator>(), Ok(i));
        assert!(
            Integrator::ALL[..k]
                .iter()
                .all(|j| j.id() != i.id() && j.name() != i.name()),
            "{i}: another integrator has its id or its name"
        );
        assert!(i.info().summary.ends_with('.') && !i.info().source.is_empty());
    }
    for pair in Integrator::ALL.windows(2) {
        let [before, after] = [pair[0], pair[1]].map(|i| i.info().group);
        assert!(
            before <= after,
            "{} is in the group {after:?}, but listed after {} in {before:?}: move its line in integrators!",
            pair[1],
            pair[0]
        );
    }
    let error = "leapfrog".parse::<Integrator>().unwrap_err().to_string();
    assert!(error.contains("'leapfrog'") && error.contains("heun-2012"));
}

#[test]
fn evaluations_as_claimed() {
    let Case { body, start, .. } = Case::free();
    let pull = spring(DVec3::X, 1.0);
    let (free, forced) = (on(&[]), on(&pull));
    for &i in Integrator::ALL {
        let claimed = i.info().evaluations;
        for (law, what, claim) in [
            (free, "free", claimed.free),
            (forced, "forced", claimed.forced),
        ] {
            let (mut state, mut memory) = (start, IntegratorMemory::default());
            for step in 1..=8 {
                let outcome = i.step(&body, &mut state, &law, 1.0 / 60.0, &mut memory);
                let spent = outcome.evaluations;
                // The first step needs the starting evaluations and the last does not; in between, a long memory fills.
                let (least, most) = match step {
                    1 => (claim + claimed.starting, claim + claimed.starting),
                    8 => (claim, claim),
                    _ => (claim, claim + claimed.starting),
                };
                let (least, most) = (u64::from(least), u64::from(most));
                assert!(
                    spent >= least && (spent <= most || claimed.per_iteration),
                    "{i} claims {least} evaluations in step {step}, {what}; measured: {spent}. \
                     Claim what it spends in the `evaluations` of its INFO"
                );
            }
        }
    }
}
