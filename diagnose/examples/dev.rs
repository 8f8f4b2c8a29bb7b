//! dev
use std::sync::atomic::AtomicBool;
fn main() {
    let stop = AtomicBool::new(false);
    for folder in std::env::args().skip(1) {
        let t0 = std::time::Instant::now();
        let c = match oleo_diagnose::Campaign::open(std::path::Path::new(&folder)) {
            Ok(c) => c,
            Err(e) => {
                println!("{e}");
                continue;
            }
        };
        let p = oleo_diagnose::problem::Problem::new(&*c.specimen, &stop);
        println!("== {} read {:.2?}", c.name, t0.elapsed());
        let quiet = std::env::var("QUIET").is_ok();
        let s = oleo_diagnose::select::select(&p, &|m, f| {
            if !quiet {
                println!(
                    "   {m} {f:.2} {:.1?} sims {}",
                    t0.elapsed(),
                    p.simulated() / c.specimen.recordings()
                )
            }
        })
        .unwrap();
        let names = |i: usize| c.specimen.candidates()[i].name();
        let h = p.hypothesis(&s.best.point);
        let dev = s.best.deviations();
        if !quiet {
            for (k, par) in p.parameters(&s.best.point.effects).iter().enumerate() {
                println!(
                    "   {:28} z {:8.3} +- {:.3}  value {:.5e}",
                    par.key,
                    s.best.point.z[k],
                    dev[k],
                    par.value(s.best.point.z[k])
                );
            }
            let mut t = s.trials.clone();
            t.sort_by(|a, b| a.alone.total_cmp(&b.alone));
            for t in t.iter().take(12) {
                println!("     alone {:.4} {}", t.alone, names(t.candidate));
            }
            let mut t = s.trials.clone();
            t.retain(|t| t.added.is_some());
            t.sort_by(|a, b| a.added.unwrap().total_cmp(&b.added.unwrap()));
            for t in t.iter().take(6) {
                println!("     added {:.4} {}", t.added.unwrap(), names(t.candidate));
            }
        }
        println!(
            "{} ratio {:.4} -> {:.4}  {:?} incomplete {} time {:.1?}",
            c.name,
            s.noise_ratio.0,
            s.noise_ratio.1,
            s.chosen
                .iter()
                .map(|c| format!(
                    "{} gain {:.0}±{:.0} rival {:?}{}",
                    names(c.candidate),
                    c.gain,
                    c.gain_error,
                    c.rival.map(|r| (names(r.0), r.1 as i64, r.2 as i64)),
                    if c.ambiguous { " AMBIGUOUS" } else { "" }
                ))
                .collect::<Vec<_>>(),
            s.incomplete,
            t0.elapsed()
        );
        let _ = h;
        if std::env::var("MAP").is_ok() {
            let res = p.residuals(&p.predict(&s.best.point).unwrap());
            for (r, series) in res.iter().enumerate() {
                let f: Vec<String> = series
                    .iter()
                    .map(|c| format!("{:7.2}", (c.iter().map(|v| v * v).sum::<f64>() / c.len() as f64).sqrt()))
                    .collect();
                println!("    {:18} {}", c.specimen.recording_name(r), f.join(" "));
            }
        }
        if let Ok(want) = std::env::var("SHOW") {
            let sc = oleo_diagnose::screen::Screen::new(&p, &s.best).unwrap();
            let ids: Vec<usize> = (0..c.specimen.candidates().len())
                .filter(|&i| names(i).contains(&want))
                .collect();
            for f in sc.all(&ids).unwrap().into_iter().flatten() {
                let d = f.deviations();
                let pr = p.parameters(&f.point.effects);
                let k = f.point.z.len() - 1;
                println!(
                    "    {} cost {:.0} (base {:.0}) last {} = {:e} sd z {}",
                    names(*f.point.effects.last().unwrap()),
                    f.cost,
                    s.best.cost,
                    pr[k].key,
                    pr[k].value(f.point.z[k]),
                    d[k]
                );
            }
        }
    }
}
