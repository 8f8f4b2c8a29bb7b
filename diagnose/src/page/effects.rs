//! The section "What": the effects with equation and source, the rivals tested in their place, and all rejected candidates.

use oleo_plant_sim::strut::{Equation, LawArgument, LawPlace, UnlistedLaw};
use oleo_report::{Axis, Cell, Column, Curves, Page, Style, Table, significant};

use super::words;
use crate::campaign::Campaign;
use crate::diagnosis::{Diagnosis, Effect};
use crate::effect::unlisted::is_of_free_table;
use crate::effect::{Candidate, of};
use crate::parameter::Shown;
use crate::search::LeastSize;

pub fn section(page: &mut Page, campaign: &Campaign, diagnosis: &Diagnosis) {
    let all = campaign.specimen.candidates();
    page.section("What");
    let found = diagnosis.effects.iter().any(|e| e.selected.is_some());
    if !found {
        page.text("No effect improves the prediction of held-out stretches by more than chance and the smoothing of the inputs can explain.");
    }
    for e in &diagnosis.effects {
        page.topic(Some(&words::topic(&e.place)));
        effect(page, campaign, e);
    }
    page.topic(None);
    if found {
        page.text(
            "For each effect, its strongest rival was fitted in its place, together with all other parameters, and judged on \
             the same held-out stretches. The lead says how much better the effect fits than its rival, in standard errors \
             over the stretches.",
        )
        .table(rivals(all, diagnosis));
    }
    let rejected = rejected(all, diagnosis);
    let summary = format!("All {} rejected candidates with their noise ratios", rejected.len());
    if diagnosis
        .selection
        .scores
        .iter()
        .any(|score| !score.least_sizes.is_empty())
    {
        page.text(
            "The list of rejected candidates states from which size each would have been found in 19 of 20 such campaigns. Below that size, \
             \"absent\" means only that these recordings cannot show it.",
        );
    }
    page.details(&summary, rejected);
}

fn effect(page: &mut Page, campaign: &Campaign, e: &Effect) {
    let (kind, known) = (campaign.specimen.kind(), of(e.id));
    let named = known.named(kind, &e.label);
    if e.selected.is_none() {
        page.text(&format!(
            "{} {}: part of the misfit can be predicted from the inputs, but none of the laws that were tried improves the \
             prediction of held-out stretches enough to be reported.",
            words::sentence(named),
            words::at(&e.place)
        ));
        return;
    }
    page.text(&format!(
        "{} {} ({}).",
        words::sentence(named),
        words::at(&e.place),
        words::effect_name(e)
    ));
    if let Some(equation) = known.equation_in(kind, &e.label) {
        let meaning = match law(e) {
            Some(law) if is_closed(equation) => symbols_of_a_law(&law),
            _ => words::sentence(known.meaning_in(kind, &e.label)),
        };
        (page.equation(equation.text)).text(&format!("{meaning}. Source: {}.", equation.source));
    }
    if !e.parameters.is_empty() && has_readable_numbers(e) {
        let mut table = Table::new([
            Column::text("Parameter"),
            Column::number("Value"),
            Column::text("95 % interval"),
            Column::text("Unit"),
        ]);
        for p in &e.parameters {
            let (name, unit) = words::parameter(&p.key);
            let (value, interval) = words::value_and_interval(p.value, p.ci95);
            let name = match known.symbol_in(kind, &e.label, &p.key) {
                None | Some("") => name,
                Some(symbol) => format!("{name}, {symbol}"),
            };
            table.row([name, value, interval, unit]);
        }
        page.table(table);
    }
    if let Some(law) = law(e) {
        page.figure(tabulated(e, &law));
    }
}

/// Whether the text of a law is an equation, and not the words that stand for a table.
fn is_closed(equation: Equation) -> bool {
    equation.text.contains('=')
}

/// What value and argument of a law's equation are.
fn symbols_of_a_law(law: &UnlistedLaw) -> String {
    let quantity = |(name, unit): (&str, &str)| {
        if unit.is_empty() {
            format!("the {name}")
        } else {
            format!("the {name} in {unit}")
        }
    };
    let y = quantity(value(law));
    if law.depends_on == LawArgument::Phase {
        format!("Here y is {y}, and t is the time since the start of each recording in s")
    } else if law.depends_on == LawArgument::RelativeDensity {
        format!(
            "Here y is {y}, x is {}, T is the temperature of the gas, and T_0 that of its surroundings, both in K",
            quantity(argument(law.depends_on))
        )
    } else if law.presliding_volume_m3.is_some() {
        format!(
            "Here y is {y}, x is {}, and s is the shear of the seal, from -1 to 1, while the oil volume V in m3 flows in with Q in m3/s",
            quantity(argument(law.depends_on))
        )
    } else {
        format!("Here y is {y}, and x is {}", quantity(argument(law.depends_on)))
    }
}

/// The law of an effect that was fitted as a table.
pub(super) fn law(effect: &Effect) -> Option<UnlistedLaw> {
    serde_json::from_value(effect.law.clone()?).ok()
}

/// Whether the numbers of an effect mean something on their own. Those of a law of a fixed shape do (the width of a groove);
/// those of a free table, one for each of its points or intervals, are only drawn.
pub(super) fn has_readable_numbers(effect: &Effect) -> bool {
    !effect.parameters.iter().any(|p| is_of_free_table(&p.key))
}

/// A law that was fitted as a table, drawn.
fn tabulated(effect: &Effect, law: &UnlistedLaw) -> Curves {
    let (argument, argument_unit) = argument(law.depends_on);
    let (value, value_unit) = value(law);
    let mut curves = Curves::new(
        &format!("The fitted law: {}", effect.label),
        Axis::new(argument, argument_unit),
    );
    let memory = (law.time_constant_s).map_or(String::new(), |t| {
        format!(
            " A change is forgotten with a time constant of {} s.",
            significant(t, 3)
        )
    });
    let shear = (law.presliding_volume_m3).map_or(String::new(), |v| {
        format!(
            " It is reached over {} m3 of oil, which shear the seal.",
            significant(v, 3)
        )
    });
    curves.caption(&format!("The law is linear between the points.{memory}{shear}"));
    curves
        .panel(Axis::new(value, value_unit))
        .series(Style::LineAndPoints, "fitted", &law.argument, &law.value);
    curves
}

/// What a law depends on, and its unit.
fn argument(depends_on: LawArgument) -> (&'static str, &'static str) {
    match depends_on {
        LawArgument::Displacement => ("displacement", "m"),
        LawArgument::Speed => ("speed", "m/s"),
        LawArgument::Acceleration => ("acceleration", "m/s2"),
        LawArgument::Time => ("time since the start", "s"),
        LawArgument::Phase => ("phase of the oscillation", "turns"),
        LawArgument::P1 => ("p1", "Pa"),
        LawArgument::Flow => ("flow", "m3/s"),
        LawArgument::FlowRate => ("rate of flow", "m3/s2"),
        LawArgument::PressureDrop => ("pressure drop", "Pa"),
        LawArgument::RelativeDensity => ("gas density over static gas density", ""),
        LawArgument::RelativeVolume => ("gas volume over static gas volume", ""),
        LawArgument::Reading => ("reading", ""),
        LawArgument::ReadingRate => ("rate of the reading", "1/s"),
        LawArgument::Energy => ("energy held", "J"),
        LawArgument::RelativeEnergy => ("energy held, over static pressure times static volume", ""),
        LawArgument::Force => ("force above the static one", "N"),
        LawArgument::ReadingChange => ("recent change of r, the reading", ""),
        LawArgument::VolumeChange => ("recent change of v, the gas volume over the static one", ""),
    }
}

/// What the value of a law is at its place, and its unit.
fn value(law: &UnlistedLaw) -> (&'static str, &'static str) {
    match law.place {
        LawPlace::MainSeal => ("force", "N"),
        LawPlace::MainSealFriction => ("friction force", "N"),
        LawPlace::MainChamber => ("volume", "m3"),
        LawPlace::Mount => ("deflection", "m"),
        LawPlace::MainChamberLoss => ("flow out of the chamber", "m3/s"),
        LawPlace::Path1 | LawPlace::Path2 => ("pressure drop", "Pa"),
        LawPlace::BesidePack1 | LawPlace::BesidePack2 if law.depends_on == LawArgument::PressureDrop => {
            ("flow", "m3/s")
        }
        LawPlace::BesidePack1 | LawPlace::BesidePack2 => ("flow coefficient", "m3/s/sqrt(Pa)"),
        LawPlace::Pack1 | LawPlace::Pack2 => ("factor on the pressure drop", ""),
        LawPlace::Valve1 | LawPlace::Valve2 | LawPlace::Valve3 | LawPlace::Valves => ("factor on the flow", ""),
        LawPlace::BesideValve3 => ("flow coefficient", "m3/s/sqrt(Pa)"),
        LawPlace::ValveTiming => ("time added to the response", "s"),
        LawPlace::ValveMovement => ("duration of the movement", "s"),
        LawPlace::Accumulator1 | LawPlace::Accumulator2 | LawPlace::Accumulators
            if law.depends_on == LawArgument::RelativeDensity =>
        {
            ("compressibility factor", "")
        }
        LawPlace::Accumulator1 | LawPlace::Accumulator2 | LawPlace::Accumulators => ("factor on the gas pressure", ""),
        LawPlace::InstrumentDisplacement => ("value added to the reading", "m"),
        LawPlace::InstrumentForce => ("value added to the reading", "N"),
        LawPlace::InstrumentP1 | LawPlace::InstrumentP2 | LawPlace::InstrumentP3 | LawPlace::InstrumentP4 => {
            ("value added to the reading", "Pa")
        }
        LawPlace::Accumulator1Friction | LawPlace::Accumulator2Friction => ("pressure held back", "Pa"),
    }
}

fn rivals(all: &[Candidate], diagnosis: &Diagnosis) -> Table {
    let mut table = Table::new([
        Column::text("Effect"),
        Column::number("Noise ratio without it"),
        Column::number("Noise ratio with it"),
        Column::text("Strongest rival in its place"),
        Column::number("Noise ratio with the rival"),
        Column::number("Lead, standard errors"),
        Column::text("Judgement"),
    ]);
    let with = diagnosis.selection.improved_ratio;
    let count: usize = diagnosis.residuals.improved.iter().flatten().map(Vec::len).sum();
    for c in &diagnosis.selection.effects {
        let mut row: Vec<Cell> = vec![
            all[c.candidate].name().into(),
            format!("{:.2}", c.ratio_without).into(),
            format!("{with:.2}").into(),
        ];
        match c.rival {
            Some(rival) => {
                let (lead, error) = (rival.lead.total, rival.lead.standard_error);
                let ratio = (with * with + lead / count.max(1) as f64).max(0.0).sqrt();
                row.extend([
                    all[rival.candidate].name().into(),
                    format!("{ratio:.2}").into(),
                    significant(lead / error.max(1.0), 2).into(),
                    if rival.ambiguous {
                        Cell::warning("cannot be distinguished")
                    } else {
                        Cell::good("rival rejected")
                    },
                ]);
            }
            None => row.extend([
                "no rival could be fitted".into(),
                "-".into(),
                "-".into(),
                Cell::good("no rival"),
            ]),
        }
        table.row(row);
    }
    table
}

/// The sizes from which an effect would have been found, in words.
fn found_from(candidate: &Candidate, least_sizes: &[LeastSize]) -> String {
    let sizes = least_sizes.iter().map(|least| {
        let number = &candidate.parameters[least.parameter];
        let value = least.value.map(|value| number.reported(value));
        let (name, unit) = words::parameter(number.reported_key());
        let unit = unit.replace("relative", "");
        let bound = match number.shown {
            Shown::AsInverse(_) => "at most",
            Shown::AsFitted | Shown::AsNumberBelievedToBe(_) => "at least",
        };
        match value {
            Some(value) => format!("{name} of {bound} {} {unit}", significant(value, 2))
                .trim_end()
                .to_owned(),
            None => format!("{name}: not by these recordings"),
        }
    });
    let sizes: Vec<String> = sizes.collect();
    if sizes.is_empty() { "-".into() } else { sizes.join("; ") }
}

fn rejected(all: &[Candidate], diagnosis: &Diagnosis) -> Table {
    let selection = &diagnosis.selection;
    let after = selection.improved_ratio;
    let mut scores: Vec<_> = (selection.scores.iter())
        .filter(|t| !selection.best.point.effects.contains(&t.candidate))
        .collect();
    scores.sort_by(|a, b| a.alone.total_cmp(&b.alone));
    let mut table = Table::new([
        Column::text("Rejected candidate"),
        Column::text("Place"),
        Column::number("Held-out noise ratio with it alone"),
        Column::number("Held-out noise ratio with it added to the improved model"),
        Column::text("Would have been found from"),
        Column::text("Reason"),
    ]);
    for t in scores {
        let c = &all[t.candidate];
        let because = match t.added {
            None => "cannot be combined with an effect that was found".to_owned(),
            Some(added) if added >= after => "does not improve the held-out prediction".to_owned(),
            Some(added) => format!(
                "improves the held-out prediction by only {} %",
                significant(100.0 * (1.0 - added / after), 2)
            ),
        };
        table.row([
            c.id.to_string(),
            c.place_and_label(),
            if t.alone.is_finite() {
                format!("{:.3}", t.alone)
            } else {
                "not fitted".into()
            },
            t.added.map_or("-".into(), |a| format!("{a:.3}")),
            found_from(c, &t.least_sizes),
            because,
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Effect;
    use crate::effect::unlisted;
    use crate::vocabulary::{EffectId, Site, SpecimenKind};
    use strum::VariantArray;

    fn numbers_of(effect: &Effect, parameters: &[crate::parameter::Parameter]) -> bool {
        let estimate = |p: &crate::parameter::Parameter| crate::diagnosis::Estimate {
            key: p.key.clone(),
            value: p.start,
            ci95: [p.start; 2],
        };
        let mut effect = effect.clone();
        effect.parameters = parameters.iter().map(estimate).collect();
        has_readable_numbers(&effect)
    }

    /// Equations are written as text where they are computed; the page can set every one of them.
    #[test]
    fn every_equation_is_set_and_not_shown_as_text() {
        for &id in EffectId::VARIANTS {
            for &kind in SpecimenKind::VARIANTS {
                let Some(equation) = of(id).equation_in(kind, "") else {
                    continue;
                };
                if id == EffectId::Unlisted && !equation.text.contains('=') {
                    continue;
                }
                let mut page = Page::new("Equation", "oleo diagnose");
                page.equation(equation.text);
                assert!(page.render().contains("<math "), "{id}: {}", equation.text);
            }
        }
    }

    /// A law of a few numbers is an equation, and the page says what its symbols are.
    #[test]
    fn a_law_of_few_numbers_is_set_as_an_equation_with_its_quantities() {
        let label = "opening beside pack 1 over displacement";
        let equation = of(EffectId::Unlisted).equation_in(SpecimenKind::TwoStageStrut, label);
        assert!(is_closed(equation.expect("an equation")));
        let law = unlisted::table(label, &[1e-6, 0.0, 0.01]).expect("a law of the list");
        assert_eq!(
            symbols_of_a_law(&law),
            "Here y is the flow coefficient in m3/s/sqrt(Pa), and x is the displacement in m"
        );
        let piston = unlisted::table("pressure held back over volume, accumulator 2", &[4e4, -0.5, 7e-7]);
        let piston = piston.expect("a law of the list");
        assert_eq!(piston.presliding_volume_m3, Some(7e-7));
        assert!(symbols_of_a_law(&piston).ends_with("while the oil volume V in m3 flows in with Q in m3/s"));
        let symbol = |key| {
            of(EffectId::Unlisted).symbol_in(
                SpecimenKind::TwoStageStrut,
                "pressure held back over volume, accumulator 2",
                key,
            )
        };
        assert_eq!(symbol("presliding_volume_m3"), Some("V_s"));
        for candidate in unlisted::candidates_of_struts(50.0) {
            let equation = of(EffectId::Unlisted).equation_in(SpecimenKind::TwoStageStrut, &candidate.label);
            let equation = equation.expect("an equation");
            let mut page = Page::new("Equation", "oleo diagnose");
            page.equation(equation.text);
            let set = page.render().contains("<math ");
            assert_eq!(set, is_closed(equation), "{}: {}", candidate.label, equation.text);
        }
    }

    /// A page that says "drawn" draws it: every law that the search may fit to a strut has a figure.
    #[test]
    fn every_law_without_a_name_can_be_drawn() {
        for candidate in unlisted::candidates_of_struts(50.0) {
            let label = candidate.label;
            let starts: Vec<f64> = candidate.parameters.iter().map(|p| p.start).collect();
            let law = unlisted::table(&label, &starts).expect("a law of the list");
            let effect = Effect {
                id: EffectId::Unlisted,
                place: Site::Unknown.into(),
                label: label.clone(),
                selected: None,
                confidence: 0.5,
                parameters: vec![],
                law: serde_json::to_value(&law).ok(),
                equation: None,
                ratio_without: 2.0,
                ratio_with: 1.0,
            };
            let read = super::law(&effect).unwrap_or_else(|| panic!("{label} is not drawn"));
            assert_eq!(read, law, "{label}");
            let readable = numbers_of(&effect, &candidate.parameters);
            match label.as_str() {
                "opening beside pack 1 over displacement" | "force over acceleration" | "force over time" => {
                    assert!(readable, "{label}");
                }
                "force over speed" | "friction over speed" | "strength of pack 1 over displacement" => {
                    assert!(!readable, "{label}");
                }
                _ => {}
            }
            assert!(!value(&law).0.is_empty() && !argument(law.depends_on).0.is_empty());
        }
    }
}
