//! The vehicle from the side, from behind and from above, moving with the time at the pointer.

use oleo_interface::{Axle, Corner, Side, Valve};
use oleo_plant_sim::vehicle::{AxleParameters, VehicleParameters};
use oleo_report::Scene;

use super::time::{LINK, Time};
use crate::metrics::Metrics;
use crate::record::Sample;
use crate::run::Outcome;

/// Units of the drawing for a metre.
const PER_M: f64 = 100.0;
/// Vertical motion is drawn larger than it is, and angles with it; otherwise a good ride could not be seen.
const LARGER: f64 = 3.0;
/// Height of the road at the start, in units of the drawing from its top.
const GROUND: f64 = 250.0;
/// Height of a view, in units of the drawing.
const HEIGHT: f64 = 290.0;

/// The moving drawing of a run.
pub(super) fn scene(outcome: &Outcome, metrics: &Metrics, time: &Time) -> Scene {
    let samples = &outcome.plant.recording.samples;
    let shape = Shape::of(&outcome.plant.assembly.parameters);
    let mut scene = Scene::new("The vehicle", &shape.svg(), LINK, &time.s, "s");
    scene.caption(
        "The vehicle at the time of the pointer in a figure, or of the slider: from the left, from behind and from above. Vertical \
         motion and angles are drawn three times as large as they are. A filled circle is an open valve (1, 2 and 3 from left to right).",
    );
    scene.begin(time.begin_s());
    let at = |i: usize| Pose::of(&samples[i], &shape);
    scene.part("side-body", |i| {
        let pose = at(i);
        // The nose is on the left; where it is down, the drawing turns against the clock.
        [
            0.0,
            -PER_M * LARGER * pose.heave_m,
            -LARGER * pose.pitch_rad.to_degrees(),
        ]
    });
    // From behind, left is left: the left side up turns clockwise.
    scene.part("behind-body", |i| {
        let pose = at(i);
        [0.0, -PER_M * LARGER * pose.heave_m, LARGER * pose.roll_rad.to_degrees()]
    });
    for corner in Corner::ALL {
        let name = corner.name();
        scene.part(&format!("wheel-{name}"), |i| {
            [0.0, -PER_M * LARGER * at(i).wheel_m[corner.index()], 0.0]
        });
        scene.part(&format!("road-{name}"), |i| {
            [
                0.0,
                -PER_M * LARGER * samples[i].motion.wheel[corner].road_height_m,
                0.0,
            ]
        });
        scene.lamp(&format!("off-{name}"), |i| {
            samples[i].motion.wheel[corner].load_n <= 0.0
        });
        for valve in Valve::ALL {
            scene.lamp(&format!("valve-{name}-{}", valve.number()), |i| {
                samples[i].energised.is_open(corner, valve)
            });
        }
    }
    scene.lamp("handling", |i| {
        metrics.strategy.get(i).is_some_and(|said| said.handling)
    });
    scene
}

/// What the drawing needs of the vehicle's dimensions, m.
struct Shape {
    wheelbase: f64,
    /// Of the body's centre of mass.
    behind_front_axle: f64,
    /// Of the centre of mass above the ground, about which the drawn body turns.
    height: f64,
    width: f64,
    front: AxleParameters,
    rear: AxleParameters,
}

impl Shape {
    fn of(vehicle: &VehicleParameters) -> Self {
        Self {
            wheelbase: vehicle.layout.wheelbase_m,
            behind_front_axle: vehicle.body_cg_behind_front_axle_m(),
            height: vehicle.body.vehicle_cg_height_m,
            width: vehicle.layout.width_m,
            front: vehicle.front_axle,
            rear: vehicle.rear_axle,
        }
    }

    fn axle(&self, axle: Axle) -> &AxleParameters {
        match axle {
            Axle::Front => &self.front,
            Axle::Rear => &self.rear,
        }
    }

    /// How far an axle is ahead of the body's centre of mass, m.
    fn ahead_m(&self, axle: Axle) -> f64 {
        match axle {
            Axle::Front => self.behind_front_axle,
            Axle::Rear => self.behind_front_axle - self.wheelbase,
        }
    }

    fn svg(&self) -> String {
        format!(
            "<div class=\"views\">{}{}{}</div>",
            self.side(),
            self.behind(),
            self.above()
        )
    }

    /// A point of the outline, right of the centre of mass and down from the ground, as the drawing has it from the centre of mass.
    fn point(&self, right_m: f64, down_m: f64) -> String {
        format!("{:.1},{:.1}", PER_M * right_m, PER_M * (down_m + self.height))
    }

    /// The body, which turns about its centre of mass.
    fn body(&self, name: &str, centre: f64, outline: &[String]) -> String {
        format!(
            "<g transform=\"translate({centre:.1} {:.1})\"><g data-part=\"{name}\"><polygon class=\"body\" points=\"{}\"/></g></g>",
            GROUND - PER_M * self.height,
            outline.join(" ")
        )
    }

    /// From the left, driving to the left as one sees it from there.
    fn side(&self) -> String {
        let length = self.wheelbase + 1.4;
        let width = PER_M * (length + 0.6);
        let centre = 0.5 * width - PER_M * (0.5 * self.wheelbase - self.behind_front_axle);
        let (bottom, bonnet, roof) = (-0.55, -1.2, -1.95);
        let nose = -(self.behind_front_axle + 0.55);
        let tail = self.wheelbase - self.behind_front_axle + 0.75;
        let outline: Vec<String> = [
            (nose, bottom),
            (nose, bonnet),
            (nose + 1.15, bonnet),
            (nose + 1.45, roof),
            (tail, roof),
            (tail, bottom),
        ]
        .map(|(x, y)| self.point(x, y))
        .into();
        let mut parts = self.body("side-body", centre, &outline);
        for corner in [Corner::FrontLeft, Corner::RearLeft] {
            let x = centre - PER_M * self.ahead_m(corner.axle());
            let radius = PER_M * self.axle(corner.axle()).tyre_radius_m;
            parts += &wheel_and_road(corner, x, |y| {
                format!(
                    "<circle class=\"wheel\" cx=\"{x:.1}\" cy=\"{:.1}\" r=\"{radius:.1}\"/>",
                    y - radius
                )
            });
        }
        view("From the left", width, &parts)
    }

    fn behind(&self) -> String {
        let width = PER_M * (self.width + 0.9);
        let (centre, half) = (0.5 * width, 0.5 * self.width);
        let outline: Vec<String> = [
            (-half, -0.6),
            (-half, -1.2),
            (-half + 0.12, -1.95),
            (half - 0.12, -1.95),
            (half, -1.2),
            (half, -0.6),
        ]
        .map(|(x, y)| self.point(x, y))
        .into();
        let mut parts = self.body("behind-body", centre, &outline);
        for corner in [Corner::RearLeft, Corner::RearRight] {
            let x = centre + PER_M * across_m(corner, 0.5 * self.rear.track_m);
            let height = 2.0 * PER_M * self.rear.tyre_radius_m;
            parts += &wheel_and_road(corner, x, |y| {
                format!(
                    "<rect class=\"wheel\" x=\"{:.1}\" y=\"{:.1}\" width=\"24\" height=\"{height:.1}\" rx=\"6\"/>",
                    x - 12.0,
                    y - height
                )
            });
        }
        view("From behind", width, &parts)
    }

    /// From above, the nose at the top, with the valves of each strut.
    fn above(&self) -> String {
        let mut parts = String::from(
            "<rect class=\"body\" x=\"90\" y=\"40\" width=\"90\" height=\"215\" rx=\"16\"/><path class=\"line\" d=\"M105 92 H165\"/>",
        );
        for corner in Corner::ALL {
            let x = if corner.side() == Side::Left { 12.0 } else { 192.0 };
            let y = if corner.axle() == Axle::Front { 84.0 } else { 216.0 };
            let name = corner.name();
            for valve in Valve::ALL {
                parts += &format!(
                    "<circle class=\"lamp\" data-lamp=\"valve-{name}-{}\" cx=\"{}\" cy=\"{y}\" r=\"9\"/>",
                    valve.number(),
                    x + 10.0 + 24.0 * valve.index() as f64
                );
            }
            parts += &format!(
                "<text class=\"off\" data-lamp=\"off-{name}\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">off the road</text>",
                x + 38.0,
                y + 28.0
            );
        }
        parts +=
            "<text class=\"off\" data-lamp=\"handling\" x=\"135\" y=\"155\" text-anchor=\"middle\">handling</text>";
        view("Open valves", 270.0, &parts)
    }
}

/// A wheel with the piece of road under it, which moves with the road.
fn wheel_and_road(corner: Corner, x: f64, wheel: impl Fn(f64) -> String) -> String {
    let name = corner.name();
    format!(
        "<g data-part=\"wheel-{name}\">{}</g><g data-part=\"road-{name}\"><path class=\"road\" d=\"M{:.1} {GROUND} H{:.1}\"/></g>",
        wheel(GROUND),
        x - 45.0,
        x + 45.0
    )
}

fn view(title: &str, width: f64, parts: &str) -> String {
    format!(
        "<svg viewBox=\"0 0 {width:.0} {HEIGHT}\" style=\"flex:{width:.0} 1 {:.0}px\" role=\"img\" aria-label=\"{title}\"><text x=\"8\" y=\"20\">{title}</text>{parts}</svg>",
        0.55 * width
    )
}

/// To the right as seen from behind, m.
fn across_m(corner: Corner, half_m: f64) -> f64 {
    match corner.side() {
        Side::Left => -half_m,
        Side::Right => half_m,
    }
}

/// Where body and wheels are, from where they stood at the start.
struct Pose {
    heave_m: f64,
    pitch_rad: f64,
    roll_rad: f64,
    /// Height of each wheel's centre, m.
    wheel_m: [f64; 4],
}

impl Pose {
    /// The struts say where the axles are: an axle is below the body by the strut's displacement less, at both of its struts.
    fn of(sample: &Sample, shape: &Shape) -> Self {
        let body = &sample.motion.body;
        let mut wheel_m = [0.0; 4];
        for axle in [Axle::Front, Axle::Rear] {
            let parameters = shape.axle(axle);
            let at_strut = |side: Side| {
                let corner = axle.corner(side);
                let left_m = -across_m(corner, 0.5 * parameters.strut_spacing_m);
                body.heave_m - body.pitch_rad * shape.ahead_m(axle)
                    + body.roll_rad * left_m
                    + sample.displacement_m[corner]
            };
            let (left, right) = (at_strut(Side::Left), at_strut(Side::Right));
            let (middle, slope) = (0.5 * (left + right), (left - right) / parameters.strut_spacing_m);
            for side in Side::ALL {
                let corner = axle.corner(side);
                wheel_m[corner.index()] = middle - slope * across_m(corner, 0.5 * parameters.track_m);
            }
        }
        Self {
            heave_m: body.heave_m,
            pitch_rad: body.pitch_rad,
            roll_rad: body.roll_rad,
            wheel_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Motion;
    use oleo_controller::ValveCommand;
    use oleo_interface::Corners;
    use oleo_plant_sim::strut::StrutOutput;
    use oleo_plant_sim::vehicle::BodyMotion;

    fn sample(body: BodyMotion, displacement_m: Corners<f64>) -> Sample {
        Sample {
            motion: Motion {
                body,
                ..Motion::default()
            },
            displacement_m,
            strut: Corners::splat(StrutOutput {
                force_n: 0.0,
                pressure_pa: [4e6; 4],
            }),
            inertial: None,
            heard: true,
            command: ValveCommand::SAFE,
            energised: ValveCommand::SAFE,
        }
    }

    /// A body that moves over axles that stand still: the struts take up the motion.
    #[test]
    fn wheels_on_a_flat_road_stay_where_they_are() {
        let shape = Shape::of(&VehicleParameters::defender110());
        let body = BodyMotion {
            heave_m: 0.02,
            roll_rad: 0.03,
            pitch_rad: -0.01,
            ..BodyMotion::default()
        };
        let displacement_m = Corners::from_fn(|corner| {
            let axle = shape.axle(corner.axle());
            let left_m = -across_m(corner, 0.5 * axle.strut_spacing_m);
            -(body.heave_m - body.pitch_rad * shape.ahead_m(corner.axle()) + body.roll_rad * left_m)
        });
        let pose = Pose::of(&sample(body, displacement_m), &shape);
        assert!(
            pose.wheel_m.iter().all(|height| height.abs() < 1e-12),
            "{:?}",
            pose.wheel_m
        );
        // Without displacement the axles go with the body, and the left wheels are the higher ones.
        let stiff = Pose::of(&sample(body, Corners::splat(0.0)), &shape);
        let rise = 0.02 + 0.03 * 0.5 * shape.front.track_m + 0.01 * shape.behind_front_axle;
        assert!((stiff.wheel_m[0] - rise).abs() < 1e-12 && stiff.wheel_m[0] > stiff.wheel_m[1]);
    }

    #[test]
    fn every_part_that_moves_is_drawn() {
        let svg = Shape::of(&VehicleParameters::defender110()).svg();
        for part in [
            "side-body",
            "behind-body",
            "wheel-front-left",
            "wheel-rear-right",
            "road-rear-left",
        ] {
            assert!(svg.contains(&format!("data-part=\"{part}\"")), "{part}");
        }
        assert_eq!(svg.matches("data-lamp=\"valve-").count(), 12);
    }
}
