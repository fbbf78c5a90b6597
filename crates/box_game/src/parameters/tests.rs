use super::*;

#[test]
fn the_table_is_consistent() {
    for (k, parameter) in Parameter::ALL.into_iter().enumerate() {
        let info = parameter.info();
        let (range, slider) = (info.range, info.slider);
        assert!(range.0 <= slider.0 && slider.1 <= range.1, "{info:?}");
        assert!(info.hint.ends_with('.'));
        for other in &Parameter::ALL[..k] {
            assert!(other.info().label != info.label && other.info().id != info.id);
        }
        for value in [f64::NEG_INFINITY, f64::INFINITY, -1e300, 1e300, 0.0] {
            let nearest = parameter.nearest(value).expect("only NaN has none");
            assert!(range.0 <= nearest && nearest <= range.1);
        }
        assert_eq!(parameter.nearest(f64::NAN), None);
    }
    let law = Parameter::RestitutionLaw;
    assert_eq!(
        (law.parse("newton"), law.parse("0"), law.parse("x")),
        (Some(1.0), Some(0.0), None)
    );
    assert_eq!(law.describe(1.0), "restitution-law Newton");
    assert_eq!(Parameter::Substeps.nearest(2.6), Some(3.0));
    assert!(SPEEDS.is_sorted_by(|a, b| a < b) && SPEEDS.contains(&1.0));
}

#[test]
fn values_are_set_within_their_range_and_refused_in_words() {
    let mut parameters = Parameters::of(&Scenario::find("bounce").expect("a scene"));
    for parameter in Parameter::ALL {
        let value = parameter.info().slider.0;
        assert_eq!(parameters.set(parameter, value), Ok(()));
        assert_eq!(parameters.get(parameter), Some(value));
    }
    let before = parameters;
    for (parameter, value, words) in [
        (
            Parameter::Restitution,
            1.5,
            "restitution 1.5: allowed: 0 to 1",
        ),
        (
            Parameter::Gravity,
            f64::NAN,
            "gravity NaN m/s²: allowed: -10000 to 10000 m/s²",
        ),
        (
            Parameter::Boxes,
            2.5,
            "boxes 2.5: allowed: whole numbers from 1 to 100000",
        ),
    ] {
        assert_eq!(parameters.set(parameter, value), Err(words.to_owned()));
    }
    assert_eq!(parameters, before);
    let mut floating = Parameters::of(&Scenario::find("dzhanibekov").expect("a scene"));
    let said = floating.set(Parameter::Friction, 0.5);
    let words = "friction: this scene has no floor".to_owned();
    assert_eq!(said, Err(words));
}
