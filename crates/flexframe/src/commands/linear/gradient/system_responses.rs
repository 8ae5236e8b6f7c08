//! Responses of bodies in joints with their rates: Eq. (D21) of `docs/method/gradients.md`.

use std::f64::consts::TAU;

use diagnostic::{Failure, Kind};
use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

use super::here::{Here, NumbersOfBody};
use super::number::Number;
use super::responses::{AXES, Change, Moved, Ports, Responses};
use super::varying::{product, times};
use crate::commands::linear::linearize::{BodyRows, acting_loads, input_channels};

/// An input or an output: forces, or a displacement, over the coordinates of all bodies.
struct Port {
    name: String,
    row: Vec<f64>,
    of: Of,
}

/// The place that it acts on or sees.
enum Of {
    /// A load, by its number in the scene of a body.
    Load { body: usize, load: usize },
    /// A displacement of a point of a body along an axis.
    Point { body: usize, point: usize, axis: usize },
    /// A coordinate of a joint, which markers have.
    Joint,
}

/// Rates of a port with a number of a body.
struct Followed {
    /// Forces of the port on the coordinates of the body that are none of its markers.
    direct: Vec<f64>,
    /// Their rates, on the coordinates of the body.
    rates: Vec<f64>,
}

impl Here<'_> {
    /// The responses at some frequencies, cycles per time; `stiffness_rates` are K' by each number that is a stiffness.
    pub fn responses(
        &self,
        numbers: &[Number],
        stiffness_rates: &[Option<Mat<f64>>],
        varied: &[Option<NumbersOfBody<'_>>],
        frequencies: &[f64],
    ) -> Result<Responses, Failure> {
        if frequencies.is_empty() {
            return Ok(Responses::none(numbers.len()));
        }
        let [inputs, outputs] = self.ports();
        let ports: Vec<&Port> = inputs.iter().chain(&outputs).collect();
        let changes = numbers.iter().zip(stiffness_rates).enumerate().map(|(i, (number, rate))| match rate {
            Some(rate) => Ok(Box::new(move |_, ports: [usize; 2], moved: &Moved| {
                let [x, y] = ports.map(|port| &moved.coordinates[port]);
                Some(-product(rate, x, y))
            }) as Change<'_>),
            None => self.change_with(i, number, varied, &ports),
        });
        let changes: Vec<Change<'_>> = changes.collect::<Result<_, _>>()?;
        let linear = &self.steady.linear;
        let size = linear.size();
        let along =
            |j: usize, row: &[f64]| -> f64 { row.iter().enumerate().map(|(k, r)| r * linear.basis[(k, j)]).sum() };
        let rows = Mat::from_fn(size, ports.len(), |j, port| along(j, &ports[port].row));
        let right = Mat::from_fn(size, ports.len(), |j, port| c64::new(rows[(j, port)], 0.0));
        let moved = |omega: f64| {
            let dynamic = Mat::from_fn(size, size, |i, j| {
                let own = if i == j { omega * omega } else { 0.0 };
                c64::new(linear.stiffness[(i, j)] - own, omega * linear.damping[(i, j)])
            });
            let moved = dynamic.partial_piv_lu().solve(&right);
            let is_known = |value: c64| value.re.is_finite() && value.im.is_finite();
            if (omega == 0.0 && self.is_loose) || !moved.col_iter().all(|x| x.iter().all(|x| is_known(*x))) {
                let frequency = omega / TAU;
                let words = format!(
                    "the response at {frequency} cycles per time has no end: an undamped vibration or a motion as a whole is there"
                );
                let help = "take other --frequencies, or give the bodies damping";
                return Err(Kind::Run.of(self.path()).help(help).says(words));
            }
            let coordinates: Vec<Vec<c64>> = moved.col_iter().map(|x| x.iter().copied().collect()).collect();
            let motions = coordinates.iter().map(|x| times(&linear.basis, x)).collect();
            Ok(Moved { coordinates, motions })
        };
        let names = [&inputs, &outputs].map(|ports| ports.iter().map(|port| port.name.clone()).collect());
        Responses::new(&Ports { names, rows }, frequencies, &changes, moved)
    }

    /// Loads and forces along joints; displacements of points and coordinates of joints.
    fn ports(&self) -> [Vec<Port>; 2] {
        let (motion, linear) = (self.motion.run.motion(), &self.steady.linear);
        let all = linear.basis.nrows();
        let [mut inputs, mut outputs] = [(); 2].map(|()| Vec::new());
        for (place, (body, state)) in self.motion.bodies.iter().zip(self.steady.states()).enumerate() {
            let (scene, model, own) = (&self.system.bodies[*body], &self.models[*body], linear.coordinates_of(place));
            let rows = BodyRows::new(scene, model, &state.modal_displacement, self.models.len() == 1);
            let over = |row: &[f64]| {
                let mut whole = vec![0.0; all];
                whole[own.clone()].copy_from_slice(row);
                whole
            };
            let units = motion.system().bodies()[place].unit_forces(&state);
            let channels = input_channels(scene, model, &rows.prefix);
            for ((unit, channel), (load, _)) in units.iter().zip(channels).zip(acting_loads(scene, model)) {
                inputs.push(Port { name: channel.name, row: over(unit), of: Of::Load { body: *body, load } });
            }
            for (point, (name, shapes)) in rows.points().iter().enumerate() {
                for (axis, (letter, row)) in AXES.iter().zip(shapes).enumerate() {
                    let name = format!("{name}.displacement.{letter}");
                    outputs.push(Port { name, row: over(row), of: Of::Point { body: *body, point, axis } });
                }
            }
        }
        for (number, joint) in self.motion.joints.iter().enumerate() {
            let of = &self.system.joints[*joint];
            for coordinate in of.kind.coordinates() {
                let row = motion.coordinate_row(&self.steady, number, *coordinate);
                for list in [&mut inputs, &mut outputs] {
                    list.push(Port {
                        name: format!("{}.{}", of.name, coordinate.name()),
                        row: row.clone(),
                        of: Of::Joint,
                    });
                }
            }
        }
        [inputs, outputs]
    }

    /// The change by a number of a body.
    fn change_with<'a>(
        &self,
        i: usize,
        number: &Number,
        varied: &'a [Option<NumbersOfBody<'a>>],
        ports: &[&Port],
    ) -> Result<Change<'a>, Failure> {
        let (body, of_body, k) = self.varying(i, number, varied)?;
        let rates = &of_body.body.rates[k];
        let followed = |port: &&Port| {
            let direct = || port.row[of_body.first..of_body.first + rates.mass.nrows()].to_vec();
            match port.of {
                Of::Load { body: of, load } if of == body => {
                    let direct = direct();
                    let rates = rates.loads.get(&load)?.on_coordinates(&direct);
                    Some(Followed { direct, rates })
                }
                Of::Point { body: of, point, axis } if of == body => {
                    // Rigid motions move a point as they do, whatever the number.
                    let own = rates.points[point].row(axis).iter().copied();
                    let rates = std::iter::repeat_n(0.0, 6).chain(own).collect();
                    Some(Followed { direct: direct(), rates })
                }
                _ => Some(Followed { direct: Vec::new(), rates: Vec::new() }),
            }
        };
        let followed: Vec<Option<Followed>> = ports.iter().map(followed).collect();
        Ok(Box::new(move |omega, ports, moved| {
            let [first, second] = ports.map(|port| followed[port].as_ref());
            let (first, second) = (first?, second?);
            let [x, y] = ports.map(|port| &moved.motions[port][..]);
            let change = of_body.change(c64::new(0.0, omega), [x, y], [&first.direct, &second.direct], rates);
            let along = |followed: &Followed, motion| -> c64 {
                followed.rates.iter().zip(of_body.own(motion)).map(|(rate, x)| *x * *rate).sum()
            };
            Some(along(first, y) + along(second, x) - change)
        }))
    }
}
